//! The g-method: a check of the p-k method that does not follow branches.
//!
//! The forces of a growing motion are those of the harmonic motion with a first-order correction, Q(γ + iκ) ≈ Q(iκ) + γ
//! Q'(iκ), where Q' = −i dQ/dκ (Chen, AIAA Journal 38, 2000, doi:10.2514/2.1171). In modal coordinates, at the speed u
//! and the dynamic pressure p, motions with the rate λ = u (γ + iκ) satisfy
//!
//! [γ² u² + γ (2iκ u² + u C − p Q') − κ² u² + iκ u C + K − p Q(iκ)] v = 0,
//!
//! a quadratic eigenvalue problem for γ at each κ; a solution is a motion when its γ is real. Both methods agree at a
//! point of neutral stability in theory, so that a difference shows errors of interpolation and branch following.
use num_complex::Complex64;

use super::{Crossing, Flutter, Kind, Modes, ZERO, least};
use crate::math::eigenvalues::eigenvalues;

/// Fraction of κ over which forces are differentiated.
const BESIDE: f64 = 1e-4;
/// Relative distance in x from a flutter point within which the neutral motion is searched.
const WITHIN: f64 = 0.02;
/// Greatest number of secant steps for κ and for x.
const SECANT: usize = 60;
/// Relative change of κ or x at which the iteration ends.
const ENOUGH: f64 = 1e-12;

impl Flutter<'_> {
    /// x at which the motion of a flutter point is neutral by the g-method; `None` for divergence, and where no such
    /// motion is found within two per cent.
    pub fn damping_perturbation(&self, crossing: &Crossing) -> Option<f64> {
        let modes = self.modes.as_ref().filter(|_| crossing.kind != Kind::Divergence)?;
        let growth = |x: f64| self.growth(modes, x, crossing.kappa);
        let mut ends = [1.0 - WITHIN, 1.0 + WITHIN].map(|part| part * crossing.x);
        let mut sizes = [growth(ends[0])?, growth(ends[1])?];
        if sizes[0] * sizes[1] > 0.0 {
            return None;
        }
        for _ in 0..SECANT {
            let x = (ends[0] * sizes[1] - ends[1] * sizes[0]) / (sizes[1] - sizes[0]);
            let size = growth(x)?;
            let side = usize::from(size * sizes[0] <= 0.0);
            let moved = (x - ends[side]).abs();
            (ends[side], sizes[side]) = (x, size);
            // the value at the other end is halved, so that this end moves too (Illinois method)
            sizes[1 - side] *= 0.5;
            if size == 0.0 || moved <= ENOUGH * x {
                return Some(x);
            }
        }
        None
    }

    /// Growth γ of the motion near κ.
    fn growth(&self, modes: &Modes, x: f64, near: f64) -> Option<f64> {
        let (mut kappa, mut gamma) = (near, ZERO);
        let mut before = None::<[f64; 2]>;
        for _ in 0..SECANT {
            gamma = self.nearest(modes, x, kappa, gamma.re)?;
            if gamma.im.abs() <= ENOUGH * kappa {
                return Some(gamma.re);
            }
            let step = before.map(|[k, im]| -gamma.im * (kappa - k) / (gamma.im - im));
            before = Some([kappa, gamma.im]);
            // κ + Im γ is the frequency of this motion
            kappa += step.filter(|s| s.abs() < 0.5 * kappa).unwrap_or(gamma.im);
            if !(kappa > 0.0) {
                return None;
            }
        }
        None
    }

    /// The eigenvalue γ at κ that is nearest to the real number `to`.
    fn nearest(&self, modes: &Modes, x: f64, kappa: f64, to: f64) -> Option<Complex64> {
        let (n, speed, pressure) = (modes.n, self.speed(x), self.pressure(x));
        let step = BESIDE * kappa;
        let [below, at, above] = [kappa - step, kappa, kappa + step].map(|k| self.modal(modes, k));
        let (below, at, above) = (below?, at?, above?);
        let i = Complex64::i();
        let size = 2 * n;
        let mut matrix = vec![ZERO; size * size];
        for e in 0..n * n {
            let (row, column) = (e / n, e % n);
            let unit = f64::from(u8::from(row == column));
            let slope = (above[e] - below[e]) / (2.0 * i * step);
            let damping = modes.damping[e] / speed;
            let forces = pressure / (speed * speed);
            let still = i * kappa * damping - kappa * kappa * unit + modes.stiffness[e] / (speed * speed);
            matrix[(n + row) * size + column] = forces * at[e] - still;
            matrix[(n + row) * size + n + column] = forces * slope - 2.0 * i * kappa * unit - damping;
            matrix[row * size + n + column] = unit.into();
        }
        let found = spectrum(&matrix, size)?;
        let place = least(found.iter().map(|z| (z - to).norm()));
        found.get(place).copied()
    }
}

