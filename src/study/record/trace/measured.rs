//! The numbers of a history that error bars are told of: of its last period, of its last cycles, or of all of it.
use num_complex::Complex64;

use super::{Harmonics, Sample, Trace};
use crate::observe::cycles::Cycles;
use crate::observe::error_bars::{LOADS, Measure, Measured, NOT_PERIODIC, Quantity, Window};

/// Multiples of the harmonic that the motion has most of.
const TOLD: [usize; 2] = [1, 2];

/// A load of a sample.
type Pick = fn(&Sample) -> f64;
/// The loads, in the order of their names.
const PICKS: [Pick; 3] = [|m| m.loads.cl, |m| m.loads.cd, |m| m.loads.cm];

impl Trace {
    /// Numbers of the last period where a motion with a `period` repeats, else of the last cycles of the lift where they repeat, else of all of
    /// the march; `None` without a history.
    pub(crate) fn measured(&self, period: Option<f64>) -> Option<Measured> {
        let periodic = period.and_then(|period| self.measured_in_period(period));
        let cycles = || self.measured_in_cycles().filter(|c| c.change().is_some_and(|change| change <= NOT_PERIODIC));
        periodic.or_else(cycles).or_else(|| self.measured_in_all())
    }

    /// Means, and the harmonics of the loads that the motion has most of.
    fn measured_in_period(&self, period: f64) -> Option<Measured> {
        let until = self.samples.last()?.time;
        let from = until - f64::from(self.whole(period)) * period;
        let (loads, motions) = self.fitted(period)?;
        let moved = &motions.first()?.1;
        let before = self.fitted_until(until - period, period, loads[0].terms.len());
        let former = before.as_ref().and_then(|(loads, motions)| Some((loads, &motions.first()?.1)));
        let m = moved.dominant();
        let multiples = TOLD.into_iter().filter(|k| k * m <= moved.terms.len());
        // windows of n periods a period apart share n − 1: what changes from one such window to the next is n times as much
        let overlap = f64::from(self.whole(period));
        let apart = |own: [f64; 2], before: [f64; 2]| [0, 1].map(|d| own[d] + overlap * (before[d] - own[d]));
        let quantities: Vec<usize> = std::iter::once(0).chain(multiples).collect();
        let of = |(load, name): (usize, &str)| {
            let measure = |k: usize| {
                let value = multiple(&loads[load], moved, m, k);
                Measure {
                    of: name.to_owned(),
                    quantity: if k == 0 { Quantity::Mean } else { Quantity::Harmonic(k * m) },
                    value,
                    before: former.map(|(loads, moved)| apart(value, multiple(&loads[load], moved, m, k))),
                }
            };
            quantities.iter().copied().map(measure).collect::<Vec<_>>()
        };
        let values = LOADS.into_iter().enumerate().flat_map(of).collect();
        Some(Measured { window: Window::LastPeriod, from, until, values })
    }

    /// Frequency of the lift, means and amplitudes, over its last cycles.
    fn measured_in_cycles(&self) -> Option<Measured> {
        let time = self.column(|m| m.time);
        let until = *time.last()?;
        let [lift, others @ ..] = PICKS;
        let looked = |n: usize| {
            let load = |pick: Pick| self.samples[..n].iter().map(pick).collect::<Vec<f64>>();
            let found = others.map(|other| Cycles::of(&time[..n], &load(lift), &load(other)));
            let [Some(drag), Some(moment)] = found else { return None };
            Some([
                ("CL", Quantity::Frequency, drag.frequency),
                ("CL", Quantity::Mean, drag.mean_cl),
                ("CL", Quantity::Amplitude, drag.amplitude_cl),
                ("CD", Quantity::Mean, drag.mean_cd),
                ("CD", Quantity::Amplitude, drag.amplitude_cd),
                ("CM", Quantity::Mean, moment.mean_cd),
                ("CM", Quantity::Amplitude, moment.amplitude_cd),
            ])
        };
        let cycles = self.cycles()?;
        let last = looked(time.len())?;
        let former = looked(time.partition_point(|t| *t <= until - 1.0 / cycles.frequency));
        let measure = |(k, (of, quantity, value)): (usize, (&str, Quantity, f64))| Measure {
            of: of.to_owned(),
            quantity,
            value: [value, 0.0],
            before: former.map(|all| [all[k].2, 0.0]),
        };
        let from = until - cycles.cycles as f64 / cycles.frequency;
        let values = last.into_iter().enumerate().map(measure).collect();
        Some(Measured { window: Window::Cycles, from, until, values })
    }

