//! A short march that begins from a harmonic balance and tells how far the two are apart.
//!
//! The states of the balance at the start of a period and at the two steps before it are what the second-order formula in time
//! goes on from: the march has no start of its own to forget. It solves the same equations in space with another error in time,
//! and leaves the balance where the flow has a rhythm of its own or waves that the harmonics cannot hold.
use super::super::look::GasView;
use super::super::record::Log;
use super::super::watch::{Effort, Ending, Now, Observer, Told, drive};
use super::lead::even_steps;
use super::periodic::{PeriodicState, terms};
use crate::case::Harmonics as Asked;
use crate::math::fourier::Series;
use crate::observe::harmonics::{Harmonics, Window};
use crate::observe::loads::Coefficients;
use crate::problem::RunError;
use crate::problem::numerics::harmonic_control;
use crate::record::summary::{Apart, MarchingCheck};
use crate::scheme::HasGas;
use crate::time::dual::Dual;
use crate::time::{Integrator, Past, Standing, Step};

/// Steps of a period: the formula in time then errs by less than .1 % in the first harmonic.
const STEPS: u32 = 128;
/// First harmonic over the largest one above which a load counts.
const PRESENT: f64 = 1e-2;

/// Marches `plan.check` periods from the balance, whose loads are `series`; `None` when told to stop.
pub(super) fn marched_on<S: HasGas<D>, const D: usize>(
    plan: &Asked,
    from: &PeriodicState<'_, S, D>,
    series: &[Series; 3],
    log: &mut Log<'_>,
) -> Result<Option<MarchingCheck>, RunError> {
    let (system, period) = (from.system, from.period);
    let step = period / f64::from(STEPS);
    let march = even_steps(step, f64::from(1 + plan.check) * period);
    let at = |before: f64| from.state_at(-before * step / period * std::f64::consts::TAU);
    let past = Past { time: period, last: step, next: step, before: at(1.0), older: at(2.0), ..Past::default() };
    let mut marcher = Dual::new(system, harmonic_control(plan, D), march, past, at(0.0));
    log.note(&format!("{} periods of {STEPS} steps are marched from the balance", plan.check));
    let mut effort = Effort { points: system.gas().discretisation.cloud.n_fluid };
    let mut seen = Loads { system, time: Vec::new(), loads: Vec::new() };
    match drive(&mut marcher, &mut [&mut effort, &mut seen, &mut Told], log)? {
        Ending::Stopped => return Ok(None),
        Ending::Failed(problem) => return Err(log.failed(problem)),
        _ => {}
    }
    let window = Window { period, periods: 1.0, harmonics: from.balance.instances().harmonics() };
    let [cl, cd, cm] = seen.apart(series, &window);
    let unconverged = marcher.cost().unconverged;
    Ok(Some(MarchingCheck { periods: plan.check, steps_per_period: STEPS, unconverged, cl, cd, cm }))
}

/// Keeps the loads of all times.
struct Loads<'a, S, const D: usize> {
    system: &'a S,
    time: Vec<f64>,
    loads: Vec<Coefficients>,
}

impl<S: HasGas<D>, const D: usize> Observer<S, Log<'_>> for Loads<'_, S, D> {
    fn begin(&mut self, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        self.time.push(now.mark().time);
        let Standing { frame, work, state, .. } = now.standing();
        let view = GasView::of(self.system, frame, state);
        self.loads.push(view.coefficients(&log.axes, self.system.gas_work(work)).unwrap_or_default());
        Ok(())
    }

    fn step(&mut self, _: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        self.begin(now, log)
    }
}

impl<S, const D: usize> Loads<'_, S, D> {
    /// Lift, drag and moment against those of a balance, where they have a first harmonic.
    fn apart(&self, series: &[Series; 3], window: &Window) -> [Option<Apart>; 3] {
        let values: [fn(&Coefficients) -> f64; 3] = [|c| c.cl, |c| c.cd, |c| c.cm];
        let held = series.each_ref().map(|s| terms(s)[0]);
        let largest = held.iter().fold(0.0, |m: f64, h| m.max(h.norm()));
        std::array::from_fn(|k| {
            let values: Vec<f64> = self.loads.iter().map(values[k]).collect();
            let fit = Harmonics::fit(&self.time, &values, window).ok()?;
            let size = held[k].norm();
            (size > PRESENT * largest).then(|| Apart {
                mean: (fit.mean - series[k].coefficients()[0]) / size,
                first_harmonic: (fit.term(1) - held[k]).norm() / size,
            })
        })
    }
}
