//! Sums of numbers that do not depend on the order in which the numbers are added.
//!
//! A number in double precision is a whole number of 2^-1074. The accumulator holds the sum of such numbers as one long whole number in
//! limbs of 40 bits (Kulisch, *Computer Arithmetic and Validity*, 2013, ch. 8), so that nothing is rounded until the sum is read. A limb has 23
//! bits to spare: 2^23 numbers can be added before one overflows.

/// Bits of a limb, and limbs that hold every finite number in double precision.
const BITS: usize = 40;
const LIMBS: usize = 54;
/// Bits of the significand of a number, and bits that its exponent starts at.
const SIGNIFICAND: u32 = 52;
const LOWEST: i32 = 1074;
/// What is remembered of numbers that are not finite.
const POSITIVE: u8 = 1;
const NEGATIVE: u8 = 2;
const NO_NUMBER: u8 = 4;

/// The exact sum of what was added to it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Accumulator {
    /// Limb k counts in 2^(40 k − 1074).
    limbs: [i64; LIMBS],
    /// Infinities and numbers that are none among what was added, bit by bit.
    stray: u8,
}

impl Accumulator {
    /// The sum of nothing.
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
        // numbers without the leading one have the exponent of the smallest that have it
        let significand = if exponent == 0 { fraction } else { fraction | 1 << SIGNIFICAND };
        let place = exponent.max(1) - 1;
        let (k, shift) = (place / BITS, place % BITS);
        let wide = u128::from(significand) << shift;
        let sign = if bits >> 63 == 0 { 1 } else { -1 };
        for (i, limb) in self.limbs[k..k + 3].iter_mut().enumerate() {
            *limb += sign * (wide >> (i * BITS) & MASK) as i64;
        }
    }

    /// Adds all that was added to another one.
    pub fn merge(&mut self, other: &Self) {
        self.limbs.iter_mut().zip(&other.limbs).for_each(|(a, b)| *a += b);
        self.stray |= other.stray;
    }

    /// The sum in double precision, rounded once; what is not finite among the numbers is so in their sum.
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

/// Brings all limbs but the last to 0 ≤ limb < 2^40; the last.
fn carry(limbs: &mut [i64; LIMBS]) -> i64 {
    for k in 0..LIMBS - 1 {
        let over = limbs[k] >> BITS;
        limbs[k] -= over << BITS;
        limbs[k + 1] += over;
    }
    limbs[LIMBS - 1]
}

/// The number whose limbs, none of them negative, these are.
fn read(limbs: &[i64; LIMBS]) -> f64 {
    let Some(top) = limbs.iter().rposition(|limb| *limb != 0) else { return 0.0 };
    let low = top.saturating_sub(2);
    let high = limbs[low..=top].iter().rev().fold(0u128, |all, limb| all << BITS | *limb as u128);
    // what lies below decides only where the rest is just between two numbers
    let below = u128::from(limbs[..low].iter().any(|limb| *limb != 0));
    let exponent = (low * BITS) as i32 - LOWEST;
    let half = exponent / 2;
    (high | below) as f64 * power(half) * power(exponent - half)
}

/// 2^n, where that has a leading one.
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
