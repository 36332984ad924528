//! Sparse matrices of small dense blocks, for the preconditioners of implicit steps.
//!
//! Each row belongs to a particle. Blocks are stored column by column: diagonal blocks in single precision,
//! off-diagonal blocks as integers from -127 to 127 times one unit for each block. This precision suffices for a
//! preconditioner, and the cost of a sweep is the time to read the blocks. The rounding error of a block is added to
//! the diagonal of its row. Unknowns should be scaled so that the entries of a block have similar magnitudes
//! ([`BlockMatrix::assemble`]). Sweeps are Gauss-Seidel inside fixed parts of consecutive rows and Jacobi between
//! parts, so that the result does not depend on the number of threads.
mod rows;

use std::ops::Range;
use std::sync::Arc;

use multiversion::multiversion;

use super::blocks::{MOST_ENTRIES, array, invert_block, store, with_block};
use super::parallel::{copy, fill, parts, sweep_parts, sweep_rows, sweep_two_parts};
use super::rounded::{LANES, UNIT, add_block, leading, load, load_lanes, multiply, round_block, subtract};

pub use rows::Rows;

/// Minimum and maximum number of rows in one part of a coarse matrix.
const PART: [usize; 2] = [64, 1024];
/// Number of parts of a coarse matrix, unless the parts would be smaller than the minimum.
const MANY_PARTS: usize = 8;

/// Number of blocks of a row of a coarse matrix that are summed at a time.
const WINDOW: usize = 64;

/// A sparse matrix of square blocks.
#[derive(Clone, Debug, Default)]
pub struct BlockMatrix {
    block: usize,
    /// Index of the first entry of each row, followed by the number of all entries.
    first: Arc<Vec<u32>>,
    column: Columns,
    /// For each row, three positions relative to its first entry: the first entry inside its part, the first one after
    /// the diagonal, and the first one after its part.
    cut: Vec<[u16; 3]>,
    /// Unit and entries of each off-diagonal block, followed by [`LANES`] unused entries.
    value: Vec<u8>,
    /// Diagonal blocks as assembled, or their inverses after [`Self::make_sweepable`].
    diagonal: Vec<f32>,
    /// Inverses of the diagonal blocks after [`Self::invert_diagonal`], else empty.
    inverse: Vec<f32>,
    parts: Vec<Range<usize>>,
    value_parts: Vec<Range<usize>>,
    /// Weight of each assembly in a mean; `None` if an assembly replaces the blocks.
    weight: Option<f32>,
    /// Magnitudes of the unknowns of a row; the stored blocks refer to unknowns divided by them.
    scale: Vec<f32>,
}

/// Off-diagonal columns of each row in ascending order. The lists may be shared with other owners.
#[derive(Clone, Debug, Default)]
struct Columns {
    /// Start of the list of each row.
    start: Arc<Vec<u32>>,
    list: Arc<Vec<u32>>,
}

impl Columns {
    /// Columns of row `i` of a matrix with these first entries.
    #[inline(always)]
    fn of(&self, i: usize, first: &[u32]) -> &[u32] {
        let start = self.start[i] as usize;
        &self.list[start..start + (first[i + 1] - first[i]) as usize]
    }

    /// Memory that is not shared with other owners (bytes).
    fn bytes(&self) -> usize {
        if Arc::strong_count(&self.list) == 1 { 4 * self.list.len() } else { 0 }
    }
}

/// An approximate solution of A x = b, with the partial sums that successive sweeps reuse.
#[derive(Clone, Debug, Default)]
pub struct Sweeps {
    /// Right-hand side b.
    pub b: Vec<f32>,
    /// Solution x.
    pub x: Vec<f32>,
    /// Working storage: the solution before a half-sweep.
    old: Vec<f32>,
    /// For each row, the sum over the columns of the same part on the side of the diagonal that the last half-sweep
    /// visited, or the residual b − A x.
    pub side: Vec<f32>,
}

impl Sweeps {
    /// Creates storage for the rows of `matrix`.
    pub fn new(matrix: &BlockMatrix) -> Self {
        let zero = vec![0.0; matrix.n_rows() * matrix.block];
        Self { b: zero.clone(), x: zero.clone(), old: zero.clone(), side: zero }
    }

    /// Memory in use (bytes).
    pub fn bytes(&self) -> usize {
        16 * self.b.len()
    }

