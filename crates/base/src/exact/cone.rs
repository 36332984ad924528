//! Supersonic flow past a cone at zero incidence.
//!
//! Behind an attached conical shock the flow is isentropic and depends only on the angle θ from the axis. With
//! velocities divided by the maximum speed √(2 h₀), u along the ray from the apex and v normal to it,
//!
//! u' = v,  v' = (v² u − a (2u + v cot θ)) / (a − v²),  a = (γ−1)/2 (1 − u² − v²),
//!
//! from the state behind an oblique shock of angle β down to the surface, where v = 0. As a function of β, the half
//! angle of the cone increases from zero at the Mach angle to a maximum and decreases again; in practice the weaker
//! shock occurs. The pressure is constant along the surface. Angles are in radians.
//!
//! Source: G. I. Taylor and J. W. Maccoll, *The air pressure on a cone moving at high speeds*, Proc. R. Soc. A 139 (1933), 278-311; charts 5
//! to 7 of NACA Report 1135 (1953).
use super::expansion::stagnation_pressure_ratio;
use super::roots::bisect;
use super::shock::{deflection, normal_shock};
use super::{Error, check_gamma};
use std::f64::consts::FRAC_PI_2;

/// Number of steps of the integration from the shock to the surface.
const STEPS: usize = 2000;
/// Minimum half angle (rad); for smaller ones the shock is a Mach wave.
const LEAST: f64 = 1e-3;
/// Number of shock angles among which the maximum half angle is searched.
const SEARCHED: usize = 60;

/// Flow past a cone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConeFlow {
    /// Shock angle to the axis (rad).
    pub shock_angle: f64,
    /// Ratio of the pressure behind the shock to that of the free stream.
    pub shock_pressure: f64,
    /// Ratio of the surface pressure to that of the free stream.
    pub surface_pressure: f64,
    /// Mach number on the surface.
    pub surface_mach: f64,
}

impl ConeFlow {
    /// Flow at the Mach number `mach` past a cone of this half angle (rad). Returns an error if `gamma`, the Mach
    /// number or the angle is outside its range, or the shock is detached.
    pub fn new(mach: f64, half_angle: f64, gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        if !(1.0 < mach && mach.is_finite()) {
            return Err(Error::Mach { what: "flow past a cone", range: "(1, inf)", mach });
        }
        if !(LEAST..FRAC_PI_2).contains(&half_angle) {
            return Err(Error::Angle { what: "flow past a cone", range: "[0.001, detachment]", angle: half_angle });
        }
        let mach_angle = (1.0 / mach).asin();
        let at = |k: usize| mach_angle + (FRAC_PI_2 - mach_angle) * k as f64 / SEARCHED as f64;
        let angle = |shock: f64| behind(mach, shock, gamma).surface();
        let (steepest, limit) = (1..SEARCHED)
            .map(|k| (at(k), angle(at(k)).0))
            .fold((mach_angle, 0.0), |a, b| if b.1 > a.1 { b } else { a });
        if half_angle > limit {
            return Err(Error::Detached { angle: half_angle, mach, limit });
        }
        let shock_angle = bisect(mach_angle, steepest, |shock| angle(shock).0 - half_angle);
        let start = behind(mach, shock_angle, gamma);
        let (_, speed) = start.surface();
        let surface_mach = mach_of_speed(speed, gamma);
        let shock_pressure = normal_shock((mach * shock_angle.sin()).max(1.0), gamma)?.pressure;
        let expansion = stagnation_pressure_ratio(mach_of_speed(start.speed(), gamma), gamma)
            / stagnation_pressure_ratio(surface_mach, gamma);
        Ok(Self { shock_angle, shock_pressure, surface_pressure: shock_pressure * expansion, surface_mach })
    }

    /// Pressure coefficient on the surface for the free-stream Mach number `mach`.
    pub fn surface_pressure_coefficient(&self, mach: f64, gamma: f64) -> f64 {
        (self.surface_pressure - 1.0) / (0.5 * gamma * mach * mach)
    }
}

/// Conical flow at one angle from the axis.
#[derive(Clone, Copy)]
struct Ray {
    angle: f64,
    /// Velocities u and v divided by the maximum speed.
    velocity: [f64; 2],
    gamma: f64,
}

