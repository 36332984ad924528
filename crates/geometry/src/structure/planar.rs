//! A body in 2-D: the typical section, with or without a flap, and the free rigid body.
//!
//! x is directed downstream and y up. The coordinates are the displacements of the pivot p along x and y (`surge` and
//! `plunge`, up positive), the angle α (`pitch`, nose up positive, that is clockwise) and the angle β of the flap
//! relative to the section (`flap`, trailing edge down positive, also clockwise). A point X in the initial placement
//! moves to p + d + R(α)(X' − p), where X' = X ahead of the hinge l + p; behind it, R(β) rotates it about the hinge. R
//! is the clockwise rotation and J that by a quarter turn, J (x, y) = (y, −x).
//!
//! Let m be the mass (per span), S the first moment about the pivot and I the moment of inertia about it, of the whole
//! body with β = 0; S_β and I_β are those of the flap about the hinge. With γ = α + β, S₀ = S − S_β and I₀ = I − I_β −
//! 2 l·S_β, Lagrange's equations are
//!
//! m (d'' − g) + α'' RJS₀ − α'² RS₀ + γ'' R_γJS_β − γ'² R_γS_β = Q_d,
//!
//! e_α = I₀ α'' + RJS₀·(d'' − g) + RJl·(γ'' R_γJS_β − γ'² R_γS_β), e_γ = I_β γ'' + R_γJS_β·(d'' − g + α'' RJl − α'²
//! Rl), e_α + e_γ = Q_α and e_γ = Q_β. The *linear* section of the flutter literature has R = R_γ = 1 and no squares of
//! rates: in its notation, with plunge down positive, m h'' + S_α α'' + S_β β'' = …, and so on (Bisplinghoff, Ashley
//! and Halfman 1955, section 9-2).
use crate::math::jet::Scalar;

/// Names of the coordinates, in their order.
pub(super) const NAMES: [&str; 4] = ["surge", "plunge", "pitch", "flap"];

/// Dependence of the inertia of a body on its rotation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InertiaLaw {
    /// Inertia of the unrotated body: the equations of the flutter literature, for small angles.
    Linear,
    /// Exact inertia of a rigid body at any angle.
    Exact,
}

/// A trailing-edge flap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flap {
    /// A point of the hinge line in the initial placement.
    pub hinge: [f64; 2],
    /// First moment S_β: mass of the flap times the offset of its centre of mass from the hinge.
    pub static_moment: [f64; 2],
    /// Moment of inertia I_β about the hinge.
    pub inertia: f64,
    /// Length along x, centred on the hinge, over which the rotation of the surface increases to its full value; zero:
    /// a kink.
    pub blend: f64,
}

/// A rigid body in 2-D; all quantities are per unit span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarBody {
    /// Pivot p: reference point of the displacement and centre of rotation (elastic axis).
    pub pivot: [f64; 2],
    /// Mass m.
    pub mass: f64,
    /// First moment S: mass times the offset of the centre of mass from the pivot.
    pub static_moment: [f64; 2],
    /// Moment of inertia I about the pivot.
    pub inertia: f64,
    /// The flap; its mass is included in m, S and I.
    pub flap: Option<Flap>,
    /// Acceleration of gravity g.
    pub gravity: [f64; 2],
    /// Inertia for small angles or for any angle.
    pub law: InertiaLaw,
}

type Pair<S> = [S; 2];

/// The rotated vector R(angle) x.
pub(super) fn turn<S: Scalar>(angle: S, x: &Pair<S>) -> Pair<S> {
    let (sine, cosine) = (angle.sin(), angle.cos());
    [cosine * x[0] + sine * x[1], cosine * x[1] - sine * x[0]]
}

/// The vector J x, rotated by a quarter turn.
fn quarter<S: Scalar>(x: &Pair<S>) -> Pair<S> {
    [x[1], -x[0]]
}

