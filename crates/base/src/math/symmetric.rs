//! Dense symmetric matrices, stored row by row: Cholesky factorisation, eigenvalues and eigenvectors.
//!
//! Householder reflections reduce the matrix to tridiagonal form, and QR steps make it diagonal. A x = λ B x with B = G
//! Gᵀ has the eigenvalues of G⁻¹ A G⁻ᵀ (Golub and Van Loan, 4th edition, sections 4.2, 8.3 and 8.7).
use super::reduce::abreast;

/// Maximum number of steps for one eigenvalue; two are usual.
const STEPS: usize = 60;

/// Lower triangle G of A = G Gᵀ; `None` if A is not positive definite.
pub fn cholesky(matrix: &[f64], n: usize) -> Option<Vec<f64>> {
    let mut factor = vec![0.0; n * n];
    for i in 0..n {
        for j in 0..=i {
            let known: f64 = (0..j).map(|k| factor[i * n + k] * factor[j * n + k]).sum();
            let rest = matrix[i * n + j] - known;
            if i == j && !(rest > 0.0 && rest.is_finite()) {
                return None;
            }
            factor[i * n + j] = if i == j { rest.sqrt() } else { rest / factor[j * n + j] };
        }
    }
    Some(factor)
}

/// Eigenvalues of a symmetric matrix in ascending order, with unit eigenvectors.
#[derive(Clone, Debug)]
pub struct Eigen {
    /// Eigenvalues in ascending order.
    pub values: Vec<f64>,
    /// Eigenvector of each eigenvalue.
    pub vectors: Vec<Vec<f64>>,
}

/// Eigenvalues of the symmetric matrix A in ascending order; NaN if A is not finite.
pub fn eigenvalues(matrix: &[f64], n: usize) -> Vec<f64> {
    eigen(matrix, n).map_or_else(|| vec![f64::NAN; n], |found| found.values)
}

/// Eigenvalues and eigenvectors of the symmetric matrix A; `None` if it is not finite.
pub fn eigen(matrix: &[f64], n: usize) -> Option<Eigen> {
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    // rows in descending order of their norm, so that small eigenvalues of a graded matrix remain accurate
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|i, j| matrix[j * n + j].abs().total_cmp(&matrix[i * n + i].abs()));
    let sorted = (0..n * n).map(|k| matrix[order[k / n] * n + order[k % n]]).collect();
    let mut band = Tridiagonal::of(sorted, n);
    band.diagonalise()?;
    let mut pairs: Vec<(f64, Vec<f64>)> = band.diagonal.into_iter().zip(band.rows).collect();
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let back = |(value, sorted): (f64, Vec<f64>)| {
        let mut vector = vec![0.0; n];
        order.iter().zip(sorted).for_each(|(i, x)| vector[*i] = x);
        (value, vector)
    };
    let (values, vectors) = pairs.into_iter().map(back).unzip();
    Some(Eigen { values, vectors })
}

/// Tridiagonal matrix T = Qᵀ A Q, and the rows of Qᵀ.
struct Tridiagonal {
    diagonal: Vec<f64>,
    beside: Vec<f64>,
    rows: Vec<Vec<f64>>,
}

impl Tridiagonal {
    /// Tridiagonalisation by Householder reflections (Golub and Van Loan, 4th edition, algorithm 8.3.1); `a` holds the
    /// rows of A.
    fn of(mut a: Vec<f64>, n: usize) -> Self {
        let mut beside = vec![0.0; n.saturating_sub(1)];
        let mut reflections = Vec::new();
        for k in 0..n.saturating_sub(2) {
            let mut v = a[k * n + k + 1..(k + 1) * n].to_vec();
            let scale = v.iter().fold(0.0f64, |m, x| m.max(x.abs()));
            if v[1..].iter().all(|x| *x == 0.0) {
                beside[k] = v[0];
                continue;
            }
            v.iter_mut().for_each(|x| *x /= scale);
            let length = v.iter().map(|x| x * x).sum::<f64>().sqrt().copysign(v[0]);
            beside[k] = -length * scale;
            v[0] += length;
            let beta = 1.0 / (length * v[0]);
            reflect(&mut a[(k + 1) * n..], (n, k + 1), &v, beta);
            reflections.push((k + 1, beta, v));
        }
        if n > 1 {
            beside[n - 2] = a[(n - 1) * n + n - 2];
        }
        let unit = |k: usize| (0..n).map(|j| if j == k { 1.0 } else { 0.0 }).collect();
        let mut rows: Vec<Vec<f64>> = (0..n).map(unit).collect();
        // row k of Qᵀ is Q e_k, and the last reflections do not change the first rows
        for (from, beta, v) in reflections.iter().rev() {
            for row in &mut rows[*from..] {
                let part = beta * abreast(0..v.len(), &|i| v[i] * row[from + i]);
                row[*from..].iter_mut().zip(v).for_each(|(x, v)| *x -= part * v);
            }
        }
        Self { diagonal: (0..n).map(|k| a[k * n + k]).collect(), beside, rows }
    }

