//! All columns of the matrices as small motions about one steady flow.
//!
//! What the columns of harmonic balances tend to as their amplitudes go to nothing: one cloud, one steady flow, and a linear system for
//! each mode and frequency (`studies::forces`); the same on coarser clouds tells how far they are known. Rigid
//! modes are rotations and shifts, not displacement fields, so that forces of the steady flow turn with the body as they do there.

use num_complex::Complex64;

use super::super::cost;
use super::super::flow::{self, Flow};
use super::super::monitor::{Monitor, Quiet, Within};
use super::super::record::work::Clock;
use super::super::solution::Solution;
use super::super::studies::{ForceSource, SOLVED, in_order};
use super::super::time_left::Portion;
use super::cloud_error::{self, OnCoarser};
use super::{Column, Matrices, Solved};
use crate::case::{AnyMode, Case, Cloud, Gaf, Mode};
use crate::geometry::dimension;
use crate::problem::coarser::{BETWEEN, COARSER, coarser, refinement, times_the_spacing};
use crate::problem::{Problem, RunError, spacing};

/// Fills in the columns of all modes and frequencies of `plan` with their error bars, and calls `keep` after each frequency; false when
/// the monitor says stop.
pub(super) fn columns(
    (problem, plan): (&Problem, &Gaf),
    matrices: &mut Matrices,
    keep: &mut dyn FnMut(&Matrices) -> Result<(), RunError>,
    monitor: &mut dyn Monitor,
) -> Result<bool, RunError> {
    let steady = problem.about_steady_flow_of_gaf(plan)?;
    let asked = Asked { case: problem.given(), plan, length: matrices.conditions.reduced_length };
    let mut add = |found: Vec<Column>| {
        matrices.columns.extend(found);
        asked.sort(&mut matrices.columns);
        keep(matrices)
    };
    let outer = Portion::of(0, &asked.clouds(false));
    let found = asked.about(&steady, &mut add, &mut Within { outer, monitor: &mut *monitor })?;
    let Some(SteadyFlow { cloud, solved, shocks }) = found else { return Ok(false) };
    if !solved {
        monitor.warn("the steady flow did not converge: forces about it are doubtful");
        matrices.columns.iter_mut().for_each(|c| c.converged = false);
        keep(matrices)?;
    }
    let one = steady.on_cloud(cloud)?;
    let Some(others) = asked.on_coarser_clouds(&one, shocks, monitor)? else { return Ok(false) };
    if coarser(one.given(), COARSER).is_none() {
        cloud_error::untold(plan, one.given()).iter().for_each(|why| monitor.note(why));
    }
    cloud_error::tell(&mut matrices.columns, &others);
    keep(matrices)?;
    Ok(true)
}

/// A steady flow that forces were found about.
struct SteadyFlow {
    cloud: Cloud,
    /// True where it came to rest.
    solved: bool,
    /// True where it is faster than sound somewhere.
    shocks: bool,
}

/// What is asked of a steady flow.
struct Asked<'a> {
    case: &'a Case,
    plan: &'a Gaf,
    /// Length of reduced frequencies.
    length: f64,
}

