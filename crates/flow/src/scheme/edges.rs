//! Fluxes across the edges of a part, several edges at a time.
//!
//! The data of the two ends of several edges are gathered into arrays, in which each quantity is stored for all these
//! edges. A loop without branches computes all of them with the functions of `edge_flux`, which the compiler translates
//! to vector instructions. The results are added to the rows of the part in the order of the edges, so that the sums
//! equal those of a loop over single edges.
use multiversion::multiversion;

use crate::case::{Flux, Limiter};
use crate::cloud::{Edge, Weights};
use crate::math::Vector;
use crate::math::blocks::array;
use crate::physics::riemann::{AusmPlusUp, Hllc, Roe, Rusanov, UpwindFlux};
use crate::physics::{Conserved, Gas, Newtonian, Primitive};

use super::edge_flux::{FluxScheme, Passing, conservative, consistent, slowed, steep, upwind, viscous};
use super::lanes::{LANES, Lanes, Number, StateLanes, pair, put, put_all, take, take_all};
use super::reconstruct::{Factors, Gradient, Limit, Reconstruction, Unlimited, VanAlbada, Venkatakrishnan};
use super::viscous::slopes;

/// Data of the particles from which the fluxes are computed.
#[derive(Clone, Copy)]
pub struct Particles<'a, const D: usize, S = f64> {
    /// Positions.
    pub x: &'a [Vector<D>],
    /// Volumes.
    pub volume: &'a [f64],
    /// States.
    pub state: &'a [Primitive<D, S>],
    /// Gradients.
    pub gradient: &'a [Gradient<D, S>],
    /// Pressure sensor from 0 (smooth) to 1 (strong shock), see [`Gradient::steepness`].
    pub steepness: &'a [S],
    /// Velocities of the particles themselves; empty when none moves.
    pub velocity: &'a [Vector<D>],
    /// Range of the outer particles. Waves leave through them, for which the full jump of the normal velocity is
    /// necessary.
    pub outer: (usize, usize),
}

/// Several edges with the data of their ends and their contributions to V dU/dt at both ends.
struct Batch<const D: usize, S: Number> {
    own: [StateLanes<D, S>; 2],
    slope: [StateLanes<D, S>; 2],
    /// −V a of each end, the area vector s, and the velocities of the ends.
    weight: [[Lanes; D]; 2],
    area: [Lanes; D],
    speed: [[Lanes; D]; 2],
    /// Smallest factor on the jump of the normal velocity: 1 at outer particles.
    whole: Lanes,
    /// The greater pressure sensor of the two ends.
    steepness: S::Many,
    /// States on both sides of the midpoint, the upwind flux there per unit of area, and the result.
    middle: [StateLanes<D, S>; 2],
    upwind: StateLanes<D, S>,
    out: [StateLanes<D, S>; 2],
    /// Offset from the first end to the second, and the gradients at both; for viscous fluxes only.
    along: [Lanes; D],
    gradient: [Slope<D, S>; 2],
}

/// Gradients of density, velocity and pressure of every edge.
struct Slope<const D: usize, S: Number> {
    density: [S::Many; D],
    velocity: [[S::Many; D]; D],
    pressure: [S::Many; D],
}

impl<const D: usize, S: Number> Slope<D, S> {
    const ZERO: Self = Self { density: [S::NONE; D], velocity: [[S::NONE; D]; D], pressure: [S::NONE; D] };

    #[inline(always)]
    fn take(&self, k: usize) -> Gradient<D, S> {
        Gradient {
            density: take_all(&self.density, k),
            velocity: array(|c| take_all(&self.velocity[c], k)),
            pressure: take_all(&self.pressure, k),
        }
    }

    #[inline(always)]
    fn put(&mut self, k: usize, g: &Gradient<D, S>) {
        put_all(&mut self.density, k, &g.density);
        for c in 0..D {
            put_all(&mut self.velocity[c], k, &g.velocity[c]);
        }
        put_all(&mut self.pressure, k, &g.pressure);
    }
}

impl<const D: usize, S: Number> Batch<D, S> {
    const BLANK: Self = Self {
        own: [StateLanes::ZERO; 2],
        slope: [StateLanes::ZERO; 2],
        weight: [[[0.0; LANES]; D]; 2],
        area: [[0.0; LANES]; D],
        speed: [[[0.0; LANES]; D]; 2],
        whole: [0.0; LANES],
        steepness: S::NONE,
        middle: [StateLanes::ZERO; 2],
        upwind: StateLanes::ZERO,
        out: [StateLanes::ZERO; 2],
        along: [[0.0; LANES]; D],
        gradient: [Slope::ZERO; 2],
    };
}

