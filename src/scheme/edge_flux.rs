//! The flux across an edge as a function of plain values.
use crate::math::Vector;

/// s/2V: what takes the place of a_ij when the coefficients are conservative.
#[inline(always)]
pub(super) fn half_face<const D: usize>(volume: f64, s: &Vector<D>) -> Vector<D> {
    *s * (0.5 / volume)
}
