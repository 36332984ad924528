//! The beginning of stages: what the first of a run stands on, and the state that each begins with.
use super::super::course::{Coarser, Course};
use super::super::record::Log;
use super::super::record::saved::{Kept, Saved};
use super::super::setup::{self, Solver};
use super::super::stage::Stage;
use super::super::studies::Start;
use super::stages::StageEnd;
use crate::cloud::Cloud;
use crate::cloud::sources::Source;
use crate::problem::{ProblemIn, RunError};
use crate::scheme::HasGas;

/// What the first stage of a run begins with; each part serves once.
pub(super) struct Opening<const D: usize> {
    /// The cloud of the case.
    cloud: Option<Cloud<D>>,
    /// Checkpoint of this run.
    checkpoint: Option<Saved<'static>>,
    /// Last state of another run.
    other: Option<Saved<'static>>,
}

/// The beginning of a stage.
pub(super) struct StageStart<S, const D: usize> {
    pub(super) solver: Solver<S, D>,
    pub(super) start: Start,
}

impl<const D: usize> Opening<D> {
    /// At the checkpoint of the run.
    pub(super) fn at_checkpoint(saved: Saved<'static>) -> Self {
        Self { cloud: None, checkpoint: Some(saved), other: None }
    }

    /// On the cloud of the case, with the last state of another run or none.
    pub(super) fn on(cloud: Cloud<D>, other: Option<Saved<'static>>) -> Self {
        Self { cloud: Some(cloud), checkpoint: None, other }
    }

    /// The cloud of the case, where it is built.
    pub(super) fn cloud(&self) -> Option<&Cloud<D>> {
        self.cloud.as_ref()
    }

    /// The checkpoint of the run.
    pub(super) fn checkpoint(&self) -> Option<&Saved<'static>> {
        self.checkpoint.as_ref()
    }

    /// The stage that a run goes on with, the sources of its cloud, and what was kept of those before it.
    pub(super) fn standing(&mut self) -> (usize, Vec<Source<D>>, Vec<Kept>) {
        let sources = self.checkpoint.as_ref().or(self.other.as_ref()).map_or_else(Vec::new, Saved::sources);
        let Some(saved) = &mut self.checkpoint else { return (0, sources, Vec::new()) };
        (saved.stage, sources, std::mem::take(&mut saved.kept).into_owned())
    }

    /// The beginning of a stage: at the checkpoint, on the cloud of the stage before it, or on one that `build` makes.
    pub(super) fn begin<S: HasGas<D>>(
        &mut self,
        (stage, problem): (&Stage, &ProblemIn<D>),
        build: impl Fn(Option<Cloud<D>>) -> Result<Solver<S, D>, RunError>,
        previous: Option<StageEnd<S, D>>,
        course: &mut Course<S, D>,
        log: &Log<'_>,
    ) -> Result<StageStart<S, D>, RunError> {
        let saved = self.checkpoint.take();
        let before = match previous {
            Some(end) if saved.is_none() && stage.shares_cloud(&end.stage) => {
                return Ok(StageStart::fresh(end.solver, end.reached.state));
            }
            other => other,
        };
        let solver = match course.take(stage, problem)? {
            Some(solver) => solver,
            None => build(if stage.factor == 1.0 { self.cloud.take() } else { None })?,
        };
        if let Some(saved) = saved {
            return StageStart::resumed(solver, saved);
        }
        let guess = guess(&solver, (stage, problem), before.as_ref(), course, log);
        let begun = begun(solver, problem, (guess, before.as_ref()), self.other.take())?;
        before.into_iter().for_each(|end| course.shelve(&end.stage, end.solver));
        Ok(begun)
    }
}

impl<S, const D: usize> StageStart<S, D> {
    fn fresh(solver: Solver<S, D>, state: Vec<f64>) -> Self {
        Self { solver, start: Start::Fresh(state) }
    }
}

impl<S: HasGas<D>, const D: usize> StageStart<S, D> {
    /// A stage that goes on where a checkpoint stands.
    fn resumed(mut solver: Solver<S, D>, saved: Saved<'static>) -> Result<Self, RunError> {
        // particles that travel are elsewhere by now
        let travelled = saved.lagrangian.as_ref().map(|r| r.resume(solver.system.gas()));
        if let Some(fluid) = travelled.transpose()?.flatten() {
            solver.system.set_gas(fluid);
        }
        saved.fits(solver.system.fields())?;
        Ok(Self { solver, start: Start::Resume(saved.state.into_owned(), saved.memory) })
    }
}

/// What is guessed of the state of a stage on a cloud of its own.
fn guess<S: HasGas<D>, const D: usize>(
    solver: &Solver<S, D>,
    (stage, problem): (&Stage, &ProblemIn<D>),
    before: Option<&StageEnd<S, D>>,
    course: &Course<S, D>,
    log: &Log<'_>,
) -> Option<Vec<f64>> {
    let transfer = |s: &StageEnd<S, D>, u: &[f64]| setup::transfer(&s.solver.system, u, &solver.system, problem);
    let carry = |u: &[f64]| before.map_or_else(Vec::new, |s| transfer(s, u));
    let coarser = before.map(|s| Coarser { factor: s.stage.factor, state: &s.reached.state, carry: &carry });
    course.guess(stage, &solver.system, coarser.as_ref(), log)
}

/// A stage on a cloud of its own: from what is guessed, else from the state of the stage before it, else from the last state of
/// another run, else from the start of the case.
fn begun<S: HasGas<D>, const D: usize>(
    solver: Solver<S, D>,
    problem: &ProblemIn<D>,
    (guess, before): (Option<Vec<f64>>, Option<&StageEnd<S, D>>),
    other: Option<Saved<'static>>,
) -> Result<StageStart<S, D>, RunError> {
    let state = match (guess, before, other) {
        (Some(guess), ..) => guess,
        (None, Some(end), _) => setup::transfer(&end.solver.system, &end.reached.state, &solver.system, problem),
        (None, None, Some(other)) => setup::taken_over(problem.case(), &solver.system, other.state.into_owned())?,
        (None, None, None) => solver.system.start(),
    };
    Ok(StageStart::fresh(solver, state))
}