    /// Implicit symmetric QR steps with Wilkinson's shift (Golub and Van Loan, 4th edition, algorithms 8.3.2 and
    /// 8.3.3).
    fn diagonalise(&mut self) -> Option<()> {
        let size = self.diagonal.iter().chain(&self.beside).fold(0.0f64, |m, x| m.max(x.abs()));
        let negligible = (f64::EPSILON * f64::EPSILON * size).powi(2);
        let (mut last, mut steps) = (self.diagonal.len().saturating_sub(1), 0);
        while last > 0 {
            let parts = |k: &usize| {
                let neighbours = self.diagonal[*k - 1].abs() * self.diagonal[*k].abs();
                self.beside[*k - 1].powi(2) <= f64::EPSILON.powi(2) * neighbours + negligible
            };
            let first = (1..=last).rev().find(parts).unwrap_or(0);
            if first == last {
                (last, steps) = (last - 1, 0);
            } else if steps < STEPS {
                self.step(first, last);
                steps += 1;
            } else {
                return None;
            }
        }
        Some(())
    }

    fn step(&mut self, first: usize, last: usize) {
        let Self { diagonal: d, beside: e, rows } = self;
        let (half, off) = (0.5 * (d[last - 1] - d[last]), e[last - 1]);
        let shift = d[last] - off / (half + half.hypot(off).copysign(half)) * off;
        let (mut x, mut z) = (d[first] - shift, e[first]);
        for k in first..last {
            let length = x.hypot(z);
            let (c, s) = if length > 0.0 { (x / length, z / length) } else { (1.0, 0.0) };
            if k > first {
                e[k - 1] = length;
            }
            let t = s * (d[k + 1] - d[k]) + 2.0 * c * e[k];
            d[k] += s * t;
            d[k + 1] -= s * t;
            e[k] = c * t - e[k];
            if k + 1 < last {
                (x, z) = (e[k], s * e[k + 1]);
                e[k + 1] *= c;
            }
            let (above, below) = rows.split_at_mut(k + 1);
            for (x, y) in above[k].iter_mut().zip(&mut below[0]) {
                (*x, *y) = (c * *x + s * *y, c * *y - s * *x);
            }
        }
    }
}

/// Computes A ← H A H with H = 1 − β v vᵀ for the rows and columns of A from `from` on; `rows` begins with that row.
fn reflect(rows: &mut [f64], (n, from): (usize, usize), v: &[f64], beta: f64) {
    let mut w = vec![0.0; v.len()];
    for (row, v) in rows.chunks_exact(n).zip(v) {
        w.iter_mut().zip(&row[from..]).for_each(|(w, a)| *w += beta * v * a);
    }
    let half = 0.5 * beta * abreast(0..v.len(), &|i| v[i] * w[i]);
    w.iter_mut().zip(v).for_each(|(w, v)| *w -= half * v);
    for (i, row) in rows.chunks_exact_mut(n).enumerate() {
        let (a, b) = (v[i], w[i]);
        row[from..].iter_mut().zip(v.iter().zip(&w)).for_each(|(x, (v, w))| *x -= a * w + b * v);
    }
}

