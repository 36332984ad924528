//! Dense matrices: A x = b by elimination with partial pivoting (Golub and Van Loan, 4th edition, section 3.4).

/// Ratio of smallest to largest pivot below which a matrix is regarded as singular: round-off for some thousand rows.
const SINGULAR: f64 = 1e-15;

/// Solves A x = b for several right-hand sides. `matrix` holds the rows of A one after another and is overwritten; row
/// i of `right` holds the right-hand sides of equation i and becomes the solution. Returns false if A is singular to
/// round-off.
pub fn solve<const M: usize>(matrix: &mut [f64], right: &mut [[f64; M]]) -> bool {
    let n = right.len();
    let (mut smallest, mut largest) = (f64::INFINITY, 0.0f64);
    for k in 0..n {
        let size = |i: usize| matrix[i * n + k].abs();
        let pivot = (k + 1..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
        (smallest, largest) = (smallest.min(size(pivot)), largest.max(size(pivot)));
        if !(smallest > SINGULAR * largest) {
            return false;
        }
        if pivot != k {
            (0..n).for_each(|j| matrix.swap(k * n + j, pivot * n + j));
            right.swap(k, pivot);
        }
        eliminate(matrix, right, k);
    }
    for k in (0..n).rev() {
        let known = (k + 1..n).fold(right[k], |sum, j| less(sum, matrix[k * n + j], &right[j]));
        right[k] = known.map(|v| v / matrix[k * n + k]);
    }
    true
}

/// Subtracts multiples of row `k` from the rows below, so that their entries in column `k` vanish.
fn eliminate<const M: usize>(matrix: &mut [f64], right: &mut [[f64; M]], k: usize) {
    let n = right.len();
    let (above, below) = matrix.split_at_mut((k + 1) * n);
    let row = &above[k * n..];
    for (i, other) in below.chunks_exact_mut(n).enumerate() {
        let factor = other[k] / row[k];
        if factor != 0.0 {
            other[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(a, b)| *a -= factor * b);
            right[k + 1 + i] = less(right[k + 1 + i], factor, &right[k]);
        }
    }
}

fn less<const M: usize>(a: [f64; M], factor: f64, b: &[f64; M]) -> [f64; M] {
    std::array::from_fn(|m| a[m] - factor * b[m])
}

/// A factored dense matrix, for solves with many right-hand sides.
#[derive(Clone, Debug, Default)]
pub struct Factors {
    n: usize,
    /// L below the diagonal, U on and above it; rows in the order of `order`.
    rows: Vec<f64>,
    order: Vec<usize>,
}

impl Factors {
    /// Factors the matrix with `n` rows, stored one after another; `None` if it is singular to round-off.
    pub fn new(n: usize, mut rows: Vec<f64>) -> Option<Self> {
        let mut order: Vec<usize> = (0..n).collect();
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0f64);
        for k in 0..n {
            let size = |i: usize| rows[i * n + k].abs();
            let pivot = (k + 1..n).fold(k, |best, i| if size(i) > size(best) { i } else { best });
            (smallest, largest) = (smallest.min(size(pivot)), largest.max(size(pivot)));
            if !(smallest > SINGULAR * largest) {
                return None;
            }
            if pivot != k {
                (0..n).for_each(|j| rows.swap(k * n + j, pivot * n + j));
                order.swap(k, pivot);
            }
            let (above, below) = rows.split_at_mut((k + 1) * n);
            let row = &above[k * n..];
            for other in below.chunks_exact_mut(n) {
                other[k] /= row[k];
                let factor = other[k];
                other[k + 1..].iter_mut().zip(&row[k + 1..]).for_each(|(a, b)| *a -= factor * b);
            }
        }
        Some(Self { n, rows, order })
    }

    /// Number of equations.
    pub fn len(&self) -> usize {
        self.n
    }

    /// True if there are no equations.
    pub fn is_empty(&self) -> bool {
        self.n == 0
    }

    /// Computes x = A⁻¹ b.
    pub fn solve(&self, b: &[f64], x: &mut [f64]) {
        let n = self.n;
        for i in 0..n {
            let known = self.rows[i * n..i * n + i].iter().zip(&x[..i]).map(|(l, x)| l * x).sum::<f64>();
            x[i] = b[self.order[i]] - known;
        }
        for i in (0..n).rev() {
            let row = &self.rows[i * n..(i + 1) * n];
            let known = row[i + 1..].iter().zip(&x[i + 1..n]).map(|(u, x)| u * x).sum::<f64>();
            x[i] = (x[i] - known) / row[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_satisfy_their_equations() {
        let n = 40;
        // zeros on the diagonal require pivoting
        let entry = |i: usize, j: usize| if i == j { 0.0 } else { ((7 * i + 3 * j * j) as f64).sin() };
        let exact: Vec<[f64; 2]> = (0..n).map(|i| [(i as f64).cos(), 1.0 + i as f64]).collect();
        let mut matrix: Vec<f64> = (0..n * n).map(|k| entry(k / n, k % n)).collect();
        let row = |i: usize| std::array::from_fn(|m| (0..n).map(|j| entry(i, j) * exact[j][m]).sum());
        let mut right: Vec<[f64; 2]> = (0..n).map(row).collect();
        assert!(solve(&mut matrix, &mut right));
        let error = right.iter().zip(&exact).map(|(a, b)| (a[0] - b[0]).abs().max((a[1] - b[1]).abs()));
        assert!(error.fold(0.0, f64::max) < 1e-10);
    }

    #[test]
    fn factors_solve_what_elimination_solves() {
        let n = 23;
        let entry = |k: usize| {
            ((7 * (k / n) + 3 * (k % n) * (k % n)) as f64).sin() * f64::from(u8::from(!k.is_multiple_of(n + 1)))
        };
        let matrix: Vec<f64> = (0..n * n).map(entry).collect();
        let exact: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
        let b: Vec<f64> = (0..n).map(|i| (0..n).map(|j| matrix[i * n + j] * exact[j]).sum()).collect();
        let mut x = vec![0.0; n];
        Factors::new(n, matrix).unwrap().solve(&b, &mut x);
        assert!(x.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-9), "{x:?}");
        assert!(Factors::new(2, vec![1.0, 2.0, 2.0, 4.0]).is_none());
    }

    #[test]
    fn singular_matrices_are_refused() {
        assert!(!solve(&mut [1.0, 2.0, 2.0, 4.0], &mut [[1.0], [2.0]]));
        assert!(!solve(&mut [0.0], &mut [[1.0]]));
        assert!(solve(&mut [], &mut [[0.0; 1]; 0]));
    }
}
