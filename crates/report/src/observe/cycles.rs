//! Cycles that a load goes through of itself: vortex shedding, buffet.
//!
//! Where nothing prescribes a period it is found from the history. A cycle begins where the lift rises through its mean;
//! the crossing lies between two steps, linear in time. Ripples and jerks are no cycles: the lift is averaged over a part of the
//! period of the largest peak of its spectrum, and a crossing counts only after it has been below its mean by a part of its
//! deviation. The first half of the history, in which the cycle builds up, is left out, and
//! the last whole cycles give frequency, means and amplitudes. Their spread tells how regular the cycle is.
use serde::{Deserialize, Serialize};

/// Cycles that are looked at, at most.
const MOST: usize = 6;
/// Cycles that make a frequency, at least.
const LEAST: usize = 2;
/// Part of the root mean square deviation by which the lift must have been below its mean before a crossing counts.
const RIPPLE: f64 = 0.5;
/// Part of the period of the largest peak of the spectrum on either side over which the lift is averaged.
const REACH: f64 = 1.0 / 16.0;
/// Bins in time of the spectrum.
const BINS: usize = 1024;
/// Root mean square deviation of the lift below which it does not move.
const STILL: f64 = 1e-6;

/// The last whole cycles of the lift.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cycles {
    /// Cycles in a unit of time.
    pub frequency: f64,
    /// Longest less shortest of the cycles over their mean.
    pub spread: f64,
    /// Number of cycles.
    pub cycles: usize,
    /// Mean of the lift.
    pub mean_cl: f64,
    /// Half of greatest less smallest lift.
    pub amplitude_cl: f64,
    /// Mean of the drag.
    pub mean_cd: f64,
    /// Half of greatest less smallest drag.
    pub amplitude_cd: f64,
}

/// A load at rising times.
#[derive(Clone, Copy)]
pub(super) struct Trace<'a> {
    pub(super) time: &'a [f64],
    pub(super) values: &'a [f64],
}

impl Cycles {
    /// Cycles at the end of the histories of lift and drag at rising `time`s; `None` where there are not two whole ones.
    pub fn of(time: &[f64], lift: &[f64], drag: &[f64]) -> Option<Self> {
        let (start, end) = (*time.first()?, *time.last()?);
        let (cl, cd) = (Trace { time, values: lift }, Trace { time, values: drag });
        let late = (0.5 * (start + end), end);
        let reach = REACH / cl.dominant(late)?;
        let even = cl.averaged(reach);
        let seen = Trace { time, values: &even };
        // nearer to the end the average has one side only
        let late = (late.0, end - reach);
        let first = seen.crossings(late, seen.mean(late))?;
        // the mean of whole cycles is nearer to the middle of the lift than that of half the history
        let begins = seen.crossings(late, seen.mean((*first.first()?, *first.last()?)))?;
        let begins = &begins[begins.len().saturating_sub(MOST + 1)..];
        let cycles = begins.len().saturating_sub(1);
        if cycles < LEAST {
            return None;
        }
        let whole = (begins[0], begins[cycles]);
        let lengths = begins.windows(2).map(|w| w[1] - w[0]);
        let (shortest, longest) = lengths.fold((f64::INFINITY, 0.0_f64), |(s, l), d| (s.min(d), l.max(d)));
        let frequency = cycles as f64 / (whole.1 - whole.0);
        Some(Self {
            frequency,
            spread: (longest - shortest) * frequency,
            cycles,
            mean_cl: cl.mean(whole),
            amplitude_cl: cl.half_range(whole),
            mean_cd: cd.mean(whole),
            amplitude_cd: cd.half_range(whole),
        })
    }
}

