//! The record of a study, and its ways out.
use std::sync::Arc;

use super::super::keeper::{Earlier, Keeper, Tables};
use super::super::look::LoadFrame;
use super::super::monitor::{Monitor, Tick};
use super::super::time_left::Portion;
use super::crosscheck::{Moment, Twofold};
use super::history::IterationHistory;
use super::interval::passed;
use super::polar::PolarRecord;
use super::saved::{Saved, Settling};
use super::trace::Trace;
use super::work::{Clock, Work};
use crate::case::{Case, Units};
use crate::observe::convergence::CloudLoads;
use crate::observe::error_bars::{Measure, Measured, Quantity, Window};
use crate::observe::structure::{CoordinateHistory, StructureNames, StructureSample, StructureSummary, StructureTable};
use crate::observe::swing::Swing;
use crate::problem::Described;
use crate::problem::RunError;
use crate::record::summary::{BalanceReport, GeneralisedForce, PolarPoint};
use crate::scheme::RemapLedger;
use crate::time::TimeError;

/// What a run has found about itself so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    /// Iterations over all stages.
    pub(crate) iteration: u64,
    /// What every iteration left.
    pub(crate) history: IterationHistory,
    /// Finished cycles: cycle, particles, CL, CD, CM.
    pub(crate) cycles: Vec<[f64; 5]>,
    /// Loads on the clouds of a family.
    pub(crate) clouds: Vec<CloudLoads>,
    /// True where a family of clouds ended because the next one would have taken too long.
    pub(crate) out_of_time: bool,
    /// Points of a polar.
    pub(crate) polar: PolarRecord,
    /// What the stage told that makes results doubtful.
    pub(crate) warnings: Vec<String>,
    /// Why a relaxation ended short of its goal, where it did.
    pub(crate) reason: Option<String>,
    /// Totals of the conserved quantities when the march began.
    pub(crate) start_totals: Vec<f64>,
    /// Residual over its first value at the end.
    pub(crate) drop: f64,
    /// True where the start was a steady flow already, whose residual is round-off.
    pub(crate) began_steady: bool,
    /// True when the goal was reached.
    pub(crate) converged: bool,
    /// True when the loads of a march settled within a tolerance that the case gives.
    pub(crate) settled: bool,
    /// Final time, in the units of the case.
    pub(crate) time: f64,
    /// Bytes of the integrator.
    pub(crate) bytes: usize,
    /// Linear iterations of the last stage.
    pub(crate) linear: u32,
    /// Those of the legs of a march before this one.
    pub(crate) linear_before: u32,
    /// Steps in time that did not reach their goal.
    pub(crate) unconverged: u32,
    /// Times a step in time was halved because its equations could not be solved.
    pub(crate) halved: u32,
    /// Loads and motion of the march so far.
    pub(crate) trace: Trace,
    /// Work of all stages.
    pub(crate) work: Work,
    /// What the end of a harmonic balance is told from.
    pub(crate) settling: Settling,
    /// Evaluations of the residual of one instance by the harmonic balances that are over.
    pub(crate) evaluations: u64,
    /// What a harmonic balance found about itself.
    pub(crate) balance: Option<BalanceReport>,
    /// Forces on the modes of `[gaf]`.
    pub(crate) forces: Vec<GeneralisedForce>,
    /// Part of the period, angle, displacement and loads at the instances of a harmonic balance.
    pub(crate) instances: Vec<[f64; 6]>,
    /// What re-clouding did so far, where particles travel with the fluid.
    pub(crate) ledger: RemapLedger,
    /// Loads evaluated twice, where the motion repeats.
    pub(crate) moments: Twofold,
    /// How structures moved.
    pub(crate) structures: StructureTable,
    /// Angular frequency of the harmonic balance that they moved by, in the units of the case.
    pub(crate) balanced: Option<f64>,
}

