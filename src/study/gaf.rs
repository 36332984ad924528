//! Generalised aerodynamic forces: for each mode and reduced frequency a linear system about one steady flow, or two harmonic balances.
mod balance;
mod cloud_error;
mod linear;
mod record;

pub use record::{CONVENTION, Column, Conditions, Errors, Matrices, Solved};

use super::monitor::Monitor;
use crate::case::{Case, Gaf, GafMethod};
use crate::problem::{Problem, RunError, supported};

/// Finds all columns and calls `keep` after each; false when the monitor says stop.
pub(crate) fn found(
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

/// The table `[gaf]`.
pub(crate) fn planned(case: &Case) -> Result<Gaf, RunError> {
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
pub(crate) fn blank(problem: &Problem, plan: &Gaf) -> Matrices {
    let modes = plan.all_modes().map(|m| m.name().to_owned()).collect();
    let (conditions, linearity) = (Conditions::of(problem, plan), plan.linearity.unwrap_or(Gaf::LINEARITY));
    Matrices { modes, columns: Vec::new(), linearity, conditions }
}
