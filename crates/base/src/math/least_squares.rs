//! Small weighted least-squares problems.
//!
//! A fit determines coefficients c that minimise Σ_k w_k (b_k·c − f_k)², where row b_k holds the basis functions at
//! particle k, relative to the centre of the cloud and scaled by its size (eqs (10), (14), (15) of the paper and the
//! paragraph below them). Usually the result is not c but a row of *weights* that gives one coefficient from the data,
//! c_m = Σ_k r_mk f_k; the weights depend on geometry only.
//!
//! The normal equations are solved first (Cholesky). If they are ill-conditioned, the rows are factored (QR); if the
//! rows are rank deficient too, the pseudo-inverse is used (SVD by one-sided Jacobi rotations, Demmel 1997 §5.4.3).
use super::Vector;
use super::singular::Singular;
use super::square::cofactor;

/// Condition number of the scaled normal matrix above which Cholesky is not used; it is the square of that of the rows.
const CHOLESKY_CONDITION: f64 = 1e8;
/// Ratio of the off-diagonal elements to the trace at which Jacobi rotations end. They converge quadratically, so that
/// the eigenvalues are then exact to round-off.
const EIGEN_TOLERANCE: f64 = 1e-9;
/// Ratio of smallest to largest diagonal element of R below which the rows are regarded as rank deficient.
const RANK_TOLERANCE: f64 = 1e-10;

/// Factorisation that a fit used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Cholesky factorisation of the normal equations.
    Cholesky,
    /// Orthogonal factorisation of the rows.
    Qr,
    /// Pseudo-inverse: the data do not determine every coefficient.
    Svd,
}

/// Weights w_ij of the derivative ∇f_i = Σ_j w_ij (f_j − f_i) [1/length] by a linear fit with weights 1/|d|², and the
/// condition number of the scaled normal matrix of order 2 or 3.
///
/// The fit is fixed to the value at the centre; only the gradient is free. It is exact for linear fields. `None` if the
/// cloud does not determine a gradient (all particles on one line or plane).
#[doc(alias = "eq10")]
pub fn gradient_weights<const D: usize>(offsets: &[Vector<D>], out: &mut Vec<Vector<D>>) -> Option<f64> {
    out.clear();
    let (inverse, condition) = normal_inverse(&normal_matrix(offsets.iter().copied()).0)?;
    out.extend(offsets.iter().map(|d| gradient_weight(&inverse, d)));
    Some(condition)
}

/// Inverse normal matrix, from which [`gradient_weight`] computes every weight of a row, and its condition number;
/// `None` if the matrix does not determine a gradient.
#[inline]
pub fn normal_inverse<const D: usize>(m: &[[f64; D]; D]) -> Option<([[f64; D]; D], f64)> {
    let condition = condition_symmetric(m);
    if !(condition < 1.0 / RANK_TOLERANCE) {
        return None;
    }
    Some((invert_symmetric(m)?, condition))
}

/// Weight of the neighbour at offset `d` in a row with the given inverse normal matrix.
#[inline]
pub fn gradient_weight<const D: usize>(inverse: &[[f64; D]; D], d: &Vector<D>) -> Vector<D> {
    let w = 1.0 / d.norm_squared();
    Vector::from_fn(|r| w * (0..D).map(|c| inverse[r][c] * d[c]).sum::<f64>())
}

/// Fraction of the trace that a bounded fit adds to the diagonal of the normal matrix.
const BOUND: f64 = 0.05;

/// Inverse normal matrix for `n` neighbours, as [`normal_inverse`], but with bounded weights for any offsets: the
/// gradient tends to zero in directions without neighbours. It is exact for constant fields, but not for linear ones.
pub fn bounded_inverse<const D: usize>(m: &[[f64; D]; D], n: usize) -> [[f64; D]; D] {
    let mut m = *m;
    (0..D).for_each(|r| m[r][r] += BOUND * n as f64);
    invert_symmetric(&m).unwrap_or([[0.0; D]; D])
}

/// Normal matrix Σ d dᵀ/|d|² and the number of offsets.
pub fn normal_matrix<const D: usize>(offsets: impl Iterator<Item = Vector<D>>) -> ([[f64; D]; D], usize) {
    let (mut m, mut n) = ([[0.0; D]; D], 0);
    for d in offsets {
        let w = 1.0 / d.norm_squared();
        for r in 0..D {
            for c in 0..D {
                m[r][c] += w * d[r] * d[c];
            }
        }
        n += 1;
    }
    (m, n)
}

