//! A piston at the end of a tube of gas at rest.
//!
//! A piston that starts impulsively into the gas creates a shock. With M = u/c₀ and g = (γ + 1)/4, the shock speed is
//! c₀ (gM + √(1 + g²M²)), and the pressure on the piston is p/p₀ = 1 + γM (gM + √(1 + g²M²)) (Rankine-Hugoniot). A
//! piston that is withdrawn, or moves smoothly, creates a simple wave: on the piston, p/p₀ = (1 + (γ −
//! 1)M/2)^(2γ/(γ−1)) for any amplitude, and every state propagates at u + c = c₀ + (γ + 1)u/2 (Landau and Lifshitz,
//! Fluid Mechanics, § 101). This is valid until the wave breaks; for small M the limit is the acoustic solution p − p₀
//! = ρ₀ c₀ u(t − x/c₀).
use super::roots::bisect;
use super::{Error, GasState, check_gamma};
use crate::math::Vector;

/// Number of phases, between maximum retreat and maximum advance, at which the breaking of the wave is searched.
const PHASES: u32 = 128;

/// Gas at rest in front of a piston.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tube {
    density: f64,
    pressure: f64,
    gamma: f64,
}

/// State at a piston that starts impulsively into the gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Impulse {
    /// Pressure on the piston.
    pub pressure: f64,
    /// Density at the piston.
    pub density: f64,
    /// Speed of the shock.
    pub shock_speed: f64,
}

/// Motion of an oscillating piston, X(t) = −(U/ω) cos ωt, with the velocity U sin ωt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oscillation {
    /// Amplitude U of the velocity.
    pub speed: f64,
    /// Angular frequency ω [rad/time].
    pub omega: f64,
}

impl Tube {
    /// A tube of gas with the given density, pressure and ratio of specific heats; an error if one of them is outside
    /// its range.
    pub fn new(density: f64, pressure: f64, gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        if !(density > 0.0 && pressure > 0.0 && density.is_finite() && pressure.is_finite()) {
            return Err(Error::State { side: "piston", density, velocity: 0.0, pressure });
        }
        Ok(Self { density, pressure, gamma })
    }

    /// Speed of sound c₀.
    pub fn sound_speed(&self) -> f64 {
        (self.gamma * self.pressure / self.density).sqrt()
    }

    /// Shock in front of a piston that starts impulsively with `speed` into the gas; an error if the speed is outside
    /// its range.
    pub fn impulse(&self, speed: f64) -> Result<Impulse, Error> {
        if !(0.0 <= speed && speed.is_finite()) {
            let what = "speed of an impulsively started piston";
            return Err(Error::Parameter {
                what,
                value: speed,
                range: "zero or positive; use `on_piston` for a withdrawn piston",
            });
        }
        let mach = speed / self.sound_speed();
        let g = 0.25 * (self.gamma + 1.0) * mach;
        let shock_mach = g + (1.0 + g * g).sqrt();
        Ok(Impulse {
            pressure: self.pressure * (1.0 + self.gamma * mach * shock_mach),
            density: self.density * shock_mach / (shock_mach - mach),
            shock_speed: self.sound_speed() * shock_mach,
        })
    }

    /// State on a piston with the momentary velocity `speed` (positive into the gas) in a simple wave; a vacuum below
    /// −2c₀/(γ − 1).
    pub fn on_piston(&self, speed: f64) -> GasState<1> {
        let sound = (1.0 + 0.5 * (self.gamma - 1.0) * speed / self.sound_speed()).max(0.0);
        let density = self.density * sound.powf(2.0 / (self.gamma - 1.0));
        let pressure = self.pressure * sound.powf(2.0 * self.gamma / (self.gamma - 1.0));
        GasState { density, velocity: Vector([speed]), pressure }
    }

    /// Distance from the mean position of the piston at which the wave breaks. Neighbouring characteristics meet after
    /// the time (c₀ + (γ − 1)u/2) / ((γ + 1)u̇/2); the shortest distance counts.
    pub fn breaks_at(&self, piston: &Oscillation) -> f64 {
        let (c, fast) = (self.sound_speed(), 0.5 * (self.gamma + 1.0));
        let meeting = |k: u32| {
            let t = std::f64::consts::PI * (f64::from(k) / f64::from(PHASES) - 0.5) / piston.omega;
            let u = piston.velocity(t);
            let rise = fast * piston.omega * piston.speed * (piston.omega * t).cos();
            piston.place(t) + (c + fast * u) * (c + (fast - 1.0) * u) / rise
        };
        (1..PHASES).map(meeting).fold(f64::INFINITY, f64::min)
    }

