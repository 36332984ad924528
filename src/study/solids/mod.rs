//! Structures of particles alone: equilibrium, marching and natural modes, without a gas.
mod balance;
mod fields;
mod keeper;
mod march;
mod pace;
mod record;
mod summary;

use std::path::Path;

use super::monitor::Monitor;
use super::record::work::Clock;
use crate::case::{Case, Temporal};
use crate::geometry::dimension;
use crate::problem::RunError;
use crate::problem::solids::{Filling, supported};
use crate::solid::modes::{ModeRequest, modes};

pub use record::{ModeRow, PeriodicRow, ProbeHarmonic, ProbeRow, SolidLedger, SolidSolution, SolidSummary};

pub(crate) use balance::possible;
pub(crate) use fields::{columns, history, places, snapshot, stresses, von_mises};
pub(crate) use keeper::{SolidKeeper, SolidsKeeper, Sought, Standing};
pub(crate) use march::Marched;
pub(crate) use record::{Row, Work};

use march::Study;
use summary::Ending;

/// How a structure alone ended.
pub enum Ended {
    /// At its end.
    Finished(Box<SolidSolution>),
    /// Told to stop after so many steps.
    Interrupted(u64),
}

/// Solves a structure alone whose case names files in the folder `input`.
pub(crate) fn solve(
    (case, input): (&Case, &Path),
    keeper: Option<&dyn SolidsKeeper>,
    monitor: &mut dyn Monitor,
) -> Result<Ended, RunError> {
    supported(case)?;
    match dimension(case) {
        2 => study::<2>((case, input), keeper.map(|keeper| keeper as &dyn SolidKeeper<2>), monitor),
        _ => study::<3>((case, input), keeper.map(|keeper| keeper as &dyn SolidKeeper<3>), monitor),
    }
}

fn study<const D: usize>(
    (case, input): (&Case, &Path),
    keeper: Option<&dyn SolidKeeper<D>>,
    monitor: &mut dyn Monitor,
) -> Result<Ended, RunError> {
    let clock = Clock::start();
    let built = Filling::of(case, input).build::<D>()?;
    built.notes.iter().for_each(|n| monitor.note(n));
    built.warnings.iter().for_each(|w| monitor.warn(w));
    let start = built.structure.start(|i| built.velocity[i]);
    let study = Study { case, built: &built, keeper };
    let marched = match &case.time {
        Temporal::Modes(plan) if !plan.preload => Marched::at_rest(&built, start),
        Temporal::Harmonics(plan) => balance::solve(&study, plan, monitor)?,
        _ => study.march(start, monitor)?,
    };
    if marched.stopped {
        return Ok(Ended::Interrupted(marched.iteration));
    }
    let found = match &case.time {
        Temporal::Modes(plan) => {
            let above = plan.shift.map_or(0.0, |f| f.0);
            let wanted = ModeRequest { count: plan.number as usize, above };
            modes(&built.structure, &marched.state, &wanted)
                .map_err(|e| RunError::Solid { what: e.to_string(), hint: "see the guide `structures`".into() })?
        }
        _ => Vec::new(),
    };
    let solution = Box::new(summary::solution(&study, &Ending { marched: &marched, modes: &found, clock: &clock }));
    keeper.map_or(Ok(()), |keeper| keeper.end(&built, (&marched.state, &found), &solution.summary))?;
    Ok(Ended::Finished(solution))
}
