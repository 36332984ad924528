//! Harmonics of load histories.
//!
//! f(t) = Re Σ f_n e^{+inωt}, n = 0..N, fitted by least squares to the last periods of a history whose steps need not be
//! equal; each sample counts with the time it stands for. A march has its first sample one step after its start: there the end of
//! the period stands for the beginning. A sine of amplitude A and phase φ has f_1 = −iA e^{iφ}. What a
//! load has to do with the motion is told by ratios, in which the origin of time drops out: f_1/α_1, and for the others
//! f_n (|α_1|/α_1)^n, which is the coefficient when time starts at the greatest angle. The work of a cycle is
//! ∮ f dα = π Σ n Im(f_n ᾱ_n): positive when the flow feeds the motion.
use num_complex::Complex64;

/// Samples per unknown of the fit, at least.
const SAMPLES_PER_UNKNOWN: usize = 2;
/// Pivots of the fit smaller than this part of the largest mean that the samples do not tell the harmonics apart.
const SINGULAR: f64 = 1e-10;
/// Harmonics among which the largest is looked for, fewer where a period has few samples.
const WATCHED: [usize; 2] = [5, 1];
/// Part of a step by which a history may miss the start of its window.
const SLACK: f64 = 1e-6;

/// Mean and harmonics of a history.
#[derive(Clone, Debug, PartialEq)]
pub struct Harmonics {
    /// Angular frequency ω.
    pub omega: f64,
    /// Mean f_0.
    pub mean: f64,
    /// f_1, f_2, …
    pub terms: Vec<Complex64>,
    /// Root mean square of what the series leaves.
    pub remainder: f64,
}

/// Which part of a history is looked at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// Period of the motion.
    pub period: f64,
    /// Number of periods, counted from the end.
    pub periods: f64,
    /// Number of harmonics.
    pub harmonics: usize,
}

/// How a period differs from the one before it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Periodicity {
    /// Change of the mean over the largest harmonic.
    pub mean: f64,
    /// Change of the largest harmonic (complex) over itself.
    pub first: f64,
}

/// Why a history has no harmonics.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HarmonicsError {
    /// The history is shorter than the window.
    #[error("the history spans {span} of {needed} periods\nhint: march longer, or look at fewer periods")]
    Short {
        /// Periods in the history.
        span: f64,
        /// Periods asked for.
        needed: f64,
    },
    /// Too few samples for the number of harmonics.
    #[error(
        "{samples} samples do not fix {harmonics} harmonics\nhint: take more steps in a period, or fewer harmonics"
    )]
    Sparse {
        /// Samples in the window.
        samples: usize,
        /// Harmonics asked for.
        harmonics: usize,
    },
    /// A value that is no number.
    #[error("the history holds a value that is not finite at t = {time}")]
    NotFinite {
        /// When.
        time: f64,
    },
}

impl Harmonics {
    /// Fits the end of the history `values` at rising `time`s.
    pub fn fit(time: &[f64], values: &[f64], window: &Window) -> Result<Self, HarmonicsError> {
        let end = time.last().copied().unwrap_or_default();
        Self::fit_until(time, values, window, end)
    }

    /// Fits the part of the history that ends at time `end`.
    pub fn fit_until(time: &[f64], values: &[f64], window: &Window, end: f64) -> Result<Self, HarmonicsError> {
        let (first, last) = bounds(time, window, end)?;
        let (time, values) = (&time[first..last], &values[first..last]);
        if let Some(k) = (0..time.len()).find(|&k| !values[k].is_finite() || !time[k].is_finite()) {
            return Err(HarmonicsError::NotFinite { time: time[k] });
        }
        let unknowns = 2 * window.harmonics + 1;
        let sparse = HarmonicsError::Sparse { samples: time.len(), harmonics: window.harmonics };
        if time.len() < SAMPLES_PER_UNKNOWN * unknowns {
            return Err(sparse);
        }
        let omega = std::f64::consts::TAU / window.period;
        let rows: Vec<Vec<f64>> = time.iter().map(|t| basis(window.harmonics, omega * t)).collect();
        let weights = durations(time, end - window.periods * window.period);
        // the mean is taken out first: it may be far larger than the rest
        let level = values.iter().sum::<f64>() / values.len() as f64;
        let mut matrix = vec![vec![0.0; unknowns + 1]; unknowns];
        for ((row, weight), value) in rows.iter().zip(&weights).zip(values) {
            for (i, line) in matrix.iter_mut().enumerate() {
                (0..unknowns).for_each(|j| line[j] += weight * row[i] * row[j]);
                line[unknowns] += weight * row[i] * (value - level);
            }
        }
        let x = solve(matrix).ok_or(sparse)?;
        let terms = (1..=window.harmonics).map(|n| Complex64::new(x[2 * n - 1], -x[2 * n])).collect();
        let left = |row: &[f64], value: f64| value - level - row.iter().zip(&x).map(|(a, b)| a * b).sum::<f64>();
        let squares: f64 = rows.iter().zip(values).zip(&weights).map(|((r, v), w)| w * left(r, *v).powi(2)).sum();
        let remainder = (squares / weights.iter().sum::<f64>()).sqrt();
        Ok(Self { omega, mean: level + x[0], terms, remainder })
    }

