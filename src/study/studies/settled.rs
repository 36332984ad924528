//! When a harmonic balance has found its loads: a small motion hardly shows in the residual.
use super::super::look::{GasView, motion};
use super::super::record::Log;
use super::super::record::saved::Settling;
use super::super::watch::{Eyes, Now, Observer, Wish};
use crate::math::fourier::Series;
use crate::observe::loads::Coefficients;
use crate::problem::RunError;
use crate::scheme::HasGas;
use crate::system::System;
use crate::time::harmonic::HarmonicBalance;
use crate::time::{Standing, Step};

/// Iterations over which loads must not change.
const WINDOW: usize = 5;
/// Largest harmonic over that of all loads above which a load counts: symmetry leaves others at round-off.
const PRESENT: f64 = 1e-3;
/// Orders by which the residual must have fallen before loads are looked at.
const FALLEN: f64 = 2.0;
/// Iterations without a new smallest residual, smaller by the part `PROGRESS`, after which a relaxation is given up.
const PATIENCE: u32 = 50;
/// See `PATIENCE`.
const PROGRESS: f64 = 0.97;

/// Sees loads at all instances of a period.
pub(super) struct PeriodicEyes<'a, S: System, const D: usize> {
    balance: &'a HarmonicBalance<'a, S>,
    system: &'a S,
    work: S::Work,
}

impl<'a, S: HasGas<D>, const D: usize> PeriodicEyes<'a, S, D> {
    /// Of a balance.
    pub(super) fn new(balance: &'a HarmonicBalance<'a, S>, system: &'a S) -> Self {
        Self { balance, system, work: system.work() }
    }

    /// Loads at the instances where the equations are evaluated; `None` without bodies.
    pub(super) fn series(&mut self, frames: &[S::Frame], state: &[f64], log: &Log<'_>) -> Option<[Series; 3]> {
        let mut all = [Vec::new(), Vec::new(), Vec::new()];
        let mut one = vec![0.0; self.system.len()];
        for (n, frame) in frames.iter().enumerate() {
            self.balance.look(state, n, &mut one);
            let view = GasView::of(self.system, frame, &one);
            let c = view.coefficients(&log.axes, self.system.gas_work(&mut self.work))?;
            [c.cl, c.cd, c.cm].into_iter().zip(&mut all).for_each(|(v, all)| all.push(v));
        }
        let [a, b, c] = all.map(|values| Series::of_values(&values).ok());
        Some([a?, b?, c?])
    }
}

impl<'a, S: HasGas<D>, const D: usize> Eyes<HarmonicBalance<'a, S>> for PeriodicEyes<'a, S, D> {
    fn loads(&mut self, at: Standing<'_, HarmonicBalance<'a, S>>, log: &mut Log<'_>) -> Option<Coefficients> {
        let series = self.series(at.frame, at.state, log)?;
        let recent = &mut log.record.settling.recent;
        recent.push(series.iter().flat_map(|s| s.coefficients().to_vec()).collect());
        recent.drain(..recent.len().saturating_sub(WINDOW + 1));
        let [cl, cd, cm] = series.each_ref().map(|s| s.coefficients()[0]);
        Some(Coefficients { cl, cd, cm })
    }

    fn motion(&self, at: Standing<'_, HarmonicBalance<'a, S>>, time: f64) -> [f64; 5] {
        motion(self.system.gas(), time, at.frame.first().map_or(&[], |f| &self.system.gas_frame(f).jets))
    }

    fn particles(&self) -> usize {
        self.system.gas().discretisation.cloud.n_fluid
    }

    fn instances(&self) -> usize {
        self.balance.times().len()
    }
}

/// Ends a balance when the residual has fallen and the loads have settled, or nothing is gained any more.
pub(super) struct Settled {
    /// Residual over its first value that it is after.
    pub(super) goal: f64,
    /// Change of the loads that counts as none.
    pub(super) tolerance: f64,
    /// Greatest number of iterations.
    pub(super) iterations: u32,
}

