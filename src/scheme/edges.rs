//! The fluxes across the edges of a part, many at a time.
//!
//! What the two ends of some edges hold is gathered into arrays, one number of every edge after the other; a loop without
//! branches then computes all of them, which the compiler turns into vector instructions; what comes out is added to the
//! rows of the part in the order of the edges. The sums are therefore the same as those of one edge at a time.
use multiversion::multiversion;

use crate::cloud::Edge;
use crate::math::Vector;
use crate::physics::riemann::UpwindFlux;
use crate::physics::{Conserved, Gas, Newtonian, Primitive};

use super::reconstruct::{Gradient, Limit, Reconstruction, low_mach_correction};
use super::viscous::{direction, middle, slopes};

/// Edges that are computed together: enough to fill vectors, few enough that all of it stays in the first cache.
const LANES: usize = 16;

type Lanes = [f64; LANES];

/// What the fluxes need to know of the scheme.
#[derive(Clone, Copy)]
pub struct FluxScheme<F, L> {
    /// Gas.
    pub gas: Gas,
    /// Upwind flux.
    pub flux: F,
    /// Limiter.
    pub limit: L,
    /// Order, κ, threshold.
    pub reconstruction: Reconstruction,
    /// Exactly conservative coefficients.
    pub conservative: bool,
    /// Those also for what a moving particle passes.
    pub by_faces: bool,
    /// Viscosity and heat conduction.
    pub medium: Option<Newtonian>,
}

/// What particles hold.
#[derive(Clone, Copy)]
pub struct Particles<'a, const D: usize> {
    /// Places.
    pub x: &'a [Vector<D>],
    /// Volumes.
    pub volume: &'a [f64],
    /// States.
    pub state: &'a [Primitive<D>],
    /// Gradients.
    pub gradient: &'a [Gradient<D>],
    /// Velocities of the particles themselves; empty when none moves.
    pub velocity: &'a [Vector<D>],
    /// The outer ones: waves leave through them, which takes the whole jump of the velocity.
    pub outer: (usize, usize),
}

/// The `D` + 2 numbers of a state or a flux of every edge: density, velocity or momentum, pressure or energy.
struct StateLanes<const D: usize> {
    density: Lanes,
    vector: [Lanes; D],
    energy: Lanes,
}

impl<const D: usize> StateLanes<D> {
    const ZERO: Self = Self { density: [0.0; LANES], vector: [[0.0; LANES]; D], energy: [0.0; LANES] };

    #[inline(always)]
    fn primitive(&self, k: usize) -> Primitive<D> {
        Primitive { density: self.density[k], velocity: take(&self.vector, k), pressure: self.energy[k] }
    }

    #[inline(always)]
    fn conserved(&self, k: usize) -> Conserved<D> {
        Conserved { density: self.density[k], momentum: take(&self.vector, k), energy: self.energy[k] }
    }

    #[inline(always)]
    fn put(&mut self, k: usize, density: f64, vector: &Vector<D>, energy: f64) {
        self.density[k] = density;
        put(&mut self.vector, k, vector);
        self.energy[k] = energy;
    }
}

#[inline(always)]
fn take<const D: usize>(lanes: &[Lanes; D], k: usize) -> Vector<D> {
    Vector::from_fn(|d| lanes[d][k])
}

#[inline(always)]
fn put<const D: usize>(lanes: &mut [Lanes; D], k: usize, v: &Vector<D>) {
    for d in 0..D {
        lanes[d][k] = v[d];
    }
}

/// Some edges with what their ends hold, and what they add to V dU/dt of both.
struct Batch<const D: usize> {
    own: [StateLanes<D>; 2],
    slope: [StateLanes<D>; 2],
    /// −V a of either end, the area vector s, and the velocities of the ends.
    weight: [[Lanes; D]; 2],
    area: [Lanes; D],
    speed: [[Lanes; D]; 2],
    /// Least part of the jump of the normal velocity that counts: 1 beside outer particles.
    whole: Lanes,
    /// States on both sides of the middle, the upwind flux there per unit of area, and the result.
    middle: [StateLanes<D>; 2],
    upwind: StateLanes<D>,
    out: [StateLanes<D>; 2],
    /// The edge from one end to the other, and the gradients at both; for stress and heat alone.
    along: [Lanes; D],
    gradient: [Slope<D>; 2],
}

