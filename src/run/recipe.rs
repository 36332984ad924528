//! How a case integrates: the one place that tells apart steady, marched and periodic cases, and turns what the case says into
//! what integrators want.
use super::accuracy;
use super::error::RunError;
use super::stage::{Stage, Task};
use crate::case::{self, Case, HarmonicCount, Harmonics, Initial, RungeKutta, Steady, SteadyMethod, Temporal};
use crate::math::multilevel::Cycle;
use crate::time::control::{Control, Method};
use crate::time::dual::Plan;
use crate::time::explicit;

/// Particles above which a steady case is started on one coarser cloud, and on two; in 2-D and 3-D.
const START: [[usize; 2]; 2] = [[2_500, 9_000], [15_000, 80_000]];
/// Greatest number of iterations of the relaxation before a march.
const PRELUDE_ITERATIONS: u32 = 500;
/// Orders of magnitude of that relaxation: the motion soon moves loads by more than what is left.
const PRELUDE_ORDERS: f64 = 3.0;
/// The same for bodies on springs, which what is left moves: it is to be round-off, so that
/// oscillations may be as small as one likes.
const SPRUNG_ORDERS: f64 = 13.0;
/// Greatest number of its iterations where a march leads to a harmonic balance.
const LEAD_ITERATIONS: u32 = 60;
/// Harmonics at which `number = "auto"` begins, and what it adds.
const FIRST: usize = 1;
const MORE: usize = 2;
/// Greatest Courant number of sweeps alone.
const SWEEPS_CFL_MAX: f64 = 100.0;
/// Reduction asked of the linear solves of a harmonic balance: those that ask for more take longer, and shocks that move leave Newton's
/// method no use for it (Eisenstat and Walker 1996, doi:10.1137/0917003).
const HARMONIC_REDUCTION: f64 = 0.3;
/// Harmonics that `number = "auto"` mostly ends with.
const USUAL_HARMONICS: u32 = 3;

/// A march of a case.
pub(crate) struct Marching {
    /// How steps are taken.
    pub(crate) scheme: Scheme,
    /// Time of the solver at which it ends.
    pub(crate) until: f64,
    /// Greatest number of steps.
    pub(crate) limit: u32,
    /// Change of the loads from period to period below which it ends as well.
    pub(crate) tolerance: Option<f64>,
    /// About the period, in the time of the case, of structures with whose second like period it ends as well.
    pub(crate) swing: Option<f64>,
}

/// How steps in time are taken.
pub(crate) enum Scheme {
    /// Implicit, each step relaxed.
    Dual(Control, Plan),
    /// Explicit, limited by a Courant number.
    Explicit(explicit::Plan),
}

/// A fixed implicit step.
pub(crate) struct FixedStep {
    /// Its length.
    pub(crate) length: f64,
    /// True when it is given as steps of a period.
    pub(crate) of_period: bool,
}

/// The harmonic balance of a case.
pub(crate) fn balance(case: &Case) -> Option<&Harmonics> {
    match &case.time {
        Temporal::Harmonics(plan) => Some(plan),
        _ => None,
    }
}

/// The relaxation of a steady case, or the one that gives another case its start.
pub(crate) fn relaxation(case: &Case) -> Option<Steady> {
    match &case.time {
        Temporal::Steady(steady) => Some(steady.clone()),
        Temporal::Dual(dual) => Some(start_of_march(case, dual)),
        Temporal::Harmonics(plan) => Some(harmonic_prelude(plan)),
        Temporal::Explicit(_) | Temporal::Newmark(_) | Temporal::Modes(_) => None,
    }
}

/// The march of a case; `None` where it does not march.
pub(crate) fn marching(case: &Case, period: Option<f64>, dimension: usize) -> Result<Option<Marching>, RunError> {
    match &case.time {
        Temporal::Steady(_) | Temporal::Harmonics(_) | Temporal::Newmark(_) | Temporal::Modes(_) => Ok(None),
        Temporal::Explicit(plan) => {
            let until = case.end(period).ok_or(RunError::NoPeriod { table: "explicit" })?;
            let method = match plan.method {
                RungeKutta::Ssprk3 => explicit::Method::Ssprk3,
                RungeKutta::Rk4 => explicit::Method::Rk4,
            };
            let scheme = Scheme::Explicit(explicit::Plan { method, cfl: plan.cfl, until });
            Ok(Some(Marching { scheme, until, limit: plan.steps, tolerance: plan.periodic_tolerance, swing: None }))
        }
        Temporal::Dual(dual) => {
            let plan = implicit_plan(case, dual, period)?;
            let (until, scheme) = (plan.until, Scheme::Dual(inner_control(dual, dimension), plan));
            let (tolerance, swing) = (dual.periodic_tolerance, dual.swing.map(|t| t.0));
            Ok(Some(Marching { scheme, until, limit: u32::MAX, tolerance, swing }))
        }
    }
}

