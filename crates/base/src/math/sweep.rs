//! The parallel loop.
//!
//! Every loop over particles goes through this file. A loop gathers what it needs and writes its own slot, or owns one
//! contiguous *part* of the output; sums run over chunks of a fixed size. The result is therefore the same bits for any
//! number of threads.
use std::ops::Range;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use rayon::slice::ParallelSliceMut;

/// Particles in one chunk of a parallel loop or of a sum.
pub const CHUNK: usize = 1024;
/// Most pieces that a loop is cut into where each slot is much work: enough that no thread waits long for another.
const PIECES: usize = 1024;

/// Threads that loops are shared out to.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

// A loop meets the threads in `both` alone, which is compiled once for all of them. A call of a function that is known only at
// run time costs nothing beside a chunk, and what the chunk holds is a plain loop, compiled for the formula inside it.

/// Runs `a` and `b`, at the same time if a thread is free.
fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    rayon::join(a, b);
}

/// Calls `f(k, piece)` for every piece of `width` values of `out`, the last of which may be shorter; `first` is the number of
/// the first.
fn each_piece<T: Send>(first: usize, width: usize, out: &mut [T], f: &(dyn Fn(usize, &mut [T]) + Sync)) {
    match out.len().div_ceil(width) {
        0 => {}
        1 => f(first, out),
        n => {
            let (left, right) = out.split_at_mut(n / 2 * width);
            both(&mut || each_piece(first, width, left, f), &mut || each_piece(first + n / 2, width, right, f));
        }
    }
}

/// Calls `f(c)` for every `c` in `from..to`.
fn each_chunk(from: usize, to: usize, f: &(dyn Fn(usize) + Sync)) {
    match to - from {
        0 => {}
        1 => f(from),
        n => both(&mut || each_chunk(from, from + n / 2, f), &mut || each_chunk(from + n / 2, to, f)),
    }
}

/// Sets `out[i] = f(i)` for every `i`.
pub fn sweep<T: Send>(out: &mut [T], f: impl Fn(usize) -> T + Sync) {
    sweep_slots(out, |i, slot| *slot = f(i));
}

/// Calls `f(i, slot)` for every slot of `out`.
pub fn sweep_slots<T: Send>(out: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    each_piece(0, CHUNK, out, &|c, chunk| {
        for (k, slot) in chunk.iter_mut().enumerate() {
            f(c * CHUNK + k, slot);
        }
    });
}

/// Sets `out[i] = f(i)` for every `i` where each one is much work.
pub fn sweep_each<T: Send>(out: &mut [T], f: impl Fn(usize) -> T + Sync) {
    sweep_each_slot(out, |i, slot| *slot = f(i));
}

/// Calls `f(i, slot)` for every slot of `out` where each one is much work.
pub fn sweep_each_slot<T: Send>(out: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    let width = out.len().div_ceil(PIECES).max(1);
    each_piece(0, width, out, &|c, piece| {
        for (k, slot) in piece.iter_mut().enumerate() {
            f(c * width + k, slot);
        }
    });
}

/// Calls `f(c, chunk)` for every chunk of `width` values of `out` where each one is much work.
pub fn sweep_each_chunk<T: Send>(out: &mut [T], width: usize, f: impl Fn(usize, &mut [T]) + Sync) {
    each_piece(0, width, out, &f);
}

/// The numbers `0..n` in the order of `key`, ties in their own order.
pub fn order_by_key(n: usize, key: impl Fn(usize) -> u64 + Sync) -> Vec<u32> {
    let mut keys = vec![(0, 0); n];
    sweep(&mut keys, |i| (key(i), i as u32));
    keys.par_sort_unstable();
    keys.into_iter().map(|k| k.1).collect()
}

/// Calls `f(i, row)` for every row of `width` values of `out`.
pub fn sweep_rows<T: Send>(out: &mut [T], width: usize, f: impl Fn(usize, &mut [T]) + Sync) {
    each_piece(0, CHUNK * width, out, &|c, chunk| {
        for (k, row) in chunk.chunks_exact_mut(width).enumerate() {
            f(c * CHUNK + k, row);
        }
    });
}

