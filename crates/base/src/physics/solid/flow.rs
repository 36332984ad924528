//! Flow stress of metals: equivalent stress at which a material yields.
//!
//! σ_y = σ(ε_p) · r(ε̇_p) · (1 − T*ᵐ) is a product of hardening with the equivalent plastic strain ε_p, a factor of the
//! plastic strain rate, and a factor of temperature, T* = (T − T_r)/(T_m − T_r) limited to [0, 1]. Johnson and Cook
//! (1983) is the case (A + B ε_pⁿ)(1 + C ln(ε̇_p/ε̇₀))(1 − T*ᵐ); Voce (1948) and Perzyna (1966) are others. Stress,
//! time and temperature may be in any consistent units.
use crate::math::jet::Scalar;

/// Hardening with the equivalent plastic strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Hardening {
    /// σ = start + linear ε_p + saturation (1 − e^(−exponent ε_p)): linear and Voce (1948).
    Voce {
        /// Initial yield stress.
        start: f64,
        /// Slope of the linear part (stress).
        linear: f64,
        /// Total increase by the exponential part (stress).
        saturation: f64,
        /// Rate of the exponential part, per unit of strain.
        exponent: f64,
    },
    /// σ = start + modulus ε_pⁿ: Ludwik, and Johnson and Cook with A, B and n.
    Power {
        /// Initial yield stress A.
        start: f64,
        /// Hardening modulus B (stress).
        modulus: f64,
        /// Exponent n.
        exponent: f64,
    },
}

/// Factor of the plastic strain rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rate {
    /// The factor 1: rate independent.
    Independent,
    /// 1 + C ln(ε̇_p/ε̇₀), and 1 at rates below ε̇₀ (Johnson & Cook 1983).
    Logarithmic {
        /// Factor C.
        factor: f64,
        /// Reference rate ε̇₀, per unit of time.
        reference: f64,
    },
    /// 1 + (η ε̇_p)^(1/N), the overstress for ε̇_p = ⟨σ/σ_y − 1⟩ᴺ/η (Perzyna 1966).
    Overstress {
        /// Viscosity η, a time.
        viscosity: f64,
        /// Exponent N.
        exponent: f64,
    },
}

/// Thermal softening factor 1 − T*ᵐ with T* = (T − reference)/(melting − reference) limited to [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Softening {
    /// Temperature T_r below which there is no softening.
    pub reference: f64,
    /// Melting temperature T_m, at which the flow stress vanishes.
    pub melting: f64,
    /// Exponent m.
    pub exponent: f64,
}

/// Von Mises plasticity: flow stress and kinematic hardening.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plasticity {
    /// Isotropic hardening with plastic strain.
    pub hardening: Hardening,
    /// Modulus of Prager's kinematic hardening (stress): increase of the back stress per plastic strain in uniaxial
    /// tension.
    pub kinematic: f64,
    /// Factor of the plastic strain rate.
    pub rate: Rate,
    /// Factor of the temperature; `None`: 1.
    pub softening: Option<Softening>,
}

/// Constants of the Johnson-Cook flow stress (1983).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JohnsonCook {
    /// Yield stress A.
    pub start: f64,
    /// Hardening modulus B.
    pub modulus: f64,
    /// Hardening exponent n.
    pub exponent: f64,
    /// Coefficient C of the strain rate.
    pub rate_factor: f64,
    /// Reference strain rate ε̇₀.
    pub rate: f64,
    /// Thermal softening with T_r, T_m and m.
    pub softening: Softening,
}

impl Plasticity {
    /// Linear hardening start + slope ε_p; with zero slope, perfect plasticity.
    pub const fn linear(start: f64, slope: f64) -> Self {
        Self {
            hardening: Hardening::Voce { start, linear: slope, saturation: 0.0, exponent: 0.0 },
            kinematic: 0.0,
            rate: Rate::Independent,
            softening: None,
        }
    }

    /// The Johnson-Cook flow stress (A + B ε_pⁿ)(1 + C ln(ε̇_p/ε̇₀))(1 − T*ᵐ) (1983).
    pub const fn johnson_cook(c: JohnsonCook) -> Self {
        Self {
            hardening: Hardening::Power { start: c.start, modulus: c.modulus, exponent: c.exponent },
            kinematic: 0.0,
            rate: Rate::Logarithmic { factor: c.rate_factor, reference: c.rate },
            softening: Some(c.softening),
        }
    }

