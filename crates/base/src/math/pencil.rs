//! Poles of a signal that is a sum of exponentials, by the matrix pencil method.
//!
//! Samples y_k = Σ_m c_m z_m^k at equal steps form the matrix Y with rows (y_i, …, y_{i+L}), which span the powers (1,
//! z, …, z^L) of the poles. Let V be the M leading right singular vectors of Y, V₁ these vectors without their last and
//! V₂ without their first entry. The eigenvalues of V₁⁺ V₂ are the poles, and noise remains in the other singular
//! vectors. An L between a third and a half of the number of samples is least sensitive to noise (Hua and Sarkar 1990,
//! IEEE Trans. ASSP 38, 814).
use num_complex::Complex64;

use super::dense::Factors;
use super::eigenvalues::eigenvalues;
use super::singular::Singular;

/// Number of samples divided by the length L of a row of the pencil.
const REACH: usize = 3;

/// Singular vectors of a signal, from which any number of poles can be computed.
#[derive(Clone, Debug)]
pub struct Pencil {
    /// Right singular vectors, in descending order of the singular values.
    vectors: Vec<Vec<f64>>,
}

impl Pencil {
    /// The pencil of samples at equal steps.
    pub fn of(samples: &[f64]) -> Self {
        let length = samples.len() / REACH;
        let rows = samples.len() - length;
        let columns = (0..=length).map(|c| samples[c..].iter().take(rows).copied().collect());
        let found = Singular::of(columns.collect());
        let mut all: Vec<(f64, Vec<f64>)> = found.squares().into_iter().zip(found.right).collect();
        all.sort_by(|a, b| b.0.total_cmp(&a.0));
        Self { vectors: all.into_iter().map(|(_, vector)| vector).collect() }
    }

    /// The `count` poles z; `None` if the signal has fewer.
    pub fn poles(&self, count: usize) -> Option<Vec<Complex64>> {
        let leading = self.vectors.get(..count)?;
        let length = leading.first()?.len() - 1;
        if count > length {
            return None;
        }
        let product =
            |i: usize, j: usize, shift: usize| (0..length).map(|k| leading[i][k] * leading[j][k + shift]).sum::<f64>();
        let normal = Factors::new(count, (0..count * count).map(|k| product(k / count, k % count, 0)).collect())?;
        let mut turned = vec![0.0; count * count];
        for (j, column) in turned.chunks_exact_mut(count).enumerate() {
            let right: Vec<f64> = (0..count).map(|i| product(i, j, 1)).collect();
            normal.solve(&right, column);
        }
        // the transpose has the same eigenvalues
        eigenvalues(&turned, count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poles_of_a_sum_of_powers_are_found() {
        let poles = [Complex64::from_polar(0.98, 0.3), Complex64::from_polar(1.01, 0.37)];
        let sample = |k: i32| 2.0 + poles[0].powi(k).re - 0.3 * poles[1].powi(k).im;
        let pencil = Pencil::of(&(0..90).map(sample).collect::<Vec<f64>>());
        let found = pencil.poles(5).unwrap();
        for pole in poles.into_iter().chain([Complex64::ONE]) {
            assert!(found.iter().any(|z| (z - pole).norm() < 1e-10), "{pole}: {found:?}");
        }
        assert!(pencil.poles(31).is_none() && Pencil::of(&[]).poles(1).is_none());
    }
}