/// Calls `f(k, slice)` for every part `k`, where `slice` holds the rows `parts[k]` of `out`, `width` values each.
///
/// The parts must follow one another without gaps from row zero.
pub fn sweep_parts<T: Send>(
    parts: &[Range<usize>],
    width: usize,
    out: &mut [T],
    f: &(impl Fn(usize, &mut [T]) + Sync),
) {
    split_parts(0, &mut (parts, width, out), f);
}

fn split_parts<T: Send>(first: usize, cut: &mut Cut<'_, T>, f: &(dyn Fn(usize, &mut [T]) + Sync)) {
    match cut.0.len() {
        0 => {}
        1 => f(first, cut.2),
        n => {
            let (mut left, mut right) = halve(cut);
            both(&mut || split_parts(first, &mut left, f), &mut || split_parts(first + n / 2, &mut right, f));
        }
    }
}

/// Parts, values a row, and the output they cut.
pub type Cut<'a, T> = (&'a [Range<usize>], usize, &'a mut [T]);

/// [`sweep_parts`] with two outputs that are cut into the same number of parts.
pub fn sweep_two_parts<T: Send, U: Send>(
    mut a: Cut<'_, T>,
    mut b: Cut<'_, U>,
    f: &(impl Fn(usize, &mut [T], &mut [U]) + Sync),
) {
    split_two_parts(0, &mut a, &mut b, f);
}

/// What is done with a part of either output.
type OnTwoParts<'f, T, U> = dyn Fn(usize, &mut [T], &mut [U]) + Sync + 'f;

fn split_two_parts<T: Send, U: Send>(first: usize, a: &mut Cut<'_, T>, b: &mut Cut<'_, U>, f: &OnTwoParts<'_, T, U>) {
    match a.0.len() {
        0 => {}
        1 => f(first, a.2, b.2),
        n => {
            let ((mut a_left, mut a_right), (mut b_left, mut b_right)) = (halve(a), halve(b));
            both(&mut || split_two_parts(first, &mut a_left, &mut b_left, f), &mut || {
                split_two_parts(first + n / 2, &mut a_right, &mut b_right, f);
            });
        }
    }
}

fn halve<'a, T>((parts, width, out): &'a mut Cut<'_, T>) -> (Cut<'a, T>, Cut<'a, T>) {
    let (left, right) = parts.split_at(parts.len() / 2);
    let (a, b) = out.split_at_mut((right[0].start - left[0].start) * *width);
    ((left, *width, a), (right, *width, b))
}

/// Cuts `0..n` into parts of about `size` rows.
pub fn parts(n: usize, size: usize) -> Vec<Range<usize>> {
    let count = n.div_ceil(size).max(1);
    (0..count).map(|k| k * n / count..(k + 1) * n / count).collect()
}

/// Sum of `f(i)` over `0..n`: chunk sums of fixed size, added in order.
pub fn sum(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    let chunk = |c: usize| abreast(c * CHUNK..((c + 1) * CHUNK).min(n), &f);
    pairwise(0, n.div_ceil(CHUNK), &chunk)
}

/// Sum of `f(i)` over a range, every eighth term together: additions that need not wait for one another.
#[inline(always)]
pub fn abreast(range: Range<usize>, f: &impl Fn(usize) -> f64) -> f64 {
    let mut sums = [0.0; 8];
    let whole = range.start + range.len() / 8 * 8;
    for start in (range.start..whole).step_by(8) {
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += f(start + k);
        }
    }
    for (i, sum) in (whole..range.end).zip(&mut sums) {
        *sum += f(i);
    }
    let [a, b, c, d, e, f, g, h] = sums;
    ((a + b) + (c + d)) + ((e + f) + (g + h))
}

