//! Numbers with derivatives (automatic differentiation in forward mode).
//!
//! A function that is generic in [`Scalar`] gives its value for `f64`, and value, first and second derivative for a
//! [`Jet`], x + x′ε + x″ε²/2 with ε³ = 0. The derivatives are exact up to rounding and follow from the same formula,
//! e.g. velocity and acceleration of a motion. If the first derivative suffices, a [`Dual`](super::dual::Dual) number
//! costs less.
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Arithmetic of a real number or of one with derivatives. Selections compare values: a maximum has the derivative of
/// the greater number.
pub trait Scalar:
    Copy
    + Add<Output = Self>
    + Add<f64, Output = Self>
    + Sub<Output = Self>
    + Sub<f64, Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The constant `value`, with zero derivatives.
    fn constant(value: f64) -> Self;
    /// The value without derivatives.
    fn value(self) -> f64;
    /// The composition f(self), where `f` returns value, first and second derivative for a real number.
    fn map(self, f: impl FnOnce(f64) -> [f64; 3]) -> Self;

    /// Sine of the number (an angle in radians).
    #[inline(always)]
    fn sin(self) -> Self {
        self.map(|x| {
            let (s, c) = x.sin_cos();
            [s, c, -s]
        })
    }

    /// Cosine of the number (an angle in radians).
    #[inline(always)]
    fn cos(self) -> Self {
        self.map(|x| {
            let (s, c) = x.sin_cos();
            [c, -s, -c]
        })
    }

    /// Reciprocal 1/x of the number.
    #[inline(always)]
    fn inverse(self) -> Self {
        self.map(|x| [1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x)])
    }

    /// Square root √x.
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(|x| {
            let root = x.sqrt();
            [root, 0.5 / root, -0.25 / (root * x)]
        })
    }

    /// Power xⁿ of the number x.
    #[inline(always)]
    fn powf(self, n: f64) -> Self {
        self.map(|x| [x.powf(n), n * x.powf(n - 1.0), n * (n - 1.0) * x.powf(n - 2.0)])
    }

    /// Exponential eˣ of the number x.
    #[inline(always)]
    fn exp(self) -> Self {
        self.map(|x| [x.exp(); 3])
    }

    /// Natural logarithm of the number.
    #[inline(always)]
    fn log(self) -> Self {
        self.map(|x| [x.ln(), 1.0 / x, -1.0 / (x * x)])
    }

    /// Absolute value |x|.
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(|x| [x.abs(), x.signum(), 0.0])
    }

    /// The greater of two numbers.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self.value() < other.value() || self.value().is_nan() { other } else { self }
    }

    /// The smaller of two numbers.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self.value() > other.value() || self.value().is_nan() { other } else { self }
    }
}

impl Scalar for f64 {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self
    }

    #[inline(always)]
    fn map(self, f: impl FnOnce(f64) -> [f64; 3]) -> Self {
        f(self)[0]
    }

    #[inline(always)]
    fn powf(self, n: f64) -> Self {
        // the compiler cannot optimise the unused derivatives away
        Self::powf(self, n)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::max(self, other)
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::min(self, other)
    }
}

/// A value with its first and second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Value x of the function.
    pub value: f64,
    /// First derivative x′ of the function.
    pub first: f64,
    /// Second derivative x″ of the function.
    pub second: f64,
}

impl Jet {
    /// The independent variable with the value `t`.
    pub fn variable(t: f64) -> Self {
        Self { value: t, first: 1.0, second: 0.0 }
    }
}

impl Scalar for Jet {
    fn constant(value: f64) -> Self {
        Self { value, first: 0.0, second: 0.0 }
    }

    fn value(self) -> f64 {
        self.value
    }

    /// Chain rule: (f∘x)′ = f′x′, (f∘x)″ = f″x′² + f′x″.
    fn map(self, f: impl FnOnce(f64) -> [f64; 3]) -> Self {
        let [value, slope, bend] = f(self.value);
        // a constant keeps zero derivatives even where those of `f` are infinite
        if self.first == 0.0 && self.second == 0.0 {
            return Self::constant(value);
        }
        Self { value, first: slope * self.first, second: bend * self.first * self.first + slope * self.second }
    }
}

impl Add for Jet {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self { value: self.value + o.value, first: self.first + o.first, second: self.second + o.second }
    }
}

impl Neg for Jet {
    type Output = Self;
    fn neg(self) -> Self {
        Self { value: -self.value, first: -self.first, second: -self.second }
    }
}

impl Sub for Jet {
    type Output = Self;
    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl Mul for Jet {
    type Output = Self;
    fn mul(self, o: Self) -> Self {
        Self {
            value: self.value * o.value,
            first: self.first * o.value + self.value * o.first,
            second: self.second * o.value + 2.0 * self.first * o.first + self.value * o.second,
        }
    }
}

impl Div for Jet {
    type Output = Self;
    fn div(self, o: Self) -> Self {
        // the value itself is divided, so that it equals that of `f64`
        Self { value: self.value / o.value, ..self * o.inverse() }
    }
}

impl Add<f64> for Jet {
    type Output = Self;
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}

impl Sub<f64> for Jet {
    type Output = Self;
    fn sub(self, o: f64) -> Self {
        Self { value: self.value - o, ..self }
    }
}

impl Mul<f64> for Jet {
    type Output = Self;
    fn mul(self, o: f64) -> Self {
        Self { value: self.value * o, first: self.first * o, second: self.second * o }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn formula<S: Scalar>(t: S) -> S {
        (t * t + S::constant(2.0)).sin() / (t - S::constant(7.0)) * t.cos()
    }

    #[test]
    fn derivatives_are_those_of_the_formula() {
        let h = 1e-4;
        for t in [-1.3, 0.0, 0.4, 2.1] {
            let jet = formula(Jet::variable(t));
            let (a, b, c) = (formula(t - h), formula(t), formula(t + h));
            assert_eq!(jet.value, b);
            assert!((jet.first - (c - a) / (2.0 * h)).abs() < 1e-7, "{t}");
            assert!((jet.second - (c - 2.0 * b + a) / (h * h)).abs() < 1e-6, "{t}");
        }
    }
}
