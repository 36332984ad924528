//! Scales of the free stream.
//!
//! A perfect gas: p = ρ R T, c = √(γ p/ρ), V = M c. Without dimensional values ρ = 1 and c = 1, hence p = 1/γ.
use super::Flow;

/// The free stream in numbers: dimensional when the case is, else in units of its density and sound speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeStreamScales {
    /// Density.
    pub density: f64,
    /// Speed of sound.
    pub sound_speed: f64,
    /// Static pressure.
    pub pressure: f64,
    /// Speed of the stream.
    pub speed: f64,
    /// Mach number.
    pub mach: f64,
}

impl FreeStreamScales {
    /// Dynamic pressure ρ V²/2.
    pub fn dynamic_pressure(&self) -> f64 {
        0.5 * self.density * self.speed * self.speed
    }
}

impl Flow {
    /// Density, sound speed, pressure, speed and Mach number of the free stream.
    ///
    /// Without `mach` and `velocity` (cases that start from their own field) the stream is at rest.
    pub fn reference(&self) -> FreeStreamScales {
        let (density, pressure) = self.state();
        let sound_speed = (self.gamma * pressure / density).sqrt();
        let (speed, mach) = match (self.velocity, self.mach) {
            (Some(velocity), _) => (velocity.0, velocity.0 / sound_speed),
            (None, mach) => (mach.unwrap_or(0.0) * sound_speed, mach.unwrap_or(0.0)),
        };
        FreeStreamScales { density, sound_speed, pressure, speed, mach }
    }

    /// True when the free stream has units.
    pub fn is_dimensional(&self) -> bool {
        [self.pressure.is_some(), self.temperature.is_some(), self.density.is_some()].iter().filter(|g| **g).count() > 1
    }

    /// Density and pressure.
    fn state(&self) -> (f64, f64) {
        let r = self.gas_constant;
        match (self.pressure, self.temperature, self.density) {
            (Some(p), _, Some(rho)) => (rho.0, p.0),
            (Some(p), Some(t), None) => (p.0 / (r * t.0), p.0),
            (None, Some(t), Some(rho)) => (rho.0, rho.0 * r * t.0),
            _ => (1.0, 1.0 / self.gamma),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::case::read;

    fn scales(flow: &str) -> super::FreeStreamScales {
        let text = format!("[flow]\n{flow}\n[cloud]\nspacing = 0.1\n[[body]]\nnaca = \"0012\"\n");
        read(&text, "case.toml").unwrap().flow.reference()
    }

    #[test]
    fn nondimensional_stream_has_unit_density_and_sound_speed() {
        let s = scales("mach = 0.8");
        assert_eq!((s.density, s.sound_speed, s.speed, s.mach), (1.0, 1.0, 0.8, 0.8));
        assert!((s.pressure - 1.0 / 1.4).abs() < 1e-15);
    }

    #[test] // U.S. Standard Atmosphere (1976), sea level: 1.225 kg/m³, 340.294 m/s
    fn dimensional_stream_agrees_with_the_standard_atmosphere() {
        let s = scales("velocity = \"170.147 m/s\"\npressure = \"1013.25 hPa\"\ntemperature = \"15 degC\"");
        assert!((s.density - 1.225).abs() < 1e-3);
        assert!((s.sound_speed - 340.294).abs() < 0.05);
        assert!((s.mach - 0.5).abs() < 1e-4);
        assert!((s.dynamic_pressure() - 0.5 * 1.225 * 170.147_f64.powi(2)).abs() < 20.0);
        let other = scales("mach = 0.5\npressure = 101325\ndensity = 1.225");
        assert!((other.speed - 170.147).abs() < 0.05);
    }
}
