//! Rigid displacements x = R X + s.
use crate::math::Vector;
use crate::math::jet::Scalar;

/// A rotation followed by a translation, x ↦ R x + s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPose<const D: usize> {
    /// Rows of the rotation matrix R.
    pub rotation: [Vector<D>; D],
    /// Translation s.
    pub shift: Vector<D>,
}

impl<const D: usize> RigidPose<D> {
    /// The identity.
    pub fn identity() -> Self {
        Self { rotation: std::array::from_fn(Vector::axis), shift: Vector::ZERO }
    }

    /// Image of the point `x`.
    #[inline]
    pub fn point(&self, x: &Vector<D>) -> Vector<D> {
        self.direction(x) + self.shift
    }

    /// Image of the direction `v`.
    #[inline]
    pub fn direction<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        Vector::from_fn(|d| v.along(&self.rotation[d]))
    }

    /// The point whose image is `x`.
    #[inline]
    pub fn inverse_point(&self, x: &Vector<D>) -> Vector<D> {
        self.inverse_direction(&(*x - self.shift))
    }

    /// The direction whose image is `v`.
    #[inline]
    pub fn inverse_direction<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        let mut back = Vector::zero();
        for d in 0..D {
            back += Vector::from_fn(|c| v[d] * self.rotation[d][c]);
        }
        back
    }

    /// The inverse pose.
    pub fn inverse(&self) -> Self {
        let rotation = std::array::from_fn(|i| Vector::from_fn(|j| self.rotation[j][i]));
        Self { rotation, shift: -self.inverse_direction(&self.shift) }
    }

    /// The composition of this pose followed by `next`.
    pub fn then(&self, next: &Self) -> Self {
        let columns: [Vector<D>; D] =
            std::array::from_fn(|j| next.direction(&Vector::from_fn(|i| self.rotation[i][j])));
        let rotation = std::array::from_fn(|i| Vector::from_fn(|j| columns[j][i]));
        Self { rotation, shift: next.point(&self.shift) }
    }

    /// The pose that, applied after `from`, gives this one.
    pub fn relative_to(&self, from: &Self) -> Self {
        from.inverse().then(self)
    }
}
