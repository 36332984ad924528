//! A structure in modal coordinates: ΦᵀMΦ = 1, ΦᵀKΦ = diag ω², and roots of its equations by Newton's method.
use num_complex::Complex64;

use super::super::Matrices;
use super::{NEWTON, Place, Point, Root, ZERO, inner, least};
use crate::math::singular::Singular;
use crate::math::symmetric;

/// Change of root and shape at which the Newton iteration ends, and the change that is acceptable when it stagnates.
const CONVERGED: [f64; 2] = [1e-14, 1e-8];
/// Squared natural frequencies nearer than the first value (relative) are separated by the second until forces act.
const CLOSE: [f64; 2] = [1e-3, 1e-2];

/// Matrices in modal coordinates, in which the mass matrix is the identity; row by row.
#[derive(Clone)]
pub(super) struct Modes {
    pub(super) n: usize,
    /// Squared natural frequencies, ascending.
    pub(super) squares: Vec<f64>,
    /// Modal matrix Φ, and Φ⁻¹ = ΦᵀM.
    pub(super) basis: Vec<f64>,
    pub(super) inverse: Vec<f64>,
    pub(super) damping: Vec<Complex64>,
    pub(super) stiffness: Vec<Complex64>,
    /// Artificial separation of close squared frequencies.
    pub(super) apart: Vec<f64>,
}

impl Modes {
    pub(super) fn new(matrices: &Matrices) -> Option<Self> {
        let n = matrices.mass.len().isqrt();
        let square = |a: &[f64]| a.len() == n * n && a.iter().all(|x| x.is_finite());
        if n == 0 || ![&matrices.mass, &matrices.damping, &matrices.stiffness].into_iter().all(|a| square(a)) {
            return None;
        }
        let inverse = inverse_factor(&symmetric::cholesky(&matrices.mass, n)?, n);
        // G⁻¹ K G⁻ᵀ of the symmetric part of K
        let k = |i: usize, j: usize| 0.5 * (matrices.stiffness[i * n + j] + matrices.stiffness[j * n + i]);
        let half: Vec<f64> = (0..n * n).map(|e| (0..n).map(|l| inverse[e / n * n + l] * k(l, e % n)).sum()).collect();
        let entry = |i: usize, j: usize| (0..n).map(|l| half[i * n + l] * inverse[j * n + l]).sum::<f64>();
        let columns: Vec<Vec<f64>> =
            (0..n).map(|j| (0..n).map(|i| 0.5 * (entry(i, j) + entry(j, i))).collect()).collect();
        let found = Singular::of(columns);
        // A v = λ v, so that the left vectors are the right ones multiplied by λ
        let quotient = |(left, right): (&Vec<f64>, &Vec<f64>)| left.iter().zip(right).map(|(l, r)| l * r).sum::<f64>();
        let mut order: Vec<(f64, &Vec<f64>)> =
            found.left.iter().zip(&found.right).map(|pair| (quotient(pair), pair.1)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0));
        let squares: Vec<f64> = order.iter().map(|mode| mode.0).collect();
        let mut basis = vec![0.0; n * n];
        for (m, (_, v)) in order.iter().enumerate() {
            (0..n).for_each(|i| basis[i * n + m] = (0..n).map(|l| inverse[l * n + i] * v[l]).sum());
        }
        let back = |e: usize| (0..n).map(|l| basis[l * n + e / n] * matrices.mass[l * n + e % n]).sum();
        let inverse = (0..n * n).map(back).collect();
        let apart = set_apart(&squares);
        let mut modes = Self { n, squares, basis, inverse, damping: Vec::new(), stiffness: Vec::new(), apart };
        let complex = |a: &[f64]| a.iter().map(|x| Complex64::from(*x)).collect::<Vec<_>>();
        modes.damping = modes.project(&complex(&matrices.damping));
        modes.stiffness = modes.project(&complex(&matrices.stiffness));
        Some(modes)
    }

    /// The modal matrix Φᵀ A Φ.
    pub(super) fn project(&self, a: &[Complex64]) -> Vec<Complex64> {
        let n = self.n;
        let half = |e: usize| (0..n).map(|l| a[e / n * n + l] * self.basis[l * n + e % n]).sum::<Complex64>();
        let half: Vec<Complex64> = (0..n * n).map(half).collect();
        (0..n * n).map(|e| (0..n).map(|l| half[l * n + e % n] * self.basis[l * n + e / n]).sum()).collect()
    }

    /// Coordinates Φ q of a modal shape.
    pub(super) fn coordinates(&self, shape: &[Complex64]) -> Vec<Complex64> {
        self.basis.chunks_exact(self.n).map(|row| row.iter().zip(shape).map(|(b, q)| q * *b).sum()).collect()
    }

    /// Point `k` of a branch as a root; its derivative is the difference quotient to the previous point.
    pub(super) fn root(&self, branch: &[Point], k: usize) -> Option<Root> {
        let point = branch.get(k).filter(|point| point.shape.len() == self.n)?;
        let modal: Vec<Complex64> = self
            .inverse
            .chunks_exact(self.n)
            .map(|row| row.iter().zip(&point.shape).map(|(b, q)| q * *b).sum())
            .collect();
        let size = inner(&modal, &modal).re.sqrt();
        let shape = modal.into_iter().map(|q| q / size).collect();
        let before = k.checked_sub(1).map(|k| &branch[k]);
        let rate = before.map_or(ZERO, |b| (point.lambda - b.lambda) / (point.x - b.x));
        Some(Root { place: Place { x: point.x, on: 1.0 }, lambda: point.lambda, shape, rate })
    }

    /// Root and shape of λ² + `on` C λ + A by Newton's method from a guess; the shape has the product 1 with `near`.
    pub(super) fn newton(
        &self,
        a: &[Complex64],
        on: f64,
        (mut lambda, mut shape): (Complex64, Vec<Complex64>),
        near: &[Complex64],
    ) -> Option<(Complex64, Vec<Complex64>)> {
        let (n, width) = (self.n, self.n + 1);
        let mut last = f64::INFINITY;
        for _ in 0..NEWTON {
            let (mut matrix, mut right) = (vec![ZERO; width * width], vec![ZERO; width]);
            for i in 0..n {
                let row = &mut matrix[i * width..][..width];
                row[n] = 2.0 * lambda * shape[i];
                for j in 0..n {
                    let damping = self.damping[i * n + j] * on;
                    let diagonal = if i == j { lambda * lambda + (1.0 - on) * self.apart[i] } else { ZERO };
                    row[j] = a[i * n + j] + damping * lambda + diagonal;
                    row[n] += damping * shape[j];
                    right[i] -= row[j] * shape[j];
                }
            }
            near.iter().enumerate().for_each(|(j, q)| matrix[n * width + j] = q.conj());
            right[n] = 1.0 - inner(near, &shape);
            solve(&mut matrix, &mut right)?;
            lambda += right[n];
            shape.iter_mut().zip(&right).for_each(|(q, dq)| *q += dq);
            let turned = inner(&right[..n], &right[..n]).re.sqrt();
            let change = turned.max(right[n].norm() / lambda.norm());
            if change <= CONVERGED[0] || (change <= CONVERGED[1] && change >= last) {
                return Some((lambda, shape));
            }
            last = change;
        }
        None
    }
}

