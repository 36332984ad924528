//! Subcritical flow past a sphere and a circle.
//!
//! Shock-free flow past a body is isentropic and irrotational, v = ∇φ. With speeds divided by the free-stream speed,
//! lengths divided by the radius and M the free-stream Mach number,
//!
//! ∇²φ = M² [½ ∇φ·∇q² − (γ−1)/2 (1 − q²) ∇²φ], q = |∇φ|.
//!
//! **Sphere.** φ = φ0 + M² φ1 + M⁴ φ2 + M⁶ φ3 + O(M⁸) (Janzen 1913, Rayleigh 1916): φ0 = (r + 1/(2r²)) cos θ and
//! ∇²φ1 = ½ ∇φ0·∇q0², which gives
//!
//! φ1 = (r⁻²/3 − r⁻⁵/5 + r⁻⁸/24) P1 + (27/55 r⁻⁴ − 3/10 r⁻² − 3/10 r⁻⁵ + 3/176 r⁻⁸) P3,
//!
//! and on the surface u/U = sin θ (3/2 + M² (551/1760 − 243/352 cos²θ)). The term φ2, the first that depends on γ, adds
//! M⁴ sin θ (0.3551 − 1.5761 cos²θ + 1.1949 cos⁴θ) for γ = 1.4. The module `janzen_rayleigh` computes all terms.
//!
//! **Circle.** Surface speeds from a spectral solution of the full equation (γ = 1.4,
//! `cylinder_subsonic_potential_surface.csv`) at M = 0.1, 0.2, 0.3, 0.35 are represented as sine series and
//! interpolated in M², together with the exact 2 sin θ at M = 0. They agree with the O(M²) expansion u/U = 2 sin θ + M²
//! (⅔ sin θ − ½ sin 3θ) (Rayleigh 1916).
//!
//! Conventions: flow along +x, θ from the x axis. Surface speeds are symmetric fore and aft, so that θ may be measured
//! from either stagnation point. Limits: sphere M ≤ 0.5. There, φ2 changes Cp by up to 0.008 at M = 0.3, φ3 by 0.001.
//! Successive terms decrease by about (M/0.57)², so that the truncation error is 0.0004 at M = 0.3, 0.004 at 0.4 and
//! 0.02 at 0.5. Circle M ≤ 0.35. Sources: O. Janzen, *Phys. Zeitschr.* 14 (1913) 639-643; Lord Rayleigh, *Phil. Mag.*
//! 32 (1916) 1-6. The terms of the sphere were derived independently and are tested against the equation.
use super::expansion::isentropic_pressure_coefficient;
use super::janzen_rayleigh::{Series, evaluate, sphere_potentials};
use super::{Error, check_gamma};
use crate::math::Vector;

/// Maximum Mach number of the sphere; the flow becomes sonic at the equator near 0.57.
const SPHERE_MACH_LIMIT: f64 = 0.5;
/// Maximum Mach number of the table of the circle; the flow becomes sonic near 0.398.
const CIRCLE_MACH_LIMIT: f64 = 0.35;
/// Ratio of specific heats of the table of the circle.
const CIRCLE_GAMMA: f64 = 1.4;
/// Maximum difference of γ that is regarded as round-off.
const GAMMA_TOLERANCE: f64 = 1e-9;

/// Flow past a sphere of unit radius, including terms up to O(M⁶).
#[derive(Clone, Debug, PartialEq)]
pub struct SphereFlow {
    mach: f64,
    gamma: f64,
    /// Potential as a series in powers of r, cos θ and ln r.
    potential: Series,
}

impl SphereFlow {
    /// Flow at the free-stream Mach number `mach` ≤ 0.5; an error if an argument is outside its range.
    pub fn new(mach: f64, gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        if !(0.0..=SPHERE_MACH_LIMIT).contains(&mach) {
            return Err(Error::Mach { what: "flow past a sphere", range: "[0, 0.5]", mach });
        }
        let mut potential = Series::new();
        for (term, n) in sphere_potentials(gamma).into_iter().zip(0..) {
            term.into_iter().for_each(|(key, a)| *potential.entry(key).or_default() += a * mach.powi(2 * n));
        }
        Ok(Self { mach, gamma, potential })
    }