/// Eigenvalues λ of A x = λ B x in ascending order, for a positive definite B; empty if it is not.
pub fn generalised_eigenvalues(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let Some(factor) = cholesky(b, n) else { return Vec::new() };
    let half = forward(&factor, a, n);
    let turned: Vec<f64> = (0..n * n).map(|k| half[k % n * n + k / n]).collect();
    let full = forward(&factor, &turned, n);
    // the matrix is symmetric only up to round-off
    let even: Vec<f64> = (0..n * n).map(|k| 0.5 * (full[k] + full[k % n * n + k / n])).collect();
    eigenvalues(&even, n)
}

/// Product G⁻¹ A for the lower triangle G.
fn forward(factor: &[f64], a: &[f64], n: usize) -> Vec<f64> {
    let mut x = a.to_vec();
    for i in 0..n {
        for j in 0..n {
            let known: f64 = (0..i).map(|k| factor[i * n + k] * x[k * n + j]).sum();
            x[i * n + j] = (x[i * n + j] - known) / factor[i * n + i];
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // the chain of n springs: 4 sin²(kπ/(2n + 2))
    fn chains_have_their_frequencies() {
        let n = 7;
        let entry = |k: usize| match (k / n).abs_diff(k % n) {
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        };
        let chain: Vec<f64> = (0..n * n).map(entry).collect();
        let exact: Vec<f64> =
            (1..=n).map(|k| 4.0 * (k as f64 * std::f64::consts::PI / (2 * n + 2) as f64).sin().powi(2)).collect();
        let found = eigenvalues(&chain, n);
        assert!(found.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-13), "{found:?}");
        // with A = B all eigenvalues are one, and B follows from its Cholesky factor
        assert!(generalised_eigenvalues(&chain, &chain, n).iter().all(|x| (x - 1.0).abs() < 1e-13));
        let g = cholesky(&chain, n).unwrap();
        let back = |k: usize| (0..n).map(|j| g[k / n * n + j] * g[k % n * n + j]).sum::<f64>();
        assert!((0..n * n).all(|k| (back(k) - chain[k]).abs() < 1e-14));
    }

    #[test]
    fn vectors_are_orthonormal_and_a_graded_matrix_keeps_its_small_values() {
        let n = 60;
        let entry = |i: usize, j: usize| ((7 * i.min(j) + 3 * i.max(j) * i.max(j)) as f64).sin();
        let full: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let found = eigen(&full, n).unwrap();
        let inner = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        for (value, x) in found.values.iter().zip(&found.vectors) {
            assert!((0..n).all(|i| (inner(&full[i * n..(i + 1) * n], x) - value * x[i]).abs() < 1e-12));
            let product = |y: &Vec<f64>| inner(x, y) - if std::ptr::eq(x, y) { 1.0 } else { 0.0 };
            assert!(found.vectors.iter().all(|y| product(y).abs() < 1e-13));
        }
        assert!(found.values.is_sorted() && eigen(&[f64::NAN], 1).is_none() && eigen(&[], 0).is_some());
        // D C D with D = (1, 1e-5, 1e-10) and C of ones on the diagonal and 0.1 beside it: the least value is what elimination leaves,
        // 1e-20 det C / (1 - 0.01)
        let graded = [1.0, 1e-6, 1e-11, 1e-6, 1e-10, 1e-16, 1e-11, 1e-16, 1e-20];
        let (small, least) = (eigenvalues(&graded, 3), 1e-20 * 0.972 / 0.99);
        assert!((small[0] / least - 1.0).abs() < 1e-9, "{small:?}");
    }

    #[test]
    fn matrices_that_are_not_positive_definite_are_told() {
        assert_eq!(cholesky(&[1.0, 2.0, 2.0, 1.0], 2), None);
        assert_eq!(cholesky(&[f64::NAN], 1), None);
        assert!(generalised_eigenvalues(&[1.0], &[0.0], 1).is_empty());
        let indefinite = eigenvalues(&[1.0, 2.0, 2.0, 1.0], 2);
        assert!((indefinite[0] + 1.0).abs() < 1e-14 && (indefinite[1] - 3.0).abs() < 1e-14);
    }
}
