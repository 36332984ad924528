//! What a motion that repeats says about its loads: harmonics, loops, work of a cycle.
mod measured;

use serde_json::{Value, json};

use crate::claims::Loops;
use crate::observe::cycles::Cycles;
use crate::observe::harmonics::{Harmonics, Periodicity, Window};
use crate::observe::loads::Coefficients;
use crate::record::summary::{Change, FirstHarmonics, LastPeriod, PeriodicLoads};

/// Harmonics that are reported: more where those do not hold the motion, as of several frequencies on their common one.
const HARMONICS: [usize; 3] = [5, 13, 31];
/// The same where a period has too few steps for them.
const FEWER: [usize; 3] = [3, 2, 1];
/// Root mean square of a motion that its harmonics leave, over the largest, below which they hold it.
const HELD: f64 = 1e-3;
/// Harmonic of a motion over its largest above which it is there.
const PRESENT: f64 = 1e-3;
/// Part of a period within which two times are the same.
const SAME_TIME: f64 = 1e-9;
/// Points of a loop.
const POINTS: usize = 256;
/// Part of a period by which a history may fall short of a whole number of them.
const SLACK: f64 = 1e-6;
/// Smallest amplitude of a motion, in radians or lengths, that loads are measured against.
const STILL: f64 = 1e-12;

/// Loads and motion at one time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    /// Time, in the units of the case.
    pub(crate) time: f64,
    /// Loads.
    pub(crate) loads: Coefficients,
    /// Angle (radians, nose up), displacement and coordinate of the first mode of the first body that moves.
    pub(crate) motion: [f64; 5],
}

/// The history of the loads of a march; times and periods are those of the case.
#[derive(Clone, Debug, Default)]
pub(crate) struct Trace {
    samples: Vec<Sample>,
    /// Periods at the end that loops and harmonics are the mean of, at least one.
    periods: u32,
}

