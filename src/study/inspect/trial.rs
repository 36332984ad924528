//! Trials of explicit marches: how many steps a march takes, seen in a second or two.
//!
//! The longest stable step goes with the distance of particles as the body is deformed: in an impact that squeezes its foot to a third it
//! falls to a third, and where particles are sheared past one another to a twentieth. What a march takes is seen on the body itself where
//! that is over soon, else on one with fewer particles, whose steps are longer by the ratio of the steps at rest.
use std::time::{Duration, Instant};

use crate::case::{Case, Temporal};
use crate::problem::solids::{Built, Filling};
use crate::time::symplectic::{Plan, Symplectic};
use crate::time::{Integrator, Past};

/// Factors on the distance of particles, and the longest that the trial of each of them may take.
const FACTORS: [f64; 3] = [1.0, 2.0, 4.0];
const LONGEST: Duration = Duration::from_millis(1500);

/// Steps of a march.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Steps {
    /// Their number.
    pub(super) number: f64,
    /// True where a trial came to its end, so that it is about that many; else there are at least so many.
    pub(super) is_known: bool,
    /// Seconds that they take.
    pub(super) seconds: f64,
}

/// Steps of the explicit march of the structure `built` of a case; `None` of other studies.
pub(super) fn steps<const D: usize>((case, filling): (&Case, Filling<'_>), built: &Built<D>) -> Option<Steps> {
    let Temporal::Explicit(plan) = &case.time else { return None };
    let plan = Plan { cfl: plan.cfl, until: plan.until?.0 };
    let at_rest = step_at_rest(built);
    let (mut least, mut each) = (plan.until / (plan.cfl * at_rest), 0.0);
    for factor in FACTORS {
        let coarse = (factor > 1.0).then(|| filling.coarser(factor).build::<D>());
        let body = match &coarse {
            None => built,
            Some(Ok(body)) => body,
            Some(Err(_)) => break,
        };
        let finer = step_at_rest(body) / at_rest;
        let (number, is_over, seconds_of_step) = march(body, plan);
        if each == 0.0 {
            each = seconds_of_step;
        }
        let number = finer * number;
        if is_over {
            return Some(Steps { number, is_known: true, seconds: each * number });
        }
        least = least.max(number);
    }
    Some(Steps { number: least, is_known: false, seconds: each * least })
}

/// Steps of the march of a body, whether it is over soon, else there are at least so many, and the seconds of one of them.
fn march<const D: usize>(body: &Built<D>, plan: Plan) -> (f64, bool, f64) {
    let (start, system) = (body.structure.start(|i| body.velocity[i]), &body.structure);
    let (began, mut march) = (Instant::now(), Symplectic::new(system, plan, Past::default(), start));
    let each = |steps: u32| began.elapsed().as_secs_f64() / f64::from(steps.max(1));
    while !march.finished() {
        let mark = march.mark();
        let to_come = if mark.last > 0.0 { (plan.until - mark.time) / mark.last } else { 0.0 };
        if began.elapsed() > LONGEST || march.advance().is_err() {
            return (f64::from(mark.iteration) + to_come, false, each(mark.iteration));
        }
    }
    let steps = march.mark().iteration;
    (f64::from(steps), true, each(steps))
}

fn step_at_rest<const D: usize>(body: &Built<D>) -> f64 {
    body.structure.solid.stable_step(&vec![[0.0; D]; body.structure.solid.len()])
}
