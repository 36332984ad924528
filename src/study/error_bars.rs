//! Error bars of the loads of marches and harmonic balances, from further runs: one on a cloud with twice the spacing, one with twice the
//! step in time or with another number of harmonics.
//!
//! With r times the spacing or the step and order p, what a number changes by is (rᵖ − 1) times its error. Two runs show no order, so that
//! there is a safety factor ([`ErrorBars`]). The backward difference in time has the order that the case gives it, Runge-Kutta methods have theirs; an
//! explicit step may not be twice as long, so that the other one is half as long. What one harmonic more adds is what a number of them
//! leaves out; one harmonic less tells at least that, and takes less time.
//!
//! The further runs begin when the run has found its flow.
use serde_json::Value;

use super::flow::{self, Origin, Way};
use super::monitor::{Monitor, Quiet};
use super::record::Log;
use super::solution::Solution;
use crate::case::{Case, Cloud, HarmonicCount, LoadErrors, RungeKutta, Temporal};
use crate::observe::error_bars::{ErrorBars, Measured, NOT_PERIODIC, OtherRun, Part, Window};
use crate::problem::coarser::{COARSER, coarser};
use crate::problem::{Problem, RunError};
use crate::record::summary::Summary;

/// Half width over what a number changes by from twice the spacing: three times what errors of second order leave (Roache 1994), and twice
/// what those of first order do, which captured shocks make.
const OF_CLOUD: [f64; 2] = [1.0, 2.0];
/// Safety factor of the change from another step in time, whose order is known (Roache 1994: 3 for two runs).
const OF_STEP: f64 = 3.0;
/// The same from a number of harmonics that is one less, and one more.
const OF_HARMONICS: [f64; 2] = [1.0, 1.25];
/// Step of the further run over that of the run: with implicit and with explicit methods.
const LONGER: u32 = 2;
const SHORTER: f64 = 0.5;
/// Greatest tolerance of an adaptive step.
const LOOSEST: f64 = 0.1;
/// Multiples of the harmonics of a motion that are told.
const TOLD: usize = 2;
/// Share of the steps in time that may miss the goal of their inner iterations, as those of an abrupt start do.
const MISSED: f64 = 0.02;
/// Fewest steps of a period, and most harmonics, of any case.
const FEWEST_STEPS: u32 = 4;
const MOST_HARMONICS: usize = 16;

/// Solves the further runs of a problem.
pub(crate) trait FurtherRuns {
    /// The summary of the run of `problem` that tells `part` of the error; `None` when told to stop.
    fn solve(&self, part: Part, problem: Problem, monitor: &mut dyn Monitor) -> Result<Option<Value>, RunError>;
}

/// Solves them in memory.
struct InMemory;

impl FurtherRuns for InMemory {
    fn solve(&self, _: Part, problem: Problem, monitor: &mut dyn Monitor) -> Result<Option<Value>, RunError> {
        let found = solved(&problem, monitor)?;
        Ok(found.and_then(|found| serde_json::to_value(&found.summary).ok()))
    }
}

/// Solves a problem in memory with the error bars that it asks for; `None` when told to stop.
pub(crate) fn solved(problem: &Problem, monitor: &mut dyn Monitor) -> Result<Option<Solution>, RunError> {
    let Ok(mut flow) = flow::solve(problem, Way::of(Origin::Case), monitor)? else { return Ok(None) };
    let further = Further { problem, runs: &InMemory };
    let mut bars = |summary: &mut Summary, log: &mut Log<'_>| further.find(summary, log);
    Ok(flow.conclude(Some(&mut bars))?.ok())
}

/// The error bars of a run, from further ones.
pub(crate) struct Further<'a> {
    /// The problem of the run.
    pub(crate) problem: &'a Problem,
    /// Who solves the others.
    pub(crate) runs: &'a dyn FurtherRuns,
}

