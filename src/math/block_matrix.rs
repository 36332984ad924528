//! Sparse matrices of small dense blocks, in single precision: what implicit steps are preconditioned with.
//!
//! Rows are particles. The blocks of a row follow one another, its diagonal block first; each block is stored column by
//! column. Sweeps are Gauss-Seidel inside fixed parts of consecutive rows and Jacobi between them, so that the result does
//! not depend on the number of threads.
use std::ops::Range;

use super::sweep::{parts, sweep_parts};

/// Rows in one part of a Gauss-Seidel sweep.
const PART: usize = 1024;

/// A sparse matrix of square blocks.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix {
    block: usize,
    first: Vec<u32>,
    column: Vec<u32>,
    value: Vec<f32>,
    inverse: Vec<f32>,
    parts: Vec<Range<usize>>,
    value_parts: Vec<Range<usize>>,
}

impl BlockMatrix {
    /// A matrix with `n` rows whose row i couples to the columns `index[first[i]..first[i + 1]]` below `n`, and to itself.
    ///
    /// `parts` are the consecutive rows that are assembled and swept together.
    pub fn new(block: usize, parts: &[Range<usize>], first: &[u32], index: &[u32]) -> Self {
        let n = parts.last().map_or(0, |p| p.end);
        let mut own_first = vec![0u32];
        let mut column = Vec::with_capacity(index.len() + n);
        for i in 0..n {
            column.push(i as u32);
            let row = &index[first[i] as usize..first[i + 1] as usize];
            column.extend(row.iter().filter(|j| (**j as usize) < n && **j as usize != i));
            own_first.push(column.len() as u32);
        }
        Self::from_pattern(block, own_first, column, parts.to_vec())
    }

    fn from_pattern(block: usize, first: Vec<u32>, column: Vec<u32>, parts: Vec<Range<usize>>) -> Self {
        let size = block * block;
        let value_parts = parts.iter().map(|p| first[p.start] as usize..first[p.end] as usize).collect();
        let n = first.len() - 1;
        Self {
            block,
            value: vec![0.0; column.len() * size],
            inverse: vec![0.0; n * size],
            first,
            column,
            parts,
            value_parts,
        }
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.first.len() - 1
    }

    /// Order of the blocks.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        4 * (self.value.len() + self.inverse.len() + self.column.len() + self.first.len())
    }

    /// Parts in which rows are assembled and swept.
    pub fn parts(&self) -> &[Range<usize>] {
        &self.parts
    }

    /// Calls `f(k, rows)` for every part; `rows` gives write access to the blocks of the rows of part `k`.
    pub fn assemble(&mut self, f: impl Fn(usize, &mut Rows<'_>) + Sync) {
        let (first, column, block, parts) = (&self.first, &self.column, self.block, &self.parts);
        sweep_parts(&self.value_parts, block * block, &mut self.value, &|k, value| {
            value.fill(0.0);
            let base = first[parts[k].start] as usize;
            f(k, &mut Rows { first, column, value, base, size: block * block });
        });
    }

    /// Adds `shift[i]` to the diagonal of row i.
    pub fn shift(&mut self, shift: &[f64]) {
        let n = self.block;
        for (i, s) in shift.iter().enumerate() {
            let start = self.first[i] as usize * n * n;
            (0..n).for_each(|d| self.value[start + d * (n + 1)] += *s as f32);
        }
    }

    /// Inverts the diagonal blocks: needed before a sweep.
    pub fn invert_diagonal(&mut self) {
        let size = self.block * self.block;
        let (first, value, block, parts) = (&self.first, &self.value, self.block, &self.parts);
        sweep_parts(parts, size, &mut self.inverse, &|k, out| {
            for (i, inverse) in parts[k].clone().zip(out.chunks_exact_mut(size)) {
                let start = first[i] as usize * size;
                invert(block, &value[start..start + size], inverse);
            }
        });
    }

    /// One forward and one backward sweep for A x = b, starting from `x`; `old` is scratch of the same length.
    pub fn symmetric_sweep(&self, b: &[f32], x: &mut [f32], old: &mut [f32]) {
        for forward in [true, false] {
            old.copy_from_slice(x);
            match self.block {
                4 => self.half_sweep::<4>(b, x, old, forward),
                5 => self.half_sweep::<5>(b, x, old, forward),
                3 => self.half_sweep::<3>(b, x, old, forward),
                _ => self.half_sweep::<1>(b, x, old, forward),
            }
        }
    }

    fn half_sweep<const N: usize>(&self, b: &[f32], x: &mut [f32], old: &[f32], forward: bool) {
        sweep_parts(&self.parts, N, x, &|k, own| {
            let part = self.parts[k].clone();
            let mut row = |i: usize| {
                let mut r = load::<N>(b, i);
                for e in self.first[i] as usize + 1..self.first[i + 1] as usize {
                    let j = self.column[e] as usize;
                    let xj = if part.contains(&j) { load::<N>(own, j - part.start) } else { load::<N>(old, j) };
                    subtract::<N>(&self.value[e * N * N..(e + 1) * N * N], &xj, &mut r);
                }
                let mut y = [0.0; N];
                subtract::<N>(&self.inverse[i * N * N..(i + 1) * N * N], &r, &mut y);
                let at = (i - part.start) * N;
                (0..N).for_each(|c| own[at + c] = -y[c]);
            };
            if forward { part.clone().for_each(&mut row) } else { part.clone().rev().for_each(&mut row) }
        });
    }

    /// r = b − A x.
    pub fn residual(&self, b: &[f32], x: &[f32], r: &mut [f32]) {
        match self.block {
            4 => self.residual_of::<4>(b, x, r),
            5 => self.residual_of::<5>(b, x, r),
            3 => self.residual_of::<3>(b, x, r),
            _ => self.residual_of::<1>(b, x, r),
        }
    }

    fn residual_of<const N: usize>(&self, b: &[f32], x: &[f32], r: &mut [f32]) {
        sweep_parts(&self.parts, N, r, &|k, out| {
            for (i, row) in self.parts[k].clone().zip(out.chunks_exact_mut(N)) {
                let mut sum = load::<N>(b, i);
                for e in self.first[i] as usize..self.first[i + 1] as usize {
                    let xj = load::<N>(x, self.column[e] as usize);
                    subtract::<N>(&self.value[e * N * N..(e + 1) * N * N], &xj, &mut sum);
                }
                row.copy_from_slice(&sum);
            }
        });
    }

    /// The pattern of the matrix that couples groups of rows, and where each block of this one goes.
    pub fn coarse(&self, group: &[u32], n_groups: usize) -> (Self, Vec<u32>) {
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); n_groups];
        group.iter().enumerate().for_each(|(i, g)| members[*g as usize].push(i as u32));
        let mut first = vec![0u32];
        let mut column: Vec<u32> = Vec::new();
        let mut target = vec![0u32; self.column.len()];
        let mut place = vec![u32::MAX; n_groups];
        for (g, rows) in members.iter().enumerate() {
            let start = column.len() as u32;
            column.push(g as u32);
            place[g] = start;
            for i in rows {
                for e in self.first[*i as usize] as usize..self.first[*i as usize + 1] as usize {
                    let c = group[self.column[e] as usize];
                    if place[c as usize] == u32::MAX || place[c as usize] < start {
                        place[c as usize] = column.len() as u32;
                        column.push(c);
                    }
                    target[e] = place[c as usize];
                }
            }
            first.push(column.len() as u32);
        }
        let parts = parts(n_groups, PART);
        (Self::from_pattern(self.block, first, column, parts), target)
    }

    /// Adds the blocks of `fine` into this matrix; `target` says where each goes.
    pub fn gather(&mut self, fine: &Self, target: &[u32]) {
        let size = self.block * self.block;
        self.value.fill(0.0);
        for (e, t) in target.iter().enumerate() {
            let from = &fine.value[e * size..(e + 1) * size];
            let to = &mut self.value[*t as usize * size..(*t as usize + 1) * size];
            to.iter_mut().zip(from).for_each(|(a, b)| *a += b);
        }
    }

    /// Columns of row `i`, itself first.
    pub fn columns(&self, i: usize) -> &[u32] {
        &self.column[self.first[i] as usize..self.first[i + 1] as usize]
    }

    /// Size of the coupling of entry `k` of row `i`.
    pub fn strength(&self, i: usize, k: usize) -> f32 {
        let size = self.block * self.block;
        let e = self.first[i] as usize + k;
        self.value[e * size..(e + 1) * size].iter().map(|v| v * v).sum()
    }
}

