//! A structure in a stream as a linear state-space system, for control design.
//!
//! Forces that are known as functions of frequency are approximated by rational functions with lags (Roger,
//! AGARD-CP-228, 1977),
//!
//! Q(s) ≈ A₀ + A₁ s + A₂ s² + Σ_l B_l s/(s + β_l), s = λ/u,
//!
//! where A₀ = Q(0) and the other matrices follow by least squares over frequencies for each entry. The lags β_l form a
//! geometric sequence; the best of several sequences is used. At the speed u and the dynamic pressure p (both relative
//! to the reference), the states are q, q' and r_l with r_l' + u β_l r_l = q':
//!
//! (M − p/u² A₂) q'' = −(K − p A₀) q − (C − p/u A₁) q' + p Σ B_l r_l + f.
//!
//! Limits: forces of rapid growth or decay are extrapolated. Far above the fitted frequencies the term with s²
//! dominates.
use num_complex::Complex64;

use super::super::Matrices;
use crate::math::dense::Factors;
use crate::math::singular::Singular;

/// Number of frequencies in the fit.
const SAMPLES: usize = 60;
/// Minimum and maximum number of lags.
const LAGS: [usize; 2] = [2, 8];
/// Trial values of the first and the last lag, relative to the highest frequency.
const FIRST: [f64; 4] = [0.02, 0.05, 0.12, 0.3];
const LAST: [f64; 3] = [0.5, 1.0, 2.0];
/// Misfit relative to the largest modulus of an entry at which no more lags are added.
const ENOUGH: f64 = 1e-3;
/// Singular value relative to the largest below which it counts as zero.
const NULL: f64 = 1e-11;

/// Rational approximation of the aerodynamic forces as functions of s (Roger).
#[derive(Clone, Debug, PartialEq)]
pub struct Roger {
    /// Matrices A₀, A₁ and A₂; row by row.
    pub polynomial: [Vec<f64>; 3],
    /// Lags β_l.
    pub lags: Vec<f64>,
    /// Matrices B_l; row by row.
    pub lagged: Vec<Vec<f64>>,
    /// Largest misfit over the fitted frequencies, relative to the largest modulus of the entry.
    pub misfit: f64,
}

/// State-space system x' = A x + B f, y = C x + D f; matrices row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct StateSpace {
    /// System matrix A, square.
    pub a: Vec<f64>,
    /// Input matrix B, with a column for the force on each coordinate.
    pub b: Vec<f64>,
    /// Output matrix C for the coordinates, followed by their rates.
    pub c: Vec<f64>,
    /// Feedthrough matrix D, which is zero.
    pub d: Vec<f64>,
    /// Number of states.
    pub states: usize,
}

impl Roger {
    /// Fits the values of `forces` at s = iκ for 0 ≤ κ ≤ `highest`; `None` when these are not finite.
    pub fn fit(forces: &dyn Fn(f64) -> Vec<Complex64>, highest: f64) -> Option<Self> {
        // dense at low frequencies, where the lags act
        let kappa = |m: usize| highest * (m as f64 / SAMPLES as f64).powf(1.5);
        let samples: Vec<(f64, Vec<Complex64>)> = (0..=SAMPLES).map(|m| (kappa(m), forces(kappa(m)))).collect();
        let whole = samples.iter().all(|s| s.1.len() == samples[0].1.len() && s.1.iter().all(|f| f.is_finite()));
        if !(whole && highest > 0.0 && highest.is_finite()) {
            return None;
        }
        let mut best = None::<Self>;
        for count in LAGS[0]..=LAGS[1] {
            for (first, last) in FIRST.iter().flat_map(|a| LAST.map(|b| (*a, b))) {
                let part = |l: usize| l as f64 / (count - 1) as f64;
                let lags = (0..count).map(|l| highest * first * (last / first).powf(part(l))).collect();
                let found = Self::with(&samples, lags);
                if best.as_ref().is_none_or(|b| found.misfit < b.misfit) {
                    best = Some(found);
                }
            }
            if best.as_ref().is_some_and(|b| b.misfit <= ENOUGH) {
                break;
            }
        }
        best
    }

