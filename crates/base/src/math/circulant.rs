//! Sweeps for linear systems that are periodic in time: (A + ∂/∂t) x = b at the 2N + 1 instances of a period.
//!
//! With the same matrix A at all instances, the system is block-circulant. Its Fourier coefficients in time decouple: A
//! x_0 = b_0 for the mean, and (A + imω) z_m = r_m for each harmonic, with z = c − is for c cos mωt + s sin mωt
//! (Mavriplis and Mundis, AIAA 2014-0571). All harmonics have the same off-diagonal blocks, which a sweep reads once
//! for all of them. The inverse of the diagonal differs for each harmonic: S A − imω S with S = (A² + m²ω²)⁻¹. Sweeps
//! use the same parts and order as those of [`BlockMatrix`].
use std::ops::Range;

use multiversion::multiversion;

use super::block_matrix::BlockMatrix;
use super::blocks::{store, with_block};
use super::parallel::{copy, fill, sweep_parts, sweep_two_parts};
use super::rounded::{LANES, Lanes, leading, load, multiply, subtract_wide, widen_block};

/// Maximum number of harmonics.
pub const MOST_HARMONICS: usize = 16;
/// Maximum number of coefficients of a row.
const MOST: usize = 2 * MOST_HARMONICS + 1;

/// Fourier coefficients of the solution of (A + ∂/∂t) x = b, in the order mean, cosine and sine of the first harmonic,
/// of the second, ..., with the partial sums that successive sweeps reuse.
#[derive(Clone, Debug)]
pub struct HarmonicSweeps {
    harmonics: usize,
    /// True if the mean is an unknown; else it is zero and stays zero.
    mean: bool,
    omega: f32,
    /// Right-hand side b.
    pub b: Vec<f32>,
    /// Solution x.
    pub x: Vec<f32>,
    /// Working storage: the solution before a half-sweep, or the residual b − (A + ∂/∂t) x.
    pub r: Vec<f32>,
    side: Vec<f32>,
    /// Real part and negative imaginary part of (A_ii + imω)⁻¹ for each harmonic.
    inverse: Vec<f32>,
}

impl HarmonicSweeps {
    /// Creates storage for the rows of `matrix`; without `mean`, only the harmonics are unknowns.
    pub fn new(matrix: &BlockMatrix, harmonics: usize, omega: f64, mean: bool) -> Self {
        let (n, size) = (matrix.n_rows(), matrix.block());
        let zero = vec![0.0; n * size * (2 * harmonics + 1)];
        let inverse = vec![0.0; n * size * size * 2 * harmonics];
        let omega = omega as f32;
        Self { harmonics, mean, omega, b: zero.clone(), x: zero.clone(), r: zero.clone(), side: zero, inverse }
    }

    /// Number of Fourier coefficients in time.
    pub fn count(&self) -> usize {
        2 * self.harmonics + 1
    }

    /// Memory in use (bytes).
    pub fn bytes(&self) -> usize {
        4 * (4 * self.b.len() + self.inverse.len())
    }

    /// Sets the solution to zero.
    pub fn clear(&mut self) {
        fill(&mut self.x, 0.0);
        fill(&mut self.side, 0.0);
    }

    /// Inverts the diagonal of each harmonic. Sweeps need this, after the inversion of the diagonal of the matrix.
    pub fn invert(&mut self, matrix: &BlockMatrix) {
        let (block, harmonics) = (matrix.block(), self.harmonics);
        let size = block * block;
        let omega = self.omega;
        if harmonics == 0 {
            return;
        }
        sweep_parts(matrix.parts(), 2 * harmonics * size, &mut self.inverse, &|k, out| {
            for (i, out) in matrix.parts()[k].clone().zip(out.chunks_exact_mut(2 * harmonics * size)) {
                for (m, out) in out.chunks_exact_mut(2 * size).enumerate() {
                    let beta = (m + 1) as f32 * omega;
                    invert_shifted(block, matrix.diagonal(i), beta, out);
                }
            }
        });
    }

