//! Structures of particles alone: equilibrium, marching and natural modes, without a gas.
mod balance;
mod cut;
mod fields;
pub(super) mod files;
mod filling;
mod inspect;
mod march;
mod material;
mod natural;
mod own_modes;
mod pace;
pub(super) mod pictures;
mod probes;
mod record;
mod saved;
pub(super) mod setup;
mod size;
mod spline_modes;
mod summary;
#[cfg(test)]
mod tests;
mod trial;

use std::path::Path;

use super::error::RunError;
use super::files::write_state_script;
use super::folder;
use super::monitor::Monitor;
use super::record::summary::Clock;
use crate::case::{Case, PlaneState, Temporal};
use crate::geometry::dimension;
use crate::solid::modes::{Mode, Wanted, modes};

pub(super) use inspect::inspect_in_gas;
pub use inspect::{SolidReport, inspect_structure};
pub(super) use own_modes::{told_of_own_modes, with_own_modes};
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

/// Refuses what can be said of structures but is not computed yet.
pub(super) fn supported(case: &Case) -> Result<(), RunError> {
    let any = |f: fn(&crate::case::Solid) -> bool| case.solids().any(|(_, _, s)| f(s));
    let asks = [
        (
            any(|s| s.plane == PlaneState::Axisymmetric) && any(|s| s.plane != PlaneState::Axisymmetric),
            "bodies of which some only are axisymmetric (`plane = \"axisymmetric\"`)",
        ),
        (differ(case), "bodies with different `damping` or `stiffness_damping`"),
        (
            case.contact.is_some() && !matches!(case.time, Temporal::Explicit(_)),
            "contact in other than explicit marches (`[contact]` needs `[time.explicit]`)",
        ),
    ];
    match asks.iter().filter(|a| a.0).map(|a| a.1).collect::<Vec<_>>()[..] {
        [] => Ok(()),
        ref missing => Err(RunError::Unsupported {
            what: format!("{} cannot be computed yet", missing.join(" and ")),
            hint: "leave it out",
        }),
    }
}

/// True where one body is damped in another way than the others.
fn differ(case: &Case) -> bool {
    let mut all = case.solids().map(|(_, _, s)| (s.damping.0, s.stiffness_damping.0));
    let first = all.next();
    all.any(|d| Some(d) != first)
}

/// Refuses what is computed of a gas where there is none.
pub(super) fn with_gas(case: &Case) -> Result<(), RunError> {
    supported(case)?;
    if case.has_gas() {
        return Ok(());
    }
    Err(RunError::Unsupported {
        what: "the case has no gas: a structure alone has no cloud, and no fields or loads of one".into(),
        hint: "`alula run` computes it",
    })
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
    let built = setup::build::<D>(case, input)?;
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
