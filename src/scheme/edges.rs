//! The fluxes across the edges of a part, many at a time.
//!
//! What the two ends of some edges hold is gathered into arrays, one number of every edge after the other; a loop without
//! branches then computes all of them, which the compiler turns into vector instructions; what comes out is added to the
//! rows of the part in the order of the edges. The sums are therefore the same as those of one edge at a time.
use multiversion::multiversion;

use crate::cloud::Edge;
use crate::math::Vector;
use crate::physics::riemann::UpwindFlux;
use crate::physics::{Conserved, Gas, Primitive};

use super::reconstruct::{Gradient, Limit, Reconstruction};

/// Edges that are computed together: enough to fill vectors, few enough that all of it stays in the first cache.
const LANES: usize = 16;

type Lanes = [f64; LANES];

/// What the fluxes need to know of the scheme.
#[derive(Clone, Copy)]
pub struct Rule<F, L> {
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
}

/// `D` + 2 numbers of every edge.
struct Many<const D: usize> {
    first: Lanes,
    vector: [Lanes; D],
    last: Lanes,
}

impl<const D: usize> Many<D> {
    const ZERO: Self = Self { first: [0.0; LANES], vector: [[0.0; LANES]; D], last: [0.0; LANES] };

    #[inline(always)]
    fn primitive(&self, k: usize) -> Primitive<D> {
        Primitive { density: self.first[k], velocity: take(&self.vector, k), pressure: self.last[k] }
    }

    #[inline(always)]
    fn conserved(&self, k: usize) -> Conserved<D> {
        Conserved { density: self.first[k], momentum: take(&self.vector, k), energy: self.last[k] }
    }

