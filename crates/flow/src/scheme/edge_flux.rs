//! The flux across an edge as a function of plain values.
//!
//! An edge connects the particles i and j with the offset d. It has an area vector s, which has opposite signs for
//! both, and at each end the weight a of the other end in the gradient. [`edge_flux`] returns its contribution to V
//! dU/dt of both ends. With the states q_L and q_R on both sides of the midpoint (`reconstruct`), m = s/|s|, the upwind
//! flux F̂ (`physics::riemann`), the physical flux F, and the velocities w of the particles, it is
//!
//! - *conservative*: F(q_i)·s − |s| F̂ and |s| F̂ − F(q_j)·s; the transport relative to moving particles is
//!   (w·s) Ū − (w_i·n_i) (Ū − U_i) with the mean Ū of both sides of the midpoint;
//! - otherwise: −V_i a·[F(q_L) + F(q_R) − 2F(q_i)] − |s| [F̂ − m·(F(q_L) + F(q_R))/2], in the frame of the moving
//!   particle;
//!
//! plus the viscous flux along d (`viscous`). The sums over the edges of a particle form its residual, see `residual`.
//! The module `edges` computes the same for many edges at once, with the functions below.
use super::reconstruct::{Gradient, Reconstruction, Unlimited, VanAlbada, Venkatakrishnan, low_mach_correction};
use super::viscous::{direction, middle, slopes};
use crate::case::{Flux, Limiter};
use crate::math::Vector;
use crate::math::jet::Scalar;
use crate::physics::riemann::{AusmPlusUp, Central, Hllc, Hlle, Roe, Rusanov, UpwindFlux};
use crate::physics::viscous::Slopes;
use crate::physics::{Conserved, Gas, Newtonian, Primitive};

/// Settings of the scheme that determine the fluxes.
#[derive(Clone, Copy, Debug)]
pub struct FluxScheme {
    /// Ideal gas.
    pub gas: Gas,
    /// Upwind flux function.
    pub flux: Flux,
    /// Slope limiter.
    pub limit: Limiter,
    /// Order, κ and threshold of the reconstruction.
    pub reconstruction: Reconstruction,
    /// True for exactly conservative coefficients.
    pub conservative: bool,
    /// True when these coefficients are also used for the transport relative to moving particles.
    pub by_faces: bool,
    /// Viscosity and heat conduction; `None` for an inviscid gas.
    pub medium: Option<Newtonian>,
}

/// Data of the particle at one end of an edge.
#[derive(Clone, Copy, Debug)]
pub struct EdgeEnd<const D: usize, S = f64> {
    /// State of the particle.
    pub state: Primitive<D, S>,
    /// Gradient at the particle.
    pub gradient: Gradient<D, S>,
    /// Pressure sensor from 0 (smooth) to 1 (strong shock).
    pub steepness: S,
    /// −V a: negative volume times the weight of the other end in the gradient.
    pub weight: Vector<D, S>,
    /// Velocity w of the particle.
    pub velocity: Vector<D, S>,
}

/// Data of an edge that both ends share.
#[derive(Clone, Copy, Debug)]
pub struct EdgeFace<const D: usize, S = f64> {
    /// Offset d from the first end to the second.
    pub along: Vector<D, S>,
    /// Area vector s from the first end to the second.
    pub area: Vector<D, S>,
    /// Smallest factor on the jump of the normal velocity in slow flow: 1 at the sides of the domain, otherwise 0.
    pub whole: f64,
}

/// Contributions of an edge to V dU/dt of its two ends.
pub fn edge_flux<const D: usize, S: Scalar>(
    scheme: &FluxScheme,
    ends: [&EdgeEnd<D, S>; 2],
    face: &EdgeFace<D, S>,
) -> [Conserved<D, S>; 2] {
    let gas = &scheme.gas;
    let (velocity, weight) = (ends.map(|end| end.velocity), ends.map(|end| end.weight));
    let (sides, upwind) = between(scheme, ends, face);
    let passing = Passing { state: ends.map(|end| end.state), weight, velocity, area: face.area, sides, upwind };
    let inviscid = match scheme.conservative {
        true => conservative::<D, S, true>(gas, scheme.by_faces, &passing),
        false => consistent::<D, S, true>(gas, &passing),
    };
    let Some(medium) = &scheme.medium else { return inviscid };
    let slopes = ends.map(|end| slopes(gas, &end.state, &end.gradient));
    let viscous = viscous(gas, medium, &slopes, (&face.along, &face.area), (!scheme.conservative).then_some(&weight));
    let [i, j] = inviscid;
    [i.plus(S::constant(1.0), &viscous[0]), j.plus(S::constant(1.0), &viscous[1])]
}

/// Flux through an edge in addition to the mean flux of its ends: dissipation and the effect of the reconstruction.
pub fn beyond_mean<const D: usize>(scheme: &FluxScheme, ends: [&EdgeEnd<D>; 2], face: &EdgeFace<D>) -> Conserved<D> {
    let mean = mean_through(&scheme.gas, &ends.map(|end| end.state), &face.area, &ends.map(|end| end.velocity));
    between(scheme, ends, face).1.times(face.area.norm()).minus(&mean)
}

