//! Progress: the work done, a line of the history for every iteration, and a word to those who watch.
use super::super::look::{GasView, motion};
use super::super::monitor::{MarchTick, Tick};
use super::super::record::Log;
use super::super::record::trace::Sample;
use super::drive::{Now, Observer};
use crate::observe::loads::Coefficients;
use crate::problem::RunError;
use crate::scheme::HasGas;
use crate::system::System;
use crate::time::{Standing, Step};

/// How loads and motion are seen in a system.
pub(crate) trait Eyes<S: System> {
    /// Loads on all bodies; `None` without bodies.
    fn loads(&mut self, at: Standing<'_, S>, log: &mut Log<'_>) -> Option<Coefficients>;
    /// Angle (radians, nose up), displacement and coordinate of the first mode of the first body that moves.
    fn motion(&self, at: Standing<'_, S>, time: f64) -> [f64; 5];
    /// Fluid particles.
    fn particles(&self) -> usize;
    /// Instances of a period at which the residual is evaluated.
    fn instances(&self) -> usize {
        1
    }
}

/// The gas as it stands at one time.
pub(crate) struct GasEyes<'a, S, const D: usize> {
    /// The system.
    pub(crate) system: &'a S,
}

impl<S: HasGas<D>, const D: usize> Eyes<S> for GasEyes<'_, S, D> {
    fn loads(&mut self, at: Standing<'_, S>, log: &mut Log<'_>) -> Option<Coefficients> {
        GasView::of(self.system, at.frame, at.state).coefficients(&log.axes, self.system.gas_work(at.work))
    }

    fn motion(&self, at: Standing<'_, S>, time: f64) -> [f64; 5] {
        motion(self.system.gas(), time, &self.system.gas_frame(at.frame).jets)
    }

    fn particles(&self) -> usize {
        self.system.gas().discretisation.cloud.n_fluid
    }
}

/// Counts evaluations.
pub(crate) struct Effort {
    /// Particles, times instances, of each.
    pub(crate) points: usize,
}

impl<S: System> Observer<S, Log<'_>> for Effort {
    fn begin(&mut self, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        log.record.work.begin(now.cost().evaluations);
        Ok(())
    }

    fn step(&mut self, _: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        log.record.work.add(now.cost().evaluations, self.points);
        Ok(())
    }
}

/// What an integration is after.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Aim {
    /// So many orders of magnitude of the residual.
    Orders(f64),
    /// A time of the solver.
    Time(f64),
}

/// Writes the history and tells of every iteration.
pub(crate) struct Progress<'a, S> {
    /// How loads are seen.
    pub(crate) eyes: &'a mut dyn Eyes<S>,
    /// Cycle of adaptation.
    pub(crate) cycle: u32,
    /// What the integration is after.
    pub(crate) aim: Aim,
}

impl<S: System> Observer<S, Log<'_>> for Progress<'_, S> {
    fn begin(&mut self, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        self.effort().begin(now, log)
    }

    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        log.record.iteration += 1;
        self.effort().step(step, now, log)?;
        let loads = self.eyes.loads(now.standing(), log);
        let motion = if log.case.moves() { self.eyes.motion(now.standing(), step.time) } else { [0.0; 5] };
        let time = log.units.case_time(step.time);
        if time > 0.0 {
            // the angle that a resumed run reads in the history, to the last bit
            let motion = [motion[0].to_degrees().to_radians(), motion[1], motion[2], motion[3], motion[4]];
            log.record.trace.push(Sample { time, loads: loads.unwrap_or_default(), motion });
        }
        let row = self.row(step, now.cost().inner, &loads.unwrap_or_default(), &motion, log);
        log.row(&row)?;
        let done = match self.aim {
            Aim::Orders(orders) => -step.residual.log10() / orders,
            Aim::Time(until) => time / log.units.case_time(until),
        };
        log.tick(&Tick {
            iteration: log.record.iteration,
            portion: log.portion.at(done),
            residual: step.residual,
            cfl: step.cfl,
            loads: loads.map(|c| [c.cl, c.cd, c.cm]),
            particles: self.eyes.particles(),
            march: self.march(time, motion[0], log),
            point: log.point,
        });
        Ok(())
    }
}

impl<S: System> Progress<'_, S> {
    fn effort(&self) -> Effort {
        Effort { points: self.eyes.instances() * self.eyes.particles() }
    }

    /// Where a march stands.
    fn march(&self, time: f64, angle: f64, log: &Log<'_>) -> Option<MarchTick> {
        let Aim::Time(until) = self.aim else { return None };
        let period = log.case_period();
        Some(MarchTick {
            time,
            until: log.units.case_time(until),
            period,
            angle: log.case.moves().then_some(angle),
            lift_before: period.and_then(|p| log.record.trace.lift_at(time - p)),
        })
    }

    /// A row of the history, as [`IterationHistory`](super::super::record::IterationHistory) names its columns.
    fn row(&self, step: &Step, inner: u32, c: &Coefficients, motion: &[f64; 5], log: &Log<'_>) -> Vec<f64> {
        let seconds = log.wall_seconds();
        let (cycle, time) = (f64::from(self.cycle), log.units.case_time(step.time));
        let mut row =
            vec![cycle, log.record.iteration as f64, time, step.cfl, step.residual, c.cl, c.cd, c.cm, seconds];
        row.push(self.eyes.particles() as f64);
        if log.case.moves() {
            row.extend([f64::from(inner), motion[0].to_degrees(), motion[1], motion[2], motion[3]]);
        }
        if log.case.bends() {
            row.push(motion[4]);
        }
        row.extend(log.point.map(|[point, _]| (point + 1) as f64));
        row
    }
}