/// Gradients of density, velocity and pressure of every edge.
struct Slope<const D: usize> {
    density: [Lanes; D],
    velocity: [[Lanes; D]; D],
    pressure: [Lanes; D],
}

impl<const D: usize> Slope<D> {
    const ZERO: Self =
        Self { density: [[0.0; LANES]; D], velocity: [[[0.0; LANES]; D]; D], pressure: [[0.0; LANES]; D] };

    #[inline(always)]
    fn take(&self, k: usize) -> Gradient<D> {
        Gradient {
            density: take(&self.density, k),
            velocity: std::array::from_fn(|c| take(&self.velocity[c], k)),
            pressure: take(&self.pressure, k),
        }
    }

    #[inline(always)]
    fn put(&mut self, k: usize, g: &Gradient<D>) {
        put(&mut self.density, k, &g.density);
        for c in 0..D {
            put(&mut self.velocity[c], k, &g.velocity[c]);
        }
        put(&mut self.pressure, k, &g.pressure);
    }
}

impl<const D: usize> Batch<D> {
    const BLANK: Self = Self {
        own: [StateLanes::ZERO; 2],
        slope: [StateLanes::ZERO; 2],
        weight: [[[0.0; LANES]; D]; 2],
        area: [[0.0; LANES]; D],
        speed: [[[0.0; LANES]; D]; 2],
        whole: [0.0; LANES],
        middle: [StateLanes::ZERO; 2],
        upwind: StateLanes::ZERO,
        out: [StateLanes::ZERO; 2],
        along: [[0.0; LANES]; D],
        gradient: [Slope::ZERO; 2],
    };
}

/// Calls `add(i, change)` with what every edge adds to V dU/dt of its ends, one edge after the other.
pub fn edge_fluxes<const D: usize, F: UpwindFlux<D>, L: Limit>(
    scheme: &FluxScheme<F, L>,
    particles: Particles<'_, D>,
    edges: &[Edge<D>],
    mut add: impl FnMut(usize, &Conserved<D>),
) {
    let mut batch = Batch::BLANK;
    for some in edges.chunks(LANES) {
        gather(scheme, &particles, some, &mut batch);
        reconstruct(scheme.gas, scheme.limit, scheme.reconstruction, &mut batch);
        if scheme.reconstruction.low_mach {
            low_mach_corrections(scheme.gas, &mut batch);
        }
        upwind_fluxes(scheme.gas, scheme.flux, &mut batch);
        match (particles.velocity.is_empty(), scheme.conservative) {
            (true, true) => accumulate_residual::<D, false, true>(scheme.gas, scheme.by_faces, &mut batch),
            (true, false) => accumulate_residual::<D, false, false>(scheme.gas, scheme.by_faces, &mut batch),
            (false, true) => accumulate_residual::<D, true, true>(scheme.gas, scheme.by_faces, &mut batch),
            (false, false) => accumulate_residual::<D, true, false>(scheme.gas, scheme.by_faces, &mut batch),
        }
        if let Some(medium) = scheme.medium {
            match scheme.conservative {
                true => viscous_fluxes::<D, true>(scheme.gas, medium, &mut batch),
                false => viscous_fluxes::<D, false>(scheme.gas, medium, &mut batch),
            }
        }
        for (k, e) in some.iter().enumerate() {
            add(e.i(), &batch.out[0].conserved(k));
            if e.both() {
                add(e.j(), &batch.out[1].conserved(k));
            }
        }
    }
}

#[inline(always)]
fn gather<const D: usize, F, L>(
    scheme: &FluxScheme<F, L>,
    p: &Particles<'_, D>,
    edges: &[Edge<D>],
    batch: &mut Batch<D>,
) {
    for (k, e) in edges.iter().enumerate() {
        let ends = [e.i(), e.j()];
        let d = p.x[ends[1]] - p.x[ends[0]];
        let weights = [&e.a_i, &e.a_j];
        for side in 0..2 {
            let i = ends[side];
            let q = &p.state[i];
            batch.own[side].put(k, q.density, &q.velocity, q.pressure);
            if scheme.medium.is_some() {
                batch.gradient[side].put(k, &p.gradient[i]);
            }
            if scheme.reconstruction.second_order {
                let g = p.gradient[i].along(&d);
                batch.slope[side].put(k, g.density, &g.velocity, g.pressure);
            }
            if !scheme.conservative || !p.velocity.is_empty() {
                put(&mut batch.weight[side], k, &(*weights[side] * -p.volume[i]));
            }
            if !p.velocity.is_empty() {
                put(&mut batch.speed[side], k, &p.velocity[i]);
            }
        }
        put(&mut batch.area, k, &e.s);
        put(&mut batch.along, k, &d);
        batch.whole[k] = f64::from(u8::from(p.outer.0 <= ends[1] && ends[1] < p.outer.1));
    }
}

