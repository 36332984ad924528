//! Marching in time; where particles travel, in legs between which the cloud is built anew.
use super::super::look::totals;
use super::super::record::Log;
use super::super::record::saved::LagrangianCheckpoint;
use super::super::setup::Solver;
use super::super::watch::{
    Aim, Alike, Checkpoint, CrossCheck, Ending, FieldSeries, Film, GasEyes, Limit, Observer, Particles, Periodic,
    Progress, Structures, Told, Worn, drive,
};
use super::turn::{Reached, Start, Turn};
use crate::coupling::Marches;
use crate::physics::n_variables;
use crate::problem::RunError;
use crate::problem::numerics::{Marching, Scheme};
use crate::scheme::Reclouded;
use crate::scheme::{Fluid, HasGas, RemapLedger};
use crate::system::{Instant, System};
use crate::time::dual::Dual;
use crate::time::{Integrator, Memory, Past, Standing};

/// Marches to the end; `None` when told to stop. `solver` may end on another cloud.
pub(crate) fn march<S: Marches<D>, const D: usize>(
    solver: &mut Solver<S, D>,
    marching: &Marching,
    start: Start,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<Option<Reached<S>>, RunError> {
    let mut begin = match start {
        Start::Resume(u, Memory::March(past)) => (past, u),
        other => (Past::default(), other.into_state()),
    };
    if begin.0.iteration == 0 && log.record.start_totals.is_empty() {
        log.record.start_totals =
            totals(&solver.system.gas().volumes(), solver.system.gas_state(&begin.1), n_variables(D));
    }
    loop {
        let system = &solver.system;
        let mut integrator = integrator(system, marching, begin);
        let ending = watched(solver, integrator.as_mut(), marching, turn, log)?;
        match ending {
            Ending::Stopped => return Ok(None),
            Ending::Failed(problem) => return Err(log.failed(problem)),
            Ending::Finished | Ending::Spent => tell(integrator.as_ref(), &ending, marching, log),
            Ending::Paused => {}
        }
        let Memory::March(past) = integrator.memory() else { return Err(RunError::NoStage) };
        let Some(renewed) = renewed(system, integrator.as_mut(), &past, turn, log)? else {
            let Standing { frame, state, .. } = integrator.standing();
            let (frame, state) = (frame.clone(), state.to_vec());
            drop(integrator);
            return Ok(Some(Reached::at(frame, state)));
        };
        drop(integrator);
        let Renewed { mut fluid, past, u } = renewed;
        let over = !matches!(ending, Ending::Paused);
        if over {
            fluid.measure();
        }
        solver.system.set_gas(fluid);
        if over {
            let system = &solver.system;
            let at = Instant::formula(system.gas().stood(), &[]);
            return Ok(Some(Reached::at(system.frame(&at.with(&system.placing().values(&u)), &u), u)));
        }
        begin = (past, u);
    }
}

fn integrator<'a, S: Marches<D>, const D: usize>(
    system: &'a S,
    marching: &Marching,
    (past, u): (Past, Vec<f64>),
) -> Box<dyn Integrator<S> + 'a> {
    match marching.scheme {
        Scheme::Dual(control, plan) => Box::new(Dual::new(system, control, plan, past, u)),
        Scheme::Explicit(plan) => system.explicit(plan, past, u),
    }
}

