//! Generalised aerodynamic forces: for each mode and reduced frequency a linear system about one steady flow, or two harmonic balances.
mod balance;
mod cloud_error;
mod linear;

pub use crate::record::gaf::{CONVENTION, Column, Conditions, Errors, Matrices, Solved};

use super::monitor::Monitor;
use crate::case::{Case, Gaf, GafMethod};
use crate::problem::{Problem, RunError, reference, supported};

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
    let (conditions, linearity) = (conditions(problem, plan), plan.linearity.unwrap_or(Gaf::LINEARITY));
    Matrices { modes, columns: Vec::new(), linearity, conditions }
}

/// The flow and the lengths that forces hold for.
fn conditions(problem: &Problem, plan: &Gaf) -> Conditions {
    let case = problem.given();
    let (chord, area) = match problem {
        Problem::Plane(problem) => {
            let chord = problem.surface().map_or(1.0, |s| reference::chord(case, Some(s)));
            (chord, chord)
        }
        Problem::Space(problem) => {
            let seen = problem.surface().map(|s| reference::planform(case, s));
            seen.map_or((1.0, 1.0), |seen| (seen.chord, seen.area))
        }
    };
    let stream = problem.reference();
    Conditions {
        mach: stream.mach,
        speed: stream.speed,
        dynamic_pressure: stream.dynamic_pressure(),
        alpha_deg: case.flow.alpha.0.to_degrees(),
        chord,
        area,
        reduced_length: plan.reduced_length.map_or(0.5 * chord, |l| l.0),
        pivot: plan.pivot.as_ref().map(|p| p.iter().map(|x| x.0).collect()),
    }
}
