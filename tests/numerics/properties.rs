//! What the numerics promise for any state, any direction and any cloud, tried on random ones.

use crate::common::{case, largest, solver};
use alula::case::{Flux, Limiter};
use alula::cloud::sources::Source;
use alula::cloud::{Cloud, CloudSpec, Operators};
use alula::math::Vector;
use alula::physics::riemann::{AusmPlusUp, Hllc, Roe, Rusanov, UpwindFlux};
use alula::physics::{Conserved, Gas, Newtonian, Primitive, n_variables};
use alula::scheme::edge_flux::{EdgeEnd, EdgeFace, FluxScheme, edge_flux};
use alula::scheme::reconstruct::{Gradient, Limit, Reconstruction, Unlimited, VanAlbada, Venkatakrishnan};
use alula::scheme::wall_motion::WallMotion;
use alula::scheme::wall_state::{Wall, no_slip_wall, slip_wall};
use alula::system::{Instant, System};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{RngSeed, TestCaseResult};

const AIR: Gas = Gas { gamma: 1.4 };
const OIL: Newtonian = Newtonian { viscosity: 0.02, sutherland: Some(0.38), prandtl: 0.72 };
/// Round-off of some hundred operations on numbers of order one.
const ROUND_OFF: f64 = 1e-12;

/// The same cases on every run, and no files about those that fail.
fn tried(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() }
}

fn vector<const D: usize>(reach: f64) -> impl Strategy<Value = Vector<D>> {
    vec(-reach..reach, D).prop_map(|v| Vector::from_fn(|d| v[d]))
}

fn direction<const D: usize>() -> impl Strategy<Value = Vector<D>> {
    vector(1.0).prop_filter("no direction", |v| v.norm() > 0.1).prop_map(|v| v.unit())
}

/// From slow flow to Mach 10 and more.
fn state<const D: usize>() -> impl Strategy<Value = Primitive<D>> {
    let positive = || (-1.5..1.5f64).prop_map(f64::exp);
    (positive(), vector(3.0), positive()).prop_map(|(density, velocity, pressure)| Primitive {
        density,
        velocity,
        pressure,
    })
}

fn gradient<const D: usize>() -> impl Strategy<Value = Gradient<D>> {
    (vector(1.0), vec(vector(1.0), D), vector(1.0)).prop_map(|(density, velocity, pressure)| Gradient {
        density,
        velocity: std::array::from_fn(|d| velocity[d]),
        pressure,
    })
}

/// A rotation: two reflections.
#[derive(Clone, Copy, Debug)]
struct Turn<const D: usize>([Vector<D>; 2]);

impl<const D: usize> Turn<D> {
    fn any() -> impl Strategy<Value = Self> {
        (direction(), direction()).prop_map(|(a, b)| Self([a, b]))
    }

    fn of(&self, x: &Vector<D>) -> Vector<D> {
        self.0.iter().fold(*x, |x, n| x - *n * (2.0 * n.dot(&x)))
    }

    fn state(&self, q: &Primitive<D>) -> Primitive<D> {
        Primitive { velocity: self.of(&q.velocity), ..*q }
    }

    fn flux(&self, f: &Conserved<D>) -> Conserved<D> {
        Conserved { momentum: self.of(&f.momentum), ..*f }
    }

    fn end(&self, e: &EdgeEnd<D>) -> EdgeEnd<D> {
        let gradient = e.gradient.turned(&|x: &Vector<D>| self.of(x));
        let (weight, velocity) = (self.of(&e.weight), self.of(&e.velocity));
        EdgeEnd { state: self.state(&e.state), gradient, weight, velocity, ..*e }
    }
}

/// Fails unless both are the same to round-off of numbers like the fluxes of these states.
fn same<const D: usize>(a: &Conserved<D>, b: &Conserved<D>, of: &[&Primitive<D>]) -> TestCaseResult {
    let flux = |q: &Primitive<D>| (q.density + q.pressure) * (1.0 + q.velocity.norm()).powi(3);
    let (scale, d) = (1.0 + of.iter().map(|q| flux(q)).sum::<f64>(), a.minus(b));
    let worst = d.density.abs().max(d.momentum.max_abs()).max(d.energy.abs());
    prop_assert!(worst <= ROUND_OFF * scale, "{a:?}\n{b:?}\n{:?}", of);
    Ok(())
}