    /// Performs one forward and one backward sweep, starting from `x`.
    pub fn symmetric_sweep(&mut self, matrix: &BlockMatrix) {
        match (matrix.block(), self.count(), self.mean) {
            (4, 3, false) => self.both_sweeps::<4, 3, 1>(matrix),
            (5, 3, false) => self.both_sweeps::<5, 3, 1>(matrix),
            (block, _, false) => with_block!(block, N => self.both_sweeps::<N, MOST, 1>(matrix)),
            (4, 3, _) => self.both_sweeps::<4, 3, 0>(matrix),
            (4, 5, _) => self.both_sweeps::<4, 5, 0>(matrix),
            (4, 7, _) => self.both_sweeps::<4, 7, 0>(matrix),
            (5, 3, _) => self.both_sweeps::<5, 3, 0>(matrix),
            (5, 5, _) => self.both_sweeps::<5, 5, 0>(matrix),
            (block, ..) => with_block!(block, N => self.both_sweeps::<N, MOST, 0>(matrix)),
        }
    }

    /// Sweeps the coefficients from index `FIRST` on.
    fn both_sweeps<const N: usize, const COUNT: usize, const FIRST: usize>(&mut self, matrix: &BlockMatrix) {
        let width = N * self.count();
        for forward in [true, false] {
            copy(&self.x, &mut self.r);
            let (known, parts) = ((&self.b[..], &self.r[..], &self.inverse[..], self.harmonics), matrix.parts());
            let outputs = ((parts, width, self.x.as_mut_slice()), (parts, width, &mut self.side[..]));
            sweep_two_parts(outputs.0, outputs.1, &|k, x, side| {
                relax_part::<N, COUNT, FIRST>(matrix, known, &parts[k], forward, (x, side));
            });
        }
    }

    /// Computes r = b − (A + ∂/∂t) x.
    pub fn residual(&mut self, matrix: &BlockMatrix) {
        match self.mean {
            true => with_block!(matrix.block(), N => self.residual_of::<N, 0>(matrix)),
            false => with_block!(matrix.block(), N => self.residual_of::<N, 1>(matrix)),
        }
    }

    fn residual_of<const N: usize, const FIRST: usize>(&mut self, matrix: &BlockMatrix) {
        let (count, omega) = (self.count(), self.omega);
        let known = (&self.b[..], &self.x[..], &self.side[..]);
        sweep_parts(matrix.parts(), N * count, &mut self.r, &|k, out| {
            residual_of_part::<N, FIRST>(matrix, known, (&matrix.parts()[k], count, omega), out);
        });
    }

    /// Recomputes the partial sums that a forward sweep needs, after a change of `x` by the caller.
    pub fn restart(&mut self, matrix: &BlockMatrix) {
        with_block!(matrix.block(), N => self.restart_of::<N>(matrix))
    }

    fn restart_of<const N: usize>(&mut self, matrix: &BlockMatrix) {
        let count = self.count();
        let x = &self.x;
        sweep_parts(matrix.parts(), N * count, &mut self.side, &|k, out| {
            sums_of_part::<N>(matrix, x, (&matrix.parts()[k], count), out);
        });
    }
}

/// Residual b − (A + ∂/∂t) x of one part, from the right-hand side, the solution and the sums of the last half-sweep.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn residual_of_part<const N: usize, const FIRST: usize>(
    matrix: &BlockMatrix,
    (b, x, side): (&[f32], &[f32], &[f32]),
    (part, count, omega): (&Range<usize>, usize, f32),
    out: &mut [f32],
) {
    for (i, row) in part.clone().zip(out.chunks_exact_mut(N * count)) {
        let (below, inside, above) = matrix.split_row(i);
        let (middle, column) = (matrix.middle(i), matrix.columns_by_entry(i));
        let mut sum = [[0.0; LANES]; MOST];
        let sum = &mut sum[..count];
        for e in below.chain(inside.start..middle).chain(above) {
            gather::<N, FIRST>(matrix, e, &x[column(e) * count * N..], sum);
        }
        let at = i * count;
        row[..FIRST * N].fill(0.0);
        for (c, sum) in sum.iter_mut().enumerate().skip(FIRST) {
            let mut own = [0.0; N];
            multiply::<N>(matrix.diagonal(i), &load::<N>(x, at + c), &mut own);
            // the time derivative of a cosine contributes to the sine, and vice versa
            let beta = c.div_ceil(2) as f32 * omega;
            let (partner, beta) = if c % 2 == 1 { (c + 1, beta) } else { (c.max(1) - 1, -beta) };
            let other = load::<N>(x, at + partner);
            for v in 0..N {
                let known = b[(at + c) * N + v] + sum[v] + side[(at + c) * N + v];
                row[c * N + v] = known - own[v] - beta * other[v];
            }
        }
    }
}

