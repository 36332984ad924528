//! One stage from its start to its end: the integrator, watched.
use super::harmonic::balance;
use super::load_crosscheck::MOMENTS;
use super::persist::{FILE, Position, Saved};
use super::run_recorder::{NEARLY, RunRecorder};
use super::setup::{Solver, control, harmonic_prelude, inner_control, plan, prelude};
use super::snapshot::LoadFrame;
use super::{RunError, outputs};
use crate::case::{self, Case, Explicit as Marching, RungeKutta, Steady, Temporal};
use crate::math::sweep::sum;
use crate::observe::loads::Coefficients;
use crate::scheme::travel::Reclouded;
use crate::scheme::{Fluid, Frame, Work};
use crate::time::control::Control;
use crate::time::dual::{self, Dual};
use crate::time::explicit::{Explicit, Method};
use crate::time::relax::Relax;
use crate::time::{March, Past};

/// Orders of magnitude that stages before the last one are solved to.
const EARLY_ORDERS: f64 = 3.5;
/// Iterations without a new smallest residual after which a stage before the last one has given what it can.
const PATIENCE: u32 = 20;

/// Where a stage starts.
pub(super) enum Start {
    /// From a state.
    Fresh(Vec<f64>),
    /// Where a checkpoint stands.
    Resume(Box<Saved>),
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
    recorder: &mut RunRecorder<'_>,
) -> Solved<D> {
    let marches = at.stages[at.stage].march;
    match &case.time {
        Temporal::Steady(steady) => relax(steady, solver, start, at, last, recorder),
        Temporal::Dual(dual) if !marches => relax(&prelude(dual), solver, start, at, false, recorder),
        Temporal::Dual(dual) => march_implicitly(dual, solver, start, at, recorder),
        Temporal::Explicit(marching) => march_explicitly(marching, solver, start, at, recorder),
        Temporal::Harmonics(plan) if !marches => relax(&harmonic_prelude(plan), solver, start, at, false, recorder),
        Temporal::Harmonics(plan) => balance(plan, solver, start, at, recorder),
    }
}

fn relax<const D: usize>(
    steady: &Steady,
    solver: &Solver<D>,
    start: Start,
    at: &Position<'_>,
    last: bool,
    recorder: &mut RunRecorder<'_>,
) -> Solved<D> {
    let fluid = &solver.fluid;
    let (u, resume) = match start {
        Start::Fresh(u) => (u, None),
        Start::Resume(s) => (s.state, Some(s.relax)),
    };
    let fresh = resume.is_none();
    let mut relax = Relax::new(fluid, control(steady, D), u, &fluid.start(), resume);
    let orders = if last { steady.orders } else { steady.orders.min(EARLY_ORDERS) };
    recorder.work.begin(relax.evaluations);
    if fresh {
        recorder.save(at, 0.0, &relax.u, relax.resume())?;
    }
    let cycle = at.stages[at.stage].cycle;
    // a checkpoint may have been written by the very iteration that reached the goal
    let mut reached = relax.iteration > 0 && relax.drop() <= 10f64.powf(-orders);
    let rests = |relax: &Relax<'_, Fluid<D>>| !last && relax.resting() >= PATIENCE;
    while !reached && relax.iteration < steady.iterations && !rests(&relax) {
        let step = match relax.advance() {
            Ok(step) => step,
            Err(e) => {
                recorder.save(at, 0.0, &relax.u, relax.resume())?;
                return Err(recorder.failed(e));
            }
        };
        recorder.count();
        recorder.work.add(relax.evaluations, fluid.discretisation.cloud.n_fluid);
        let (frame, work, state) = relax.parts();
        let loads = coefficients(fluid, recorder.axes(), frame, state, work);
        recorder.record((cycle, 0), &step, loads, (orders, -step.residual.log10()), fluid)?;
        if recorder.due(relax.iteration) {
            recorder.save(at, 0.0, &relax.u, relax.resume())?;
        }
        reached = step.residual <= 10f64.powf(-orders);
        if reached {
            break;
        }
        if recorder.stopped() && !rests(&relax) {
            recorder.save(at, 0.0, &relax.u, relax.resume())?;
            return Ok(None);
        }
    }
    if !reached && rests(&relax) {
        let orders = -relax.drop().log10();
        recorder.note(&format!(
            "the flow has not come nearer to a steady one for {PATIENCE} iterations, at {orders:.1} orders: the run goes on from there"
        ));
    }
    (recorder.drop, recorder.converged) = (relax.drop(), reached);
    (recorder.bytes, recorder.linear) = (relax.bytes(), relax.linear);
    let (frame, work, state) = relax.parts();
    let loads = coefficients(fluid, recorder.axes(), frame, state, work).unwrap_or_default();
    if at.stages[at.stage].factor == 1.0 {
        recorder.cycles.push([
            f64::from(cycle),
            fluid.discretisation.cloud.n_real() as f64,
            loads.cl,
            loads.cd,
            loads.cm,
        ]);
    }
    if last {
        recorder.save(at, 0.0, &relax.u, relax.resume())?;
    }
    let (frame, _, state) = relax.parts();
    Ok(Some((state.to_vec(), frame.clone())))
}

