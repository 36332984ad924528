//! Sparse symmetric matrices and their direct factorisation: Cholesky for real matrices, LLᵀ elimination for complex
//! ones.
mod factors;
mod number;
mod ordering;
mod panel;
mod tree;

use num_complex::Complex64;

use self::factors::{Entries, Factored};
use self::tree::Tree;
use super::lanczos::start;

/// A sparse symmetric matrix, stored as its lower triangle, column by column.
#[derive(Clone, Debug, Default)]
pub struct Symmetric {
    /// Start of each column, followed by the number of entries.
    pub first: Vec<usize>,
    /// Row of each entry, ascending within a column.
    pub row: Vec<usize>,
    /// Value of each entry.
    pub value: Vec<f64>,
}

impl Symmetric {
    /// Number of columns.
    pub fn len(&self) -> usize {
        self.first.len().saturating_sub(1)
    }

    /// True if there are no columns.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Computes out = A x.
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

    /// Cholesky factorisation A = L Lᵀ; `None` if the matrix is not positive definite.
    pub fn factor(self) -> Option<Factors> {
        let tree = Tree::of(&self.first, &self.row);
        let entries = Entries::of(&tree, self.columns(), |_| 0.0, &vec![0.0; self.len()]);
        let n = self.len();
        drop((self.first, self.row));
        Factored::of(tree, &entries).map(|of| Factors { of, n, entries: self.value.len() })
    }

    /// Factors A + diag(z) for complex z; `None` if the matrix is singular.
    ///
    /// There is no pivoting; pivots that are too small are increased. Iterative refinement corrects the resulting
    /// error, and a matrix for which it does not converge is rejected.
    pub fn factor_with(&self, diagonal: &[[f64; 2]]) -> Option<ComplexFactors> {
        let matrix = Shifted { matrix: self.clone(), diagonal: diagonal.iter().map(|z| complex(*z)).collect() };
        let floor: Vec<f64> = matrix.sizes().iter().map(|size| LIFTED * size).collect();
        let tree = Tree::of(&self.first, &self.row);
        let entries = Entries::of(&tree, self.columns(), |i| matrix.diagonal[i], &floor);
        let of = Factored::of(tree, &entries)?;
        let factors = ComplexFactors { of, matrix };
        let mut probe: Vec<Complex64> = start(self.len(), 0).into_iter().map(Complex64::from).collect();
        (factors.refined(&mut probe) < REFUSED).then_some(factors)
    }

    fn columns(&self) -> (&[usize], &[usize], &[f64]) {
        (&self.first, &self.row, &self.value)
    }
}

/// Smallest ratio of a pivot of a complex matrix to the largest entry of its row; smaller pivots are increased to it.
/// It is about the square root of round-off, and refinement restores the lost digits (Li and Demmel 2003, ACM TOMS 29,
/// 110).
const LIFTED: f64 = 1.5e-8;
/// Ratio of the residual to the magnitude of its terms at which refinement ends: the accuracy of elimination with
/// pivoting.
const ENOUGH: f64 = 1e-13;
/// Ratio of the residual to the magnitude of its terms above which a matrix is rejected.
const REFUSED: f64 = 1e-10;
/// Maximum number of refinement steps.
const CORRECTIONS: usize = 8;

fn complex([re, im]: [f64; 2]) -> Complex64 {
    Complex64::new(re, im)
}

/// The matrix A + diag(z).
struct Shifted {
    matrix: Symmetric,
    diagonal: Vec<Complex64>,
}

impl Shifted {
    /// Largest modulus of an entry in each row.
    fn sizes(&self) -> Vec<f64> {
        let mut sizes = vec![0.0f64; self.diagonal.len()];
        self.visit(|r, c, value| {
            sizes[r] = sizes[r].max(value.l1_norm());
            sizes[c] = sizes[c].max(value.l1_norm());
        });
        sizes
    }

    /// Calls `f(row, column, value)` for each entry of the lower triangle.
    fn visit(&self, mut f: impl FnMut(usize, usize, Complex64)) {
        let Symmetric { first, row, value } = &self.matrix;
        for c in 0..self.diagonal.len() {
            for k in first[c]..first[c + 1] {
                let own = if row[k] == c { self.diagonal[c] } else { Complex64::ZERO };
                f(row[k], c, own + value[k]);
            }
        }
    }

    /// Residual b − (A + diag(z)) x, and the magnitude of its terms in each row.
    fn residual(&self, x: &[Complex64], b: &[Complex64]) -> (Vec<Complex64>, Vec<f64>) {
        let mut sizes: Vec<f64> = b.iter().map(Complex64::l1_norm).collect();
        let mut r = b.to_vec();
        let mut take = |i: usize, product: Complex64| {
            r[i] -= product;
            sizes[i] += product.l1_norm();
        };
        self.visit(|i, j, value| {
            take(i, value * x[j]);
            if i != j {
                take(j, value * x[i]);
            }
        });
        (r, sizes)
    }
}

/// Factors of a complex sparse symmetric matrix.
pub struct ComplexFactors {
    of: Factored<Complex64>,
    matrix: Shifted,
}

impl ComplexFactors {
    /// Memory of the matrix that was factored (bytes); its factors need several times as much.
    pub fn bytes(&self) -> usize {
        let entries = 2 * self.matrix.matrix.value.len() - self.matrix.diagonal.len();
        entries * (size_of::<Complex64>() + size_of::<usize>())
    }

    /// Replaces the complex vector `x` by A⁻¹ x.
    pub fn solve(&mut self, x: &mut [[f64; 2]]) {
        let mut all: Vec<Complex64> = x.iter().map(|x| complex(*x)).collect();
        self.refined(&mut all);
        x.iter_mut().zip(all).for_each(|(x, z)| *x = [z.re, z.im]);
    }

    /// Replaces `x` by A⁻¹ x with iterative refinement, and returns the largest ratio of a residual to the magnitude of
    /// its terms (Oettli and Prager 1964; Golub and Van Loan, 4th edition, section 3.5.3).
    fn refined(&self, x: &mut Vec<Complex64>) -> f64 {
        let right = x.clone();
        self.of.solve(x);
        let (mut left, mut best) = (f64::INFINITY, x.clone());
        for _ in 0..CORRECTIONS {
            let (mut r, sizes) = self.matrix.residual(x, &right);
            let parts = r.iter().zip(&sizes).filter(|(_, size)| **size > 0.0).map(|(r, size)| r.l1_norm() / size);
            let now = parts.fold(0.0, |m: f64, part| if part <= m { m } else { part });
            if !(now < 0.5 * left) {
                break;
            }
            (left, best) = (now, x.clone());
            if now < ENOUGH {
                break;
            }
            self.of.solve(&mut r);
            x.iter_mut().zip(r).for_each(|(x, r)| *x += r);
        }
        *x = best;
        left
    }
}

/// Cholesky factors of a sparse matrix.
pub struct Factors {
    of: Factored<f64>,
    n: usize,
    entries: usize,
}

impl Factors {
    /// Memory of the matrix that was factored (bytes); its factors need several times as much.
    pub fn bytes(&self) -> usize {
        self.entries * (size_of::<f64>() + size_of::<usize>())
    }

    /// Replaces the columns of `x`, stored one after another, by A⁻¹ times these columns.
    pub fn solve(&self, x: &mut [f64]) {
        debug_assert!(x.len().is_multiple_of(self.n.max(1)));
        self.of.solve(x);
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
