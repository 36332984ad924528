//! Blocks of integers with one unit for each block, stored by columns: the off-diagonal blocks of
//! [`super::block_matrix`].
use super::blocks::array;

/// Number of values that are read at once: a column of a block and the values that follow.
pub(super) const LANES: usize = 8;
/// A column of a block, or partial sums of one; entries beyond the order of the block are meaningless.
pub(super) type Lanes = [f32; LANES];
/// Number of bytes before the entries of a block: the upper half of its unit in single precision.
pub(super) const UNIT: usize = 2;
/// Largest integer in a block.
const LARGEST: f32 = 127.0;

/// Reads the unit of the entries of a block.
#[inline(always)]
pub(super) fn unit_of(block: &[u8]) -> f32 {
    of_upper_half(u16::from_le_bytes([block[0], block[1]]))
}

/// The single-precision number with this upper half.
#[inline(always)]
pub fn of_upper_half(half: u16) -> f32 {
    f32::from_bits(u32::from(half) << 16)
}

/// Upper half of a single-precision number, rounded.
#[inline(always)]
pub fn upper_half(x: f32) -> u16 {
    (x.to_bits().wrapping_add(0x8000) >> 16) as u16
}

/// Writes a block and adds its rounding errors to `own`. Row sums, which determine the slow modes, therefore remain
/// exact.
#[inline(always)]
pub(super) fn round_block(sum: &[f32], block: &mut [u8], own: &mut [f32]) {
    // adding this number (1.5 · 2²³) rounds to an integer, because the sum has no bits for fractions
    const WHOLE: f32 = 12_582_912.0;
    // compares bit patterns, which have the order of positive numbers
    let (n, mut largest) = (sum.len(), 0);
    for x in sum {
        largest = x.abs().to_bits().max(largest);
    }
    // upper half of the bits, rounded up
    let half = (f32::from_bits(largest) / LARGEST).to_bits().wrapping_add(0xffff) >> 16;
    let unit = f32::from_bits(half << 16);
    let scale = if unit >= f32::MIN_POSITIVE { 1.0 / unit } else { 0.0 };
    block[..UNIT].copy_from_slice(&(half as u16).to_le_bytes());
    let (to, own) = (&mut block[UNIT..UNIT + n], &mut own[..n]);
    for k in 0..n {
        let whole = sum[k] * scale + WHOLE;
        to[k] = (whole.to_bits() as i32 - WHOLE.to_bits() as i32) as u8;
        own[k] += sum[k] - (whole - WHOLE) * unit;
    }
}

/// Computes sum ← sum + share · B.
#[inline(always)]
pub(super) fn add_block<const N: usize>(block: &[u8], share: f32, sum: &mut [f32]) {
    let unit = share * unit_of(block);
    let entries = block[UNIT..UNIT + N * N].iter();
    sum[..N * N].iter_mut().zip(entries).for_each(|(s, b)| *s += unit * f32::from(*b as i8));
}

/// The first `N` values.
#[inline(always)]
pub(super) fn leading<const N: usize>(lanes: &Lanes) -> [f32; N] {
    array(|k| lanes[k])
}

#[inline(always)]
pub(super) fn load_lanes<const N: usize>(x: &[f32], i: usize) -> Lanes {
    let x = &x[i * N..(i + 1) * N];
    let mut lanes = [0.0; LANES];
    (0..N).for_each(|k| lanes[k] = x[k]);
    lanes
}

#[inline(always)]
pub(super) fn load<const N: usize>(x: &[f32], i: usize) -> [f32; N] {
    let x = &x[i * N..(i + 1) * N];
    array(|k| x[k])
}

/// Computes r ← r − B x.
#[inline(always)]
pub(super) fn subtract<const N: usize>(block: &[u8], x: &[f32; N], r: &mut Lanes) {
    let unit = unit_of(block);
    for c in 0..N {
        let (column, x) = (column::<N>(block, c), unit * x[c]);
        for k in 0..LANES {
            r[k] -= column[k] * x;
        }
    }
}

/// Column `c` of a block, in its unit.
#[inline(always)]
fn column<const N: usize>(block: &[u8], c: usize) -> Lanes {
    let entries = &block[UNIT + c * N..UNIT + c * N + LANES];
    array(|k| f32::from(entries[k] as i8))
}

/// Entries of a block, by columns.
#[inline(always)]
pub(super) fn widen_block<const N: usize>(block: &[u8]) -> [Lanes; N] {
    let unit = unit_of(block);
    array(|c| column::<N>(block, c).map(|b| unit * b))
}

/// Computes r ← r − B x.
#[inline(always)]
pub(super) fn subtract_wide<const N: usize>(block: &[Lanes; N], x: &[f32], r: &mut Lanes) {
    let x = &x[..N];
    for c in 0..N {
        for k in 0..LANES {
            r[k] -= block[c][k] * x[c];
        }
    }
}

/// Computes r ← r + B x for a block stored by columns.
#[inline(always)]
pub(super) fn multiply<const N: usize>(block: &[f32], x: &[f32; N], r: &mut [f32; N]) {
    let block = &block[..N * N];
    for c in 0..N {
        for k in 0..N {
            r[k] += block[c * N + k] * x[c];
        }
    }
}
