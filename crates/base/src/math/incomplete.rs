//! Incomplete factorisation of a sparse block matrix in which off-diagonal blocks remain unchanged (DILU).
//!
//! A = L + diag A + U is approximated by (D + L) D⁻¹ (D + U), with pivots D for which the diagonals agree (Pommerell
//! 1992):
//!
//! D_i = A_ii − Σ_{j<i} A_ij D_j⁻¹ A_ji.
//!
//! Along a line of particles this is the exact solution, so that the stiff coupling across thin layers is resolved at
//! the cost of two half-sweeps. Blocks between parts of the matrix are not included in the factors, so that parts are
//! independent. A second solve for the residual takes these blocks into account.
use std::ops::Range;

use multiversion::multiversion;

use super::block_matrix::BlockMatrix;
use super::blocks::{array, invert, store, with_block};
use super::parallel::{sweep, sweep_parts};
use super::rounded::{LANES, Lanes, leading, load, multiply, subtract, widen_block};

/// Inverse pivots of a matrix, and working storage of a solve.
#[derive(Clone, Debug, Default)]
pub struct Incomplete {
    inverse: Vec<f32>,
    first: Vec<f32>,
    second: Vec<f32>,
}

impl Incomplete {
    /// Memory in use (bytes).
    pub fn bytes(&self) -> usize {
        4 * (self.inverse.len() + self.first.len() + self.second.len())
    }

    /// Computes the pivots of `matrix`.
    pub fn factor(&mut self, matrix: &BlockMatrix) {
        let n = matrix.block();
        self.inverse.resize(matrix.n_rows() * n * n, 0.0);
        self.first.resize(matrix.n_rows() * n, 0.0);
        self.second.resize(matrix.n_rows() * n, 0.0);
        with_block!(n, N => self.factor_blocks::<N>(matrix));
    }

    fn factor_blocks<const N: usize>(&mut self, matrix: &BlockMatrix) {
        let parts = matrix.parts();
        sweep_parts(parts, N * N, &mut self.inverse, &|k, out| {
            let start = parts[k].start;
            for i in parts[k].clone() {
                let (before, rest) = out.split_at_mut((i - start) * N * N);
                let pivot = pivot::<N>(matrix, i, start, before);
                let mut wide = [0.0; 36];
                invert(N, pivot.as_flattened(), &mut wide[..N * N]);
                rest[..N * N].iter_mut().zip(&wide).for_each(|(r, w)| *r = *w as f32);
            }
        });
    }

    /// Computes z ≈ A⁻¹ r, where `r(i, row)` sets row i of the right-hand side and `matrix` is the factored matrix: one
    /// solve with the factors, and a second one for the residual, which includes the blocks between parts.
    pub fn apply(&mut self, matrix: &BlockMatrix, r: impl Fn(usize, &mut [f32]) + Sync, z: &mut [f64]) {
        let scaled = |i: usize, row: &mut [f32]| {
            r(i, row);
            matrix.enter(row);
        };
        with_block!(matrix.block(), N => self.solve::<N>(matrix, &scaled, z));
    }

    fn solve<const N: usize>(&mut self, matrix: &BlockMatrix, b: &(impl Fn(usize, &mut [f32]) + Sync), z: &mut [f64]) {
        let (parts, inverse, first) = (matrix.parts(), &self.inverse[..], &mut self.first);
        sweep_parts(parts, N, first, &|k, x| solve_part::<N>(matrix, inverse, &parts[k], b, x));
        let first = &first[..];
        sweep_parts(parts, N, &mut self.second, &|k, y| correct_part::<N>(matrix, (inverse, first), &parts[k], b, y));
        let second = &self.second;
        sweep(z, |k| f64::from(matrix.leave(first, k) + matrix.leave(second, k)));
    }
}

/// Computes x ← (D + U)⁻¹ D (D + L)⁻¹ b for the rows of one part.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn solve_part<const N: usize>(
    matrix: &BlockMatrix,
    inverse: &[f32],
    part: &Range<usize>,
    b: &impl Fn(usize, &mut [f32]),
    x: &mut [f32],
) {
    let start = part.start;
    for i in part.clone() {
        let ((_, inside, _), column) = (matrix.split_row(i), matrix.columns_by_entry(i));
        let mut r = [0.0; LANES];
        b(i, &mut r[..N]);
        for e in inside.start..matrix.middle(i) {
            subtract::<N>(matrix.off_diagonal::<N>(e), &load::<N>(x, column(e) - start), &mut r);
        }
        add_pivoted::<N>(inverse, i, &r, [0.0; N], &mut x[(i - start) * N..]);
    }
    backward::<N>(matrix, inverse, part, x);
}

