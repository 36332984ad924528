//! Rigid displacements x = R X + s.
use crate::math::Vector;
use crate::math::jet::Scalar;

/// A rotation followed by a shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPose<const D: usize> {
    /// Rows of the rotation matrix R.
    pub rotation: [Vector<D>; D],
    /// Shift s.
    pub shift: Vector<D>,
}

impl<const D: usize> RigidPose<D> {
    /// Nothing moves.
    pub fn identity() -> Self {
        Self { rotation: std::array::from_fn(Vector::axis), shift: Vector::ZERO }
    }

    /// Where the point `x` goes.
    #[inline]
    pub fn point(&self, x: &Vector<D>) -> Vector<D> {
        self.direction(x) + self.shift
    }

    /// Where the direction `v` points.
    #[inline]
    pub fn direction<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        Vector::from_fn(|d| v.along(&self.rotation[d]))
    }

    /// The point that goes to `x`.
    #[inline]
    pub fn inverse_point(&self, x: &Vector<D>) -> Vector<D> {
        self.inverse_direction(&(*x - self.shift))
    }

    /// The direction that goes to `v`.
    #[inline]
    pub fn inverse_direction<S: Scalar>(&self, v: &Vector<D, S>) -> Vector<D, S> {
        let mut back = Vector::zero();
        for d in 0..D {
            back += Vector::from_fn(|c| v[d] * self.rotation[d][c]);
        }
        back
    }

    /// The pose that undoes this one.
    pub fn inverse(&self) -> Self {
        let rotation = std::array::from_fn(|i| Vector::from_fn(|j| self.rotation[j][i]));
        Self { rotation, shift: -self.inverse_direction(&self.shift) }
    }

    /// This pose, then `next`.
    pub fn then(&self, next: &Self) -> Self {
        let columns: [Vector<D>; D] =
            std::array::from_fn(|j| next.direction(&Vector::from_fn(|i| self.rotation[i][j])));
        let rotation = std::array::from_fn(|i| Vector::from_fn(|j| columns[j][i]));
        Self { rotation, shift: next.point(&self.shift) }
    }

    /// What takes the pose `from` to this one.
    pub fn relative_to(&self, from: &Self) -> Self {
        from.inverse().then(self)
    }
}
