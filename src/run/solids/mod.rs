//! Structures of particles alone: equilibrium, marching and natural modes, without a gas.
mod balance;
mod fields;
pub(super) mod files;
mod inspect;
mod march;
mod pace;
pub(super) mod pictures;
mod record;
mod saved;
mod summary;
#[cfg(test)]
mod tests;
mod trial;

use std::path::Path;

use super::files::write_state_script;
use super::folder;
use super::monitor::Monitor;
use super::record::summary::Clock;
use crate::case::{Case, Temporal};
use crate::geometry::dimension;
use crate::problem::RunError;
use crate::problem::solids::{build, supported};
use crate::solid::modes::{Mode, Wanted, modes};

pub(super) use inspect::inspect_in_gas;
pub use inspect::{SolidReport, inspect_structure};
pub use record::{ModeRow, PeriodicRow, ProbeHarmonic, ProbeRow, SolidLedger, SolidSolution, SolidSummary};

pub(super) use fields::{snapshot, von_mises};
pub(super) use saved::Saved;

use files::Files;
use march::{Marched, Study};
use summary::Ending;

/// How a structure alone ended.
pub enum Ended {
    /// At its end.
    Finished(Box<SolidSolution>),
    /// Told to stop after so many steps.
    Interrupted(u64),
}

/// A structure alone that is to be computed.
#[derive(Clone, Copy)]
pub(super) struct Job<'a> {
    pub(super) case: &'a Case,
    /// Folder that file names of the case refer to.
    pub(super) input: &'a Path,
    /// Folder of the run; nothing is written without one.
    pub(super) out: Option<&'a Path>,
    /// The checkpoint that it goes on from; from its start without one.
    pub(super) from: Option<&'a Saved>,
}

/// Solves a structure alone.
pub(super) fn solve(job: &Job<'_>, monitor: &mut dyn Monitor) -> Result<Ended, RunError> {
    supported(job.case)?;
    match dimension(job.case) {
        2 => study::<2>(job, monitor),
        _ => study::<3>(job, monitor),
    }
}

fn study<const D: usize>(job: &Job<'_>, monitor: &mut dyn Monitor) -> Result<Ended, RunError> {
    let Job { case, input, out, from } = *job;
    let clock = Clock::start();
    let built = build::<D>(case, input)?;
    built.notes.iter().for_each(|n| monitor.note(n));
    built.warnings.iter().for_each(|w| monitor.warn(w));
    let files = Files { case, out };
    let start = built.structure.start(|i| built.velocity[i]);
    let study = Study { case, built: &built, files: &files };
    let marched = match &case.time {
        Temporal::Modes(plan) if !plan.preload => Marched::at_rest(&built, start),
        Temporal::Harmonics(plan) => balance::solve(&study, plan, from, monitor)?,
        _ => study.march(start, from, monitor)?,
    };
    if marched.stopped {
        return Ok(Ended::Interrupted(marched.iteration));
    }
    let found = match &case.time {
        Temporal::Modes(plan) => {
            let above = plan.shift.map_or(0.0, |f| f.0);
            let wanted = Wanted { count: plan.number as usize, above };
            modes(&built.structure, &marched.state, &wanted)
                .map_err(|e| RunError::Solid { what: e.to_string(), hint: "see the guide `structures`".into() })?
        }
        _ => Vec::new(),
    };
    conclude(&study, &Ending { marched: &marched, modes: &found, clock: &clock })
}

/// Writes what was found.
fn conclude<const D: usize>(study: &Study<'_, D>, ending: &Ending<'_>) -> Result<Ended, RunError> {
    let found = Box::new(summary::solution(study, ending));
    let Some(out) = study.files.out else { return Ok(Ended::Finished(found)) };
    study.files.fields(("solid", Some(found.summary.time)), study.built, &ending.marched.state)?;
    if ending.modes.is_empty() {
        study.files.pictures(study.built, &ending.marched.state)?;
    }
    let write = |(k, mode): (usize, &Mode)| study.files.mode(k, study.built, mode);
    ending.modes.iter().enumerate().try_for_each(write)?;
    study.files.summary(&found.summary)?;
    write_state_script(out)?;
    study.files.report()?;
    folder::finish(out)?;
    Ok(Ended::Finished(found))
}
