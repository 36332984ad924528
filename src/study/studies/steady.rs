//! Relaxation to a steady state: the end of a steady case, or the start of another.
use super::super::look::friction::{chordwise, sonic_places};
use super::super::look::{GasView, entropy_drag, momentum};
use super::super::record::family;
use super::super::record::{IterationHistory, Log};
use super::super::stage::{Stage, Task};
use super::super::watch::{
    Aim, Checkpoint, Ending, Flat, GasEyes, Given, Limit, Observer, Progress, Resting, Swinging, Told, drive, sample,
};
use super::turn::{Reached, Start, Turn};
use crate::case::{Accuracy, Case, Side, Steady};
use crate::cloud::CloudSpec;
use crate::math::Bounds;
use crate::math::reduce::first;
use crate::observe::convergence::CloudLoads;
use crate::observe::loads::Coefficients;
use crate::problem::RunError;
use crate::problem::numerics::control;
use crate::problem::spacing;
use crate::scheme::{Fluid, HasGas, View, Work};
use crate::system::Implicit;
use crate::time::relax::Relax;
use crate::time::{Integrator, Memory, Standing};

/// Orders of magnitude that relaxations before another one are solved to, and where shocks are to be expected: the next cloud moves them anyway.
/// What is left in smooth flows takes as many iterations on the next cloud, each dearer.
const EARLY_ORDERS: f64 = 4.5;
const EARLY_ORDERS_OF_SHOCKS: f64 = 3.0;
/// Orders beyond those of a single cloud, on the clouds of a family whose loads have not come to rest by then: what loads change by from one to
/// the next must not be what is left of their residual.
const SETTLING: f64 = 1.5;
/// Iterations without a new smallest residual after which a relaxation before the last stage has given what it can.
const PATIENCE: u32 = 20;
/// The same where loads have changed by less than this part of the largest, on a single cloud's way to its own: the next cloud changes them
/// by a hundred times as much.
const PATIENCE_AT_REST: u32 = 4;
const GIVEN: f64 = 1e-4;
/// The same for the last stage: no later one makes up for it.
const LAST_PATIENCE: usize = 200;
/// The same on the last cloud of a family, where the one before serves in its place.
const FAMILY_PATIENCE: usize = 100;
/// The same for the last stage of a point of a polar that starts from rest: the other points wait.
const POINT_PATIENCE: usize = 60;

/// Iterations that loads are watched over where the residual does not reach its goal.
const UNSETTLED: usize = 20;

