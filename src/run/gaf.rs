//! Generalised aerodynamic forces in folders.
use std::path::{Path, PathBuf};

use super::folder::{self, Places};
use super::refusals;
use crate::case::{Case, GafMethod};
use crate::geometry::dimension;
use crate::observe::columns::Scale;
use crate::problem::{Problem, RunError};
use crate::study::Monitor;
pub use crate::study::gaf::{CONVENTION, Column, Conditions, Errors, Matrices, Solved};
use crate::study::gaf::{blank, found, planned};

/// Computes the matrices of the table `[gaf]` into a fresh folder, or one where those of the same case were not all found; `None` when the
/// monitor says stop.
pub fn gaf(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    sought(case, places, monitor).map_err(|problem| refusals::with_other_files(case, &places.input, problem))
}

fn sought(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    let plan = planned(case)?;
    let _held = folder::create_once(case, &places.input, &places.out)?;
    let problem = Problem::of_case(case, &places.input)?;
    let mut matrices = blank(&problem, &plan);
    let scale = Scale { dimensional: case.flow.is_dimensional(), dimension: dimension(case).into() };
    let mut keep = |matrices: &Matrices| Ok(matrices.write(&plan.reduced_frequencies, scale, &places.out)?);
    if !found((&problem, &plan), &mut matrices, &mut keep, monitor)? {
        return Ok(None);
    }
    folder::finish(&places.out)?;
    Ok(Some(matrices))
}

/// Makes room for matrices that can be computed: earlier results in their folder are renamed; the new name, if there were any.
pub fn set_aside(case: &Case, places: &Places) -> Result<Option<PathBuf>, RunError> {
    folder::make_room(&places.out, || rehearse(case, &places.input))
}

/// The same without a folder.
pub fn in_memory(case: &Case, input: &Path, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    let plan = planned(case)?;
    let problem = Problem::of_case(case, input)?;
    let mut matrices = blank(&problem, &plan);
    let whole = found((&problem, &plan), &mut matrices, &mut |_| Ok(()), monitor)?;
    Ok(whole.then_some(matrices))
}

/// Refuses matrices of which it is known before any flow that they cannot be computed.
pub(super) fn rehearse(case: &Case, input: &Path) -> Result<(), RunError> {
    let plan = planned(case)?;
    let problem = Problem::of_case(case, input)?;
    if plan.method == GafMethod::Linear {
        return refusals::rehearse(&problem.about_steady_flow_of_gaf(&plan)?, true);
    }
    // the fastest motion asks most of a cloud
    let fastest = plan.reduced_frequencies.iter().copied().fold(0.0, f64::max);
    let rehearsed = |mode| refusals::rehearse(&problem.in_motion_of_gaf(&plan, mode, fastest, 1.0)?, true);
    plan.all_modes().try_for_each(rehearsed)
}
