//! Values at the middle of an edge.
//!
//! MUSCL on primitive variables (van Leer 1979, in the edge form of Löhner 2008): with the upwind difference
//! a = 2∇q_i·d − Δq and the central one b = Δq = q_j − q_i,
//! q_L = q_i + s/4 [(1 − κs) a + (1 + κs) b]. The limiter s(a, b) is 1 in smooth flow and falls to 0 where a and b disagree;
//! it is differentiable, so that Newton's method converges through shocks.
//!
//! Nothing is linear in a strong shock or beside a vacuum. There slopes are given up, smoothly: of a *steep* particle, whose
//! pressure changes by much of itself within its spacing, and of an edge whose ends have very different pressures; what is left
//! of an increment leaves density and pressure positive. Between steep particles the upwind flux gives way to Einfeldt's: one that
//! resolves contacts lets disturbances grow along a strong shock that stands between two rows of particles (Quirk 1994, Int. J.
//! Numer. Methods Fluids 18). Rusanov's would do as well, but takes mass and energy from row to row where a shock is curved: total
//! pressure behind the bow shock of a circle at Mach 10 was 4 % low. None of it acts in shocks below about Mach 1.4.
use crate::math::Vector;
use crate::math::jet::Scalar;
use crate::physics::{Gas, Primitive};

/// Smallest fraction of a particle's own density or pressure that a reconstructed state may have.
const POSITIVE: f64 = 0.1;
/// Squares of the relative change of pressure in one spacing, h |∇p|/p, between which slopes vanish: a shock at Mach 1.4 has .5,
/// bow shocks have more than 1.
const STEEP: [f64; 2] = [0.5, 1.5];
/// Squares of the relative jump of pressure (p_j − p_i)/(p_j + p_i) between which slopes are given up, at ratios of 2 and 4.
const JUMP: [f64; 2] = [1.0 / 9.0, 9.0 / 25.0];
/// Least square of the threshold: without any, limiters would divide nothing by nothing where nothing varies.
const LEAST_SQUARE: f64 = 1e-60;

/// Gradients of density, velocity and pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Gradient<const D: usize, S = f64> {
    /// Gradient of the density.
    pub density: Vector<D, S>,
    /// Gradient of each velocity component.
    pub velocity: [Vector<D, S>; D],
    /// Gradient of the pressure.
    pub pressure: Vector<D, S>,
}

impl<const D: usize> Gradient<D> {
    /// All zero.
    pub const ZERO: Self = Self { density: Vector::ZERO, velocity: [Vector::ZERO; D], pressure: Vector::ZERO };

    /// The same gradient in turned axes.
    pub fn turned(&self, turn: &impl Fn(&Vector<D>) -> Vector<D>) -> Self {
        // rows of R G Rᵀ: turn the derivative of each component, then mix the components
        let half: [Vector<D>; D] = std::array::from_fn(|c| turn(&self.velocity[c]));
        let column = |d: usize| turn(&Vector::from_fn(|c| half[c][d]));
        let columns: [Vector<D>; D] = std::array::from_fn(column);
        Self {
            density: turn(&self.density),
            velocity: std::array::from_fn(|c| Vector::from_fn(|d| columns[d][c])),
            pressure: turn(&self.pressure),
        }
    }
}

/// 0 below 0, 1 above 1, in between t² (3 − 2t).
#[inline(always)]
pub(super) fn smooth_step<S: Scalar>(t: S) -> S {
    let t = t.max(S::constant(0.0)).min(S::constant(1.0));
    t * t * (S::constant(3.0) - t * 2.0)
}

impl<const D: usize, S: Scalar> Gradient<D, S> {
    /// All zero.
    pub fn zero() -> Self {
        Self { density: Vector::zero(), velocity: [Vector::zero(); D], pressure: Vector::zero() }
    }

    /// Adds a (q_j − q_i) for one neighbour.
    #[inline(always)]
    pub fn add(&mut self, a: &Vector<D>, dq: &Primitive<D, S>) {
        let times = |q: S| Vector::from_fn(|c| q * a[c]);
        self.density += times(dq.density);
        for d in 0..D {
            self.velocity[d] += times(dq.velocity[d]);
        }
        self.pressure += times(dq.pressure);
    }

