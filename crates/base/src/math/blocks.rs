//! Supported orders of the small dense blocks of sparse matrices.
//!
//! Kernels are compiled for the orders that the physics uses: one for a scalar, two for an oscillator, three for a
//! turbulence model of two variables with their time scale, four and five for a gas in 2-D and 3-D, six for a gas with
//! turbulence model and for solids in 3-D. A matrix of any other order cannot be created.

/// Block orders for which kernels exist.
pub const SERVED: std::ops::RangeInclusive<usize> = 1..=6;

/// Number of entries of the largest block.
pub const MOST_ENTRIES: usize = 36;

/// Panics for a block order without a kernel.
///
/// # Panics
///
/// If `block` is outside [`SERVED`].
pub fn assert_served(block: usize) {
    assert!(SERVED.contains(&block), "{}", not_served(block));
}

/// Message for a block order without a kernel.
pub(super) fn not_served(block: usize) -> String {
    format!("no kernel serves blocks of {block} unknowns, only {SERVED:?}; a new order is added in `math::blocks`")
}

/// The array whose entry `k` is `f(k)`.
///
/// This is a plain loop, so that the compiler inlines it into the kernel; the function of the standard library is
/// compiled separately.
#[inline(always)]
pub fn array<T: Copy, const N: usize>(mut f: impl FnMut(usize) -> T) -> [T; N] {
    let mut out = [f(0); N];
    let mut k = 1;
    while k < N {
        out[k] = f(k);
        k += 1;
    }
    out
}

/// Copies the row or column of a block to the start of `out`.
#[inline(always)]
pub(super) fn store<const N: usize>(values: &[f32; N], out: &mut [f32]) {
    out[..N].copy_from_slice(values);
}

/// Inverts a block of order `n` in place.
pub(super) fn invert_block(n: usize, own: &mut [f32]) {
    let (mut block, mut inverse) = ([0.0; MOST_ENTRIES].map(f64::from), [0.0; MOST_ENTRIES].map(f64::from));
    block.iter_mut().zip(&*own).for_each(|(b, o)| *b = f64::from(*o));
    invert(n, &block[..n * n], &mut inverse[..n * n]);
    own.iter_mut().zip(&inverse).for_each(|(o, i)| *o = *i as f32);
}

/// Inverse of a small matrix by Gauss-Jordan elimination with row pivoting; a singular matrix gives the zero matrix.
pub(super) fn invert(n: usize, a: &[f64], out: &mut [f64]) {
    let mut m = [[0.0f64; 12]; 6];
    for r in 0..n {
        for c in 0..n {
            m[r][c] = a[c * n + r];
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
            out[c * n + r] = m[r][n + c];
        }
    }
}

/// Evaluates an expression with the constant `N` set to the order of a block.
macro_rules! with_block {
    ($block:expr, $n:ident => $body:expr) => {
        match $block {
            1 => {
                const $n: usize = 1;
                $body
            }
            2 => {
                const $n: usize = 2;
                $body
            }
            3 => {
                const $n: usize = 3;
                $body
            }
            4 => {
                const $n: usize = 4;
                $body
            }
            5 => {
                const $n: usize = 5;
                $body
            }
            6 => {
                const $n: usize = 6;
                $body
            }
            other => panic!("{}", crate::math::blocks::not_served(other)),
        }
    };
}
pub(crate) use with_block;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_order_has_its_own_kernel() {
        for block in SERVED {
            assert_eq!(with_block!(block, N => N), block);
        }
    }

    #[test]
    #[should_panic(expected = "no kernel serves blocks of 7 unknowns")]
    fn other_orders_are_refused() {
        assert_served(7);
    }
}
