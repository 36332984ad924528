//! One stage from its start to its end: the integrator, watched.
use super::harmonic::{BalanceReport, balance};
use super::outputs;
use super::periodic::{Sample, Trace};
use super::persist::{FILE, Position, Roaming, Saved};
use super::setup::{Solver, control, harmonic_prelude, inner_control, plan, prelude};
use super::snapshot::{LoadFrame, Snapshot, load_axes};
use super::{Monitor, Places, RunError, Tick};
use crate::case::{self, Case, Explicit as Marching, RungeKutta, Steady, Temporal};
use crate::math::sweep::sum;
use crate::motion::Law;
use crate::observe::History;
use crate::observe::loads::Coefficients;
use crate::scheme::travel::Renewed;
use crate::scheme::{Fluid, Frame, Turnover, Work};
use crate::time::dual::Dual;
use crate::time::explicit::{Explicit, Method};
use crate::time::relax::{Phase, Relax, Resume};
use crate::time::{March, Past, TimeError};

/// Orders of magnitude that stages before the last one are solved to.
const EARLY_ORDERS: f64 = 3.5;
/// Columns of `history.csv`.
const COLUMNS: [&str; 9] = ["cycle", "iteration", "time", "cfl", "residual", "cl", "cd", "cm", "seconds"];
/// More of them when something moves: iterations within the step, angle and displacement of the first body that moves.
const MOVING: [&str; 5] = ["inner", "angle_deg", "shift_x", "shift_y", "shift_z"];
/// One more when a body bends: the coordinate of the first mode of that body.
const BENDING: &str = "mode";

/// Where a stage starts.
pub(super) enum Start {
    /// From a state.
    Fresh(Vec<f64>),
    /// Where a checkpoint stands.
    Resume(Box<Saved>),
}

/// Part of an interval by which a time may fall short of a multiple of it.
pub(super) const NEARLY: f64 = 1e-6;

/// Everything that accompanies the stages of a run.
pub(super) struct Journal<'a> {
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
    pub(super) turnover: Turnover,
}

impl<'a> Journal<'a> {
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
        Ok(Self {
            monitor,
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
            turnover: saved.and_then(|s| s.roaming.as_ref()).map_or_else(Turnover::default, |r| r.turnover.clone()),
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
    fn is_periodic(&self, time: f64, before: f64, tolerance: f64) -> bool {
        let Some(period) = self.period else { return false };
        let ended = (time / period + NEARLY).floor() > (before / period + NEARLY).floor();
        ended
            && time / period > 1.5
            && self.trace.change(period).is_some_and(|c| c.mean.max(c.first_harmonic) < tolerance)
    }

    /// True, with a note, when the loads of the last period still differ from those of the period before.
    fn unsettled(&mut self, tolerance: f64) -> bool {
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
            particles: fluid.shape.cloud.n_fluid,
        });
        Ok(())
    }