    /// Sets the solution to zero.
    pub fn clear(&mut self) {
        fill(&mut self.x, 0.0);
        fill(&mut self.side, 0.0);
    }
}

impl BlockMatrix {
    /// Creates a matrix in which row i couples to itself and to the columns `index[first[i]..first[i + 1]]`, in
    /// ascending order and smaller than the number of rows. Lists that do not contain i are shared, not copied: in 3-D
    /// they take an eighth of the memory of the matrix.
    ///
    /// `parts` are the ranges of consecutive rows that are assembled and swept together.
    ///
    /// # Panics
    ///
    /// If no kernel exists for blocks of that order, see [`super::blocks`], or a row couples to more than 65,535
    /// others.
    pub fn new(block: usize, parts: &[Range<usize>], first: &Arc<Vec<u32>>, index: &Arc<Vec<u32>>) -> Self {
        super::blocks::assert_served(block);
        let n = parts.last().map_or(0, |p| p.end);
        let row = |i: usize| {
            let row = &index[first[i] as usize..first[i + 1] as usize];
            &row[..row.partition_point(|j| (*j as usize) < n)]
        };
        let mut ends = Vec::with_capacity(n + 1);
        ends.push(0u32);
        if (0..n).all(|i| row(i).binary_search(&(i as u32)).is_err()) {
            (0..n).for_each(|i| ends.push(ends[i] + row(i).len() as u32));
            let column = Columns { start: Arc::clone(first), list: Arc::clone(index) };
            return Self::from_pattern(block, Arc::new(ends), column, parts.to_vec());
        }
        let mut list = Vec::new();
        for i in 0..n {
            list.extend(row(i).iter().filter(|j| **j as usize != i));
            ends.push(list.len() as u32);
        }
        Self::from_lists(block, ends, list, parts.to_vec())
    }

    /// Creates the matrix from `list`, the off-diagonal columns of each row in ascending order.
    fn from_lists(block: usize, first: Vec<u32>, mut list: Vec<u32>, parts: Vec<Range<usize>>) -> Self {
        list.shrink_to_fit();
        let first = Arc::new(first);
        let column = Columns { start: Arc::clone(&first), list: Arc::new(list) };
        Self::from_pattern(block, first, column, parts)
    }

    fn from_pattern(block: usize, first: Arc<Vec<u32>>, column: Columns, parts: Vec<Range<usize>>) -> Self {
        let size = block * block;
        let value_parts = parts.iter().map(|p| first[p.start] as usize..first[p.end] as usize).collect();
        let n = first.len() - 1;
        let cut = parts.iter().flat_map(|p| p.clone().map(|i| cut(i, p, column.of(i, &first)))).collect();
        Self {
            block,
            cut,
            value: vec![0; first[n] as usize * (UNIT + size) + LANES],
            diagonal: vec![0.0; n * size],
            inverse: Vec::new(),
            first,
            column,
            parts,
            value_parts,
            weight: None,
            scale: vec![1.0; block],
        }
    }

    /// This matrix for unknowns of the magnitudes `scale`. Assembly scales the blocks; [`Self::enter`] and
    /// [`Self::leave`] convert right-hand sides and solutions.
    ///
    /// # Panics
    ///
    /// If the length of `scale` is not the number of unknowns of a row.
    pub fn scaled(self, scale: &[f64]) -> Self {
        assert_eq!(scale.len(), self.block);
        Self { scale: scale.iter().map(|s| *s as f32).collect(), ..self }
    }

    /// Converts right-hand sides, row by row, to those of the scaled matrix.
    #[inline(always)]
    pub fn enter(&self, b: &mut [f32]) {
        b.chunks_exact_mut(self.block).for_each(|b| b.iter_mut().zip(&self.scale).for_each(|(b, s)| *b /= s));
    }

    /// Entry `k` of a solution of the scaled matrix, converted to the original unknowns.
    #[inline(always)]
    pub fn leave(&self, x: &[f32], k: usize) -> f32 {
        x[k] * self.scale[k % self.block]
    }

    /// Makes the matrix the mean of the next `count` assemblies, until [`Self::end_mean`].
    pub fn begin_mean(&mut self, count: usize) {
        self.weight = Some(1.0 / count as f32);
        fill(&mut self.value, 0);
        fill(&mut self.diagonal, 0.0);
    }

    /// Ends a mean: later assemblies replace the blocks.
    pub fn end_mean(&mut self) {
        self.weight = None;
    }

