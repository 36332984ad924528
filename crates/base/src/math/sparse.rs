//! Sparse symmetric matrices and their factors: Cholesky's, and of complex ones those of elimination.
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, Lu, SymbolicLlt, SymbolicLu};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{MatMut, Side, c64};

/// A symmetric matrix: its lower triangle, column by column.
#[derive(Clone, Debug, Default)]
pub struct Symmetric {
    /// Where each column begins; one more than there are columns.
    pub first: Vec<usize>,
    /// Rows, ascending in a column.
    pub row: Vec<usize>,
    /// Values.
    pub value: Vec<f64>,
}

impl Symmetric {
    /// Number of columns.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// True when there are no columns.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// out = A x.
    pub fn product(&self, x: &[f64], out: &mut [f64]) {
        out.fill(0.0);
        for column in 0..self.len() {
            for k in self.first[column]..self.first[column + 1] {
                let (row, value) = (self.row[k], self.value[k]);
                out[row] += value * x[column];
                if row != column {
                    out[column] += value * x[row];
                }
            }
        }
    }

    /// A = L Lᵀ; `None` where the matrix is not positive.
    pub fn factor(self) -> Option<Factors> {
        let n = self.len();
        let symbolic = SymbolicSparseColMat::new_checked(n, n, self.first, None, self.row);
        let matrix = SparseColMat::new(symbolic, self.value);
        let order = SymbolicLlt::try_new(matrix.symbolic(), Side::Lower).ok()?;
        let of = Llt::try_new_with_symbolic(order, matrix.as_ref(), Side::Lower).ok()?;
        Some(Factors { of, n, entries: matrix.val().len() })
    }
}

impl Symmetric {
    /// Factors of A + diag(z), z complex numbers; `None` where that is singular.
    pub fn factor_with(&self, diagonal: &[[f64; 2]]) -> Option<ComplexFactors> {
        let n = self.len();
        let mut count = vec![0usize; n + 1];
        let entries = || (0..n).flat_map(|c| (self.first[c]..self.first[c + 1]).map(move |k| (c, k)));
        for (column, k) in entries() {
            count[column + 1] += 1;
            if self.row[k] != column {
                count[self.row[k] + 1] += 1;
            }
        }
        (0..n).for_each(|c| count[c + 1] += count[c]);
        let (mut at, first) = (count.clone(), count);
        let (mut row, mut value) = (vec![0usize; first[n]], vec![c64::new(0.0, 0.0); first[n]]);
        // column after column, so that the upper triangle comes in the order of rows and before the lower one
        for (column, k) in entries() {
            let (r, mut v) = (self.row[k], c64::new(self.value[k], 0.0));
            if r == column {
                v += c64::new(diagonal[r][0], diagonal[r][1]);
            } else {
                (row[at[r]], value[at[r]]) = (column, v);
                at[r] += 1;
            }
            (row[at[column]], value[at[column]]) = (r, v);
            at[column] += 1;
        }
        let symbolic = SymbolicSparseColMat::new_checked(n, n, first, None, row);
        let matrix = SparseColMat::new(symbolic, value);
        let order = SymbolicLu::try_new(matrix.symbolic()).ok()?;
        let of = Lu::try_new_with_symbolic(order, matrix.as_ref()).ok()?;
        Some(ComplexFactors { of, n, entries: matrix.val().len(), right: vec![c64::new(0.0, 0.0); n] })
    }
}

/// Factors of a complex sparse matrix.
pub struct ComplexFactors {
    of: Lu<usize, c64>,
    n: usize,
    entries: usize,
    right: Vec<c64>,
}

impl ComplexFactors {
    /// Bytes of the matrix that was factored: its factors hold several times as many.
    pub fn bytes(&self) -> usize {
        self.entries * (size_of::<c64>() + size_of::<usize>())
    }

    /// Replaces the complex numbers `x` by what A takes to them.
    pub fn solve(&mut self, x: &mut [[f64; 2]]) {
        self.right.iter_mut().zip(&*x).for_each(|(r, x)| *r = c64::new(x[0], x[1]));
        self.of.solve_in_place(MatMut::from_column_major_slice_mut(&mut self.right, self.n, 1));
        x.iter_mut().zip(&self.right).for_each(|(x, r)| *x = [r.re, r.im]);
    }
}

/// Cholesky factors of a sparse matrix.
pub struct Factors {
    of: Llt<usize, f64>,
    n: usize,
    entries: usize,
}

impl Factors {
    /// Bytes of the matrix that was factored: its factors hold several times as many.
    pub fn bytes(&self) -> usize {
        self.entries * (size_of::<f64>() + size_of::<usize>())
    }

    /// Replaces the columns of `x`, one after another, by what A takes to them.
    pub fn solve(&self, x: &mut [f64]) {
        let columns = x.len() / self.n.max(1);
        self.of.solve_in_place(MatMut::from_column_major_slice_mut(x, self.n, columns));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_string_is_solved_and_an_indefinite_matrix_is_refused() {
        let n = 50;
        let string = |own: f64| {
            let mut all = Symmetric { first: vec![0], ..Symmetric::default() };
            for k in 0..n {
                all.row.push(k);
                all.value.push(own);
                if k + 1 < n {
                    all.row.push(k + 1);
                    all.value.push(-1.0);
                }
                all.first.push(all.row.len());
            }
            all
        };
        let exact: Vec<f64> = (0..n).map(|k| (k as f64).sin()).collect();
        let mut x = vec![0.0; n];
        string(2.0).product(&exact, &mut x);
        string(2.0).factor().unwrap().solve(&mut x);
        assert!(x.iter().zip(&exact).all(|(x, e)| (x - e).abs() < 1e-11));
        assert!(string(-2.0).factor().is_none());
        // (A + i) (x + i y) = b
        let (y, mut b) = (exact.iter().map(|x| 1.0 - x).collect::<Vec<_>>(), [vec![0.0; n], vec![0.0; n]]);
        string(0.3).product(&exact, &mut b[0]);
        string(0.3).product(&y, &mut b[1]);
        let mut z: Vec<[f64; 2]> = (0..n).map(|k| [b[0][k] - y[k], b[1][k] + exact[k]]).collect();
        string(0.3).factor_with(&vec![[0.0, 1.0]; n]).unwrap().solve(&mut z);
        assert!((0..n).all(|k| (z[k][0] - exact[k]).abs() < 1e-11 && (z[k][1] - y[k]).abs() < 1e-11));
    }
}
