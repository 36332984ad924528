//! The side of the domain that is a plane of symmetry across the span.
use crate::case::{Case, Side};
use crate::math::Bounds;

/// Where it stands along y, and 1 where the gas is at greater y, -1 where at less; `None` where no side across y is one.
pub(crate) fn side_of_symmetry<const D: usize>(case: &Case, domain: &Bounds<D>) -> Option<(f64, f64)> {
    match (&case.boundary.y_min, &case.boundary.y_max) {
        (Side::Symmetry, _) => Some((domain.min[1], 1.0)),
        (_, Side::Symmetry) => Some((domain.max[1], -1.0)),
        _ => None,
    }
}