/// Mean flux of two ends through an area that moves with their mean velocity.
pub fn mean_through<const D: usize>(
    gas: &Gas,
    state: &[Primitive<D>; 2],
    area: &Vector<D>,
    velocity: &[Vector<D>; 2],
) -> Conserved<D> {
    upwind(gas, Central, state, area, velocity).times(area.norm())
}

/// States on both sides of the midpoint of an edge, and the upwind flux between them per unit of area.
fn between<const D: usize, S: Scalar>(
    scheme: &FluxScheme,
    ends: [&EdgeEnd<D, S>; 2],
    face: &EdgeFace<D, S>,
) -> ([Primitive<D, S>; 2], Conserved<D, S>) {
    let (gas, [a, b]) = (&scheme.gas, ends);
    let along = ends.map(|end| end.gradient.along(&face.along).times(S::constant(1.0) - end.steepness));
    let (states, slopes) = ((&a.state, &b.state), (&along[0], &along[1]));
    let sides = match scheme.limit {
        Limiter::None => scheme.reconstruction.states(gas, Unlimited, states, slopes),
        Limiter::VanAlbada => scheme.reconstruction.states(gas, VanAlbada, states, slopes),
        Limiter::Venkatakrishnan => scheme.reconstruction.states(gas, Venkatakrishnan, states, slopes),
    };
    let velocity = ends.map(|end| end.velocity);
    let sides = if scheme.reconstruction.low_mach {
        slowed(gas, [sides.0, sides.1], (&face.area, face.whole), &velocity)
    } else {
        [sides.0, sides.1]
    };
    let upwind = match scheme.flux {
        Flux::Hllc => upwind(gas, Hllc, &sides, &face.area, &velocity),
        Flux::Roe => upwind(gas, Roe, &sides, &face.area, &velocity),
        Flux::AusmPlusUp => upwind(gas, AusmPlusUp, &sides, &face.area, &velocity),
        Flux::Rusanov => upwind(gas, Rusanov, &sides, &face.area, &velocity),
    };
    let upwind = steep(gas, (&sides, &upwind), &face.area, &velocity, a.steepness.max(b.steepness));
    (sides, upwind)
}

/// Data for the inviscid contribution, once the states on both sides of the midpoint and the flux between them are
/// known.
pub(super) struct Passing<const D: usize, S> {
    pub(super) state: [Primitive<D, S>; 2],
    pub(super) weight: [Vector<D, S>; 2],
    pub(super) velocity: [Vector<D, S>; 2],
    pub(super) area: Vector<D, S>,
    /// States on both sides of the midpoint.
    pub(super) sides: [Primitive<D, S>; 2],
    /// Upwind flux between them per unit of area.
    pub(super) upwind: Conserved<D, S>,
}

/// States on both sides of the midpoint, relative to the mean velocity of the ends, after the low-Mach-number
/// correction.
#[inline(always)]
pub(super) fn slowed<const D: usize, S: Scalar>(
    gas: &Gas,
    [l, r]: [Primitive<D, S>; 2],
    (area, whole): (&Vector<D, S>, f64),
    velocity: &[Vector<D, S>; 2],
) -> [Primitive<D, S>; 2] {
    let (m, w) = (normal(area).0, mean(velocity));
    let (l, r) = low_mach_correction(gas, l.seen_from(&w), r.seen_from(&w), (&m, whole));
    [l.seen_from(&-w), r.seen_from(&-w)]
}

/// Upwind flux per unit of area through an area that moves with the mean velocity of the ends, computed in the frame in
/// which the area is at rest.
#[inline(always)]
pub(super) fn upwind<const D: usize, S: Scalar, F: UpwindFlux<D>>(
    gas: &Gas,
    flux: F,
    [l, r]: &[Primitive<D, S>; 2],
    area: &Vector<D, S>,
    velocity: &[Vector<D, S>; 2],
) -> Conserved<D, S> {
    let (m, w) = (normal(area).0, mean(velocity));
    let f = flux.across(gas, &l.seen_from(&w), &r.seen_from(&w), &m);
    let energy = f.energy + w.dot(&f.momentum) + w.norm_squared() * 0.5 * f.density;
    Conserved { density: f.density, momentum: f.momentum + w * f.density, energy }
}

/// The upwind flux, blended with Einfeldt's flux by the factor `steepness` from 0 to 1.
#[inline(always)]
pub(super) fn steep<const D: usize, S: Scalar>(
    gas: &Gas,
    (sides, plain): (&[Primitive<D, S>; 2], &Conserved<D, S>),
    area: &Vector<D, S>,
    velocity: &[Vector<D, S>; 2],
    steepness: S,
) -> Conserved<D, S> {
    let damped = upwind(gas, Hlle, sides, area, velocity);
    plain.plus(steepness, &damped.minus(plain))
}

