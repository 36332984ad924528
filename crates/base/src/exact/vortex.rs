//! Advected isentropic vortex.
//!
//! In a uniform stream of unit density, pressure and temperature, the vortex
//!
//! δu = −β/2π e^{(1−r²)/2} (y − y_c), δv = β/2π e^{(1−r²)/2} (x − x_c), T = 1 − (γ−1)β²/(8γπ²) e^{1−r²},
//!
//! with ρ = T^{1/(γ−1)} and p = ρT satisfies radial equilibrium and is advected without change: a smooth exact solution
//! of the Euler equations. In a periodic box, the nearest image of the vortex is used, which leaves a kink of relative
//! size e^{−L²/8} at half the box length L (4·10⁻⁶ for L = 10).
//!
//! Source: C.-W. Shu, *Essentially non-oscillatory and weighted essentially non-oscillatory schemes for hyperbolic
//! conservation laws*, in LNM 1697 (1998), section 4.
use super::{Error, GasState, check_gamma};
use crate::math::Vector;
use std::f64::consts::PI;

/// An isentropic vortex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IsentropicVortex {
    strength: f64,
    centre: Vector<2>,
    velocity: Vector<2>,
    gamma: f64,
    period: Option<Vector<2>>,
}

impl IsentropicVortex {
    /// A vortex of strength β that starts at `centre` and moves with `velocity`, in the whole plane.
    ///
    /// Returns an error if the temperature in the core would not be positive: (γ−1)β² e < 8γπ² must hold (β < 10.08 for
    /// γ = 1.4).
    pub fn new(strength: f64, centre: Vector<2>, velocity: Vector<2>, gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        if !(strength.is_finite() && core_temperature_drop(strength, gamma) * 1.0_f64.exp() < 1.0) {
            let range = "a strength for which the temperature in the core is positive";
            return Err(Error::Parameter { what: "strength of the vortex", value: strength, range });
        }
        Ok(Self { strength, centre, velocity, gamma, period: None })
    }

    /// This vortex in a box with the edge lengths `period`, periodic in all directions.
    pub fn periodic(self, period: Vector<2>) -> Self {
        Self { period: Some(period), ..self }
    }

    /// Centre of the vortex at time `t`, without periodic shift into the box.
    pub fn centre(&self, t: f64) -> Vector<2> {
        self.centre + self.velocity * t
    }

    /// State of the gas at `x` and time `t`.
    pub fn state(&self, x: &Vector<2>, t: f64) -> GasState<2> {
        let d = self.nearest(*x - self.centre(t));
        let r2 = d.norm_squared();
        let swirl = self.strength / (2.0 * PI) * (0.5 * (1.0 - r2)).exp();
        let temperature = 1.0 - core_temperature_drop(self.strength, self.gamma) * (1.0 - r2).exp();
        let density = temperature.powf(1.0 / (self.gamma - 1.0));
        let velocity = self.velocity + Vector([-d[1], d[0]]) * swirl;
        GasState { density, velocity, pressure: density * temperature }
    }

    fn nearest(&self, d: Vector<2>) -> Vector<2> {
        match self.period {
            None => d,
            Some(period) => Vector::from_fn(|k| d[k] - period[k] * (d[k] / period[k]).round()),
        }
    }
}

/// Factor of e^{1−r²} in the temperature.
fn core_temperature_drop(strength: f64, gamma: f64) -> f64 {
    (gamma - 1.0) * strength * strength / (8.0 * gamma * PI * PI)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vortex() -> IsentropicVortex {
        IsentropicVortex::new(5.0, Vector([5.0, 5.0]), Vector([1.0, 1.0]), 1.4).unwrap().periodic(Vector([10.0, 10.0]))
    }

    #[test] // centre_state of isentropic_vortex.toml
    fn core_follows_the_table() {
        let s = vortex().state(&Vector([5.0, 5.0]), 0.0);
        assert!((s.density - 0.4938073).abs() < 1e-7 && (s.pressure - 0.3723750).abs() < 1e-7);
        assert_eq!(s.velocity, Vector([1.0, 1.0]));
    }

    #[test]
    fn returns_after_one_period() {
        for x in [Vector([4.3, 5.9]), Vector([0.1, 9.9]), Vector([6.0, 2.0])] {
            let (a, b) = (vortex().state(&x, 0.0), vortex().state(&x, 10.0));
            assert!((a.density - b.density).abs() < 1e-14 && (a.velocity - b.velocity).norm() < 1e-14);
        }
    }

    #[test]
    fn pressure_balances_the_rotation() {
        // dp/dr = ρ w²/r by central differences on a ray
        let (v, h) = (vortex(), 1e-4);
        for r in [0.3, 1.0, 2.2] {
            let at = |r: f64| v.state(&Vector([5.0 + r * 0.6, 5.0 + r * 0.8]), 0.0);
            let swirl = (at(r).velocity - Vector([1.0, 1.0])).norm();
            let slope = (at(r + h).pressure - at(r - h).pressure) / (2.0 * h);
            assert!((slope - at(r).density * swirl * swirl / r).abs() < 1e-7);
        }
    }

    #[test]
    fn strengths_that_empty_the_core_are_refused() {
        assert!(IsentropicVortex::new(10.0, Vector::ZERO, Vector::ZERO, 1.4).is_ok());
        assert!(IsentropicVortex::new(10.1, Vector::ZERO, Vector::ZERO, 1.4).is_err());
        assert!(IsentropicVortex::new(f64::NAN, Vector::ZERO, Vector::ZERO, 1.4).is_err());
    }
}