    /// Number of rows.
    pub fn n_rows(&self) -> usize {
        self.first.len() - 1
    }

    /// Order of the blocks.
    pub fn block(&self) -> usize {
        self.block
    }

    /// Memory in use (bytes).
    pub fn bytes(&self) -> usize {
        self.value.len()
            + self.column.bytes()
            + 4 * (self.diagonal.len() + self.inverse.len() + self.first.len())
            + 6 * self.cut.len()
    }

    /// Ranges of rows that are assembled and swept together.
    pub fn parts(&self) -> &[Range<usize>] {
        &self.parts
    }

    /// Calls `f(k, rows)` for every part k, where `rows` adds to the blocks of its rows, which are initially zero.
    ///
    /// An entry smaller than 1/254 of the largest entry of its off-diagonal block is rounded to zero.
    pub fn assemble(&mut self, f: impl Fn(usize, &mut Rows<'_>) + Sync) {
        let (first, column, block, parts) = (&self.first, &self.column, self.block, &self.parts);
        let (size, weight) = (block * block, self.weight);
        let mut factor = [0.0; MOST_ENTRIES];
        for (k, factor) in factor[..size].iter_mut().enumerate() {
            *factor = weight.unwrap_or(1.0) * self.scale[k / block] / self.scale[k % block];
        }
        let values = (self.value_parts.as_slice(), UNIT + size, self.value.as_mut_slice());
        let diagonals = (parts.as_slice(), size, self.diagonal.as_mut_slice());
        sweep_two_parts(values, diagonals, &|k, value, diagonal| {
            if weight.is_none() {
                value.fill(0);
                diagonal.fill(0.0);
            }
            let start = parts[k].start;
            f(k, &mut Rows { first, column, value, diagonal, start, block, factor: &factor });
        });
    }

    /// Adds `shift(i)` to the diagonal entries of row i.
    pub fn shift(&mut self, shift: impl Fn(usize) -> f64 + Sync) {
        let n = self.block;
        sweep_rows(&mut self.diagonal, n * n, |i, diagonal| {
            let shift = shift(i) as f32;
            (0..n).for_each(|d| diagonal[d * (n + 1)] += shift);
        });
    }

    /// Replaces the diagonal blocks by their inverses. Sweeps need this; the next assembly restores the blocks.
    pub fn make_sweepable(&mut self) {
        let (block, size) = (self.block, self.block * self.block);
        sweep_rows(&mut self.diagonal, size, |_, own| invert_block(block, own));
    }

    /// Computes the inverses of the diagonal blocks and keeps the blocks as well.
    pub fn invert_diagonal(&mut self) {
        let (block, size) = (self.block, self.block * self.block);
        self.inverse.resize(self.diagonal.len(), 0.0);
        copy(&self.diagonal, &mut self.inverse);
        sweep_rows(&mut self.inverse, size, |_, own| invert_block(block, own));
    }

    /// Performs one forward and one backward sweep for A x = b, starting from `s.x`.
    ///
    /// The forward sweep needs the sums over the columns after the diagonal, which the preceding backward sweep has
    /// computed, and vice versa (Conrad and Wallach 1979). Each half-sweep therefore visits only half of the blocks.
    pub fn symmetric_sweep(&self, s: &mut Sweeps) {
        with_block!(self.block, N => self.both_sweeps::<N>(s))
    }

    fn both_sweeps<const N: usize>(&self, s: &mut Sweeps) {
        for forward in [true, false] {
            copy(&s.x, &mut s.old);
            let (b, old) = (&s.b, &s.old);
            let (parts, x) = (self.parts.as_slice(), s.x.as_mut_slice());
            sweep_two_parts((parts, N, x), (parts, N, &mut s.side[..]), &|k, x, side| {
                relax_part::<N>(self, &self.parts[k], (b, old), forward, (x, side));
            });
        }
    }

    /// Computes x_i = A_ii⁻¹ (b_i − Σ_j A_ij x_j).
    #[inline(always)]
    fn relax_row<const N: usize>(
        &self,
        i: usize,
        part: &Range<usize>,
        (b, old): (&[f32], &[f32]),
        forward: bool,
        (x, side): (&mut [f32], &mut [f32]),
    ) {
        let at = (i - part.start) * N;
        let (below, inside, above) = self.split_row(i);
        let (middle, column) = (self.middle(i), self.columns_by_entry(i));
        let mut r = load_lanes::<N>(b, i);
        for e in below.chain(above) {
            subtract::<N>(self.off_diagonal::<N>(e), &load::<N>(old, column(e)), &mut r);
        }
        let swept = if forward { inside.start..middle } else { middle..inside.end };
        let mut sum = [0.0; LANES];
        for e in swept {
            subtract::<N>(self.off_diagonal::<N>(e), &load::<N>(x, column(e) - part.start), &mut sum);
        }
        let side = &mut side[at..at + N];
        (0..N).for_each(|c| r[c] += side[c] + sum[c]);
        store(&leading::<N>(&sum), side);
        let mut y = [0.0; N];
        multiply::<N>(&self.diagonal[i * N * N..(i + 1) * N * N], &leading::<N>(&r), &mut y);
        store(&y, &mut x[at..]);
    }

    /// Ranges of the entries of row `i` before, inside and after its part.
    #[inline(always)]
    pub(super) fn split_row(&self, i: usize) -> (Range<usize>, Range<usize>, Range<usize>) {
        let (first, [from, _, to]) = (self.first[i] as usize, self.cut[i].map(usize::from));
        (first..first + from, first + from..first + to, first + to..self.first[i + 1] as usize)
    }

    /// Columns of the entries of row `i`.
    #[inline(always)]
    pub(super) fn columns_by_entry(&self, i: usize) -> impl Fn(usize) -> usize + Copy + '_ {
        let (columns, first) = (self.columns(i), self.first[i] as usize);
        move |e| columns[e - first] as usize
    }