    /// f_n, zero beyond the last.
    pub fn term(&self, n: usize) -> Complex64 {
        match n {
            0 => Complex64::new(self.mean, 0.0),
            n => self.terms.get(n - 1).copied().unwrap_or_default(),
        }
    }

    /// Value of the series at time `t`.
    pub fn at(&self, t: f64) -> f64 {
        let wave = |n: usize| (self.term(n) * Complex64::cis(n as f64 * self.omega * t)).re;
        self.mean + (1..=self.terms.len()).map(wave).sum::<f64>()
    }

    /// f_n/α_n: the load per motion in one harmonic, with the phase by which it leads.
    pub fn per(&self, motion: &Self, n: usize) -> Complex64 {
        self.term(n) / motion.term(n)
    }

    /// Number of the largest harmonic, 1 where there is none.
    pub fn dominant(&self) -> usize {
        (1..=self.terms.len()).reduce(|a, b| if self.term(b).norm() > self.term(a).norm() { b } else { a }).unwrap_or(1)
    }

    /// Numbers of the harmonics that are more than `part` of the largest, rising.
    pub fn present(&self, part: f64) -> Vec<usize> {
        let least = part * self.term(self.dominant()).norm();
        (1..=self.terms.len()).filter(|n| self.term(*n).norm() > least).collect()
    }

    /// Work of a cycle ∮ f dα on the motion α.
    pub fn work(&self, motion: &Self) -> f64 {
        let shared = self.terms.len().min(motion.terms.len());
        (1..=shared).map(|n| n as f64 * (self.term(n) * motion.term(n).conj()).im).sum::<f64>() * std::f64::consts::PI
    }

    /// The loop of the load against the motion, `points` pairs (motion, load) over one period.
    pub fn cycle(&self, motion: &Self, points: usize) -> Vec<[f64; 2]> {
        let period = std::f64::consts::TAU / self.omega;
        let times = (0..points).map(|k| period * k as f64 / points as f64);
        times.map(|t| [motion.at(t), self.at(t)]).collect()
    }
}

impl Periodicity {
    /// Compares the last period of a history with the one before; `None` while there are no two, or no harmonic.
    pub fn of(time: &[f64], values: &[f64], period: f64) -> Option<Self> {
        let end = *time.last()?;
        let both = |harmonics: usize| {
            let window = Window { period, periods: 1.0, harmonics };
            let at = |end: f64| Harmonics::fit_until(time, values, &window, end).ok();
            at(end).zip(at(end - period))
        };
        let (last, before) = WATCHED.into_iter().find_map(both)?;
        let n = last.dominant();
        let size = last.term(n).norm();
        (size > 0.0).then(|| Self {
            mean: (last.mean - before.mean).abs() / size,
            first: (last.term(n) - before.term(n)).norm() / size,
        })
    }

    /// The greater of both changes.
    pub fn change(&self) -> f64 {
        self.mean.max(self.first)
    }
}

