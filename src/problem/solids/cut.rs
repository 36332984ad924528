//! Planes of symmetry at the sides of the domain of a gas that cut bodies made of particles.
use super::super::error::RunError;
use crate::case::{Case, Side};
use crate::cloud::CloudSpec;
use crate::math::{Bounds, Vector};

/// A plane of symmetry that cuts a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cut {
    /// Across which axis.
    pub(super) axis: usize,
    /// Its coordinate there.
    pub(super) place: f64,
    /// The body is on the side of smaller coordinates.
    pub(super) below: bool,
}

/// The planes of symmetry at the sides of the domain of the gas that cut a body within `bounds`.
pub(super) fn cuts<const D: usize>(case: &Case, bounds: &Bounds<D>) -> Vec<Cut> {
    if !case.has_gas() {
        return Vec::new();
    }
    let limits = CloudSpec::<D>::of_case(case).limits();
    let sides = case.boundary.pairs();
    let mut all = Vec::new();
    for axis in 0..D {
        for (below, place) in [(false, limits.min[axis]), (true, limits.max[axis])] {
            let beyond = if below { bounds.max[axis] > place } else { bounds.min[axis] < place };
            if sides[axis][usize::from(below)] == Side::Symmetry && beyond {
                all.push(Cut { axis, place, below });
            }
        }
    }
    all
}

/// The corners of a box along the axes without what is beyond the cuts.
pub(super) fn cut_off<const D: usize>(
    corners: Vec<Vector<D>>,
    cuts: &[Cut],
    name: &str,
) -> Result<Vec<Vector<D>>, RunError> {
    let bounds = Bounds::around(&corners);
    let at_end = |x: &Vector<D>, d: usize| x[d] == bounds.min[d] || x[d] == bounds.max[d];
    if !corners.iter().all(|x| (0..D).all(|d| at_end(x, d))) {
        return Err(uncut(name));
    }
    let cut = |mut x: Vector<D>| {
        for c in cuts {
            x[c.axis] = if c.below { x[c.axis].min(c.place) } else { x[c.axis].max(c.place) };
        }
        x
    };
    Ok(corners.into_iter().map(cut).collect())
}

/// The refusal of a body that no plane can cut.
pub(super) fn uncut(name: &str) -> RunError {
    RunError::Solid {
        what: format!(
            "a plane of symmetry at a side of the domain cuts `{name}`: only boxes along the axes can be cut"
        ),
        hint: "let the body end before the side, or make it a `box`".into(),
    }
}
