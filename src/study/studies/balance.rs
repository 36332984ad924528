//! Harmonic balance with one number of harmonics, and what is made of the last one.
use super::super::keeper::Camera;
use super::super::record::Log;
use super::super::record::saved::Settling;
use super::super::setup::Solver;
use super::super::stage::Task;
use super::super::watch::{Aim, Checkpoint, Ending, Observer, Progress, Told, drive};
use super::check::marched_on;
use super::periodic::{PeriodicState, build, period_of, terms};
use super::settled::{PeriodicEyes, Settled};
use super::turn::{Reached, Start, Turn};
use crate::case::Harmonics;
use crate::math::fourier::{Instances, Series};
use crate::math::reduce::sum;
use crate::physics::n_variables;
use crate::problem::RunError;
use crate::problem::numerics::{harmonic_control, is_automatic};
use crate::record::summary::BalanceReport;
use crate::scheme::{Fluid, Frame, HasGas};
use crate::system::System;
use crate::time::control::Method;
use crate::time::harmonic::HarmonicBalance;
use crate::time::relax::{Relax, Resume};
use crate::time::{Integrator, Memory};

/// Orders by which the residual must fall with fewer harmonics than are wanted.
const EARLY_ORDERS: f64 = 3.0;
/// Courant number that Newton's method begins with near a solution, over that of a relaxation.
const NEAR: f64 = 10.0;
/// Least change of the loads that ends a relaxation with fewer harmonics than are wanted.
const EARLY_TOLERANCE: f64 = 3e-3;
/// Relative error of the wall velocity above which a run warns.
const WALL_ERROR: f64 = 0.01;

/// Finds the periodic solution with the harmonics of a stage; `None` when told to stop.
pub(crate) fn balance<S: HasGas<D>, const D: usize>(
    solver: &Solver<S, D>,
    plan: &Harmonics,
    start: Start,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<Option<Reached<S>>, RunError> {
    let (system, Task::Balance { harmonics }) = (&solver.system, turn.stage().task) else {
        return Err(RunError::NoStage);
    };
    let period = period_of(system, log)?;
    let balance = build(system, plan, harmonics, period);
    let seek = begun(&balance, (system, plan), start, log);
    let Some(state) = converge(&balance, system, seek, turn, log)? else { return Ok(None) };
    let found = PeriodicState { balance: &balance, system, state: &state, period };
    let report = report(&found, log);
    let tail = report.tail_loads.zip(report.tail_density).map(|(a, b)| a.max(b));
    let short = tail.is_some_and(|t| t <= plan.tail);
    if turn.last() || (is_automatic(plan) && short && turn.stage().factor == 1.0) {
        return finish(&found, (solver, turn.camera), plan, report, log);
    }
    let next = turn.at.stages.get(turn.at.stage + 1).map_or(0, |s| s.instances() / 2);
    log.note(&format!("{harmonics} harmonics done, {next} follow"));
    Ok(Some(Reached { state, end: None, enough: false, unsteady: false }))
}

/// State at all instances, from one or from another number of them, and where a relaxation stands.
fn begun<'a, S: System>(
    balance: &HarmonicBalance<'_, S>,
    (system, plan): (&S, &'a Harmonics),
    start: Start,
    log: &mut Log<'_>,
) -> Seek<'a> {
    let u = match start {
        Start::Resume(state, Memory::Relaxation(resume)) => {
            return Seek { plan, state, resume: Some(resume), near: false };
        }
        other => other.into_state(),
    };
    log.record.settling = Settling { earlier: log.record.evaluations, ..Settling::default() };
    let (count, wanted) = (u.len() / system.len(), balance.instances().count());
    let state = match count {
        1 => balance.led_copies(&u),
        _ if count == wanted => u,
        _ => balance.led_resampled(&u, Instances::of_harmonics(count / 2)),
    };
    Seek { plan, state, resume: None, near: count > 1 && plan.march == 0 }
}

/// What a relaxation begins with.
struct Seek<'a> {
    plan: &'a Harmonics,
    state: Vec<f64>,
    resume: Option<Resume>,
    /// The state is a periodic solution, on another cloud, of another case or with fewer harmonics.
    near: bool,
}