/// Inverse of a symmetric positive definite matrix of order 1, 2 or 3 by cofactors.
fn invert_symmetric<const D: usize>(m: &[[f64; D]; D]) -> Option<[[f64; D]; D]> {
    let mut inverse = [[0.0; D]; D];
    let det = match D {
        1 => m[0][0],
        2 => m[0][0] * m[1][1] - m[0][1] * m[1][0],
        _ => {
            m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
                + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0])
        }
    };
    if !(det.abs() > 0.0) {
        return None;
    }
    for r in 0..D {
        for c in 0..D {
            inverse[c][r] = cofactor::<D>(|i, j| m[i][j], r, c) / det;
        }
    }
    Some(inverse)
}

/// Condition number (ratio of extreme eigenvalues) of a small symmetric positive definite matrix; infinite if it is
/// singular.
#[inline]
pub fn condition_symmetric<const D: usize>(m: &[[f64; D]; D]) -> f64 {
    if D == 2 {
        return condition_of_two([m[0][0], m[0][1], m[1][1]]);
    }
    let values = eigenvalues_symmetric(m);
    let (low, high) = values.iter().fold((f64::INFINITY, 0.0f64), |(l, h), v| (l.min(*v), h.max(*v)));
    if low > 0.0 { high / low } else { f64::INFINITY }
}

/// Condition number of [a b; b c]: the larger eigenvalue λ follows from the trace, the smaller one is the determinant
/// divided by λ.
fn condition_of_two([a, b, c]: [f64; 3]) -> f64 {
    let high = 0.5 * (a + c) + (0.25 * (a - c) * (a - c) + b * b).sqrt();
    let determinant = a * c - b * b;
    if high > 0.0 && determinant > 0.0 { high * high / determinant } else { f64::INFINITY }
}

/// Smallest eigenvalue of a small symmetric matrix.
pub fn smallest_eigenvalue<const D: usize>(m: &[[f64; D]; D]) -> f64 {
    eigenvalues_symmetric(m).into_iter().fold(f64::INFINITY, f64::min)
}

/// Eigenvalues of a small symmetric matrix by cyclic Jacobi rotations.
fn eigenvalues_symmetric<const D: usize>(m: &[[f64; D]; D]) -> [f64; D] {
    let mut a = *m;
    let size: f64 = (0..D).map(|d| m[d][d].abs()).sum();
    for _ in 0..12 {
        let mut off = 0.0;
        for p in 0..D {
            for q in p + 1..D {
                off += a[p][q] * a[p][q];
                rotate_symmetric(&mut a, p, q);
            }
        }
        if off <= (EIGEN_TOLERANCE * size).powi(2) {
            break;
        }
    }
    std::array::from_fn(|d| a[d][d])
}

fn rotate_symmetric<const D: usize>(a: &mut [[f64; D]; D], p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
    let c = 1.0 / (t * t + 1.0).sqrt();
    let s = t * c;
    for k in 0..D {
        let (x, y) = (a[k][p], a[k][q]);
        a[k][p] = c * x - s * y;
        a[k][q] = s * x + c * y;
    }
    for k in 0..D {
        let (x, y) = (a[p][k], a[q][k]);
        a[p][k] = c * x - s * y;
        a[q][k] = s * x + c * y;
    }
}

/// A fit with `n` coefficients to rows that are added one by one: f = c_0 b_0(x) + … + c_n b_n(x), eq. (11) for the
/// basis 1, x, y, z.
#[doc(alias = "eq11")]
#[derive(Clone, Debug, Default)]
pub struct Fit {
    n: usize,
    rows: Vec<f64>,
    weights: Vec<f64>,
}

impl Fit {
    /// Empties the fit and sets its number of coefficients to `n`; the storage is reused.
    pub fn reset(&mut self, n: usize) {
        self.n = n;
        self.rows.clear();
        self.weights.clear();
    }

    /// Adds the row b·c = f with weight w: a value (Dirichlet) row if b holds the basis functions, a gradient (Neumann)
    /// row `a·n = g` if b holds their normal derivatives.
    #[doc(alias = "eq13")]
    #[doc(alias = "eq14")]
    pub fn push(&mut self, basis: &[f64], weight: f64) {
        debug_assert_eq!(basis.len(), self.n);
        self.rows.extend_from_slice(basis);
        self.weights.push(weight);
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.weights.len()
    }

    /// True if no row has been added.
    pub fn is_empty(&self) -> bool {
        self.weights.is_empty()
    }

