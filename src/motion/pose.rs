//! Rigid displacements x = R X + s.
use crate::math::Vector;

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
    pub fn direction(&self, v: &Vector<D>) -> Vector<D> {
        Vector::from_fn(|d| self.rotation[d].dot(v))
    }

    /// The point that goes to `x`.
    #[inline]
    pub fn inverse_point(&self, x: &Vector<D>) -> Vector<D> {
        self.inverse_direction(&(*x - self.shift))
    }

    /// The direction that goes to `v`.
    #[inline]
    pub fn inverse_direction(&self, v: &Vector<D>) -> Vector<D> {
        let mut back = Vector::ZERO;
        for d in 0..D {
            back += self.rotation[d] * v[d];
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
