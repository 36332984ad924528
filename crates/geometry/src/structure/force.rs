//! Prescribed forces as functions of time.
use crate::case::formula::Formula;

/// A generalised force that depends on time only.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ForceHistory {
    /// No force.
    #[default]
    Zero,
    /// The force amplitude·cos(ωt + phase).
    Cosine {
        /// Amplitude.
        amplitude: f64,
        /// Angular frequency ω; zero: a steady force.
        omega: f64,
        /// Phase [rad].
        phase: f64,
    },
    /// A formula of a case file, in the units of the case.
    Formula {
        /// The formula in t and ω.
        formula: Formula,
        /// Angular frequency ω in the formula, in the units of its time.
        omega: f64,
        /// Length of the solver's unit of time in units of the formula's time.
        time: f64,
        /// Factor on the values of the formula.
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
