//! Generalised aerodynamic forces: for each mode and reduced frequency a linear system about one steady flow, or two harmonic balances.
mod balance;
mod cloud_error;
mod linear;
mod record;

pub use record::{CONVENTION, Column, Conditions, Errors, Matrices, Solved};

use std::path::Path;

use super::folder::{self, Places};
use super::monitor::Monitor;
use super::refusals;
use crate::case::{Case, Gaf, GafMethod};
use crate::geometry::dimension;
use crate::observe::columns::Scale;
use crate::problem::{Problem, RunError, supported};

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
    let mut keep = |matrices: &Matrices| matrices.write(&plan.reduced_frequencies, scale, &places.out);
    if !found((&problem, &plan), &mut matrices, &mut keep, monitor)? {
        return Ok(None);
    }
    folder::finish(&places.out)?;
    Ok(Some(matrices))
}

/// The same without a folder.
pub fn in_memory(case: &Case, input: &Path, monitor: &mut dyn Monitor) -> Result<Option<Matrices>, RunError> {
    let plan = planned(case)?;
    let problem = Problem::of_case(case, input)?;
    let mut matrices = blank(&problem, &plan);
    let whole = found((&problem, &plan), &mut matrices, &mut |_| Ok(()), monitor)?;
    Ok(whole.then_some(matrices))
}

/// Finds all columns and calls `keep` after each; false when the monitor says stop.
fn found(
    plan: (&Problem, &Gaf),
    matrices: &mut Matrices,
    keep: &mut dyn FnMut(&Matrices) -> Result<(), RunError>,
    monitor: &mut dyn Monitor,
) -> Result<bool, RunError> {
    match plan.1.method {
        GafMethod::Linear => linear::columns(plan, matrices, keep, monitor),
        GafMethod::Balance => balance::columns(plan, matrices, keep, monitor),
    }
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

fn planned(case: &Case) -> Result<Gaf, RunError> {
    let Some(plan) = case.gaf.clone() else {
        return Err(RunError::Unsupported {
            what: "the case has no table `[gaf]`".into(),
            hint: "add one with `reduced_frequencies`",
        });
    };
    supported(case)?;
    Ok(plan)
}

/// Matrices of which no column is known.
fn blank(problem: &Problem, plan: &Gaf) -> Matrices {
    let modes = plan.all_modes().map(|m| m.name().to_owned()).collect();
    let (conditions, linearity) = (Conditions::of(problem, plan), plan.linearity.unwrap_or(Gaf::LINEARITY));
    Matrices { modes, columns: Vec::new(), linearity, conditions }
}