/// Contribution with conservative coefficients; `by_faces`: these are also used for the transport relative to moving
/// ends.
#[inline(always)]
pub(super) fn conservative<const D: usize, S: Scalar, const MOVES: bool>(
    gas: &Gas,
    by_faces: bool,
    edge: &Passing<D, S>,
) -> [Conserved<D, S>; 2] {
    let (s, one) = (&edge.area, S::constant(1.0));
    let through = edge.upwind.times(normal(s).1);
    let [out_i, out_j] = [gas.flux(&edge.state[0], s), gas.flux(&edge.state[1], s)];
    if !MOVES {
        return [out_i.minus(&through), through.minus(&out_j)];
    }
    let mean_state = gas.conserved(&edge.sides[0]).plus(one, &gas.conserved(&edge.sides[1])).times(S::constant(0.5));
    let through = through.plus(mean(&edge.velocity).dot(s), &mean_state);
    // w·∇U: by the weights that are exact for linear fields, given as −V a, or by the area vectors of the fluxes
    let n = if by_faces { [*s, -*s] } else { [edge.weight[0].times(-2.0), edge.weight[1].times(-2.0)] };
    let swept = |k: usize| mean_state.minus(&gas.conserved(&edge.state[k])).times(edge.velocity[k].dot(&n[k]));
    [out_i.minus(&through).plus(one, &swept(0)), through.minus(&out_j).plus(one, &swept(1))]
}

/// Contribution with the weights that are exact for linear fields, each end with its own velocity.
#[inline(always)]
pub(super) fn consistent<const D: usize, S: Scalar, const MOVES: bool>(
    gas: &Gas,
    edge: &Passing<D, S>,
) -> [Conserved<D, S>; 2] {
    let (m, size) = normal(&edge.area);
    let both = both_sides::<D, S, MOVES>(gas, &edge.sides, &m, &mean(&edge.velocity));
    let spread = edge.upwind.plus(S::constant(-0.5), &both).times(size);
    let central = |k: usize| {
        let (a, w) = (&edge.weight[k], &edge.velocity[k]);
        let both = both_sides::<D, S, MOVES>(gas, &edge.sides, a, w);
        both.plus(S::constant(-2.0), &relative_flux::<D, S, MOVES>(gas, &edge.state[k], a, w))
    };
    [central(0).minus(&spread), central(1).plus(S::constant(1.0), &spread)]
}

/// Sum of the fluxes of both sides of the midpoint through an area `n` that moves with `w`.
#[inline(always)]
fn both_sides<const D: usize, S: Scalar, const MOVES: bool>(
    gas: &Gas,
    [left, right]: &[Primitive<D, S>; 2],
    n: &Vector<D, S>,
    w: &Vector<D, S>,
) -> Conserved<D, S> {
    let through = relative_flux::<D, S, MOVES>(gas, left, n, w);
    through.plus(S::constant(1.0), &relative_flux::<D, S, MOVES>(gas, right, n, w))
}

/// Flux of the state `q` through an area `n` that moves with the velocity `w`.
#[inline(always)]
fn relative_flux<const D: usize, S: Scalar, const MOVES: bool>(
    gas: &Gas,
    q: &Primitive<D, S>,
    n: &Vector<D, S>,
    w: &Vector<D, S>,
) -> Conserved<D, S> {
    if MOVES { gas.flux(q, n).plus(-w.dot(n), &gas.conserved(q)) } else { gas.flux(q, n) }
}

/// Viscous contribution of an edge to both ends: by the weights −V a where they are given, otherwise through the area
/// vector.
#[inline(always)]
pub(super) fn viscous<const D: usize, S: Scalar>(
    gas: &Gas,
    medium: &Newtonian,
    [a, b]: &[Slopes<D, S>; 2],
    (d, s): (&Vector<D, S>, &Vector<D, S>),
    weight: Option<&[Vector<D, S>; 2]>,
) -> [Conserved<D, S>; 2] {
    let middle = middle((a, b), d, &direction(s, d));
    let Some([n_i, n_j]) = weight else {
        let through = medium.flux(gas, &middle, s);
        return [through, through.times(S::constant(-1.0))];
    };
    let past = |own: &Slopes<D, S>, n: &Vector<D, S>| medium.flux(gas, own, n).minus(&medium.flux(gas, &middle, n));
    [past(a, n_i).times(S::constant(2.0)), past(b, n_j).times(S::constant(2.0))]
}

/// Mean velocity of both ends.
#[inline(always)]
fn mean<const D: usize, S: Scalar>(velocity: &[Vector<D, S>; 2]) -> Vector<D, S> {
    (velocity[0] + velocity[1]).times(0.5)
}

/// Unit normal and magnitude of an area vector; the zero vector where the area is zero.
#[inline(always)]
fn normal<const D: usize, S: Scalar>(s: &Vector<D, S>) -> (Vector<D, S>, S) {
    let size = s.norm();
    (*s * size.max(S::constant(f64::MIN_POSITIVE)).inverse(), size)
}

/// The vector s/2V, which replaces a_ij when the coefficients are conservative.
#[inline(always)]
pub(super) fn half_face<const D: usize>(volume: f64, s: &Vector<D>) -> Vector<D> {
    *s * (0.5 / volume)
}

#[cfg(test)]
mod tests;
