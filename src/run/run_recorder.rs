//! What accompanies a run from stage to stage: the history, checkpoints, loads in time, and what the end of it is told from.
use super::balance;
use super::harmonic::BalanceReport;
use super::load_crosscheck::Twofold;
use super::periodic::{Sample, Trace};
use super::persist::{FILE, LagrangianCheckpoint, Position, Saved};
use super::snapshot::{LoadFrame, Snapshot, load_axes};
use super::{Monitor, Places, RunError, Tick};
use crate::case::Case;
use crate::motion::BodyMotion;
use crate::observe::History;
use crate::observe::loads::Coefficients;
use crate::scheme::{Fluid, Frame, RemapLedger, Work};
use crate::time::control::Phase;
use crate::time::relax::Resume;
use crate::time::{March, TimeError};

/// Columns of `history.csv`.
const COLUMNS: [&str; 9] = ["cycle", "iteration", "time", "cfl", "residual", "cl", "cd", "cm", "seconds"];
/// More of them when something moves: iterations within the step, angle and displacement of the first body that moves.
const MOVING: [&str; 5] = ["inner", "angle_deg", "shift_x", "shift_y", "shift_z"];
/// One more when a body bends: the coordinate of the first mode of that body.
const BENDING: &str = "mode";

/// Part of an interval by which a time may fall short of a multiple of it.
pub(super) const NEARLY: f64 = 1e-6;

/// Everything that accompanies the stages of a run.
pub(super) struct RunRecorder<'a> {
    monitor: &'a mut dyn Monitor,
    history: History,
    out: std::path::PathBuf,
    case: Case,
    axes: LoadFrame,
    /// Time between field files of a march.
    interval: Option<f64>,
    iteration: u64,
    began: std::time::Instant,
    before: (f64, f64),
    cpu: super::summary::Clock,
    /// Interval between checkpoints.
    every: u32,
    /// Finished cycles: cycle, particles, CL, CD, CM.
    pub(super) cycles: Vec<[f64; 5]>,
    /// Totals of the conserved quantities when the march began.
    pub(super) start_totals: Vec<f64>,
    /// Residual over its first value at the end.
    pub(super) drop: f64,
    /// True when the goal was reached.
    pub(super) converged: bool,
    /// Final time.
    pub(super) time: f64,
    /// Bytes of the integrator.
    pub(super) bytes: usize,
    /// Linear iterations of the last stage.
    pub(super) linear: u32,
    /// Steps in time that did not reach their goal.
    pub(super) unconverged: u32,
    /// Times a step in time was halved because its equations could not be solved.
    pub(super) halved: u32,
    /// Period of the motion.
    pub(super) period: Option<f64>,
    /// Loads and motion of the march so far.
    pub(super) trace: Trace,
    /// Work of all stages.
    pub(super) work: super::summary::Work,
    /// Evaluations of the residual of one instance by harmonic balance.
    pub(super) evaluations: u64,
    /// What a harmonic balance found about itself.
    pub(super) balance: Option<BalanceReport>,
    /// Forces on the modes of `[gaf]`.
    pub(super) forces: Vec<super::forces::GeneralisedForce>,
    /// Part of the period, angle, displacement and loads at the instances of a harmonic balance.
    pub(super) instances: Vec<[f64; 6]>,
    /// What re-clouding did so far, where particles travel with the fluid.
    pub(super) ledger: RemapLedger,
    /// Loads evaluated twice, where the motion repeats.
    pub(super) twofold: Twofold,
}