    /// Last value, mean, deviation and greatest value of each load.
    fn measured_in_all(&self) -> Option<Measured> {
        let time = self.column(|m| m.time);
        let ([from, .., until], true) = (&time[..], time.len() > 1) else { return None };
        let of = |(pick, name): (Pick, &'static str)| {
            let load = self.column(pick);
            let mean_of = |f: &dyn Fn(f64) -> f64| {
                let pieces = time.windows(2).zip(load.windows(2));
                pieces.map(|(t, v)| 0.5 * (t[1] - t[0]) * (f(v[0]) + f(v[1]))).sum::<f64>() / (until - from)
            };
            let mean = mean_of(&|v| v);
            let peak = load.iter().fold(0.0, |most: f64, v| if v.abs() > most.abs() { *v } else { most });
            let all = [
                (Quantity::Final, load.last().copied().unwrap_or_default()),
                (Quantity::Mean, mean),
                (Quantity::Rms, mean_of(&|v| (v - mean).powi(2)).sqrt()),
                (Quantity::Peak, peak),
            ];
            all.map(|(quantity, value)| Measure { of: name.to_owned(), quantity, value: [value, 0.0], before: None })
        };
        let values = PICKS.into_iter().zip(LOADS).flat_map(of).collect();
        Some(Measured { window: Window::March, from: *from, until: *until, values })
    }
}

/// Mean (`k` = 0), or harmonic k m of a load when time starts at the greatest value of harmonic `m` of the motion.
fn multiple(load: &Harmonics, motion: &Harmonics, m: usize, k: usize) -> [f64; 2] {
    if k == 0 {
        return [load.mean, 0.0];
    }
    let term = load.term(k * m) * Complex64::cis(-(k as f64) * motion.term(m).arg());
    [term.re, term.im]
}

#[cfg(test)]
mod tests {
    use super::super::Coefficients;
    use super::*;
    use std::f64::consts::TAU;

    /// Steps of a history whose lift is `f`, and whose drag is constant.
    fn history(steps: usize, dt: f64, angle: f64, f: impl Fn(f64) -> f64) -> Trace {
        let mut trace = Trace::default();
        for k in 1..=steps {
            let t = dt * k as f64;
            let loads = Coefficients { cl: f(t), cd: 0.5, cm: -0.25 * f(t) };
            trace.push(Sample { time: t, loads, motion: [angle * (TAU * t).sin(), 0.0, 0.0, 0.0, 0.0] });
        }
        trace
    }

    fn value(all: &Measured, of: &str, quantity: Quantity) -> Measure {
        all.values.iter().find(|m| m.of == of && m.quantity == quantity).unwrap().clone()
    }

    #[test]
    fn a_period_has_means_and_harmonics_from_the_greatest_angle() {
        let lift = |t: f64| 0.3 + 2.0 * (TAU * t - 0.2).sin() + 0.1 * (2.0 * TAU * t).cos() + 0.05 * (-t).exp();
        let all = history(192, 1.0 / 64.0, 0.02, lift).measured(Some(1.0)).unwrap();
        assert_eq!((all.window, all.values.len()), (Window::LastPeriod, 9));
        let first = value(&all, "CL", Quantity::Harmonic(1));
        assert!(
            (first.value[0] - 2.0 * 0.2f64.cos()).abs() < 2e-3 && (first.value[1] + 2.0 * 0.2f64.sin()).abs() < 2e-3,
            "{first:?}"
        );
        // twice the phase of the motion, which is greatest a quarter of a period late
        let second = value(&all, "CL", Quantity::Harmonic(2));
        assert!((second.value[0] + 0.1).abs() < 2e-3, "{second:?}");
        let mean = value(&all, "CL", Quantity::Mean);
        assert!(mean.before.unwrap()[0] - mean.value[0] > 1e-3, "it still decays");
        assert!(all.change().unwrap() < 0.01);
        // a single period says nothing of the one before
        let one = history(64, 1.0 / 64.0, 0.02, lift).measured(Some(1.0)).unwrap();
        assert_eq!(one.change(), None);
    }

    #[test]
    fn what_repeats_by_itself_is_told_by_its_cycles_and_all_else_as_a_whole() {
        let lift = |t: f64| (TAU * t / 0.7).sin();
        let cycles = history(600, 0.02, 0.0, lift).measured(None).unwrap();
        assert_eq!(cycles.window, Window::Cycles);
        assert!((value(&cycles, "CL", Quantity::Frequency).value[0] - 1.0 / 0.7).abs() < 1e-3);
        assert!((value(&cycles, "CM", Quantity::Amplitude).value[0] - 0.25).abs() < 2e-3);
        let step = history(100, 0.1, 0.0, |t| 1.0 - 2.0 * (-t).exp()).measured(None).unwrap();
        assert_eq!(step.window, Window::March);
        assert!((value(&step, "CL", Quantity::Final).value[0] - 1.0).abs() < 1e-3);
        assert!((value(&step, "CL", Quantity::Peak).value[0] - 1.0).abs() < 1e-3);
        assert!(value(&step, "CD", Quantity::Rms).value[0] < 1e-12);
        assert!(history(1, 0.1, 0.0, lift).measured(None).is_none());
    }
}