/// Eigenvalues of a complex matrix, from the real matrix of its parts, which also has their conjugates.
fn spectrum(matrix: &[Complex64], n: usize) -> Option<Vec<Complex64>> {
    let size = 2 * n;
    let entry = |k: usize| {
        let (row, column) = (k / size, k % size);
        let z = matrix[row % n * n + column % n];
        match (row < n, column < n) {
            (true, false) => -z.im,
            (false, true) => z.im,
            _ => z.re,
        }
    };
    let real: Vec<f64> = (0..size * size).map(entry).collect();
    let own = |z: &Complex64| z.im == 0.0 || singular(matrix, n, *z) <= singular(matrix, n, z.conj());
    Some(eigenvalues(&real, size)?.into_iter().filter(own).collect())
}

/// The magnitude |det(A − z)|.
fn singular(matrix: &[Complex64], n: usize, z: Complex64) -> f64 {
    let mut a = matrix.to_vec();
    (0..n).for_each(|k| a[k * n + k] -= z);
    let mut product = 1.0;
    for k in 0..n {
        let pivot = k + least((k..n).map(|i| -a[i * n + k].norm()));
        (0..n).for_each(|j| a.swap(k * n + j, pivot * n + j));
        let diagonal = a[k * n + k];
        product *= diagonal.norm();
        if product == 0.0 {
            return 0.0;
        }
        for i in k + 1..n {
            let factor = a[i * n + k] / diagonal;
            (k..n).for_each(|j| {
                let above = a[k * n + j];
                a[i * n + j] -= factor * above;
            });
        }
    }
    product
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::structure::Matrices;

    #[test]
    fn complex_matrices_have_their_eigenvalues() {
        let i = Complex64::i();
        // triangular: 1 + i, 2 − 3i
        let found = spectrum(&[1.0 + i, 0.5 * i, ZERO, 2.0 - 3.0 * i], 2).unwrap();
        for z in [1.0 + i, 2.0 - 3.0 * i] {
            assert!(found.iter().any(|f| (f - z).norm() < 1e-12), "{found:?}");
        }
        assert_eq!(found.len(), 2);
    }

    #[test]
    fn both_methods_agree_where_motions_are_neutral() {
        let unit = |a: f64, d: f64| vec![a, 0.0, 0.0, d];
        let m = Matrices { mass: unit(1.0, 1.0), damping: unit(0.02, 0.01), stiffness: unit(1.0, 4.0) };
        let forces = |kappa: f64| {
            let lag = Complex64::new(0.0, kappa) / Complex64::new(0.3, kappa);
            let entry = |a: f64| a * (1.0 - 0.5 * lag) - Complex64::new(0.0, 0.02 * kappa);
            vec![entry(0.0), entry(0.6), entry(-0.5), entry(0.1)]
        };
        let flutter = Flutter::new(&m, &forces);
        let found = flutter.crossings(&flutter.branches(4.0), 4.0);
        let first = found.iter().find(|c| c.kind == Kind::Flutter).unwrap();
        let other = flutter.damping_perturbation(first).unwrap();
        assert!((other / first.x - 1.0).abs() < 1e-9, "{} {}", other, first.x);
        // beside it p-k and g-method differ: a wrong crossing is not confirmed
        let wrong = Crossing { x: 1.1 * first.x, ..first.clone() };
        assert!(flutter.damping_perturbation(&wrong).is_none());
    }
}
