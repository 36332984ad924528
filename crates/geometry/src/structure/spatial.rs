//! A free rigid body in space.
//!
//! Coordinates are the displacement d of the pivot p (`surge`, `sway`, `plunge` along x, y, z) and the rotation vector θ (`roll`,
//! `pitch`, `yaw`: its components along x, y, z; `pitch` alone is nose up positive for a stream along x with lift along z). A
//! point X of the body as placed goes to p + d + R(θ)(X − p); see [`crate::math::rotation`] for R and T. Rotations are exact up to just under one
//! full turn from where the body was placed: there the rotation vector loses its meaning, and [`super::Structure::fault`] says so.
//!
//! With mass m, first moment s about the pivot and inertia tensor J about the pivot in axes of the body, ω = T θ' and Newton's and Euler's
//! laws, the latter projected on θ,
//!
//! m (d'' − g) + R(ω'×s + ω×(ω×s)) = Q_d, Tᵀ[J ω' + ω×Jω + s×Rᵀ(d'' − g)] = Q_θ.
use crate::math::jet::Scalar;
use crate::math::rotation::{
    Triple, body_acceleration, body_rate, constants, cross, dot, generalised_moment, rotate, rotate_back, sum,
};

/// Names of the coordinates, in their order.
pub(super) const NAMES: [&str; 6] = ["surge", "sway", "plunge", "roll", "pitch", "yaw"];
/// Greatest length of a rotation vector: half a degree short of the full turn at which it is singular.
pub(super) const LARGEST_TURN: f64 = std::f64::consts::TAU - 0.01;

/// A rigid body in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidBody {
    /// p, the point whose displacement is counted and about which the body turns.
    pub pivot: [f64; 3],
    /// m.
    pub mass: f64,
    /// s: mass times the offset of the centre of mass from the pivot.
    pub static_moment: [f64; 3],
    /// Rows of J about the pivot, symmetric.
    pub inertia: [[f64; 3]; 3],
    /// Acceleration of gravity g.
    pub gravity: [f64; 3],
}

impl RigidBody {
    /// Left sides of the equations, springs and dampers aside.
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

    /// J x.
    fn times<S: Scalar>(&self, x: &Triple<S>) -> Triple<S> {
        std::array::from_fn(|i| dot(&constants(&self.inertia[i]), x))
    }

    /// Potential of gravity, zero as placed.
    pub(super) fn weight_energy(&self, q: &[f64]) -> f64 {
        let (g, s) = (&self.gravity, &self.static_moment);
        let turned = rotate(&[q[3], q[4], q[5]], s);
        let fall = self.mass * dot(g, &[q[0], q[1], q[2]]) + dot(g, &turned) - dot(g, s);
        -fall
    }
}
