//! Difference formulas for ∂/∂t on the times and coordinates of a march.
//!
//! The first-order formula of two times, and the second-order one of three, written for steps of unequal length r = Δt/Δt₋₁:
//! c = [(1 + 2r)/(1 + r), −(1 + r), r²/(1 + r)]/Δt.
use crate::system::{Instant, Rate, Term};

/// A difference formula with the coordinates of bodies at its times, except those of the new state, which are passed to
/// [`Formula::at`].
#[derive(Clone, Debug, Default)]
pub struct Formula {
    terms: [Known; 3],
    count: usize,
}

/// One term of the formula.
#[derive(Clone, Debug, Default)]
struct Known {
    coefficient: f64,
    time: f64,
    coordinates: Vec<f64>,
}

impl Formula {
    /// First-order formula (f(end) − f(end − dt))/dt.
    pub fn first_order(end: f64, dt: f64) -> Self {
        Self::of(&[(1.0 / dt, end), (-1.0 / dt, end - dt)])
    }

    /// Second-order formula of three times, after steps of length `last` and `dt`.
    pub fn second_order(end: f64, dt: f64, last: f64) -> Self {
        let r = dt / last;
        Self::of(&[
            ((1.0 + 2.0 * r) / (1.0 + r) / dt, end),
            (-(1.0 + r) / dt, end - dt),
            (r * r / (1.0 + r) / dt, end - dt - last),
        ])
    }

    fn of(terms: &[(f64, f64)]) -> Self {
        let mut all = Self { count: terms.len(), ..Self::default() };
        for (known, (coefficient, time)) in all.terms.iter_mut().zip(terms) {
            (known.coefficient, known.time) = (*coefficient, *time);
        }
        all
    }

    /// This formula with the coordinates of bodies at its second time, its third time, and so on.
    pub fn with_past(mut self, past: &[&[f64]]) -> Self {
        for (term, coordinates) in self.terms[..self.count].iter_mut().skip(1).zip(past) {
            term.coordinates = coordinates.to_vec();
        }
        self
    }

    /// Time at the end of the step.
    pub fn time(&self) -> f64 {
        self.terms[0].time
    }

    /// Coefficient of term `k`; 0 beyond the last term.
    pub fn coefficient(&self, k: usize) -> f64 {
        self.terms.get(k).map_or(0.0, |t| t.coefficient)
    }

    /// Calls `f` with the instant at the end of the step, for bodies with the coordinates `coordinates`.
    pub fn at<T>(&self, coordinates: &[f64], f: impl FnOnce(&Instant<'_>) -> T) -> T {
        let mut terms = [Term::of_time(0.0, 0.0); 3];
        let count = self.count;
        for (term, known) in terms.iter_mut().zip(&self.terms) {
            *term = Term { coefficient: known.coefficient, time: known.time, coordinates: &known.coordinates };
        }
        terms[0].coordinates = coordinates;
        f(&Instant { time: terms[0].time, coordinates, rate: Rate::Formula(&terms[..count]) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_exact_for_their_order() {
        let derivative = |formula: &Formula, f: fn(f64) -> f64| {
            formula.at(&[], |at| match at.rate {
                Rate::Formula(terms) => terms.iter().map(|t| t.coefficient * f(t.time)).sum::<f64>(),
                _ => f64::NAN,
            })
        };
        assert!((derivative(&Formula::first_order(2.0, 0.3), |t| 5.0 * t) - 5.0).abs() < 1e-13);
        let parabola = derivative(&Formula::second_order(2.0, 0.3, 0.5), |t| t * t - t);
        assert!((parabola - 3.0).abs() < 1e-13, "{parabola}");
    }
}