/// Drives one leg under the eyes of all that watch a march.
fn watched<S: Marches<D>, const D: usize>(
    solver: &Solver<S, D>,
    integrator: &mut (dyn Integrator<S> + '_),
    marching: &Marching,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<Ending, RunError> {
    let system = &solver.system;
    let eyes = &mut GasEyes { system };
    let keep = keeper(system);
    let mut progress = Progress { eyes, cycle: 0, aim: Aim::Time(marching.until) };
    let (mut crosscheck, mut structures) = (CrossCheck { system }, Structures { system });
    let interval = log.case.output.field_interval.map(|t| log.units.solver_time(t.0));
    let mut series = turn.camera.zip(interval).map(|(camera, interval)| FieldSeries { system, camera, interval });
    let mut film = turn.camera.zip(solver.film.as_ref()).map(|(camera, surface)| Film { system, camera, surface });
    let mut periodic = marching.tolerance.map(|tolerance| Periodic { tolerance });
    let mut alike = marching.swing.map(|period| Alike { period, seen: 0 });
    let (mut limit, mut worn) = (Limit { iterations: marching.limit }, Worn { system });
    let mut checkpoint = checkpoint(turn, &keep);
    let mut told = Told;
    let mut all: Vec<&mut dyn Observer<S, Log<'_>>> = vec![&mut progress, &mut structures, &mut crosscheck];
    all.extend(series.as_mut().map(|o| o as &mut dyn Observer<S, Log<'_>>));
    all.extend(film.as_mut().map(|o| o as &mut dyn Observer<S, Log<'_>>));
    all.extend(periodic.as_mut().map(|o| o as &mut dyn Observer<S, Log<'_>>));
    all.extend(alike.as_mut().map(|o| o as &mut dyn Observer<S, Log<'_>>));
    all.extend([&mut limit as &mut dyn Observer<S, Log<'_>>, &mut told, &mut worn, &mut checkpoint]);
    drive(integrator, &mut all, log)
}

/// Keeps what is known of a march that is over.
fn tell<S: HasGas<D>, const D: usize>(
    integrator: &dyn Integrator<S>,
    ending: &Ending,
    marching: &Marching,
    log: &mut Log<'_>,
) {
    let settled = marching.tolerance.map(|t| settled(t, log));
    let cost = integrator.cost();
    let record = &mut log.record;
    record.time = log.units.case_time(integrator.mark().time);
    // a tolerance that could not be tested says nothing
    record.settled = settled == Some(Some(true));
    record.converged = matches!(ending, Ending::Finished) && settled != Some(Some(false));
    record.linear_before += cost.linear;
    (record.bytes, record.linear) = (cost.bytes, record.linear_before);
    (record.unconverged, record.halved) = (cost.unconverged, cost.halved);
    if cost.halved > 0 {
        log.warn(&format!("steps in time were halved {} times, where Newton's method stalled", cost.halved));
    }
}

/// False, with a warning, when the loads of the last period still differ from those of the period before; `None` where there are not two.
fn settled(tolerance: f64, log: &mut Log<'_>) -> Option<bool> {
    let period = log.case_period()?;
    let Some(change) = log.record.trace.change(period) else {
        log.warn(
            "`periodic_tolerance` was not tested: loads are compared over the last two periods; march two or more",
        );
        return None;
    };
    let largest = change.mean.max(change.first_harmonic);
    if largest < tolerance {
        return Some(true);
    }
    log.warn(&format!(
        "the loads have not settled: after {:.4} periods mean and first harmonic still change by {largest:.1e} from one \
         period to the next (`periodic_tolerance` {tolerance:.1e}); more `periods` may do, unless the flow has a rhythm of \
         its own: see `lift_cycles` in `summary.json`",
        change.periods
    ));
    Some(false)
}

/// A march on a cloud built anew.
struct Renewed<const D: usize> {
    fluid: Fluid<D>,
    past: Past,
    u: Vec<f64>,
}

/// The gas on a cloud built anew; `None` where particles do not travel with it.
fn renewed<S: HasGas<D>, const D: usize>(
    system: &S,
    integrator: &mut (dyn Integrator<S> + '_),
    past: &Past,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<Option<Renewed<D>>, RunError> {
    let gas_before = |u: &'_ [f64]| if u.is_empty() { Vec::new() } else { system.gas_state(u).to_vec() };
    let (before, older) = (gas_before(&past.before), gas_before(&past.older));
    let Standing { frame, work, state, .. } = integrator.standing();
    let (gas, ledger) = (system.gas(), &mut log.record.ledger);
    let states = (system.gas_state(state), [&before[..], &older[..]]);
    let found = match gas.reclouded(system.gas_frame(frame), states, system.gas_work(work), ledger) {
        Ok(found) => found,
        Err(source) => {
            checkpoint(turn, &keeper(system)).keep(integrator, log)?;
            let time = log.units.case_time(past.time);
            return Err(RunError::Recloud { time, source, checkpoint: log.checkpoint() });
        }
    };
    let Some(Reclouded { fluid, u, past: [before, older] }) = found else { return Ok(None) };
    let whole = |u: &[f64], gas: Vec<f64>| if u.is_empty() { gas } else { system.with_gas(u, &gas) };
    let past = Past { before: whole(&past.before, before), older: whole(&past.older, older), ..past.clone() };
    Ok(Some(Renewed { fluid, past, u: system.with_gas(state, &u) }))
}

/// What checkpoints keep of particles that travel.
fn keeper<S: HasGas<D>, const D: usize>(
    system: &S,
) -> impl Fn(&S::Frame, &RemapLedger) -> Option<LagrangianCheckpoint> + '_ {
    |frame, ledger| LagrangianCheckpoint::of(system.gas(), system.gas_frame(frame), ledger)
}

fn checkpoint<'a, S: System, const D: usize>(
    turn: &'a Turn<'a, D>,
    particles: &'a Particles<'a, S>,
) -> Checkpoint<'a, S> {
    Checkpoint::new(turn.at, Some(particles), true)
}
