//! Sparse symmetric matrices and their Cholesky factors.
use faer::MatMut;
use faer::Side;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::{Llt, SymbolicLlt};
use faer::sparse::{SparseColMat, SymbolicSparseColMat};

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
        Some(Factors { of: Llt::try_new_with_symbolic(order, matrix.as_ref(), Side::Lower).ok()?, n })
    }
}

/// Cholesky factors of a sparse matrix.
pub struct Factors {
    of: Llt<usize, f64>,
    n: usize,
}

impl Factors {
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
    }
}
