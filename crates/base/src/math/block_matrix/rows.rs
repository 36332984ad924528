//! Assembly of the blocks in one part of the rows of a block matrix.
//!
//! The rounding error of an off-diagonal block is added to the diagonal block of its row.
use super::Columns;
use crate::math::blocks::MOST_ENTRIES;
use crate::math::rounded::{UNIT, round_block, unit_of};

/// Adds to the blocks of the rows of one part.
pub struct Rows<'a> {
    pub(super) first: &'a [u32],
    pub(super) column: &'a Columns,
    pub(super) value: &'a mut [u8],
    pub(super) diagonal: &'a mut [f32],
    pub(super) start: usize,
    pub(super) block: usize,
    /// Factor of each entry, from the scale of the unknowns and the weight of a mean.
    pub(super) factor: &'a [f32; MOST_ENTRIES],
}

impl Rows<'_> {
    /// Adds `f(r, c)` to entry (r, c) of the block that couples row `i` to column `j`; does nothing if the pattern has
    /// no such block.
    pub fn add(&mut self, i: usize, j: usize, f: impl Fn(usize, usize) -> f64) {
        let n = self.block;
        let mut block = [0.0; MOST_ENTRIES];
        (0..n).for_each(|c| (0..n).for_each(|r| block[c * n + r] = f(r, c) as f32));
        match i == j {
            true => self.add_own(n, i, &block),
            false => self.add_other(n, (i, j), &block),
        }
    }

    /// Adds `block`, stored by columns, to the diagonal block of row `i`; `n` is the order of the blocks, for which a
    /// constant gives faster code.
    #[inline(always)]
    pub fn add_own(&mut self, n: usize, i: usize, block: &[f32]) {
        debug_assert_eq!(n, self.block);
        let at = (i - self.start) * n * n;
        let (own, block, factor) = (&mut self.diagonal[at..at + n * n], &block[..n * n], &self.factor[..n * n]);
        for k in 0..n * n {
            own[k] += factor[k] * block[k];
        }
    }

    /// Adds `block`, stored by columns, to the block that couples row `i` to another column `j`; does nothing if the
    /// pattern has no such block.
    #[inline(always)]
    pub fn add_other(&mut self, n: usize, (i, j): (usize, usize), block: &[f32]) {
        debug_assert_eq!(n, self.block);
        let Some(k) = position(self.column.of(i, self.first), j as u32) else { return };
        let own = (i - self.start) * n * n;
        let at = ((self.first[i] - self.first[self.start]) as usize + k) * (UNIT + n * n);
        let stored = &mut self.value[at..at + UNIT + n * n];
        let (unit, block, factor) = (unit_of(stored), &block[..n * n], &self.factor[..n * n]);
        let mut sum = [0.0; MOST_ENTRIES];
        for k in 0..n * n {
            sum[k] = factor[k] * block[k];
        }
        if unit > 0.0 {
            for k in 0..n * n {
                sum[k] += unit * f32::from(stored[UNIT + k] as i8);
            }
        }
        round_block(&sum[..n * n], stored, &mut self.diagonal[own..own + n * n]);
    }
}

/// Position of `j` in an ascending list; `None` if it is absent.
#[inline(always)]
fn position(list: &[u32], j: u32) -> Option<usize> {
    const STEP: usize = 8;
    let mut k = 0;
    while k + STEP <= list.len() && list[k + STEP - 1] < j {
        k += STEP;
    }
    let mut smaller = 0u32;
    for c in &list[k..list.len().min(k + STEP)] {
        smaller += u32::from(*c < j);
    }
    k += smaller as usize;
    (k < list.len() && list[k] == j).then_some(k)
}