/// Sum of `value(k)` over `from..to` in a fixed tree.
fn pairwise(from: usize, to: usize, value: &(dyn Fn(usize) -> f64 + Sync)) -> f64 {
    match to - from {
        0 => 0.0,
        1 => value(from),
        n => {
            let middle = from + n / 2;
            let (mut a, mut b) = (0.0, 0.0);
            both(&mut || a = pairwise(from, middle, value), &mut || b = pairwise(middle, to, value));
            a + b
        }
    }
}

/// As many sums at once as `total` has slots: `f` sets those of a range of indices; chunks of fixed size are added in order.
/// `chunks` is storage.
pub fn sum_each(n: usize, total: &mut [f64], chunks: &mut Vec<f64>, f: impl Fn(Range<usize>, &mut [f64]) + Sync) {
    let width = total.len();
    chunks.clear();
    chunks.resize(n.div_ceil(CHUNK) * width, 0.0);
    each_piece(0, width.max(1), chunks, &|c, out| f(c * CHUNK..n.min((c + 1) * CHUNK), out));
    total.fill(0.0);
    chunks.chunks_exact(width.max(1)).for_each(|c| total.iter_mut().zip(c).for_each(|(t, c)| *t += c));
}

/// Calls `f(range, slots)` for consecutive slots of `out`, a chunk at a time.
pub fn sweep_chunks<T: Send>(out: &mut [T], f: impl Fn(Range<usize>, &mut [T]) + Sync) {
    each_piece(0, CHUNK, out, &|c, chunk| f(c * CHUNK..c * CHUNK + chunk.len(), chunk));
}

/// Copies `from`, which is as long, to `out`.
pub fn copy<T: Copy + Send + Sync>(from: &[T], out: &mut [T]) {
    sweep_chunks(out, |range, out| out.copy_from_slice(&from[range]));
}

/// Sets every slot of `out` to `value`.
pub fn fill<T: Copy + Send + Sync>(out: &mut [T], value: T) {
    sweep_chunks(out, |_, out| out.fill(value));
}

/// The first of `0..n` for which `f` holds.
pub fn first(n: usize, f: impl Fn(usize) -> bool + Sync) -> Option<usize> {
    let found = AtomicUsize::new(usize::MAX);
    each_chunk(0, n.div_ceil(CHUNK), &|c| {
        // what lies behind one that was found need not be asked
        if c * CHUNK < found.load(Ordering::Relaxed)
            && let Some(i) = (c * CHUNK..((c + 1) * CHUNK).min(n)).find(|i| f(*i))
        {
            found.fetch_min(i, Ordering::Relaxed);
        }
    });
    Some(found.into_inner()).filter(|i| *i < n)
}

/// Largest of `f(i)` over `0..n`, at least zero.
pub fn maximum(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    // positive numbers are in the order of their bits
    let largest = AtomicU64::new(0);
    each_chunk(0, n.div_ceil(CHUNK), &|c| {
        let chunk = (c * CHUNK..((c + 1) * CHUNK).min(n)).map(&f).fold(0.0, f64::max);
        if chunk > 0.0 {
            largest.fetch_max(chunk.to_bits(), Ordering::Relaxed);
        }
    });
    f64::from_bits(largest.into_inner())
}

/// Inner product of two slices with a fixed order of summation.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    sum(a.len(), |i| a[i] * b[i])
}

/// Euclidean norm with a fixed order of summation.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_do_not_depend_on_the_number_of_threads() {
        let values: Vec<f64> = (0..100_000).map(|i| (i as f64 * 0.7).sin()).collect();
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        let one = pool(1).install(|| dot(&values, &values));
        let four = pool(4).install(|| dot(&values, &values));
        assert_eq!(one.to_bits(), four.to_bits());
    }

    #[test]
    fn parts_cover_every_row_once() {
        let parts = parts(10_007, 1000);
        let mut rows = vec![0u8; 10_007 * 2];
        sweep_parts(&parts, 2, &mut rows, &|k, slice| {
            assert_eq!(slice.len(), 2 * parts[k].len());
            slice.iter_mut().for_each(|v| *v += 1);
        });
        assert!(rows.iter().all(|v| *v == 1));
    }
}