impl Asked<'_> {
    /// Work on the cloud of the case and on coarser ones, two of them where there are `shocks`, beside one another.
    fn clouds(&self, shocks: bool) -> [f64; 3] {
        let d = dimension(self.case).into();
        let asked = |ratio: f64, asked: bool| if asked { spacing::alike(ratio, d) } else { 0.0 };
        [1.0, asked(COARSER, self.plan.cloud_error), asked(BETWEEN, self.plan.cloud_error && shocks)]
    }

    /// Brings columns into the order in which the case names their frequencies.
    fn sort(&self, columns: &mut [Column]) {
        let place = |c: &Column| self.plan.reduced_frequencies.iter().position(|k| *k == c.k);
        columns.sort_by_key(place);
    }

    /// Hands the columns about the flow of the case `steady` to `add`, frequency by frequency; that flow, `None` when the monitor
    /// says stop.
    fn about(
        &self,
        steady: &Problem,
        add: &mut dyn FnMut(Vec<Column>) -> Result<(), RunError>,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<SteadyFlow>, RunError> {
        let columns = self.plan.reduced_frequencies.len() * self.plan.all_modes().count();
        let share = cost::share_of_steady(dimension(steady.case()).into(), columns);
        let Some(mut flow) = flow::steady(steady, share, monitor)? else { return Ok(None) };
        let Some(shocks) = self.columns(&mut *flow, add)? else { return Ok(None) };
        let Ok(Solution { summary, .. }) = flow.conclude(None)? else { return Ok(None) };
        let solved = summary.succeeded();
        Ok(Some(SteadyFlow { cloud: summary.conditions.cloud, solved, shocks }))
    }

    /// The columns on coarser clouds than that of `one`, with the factor on its spacing, where errors are asked for; of clouds between
    /// there is one where `shocks` are captured. `None` when the monitor says stop.
    fn on_coarser_clouds(
        &self,
        one: &Problem,
        mut shocks: bool,
        monitor: &mut dyn Monitor,
    ) -> Result<Option<Vec<OnCoarser>>, RunError> {
        let mut others = Vec::new();
        for ratio in [COARSER, BETWEEN] {
            if !self.plan.cloud_error || (ratio != COARSER && !shocks) {
                break;
            }
            let coarse = match one.on_spacing(ratio) {
                Ok(Some(coarse)) => coarse,
                Ok(None) => continue,
                Err(problem) => {
                    monitor.note(&format!("the coarser cloud tells nothing: {problem}"));
                    continue;
                }
            };
            monitor.note(&format!("the same on a cloud with {}", times_the_spacing(ratio)));
            let mut other = Vec::new();
            let mut add = |found: Vec<Column>| {
                other.extend(found);
                self.sort(&mut other);
                Ok(())
            };
            let outer = Portion::of(if ratio == COARSER { 1 } else { 2 }, &self.clouds(shocks));
            match self.about(&coarse, &mut add, &mut Within { outer, monitor: &mut Quiet { monitor } }) {
                Ok(Some(flow)) if flow.solved => {
                    shocks |= flow.shocks;
                    others.push(OnCoarser { ratio: refinement(&one.given().cloud, ratio), columns: other });
                }
                Ok(Some(_)) => monitor.note("the coarser cloud tells nothing: the steady flow on it did not converge"),
                Ok(None) => return Ok(None),
                // a cloud that is too coarse for the body tells nothing of the one that is not
                Err(problem) => monitor.note(&format!("the coarser cloud tells nothing: {problem}")),
            }
        }
        Ok(Some(others))
    }

    /// Hands the columns about a flow that is known to `add`, frequency by frequency; true where that flow is faster than sound somewhere,
    /// `None` when the monitor says stop.
    fn columns(
        &self,
        flow: &mut dyn Flow<'_>,
        add: &mut dyn FnMut(Vec<Column>) -> Result<(), RunError>,
    ) -> Result<Option<bool>, RunError> {
        let (mut source, log) = flow.forces()?;
        let shocks = source.is_supersonic();
        let all = in_order(&self.plan.reduced_frequencies);
        for (number, &k) in all.iter().enumerate() {
            log.portion = Portion { is_even: true, ..log.portion.at(number as f64 / all.len() as f64) };
            log.doing(&format!("forces at k = {k}, {} of {} frequencies", number + 1, all.len()));
            let found = at_frequency((self.case, self.plan), k, (&mut *source, &|| log.stopped()), self.length);
            let Some(found) = found else { return Ok(None) };
            found.iter().filter_map(told).for_each(|line| log.note(&line));
            add(found)?;
        }
        Ok(Some(shocks))
    }
}

/// A column in a line for people; `None` where it was not solved for.
fn told(column: &Column) -> Option<String> {
    let solved = column.solved?;
    Some(format!(
        "k = {}, {}: Cl {:+.4} {:+.4}i, Cm {:+.4} {:+.4}i, {} linear iterations, residual {:.0e}",
        column.k, column.mode, column.cl[0], column.cl[1], column.cm[0], column.cm[1], solved.iterations, solved.left
    ))
}

/// The columns at the reduced frequency `k`; `length` is that of reduced frequencies, and of the coordinate of plunge. `None` where `stop`
/// says so before all are found.
fn at_frequency(
    (case, plan): (&Case, &Gaf),
    k: f64,
    (source, stop): (&mut dyn ForceSource, &dyn Fn() -> bool),
    length: f64,
) -> Option<Vec<Column>> {
    let clock = Clock::start();
    let (scale, forces) = (source.work_scale(), source.forces_unless(k * case.flow.reference().mach / length, stop)?);
    let unit = |mode: &AnyMode<'_>| if *mode == AnyMode::Rigid(Mode::Plunge) { length } else { 1.0 };
    let units: Vec<f64> = plan.all_modes().map(|mode| unit(&mode)).collect();
    let (n, parts) = (units.len(), |c: Complex64| [c.re, c.im]);
    let column = |(j, mode): (usize, AnyMode<'_>)| {
        let force = |i: usize| parts(forces.generalised[i * n + j] * (units[i] * units[j] / scale));
        let [cl, cm] = forces.coefficients[j].map(|c| parts(c * units[j]));
        let ended = forces.ended[j];
        Column {
            k,
            mode: mode.name().to_owned(),
            cl,
            cm,
            q: (0..n).map(force).collect(),
            nonlinearity: None,
            errors: None,
            solved: Some(Solved { iterations: ended.iterations, left: ended.left }),
            cpu_seconds: clock.cpu_seconds() / n as f64,
            converged: ended.left <= SOLVED,
        }
    };
    Some(plan.all_modes().enumerate().map(column).collect())
}