    /// Flow stress for an equivalent plastic strain, its rate, and a temperature.
    #[inline]
    pub fn flow_stress<S: Scalar>(&self, strain: S, rate: S, temperature: S) -> S {
        let softening = self.softening.map_or(S::constant(1.0), |s| s.factor(temperature));
        self.hardening.stress(strain) * self.rate.factor(rate) * softening
    }
}

impl Hardening {
    /// Stress for an equivalent plastic strain at low rate and reference temperature.
    #[inline(always)]
    pub fn stress<S: Scalar>(&self, strain: S) -> S {
        match *self {
            Self::Voce { start, linear, saturation, exponent } => {
                let decay = strain.map(|x| {
                    let e = (-exponent * x).exp();
                    [1.0 - e, exponent * e, -exponent * exponent * e]
                });
                strain * linear + decay * saturation + start
            }
            Self::Power { start, modulus, exponent } => power(strain, exponent) * modulus + start,
        }
    }
}

impl Rate {
    /// Factor for a plastic strain rate.
    #[inline(always)]
    pub fn factor<S: Scalar>(&self, rate: S) -> S {
        match *self {
            Self::Independent => S::constant(1.0),
            Self::Logarithmic { factor, reference } => {
                if rate.value() > reference {
                    (rate * (1.0 / reference)).map(|x| [x.ln(), 1.0 / x, -1.0 / (x * x)]) * factor + 1.0
                } else {
                    S::constant(1.0)
                }
            }
            Self::Overstress { viscosity, exponent } => power(rate * viscosity, 1.0 / exponent) + 1.0,
        }
    }
}

impl Softening {
    /// Factor for a temperature.
    #[inline(always)]
    pub fn factor<S: Scalar>(&self, temperature: S) -> S {
        let t = (temperature - self.reference) * (1.0 / (self.melting - self.reference));
        -power(t.min(S::constant(1.0)), self.exponent) + 1.0
    }
}

/// xⁿ for positive x, and the constant 0 otherwise, where the derivative may be infinite.
#[inline(always)]
fn power<S: Scalar>(x: S, n: f64) -> S {
    if !(x.value() > 0.0) {
        S::constant(0.0)
    } else if n == 1.0 {
        x
    } else {
        x.powf(n)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::dual::Dual;

    const COPPER: JohnsonCook = JohnsonCook {
        start: 90e6,
        modulus: 292e6,
        exponent: 0.31,
        rate_factor: 0.025,
        rate: 1.0,
        softening: Softening { reference: 293.0, melting: 1356.0, exponent: 1.09 },
    };

    #[test]
    fn johnson_cook_is_the_formula() {
        let law = Plasticity::johnson_cook(COPPER);
        for (e, rate, t) in [(0.1, 1e3, 400.0), (0.5, 2.0, 1000.0), (1e-6, 1e5, 294.0)] {
            let star = (t - 293.0) / (1356.0 - 293.0f64);
            let exact = (90e6 + 292e6 * f64::powf(e, 0.31)) * (1.0 + 0.025 * f64::ln(rate)) * (1.0 - star.powf(1.09));
            assert!((law.flow_stress(e, rate, t) / exact - 1.0).abs() < 1e-14);
        }
        assert_eq!(law.flow_stress(0.0, 0.0, 0.0), 90e6);
        assert_eq!(law.flow_stress(1.0, 0.0, 2000.0), 0.0);
    }

    #[test]
    fn every_factor_has_its_derivative() {
        let voce = Hardening::Voce { start: 1.0, linear: 2.0, saturation: 3.0, exponent: 4.0 };
        let rates = [COPPER.rate_factor, 0.3].map(|factor| Rate::Logarithmic { factor, reference: 0.2 });
        let overstress = Rate::Overstress { viscosity: 0.7, exponent: 3.0 };
        let factors: [Box<dyn Fn(Dual) -> Dual>; 5] = [
            Box::new(|x| voce.stress(x)),
            Box::new(|x| rates[0].factor(x)),
            Box::new(|x| rates[1].factor(x)),
            Box::new(|x| overstress.factor(x)),
            Box::new(|x| COPPER.softening.factor(x * 900.0)),
        ];
        for f in factors {
            let (x, h) = (0.6, 1e-5);
            let slope = (f(Dual::constant(x + h)).value - f(Dual::constant(x - h)).value) / (2.0 * h);
            let exact = f(Dual::variable(x)).derivative;
            assert!((exact - slope).abs() < 1e-8 * exact.abs().max(1.0), "{exact} {slope}");
        }
    }
}