/// Range of samples inside the window that ends at `end`.
fn bounds(time: &[f64], window: &Window, end: f64) -> Result<(usize, usize), HarmonicsError> {
    let start = end - window.periods * window.period;
    let slack = SLACK * window.period;
    let begin = time.first().copied().unwrap_or(f64::INFINITY);
    let step = if let [a, b, ..] = time { b - a } else { 0.0 };
    if begin > start + step + slack {
        let span = if time.is_empty() { 0.0 } else { (end - begin) / window.period };
        return Err(HarmonicsError::Short { span, needed: window.periods });
    }
    let first = time.partition_point(|t| *t < start - slack);
    let last = time.partition_point(|t| *t <= end + slack);
    Ok((first, last))
}

/// 1, cos, sin, cos 2, sin 2, …
fn basis(harmonics: usize, phase: f64) -> Vec<f64> {
    let mut row = vec![1.0];
    for n in 1..=harmonics {
        let (sine, cosine) = (n as f64 * phase).sin_cos();
        row.extend([cosine, sine]);
    }
    row
}

/// The time each sample stands for: half the way to its neighbours. Where the first one lies behind the `start` of the window, the
/// last one stands for the start.
fn durations(time: &[f64], start: f64) -> Vec<f64> {
    let n = time.len();
    let mut all: Vec<f64> = (0..n).map(|k| 0.5 * (time[(k + 1).min(n - 1)] - time[k.saturating_sub(1)])).collect();
    let short = 0.5 * (time[0] - start).max(0.0);
    all[0] += short;
    all[n - 1] += short;
    all
}