    /// Ratio of the surface speed to the free-stream speed at the angle `theta` (rad) from a stagnation point.
    pub fn surface_speed(&self, theta: f64) -> f64 {
        theta.sin() * evaluate(&self.potential, 1.0, theta.cos())[2]
    }

    /// Pressure coefficient on the surface at the angle `theta` (rad) from a stagnation point.
    pub fn surface_pressure_coefficient(&self, theta: f64) -> f64 {
        isentropic_pressure_coefficient(self.surface_speed(theta), self.mach, self.gamma)
    }

    /// Velocity divided by the free-stream speed at `x` (in radii from the centre), |x| ≥ 1.
    pub fn velocity(&self, x: &Vector<3>) -> Vector<3> {
        let r = x.norm().max(f64::MIN_POSITIVE);
        let out = *x * (1.0 / r);
        let [_, radial, slope] = evaluate(&self.potential, r, out[0]);
        // ∇φ = φ_r e_r + (1/r) ∂φ/∂c (e_x − c e_r)
        out * (radial - out[0] * slope / r) + Vector::axis(0) * (slope / r)
    }
}

/// Number of sine harmonics sin θ, sin 3θ, …, equal to the number of tabulated angles.
const HARMONICS: usize = 18;
/// Mach numbers of the table.
const CIRCLE_MACH: [f64; 4] = [0.1, 0.2, 0.3, 0.35];
/// Ratios of the surface speed to the free-stream speed at 5, 10, …, 90 degrees, one row for each Mach number.
#[rustfmt::skip]
const CIRCLE_SPEED: [[f64; HARMONICS]; 4] = [
    [
        0.1735952, 0.3459462, 0.5158134, 0.6819663, 0.8431897, 0.9982887, 1.1460958, 1.2854789, 1.4153496,
        1.5346732, 1.6424795, 1.7378738, 1.8200489, 1.8882969, 1.9420205, 1.9807430, 2.0041172, 2.0119323,
    ],
    [
        0.1714050, 0.3417959, 0.5101521, 0.6754399, 0.8366067, 0.9925767, 1.1422475, 1.2844895, 1.4181485,
        1.5420527, 1.6550248, 1.7559006, 1.8435552, 1.9169353, 1.9750977, 2.0172507, 2.0427934, 2.0513502,
    ],
    [
        0.1675834, 0.3344794, 0.4999885, 0.6633866, 0.8239112, 0.9807464, 1.1330058, 1.2797128, 1.4197795,
        1.5519838, 1.6749485, 1.7871265, 1.8868024, 1.9721226, 2.0411730, 2.0921176, 2.1233962, 2.1339482,
    ],
    [
        0.1649450, 0.3293753, 0.4927664, 0.6545731, 0.8142178, 0.9710751, 1.1244544, 1.2735751, 1.4175360,
        1.5552737, 1.6855086, 1.8066755, 1.9168422, 2.0136294, 2.0941757, 2.1552411, 2.1935852, 2.2066892,
    ],
];

/// Flow past a circle without circulation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleFlow {
    mach: f64,
    coefficients: [f64; HARMONICS],
}