impl Trace<'_> {
    /// Value at `t` between samples `k` and `k + 1`.
    fn at(&self, k: usize, t: f64) -> f64 {
        let part = (t - self.time[k]) / (self.time[k + 1] - self.time[k]);
        self.values[k] + part * (self.values[k + 1] - self.values[k])
    }

    /// Mean over time, linear between samples.
    pub(super) fn mean(&self, (from, to): (f64, f64)) -> f64 {
        let piece = |k: usize| {
            let (a, b) = (self.time[k].max(from), self.time[k + 1].min(to));
            if a < b { 0.5 * (b - a) * (self.at(k, a) + self.at(k, b)) } else { 0.0 }
        };
        (0..self.time.len() - 1).map(piece).sum::<f64>() / (to - from)
    }

    fn within(&self, (from, to): (f64, f64)) -> impl Iterator<Item = f64> {
        self.time.iter().zip(self.values).filter(move |(t, _)| from <= **t && **t <= to).map(|(_, v)| *v)
    }

    fn half_range(&self, window: (f64, f64)) -> f64 {
        let range = self.within(window).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        0.5 * (range.1 - range.0)
    }

    /// Integral over time from the first sample to each.
    fn integral(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let pieces = self.time.windows(2).zip(self.values.windows(2)).map(|(t, v)| 0.5 * (t[1] - t[0]) * (v[0] + v[1]));
        let rest = pieces.map(|piece| {
            sum += piece;
            sum
        });
        std::iter::once(0.0).chain(rest).collect()
    }

    /// Integral from the first sample to the time `t`, given those to each sample.
    fn integral_to(&self, t: f64, integral: &[f64]) -> f64 {
        let k = self.time.partition_point(|s| *s <= t).clamp(1, self.time.len() - 1) - 1;
        integral[k] + 0.5 * (t - self.time[k]) * (self.values[k] + self.at(k, t))
    }

    /// Frequency of the largest peak of the spectrum of a window; `None` where there is none.
    pub(super) fn dominant(&self, (from, to): (f64, f64)) -> Option<f64> {
        if self.time.len() < 2 {
            return None;
        }
        let (integral, width) = (self.integral(), (to - from) / BINS as f64);
        let edge = |k: usize| self.integral_to(from + width * k as f64, &integral);
        let bins: Vec<f64> = (0..BINS).map(|k| (edge(k + 1) - edge(k)) / width).collect();
        let mean = bins.iter().sum::<f64>() / BINS as f64;
        let power = |m: usize| {
            let turn = |k: usize| std::f64::consts::TAU * (k * m % BINS) as f64 / BINS as f64;
            let all = bins.iter().enumerate().map(|(k, b)| ((b - mean) * turn(k).cos(), (b - mean) * turn(k).sin()));
            let (c, s) = all.fold((0.0, 0.0), |sum, term| (sum.0 + term.0, sum.1 + term.1));
            c * c + s * s
        };
        let peak = (1..BINS / 4).map(|m| (m, power(m))).max_by(|a, b| a.1.total_cmp(&b.1))?;
        (peak.1.is_finite() && peak.1 > 0.0).then(|| peak.0 as f64 / (to - from))
    }

    /// Means over `reach` on both sides of each sample, as far as the history goes.
    fn averaged(&self, reach: f64) -> Vec<f64> {
        let (integral, last) = (self.integral(), self.time.len() - 1);
        let mean = |t: &f64| {
            let (from, to) = ((t - reach).max(self.time[0]), (t + reach).min(self.time[last]));
            (self.integral_to(to, &integral) - self.integral_to(from, &integral)) / (to - from)
        };
        self.time.iter().map(mean).collect()
    }

    /// Times in the window at which the history rises through `level`; `None` where it is still or not finite.
    fn crossings(&self, window: (f64, f64), level: f64) -> Option<Vec<f64>> {
        let (n, squares) = self.within(window).fold((0.0, 0.0), |(n, s), v| (n + 1.0, s + (v - level).powi(2)));
        let deviation = (squares / n).sqrt();
        if !deviation.is_finite() || deviation < STILL {
            return None;
        }
        let mut below = false;
        let mut times = Vec::new();
        let end = self.time.partition_point(|t| *t <= window.1).min(self.time.len());
        for k in self.time.partition_point(|t| *t < window.0)..end.saturating_sub(1) {
            let (a, b) = (self.values[k] - level, self.values[k + 1] - level);
            below |= a < -RIPPLE * deviation;
            if below && a < 0.0 && b >= 0.0 {
                times.push(self.time[k] + (self.time[k + 1] - self.time[k]) * a / (a - b));
                below = false;
            }
        }
        Some(times)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    const PERIOD: f64 = 5.3;

    fn history(n: usize, f: impl Fn(f64) -> f64) -> (Vec<f64>, Vec<f64>) {
        // steps that are not equal
        let time: Vec<f64> = (0..n).map(|k| 0.09 * k as f64 + 0.02 * (k as f64).sin()).collect();
        let values = time.iter().map(|t| f(*t)).collect();
        (time, values)
    }

    #[test]
    fn a_cycle_that_builds_up_is_found() {
        let size = |t: f64| 1.0 / (1.0 + 1e3 * (-0.4 * t).exp());
        let ripple = |t: f64| 0.02 * (TAU * t / 0.5).sin();
        let (time, lift) = history(1200, |t| 0.1 + 0.6 * size(t) * (TAU * t / PERIOD + 0.4).sin() + ripple(t));
        let (_, drag) = history(1200, |t| 1.3 + 0.05 * size(t) * (2.0 * TAU * t / PERIOD).cos());
        let c = Cycles::of(&time, &lift, &drag).unwrap();
        assert!((c.frequency * PERIOD - 1.0).abs() < 2e-3, "{c:?}");
        assert!(c.cycles == MOST && c.spread < 0.02, "{c:?}");
        assert!((c.mean_cd - 1.3).abs() < 1e-4 && (c.amplitude_cd - 0.05).abs() < 1e-3, "{c:?}");
        assert!((c.mean_cl - 0.1).abs() < 2e-3 && (c.amplitude_cl - 0.61).abs() < 0.02, "{c:?}");
    }

    #[test]
    fn a_pure_sine_is_exact_to_the_square_of_the_step() {
        let (time, lift) = history(1200, |t| (TAU * t / PERIOD).sin());
        let c = Cycles::of(&time, &lift, &lift).unwrap();
        assert!((c.frequency * PERIOD - 1.0).abs() < 1e-5 && c.spread < 1e-3 && c.mean_cl.abs() < 1e-3, "{c:?}");
    }

    #[test]
    fn jerks_are_no_cycles() {
        let (time, mut lift) = history(1200, |t| 0.1 + 0.7 * (TAU * t / PERIOD).sin());
        lift.iter_mut().enumerate().filter(|(k, _)| k % 37 < 2).for_each(|(k, v)| *v += 1.5 - (k % 5) as f64);
        let c = Cycles::of(&time, &lift, &lift).unwrap();
        assert!((c.frequency * PERIOD - 1.0).abs() < 1e-2 && c.cycles == MOST && c.spread < 0.1, "{c:?}");
    }

    #[test]
    fn what_does_not_swing_has_no_cycles() {
        let still = |f: fn(f64) -> f64, n: usize| {
            let (time, lift) = history(n, f);
            Cycles::of(&time, &lift, &lift)
        };
        assert_eq!(still(|t| 0.3 + 0.5 * (-t).exp(), 1200), None);
        assert_eq!(still(|t| (TAU * t / PERIOD).sin(), 120), None, "two whole cycles in the second half");
        assert_eq!(still(|_| f64::NAN, 1200), None);
        assert_eq!(still(|t| t, 1), None);
        assert_eq!(Cycles::of(&[], &[], &[]), None);
    }
}
