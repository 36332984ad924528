//! Upwind fluxes between two states across a unit normal (approximate Riemann solvers).
//!
//! All fluxes are consistent, F(q, q, n) = F(q)·n, and conservative, F(a, b, n) = −F(b, a, −n).
use super::gas::{Conserved, Gas, Primitive};
use crate::math::Vector;
use crate::math::jet::Scalar;

/// Fraction of the sound speed below which Roe's eigenvalues are smoothed (entropy fix, Harten 1983).
const ENTROPY_FIX: f64 = 0.1;
/// Fraction of the sound speed over which the minimum and the maximum of several wave speeds are smoothed.
const PASSING: f64 = 1.0;

/// A numerical flux across a unit normal.
pub trait UpwindFlux<const D: usize>: Copy + Sync {
    /// Flux from `l` to `r` per unit area. Implementations select values instead of branching on the states, so that
    /// the fluxes of many edges can be computed by vector instructions.
    fn across<S: Scalar>(
        self,
        gas: &Gas,
        l: &Primitive<D, S>,
        r: &Primitive<D, S>,
        n: &Vector<D, S>,
    ) -> Conserved<D, S>;
}

/// Averages of two states, weighted by the square roots of their densities (Roe 1981, J. Comput. Phys. 43).
struct RoeAverage<const D: usize, S> {
    density: S,
    velocity: Vector<D, S>,
    enthalpy: S,
    /// Squared sound speed, which may be negative for two states of very different enthalpy.
    square: S,
}

impl<const D: usize, S: Scalar> RoeAverage<D, S> {
    /// Roe averages of two states with these total enthalpies.
    #[inline(always)]
    fn of(gas: &Gas, [l, r]: [&Primitive<D, S>; 2], [hl, hr]: [S; 2]) -> Self {
        let (wl, wr) = (l.density.sqrt(), r.density.sqrt());
        let weight = (wl + wr).inverse();
        let velocity = (l.velocity * wl + r.velocity * wr) * weight;
        let enthalpy = (hl * wl + hr * wr) * weight;
        let square = (enthalpy - velocity.norm_squared() * 0.5) * (gas.gamma - 1.0);
        Self { density: wl * wr, velocity, enthalpy, square }
    }
}

/// HLLC flux (Toro, Spruce and Speares 1994) with the wave speeds of Batten et al. (1997): resolves contacts exactly.
#[derive(Clone, Copy, Debug)]
pub struct Hllc;
impl<const D: usize> UpwindFlux<D> for Hllc {
    #[inline(always)]
    fn across<S: Scalar>(
        self,
        gas: &Gas,
        l: &Primitive<D, S>,
        r: &Primitive<D, S>,
        n: &Vector<D, S>,
    ) -> Conserved<D, S> {
        let (zero, inverse) = (S::constant(0.0), 1.0 / (gas.gamma - 1.0));
        let (ul, ur) = (l.velocity.dot(n), r.velocity.dot(n));
        let (tl, tr) = (l.pressure / l.density, r.pressure / r.density);
        let (el, er) = (tl * inverse + l.velocity.norm_squared() * 0.5, tr * inverse + r.velocity.norm_squared() * 0.5);
        let mean = RoeAverage::of(gas, [l, r], [el + tl, er + tr]);
        let (un, c) = (mean.velocity.dot(n), mean.square.max(zero).sqrt());
        let sl = (ul - (tl * gas.gamma).sqrt()).min(un - c);
        let sr = (ur + (tr * gas.gamma).sqrt()).max(un + c);
        let (ml, mr) = (l.density * (sl - ul), r.density * (sr - ur));
        let star = (r.pressure - l.pressure + ml * ul - mr * ur) / (ml - mr);
        // F + S (U* − U) on the side of the contact in which the area lies; S = 0 where the outer wave of this side has
        // passed the area
        let left = star.value() >= 0.0;
        let pick = |a: S, b: S| if left { a } else { b };
        let q = Primitive::zip(l, r, pick);
        let (e, s, m, wave) = (pick(el, er), pick(sl, sr), pick(ml, mr), pick(sl.min(zero), sr.max(zero)));
        let jump = star - q.velocity.dot(n);
        let shared = (m * (s - star)).inverse();
        let density = m * m * shared;
        let energy = density * (e + jump * (star + q.pressure * (s - star) * shared));
        let plain = gas.flux(&q, n);
        Conserved {
            density: plain.density + wave * (density - q.density),
            momentum: plain.momentum + (q.velocity * (density - q.density) + *n * (density * jump)) * wave,
            energy: plain.energy + wave * (energy - q.density * e),
        }
    }
}