/// Parts of the motion that are there, by name.
type Moved = Vec<(&'static str, Harmonics)>;

/// Parts of a motion.
const PARTS: [&str; 5] = ["angle", "shift_x", "shift_y", "shift_z", "mode"];

impl Trace {
    /// Series of the loads and of the parts of the motion that are there, from the last period.
    fn fitted(&self, period: f64) -> Option<([Harmonics; 3], Moved)> {
        let mut all = HARMONICS.into_iter().map_while(|n| self.fitted_by(period, n));
        let few = || FEWER.into_iter().find_map(|n| self.fitted_by(period, n));
        let first = all.next().or_else(few)?;
        let holds = |(_, h): &(&str, Harmonics)| h.remainder <= HELD * h.term(h.dominant()).norm();
        if first.1.iter().all(holds) {
            return Some(first);
        }
        Some(all.find(|(_, motions)| motions.iter().all(holds)).unwrap_or(first))
    }

    /// The same with a number of harmonics.
    fn fitted_by(&self, period: f64, harmonics: usize) -> Option<([Harmonics; 3], Moved)> {
        self.fitted_until(self.samples.last()?.time, period, harmonics)
    }

    /// The same of the history up to the time `end`.
    fn fitted_until(&self, end: f64, period: f64, harmonics: usize) -> Option<([Harmonics; 3], Moved)> {
        let time = self.column(|m| m.time);
        let window = Window { period, periods: f64::from(self.whole(period)), harmonics };
        let fit = |f: &dyn Fn(&Sample) -> f64| Harmonics::fit_until(&time, &self.column(f), &window, end).ok();
        let loads = [fit(&|m| m.loads.cl)?, fit(&|m| m.loads.cd)?, fit(&|m| m.loads.cm)?];
        let moved = |(k, name): (usize, &'static str)| Some((name, fit(&|m: &Sample| m.motion[k])?));
        let moves = |h: &Harmonics| h.term(h.dominant()).norm().max(h.remainder) > STILL;
        let motions = PARTS.into_iter().enumerate().filter_map(moved).filter(|(_, h)| moves(h));
        Some((loads, motions.collect()))
    }

    /// First harmonics over each part of the motion; none while there is no whole period.
    pub(crate) fn first_harmonics(&self, period: f64) -> Vec<FirstHarmonics> {
        let Some((loads, motions)) = self.fitted(period) else { return Vec::new() };
        let all = motions.iter().flat_map(|(name, motion)| {
            let of = |harmonic: usize| {
                let over = |load: &Harmonics| [load.per(motion, harmonic).re, load.per(motion, harmonic).im];
                let [cl, cd, cm] = loads.each_ref().map(over);
                FirstHarmonics { motion: (*name).to_owned(), harmonic, cl, cd, cm }
            };
            motion.present(PRESENT).into_iter().map(of)
        });
        all.collect()
    }

    /// Means and first harmonics of the loads; `None` while there is no whole period, or nothing moves.
    pub(crate) fn periodic_loads(&self, period: f64) -> Option<PeriodicLoads> {
        let (loads, motions) = self.fitted(period)?;
        let (motion, moved) = motions.first()?;
        let harmonic = moved.dominant();
        let of = |value: &dyn Fn(&Harmonics) -> f64| {
            let [cl, cd, cm] = loads.each_ref().map(value);
            Coefficients { cl, cd, cm }
        };
        Some(PeriodicLoads {
            mean: of(&|h| h.mean),
            amplitude: of(&|h| h.term(harmonic).norm()),
            phase_deg: of(&|h| h.per(moved, harmonic).arg().to_degrees()),
            per_motion: of(&|h| h.per(moved, harmonic).norm()),
            motion_amplitude: moved.term(harmonic).norm(),
            harmonic,
            motion: (*motion).to_owned(),
        })
    }

    /// Greatest lift and drag of the march so far.
    pub(crate) fn largest(&self) -> [f64; 2] {
        let most = |f: fn(&Coefficients) -> f64| self.samples.iter().map(|m| f(&m.loads).abs()).fold(0.0, f64::max);
        [most(|c| c.cl), most(|c| c.cd)]
    }

    /// Lift at time `t`, where the history reaches back so far.
    pub(crate) fn lift_at(&self, t: f64) -> Option<f64> {
        self.samples.first().filter(|m| m.time <= t).map(|_| self.loads_near(t)[0])
    }

    /// Loads of the last period, linear in time between steps; `None` while there is no whole one.
    pub(crate) fn last_period(&self, period: f64) -> Option<LastPeriod> {
        let time = self.column(|m| m.time);
        let end = *time.last()?;
        // the first sample lies one step after the start of the march
        let first = time.partition_point(|t| *t < end - period * (1.0 + SAME_TIME));
        if first == 0 && end < period * (1.0 - SAME_TIME) {
            return None;
        }
        let (cl, cd) = (self.column(|m| m.loads.cl), self.column(|m| m.loads.cd));
        let of = |v: &[f64]| {
            let (t, v) = (&time[first..], &v[first..]);
            let area: f64 = t.windows(2).zip(v.windows(2)).map(|(t, v)| 0.5 * (t[1] - t[0]) * (v[0] + v[1])).sum();
            (area / (end - t[0]), v.iter().copied().fold(f64::NEG_INFINITY, f64::max))
        };
        let ((mean_cl, peak_cl), (mean_cd, peak_cd)) = (of(&cl), of(&cd));
        (end > time[first]).then_some(LastPeriod { mean_cl, peak_cl, mean_cd, peak_cd })
    }

    /// Cycles of the lift at the end of the history, whether or not a motion prescribes them.
    pub(crate) fn cycles(&self) -> Option<Cycles> {
        Cycles::of(&self.column(|m| m.time), &self.column(|m| m.loads.cl), &self.column(|m| m.loads.cd))
    }

    /// The same samples, with loops and harmonics from the last `periods`.
    pub(crate) fn over(self, periods: u32) -> Self {
        Self { periods, ..self }
    }

    /// Number of whole periods that loops and harmonics are the mean of. The first sample lies one step after the start of the march.
    fn whole(&self, period: f64) -> u32 {
        let [first, second, .., last] = &self.samples[..] else { return 1 };
        let span = (last.time - first.time + (second.time - first.time)) / period + SLACK;
        self.periods.min(span as u32).max(1)
    }

    /// Mean of the loads in the last periods at the phase of time `t`.
    fn loads_at(&self, t: f64, period: f64) -> [f64; 3] {
        let end = self.samples.last().map_or(0.0, |m| m.time);
        let last = end - (end - t).rem_euclid(period);
        let count = self.whole(period);
        // the first sample lies one step after the start of the march, where the end of the period stands
        let (first, start) = (self.samples.first().map_or(0.0, |m| m.time), end - f64::from(count) * period);
        let near = |t: f64| {
            if t >= first {
                return self.loads_near(t);
            }
            let (part, [a, b]) = ((t - start) / (first - start), [end, first].map(|t| self.loads_near(t)));
            std::array::from_fn(|c| a[c] + part * (b[c] - a[c]))
        };
        let all = (0..count).map(|p| near(last - f64::from(p) * period));
        all.fold([0.0; 3], |sum, loads| std::array::from_fn(|c| sum[c] + loads[c] / f64::from(count)))
    }

    /// Loads at time `t`: the cubic through the four samples around it.
    fn loads_near(&self, t: f64) -> [f64; 3] {
        let after = self.samples.partition_point(|m| m.time < t);
        let first = after.saturating_sub(2).min(self.samples.len().saturating_sub(4));
        let near = &self.samples[first..(first + 4).min(self.samples.len())];
        near.iter().enumerate().fold([0.0; 3], |sum, (k, m)| {
            let others = near.iter().enumerate().filter(|(j, _)| *j != k);
            let weight: f64 = others.map(|(_, o)| (t - o.time) / (m.time - o.time)).product();
            let loads = [m.loads.cl, m.loads.cd, m.loads.cm];
            std::array::from_fn(|c| sum[c] + weight * loads[c])
        })
    }

    /// Forgets all samples.
    pub(crate) fn clear(&mut self) {
        self.samples.clear();
    }

    /// Adds a sample.
    pub(crate) fn push(&mut self, sample: Sample) {
        self.samples.push(sample);
    }

    /// The part of a trace that the history of an interrupted run holds.
    pub(crate) fn parse(text: &str, until: f64) -> Self {
        let mut lines = text.lines();
        let header: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
        let place = |name: &str| header.iter().position(|h| *h == name);
        let loads: Option<Vec<usize>> = ["time", "cl", "cd", "cm"].into_iter().map(place).collect();
        let Some(loads) = loads else { return Self::default() };
        // bodies that stay where they are have no columns of motion
        let motion = ["angle_deg", "shift_x", "shift_y", "shift_z", "mode"].map(place);
        let row = |line: &str| {
            let values: Vec<f64> = line.split(',').map(|v| v.parse().unwrap_or(f64::NAN)).collect();
            let get = |at: usize| values.get(at).copied().unwrap_or(f64::NAN);
            let [angle, x, y, z, mode] = motion.map(|at| at.map_or(0.0, get));
            let coefficients = Coefficients { cl: get(loads[1]), cd: get(loads[2]), cm: get(loads[3]) };
            Sample { time: get(loads[0]), loads: coefficients, motion: [angle.to_radians(), x, y, z, mode] }
        };
        // iterations before the march stand at time zero
        Self {
            periods: 1,
            samples: lines.map(row).filter(|m| m.time > 0.0 && m.time <= until * (1.0 + 1e-12)).collect(),
        }
    }

    fn column(&self, f: impl Fn(&Sample) -> f64) -> Vec<f64> {
        self.samples.iter().map(f).collect()
    }

    /// Change over the last period; `None` while there are not two.
    pub(crate) fn change(&self, period: f64) -> Option<Change> {
        let time = self.column(|m| m.time);
        let loads = [self.column(|m| m.loads.cl), self.column(|m| m.loads.cm)];
        let changes: Option<Vec<Periodicity>> = loads.iter().map(|v| Periodicity::of(&time, v, period)).collect();
        let changes = changes?;
        let largest = |f: fn(&Periodicity) -> f64| changes.iter().map(f).fold(0.0, f64::max);
        Some(Change { periods: time.last()? / period, mean: largest(|p| p.mean), first_harmonic: largest(|p| p.first) })
    }

    /// Harmonics of loads and motions, and phase, angle, displacement and loads over the last period; `None` while there is none.
    pub(crate) fn tables(&self, period: f64) -> Option<(Value, Vec<[f64; 6]>)> {
        let ([cl, cd, cm], motions) = self.fitted(period)?;
        let loads = [("cl", &cl), ("cd", &cd), ("cm", &cm)];
        let about = |motion: &(&'static str, Harmonics)| {
            motion
                .1
                .present(PRESENT)
                .into_iter()
                .map(|n| {
                    let per = |(name, h): &(&str, &Harmonics)| ((*name).to_owned(), ratio(h, &motion.1, n));
                    json!({
                        "motion": motion.0,
                        "harmonic": n,
                        "amplitude": motion.1.term(n).norm(),
                        "loads_per_motion": loads.iter().map(per).collect::<serde_json::Map<String, Value>>(),
                    })
                })
                .collect::<Vec<_>>()
        };
        let whole = json!({
            "convention": "f(t) = mean + Re sum f_n exp(+i n omega t); ratios are a harmonic of the load over the same of \
                           the motion (radians, lengths, coordinate of a mode), phase positive when the load leads; times are those of the run",
            "omega": cl.omega,
            "period": period,
            "change_over_last_period": self.change(period),
            "loads": loads.iter().map(|(n, h)| ((*n).to_owned(), series(h))).collect::<serde_json::Map<String, Value>>(),
            "about_motion": motions.iter().flat_map(about).collect::<Vec<_>>(),
        });
        let rows = self.loop_rows(&motions, period).collect();
        Some((whole, rows))
    }

    /// Phase, angle, displacement and loads over the last period.
    fn loop_rows<'a>(&'a self, motions: &'a Moved, period: f64) -> impl Iterator<Item = [f64; 6]> + 'a {
        (0..POINTS).map(move |k| {
            let t = period * k as f64 / POINTS as f64;
            let angle = motions.iter().find(|m| m.0 == "angle").map_or(0.0, |m| m.1.at(t).to_degrees());
            let shift = motions.iter().find(|m| m.0 != "angle").map_or(0.0, |m| m.1.at(t));
            let [cl, cd, cm] = self.loads_at(t, period);
            [k as f64 / POINTS as f64, angle, shift, cl, cd, cm]
        })
    }

    /// Loads over the last period; empty while there is none.
    pub(crate) fn loops(&self, period: f64) -> Loops {
        let Some((_, motions)) = self.fitted(period) else { return Loops::default() };
        let rows: Vec<[f64; 6]> = self.loop_rows(&motions, period).collect();
        Loops { cl: rows.iter().map(|r| r[3]).collect(), cd: rows.iter().map(|r| r[4]).collect() }
    }
}

/// Mean, complex harmonics and what they leave.
fn series(h: &Harmonics) -> Value {
    let terms: Vec<Value> = h.terms.iter().map(|c| json!({ "re": c.re, "im": c.im, "abs": c.norm() })).collect();
    json!({ "mean": h.mean, "harmonics": terms, "remainder_rms": h.remainder })
}

/// Harmonic `n` of a load over that of the motion, and the work of a cycle by all harmonics.
fn ratio(load: &Harmonics, motion: &Harmonics, n: usize) -> Value {
    let per = load.per(motion, n);
    json!({
        "re": per.re,
        "im": per.im,
        "amplitude": per.norm(),
        "phase_deg": per.arg().to_degrees(),
        "work_per_cycle": load.work(motion),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_period_has_its_mean_and_its_peak() {
        let mut trace = Trace::default();
        for k in 1..=250 {
            let t = 0.02 * f64::from(k);
            let cl = if t > 2.99 { 0.3 + (std::f64::consts::PI * t).sin() } else { 7.0 };
            let loads = Coefficients { cl, cd: 2.0 * cl, cm: 0.0 };
            trace.push(Sample { time: t, loads, motion: [0.0; 5] });
        }
        let last = trace.last_period(2.0).unwrap();
        assert!((last.mean_cl - 0.3).abs() < 1e-12 && (last.peak_cl - 1.3).abs() < 1e-3, "{last:?}");
        assert!((last.mean_cd - 0.6).abs() < 1e-12 && (last.peak_cd - 2.6).abs() < 2e-3, "{last:?}");
        assert!(
            trace.last_period(5.0).is_some_and(|p| p.peak_cl == 7.0),
            "the first sample is one step after the start"
        );
        assert_eq!(trace.last_period(5.1), None);
        assert_eq!(Trace::default().last_period(1.0), None);
    }

    #[test]
    fn loops_go_through_the_samples_and_take_the_mean_of_periods() {
        let sample = |k: i32| {
            let time = f64::from(k) / 16.0;
            // grows by one from period to period
            let cl = (std::f64::consts::TAU * time).sin() + time.floor();
            Sample { time, loads: Coefficients { cl, cd: 1.0, cm: 0.0 }, motion: [0.0; 5] }
        };
        let mut trace = Trace::default();
        (1..=48).for_each(|k| trace.push(sample(k)));
        let at = |trace: &Trace, t: f64| trace.loads_at(t, 1.0)[0];
        assert!((at(&trace, 0.25) - 3.0).abs() < 1e-12 && (at(&trace, 7.25) - 3.0).abs() < 1e-12);
        let mut one = Trace::default();
        (1..=16).for_each(|k| one.push(Sample { loads: sample(32).loads, ..sample(k) }));
        assert!((at(&one, 0.01) - 2.0).abs() < 1e-12, "between the end of a period and its first sample");
        let two = trace.over(2);
        assert!((at(&two, 0.25) - 2.5).abs() < 1e-12 && (two.loads_at(0.6, 1.0)[1] - 1.0).abs() < 1e-12);
        assert_eq!((two.whole(1.0), two.over(9).whole(1.0)), (2, 3));
    }
}
