//! Loads evaluated twice at moments of a period.
use super::super::look::{GasView, momentum};
use super::super::record::crosscheck::{MOMENTS, Moment};
use super::super::record::{Log, passed};
use super::drive::{Now, Observer};
use crate::problem::RunError;
use crate::scheme::{HasGas, View, Work};
use crate::time::{Standing, Step};

/// Compares loads at equal parts of the period of a march.
pub(crate) struct CrossCheck<'a, S, const D: usize> {
    /// The system.
    pub(crate) system: &'a S,
}

impl<S: HasGas<D>, const D: usize> Observer<S, Log<'_>> for CrossCheck<'_, S, D> {
    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        let Some(part) = log.period.map(|p| p / f64::from(MOMENTS)) else { return Ok(()) };
        if passed(step.time, part) <= passed(now.before, part) {
            return Ok(());
        }
        let Standing { frame, work, state, .. } = now.standing();
        let view = GasView::of(self.system, frame, state);
        compare(&view, self.system.gas_work(work), log.record.iteration, step.time, log)
    }
}

/// Keeps the loads of a moment, by both evaluations, as of an iteration; `time` is that of the solver.
pub(crate) fn compare<const D: usize>(
    gas: &GasView<'_, D>,
    work: &mut Work<D>,
    iteration: u64,
    time: f64,
    log: &mut Log<'_>,
) -> Result<(), RunError> {
    if !log.compares_loads() {
        return Ok(());
    }
    let Some(sum) = momentum::around(&log.case, &log.axes, gas, work, true) else { return Ok(()) };
    let view = View::new(gas.fluid, gas.frame, work);
    let wall = log.axes.coefficients(&view);
    let around = log.axes.axes(&view).coefficients(&sum.load);
    let time = log.units.case_time(time);
    log.compared(&Moment { iteration, time, wall, around })
}