// The loops below are compiled for vectors of four numbers as well as for the plainest processor: the same operations in both,
// so the same bits.

/// States on both sides of the middle of every edge.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn reconstruct<const D: usize, L: Limit>(gas: Gas, limit: L, reconstruction: Reconstruction, batch: &mut Batch<D>) {
    let Batch { own, slope, middle: [left, right], .. } = batch;
    for k in 0..LANES {
        let (qi, qj) = (own[0].primitive(k), own[1].primitive(k));
        let slopes = (slope[0].primitive(k), slope[1].primitive(k));
        let (l, r) = reconstruction.states(&gas, limit, (&qi, &qj), (&slopes.0, &slopes.1));
        left.put(k, l.density, &l.velocity, l.pressure);
        right.put(k, r.density, &r.velocity, r.pressure);
    }
}

/// Scales the jump of the normal velocity with the Mach number, seen from the mean velocity of the ends.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn low_mach_corrections<const D: usize>(gas: Gas, batch: &mut Batch<D>) {
    let Batch { area, speed, whole, middle: [left, right], .. } = batch;
    for k in 0..LANES {
        let m = normal(&take(area, k)).0;
        let w = (take(&speed[0], k) + take(&speed[1], k)) * 0.5;
        let seen = |q: Primitive<D>, w: Vector<D>| Primitive { velocity: q.velocity - w, ..q };
        let (l, r) = low_mach_correction(&gas, seen(left.primitive(k), w), seen(right.primitive(k), w), (&m, whole[k]));
        let (l, r) = (seen(l, -w), seen(r, -w));
        left.put(k, l.density, &l.velocity, l.pressure);
        right.put(k, r.density, &r.velocity, r.pressure);
    }
}

/// The upwind flux through an area that moves with the mean velocity of the ends, by way of the axes in which it rests.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn upwind_fluxes<const D: usize, F: UpwindFlux<D>>(gas: Gas, flux: F, batch: &mut Batch<D>) {
    let Batch { area, speed, middle: [left, right], upwind, .. } = batch;
    for k in 0..LANES {
        let m = normal(&take(area, k)).0;
        let w = (take(&speed[0], k) + take(&speed[1], k)) * 0.5;
        let seen = |q: Primitive<D>| Primitive { velocity: q.velocity - w, ..q };
        let f = flux.across(&gas, &seen(left.primitive(k)), &seen(right.primitive(k)), &m);
        let energy = f.energy + w.dot(&f.momentum) + 0.5 * w.norm_squared() * f.density;
        upwind.put(k, f.density, &(f.momentum + w * f.density), energy);
    }
}