/// The stages of a case whose own cloud has `n` fluid particles, and others in its family the `sizes`: coarse, fine, adapted, marched, more and more harmonics.
/// A harmonic balance has `least` harmonics or more: the motion has so many.
pub(crate) fn plan(
    case: &Case,
    (n, sizes): (usize, &dyn Fn(f64) -> f64),
    dimension: usize,
    least: usize,
) -> Vec<Stage> {
    if let Some(asked) = accuracy::asked(case) {
        return at_all_points(case, accuracy::family(case, &asked, sizes, dimension));
    }
    let mut all = Vec::new();
    // a march from a given field starts from that field itself
    let given = case.is_unsteady() && !matches!(case.initial, Initial::FreeStream);
    let relaxes = relaxation(case).is_some() && !case.bodies.is_empty() && !given;
    let steady = |factor: f64, cycle: u32| Stage { factor, cycle, ..Stage::PLAIN };
    if relaxes {
        let limits = START[dimension - 2];
        let coarser = [(limits[1], 4.0), (limits[0], 2.0)].into_iter();
        let factors = coarser.filter(|(most, factor)| n > *most && divides(case, *factor)).map(|(_, f)| f);
        let factors: Vec<f64> = factors.collect();
        if let Some(stages) = balance_from_coarser(case, &factors, least) {
            return stages;
        }
        all.extend(factors.into_iter().map(|f| steady(f, 0)));
    }
    if relaxes || !case.is_unsteady() {
        all.extend((0..=case.adapt.cycles).map(|cycle| steady(1.0, cycle)));
    }
    let cycle = all.last().map_or(0, |s: &Stage| s.cycle);
    all.extend(in_time(case, None, least).into_iter().map(|task| Stage { cycle, task, ..Stage::PLAIN }));
    at_all_points(case, all)
}

/// The stages of a harmonic balance that begins on coarser clouds with these factors on their spacing, where it can: the steady flow and
/// few harmonics on the coarsest, all of them there and on the others; where their number is found on the way, the first ones.
fn balance_from_coarser(case: &Case, factors: &[f64], least: usize) -> Option<Vec<Stage>> {
    let plan = balance(case).filter(|plan| plan.march == 0 && case.adapt.cycles == 0)?;
    let (coarsest, finer) = factors.split_first()?;
    let tasks = in_time(case, None, least);
    let (early, late) = tasks.split_at(if is_automatic(plan) { 1 } else { tasks.len() });
    let on = |factor: f64| move |task: &Task| Stage { factor, task: *task, ..Stage::PLAIN };
    let mut all: Vec<Stage> = std::iter::once(&Task::Relax).chain(early).map(on(*coarsest)).collect();
    all.extend(finer.iter().chain(&[1.0]).flat_map(|factor| early.last().map(on(*factor))));
    all.extend(late.iter().map(on(1.0)));
    Some(all)
}

/// The stages of a harmonic balance of a motion with harmonics of these numbers that no coarser cloud gives a start.
pub(crate) fn balance_from_rest(case: &Case, multiples: &[usize]) -> Vec<Stage> {
    let least = multiples.last().copied().unwrap_or(FIRST);
    let tasks = std::iter::once(Task::Relax).chain(in_time(case, None, least));
    tasks.map(|task| Stage { task, ..Stage::PLAIN }).collect()
}

/// The stages of a run in words, whose own cloud has `n` fluid particles.
pub(crate) fn describe(stages: &[Stage], n: usize) -> String {
    let first = || stages.iter().filter(|s| s.point.unwrap_or(0) == 0);
    let mut factors: Vec<f64> = first().map(|s| s.factor).filter(|f| *f > 1.0).collect();
    factors.dedup();
    let coarse = factors.len();
    let cycles = (1..).take_while(|c| first().any(|s| s.factor == 1.0 && s.cycle == *c)).count();
    let points = stages.last().and_then(|s| s.point).map_or_else(String::new, |p| format!("; {} points", p + 1));
    format!("{n} fluid particles; {coarse} coarser clouds for the start, {cycles} cycles of adaptation{points}")
}