    /// Gradients of which each is `f` of one here.
    #[inline(always)]
    pub fn map(&self, f: impl Fn(&Vector<D, S>) -> Vector<D, S>) -> Self {
        Self { density: f(&self.density), velocity: self.velocity.each_ref().map(&f), pressure: f(&self.pressure) }
    }

    /// How far the pressure `p` is from linear within a spacing `h`: 0 in smooth flow and weak shocks, 1 in strong ones.
    #[inline(always)]
    pub fn steepness(&self, h: f64, p: S) -> S {
        let change = self.pressure.norm_squared() * (h * h) / (p * p);
        smooth_step((change - STEEP[0]) * (1.0 / (STEEP[1] - STEEP[0])))
    }

    /// Change of the state along `d`.
    #[inline(always)]
    pub fn along(&self, d: &Vector<D, S>) -> Primitive<D, S> {
        Primitive {
            density: self.density.dot(d),
            velocity: Vector::from_fn(|c| self.velocity[c].dot(d)),
            pressure: self.pressure.dot(d),
        }
    }
}

/// Slope limiter of one edge and one variable: `a` upwind, `b` central difference, `eps` the square of a small difference.
pub trait Limit: Copy + Sync {
    /// Factors in [0, 1] of both ends, which share one division where they can.
    fn factors<S: Scalar>(self, a: [S; 2], b: S, eps: S) -> [S; 2];
}

/// Van Albada, van Leer and Roberts (1982) in a form that never reaches zero, s = m/(m + (a − b)²) with
/// m = ε + (a² + b²)/2: differentiable everywhere, so that residuals fall through shocks.
#[derive(Clone, Copy)]
pub struct VanAlbada;
impl Limit for VanAlbada {
    #[inline(always)]
    fn factors<S: Scalar>(self, a: [S; 2], b: S, eps: S) -> [S; 2] {
        let [c, a] = a;
        let (top_c, top_a) = (eps + (c * c + b * b) * 0.5, eps + (a * a + b * b) * 0.5);
        let (bottom_c, bottom_a) = (top_c + (c - b) * (c - b), top_a + (a - b) * (a - b));
        let shared = (bottom_c * bottom_a).inverse();
        [top_c * bottom_a * shared, top_a * bottom_c * shared]
    }
}

/// The rational function of Venkatakrishnan (1995) applied to the two differences of an edge: smooth where these agree, but 3/4
/// there if they are far above the threshold.
#[derive(Clone, Copy)]
pub struct Venkatakrishnan;
impl Limit for Venkatakrishnan {
    #[inline(always)]
    fn factors<S: Scalar>(self, a: [S; 2], b: S, eps: S) -> [S; 2] {
        [self.factor(a[0], b, eps), self.factor(a[1], b, eps)]
    }
}
impl Venkatakrishnan {
    #[inline(always)]
    fn factor<S: Scalar>(self, a: S, b: S, eps: S) -> S {
        let (up, own) = (a * b, (a + b) * 0.25 * (a + b));
        let top = b * b + eps + (a + b) * (2.0 * 0.5) * b;
        let bottom = b * b + own * 2.0 + (a + b) * 0.5 * b + eps;
        let (zero, one) = (S::constant(0.0), S::constant(1.0));
        if (up + eps).value() <= 0.0 { zero } else { (top / bottom).max(zero).min(one) }
    }
}

/// No limiter.
#[derive(Clone, Copy)]
pub struct Unlimited;
impl Limit for Unlimited {
    #[inline(always)]
    fn factors<S: Scalar>(self, _: [S; 2], _: S, _: S) -> [S; 2] {
        [S::constant(1.0); 2]
    }
}

/// Order, κ and threshold of the reconstruction.
#[derive(Clone, Copy, Debug)]
pub struct Reconstruction {
    /// False: the states of the particles themselves (first order).
    pub second_order: bool,
    /// κ of the linear combination.
    pub kappa: f64,
    /// Relative difference below which the limiter does not act.
    pub threshold: f64,
    /// Jumps of the normal velocity are scaled with the Mach number, see [`low_mach_correction`].
    pub low_mach: bool,
}