fn upwind<const D: usize>(
    flux: impl UpwindFlux<D>,
    (l, r, n, turn): &(Primitive<D>, Primitive<D>, Vector<D>, Turn<D>),
) -> TestCaseResult {
    let found = flux.across(&AIR, l, r, n);
    same(&flux.across(&AIR, l, l, n), &AIR.flux(l, n), &[l])?;
    same(&flux.across(&AIR, r, l, &-*n).times(-1.0), &found, &[l, r])?;
    let turned = flux.across(&AIR, &turn.state(l), &turn.state(r), &turn.of(n));
    same(&turned, &turn.flux(&found), &[l, r])
}

fn every_upwind<const D: usize>(at: &(Primitive<D>, Primitive<D>, Vector<D>, Turn<D>)) -> TestCaseResult {
    upwind(Hllc, at)?;
    upwind(Roe, at)?;
    upwind(AusmPlusUp, at)?;
    upwind(Rusanov, at)
}

proptest! {
    #![proptest_config(tried(512))]
    #[test]
    fn every_upwind_flux_is_consistent_conservative_and_blind_to_axes(
        plane in (state::<2>(), state::<2>(), direction::<2>(), Turn::<2>::any()),
        solid in (state::<3>(), state::<3>(), direction::<3>(), Turn::<3>::any()),
    ) {
        every_upwind(&plane)?;
        every_upwind(&solid)?;
    }
}

/// Two ends, what they share, and a turn of all of it.
#[derive(Clone, Debug)]
struct Pair<const D: usize> {
    ends: [EdgeEnd<D>; 2],
    face: EdgeFace<D>,
    turn: Turn<D>,
}

impl<const D: usize> Pair<D> {
    fn any() -> impl Strategy<Value = Self> {
        let end = || {
            (state(), gradient(), 0.0..=1.0, vector(1.0), vector(0.5)).prop_map(
                |(state, gradient, steepness, weight, velocity)| EdgeEnd {
                    state,
                    gradient,
                    steepness,
                    weight,
                    velocity,
                },
            )
        };
        let face = (direction(), vector(1.0), select(vec![0.0, 1.0])).prop_map(|(along, area, whole)| EdgeFace {
            along: along * 0.3,
            area,
            whole,
        });
        (end(), end(), face, Turn::any()).prop_map(|(a, b, face, turn)| Self { ends: [a, b], face, turn })
    }
}

/// Choices of a scheme: second order, correction at low Mach number, conservative, by faces, viscous.
type Ways = [bool; 5];

fn scheme(flux: Flux, limit: Limiter, [second_order, low_mach, conservative, by_faces, viscous]: Ways) -> FluxScheme {
    let reconstruction = Reconstruction { second_order, kappa: 1.0 / 3.0, threshold: 0.02, low_mach };
    FluxScheme { gas: AIR, flux, limit, reconstruction, conservative, by_faces, medium: viscous.then_some(OIL) }
}

fn edge<const D: usize>(scheme: &FluxScheme, at: &Pair<D>, blind: bool) -> TestCaseResult {
    let ([a, b], face) = (&at.ends, &at.face);
    let states = [&a.state, &b.state];
    let [i, j] = edge_flux(scheme, [a, b], face);
    // the same seen from the other end
    let [back_j, back_i] = edge_flux(scheme, [b, a], &EdgeFace { along: -face.along, area: -face.area, ..*face });
    same(&back_i, &i, &states)?;
    same(&back_j, &j, &states)?;
    // two ends alike add nothing, however they move
    let alike = [a, b].map(|e| EdgeEnd { state: a.state, gradient: Gradient::ZERO, ..*e });
    for nothing in edge_flux(scheme, [&alike[0], &alike[1]], face) {
        same(&nothing, &Conserved::ZERO, &[&a.state])?;
    }
    // what one end loses the other gains, but for the fluxes of both themselves, which add up to nothing around a particle
    let still = [a, b].map(|e| EdgeEnd { velocity: Vector::ZERO, ..*e });
    if scheme.conservative {
        let [i, j] = edge_flux(scheme, [&still[0], &still[1]], face);
        let own = AIR.flux(&a.state, &face.area).minus(&AIR.flux(&b.state, &face.area));
        same(&i.plus(1.0, &j), &own, &states)?;
    }
    if blind {
        let ends = [a, b].map(|e| at.turn.end(e));
        let turned = EdgeFace { along: at.turn.of(&face.along), area: at.turn.of(&face.area), ..*face };
        let [turned_i, turned_j] = edge_flux(scheme, [&ends[0], &ends[1]], &turned);
        same(&turned_i, &at.turn.flux(&i), &states)?;
        same(&turned_j, &at.turn.flux(&j), &states)?;
    }
    Ok(())
}