/// Where a march begins: (what it goes on from, state).
fn beginning<const D: usize>(
    start: Start,
    solver: &mut Solver<D>,
    recorder: &mut RunRecorder<'_>,
) -> Result<(Past, Vec<f64>), RunError> {
    let (past, u) = match start {
        Start::Fresh(u) => (Past::default(), u),
        Start::Resume(s) => {
            if let Some(fluid) = s.lagrangian.map(|r| r.resume(&solver.fluid)).transpose()?.flatten() {
                solver.fluid = fluid;
            }
            (s.past, s.state)
        }
    };
    if past.iteration == 0 && recorder.start_totals.is_empty() {
        recorder.start_totals = totals(&solver.fluid, &u);
    }
    Ok((past, u))
}

fn march_explicitly<const D: usize>(
    marching: &Marching,
    solver: &mut Solver<D>,
    start: Start,
    at: &Position<'_>,
    recorder: &mut RunRecorder<'_>,
) -> Solved<D> {
    let Some(until) = marching.end(recorder.period) else {
        return Err(RunError::Folder("`[time.explicit]` counts periods of a motion that has none".into()));
    };
    let method = match marching.method {
        RungeKutta::Ssprk3 => Method::Ssprk3,
        RungeKutta::Rk4 => Method::Rk4,
    };
    let goal = (until, marching.steps, marching.periodic_tolerance);
    march_on(&Plan::Explicit(method, (marching.cfl, until)), goal, (solver, start), at, recorder)
}

/// How to march.
enum Plan {
    Dual(Control, dual::Plan),
    Explicit(Method, (f64, f64)),
}

impl Plan {
    fn marcher<'a, const D: usize>(
        &self,
        fluid: &'a Fluid<D>,
        begin: (Past, Vec<f64>),
    ) -> Box<dyn March<Fluid<D>> + 'a> {
        match *self {
            Self::Dual(control, plan) => Box::new(Dual::new(fluid, control, plan, begin)),
            Self::Explicit(method, until) => Box::new(Explicit::new(fluid, method, until, begin)),
        }
    }
}

/// Marches to the end; where particles travel, the cloud is built anew on the way.
fn march_on<const D: usize>(
    plan: &Plan,
    goal: (f64, u32, Option<f64>),
    (solver, start): (&mut Solver<D>, Start),
    at: &Position<'_>,
    recorder: &mut RunRecorder<'_>,
) -> Solved<D> {
    let mut begin = beginning(start, solver, recorder)?;
    loop {
        let fluid = &solver.fluid;
        let mut owned = plan.marcher(fluid, begin);
        let marcher = owned.as_mut();
        let pause = march(marcher, goal, solver, at, recorder)?;
        if pause == Pause::Stop {
            return Ok(None);
        }
        let mut past = marcher.past().clone();
        let Some(reclouded) = reclouded(marcher, fluid, at, recorder)? else { return Ok(Some(ended(marcher))) };
        [past.before, past.older] = reclouded.past;
        begin = (past, reclouded.u);
        drop(owned);
        solver.fluid = reclouded.fluid;
        if pause == Pause::End {
            solver.fluid.measure();
            let frame = solver.fluid.frame_after(&begin.1);
            return Ok(Some((begin.1, frame)));
        }
    }
}

/// The cloud of a march built anew; `None` where particles do not travel with the fluid.
fn reclouded<const D: usize>(
    marcher: &mut dyn March<Fluid<D>>,
    fluid: &Fluid<D>,
    at: &Position<'_>,
    recorder: &mut RunRecorder<'_>,
) -> Result<Option<Reclouded<D>>, RunError> {
    let time = marcher.past().time;
    let past = marcher.past().clone();
    let (frame, work, u) = marcher.parts();
    match fluid.reclouded(frame, (u, [&past.before, &past.older]), work, &mut recorder.ledger) {
        Ok(reclouded) => Ok(reclouded),
        Err(source) => {
            recorder.keep(at, marcher, fluid)?;
            Err(RunError::Recloud { time, source, checkpoint: recorder.out().join(FILE).display().to_string() })
        }
    }
}

/// State and frame of a march that is over.
fn ended<const D: usize>(marcher: &mut dyn March<Fluid<D>>) -> (Vec<f64>, Frame<D>) {
    let (frame, _, state) = marcher.parts();
    (state.to_vec(), frame.clone())
}

fn march_implicitly<const D: usize>(
    dual: &case::Dual,
    solver: &mut Solver<D>,
    start: Start,
    at: &Position<'_>,
    recorder: &mut RunRecorder<'_>,
) -> Solved<D> {
    let plan = plan(dual, recorder.period)?;
    let goal = (plan.until, u32::MAX, dual.periodic_tolerance);
    march_on(&Plan::Dual(inner_control(dual, D), plan), goal, (solver, start), at, recorder)
}