    fn with(samples: &[(f64, Vec<Complex64>)], lags: Vec<f64>) -> Self {
        let fitted = &samples[1..];
        let function = |c: usize, kappa: f64| {
            let s = Complex64::new(0.0, kappa);
            match c {
                0 => s,
                1 => s * s,
                _ => s / (s + lags[c - 2]),
            }
        };
        let parts = |all: &mut dyn Iterator<Item = Complex64>| all.flat_map(|z| [z.re, z.im]).collect::<Vec<f64>>();
        let column = |c: usize| {
            let column = parts(&mut fitted.iter().map(|(k, _)| function(c, *k)));
            let size = column.iter().map(|x| x * x).sum::<f64>().sqrt();
            (column.into_iter().map(|x| x / size).collect::<Vec<f64>>(), size)
        };
        let (columns, sizes): (Vec<_>, Vec<f64>) = (0..2 + lags.len()).map(column).unzip();
        let singular = Singular::of(columns);
        let squares = singular.squares();
        let least = NULL * NULL * squares.iter().fold(0.0, |a: f64, b| a.max(*b));
        let entries = samples[0].1.len();
        let (mut found, mut misfit) = (vec![vec![0.0; entries]; sizes.len()], 0.0f64);
        for e in 0..entries {
            let still = samples[0].1[e].re;
            let right = parts(&mut fitted.iter().map(|(_, f)| f[e] - still));
            for (k, square) in squares.iter().enumerate().filter(|(_, s)| **s > least) {
                let share = singular.left[k].iter().zip(&right).map(|(a, b)| a * b).sum::<f64>() / square;
                found.iter_mut().zip(&singular.right[k]).for_each(|(f, v)| f[e] += share * v);
            }
            found.iter_mut().zip(&sizes).for_each(|(f, size)| f[e] /= size);
            let largest = samples.iter().map(|s| s.1[e].norm()).fold(f64::MIN_POSITIVE, f64::max);
            let value = |k: f64| (0..sizes.len()).map(|c| found[c][e] * function(c, k)).sum::<Complex64>() + still;
            misfit = fitted.iter().map(|(k, f)| (value(*k) - f[e]).norm() / largest).fold(misfit, f64::max);
        }
        let lagged = found.split_off(2);
        let still = samples[0].1.iter().map(|f| f.re).collect();
        let [first, second] = [0, 1].map(|c| std::mem::take(&mut found[c]));
        Self { polynomial: [still, first, second], lags, lagged, misfit }
    }

    /// The state-space system at the given speed and dynamic pressure, both relative to the reference, in the time of
    /// the reference; `None` where the mass matrix, which includes aerodynamic terms, is singular.
    pub fn system(&self, structure: &Matrices, speed: f64, pressure: f64) -> Option<StateSpace> {
        let n = structure.mass.len().isqrt();
        let states = n * (2 + self.lags.len());
        let [still, first, second] = &self.polynomial;
        let less = |a: &[f64], b: &[f64], part: f64| a.iter().zip(b).map(|(a, b)| a - part * b).collect::<Vec<f64>>();
        let mass = Factors::new(n, less(&structure.mass, second, pressure / (speed * speed)))?;
        let stiffness = less(&structure.stiffness, still, pressure);
        let damping = less(&structure.damping, first, pressure / speed);
        // contribution of each state to M q''
        let push = |i: usize, state: usize| {
            let e = i * n + state % n;
            match state / n {
                0 => -stiffness[e],
                1 => -damping[e],
                l => pressure * self.lagged[l - 2][e],
            }
        };
        let unit = |k: usize| (0..n).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
        let solved = |right: &[f64]| {
            let mut x = vec![0.0; n];
            mass.solve(right, &mut x);
            x
        };
        let (mut a, mut b, mut c) = (vec![0.0; states * states], vec![0.0; states * n], vec![0.0; 2 * n * states]);
        for state in 0..states {
            let column = solved(&(0..n).map(|i| push(i, state)).collect::<Vec<f64>>());
            (0..n).for_each(|i| a[(n + i) * states + state] = column[i]);
        }
        for k in 0..n {
            a[k * states + n + k] = 1.0;
            for (l, lag) in self.lags.iter().enumerate() {
                let row = (2 + l) * n + k;
                a[row * states + n + k] = 1.0;
                a[row * states + row] = -speed * lag;
            }
            let column = solved(&unit(k));
            (0..n).for_each(|i| b[(n + i) * n + k] = column[i]);
        }
        (0..2 * n).for_each(|k| c[k * states + k] = 1.0);
        Some(StateSpace { a, b, c, d: vec![0.0; 2 * n * n], states })
    }
}