fn every_edge<const D: usize>(ways: Ways, at: &Pair<D>) -> TestCaseResult {
    // limiters look at velocities by their components, so that only without one turned axes see the same
    edge(&scheme(Flux::Hllc, Limiter::None, ways), at, true)?;
    edge(&scheme(Flux::Roe, Limiter::None, ways), at, true)?;
    edge(&scheme(Flux::AusmPlusUp, Limiter::None, ways), at, true)?;
    edge(&scheme(Flux::Rusanov, Limiter::None, ways), at, true)?;
    edge(&scheme(Flux::Hllc, Limiter::VanAlbada, ways), at, !ways[0])?;
    edge(&scheme(Flux::Roe, Limiter::Venkatakrishnan, ways), at, !ways[0])
}

proptest! {
    #![proptest_config(tried(512))]
    #[test]
    fn every_edge_flux_is_consistent_the_same_from_both_ends_and_blind_to_axes(
        ways in any::<Ways>(), plane in Pair::<2>::any(), solid in Pair::<3>::any(),
    ) {
        every_edge(ways, &plane)?;
        every_edge(ways, &solid)?;
    }
}

/// Slopes along an edge from the differences a = 2g − Δq that limiters compare.
fn slopes<const D: usize>(a: &Primitive<D>, dq: &Primitive<D>) -> Primitive<D> {
    Primitive::zip(a, dq, |a, dq| 0.5 * (a + dq))
}

fn numbers<const D: usize>(q: &Primitive<D>) -> Vec<f64> {
    [q.density, q.pressure].into_iter().chain(q.velocity.0).collect()
}

/// Fails unless the states at the middle of the edge from `l` to `r` lie between both, with `a` the upwind differences.
fn between<L: Limit>(limit: L, [l, r]: [&Primitive<3>; 2], a: [Primitive<3>; 2]) -> TestCaseResult {
    let reconstruction = Reconstruction { second_order: true, kappa: 0.0, threshold: 0.0, low_mach: false };
    let dq = r.minus(l);
    let along = a.map(|a| slopes(&a, &dq));
    let (left, right) = reconstruction.states(&AIR, limit, (l, r), (&along[0], &along[1]));
    for q in [left, right] {
        for (q, (l, r)) in numbers(&q).into_iter().zip(numbers(l).into_iter().zip(numbers(r))) {
            prop_assert!(l.min(r) - ROUND_OFF <= q && q <= l.max(r) + ROUND_OFF, "{q} is not between {l} and {r}");
        }
    }
    Ok(())
}

/// Fails unless linear data have the mean of both ends at the middle.
fn linear<L: Limit>(limit: L, (kappa, threshold): (f64, f64), [l, r]: [&Primitive<3>; 2]) -> TestCaseResult {
    let reconstruction = Reconstruction { second_order: true, kappa, threshold, low_mach: false };
    let dq = r.minus(l);
    let (left, right) = reconstruction.states(&AIR, limit, (l, r), (&dq, &dq));
    let mean = numbers(&l.plus(0.5, &dq));
    for q in [left, right] {
        let miss = largest(numbers(&q).iter().zip(&mean).map(|(a, b)| a - b));
        prop_assert!(miss <= ROUND_OFF, "{q:?} {mean:?}");
    }
    Ok(())
}

/// Fails unless factors lie between 0 and 1, and differ from 1 by `lost` at most where the data are linear.
fn factors(limit: impl Limit, (a, b, eps): ([f64; 2], f64, f64), lost: f64) -> TestCaseResult {
    for s in limit.factors(a, b, eps) {
        prop_assert!((0.0..=1.0).contains(&s), "{s}");
    }
    for s in limit.factors([b, b], b, eps) {
        prop_assert!(s >= 1.0 - lost - ROUND_OFF, "{s}");
    }
    Ok(())
}

