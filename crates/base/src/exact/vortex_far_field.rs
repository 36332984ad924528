//! Point vortex in a subsonic free stream: the far field of a lifting aerofoil.
//!
//! Far from an aerofoil with the circulation Γ, the linearised flow is a vortex scaled by the Prandtl-Glauert rule,
//!
//! u = U cos α + F sin θ, v = U sin α − F cos θ, F = Γ β / (2π r (1 − M² sin²(θ − α))), β = √(1 − M²),
//!
//! (r, θ) are polar coordinates about the vortex, and Γ is positive for lift (clockwise). Density and pressure follow
//! from constant total enthalpy and entropy. The lift per span is ρUΓ (Kutta-Joukowski), so that Γ = ½ CL c U. The
//! error of a far field at a distance of r chords is reduced from O(1/r) to O(1/r²).
//!
//! Source: J. L. Thomas and M. D. Salas, *Far-field boundary conditions for transonic lifting solutions to the Euler
//! equations*, AIAA Journal 24 (1986) 1074-1080.
use super::{Error, GasState, check_gamma};
use crate::math::Vector;
use crate::math::jet::Scalar;
use std::f64::consts::PI;

/// Minimum ratio of the temperature to that of the free stream; it keeps the state finite near the core, where the
/// formula is not valid.
const LEAST_TEMPERATURE: f64 = 0.1;

/// A free stream with a point vortex.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FarFieldVortex {
    free_stream: GasState<2>,
    gamma: f64,
    circulation: f64,
    centre: Vector<2>,
    mach_squared: f64,
    direction: Vector<2>,
}

impl FarFieldVortex {
    /// Field of a vortex with the strength `circulation` (positive for lift) at `centre`. Returns an error if the free
    /// stream is not physical, at rest or not subsonic.
    pub fn new(free_stream: GasState<2>, gamma: f64, circulation: f64, centre: Vector<2>) -> Result<Self, Error> {
        check_gamma(gamma)?;
        let GasState { density, velocity, pressure } = free_stream;
        if !(0.0 < density && density.is_finite() && 0.0 < pressure && pressure.is_finite()) {
            return Err(Error::State { side: "free-stream", density, velocity: velocity.norm(), pressure });
        }
        let mach = free_stream.mach(gamma);
        if !(0.0 < mach && mach < 1.0) {
            return Err(Error::Mach { what: "vortex far field", range: "(0, 1)", mach });
        }
        let direction = velocity.unit();
        Ok(Self { free_stream, gamma, circulation, centre, mach_squared: mach * mach, direction })
    }

    /// This field with another circulation.
    pub fn with_circulation(self, circulation: f64) -> Self {
        Self { circulation, ..self }
    }

    /// Velocity at `x` minus that of the free stream; zero at the centre.
    pub fn velocity_increment(&self, x: &Vector<2>) -> Vector<2> {
        self.increment(x, self.circulation)
    }

    fn increment<S: Scalar>(&self, x: &Vector<2>, circulation: S) -> Vector<2, S> {
        let d = *x - self.centre;
        let r2 = d.norm_squared();
        if r2 == 0.0 {
            return Vector::zero();
        }
        // r sin(θ − α) is the distance from the line through the vortex along the free stream
        let across = self.direction[0] * d[1] - self.direction[1] * d[0];
        let stretched = r2 - self.mach_squared * across * across;
        let strength = circulation * ((1.0 - self.mach_squared).sqrt() / (2.0 * PI * stretched));
        Vector([strength * d[1], strength * -d[0]])
    }

    /// State of the gas at `x`.
    pub fn state(&self, x: &Vector<2>) -> GasState<2> {
        self.state_of(x, self.circulation)
    }

