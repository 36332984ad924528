//! Dual numbers: a value with one derivative.
//!
//! x + x′ε with ε² = 0. This suffices for a tangent or the change of a residual, at about twice the cost of the
//! formula. [`Jet`](super::jet::Jet) carries the second derivative as well.
use super::jet::Scalar;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A value with its derivative in one direction.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dual {
    /// Value x.
    pub value: f64,
    /// Derivative x′.
    pub derivative: f64,
}

impl Dual {
    /// The independent variable with the value `x`.
    #[inline(always)]
    pub const fn variable(x: f64) -> Self {
        Self { value: x, derivative: 1.0 }
    }
}

impl Scalar for Dual {
    #[inline(always)]
    fn constant(value: f64) -> Self {
        Self { value, derivative: 0.0 }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    /// Chain rule (f∘x)′ = f′x′; a constant keeps a zero derivative even where that of `f` is infinite.
    #[inline(always)]
    fn map(self, f: impl FnOnce(f64) -> [f64; 3]) -> Self {
        let [value, slope, _] = f(self.value);
        Self { value, derivative: if self.derivative == 0.0 { 0.0 } else { slope * self.derivative } }
    }

    /// Power without the second derivative, which costs another power.
    #[inline(always)]
    fn powf(self, n: f64) -> Self {
        let value = self.value.powf(n);
        let slope = if self.value == 0.0 { n * self.value.powf(n - 1.0) } else { n * value / self.value };
        Self { value, derivative: if self.derivative == 0.0 { 0.0 } else { slope * self.derivative } }
    }

    #[inline(always)]
    fn inverse(self) -> Self {
        let over = 1.0 / self.value;
        Self { value: over, derivative: if self.derivative == 0.0 { 0.0 } else { -over * over * self.derivative } }
    }
}

impl Add for Dual {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: Self) -> Self {
        Self { value: self.value + o.value, derivative: self.derivative + o.derivative }
    }
}

impl Sub for Dual {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: Self) -> Self {
        Self { value: self.value - o.value, derivative: self.derivative - o.derivative }
    }
}

impl Neg for Dual {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, derivative: -self.derivative }
    }
}

impl Mul for Dual {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: Self) -> Self {
        Self { value: self.value * o.value, derivative: self.derivative * o.value + self.value * o.derivative }
    }
}

impl Div for Dual {
    type Output = Self;
    #[inline(always)]
    fn div(self, o: Self) -> Self {
        let value = self.value / o.value;
        Self { value, derivative: (self.derivative - value * o.derivative) / o.value }
    }
}

impl Add<f64> for Dual {
    type Output = Self;
    #[inline(always)]
    fn add(self, o: f64) -> Self {
        Self { value: self.value + o, ..self }
    }
}

impl Sub<f64> for Dual {
    type Output = Self;
    #[inline(always)]
    fn sub(self, o: f64) -> Self {
        Self { value: self.value - o, ..self }
    }
}

impl Mul<f64> for Dual {
    type Output = Self;
    #[inline(always)]
    fn mul(self, o: f64) -> Self {
        Self { value: self.value * o, derivative: self.derivative * o }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::jet::Jet;

    fn formula<S: Scalar>(t: S) -> S {
        (-(t * t) + 2.5).abs().sqrt() / (t - 7.0) * t.cos() + (t * 3.0 - t.inverse()).powf(2.0).max(t.sin())
    }

    #[test]
    fn the_derivative_is_that_of_a_jet() {
        for t in [-1.3, 0.4, 2.1] {
            let (dual, jet) = (formula(Dual::variable(t)), formula(Jet::variable(t)));
            assert!((dual.value - jet.value).abs() < 1e-14);
            assert!((dual.derivative - jet.first).abs() < 1e-13 * jet.first.abs().max(1.0), "{t}");
        }
        assert_eq!(Dual::constant(0.0).powf(0.3).derivative, 0.0);
        assert_eq!(Dual::constant(f64::MIN_POSITIVE).inverse().derivative, 0.0);
        assert_eq!(Dual::variable(0.0).powf(2.0).derivative, 0.0);
    }
}