proptest! {
    #![proptest_config(tried(256))]
    #[test]
    fn limiters_are_factors_that_leave_linear_data_alone(
        numbers in ([-10.0..10.0f64, -10.0..10.0f64], -10.0..10.0f64, 1e-6..1.0f64),
        ends in (state::<3>(), state::<3>()), scheme in (-1.0..1.0f64, 0.0..1.0f64),
    ) {
        factors(VanAlbada, numbers, 0.0)?;
        factors(Unlimited, numbers, 0.0)?;
        // that of Venkatakrishnan does so below the threshold only, above it a quarter is lost
        let (_, b, eps) = numbers;
        factors(Venkatakrishnan, numbers, (b * b / eps).min(0.25))?;
        // pressures that differ by more than a factor of 2 are taken for those of a shock
        let (l, mut r) = ends;
        r.pressure = r.pressure.clamp(0.5 * l.pressure, 2.0 * l.pressure);
        let ends = [&l, &r];
        linear(VanAlbada, scheme, ends)?;
        // where nothing varies there is nothing to compare, with or without a threshold
        linear(VanAlbada, (scheme.0, 0.0), [ends[0]; 2])?;
        linear(Venkatakrishnan, (scheme.0, 0.0), [ends[0]; 2])?;
        linear(Unlimited, scheme, ends)?;
    }

    #[test]
    fn limited_states_lie_between_their_ends(
        l in state::<3>(), r in state::<3>(), a in [state::<3>(), state::<3>()], ratio in [-1.0..9.0f64, -1.0..9.0f64],
    ) {
        between(Venkatakrishnan, [&l, &r], [a[0].minus(&l), a[1].minus(&r)])?;
        // the function of van Albada and others lets a little pass where the upwind difference is far greater, or opposite
        let dq = r.minus(&l);
        between(VanAlbada, [&l, &r], ratio.map(|t| Primitive::zip(&dq, &dq, |d, _| t * d)))?;
    }

    #[test]
    fn reconstructed_states_are_physical(ends in [state::<3>(), state::<3>()], steep in [gradient::<3>(), gradient::<3>()]) {
        let along = steep.map(|g| g.along(&Vector([20.0, -10.0, 5.0])));
        let reconstruction = Reconstruction { second_order: true, kappa: 0.0, threshold: 1.0, low_mach: false };
        let (l, r) = reconstruction.states(&AIR, Unlimited, (&ends[0], &ends[1]), (&along[0], &along[1]));
        prop_assert!(l.is_physical() && r.is_physical(), "{l:?} {r:?}");
    }
}

/// A jittered cloud of two levels in the unit box, refined further around points.
#[derive(Clone, Debug)]
struct Filled {
    spacing: f64,
    jitter: f64,
    corner: Vec<f64>,
    points: Vec<Vec<f64>>,
}

impl Filled {
    fn any(dimension: usize) -> impl Strategy<Value = Self> {
        let spacing = if dimension == 2 { vec![0.125, 0.1] } else { vec![0.25, 0.2] };
        let points = vec(vec(0.0..1.0f64, dimension), 0..3);
        (select(spacing), 0.0..0.35f64, vec(0.0..0.6f64, dimension), points)
            .prop_map(|(spacing, jitter, corner, points)| Self { spacing, jitter, corner, points })
    }

    fn text(&self) -> String {
        let (d, h) = (self.corner.len(), self.spacing);
        let list = |v: &[f64]| v.iter().map(f64::to_string).collect::<Vec<String>>().join(", ");
        let far: Vec<f64> = self.corner.iter().map(|c| c + 0.4).collect();
        format!(
            "title = \"box\"\ndimension = {d}\n[flow]\nmach = 0.5\n[cloud]\nspacing = {h}\njitter = {}\n[cloud.domain]\n\
             min = [{}]\nmax = [{}]\n[[cloud.box]]\nmin = [{}]\nmax = [{}]\nspacing = {}\n",
            self.jitter,
            list(&vec![0.0; d]),
            list(&vec![1.0; d]),
            list(&self.corner),
            list(&far),
            0.5 * h
        )
    }

    fn cloud<const D: usize>(&self) -> Cloud<D> {
        let source = |x: &Vec<f64>| Source { x: Vector::from_fn(|d| x[d]), spacing: 0.5 * self.spacing, layers: 3.0 };
        let sources: Vec<Source<D>> = self.points.iter().map(source).collect();
        Cloud::build(&CloudSpec::of_case(&case(&self.text())), None, &sources).unwrap()
    }
}

