//! A natural mode that was found, as the case would have it from a file.
use crate::case::{ModeTable, StructureMode};

/// A natural mode that was found.
pub(super) struct Natural {
    /// Angular frequency.
    pub(super) omega: f64,
    /// Generalised mass.
    pub(super) mass: f64,
    /// Gravity's part along it.
    pub(super) weight: f64,
    /// Momentum at the start along it.
    pub(super) momentum: f64,
    /// Damping in proportion to mass and to stiffness.
    pub(super) damping: [f64; 2],
    /// Estimate of the relative error of the frequency.
    pub(super) error: Option<f64>,
    /// Shape.
    pub(super) table: ModeTable,
}

impl Natural {
    /// Number `k` as the case would have it from a file. Damping in proportion to mass and stiffness is ζ = α/(2ω) + βω/2; the
    /// velocity at the start and gravity are their parts along the mode.
    pub(super) fn into_mode(self, k: usize) -> StructureMode {
        let (mass, omega, [alpha, beta]) = (self.mass, self.omega, self.damping);
        let told = self.error.map(|e| format!(" ± {:.1e} %", 100.0 * e)).unwrap_or_default();
        StructureMode {
            name: format!("mode-{}", k + 1),
            file: String::new(),
            mass,
            frequency: None,
            reduced_frequency: None,
            stiffness: Some(mass * omega * omega),
            damping_ratio: if omega > 0.0 { 0.5 * (alpha / omega + beta * omega) } else { 0.0 },
            cubic: 0.0,
            free_play: 0.0,
            initial: 0.0,
            initial_rate: self.momentum / mass,
            force: (self.weight != 0.0).then(|| format!("{:?}", self.weight)),
            table: Some(self.table),
            told: format!("{:.5e}{told} (generalised mass {mass:.4e})", omega / std::f64::consts::TAU),
        }
    }
}
