//! Singular values and vectors of small matrices by one-sided Jacobi rotations.
//!
//! A V = U Σ: pairs of columns of A are rotated until all columns are orthogonal; V collects the rotations (Demmel
//! 1997, section 5.4.3; Hestenes 1958). Small singular values are as accurate as large ones.

/// Maximum number of sweeps over all pairs of columns; convergence is quadratic, so that fewer suffice.
const SWEEPS: usize = 30;
/// Cosine of the angle between two columns below which they are regarded as orthogonal: round-off.
const RIGHT_ANGLE: f64 = 1e-15;

/// The decomposition A V = U Σ, column by column, in no particular order.
#[derive(Clone, Debug, PartialEq)]
pub struct Singular {
    /// Columns of U Σ, whose norms are the singular values.
    pub left: Vec<Vec<f64>>,
    /// Columns of V.
    pub right: Vec<Vec<f64>>,
}

impl Singular {
    /// Decomposes the matrix with these columns.
    pub fn of(columns: Vec<Vec<f64>>) -> Self {
        let n = columns.len();
        let unit = |c: usize| (0..n).map(|k| if k == c { 1.0 } else { 0.0 }).collect();
        let mut found = Self { left: columns, right: (0..n).map(unit).collect() };
        for _ in 0..SWEEPS {
            let mut rotated = false;
            for p in 0..n {
                (p + 1..n).for_each(|q| rotated |= found.rotate(p, q));
            }
            if !rotated {
                break;
            }
        }
        found
    }

    /// Squares of the singular values.
    pub fn squares(&self) -> Vec<f64> {
        self.left.iter().map(|column| inner(column, column)).collect()
    }

    /// Makes columns `p` and `q` orthogonal; false if they already are.
    fn rotate(&mut self, p: usize, q: usize) -> bool {
        let u = &self.left;
        let (a, b, c) = (inner(&u[p], &u[p]), inner(&u[q], &u[q]), inner(&u[p], &u[q]));
        if c == 0.0 || c.abs() <= RIGHT_ANGLE * (a * b).sqrt() {
            return false;
        }
        let theta = (b - a) / (2.0 * c);
        let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
        let cosine = 1.0 / (t * t + 1.0).sqrt();
        let sine = t * cosine;
        for columns in [&mut self.left, &mut self.right] {
            let (low, high) = columns.split_at_mut(q);
            for (x, y) in low[p].iter_mut().zip(high[0].iter_mut()) {
                (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
            }
        }
        true
    }
}

fn inner(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // the determinant of the Hilbert matrix of order 5 is 1/266716800000 (Hilbert 1894)
    fn small_singular_values_are_exact() {
        let n = 5;
        let column = |c: usize| (0..n).map(|r| 1.0 / (r + c + 1) as f64).collect::<Vec<f64>>();
        let found = Singular::of((0..n).map(column).collect());
        let determinant = found.squares().iter().product::<f64>().sqrt();
        assert!((determinant * 266_716_800_000.0 - 1.0).abs() < 1e-9, "{determinant:e}");
        for c in 0..n {
            let product = |r: usize| (0..n).map(|k| column(k)[r] * found.right[c][k]).sum::<f64>();
            assert!((0..n).all(|r| (product(r) - found.left[c][r]).abs() < 1e-15));
        }
    }
}
