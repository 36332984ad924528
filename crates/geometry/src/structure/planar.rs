//! A body in the plane: the typical section, with or without a flap, and the free rigid body.
//!
//! x points downstream, y up. Coordinates are displacements of the pivot p along x and y (`surge`, `plunge`, up positive), the
//! angle α (`pitch`, nose up positive, that is clockwise) and the angle β of the flap against the section (`flap`, trailing edge
//! down positive, clockwise as well). A point X of the body as placed goes to p + d + R(α)(X' − p), where X' = X ahead of the hinge
//! l + p, and R(β) turns it about the hinge behind. R is the clockwise rotation, J that by a quarter turn, J (x, y) = (y, −x).
//!
//! Let m be the mass (per span), S its first moment about the pivot, I its second, of the whole body with β = 0; S_β and I_β are those
//! of the flap about the hinge. With γ = α + β, S₀ = S − S_β and I₀ = I − I_β − 2 l·S_β, Lagrange's equations are
//!
//! m (d'' − g) + α'' RJS₀ − α'² RS₀ + γ'' R_γJS_β − γ'² R_γS_β = Q_d,
//!
//! e_α = I₀ α'' + RJS₀·(d'' − g) + RJl·(γ'' R_γJS_β − γ'² R_γS_β), e_γ = I_β γ'' + R_γJS_β·(d'' − g + α'' RJl − α'² Rl),
//! e_α + e_γ = Q_α and e_γ = Q_β. The *linear* section of the flutter literature has R = R_γ = 1 and no squares of rates: in its
//! notation, with plunge down, m h'' + S_α α'' + S_β β'' = …, and so on (Bisplinghoff, Ashley and Halfman 1955, section 9-2).
use crate::math::jet::Scalar;

/// Names of the coordinates, in their order.
pub(super) const NAMES: [&str; 4] = ["surge", "plunge", "pitch", "flap"];

/// How the inertia of a body depends on how far it has turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InertiaLaw {
    /// As if it had not turned: the equations of the flutter literature, for small angles.
    Linear,
    /// That of a rigid body, whatever the angle.
    Exact,
}

/// A trailing-edge flap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flap {
    /// A point of the hinge line, as placed.
    pub hinge: [f64; 2],
    /// S_β: mass of the flap times the offset of its centre of mass from the hinge.
    pub static_moment: [f64; 2],
    /// I_β about the hinge.
    pub inertia: f64,
    /// Length along x over which the surface goes from still to turning, centred on the hinge; zero: a kink.
    pub blend: f64,
}

/// A rigid body in the plane; quantities are per unit span.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarBody {
    /// p, the point whose displacement is counted and about which angles turn: the elastic axis.
    pub pivot: [f64; 2],
    /// m.
    pub mass: f64,
    /// S: mass times the offset of the centre of mass from the pivot.
    pub static_moment: [f64; 2],
    /// I about the pivot.
    pub inertia: f64,
    /// The flap, whose mass is part of m, S and I.
    pub flap: Option<Flap>,
    /// Acceleration of gravity g.
    pub gravity: [f64; 2],
    /// Small or any angles.
    pub law: InertiaLaw,
}

type Pair<S> = [S; 2];

/// R(angle) x.
pub(super) fn turn<S: Scalar>(angle: S, x: &Pair<S>) -> Pair<S> {
    let (sine, cosine) = (angle.sin(), angle.cos());
    [cosine * x[0] + sine * x[1], cosine * x[1] - sine * x[0]]
}

/// J x.
fn quarter<S: Scalar>(x: &Pair<S>) -> Pair<S> {
    [x[1], -x[0]]
}

fn dot<S: Scalar>(a: &Pair<S>, b: &Pair<S>) -> S {
    a[0] * b[0] + a[1] * b[1]
}

/// A vector fixed to a body that has turned by `angle`, what that body does, and the acceleration of the vector's end.
struct Arm<S> {
    /// RJv: how the end moves per angle.
    lever: Pair<S>,
    /// angle'' RJv − angle'² Rv.
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
    /// Flap of no mass at the pivot where there is none.
    fn flap_or_none(&self) -> Flap {
        let none = Flap { hinge: self.pivot, static_moment: [0.0; 2], inertia: 0.0, blend: 0.0 };
        self.flap.unwrap_or(none)
    }

    /// Hinge less pivot, l.
    fn offset(&self) -> [f64; 2] {
        let hinge = self.flap_or_none().hinge;
        std::array::from_fn(|i| hinge[i] - self.pivot[i])
    }

    /// S₀.
    fn main_moment(&self) -> [f64; 2] {
        let flap = self.flap_or_none();
        std::array::from_fn(|i| self.static_moment[i] - flap.static_moment[i])
    }

    /// Left sides of the equations, springs and dampers aside.
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

    /// Potential of gravity, zero as placed.
    pub(super) fn weight_energy(&self, q: &[f64]) -> f64 {
        let parts = [(self.main_moment(), q[2]), (self.flap_or_none().static_moment, q[2] + q[3])];
        let rise = parts.map(|(s, angle)| match self.law {
            InertiaLaw::Linear => dot(&self.gravity, &quarter(&s)) * angle,
            InertiaLaw::Exact => dot(&self.gravity, &turn(angle, &s)) - dot(&self.gravity, &s),
        });
        -self.mass * (self.gravity[0] * q[0] + self.gravity[1] * q[1]) - rise[0] - rise[1]
    }
}