/// Largest error of the gradient of a field, over `scale` of the spacing there.
fn gradient_error<const D: usize>(
    cloud: &Cloud<D>,
    (field, slope): (impl Fn(&Vector<D>) -> f64, impl Fn(&Vector<D>) -> Vector<D>),
    scale: impl Fn(f64) -> f64,
) -> f64 {
    let values: Vec<f64> = cloud.x.iter().map(field).collect();
    let found = Operators::new(cloud).gradient(cloud, &values);
    let error = |(i, g): (usize, &Vector<D>)| (*g - slope(&cloud.x[i])).max_abs() / scale(cloud.spacing[i]);
    let fitted = |i: usize| cloud.first_order.binary_search(&(i as u32)).is_err();
    largest(found.iter().enumerate().filter(|(i, _)| fitted(*i)).map(error))
}

fn differentiates<const D: usize>(filled: &Filled, a: Vector<D>, bend: &[Vector<D>]) -> TestCaseResult {
    let cloud = filled.cloud::<D>();
    prop_assert!(cloud.first_order.is_empty());
    let linear = gradient_error(&cloud, (|x| 2.0 + a.dot(x), |_| a), |_| 1.0);
    prop_assert!(linear <= ROUND_OFF, "linear: {linear:e}");
    // x·Hx/2 with a symmetric H of entries below 1: first order, so that the error is some tenths of the spacing
    let row = |r: usize| Vector::from_fn(|c| 0.5 * (bend[r][c] + bend[c][r]));
    let slope = |x: &Vector<D>| Vector::from_fn(|r| row(r).dot(x));
    let quadratic = gradient_error(&cloud, (|x| 0.5 * slope(x).dot(x), slope), |h| h);
    prop_assert!(quadratic <= 0.5 * D as f64, "quadratic: {quadratic}");
    Ok(())
}

proptest! {
    #![proptest_config(tried(64))]
    #[test]
    fn gradients_are_exact_for_linear_fields_and_near_for_others_on_any_cloud(
        plane in (Filled::any(2), vector::<2>(1.0), vec(vector::<2>(1.0), 2)),
        solid in (Filled::any(3), vector::<3>(1.0), vec(vector::<3>(1.0), 3)),
    ) {
        differentiates(&plane.0, plane.1, &plane.2)?;
        differentiates(&solid.0, solid.1, &solid.2)?;
    }
}

