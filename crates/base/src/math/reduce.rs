//! Sums, norms, maxima and searches over rows; all reductions of rows to one number are in this file.
//!
//! Rows are divided into chunks of [`CHUNK`] consecutive ones, independently of the number of threads. A chunk is
//! summed in floating point; the sums of chunks are added exactly in integer arithmetic ([`Accumulator`]) and rounded
//! once. A sum over rows is therefore identical for any order, number of threads and number of pieces. Maxima, minima
//! and first indices are exact in any case.
use std::ops::Range;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

pub use accumulator::Accumulator;

use super::parallel::{CHUNK, both, each_chunk, each_piece, sweep_each};

mod accumulator;

/// Number of chunks that a thread adds before it checks whether another thread is free.
const TOGETHER: usize = 16;

/// Sum of `f(i)` over `0..n`.
pub fn sum(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    let [sum] = of_chunks(n, &|range| [abreast(range, &f)]);
    sum
}

/// N sums over `0..n` at once, one for each value of `f(i)`.
pub fn sums<const N: usize>(n: usize, f: impl Fn(usize) -> [f64; N] + Sync) -> [f64; N] {
    of_chunks(n, &|range| {
        let mut sums = [0.0; N];
        for i in range {
            let values = f(i);
            (0..N).for_each(|k| sums[k] += values[k]);
        }
        sums
    })
}

/// Contribution of the chunks of `range` to the sum of `f(i)` over all rows; the range must begin at the limit of a
/// chunk. The contributions of consecutive ranges, merged in any order, give the result of [`sum`].
pub fn partial(range: Range<usize>, f: impl Fn(usize) -> f64 + Sync) -> Accumulator {
    debug_assert!(range.start.is_multiple_of(CHUNK), "row {} is not the first row of a chunk", range.start);
    let chunk = |c: usize| [abreast(c * CHUNK..((c + 1) * CHUNK).min(range.end), &f)];
    let mut all = [Accumulator::ZERO];
    accumulate(range.start / CHUNK, range.end.div_ceil(CHUNK), &chunk, &mut all);
    let [sum] = all;
    sum
}

/// Sums of the values of `chunk` over the chunks of `0..n`.
fn of_chunks<const N: usize>(n: usize, chunk: &(dyn Fn(Range<usize>) -> [f64; N] + Sync)) -> [f64; N] {
    if n <= CHUNK {
        // the exact sum of a single number, which has no negative zero
        return chunk(0..n).map(|x| x + 0.0);
    }
    let of = |c: usize| chunk(c * CHUNK..((c + 1) * CHUNK).min(n));
    let mut all = [const { Accumulator::ZERO }; N];
    accumulate(0, n.div_ceil(CHUNK), &of, &mut all);
    all.map(|sum| sum.value())
}

/// Adds `value(c)` of the chunks `from..to` to `all`.
fn accumulate<const N: usize>(
    from: usize,
    to: usize,
    value: &(dyn Fn(usize) -> [f64; N] + Sync),
    all: &mut [Accumulator; N],
) {
    if to - from <= TOGETHER {
        for c in from..to {
            all.iter_mut().zip(value(c)).for_each(|(all, x)| all.add(x));
        }
        return;
    }
    let (middle, mut rest) = (from + (to - from) / 2, [const { Accumulator::ZERO }; N]);
    both(&mut || accumulate(from, middle, value, all), &mut || accumulate(middle, to, value, &mut rest));
    all.iter_mut().zip(&rest).for_each(|(all, rest)| all.merge(rest));
}

/// Sum of `f(i)` over a range with eight partial sums, so that additions do not wait for one another.
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

/// Sums for all entries of `total` at once, where `f` sets the contributions of a chunk of indices; `chunks` is working
/// storage.
pub fn sum_each(n: usize, total: &mut [f64], chunks: &mut Vec<f64>, f: impl Fn(Range<usize>, &mut [f64]) + Sync) {
    let width = total.len();
    chunks.clear();
    chunks.resize(n.div_ceil(CHUNK) * width, 0.0);
    each_piece(0, width.max(1), chunks, &|c, out| f(c * CHUNK..n.min((c + 1) * CHUNK), out));
    let chunks = &*chunks;
    sweep_each(total, |k| {
        let mut all = Accumulator::ZERO;
        chunks.iter().skip(k).step_by(width).for_each(|x| all.add(*x));
        all.value()
    });
}

/// The first index in `0..n` for which `f` is true; `None` if there is none.
pub fn first(n: usize, f: impl Fn(usize) -> bool + Sync) -> Option<usize> {
    let found = AtomicUsize::new(usize::MAX);
    each_chunk(0, n.div_ceil(CHUNK), &|c| {
        // indices after one that was found need no check
        if c * CHUNK < found.load(Ordering::Relaxed)
            && let Some(i) = (c * CHUNK..((c + 1) * CHUNK).min(n)).find(|i| f(*i))
        {
            found.fetch_min(i, Ordering::Relaxed);
        }
    });
    Some(found.into_inner()).filter(|i| *i < n)
}