impl<'a> RunRecorder<'a> {
    /// Opens the history of a run.
    pub(super) fn open(
        case: &Case,
        places: &Places,
        saved: Option<&Saved>,
        (period, monitor): (Option<f64>, &'a mut dyn Monitor),
    ) -> Result<Self, RunError> {
        let path = places.out.join("history.csv");
        let moving = MOVING.into_iter().filter(|_| case.moves());
        let columns: Vec<&str> = COLUMNS.into_iter().chain(moving).chain(case.bends().then_some(BENDING)).collect();
        let history = match saved {
            Some(s) => History::resume(&path, &columns, s.iteration)?,
            None => History::create(&path, &columns)?,
        };
        let twofold = match period.filter(|_| case.moves() && !case.bodies.is_empty()) {
            Some(_) => Twofold::open(&places.out, saved.map(|s| s.iteration))?,
            None => Twofold::default(),
        };
        Ok(Self {
            monitor,
            twofold,
            history,
            out: places.out.clone(),
            case: case.clone(),
            axes: load_axes(case),
            interval: case.output.field_interval.map(|t| t.0),
            iteration: saved.map_or(0, |s| s.iteration),
            began: std::time::Instant::now(),
            before: saved.map_or((0.0, 0.0), |s| (s.cpu_seconds, s.wall_seconds)),
            cpu: super::summary::Clock::start(),
            every: case.output.checkpoint.max(1),
            cycles: saved.map_or_else(Vec::new, |s| s.cycles.clone()),
            start_totals: saved.map_or_else(Vec::new, |s| s.start_totals.clone()),
            drop: 1.0,
            converged: false,
            time: saved.map_or(0.0, |s| s.time),
            bytes: 0,
            linear: 0,
            work: super::summary::Work::before(saved.map_or(0, |s| s.work)),
            evaluations: 0,
            balance: None,
            instances: Vec::new(),
            forces: Vec::new(),
            unconverged: saved.map_or(0, |s| s.past.unconverged),
            halved: saved.map_or(0, |s| s.past.halved),
            ledger: saved.and_then(|s| s.lagrangian.as_ref()).map_or_else(RemapLedger::default, |r| r.ledger.clone()),
            trace: saved
                .filter(|s| s.time > 0.0)
                .map_or_else(Trace::default, |s| Trace::read(&places.out, s.time))
                .over(case.output.loop_periods),
            period,
        })
    }

    /// Iterations over all stages.
    pub(super) fn iteration(&self) -> u64 {
        self.iteration
    }

    /// Says a line.
    pub(super) fn note(&mut self, text: &str) {
        self.monitor.note(text);
    }

    /// Hands over the solution.
    pub(super) fn show(&mut self, field: &Snapshot) {
        self.monitor.solution(field);
    }

    /// Processor and wall seconds, those before a restart included.
    pub(super) fn seconds(&self) -> (f64, f64) {
        (self.before.0 + self.cpu.cpu_seconds(), self.before.1 + self.began.elapsed().as_secs_f64())
    }

    /// True when a period has just ended whose loads differ from those of the period before by less than `tolerance`.
    pub(super) fn is_periodic(&self, time: f64, before: f64, tolerance: f64) -> bool {
        let Some(period) = self.period else { return false };
        let ended = (time / period + NEARLY).floor() > (before / period + NEARLY).floor();
        ended
            && time / period > 1.5
            && self.trace.change(period).is_some_and(|c| c.mean.max(c.first_harmonic) < tolerance)
    }

    /// True, with a note, when the loads of the last period still differ from those of the period before.
    pub(super) fn unsettled(&mut self, tolerance: f64) -> bool {
        let Some(period) = self.period else { return false };
        let Some(change) = self.trace.change(period) else {
            self.note("`periodic_tolerance` was not tested: loads are compared over the last two periods; march three or more");
            return false;
        };
        let largest = change.mean.max(change.first_harmonic);
        if largest < tolerance {
            return false;
        }
        self.note(&format!(
            "the loads have not settled: after {:.4} periods mean and first harmonic still change by {largest:.1e} from one \
             period to the next (`periodic_tolerance` {tolerance:.1e}); more `periods` may do, unless the flow has a rhythm of \
             its own: see `lift_cycles` in `summary.json`",
            change.periods
        ));
        true
    }

    /// Keeps the loads of a moment, by both evaluations, as of some iterations ahead.
    pub(super) fn compare<const D: usize>(
        &mut self,
        (ahead, time): (u64, f64),
        fluid: &Fluid<D>,
        (frame, state, work): (&Frame<D>, &[f64], &mut Work<D>),
    ) -> Result<(), RunError> {
        if !self.twofold.is_open() {
            return Ok(());
        }
        let Some(sum) = balance::around(&self.case, &self.axes, fluid, (frame, state, &mut *work), true) else {
            return Ok(());
        };
        let walls = self.axes.coefficients_in(fluid, frame, work);
        let around = self.axes.axes_in(fluid, frame).coefficients(&sum.load);
        Ok(self.twofold.push((self.iteration + ahead, time), &walls, &around)?)
    }

    /// The case.
    pub(super) fn case(&self) -> &Case {
        &self.case
    }

    /// The run folder.
    pub(super) fn out(&self) -> &std::path::Path {
        &self.out
    }

    /// Axes of the loads.
    pub(super) fn axes(&self) -> &LoadFrame {
        &self.axes
    }

    /// Time between field files.
    pub(super) fn interval(&self) -> Option<f64> {
        self.interval
    }

    /// Counts an iteration.
    pub(super) fn count(&mut self) {
        self.iteration += 1;
    }

    /// True when the run is told to stop.
    pub(super) fn stopped(&self) -> bool {
        self.monitor.stop()
    }

    /// Appends an iteration to the history.
    pub(super) fn record<const D: usize>(
        &mut self,
        (cycle, inner): (u32, u32),
        step: &crate::time::Step,
        loads: Option<Coefficients>,
        goal: (f64, f64),
        fluid: &Fluid<D>,
    ) -> Result<(), RunError> {
        let c = loads.unwrap_or_default();
        let seconds = self.seconds().1;
        let row =
            [f64::from(cycle), self.iteration as f64, step.time, step.cfl, step.residual, c.cl, c.cd, c.cm, seconds];
        let mut row = row.to_vec();
        let motion = if self.case.moves() { motion(fluid, step.time) } else { [0.0; 5] };
        if self.case.moves() {
            row.extend([f64::from(inner), motion[0].to_degrees(), motion[1], motion[2], motion[3]]);
        }
        if self.case.bends() {
            row.push(motion[4]);
        }
        if step.time > 0.0 {
            // the angle that a resumed run reads in the history, to the last bit
            let motion = [motion[0].to_degrees().to_radians(), motion[1], motion[2], motion[3], motion[4]];
            self.trace.push(Sample { time: step.time, loads: c, motion });
        }
        self.history.append(&row)?;
        self.monitor.tick(&Tick {
            iteration: self.iteration,
            goal: goal.0,
            reached: goal.1,
            residual: step.residual,
            cfl: step.cfl,
            loads: loads.map(|c| [c.cl, c.cd, c.cm]),
            particles: fluid.discretisation.cloud.n_fluid,
        });
        Ok(())
    }

    pub(super) fn save(&self, at: &Position<'_>, time: f64, state: &[f64], relax: Resume) -> Result<(), RunError> {
        self.save_with(at, time, (state, relax), Vec::new())
    }

    /// Writes a checkpoint of a relaxation with what its end depends on.
    pub(super) fn save_with(
        &self,
        at: &Position<'_>,
        time: f64,
        (state, relax): (&[f64], Resume),
        memory: Vec<f64>,
    ) -> Result<(), RunError> {
        let (cpu, wall) = self.seconds();
        let mut saved = Saved::new(at, self.iteration, time, state, relax);
        saved.past.before = memory;
        (saved.cpu_seconds, saved.wall_seconds, saved.work) = (cpu, wall, self.work.total);
        saved.cycles = self.cycles.clone();
        saved.start_totals = self.start_totals.clone();
        saved.write(&self.out)
    }

    /// Writes a checkpoint of a march.
    pub(super) fn keep<const D: usize>(
        &self,
        at: &Position<'_>,
        marcher: &mut dyn March<Fluid<D>>,
        fluid: &Fluid<D>,
    ) -> Result<(), RunError> {
        let past = marcher.past().clone();
        let (cpu, wall) = self.seconds();
        let (frame, _, state) = marcher.parts();
        let mut saved = Saved::new(at, self.iteration, past.time, state, bare(past.iteration));
        saved.lagrangian = LagrangianCheckpoint::of(fluid, frame, &self.ledger);
        (saved.cpu_seconds, saved.wall_seconds, saved.work) = (cpu, wall, self.work.total);
        saved.cycles = self.cycles.clone();
        saved.start_totals = self.start_totals.clone();
        saved.past = past;
        saved.write(&self.out)
    }

    pub(super) fn due(&self, iteration: u32) -> bool {
        self.monitor.checkpoint() || iteration.is_multiple_of(self.every)
    }

    pub(super) fn failed(&self, source: TimeError) -> RunError {
        RunError::Time { source, checkpoint: self.out.join(FILE).display().to_string() }
    }
}

/// Angle (radians, nose up), displacement and coordinate of the first mode of the first body that moves.
pub(super) fn motion<const D: usize>(fluid: &Fluid<D>, time: f64) -> [f64; 5] {
    fluid.cloud_motion.law().map_or([0.0; 5], |law: &BodyMotion<D>| {
        let shift = law.displacement(time).to_3d();
        let mode = law.coordinates(time).first().copied().unwrap_or(0.0);
        [law.angle(time).value, shift[0], shift[1], shift[2], mode]
    })
}

/// Where a march stands, in the terms of a relaxation.
fn bare(iteration: u32) -> Resume {
    Resume { iteration, cfl: 0.0, first_norm: 1.0, linear: 0, phase: Phase::default(), scale: Vec::new() }
}