/// Sums over the columns after the diagonal inside one part.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn sums_of_part<const N: usize>(
    matrix: &BlockMatrix,
    x: &[f32],
    (part, count): (&Range<usize>, usize),
    out: &mut [f32],
) {
    for (i, row) in part.clone().zip(out.chunks_exact_mut(N * count)) {
        let ((_, inside, _), column) = (matrix.split_row(i), matrix.columns_by_entry(i));
        let mut sum = [[0.0; LANES]; MOST];
        for e in matrix.middle(i)..inside.end {
            gather::<N, 0>(matrix, e, &x[column(e) * count * N..], &mut sum[..count]);
        }
        row.chunks_exact_mut(N).zip(&sum).for_each(|(row, sum)| store(&leading::<N>(sum), row));
    }
}

/// Computes sum ← sum − B x for the coefficients of one neighbour, from index `FIRST` on.
#[inline(always)]
fn gather<const N: usize, const FIRST: usize>(matrix: &BlockMatrix, e: usize, x: &[f32], sum: &mut [Lanes]) {
    let block = widen_block::<N>(matrix.off_diagonal::<N>(e));
    for (x, sum) in x.chunks_exact(N).zip(sum).skip(FIRST) {
        subtract_wide::<N>(&block, x, sum);
    }
}

/// Half-sweep over one part, from the right-hand side, the previous solution and the inverse diagonals of all
/// harmonics.
#[multiversion(targets("x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn relax_part<const N: usize, const COUNT: usize, const FIRST: usize>(
    matrix: &BlockMatrix,
    (b, old, inverse, harmonics): (&[f32], &[f32], &[f32], usize),
    part: &Range<usize>,
    forward: bool,
    (x, side): (&mut [f32], &mut [f32]),
) {
    for k in 0..part.len() {
        let i = if forward { part.start + k } else { part.end - 1 - k };
        let own = (&inverse[i * 2 * harmonics * N * N..(i + 1) * 2 * harmonics * N * N], harmonics);
        relax_row::<N, COUNT, FIRST>(matrix, own, (i, part), (b, old), forward, (x, side));
    }
}

