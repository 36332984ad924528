//! Studies of problems, in memory: each takes a problem and returns what it found.
use super::error_bars::solved;
use super::flutter::{InMemory, boundary, planned};
use super::monitor::{Monitor, Silent};
use super::refuse;
use super::solids::{self, Ended, SolidSolution};
use super::solution::Solution;
use crate::case::Temporal;
use crate::observe::convergence::Convergence;
use crate::problem::{Problem, RunError, spacing};
use crate::record::flutter::{Boundary, LimitCycle};
use crate::record::summary::PolarPoint;

/// Marches the flow of a problem with `[time.dual]` or `[time.explicit]` in time, with the error bars that it asks for.
pub fn march(problem: &Problem) -> Result<Solution, RunError> {
    march_with(problem, &mut Silent)?.ok_or(RunError::NoStage)
}

/// Marches under the eyes of `monitor`; `None` when that says stop.
pub fn march_with(problem: &Problem, monitor: &mut dyn Monitor) -> Result<Option<Solution>, RunError> {
    let marches = matches!(problem.case().time, Temporal::Dual(_) | Temporal::Explicit(_));
    refuse(
        !marches || !problem.case().has_gas(),
        "a march of a case that does not ask for one",
        "add `[time.dual]` or `[time.explicit]`, or call `study::solid` for a structure alone",
    )?;
    solved(problem, monitor)
}

/// Finds the periodic flow of a problem with `[time] harmonics`, with the error bars that it asks for.
pub fn harmonic(problem: &Problem) -> Result<Solution, RunError> {
    harmonic_with(problem, &mut Silent)?.ok_or(RunError::NoStage)
}

/// Finds the periodic flow under the eyes of `monitor`; `None` when that says stop.
pub fn harmonic_with(problem: &Problem, monitor: &mut dyn Monitor) -> Result<Option<Solution>, RunError> {
    let balances = matches!(problem.case().time, Temporal::Harmonics(_));
    refuse(
        !balances || !problem.case().has_gas(),
        "a harmonic balance of a case that does not ask for one",
        "add `[time] harmonics = 3`, or call `study::solid` for a structure alone",
    )?;
    solved(problem, monitor)
}

/// Solves a structure without a gas: equilibrium, march, natural modes or periodic motion, as its `[time]` says.
pub fn solid(problem: &Problem) -> Result<SolidSolution, RunError> {
    solid_with(problem, &mut Silent)?.ok_or(RunError::NoStage)
}

/// Solves a structure under the eyes of `monitor`; `None` when that says stop.
pub fn solid_with(problem: &Problem, monitor: &mut dyn Monitor) -> Result<Option<SolidSolution>, RunError> {
    refuse(problem.case().has_gas(), "a structure alone of a case with `[flow]`", "take out `[flow]`")?;
    Ok(match solids::solve((problem.given(), problem.input()), None, monitor)? {
        Ended::Finished(solution) => Some(*solution),
        Ended::Interrupted(_) => None,
    })
}

/// The points of a problem with several angles of attack or Mach numbers in `[flow]`, all angles of attack at the first Mach number, then all at the next.
pub fn polar(problem: &Problem) -> Result<Vec<PolarPoint>, RunError> {
    polar_with(problem, &mut Silent)?.ok_or(RunError::NoStage)
}

/// The points of a polar under the eyes of `monitor`; `None` when that says stop.
pub fn polar_with(problem: &Problem, monitor: &mut dyn Monitor) -> Result<Option<Vec<PolarPoint>>, RunError> {
    refuse(
        problem.case().polar.is_none(),
        "a polar of a case with one angle of attack",
        "give several: `flow.alpha = [\"0 deg\", \"2 deg\"]`",
    )?;
    Ok(solved(problem, monitor)?.map(|solution| solution.summary.polar))
}

/// Loads on a family of clouds and how they converge, of a steady problem that gives no `cloud.spacing` or has `[accuracy]`; `None` where the
/// clouds tell no order.
pub fn family(problem: &Problem) -> Result<Option<Convergence>, RunError> {
    let case = problem.case();
    refuse(
        spacing::asked(case).is_none() || case.polar.is_some(),
        "a family of clouds of a case that gives one cloud",
        "add `[accuracy]`, or leave out `cloud.spacing`",
    )?;
    let solution = solved(problem, &mut Silent)?.ok_or(RunError::NoStage)?;
    Ok(solution.summary.grid.grid_convergence)
}

/// The flutter boundary that the table `[flutter]` asks for, with the limit cycles of `[lco]`.
///
/// At each Mach number: the steady flow, forces of small motions about it at a few frequencies, and the speeds at which motions of the
/// structure begin to grow.
pub fn flutter(problem: &Problem) -> Result<Boundary, RunError> {
    flutter_with(problem, &mut Silent)?.ok_or(RunError::NoStage)
}

/// The flutter boundary under the eyes of `monitor`; `None` when that says stop.
pub fn flutter_with(problem: &Problem, monitor: &mut dyn Monitor) -> Result<Option<Boundary>, RunError> {
    let plan = planned(problem.given())?;
    boundary(problem, (&plan, None), &mut InMemory, monitor)
}

/// The limit cycles that the table `[lco]` asks for.
pub fn limit_cycle(problem: &Problem) -> Result<Vec<LimitCycle>, RunError> {
    refuse(
        problem.given().lco.is_none(),
        "limit cycles of a case without `[lco]`",
        "add it, with `amplitude` or `displacement`",
    )?;
    Ok(flutter(problem)?.lco)
}