/// Local Lax-Friedrichs flux (Rusanov 1961).
#[derive(Clone, Copy, Debug)]
pub struct Rusanov;
impl<const D: usize> UpwindFlux<D> for Rusanov {
    #[inline(always)]
    fn across<S: Scalar>(
        self,
        gas: &Gas,
        l: &Primitive<D, S>,
        r: &Primitive<D, S>,
        n: &Vector<D, S>,
    ) -> Conserved<D, S> {
        let (one, half) = (S::constant(1.0), S::constant(0.5));
        let speed = gas.signal_speed(l, n).max(gas.signal_speed(r, n));
        let central = gas.flux(l, n).plus(one, &gas.flux(r, n));
        central.plus(-speed, &gas.conserved(r)).plus(speed, &gas.conserved(l)).times(half)
    }
}

/// HLL flux (Harten, Lax and van Leer 1983) with the wave speeds of Einfeldt (1988): a single mean state between the
/// outer waves.
///
/// The switches between wave speeds are smoothed over a range of one sound speed. Newton's method therefore converges
/// through strong shocks, and shocks between one and two times the sound speed are damped nearly as much as by
/// Rusanov's flux. Faster flow is purely upwind, so that a strong shock across rows of particles does not transport
/// anything between the rows. The dissipation of the energy acts on ρH (Jameson 1995, Int. J. Comput. Fluid Dyn. 5): a
/// uniform total enthalpy remains uniform within a captured shock, and mass that leaves the shock sideways carries its
/// share of the energy.
#[derive(Clone, Copy, Debug)]
pub struct Hlle;
impl<const D: usize> UpwindFlux<D> for Hlle {
    #[inline(always)]
    fn across<S: Scalar>(
        self,
        gas: &Gas,
        l: &Primitive<D, S>,
        r: &Primitive<D, S>,
        n: &Vector<D, S>,
    ) -> Conserved<D, S> {
        let zero = S::constant(0.0);
        let (ul, ur) = (l.velocity.dot(n), r.velocity.dot(n));
        let (hl, hr) = (gas.total_enthalpy(l), gas.total_enthalpy(r));
        let mean = RoeAverage::of(gas, [l, r], [hl, hr]);
        let (un, c) = (mean.velocity.dot(n), mean.square.max(zero).sqrt());
        let width = c * PASSING;
        let least = |a: S, b: S| (a + b - rounded((a - b).abs(), width)) * 0.5;
        let low = least(least(ul - gas.sound_speed(l), un - c), zero);
        let high = -least(least(-(ur + gas.sound_speed(r)), -(un + c)), zero);
        let [ql, qr] = [(l, hl), (r, hr)].map(|(q, h)| Conserved { energy: q.density * h, ..gas.conserved(q) });
        let spread = qr.minus(&ql).times(low * high);
        let both = gas.flux(l, n).times(high).plus(-low, &gas.flux(r, n));
        both.plus(S::constant(1.0), &spread).times((high - low).inverse())
    }
}

/// Central flux: the mean of the fluxes on both sides, without dissipation.
#[derive(Clone, Copy, Debug)]
pub struct Central;
impl<const D: usize> UpwindFlux<D> for Central {
    #[inline(always)]
    fn across<S: Scalar>(
        self,
        gas: &Gas,
        l: &Primitive<D, S>,
        r: &Primitive<D, S>,
        n: &Vector<D, S>,
    ) -> Conserved<D, S> {
        gas.flux(l, n).plus(S::constant(1.0), &gas.flux(r, n)).times(S::constant(0.5))
    }
}