/// True where a cloud with `factor` times the spacing fits into the domain: a start on one that does not is left out.
pub(crate) fn divides(case: &Case, factor: f64) -> bool {
    /// What a number of cells may be off a whole one, relative to it.
    const MISFIT: f64 = 1e-7;
    let Some((domain, spacing)) = case.cloud.domain.as_ref().zip(case.cloud.spacing.as_ref()) else { return true };
    domain.min.iter().zip(&domain.max).all(|(min, max)| {
        let cells = (max.0 - min.0) / (factor * spacing.0);
        cells > 0.5 && (cells - cells.round()).abs() <= MISFIT * cells
    })
}

/// The stages of one point, for every point of a polar.
fn at_all_points(case: &Case, stages: Vec<Stage>) -> Vec<Stage> {
    let Some(polar) = &case.polar else { return stages };
    (0..polar.len()).flat_map(|point| stages.iter().map(move |s| Stage { point: Some(point), ..*s })).collect()
}

/// The stages of a case that begins from the last state of another run, reached at the stage `from`, on the same cloud.
pub(crate) fn plan_from(case: &Case, from: &Stage) -> Vec<Stage> {
    let held = match from.task {
        Task::Balance { harmonics } => Some(harmonics),
        _ => None,
    };
    let tasks = if case.is_unsteady() { in_time(case, held, FIRST) } else { vec![Task::Relax] };
    tasks.into_iter().map(|task| Stage { task, back: false, ..*from }).collect()
}

/// What is done in time after any steady start; `held`: harmonics of the state it begins from; `least`: harmonics that the motion
/// has.
fn in_time(case: &Case, held: Option<usize>, least: usize) -> Vec<Task> {
    match &case.time {
        Temporal::Steady(_) | Temporal::Newmark(_) | Temporal::Modes(_) => Vec::new(),
        Temporal::Explicit(_) | Temporal::Dual(_) => vec![Task::March],
        Temporal::Harmonics(plan) => {
            let (most, auto) = (most(plan), is_automatic(plan));
            let lead = held.is_none() && plan.march > 0;
            let first = match held {
                Some(held) if auto => held.min(most),
                None if auto || !lead => least.clamp(FIRST, most),
                _ => most,
            };
            let more = |n: &usize| (*n < most).then(|| if auto { (n + MORE).min(most) } else { most });
            let balances = std::iter::successors(Some(first), more).map(|harmonics| Task::Balance { harmonics });
            lead.then_some(Task::Lead).into_iter().chain(balances).collect()
        }
    }
}

/// Most harmonics that a balance may have.
pub(crate) fn most(plan: &Harmonics) -> usize {
    match plan.number {
        HarmonicCount::Fixed(n) => n as usize,
        HarmonicCount::Auto(_) => plan.most as usize,
    }
}

/// True when the number of harmonics is found on the way.
pub(crate) fn is_automatic(plan: &Harmonics) -> bool {
    matches!(plan.number, HarmonicCount::Auto(_))
}

/// Harmonics that a balance ends with as far as is known before, 0 without one.
pub(crate) fn harmonics(case: &Case) -> u32 {
    match &case.time {
        Temporal::Harmonics(plan) => match plan.number {
            HarmonicCount::Fixed(n) => n,
            HarmonicCount::Auto(_) => USUAL_HARMONICS.min(plan.most),
        },
        _ => 0,
    }
}

/// The implicit step of a case, where it is fixed.
pub(crate) fn fixed_step(case: &Case, period: Option<f64>) -> Option<FixedStep> {
    let Temporal::Dual(dual) = &case.time else { return None };
    let length = case.step_length(period).filter(|dt| dual.adaptive.is_none() && 0.0 < *dt)?;
    Some(FixedStep { length, of_period: period.is_some() && dual.steps_per_period.is_some() })
}

