//! Ringleb's flow: steady compressible flow around the edge of a plate.
//!
//! The stream function ψ = sin θ / q solves Chaplygin's hodograph equation for every gas, where q is the speed, θ the
//! angle between the velocity and the x axis, and 1/k = ψ identifies a streamline. With unit stagnation density and
//! sound speed, c² = 1 − (γ−1)/2 q², ρ = c^{2/(γ−1)}, p = ρ^γ/γ and
//!
//! x = J/2 + cos 2θ /(2ρq²) = 1/(2ρ) (1/q² − 2/k²) + J/2, y = sin 2θ /(2ρq²), sin θ = q/k,
//! J = Σ_{m=1,3,…,n} 1/(m cᵐ) − ½ ln((1+c)/(1−c)), n = 2/(γ−1) odd.
//!
//! Points of equal speed lie on a circle of radius 1/(2ρq²) about (J/2, 0), so that the inverse map is a scalar root in
//! q. The distance to the circle increases with q wherever M² cos²θ < 1; this derivative vanishes on the limit line,
//! where the map folds. The solution is the smallest root, on the branch that contains the subsonic flow.
//!
//! Conventions: the gas flows downwards (v < 0), in from y > 0 with u < 0 and out at y < 0 with u > 0; the speed is
//! largest on y = 0. The plate is y = 0, x > J/2 for the speed at its edge (ψ = 0). Usual walls are the streamlines k =
//! 0.7 and k = 1.5. Limits: γ = 1 + 2/n with n odd (1.4, 5/3, …); points beyond the limit line give an error.
//!
//! Source: F. Ringleb, *Exakte Lösungen der Differentialgleichungen einer adiabatischen Gasströmung*, ZAMM 20 (1940),
//! 185-198; J was derived here for general n.
use super::roots::bisect;
use super::{Error, GasState, check_gamma};
use crate::math::Vector;
use std::f64::consts::PI;

/// Maximum distance of 2/(γ−1) from an odd number that is regarded as round-off in γ.
const ODD_TOLERANCE: f64 = 1e-9;
/// Number of steps in which supersonic speeds are searched for the first root.
const SEARCH_STEPS: usize = 400;
/// Minimum fraction of the limit speed in the subsonic search: points with lower speeds are in the far field at rest.
const SLOWEST: f64 = 1e-12;

/// Ringleb's flow for a given gas.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ringleb {
    gamma: f64,
    /// Exponent n = 2/(γ−1), an odd number.
    exponent: i32,
}

/// A point of the hodograph plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hodograph {
    /// Speed q divided by the stagnation sound speed.
    pub speed: f64,
    /// Streamline parameter k: reciprocal of the stream function, equal to the speed where the streamline crosses y =
    /// 0.
    pub streamline: f64,
    /// Angle θ of the streamline in [0, π] (rad); below π/2 for y > 0.
    pub angle: f64,
}

impl Ringleb {
    /// Flow of a gas with the ratio of specific heats `gamma` = 1 + 2/n, n odd; an error for any other.
    pub fn new(gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        let n = 2.0 / (gamma - 1.0);
        let odd = 2.0 * ((n - 1.0) / 2.0).round() + 1.0;
        if (n - odd).abs() > ODD_TOLERANCE || !(1.0..=99.0).contains(&odd) {
            return Err(Error::GammaNotClosed { gamma });
        }
        Ok(Self { gamma, exponent: odd as i32 })
    }

    /// State of the gas at `x`; an error beyond the limit line.
    pub fn state(&self, x: &Vector<2>) -> Result<GasState<2>, Error> {
        Ok(self.state_of(&self.hodograph(x)?))
    }

    /// State of the gas at a point of the hodograph plane.
    pub fn state_of(&self, point: &Hodograph) -> GasState<2> {
        let density = self.density(point.speed);
        let velocity = Vector([point.angle.cos(), point.angle.sin()]) * -point.speed;
        GasState { density, velocity, pressure: density.powf(self.gamma) / self.gamma }
    }

