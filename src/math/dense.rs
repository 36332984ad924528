//! Full matrices: A x = b by elimination with partial pivoting (Golub and Van Loan, 4th edition, section 3.4).

/// Ratio of smallest to largest pivot below which a matrix counts as singular: round-off of some thousand rows.
const SINGULAR: f64 = 1e-15;

/// Solves A x = b for several right-hand sides at once; `matrix` holds the rows of A one after another and is used up, row i
/// of `right` holds the right-hand sides of equation i and becomes the solution. False when A is singular to round-off.
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

/// Takes the multiples of row `k` that clear its column off the rows below.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solutions_satisfy_their_equations() {
        let n = 40;
        // zeros on the diagonal ask for pivots
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
    fn singular_matrices_are_refused() {
        assert!(!solve(&mut [1.0, 2.0, 2.0, 4.0], &mut [[1.0], [2.0]]));
        assert!(!solve(&mut [0.0], &mut [[1.0]]));
        assert!(solve(&mut [], &mut [[0.0; 1]; 0]));
    }
}