/// Inverse G⁻¹ of the lower triangular matrix G.
fn inverse_factor(factor: &[f64], n: usize) -> Vec<f64> {
    let mut x = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (j..i).map(|k| factor[i * n + k] * x[k * n + j]).sum();
            x[i * n + j] = (if i == j { 1.0 } else { 0.0 } - known) / factor[i * n + i];
        }
    }
    x
}

/// Values to be added to close squared frequencies in order to separate them.
fn set_apart(squares: &[f64]) -> Vec<f64> {
    let mut last = f64::NEG_INFINITY;
    let apart = squares.iter().map(|square| {
        let close = *square > 0.0 && *square < last * (1.0 + CLOSE[0]);
        last = if close { last * (1.0 + CLOSE[1]) } else { *square };
        last - square
    });
    apart.collect()
}

/// Solves A x = b in place by elimination with partial pivoting; `None` when A is singular.
fn solve(matrix: &mut [Complex64], right: &mut [Complex64]) -> Option<()> {
    let n = right.len();
    for k in 0..n {
        let pivot = k + least((k..n).map(|i| -matrix[i * n + k].norm()));
        (0..n).for_each(|j| matrix.swap(k * n + j, pivot * n + j));
        right.swap(k, pivot);
        let diagonal = matrix[k * n + k];
        if !(diagonal.norm() > 0.0 && diagonal.is_finite()) {
            return None;
        }
        let (above, below) = matrix.split_at_mut((k + 1) * n);
        let row = &above[k * n..];
        let value = right[k];
        for (other, rest) in below.chunks_exact_mut(n).zip(&mut right[k + 1..]) {
            let factor = other[k] / diagonal;
            other[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(a, b)| *a -= factor * b);
            *rest -= factor * value;
        }
    }
    for k in (0..n).rev() {
        let known: Complex64 = (k + 1..n).map(|j| matrix[k * n + j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k * n + k];
    }
    Some(())
}
