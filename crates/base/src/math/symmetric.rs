//! Small symmetric matrices, rows one after another: Cholesky's factor and eigenvalues.
//!
//! A x = λ B x with B = G Gᵀ has the eigenvalues of G⁻¹ A G⁻ᵀ, which Jacobi's rotations bring to the diagonal (Golub and Van Loan,
//! 4th edition, algorithms 4.2.1, 8.5.2 and 8.7.1).

/// Sweeps of rotations after which no matrix of a few rows is left to converge: convergence is quadratic.
const SWEEPS: usize = 50;

/// Lower triangle G of A = G Gᵀ; `None` when A is not positive definite.
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

/// Eigenvalues of the symmetric matrix A, rising.
pub fn eigenvalues(matrix: &[f64], n: usize) -> Vec<f64> {
    let mut a = matrix.to_vec();
    let size = a.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    for _ in 0..SWEEPS {
        let largest = (0..n * n).filter(|k| k / n != k % n).fold(0.0f64, |m, k| m.max(a[k].abs()));
        if largest <= f64::EPSILON * f64::EPSILON * size {
            break;
        }
        for p in 0..n {
            (p + 1..n).for_each(|q| rotate(&mut a, n, [p, q]));
        }
    }
    let mut values: Vec<f64> = (0..n).map(|k| a[k * n + k]).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The rotation of rows and columns p and q that clears their entry.
fn rotate(a: &mut [f64], n: usize, [p, q]: [usize; 2]) {
    let off = a[p * n + q];
    if off == 0.0 {
        return;
    }
    let ratio = (a[q * n + q] - a[p * n + p]) / (2.0 * off);
    let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    for k in 0..n {
        let (x, y) = (a[k * n + p], a[k * n + q]);
        (a[k * n + p], a[k * n + q]) = (cosine * x - sine * y, sine * x + cosine * y);
    }
    for k in 0..n {
        let (x, y) = (a[p * n + k], a[q * n + k]);
        (a[p * n + k], a[q * n + k]) = (cosine * x - sine * y, sine * x + cosine * y);
    }
}

/// Eigenvalues λ of A x = λ B x, rising, for a positive definite B; none when it is not.
pub fn generalised_eigenvalues(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let Some(factor) = cholesky(b, n) else { return Vec::new() };
    let half = forward(&factor, a, n);
    let turned: Vec<f64> = (0..n * n).map(|k| half[k % n * n + k / n]).collect();
    let full = forward(&factor, &turned, n);
    // round-off leaves it symmetric to the last digits only
    let even: Vec<f64> = (0..n * n).map(|k| 0.5 * (full[k] + full[k % n * n + k / n])).collect();
    eigenvalues(&even, n)
}

/// G⁻¹ A for the lower triangle G.
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
        // against itself every number is one, and its factor gives it back
        assert!(generalised_eigenvalues(&chain, &chain, n).iter().all(|x| (x - 1.0).abs() < 1e-13));
        let g = cholesky(&chain, n).unwrap();
        let back = |k: usize| (0..n).map(|j| g[k / n * n + j] * g[k % n * n + j]).sum::<f64>();
        assert!((0..n * n).all(|k| (back(k) - chain[k]).abs() < 1e-14));
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
