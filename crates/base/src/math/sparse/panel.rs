//! Elimination of one dense panel, stored column by column, and the update of the matrix behind it.
//!
//! A panel of m rows and k columns is factored to L of A = L Lᵀ recursively: the left half is eliminated, its products
//! are subtracted from the right half, and then the right half is eliminated (Golub and Van Loan, 4th edition, section
//! 4.2.6). Products use register tiles of packed strips (Goto and van de Geijn 2008, ACM TOMS 34, 12).
use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::number::{Number, TILE, WIDE};
use crate::math::parallel::sweep_each_chunk;

/// Number of columns that are eliminated one by one.
const NARROW: usize = 8;
/// Number of columns of L whose products are subtracted together: a strip of them fits into the first-level cache.
const DEPTH: usize = 192;
/// Number of rows whose strips fit into the second-level cache.
const HIGH: usize = 192;
/// Number of columns that a thread processes at a time, a multiple of the rows of a strip.
const SHARE: usize = 48;
/// Number of multiplications below which packing does not pay, and number above which work is distributed over threads.
const PACKED: usize = 4096;
const SHARED: usize = 1 << 20;

/// Part of a matrix stored column by column: the rows from `from` on of columns with the stride `step`.
pub(super) struct Target<'a, T> {
    pub(super) values: &'a mut [T],
    pub(super) step: usize,
    pub(super) from: usize,
}

/// Replaces the `k` columns of `panel`, with `m` rows each, by those of L; entries above the diagonal are ignored.
/// `None` if a pivot is not valid; `floor` holds the values to which pivots may be increased.
pub(super) fn eliminate<T: Number>(panel: &mut [T], m: usize, floor: &[f64]) -> Option<()> {
    halves(panel, m, (0, floor.len()), floor)
}

fn halves<T: Number>(panel: &mut [T], m: usize, (from, to): (usize, usize), floor: &[f64]) -> Option<()> {
    let half = (to - from).div_ceil(2).next_multiple_of(NARROW);
    if to - from <= NARROW {
        return narrow(&mut panel[from * m..to * m], m, from, &floor[from..to]);
    }
    let middle = from + half;
    halves(panel, m, (from, middle), floor)?;
    let (left, right) = panel.split_at_mut(middle * m);
    let target = Target { values: &mut right[..(to - middle) * m], step: m, from: middle };
    subtract_products(&left[from * m..], m, middle, target);
    halves(panel, m, (middle, to), floor)
}

/// Eliminates a few columns, whose diagonal begins in row `from`.
#[multiversion(targets("x86_64+avx2+fma"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn narrow<T: Number>(columns: &mut [T], m: usize, from: usize, floor: &[f64]) -> Option<()> {
    for j in 0..floor.len() {
        let (done, later) = columns.split_at_mut((j + 1) * m);
        let column = &mut done[j * m + from + j..];
        let root = column[0].root(floor[j])?;
        let inverse = root.inverse();
        column[0] = root;
        column[1..].iter_mut().for_each(|x| *x = *x * inverse);
        for (c, other) in later.chunks_exact_mut(m).enumerate() {
            let part = column[c + 1];
            let other = &mut other[from + j + 1 + c..];
            other.iter_mut().zip(&column[c + 1..]).for_each(|(x, l)| *x -= *l * part);
        }
    }
    Some(())
}

/// Subtracts L Lᵀ from `target`, at least on and below its diagonal, for the rows of L from `row` on; columns of L have
/// `m` rows.
pub(super) fn subtract_products<T: Number>(l: &[T], m: usize, row: usize, target: Target<'_, T>) {
    let Target { values, step, from } = target;
    let (depth, width, height) = (l.len() / m, values.len() / step, m - row);
    if depth * width * height < PACKED {
        return directly(l, m, row, Target { values, step, from });
    }
    let strips = height.div_ceil(T::ROWS);
    for columns in l.chunks(DEPTH * m) {
        let size = columns.len() / m * T::ROWS * T::PARTS;
        let mut packed = vec![0.0; strips * size];
        let shared = depth * width * height > SHARED;
        let share = if shared { SHARE * step } else { values.len() };
        sweep_each_chunk(&mut packed, if shared { 16 * size } else { strips * size }, |c, strips| {
            for (s, strip) in strips.chunks_exact_mut(size).enumerate() {
                pack(columns, m, row + (16 * c + s) * T::ROWS, strip);
            }
        });
        sweep_each_chunk(values, share, |c, values| {
            subtract_tiles(&packed, size, (c * SHARE, height), Target { values, step, from });
        });
    }
}

/// Packs one strip of rows from `row` on, column after column.
fn pack<T: Number>(columns: &[T], m: usize, row: usize, strip: &mut [f64]) {
    let end = (row + T::ROWS).min(m);
    for (column, out) in columns.chunks_exact(m).zip(strip.chunks_exact_mut(T::ROWS * T::PARTS)) {
        column[row..end].iter().enumerate().for_each(|(lane, x)| x.put(out, lane));
    }
}