/// Another run.
struct Other {
    part: Part,
    cloud: Cloud,
    time: Temporal,
    /// Spacing, step or number of harmonics over that of the run.
    ratio: f64,
    /// Half width over the change.
    factor: f64,
    /// What it is, in words.
    words: String,
}

/// What another run says.
enum Asked {
    /// The monitor said stop.
    Stopped,
    /// Its numbers.
    Told(Box<OtherRun>),
    /// Nothing, for this reason.
    Silent(String),
}

impl Further<'_> {
    /// Finds the error bars of a run that is over; false when told to stop.
    pub(crate) fn find(&self, summary: &mut Summary, log: &mut Log<'_>) -> Result<bool, RunError> {
        let case = self.problem.case();
        let Some(asked) = case.accuracy.filter(|_| case.is_unsteady()) else { return Ok(true) };
        let Some(measured) = log.measured() else { return Ok(true) };
        let parts = parts(case, asked.error);
        let missed =
            f64::from(summary.convergence.unconverged_steps) / (summary.convergence.iterations as f64).max(1.0);
        let (mut runs, mut untold) = (Vec::new(), why_none((summary.succeeded(), missed), balances(case), &measured));
        for part in &parts {
            if untold.is_some() {
                break;
            }
            match self.asked(*part, (summary, &measured), log)? {
                Asked::Stopped => return Ok(false),
                Asked::Told(run) => runs.push(*run),
                Asked::Silent(why) => untold = Some(why),
            }
        }
        let found = match untold {
            _ if parts.is_empty() => ErrorBars::untold(measured, None),
            Some(why) => ErrorBars::untold(measured, Some(why)),
            None => ErrorBars::of(measured, runs),
        };
        if let Some(why) = &found.untold {
            log.warn(&format!("no error bars are told: {why}"));
        }
        if !parts.is_empty() {
            summary.cost.spent_on_bars(log.seconds());
        }
        summary.error_bars = Some(found);
        Ok(true)
    }

    /// What another run says of a part of the error.
    fn asked(
        &self,
        part: Part,
        (summary, measured): (&Summary, &Measured),
        log: &mut Log<'_>,
    ) -> Result<Asked, RunError> {
        let other = match other(part, self.problem.case(), summary) {
            Ok(other) => other,
            Err(why) => return Ok(Asked::Silent(why)),
        };
        log.note(&format!("error bars: the same {}", other.words));
        let problem = self.problem.further(other.cloud.clone(), other.time.clone());
        let monitor = &mut Quiet { monitor: log.monitor() };
        match problem.and_then(|problem| self.runs.solve(part, problem, monitor)) {
            Ok(Some(found)) => Ok(told(other, &found, measured)),
            Ok(None) => Ok(Asked::Stopped),
            Err(problem) => Ok(Asked::Silent(format!("the same {} fails: {problem}", other.words))),
        }
    }
}

/// The parts of the error that are asked for.
fn parts(case: &Case, asked: LoadErrors) -> Vec<Part> {
    let in_time = if balances(case) { Part::Harmonics } else { Part::Step };
    match asked {
        LoadErrors::None => Vec::new(),
        LoadErrors::Cloud => vec![Part::Cloud],
        LoadErrors::Step | LoadErrors::Harmonics => vec![in_time],
        LoadErrors::All => vec![Part::Cloud, in_time],
    }
}

fn balances(case: &Case) -> bool {
    matches!(case.time, Temporal::Harmonics(_))
}

/// Why a run has no error bars, whatever others say.
fn why_none((converged, missed): (bool, f64), balance: bool, measured: &Measured) -> Option<String> {
    if !converged {
        return Some("it has not converged".into());
    }
    if missed > MISSED {
        return Some(format!("{:.0} % of its steps in time have not converged", 100.0 * missed));
    }
    if balance || measured.window != Window::LastPeriod {
        return None;
    }
    match measured.change() {
        None => Some("no period before the last one confirms it: march two or more".into()),
        Some(change) if change > NOT_PERIODIC => Some(format!(
            "it is not periodic: from the period before loads differ by {:.0} % of their harmonics",
            100.0 * change
        )),
        Some(_) => None,
    }
}