/// The relaxation that gives a march its start.
fn start_of_march(case: &Case, dual: &case::Dual) -> Steady {
    let usual = if case.structures.is_empty() { PRELUDE_ORDERS } else { SPRUNG_ORDERS };
    Steady { orders: dual.start_orders.unwrap_or(usual), ..prelude(dual) }
}

/// That relaxation as far as it is one of each step as well.
fn prelude(dual: &case::Dual) -> Steady {
    Steady { method: dual.method, iterations: PRELUDE_ITERATIONS, orders: PRELUDE_ORDERS, ..Steady::default() }
}

/// The relaxation that gives a harmonic balance its start.
fn harmonic_prelude(plan: &Harmonics) -> Steady {
    let iterations = if plan.march > 0 { LEAD_ITERATIONS } else { PRELUDE_ITERATIONS };
    Steady { method: plan.method, iterations, orders: PRELUDE_ORDERS, ..Steady::default() }
}

/// Numbers of a harmonic balance.
pub(crate) fn harmonic_control(plan: &Harmonics, dimension: usize) -> Control {
    let steady = Steady { cfl: plan.cfl, cfl_max: plan.cfl_max, ..harmonic_prelude(plan) };
    Control { tolerance: HARMONIC_REDUCTION, ..control(&steady, dimension) }
}

/// Numbers of an implicit march.
fn implicit_plan(case: &Case, dual: &case::Dual, period: Option<f64>) -> Result<Plan, RunError> {
    let wrong = || RunError::NoPeriod { table: "dual" };
    Ok(Plan {
        until: case.end(period).ok_or_else(wrong)?,
        step: case.step_length(period).ok_or_else(wrong)?,
        order: dual.order,
        orders: dual.orders,
        iterations: dual.inner_iterations,
        adaptive: dual.adaptive,
    })
}

/// Numbers of the relaxation within a step in time.
fn inner_control(dual: &case::Dual, dimension: usize) -> Control {
    let steady = Steady { cfl: dual.cfl, cfl_max: dual.cfl_max, ..prelude(dual) };
    control(&steady, dimension)
}

/// Numbers of the steady relaxation.
pub(crate) fn control(steady: &Steady, dimension: usize) -> Control {
    let sweeps_alone = steady.method == SteadyMethod::LuSgs;
    let usual = Control::newton(dimension);
    Control {
        method: match steady.method {
            SteadyMethod::NewtonKrylov => Method::NewtonKrylov,
            SteadyMethod::LuSgs => Method::Sweeps,
            SteadyMethod::RungeKutta => Method::RungeKutta,
        },
        cfl: steady.cfl,
        cfl_max: if sweeps_alone { steady.cfl_max.min(SWEEPS_CFL_MAX) } else { steady.cfl_max },
        cycle: Cycle { levels: if sweeps_alone { 1 } else { usual.cycle.levels }, ..usual.cycle },
        ..usual
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn balances_begin_on_the_coarsest_cloud() {
        let planned = |time: &str, n: usize| -> Vec<(f64, usize)> {
            let text = format!(
                "title = \"t\"\n[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[motion]\nreduced_frequency = 0.3\nplunge = 0.01\n\
                 [cloud]\nspacing = 0.01\n{time}\n"
            );
            let case = crate::case::read(&text, "t").unwrap();
            plan(&case, (n, &|_| 0.0), 2, 1).iter().map(|s| (s.factor, s.instances() / 2)).collect()
        };
        assert_eq!(planned("[time]\nharmonics = 3", 10_000), [(4.0, 0), (4.0, 1), (4.0, 3), (2.0, 3), (1.0, 3)]);
        assert_eq!(planned("[time]\nharmonics = 1", 4_000), [(2.0, 0), (2.0, 1), (1.0, 1)]);
        assert_eq!(planned("[time]\nharmonics = 2", 1_000), [(1.0, 0), (1.0, 1), (1.0, 2)]);
        let automatic = planned("[time]\nharmonics = \"auto\"", 4_000);
        assert_eq!(automatic[..4], [(2.0, 0), (2.0, 1), (1.0, 1), (1.0, 3)], "{automatic:?}");
        // a march leads to the instances of all harmonics, from a steady flow on the same cloud
        let led = planned("[time.harmonics]\nnumber = 2\nmarch = 3", 4_000);
        assert_eq!(led, [(2.0, 0), (1.0, 0), (1.0, 0), (1.0, 2)]);
    }
}
