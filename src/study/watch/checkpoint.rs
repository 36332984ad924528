//! Checkpoints: every so many iterations or minutes, when asked for, at the end and when things go wrong.
use super::super::record::Log;
use super::super::record::saved::{LagrangianCheckpoint, Position, Saved, equations_of};
use super::drive::{Ending, Now, Observer};
use crate::problem::RunError;
use crate::scheme::RemapLedger;
use crate::system::System;
use crate::time::{Integrator, Standing, Step};

/// What a checkpoint keeps of particles that travel, given the frame and what re-clouding did so far.
pub(crate) type Particles<'a, S> = dyn Fn(&<S as System>::Frame, &RemapLedger) -> Option<LagrangianCheckpoint> + 'a;

/// Writes the checkpoint of a run folder.
pub(crate) struct Checkpoint<'a, S: System> {
    /// Where the run stands among its stages.
    at: &'a Position<'a>,
    /// What is kept of particles that travel; absent where none can.
    particles: Option<&'a Particles<'a, S>>,
    /// Whether one is written when the stage is over.
    at_end: bool,
    /// Wall seconds of the run at the last one.
    written: f64,
}

impl<S: System> Observer<S, Log<'_>> for Checkpoint<'_, S> {
    fn begin(&mut self, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        self.written = log.wall_seconds();
        if now.mark().iteration == 0 { self.write(now, log) } else { Ok(()) }
    }

    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        let output = &log.case.output;
        let seconds = log.wall_seconds();
        let due = log.checkpoint_is_asked_for()
            || step.iteration.is_multiple_of(output.checkpoint.max(1))
            || seconds - self.written >= output.checkpoint_time.0;
        if !due {
            return Ok(());
        }
        self.written = seconds;
        self.write(now, log)
    }

    fn end(&mut self, ending: &Ending, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        match ending {
            Ending::Finished | Ending::Spent if self.at_end => self.write(now, log),
            Ending::Stopped | Ending::Failed(_) => self.write(now, log),
            _ => Ok(()),
        }
    }
}

impl<'a, S: System> Checkpoint<'a, S> {
    /// Of a stage of a run; `at_end`: one is written when the stage is over.
    pub(crate) fn new(at: &'a Position<'a>, particles: Option<&'a Particles<'a, S>>, at_end: bool) -> Self {
        Self { at, particles, at_end, written: 0.0 }
    }

    /// Writes where an integrator stands that is not being driven.
    pub(crate) fn keep(&self, integrator: &mut dyn Integrator<S>, log: &Log<'_>) -> Result<(), RunError> {
        self.write(&mut Now::at(integrator), log)
    }

    fn write(&self, now: &mut Now<'_, S>, log: &Log<'_>) -> Result<(), RunError> {
        let Some(keeper) = &log.keeper else { return Ok(()) };
        let (memory, time) = (now.memory(), now.mark().time);
        let linear = log.record.linear_before + now.cost().linear;
        let Standing { frame, state, .. } = now.standing();
        let [cpu_seconds, wall_seconds] = log.seconds();
        let record = &log.record;
        let single = log.case.polar.is_none() && self.at.stages[self.at.stage].point.is_none();
        let saved = Saved {
            stage: self.at.stage,
            stages: self.at.stages.to_vec(),
            iteration: record.iteration,
            time,
            state: state.into(),
            memory,
            settling: record.settling.clone(),
            start_totals: record.start_totals.clone(),
            cycles: record.cycles.clone(),
            clouds: record.clouds.clone(),
            cpu_seconds,
            wall_seconds,
            work: record.work.total,
            linear,
            lagrangian: self.particles.and_then(|of| of(frame, &record.ledger)),
            sources: self.at.sources.to_vec(),
            polar: record.polar.clone(),
            kept: self.at.kept.into(),
            equations: single.then(|| equations_of(&log.case)),
            tables: Vec::new(),
        };
        keeper.checkpoint(saved)
    }
}