/// Calls `add(i, change)` with the contribution of every edge to V dU/dt of its ends, one edge after the other.
/// `frozen` holds the limiter factors of the edges if they are given instead of computed.
pub fn edge_fluxes<const D: usize, S: Number>(
    scheme: &FluxScheme,
    particles: Particles<'_, D, S>,
    (edges, weights, frozen): (&[Edge<D>], Weights<'_, D>, &[Factors<D>]),
    add: &mut impl FnMut(usize, &Conserved<D, S>),
) {
    let mut batch = Batch::BLANK;
    for (c, some) in edges.chunks(LANES).enumerate() {
        gather(scheme, &particles, (some, c * LANES, &weights), &mut batch);
        match frozen.get(c * LANES..) {
            Some(own @ [_, ..]) => reconstruct_frozen(scheme.reconstruction, own, &mut batch),
            _ => match scheme.limit {
                Limiter::None => reconstruct(scheme.gas, Unlimited, scheme.reconstruction, &mut batch),
                Limiter::VanAlbada => reconstruct(scheme.gas, VanAlbada, scheme.reconstruction, &mut batch),
                Limiter::Venkatakrishnan => reconstruct(scheme.gas, Venkatakrishnan, scheme.reconstruction, &mut batch),
            },
        }
        if scheme.reconstruction.low_mach {
            low_mach_corrections(scheme.gas, &mut batch);
        }
        match scheme.flux {
            Flux::Hllc => upwind_fluxes(scheme.gas, Hllc, &mut batch),
            Flux::Roe => upwind_fluxes(scheme.gas, Roe, &mut batch),
            Flux::AusmPlusUp => upwind_fluxes(scheme.gas, AusmPlusUp, &mut batch),
            Flux::Rusanov => upwind_fluxes(scheme.gas, Rusanov, &mut batch),
        }
        if (0..LANES).any(|k| S::take(&batch.steepness, k).value() > 0.0) {
            steep_fluxes(scheme.gas, &mut batch);
        }
        match (particles.velocity.is_empty(), scheme.conservative) {
            (true, true) => accumulate_residual::<D, S, false, true>(scheme.gas, scheme.by_faces, &mut batch),
            (true, false) => accumulate_residual::<D, S, false, false>(scheme.gas, scheme.by_faces, &mut batch),
            (false, true) => accumulate_residual::<D, S, true, true>(scheme.gas, scheme.by_faces, &mut batch),
            (false, false) => accumulate_residual::<D, S, true, false>(scheme.gas, scheme.by_faces, &mut batch),
        }
        if let Some(medium) = scheme.medium {
            match scheme.conservative {
                true => viscous_fluxes::<D, S, true>(scheme.gas, medium, &mut batch),
                false => viscous_fluxes::<D, S, false>(scheme.gas, medium, &mut batch),
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

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn gather<const D: usize, S: Number>(
    scheme: &FluxScheme,
    p: &Particles<'_, D, S>,
    (edges, first, weights): (&[Edge<D>], usize, &Weights<'_, D>),
    batch: &mut Batch<D, S>,
) {
    let weighed = !scheme.conservative || !p.velocity.is_empty();
    for (k, e) in edges.iter().enumerate() {
        let ends = [e.i(), e.j()];
        let d = p.x[ends[1]] - p.x[ends[0]];
        let pair = if weighed { weights.of(first + k, e, &d) } else { [Vector::ZERO; 2] };
        for side in 0..2 {
            let i = ends[side];
            let q = &p.state[i];
            batch.own[side].put_primitive(k, q);
            if scheme.medium.is_some() {
                batch.gradient[side].put(k, &p.gradient[i]);
            }
            if scheme.reconstruction.second_order {
                let along = p.gradient[i].along(&Vector::constant(&d));
                batch.slope[side].put_primitive(k, &along.times(S::constant(1.0) - p.steepness[i]));
            }
            if weighed {
                put(&mut batch.weight[side], k, &(pair[side] * -p.volume[i]));
            }
            if !p.velocity.is_empty() {
                put(&mut batch.speed[side], k, &p.velocity[i]);
            }
        }
        put(&mut batch.area, k, &e.s);
        if scheme.medium.is_some() {
            put(&mut batch.along, k, &d);
        }
        p.steepness[ends[0]].max(p.steepness[ends[1]]).put(&mut batch.steepness, k);
        batch.whole[k] = f64::from(u8::from(p.outer.0 <= ends[1] && ends[1] < p.outer.1));
    }
}

// The loops below are compiled for vector registers of several sizes as well as for the baseline processor, with the
// same operations and hence the same bits.

/// Reconstructs the states on both sides of the midpoint of every edge.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn reconstruct<const D: usize, S: Number, L: Limit>(
    gas: Gas,
    limit: L,
    reconstruction: Reconstruction,
    batch: &mut Batch<D, S>,
) {
    let Batch { own, slope, middle: [left, right], .. } = batch;
    for k in 0..LANES {
        let (qi, qj) = (own[0].primitive(k), own[1].primitive(k));
        let slopes = (slope[0].primitive(k), slope[1].primitive(k));
        let (l, r) = reconstruction.states(&gas, limit, (&qi, &qj), (&slopes.0, &slopes.1));
        left.put_primitive(k, &l);
        right.put_primitive(k, &r);
    }
}

/// Reconstructs these states with given limiter factors.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn reconstruct_frozen<const D: usize, S: Number>(
    reconstruction: Reconstruction,
    frozen: &[Factors<D>],
    batch: &mut Batch<D, S>,
) {
    let Batch { own, slope, middle: [left, right], .. } = batch;
    for (k, factors) in frozen.iter().take(LANES).enumerate() {
        let (qi, qj) = (own[0].primitive(k), own[1].primitive(k));
        let slopes = (slope[0].primitive(k), slope[1].primitive(k));
        let factors = [Primitive::constant(&factors[0]), Primitive::constant(&factors[1])];
        let (l, r) = reconstruction.limited((&qi, &qj), (&slopes.0, &slopes.1), &factors);
        left.put_primitive(k, &l);
        right.put_primitive(k, &r);
    }
}

/// Applies the low-Mach-number correction to the jump of the normal velocity.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn low_mach_corrections<const D: usize, S: Number>(gas: Gas, batch: &mut Batch<D, S>) {
    let Batch { area, speed, whole, middle: [left, right], .. } = batch;
    for k in 0..LANES {
        let sides = [left.primitive(k), right.primitive(k)];
        let [l, r] = slowed(&gas, sides, (&take(area, k), whole[k]), &pair(speed, k));
        left.put_primitive(k, &l);
        right.put_primitive(k, &r);
    }
}

/// Computes the upwind flux through the area of every edge.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn upwind_fluxes<const D: usize, S: Number, F: UpwindFlux<D>>(gas: Gas, flux: F, batch: &mut Batch<D, S>) {
    let Batch { area, speed, middle: [left, right], upwind: through, .. } = batch;
    for k in 0..LANES {
        let sides = [left.primitive(k), right.primitive(k)];
        through.put_conserved(k, &upwind(&gas, flux, &sides, &take(area, k), &pair(speed, k)));
    }
}

/// Blends the upwind flux with Einfeldt's flux where the pressure sensor is active.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn steep_fluxes<const D: usize, S: Number>(gas: Gas, batch: &mut Batch<D, S>) {
    let Batch { area, speed, steepness, middle: [left, right], upwind: through, .. } = batch;
    for k in 0..LANES {
        let (sides, plain) = ([left.primitive(k), right.primitive(k)], through.conserved(k));
        let flux = steep(&gas, (&sides, &plain), &take(area, k), &pair(speed, k), S::take(steepness, k));
        through.put_conserved(k, &flux);
    }
}

/// Computes the contribution of every edge to V dU/dt of both ends.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn accumulate_residual<const D: usize, S: Number, const MOVES: bool, const CONSERVATIVE: bool>(
    gas: Gas,
    by_faces: bool,
    batch: &mut Batch<D, S>,
) {
    let Batch { own, weight, area, speed, middle, upwind, out: [out_i, out_j], .. } = batch;
    for k in 0..LANES {
        let edge = Passing {
            state: [own[0].primitive(k), own[1].primitive(k)],
            weight: pair(weight, k),
            velocity: pair(speed, k),
            area: take(area, k),
            sides: [middle[0].primitive(k), middle[1].primitive(k)],
            upwind: upwind.conserved(k),
        };
        let [i, j] = match CONSERVATIVE {
            true => conservative::<D, S, MOVES>(&gas, by_faces, &edge),
            false => consistent::<D, S, MOVES>(&gas, &edge),
        };
        out_i.put_conserved(k, &i);
        out_j.put_conserved(k, &j);
    }
}

/// Adds the viscous contribution of every edge to V dU/dt of both ends.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn viscous_fluxes<const D: usize, S: Number, const CONSERVATIVE: bool>(
    gas: Gas,
    medium: Newtonian,
    batch: &mut Batch<D, S>,
) {
    let Batch { own, weight, area, along, gradient, out: [out_i, out_j], .. } = batch;
    for k in 0..LANES {
        let ends = array(|side| slopes(&gas, &own[side].primitive(k), &gradient[side].take(k)));
        let weight = pair(weight, k);
        let weight = if CONSERVATIVE { None } else { Some(&weight) };
        let [i, j] = viscous(&gas, &medium, &ends, (&take(along, k), &take(area, k)), weight);
        out_i.put_conserved(k, &out_i.conserved(k).plus(S::constant(1.0), &i));
        out_j.put_conserved(k, &out_j.conserved(k).plus(S::constant(1.0), &j));
    }
}
