//! A free rigid body in 3-D.
//!
//! The coordinates are the displacement d of the pivot p (`surge`, `sway`, `plunge` along x, y, z) and the rotation
//! vector θ (`roll`,
//! `pitch`, `yaw`: its components along x, y, z; `pitch` alone is nose up positive for a stream along x with lift along
//! z). A point X in
//! the initial placement moves to p + d + R(θ)(X − p); see [`crate::math::rotation`] for R and T. Rotations are exact
//! up to just below a full turn from the initial placement, where the rotation vector is singular;
//! [`super::Structure::fault`] reports this.
//!
//! With the mass m, the first moment s about the pivot, the inertia tensor J about the pivot in body axes, and ω = T
//! θ', Newton's and Euler's equations, the latter projected on θ, are
//!
//! m (d'' − g) + R(ω'×s + ω×(ω×s)) = Q_d, Tᵀ[J ω' + ω×Jω + s×Rᵀ(d'' − g)] = Q_θ.
use crate::math::jet::Scalar;
use crate::math::rotation::{
    Triple, body_acceleration, body_rate, constants, cross, dot, generalised_moment, rotate, rotate_back, sum,
};

/// Names of the coordinates, in their order.
pub(super) const NAMES: [&str; 6] = ["surge", "sway", "plunge", "roll", "pitch", "yaw"];
/// Greatest length of a rotation vector [rad]: half a degree less than a full turn, at which it is singular.
pub(super) const LARGEST_TURN: f64 = std::f64::consts::TAU - 0.01;

/// A rigid body in 3-D.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    /// Pivot p: reference point of the displacement and centre of rotation.
    pub pivot: [f64; 3],
    /// Mass m.
    pub mass: f64,
    /// First moment s: mass times the offset of the centre of mass from the pivot.
    pub static_moment: [f64; 3],
    /// Rows of the symmetric inertia tensor J about the pivot.
    pub inertia: [[f64; 3]; 3],
    /// Acceleration of gravity g.
    pub gravity: [f64; 3],
}

impl RigidBody {
    /// Left-hand sides of the equations, without springs and dampers.
    pub(super) fn inertial<S: Scalar>(&self, q: &[S], v: &[S], a: &[S]) -> Vec<S> {
        let triple = |x: &[S], from: usize| -> Triple<S> { [x[from], x[from + 1], x[from + 2]] };
        let (theta, rate, second) = (triple(q, 3), triple(v, 3), triple(a, 3));
        let omega = body_rate(&theta, &rate);
        let change = body_acceleration(&theta, &rate, &second);
        let s = constants(&self.static_moment);
        let swing = sum(&cross(&change, &s), &cross(&omega, &cross(&omega, &s)));
        let swing = rotate(&theta, &swing);
        let free: Triple<S> = std::array::from_fn(|i| a[i] - S::constant(self.gravity[i]));
        let spin = sum(&self.times(&change), &cross(&omega, &self.times(&omega)));
        let moment = sum(&spin, &cross(&s, &rotate_back(&theta, &free)));
        let moment = generalised_moment(&theta, &moment);
        (0..6).map(|i| if i < 3 { S::constant(self.mass) * free[i] + swing[i] } else { moment[i - 3] }).collect()
    }

    /// The product J x.
    fn times<S: Scalar>(&self, x: &Triple<S>) -> Triple<S> {
        std::array::from_fn(|i| dot(&constants(&self.inertia[i]), x))
    }

    /// Potential energy of gravity; zero in the initial placement.
    pub(super) fn weight_energy(&self, q: &[f64]) -> f64 {
        let (g, s) = (&self.gravity, &self.static_moment);
        let turned = rotate(&[q[3], q[4], q[5]], s);
        let fall = self.mass * dot(g, &[q[0], q[1], q[2]]) + dot(g, &turned) - dot(g, s);
        -fall
    }
}