    /// Weights r_k with c_m = Σ_k r_k f_k for coefficient `m`, and the factorisation that was used.
    #[doc(alias = "eq15")]
    pub fn row_of_inverse(&self, m: usize, out: &mut Vec<f64>) -> Method {
        let scale = self.column_scales();
        if let Some(x) = self.solve_normal(m, &scale) {
            self.apply(&x, out);
            return Method::Cholesky;
        }
        let a = self.scaled_rows(&scale);
        if let Some(row) = qr_row(&a, self.len(), self.n, m) {
            self.finish(&row, scale[m], out);
            return Method::Qr;
        }
        let row = svd_row(&a, self.len(), self.n, m);
        self.finish(&row, scale[m], out);
        Method::Svd
    }

    /// Column scales that normalise the columns of the weighted rows.
    fn column_scales(&self) -> Vec<f64> {
        (0..self.n)
            .map(|c| {
                let s: f64 = (0..self.len()).map(|k| self.weights[k] * self.rows[k * self.n + c].powi(2)).sum();
                if s > 0.0 { 1.0 / s.sqrt() } else { 1.0 }
            })
            .collect()
    }

    /// Solves (BᵀWB) x = e_m with unit columns; `None` if the matrix is not safely positive definite.
    fn solve_normal(&self, m: usize, scale: &[f64]) -> Option<Vec<f64>> {
        let n = self.n;
        let mut a = vec![0.0; n * n];
        for (k, w) in self.weights.iter().enumerate() {
            let b = &self.rows[k * n..(k + 1) * n];
            for r in 0..n {
                for c in 0..=r {
                    a[r * n + c] += w * b[r] * b[c] * scale[r] * scale[c];
                }
            }
        }
        cholesky(&mut a, n)?;
        let mut x = vec![0.0; n];
        x[m] = scale[m];
        cholesky_solve(&a, n, &mut x);
        x.iter_mut().zip(scale).for_each(|(x, s)| *x *= s);
        Some(x)
    }

    fn apply(&self, x: &[f64], out: &mut Vec<f64>) {
        out.clear();
        out.extend(self.weights.iter().enumerate().map(|(k, w)| {
            let b = &self.rows[k * self.n..(k + 1) * self.n];
            w * b.iter().zip(x).map(|(b, x)| b * x).sum::<f64>()
        }));
    }

    /// Rows √w b with scaled columns, stored row by row.
    fn scaled_rows(&self, scale: &[f64]) -> Vec<f64> {
        let n = self.n;
        (0..self.len() * n).map(|e| self.weights[e / n].sqrt() * self.rows[e] * scale[e % n]).collect()
    }

    fn finish(&self, row: &[f64], scale: f64, out: &mut Vec<f64>) {
        out.clear();
        out.extend(row.iter().zip(&self.weights).map(|(r, w)| r * w.sqrt() * scale));
    }
}

/// Cholesky factor, in the lower triangle, of a matrix with unit diagonal; `None` if a pivot is too small.
fn cholesky(a: &mut [f64], n: usize) -> Option<()> {
    for c in 0..n {
        for r in c..n {
            let s: f64 = (0..c).map(|k| a[r * n + k] * a[c * n + k]).sum();
            let v = a[r * n + c] - s;
            if r == c {
                if v < 1.0 / CHOLESKY_CONDITION {
                    return None;
                }
                a[r * n + c] = v.sqrt();
            } else {
                a[r * n + c] = v / a[c * n + c];
            }
        }
    }
    Some(())
}

fn cholesky_solve(l: &[f64], n: usize, x: &mut [f64]) {
    for r in 0..n {
        let s: f64 = (0..r).map(|c| l[r * n + c] * x[c]).sum();
        x[r] = (x[r] - s) / l[r * n + r];
    }
    for r in (0..n).rev() {
        let s: f64 = (r + 1..n).map(|c| l[c * n + r] * x[c]).sum();
        x[r] = (x[r] - s) / l[r * n + r];
    }
}

/// Row `m` of the pseudo-inverse of the `rows`×`n` matrix by QR factorisation; `None` if it is rank deficient.
fn qr_row(a: &[f64], rows: usize, n: usize, m: usize) -> Option<Vec<f64>> {
    if rows < n {
        return None;
    }
    // Modified Gram-Schmidt, twice, is as good as Householder for these sizes and yields Q explicitly.
    let mut q: Vec<Vec<f64>> = (0..n).map(|c| (0..rows).map(|k| a[k * n + c]).collect()).collect();
    let mut r = vec![0.0; n * n];
    for c in 0..n {
        for _ in 0..2 {
            for p in 0..c {
                let s: f64 = (0..rows).map(|k| q[p][k] * q[c][k]).sum();
                r[p * n + c] += s;
                let (done, rest) = q.split_at_mut(c);
                rest[0].iter_mut().zip(&done[p]).for_each(|(x, y)| *x -= s * y);
            }
        }
        let norm = q[c].iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(norm > RANK_TOLERANCE) {
            return None;
        }
        r[c * n + c] = norm;
        q[c].iter_mut().for_each(|x| *x /= norm);
    }
    // row m of R⁻¹ Qᵀ: solve Rᵀ y = e_m, then Q y
    let mut y = vec![0.0; n];
    for c in m..n {
        let s: f64 = (m..c).map(|p| r[p * n + c] * y[p]).sum();
        y[c] = (if c == m { 1.0 } else { 0.0 } - s) / r[c * n + c];
    }
    Some((0..rows).map(|k| (m..n).map(|c| q[c][k] * y[c]).sum()).collect())
}

