//! Small square matrices.
use super::types::Vector;

/// Entry (r, c) of the cofactors of the matrix of order D ≤ 3 with entries `at`.
#[inline(always)]
pub fn cofactor<const D: usize>(at: impl Fn(usize, usize) -> f64, r: usize, c: usize) -> f64 {
    let at = |i: usize, j: usize| at((r + i) % D, (c + j) % D);
    match D {
        1 => 1.0,
        2 => at(1, 1) * if (r + c).is_multiple_of(2) { 1.0 } else { -1.0 },
        _ => at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1),
    }
}

/// Rows of cof F, the derivatives of det F by the entries of F, for the rows of F.
#[inline(always)]
pub fn cofactors<const D: usize>(f: &[Vector<D>; D]) -> [Vector<D>; D] {
    std::array::from_fn(|r| Vector::from_fn(|c| cofactor::<D>(|i, j| f[i][j], r, c)))
}

/// det F.
#[inline(always)]
pub fn determinant<const D: usize>(f: &[Vector<D>; D]) -> f64 {
    (0..D).map(|c| f[0][c] * cofactor::<D>(|i, j| f[i][j], 0, c)).sum()
}

/// F v.
#[inline(always)]
pub fn times<const D: usize>(f: &[Vector<D>; D], v: &Vector<D>) -> Vector<D> {
    Vector::from_fn(|r| f[r].dot(v))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cofactor_times_the_transpose_is_the_determinant() {
        let f = [Vector([1.1, 0.2, -0.3]), Vector([0.4, 0.9, 0.1]), Vector([-0.2, 0.3, 1.2])];
        let g = [Vector([1.1, 0.2]), Vector([-0.4, 0.9])];
        for k in 0..3 {
            // F^T cof(F) = det(F) 1
            let column = times(&cofactors(&f), &Vector::axis(k));
            let back: Vector<3> = Vector::from_fn(|c| (0..3).map(|r| f[r][c] * column[r]).sum());
            assert!((back - Vector::axis(k) * determinant(&f)).norm() < 1e-14);
        }
        assert!((determinant(&f) - (1.1 * 1.05 - 0.2 * 0.5 - 0.3 * 0.3)).abs() < 1e-14);
        assert!((determinant(&g) - 1.07).abs() < 1e-14);
    }
}