/// Steps until the end, a limit on their number, a periodic state, or a worn cloud.
fn march<const D: usize>(
    marcher: &mut dyn March<Fluid<D>>,
    (until, limit, tolerance): (f64, u32, Option<f64>),
    solver: &Solver<D>,
    at: &Position<'_>,
    recorder: &mut RunRecorder<'_>,
) -> Result<Pause, RunError> {
    let fluid = &solver.fluid;
    if marcher.past().iteration == 0 {
        recorder.keep(at, marcher, fluid)?;
    }
    // a checkpoint may have been written by the very step that ended the march
    let past = marcher.past();
    let settled = |t: f64| recorder.is_periodic(past.time, past.time - past.last, t);
    let mut periodic = past.iteration > 0 && tolerance.is_some_and(settled);
    recorder.work.begin(marcher.evaluations());
    while !marcher.finished() && !periodic && marcher.past().iteration < limit {
        if fluid.is_worn(marcher.parts().0) {
            return Ok(Pause::Worn);
        }
        let before = marcher.past().time;
        let step = match marcher.advance() {
            Ok(step) => step,
            Err(e) => {
                recorder.keep(at, marcher, fluid)?;
                return Err(recorder.failed(e));
            }
        };
        recorder.count();
        recorder.work.add(marcher.evaluations(), fluid.discretisation.cloud.n_fluid);
        let inner = marcher.inner();
        let (frame, work, state) = marcher.parts();
        let loads = coefficients(fluid, recorder.axes(), frame, state, work);
        recorder.record((0, inner), &step, loads, (until, step.time), fluid)?;
        let parts = recorder.period.map(|p| p / f64::from(MOMENTS));
        if parts.is_some_and(|part| passed(step.time, part) > passed(before, part)) {
            recorder.compare((0, step.time), fluid, (frame, state, &mut *work))?;
        }
        write_due(solver, (frame, work), (before, step.time), recorder)?;
        periodic = tolerance.is_some_and(|t| recorder.is_periodic(step.time, before, t));
        if recorder.due(step.iteration) {
            recorder.keep(at, marcher, fluid)?;
        }
        if recorder.stopped() && !marcher.finished() && !periodic {
            recorder.keep(at, marcher, fluid)?;
            return Ok(Pause::Stop);
        }
    }
    let settled = periodic || tolerance.is_none_or(|t| !recorder.unsettled(t));
    (recorder.time, recorder.converged) = (marcher.past().time, (marcher.finished() || periodic) && settled);
    (recorder.bytes, recorder.linear) = (marcher.bytes(), marcher.linear());
    (recorder.unconverged, recorder.halved) = (marcher.past().unconverged, marcher.past().halved);
    if recorder.halved > 0 {
        recorder.note(&format!("steps in time were halved {} times, where Newton's method stalled", recorder.halved));
    }
    recorder.keep(at, marcher, fluid)?;
    Ok(Pause::End)
}

/// Whole intervals that have passed at `t`.
fn passed(t: f64, interval: f64) -> u64 {
    (t / interval + NEARLY).floor() as u64
}

/// Writes the files of the field and of the film that fall into a step.
fn write_due<const D: usize>(
    solver: &Solver<D>,
    (frame, work): (&Frame<D>, &mut Work<D>),
    (before, now): (f64, f64),
    recorder: &RunRecorder<'_>,
) -> Result<(), RunError> {
    let (case, out, fluid) = (recorder.case(), recorder.out(), &solver.fluid);
    if let Some(interval) = recorder.interval()
        && passed(now, interval) > passed(before, interval)
    {
        outputs::write_series(case, out, fluid, (frame, work), interval)?;
    }
    if let (Some(surface), Some(period)) = (&solver.film, recorder.period) {
        let part = |t: f64| passed(t, period / f64::from(outputs::FILM));
        if part(now) > part(before) {
            outputs::write_film(case, out, (fluid, surface), (frame, work), part(now))?;
        }
    }
    Ok(())
}

/// Coefficients from wall pressure and friction; `None` without bodies.
pub(super) fn coefficients<const D: usize>(
    fluid: &Fluid<D>,
    axes: &LoadFrame,
    frame: &Frame<D>,
    state: &[f64],
    work: &mut Work<D>,
) -> Option<Coefficients> {
    if fluid.discretisation.cloud.interface.is_empty() {
        return None;
    }
    fluid.fill_states(frame, state, work);
    if fluid.viscous_model.is_some() {
        fluid.fill_gradients(frame, work);
    }
    Some(axes.coefficients_in(fluid, frame, work))
}

/// Totals of mass, momentum and energy over the fluid particles.
pub(super) fn totals<const D: usize>(fluid: &Fluid<D>, u: &[f64]) -> Vec<f64> {
    let n = D + 2;
    let volume = fluid.volumes();
    (0..n).map(|c| sum(fluid.discretisation.cloud.n_fluid, |i| volume[i] * u[i * n + c])).collect()
}