    /// Index of the entry of row `i` in column `j`; `None` if the pattern has no such entry.
    pub(super) fn entry(&self, i: usize, j: usize) -> Option<usize> {
        self.columns(i).binary_search(&(j as u32)).ok().map(|k| self.first[i] as usize + k)
    }

    /// Index of the first entry of row `i` inside its part after the diagonal.
    #[inline(always)]
    pub(super) fn middle(&self, i: usize) -> usize {
        self.first[i] as usize + usize::from(self.cut[i][1])
    }

    /// Diagonal block of row `i`, stored by columns, as assembled; not valid after [`Self::make_sweepable`].
    #[inline(always)]
    pub(super) fn diagonal(&self, i: usize) -> &[f32] {
        &self.diagonal[i * self.block * self.block..(i + 1) * self.block * self.block]
    }

    /// Inverse of the diagonal block of row `i`, stored by columns.
    #[inline(always)]
    pub(super) fn inverse(&self, i: usize) -> &[f32] {
        &self.inverse[i * self.block * self.block..(i + 1) * self.block * self.block]
    }

    /// Unit and entries of entry `e`, together with the bytes that follow.
    #[inline(always)]
    pub(super) fn off_diagonal<const N: usize>(&self, e: usize) -> &[u8] {
        let at = e * (UNIT + N * N);
        &self.value[at..at + UNIT + (N - 1) * N + LANES]
    }

    /// Computes s.side = b − A x after a sweep.
    ///
    /// The backward half-sweep solved every row with the values of the other rows at that time. The residual of a row
    /// therefore follows from the later changes of the rows that were not yet visited and of those in other parts.
    pub fn residual(&self, s: &mut Sweeps) {
        with_block!(self.block, N => self.residual_of::<N>(s))
    }

    fn residual_of<const N: usize>(&self, s: &mut Sweeps) {
        let (x, old) = (&s.x, &s.old);
        sweep_parts(&self.parts, N, &mut s.side, &|k, out| residual_part::<N>(self, &self.parts[k], (x, old), out));
    }

    /// Product A x with the assembled matrix.
    #[cfg(test)]
    pub(super) fn product(&self, x: &[f32]) -> Vec<f32> {
        with_block!(self.block, N => {
            let row = |i: usize| {
                let mut sum = [0.0; N];
                multiply::<N>(self.diagonal(i), &load::<N>(x, i), &mut sum);
                let (mut all, column) = ([0.0; LANES], self.columns_by_entry(i));
                for e in self.first[i] as usize..self.first[i + 1] as usize {
                    subtract::<N>(self.off_diagonal::<N>(e), &load::<N>(x, column(e)), &mut all);
                }
                (0..N).map(move |c| sum[c] - all[c])
            };
            (0..self.n_rows()).flat_map(row).collect()
        })
    }

    /// Recomputes the partial sums that a forward sweep needs, after a change of `s.x` by the caller.
    pub fn restart(&self, s: &mut Sweeps) {
        with_block!(self.block, N => self.restart_of::<N>(s))
    }