fn dot<S: Scalar>(a: &Pair<S>, b: &Pair<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// A vector fixed to a rotating body: lever arm and acceleration of its end.
struct Arm<S> {
    /// Lever arm RJv: derivative of the position of the end by the angle.
    lever: Pair<S>,
    /// Acceleration of the end, angle'' RJv − angle'² Rv.
    acceleration: Pair<S>,
}

/// An angle with its rate and acceleration.
#[derive(Clone, Copy)]
struct Turning<S> {
    angle: S,
    rate: S,
    second: S,
}

impl<S: Scalar> Turning<S> {
    fn arm(&self, v: &[f64; 2]) -> Arm<S> {
        let along = turn(self.angle, &v.map(S::constant));
        let lever = quarter(&along);
        let acceleration = std::array::from_fn(|i| self.second * lever[i] - self.rate * self.rate * along[i]);
        Arm { lever, acceleration }
    }
}

impl PlanarBody {
    /// The flap, or a massless one at the pivot where there is none.
    fn flap_or_none(&self) -> Flap {
        let none = Flap { hinge: self.pivot, static_moment: [0.0; 2], inertia: 0.0, blend: 0.0 };
        self.flap.unwrap_or(none)
    }

    /// Offset l of the hinge from the pivot.
    fn offset(&self) -> [f64; 2] {
        let hinge = self.flap_or_none().hinge;
        std::array::from_fn(|i| hinge[i] - self.pivot[i])
    }

    /// First moment S₀ of the main part.
    fn main_moment(&self) -> [f64; 2] {
        let flap = self.flap_or_none();
        std::array::from_fn(|i| self.static_moment[i] - flap.static_moment[i])
    }

    /// Left-hand sides of the equations, without springs and dampers.
    pub(super) fn inertial<S: Scalar>(&self, q: &[S], v: &[S], a: &[S]) -> Vec<S> {
        let zero = S::constant(0.0);
        let (flap, l) = (self.flap_or_none(), self.offset());
        let turning = |angle: S, rate: S, second: S| match self.law {
            InertiaLaw::Linear => Turning { angle: zero, rate: zero, second },
            InertiaLaw::Exact => Turning { angle, rate, second },
        };
        let main = turning(q[2], v[2], a[2]);
        let tail = turning(q[2] + q[3], v[2] + v[3], a[2] + a[3]);
        let (body, arm, rear) = (main.arm(&self.main_moment()), main.arm(&l), tail.arm(&flap.static_moment));
        let free = std::array::from_fn(|i| a[i] - S::constant(self.gravity[i]));
        let coupling = l[0] * flap.static_moment[0] + l[1] * flap.static_moment[1];
        let remaining = S::constant(self.inertia - flap.inertia - 2.0 * coupling);
        let hinge: Pair<S> = std::array::from_fn(|i| free[i] + arm.acceleration[i]);
        let on_section = remaining * a[2] + dot(&body.lever, &free) + dot(&arm.lever, &rear.acceleration);
        let on_flap = S::constant(flap.inertia) * (a[2] + a[3]) + dot(&rear.lever, &hinge);
        let along = |i: usize| S::constant(self.mass) * free[i] + body.acceleration[i] + rear.acceleration[i];
        vec![along(0), along(1), on_section + on_flap, on_flap]
    }

    /// Potential energy of gravity; zero in the initial placement.
    pub(super) fn weight_energy(&self, q: &[f64]) -> f64 {
        let parts = [(self.main_moment(), q[2]), (self.flap_or_none().static_moment, q[2] + q[3])];
        let rise = parts.map(|(s, angle)| match self.law {
            InertiaLaw::Linear => dot(&self.gravity, &quarter(&s)) * angle,
            InertiaLaw::Exact => dot(&self.gravity, &turn(angle, &s)) - dot(&self.gravity, &s),
        });
        -self.mass * (self.gravity[0] * q[0] + self.gravity[1] * q[1]) - rise[0] - rise[1]
    }
}