/// The ray just behind a shock of the angle `shock` (rad).
fn behind(mach: f64, shock: f64, gamma: f64) -> Ray {
    let turn = deflection(mach, shock, gamma);
    let ahead = (1.0 + 2.0 / ((gamma - 1.0) * mach * mach)).powf(-0.5);
    // the velocity along the shock does not change
    let along = ahead * shock.cos();
    Ray { angle: shock, velocity: [along, -along * (shock - turn).tan()], gamma }
}

fn mach_of_speed(speed: f64, gamma: f64) -> f64 {
    (2.0 / (gamma - 1.0) / (1.0 / (speed * speed) - 1.0)).sqrt()
}

impl Ray {
    fn speed(&self) -> f64 {
        self.velocity[0].hypot(self.velocity[1])
    }

    fn slope(&self, angle: f64, [u, v]: [f64; 2]) -> [f64; 2] {
        let a = 0.5 * (self.gamma - 1.0) * (1.0 - u * u - v * v);
        [v, (v * v * u - a * (2.0 * u + v / angle.tan())) / (a - v * v)]
    }

    /// One step of the classical Runge-Kutta method.
    fn stepped(self, step: f64) -> Self {
        let along = |k: [f64; 2], h: f64| [self.velocity[0] + h * k[0], self.velocity[1] + h * k[1]];
        let (angle, half) = (self.angle, 0.5 * step);
        let k1 = self.slope(angle, self.velocity);
        let k2 = self.slope(angle + half, along(k1, half));
        let k3 = self.slope(angle + half, along(k2, half));
        let k4 = self.slope(angle + step, along(k3, step));
        let sum = std::array::from_fn(|d| (k1[d] + 2.0 * (k2[d] + k3[d]) + k4[d]) / 6.0);
        Self { angle: angle + step, velocity: along(sum, step), ..self }
    }

    /// Angle of the surface, where v = 0, and the speed there.
    fn surface(self) -> (f64, f64) {
        // small steps near the shock, because a − v² is almost zero behind a weak one
        let place = |k: usize| self.angle * (1.0 - (k as f64 / STEPS as f64).powi(2));
        let mut ray = self;
        for k in 1..STEPS {
            let next = ray.stepped(place(k) - ray.angle);
            if next.velocity[1] >= 0.0 {
                break;
            }
            ray = next;
        }
        // Newton's method for the last fraction of a step
        for _ in 0..3 {
            ray = ray.stepped(-ray.velocity[1] / ray.slope(ray.angle, ray.velocity)[1]);
        }
        (ray.angle, ray.velocity[0])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // NACA Report 1135, charts 5 and 6; Sims, NASA SP-3004 (1964): shock at 31.2 deg for 10 deg at Mach 2
    fn shocks_and_pressures_are_those_of_the_tables() {
        let table = [(2.0, 10.0, 31.206, 1.2925), (2.0, 15.0, 33.915, 1.5663), (3.0, 20.0, 29.615, 2.7909)];
        for (mach, half, shock, pressure) in table {
            let flow = ConeFlow::new(mach, f64::to_radians(half), 1.4).unwrap();
            assert!((flow.shock_angle.to_degrees() - shock).abs() < 1e-3, "{flow:?}");
            assert!((flow.surface_pressure - pressure).abs() < 1e-4, "{flow:?}");
        }
    }

    #[test]
    fn slender_cones_follow_von_karman() {
        // Cp = θ² (2 ln(2 / (θ √(M² − 1))) − 1): Th. von Kármán and N. B. Moore, Trans. ASME 54 (1932)
        let (mach, half) = (2.0_f64, 0.02_f64);
        let cp = ConeFlow::new(mach, half, 1.4).unwrap().surface_pressure_coefficient(mach, 1.4);
        let linear = half * half * (2.0 * (2.0 / (half * (mach * mach - 1.0).sqrt())).ln() - 1.0);
        assert!((cp / linear - 1.0).abs() < 0.01, "{cp} {linear}");
    }

    #[test] // NACA Report 1135, chart 5: a cone of 40.7 deg detaches the shock at Mach 2
    fn blunt_cones_are_refused() {
        assert!(ConeFlow::new(2.0, 40.0_f64.to_radians(), 1.4).is_ok());
        assert!(matches!(ConeFlow::new(2.0, 42.0_f64.to_radians(), 1.4), Err(Error::Detached { .. })));
        assert!(ConeFlow::new(0.9, 0.2, 1.4).is_err() && ConeFlow::new(2.0, 0.0, 1.4).is_err());
    }
}
