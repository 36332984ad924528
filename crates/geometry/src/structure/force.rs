//! External forces that are functions of time.
use crate::case::formula::Formula;

/// A generalised force that time alone determines.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ForceHistory {
    /// None.
    #[default]
    Zero,
    /// amplitude·cos(ωt + phase).
    Cosine {
        /// Amplitude.
        amplitude: f64,
        /// Angular frequency ω; zero: a steady force.
        omega: f64,
        /// Phase, radians.
        phase: f64,
    },
    /// A formula of a case file in its own units.
    Formula {
        /// The formula in t and ω.
        formula: Formula,
        /// ω of the formula, in the units of its time.
        omega: f64,
        /// Units of the formula's time in one unit of time here.
        time: f64,
        /// Factor on its values.
        factor: f64,
    },
}

impl ForceHistory {
    /// A steady force.
    pub fn steady(value: f64) -> Self {
        Self::Cosine { amplitude: value, omega: 0.0, phase: 0.0 }
    }

    /// The force at time `t`.
    pub fn at(&self, t: f64) -> f64 {
        match self {
            Self::Zero => 0.0,
            Self::Cosine { amplitude, omega, phase } => amplitude * (omega * t + phase).cos(),
            Self::Formula { formula, omega, time, factor } => factor * formula.value(time * t, *omega),
        }
    }
}