impl<S: System> Observer<S, Log<'_>> for Settled {
    fn wish(&mut self, now: &mut Now<'_, S>, log: &Log<'_>) -> Option<Wish> {
        let (mark, settling) = (now.mark(), &log.record.settling);
        // a checkpoint may have been written by the very iteration that ended the relaxation, or before the first one
        if mark.iteration > 0 && self.is_reached(mark.residual, settling) {
            return Some(Wish::Finish);
        }
        let over = mark.iteration >= self.iterations || self.is_stuck(mark.iteration, settling);
        over.then_some(Wish::GiveUp)
    }

    fn step(&mut self, step: &Step, now: &mut Now<'_, S>, log: &mut Log<'_>) -> Result<(), RunError> {
        let settling = &mut log.record.settling;
        settling.evaluations = now.cost().evaluations;
        if step.residual < PROGRESS * settling.best {
            (settling.best, settling.best_iteration) = (step.residual, step.iteration);
        }
        Ok(())
    }
}

impl Settled {
    /// No new smallest residual for too long.
    pub(super) fn is_stuck(&self, iteration: u32, settling: &Settling) -> bool {
        iteration > settling.best_iteration + PATIENCE
    }

    /// The residual has fallen far enough and the loads have settled.
    fn is_reached(&self, residual: f64, settling: &Settling) -> bool {
        let recent = &settling.recent;
        (residual <= self.goal && still(recent, 1, self.tolerance))
            || (residual <= 10f64.powf(-FALLEN) && still(recent, WINDOW, self.tolerance))
    }

    /// Says that a relaxation was given up.
    pub(super) fn told(drop: f64, harmonics: usize, place: &str) -> String {
        format!(
            "the residual has not fallen for {PATIENCE} iterations at {:.2} orders: with {harmonics} harmonics the flow has no \
             periodic state that the relaxation can find; it is largest at {place}",
            -drop.log10()
        )
    }
}

/// True when over a number of iterations no mean and no harmonic of a load has changed by more than `tolerance` times the
/// largest harmonic of that load, for loads that the motion makes at all; bodies without loads are always still. The first harmonic
/// may be small: that of the common frequency of several, or of a drag that follows the square of the motion.
fn still(recent: &[Vec<f64>], iterations: usize, tolerance: f64) -> bool {
    let Some(last) = recent.last() else { return true };
    if recent.len() <= iterations {
        return false;
    }
    let count = last.len() / 3;
    let window = &recent[recent.len() - 1 - iterations..];
    let part = |v: &[f64], load: usize, k: usize| v[load * count + k];
    let harmonic = |load: usize, n: usize| part(last, load, n).hypot(part(last, load, n + count / 2));
    let dominant = |load: usize| (1..=count / 2).map(|n| harmonic(load, n)).fold(0.0, f64::max);
    let largest = (0..3).map(dominant).fold(0.0, f64::max);
    (0..3).filter(|load| dominant(*load) > PRESENT * largest).all(|load| {
        let bound = tolerance * dominant(load);
        (0..count).all(|k| window.iter().all(|v| (part(v, load, k) - part(last, load, k)).abs() < bound))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn loads_are_still_when_those_that_are_there_are() {
        // mean, cosine and sine of lift, drag and moment: a piston has drag alone
        let drag = |sine: f64| vec![1e-9, 0.0, 2e-9, 0.1, 0.0, sine, 0.0, 1e-12, 0.0];
        let recent = [drag(0.5), drag(0.4), drag(0.400_01)];
        assert!(still(&recent, 1, 1e-4) && !still(&recent, 2, 1e-4) && !still(&recent, 1, 1e-6));
        assert!(!still(&recent, 3, 1.0), "too few iterations");
        assert!(still(&[], 1, 1e-4) && still(&[vec![0.0; 9], vec![0.0; 9]], 1, 1e-4));
        let lift = |cosine: f64| vec![0.0, cosine, 0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.0];
        assert!(!still(&[lift(1.0), lift(1.01)], 1, 1e-4));
        // means and cosines of two harmonics and their sines: the second one rules, the first one is noise
        let second = |noise: f64| vec![0.0, noise, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert!(still(&[second(1e-6), second(3e-6)], 1, 1e-4) && !still(&[second(1e-6), second(3e-3)], 1, 1e-4));
    }
}
