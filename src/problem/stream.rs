//! Streams of another pressure and temperature at the same Mach number: what matched static equilibria are sought in.
use super::given::Given;
use crate::case::{Density, Pressure, Structure, Temperature};

/// Pressure and temperature of a stream over those of a case.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamRatio {
    /// Pressure.
    pub pressure: f64,
    /// Temperature, the square of the sound speed.
    pub temperature: f64,
}

impl StreamRatio {
    /// The stream of the case.
    pub const SAME: Self = Self { pressure: 1.0, temperature: 1.0 };

    /// Density.
    pub fn density(self) -> f64 {
        self.pressure / self.temperature
    }

    /// Stiffness, damping and mass in units of the stream, over these in units of the case's.
    pub fn structural(self) -> [f64; 3] {
        [1.0 / self.pressure, self.temperature.sqrt() / self.pressure, 1.0 / self.density()]
    }
}

/// The same structure in a stream of the same Mach number. With units the stream changes; without them, it is what all is measured in,
/// and the numbers of the structure change.
pub(super) fn enter_stream(Given { case, modes }: &mut Given, ratio: StreamRatio) {
    let flow = &mut case.flow;
    if flow.is_dimensional() {
        flow.pressure = flow.pressure.map(|p| Pressure(p.0 * ratio.pressure));
        flow.temperature = flow.temperature.map(|t| Temperature(t.0 * ratio.temperature));
        flow.density = flow.density.map(|d| Density(d.0 * ratio.density()));
    }
    let dimensional = flow.is_dimensional();
    case.structures.iter_mut().for_each(|s| enter(s, ratio, dimensional));
    if !dimensional {
        *modes = modes.in_stream(ratio);
    }
}

/// Turns its numbers into those of a stream; what is told in units stays as it is where the stream changes with them.
pub(super) fn enter(structure: &mut Structure, ratio: StreamRatio, dimensional: bool) {
    let faster = ratio.temperature.sqrt();
    for number in [&mut structure.reduced_speed, &mut structure.reduced_velocity] {
        *number = number.map(|v| v * faster);
    }
    // U/(b omega sqrt(mu)): the mass ratio goes as one over the density
    structure.speed_index = structure.speed_index.map(|v| v * ratio.pressure.sqrt());
    structure.mass_ratio = structure.mass_ratio.map(|m| m / ratio.density());
    structure.modes.iter_mut().for_each(|m| m.reduced_frequency = m.reduced_frequency.map(|k| k / faster));
    if dimensional {
        return;
    }
    let [stiffness, damping, mass] = ratio.structural();
    structure.stiffness.values_mut().for_each(|k| *k *= stiffness);
    structure.frequency.values_mut().for_each(|w| w.0 /= faster);
    structure.damping.values_mut().for_each(|c| *c *= damping);
    structure.mass.iter_mut().for_each(|m| m.0 *= mass);
    structure.inertia.iter_mut().flatten().for_each(|j| j.0 *= mass);
    structure.gravity.iter_mut().flatten().for_each(|g| g.0 /= ratio.temperature);
    for mode in &mut structure.modes {
        mode.mass *= mass;
        mode.stiffness = mode.stiffness.map(|k| k * stiffness);
        mode.frequency.iter_mut().for_each(|w| w.0 /= faster);
    }
}