/// The run that tells a part of the error of `case`, or why there is none.
fn other(part: Part, case: &Case, summary: &Summary) -> Result<Other, String> {
    let (mut cloud, mut time) = (case.cloud.clone(), case.time.clone());
    let (ratio, factor, words) = match part {
        Part::Cloud => {
            let why = "no cloud with twice the spacing fits into the domain, or `[adapt]` makes another cloud of each spacing";
            cloud = coarser(case, COARSER).ok_or(why)?;
            let factor = OF_CLOUD[usize::from(summary.grid.supersonic)];
            (COARSER, factor, "on a cloud with twice the spacing".to_owned())
        }
        Part::Step => {
            let (ratio, order) = stepped(&mut time)?;
            let factor = OF_STEP / (ratio.powi(order) - 1.0).abs();
            (ratio, factor, format!("with {ratio} times the step in time"))
        }
        Part::Harmonics => {
            let own = summary.periodic.harmonic_balance.as_ref().map_or(1, |b| b.harmonics);
            let moved = summary.periodic.first_harmonics.iter().map(|h| h.harmonic).max().unwrap_or(1);
            // the other balance has the second harmonic of the motion too, which is told
            let n = if own > TOLD * moved { own - 1 } else { own + 1 };
            if n > MOST_HARMONICS {
                return Err(format!("there is no balance with more than {MOST_HARMONICS} harmonics"));
            }
            if let Temporal::Harmonics(plan) = &mut time {
                (plan.number, plan.check) = (HarmonicCount::Fixed(n as u32), 0);
            }
            let words = format!("with {n} harmonic{} in place of {own}", if n == 1 { "" } else { "s" });
            (n as f64 / own as f64, OF_HARMONICS[usize::from(n > own)], words)
        }
    };
    Ok(Other { part, cloud, time, ratio, factor, words })
}

/// Turns a march into one with another step in time: its length over what it was, and the order of the method.
fn stepped(time: &mut Temporal) -> Result<(f64, i32), String> {
    match time {
        Temporal::Dual(plan) => {
            let order = i32::from(plan.order);
            if let Some(tolerance) = &mut plan.adaptive {
                // the error of one step goes with this power of its length
                let power = order + 1;
                let own = std::mem::replace(tolerance, (*tolerance * f64::from(LONGER).powi(power)).min(LOOSEST));
                if *tolerance == own {
                    return Err(format!("the tolerance of an adaptive step may not be more than {own}"));
                }
                return Ok(((*tolerance / own).powf(1.0 / f64::from(power)), order));
            }
            if let Some(steps) = &mut plan.steps_per_period {
                let own = *steps;
                *steps = own / LONGER;
                if *steps < FEWEST_STEPS {
                    return Err(format!("half of {own} steps a period are fewer than {FEWEST_STEPS}"));
                }
                return Ok((f64::from(own) / f64::from(*steps), order));
            }
            plan.step.iter_mut().for_each(|step| step.0 *= f64::from(LONGER));
            Ok((f64::from(LONGER), order))
        }
        Temporal::Explicit(plan) => {
            plan.cfl *= SHORTER;
            plan.steps = plan.steps.saturating_mul(LONGER);
            let order = match plan.method {
                RungeKutta::Ssprk3 => 3,
                RungeKutta::Rk4 => 4,
            };
            Ok((SHORTER, order))
        }
        _ => Err("nothing marches".into()),
    }
}

