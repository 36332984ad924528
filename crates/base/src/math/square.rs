//! Small square matrices.
use super::types::Vector;

/// Cofactor (r, c) of the matrix of order D ≤ 3 with the entries `at`.
#[inline(always)]
pub fn cofactor<const D: usize>(at: impl Fn(usize, usize) -> f64, r: usize, c: usize) -> f64 {
    let at = |i: usize, j: usize| at((r + i) % D, (c + j) % D);
    match D {
        1 => 1.0,
        2 => at(1, 1) * if (r + c).is_multiple_of(2) { 1.0 } else { -1.0 },
        _ => at(1, 1) * at(2, 2) - at(1, 2) * at(2, 1),
    }
}

/// Rows of the cofactor matrix cof F, the derivative of det F with respect to F, from the rows of F.
#[inline(always)]
pub fn cofactors<const D: usize>(f: &[Vector<D>; D]) -> [Vector<D>; D] {
    std::array::from_fn(|r| Vector::from_fn(|c| cofactor::<D>(|i, j| f[i][j], r, c)))
}

/// Determinant of F from its rows.
#[inline(always)]
pub fn determinant<const D: usize>(f: &[Vector<D>; D]) -> f64 {
    (0..D).map(|c| f[0][c] * cofactor::<D>(|i, j| f[i][j], 0, c)).sum()
}

/// A symmetric matrix of order 2 or 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symmetric<const D: usize> {
    diagonal: [f64; D],
    /// The off-diagonal entries (0, 1), (0, 2) and (1, 2); in 2-D only the first.
    beside: [f64; D],
}

impl<const D: usize> Symmetric<D> {
    /// The zero matrix.
    pub const ZERO: Self = Self { diagonal: [0.0; D], beside: [0.0; D] };

    /// The symmetric matrix with the upper triangle of `full`.
    #[inline(always)]
    pub fn of(full: &[[f64; D]; D]) -> Self {
        let mut m = Self::ZERO;
        for r in 0..D {
            m.diagonal[r] = full[r][r];
            (r + 1..D).for_each(|c| m.beside[r + c - 1] = full[r][c]);
        }
        m
    }

    /// All entries, row by row.
    #[inline(always)]
    pub fn full(&self) -> [[f64; D]; D] {
        let mut full = [[0.0; D]; D];
        for r in 0..D {
            full[r][r] = self.diagonal[r];
            for c in r + 1..D {
                (full[r][c], full[c][r]) = (self.beside[r + c - 1], self.beside[r + c - 1]);
            }
        }
        full
    }

    /// Adds a bᵀ for two parallel vectors.
    #[inline(always)]
    pub fn add_product(&mut self, a: &Vector<D>, b: &Vector<D>) {
        for r in 0..D {
            self.diagonal[r] += a[r] * b[r];
            (r + 1..D).for_each(|c| self.beside[r + c - 1] += a[r] * b[c]);
        }
    }
}

/// Product F v.
#[inline(always)]
pub fn times<const D: usize>(f: &[Vector<D>; D], v: &Vector<D>) -> Vector<D> {
    Vector::from_fn(|r| f[r].dot(v))
}

/// An orthonormal frame whose last vector is the unit vector `normal`.
pub fn frame_of<const D: usize>(normal: &Vector<D>) -> [Vector<D>; D] {
    let mut axes = [*normal; D];
    if D == 2 {
        (axes[0][0], axes[0][1]) = (-normal[1], normal[0]);
        return axes;
    }
    let smallest = (0..D).fold(0, |a, d| if normal[d].abs() < normal[a].abs() { d } else { a });
    let e = Vector::axis(smallest);
    axes[0] = (e - *normal * e.dot(normal)).unit();
    axes[1] = Vector::from_fn(|d| {
        let (a, b) = ((d + 1) % D, (d + 2) % D);
        normal[a] * axes[0][b] - normal[b] * axes[0][a]
    });
    axes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_is_orthonormal_and_ends_in_the_normal() {
        let n = Vector([0.3, -0.5, 0.8]).unit();
        let [a, b, c] = frame_of(&n);
        assert_eq!(c, n);
        assert!(a.dot(&b).abs() + a.dot(&c).abs() + b.dot(&c).abs() < 1e-14);
        assert!((a.norm() - 1.0).abs() + (b.norm() - 1.0).abs() < 1e-14);
        let [along, normal] = frame_of(&Vector([0.6, 0.8]));
        assert_eq!((along, normal), (Vector([-0.8, 0.6]), Vector([0.6, 0.8])));
    }

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

    #[test]
    fn a_symmetric_matrix_is_its_upper_triangle() {
        let (space, plane) = ([[1.0, 2.0, 3.0], [2.0, 4.0, 5.0], [3.0, 5.0, 6.0]], [[1.0, 2.0], [2.0, 3.0]]);
        assert_eq!((Symmetric::of(&space).full(), Symmetric::of(&plane).full()), (space, plane));
        let (mut sum, v) = (Symmetric::of(&space), Vector([1.0, -2.0, 0.5]));
        sum.add_product(&(v * 2.0), &v);
        assert_eq!(sum.full()[2], [3.0 + 1.0, 5.0 - 2.0, 6.0 + 0.5]);
    }
}
