//! The edge flux against the kernel that computes many at once, against differences, and in uniform flow.
use super::*;
use crate::cloud::{Edge, Weights};
use crate::math::jet::Jet;
use crate::scheme::edges::{Particles, edge_fluxes};

const AIR: Gas = Gas { gamma: 1.4 };
const OIL: Newtonian = Newtonian { viscosity: 0.02, sutherland: Some(0.38), prandtl: 0.72 };

/// Numbers between −1 and 1 that look random.
struct Draw(u64);
impl Draw {
    fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn vector<const D: usize>(&mut self) -> Vector<D> {
        Vector::from_fn(|_| self.number())
    }
}

/// The places, states, gradients and velocities of some particles, and edges between them.
struct Few<const D: usize> {
    x: Vec<Vector<D>>,
    volume: Vec<f64>,
    ends: Vec<EdgeEnd<D>>,
    edges: Vec<Edge<D>>,
    weights: Vec<[Vector<D>; 2]>,
}

fn few<const D: usize>() -> Few<D> {
    let (n, mut draw) = (12u32, Draw(1));
    let end = |draw: &mut Draw| EdgeEnd {
        state: Primitive {
            density: 1.0 + 0.3 * draw.number(),
            velocity: draw.vector(),
            pressure: 0.7 + 0.2 * draw.number(),
        },
        gradient: Gradient {
            density: draw.vector::<D>() * 0.3,
            velocity: std::array::from_fn(|_| draw.vector::<D>() * 0.3),
            pressure: draw.vector::<D>() * 0.3,
        },
        steepness: draw.number().max(0.0),
        weight: Vector::ZERO,
        velocity: draw.vector::<D>() * 0.2,
    };
    let ends = (0..n).map(|_| end(&mut draw)).collect();
    let pairs = (0..n).flat_map(|i: u32| (i + 1..n).map(move |j| (i, j)));
    let (weights, edges) =
        pairs.map(|(i, j)| ([draw.vector(), draw.vector()], Edge::of_both(i, j, draw.vector()))).unzip();
    Few {
        x: (0..n).map(|_| draw.vector()).collect(),
        volume: (0..n).map(|_| 1.5 + draw.number()).collect(),
        ends,
        edges,
        weights,
    }
}

/// Checks that every edge gives the same on its own as among others, and returns the largest flux.
fn compare<const D: usize>(few: &Few<D>, scheme: &FluxScheme) {
    let (state, gradient): (Vec<_>, Vec<_>) = few.ends.iter().map(|e| (e.state, e.gradient)).unzip();
    let velocity: Vec<_> = few.ends.iter().map(|e| e.velocity).collect();
    let steepness: Vec<_> = few.ends.iter().map(|e| e.steepness).collect();
    let outer = (10, 12);
    let particles = Particles {
        x: &few.x,
        volume: &few.volume,
        state: &state,
        gradient: &gradient,
        steepness: &steepness,
        velocity: &velocity,
        outer,
    };
    let mut found = Vec::new();
    let edges = (few.edges.as_slice(), Weights::stored(&few.weights), &[][..]);
    edge_fluxes(scheme, particles, edges, &mut |i: usize, change: &Conserved<D>| found.push((i, *change)));
    let mut found = found.into_iter();
    for (e, [a_i, a_j]) in few.edges.iter().zip(&few.weights) {
        let [i, j] = [e.i(), e.j()];
        let one = |k: usize, a: &Vector<D>| EdgeEnd { weight: *a * -few.volume[k], ..few.ends[k] };
        let ends = [one(i, a_i), one(j, a_j)];
        let face = EdgeFace { along: few.x[j] - few.x[i], area: e.s, whole: f64::from(u8::from(j >= outer.0)) };
        let [a, b] = edge_flux(scheme, [&ends[0], &ends[1]], &face);
        assert_eq!(found.next(), Some((i, a)));
        assert_eq!(found.next(), Some((j, b)));
    }
}

fn all_ways<const D: usize>(flux: Flux, limit: Limiter) {
    let few = few::<D>();
    for k in 0..32 {
        let chosen = |bit: u32| k >> bit & 1 == 1;
        let [second_order, low_mach] = [chosen(0), chosen(1)];
        let reconstruction = Reconstruction { second_order, kappa: 1.0 / 3.0, threshold: 0.02, low_mach };
        let medium = chosen(2).then_some(OIL);
        let (conservative, by_faces) = (chosen(3), chosen(4));
        compare(&few, &FluxScheme { gas: AIR, flux, limit, reconstruction, conservative, by_faces, medium });
    }
}

#[test]
fn an_edge_alone_gives_the_bits_that_it_gives_among_others() {
    all_ways::<2>(Flux::Hllc, Limiter::VanAlbada);
    all_ways::<3>(Flux::Hllc, Limiter::Venkatakrishnan);
    all_ways::<2>(Flux::Roe, Limiter::None);
    all_ways::<3>(Flux::AusmPlusUp, Limiter::VanAlbada);
    all_ways::<2>(Flux::Rusanov, Limiter::VanAlbada);
}