/// What the summary of another run says of the numbers `own`.
fn told(other: Other, summary: &Value, own: &Measured) -> Asked {
    let words = &other.words;
    let known = summary["error_bars"]["measured"].clone();
    let Ok(found) = serde_json::from_value::<Measured>(known) else {
        return Asked::Silent(format!("the same {words} tells no numbers"));
    };
    let balance = matches!(other.time, Temporal::Harmonics(_));
    let [steps, missed] = ["iterations", "unconverged_steps"].map(|key| summary[key].as_f64().unwrap_or_default());
    let converged = (summary["converged"] != Value::Bool(false), missed / steps.max(1.0));
    if let Some(why) = why_none(converged, balance, &found) {
        return Asked::Silent(format!("the same {words}: {why}"));
    }
    if found.window != own.window {
        return Asked::Silent(format!(
            "the same {words} repeats itself where this run does not, or the other way round"
        ));
    }
    let Other { part, ratio, factor, .. } = other;
    let particles = summary["particles"].as_u64().unwrap_or_default() as usize;
    let cpu_seconds = summary["cpu_seconds"].as_f64().unwrap_or_default();
    Asked::Told(Box::new(OtherRun { part, ratio, factor, particles, cpu_seconds, values: found.values }))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(time: &str) -> Case {
        let text = format!(
            "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\n[motion]\nreduced_frequency = 0.3\npivot = [0.25, 0]\npitch = \"1 deg\"\n[cloud]\nspacing = 0.1\n\
             [accuracy]\nerror = \"all\"\n{time}\n"
        );
        crate::case::read(&text, "t").unwrap_or_else(|e| panic!("{e}"))
    }

    #[test]
    fn other_runs_have_twice_the_step() {
        let stepped = |time: &str| {
            let mut case = case(time);
            let found = stepped(&mut case.time);
            found.map(|found| (found, case.time))
        };
        let ((ratio, order), Temporal::Dual(plan)) =
            stepped("[time.dual]\nsteps_per_period = 65\nperiods = 3").unwrap()
        else {
            panic!()
        };
        assert_eq!((plan.steps_per_period, ratio, order), (Some(32), 65.0 / 32.0, 2));
        let ((ratio, order), Temporal::Dual(plan)) = stepped("[time.dual]\nstep = 0.2\nuntil = 9\norder = 1").unwrap()
        else {
            panic!()
        };
        assert_eq!((plan.step.map(|t| t.0), ratio, order), (Some(0.4), 2.0, 1));
        let ((ratio, _), Temporal::Dual(plan)) =
            stepped("[time.dual]\nstep = 0.2\nuntil = 9\nadaptive = 1e-3").unwrap()
        else {
            panic!()
        };
        assert!((ratio - 2.0).abs() < 1e-12 && (plan.adaptive.unwrap() - 8e-3).abs() < 1e-15);
        let first = "[time.dual]\nstep = 0.2\nuntil = 9\nadaptive = 1e-3\norder = 1";
        let ((ratio, order), Temporal::Dual(plan)) = stepped(first).unwrap() else { panic!() };
        assert!((ratio - 2.0).abs() < 1e-12 && (plan.adaptive.unwrap() - 4e-3).abs() < 1e-15 && order == 1);
        let ((ratio, order), Temporal::Explicit(plan)) = stepped("[time.explicit]\nuntil = 9").unwrap() else {
            panic!()
        };
        assert_eq!((plan.cfl, ratio, order), (0.4, 0.5, 3));
        assert!(stepped("[time.dual]\nsteps_per_period = 7\nperiods = 3").is_err());
    }

    #[test]
    fn what_is_asked_for_depends_on_the_way_in_time() {
        let march = case("[time.dual]\nstep = 0.2\nuntil = 9");
        let balance = case("[time]\nharmonics = 2");
        assert_eq!(parts(&march, LoadErrors::All), [Part::Cloud, Part::Step]);
        assert_eq!(parts(&balance, LoadErrors::All), [Part::Cloud, Part::Harmonics]);
        assert_eq!(parts(&balance, LoadErrors::Cloud), [Part::Cloud]);
        assert!(parts(&march, LoadErrors::None).is_empty());
    }
}