/// Write access to the blocks of the rows of one part.
pub struct Rows<'a> {
    first: &'a [u32],
    column: &'a [u32],
    value: &'a mut [f32],
    base: usize,
    size: usize,
}

impl Rows<'_> {
    /// The block that couples row `i` to column `j`, or `None` when the pattern has none.
    #[inline]
    pub fn block(&mut self, i: usize, j: usize) -> Option<&mut [f32]> {
        let start = self.first[i] as usize;
        let e = if i == j {
            start
        } else {
            let row = &self.column[start + 1..self.first[i + 1] as usize];
            start + 1 + row.binary_search(&(j as u32)).ok()?
        };
        let at = (e - self.base) * self.size;
        Some(&mut self.value[at..at + self.size])
    }
}

#[inline(always)]
fn load<const N: usize>(x: &[f32], i: usize) -> [f32; N] {
    let mut out = [0.0; N];
    out.copy_from_slice(&x[i * N..(i + 1) * N]);
    out
}

/// r ← r − B x for a block stored by columns.
#[inline(always)]
fn subtract<const N: usize>(block: &[f32], x: &[f32; N], r: &mut [f32; N]) {
    for c in 0..N {
        for k in 0..N {
            r[k] -= block[c * N + k] * x[c];
        }
    }
}

/// Inverse of a small matrix by Gauss-Jordan elimination with row pivoting; a singular one gives the zero matrix.
fn invert(n: usize, a: &[f32], out: &mut [f32]) {
    let mut m = [[0.0f64; 12]; 6];
    for r in 0..n {
        for c in 0..n {
            m[r][c] = f64::from(a[c * n + r]);
        }
        m[r][n + r] = 1.0;
    }
    for p in 0..n {
        let pivot = (p..n).fold(p, |b, r| if m[r][p].abs() > m[b][p].abs() { r } else { b });
        m.swap(p, pivot);
        if m[p][p] == 0.0 || !m[p][p].is_finite() {
            out.fill(0.0);
            return;
        }
        let scale = 1.0 / m[p][p];
        m[p].iter_mut().for_each(|v| *v *= scale);
        for r in 0..n {
            if r != p && m[r][p] != 0.0 {
                let f = m[r][p];
                let pivot_row = m[p];
                m[r].iter_mut().zip(&pivot_row).for_each(|(v, w)| *v -= f * w);
            }
        }
    }
    for r in 0..n {
        for c in 0..n {
            out[c * n + r] = m[r][n + c] as f32;
        }
    }
}
