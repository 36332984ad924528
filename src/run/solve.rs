//! One stage from its start to its end: the integrator, watched.

use super::outputs;
use super::persist::{FILE, Position, Saved};
use super::setup::{Solver, control};
use super::snapshot::{LoadFrame, Snapshot, load_axes};
use super::{Monitor, Places, RunError, Tick};
use crate::case::{Case, Explicit as Marching, RungeKutta, Steady, Temporal};
use crate::math::sweep::sum;
use crate::observe::History;
use crate::observe::loads::Coefficients;
use crate::scheme::{Fluid, Frame, Work};
use crate::time::TimeError;
use crate::time::explicit::{Explicit, Method};
use crate::time::relax::{Phase, Relax, Resume};

/// Orders of magnitude that stages before the last one are solved to.
const EARLY_ORDERS: f64 = 3.5;
/// Columns of `history.csv`.
const COLUMNS: [&str; 9] = ["cycle", "iteration", "time", "cfl", "residual", "cl", "cd", "cm", "seconds"];

/// Where a stage starts.
pub(super) enum Start {
    /// From a state.
    Fresh(Vec<f64>),
    /// Where a checkpoint stands.
    Resume(Box<Saved>),
}

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
}

impl<'a> Journal<'a> {
    /// Opens the history of a run.
    pub(super) fn open(
        case: &Case,
        places: &Places,
        saved: Option<&Saved>,
        monitor: &'a mut dyn Monitor,
    ) -> Result<Self, RunError> {
        let path = places.out.join("history.csv");
        let history = match saved {
            Some(s) => History::resume(&path, &COLUMNS, s.iteration)?,
            None => History::create(&path, &COLUMNS)?,
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

    fn record(
        &mut self,
        cycle: u32,
        step: &crate::time::Step,
        loads: Option<Coefficients>,
        goal: (f64, f64),
        n: usize,
    ) -> Result<(), RunError> {
        let c = loads.unwrap_or_default();
        let seconds = self.seconds().1;
        let row =
            [f64::from(cycle), self.iteration as f64, step.time, step.cfl, step.residual, c.cl, c.cd, c.cm, seconds];
        self.history.append(&row)?;
        self.monitor.tick(&Tick {
            iteration: self.iteration,
            goal: goal.0,
            reached: goal.1,
            residual: step.residual,
            cfl: step.cfl,
            loads: loads.map(|c| [c.cl, c.cd, c.cm]),
            particles: n,
        });
        Ok(())
    }

    fn save(&self, at: &Position<'_>, time: f64, state: &[f64], relax: Resume) -> Result<(), RunError> {
        let (cpu, wall) = self.seconds();
        let mut saved = Saved::new(at, self.iteration, time, state, relax);
        (saved.cpu_seconds, saved.wall_seconds) = (cpu, wall);
        saved.cycles = self.cycles.clone();
        saved.start_totals = self.start_totals.clone();
        saved.write(&self.out)
    }

    fn due(&self, iteration: u32) -> bool {
        self.monitor.checkpoint() || iteration.is_multiple_of(self.every)
    }

    fn failed(&self, source: TimeError) -> RunError {
        RunError::Time { source, checkpoint: self.out.join(FILE).display().to_string() }
    }
}

/// Integrates one stage; `None` when told to stop.
pub(super) fn solve<const D: usize>(
    case: &Case,
    solver: &Solver<D>,
    start: Start,
    at: &Position<'_>,
    last: bool,
    journal: &mut Journal<'_>,
) -> Result<Option<Vec<f64>>, RunError> {
    match &case.time {
        Temporal::Steady(steady) => relax(steady, solver, start, at, last, journal),
        Temporal::Explicit(marching) => march(marching, solver, start, at, journal),
        Temporal::Dual(_) => Err(RunError::Unsupported("implicit marching cannot be computed yet".into())),
    }
}

fn relax<const D: usize>(
    steady: &Steady,
    solver: &Solver<D>,
    start: Start,
    at: &Position<'_>,
    last: bool,
    journal: &mut Journal<'_>,
) -> Result<Option<Vec<f64>>, RunError> {
    let fluid = &solver.fluid;
    let (u, resume) = match start {
        Start::Fresh(u) => (u, None),
        Start::Resume(s) => (s.state, Some(s.relax)),
    };
    let fresh = resume.is_none();
    let mut relax = Relax::new(fluid, control(steady, D), u, &solver.initial, resume);
    let orders = if last { steady.orders } else { steady.orders.min(EARLY_ORDERS) };
    if fresh {
        journal.save(at, 0.0, &relax.u, relax.resume())?;
    }
    let cycle = at.stages[at.stage].cycle;
    // a checkpoint may have been written by the very iteration that reached the goal
    let mut reached = !fresh && relax.drop() <= 10f64.powf(-orders);
    while !reached && relax.iteration < steady.iterations {
        let step = match relax.advance() {
            Ok(step) => step,
            Err(e) => {
                journal.save(at, 0.0, &relax.u, relax.resume())?;
                return Err(journal.failed(e));
            }
        };
        journal.iteration += 1;
        let (frame, work, state) = relax.parts();
        let loads = coefficients(fluid, &journal.axes, frame, state, work);
        journal.record(cycle, &step, loads, (orders, -step.residual.log10()), fluid.cloud.n_fluid)?;
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
        journal.cycles.push([f64::from(cycle), fluid.cloud.n_real() as f64, loads.cl, loads.cd, loads.cm]);
    }
    if last {
        journal.save(at, 0.0, &relax.u, relax.resume())?;
    }
    Ok(Some(relax.u))
}

fn march<const D: usize>(
    marching: &Marching,
    solver: &Solver<D>,
    start: Start,
    at: &Position<'_>,
    journal: &mut Journal<'_>,
) -> Result<Option<Vec<f64>>, RunError> {
    let fluid = &solver.fluid;
    let Some(until) = marching.end(None) else {
        return Err(RunError::Unsupported("periods of a motion cannot be counted yet".into()));
    };
    let (time, done, u) = match start {
        Start::Fresh(u) => (0.0, 0, u),
        Start::Resume(s) => (s.time, s.relax.iteration, s.state),
    };
    if done == 0 && journal.start_totals.is_empty() {
        journal.start_totals = totals(fluid, &u);
    }
    let method = match marching.method {
        RungeKutta::Ssprk3 => Method::Ssprk3,
        RungeKutta::Rk4 => Method::Rk4,
    };
    let mut explicit = Explicit::new(fluid, method, (marching.cfl, until), (time, done, u));
    if done == 0 {
        journal.save(at, 0.0, &explicit.u, bare(0))?;
    }
    let mut before = explicit.time;
    while !explicit.finished() && explicit.iteration < marching.steps {
        let step = match explicit.advance() {
            Ok(step) => step,
            Err(e) => {
                journal.save(at, explicit.time, &explicit.u, bare(explicit.iteration - 1))?;
                return Err(journal.failed(e));
            }
        };
        journal.iteration += 1;
        let (frame, work, state) = explicit.parts();
        let loads = coefficients(fluid, &journal.axes, frame, state, work);
        journal.record(0, &step, loads, (until, step.time), fluid.cloud.n_fluid)?;
        if let Some(interval) = journal.interval
            && (explicit.time / interval).floor() > (before / interval).floor()
        {
            let (frame, work, state) = explicit.parts();
            fluid.fill_states(frame, state, work);
            outputs::write_series(&journal.case, &journal.out, fluid, work, frame.time, interval)?;
        }
        before = explicit.time;
        if journal.due(explicit.iteration) {
            journal.save(at, explicit.time, &explicit.u, bare(explicit.iteration))?;
        }
        if journal.monitor.stop() && !explicit.finished() {
            journal.save(at, explicit.time, &explicit.u, bare(explicit.iteration))?;
            return Ok(None);
        }
    }
    (journal.time, journal.converged) = (explicit.time, explicit.finished());
    journal.save(at, explicit.time, &explicit.u, bare(explicit.iteration))?;
    Ok(Some(explicit.u))
}

/// Where a march stands, in the terms of a relaxation.
fn bare(iteration: u32) -> Resume {
    Resume { iteration, cfl: 0.0, first_norm: 1.0, linear: 0, phase: Phase::default(), scale: Vec::new() }
}

/// Coefficients from wall pressure; `None` without bodies.
fn coefficients<const D: usize>(
    fluid: &Fluid<D>,
    axes: &LoadFrame,
    frame: &Frame<D>,
    state: &[f64],
    work: &mut Work<D>,
) -> Option<Coefficients> {
    if fluid.cloud.interface.is_empty() {
        return None;
    }
    fluid.fill_states(frame, state, work);
    Some(axes.wall_coefficients(fluid, work))
}

/// Totals of mass, momentum and energy over the fluid particles.
pub(super) fn totals<const D: usize>(fluid: &Fluid<D>, u: &[f64]) -> Vec<f64> {
    let n = D + 2;
    (0..n).map(|c| sum(fluid.cloud.n_fluid, |i| fluid.cloud.volume[i] * u[i * n + c])).collect()
}