impl Record {
    /// What a checkpoint and the tables beside it hold.
    fn resumed(saved: &Saved, earlier: Earlier, units: &Units) -> Self {
        let march = match &saved.memory {
            crate::time::Memory::March(past) => (past.unconverged, past.halved, saved.linear),
            // it counts on by itself
            crate::time::Memory::Relaxation(_) => (0, 0, 0),
        };
        Self {
            iteration: saved.iteration,
            history: earlier.history,
            cycles: saved.cycles.clone(),
            clouds: saved.clouds.clone(),
            polar: saved.polar.clone(),
            start_totals: saved.start_totals.clone(),
            drop: 1.0,
            time: units.case_time(saved.time),
            unconverged: march.0,
            halved: march.1,
            linear_before: march.2,
            trace: earlier.trace,
            work: Work::before(saved.work),
            evaluations: saved.settling.earlier,
            settling: saved.settling.clone(),
            ledger: saved.lagrangian.as_ref().map_or_else(RemapLedger::default, |r| r.ledger.clone()),
            moments: earlier.moments,
            structures: earlier.structures,
            ..Self::default()
        }
    }
}

impl Record {
    /// True when the goal was reached, at all points of a polar; `None` of a march that came to its end and was asked for no more.
    pub(crate) fn goal_reached(&self, marches: bool) -> Option<bool> {
        match &self.polar.points[..] {
            [] if marches && self.converged && !self.settled => None,
            [] => Some(self.converged),
            points => Some(points.iter().all(|p| p.converged)),
        }
    }
}

/// The record of a study with its ways out: to those who watch, and to its keeper where it has one.
pub(crate) struct Log<'a> {
    monitor: &'a mut dyn Monitor,
    /// The case.
    pub(crate) case: Arc<Case>,
    /// Axes of the loads.
    pub(crate) axes: LoadFrame,
    /// From the units of the solver to those of the case: what observers keep, tell and write is in the latter.
    pub(crate) units: Units,
    /// Period of the motion, in the time of the solver.
    pub(crate) period: Option<f64>,
    /// Who keeps the study.
    pub(crate) keeper: Option<Box<dyn Keeper>>,
    /// What is known so far.
    pub(crate) record: Record,
    /// Present point of a polar, and their number.
    pub(crate) point: Option<[usize; 2]>,
    /// Present part of the run: nothing of it is done.
    pub(crate) portion: Portion,
    /// The structures.
    pub(crate) structures: Vec<Described>,
    clock: Clock,
    /// Processor and wall seconds before a restart.
    before: [f64; 2],
}

/// What loads are measured by.
pub(crate) struct Scales {
    /// Axes.
    pub(crate) axes: LoadFrame,
    /// Period of the motion, in the time of the solver.
    pub(crate) period: Option<f64>,
}