    /// Speed and streamline at `x`, by the inverse map; an error beyond the limit line.
    pub fn hodograph(&self, x: &Vector<2>) -> Result<Hodograph, Error> {
        let outside = Error::Outside { what: "the region of Ringleb's flow up to its limit line", x: x[0], y: x[1] };
        if !x.is_finite() {
            return Err(outside);
        }
        let (low, high) = self.bracket(x).ok_or(outside)?;
        let speed = bisect(low, high, |q| self.excess(q, x));
        let mut double_angle = x[1].atan2(x[0] - 0.5 * self.shift(speed));
        if double_angle < 0.0 {
            double_angle += 2.0 * PI;
        }
        let angle = 0.5 * double_angle;
        Ok(Hodograph { speed, streamline: speed / angle.sin(), angle })
    }

    /// Position on the streamline `k` at which the speed is `q` ≤ `k`, for y ≥ 0 (`above`) or y ≤ 0.
    pub fn position(&self, q: f64, k: f64, above: bool) -> Vector<2> {
        let sine = (q / k).clamp(-1.0, 1.0);
        let radius = self.radius(q);
        let y = 2.0 * sine * (1.0 - sine * sine).sqrt() * radius;
        let x = 0.5 * self.shift(q) + (1.0 - 2.0 * sine * sine) * radius;
        Vector([x, if above { y } else { -y }])
    }

    /// `n` ≥ 2 points along the streamline `k` in the direction of the flow, between the two points with the speed
    /// `q_min` < `k`.
    pub fn streamline(&self, k: f64, q_min: f64, n: usize) -> Vec<Vector<2>> {
        // equal steps of θ are uniform in space where the streamline curvature is largest
        let first = (q_min / k).clamp(0.0, 1.0).asin();
        let step = (PI - 2.0 * first) / (n.max(2) - 1) as f64;
        (0..n.max(2))
            .map(|i| {
                let angle = first + step * i as f64;
                self.position(k * angle.sin(), k, angle <= 0.5 * PI)
            })
            .collect()
    }

    /// Unit normal of the streamline through `x`, towards smaller stream function (larger k); an error beyond the limit
    /// line.
    pub fn normal(&self, x: &Vector<2>) -> Result<Vector<2>, Error> {
        let angle = self.hodograph(x)?.angle;
        Ok(Vector([angle.sin(), -angle.cos()]))
    }

    /// Density at the speed `q`, divided by the stagnation density.
    pub fn density(&self, q: f64) -> f64 {
        self.sound_speed(q).powi(self.exponent)
    }

    /// Sound speed at the speed `q`, divided by the stagnation value.
    pub fn sound_speed(&self, q: f64) -> f64 {
        (1.0 - 0.5 * (self.gamma - 1.0) * q * q).max(0.0).sqrt()
    }

    /// Twice the x coordinate of the centre of the circle of speed `q`.
    fn shift(&self, q: f64) -> f64 {
        let c = self.sound_speed(q);
        let series: f64 = (1..=self.exponent).step_by(2).map(|m| 1.0 / (f64::from(m) * c.powi(m))).sum();
        // the form (1+c)/(1−c) = (1+c)²/((γ−1)/2 q²) has no cancellation at small q
        series - ((1.0 + c) / ((0.5 * (self.gamma - 1.0)).sqrt() * q)).ln()
    }

    /// Radius of the circle of speed `q`.
    fn radius(&self, q: f64) -> f64 {
        0.5 / (self.density(q) * q * q)
    }

    /// Distance from `x` to the centre of the circle of speed `q`, minus its radius.
    fn excess(&self, q: f64, x: &Vector<2>) -> f64 {
        (x[0] - 0.5 * self.shift(q)).hypot(x[1]) - self.radius(q)
    }

