//! The loop: every integrator is driven here, and only here.
//!
//! Before each step the observers say what they wish; the strongest wish ends the loop. After each step they look at it, in
//! their order, so that a checkpoint, which comes last, holds what the others have found.
use crate::problem::RunError;
use crate::system::System;
use crate::time::{Cost, Integrator, Mark, Memory, Standing, Step, TimeError};

/// How driving ended.
#[derive(Debug)]
pub(crate) enum Ending {
    /// The goal is reached.
    Finished,
    /// All that was granted is spent, or nothing is gained any more.
    Spent,
    /// The run was told to stop.
    Stopped,
    /// Something has to be done before it can go on: the cloud is worn.
    Paused,
    /// It cannot go on; the integrator keeps the last good state.
    Failed(TimeError),
}

/// What an observer wishes; the later ones are stronger.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Wish {
    /// To pause.
    Pause,
    /// To stop here and go on another time.
    Stop,
    /// To end short of the goal.
    GiveUp,
    /// To end: the goal is reached.
    Finish,
}

impl From<Wish> for Ending {
    fn from(wish: Wish) -> Self {
        match wish {
            Wish::Pause => Self::Paused,
            Wish::Stop => Self::Stopped,
            Wish::GiveUp => Self::Spent,
            Wish::Finish => Self::Finished,
        }
    }
}

/// An integrator at one moment, as observers see it.
pub(crate) struct Now<'a, S: System> {
    integrator: &'a mut (dyn Integrator<S> + 'a),
    /// Time before the last step.
    pub(crate) before: f64,
}

impl<'a, S: System> Now<'a, S> {
    /// Where an integrator stands.
    pub(crate) fn at(integrator: &'a mut (dyn Integrator<S> + 'a)) -> Self {
        let mark = integrator.mark();
        Self { before: mark.time - mark.last, integrator }
    }

    /// How far it has come.
    pub(crate) fn mark(&self) -> Mark {
        self.integrator.mark()
    }

    /// What it has spent.
    pub(crate) fn cost(&self) -> Cost {
        self.integrator.cost()
    }

    /// What it must remember.
    pub(crate) fn memory(&self) -> Memory {
        self.integrator.memory()
    }

    /// Where it stands.
    pub(crate) fn standing(&mut self) -> Standing<'_, S> {
        self.integrator.standing()
    }
}

/// Something that watches an integrator, and writes into the log `L` of the study.
pub(crate) trait Observer<S: System, L> {
    /// Before the first step.
    fn begin(&mut self, _: &mut Now<'_, S>, _: &mut L) -> Result<(), RunError> {
        Ok(())
    }
    /// Before every step: whether to go on.
    fn wish(&mut self, _: &mut Now<'_, S>, _: &L) -> Option<Wish> {
        None
    }
    /// After every step.
    fn step(&mut self, _: &Step, _: &mut Now<'_, S>, _: &mut L) -> Result<(), RunError> {
        Ok(())
    }
    /// After the last step.
    fn end(&mut self, _: &Ending, _: &mut Now<'_, S>, _: &mut L) -> Result<(), RunError> {
        Ok(())
    }
}

/// Drives an integrator until it is finished, fails, or an observer wishes an end.
pub(crate) fn drive<S: System, L>(
    integrator: &mut dyn Integrator<S>,
    observers: &mut [&mut dyn Observer<S, L>],
    log: &mut L,
) -> Result<Ending, RunError> {
    let start = integrator.check();
    let mut now = Now::at(integrator);
    for observer in observers.iter_mut() {
        observer.begin(&mut now, log)?;
    }
    let ending = loop {
        if let Err(problem) = start {
            break Ending::Failed(problem);
        }
        if now.integrator.finished() {
            break Ending::Finished;
        }
        if let Some(wish) = observers.iter_mut().filter_map(|o| o.wish(&mut now, log)).max() {
            break wish.into();
        }
        now.before = now.mark().time;
        let step = match now.integrator.advance() {
            Ok(step) => step,
            Err(problem) => break Ending::Failed(problem),
        };
        for observer in observers.iter_mut() {
            observer.step(&step, &mut now, log)?;
        }
    };
    for observer in observers.iter_mut() {
        observer.end(&ending, &mut now, log)?;
    }
    Ok(ending)
}
