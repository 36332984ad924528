//! Isentropic relations and the Prandtl-Meyer expansion.
//!
//! Along a streamline without shocks, stagnation values are constant: with m = 1 + (γ−1)/2 M², T0/T = m, p0/p =
//! m^(γ/(γ−1)), ρ0/ρ = m^(1/(γ−1)). A supersonic flow that is turned by ν2 − ν1 around a convex corner expands to the
//! Mach number of ν2, where
//!
//! ν(M) = √((γ+1)/(γ−1)) atan √((γ−1)/(γ+1) (M²−1)) − atan √(M²−1).
//!
//! Angles are in radians. Source: Ames Research Staff, *Equations, Tables and Charts for Compressible Flow*, NACA
//! Report 1135 (1953), eqs. (43)-(46), (171).
use super::roots::bisect;
use super::{Error, check_gamma};
use std::f64::consts::FRAC_PI_2;

/// Ratio T0/T of stagnation to static temperature.
pub fn stagnation_temperature_ratio(mach: f64, gamma: f64) -> f64 {
    1.0 + 0.5 * (gamma - 1.0) * mach * mach
}

/// Ratio p0/p of stagnation to static pressure.
pub fn stagnation_pressure_ratio(mach: f64, gamma: f64) -> f64 {
    stagnation_temperature_ratio(mach, gamma).powf(gamma / (gamma - 1.0))
}

/// Ratio ρ0/ρ of stagnation to static density.
pub fn stagnation_density_ratio(mach: f64, gamma: f64) -> f64 {
    stagnation_temperature_ratio(mach, gamma).powf(1.0 / (gamma - 1.0))
}

/// Pressure coefficient at a point where the speed is `speed_ratio` times the free-stream speed, for isentropic flow.
///
/// Cp = 2/(γM²) ((1 + (γ−1)/2 M² (1 − q²))^(γ/(γ−1)) − 1), and 1 − q² for M = 0.
pub fn isentropic_pressure_coefficient(speed_ratio: f64, mach: f64, gamma: f64) -> f64 {
    let excess = 1.0 - speed_ratio * speed_ratio;
    let m2 = mach * mach;
    if m2 == 0.0 {
        return excess;
    }
    // ln_1p and exp_m1 are accurate at small Mach numbers, where (1 + ε)^n − 1 is not
    let heat = (0.5 * (gamma - 1.0) * m2 * excess).max(-1.0);
    2.0 / (gamma * m2) * (gamma / (gamma - 1.0) * heat.ln_1p()).exp_m1()
}

/// Prandtl-Meyer angle ν(M) (rad); zero at and below Mach 1.
pub fn prandtl_meyer_angle(mach: f64, gamma: f64) -> f64 {
    let s = (mach * mach - 1.0).max(0.0).sqrt();
    let g = ((gamma + 1.0) / (gamma - 1.0)).sqrt();
    g * (s / g).atan() - s.atan()
}

/// Prandtl-Meyer angle of the expansion into vacuum, (√((γ+1)/(γ−1)) − 1) π/2 (rad).
pub fn prandtl_meyer_limit(gamma: f64) -> f64 {
    (((gamma + 1.0) / (gamma - 1.0)).sqrt() - 1.0) * FRAC_PI_2
}

/// Mach number of the Prandtl-Meyer angle `angle` (rad); an error if the angle is outside its range.
pub fn mach_of_prandtl_meyer_angle(angle: f64, gamma: f64) -> Result<f64, Error> {
    check_gamma(gamma)?;
    if !(0.0 <= angle && angle < prandtl_meyer_limit(gamma)) {
        return Err(Error::Angle { what: "Prandtl-Meyer expansion", range: "[0, angle of vacuum)", angle });
    }
    // as a function of the Mach angle μ = asin(1/M), the interval is finite: μ = π/2 at Mach 1, 0 in vacuum
    let mach_angle = bisect(0.0, FRAC_PI_2, |mu| angle - prandtl_meyer_angle(1.0 / mu.sin(), gamma));
    Ok(1.0 / mach_angle.sin())
}

/// State behind a centred expansion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expansion {
    /// Mach number behind the fan.
    pub mach: f64,
    /// Ratio of the static pressure behind the fan to that ahead.
    pub pressure_ratio: f64,
    /// Ratio of the density behind the fan to that ahead.
    pub density_ratio: f64,
}

/// Expansion of a flow at `mach` by the turning angle `turn` (rad), positive around a convex corner; an error if an
/// argument is outside its range.
pub fn expand(mach: f64, turn: f64, gamma: f64) -> Result<Expansion, Error> {
    check_gamma(gamma)?;
    if !(1.0 <= mach && mach.is_finite()) {
        return Err(Error::Mach { what: "Prandtl-Meyer expansion", range: "[1, inf)", mach });
    }
    let after = mach_of_prandtl_meyer_angle(prandtl_meyer_angle(mach, gamma) + turn, gamma)?;
    Ok(Expansion {
        mach: after,
        pressure_ratio: stagnation_pressure_ratio(mach, gamma) / stagnation_pressure_ratio(after, gamma),
        density_ratio: stagnation_density_ratio(mach, gamma) / stagnation_density_ratio(after, gamma),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // column nu_deg of normal_shock_prandtl_meyer.csv
    fn prandtl_meyer_angles_follow_the_table() {
        for (mach, degrees) in
            [(1.05, 0.4874107), (1.3, 6.1702859), (2.0, 26.3797608), (5.0, 76.9202155), (10.0, 102.3162532)]
        {
            assert!((prandtl_meyer_angle(mach, 1.4).to_degrees() - degrees).abs() < 1e-7);
            assert!((mach_of_prandtl_meyer_angle(degrees.to_radians(), 1.4).unwrap() / mach - 1.0).abs() < 1e-7);
        }
        assert!((prandtl_meyer_limit(1.4).to_degrees() - 130.4541).abs() < 1e-4);
        assert!(mach_of_prandtl_meyer_angle(2.5, 1.4).is_err());
        assert!(mach_of_prandtl_meyer_angle(f64::NAN, 1.4).is_err());
    }

    #[test]
    fn no_turn_is_no_change() {
        let e = expand(2.2, 0.0, 1.4).unwrap();
        assert!((e.mach - 2.2).abs() < 1e-12 && (e.pressure_ratio - 1.0).abs() < 1e-12);
        assert!(expand(0.9, 0.1, 1.4).is_err());
    }

    #[test]
    fn pressure_coefficient_at_stagnation_and_at_low_speed() {
        let stagnation = (stagnation_pressure_ratio(0.3, 1.4) - 1.0) / (0.7 * 0.09);
        assert!((isentropic_pressure_coefficient(0.0, 0.3, 1.4) - stagnation).abs() < 1e-13);
        assert!((isentropic_pressure_coefficient(1.5, 1e-6, 1.4) + 1.25).abs() < 1e-11);
        assert_eq!(isentropic_pressure_coefficient(1.5, 0.0, 1.4), -1.25);
    }
}