/// Relaxes; `None` when told to stop.
pub(crate) fn relax<S: HasGas<D>, const D: usize>(
    system: &S,
    steady: &Steady,
    start: Start,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<Option<Reached<S>>, RunError> {
    let (u, resume) = match start {
        Start::Resume(u, Memory::Relaxation(resume)) => (u, Some(resume)),
        other => (other.into_state(), None),
    };
    let mut u = u;
    if resume.is_none() {
        system.prescribe(0.0, &mut u);
    }
    let asked = spacing::asked(&log.case);
    let goals = goals(steady, turn, &log.case);
    let mut level = 0;
    let mut relax = Relax::new(system, control(steady, D), u, &system.start(), resume);
    let mut hurried = !turn.last();
    let enough = loop {
        let orders = goals[level];
        relax.goal = 10f64.powf(-orders);
        let ending = watched(system, &mut relax, (steady.iterations, hurried), turn, log, orders)?;
        match ending {
            Ending::Stopped => return Ok(None),
            Ending::Failed(problem) => return Err(log.failed(problem)),
            Ending::Finished => relax.goal = relax.goal.max(relax.drop()),
            Ending::Spent | Ending::Paused => {}
        }
        log.record.reason = (!relax.finished()).then(|| short_of_goal(&relax, steady, orders, &log.record.history));
        let loads = tell(system, &mut relax, turn, log)?;
        let enough = asked.is_some_and(|asked| family::judge(&asked, loads, log));
        let restless = asked.is_some_and(|asked| !family::at_rest(&asked, &loads));
        let further = restless || level == 0 && (enough || turn.last());
        if relax.finished() && level + 1 < goals.len() && further {
            level += 1;
            continue;
        }
        let stands = hurried && stands_still(&relax, asked.is_some());
        if !(stands && enough) {
            if stands {
                tell_standstill(&relax, log);
            }
            break enough;
        }
        // the last cloud of a family is solved to the end
        hurried = false;
    };
    if asked.is_some() {
        family::announce(log);
    }
    let unsteady = !log.record.converged && relax.iteration < steady.iterations;
    let (frame, mut work, end) = relax.into_end();
    let mut state = end.clone();
    let (gas, own) = (system.gas(), system.gas_unknowns());
    gas.without_circulation(system.gas_frame(&frame), system.gas_work(&mut work), &mut state[own]);
    Ok(Some(Reached { state, end: Some((frame, end)), enough, unsteady }))
}

/// True where the residual of a cloud that others follow has not fallen for so long that these are taken at once.
fn stands_still<S: Implicit>(relax: &Relax<'_, S>, is_of_family: bool) -> bool {
    !relax.finished() && relax.resting() >= if is_of_family { PATIENCE } else { PATIENCE_AT_REST }
}

/// Says that the run goes on from a flow that is not steady yet.
fn tell_standstill<S: Implicit>(relax: &Relax<'_, S>, log: &mut Log<'_>) {
    let (resting, orders) = (relax.resting(), -relax.drop().log10());
    log.note(&format!(
        "the flow has not come nearer to a steady one for {resting} iterations, at {orders:.1} orders: the run goes on from there"
    ));
}

/// Orders of magnitude that the residual of this stage has to fall by, one after the other. On a cloud of a family the first serve where its loads
/// are at rest then and another cloud follows, the second where the loads of a last cloud are at rest, and else the third.
fn goals<const D: usize>(steady: &Steady, turn: &Turn<'_, D>, case: &Case) -> Vec<f64> {
    if spacing::asked(case).is_some() {
        return vec![steady.orders.min(EARLY_ORDERS), steady.orders, steady.orders + SETTLING];
    }
    let again = turn.next().is_some_and(|stage| stage.task == Task::Relax);
    let early = match again {
        // what an adapted cloud is refined by needs more
        true if turn.stage().factor > 1.0 && spacing::begins_near(case) => EARLY_ORDERS_OF_SHOCKS,
        true => EARLY_ORDERS,
        false => steady.orders,
    };
    vec![steady.orders.min(early)]
}

/// Why a relaxation ended before its goal.
fn short_of_goal<S: Implicit>(
    relax: &Relax<'_, S>,
    steady: &Steady,
    orders: f64,
    history: &IterationHistory,
) -> String {
    let reached = -relax.drop().log10();
    if relax.iteration >= steady.iterations {
        let all = steady.iterations;
        return format!("after all {all} iterations the residual is down {reached:.1} of {orders:.1} orders");
    }
    let resting = history.since_smallest(relax.iteration as usize);
    format!(
        "no steady flow was found: the residual, down {reached:.1} of {orders:.1} orders, has not fallen for {resting} iterations"
    )
}

fn watched<S: HasGas<D>, const D: usize>(
    system: &S,
    relax: &mut Relax<'_, S>,
    (iterations, hurried): (u32, bool),
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
    orders: f64,
) -> Result<Ending, RunError> {
    let eyes = &mut GasEyes { system };
    let mut progress = Progress { eyes, cycle: turn.stage().cycle, aim: Aim::Orders(orders) };
    // any cloud of a family may be the last one
    let at_end = turn.last() || spacing::asked(&log.case).is_some();
    let mut checkpoint = Checkpoint::new(turn.at, None, at_end);
    let patience = match (turn.stage().point, turn.last()) {
        (Some(_), _) => POINT_PATIENCE,
        (None, true) if family::has_steady_before(turn.stage(), log) => FAMILY_PATIENCE,
        _ => LAST_PATIENCE,
    };
    let hurried = hurried || (turn.stage().point.is_some() && !log.record.polar.from_rest);
    let (mut limit, mut resting, mut swinging) =
        (Limit { iterations }, Resting { patience: PATIENCE }, Swinging { patience });
    let least = if turn.stage().factor > 1.0 && !turn.last() { EARLY_ORDERS } else { orders };
    let (mut told, mut flat) = (Told, spacing::asked(&log.case).map(|asked| flat(&asked, least)));
    let mut all: Vec<&mut dyn Observer<S, Log<'_>>> = vec![&mut progress, &mut limit, &mut told];
    all.push(if hurried { &mut resting } else { &mut swinging });
    let mut given = Given { patience: PATIENCE_AT_REST, range: GIVEN };
    if hurried && flat.is_none() && turn.stage().point.is_none() {
        all.push(&mut given);
    }
    flat.iter_mut().for_each(|flat| all.push(flat));
    all.push(&mut checkpoint);
    drive(relax, &mut all, log)
}

/// When loads are at rest on a cloud of a family, whose residual has fallen by so many `orders`.
fn flat(asked: &Accuracy, orders: f64) -> Flat {
    Flat { residual: 10f64.powf(-orders), range: family::REST * asked.loads.0, iterations: UNSETTLED }
}

/// Keeps what is known of a relaxation that is over; its loads.
fn tell<S: HasGas<D>, const D: usize>(
    system: &S,
    relax: &mut Relax<'_, S>,
    turn: &Turn<'_, D>,
    log: &mut Log<'_>,
) -> Result<CloudLoads, RunError> {
    let cost = relax.cost();
    (log.record.drop, log.record.converged) = (relax.drop(), relax.finished());
    (log.record.bytes, log.record.linear) = (cost.bytes, cost.linear);
    log.record.began_steady = relax.began_steady();
    let Standing { frame, work, state, .. } = relax.standing();
    let gas = GasView::of(system, frame, state);
    let loads = gas.coefficients(&log.axes, system.gas_work(work)).unwrap_or_default();
    let family = spacing::asked(&log.case);
    let balance = family.and_then(|_| momentum::around(&log.case, &log.axes, &gas, system.gas_work(work), false));
    let momentum = balance.map(|sum| log.axes.axes(&gas.seen(system.gas_work(work))).coefficients(&sum.load));
    let told = log.record.structures.iteration.last() == Some(&(log.record.iteration as f64));
    if turn.last()
        && !told
        && let Some(exchange) = system.exchange(frame, state, work)
    {
        log.structure(log.record.iteration, &sample(0.0, exchange, &log.units))?;
    }
    let (Stage { factor, cycle, .. }, particles) = (*turn.stage(), system.gas().discretisation.cloud.n_real());
    if factor == 1.0 {
        let cycle = f64::from(cycle);
        log.record.cycles.retain(|known| known[0] != cycle);
        log.record.cycles.push([cycle, particles as f64, loads.cl, loads.cd, loads.cm]);
    }
    let (reach, unsettled) = (reach(system.gas()), unsettled(log));
    let supersonic = is_supersonic(system.gas(), system.gas_work(work));
    let lossless = !supersonic && is_lossless(system.gas(), &log.case);
    let wake = |view: View<'_, D>| entropy_drag(&view, &log.case, &log.axes.axes(&view));
    let gas = GasView::of(system, frame, state);
    let seen = gas.seen(system.gas_work(work));
    let along = chordwise(&seen, &Bounds::around(system.gas().walls_before()));
    let sonic = family.map_or([None; 2], |_| sonic_places(&log.case, &seen, &along));
    let spurious_drag = family.filter(|_| lossless).and_then(|_| wake(gas.seen(system.gas_work(work))));
    let (steady, Coefficients { cl, cd, cm }) = (log.record.converged, loads);
    let dragless = lossless && D == 2;
    Ok(CloudLoads {
        factor,
        particles,
        reach,
        supersonic,
        dragless,
        steady,
        cl,
        cd,
        cm,
        momentum,
        spurious_drag,
        sonic,
        unsettled,
    })
}

/// True where nothing but shocks could make entropy: without viscosity, the free stream on all sides.
fn is_lossless<const D: usize>(gas: &Fluid<D>, case: &Case) -> bool {
    let free = |side: &Side| matches!(side, Side::FarField | Side::Symmetry);
    gas.viscous_model.is_none() && CloudSpec::<D>::of_case(case).sides.iter().flatten().all(free)
}

/// True where the gas is faster than sound somewhere, whose states `work` holds.
pub(super) fn is_supersonic<const D: usize>(gas: &Fluid<D>, work: &Work<D>) -> bool {
    let fast = |i: usize| work.state[i].velocity.norm() > gas.gas.sound_speed(&work.state[i]);
    first(gas.discretisation.cloud.n_fluid, fast).is_some()
}

/// What the last iteration changed the loads by; half of their range over the last iterations where the residual did not reach its
/// goal.
fn unsettled(log: &Log<'_>) -> Coefficients {
    let (last, part) = if log.record.converged { (2, 1.0) } else { (UNSETTLED, 0.5) };
    let [cl, cd, cm] = log.record.history.last_loads(last).map(|[low, high]| part * (high - low).max(0.0));
    Coefficients { cl, cd, cm }
}

/// Half-width of the domain in lengths of the bodies.
fn reach<const D: usize>(gas: &Fluid<D>) -> f64 {
    let half = 0.5 * gas.discretisation.cloud.tree.bounds().extent().max_abs();
    half / Bounds::around(gas.walls_before()).extent().max_abs()
}