/// Numbers between 0 and 1 that look random.
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut z = seed;
    move || {
        z = z.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (z >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// Fails unless mass and energy are kept in a box that repeats, and all the momentum goes into the walls in it.
fn keeps<const D: usize>(filled: &Filled, body: &str, (flux, limiter): (Flux, Limiter), seed: u64) -> TestCaseResult {
    let sides: String =
        ["x", "y", "z"][..D].iter().map(|a| format!("{a}_min = \"periodic\"\n{a}_max = \"periodic\"\n")).collect();
    let text = format!("{}[scheme]\nconservative = true\n[boundary]\n{sides}{body}", filled.text());
    let (mut fluid, mut u) = solver::<D>(&text);
    (fluid.flux, fluid.limiter) = (flux, limiter);
    let mut next = noise(seed);
    for row in u.chunks_exact_mut(n_variables(D)) {
        let (density, pressure) = (0.5 + next(), 0.5 + next());
        let velocity = Vector::<D>::from_fn(|_| 2.0 * next() - 1.0);
        fluid.gas.conserved(&Primitive { density, velocity, pressure }).store(row);
    }
    let (frame, mut work, mut du) = (fluid.frame(&Instant::still(0.0), &u), fluid.work(), vec![0.0; u.len()]);
    fluid.rhs(&frame, &u, &mut work, &mut du);
    let (mut sum, mut size) = (Conserved::<D>::ZERO, 0.0);
    for (row, volume) in du.chunks_exact(n_variables(D)).zip(&fluid.discretisation.cloud.volume) {
        let change = Conserved::<D>::load(row);
        sum = sum.plus(*volume, &change);
        size += volume * change.density.abs().max(change.momentum.max_abs()).max(change.energy.abs());
    }
    let operators = &fluid.discretisation.operators;
    for face in (0..operators.n_fluid_parts).flat_map(|k| operators.wall_faces(k)) {
        sum.momentum += face.area * work.state[face.wall as usize].pressure;
    }
    let left = sum.density.abs().max(sum.momentum.max_abs()).max(sum.energy.abs());
    prop_assert!(size > 0.1 && left <= ROUND_OFF * (1.0 + size), "{left:e} of {size}: {sum:?}");
    Ok(())
}

proptest! {
    #![proptest_config(tried(24))]
    #[test]
    fn conservative_schemes_keep_what_they_should_in_a_box_that_repeats(
        plane in Filled::any(2), solid in Filled::any(3), seed in any::<u64>(),
        flux in select(vec![Flux::Hllc, Flux::Roe, Flux::AusmPlusUp, Flux::Rusanov]),
        limiter in select(vec![Limiter::None, Limiter::VanAlbada, Limiter::Venkatakrishnan]),
    ) {
        let scheme = (flux, limiter);
        keeps::<2>(&plane, "", scheme, seed)?;
        keeps::<2>(&plane, "[[body]]\ncircle = { radius = 0.2 }\ntranslate = [0.5, 0.5]\n", scheme, seed)?;
        keeps::<3>(&solid, "", scheme, seed)?;
    }
}

/// A wall of any shape that moves and turns, and gas in front of it: weights that add up to one, and states.
type Front<const D: usize> = (Wall<D>, Vec<(f64, Primitive<D>)>);

fn front<const D: usize>() -> impl Strategy<Value = Front<D>> {
    let wall = (direction(), vec(vector(1.0), D), -0.2..0.2f64, vector(1.0), vec(vector(0.5), D), vector(0.5));
    let wall = wall.prop_map(
        |(normal, bend, offset, velocity, turn, acceleration): (Vector<D>, Vec<Vector<D>>, _, _, _, _)| {
            // symmetric, and along the wall
            let flat = |x: Vector<D>| x - normal * x.dot(&normal);
            let times =
                |x: Vector<D>| Vector::from_fn(|r| (0..D).map(|c| 0.5 * (bend[r][c] + bend[c][r]) * x[c]).sum::<f64>());
            let curvature = std::array::from_fn(|r| flat(times(flat(Vector::axis(r)))));
            let motion = WallMotion { wall_velocity_gradient: std::array::from_fn(|r| turn[r]), acceleration };
            Wall { normal, curvature, offset, velocity, motion: Some(motion) }
        },
    );
    (wall, vec((-0.5..1.0f64, state()), 3)).prop_map(|(wall, mut front)| {
        front[2].0 = 1.0 - front[0].0 - front[1].0;
        (wall, front)
    })
}

fn nothing_passes<const D: usize>((wall, front): &Front<D>) -> TestCaseResult {
    let slides = slip_wall(&AIR, wall, front.iter().copied());
    let through = (slides.velocity - wall.velocity).dot(&wall.normal);
    prop_assert!(through.abs() <= ROUND_OFF && slides.is_physical(), "{through:e} {slides:?}");
    let sticks = no_slip_wall(&AIR, wall, None, front.iter().copied());
    prop_assert!(sticks.velocity == wall.velocity && sticks.is_physical(), "{sticks:?}");
    Ok(())
}

/// Uniform flow along a wall that is flat and moves uniformly.
fn uniform_flow_stays<const D: usize>((wall, front): &Front<D>) -> TestCaseResult {
    let wall = Wall { curvature: [Vector::ZERO; D], motion: None, ..*wall };
    let q = front[0].1;
    let relative = q.velocity - wall.velocity;
    let q = Primitive { velocity: q.velocity - wall.normal * relative.dot(&wall.normal), ..q };
    let found = slip_wall(&AIR, &wall, front.iter().map(|f| (f.0, q))).minus(&q);
    let miss = found.density.abs().max(found.velocity.max_abs()).max(found.pressure.abs());
    prop_assert!(miss <= 10.0 * ROUND_OFF, "{miss:e}");
    Ok(())
}

proptest! {
    #![proptest_config(tried(512))]
    #[test]
    fn nothing_passes_a_wall_and_uniform_flow_along_it_stays(plane in front::<2>(), solid in front::<3>()) {
        nothing_passes(&plane)?;
        nothing_passes(&solid)?;
        uniform_flow_stays(&plane)?;
        uniform_flow_stays(&solid)?;
    }
}