/// Roe's flux (1981) with a smooth entropy fix.
#[derive(Clone, Copy, Debug)]
pub struct Roe;
impl<const D: usize> UpwindFlux<D> for Roe {
    #[inline(always)]
    fn across<S: Scalar>(
        self,
        gas: &Gas,
        l: &Primitive<D, S>,
        r: &Primitive<D, S>,
        n: &Vector<D, S>,
    ) -> Conserved<D, S> {
        let mean = RoeAverage::of(gas, [l, r], [gas.total_enthalpy(l), gas.total_enthalpy(r)]);
        let (density, v, h, c2) = (mean.density, mean.velocity, mean.enthalpy, mean.square.max(S::constant(1e-300)));
        let (c, un) = (c2.sqrt(), v.dot(n));
        let dv = r.velocity - l.velocity;
        let (dun, dp, dr) = (dv.dot(n), r.pressure - l.pressure, r.density - l.density);
        let fix = |x: S| rounded(x.abs(), c * ENTROPY_FIX);
        let (minus, plus, middle) = (fix(un - c), fix(un + c), fix(un));
        let a = minus * (dp - density * c * dun) / (c2 * 2.0);
        let b = plus * (dp + density * c * dun) / (c2 * 2.0);
        let e = middle * (dr - dp / c2);
        let shear = (dv - *n * dun) * (middle * density);
        let dissipation = Conserved {
            density: a + b + e,
            momentum: (v - *n * c) * a + (v + *n * c) * b + v * e + shear,
            energy: a * (h - un * c) + b * (h + un * c) + e * 0.5 * v.norm_squared() + shear.dot(&v),
        };
        let (one, half) = (S::constant(1.0), S::constant(0.5));
        gas.flux(l, n).plus(one, &gas.flux(r, n)).minus(&dissipation).times(half)
    }
}

/// Smooth approximation of |x|, a parabola below `width`.
#[inline(always)]
pub fn rounded<S: Scalar>(x: S, width: S) -> S {
    if x.value() < width.value() { (x * x / width + width) * 0.5 } else { x }
}

/// AUSM⁺-up flux for all speeds (Liou 2006, J. Comput. Phys. 214), K_p = 1/4, K_u = 3/4, σ = 1, no low-Mach scaling.
#[derive(Clone, Copy, Debug)]
pub struct AusmPlusUp;
impl<const D: usize> UpwindFlux<D> for AusmPlusUp {
    #[inline(always)]
    fn across<S: Scalar>(
        self,
        gas: &Gas,
        l: &Primitive<D, S>,
        r: &Primitive<D, S>,
        n: &Vector<D, S>,
    ) -> Conserved<D, S> {
        let (ul, ur) = (l.velocity.dot(n), r.velocity.dot(n));
        let c = (gas.sound_speed(l) + gas.sound_speed(r)) * 0.5;
        let (ml, mr) = (ul / c, ur / c);
        let density = (l.density + r.density) * 0.5;
        let mean = (ml * ml + mr * mr) * 0.5;
        let slow = (S::constant(1.0) - mean).max(S::constant(0.0));
        let coupling = slow * 0.25 * (r.pressure - l.pressure) / (density * c * c);
        let m = mach_split(ml, 1.0) + mach_split(mr, -1.0) - coupling;
        let (pl, pr) = (pressure_split(ml, 1.0), pressure_split(mr, -1.0));
        let p = pl * l.pressure + pr * r.pressure - pl * 0.75 * pr * 2.0 * density * c * (ur - ul);
        let up = if m.value() > 0.0 { l } else { r };
        let mass = c * m * up.density;
        Conserved { density: mass, momentum: up.velocity * mass + *n * p, energy: mass * gas.total_enthalpy(up) }
    }
}

/// Split Mach number of degree 4 with β = 1/8; `sign` is +1 for the left state and −1 for the right one.
#[inline(always)]
fn mach_split<S: Scalar>(m: S, sign: f64) -> S {
    if m.value().abs() >= 1.0 {
        return (m + m.abs() * sign) * 0.5;
    }
    let (same, other) = ((m + sign) * (m + sign), (m - sign) * (m - sign));
    same * 0.25 * sign * (other * (2.0 * 0.25) + 1.0)
}