impl<'a> Log<'a> {
    /// Opens the record of a run, and its tables where it has a keeper.
    pub(crate) fn open(
        case: Arc<Case>,
        mut keeper: Option<Box<dyn Keeper>>,
        Scales { axes, period }: Scales,
        saved: Option<&Saved>,
        structures: Vec<Described>,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self, RunError> {
        let names: Vec<StructureNames> = structures.iter().map(|s| s.names.clone()).collect();
        let twice = period.is_some() && case.moves() && !case.bodies.is_empty();
        let tables = Tables { case: &case, twice, structures: &names };
        let earlier = keeper.as_mut().map_or_else(|| Ok(Earlier::default()), |keeper| keeper.open(&tables, saved))?;
        saved.map_or(Ok(()), |saved| saved.agrees(&earlier.history))?;
        let units = case.flow.units();
        let mut record = match saved {
            Some(saved) => Record::resumed(saved, earlier, &units),
            None => Record { drop: 1.0, history: IterationHistory::of(&case), ..Record::default() },
        };
        if record.structures.coordinates.is_empty() {
            record.structures = StructureTable::of(&names);
        }
        record.trace = record.trace.over(case.output.loop_periods);
        let before = saved.map_or([0.0; 2], |s| [s.cpu_seconds, s.wall_seconds]);
        Ok(Self {
            monitor,
            case,
            axes,
            units,
            period,
            keeper,
            record,
            point: None,
            portion: Portion::whole(0.0),
            structures,
            clock: Clock::start(),
            before,
        })
    }

    /// The run turns to a point of a polar: `case` in axes of its own.
    pub(crate) fn turn_to(&mut self, case: Arc<Case>, axes: LoadFrame, point: [usize; 2]) {
        (self.case, self.axes, self.point) = (case, axes, Some(point));
    }

    /// A point of a polar begins, which nothing is known of: from rest, or from a neighbouring one.
    pub(crate) fn begin_point(&mut self, from_rest: bool) {
        let [cpu, _] = self.seconds();
        self.record.polar.begin(self.record.iteration, cpu, from_rest);
        self.forget_clouds();
    }

    /// What was found on the clouds of a point does not count.
    pub(crate) fn forget_clouds(&mut self) {
        self.record.clouds.clear();
        self.record.cycles.clear();
    }

    /// A point of a polar is over: its row.
    pub(crate) fn end_point(&mut self, row: PolarPoint) -> Result<(), RunError> {
        self.record.polar.points.push(row);
        self.keeper.as_ref().map_or(Ok(()), |keeper| keeper.points(&self.record.polar))
    }

    /// Who watches.
    pub(crate) fn monitor(&mut self) -> &mut dyn Monitor {
        self.monitor
    }

    /// The numbers of a march or a balance that error bars are told of.
    pub(crate) fn measured(&self) -> Option<Measured> {
        let mut found = self.record.trace.measured(self.case_period())?;
        let structures = self.structure_summaries();
        let coordinates = structures.iter().flat_map(|s| &s.coordinates);
        for (c, known) in coordinates.zip(&self.record.structures.coordinates) {
            // what a coordinate that swings for ever still changes by
            let swings = found.window != Window::March && self.record.balanced.is_none();
            let told = |value: Option<f64>, quantity: Quantity, changes: Option<f64>| {
                let before = changes.filter(|_| swings).map(|change| [value.unwrap_or_default() + change, 0.0]);
                value.map(|value| Measure { of: known.name.clone(), quantity, value: [value, 0.0], before })
            };
            let spread = c.amplitude.zip(c.amplitude_spread).map(|(size, spread)| size * spread);
            found.values.extend(told(c.mean, Quantity::Mean, None));
            found.values.extend(told(c.amplitude, Quantity::Amplitude, spread));
            found.values.extend(told(c.frequency, Quantity::Frequency, None));
            found.values.extend(told(c.damping_ratio.filter(|_| !swings), Quantity::Damping, None));
        }
        Some(found)
    }

    /// Says a line.
    pub(crate) fn note(&mut self, text: &str) {
        self.monitor.note(text);
    }

    /// Says what makes results doubtful.
    pub(crate) fn warn(&mut self, text: &str) {
        self.record.warnings.push(text.to_owned());
        self.monitor.warn(text);
    }

    /// Says what begins that tells of no iterations, in the present part of the run.
    pub(crate) fn doing(&mut self, what: &str) {
        self.monitor.doing(what, &self.portion);
    }

    /// Keeps a row of the history.
    pub(crate) fn row(&mut self, row: &[f64]) -> Result<(), RunError> {
        self.record.history.push(row);
        self.keeper.as_mut().map_or(Ok(()), |keeper| keeper.row(row))
    }

    /// Tells of an iteration.
    pub(crate) fn tick(&mut self, tick: &Tick) {
        self.monitor.tick(tick);
    }

    /// True when the run is told to stop.
    pub(crate) fn stopped(&self) -> bool {
        self.monitor.stop()
    }

    /// True when a checkpoint is asked for now.
    pub(crate) fn checkpoint_is_asked_for(&self) -> bool {
        self.monitor.checkpoint()
    }

    /// Wall seconds, those before a restart included. Processor time takes reading files of the system, which is not for every step.
    pub(crate) fn wall_seconds(&self) -> f64 {
        self.before[1] + self.clock.wall_seconds()
    }

    /// Processor and wall seconds, those before a restart included.
    pub(crate) fn seconds(&self) -> [f64; 2] {
        [self.before[0] + self.clock.cpu_seconds(), self.wall_seconds()]
    }

    /// Loads of period after period are compared where bodies have a motion that repeats.
    pub(crate) fn compares_loads(&self) -> bool {
        self.period.is_some() && self.case.moves() && !self.case.bodies.is_empty()
    }

    /// Period of the motion, in the time of the case.
    pub(crate) fn case_period(&self) -> Option<f64> {
        self.period.map(|period| self.units.case_time(period))
    }

    /// Keeps how structures moved in a step, as of an iteration.
    pub(crate) fn structure(&mut self, iteration: u64, sample: &StructureSample) -> Result<(), RunError> {
        self.record.structures.push(iteration, sample);
        self.keeper.as_mut().map_or(Ok(()), |keeper| keeper.structure(iteration, sample))
    }

    /// What became of the structures.
    pub(crate) fn structure_summaries(&self) -> Vec<StructureSummary> {
        let names: Vec<StructureNames> = self.structures.iter().map(|s| s.names.clone()).collect();
        let mut all = self.record.structures.summaries(&names, self.record.balanced);
        all.iter_mut().zip(&self.structures).for_each(|(s, d)| s.description = d.lines.clone());
        all
    }

    /// The last period of every coordinate of the structures, `period` long or about so.
    pub(crate) fn swings(&self, period: f64) -> Vec<Option<Swing>> {
        let table = &self.record.structures;
        table.coordinates.iter().map(|c| Swing::of(&table.time, &c.values, period)).collect()
    }

    /// Keeps the loads of a moment, by both evaluations.
    pub(crate) fn compared(&mut self, moment: &Moment) -> Result<(), RunError> {
        let row = self.record.moments.push(moment);
        self.keeper.as_mut().map_or(Ok(()), |keeper| keeper.moment(&row))
    }

    /// Name of the checkpoint, where there is one.
    pub(crate) fn checkpoint(&self) -> Option<String> {
        self.keeper.as_ref().map(|keeper| keeper.checkpoint_name())
    }

    /// Why a run failed, and where its last good state is.
    pub(crate) fn failed(&self, source: TimeError) -> RunError {
        RunError::Time { source: Box::new(source), reached: self.reached(), checkpoint: self.checkpoint() }
    }

    /// How far the bodies on springs of a march had come, as a line of its own: motion that grows until the gas cannot follow is
    /// flutter, and no fault of a particle. Empty without them.
    fn reached(&self) -> String {
        let table = &self.record.structures;
        let Some(time) = table.time.last().filter(|_| table.marches()) else { return String::new() };
        let angles = self.structures.iter().flat_map(|s| &s.names.coordinates).map(|c| c.angle);
        let told = |(c, angle): (&CoordinateHistory, bool)| {
            let value = c.values.last().copied().unwrap_or_default();
            if angle {
                format!("{} {:.1} degrees", c.name, value.to_degrees())
            } else {
                format!("{} {value:.4}", c.name)
            }
        };
        let all: Vec<String> = table.coordinates.iter().zip(angles).map(told).collect();
        let shown = |keeper: &dyn Keeper| format!("; `alula report {}` shows how it came there", keeper.name());
        let report = self.keeper.as_deref().map_or_else(String::new, shown);
        format!("\nat t = {time:.5} the structure had {}{report}", all.join(", "))
    }

    /// How the loads of the last period differ from those of the period before, at the end of a period; `None` elsewhere.
    pub(crate) fn change_of_period(&self, time: f64, before: f64) -> Option<f64> {
        let period = self.period?;
        let ended = passed(time, period) > passed(before, period) && time / period > 1.5;
        let change = self.record.trace.change(self.units.case_time(period)).filter(|_| ended)?;
        Some(change.mean.max(change.first_harmonic))
    }
}
