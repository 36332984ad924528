//! Normal and oblique shocks of the ideal gas.
//!
//! Across a shock normal to the flow (Rankine-Hugoniot), p2/p1 = 1 + 2γ/(γ+1) (M1²−1), ρ2/ρ1 = (γ+1)M1²/((γ−1)M1²+2).
//! An oblique shock of angle β is a normal shock for M1 sin β; it deflects the flow by the angle θ with
//!
//! tan θ = 2 cot β (M1² sin²β − 1) / (M1² (γ + cos 2β) + 2).
//!
//! θ increases from zero at the Mach angle to its maximum θ_max (detachment) and decreases to zero at the normal shock:
//! below θ_max there are a weak and a strong solution.
//!
//! Angles are in radians. Source: NACA Report 1135 (1953), eqs. (93)-(101), (128)-(150), (168).
use super::expansion::{stagnation_pressure_ratio, stagnation_temperature_ratio};
use super::roots::bisect;
use super::{Error, check_gamma};
use std::f64::consts::FRAC_PI_2;

/// Ratios of the state behind a shock to that ahead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// Mach number behind the shock.
    pub mach: f64,
    /// Static pressure ratio.
    pub pressure: f64,
    /// Ratio of the densities.
    pub density: f64,
    /// Ratio of the temperatures.
    pub temperature: f64,
    /// Stagnation pressure ratio, below 1 because of the loss.
    pub stagnation_pressure: f64,
}

/// An oblique shock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObliqueShock {
    /// Angle of the shock to the flow ahead (rad).
    pub angle: f64,
    /// Ratios across the shock.
    pub jump: Jump,
}

/// Weak or strong solution of an oblique shock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Smaller shock angle, which occurs on wedges.
    Weak,
    /// Larger shock angle, with subsonic flow behind.
    Strong,
}

/// Ratios across a normal shock at the Mach number `mach`; an error below Mach 1.
pub fn normal_shock(mach: f64, gamma: f64) -> Result<Jump, Error> {
    check_supersonic("normal shock", mach, gamma)?;
    Ok(jump(mach, mach, gamma))
}

/// Pressure coefficient at a stagnation point behind a normal shock (Rayleigh's pitot formula); an error below Mach 1.
pub fn rayleigh_pitot_coefficient(mach: f64, gamma: f64) -> Result<f64, Error> {
    let jump = normal_shock(mach, gamma)?;
    let stagnation = jump.pressure * stagnation_pressure_ratio(jump.mach, gamma);
    Ok((stagnation - 1.0) / (0.5 * gamma * mach * mach))
}

/// Deflection θ (rad) of the flow by a shock of the angle `angle` (rad).
pub fn deflection(mach: f64, angle: f64, gamma: f64) -> f64 {
    let normal = (mach * angle.sin()).powi(2);
    let above = 2.0 * (normal - 1.0) * angle.cos();
    let below = angle.sin() * (mach * mach * (gamma + (2.0 * angle).cos()) + 2.0);
    above.atan2(below)
}

/// Shock angle of maximum deflection (rad), NACA 1135 (168); an error below Mach 1.
pub fn detachment_shock_angle(mach: f64, gamma: f64) -> Result<f64, Error> {
    check_supersonic("detachment", mach, gamma)?;
    let m2 = mach * mach;
    let root = ((gamma + 1.0) * ((gamma + 1.0) / 16.0 * m2 * m2 + 0.5 * (gamma - 1.0) * m2 + 1.0)).sqrt();
    Ok((((gamma + 1.0) / 4.0 * m2 - 1.0 + root) / (gamma * m2)).sqrt().min(1.0).asin())
}

/// Oblique shock that deflects a flow at `mach` by the angle `turn` ≥ 0 (rad); an error if an argument is outside its
/// range or the shock is detached.
pub fn oblique_shock(mach: f64, turn: f64, branch: Branch, gamma: f64) -> Result<ObliqueShock, Error> {
    let steepest = detachment_shock_angle(mach, gamma)?;
    let limit = deflection(mach, steepest, gamma);
    if !(0.0 <= turn && turn.is_finite()) {
        return Err(Error::Angle { what: "oblique shock", range: "[0, detachment]", angle: turn });
    }
    if turn > limit {
        return Err(Error::Detached { angle: turn, mach, limit });
    }
    let mach_angle = (1.0 / mach).asin();
    let excess = |angle| deflection(mach, angle, gamma) - turn;
    let angle = match branch {
        Branch::Weak => bisect(mach_angle, steepest, excess),
        Branch::Strong => bisect(steepest, FRAC_PI_2, excess),
    };
    Ok(ObliqueShock { angle, jump: jump(mach, (mach * angle.sin()).max(1.0), gamma) })
}