impl CircleFlow {
    /// Flow at the free-stream Mach number `mach` ≤ 0.35; an error if an argument is outside its range, because the
    /// table is for γ = 1.4.
    pub fn new(mach: f64, gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        if (gamma - CIRCLE_GAMMA).abs() > GAMMA_TOLERANCE {
            let what = "ratio of specific heats of the table for the circle";
            return Err(Error::Parameter { what, value: gamma, range: "1.4" });
        }
        if !(0.0..=CIRCLE_MACH_LIMIT).contains(&mach) {
            return Err(Error::Mach { what: "flow past a circle", range: "[0, 0.35]", mach });
        }
        let nodes: [f64; 5] = std::array::from_fn(|i| if i == 0 { 0.0 } else { CIRCLE_MACH[i - 1].powi(2) });
        let rows: [[f64; HARMONICS]; 5] =
            std::array::from_fn(|i| if i == 0 { incompressible_series() } else { sine_series(&CIRCLE_SPEED[i - 1]) });
        let weights = lagrange_weights(&nodes, mach * mach);
        let coefficients = std::array::from_fn(|k| (0..5).map(|i| weights[i] * rows[i][k]).sum());
        Ok(Self { mach, coefficients })
    }

    /// Ratio of the surface speed to the free-stream speed at the angle `theta` (rad) from a stagnation point.
    pub fn surface_speed(&self, theta: f64) -> f64 {
        (0..HARMONICS).map(|k| self.coefficients[k] * ((2 * k + 1) as f64 * theta).sin()).sum()
    }

    /// Pressure coefficient on the surface at the angle `theta` (rad) from a stagnation point.
    pub fn surface_pressure_coefficient(&self, theta: f64) -> f64 {
        isentropic_pressure_coefficient(self.surface_speed(theta), self.mach, CIRCLE_GAMMA)
    }
}

fn incompressible_series() -> [f64; HARMONICS] {
    std::array::from_fn(|k| if k == 0 { 2.0 } else { 0.0 })
}

/// Coefficients of sin((2k+1)θ) from values at 5, 10, …, 90 degrees (discrete sine transform).
fn sine_series(values: &[f64; HARMONICS]) -> [f64; HARMONICS] {
    let half = HARMONICS as f64;
    std::array::from_fn(|k| {
        let sum: f64 = (1..=HARMONICS)
            .map(|j| {
                let weight = if j == HARMONICS { 0.5 } else { 1.0 };
                let theta = std::f64::consts::FRAC_PI_2 * j as f64 / half;
                weight * values[j - 1] * ((2 * k + 1) as f64 * theta).sin()
            })
            .sum();
        2.0 / half * sum
    })
}

