//! Numbers that carry their derivatives.
//!
//! A function of time written once over [`Scalar`] gives its value for `f64`, and value, velocity and acceleration for a
//! [`Jet`]: x + x′ε + x″ε²/2 with ε³ = 0, so that derivatives are exact to rounding and belong to the same formula.
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What a formula needs of its numbers.
pub trait Scalar:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self> + Div<Output = Self>
{
    /// A constant.
    fn constant(value: f64) -> Self;
    /// The number itself.
    fn value(self) -> f64;
    /// f(self), where `f` gives value, first and second derivative at a number.
    fn map(self, f: impl FnOnce(f64) -> [f64; 3]) -> Self;

    /// Sine.
    fn sin(self) -> Self {
        self.map(|x| {
            let (s, c) = x.sin_cos();
            [s, c, -s]
        })
    }

    /// Cosine.
    fn cos(self) -> Self {
        self.map(|x| {
            let (s, c) = x.sin_cos();
            [c, -s, -c]
        })
    }
}

impl Scalar for f64 {
    fn constant(value: f64) -> Self {
        value
    }

    fn value(self) -> f64 {
        self
    }

    fn map(self, f: impl FnOnce(f64) -> [f64; 3]) -> Self {
        f(self)[0]
    }
}

/// A value with its first and second derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jet {
    /// Value.
    pub value: f64,
    /// First derivative.
    pub first: f64,
    /// Second derivative.
    pub second: f64,
}

impl Jet {
    /// The independent variable at `t`.
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
        // what does not move has no derivative, even where that of `f` is infinite
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
        let inverse = o.map(|x| [1.0 / x, -1.0 / (x * x), 2.0 / (x * x * x)]);
        // the value itself is divided, so that it is the one of `f64`
        Self { value: self.value / o.value, ..self * inverse }
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
