//! Sums of growing or decaying oscillations, fitted to samples at arbitrary times.
//!
//! f(t) = c + Σ_m e^{σ_m t} (a_m cos ω_m t + b_m sin ω_m t), where a term with ω = 0 is a e^{σ t}.
//!
//! All of c, σ, ω, a and b are fitted together by Gauss-Newton steps on the sum of squares, damped until they reduce it
//! (Levenberg 1944, Marquardt 1963). The fit needs a good initial guess, such as the poles of a [`super::pencil`]. The
//! caller should scale times and values to order one.
use num_complex::Complex64;

use super::dense::Factors;

/// Maximum number of steps.
const STEPS: usize = 80;
/// Initial and maximum damping, relative to the diagonal of the normal equations.
const HELD_BACK: f64 = 1e-6;
const MOST_HELD_BACK: f64 = 1e8;
/// Minimum damping, with which singular normal equations can still be solved.
const LEAST_HELD_BACK: f64 = 1e-13;
/// Relative decrease of the sum of squares in a step below which the fit is regarded as converged.
const GAIN: f64 = 1e-12;

/// One term of the sum.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Term {
    /// Growth rate σ [1/time].
    pub growth: f64,
    /// Angular frequency ω ≥ 0 [rad/time].
    pub frequency: f64,
    /// Amplitude a of the cosine.
    pub cosine: f64,
    /// Amplitude b of the sine; unused if ω = 0.
    pub sine: f64,
}

/// A constant c plus a sum of terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Exponentials {
    /// Constant c.
    pub constant: f64,
    /// Terms of the sum.
    pub terms: Vec<Term>,
}

/// Samples of a signal.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Times of the samples.
    pub times: &'a [f64],
    /// Values of the samples, one for each time.
    pub values: &'a [f64],
}

/// Unknowns that a step may change.
#[derive(Clone, Copy, PartialEq)]
enum Free {
    Amplitudes,
    All,
}

/// Normal equations of a step.
struct Normal {
    n: usize,
    matrix: Vec<f64>,
    right: Vec<f64>,
}

impl Term {
    /// The term with the pole s = σ + iω and zero amplitudes.
    pub fn of(pole: Complex64) -> Self {
        Self { growth: pole.re, frequency: pole.im, ..Self::default() }
    }

    /// True if ω = 0.
    pub fn is_drift(&self) -> bool {
        self.frequency == 0.0
    }

    /// Value of the term at the time `t`.
    pub fn at(&self, t: f64) -> f64 {
        let (sine, cosine) = (self.frequency * t).sin_cos();
        (self.growth * t).exp() * (self.cosine * cosine + self.sine * sine)
    }

    /// Root mean square of the term at the given times.
    pub fn size(&self, times: &[f64]) -> f64 {
        (times.iter().map(|t| self.at(*t).powi(2)).sum::<f64>() / times.len() as f64).sqrt()
    }

    /// Derivatives of the value with respect to a and b, and to σ and ω if these are free.
    fn derivatives(&self, t: f64, free: Free, row: &mut Vec<f64>) {
        let ((sine, cosine), e) = ((self.frequency * t).sin_cos(), (self.growth * t).exp());
        row.push(e * cosine);
        if !self.is_drift() {
            row.push(e * sine);
        }
        if free == Free::All {
            row.push(t * e * (self.cosine * cosine + self.sine * sine));
            if !self.is_drift() {
                row.push(t * e * (self.sine * cosine - self.cosine * sine));
            }
        }
    }

    /// Adds a step to the unknowns, in the order of [`Term::derivatives`].
    fn add(&mut self, free: Free, step: &mut impl Iterator<Item = f64>) {
        let drift = self.is_drift();
        let mut next = |wanted: bool| if wanted { step.next().unwrap_or(0.0) } else { 0.0 };
        self.cosine += next(true);
        self.sine += next(!drift);
        self.growth += next(free == Free::All);
        self.frequency += next(free == Free::All && !drift);
    }
}

impl Exponentials {
    /// The best fit to `samples` near the `poles` s = σ + iω with ω ≥ 0; `None` if there are fewer samples than
    /// unknowns.
    pub fn fit(samples: Samples<'_>, poles: &[Complex64]) -> Option<Self> {
        let mut start = Self { constant: 0.0, terms: poles.iter().map(|s| Term::of(*s)).collect() };
        if samples.times.len() < start.unknowns() {
            return None;
        }
        // amplitudes alone are a linear problem: one step and one correction
        for _ in 0..2 {
            start = start.step(samples, Free::Amplitudes, LEAST_HELD_BACK)?;
        }
        Some(start.polished(samples))
    }

    /// Number of unknowns c, σ, ω, a and b.
    pub fn unknowns(&self) -> usize {
        1 + self.terms.iter().map(|term| if term.is_drift() { 2 } else { 4 }).sum::<usize>()
    }

    /// Value of the sum at the time `t`.
    pub fn at(&self, t: f64) -> f64 {
        self.constant + self.terms.iter().map(|term| term.at(t)).sum::<f64>()
    }