    /// Two speeds that bracket the smallest root of `excess`; `None` if there is no root.
    fn bracket(&self, x: &Vector<2>) -> Option<(f64, f64)> {
        let sonic = (2.0 / (self.gamma + 1.0)).sqrt();
        let vacuum = (2.0 / (self.gamma - 1.0)).sqrt();
        if self.excess(sonic, x) >= 0.0 {
            let mut low = 0.5 * sonic;
            while self.excess(low, x) >= 0.0 {
                low *= 0.5;
                if low < SLOWEST {
                    return None;
                }
            }
            return Some((low, sonic));
        }
        let speed = |i: usize| sonic + (vacuum - sonic) * i as f64 / SEARCH_STEPS as f64;
        (1..SEARCH_STEPS).find(|&i| self.excess(speed(i), x) >= 0.0).map(|i| (speed(i - 1), speed(i)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = include_str!("../../../../verification/ringleb/reference.csv");

    /// Rows of the table: k, q, x, y, ρ, p, Mach number, |u|, |v|.
    fn rows() -> Vec<[f64; 9]> {
        let numbers = TABLE.lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit()));
        let rows: Vec<[f64; 9]> = numbers
            .map(|l| {
                let fields: Vec<f64> = l.split(',').map(|f| f.parse().unwrap()).collect();
                fields.try_into().unwrap()
            })
            .collect();
        assert_eq!(rows.len(), 65);
        rows
    }

    fn flow() -> Ringleb {
        Ringleb::new(1.4).unwrap()
    }

    #[test]
    fn the_inverse_map_returns_the_table() {
        for [k, _, x, y, density, pressure, mach, u, v] in rows() {
            for side in [1.0, -1.0] {
                let s = flow().state(&Vector([x, side * y])).unwrap();
                assert!((s.density - density).abs() < 1e-8 && (s.pressure - pressure).abs() < 1e-8, "{k} {s:?}");
                assert!((s.mach(1.4) - mach).abs() < 2e-8);
                // the signs are those of this code (see mass conservation below); u is the square root of a small
                // number near y = 0
                assert!((s.velocity - Vector([-side * u.abs(), -v.abs()])).max_abs() < 1e-7, "{:?}", s.velocity);
                let point = flow().hodograph(&Vector([x, side * y])).unwrap();
                assert!((point.streamline - k).abs() < 1e-7);
                assert!(
                    (flow().position(point.speed, point.streamline, side > 0.0) - Vector([x, side * y])).max_abs()
                        < 1e-8
                );
            }
        }
    }

    /// Derivatives of (density u, density v, u, v) along an axis.
    fn slope(flow: &Ringleb, x: Vector<2>, axis: usize) -> [f64; 4] {
        let h = 1e-4;
        let at = |s: f64| {
            let w = flow.state(&(x + Vector::axis(axis) * (s * h))).unwrap();
            [w.density * w.velocity[0], w.density * w.velocity[1], w.velocity[0], w.velocity[1]]
        };
        let (a, b) = (at(1.0), at(-1.0));
        std::array::from_fn(|i| (a[i] - b[i]) / (2.0 * h))
    }

    #[test]
    fn mass_is_kept_and_vorticity_absent_for_both_gases() {
        for gamma in [1.4, 5.0 / 3.0] {
            let flow = Ringleb::new(gamma).unwrap();
            for x in [Vector([-0.5, 0.9]), Vector([-0.7, -0.5]), Vector([0.4, 1.2]), Vector([-1.0, 0.1])] {
                let (dx, dy) = (slope(&flow, x, 0), slope(&flow, x, 1));
                assert!((dx[0] + dy[1]).abs() < 1e-6, "divergence {} at {x:?}", dx[0] + dy[1]);
                assert!((dx[3] - dy[2]).abs() < 1e-6, "vorticity {} at {x:?}", dx[3] - dy[2]);
            }
        }
    }

    #[test]
    fn streamlines_run_with_the_flow() {
        let line = flow().streamline(0.9, 0.5, 41);
        assert_eq!(line.len(), 41);
        for pair in line.windows(2) {
            let step = (pair[1] - pair[0]).unit();
            let middle = (pair[0] + pair[1]) * 0.5;
            let w = flow().state(&middle).unwrap();
            assert!(step.dot(&w.velocity.unit()) > 0.999);
            assert!(flow().normal(&middle).unwrap().dot(&step).abs() < 0.02);
            assert!((flow().hodograph(&pair[0]).unwrap().streamline / 0.9 - 1.0).abs() < 1e-9);
        }
        let x = line[10];
        let towards = x + flow().normal(&x).unwrap() * 1e-3;
        assert!(flow().hodograph(&towards).unwrap().streamline > 0.9);
    }

    #[test]
    fn gases_without_closed_form_and_points_beyond_are_refused() {
        assert!(matches!(Ringleb::new(1.3), Err(Error::GammaNotClosed { .. })));
        assert!(Ringleb::new(f64::NAN).is_err());
        assert!(flow().state(&Vector([f64::NAN, 0.0])).is_err());
        assert!(flow().state(&Vector([1e200, 1e200])).is_err());
    }
}
