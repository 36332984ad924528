//! Orders of the small dense blocks that sparse matrices are made of.
//!
//! Kernels are compiled for each order that some physics has: one for a scalar, two for an oscillator, three for a transported
//! pair with its time, four and five for a gas in the plane and in space, six for gas with a model of turbulence and for solids in
//! space. Any other order is refused when a matrix is made; none falls to a kernel of another order.

/// Orders that kernels serve.
pub const SERVED: std::ops::RangeInclusive<usize> = 1..=6;

/// Entries of the largest block.
pub const MOST_ENTRIES: usize = 36;

/// Refuses an order that no kernel serves.
///
/// # Panics
///
/// Outside [`SERVED`].
pub fn assert_served(block: usize) {
    assert!(SERVED.contains(&block), "{}", not_served(block));
}

/// What to say of an order that no kernel serves.
pub(super) fn not_served(block: usize) -> String {
    format!("no kernel serves blocks of {block} unknowns, only {SERVED:?}; a new order is added in `math::blocks`")
}

/// The array whose entry `k` is `f(k)`.
///
/// A plain loop, so that it becomes part of the kernel around it: what the standard library has for this is compiled apart from it.
#[inline(always)]
pub fn array<T: Copy, const N: usize>(mut f: impl FnMut(usize) -> T) -> [T; N] {
    let mut out = [f(0); N];
    for (k, slot) in out.iter_mut().enumerate().skip(1) {
        *slot = f(k);
    }
    out
}

/// Writes the numbers of a block's row or column to the start of `out`.
#[inline(always)]
pub(super) fn store<const N: usize>(values: &[f32; N], out: &mut [f32]) {
    out[..N].copy_from_slice(values);
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