impl StateSpace {
    /// The system in other units: the unit of time becomes `1/rate` of the present one, which also scales the rates of
    /// the `n` coordinates, and the unit of force is divided by `force`.
    pub fn in_units(mut self, n: usize, rate: f64, force: f64) -> Self {
        let scale = |state: usize| if (n..2 * n).contains(&state) { rate } else { 1.0 };
        for (k, a) in self.a.iter_mut().enumerate() {
            *a *= rate * scale(k / self.states) / scale(k % self.states);
        }
        for (k, b) in self.b.iter_mut().enumerate() {
            *b *= rate * scale(k / n) / force;
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::eigenvalues::eigenvalues;
    use crate::structure::flutter::{Flutter, Kind};

    #[test]
    fn the_system_has_the_motions_of_the_p_k_method() {
        let unit = |a: f64, d: f64| vec![a, 0.0, 0.0, d];
        let m = Matrices { mass: unit(1.0, 1.0), damping: unit(0.02, 0.01), stiffness: unit(1.0, 4.0) };
        let forces = |kappa: f64| {
            // the square root is in no way rational
            let lag = 1.0 / (1.0 + Complex64::new(0.0, kappa).sqrt());
            let entry = |a: f64| a * (0.5 + 0.5 * lag) - Complex64::new(0.0, 0.02 * kappa);
            vec![entry(0.0), entry(0.6), entry(-0.5), entry(0.1)]
        };
        let flutter = Flutter::new(&m, &forces);
        let branches = flutter.branches(4.0);
        let found = flutter.crossings(&branches, 4.0);
        let first = found.iter().find(|c| c.kind == Kind::Flutter).unwrap();
        let roger = Roger::fit(&forces, 2.0).unwrap();
        // at rest the root is steeper than any lag
        assert!(roger.misfit < 0.03, "{roger:?}");
        for part in [0.97, 1.0, 1.03] {
            let x = part * first.x;
            let system = roger.system(&m, x, x * x).unwrap();
            let values = eigenvalues(&system.a, system.states).unwrap();
            let near = branches[first.mode].iter().min_by(|a, b| (a.x - x).abs().total_cmp(&(b.x - x).abs())).unwrap();
            let nearest = values.iter().map(|z| (z - near.lambda).norm()).fold(f64::INFINITY, f64::min);
            assert!(nearest < 0.01 * near.lambda.norm(), "{part}: {nearest:e} of {near:?}");
        }
        // other units: rates grow, shapes stay
        let system = roger.system(&m, 1.0, 1.0).unwrap();
        let faster = system.clone().in_units(2, 10.0, 3.0);
        let largest = |s: &StateSpace| eigenvalues(&s.a, s.states).unwrap().iter().map(|z| z.im).fold(0.0, f64::max);
        assert!((largest(&faster) / largest(&system) - 10.0).abs() < 1e-9);
        assert!((faster.b[4] / system.b[4] - 100.0 / 3.0).abs() < 1e-9);
    }

    #[test]
    fn forces_with_lags_are_found_as_they_are() {
        let forces = |kappa: f64| {
            let s = Complex64::new(0.0, kappa);
            vec![0.3 - 0.2 * s + 0.05 * s * s + 0.4 * s / (s + 0.1)]
        };
        // the first and last lag of two are 0.05 or 0.12 and 0.5 of the highest frequency
        let roger = Roger::fit(&forces, 2.0).unwrap();
        assert!(roger.misfit < 1e-3 && (roger.polynomial[0][0] - 0.3).abs() < 1e-15, "{roger:?}");
        assert!(Roger::fit(&|_| vec![f64::NAN.into()], 1.0).is_none());
    }
}