/// What every edge adds to V dU/dt of both ends.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn accumulate_residual<const D: usize, const MOVES: bool, const CONSERVATIVE: bool>(
    gas: Gas,
    by_faces: bool,
    batch: &mut Batch<D>,
) {
    let Batch { own, weight, area, speed, middle, upwind, out: [out_i, out_j], .. } = batch;
    for k in 0..LANES {
        let (qi, qj) = (own[0].primitive(k), own[1].primitive(k));
        let (l, r) = (middle[0].primitive(k), middle[1].primitive(k));
        let s = take(area, k);
        let (m, size) = normal(&s);
        let (wi, wj) = (take(&speed[0], k), take(&speed[1], k));
        let (w, upwind) = ((wi + wj) * 0.5, upwind.conserved(k));
        let (a_i, a_j) = (take(&weight[0], k), take(&weight[1], k));
        let (i, j) = if CONSERVATIVE {
            let through = upwind.times(size);
            let (out_i, out_j) = (gas.flux(&qi, &s), gas.flux(&qj, &s));
            if MOVES {
                let mean = gas.conserved(&l).plus(1.0, &gas.conserved(&r)).times(0.5);
                let through = through.plus(w.dot(&s), &mean);
                // w·∇U: by the weights that are exact for linear fields, which come as −V a, or by those of the fluxes
                let (n_i, n_j) = if by_faces { (s, -s) } else { (a_i * -2.0, a_j * -2.0) };
                let swept_i = mean.plus(-1.0, &gas.conserved(&qi)).times(wi.dot(&n_i));
                let swept_j = mean.plus(-1.0, &gas.conserved(&qj)).times(wj.dot(&n_j));
                (out_i.plus(-1.0, &through).plus(1.0, &swept_i), through.plus(-1.0, &out_j).plus(1.0, &swept_j))
            } else {
                (out_i.plus(-1.0, &through), through.plus(-1.0, &out_j))
            }
        } else {
            let spread = upwind.plus(-0.5, &both::<D, MOVES>(&gas, (&l, &r), &m, &w)).times(size);
            let central_i = both::<D, MOVES>(&gas, (&l, &r), &a_i, &wi)
                .plus(-2.0, &relative_flux::<D, MOVES>(&gas, &qi, &a_i, &wi));
            let central_j = both::<D, MOVES>(&gas, (&l, &r), &a_j, &wj)
                .plus(-2.0, &relative_flux::<D, MOVES>(&gas, &qj, &a_j, &wj));
            (central_i.plus(-1.0, &spread), central_j.plus(1.0, &spread))
        };
        out_i.put(k, i.density, &i.momentum, i.energy);
        out_j.put(k, j.density, &j.momentum, j.energy);
    }
}

/// Flux of the state `q` through an area `n` that moves with `w`.
#[inline(always)]
fn relative_flux<const D: usize, const MOVES: bool>(
    gas: &Gas,
    q: &Primitive<D>,
    n: &Vector<D>,
    w: &Vector<D>,
) -> Conserved<D> {
    if MOVES { gas.flux(q, n).plus(-w.dot(n), &gas.conserved(q)) } else { gas.flux(q, n) }
}

/// The same of two states together.
#[inline(always)]
fn both<const D: usize, const MOVES: bool>(
    gas: &Gas,
    (l, r): (&Primitive<D>, &Primitive<D>),
    n: &Vector<D>,
    w: &Vector<D>,
) -> Conserved<D> {
    relative_flux::<D, MOVES>(gas, l, n, w).plus(1.0, &relative_flux::<D, MOVES>(gas, r, n, w))
}

/// What stress and heat along every edge add to V dU/dt of both ends.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn viscous_fluxes<const D: usize, const CONSERVATIVE: bool>(gas: Gas, medium: Newtonian, batch: &mut Batch<D>) {
    let Batch { own, weight, area, along, gradient, out: [out_i, out_j], .. } = batch;
    for k in 0..LANES {
        let (s, d) = (take(area, k), take(along, k));
        let a = slopes(&gas, &own[0].primitive(k), &gradient[0].take(k));
        let b = slopes(&gas, &own[1].primitive(k), &gradient[1].take(k));
        let middle = middle((&a, &b), &d, &direction(&s, &d));
        let (i, j) = if CONSERVATIVE {
            let through = medium.flux(&gas, &middle, &s);
            (through, through.times(-1.0))
        } else {
            // weights come as −V a
            let (n_i, n_j) = (take(&weight[0], k), take(&weight[1], k));
            let past_i = medium.flux(&gas, &a, &n_i).plus(-1.0, &medium.flux(&gas, &middle, &n_i));
            let past_j = medium.flux(&gas, &b, &n_j).plus(-1.0, &medium.flux(&gas, &middle, &n_j));
            (past_i.times(2.0), past_j.times(2.0))
        };
        let (i, j) = (out_i.conserved(k).plus(1.0, &i), out_j.conserved(k).plus(1.0, &j));
        out_i.put(k, i.density, &i.momentum, i.energy);
        out_j.put(k, j.density, &j.momentum, j.energy);
    }
}

/// Unit normal and size of an area; a normal of no length where there is none.
#[inline(always)]
fn normal<const D: usize>(s: &Vector<D>) -> (Vector<D>, f64) {
    let size = s.norm();
    (*s * (1.0 / size.max(f64::MIN_POSITIVE)), size)
}