/// Ratios across a shock at the Mach number `mach`, whose component normal to the shock is `normal`.
///
/// The total enthalpy is constant, so that the Mach number behind the shock follows from the temperature.
fn jump(mach: f64, normal: f64, gamma: f64) -> Jump {
    let n2 = normal * normal;
    let pressure = 1.0 + 2.0 * gamma / (gamma + 1.0) * (n2 - 1.0);
    let density = (gamma + 1.0) * n2 / ((gamma - 1.0) * n2 + 2.0);
    let temperature = pressure / density;
    let heat = stagnation_temperature_ratio(mach, gamma) / temperature;
    let behind = (2.0 / (gamma - 1.0) * (heat - 1.0)).sqrt();
    let stagnation_pressure = (density.powf(gamma) / pressure).powf(1.0 / (gamma - 1.0));
    Jump { mach: behind, pressure, density, temperature, stagnation_pressure }
}

fn check_supersonic(what: &'static str, mach: f64, gamma: f64) -> Result<(), Error> {
    check_gamma(gamma)?;
    if 1.0 <= mach && mach.is_finite() { Ok(()) } else { Err(Error::Mach { what, range: "[1, inf)", mach }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64, tolerance: f64) {
        assert!((a - b).abs() <= tolerance, "{a} is not {b}");
    }

    #[test] // rows of normal_shock_prandtl_meyer.csv: M1, M2, p, ρ, T, p0, Rayleigh pitot Cp
    fn normal_shocks_follow_the_table() {
        for row in [
            [1.05, 0.9531254, 1.1195833, 1.0839820, 1.0328431, 0.9998530, 1.3064501],
            [1.3, 0.7859571, 1.8050000, 1.5156951, 1.1908728, 0.9793736, 1.4485153],
            [2.0, 0.5773503, 4.5, 2.6666667, 1.6875, 0.7208739, 1.6573003],
            [10.0, 0.3875753, 116.5, 5.7142857, 20.3875, 0.0030448, 1.8316710],
        ] {
            let j = normal_shock(row[0], 1.4).unwrap();
            close(j.mach, row[1], 1e-7);
            close(j.pressure, row[2], 1e-7);
            close(j.density, row[3], 1e-7);
            close(j.temperature, row[4], 1e-7);
            close(j.stagnation_pressure, row[5], 1e-7);
            close(rayleigh_pitot_coefficient(row[0], 1.4).unwrap(), row[6], 1e-7);
        }
        assert!(normal_shock(0.99, 1.4).is_err() && normal_shock(f64::NAN, 1.4).is_err());
    }

    #[test] // rows of oblique_shock.csv: M1, θ, β, M2, p, ρ, θ_max
    fn weak_shocks_follow_the_table() {
        for row in [
            [1.5, 12.0, 64.35881, 0.960663, 1.966779, 1.606757, 12.1127],
            [2.0, 10.0, 39.31393, 1.640522, 1.706579, 1.458426, 22.9735],
            [2.5, 25.0, 50.24778, 1.386482, 4.143289, 2.549443, 29.7974],
            [4.0, 35.0, 53.45693, 1.464585, 11.882047, 4.042730, 38.7739],
        ] {
            let s = oblique_shock(row[0], row[1].to_radians(), Branch::Weak, 1.4).unwrap();
            close(s.angle.to_degrees(), row[2], 6e-6);
            close(s.jump.mach, row[3], 1e-6);
            close(s.jump.pressure, row[4], 1e-6);
            close(s.jump.density, row[5], 1e-6);
            let steepest = detachment_shock_angle(row[0], 1.4).unwrap();
            close(deflection(row[0], steepest, 1.4).to_degrees(), row[6], 6e-5);
        }
    }

    #[test]
    fn strong_shock_turns_as_much_and_is_steeper() {
        let strong = oblique_shock(2.0, 0.15, Branch::Strong, 1.4).unwrap();
        let weak = oblique_shock(2.0, 0.15, Branch::Weak, 1.4).unwrap();
        close(deflection(2.0, strong.angle, 1.4), 0.15, 1e-14);
        close(deflection(2.0, weak.angle, 1.4), 0.15, 1e-14);
        assert!(strong.angle > weak.angle && strong.jump.mach < 1.0 && weak.jump.mach > 1.0);
        let none = oblique_shock(2.0, 0.0, Branch::Weak, 1.4).unwrap();
        close(none.angle, 0.5_f64.asin(), 1e-12);
        close(none.jump.pressure, 1.0, 1e-12);
    }

    #[test]
    fn detached_shocks_are_refused() {
        assert!(matches!(oblique_shock(1.5, 0.3, Branch::Weak, 1.4), Err(Error::Detached { .. })));
        assert!(matches!(oblique_shock(1.5, -0.1, Branch::Weak, 1.4), Err(Error::Angle { .. })));
    }
}