/// Row `m` of the pseudo-inverse by one-sided Jacobi rotations of the columns.
fn svd_row(a: &[f64], rows: usize, n: usize, m: usize) -> Vec<f64> {
    let found = Singular::of((0..n).map(|c| (0..rows).map(|k| a[k * n + c]).collect()).collect());
    let (u, v, sizes) = (&found.left, &found.right, found.squares());
    let largest = sizes.iter().fold(0.0f64, |m, s| m.max(*s));
    let keep = |s: f64| s > largest * RANK_TOLERANCE * RANK_TOLERANCE;
    (0..rows).map(|k| (0..n).filter(|c| keep(sizes[*c])).map(|c| v[c][m] * u[c][k] / sizes[c]).sum()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud(n: usize, seed: u64) -> Vec<Vector<3>> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        (0..n).map(|_| Vector([next(), next(), next()])).collect()
    }

    #[test]
    fn gradient_of_a_linear_field_is_exact_on_a_random_cloud() {
        let slope = Vector([0.3, -1.7, 2.2]);
        for seed in 1..50 {
            let d = cloud(9, seed);
            let mut w = Vec::new();
            gradient_weights(&d, &mut w).unwrap();
            let g = d.iter().zip(&w).fold(Vector::ZERO, |g, (d, w)| g + *w * slope.dot(d));
            assert!((g - slope).norm() < 1e-12, "{seed}: {g:?}");
        }
    }

    #[test]
    fn particles_on_a_plane_determine_no_gradient() {
        let d: Vec<_> = cloud(9, 3).iter().map(|d| Vector([d[0], d[1], 0.0])).collect();
        assert!(gradient_weights(&d, &mut Vec::new()).is_none());
    }

    #[test]
    fn the_condition_of_two_variables_is_the_ratio_of_eigenvalues() {
        for m in [[[2.0, 0.3], [0.3, 1.0]], [[5.0, 0.0], [0.0, 1e-3]], [[1.0, 0.999], [0.999, 1.0]]] {
            let [a, b] = eigenvalues_symmetric(&m);
            let ratio = (a / b).max(b / a);
            assert!((condition_symmetric(&m) / ratio - 1.0).abs() < 1e-9, "{m:?}");
        }
        assert!(condition_symmetric(&[[1.0, 2.0], [2.0, 4.0]]).is_infinite());
    }

    #[test]
    fn bounded_weights_of_particles_on_a_line_see_the_slope_along_it() {
        let d = [Vector([1.0, 0.0, 0.0]), Vector([-2.0, 0.0, 0.0])];
        let (m, n) = normal_matrix(d.iter().copied());
        let inverse = bounded_inverse(&m, n);
        let g = d.iter().fold(Vector::ZERO, |g, d| g + gradient_weight(&inverse, d) * d[0]);
        assert!((0.9..=1.0).contains(&g[0]) && g[1] == 0.0 && g[2] == 0.0, "{g:?}");
    }

    /// Quadratic in three variables: every factorisation reproduces the value at the centre.
    #[test]
    fn every_factorisation_reproduces_a_quadratic() {
        for (squash, expected) in [(1.0, Method::Cholesky), (3e-5, Method::Qr), (0.0, Method::Svd)] {
            let mut fit = Fit::default();
            fit.reset(4);
            let d = cloud(12, 7);
            for d in &d {
                fit.push(&[1.0, d[0], d[1], d[0] + squash * d[2]], 1.0 / d.norm_squared());
            }
            let mut row = Vec::new();
            assert_eq!(fit.row_of_inverse(0, &mut row), expected);
            let value: f64 = d.iter().zip(&row).map(|(d, r)| r * (2.0 - d[0] + 0.5 * d[1])).sum();
            assert!((value - 2.0).abs() < 1e-9, "{value}");
        }
    }
}