/// Maximum of `f(i)` over `0..n`, at least zero; NaN is ignored.
pub fn maximum(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    // positive numbers have the order of their bit patterns
    let largest = AtomicU64::new(0);
    each_chunk(0, n.div_ceil(CHUNK), &|c| {
        let chunk = (c * CHUNK..((c + 1) * CHUNK).min(n)).map(&f).fold(0.0, f64::max);
        if chunk > 0.0 {
            largest.fetch_max(chunk.to_bits(), Ordering::Relaxed);
        }
    });
    f64::from_bits(largest.into_inner())
}

/// Maximum of |f(i)| over `0..n`; infinite if a value is not finite.
pub fn largest_size(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    maximum(n, |i| {
        let size = f(i).abs();
        if size.is_finite() { size } else { f64::INFINITY }
    })
}

/// Minimum of `f(i)` over `0..n` for values that are not negative; infinite if `n` is zero.
pub fn minimum(n: usize, f: impl Fn(usize) -> f64 + Sync) -> f64 {
    let smallest = AtomicU64::new(f64::INFINITY.to_bits());
    each_chunk(0, n.div_ceil(CHUNK), &|c| {
        let chunk = (c * CHUNK..((c + 1) * CHUNK).min(n)).map(&f).fold(f64::INFINITY, f64::min);
        smallest.fetch_min(chunk.max(0.0).to_bits(), Ordering::Relaxed);
    });
    f64::from_bits(smallest.into_inner())
}

/// Index and value of the first maximum of `f(i)` over `0..n`, for values that are not negative; `None` if all are zero
/// or NaN.
pub fn largest(n: usize, f: impl Fn(usize) -> f64 + Sync) -> Option<(usize, f64)> {
    let most = maximum(n, &f);
    let found = if most > 0.0 { first(n, |i| f(i) == most) } else { None };
    found.map(|i| (i, most))
}

/// Inner product of two slices of equal length.
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    sum(a.len(), |i| a[i] * b[i])
}

/// Euclidean norm of a vector.
pub fn norm(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(n: usize) -> Vec<f64> {
        (0..n).map(|i| (i as f64 * 0.7).sin() * 10f64.powi((i % 37) as i32 - 18)).collect()
    }

    #[test]
    fn sums_do_not_depend_on_the_number_of_threads() {
        let values = values(100_000);
        let pool = |n| rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap();
        let one = pool(1).install(|| dot(&values, &values));
        let four = pool(4).install(|| dot(&values, &values));
        assert_eq!(one.to_bits(), four.to_bits());
    }

    #[test]
    fn pieces_of_the_rows_give_the_same_bits_in_any_order() {
        let (values, n) = (values(40_011), 40_011);
        let f = |i: usize| values[i];
        let (whole, units) = (sum(n, f), n.div_ceil(CHUNK));
        for pieces in [1, 2, 3, 7] {
            let limit = |k: usize| (k * units / pieces * CHUNK).min(n);
            let mut parts: Vec<_> = (0..pieces).map(|k| partial(limit(k)..limit(k + 1), f)).collect();
            for turn in 0..pieces {
                parts.rotate_left(turn);
                let mut all = Accumulator::ZERO;
                parts.iter().for_each(|part| all.merge(part));
                assert_eq!(all.value().to_bits(), whole.to_bits(), "{pieces} pieces");
            }
        }
    }

    #[test]
    fn all_ways_to_sum_agree() {
        for n in [0, 1, 1000, 1024, 1025, 9000] {
            let v = values(n);
            let [first, second] = sums(n, |i| [v[i], 1.0]);
            let (mut total, mut storage) = ([0.0; 2], Vec::new());
            sum_each(n, &mut total, &mut storage, |range, out| {
                (out[0], out[1]) = (abreast(range.clone(), &|i| v[i]), range.len() as f64);
            });
            let size: f64 = v.iter().map(|x| x.abs()).sum();
            assert_eq!(total[0].to_bits(), sum(n, |i| v[i]).to_bits(), "{n}");
            assert!((first - total[0]).abs() <= 1e-13 * size);
            assert_eq!([second, total[1]], [n as f64; 2]);
        }
    }

    #[test]
    fn sums_of_what_is_not_finite_are_not_finite() {
        for n in [10, 5000] {
            let with = |x: f64| sum(n, |i| if i == n / 2 { x } else { 1.0 });
            assert!(with(f64::NAN).is_nan() && with(f64::INFINITY) == f64::INFINITY);
        }
    }

    #[test]
    fn extremes_are_those_of_all_rows() {
        let f = |i: usize| ((i * 7919) % 5003) as f64;
        assert_eq!(largest(5003, f), Some(((0..5003).find(|i| f(*i) == 5002.0).unwrap(), 5002.0)));
        assert_eq!(minimum(5003, |i| f(i) + 1.0), 1.0);
        assert_eq!(
            (largest(9, |_| 0.0), minimum(0, f), largest_size(3, |_| f64::NAN)),
            (None, f64::INFINITY, f64::INFINITY)
        );
    }
}