fn lagrange_weights(nodes: &[f64; 5], x: f64) -> [f64; 5] {
    std::array::from_fn(|i| (0..5).filter(|&j| j != i).map(|j| (x - nodes[j]) / (nodes[i] - nodes[j])).product())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Residual ∇²φ (1 + M²(γ−1)/2 (1−q²)) − M²/2 ∇φ·∇q² from fourth-order differences of the velocity.
    fn residual(flow: &SphereFlow, x: Vector<3>) -> f64 {
        let h = 2e-3;
        let m2 = flow.mach.powi(2);
        let slope = |d: usize, f: &dyn Fn(&Vector<3>) -> f64| {
            let across = |s: f64| f(&flow.velocity(&(x + Vector::axis(d) * (s * h))));
            (8.0 * (across(1.0) - across(-1.0)) - across(2.0) + across(-2.0)) / (12.0 * h)
        };
        let laplacian: f64 = (0..3).map(|d| slope(d, &|v| v[d])).sum();
        let v = flow.velocity(&x);
        let gradient = Vector::<3>::from_fn(|d| slope(d, &|v| v.norm_squared()));
        laplacian * (1.0 + 0.5 * m2 * (flow.gamma - 1.0) * (1.0 - v.norm_squared())) - 0.5 * m2 * v.dot(&gradient)
    }

    #[test]
    fn sphere_satisfies_the_equation_to_sixth_order_in_mach() {
        let points = [[1.1, 0.3, 0.2], [0.2, 1.2, -0.1], [-1.5, 0.4, 1.0], [0.8, 0.8, 0.0]].map(Vector);
        let at = |mach| {
            let flow = SphereFlow::new(mach, 1.4).unwrap();
            points.iter().map(|x| residual(&flow, *x).abs()).sum::<f64>()
        };
        assert!(at(0.0) < 1e-7, "potential flow");
        // the residual is O(M⁸): 256 times smaller at half the Mach number
        let ratio = at(0.4) / at(0.2);
        assert!(at(0.3) < 1e-3 && (200.0..330.0).contains(&ratio), "{} {ratio}", at(0.3));
    }

    #[test]
    fn sphere_field_meets_wall_surface_formula_and_free_stream() {
        let flow = SphereFlow::new(0.3, 1.4).unwrap();
        for i in 0..=12 {
            let theta = f64::from(i) * 0.26;
            let x = Vector([theta.cos(), theta.sin(), 0.0]);
            let v = flow.velocity(&x);
            assert!(v.dot(&x).abs() < 1e-14);
            assert!((v.norm() - flow.surface_speed(theta).abs()).abs() < 1e-14);
        }
        assert!((flow.velocity(&Vector([300.0, 400.0, 10.0])) - Vector::axis(0)).norm() < 1e-6);
    }

    #[test]
    fn sphere_pressure_at_stagnation_and_equator() {
        let flow = SphereFlow::new(0.3, 1.4).unwrap();
        assert!((flow.surface_pressure_coefficient(0.0) - 1.022703).abs() < 1e-6);
        assert!(
            (SphereFlow::new(0.0, 1.4).unwrap().surface_pressure_coefficient(std::f64::consts::FRAC_PI_2) + 1.25).abs()
                < 1e-12
        );
        assert!(SphereFlow::new(0.6, 1.4).is_err() && SphereFlow::new(f64::NAN, 1.4).is_err());
    }

    #[test] // rows of cylinder_subsonic_potential_surface.csv: M, degrees, speed, Cp
    fn circle_follows_the_table() {
        for (mach, degrees, speed, cp) in [
            (0.1, 45.0, 1.4153496, -1.0007009),
            (0.3, 30.0, 0.9807464, 0.0381693),
            (0.3, 90.0, 2.1339482, -3.2785967),
            (0.35, 85.0, 2.1935852, -3.3873698),
        ] {
            let flow = CircleFlow::new(mach, 1.4).unwrap();
            let theta = f64::to_radians(degrees);
            assert!((flow.surface_speed(theta) - speed).abs() < 1e-9);
            assert!((flow.surface_pressure_coefficient(theta) - cp).abs() < 2e-6);
        }
    }

    #[test]
    fn circle_tends_to_janzen_rayleigh() {
        for i in 0..=18 {
            let theta = f64::from(i) * 0.0873;
            let expansion =
                |mach: f64| 2.0 * theta.sin() + mach * mach * (2.0 / 3.0 * theta.sin() - 0.5 * (3.0 * theta).sin());
            let difference = |mach| CircleFlow::new(mach, 1.4).unwrap().surface_speed(theta) - expansion(mach);
            assert!(difference(0.05).abs() < 5e-5, "{}", difference(0.05));
            assert!(difference(0.1).abs() < 5e-4, "{}", difference(0.1));
        }
    }

    #[test]
    fn circle_is_smooth_between_angles_and_mach_numbers() {
        // between two tabulated Mach numbers, the speed lies between their speeds unless these are equal
        let flow = CircleFlow::new(0.25, 1.4).unwrap();
        let (low, high) = (CircleFlow::new(0.2, 1.4).unwrap(), CircleFlow::new(0.3, 1.4).unwrap());
        for i in 1..=17 {
            let theta = f64::from(i) * 0.09;
            let (a, b, c) = (low.surface_speed(theta), flow.surface_speed(theta), high.surface_speed(theta));
            assert!((a.min(c)..=a.max(c)).contains(&b) || (a - c).abs() < 2e-3, "{theta} {a} {b} {c}");
        }
        assert!(CircleFlow::new(0.38, 1.4).is_err());
        assert!(CircleFlow::new(0.3, 1.3).is_err());
    }
}