/// The same end with number `k` of its state, gradient, weight and velocity a little greater, as a number that carries the derivative.
fn varied<const D: usize, S: Scalar>(end: &EdgeEnd<D>, k: usize, by: S) -> EdgeEnd<D, S> {
    let mut at = 0;
    let mut next = |value: f64| {
        at += 1;
        if at - 1 == k { by + value } else { S::constant(value) }
    };
    let vector = |v: &Vector<D>, next: &mut dyn FnMut(f64) -> S| Vector::from_fn(|d| next(v[d]));
    let density = next(end.state.density);
    let velocity = vector(&end.state.velocity, &mut next);
    let pressure = next(end.state.pressure);
    let gradient = Gradient {
        density: vector(&end.gradient.density, &mut next),
        velocity: std::array::from_fn(|c| vector(&end.gradient.velocity[c], &mut next)),
        pressure: vector(&end.gradient.pressure, &mut next),
    };
    let (weight, speed) = (vector(&end.weight, &mut next), vector(&end.velocity, &mut next));
    let state = Primitive { density, velocity, pressure };
    EdgeEnd { state, gradient, steepness: S::constant(end.steepness), weight, velocity: speed }
}

fn numbers<const D: usize, S: Scalar>(both: [Conserved<D, S>; 2]) -> Vec<S> {
    both.iter().flat_map(|c| [c.density, c.energy].into_iter().chain(c.momentum.0)).collect()
}

/// Compares derivatives to every number of both ends with differences.
fn derivatives(scheme: &FluxScheme) {
    const STEP: f64 = 2e-6;
    let few = few::<2>();
    let (e, [a_i, a_j]) = (&few.edges[3], &few.weights[3]);
    let [i, j] = [e.i(), e.j()];
    let one = |k: usize, a: &Vector<2>| EdgeEnd { weight: *a * -few.volume[k], ..few.ends[k] };
    let ends = [one(i, a_i), one(j, a_j)];
    fn face<S: Scalar>(few: &Few<2>, e: &Edge<2>) -> EdgeFace<2, S> {
        let fixed = |v: Vector<2>| Vector::from_fn(|d| S::constant(v[d]));
        EdgeFace { along: fixed(few.x[e.j()] - few.x[e.i()]), area: fixed(e.s), whole: 0.0 }
    }
    fn at<S: Scalar>(
        scheme: &FluxScheme,
        ends: &[EdgeEnd<2>; 2],
        face: &EdgeFace<2, S>,
        (side, k, by): (usize, usize, S),
    ) -> Vec<S> {
        let zero = S::constant(0.0);
        let ends =
            [0, 1].map(|s| varied(&ends[s], if s == side { k } else { usize::MAX }, if s == side { by } else { zero }));
        numbers(edge_flux(scheme, [&ends[0], &ends[1]], face))
    }
    for (side, k) in (0..2).flat_map(|side| (0..16).map(move |k| (side, k))) {
        let jets = at(scheme, &ends, &face(&few, e), (side, k, Jet::variable(0.0)));
        let [less, more] = [-STEP, STEP].map(|by| at(scheme, &ends, &face(&few, e), (side, k, by)));
        let plain = at(scheme, &ends, &face(&few, e), (side, k, 0.0));
        for (n, jet) in jets.iter().enumerate() {
            let difference = (more[n] - less[n]) / (2.0 * STEP);
            assert_eq!(jet.value, plain[n]);
            assert!(
                (jet.first - difference).abs() < 1e-8 * (1.0 + difference.abs()),
                "{side} {k} {n}: {jet:?} {difference}"
            );
        }
    }
}

#[test]
fn numbers_with_derivatives_give_the_derivative_of_the_flux() {
    for conservative in [true, false] {
        let reconstruction = Reconstruction { second_order: true, kappa: 1.0 / 3.0, threshold: 0.02, low_mach: true };
        let (gas, medium, by_faces) = (AIR, Some(OIL), false);
        for flux in [Flux::Hllc, Flux::Roe] {
            let limit = Limiter::VanAlbada;
            derivatives(&FluxScheme { gas, flux, limit, reconstruction, conservative, by_faces, medium });
        }
    }
}

#[test]
fn uniform_flow_adds_nothing_however_the_ends_move() {
    let q = Primitive { density: 1.2, velocity: Vector([0.3, -0.6]), pressure: 0.8 };
    let gradient = Gradient::ZERO;
    let end = |weight, velocity| EdgeEnd {
        state: q,
        gradient,
        steepness: 0.0,
        weight: Vector(weight),
        velocity: Vector(velocity),
    };
    let face = EdgeFace { along: Vector([0.1, 0.02]), area: Vector([0.4, -0.1]), whole: 0.0 };
    let reconstruction = Reconstruction { second_order: true, kappa: 0.0, threshold: 0.02, low_mach: false };
    let (gas, flux, limit, conservative, by_faces) = (AIR, Flux::Hllc, Limiter::VanAlbada, false, false);
    let scheme = FluxScheme { gas, flux, limit, reconstruction, conservative, by_faces, medium: Some(OIL) };
    let ends = [end([0.2, 0.3], [0.5, -0.1]), end([-0.3, 0.1], [0.2, 0.7])];
    let found = numbers(edge_flux(&scheme, [&ends[0], &ends[1]], &face));
    assert!(found.iter().all(|v| v.abs() < 1e-15), "{found:?}");
}
