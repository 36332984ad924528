//! Eigenvalues of small unsymmetric matrices.
//!
//! Elimination reduces the matrix to Hessenberg form H. Then the shifted QR iteration H − s = Q R, H ← R Q + s with
//! Wilkinson's shift s makes the last subdiagonal entry vanish, which separates one eigenvalue after another (Golub and
//! Van Loan, 4th edition, sections 7.4 and 7.5; Wilkinson 1965). The arithmetic is complex, so that one shift at a time
//! suffices.
use num_complex::Complex64;

/// Maximum number of iterations for one eigenvalue; two or three are usual.
const STEPS: usize = 60;
/// Number of iterations after which an unsuccessful shift is replaced by another one.
const STUCK: usize = 10;

/// Square matrix, stored row by row.
struct Matrix {
    n: usize,
    a: Vec<Complex64>,
}

/// The n eigenvalues, in no particular order, of the `n` × `n` matrix stored row by row; `None` if it is not finite.
pub fn eigenvalues(matrix: &[f64], n: usize) -> Option<Vec<Complex64>> {
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let mut h = Matrix { n, a: matrix.iter().map(|x| Complex64::new(*x, 0.0)).collect() };
    h.reduce_to_hessenberg();
    let (mut left, mut steps) = (n, 0);
    while left > 0 {
        let first = h.start_of_block(left - 1);
        if first == left - 1 {
            (left, steps) = (left - 1, 0);
            continue;
        }
        steps += 1;
        if steps > STEPS {
            return None;
        }
        let shift =
            if steps % STUCK == 0 { h.at(left - 1, left - 2) + h.at(left - 1, left - 1) } else { h.shift(left) };
        h.step(first, left, shift);
    }
    Some((0..n).map(|k| h.at(k, k)).collect())
}

impl Matrix {
    fn at(&self, i: usize, j: usize) -> Complex64 {
        self.a[i * self.n + j]
    }

    fn at_mut(&mut self, i: usize, j: usize) -> &mut Complex64 {
        &mut self.a[i * self.n + j]
    }