    fn restart_of<const N: usize>(&self, s: &mut Sweeps) {
        let x = &s.x;
        sweep_parts(&self.parts, N, &mut s.side, &|k, out| restart_part::<N>(self, &self.parts[k], x, out));
    }

    /// Pattern of the matrix that couples groups of rows.
    pub fn coarse(&self, group: &[u32], n_groups: usize) -> Self {
        let mut members: Vec<Vec<u32>> = vec![Vec::new(); n_groups];
        group.iter().enumerate().for_each(|(i, g)| members[*g as usize].push(i as u32));
        let mut first = vec![0u32];
        let mut column: Vec<u32> = Vec::new();
        let mut own: Vec<u32> = Vec::new();
        for (g, rows) in members.iter().enumerate() {
            let columns = rows.iter().flat_map(|i| self.columns(*i as usize));
            own.clear();
            own.extend(columns.map(|j| group[*j as usize]).filter(|c| *c != g as u32));
            own.sort_unstable();
            own.dedup();
            column.extend_from_slice(&own);
            first.push(column.len() as u32);
        }
        let parts = parts(n_groups, (n_groups / MANY_PARTS).clamp(PART[0], PART[1]));
        Self { scale: self.scale.clone(), ..Self::from_lists(self.block, first, column, parts) }
    }

    /// Sets each row of this matrix to the weighted mean of rows of `fine`. `members(g)` are the rows of group g in
    /// ascending order; `group` gives the group of each row and `share` its weight in the group.
    pub fn gather<'a>(
        &mut self,
        fine: &Self,
        members: impl Fn(usize) -> &'a [u32] + Sync,
        (group, share): (&[u32], &[f32]),
    ) {
        with_block!(self.block, N => self.gather_blocks::<N>(fine, &members, (group, share)))
    }

    fn gather_blocks<'a, const N: usize>(
        &mut self,
        fine: &Self,
        members: &(impl Fn(usize) -> &'a [u32] + Sync),
        (group, share): (&[u32], &[f32]),
    ) {
        let size = N * N;
        let (parts, value_parts) = (self.parts.as_slice(), self.value_parts.as_slice());
        let (first, column) = (&self.first, &self.column);
        let values = (value_parts, UNIT + size, self.value.as_mut_slice());
        sweep_two_parts(values, (parts, size, self.diagonal.as_mut_slice()), &|k, value, diagonal| {
            let mut blocks = value.chunks_exact_mut(UNIT + size);
            let mut some = [0.0; WINDOW * MOST_ENTRIES];
            for (g, own) in parts[k].clone().zip(diagonal.chunks_exact_mut(size)) {
                let rows = || members(g).iter().map(|i| *i as usize);
                let entries = || {
                    let of = |i: usize| (fine.first[i] as usize..).zip(fine.columns(i));
                    rows().flat_map(move |i| of(i).map(move |(e, j)| (e, group[*j as usize], share[i])))
                };
                own.fill(0.0);
                for i in rows() {
                    let fine = &fine.diagonal[i * size..(i + 1) * size];
                    own.iter_mut().zip(fine).for_each(|(a, b)| *a += share[i] * b);
                }
                for (e, _, share) in entries().filter(|(_, to, _)| *to as usize == g) {
                    add_block::<N>(fine.off_diagonal::<N>(e), share, own);
                }
                for columns in column.of(g, first).chunks(WINDOW) {
                    let some = &mut some[..columns.len() * size];
                    some.fill(0.0);
                    for (e, to, share) in entries() {
                        if let Ok(k) = columns.binary_search(&to) {
                            add_block::<N>(fine.off_diagonal::<N>(e), share, &mut some[k * size..][..size]);
                        }
                    }
                    some.chunks_exact(size).zip(&mut blocks).for_each(|(sum, block)| round_block(sum, block, own));
                }
            }
        });
    }

    /// Off-diagonal columns of row `i`, in ascending order.
    pub fn columns(&self, i: usize) -> &[u32] {
        self.column.of(i, &self.first)
    }
}

/// Half-sweep over one part.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn relax_part<const N: usize>(
    matrix: &BlockMatrix,
    part: &Range<usize>,
    (b, old): (&[f32], &[f32]),
    forward: bool,
    (x, side): (&mut [f32], &mut [f32]),
) {
    for k in 0..part.len() {
        let i = if forward { part.start + k } else { part.end - 1 - k };
        matrix.relax_row::<N>(i, part, (b, old), forward, (x, side));
    }
}

