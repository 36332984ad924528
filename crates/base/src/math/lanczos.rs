//! Largest eigenvalues of a symmetric operator by the block Lanczos method.
//!
//! A block of vectors, its image, the image of that and so on are each made orthogonal to all previous vectors (block
//! Lanczos with full reorthogonalisation: Golub and Underwood 1977). The operator is then diagonalised in the space
//! that they span. A block at least as large as the multiplicity of an eigenvalue finds all its vectors: a free body
//! has six with zero frequency. With the inverse as operator, the results are the smallest eigenvalues.
use super::reduce::dot;
use super::symmetric;

/// Number of vectors in a block.
const BLOCK: usize = 8;

/// Eigenvalues in descending order, with unit eigenvectors.
#[derive(Clone, Debug)]
pub struct Pairs {
    /// Eigenvalues θ.
    pub values: Vec<f64>,
    /// Unit eigenvectors x.
    pub vectors: Vec<Vec<f64>>,
    /// Relative residual |A x − θ x|/θ of each pair.
    pub left: Vec<f64>,
}

/// The `count` largest eigenvalues of the operator `apply(x)`, which replaces the columns of length `n` in `x` by their
/// images. The relative residual of each is at most `tolerance`, and the space has at most `most` vectors. `mask` sets
/// excluded components of a vector to zero.
pub fn largest(
    n: usize,
    count: usize,
    (tolerance, most): (f64, usize),
    mask: impl Fn(&mut [f64]),
    mut apply: impl FnMut(&mut [f64]),
) -> Pairs {
    let [mut basis, mut images, mut products]: [Vec<Vec<f64>>; 3] = Default::default();
    let mut next: Vec<Vec<f64>> = (0..BLOCK.max(count.min(2 * BLOCK))).map(|k| start(n, k)).collect();
    loop {
        let before = basis.len();
        for mut vector in next {
            mask(&mut vector);
            if basis.len() < n && orthogonal(&mut vector, &basis) {
                basis.push(vector);
            }
        }
        if basis.len() == before {
            return ritz(&basis, &images, &products, count);
        }
        let mut block = basis[before..].concat();
        apply(&mut block);
        images.extend(block.chunks_exact(n.max(1)).map(|image| {
            let mut image = image.to_vec();
            mask(&mut image);
            image
        }));
        project(&mut products, &basis, &images);
        let found = ritz(&basis, &images, &products, count);
        let done = found.values.len() == count && found.left.iter().all(|r| *r < tolerance);
        if done || basis.len() >= most.min(n) {
            return found;
        }
        next = images[before..].to_vec();
    }
}

/// Makes a vector orthogonal to the others and normalises it; false if nothing remains.
fn orthogonal(vector: &mut [f64], others: &[Vec<f64>]) -> bool {
    let whole = dot(vector, vector).sqrt();
    for _ in 0..2 {
        for other in others {
            let part = dot(vector, other);
            vector.iter_mut().zip(other).for_each(|(v, o)| *v -= part * o);
        }
    }
    let left = dot(vector, vector).sqrt();
    if !(left > 1e-12 * whole) {
        return false;
    }
    vector.iter_mut().for_each(|v| *v /= left);
    true
}

/// Inner products of basis vectors with images, row by row; rows that are already known are kept.
fn project(products: &mut Vec<Vec<f64>>, basis: &[Vec<f64>], images: &[Vec<f64>]) {
    products.resize(basis.len(), Vec::new());
    for (row, vector) in products.iter_mut().zip(basis) {
        row.extend(images[row.len()..].iter().map(|image| dot(vector, image)));
    }
}

/// Ritz vectors in the space of a basis, from its images and their products with the basis.
fn ritz(basis: &[Vec<f64>], images: &[Vec<f64>], products: &[Vec<f64>], count: usize) -> Pairs {
    let m = images.len();
    let even: Vec<f64> = (0..m * m).map(|k| 0.5 * (products[k / m][k % m] + products[k % m][k / m])).collect();
    let mut pairs = Pairs { values: Vec::new(), vectors: Vec::new(), left: Vec::new() };
    let Some(found) = symmetric::eigen(&even, m) else { return pairs };
    let combined = |of: &[Vec<f64>], parts: &[f64]| {
        let mut x = vec![0.0; of[0].len()];
        for (part, vector) in parts.iter().zip(of) {
            x.iter_mut().zip(vector).for_each(|(x, v)| *x += part * v);
        }
        x
    };
    for (value, parts) in found.values.into_iter().zip(&found.vectors).rev().take(count) {
        let (x, image) = (combined(basis, parts), combined(images, parts));
        let left: f64 = x.iter().zip(&image).map(|(x, y)| (y - value * x).powi(2)).sum();
        pairs.left.push(left.sqrt() / value.abs().max(f64::MIN_POSITIVE));
        pairs.values.push(value);
        pairs.vectors.push(x);
    }
    pairs
}

/// Initial vector of length `n` without a pattern, different for each `k`.
pub fn start(n: usize, k: usize) -> Vec<f64> {
    let mut seed = 0x9e37_79b9_7f4a_7c15_u64.wrapping_mul(2 * k as u64 + 1);
    let mut next = || {
        seed ^= seed << 13;
        seed ^= seed >> 7;
        seed ^= seed << 17;
        (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
    };
    (0..n).map(|_| next()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_that_come_six_times_are_all_found() {
        let n = 200;
        let value = |k: usize| if k < 6 { 100.0 } else { 50.0 / (k - 5) as f64 };
        let apply = |x: &mut [f64]| x.chunks_exact_mut(n).for_each(|x| (0..n).for_each(|k| x[k] *= value(k)));
        let found = largest(n, 9, (1e-9, 120), |_| {}, apply);
        for (k, x) in found.values.iter().enumerate() {
            assert!((x - value(k)).abs() < 1e-9 * x, "{k}: {x}");
        }
    }
}
