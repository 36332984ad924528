//! How walls move.
use crate::math::Vector;
use crate::math::jet::Scalar;
use crate::motion::BodyMotion;

/// How a wall moves near an interface particle, beside its velocity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallMotion<const D: usize, S = f64> {
    /// Rows of ∂w/∂x: the rate of rotation, and of stretching where the wall bends.
    pub wall_velocity_gradient: [Vector<D, S>; D],
    /// Acceleration.
    pub acceleration: Vector<D, S>,
}

impl<const D: usize> WallMotion<D> {
    /// A wall that does not move.
    pub const AT_REST: Self = Self { wall_velocity_gradient: [Vector::ZERO; D], acceleration: Vector::ZERO };

    /// The same in axes that `turn` leads to from those of `self` and `back` from there.
    pub(super) fn turned(
        &self,
        turn: impl Fn(&Vector<D>) -> Vector<D>,
        back: impl Fn(&Vector<D>) -> Vector<D>,
    ) -> Self {
        let times = |v: &Vector<D>| Vector::from_fn(|i| self.wall_velocity_gradient[i].dot(v));
        let columns: [Vector<D>; D] = std::array::from_fn(|j| turn(&times(&back(&Vector::axis(j)))));
        let wall_velocity_gradient = std::array::from_fn(|i| Vector::from_fn(|j| columns[j][i]));
        Self { wall_velocity_gradient, acceleration: turn(&self.acceleration) }
    }
}

impl<const D: usize, S: Scalar> WallMotion<D, S> {
    /// A motion that no state changes.
    pub(super) fn constant(m: &WallMotion<D>) -> Self {
        Self {
            wall_velocity_gradient: m.wall_velocity_gradient.each_ref().map(Vector::constant),
            acceleration: Vector::constant(&m.acceleration),
        }
    }
}

/// ∂w/∂x of the rigid part of a motion in the axes of the case: Ṙ Rᵀ.
pub(super) fn rotation_rate<const D: usize>(law: &BodyMotion<D>, t: f64) -> [Vector<D>; D] {
    let pose = law.pose(t);
    let velocity = |x: &Vector<D>| law.kinematics_of(t, x, &[]).velocity;
    let base = velocity(&Vector::ZERO);
    let rates: [Vector<D>; D] = std::array::from_fn(|k| velocity(&Vector::axis(k)) - base);
    // rates[k] is column k of Ṙ
    std::array::from_fn(|i| Vector::from_fn(|j| (0..D).map(|k| rates[k][i] * pose.rotation[j][k]).sum()))
}