/// Computes x_i = (A_ii + ∂/∂t)⁻¹ (b_i − Σ_j A_ij x_j) for `COUNT` coefficients, or for any number if `COUNT` is
/// [`MOST`].
#[inline(always)]
fn relax_row<const N: usize, const COUNT: usize, const FIRST: usize>(
    matrix: &BlockMatrix,
    (inverse, harmonics): (&[f32], usize),
    (i, part): (usize, &Range<usize>),
    (b, old): (&[f32], &[f32]),
    forward: bool,
    (x, side): (&mut [f32], &mut [f32]),
) {
    let count = if COUNT == MOST { 2 * harmonics + 1 } else { COUNT };
    let at = (i - part.start) * count * N;
    let (below, inside, above) = matrix.split_row(i);
    let (middle, column) = (matrix.middle(i), matrix.columns_by_entry(i));
    let mut r = [[0.0; LANES]; COUNT];
    let mut sum = [[0.0; LANES]; COUNT];
    for e in below.chain(above) {
        gather::<N, FIRST>(matrix, e, &old[column(e) * count * N..], &mut r[..count]);
    }
    let swept = if forward { inside.start..middle } else { middle..inside.end };
    for e in swept {
        gather::<N, FIRST>(matrix, e, &x[(column(e) - part.start) * count * N..], &mut sum[..count]);
    }
    for c in FIRST..count {
        for v in 0..N {
            r[c][v] += b[(i * count + c) * N + v] + side[at + c * N + v] + sum[c][v];
        }
        store(&leading::<N>(&sum[c]), &mut side[at + c * N..]);
    }
    if FIRST == 0 {
        let mut y = [0.0; N];
        multiply::<N>(matrix.inverse(i), &leading::<N>(&r[0]), &mut y);
        store(&y, &mut x[at..]);
    }
    for m in 0..harmonics {
        let own = &inverse[m * 2 * N * N..(m + 1) * 2 * N * N];
        let (real, imaginary) = own.split_at(N * N);
        let (rc, rs) = (&leading::<N>(&r[2 * m + 1]), &leading::<N>(&r[2 * m + 2]));
        // (P − iQ)(r_c − i r_s) = (P r_c − Q r_s) − i (P r_s + Q r_c)
        let (mut c, mut s, mut q) = ([0.0; N], [0.0; N], [0.0; N]);
        multiply::<N>(real, rc, &mut c);
        multiply::<N>(imaginary, rs, &mut q);
        multiply::<N>(real, rs, &mut s);
        multiply::<N>(imaginary, rc, &mut s);
        let from = at + (2 * m + 1) * N;
        for v in 0..N {
            x[from + v] = c[v] - q[v];
            x[from + N + v] = s[v];
        }
    }
}