    /// State of the gas at `x` for the circulation `circulation`.
    pub fn state_of<S: Scalar>(&self, x: &Vector<2>, circulation: S) -> GasState<2, S> {
        let free = &self.free_stream;
        let velocity = Vector::constant(&free.velocity) + self.increment(x, circulation);
        let speed_change = velocity.norm_squared() * (1.0 / free.velocity.norm_squared()) - 1.0;
        let cooling = speed_change * (0.5 * (self.gamma - 1.0) * self.mach_squared);
        let temperature = (S::constant(1.0) - cooling).max(S::constant(LEAST_TEMPERATURE));
        let density = temperature.powf(1.0 / (self.gamma - 1.0)) * free.density;
        GasState { density, velocity, pressure: density * temperature * (free.pressure / free.density) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(mach: f64, alpha: f64, circulation: f64) -> FarFieldVortex {
        let velocity = Vector([alpha.cos(), alpha.sin()]) * mach;
        let free = GasState { density: 1.0, velocity, pressure: 1.0 / 1.4 };
        FarFieldVortex::new(free, 1.4, circulation, Vector([0.25, 0.0])).unwrap()
    }

    #[test]
    fn circulation_is_recovered_on_any_loop() {
        let f = field(0.7, 0.05, 0.3);
        for radius in [2.0, 30.0] {
            let n = 720;
            let sum: f64 = (0..n)
                .map(|i| {
                    let angle = 2.0 * PI * f64::from(i) / f64::from(n);
                    let x = Vector([0.25, 0.0]) + Vector([angle.cos(), angle.sin()]) * radius;
                    f.velocity_increment(&x).dot(&Vector([-angle.sin(), angle.cos()])) * 2.0 * PI * radius
                        / f64::from(n)
                })
                .sum();
            assert!((sum + 0.3).abs() < 1e-12, "{sum}");
        }
    }

    #[test]
    fn increment_solves_the_linearised_equation() {
        // (1−M²) u_x + v_y = 0 and v_x = u_y for α = 0
        let (f, h, x) = (field(0.8, 0.0, 1.0), 1e-4, Vector([3.0, 2.0]));
        let d = |axis: usize| {
            let e = Vector::axis(axis) * h;
            (f.velocity_increment(&(x + e)) - f.velocity_increment(&(x - e))) * (0.5 / h)
        };
        assert!((0.36 * d(0)[0] + d(1)[1]).abs() < 1e-9);
        assert!((d(0)[1] - d(1)[0]).abs() < 1e-9);
    }

    #[test]
    fn total_enthalpy_and_entropy_stay() {
        let f = field(0.5, 0.03, 0.1);
        let enthalpy = |s: &GasState<2>| 3.5 * s.pressure / s.density + 0.5 * s.velocity.norm_squared();
        let far = f.state(&Vector([1e9, 0.0]));
        for x in [Vector([8.0, 3.0]), Vector([-10.0, -1.0]), Vector([0.0, 12.0])] {
            let s = f.state(&x);
            assert!((enthalpy(&s) - enthalpy(&far)).abs() < 1e-9);
            assert!((s.pressure / s.density.powf(1.4) * 1.4 - 1.0).abs() < 1e-12);
        }
        // lift increases the speed above and decreases it below
        assert!(f.state(&Vector([0.25, 5.0])).pressure < f.state(&Vector([0.25, -5.0])).pressure);
    }

    #[test]
    fn the_core_is_finite_and_bad_streams_are_refused() {
        let f = field(0.5, 0.0, 1.0);
        for x in [Vector([0.25, 0.0]), Vector([0.25, 1e-9])] {
            let s = f.state(&x);
            assert!(s.density > 0.0 && s.pressure > 0.0 && s.velocity.is_finite());
        }
        let free = |u| GasState { density: 1.0, velocity: Vector([u, 0.0]), pressure: 1.0 / 1.4 };
        assert!(FarFieldVortex::new(free(1.2), 1.4, 0.1, Vector::ZERO).is_err());
        assert!(FarFieldVortex::new(free(0.0), 1.4, 0.1, Vector::ZERO).is_err());
    }
}
