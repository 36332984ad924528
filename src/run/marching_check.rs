//! A short march that begins from a harmonic balance and tells how far the two are apart.
//!
//! The states of the balance at the start of a period and at the two steps before it are what the second-order formula in time
//! goes on from: the march has no start of its own to forget. It solves the same equations in space with another error in time,
//! and leaves the balance where the flow has a rhythm of its own or waves that the harmonics cannot hold.
use serde::Serialize;

use super::RunError;
use super::harmonic::terms;
use super::marching_start::even_steps;
use super::run_recorder::RunRecorder;
use super::setup::harmonic_control;
use super::solve::coefficients;
use crate::case::Harmonics as Asked;
use crate::math::fourier::Series;
use crate::observe::harmonics::{Harmonics, Window};
use crate::observe::loads::Coefficients;
use crate::scheme::Fluid;
use crate::system::System;
use crate::time::dual::Dual;
use crate::time::harmonic::HarmonicBalance;
use crate::time::{March, Past};

/// Steps of a period: the formula in time then errs by less than .1 % in the first harmonic.
const STEPS: u32 = 128;
/// First harmonic over the largest one above which a load counts.
const PRESENT: f64 = 1e-2;

/// How far a march from a harmonic balance ends from it.
#[derive(Clone, Debug, Serialize)]
pub struct MarchingCheck {
    /// Periods marched.
    pub periods: u32,
    /// Steps of each.
    pub steps_per_period: u32,
    /// Steps that did not reach their goal.
    pub unconverged: u32,
    /// Lift, where it has a first harmonic.
    pub cl: Option<Apart>,
    /// Drag.
    pub cd: Option<Apart>,
    /// Moment.
    pub cm: Option<Apart>,
}

/// A load in the last period of a march against that of the balance, over the first harmonic of the balance.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Apart {
    /// Difference of the means.
    pub mean: f64,
    /// Size of the difference of the first harmonics, complex.
    pub first_harmonic: f64,
}

/// Marches `plan.check` periods from the balance `state`, whose loads are `series`; `None` when told to stop.
pub(super) fn marched_on<const D: usize>(
    plan: &Asked,
    balance: &HarmonicBalance<'_, Fluid<D>>,
    fluid: &Fluid<D>,
    (state, series): (&[f64], &[Series; 3]),
    period: f64,
    recorder: &mut RunRecorder<'_>,
) -> Result<Option<MarchingCheck>, RunError> {
    let step = period / f64::from(STEPS);
    let until = f64::from(1 + plan.check) * period;
    let at = |before: f64| {
        let mut one = vec![0.0; fluid.len()];
        balance.at_phase(state, -before * step / period * std::f64::consts::TAU, &mut one);
        one
    };
    let past = Past { time: period, last: step, next: step, before: at(1.0), older: at(2.0), ..Past::default() };
    let mut marcher = Dual::new(fluid, harmonic_control(plan, D), even_steps(step, until), (past, at(0.0)));
    recorder.note(&format!("{} periods of {STEPS} steps are marched from the balance", plan.check));
    recorder.work.begin(0);
    let (mut time, mut loads) = (Vec::new(), Vec::<Coefficients>::new());
    loop {
        time.push(marcher.past().time);
        let (frame, work, state) = marcher.parts();
        loads.push(coefficients(fluid, recorder.axes(), frame, state, work).unwrap_or_default());
        if marcher.finished() {
            break;
        }
        marcher.advance().map_err(|e| recorder.failed(e))?;
        recorder.work.add(marcher.evaluations(), fluid.discretisation.cloud.n_fluid);
        if recorder.stopped() {
            return Ok(None);
        }
    }
    let window = Window { period, periods: 1.0, harmonics: balance.instances().harmonics() };
    let values: [fn(&Coefficients) -> f64; 3] = [|c| c.cl, |c| c.cd, |c| c.cm];
    let held = series.each_ref().map(|s| terms(s)[0]);
    let largest = held.iter().fold(0.0, |m: f64, h| m.max(h.norm()));
    let [cl, cd, cm] = std::array::from_fn(|k| {
        let values: Vec<f64> = loads.iter().map(values[k]).collect();
        let fit = Harmonics::fit(&time, &values, &window).ok()?;
        let size = held[k].norm();
        (size > PRESENT * largest).then(|| Apart {
            mean: (fit.mean - series[k].coefficients()[0]) / size,
            first_harmonic: (fit.term(1) - held[k]).norm() / size,
        })
    });
    let unconverged = marcher.past().unconverged;
    Ok(Some(MarchingCheck { periods: plan.check, steps_per_period: STEPS, unconverged, cl, cd, cm }))
}

impl MarchingCheck {
    /// A line for those who watch.
    pub(super) fn told(&self) -> String {
        let named = [("lift", self.cl), ("drag", self.cd), ("moment", self.cm)];
        let apart = |(name, a): (&str, Option<Apart>)| {
            let a = a?;
            Some(format!("{name} {:.2} % (mean {:+.2} %)", 100.0 * a.first_harmonic, 100.0 * a.mean))
        };
        let all: Vec<String> = named.into_iter().filter_map(apart).collect();
        format!(
            "after {} periods of marching the first harmonics differ from the balance, in parts of themselves: {}",
            self.periods,
            if all.is_empty() { "no load has one".into() } else { all.join(", ") }
        )
    }
}