    #[inline(always)]
    fn put(&mut self, k: usize, first: f64, vector: &Vector<D>, last: f64) {
        self.first[k] = first;
        put(&mut self.vector, k, vector);
        self.last[k] = last;
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
    own: [Many<D>; 2],
    slope: [Many<D>; 2],
    /// −V a of either end, the area vector s, and the velocities of the ends.
    weight: [[Lanes; D]; 2],
    area: [Lanes; D],
    speed: [[Lanes; D]; 2],
    out: [Many<D>; 2],
}

impl<const D: usize> Batch<D> {
    const BLANK: Self = Self {
        own: [Many::ZERO; 2],
        slope: [Many::ZERO; 2],
        weight: [[[0.0; LANES]; D]; 2],
        area: [[0.0; LANES]; D],
        speed: [[[0.0; LANES]; D]; 2],
        out: [Many::ZERO; 2],
    };
}

/// Calls `add(i, change)` with what every edge adds to V dU/dt of its ends, one edge after the other.
pub fn edge_fluxes<const D: usize, F: UpwindFlux<D>, L: Limit>(
    rule: &Rule<F, L>,
    particles: Particles<'_, D>,
    edges: &[Edge<D>],
    mut add: impl FnMut(usize, &Conserved<D>),
) {
    let mut batch = Batch::BLANK;
    for some in edges.chunks(LANES) {
        gather(rule, &particles, some, &mut batch);
        match (particles.velocity.is_empty(), rule.conservative) {
            (true, true) => compute::<D, F, L, false, true>(rule, &mut batch),
            (true, false) => compute::<D, F, L, false, false>(rule, &mut batch),
            (false, true) => compute::<D, F, L, true, true>(rule, &mut batch),
            (false, false) => compute::<D, F, L, true, false>(rule, &mut batch),
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
fn gather<const D: usize, F, L>(rule: &Rule<F, L>, p: &Particles<'_, D>, edges: &[Edge<D>], batch: &mut Batch<D>) {
    for (k, e) in edges.iter().enumerate() {
        let ends = [e.i(), e.j()];
        let d = p.x[ends[1]] - p.x[ends[0]];
        let weights = [&e.a_i, &e.a_j];
        for side in 0..2 {
            let i = ends[side];
            let q = &p.state[i];
            batch.own[side].put(k, q.density, &q.velocity, q.pressure);
            if rule.reconstruction.second_order {
                let g = p.gradient[i].along(&d);
                batch.slope[side].put(k, g.density, &g.velocity, g.pressure);
            }
            if !rule.conservative {
                put(&mut batch.weight[side], k, &(*weights[side] * -p.volume[i]));
            }
            if !p.velocity.is_empty() {
                put(&mut batch.speed[side], k, &p.velocity[i]);
            }
        }
        put(&mut batch.area, k, &e.s);
    }
}

/// Compiled for vectors of four numbers as well as for the plainest processor; the same operations in both, so the same bits.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn compute<const D: usize, F: UpwindFlux<D>, L: Limit, const MOVES: bool, const CONSERVATIVE: bool>(
    rule: &Rule<F, L>,
    batch: &mut Batch<D>,
) {
    let Batch { own, slope, weight, area, speed, out } = batch;
    let ([own_i, own_j], [out_i, out_j]) = (own, out);
    for k in 0..LANES {
        let ends = (own_i.primitive(k), own_j.primitive(k));
        let slopes = (slope[0].primitive(k), slope[1].primitive(k));
        let weights = (take(&weight[0], k), take(&weight[1], k));
        let speeds = (take(&speed[0], k), take(&speed[1], k));
        let (i, j) = rule.flux::<D, MOVES, CONSERVATIVE>(ends, slopes, &take(area, k), weights, speeds);
        out_i.put(k, i.density, &i.momentum, i.energy);
        out_j.put(k, j.density, &j.momentum, j.energy);
    }
}

impl<F, L: Limit> Rule<F, L> {
    /// What one edge adds to V dU/dt of both ends.
    #[inline(always)]
    fn flux<const D: usize, const MOVES: bool, const CONSERVATIVE: bool>(
        &self,
        (qi, qj): (Primitive<D>, Primitive<D>),
        slopes: (Primitive<D>, Primitive<D>),
        s: &Vector<D>,
        (a_i, a_j): (Vector<D>, Vector<D>),
        (wi, wj): (Vector<D>, Vector<D>),
    ) -> (Conserved<D>, Conserved<D>)
    where
        F: UpwindFlux<D>,
    {
        let gas = &self.gas;
        let (l, r) = self.reconstruction.states(gas, self.limit, (&qi, &qj), (&slopes.0, &slopes.1));
        let size = s.norm();
        let m = *s * (1.0 / size.max(f64::MIN_POSITIVE));
        let past = |q: &Primitive<D>, n: &Vector<D>, w: &Vector<D>| match MOVES {
            true => gas.flux(q, n).plus(-w.dot(n), &gas.conserved(q)),
            false => gas.flux(q, n),
        };
        let w = (wi + wj) * 0.5;
        let upwind = match MOVES {
            true => self.upwind_past(&l, &r, &m, &w),
            false => self.flux.across(gas, &l, &r, &m),
        };
        if CONSERVATIVE {
            let through = upwind.times(size);
            let (to_i, to_j) = (past(&qi, s, &wi), past(&qj, s, &wj));
            let (mut seen_i, mut seen_j) = (through, through);
            if MOVES {
                let mean = gas.conserved(&l).plus(1.0, &gas.conserved(&r)).times(0.5);
                seen_i = through.plus((w - wi).dot(s), &mean);
                seen_j = through.plus((w - wj).dot(s), &mean);
            }
            return (to_i.plus(-1.0, &seen_i), seen_j.plus(-1.0, &to_j));
        }
        let mean = past(&l, &m, &w).plus(1.0, &past(&r, &m, &w));
        let spread = upwind.plus(-0.5, &mean).times(size);
        let central = |a: &Vector<D>, own: &Primitive<D>, w: &Vector<D>| {
            past(&l, a, w).plus(1.0, &past(&r, a, w)).plus(-2.0, &past(own, a, w))
        };
        (central(&a_i, &qi, &wi).plus(-1.0, &spread), central(&a_j, &qj, &wj).plus(1.0, &spread))
    }

    /// The upwind flux through an area that moves with `w`, by way of the axes in which it rests.
    #[inline(always)]
    fn upwind_past<const D: usize>(
        &self,
        l: &Primitive<D>,
        r: &Primitive<D>,
        m: &Vector<D>,
        w: &Vector<D>,
    ) -> Conserved<D>
    where
        F: UpwindFlux<D>,
    {
        let seen = |q: &Primitive<D>| Primitive { velocity: q.velocity - *w, ..*q };
        let f = self.flux.across(&self.gas, &seen(l), &seen(r), m);
        let energy = f.energy + w.dot(&f.momentum) + 0.5 * w.norm_squared() * f.density;
        Conserved { momentum: f.momentum + *w * f.density, energy, ..f }
    }
}
