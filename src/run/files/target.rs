//! Where files go, and what pictures are drawn from.
use std::path::Path;

use crate::case::Case;
use crate::geometry::Surface;
use crate::record::summary::TipVortex;
use crate::scheme::View;

/// Where files of a case go.
#[derive(Clone, Copy)]
pub(crate) struct Target<'a> {
    /// The case.
    pub(crate) case: &'a Case,
    /// The folder.
    pub(crate) out: &'a Path,
}

/// What the pictures are drawn from.
pub(crate) struct Scene<'a, const D: usize> {
    /// Where they go.
    pub(crate) to: Target<'a>,
    /// The gas with its gradients.
    pub(crate) view: View<'a, D>,
    /// Bodies.
    pub(crate) surface: Option<&'a Surface<D>>,
    /// Chord of the loads.
    pub(crate) chord: f64,
    /// The vortex behind the tip, where there is one.
    pub(crate) vortex: Option<TipVortex>,
}
