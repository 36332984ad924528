//! Numerics of a problem: what its case says of integrators, as these want it.
use super::error::RunError;
use crate::case::{self, Case, Cloud, HarmonicCount, Harmonics, RungeKutta, Steady, SteadyMethod, Temporal};
use crate::math::multilevel::Cycle;
use crate::time::control::{Control, Method};
use crate::time::dual::Plan;
use crate::time::explicit;

/// Greatest number of iterations of the relaxation before a march.
const PRELUDE_ITERATIONS: u32 = 500;
/// Orders of magnitude of that relaxation: the motion soon moves loads by more than what is left.
const PRELUDE_ORDERS: f64 = 3.0;
/// The same for bodies on springs, which what is left moves: it is to be round-off, so that
/// oscillations may be as small as one likes.
const SPRUNG_ORDERS: f64 = 13.0;
/// Greatest number of its iterations where a march leads to a harmonic balance.
const LEAD_ITERATIONS: u32 = 60;
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

/// True where a cloud with `factor` times the spacing fits into the domain: a start on one that does not is left out.
pub(crate) fn divides(cloud: &Cloud, factor: f64) -> bool {
    /// What a number of cells may be off a whole one, relative to it.
    const MISFIT: f64 = 1e-7;
    let Some((domain, spacing)) = cloud.domain.as_ref().zip(cloud.spacing.as_ref()) else { return true };
    domain.min.iter().zip(&domain.max).all(|(min, max)| {
        let cells = (max.0 - min.0) / (factor * spacing.0);
        cells > 0.5 && (cells - cells.round()).abs() <= MISFIT * cells
    })
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