/// Two states across `n` whose jump of the normal velocity is scaled by min(1, M), M the greater Mach number of the two, but by no
/// less than `least`.
///
/// An upwind flux damps that jump in proportion to the speed of sound, in slow flow 1/M times as much as convection asks for
/// (Thornber, Mosedale, Drikakis, Youngs and Williams 2008, J. Comput. Phys. 227; Rieper 2011, J. Comput. Phys. 230). The jump
/// along the edge's face, which is damped with the speed of the flow, stays as it is.
#[inline(always)]
pub fn low_mach_correction<const D: usize, S: Scalar>(
    gas: &Gas,
    l: Primitive<D, S>,
    r: Primitive<D, S>,
    (n, least): (&Vector<D, S>, f64),
) -> (Primitive<D, S>, Primitive<D, S>) {
    let one = S::constant(1.0);
    let mach2 = |q: &Primitive<D, S>| q.velocity.norm_squared() * q.density / (q.pressure * gas.gamma);
    let scale = mach2(&l).max(mach2(&r)).sqrt().min(one).max(S::constant(least));
    let half = *n * ((one - scale) * 0.5 * (r.velocity - l.velocity).dot(n));
    (Primitive { velocity: l.velocity + half, ..l }, Primitive { velocity: r.velocity - half, ..r })
}

/// The difference beyond either end of an edge over which a variable changes by `dq`.
#[inline(always)]
fn upwind<S: Scalar>(slopes: [S; 2], dq: S) -> [S; 2] {
    [slopes[0] * 2.0 - dq, slopes[1] * 2.0 - dq]
}

/// Part of the slopes that is kept between particles whose pressures are `p` and `q`: all of it up to a ratio of 2, none from 4 on.
#[inline(always)]
fn slope_kept<S: Scalar>(p: S, q: S) -> S {
    let jump = (q - p) / (q + p);
    S::constant(1.0) - smooth_step((jump * jump - JUMP[0]) * (1.0 / (JUMP[1] - JUMP[0])))
}

/// Part of the increment ± `change` of the state `own` that leaves a fraction of its density and its pressure.
#[inline(always)]
fn kept<const D: usize, S: Scalar>(own: &Primitive<D, S>, change: &Primitive<D, S>, sign: f64) -> S {
    let fall = (change.density * own.pressure * -sign).max(change.pressure * own.density * -sign);
    let most = own.density * own.pressure * (1.0 - POSITIVE);
    most / fall.max(most)
}

/// What a limiter leaves of the slopes at both ends of an edge, of every variable.
pub type Factors<const D: usize, S = f64> = [Primitive<D, S>; 2];

impl Reconstruction {
    /// States on both sides of the middle of an edge, from the states of its ends and their slopes along it.
    #[inline(always)]
    pub fn states<const D: usize, S: Scalar, L: Limit>(
        &self,
        gas: &Gas,
        limit: L,
        ends: (&Primitive<D, S>, &Primitive<D, S>),
        slopes: (&Primitive<D, S>, &Primitive<D, S>),
    ) -> (Primitive<D, S>, Primitive<D, S>) {
        if !self.second_order {
            return (*ends.0, *ends.1);
        }
        self.limited(ends, slopes, &self.factors(gas, limit, ends, slopes))
    }

    /// What the limiter leaves of the slopes.
    #[inline(always)]
    pub fn factors<const D: usize, S: Scalar, L: Limit>(
        &self,
        gas: &Gas,
        limit: L,
        (qi, qj): (&Primitive<D, S>, &Primitive<D, S>),
        (gi, gj): (&Primitive<D, S>, &Primitive<D, S>),
    ) -> Factors<D, S> {
        let dq = qj.minus(qi);
        let (density, pressure) = ((qi.density + qj.density) * 0.5, (qi.pressure + qj.pressure) * 0.5);
        let square = (self.threshold * self.threshold).max(LEAST_SQUARE);
        let sound2 = pressure * gas.gamma / density;
        let eps = (density * square * density, sound2 * square, pressure * square * pressure);
        let of = |slopes: [S; 2], dq: S, eps: S| limit.factors(upwind(slopes, dq), dq, eps);
        let zero = S::constant(0.0);
        let mut left = Primitive { density: zero, velocity: Vector::zero(), pressure: zero };
        let mut right = left;
        [left.density, right.density] = of([gi.density, gj.density], dq.density, eps.0);
        for d in 0..D {
            [left.velocity[d], right.velocity[d]] = of([gi.velocity[d], gj.velocity[d]], dq.velocity[d], eps.1);
        }
        [left.pressure, right.pressure] = of([gi.pressure, gj.pressure], dq.pressure, eps.2);
        [left, right]
    }