#[multiversion(targets("x86_64+avx2+fma"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn directly<T: Number>(l: &[T], m: usize, row: usize, target: Target<'_, T>) {
    for (j, out) in target.values.chunks_exact_mut(target.step).enumerate() {
        let out = &mut out[target.from + j..];
        for column in l.chunks_exact(m) {
            let column = &column[row + j..];
            let part = column[0];
            out.iter_mut().zip(column).for_each(|(x, l)| *x -= *l * part);
        }
    }
}

/// Subtracts the products of packed strips from columns of `target`, which begin with index `first` of `height`.
#[multiversion(targets("x86_64+avx2+fma"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn subtract_tiles<T: Number>(packed: &[f64], size: usize, (first, height): (usize, usize), target: Target<'_, T>) {
    let Target { values, step, from } = target;
    let strip = |s: usize| &packed[s * size..(s + 1) * size];
    let mut tile = [T::ZERO; TILE];
    for high in (first / T::ROWS * T::ROWS..height).step_by(HIGH) {
        for (block, columns) in values.chunks_mut(WIDE * step).enumerate() {
            let column = first + block * WIDE;
            let b = strip(column / T::ROWS);
            let start = high.max(column / T::ROWS * T::ROWS);
            for top in (start..height.min(high + HIGH)).step_by(T::ROWS) {
                let a = strip(top / T::ROWS);
                if target_cfg_f!(target_feature = "fma") {
                    T::tile::<true>(a, b, column % T::ROWS, &mut tile);
                } else {
                    T::tile::<false>(a, b, column % T::ROWS, &mut tile);
                }
                let rows = T::ROWS.min(height - top);
                // rows above the diagonal of the target may not exist, and are skipped
                for (out, tile) in columns.chunks_exact_mut(step).zip(tile.chunks_exact(T::ROWS)) {
                    let out = &mut out[from + top..from + top + rows];
                    out.iter_mut().zip(tile).for_each(|(x, t)| *x -= *t);
                }
            }
        }
    }
}

/// One row of several right-hand sides that are solved together.
pub(super) type Rows<T, const R: usize> = [T; R];

/// Computes x ← L⁻¹ x in the first `k` rows and subtracts their contribution from the rows below.
#[multiversion(targets("x86_64+avx2+fma"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
pub(super) fn forward<T: Number, const R: usize>(panel: &[T], k: usize, x: &mut [Rows<T, R>]) {
    let m = x.len();
    for j in (0..k).step_by(WIDE) {
        let wide = WIDE.min(k - j);
        let columns = &panel[j * m..(j + wide) * m];
        for c in 0..wide {
            let column = &columns[c * m..(c + 1) * m];
            let inverse = column[j + c].inverse();
            (0..R).for_each(|r| x[j + c][r] = x[j + c][r] * inverse);
            let own = x[j + c];
            let end = if wide == WIDE { j + wide } else { m };
            for (x, l) in x[j + c + 1..end].iter_mut().zip(&column[j + c + 1..end]) {
                (0..R).for_each(|r| x[r] -= *l * own[r]);
            }
        }
        if wide == WIDE {
            let own: [Rows<T, R>; WIDE] = std::array::from_fn(|c| x[j + c]);
            let [a, b, c, d] = std::array::from_fn(|c| &columns[c * m + j + WIDE..(c + 1) * m]);
            for ((((x, a), b), c), d) in x[j + WIDE..].iter_mut().zip(a).zip(b).zip(c).zip(d) {
                for r in 0..R {
                    x[r] -= (*a * own[0][r] + *b * own[1][r]) + (*c * own[2][r] + *d * own[3][r]);
                }
            }
        }
    }
}

/// Computes x ← L⁻ᵀ x in the first `k` rows from the known rows below; sums run over `G` rows together.
#[multiversion(targets("x86_64+avx2+fma"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
pub(super) fn backward<T: Number, const R: usize, const G: usize>(panel: &[T], k: usize, x: &mut [Rows<T, R>]) {
    let m = x.len();
    for j in (0..k).rev() {
        let (own, below) = x[j..].split_first_mut().expect("a row of its own");
        let column = &panel[j * m + j + 1..(j + 1) * m];
        let mut sums = [[T::ZERO; R]; G];
        let (l, x) = (column.chunks_exact(G), below.chunks_exact(G));
        let rest = l.remainder().iter().zip(x.remainder());
        for (l, x) in l.zip(x) {
            for g in 0..G {
                (0..R).for_each(|r| sums[g][r] += l[g] * x[g][r]);
            }
        }
        for (sum, (l, x)) in sums.iter_mut().zip(rest) {
            (0..R).for_each(|r| sum[r] += *l * x[r]);
        }
        let inverse = panel[j * m + j].inverse();
        for r in 0..R {
            let sum = sums.iter().fold(T::ZERO, |sum, s| sum + s[r]);
            own[r] = (own[r] - sum) * inverse;
        }
    }
}