    /// Reduces the matrix to Hessenberg form by similarity transformations.
    fn reduce_to_hessenberg(&mut self) {
        let n = self.n;
        for k in 1..n.saturating_sub(1) {
            let size = |i: usize| self.at(i, k - 1).norm();
            let pivot = (k + 1..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
            if size(pivot) == 0.0 {
                continue;
            }
            (0..n).for_each(|j| self.a.swap(k * n + j, pivot * n + j));
            (0..n).for_each(|i| self.a.swap(i * n + k, i * n + pivot));
            for i in k + 1..n {
                let factor = self.at(i, k - 1) / self.at(k, k - 1);
                for j in 0..n {
                    let above = self.at(k, j);
                    *self.at_mut(i, j) -= factor * above;
                }
                for r in 0..n {
                    let beside = self.at(r, i);
                    *self.at_mut(r, k) += factor * beside;
                }
            }
        }
    }

    /// First row of the unreduced block that ends in row `last`; sets the subdiagonal entry before it to zero.
    fn start_of_block(&mut self, last: usize) -> usize {
        for k in (1..=last).rev() {
            let size = self.at(k, k).norm() + self.at(k - 1, k - 1).norm();
            if self.at(k, k - 1).norm() <= f64::EPSILON * size {
                *self.at_mut(k, k - 1) = Complex64::ZERO;
                return k;
            }
        }
        0
    }

    /// Eigenvalue of the last 2 × 2 block before `end` that is nearer to its last entry.
    fn shift(&self, end: usize) -> Complex64 {
        let [a, d] = [end - 2, end - 1].map(|k| self.at(k, k));
        let (half, product) = (0.5 * (a - d), self.at(end - 2, end - 1) * self.at(end - 1, end - 2));
        let root = (half * half + product).sqrt();
        let larger = if (half + root).norm() > (half - root).norm() { half + root } else { half - root };
        if larger.norm() > 0.0 { d - product / larger } else { d }
    }

    /// One QR step H − s = Q R, H ← R Q + s for the rows and columns `first..end`.
    fn step(&mut self, first: usize, end: usize, shift: Complex64) {
        (first..end).for_each(|k| *self.at_mut(k, k) -= shift);
        let mut turns = Vec::with_capacity(end - first);
        for k in first..end - 1 {
            let (x, y) = (self.at(k, k), self.at(k + 1, k));
            let size = x.norm().hypot(y.norm());
            let (c, s) = if size > 0.0 { (x / size, y / size) } else { (Complex64::ONE, Complex64::ZERO) };
            for j in k..end {
                let (up, low) = (self.at(k, j), self.at(k + 1, j));
                *self.at_mut(k, j) = c.conj() * up + s.conj() * low;
                *self.at_mut(k + 1, j) = c * low - s * up;
            }
            turns.push([c, s]);
        }
        for (k, [c, s]) in (first..).zip(turns) {
            for i in first..(k + 2).min(end) {
                let (left, right) = (self.at(i, k), self.at(i, k + 1));
                *self.at_mut(i, k) = left * c + right * s;
                *self.at_mut(i, k + 1) = right * c.conj() - left * s.conj();
            }
        }
        (first..end).for_each(|k| *self.at_mut(k, k) += shift);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of the companion matrix of the polynomial with these roots.
    fn companion(roots: &[Complex64]) -> Vec<f64> {
        let n = roots.len();
        let mut c = vec![Complex64::ONE];
        for root in roots {
            c.push(Complex64::ZERO);
            (1..c.len()).rev().for_each(|k| c[k] = c[k] - root * c[k - 1]);
        }
        let entry = |k: usize| match (k / n, k % n) {
            (0, j) => -c[j + 1].re,
            (i, j) => f64::from(u8::from(i == j + 1)),
        };
        (0..n * n).map(entry).collect()
    }

    #[test]
    fn companions_have_the_roots_of_their_polynomials() {
        let pairs = [Complex64::new(0.9, 0.3), Complex64::new(0.85, 0.45), Complex64::new(-0.2, 1.1)];
        let roots: Vec<Complex64> =
            pairs.iter().flat_map(|z| [*z, z.conj()]).chain([Complex64::new(0.99, 0.0)]).collect();
        let found = eigenvalues(&companion(&roots), roots.len()).unwrap();
        for root in roots {
            let near = found.iter().map(|z| (z - root).norm()).fold(f64::INFINITY, f64::min);
            assert!(near < 1e-12, "{root}: {found:?}");
        }
    }

    #[test]
    fn full_matrices_keep_trace_and_symmetric_ones_their_eigenvalues() {
        let n = 12;
        let full: Vec<f64> = (0..n * n).map(|k| ((3 * k * k + 7 * k) as f64).sin()).collect();
        let found = eigenvalues(&full, n).unwrap();
        let trace: f64 = (0..n).map(|k| full[k * n + k]).sum();
        let squares: f64 = (0..n * n).map(|k| full[k] * full[k % n * n + k / n]).sum();
        assert!((found.iter().sum::<Complex64>() - trace).norm() < 1e-12);
        assert!((found.iter().map(|z| z * z).sum::<Complex64>() - squares).norm() < 1e-11);
        let even: Vec<f64> = (0..n * n).map(|k| full[k] + full[k % n * n + k / n]).collect();
        let mut real: Vec<f64> = eigenvalues(&even, n).unwrap().iter().map(|z| z.re).collect();
        real.sort_by(f64::total_cmp);
        let exact = crate::math::symmetric::eigenvalues(&even, n);
        assert!(real.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-12), "{real:?}");
    }

    #[test]
    fn permutations_and_what_is_no_number() {
        // the cyclic permutation, for which unshifted iterations make no progress: the roots of one
        let found = eigenvalues(&[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], 3).unwrap();
        assert!(found.iter().all(|z| (z.powu(3) - 1.0).norm() < 1e-13), "{found:?}");
        assert_eq!(eigenvalues(&[], 0), Some(Vec::new()));
        assert_eq!(eigenvalues(&[f64::NAN], 1), None);
    }
}