/// Solves in the same way for the residual of the solution `solved`.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn correct_part<const N: usize>(
    matrix: &BlockMatrix,
    (inverse, solved): (&[f32], &[f32]),
    part: &Range<usize>,
    b: &impl Fn(usize, &mut [f32]),
    y: &mut [f32],
) {
    let start = part.start;
    for i in part.clone() {
        let ((below, inside, above), column) = (matrix.split_row(i), matrix.columns_by_entry(i));
        let mut r = [0.0; LANES];
        b(i, &mut r[..N]);
        let own = load::<N>(solved, i);
        let mut turned = leading::<N>(&r);
        multiply::<N>(matrix.diagonal(i), &array(|c| -own[c]), &mut turned);
        r[..N].copy_from_slice(&turned);
        for e in below.chain(matrix.middle(i)..inside.end).chain(above) {
            subtract::<N>(matrix.off_diagonal::<N>(e), &load::<N>(solved, column(e)), &mut r);
        }
        // subtracts both the product with the solution and that of the forward solve
        for e in inside.start..matrix.middle(i) {
            let j = column(e);
            let (x, y) = (load::<N>(solved, j), load::<N>(y, j - start));
            subtract::<N>(matrix.off_diagonal::<N>(e), &array(|c| x[c] + y[c]), &mut r);
        }
        add_pivoted::<N>(inverse, i, &r, [0.0; N], &mut y[(i - start) * N..]);
    }
    backward::<N>(matrix, inverse, part, y);
}

/// Computes x ← (D + U)⁻¹ D x for the rows of one part.
#[inline(always)]
fn backward<const N: usize>(matrix: &BlockMatrix, inverse: &[f32], part: &Range<usize>, x: &mut [f32]) {
    for i in part.clone().rev() {
        let ((_, inside, _), column) = (matrix.split_row(i), matrix.columns_by_entry(i));
        let mut r = [0.0; LANES];
        for e in matrix.middle(i)..inside.end {
            subtract::<N>(matrix.off_diagonal::<N>(e), &load::<N>(x, column(e) - part.start), &mut r);
        }
        let own = load::<N>(x, i - part.start);
        add_pivoted::<N>(inverse, i, &r, own, &mut x[(i - part.start) * N..]);
    }
}

/// Computes x_i = own + D_i⁻¹ r.
#[inline(always)]
fn add_pivoted<const N: usize>(inverse: &[f32], i: usize, r: &Lanes, own: [f32; N], x: &mut [f32]) {
    let mut y = own;
    multiply::<N>(&inverse[i * N * N..(i + 1) * N * N], &leading::<N>(r), &mut y);
    store(&y, x);
}

/// Pivot A_ii − Σ_{j<i} A_ij D_j⁻¹ A_ji, stored by columns; `before` holds the inverse pivots of the rows of the part
/// from `start` to i.
fn pivot<const N: usize>(matrix: &BlockMatrix, i: usize, start: usize, before: &[f32]) -> [[f64; N]; N] {
    let own = matrix.diagonal(i);
    let mut pivot: [[f64; N]; N] = array(|c| array(|r| f64::from(own[c * N + r])));
    let ((_, inside, _), column) = (matrix.split_row(i), matrix.columns_by_entry(i));
    for e in inside.start..matrix.middle(i) {
        let j = column(e);
        let Some(back) = matrix.entry(j, i) else { continue };
        let there = widen_block::<N>(matrix.off_diagonal::<N>(e));
        let back = widen_block::<N>(matrix.off_diagonal::<N>(back));
        let inverse = &before[(j - start) * N * N..(j - start + 1) * N * N];
        for c in 0..N {
            let mut t = [0.0; N];
            multiply::<N>(inverse, &leading::<N>(&back[c]), &mut t);
            for m in 0..N {
                (0..N).for_each(|r| pivot[c][r] -= f64::from(there[m][r] * t[m]));
            }
        }
    }
    pivot
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of `n` rows with blocks of order 2.
    fn chain(n: usize) -> BlockMatrix {
        let (mut first, mut index) = (vec![0u32], Vec::new());
        for i in 0..n {
            index.extend([i.wrapping_sub(1), i + 1].iter().filter(|j| **j < n).map(|j| *j as u32));
            first.push(index.len() as u32);
        }
        let mut matrix = BlockMatrix::new(2, &super::super::parallel::parts(n, n), &first.into(), &index.into());
        matrix.assemble(|_, rows| {
            for i in 0..n {
                rows.add(i, i, |r, c| if r == c { 4.0 } else { 0.25 });
                if i + 1 < n {
                    rows.add(i, i + 1, |r, c| if r == c { -1.5 } else { 0.5 });
                    rows.add(i + 1, i, |r, c| if r == c { -2.0 } else { -0.25 });
                }
            }
        });
        matrix
    }

    #[test]
    fn a_chain_is_solved_exactly() {
        let n = 40;
        let matrix = chain(n);
        let wanted: Vec<f32> = (0..2 * n).map(|k| ((k * 7) % 5) as f32 - 2.0).collect();
        let right = matrix.product(&wanted);
        let mut factors = Incomplete::default();
        factors.factor(&matrix);
        let mut z = vec![0.0; 2 * n];
        factors.apply(&matrix, |i, row| (0..2).for_each(|c| row[c] = right[2 * i + c]), &mut z);
        assert!(z.iter().zip(&wanted).all(|(z, w)| (z - f64::from(*w)).abs() < 1e-4), "{z:?}");
    }
}
