//! A short march that a harmonic balance begins from.
//!
//! Newton's method finds the periodic solution from a guess that is near enough. Copies of a steady flow are, where the motion is
//! mild; flow that separates, or a body whose speed is a good part of that of the stream, needs the flow of a period that has been
//! marched. Its accuracy does not matter: steps are coarse, and a multiple of the instances, which are taken from the last period.
use super::super::record::{Log, NEARLY, passed};
use super::super::watch::{Effort, Ending, Now, Observer, Told, drive};
use super::periodic::{build, period_of};
use super::turn::Reached;
use crate::case::Harmonics;
use crate::problem::RunError;
use crate::problem::numerics::harmonic_control;
use crate::scheme::HasGas;
use crate::system::System;
use crate::time::dual::{Dual, Plan};
use crate::time::harmonic::HarmonicBalance;
use crate::time::{Past, Step};

/// Fewest steps of a period.
const STEPS: usize = 36;
/// Orders by which the residual must fall in a step.
const ORDERS: f64 = 2.0;
/// Greatest number of iterations of a step.
const ITERATIONS: u32 = 20;

/// Steps of one length beside a harmonic balance.
pub(super) fn even_steps(step: f64, until: f64) -> Plan {
    Plan { until, step, order: 2, orders: ORDERS, iterations: ITERATIONS, adaptive: None }
}

/// Marches `plan.march` periods from the state `u`; the state at the instances of a balance of so many harmonics in the last of
/// them. `None` when told to stop.
pub(crate) fn lead<S: HasGas<D>, const D: usize>(
    system: &S,
    plan: &Harmonics,
    harmonics: usize,
    u: Vec<f64>,
    log: &mut Log<'_>,
) -> Result<Option<Reached<S>>, RunError> {
    let period = period_of(system, log)?;
    let balance = build(system, plan, harmonics, period);
    let count = balance.instances().count();
    let steps = STEPS.div_ceil(count) * count;
    let march = even_steps(period / steps as f64, f64::from(plan.march) * period);
    let mut effort = Effort { points: system.gas().discretisation.cloud.n_fluid };
    let mut periods = Periods { period, of: plan.march };
    let all = vec![0.0; u.len() * count];
    let mut instances = Instances { balance: &balance, after: march.until - period, part: period / count as f64, all };
    let mut marcher = Dual::new(system, harmonic_control(plan, D), march, Past::default(), u);
    log.note(&format!("{} periods of {steps} steps are marched first", plan.march));
    match drive(&mut marcher, &mut [&mut effort, &mut periods, &mut instances, &mut Told], log)? {
        Ending::Stopped => Ok(None),
        Ending::Failed(problem) => Err(log.failed(problem)),
        _ => Ok(Some(Reached { state: instances.all, end: None, enough: false, unsteady: false })),
    }
}

/// Says when a period is over.
struct Periods {
    period: f64,
    of: u32,
}

impl<S: System> Observer<S, Log<'_>> for Periods {
    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        let done = passed(step.time, self.period);
        if done > passed(now.before, self.period) {
            let unconverged = now.cost().unconverged;
            log.note(&format!("period {done} of {} marched, {unconverged} steps not converged", self.of));
        }
        Ok(())
    }
}

/// Gathers the states at equal parts of the last period.
struct Instances<'a, S: System> {
    balance: &'a HarmonicBalance<'a, S>,
    /// Time at which that period begins.
    after: f64,
    part: f64,
    /// The states.
    all: Vec<f64>,
}

impl<S: System> Observer<S, Log<'_>> for Instances<'_, S> {
    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, _: &mut Log<'_>) -> Result<(), RunError> {
        let parts = (step.time - self.after) / self.part;
        let whole = parts.round();
        if whole >= 1.0 && (parts - whole).abs() < NEARLY {
            // the end of the period is its beginning
            let n = whole as usize % self.balance.instances().count();
            self.balance.set_instance(now.standing().state, n, &mut self.all);
        }
        Ok(())
    }
}
