//! A short march that a harmonic balance begins from.
//!
//! Newton's method finds the periodic solution from a guess that is near enough. Copies of a steady flow are, where the motion is
//! mild; flow that separates, or a body whose speed is a good part of that of the stream, needs the flow of a period that has been
//! marched. Its accuracy does not matter: steps are coarse, and a multiple of the instances, which are taken from the last period.
use super::RunError;
use super::run_recorder::RunRecorder;
use super::setup::harmonic_control;
use crate::case::Harmonics;
use crate::scheme::Fluid;
use crate::time::dual::{Dual, Plan};
use crate::time::harmonic::HarmonicBalance;
use crate::time::{March, Past};

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

/// The state at the instances of `balance` in the last of `plan.march` periods that begin with the state `u`; `None` when told to
/// stop.
pub(super) fn marched<const D: usize>(
    plan: &Harmonics,
    balance: &HarmonicBalance<'_, Fluid<D>>,
    fluid: &Fluid<D>,
    u: Vec<f64>,
    period: f64,
    recorder: &mut RunRecorder<'_>,
) -> Result<Option<Vec<f64>>, RunError> {
    let count = balance.instances().count();
    let stride = STEPS.div_ceil(count);
    let steps = (stride * count) as u32;
    let step = period / f64::from(steps);
    let until = f64::from(plan.march) * period;
    let march = even_steps(step, until);
    let mut all = vec![0.0; u.len() * count];
    let mut marcher = Dual::new(fluid, harmonic_control(plan, D), march, (Past::default(), u));
    recorder.note(&format!("{} periods of {steps} steps are marched first", plan.march));
    recorder.work.begin(0);
    for k in 1..=plan.march * steps {
        marcher.advance().map_err(|e| recorder.failed(e))?;
        recorder.work.add(marcher.evaluations(), fluid.discretisation.cloud.n_fluid);
        if recorder.stopped() {
            return Ok(None);
        }
        if k.is_multiple_of(steps) {
            let (done, of) = (k / steps, plan.march);
            recorder
                .note(&format!("period {done} of {of} marched, {} steps not converged", marcher.past().unconverged));
        }
        let last = k > (plan.march - 1) * steps;
        if last && (k as usize).is_multiple_of(stride) {
            // the end of the period is its beginning
            let n = (k as usize / stride) % count;
            let (_, _, state) = marcher.parts();
            balance.set_instance(state, n, &mut all);
        }
    }
    Ok(Some(all))
}