/// Solves the symmetric positive system [A | b] by elimination; `None` when it is singular.
fn solve(mut matrix: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let n = matrix.len();
    let largest = (0..n).fold(0.0f64, |m, i| m.max(matrix[i][i]));
    for k in 0..n {
        if !(matrix[k][k] > SINGULAR * largest) {
            return None;
        }
        for i in k + 1..n {
            let factor = matrix[i][k] / matrix[k][k];
            (k..=n).for_each(|j| matrix[i][j] -= factor * matrix[k][j]);
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| matrix[k][j] * x[j]).sum();
        x[k] = (matrix[k][n] - known) / matrix[k][k];
    }
    Some(x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    const PERIOD: f64 = 2.5;

    /// Times with steps that differ by up to 40 %.
    fn times(periods: f64, steps: usize) -> Vec<f64> {
        let n = (periods * steps as f64) as usize;
        (0..=n).map(|k| PERIOD / steps as f64 * (k as f64 + 0.2 * (1.7 * k as f64).sin())).collect()
    }

    fn window(periods: f64, harmonics: usize) -> Window {
        Window { period: PERIOD, periods, harmonics }
    }

    fn fit(f: impl Fn(f64) -> f64, harmonics: usize) -> Harmonics {
        let time = times(5.3, 40);
        let values: Vec<f64> = time.iter().map(|t| f(*t)).collect();
        Harmonics::fit(&time, &values, &window(3.0, harmonics)).unwrap()
    }

    fn omega() -> f64 {
        TAU / PERIOD
    }

    #[test]
    fn known_signals_come_back() {
        let load = |t: f64| 7.0 + 2.0 * (omega() * t + 0.3).sin() - 0.5 * (2.0 * omega() * t).cos();
        let h = fit(load, 3);
        assert!((h.mean - 7.0).abs() < 1e-12 && h.remainder < 1e-12);
        // A sin(ωt + φ) = Re(−iA e^{iφ} e^{iωt})
        let first = Complex64::new(0.0, -2.0) * Complex64::cis(0.3);
        assert!((h.term(1) - first).norm() < 1e-12 && (h.term(2) + 0.5).norm() < 1e-12);
        assert!(h.term(3).norm() < 1e-12 && h.term(9).norm() == 0.0);
        assert!((h.at(1.234) - load(1.234)).abs() < 1e-12);
    }

    #[test]
    fn a_march_of_one_period_has_harmonics() {
        let time: Vec<f64> = (1..=24).map(|k| PERIOD / 24.0 * f64::from(k)).collect();
        let load = |t: f64| 7.0 + 2.0 * (omega() * t + 0.3).sin();
        let values: Vec<f64> = time.iter().map(|t| load(*t)).collect();
        let h = Harmonics::fit(&time, &values, &window(1.0, 2)).unwrap();
        assert!((h.mean - 7.0).abs() < 1e-12 && (h.term(1).norm() - 2.0).abs() < 1e-12);
        // of what the series leaves nothing falls on it
        let ripple: Vec<f64> = time.iter().map(|t| load(*t) + (5.0 * omega() * t).cos()).collect();
        let h = Harmonics::fit(&time, &ripple, &window(1.0, 2)).unwrap();
        assert!((h.mean - 7.0).abs() < 1e-12 && h.term(2).norm() < 1e-12);
        assert!(Harmonics::fit(&time[1..], &values[1..], &window(1.0, 2)).is_err());
    }

    #[test]
    fn loads_are_told_relative_to_the_motion() {
        let motion = fit(|t| 0.1 * (omega() * t + 1.1).sin(), 2);
        let load = fit(|t| 3.0 * (omega() * t + 1.1 - 0.25).sin() + 0.2 * (2.0 * (omega() * t + 1.1)).cos(), 2);
        let ratio = load.per(&motion, 1);
        assert!((ratio.norm() - 30.0).abs() < 1e-10 && (ratio.arg() + 0.25).abs() < 1e-12);
    }

    #[test]
    fn work_is_the_area_of_the_loop() {
        let motion = fit(|t| 0.1 * (omega() * t).sin() + 0.01 * (2.0 * omega() * t).cos(), 2);
        let load = fit(|t| 1.0 + 3.0 * (omega() * t + 0.4).sin() + 0.2 * (2.0 * omega() * t).sin(), 2);
        let (cycle, n) = (load.cycle(&motion, 4096), 4096);
        let pairs = (0..n).map(|k| (cycle[k], cycle[(k + 1) % n]));
        let area: f64 = pairs.map(|(a, b)| 0.5 * (a[1] + b[1]) * (b[0] - a[0])).sum();
        assert!((load.work(&motion) - area).abs() < 1e-5 * area.abs(), "{} {area}", load.work(&motion));
        let plain = fit(|t| 3.0 * (omega() * t + 0.4).sin(), 1);
        let pitch = fit(|t| 0.1 * (omega() * t).sin(), 1);
        // a load that leads the motion feeds it
        assert!((plain.work(&pitch) - PI * 0.3 * 0.4f64.sin()).abs() < 1e-12);
    }

    #[test]
    fn periodicity_sees_what_has_not_settled() {
        let time = times(4.2, 50);
        let settled: Vec<f64> = time.iter().map(|t| 1.0 + (omega() * t).sin()).collect();
        assert!(Periodicity::of(&time, &settled, PERIOD).unwrap().change() < 1e-12);
        let drift: Vec<f64> = time.iter().zip(&settled).map(|(t, v)| v + 0.01 * t / PERIOD).collect();
        let p = Periodicity::of(&time, &drift, PERIOD).unwrap();
        // a period raises the mean by a hundredth
        assert!((p.mean - 0.01).abs() < 1e-3 && p.first < 1e-3, "{p:?}");
        assert!(Periodicity::of(&time[..60], &drift[..60], PERIOD).is_none());
        // two periods from the first step on
        let time: Vec<f64> = (1..=48).map(|k| PERIOD / 24.0 * f64::from(k)).collect();
        let settled: Vec<f64> = time.iter().map(|t| 1.0 + (omega() * t).sin()).collect();
        assert!(Periodicity::of(&time, &settled, PERIOD).unwrap().change() < 1e-10);
        assert!(Periodicity::of(&time[1..], &settled[1..], PERIOD).is_none());
        assert!(Periodicity::of(&[], &[], PERIOD).is_none());
    }

    #[test]
    fn histories_that_say_too_little_are_refused() {
        let time = times(2.0, 20);
        let mut values = vec![1.0; time.len()];
        let short = Harmonics::fit(&time, &values, &window(3.0, 1)).unwrap_err();
        assert!(matches!(short, HarmonicsError::Short { .. }) && short.to_string().contains("hint"));
        let sparse = Harmonics::fit(&time, &values, &window(1.0, 10));
        assert!(matches!(sparse, Err(HarmonicsError::Sparse { harmonics: 10, .. })));
        values[30] = f64::NAN;
        assert!(matches!(Harmonics::fit(&time, &values, &window(1.0, 1)), Err(HarmonicsError::NotFinite { .. })));
        assert!(Harmonics::fit(&[], &[], &window(1.0, 1)).is_err());
    }
}
