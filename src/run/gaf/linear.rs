//! All columns of the matrices as small motions about one steady flow.
//!
//! What the columns of harmonic balances tend to as their amplitudes go to nothing: one cloud, one steady flow, and a linear system for
//! each mode and frequency (`studies::forces`); the same on coarser clouds tells how far they are known. Rigid
//! modes are rotations and shifts, not displacement fields, so that forces of the steady flow turn with the body as they do there.
use std::path::Path;

use num_complex::Complex64;

use super::super::accuracy::Forces;
use super::super::error::RunError;
use super::super::monitor::{Monitor, Quiet};
use super::super::one_cloud::{BETWEEN, COARSER, coarser, on_one_cloud};
use super::super::record::Log;
use super::super::record::summary::Clock;
use super::super::session::{Outcome, Session};
use super::super::studies::{ForceSource, SOLVED};
use super::cloud_error;
use super::record::{Column, Matrices, Solved};
use crate::case::{AnyMode, Case, Cloud, Gaf, Mode};

/// Fills in the columns of all modes and frequencies of `plan` with their error bars, and calls `keep` after each frequency; false when
/// the monitor says stop.
pub(super) fn columns(
    (case, plan): (&Case, &Gaf),
    input: &Path,
    matrices: &mut Matrices,
    keep: &mut dyn FnMut(&Matrices) -> Result<(), RunError>,
    monitor: &mut dyn Monitor,
) -> Result<bool, RunError> {
    let steady = on_one_cloud(case.gaf_steady_case(plan), input, Forces::Table)?;
    let asked = Asked { case, plan, input, length: matrices.conditions.reduced_length };
    let mut add = |found: Vec<Column>| {
        matrices.columns.extend(found);
        keep(matrices)
    };
    let Some(Flow { cloud, solved, mut shocks }) = asked.about(&steady, &mut add, monitor)? else { return Ok(false) };
    if !solved {
        monitor.warn("the steady flow did not converge: forces about it are doubtful");
        matrices.columns.iter_mut().for_each(|c| c.converged = false);
        keep(matrices)?;
    }
    let one = Case { cloud, accuracy: None, ..steady };
    let mut others = Vec::new();
    for ratio in [COARSER, BETWEEN] {
        if !plan.cloud_error || (ratio != COARSER && !shocks) {
            break;
        }
        let Some(coarse) = coarser(&one, ratio) else { continue };
        monitor.note(&format!("the same on a cloud with {ratio} times the spacing"));
        let mut other = Vec::new();
        let mut add = |found: Vec<Column>| {
            other.extend(found);
            Ok(())
        };
        match asked.about(&coarse, &mut add, &mut Quiet { monitor }) {
            Ok(Some(flow)) if flow.solved => {
                shocks |= flow.shocks;
                others.push((ratio, other));
            }
            Ok(Some(_)) => monitor.note("the coarser cloud tells nothing: the steady flow on it did not converge"),
            Ok(None) => return Ok(false),
            // a cloud that is too coarse for the body tells nothing of the one that is not
            Err(problem) => monitor.note(&format!("the coarser cloud tells nothing: {problem}")),
        }
    }
    if coarser(&one, COARSER).is_none() {
        cloud_error::untold(plan, &one).iter().for_each(|why| monitor.note(why));
    }
    cloud_error::tell(&mut matrices.columns, &others);
    keep(matrices)?;
    Ok(true)
}

/// A steady flow that forces were found about.
struct Flow {
    cloud: Cloud,
    /// True where it came to rest.
    solved: bool,
    /// True where it is faster than sound somewhere.
    shocks: bool,
}

/// What is asked of a steady flow.
struct Asked<'a> {
    case: &'a Case,
    plan: &'a Gaf,
    input: &'a Path,
    /// Length of reduced frequencies.
    length: f64,
}

impl Asked<'_> {
    /// Hands the columns about the flow of the case `steady` to `add`, frequency by frequency; that flow, `None` when the monitor
    /// says stop.
    fn about(
        &self,
        steady: &Case,
        add: &mut dyn FnMut(Vec<Column>) -> Result<(), RunError>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Flow>, RunError> {
        let mut session = Session::open(steady, self.input)?;
        let (mut stopped, mut shocks) = (false, false);
        let mut then = |source: &mut dyn ForceSource, log: &mut Log<'_>| {
            shocks = source.is_supersonic();
            for &k in &self.plan.reduced_frequencies {
                stopped = stopped || log.stopped();
                if stopped {
                    break;
                }
                let found = at_frequency((self.case, self.plan), k, source, self.length);
                for column in &found {
                    let Some(solved) = column.solved else { continue };
                    log.note(&format!(
                        "k = {k}, {}: Cl {:+.4} {:+.4}i, Cm {:+.4} {:+.4}i, {} linear iterations, residual {:.0e}",
                        column.mode,
                        column.cl[0],
                        column.cl[1],
                        column.cm[0],
                        column.cm[1],
                        solved.iterations,
                        solved.left
                    ));
                }
                add(found)?;
            }
            Ok(())
        };
        let Outcome::Finished(summary) = session.solve_then(monitor, &mut then)? else { return Ok(None) };
        let solved = summary.succeeded();
        Ok((!stopped).then_some(Flow { cloud: summary.cloud, solved, shocks }))
    }
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
            errors: None,
            solved: Some(Solved { iterations: ended.iterations, left: ended.left }),
            cpu_seconds: clock.cpu_seconds() / n as f64,
            converged: ended.left <= SOLVED,
        }
    };
    plan.all_modes().enumerate().map(column).collect()
}