/// Real part and negative imaginary part of (A + iβ)⁻¹, stored by columns; zero for a singular matrix.
fn invert_shifted(n: usize, a: &[f32], beta: f32, out: &mut [f32]) {
    let size = n * n;
    let mut square = [0.0f64; 36];
    let at = |r: usize, c: usize| f64::from(a[c * n + r]);
    for r in 0..n {
        for c in 0..n {
            square[c * n + r] = (0..n).map(|k| at(r, k) * at(k, c)).sum();
        }
        square[r * n + r] += f64::from(beta).powi(2);
    }
    let mut inverse = [0.0f64; 36];
    super::blocks::invert(n, &square[..size], &mut inverse[..size]);
    for r in 0..n {
        for c in 0..n {
            let real: f64 = (0..n).map(|k| inverse[k * n + r] * at(k, c)).sum();
            out[c * n + r] = real as f32;
            out[size + c * n + r] = (inverse[c * n + r] * f64::from(beta)) as f32;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::fourier::Instances;

    /// Off-diagonal entries that are stored without rounding error: 127 and -16 units.
    const OFF: [f64; 2] = [-127.0 / 128.0, 16.0 / 128.0];

    /// Rows of a chain that couple to both neighbours.
    fn chain(n: usize) -> BlockMatrix {
        let mut first = vec![0u32];
        let mut index = Vec::new();
        for i in 0..n as i64 {
            index.extend([i - 1, i, i + 1].iter().filter(|j| (0..n as i64).contains(j)).map(|j| *j as u32));
            first.push(index.len() as u32);
        }
        let parts: Vec<_> = (0..n).step_by(7).map(|s| s..(s + 7).min(n)).collect();
        let mut matrix = BlockMatrix::new(3, &parts, &first.into(), &index.into());
        matrix.assemble(|k, rows| {
            for i in parts[k].clone() {
                rows.add(i, i, |r, c| if r == c { 2.5 + 0.5 * r as f64 } else { 0.25 * (r as f64 - c as f64) });
                for j in [i.wrapping_sub(1), i + 1].into_iter().filter(|j| *j < n) {
                    rows.add(i, j, |r, c| OFF[usize::from(r != c)]);
                }
            }
        });
        matrix.invert_diagonal();
        matrix
    }

    #[test]
    fn sweeps_solve_the_system_in_time() {
        let (n, harmonics, omega) = (23, 2, 0.7);
        let matrix = chain(n);
        let mut harmonic_sweeps = HarmonicSweeps::new(&matrix, harmonics, omega, true);
        harmonic_sweeps.invert(&matrix);
        harmonic_sweeps.b.iter_mut().enumerate().for_each(|(k, b)| *b = ((k * k) as f32 * 0.37).sin());
        for _ in 0..40 {
            harmonic_sweeps.symmetric_sweep(&matrix);
        }
        harmonic_sweeps.residual(&matrix);
        assert!(
            harmonic_sweeps.r.iter().all(|r| r.abs() < 1e-5),
            "{:?}",
            harmonic_sweeps.r.iter().fold(0.0f32, |a, b| a.max(b.abs()))
        );
        // the same system in values at the instances: A x_n + ω Σ D_nj x_j = b_n
        let instances = Instances::of_harmonics(harmonics);
        let count = instances.count();
        let value = |v: &[f32], i: usize, d: usize, n: usize| -> f64 {
            let phase = std::f64::consts::TAU * n as f64 / count as f64;
            (0..count)
                .map(|c| {
                    let m = c.div_ceil(2) as f64 * phase;
                    f64::from(v[(i * count + c) * 3 + d])
                        * if c % 2 == 1 { m.cos() } else { m.sin() + f64::from(u8::from(c == 0)) }
                })
                .sum()
        };
        let derivative = instances.derivative(omega);
        for i in 1..n - 1 {
            for d in 0..3 {
                for k in 0..count {
                    let x = |i: usize, d: usize| value(&harmonic_sweeps.x, i, d, k);
                    let entry =
                        |r: usize, c: usize| if r == c { 2.5 + 0.5 * r as f64 } else { 0.25 * (r as f64 - c as f64) };
                    let own: f64 = (0..3).map(|c| entry(d, c) * x(i, c)).sum();
                    let off = |j: usize| (0..3).map(|c| OFF[usize::from(c != d)] * x(j, c)).sum::<f64>();
                    let rate: f64 = (0..count).map(|j| derivative.row(k)[j] * value(&harmonic_sweeps.x, i, d, j)).sum();
                    let left = own + off(i - 1) + off(i + 1) + rate;
                    assert!((left - value(&harmonic_sweeps.b, i, d, k)).abs() < 1e-4, "{i} {d} {k}");
                }
            }
        }
    }

    #[test]
    fn harmonics_alone_are_those_beside_a_mean() {
        let matrix = chain(23);
        let [whole, alone] = [true, false].map(|mean| {
            let mut sweeps = HarmonicSweeps::new(&matrix, 1, 0.7, mean);
            sweeps.invert(&matrix);
            sweeps.b.iter_mut().enumerate().for_each(|(k, b)| *b = ((k * k) as f32 * 0.37).sin());
            (0..3).for_each(|_| sweeps.symmetric_sweep(&matrix));
            sweeps.residual(&matrix);
            sweeps
        });
        for (k, values) in [(&whole.x, &alone.x), (&whole.r, &alone.r)].into_iter().enumerate() {
            let rows = values.0.chunks_exact(9).zip(values.1.chunks_exact(9));
            rows.for_each(|(a, b)| assert!(a[3..] == b[3..] && b[..3] == [0.0; 3], "{k}: {a:?} {b:?}"));
        }
    }

    #[test]
    fn restarts_hold_what_sweeps_summed() {
        let matrix = chain(20);
        let mut harmonic_sweeps = HarmonicSweeps::new(&matrix, 1, 2.0, true);
        harmonic_sweeps.invert(&matrix);
        harmonic_sweeps.b.fill(1.0);
        harmonic_sweeps.symmetric_sweep(&matrix);
        let (x, side) = (harmonic_sweeps.x.clone(), harmonic_sweeps.side.clone());
        harmonic_sweeps.restart(&matrix);
        assert_eq!(x, harmonic_sweeps.x);
        assert!(side.iter().zip(&harmonic_sweeps.side).all(|(a, b)| (a - b).abs() < 1e-6));
    }
}