    /// State at `x` (from the mean position of the piston) and time `t` in the wave of an oscillating piston; an error
    /// outside the gas or where the solution is not valid.
    pub fn simple_wave(&self, piston: &Oscillation, x: f64, t: f64) -> Result<GasState<1>, Error> {
        let c = self.sound_speed();
        let fast = 0.5 * (self.gamma + 1.0);
        // the characteristic that left the piston at time `from` is now at reach(from), which decreases with `from`
        // until the wave breaks
        let reach = |from: f64| piston.place(from) + (c + fast * piston.velocity(from)) * (t - from);
        if x < piston.place(t) || self.breaks_at(piston) <= x {
            let what = "the gas between the piston and the position where the wave breaks";
            return Err(Error::Outside { what, x, y: 0.0 });
        }
        let slowest = c - fast * piston.speed.abs();
        if slowest <= 0.0 {
            let what = "speed of an oscillating piston";
            return Err(Error::Parameter { what, value: piston.speed, range: "less than 2 c/(gamma + 1)" });
        }
        let earliest = t - (x + piston.speed.abs() / piston.omega) / slowest - 1.0 / piston.omega;
        let from = bisect(earliest, t, |from| reach(from) - x);
        Ok(self.on_piston(piston.velocity(from)))
    }
}

impl Oscillation {
    /// Position of the piston.
    pub fn place(&self, t: f64) -> f64 {
        -self.speed / self.omega * (self.omega * t).cos()
    }

    /// Velocity of the piston.
    pub fn velocity(&self, t: f64) -> f64 {
        self.speed * (self.omega * t).sin()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    fn near(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance * b.abs(), "{a} is not {b}");
    }

    /// Mean and amplitudes of the first harmonics over a period.
    fn amplitudes(f: impl Fn(f64) -> f64, omega: f64) -> [f64; 4] {
        let n = 4096;
        let samples: Vec<f64> = (0..n).map(|k| f(TAU / omega * f64::from(k) / f64::from(n))).collect();
        std::array::from_fn(|m| {
            let part = |wave: fn(f64) -> f64| -> f64 {
                let angle = |k: usize| TAU * (k * m) as f64 / f64::from(n);
                samples.iter().enumerate().map(|(k, p)| p * wave(angle(k))).sum::<f64>() / f64::from(n)
            };
            if m == 0 { part(f64::cos) } else { 2.0 * part(f64::cos).hypot(part(f64::sin)) }
        })
    }

    #[test] // reference/piston/impulsive_piston_exact.csv: density and pressure 1, γ = 1.4
    fn an_impulse_makes_the_shock_of_the_table() {
        let tube = Tube::new(1.0, 1.0, 1.4).unwrap();
        let rows = [
            (0.1, 1.2447363, 1.1244736, 1.0873564, 0.8875122, 0.9182938),
            (1.0, 1.9266499, 2.9266499, 2.0791562, 0.2735863, 0.3962092),
            (3.0, 3.9540659, 12.8621978, 4.1444368, 0.0070690, 0.0290956),
        ];
        for (u, shock, p, density, p_out, density_out) in rows {
            let i = tube.impulse(u).unwrap();
            near(i.shock_speed, shock, 1e-7);
            near(i.pressure, p, 1e-7);
            near(i.density, density, 1e-7);
            near(tube.on_piston(-u).pressure, p_out, 1e-5);
            near(tube.on_piston(-u).density, density_out, 1e-5);
        }
        assert_eq!(tube.on_piston(-6.0).pressure, 0.0);
        assert!(tube.impulse(-1.0).is_err() && Tube::new(1.0, -1.0, 1.4).is_err());
    }

    #[test] // reference/harmonics/piston_wall_pressure_harmonics.csv, rows `exact`
    fn the_wall_pressure_has_the_harmonics_of_the_table() {
        let tube = Tube::new(1.4, 1.0, 1.4).unwrap();
        let rows = [
            (0.05, [1.001050131, 0.07002625131, 0.001050175003, 8.750656253e-6]),
            (0.3, [1.037970202, 0.4256802075, 0.03802695309, 0.001895103919]),
        ];
        for (mach, expected) in rows {
            let got = amplitudes(|t| tube.on_piston(mach * t.sin()).pressure, 1.0);
            (0..4).for_each(|m| near(got[m], expected[m], 1e-9));
        }
        // acoustic pressure ρ₀c₀u
        near(tube.density * tube.sound_speed() * 1e-6, tube.on_piston(1e-6).pressure - 1.0, 1e-5);
    }

    #[test] // reference/harmonics/piston_tube_simplewave_harmonics.csv: ω = 2π, places in wave lengths
    fn the_wave_in_the_tube_has_the_harmonics_of_the_table() {
        let tube = Tube::new(1.4, 1.0, 1.4).unwrap();
        let rows = [
            (0.01, 3.315727981, [0.9999719992, 0.0138905758, 0.001717513081, 0.0003172601276]),
            (0.05, 1.326291192, [0.999299474, 0.06778665401, 0.01632677416, 0.005766913836]),
        ];
        for (mach, x, expected) in rows {
            let piston = Oscillation { speed: mach, omega: TAU };
            let got = amplitudes(|t| tube.simple_wave(&piston, x, t).unwrap().pressure, TAU);
            (0..4).for_each(|m| near(got[m], expected[m], 1e-7));
        }
        let piston = Oscillation { speed: 0.05, omega: TAU };
        // c²/(ω U (γ + 1)/2) for small amplitudes
        near(tube.breaks_at(&piston), 1.0 / (1.2 * TAU * 0.05), 0.01);
        assert!(tube.simple_wave(&piston, 2.7, 0.3).is_err());
        assert!(tube.simple_wave(&piston, -1.0, 0.0).is_err());
    }
}