/// Relaxes until the residual has fallen, or the loads no longer change.
fn converge<S: HasGas<D>, const D: usize>(
    balance: &HarmonicBalance<'_, S>,
    system: &S,
    seek: Seek<'_>,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<Option<Vec<f64>>, RunError> {
    let Seek { plan, mut state, resume, near } = seek;
    if resume.is_none() {
        balance.prescribe(0.0, &mut state);
    }
    let last = turn.stage().factor == 1.0 && (turn.last() || is_automatic(plan));
    let orders = if last { plan.orders } else { plan.orders.min(EARLY_ORDERS) };
    let tolerance = if last { plan.tolerance } else { plan.tolerance.max(EARLY_TOLERANCE) };
    let (origin, control) = (balance.copies(&system.start()), harmonic_control(plan, D));
    let mut relax = Relax::new(balance, control, state, &origin, resume);
    if near && control.method == Method::NewtonKrylov {
        relax.begin_with_newton();
        relax.cfl = (NEAR * control.cfl).min(control.cfl_max);
    }
    drop(origin);
    relax.evaluations = log.record.settling.evaluations;
    let eyes = &mut PeriodicEyes::new(balance, system);
    let mut progress = Progress { eyes, cycle: 0, aim: Aim::Orders(orders) };
    let mut settled = Settled { goal: 10f64.powf(-orders), tolerance, iterations: plan.iterations };
    let mut checkpoint = Checkpoint::new(turn.at, None, true);
    let all: &mut [&mut dyn Observer<_, Log<'_>>] = &mut [&mut progress, &mut settled, &mut Told, &mut checkpoint];
    let ending = drive(&mut relax, all, log)?;
    match ending {
        Ending::Stopped => return Ok(None),
        Ending::Failed(problem) => return Err(log.failed(problem)),
        Ending::Finished | Ending::Spent | Ending::Paused => {}
    }
    let cost = relax.cost();
    let record = &mut log.record;
    (record.drop, record.converged) = (relax.drop(), matches!(ending, Ending::Finished));
    (record.bytes, record.linear) = (cost.bytes, cost.linear);
    record.evaluations = record.settling.earlier + cost.evaluations * balance.times().len() as u64;
    if !record.converged && turn.stage().factor > 1.0 {
        // a cloud that only gives a start gives none
        return Err(log.failed(relax.stalled()));
    }
    if !record.converged && settled.is_stuck(relax.iteration, &record.settling) {
        let text = Settled::told(relax.drop(), balance.instances().harmonics(), &relax.worst());
        log.warn(&text);
    }
    Ok(Some(relax.u))
}

/// Tells, checks and writes what was found; state and frame of the first instance, `None` when told to stop.
fn finish<S: HasGas<D>, const D: usize>(
    found: &PeriodicState<'_, S, D>,
    (solver, camera): (&Solver<S, D>, Option<&dyn Camera<D>>),
    plan: &Harmonics,
    mut report: BalanceReport,
    log: &mut Log<'_>,
) -> Result<Option<Reached<S>>, RunError> {
    tell(plan, &report, log);
    if let Some(series) = found.trace(log).filter(|_| plan.check > 0) {
        let Some(checked) = marched_on(plan, found, &series, log)? else { return Ok(None) };
        log.note(&checked.told());
        report.march = Some(checked);
    }
    if let Some(modes) = &solver.force_modes {
        let mut forces = Vec::new();
        found.between(|view, work| forces.push(modes.seen(view, work)));
        log.record.forces = modes.over_a_period(&forces);
    }
    found.compare(log)?;
    found.sample_structures(log)?;
    camera.map_or(Ok(()), |camera| found.write(solver.film.as_ref(), camera, log))?;
    log.record.balance = Some(report);
    let (frame, first) = found.instance(0);
    Ok(Some(Reached { state: found.state.to_vec(), end: Some((frame, first)), enough: true, unsteady: false }))
}

/// Says what a user should know of the truncation.
fn tell(plan: &Harmonics, report: &BalanceReport, log: &mut Log<'_>) {
    let n = report.harmonics;
    if let Some(tail) = report.tail_loads.into_iter().chain(report.tail_density).reduce(f64::max)
        && tail > plan.tail
    {
        log.warn(&format!(
            "the last of {n} harmonics still holds {:.1} % of them: add harmonics, or let `number = \"auto\"` do so",
            100.0 * tail
        ));
    }
    if report.wall_velocity_error > WALL_ERROR {
        log.warn(&format!(
            "{n} harmonics miss {:.1} % of the velocity of the walls: add harmonics",
            100.0 * report.wall_velocity_error
        ));
    }
}

fn report<S: HasGas<D>, const D: usize>(found: &PeriodicState<'_, S, D>, log: &Log<'_>) -> BalanceReport {
    let held = found.balance.instances();
    let n = held.harmonics();
    let part = |s: &Series| {
        let terms = terms(s);
        let all: f64 = terms.iter().take(n).map(|t| t.norm()).sum();
        if all > 0.0 { terms[n - 1].norm() / all } else { 0.0 }
    };
    let tail_loads = found.loads(log).filter(|_| n > 1).map(|s| part(&s[0]).max(part(&s[2])));
    let density = &found.gas();
    let frames = found.frames();
    let gas: Vec<&Frame<D>> = frames.iter().map(|f| found.system.gas_frame(f)).collect();
    BalanceReport {
        harmonics: n,
        instances: frames.len(),
        tail_loads,
        tail_density: (n > 1).then(|| density_tail(found.system.gas(), held, density)),
        wall_velocity_error: wall_velocity_error(found.system.gas(), &gas),
        evaluations: log.record.evaluations,
        march: None,
    }
}

/// Part of the last harmonic of the density in all of them.
fn density_tail<const D: usize>(fluid: &Fluid<D>, held: Instances, state: &[f64]) -> f64 {
    let (n, b) = (held.harmonics(), n_variables(D));
    let forth = held.to_coefficients();
    let volume = fluid.volumes();
    let size = |m: usize| {
        let square = |i: usize| {
            let all = &state[i * b * held.count()..(i + 1) * b * held.count()];
            let coefficient =
                |row: usize| -> f64 { forth.row(row).iter().zip(all.chunks_exact(b)).map(|(e, u)| e * u[0]).sum() };
            volume[i] * (coefficient(m).powi(2) + coefficient(n + m).powi(2))
        };
        sum(volume.len(), square).sqrt()
    };
    let all: f64 = (1..=n).map(size).sum();
    if all > 0.0 { size(n) / all } else { 0.0 }
}

/// |w − ẋ|/|ẋ| of the walls.
fn wall_velocity_error<const D: usize>(fluid: &Fluid<D>, frames: &[&Frame<D>]) -> f64 {
    let cloud = &fluid.discretisation.cloud;
    let (mut miss, mut size) = (0.0, 0.0);
    for frame in frames {
        for (i, wall) in cloud.interface_range().zip(&cloud.interface) {
            let Some(law) = fluid.cloud_motion.law_of(usize::from(wall.body)) else { continue };
            let exact = law.velocity(frame.time, &cloud.x[i]);
            miss += (frame.to_inertial_axes(&frame.velocity_of(i)) - exact).norm().powi(2);
            size += exact.norm().powi(2);
        }
    }
    if size > 0.0 { (miss / size).sqrt() } else { 0.0 }
}
