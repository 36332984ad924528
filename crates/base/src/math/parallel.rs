//! Parallel loops.
//!
//! Every loop over particles uses the functions of this file. A loop gathers its input and writes its own entry, or it
//! owns one contiguous *part* of the output, so that results are identical for any number of threads. Sums, norms and
//! maxima over rows are in [`reduce`](super::reduce).
use std::ops::Range;

use rayon::slice::ParallelSliceMut;

/// Number of particles in one chunk of a parallel loop or of a sum.
pub const CHUNK: usize = 1024;
/// Maximum number of pieces of a loop with expensive entries: enough that no thread waits long for another.
const PIECES: usize = 1024;

/// Number of threads of parallel loops.
pub fn threads() -> usize {
    rayon::current_num_threads()
}

// All loops distribute work by `both` only, which is compiled once. The cost of a call through a function pointer is
// negligible compared with a chunk, and the chunk itself is a plain loop that is compiled for its formula.

/// Runs `a` and `b`, concurrently if a thread is free.
pub(super) fn both(a: &mut (dyn FnMut() + Send), b: &mut (dyn FnMut() + Send)) {
    rayon::join(a, b);
}

/// Calls `f(k, piece)` for every piece of `width` values of `out`, of which the last may be shorter; `first` is the
/// index of the first piece.
pub(super) fn each_piece<T: Send>(first: usize, width: usize, out: &mut [T], f: &(dyn Fn(usize, &mut [T]) + Sync)) {
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
pub(super) fn each_chunk(from: usize, to: usize, f: &(dyn Fn(usize) + Sync)) {
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

/// Calls `f(i, slot)` for every entry of `out`.
pub fn sweep_slots<T: Send>(out: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    each_piece(0, CHUNK, out, &|c, chunk| {
        for (k, slot) in chunk.iter_mut().enumerate() {
            f(c * CHUNK + k, slot);
        }
    });
}

/// Sets `out[i] = f(i)` for every `i`, for expensive entries.
pub fn sweep_each<T: Send>(out: &mut [T], f: impl Fn(usize) -> T + Sync) {
    sweep_each_slot(out, |i, slot| *slot = f(i));
}

/// Calls `f(i, slot)` for every entry of `out`, for expensive entries.
pub fn sweep_each_slot<T: Send>(out: &mut [T], f: impl Fn(usize, &mut T) + Sync) {
    let width = out.len().div_ceil(PIECES).max(1);
    each_piece(0, width, out, &|c, piece| {
        for (k, slot) in piece.iter_mut().enumerate() {
            f(c * width + k, slot);
        }
    });
}

/// Calls `f(c, chunk)` for every chunk of `width` values of `out`, for expensive chunks.
pub fn sweep_each_chunk<T: Send>(out: &mut [T], width: usize, f: impl Fn(usize, &mut [T]) + Sync) {
    each_piece(0, width, out, &f);
}

/// The indices `0..n` sorted by `key`; equal keys keep their order.
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

/// Calls `f(k, slice)` for every part `k`, where `slice` holds the rows `parts[k]` of `out`, with `width` values each.
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

/// Row ranges of the parts, number of values in a row, and the output that is divided.
pub type Cut<'a, T> = (&'a [Range<usize>], usize, &'a mut [T]);

/// Calls a function for every part of two outputs, as [`sweep_parts`]; both have the same number of parts.
pub fn sweep_two_parts<T: Send, U: Send>(
    mut a: Cut<'_, T>,
    mut b: Cut<'_, U>,
    f: &(impl Fn(usize, &mut [T], &mut [U]) + Sync),
) {
    split_two_parts(0, &mut a, &mut b, f);
}

/// Function that is called with a part of either output.
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

/// Divides `0..n` into parts of about `size` rows.
pub fn parts(n: usize, size: usize) -> Vec<Range<usize>> {
    let count = n.div_ceil(size).max(1);
    (0..count).map(|k| k * n / count..(k + 1) * n / count).collect()
}

/// Calls `f(range, slots)` for consecutive entries of `out`, one chunk at a time.
pub fn sweep_chunks<T: Send>(out: &mut [T], f: impl Fn(Range<usize>, &mut [T]) + Sync) {
    each_piece(0, CHUNK, out, &|c, chunk| f(c * CHUNK..c * CHUNK + chunk.len(), chunk));
}

/// Copies `from` to `out`, which has the same length.
pub fn copy<T: Copy + Send + Sync>(from: &[T], out: &mut [T]) {
    sweep_chunks(out, |range, out| out.copy_from_slice(&from[range]));
}

/// Sets every entry of `out` to `value`.
pub fn fill<T: Copy + Send + Sync>(out: &mut [T], value: T) {
    sweep_chunks(out, |_, out| out.fill(value));
}

#[cfg(test)]
mod tests {
    use super::*;

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
