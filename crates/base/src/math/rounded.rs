//! Blocks of whole numbers of one unit each, stored by columns: those of [`super::block_matrix`] beside the diagonal.
use super::blocks::array;

/// Numbers that are read at once: a column of a block and what follows it.
pub(super) const LANES: usize = 8;
/// A column of a block, or what is summed of one; entries beyond the order of the block mean nothing.
pub(super) type Lanes = [f32; LANES];
/// Bytes before the entries of a block: the upper half of its unit.
pub(super) const UNIT: usize = 2;
/// Largest whole number in a block.
const LARGEST: f32 = 127.0;

/// Unit of the entries of a block.
#[inline(always)]
pub(super) fn unit_of(block: &[u8]) -> f32 {
    of_upper_half(u16::from_le_bytes([block[0], block[1]]))
}

/// The number whose upper half this is.
#[inline(always)]
pub fn of_upper_half(half: u16) -> f32 {
    f32::from_bits(u32::from(half) << 16)
}

/// The upper half of a number, rounded.
#[inline(always)]
pub fn upper_half(x: f32) -> u16 {
    (x.to_bits().wrapping_add(0x8000) >> 16) as u16
}

/// Writes the numbers of a block, and adds what rounding takes from them to `own`: sums of rows, which rule the slow modes,
/// then stay exact.
#[inline(always)]
pub(super) fn round_block(sum: &[f32], block: &mut [u8], own: &mut [f32]) {
    // twelve and a half million: sums with it have no room for fractions
    const WHOLE: f32 = 12_582_912.0;
    // by their bits, which are in the order of the numbers
    let (n, mut largest) = (sum.len(), 0);
    for x in sum {
        largest = x.abs().to_bits().max(largest);
    }
    // half of the bits, rounded up
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

/// sum ← sum + share · B.
#[inline(always)]
pub(super) fn add_block<const N: usize>(block: &[u8], share: f32, sum: &mut [f32]) {
    let unit = share * unit_of(block);
    let entries = block[UNIT..UNIT + N * N].iter();
    sum[..N * N].iter_mut().zip(entries).for_each(|(s, b)| *s += unit * f32::from(*b as i8));
}

/// The first `N` numbers.
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

/// r ← r − B x.
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

/// The numbers of a block, by columns.
#[inline(always)]
pub(super) fn widen_block<const N: usize>(block: &[u8]) -> [Lanes; N] {
    let unit = unit_of(block);
    array(|c| column::<N>(block, c).map(|b| unit * b))
}

/// r ← r − B x.
#[inline(always)]
pub(super) fn subtract_wide<const N: usize>(block: &[Lanes; N], x: &[f32], r: &mut Lanes) {
    let x = &x[..N];
    for c in 0..N {
        for k in 0..LANES {
            r[k] -= block[c][k] * x[c];
        }
    }
}

/// r ← r + B x for a block stored by columns.
#[inline(always)]
pub(super) fn multiply<const N: usize>(block: &[f32], x: &[f32; N], r: &mut [f32; N]) {
    let block = &block[..N * N];
    for c in 0..N {
        for k in 0..N {
            r[k] += block[c * N + k] * x[c];
        }
    }
}