/// Split pressure of degree 5 with α = 3/16; `sign` is +1 for the left state and −1 for the right one.
#[inline(always)]
fn pressure_split<S: Scalar>(m: S, sign: f64) -> S {
    if m.value().abs() >= 1.0 {
        return S::constant(0.5 * (1.0 + sign * m.value().signum()));
    }
    let square = (m + sign) * (m + sign) * 0.25;
    let other = (m - sign) * (m - sign) * 0.25;
    square * ((-(m * sign) + 2.0) + m * (16.0 * 3.0 / 16.0) * sign * other)
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: Gas = Gas { gamma: 1.4 };
    type Flux = fn(&Gas, &Primitive<2>, &Primitive<2>, &Vector<2>) -> Conserved<2>;
    const ALL: [Flux; 5] = [
        |g, l, r, n| Hllc.across(g, l, r, n),
        |g, l, r, n| Hlle.across(g, l, r, n),
        |g, l, r, n| Roe.across(g, l, r, n),
        |g, l, r, n| AusmPlusUp.across(g, l, r, n),
        |g, l, r, n| Rusanov.across(g, l, r, n),
    ];

    fn states() -> Vec<Primitive<2>> {
        let mut all = Vec::new();
        for u in [-2.3, -0.4, 0.0, 0.3, 1.9] {
            for p in [0.2, 0.71, 3.0] {
                all.push(Primitive { density: 0.8 + 0.1 * u * u, velocity: Vector([u, 0.3]), pressure: p });
            }
        }
        all
    }

    fn close(a: &Conserved<2>, b: &Conserved<2>) -> bool {
        let scale = 1.0 + a.energy.abs();
        (a.density - b.density).abs() + (a.momentum - b.momentum).norm() + (a.energy - b.energy).abs() < 1e-12 * scale
    }

    #[test]
    fn every_flux_is_consistent() {
        let n = Vector([0.6, 0.8]);
        for flux in ALL {
            for q in states() {
                assert!(close(&flux(&AIR, &q, &q, &n), &AIR.flux(&q, &n)), "{q:?}");
            }
        }
    }

    #[test]
    fn every_flux_is_conservative() {
        let n = Vector([0.6, 0.8]);
        for flux in ALL {
            for a in states() {
                for b in states() {
                    assert!(close(&flux(&AIR, &a, &b, &n), &flux(&AIR, &b, &a, &-n).times(-1.0)), "{a:?} {b:?}");
                }
            }
        }
    }

    #[test]
    fn gas_of_one_total_enthalpy_keeps_it_across_a_captured_shock() {
        let (n, enthalpy) = (Vector([0.6, 0.8]), 7.0);
        let at = |speed: f64, pressure: f64| {
            let velocity = Vector([speed, 0.3]);
            let density = 3.5 * pressure / (enthalpy - 0.5 * velocity.norm_squared());
            Primitive { density, velocity, pressure }
        };
        for (l, r) in [(at(3.0, 0.71), at(0.7, 7.4)), (at(1.3, 4.8), at(0.9, 6.0)), (at(-0.4, 8.0), at(2.1, 3.0))] {
            let flux = Hlle.across(&AIR, &l, &r, &n);
            assert!((flux.energy - enthalpy * flux.density).abs() < 1e-13 * flux.energy.abs(), "{flux:?}");
        }
    }

    #[test]
    fn hllc_and_roe_keep_a_standing_contact() {
        let (l, r) = (
            Primitive { density: 1.0, velocity: Vector([0.0, 0.2]), pressure: 0.7 },
            Primitive { density: 0.1, velocity: Vector([0.0, 0.2]), pressure: 0.7 },
        );
        let f = Hllc.across(&AIR, &l, &r, &Vector([1.0, 0.0]));
        assert!(f.density.abs() < 1e-15 && (f.momentum[0] - 0.7).abs() < 1e-15);
    }
}
