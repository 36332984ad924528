//! A pilot: the steady flow of a case on a coarser cloud, solved in a moment to learn what such a flow costs on this machine.
//!
//! How many iterations a flow takes, and how far they run in parallel, nobody knows who has not seen it: a bow shock takes five times
//! those of a section at Mach 0.5. What does not depend on the number of particles is seen on few of them.
use std::time::{Duration, Instant};

use super::super::cost::Pilot;
use super::super::flow::in_memory_in;
use super::super::look::Snapshot;
use super::super::monitor::{Monitor, Tick};
use super::super::setup::behind_shocks;
use crate::case::{Case, Dual, Initial, Temporal, Time};
use crate::cloud::CloudSpec;
use crate::cloud::layout::count;
use crate::geometry::Surface;
use crate::problem::{ProblemIn, numerics};

/// Greatest number of particles of a pilot: a fraction of a second in the plane.
const MOST: f64 = 6000.0;
/// Factors on the spacing.
const FACTORS: [f64; 2] = [2.0, 4.0];

/// Longest that a pilot may take, in 2-D and 3-D, where the cloud of the case itself takes longer: a flow that is not solved by then
/// tells nothing.
const LONGEST: [Duration; 2] = [Duration::from_secs(2), Duration::from_secs(10)];

/// Steps of a march that a pilot takes, and those of them that are timed: the first ones differ.
const STEPS: f64 = 12.0;
const TIMED: usize = 8;

/// Ends a run at a moment; notes when the steps of a march ended.
struct Bounded {
    end: Instant,
    steps: Vec<Instant>,
}

impl Bounded {
    fn in_space(dimension: usize) -> Self {
        Self { end: Instant::now() + LONGEST[dimension - 2], steps: Vec::new() }
    }
}

impl Monitor for Bounded {
    fn tick(&mut self, tick: &Tick) {
        if tick.march.is_some() {
            self.steps.push(Instant::now());
        }
    }
    fn note(&mut self, _: &str) {}
    fn stop(&self) -> bool {
        Instant::now() > self.end
    }
}

/// Solves the steady flow around the bodies of a problem, whose cloud has `n` particles, on a coarser cloud, and some steps of a march, whose
/// motion has the `period`. `None` where a run has no such start or it counts for little, where even the coarser cloud has many particles, and
/// where it is not solved soon.
pub(super) fn fly<const D: usize>(problem: &ProblemIn<D>, n: usize, period: Option<f64>) -> Option<Pilot> {
    let case = problem.case();
    let relaxation = numerics::relaxation(case).filter(|_| !matches!(case.time, Temporal::Harmonics(_)))?;
    if case.bodies.is_empty() || !matches!(case.initial, Initial::FreeStream) {
        return None;
    }
    let factor = FACTORS.into_iter().find(|f| n as f64 / f.powi(D as i32) <= MOST)?;
    let coarse = problem.at_rest(relaxation, factor).ok()?;
    let found = in_memory_in(&coarse, &mut Bounded::in_space(D)).ok()??;
    let (convergence, cost) = (&found.summary.convergence, &found.summary.cost);
    let following = followed(case, problem.surface()?, &found.field).unwrap_or(1.0);
    let step = step(problem, (factor, period));
    Some(Pilot { particles: convergence.particles as f64, seconds: cost.wall_seconds, following, step })
}

/// Seconds of an implicit step in time on the coarser cloud with `factor` times the spacing; `None` where there are none, or too few were
/// taken in the time.
fn step<const D: usize>(problem: &ProblemIn<D>, (factor, period): (f64, Option<f64>)) -> Option<f64> {
    let case = problem.case();
    let length = case.step_length(period)?;
    let Temporal::Dual(dual) = &case.time else { return None };
    let until = Some(Time(STEPS * case.flow.units().case_time(length)));
    let time = Dual { until, periods: None, periodic_tolerance: None, swing: None, ..dual.clone() };
    let coarse = problem.in_time(Temporal::Dual(time), factor).ok()?;
    let mut watch = Bounded::in_space(D);
    in_memory_in(&coarse, &mut watch).ok()?;
    let last = watch.steps.get(watch.steps.len().checked_sub(TIMED + 1)?..)?;
    Some(last[TIMED].duration_since(last[0]).as_secs_f64() / TIMED as f64)
}

/// Particles of the cloud of a case that follows the shocks in `field` over those of one that does not; `None` where it does not.
fn followed<const D: usize>(case: &Case, surface: &Surface<D>, field: &Snapshot) -> Option<f64> {
    let sources = behind_shocks(case, surface, field, 1.0);
    if sources.is_empty() {
        return None;
    }
    let cells = |sources: &[_]| count(&CloudSpec::of_case(case), Some(surface), sources).ok();
    Some(cells(&sources)? as f64 / cells(&[])? as f64)
}
