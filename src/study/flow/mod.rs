//! The flow of a gas around the bodies of a problem: solved stage by stage, asked for forces, looked at.
//!
//! A run is a plain list of [stages](super::stage): coarse clouds that give a steady case its start, the cloud of the case, one
//! cloud for each cycle of adaptation, a march, more and more harmonics. Every stage builds its cloud, takes over the state of
//! the one before by the solver's own fit, and is driven. [`solve`] is the only place that chooses between dimensions, and between a gas
//! alone and one with structures; what it returns hides both.
mod end;
mod stages;
mod start;

use std::sync::Arc;

use super::keeper::{Camera, Keeper};
use super::monitor::Monitor;
use super::record::Log;
use super::record::saved::Saved;
use super::solution::Solution;
use super::studies::ForceSource;
use crate::problem::{Problem, ProblemIn, Remark, RunError, coupled};
use crate::record::summary::Summary;
use stages::Stages;

/// State that a run begins with.
pub(crate) enum Origin {
    /// The start of the case.
    Case,
    /// Its own checkpoint.
    Own(Box<Saved<'static>>),
    /// The last state of another run.
    Other(Box<Saved<'static>>),
}

/// How a flow is to be solved.
pub(crate) struct Way {
    /// What it begins with.
    pub(crate) origin: Origin,
    /// Who keeps it; in memory alone without.
    pub(crate) keeper: Option<Box<dyn Keeper>>,
    /// Bodies on springs stay where they begin.
    pub(crate) held: bool,
    /// Share of the work that the flow takes where forces about it follow.
    pub(crate) share: f64,
}

impl Way {
    /// In memory, with bodies that move as structures let them.
    pub(crate) fn of(origin: Origin) -> Self {
        Self { origin, keeper: None, held: false, share: 1.0 }
    }
}

/// Finds the error bars of a run, given its summary, before that is written; false when told to stop.
pub(crate) type Bars<'a> = &'a mut dyn FnMut(&mut Summary, &mut Log<'_>) -> Result<bool, RunError>;

/// The solution of a run, or the iteration at which it was told to stop.
pub(crate) type Ended = Result<Solution, u64>;

/// A flow that is solved, in memory with its equations.
pub(crate) trait Flow<'a> {
    /// Forces of small motions about the flow, and the record of the run. They are the part of its work that follows.
    fn forces(&mut self) -> Result<(Box<dyn ForceSource + '_>, &mut Log<'a>), RunError>;
    /// Forces of small motions about the flow.
    fn source(&self) -> Result<Box<dyn ForceSource + '_>, RunError>;
    /// Looks at the flow, and writes it where the run has a folder.
    fn conclude(&mut self, bars: Option<Bars<'_>>) -> Result<Ended, RunError>;
}

/// A flow, or the iteration at which its run was told to stop.
pub(crate) type Solved<'a> = Result<Box<dyn Flow<'a> + 'a>, u64>;

/// Solves the flow of a problem.
pub(crate) fn solve<'a>(problem: &Problem, way: Way, monitor: &'a mut dyn Monitor) -> Result<Solved<'a>, RunError> {
    match problem {
        Problem::Plane(problem) => {
            let camera = way.keeper.as_ref().map(|keeper| keeper.plane());
            solve_in(problem, (way, camera), monitor)
        }
        Problem::Space(problem) => {
            let camera = way.keeper.as_ref().map(|keeper| keeper.space());
            solve_in(problem, (way, camera), monitor)
        }
    }
}

/// Solves a problem in memory; `None` when told to stop.
pub(crate) fn in_memory(problem: &Problem, monitor: &mut dyn Monitor) -> Result<Option<Solution>, RunError> {
    match problem {
        Problem::Plane(problem) => in_memory_in(problem, monitor),
        Problem::Space(problem) => in_memory_in(problem, monitor),
    }
}

/// The same for a problem of known dimension.
pub(crate) fn in_memory_in<const D: usize>(
    problem: &ProblemIn<D>,
    monitor: &mut dyn Monitor,
) -> Result<Option<Solution>, RunError> {
    match solve_in(problem, (Way::of(Origin::Case), None), monitor)? {
        Ok(mut flow) => Ok(flow.conclude(None)?.ok()),
        Err(_) => Ok(None),
    }
}

/// Solves the steady flow of a problem that small motions are about, `share` of the work that it takes with the forces of these; `None` when
/// told to stop. Bodies on springs stay where they begin unless they are trimmed.
pub(crate) fn steady<'a>(
    problem: &Problem,
    share: f64,
    monitor: &'a mut dyn Monitor,
) -> Result<Option<Box<dyn Flow<'a> + 'a>>, RunError> {
    let held = !problem.given().is_trimmed();
    Ok(solve(problem, Way { held, share, ..Way::of(Origin::Case) }, monitor)?.ok())
}

fn solve_in<'a, const D: usize>(
    problem: &ProblemIn<D>,
    (way, camera): (Way, Option<Arc<dyn Camera<D>>>),
    monitor: &'a mut dyn Monitor,
) -> Result<Solved<'a>, RunError> {
    if !way.held {
        problem.check_equilibrium()?;
    }
    let problem = problem.with_solids()?;
    for remark in problem.remarks() {
        match remark {
            Remark::Note(text) => monitor.note(text),
            Remark::Warning(text) => monitor.warn(text),
        }
    }
    match problem.is_coupled() {
        true => Stages::begin(problem, coupled, (way, camera), monitor)?.solve(),
        false => Stages::begin(problem, |_, gas| gas, (way, camera), monitor)?.solve(),
    }
}