/// Residual of the rows of one part, see [`BlockMatrix::residual`].
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn residual_part<const N: usize>(
    matrix: &BlockMatrix,
    part: &Range<usize>,
    (x, old): (&[f32], &[f32]),
    out: &mut [f32],
) {
    for (i, row) in part.clone().zip(out.chunks_exact_mut(N)) {
        let (below, inside, above) = matrix.split_row(i);
        let (middle, column) = (matrix.middle(i), matrix.columns_by_entry(i));
        let mut sum = [0.0; LANES];
        for e in below.chain(inside.start..middle).chain(above) {
            let (new, old) = (load::<N>(x, column(e)), load::<N>(old, column(e)));
            subtract::<N>(matrix.off_diagonal::<N>(e), &array(|c| new[c] - old[c]), &mut sum);
        }
        store(&leading::<N>(&sum), row);
    }
}

/// Partial sums of one part that a forward sweep needs.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn restart_part<const N: usize>(matrix: &BlockMatrix, part: &Range<usize>, x: &[f32], out: &mut [f32]) {
    for (i, row) in part.clone().zip(out.chunks_exact_mut(N)) {
        let (_, inside, _) = matrix.split_row(i);
        let (middle, column) = (matrix.middle(i), matrix.columns_by_entry(i));
        let mut sum = [0.0; LANES];
        for e in middle..inside.end {
            subtract::<N>(matrix.off_diagonal::<N>(e), &load::<N>(x, column(e)), &mut sum);
        }
        store(&leading::<N>(&sum), row);
    }
}

/// Positions in the columns `row` of row `i` at which its part begins, the diagonal is passed and the part ends.
fn cut(i: usize, part: &Range<usize>, row: &[u32]) -> [u16; 3] {
    assert!(row.len() <= usize::from(u16::MAX), "a row of {} blocks", row.len());
    [part.start, i, part.end].map(|limit| row.partition_point(|j| (*j as usize) < limit) as u16)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two coupled rows with unknowns of these magnitudes.
    fn pair(scale: [f64; 2], entry: impl Fn(usize, usize) -> f64 + Sync) -> BlockMatrix {
        let mut matrix =
            BlockMatrix::new(2, std::slice::from_ref(&(0..2)), &Arc::new(vec![0, 1, 2]), &Arc::new(vec![1, 0]))
                .scaled(&scale);
        matrix.assemble(|_, rows| {
            for i in 0..2 {
                rows.add(i, i, |r, c| if r == c { 4.0 } else { 0.0 });
                rows.add(i, 1 - i, &entry);
            }
        });
        matrix
    }

    /// Product A x for the unscaled unknowns `x` of each row.
    fn product(matrix: &BlockMatrix, x: [f32; 2]) -> [f32; 2] {
        let mut x = [x, x].concat();
        matrix.enter(&mut x);
        let product = matrix.product(&x);
        [0, 1].map(|k| matrix.leave(&product, k))
    }

    #[test]
    fn sums_of_rows_survive_rounding() {
        let entry = |r: usize, c: usize| [[-1.0, 0.3217], [0.0771, -0.6193]][r][c];
        let found = product(&pair([1.0, 1.0], entry), [1.0, 1.0]);
        let wanted = [0, 1].map(|r| (4.0 + entry(r, 0) + entry(r, 1)) as f32);
        assert!((0..2).all(|k| (found[k] - wanted[k]).abs() < 1e-6), "{found:?} {wanted:?}");
    }

    #[test]
    fn unknowns_of_different_sizes_are_all_kept() {
        // entries that differ by a factor of 1000, for unknowns of equal units
        let scale = [1.0, 1000.0];
        let entry = |r: usize, c: usize| [[-1.0, 0.3], [0.1, -0.6]][r][c] * scale[r] / scale[c];
        for x in [[1.0, 0.0], [0.0, 1000.0]] {
            let found = product(&pair(scale, entry), x);
            for (k, found) in found.iter().enumerate() {
                let of = |i: usize| (entry(k, i) + if k == i { 4.0 } else { 0.0 }) * f64::from(x[i]);
                let wanted = of(0) + of(1);
                assert!((f64::from(*found) - wanted).abs() < 0.005 * scale[k], "{x:?} {k}: {found} {wanted}");
            }
        }
    }
}
