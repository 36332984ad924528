//! Exact sums, which do not depend on the order of the summands.
//!
//! A number in double precision is an integer multiple of 2^-1074. The accumulator stores the sum of such numbers as
//! one long integer in limbs of 40 bits (Kulisch, *Computer Arithmetic and Validity*, 2013, ch. 8), so that nothing is
//! rounded until the sum is read. A limb has 23 spare bits: 2^23 numbers can be added before it overflows.

/// Number of bits of a limb, and number of limbs that hold every finite number in double precision.
const BITS: usize = 40;
const LIMBS: usize = 54;
/// Number of stored bits of the significand, and exponent of the smallest unit, 2^-1074.
const SIGNIFICAND: u32 = 52;
const LOWEST: i32 = 1074;
/// Flags for summands that are not finite.
const POSITIVE: u8 = 1;
const NEGATIVE: u8 = 2;
const NO_NUMBER: u8 = 4;

/// The exact sum of the numbers that were added.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accumulator {
    /// Limb k has the unit 2^(40 k − 1074).
    limbs: [i64; LIMBS],
    /// Flags of infinities and NaN among the summands.
    stray: u8,
}

impl Accumulator {
    /// The empty sum.
    pub const ZERO: Self = Self { limbs: [0; LIMBS], stray: 0 };

    /// Adds one number.
    #[inline]
    pub fn add(&mut self, x: f64) {
        let bits = x.to_bits();
        let exponent = (bits >> SIGNIFICAND & 0x7ff) as usize;
        let fraction = bits & ((1 << SIGNIFICAND) - 1);
        if exponent == 0x7ff {
            self.stray |= match (fraction, bits >> 63) {
                (0, 0) => POSITIVE,
                (0, _) => NEGATIVE,
                _ => NO_NUMBER,
            };
            return;
        }
        // subnormal numbers have the same unit as the smallest normal ones
        let significand = if exponent == 0 { fraction } else { fraction | 1 << SIGNIFICAND };
        let place = exponent.max(1) - 1;
        let (k, shift) = (place / BITS, place % BITS);
        let wide = u128::from(significand) << shift;
        let sign = if bits >> 63 == 0 { 1 } else { -1 };
        for (i, limb) in self.limbs[k..k + 3].iter_mut().enumerate() {
            *limb += sign * (wide >> (i * BITS) & MASK) as i64;
        }
    }

    /// Adds the sum of another accumulator.
    pub fn merge(&mut self, other: &Self) {
        self.limbs.iter_mut().zip(&other.limbs).for_each(|(a, b)| *a += b);
        self.stray |= other.stray;
    }

    /// The sum in double precision, rounded once; infinities and NaN among the summands give an infinity or NaN.
    pub fn value(&self) -> f64 {
        match self.stray {
            0 => {}
            POSITIVE => return f64::INFINITY,
            NEGATIVE => return f64::NEG_INFINITY,
            _ => return f64::NAN,
        }
        let mut limbs = self.limbs;
        let top = carry(&mut limbs);
        if top < 0 {
            limbs.iter_mut().for_each(|limb| *limb = -*limb);
            carry(&mut limbs);
            return -read(&limbs);
        }
        read(&limbs)
    }
}

const MASK: u128 = (1 << BITS) - 1;

/// Normalises all limbs except the last to 0 ≤ limb < 2^40 and returns the last one.
fn carry(limbs: &mut [i64; LIMBS]) -> i64 {
    for k in 0..LIMBS - 1 {
        let over = limbs[k] >> BITS;
        limbs[k] -= over << BITS;
        limbs[k + 1] += over;
    }
    limbs[LIMBS - 1]
}

/// The number with these limbs, none of which is negative.
fn read(limbs: &[i64; LIMBS]) -> f64 {
    let Some(top) = limbs.iter().rposition(|limb| *limb != 0) else { return 0.0 };
    let low = top.saturating_sub(2);
    let high = limbs[low..=top].iter().rev().fold(0u128, |all, limb| all << BITS | *limb as u128);
    // the lower bits matter only if the rest lies exactly between two numbers
    let below = u128::from(limbs[..low].iter().any(|limb| *limb != 0));
    let exponent = (low * BITS) as i32 - LOWEST;
    let half = exponent / 2;
    (high | below) as f64 * power(half) * power(exponent - half)
}

/// The power 2^n, for normal numbers.
fn power(n: i32) -> f64 {
    f64::from_bits(((n + 1023) as u64) << SIGNIFICAND)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(values: &[f64]) -> f64 {
        let mut all = Accumulator::ZERO;
        values.iter().for_each(|x| all.add(*x));
        all.value()
    }

    #[test]
    fn one_number_is_its_own_sum() {
        let tiny = f64::from_bits(1);
        let all = [1.0, -3.7, 1e-300, 1e300, f64::MAX, f64::MIN_POSITIVE, tiny, -tiny * 12345.0, 0.1, 2f64.powi(-1000)];
        for x in all {
            assert_eq!(sum(&[x]).to_bits(), x.to_bits(), "{x:e}");
            assert_eq!(sum(&[x, -x]).to_bits(), 0, "{x:e}");
        }
    }

    #[test]
    fn sums_are_rounded_once() {
        assert_eq!(sum(&[1e308, 1.0, -1e308]), 1.0);
        assert_eq!(sum(&[1.0, 2f64.powi(-53)]), 1.0, "half a unit goes to the even neighbour");
        assert_eq!(sum(&[1.0, 2f64.powi(-53), 2f64.powi(-1000)]), 1.0 + f64::EPSILON, "more than half goes up");
        assert_eq!(sum(&[-1.0, -(2f64.powi(-53)), -(2f64.powi(-1000))]), -1.0 - f64::EPSILON);
        assert_eq!(sum(&[f64::MAX, f64::MAX]), f64::INFINITY);
        assert_eq!(sum(&vec![0.1; 1000]), 100.0);
    }

    #[test]
    fn what_is_not_finite_stays_so() {
        let (inf, nan) = (f64::INFINITY, f64::NAN);
        assert_eq!(sum(&[1.0, inf]), inf);
        assert_eq!(sum(&[-inf, 1.0]), -inf);
        assert!(sum(&[inf, -inf]).is_nan() && sum(&[nan, 1.0]).is_nan() && sum(&[inf, nan]).is_nan());
    }
}
