//! Diamond airfoil in supersonic flow by shock-expansion theory.
//!
//! A symmetric double wedge of unit chord with maximum thickness at half chord: tan δ = t/c. The front panels turn the
//! flow by δ ∓ α through an oblique shock (or an expansion if negative); the shoulder turns it back by 2δ through a
//! Prandtl-Meyer fan. The pressure is constant on each panel. The solution is exact for inviscid flow as long as the
//! shocks are attached and the waves of the shoulder meet the bow shock downstream of the trailing edge. Zero thickness
//! is the flat plate.
//!
//! Source: J. Ackeret (1925) and A. Busemann (1931) as in NACA Report 1135 (1953) and H. W. Liepmann and A. Roshko,
//! *Elements of Gasdynamics* (1957), section 4.17.
use super::expansion::expand;
use super::shock::{Branch, oblique_shock};
use super::{Error, check_gamma};

/// Flow on one panel of the airfoil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Panel {
    /// Mach number on the panel.
    pub mach: f64,
    /// Ratio of the pressure to that of the free stream.
    pub pressure: f64,
}

/// Flow past a diamond airfoil.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Diamond {
    /// Upper side, front panel.
    pub upper_front: Panel,
    /// Upper side, rear panel.
    pub upper_rear: Panel,
    /// Lower side, front panel.
    pub lower_front: Panel,
    /// Lower side, rear panel.
    pub lower_rear: Panel,
    /// Lift coefficient, based on the chord.
    pub lift: f64,
    /// Drag coefficient, based on the chord.
    pub drag: f64,
}

impl Diamond {
    /// Flow at `mach` past a diamond of the given thickness-to-chord ratio at the angle of attack `alpha` (rad).
    /// Returns an error if an argument is outside its range or a shock is detached.
    pub fn new(mach: f64, thickness: f64, alpha: f64, gamma: f64) -> Result<Self, Error> {
        check_gamma(gamma)?;
        if !(0.0 <= thickness && thickness.is_finite()) {
            return Err(Error::Parameter { what: "thickness of the diamond", value: thickness, range: "[0, inf)" });
        }
        let half_angle = thickness.atan();
        let (upper_front, upper_rear) = side(mach, half_angle - alpha, half_angle, gamma)?;
        let (lower_front, lower_rear) = side(mach, half_angle + alpha, half_angle, gamma)?;
        // forces from the projections of the panels: chord for the normal force, height for the axial force
        let normal = 0.5 * (lower_front.pressure + lower_rear.pressure - upper_front.pressure - upper_rear.pressure);
        let axial =
            0.5 * thickness * (upper_front.pressure + lower_front.pressure - upper_rear.pressure - lower_rear.pressure);
        let dynamic = 0.5 * gamma * mach * mach;
        let lift = (normal * alpha.cos() - axial * alpha.sin()) / dynamic;
        let drag = (normal * alpha.sin() + axial * alpha.cos()) / dynamic;
        Ok(Self { upper_front, upper_rear, lower_front, lower_rear, lift, drag })
    }
}

/// Front and rear panel of one side: the front turns the flow by `turn` (positive: compression), the shoulder by twice
/// the half angle.
fn side(mach: f64, turn: f64, half_angle: f64, gamma: f64) -> Result<(Panel, Panel), Error> {
    let front = if turn >= 0.0 {
        let shock = oblique_shock(mach, turn, Branch::Weak, gamma)?;
        Panel { mach: shock.jump.mach, pressure: shock.jump.pressure }
    } else {
        let fan = expand(mach, -turn, gamma)?;
        Panel { mach: fan.mach, pressure: fan.pressure_ratio }
    };
    let fan = expand(front.mach, 2.0 * half_angle, gamma)?;
    Ok((front, Panel { mach: fan.mach, pressure: front.pressure * fan.pressure_ratio }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // rows of supersonic_diamond_shock_expansion.csv: M, t/c, α; four pressures, CL, CD
    fn panels_and_loads_follow_the_table() {
        for (m, t, a, expected) in [
            (2.0, 0.0, 5.0, [0.747464, 0.747464, 1.315407, 1.315407, 0.202065, 0.017678]),
            (2.0, 0.05, 8.0, [0.741305, 0.518290, 1.783002, 1.327850, 0.326522, 0.052004]),
            (2.0, 0.1, 0.0, [1.366025, 0.716545, 1.366025, 0.716545, 0.0, 0.023196]),
            (3.0, 0.1, 8.0, [0.834319, 0.304241, 2.606884, 1.198242, 0.207431, 0.044690]),
        ] {
            let d = Diamond::new(m, t, f64::to_radians(a), 1.4).unwrap();
            let got = [
                d.upper_front.pressure,
                d.upper_rear.pressure,
                d.lower_front.pressure,
                d.lower_rear.pressure,
                d.lift,
                d.drag,
            ];
            for (g, e) in got.iter().zip(expected) {
                assert!((g - e).abs() < 1e-6, "{got:?}");
            }
        }
    }

    #[test] // the numbers of verification/diamond_m2
    fn diamond_of_ten_degrees() {
        let d = Diamond::new(2.0, 10_f64.to_radians().tan(), 0.0, 1.4).unwrap();
        assert!((d.upper_front.pressure - 1.706579).abs() < 1e-6 && (d.upper_front.mach - 1.640522).abs() < 1e-6);
        assert!((d.lower_rear.pressure - 0.550785).abs() < 1e-6 && (d.lower_rear.mach - 2.371701).abs() < 1e-6);
        assert!((d.drag - 0.072785).abs() < 1e-6 && d.lift.abs() < 1e-15);
    }

    #[test]
    fn detached_and_meaningless_diamonds_are_refused() {
        assert!(matches!(Diamond::new(1.5, 0.4, 0.0, 1.4), Err(Error::Detached { .. })));
        assert!(Diamond::new(0.8, 0.1, 0.0, 1.4).is_err());
        assert!(Diamond::new(2.0, f64::NAN, 0.0, 1.4).is_err());
    }
}