    fn save(&self, at: &Position<'_>, time: f64, state: &[f64], relax: Resume) -> Result<(), RunError> {
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
    fn keep<const D: usize>(
        &self,
        at: &Position<'_>,
        marcher: &mut impl March<Fluid<D>>,
        fluid: &Fluid<D>,
    ) -> Result<(), RunError> {
        let past = marcher.past().clone();
        let (cpu, wall) = self.seconds();
        let (frame, _, state) = marcher.parts();
        let mut saved = Saved::new(at, self.iteration, past.time, state, bare(past.iteration));
        saved.roaming = Roaming::of(fluid, frame, &self.turnover);
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

/// State and frame at the end of a stage; `None` when told to stop.
pub(super) type Solved<const D: usize> = Result<Option<(Vec<f64>, Frame<D>)>, RunError>;

/// Why a leg of a march ended.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Pause {
    /// The march is over.
    End,
    /// The monitor said so.
    Stop,
    /// The cloud is to be built anew.
    Worn,
}

/// Integrates one stage; `None` when told to stop. Where particles travel with the fluid, `solver` ends on another cloud.
pub(super) fn solve<const D: usize>(
    case: &Case,
    solver: &mut Solver<D>,
    start: Start,
    at: &Position<'_>,
    last: bool,
    journal: &mut Journal<'_>,
) -> Solved<D> {
    let marches = at.stages[at.stage].march;
    match &case.time {
        Temporal::Steady(steady) => relax(steady, solver, start, at, last, journal),
        Temporal::Dual(dual) if !marches => relax(&prelude(dual), solver, start, at, false, journal),
        Temporal::Dual(dual) => march_implicitly(dual, solver, start, at, journal),
        Temporal::Explicit(marching) => march_explicitly(marching, solver, start, at, journal),
        Temporal::Harmonics(plan) if !marches => relax(&harmonic_prelude(plan), solver, start, at, false, journal),
        Temporal::Harmonics(plan) => balance(plan, solver, start, at, journal),
    }
}

fn relax<const D: usize>(
    steady: &Steady,
    solver: &Solver<D>,
    start: Start,
    at: &Position<'_>,
    last: bool,
    journal: &mut Journal<'_>,
) -> Solved<D> {
    let fluid = &solver.fluid;
    let (u, resume) = match start {
        Start::Fresh(u) => (u, None),
        Start::Resume(s) => (s.state, Some(s.relax)),
    };
    let fresh = resume.is_none();
    let mut relax = Relax::new(fluid, control(steady, D), u, &fluid.start(), resume);
    let orders = if last { steady.orders } else { steady.orders.min(EARLY_ORDERS) };
    journal.work.begin(relax.evaluations);
    if fresh {
        journal.save(at, 0.0, &relax.u, relax.resume())?;
    }
    let cycle = at.stages[at.stage].cycle;
    // a checkpoint may have been written by the very iteration that reached the goal
    let mut reached = relax.iteration > 0 && relax.drop() <= 10f64.powf(-orders);
    while !reached && relax.iteration < steady.iterations {
        let step = match relax.advance() {
            Ok(step) => step,
            Err(e) => {
                journal.save(at, 0.0, &relax.u, relax.resume())?;
                return Err(journal.failed(e));
            }
        };
        journal.iteration += 1;
        journal.work.add(relax.evaluations, fluid.shape.cloud.n_fluid);
        let (frame, work, state) = relax.parts();
        let loads = coefficients(fluid, &journal.axes, frame, state, work);
        journal.record((cycle, 0), &step, loads, (orders, -step.residual.log10()), fluid)?;
        if journal.due(relax.iteration) {
            journal.save(at, 0.0, &relax.u, relax.resume())?;
        }
        reached = step.residual <= 10f64.powf(-orders);
        if reached {
            break;
        }
        if journal.monitor.stop() {
            journal.save(at, 0.0, &relax.u, relax.resume())?;
            return Ok(None);
        }
    }
    (journal.drop, journal.converged) = (relax.drop(), reached);
    (journal.bytes, journal.linear) = (relax.bytes(), relax.linear);
    let (frame, work, state) = relax.parts();
    let loads = coefficients(fluid, &journal.axes, frame, state, work).unwrap_or_default();
    if at.stages[at.stage].factor == 1.0 {
        journal.cycles.push([f64::from(cycle), fluid.shape.cloud.n_real() as f64, loads.cl, loads.cd, loads.cm]);
    }
    if last {
        journal.save(at, 0.0, &relax.u, relax.resume())?;
    }
    let (frame, _, state) = relax.parts();
    Ok(Some((state.to_vec(), frame.clone())))
}

/// Where a march begins: (what it goes on from, state).
fn beginning<const D: usize>(
    start: Start,
    solver: &mut Solver<D>,
    journal: &mut Journal<'_>,
) -> Result<(Past, Vec<f64>), RunError> {
    let (past, u) = match start {
        Start::Fresh(u) => (Past::default(), u),
        Start::Resume(s) => {
            if let Some(fluid) = s.roaming.map(|r| r.resume(&solver.fluid)).transpose()?.flatten() {
                solver.fluid = fluid;
            }
            (s.past, s.state)
        }
    };
    if past.iteration == 0 && journal.start_totals.is_empty() {
        journal.start_totals = totals(&solver.fluid, &u);
    }
    Ok((past, u))
}

fn march_explicitly<const D: usize>(
    marching: &Marching,
    solver: &mut Solver<D>,
    start: Start,
    at: &Position<'_>,
    journal: &mut Journal<'_>,
) -> Solved<D> {
    let Some(until) = marching.end(journal.period) else {
        return Err(RunError::Folder("`[time.explicit]` counts periods of a motion that has none".into()));
    };
    let mut begin = beginning(start, solver, journal)?;
    let method = match marching.method {
        RungeKutta::Ssprk3 => Method::Ssprk3,
        RungeKutta::Rk4 => Method::Rk4,
    };
    let goal = (until, marching.steps, marching.periodic_tolerance);
    loop {
        let fluid = &solver.fluid;
        let mut marcher = Explicit::new(fluid, method, (marching.cfl, until), begin);
        let pause = march(&mut marcher, goal, solver, at, journal)?;
        if pause == Pause::Stop {
            return Ok(None);
        }
        let past = marcher.past().clone();
        let Some(renewed) = renewed(&mut marcher, fluid, at, journal)? else { return Ok(Some(ended(&mut marcher))) };
        begin = (past, renewed.u);
        solver.fluid = renewed.fluid;
        if pause == Pause::End {
            solver.fluid.measure();
            let frame = solver.fluid.frame_after(begin.0.time, begin.0.last, &begin.1);
            return Ok(Some((begin.1, frame)));
        }
    }
}

/// The cloud of a march built anew; `None` where particles do not travel with the fluid.
fn renewed<const D: usize>(
    marcher: &mut impl March<Fluid<D>>,
    fluid: &Fluid<D>,
    at: &Position<'_>,
    journal: &mut Journal<'_>,
) -> Result<Option<Renewed<D>>, RunError> {
    let time = marcher.past().time;
    let (frame, work, u) = marcher.parts();
    match fluid.renewed(frame, u, work, &mut journal.turnover) {
        Ok(renewed) => Ok(renewed),
        Err(source) => {
            journal.keep(at, marcher, fluid)?;
            Err(RunError::Recloud { time, source, checkpoint: journal.out.join(FILE).display().to_string() })
        }
    }
}

/// State and frame of a march that is over.
fn ended<const D: usize>(marcher: &mut impl March<Fluid<D>>) -> (Vec<f64>, Frame<D>) {
    let (frame, _, state) = marcher.parts();
    (state.to_vec(), frame.clone())
}

fn march_implicitly<const D: usize>(
    dual: &case::Dual,
    solver: &mut Solver<D>,
    start: Start,
    at: &Position<'_>,
    journal: &mut Journal<'_>,
) -> Solved<D> {
    let plan = plan(dual, journal.period)?;
    let (past, u) = beginning(start, solver, journal)?;
    let fluid = &solver.fluid;
    let mut marcher = Dual::new(fluid, inner_control(dual, D), plan, u, past);
    let goal = (plan.until, u32::MAX, dual.periodic_tolerance);
    match march(&mut marcher, goal, solver, at, journal)? {
        Pause::Stop => Ok(None),
        Pause::End | Pause::Worn => Ok(Some(ended(&mut marcher))),
    }
}

/// Steps until the end, a limit on their number, a periodic state, or a worn cloud.
fn march<const D: usize>(
    marcher: &mut impl March<Fluid<D>>,
    (until, limit, tolerance): (f64, u32, Option<f64>),
    solver: &Solver<D>,
    at: &Position<'_>,
    journal: &mut Journal<'_>,
) -> Result<Pause, RunError> {
    let fluid = &solver.fluid;
    if marcher.past().iteration == 0 {
        journal.keep(at, marcher, fluid)?;
    }
    // a checkpoint may have been written by the very step that ended the march
    let past = marcher.past();
    let settled = |t: f64| journal.is_periodic(past.time, past.time - past.last, t);
    let mut periodic = past.iteration > 0 && tolerance.is_some_and(settled);
    journal.work.begin(marcher.evaluations());
    while !marcher.finished() && !periodic && marcher.past().iteration < limit {
        if fluid.is_worn(marcher.parts().0) {
            return Ok(Pause::Worn);
        }
        let before = marcher.past().time;
        let step = match marcher.advance() {
            Ok(step) => step,
            Err(e) => {
                journal.keep(at, marcher, fluid)?;
                return Err(journal.failed(e));
            }
        };
        journal.iteration += 1;
        journal.work.add(marcher.evaluations(), fluid.shape.cloud.n_fluid);
        let inner = marcher.inner();
        let (frame, work, state) = marcher.parts();
        let loads = coefficients(fluid, &journal.axes, frame, state, work);
        journal.record((0, inner), &step, loads, (until, step.time), fluid)?;
        if let Some(interval) = journal.interval
            && (step.time / interval + NEARLY).floor() > (before / interval + NEARLY).floor()
        {
            outputs::write_series(&journal.case, &journal.out, fluid, (frame, work), interval)?;
        }
        if let (Some(surface), Some(period)) = (&solver.film, journal.period) {
            let part = |t: f64| (t / period * f64::from(outputs::FILM) + NEARLY).floor() as u64;
            if part(step.time) > part(before) {
                outputs::write_film(&journal.case, &journal.out, (fluid, surface), (frame, work), part(step.time))?;
            }
        }
        periodic = tolerance.is_some_and(|t| journal.is_periodic(step.time, before, t));
        if journal.due(step.iteration) {
            journal.keep(at, marcher, fluid)?;
        }
        if journal.monitor.stop() && !marcher.finished() && !periodic {
            journal.keep(at, marcher, fluid)?;
            return Ok(Pause::Stop);
        }
    }
    let settled = periodic || tolerance.is_none_or(|t| !journal.unsettled(t));
    (journal.time, journal.converged) = (marcher.past().time, (marcher.finished() || periodic) && settled);
    (journal.bytes, journal.linear, journal.unconverged) =
        (marcher.bytes(), marcher.linear(), marcher.past().unconverged);
    journal.keep(at, marcher, fluid)?;
    Ok(Pause::End)
}

/// Where a march stands, in the terms of a relaxation.
fn bare(iteration: u32) -> Resume {
    Resume { iteration, cfl: 0.0, first_norm: 1.0, linear: 0, phase: Phase::default(), scale: Vec::new() }
}

/// Coefficients from wall pressure and friction; `None` without bodies.
pub(super) fn coefficients<const D: usize>(
    fluid: &Fluid<D>,
    axes: &LoadFrame,
    frame: &Frame<D>,
    state: &[f64],
    work: &mut Work<D>,
) -> Option<Coefficients> {
    if fluid.shape.cloud.interface.is_empty() {
        return None;
    }
    fluid.fill_states(frame, state, work);
    if fluid.friction.is_some() {
        fluid.fill_gradients(frame, work);
    }
    Some(axes.coefficients_in(fluid, frame, work))
}

/// Angle (radians, nose up), displacement and coordinate of the first mode of the first body that moves.
pub(super) fn motion<const D: usize>(fluid: &Fluid<D>, time: f64) -> [f64; 5] {
    fluid.carriage.law().map_or([0.0; 5], |law: &Law<D>| {
        let shift = law.displacement(time).to_3d();
        let mode = law.coordinates(time).first().copied().unwrap_or(0.0);
        [law.angle(time).value, shift[0], shift[1], shift[2], mode]
    })
}

/// Totals of mass, momentum and energy over the fluid particles.
pub(super) fn totals<const D: usize>(fluid: &Fluid<D>, u: &[f64]) -> Vec<f64> {
    let n = D + 2;
    let volume = fluid.volumes();
    (0..n).map(|c| sum(fluid.shape.cloud.n_fluid, |i| volume[i] * u[i * n + c])).collect()
}