    /// States on both sides of the middle of an edge, of whose slopes the limiter leaves `factors`.
    #[inline(always)]
    pub fn limited<const D: usize, S: Scalar>(
        &self,
        (qi, qj): (&Primitive<D, S>, &Primitive<D, S>),
        (gi, gj): (&Primitive<D, S>, &Primitive<D, S>),
        [fi, fj]: &Factors<D, S>,
    ) -> (Primitive<D, S>, Primitive<D, S>) {
        let dq = qj.minus(qi);
        let zero = S::constant(0.0);
        let mut left = Primitive { density: zero, velocity: Vector::zero(), pressure: zero };
        let mut right = left;
        [left.density, right.density] = self.increments([gi.density, gj.density], dq.density, [fi.density, fj.density]);
        for d in 0..D {
            let (slopes, kept) = ([gi.velocity[d], gj.velocity[d]], [fi.velocity[d], fj.velocity[d]]);
            [left.velocity[d], right.velocity[d]] = self.increments(slopes, dq.velocity[d], kept);
        }
        [left.pressure, right.pressure] =
            self.increments([gi.pressure, gj.pressure], dq.pressure, [fi.pressure, fj.pressure]);
        let slope = slope_kept(qi.pressure, qj.pressure);
        (qi.plus(slope * kept(qi, &left, 1.0), &left), qj.plus(-(slope * kept(qj, &right, -1.0)), &right))
    }

    /// s/4 [(1 − κs) a + (1 + κs) b] of one variable at both ends.
    #[inline(always)]
    fn increments<S: Scalar>(&self, slopes: [S; 2], dq: S, s: [S; 2]) -> [S; 2] {
        let a = upwind(slopes, dq);
        [self.increment(a[0], dq, s[0]), self.increment(a[1], dq, s[1])]
    }

    #[inline(always)]
    fn increment<S: Scalar>(&self, a: S, b: S, s: S) -> S {
        s * 0.25 * (a + b + s * self.kappa * (b - a))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AIR: Gas = Gas { gamma: 1.4 };

    fn pair(mach: f64) -> [Primitive<2>; 2] {
        let state = |u: f64, v: f64| Primitive { density: 1.4, velocity: Vector([u, v]), pressure: 1.0 };
        [state(mach, 0.0), state(0.6 * mach, 0.3 * mach)]
    }

    #[test]
    fn slow_jumps_across_a_face_shrink_with_the_mach_number_and_those_along_it_stay() {
        let (n, t) = (Vector([0.6, 0.8]), Vector([-0.8, 0.6]));
        for mach in [1e-3, 0.1, 0.5, 1.0, 3.0] {
            let [l, r] = pair(mach);
            let (a, b) = low_mach_correction(&AIR, l, r, (&n, 0.0));
            let (before, after) = (r.velocity - l.velocity, b.velocity - a.velocity);
            assert!((after.dot(&n) - mach.min(1.0) * before.dot(&n)).abs() < 1e-15, "Mach {mach}");
            assert!((after.dot(&t) - before.dot(&t)).abs() < 1e-15);
            assert!((a.velocity + b.velocity - l.velocity - r.velocity).norm() < 1e-15, "the mean is kept");
            assert!(a.density == l.density && b.pressure == r.pressure);
            let same = low_mach_correction(&AIR, l, l, (&n, 0.0));
            assert!(same == (l, l), "consistent");
            assert!(low_mach_correction(&AIR, l, r, (&n, 1.0)) == (l, r), "waves leave");
        }
    }
}
