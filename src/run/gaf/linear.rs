//! All columns of the matrices as small motions about one steady flow.
//!
//! What the columns of harmonic balances tend to as their amplitudes go to nothing: one cloud, one steady flow, and a linear system for
//! each mode and frequency (`studies::forces`). Rigid modes are rotations and shifts, not displacement fields, so that forces of the
//! steady flow turn with the body as they do there.
use std::path::Path;

use num_complex::Complex64;

use super::super::error::RunError;
use super::super::monitor::Monitor;
use super::super::one_cloud::on_one_cloud;
use super::super::record::Log;
use super::super::record::summary::Clock;
use super::super::session::{Outcome, Session};
use super::super::studies::{ForceSource, SOLVED};
use super::record::{Column, Matrices, Solved};
use crate::case::{AnyMode, Case, Gaf, Mode};

/// Fills in the columns of all modes and frequencies of `plan`, and calls `keep` after each frequency; false when the monitor says
/// stop.
pub(super) fn columns(
    (case, plan): (&Case, &Gaf),
    input: &Path,
    matrices: &mut Matrices,
    keep: &mut dyn FnMut(&Matrices) -> Result<(), RunError>,
    monitor: &mut dyn Monitor,
) -> Result<bool, RunError> {
    let steady = on_one_cloud(case.gaf_steady_case(plan), input)?;
    let mut session = Session::open(&steady, input)?;
    let mut stopped = false;
    let mut then = |source: &mut dyn ForceSource, log: &mut Log<'_>| {
        for &k in &plan.reduced_frequencies {
            stopped = stopped || log.stopped();
            if stopped {
                break;
            }
            let found = at_frequency((case, plan), k, source, matrices.conditions.reduced_length);
            for column in &found {
                let Some(solved) = column.solved else { continue };
                log.note(&format!(
                    "k = {k}, {}: Cl {:+.4} {:+.4}i, Cm {:+.4} {:+.4}i, {} linear iterations, residual {:.0e}",
                    column.mode, column.cl[0], column.cl[1], column.cm[0], column.cm[1], solved.iterations, solved.left
                ));
            }
            matrices.columns.extend(found);
            keep(matrices)?;
        }
        Ok(())
    };
    let outcome = session.solve_then(monitor, Some(&mut then))?;
    let Outcome::Finished(summary) = outcome else { return Ok(false) };
    if !summary.succeeded() {
        monitor.warn("the steady flow did not converge: forces about it are doubtful");
        matrices.columns.iter_mut().for_each(|c| c.converged = false);
        keep(matrices)?;
    }
    Ok(!stopped)
}

/// The columns at the reduced frequency `k`; `length` is that of reduced frequencies, and of the coordinate of plunge.
fn at_frequency((case, plan): (&Case, &Gaf), k: f64, source: &mut dyn ForceSource, length: f64) -> Vec<Column> {
    let clock = Clock::start();
    let (scale, forces) = (source.work_scale(), source.forces(k * case.flow.reference().mach / length));
    let unit = |mode: &AnyMode<'_>| if *mode == AnyMode::Rigid(Mode::Plunge) { length } else { 1.0 };
    let units: Vec<f64> = plan.all_modes().map(|mode| unit(&mode)).collect();
    let (n, parts) = (units.len(), |c: Complex64| [c.re, c.im]);
    let column = |(j, mode): (usize, AnyMode<'_>)| {
        let force = |i: usize| parts(forces.generalised[i * n + j] * (units[i] * units[j] / scale));
        let [cl, cm] = forces.coefficients[j].map(|c| parts(c * units[j]));
        let ended = forces.ended[j];
        Column {
            k,
            mode: mode.name().to_owned(),
            cl,
            cm,
            q: (0..n).map(force).collect(),
            nonlinearity: None,
            solved: Some(Solved { iterations: ended.iterations, left: ended.left }),
            cpu_seconds: clock.cpu_seconds() / n as f64,
            converged: ended.left <= SOLVED,
        }
    };
    plan.all_modes().enumerate().map(column).collect()
}