    /// Sum of the squared differences from the samples.
    pub fn misfit(&self, samples: Samples<'_>) -> f64 {
        samples.times.iter().zip(samples.values).map(|(t, y)| (y - self.at(*t)).powi(2)).sum()
    }

    fn polished(self, samples: Samples<'_>) -> Self {
        let (mut misfit, mut held, mut best) = (self.misfit(samples), HELD_BACK, self);
        for _ in 0..STEPS {
            let next = best.step(samples, Free::All, held).map(|next| (next.misfit(samples), next));
            let Some((found, next)) = next.filter(|(found, _)| *found < misfit) else {
                held *= 10.0;
                if held > MOST_HELD_BACK {
                    break;
                }
                continue;
            };
            let gained = misfit - found > GAIN * misfit;
            (best, misfit, held) = (next, found, (0.1 * held).max(LEAST_HELD_BACK));
            if !gained {
                break;
            }
        }
        best.terms.iter_mut().filter(|term| term.frequency < 0.0).for_each(|term| {
            (term.frequency, term.sine) = (-term.frequency, -term.sine);
        });
        best
    }

    /// Fit after one step with the damping `held`; `None` if the normal equations have no solution.
    fn step(&self, samples: Samples<'_>, free: Free, held: f64) -> Option<Self> {
        let step = self.normal(samples, free).solve(held)?;
        let (mut next, mut step) = (self.clone(), step.into_iter());
        next.constant += step.next().unwrap_or(0.0);
        next.terms.iter_mut().for_each(|term| term.add(free, &mut step));
        Some(next)
    }

    fn normal(&self, samples: Samples<'_>, free: Free) -> Normal {
        let mut row = Vec::with_capacity(self.unknowns());
        let mut normal = Normal { n: 0, matrix: Vec::new(), right: Vec::new() };
        for (t, y) in samples.times.iter().zip(samples.values) {
            row.clear();
            row.push(1.0);
            self.terms.iter().for_each(|term| term.derivatives(*t, free, &mut row));
            normal.add(&row, y - self.at(*t));
        }
        normal
    }
}

impl Normal {
    /// Adds the equation row · x = misfit.
    fn add(&mut self, row: &[f64], misfit: f64) {
        self.n = row.len();
        self.matrix.resize(self.n * self.n, 0.0);
        self.right.resize(self.n, 0.0);
        for (i, a) in row.iter().enumerate() {
            self.right[i] += a * misfit;
            self.matrix[i * self.n..][..self.n].iter_mut().zip(row).for_each(|(m, b)| *m += a * b);
        }
    }

    /// Solves for the step, with the diagonal enlarged by the fraction `held`; unknowns are scaled to a unit diagonal.
    fn solve(self, held: f64) -> Option<Vec<f64>> {
        let n = self.n;
        let size = |i: usize| self.matrix[i * n + i].sqrt();
        let scale: Vec<f64> = (0..n).map(|i| if size(i) > 0.0 { 1.0 / size(i) } else { 1.0 }).collect();
        let entry = |k: usize| {
            let own = self.matrix[k] * scale[k / n] * scale[k % n];
            if k / n == k % n { own.max(f64::MIN_POSITIVE) + held } else { own }
        };
        let factors = Factors::new(n, (0..n * n).map(entry).collect())?;
        let right: Vec<f64> = self.right.iter().zip(&scale).map(|(r, s)| r * s).collect();
        let mut step = vec![0.0; n];
        factors.solve(&right, &mut step);
        step.iter_mut().zip(&scale).for_each(|(x, s)| *x *= s);
        Some(step)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fit_finds_what_made_the_samples() {
        let swing = |growth, frequency, cosine, sine| Term { growth, frequency, cosine, sine };
        let exact = Exponentials {
            constant: -0.4,
            terms: vec![swing(-0.7, 20.0, 1.0, 0.3), swing(0.4, 24.0, -0.2, 0.5), swing(-3.0, 0.0, 0.2, 0.0)],
        };
        // uneven times
        let times: Vec<f64> = (0..300).map(|k| k as f64 / 300.0 - 1.0 + 1e-3 * (k as f64).sin()).collect();
        let values: Vec<f64> = times.iter().map(|t| exact.at(*t)).collect();
        let samples = Samples { times: &times, values: &values };
        let poles = [Complex64::new(-0.5, 20.3), Complex64::new(0.1, 23.7), Complex64::new(-2.0, 0.0)];
        let found = Exponentials::fit(samples, &poles).unwrap();
        assert!(found.misfit(samples) < 1e-24, "{found:?}");
        for (a, b) in found.terms.iter().zip(&exact.terms) {
            assert!((a.growth - b.growth).abs() < 1e-8 && (a.frequency - b.frequency).abs() < 1e-8, "{found:?}");
        }
        assert_eq!(found.unknowns(), 11);
        assert!(Exponentials::fit(Samples { times: &times[..10], values: &values[..10] }, &poles).is_none());
    }
}
