//! The laminar boundary layer on a flat plate.
//!
//! Blasius (1908): u/U = f′(η), η = y √(U/(νx)), with f‴ + f f″/2 = 0, f(0) = f′(0) = 0, f′(∞) = 1. Density and
//! viscosity are constant, so that the Mach number should be below about 0.2, and √Re_x must be large.
use super::Error;

/// Wall shear f″(0), to all digits (Boyd, SIAM Review 50, 2008).
pub const WALL_SHEAR: f64 = 0.332_057_336_215_196_3;
/// Displacement thickness δ* divided by x/√Re_x: 1.720 787 657…, the limit of η − f.
pub const DISPLACEMENT: f64 = 1.720_787_657_520_5;
/// Momentum thickness θ divided by x/√Re_x: 2 f″(0).
pub const MOMENTUM: f64 = 2.0 * WALL_SHEAR;

/// Height η at which f′ = 1 to all digits.
const FAR: f64 = 12.0;
/// Step of the Runge-Kutta method in η; the error at the outer end is below 1e-12.
const STEP: f64 = 0.01;

/// The boundary-layer solution at one height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// Stream function f.
    pub f: f64,
    /// Velocity along the plate, u/U = f′.
    pub velocity: f64,
    /// Velocity gradient f″.
    pub shear: f64,
    /// Velocity normal to the plate, v/U √Re_x = (η f′ − f)/2.
    pub normal: f64,
}

/// Solution at the height η = y √(U/(νx)); an error if η is negative.
pub fn layer(eta: f64) -> Result<Layer, Error> {
    if !(0.0 <= eta) {
        return Err(Error::Parameter { what: "height in a boundary layer", value: eta, range: "not negative" });
    }
    if eta >= FAR {
        let f = eta - DISPLACEMENT;
        return Ok(Layer { f, velocity: 1.0, shear: 0.0, normal: 0.5 * DISPLACEMENT });
    }
    let steps = (eta / STEP).ceil().max(1.0);
    let h = eta / steps;
    let mut w = [0.0, 0.0, WALL_SHEAR];
    for _ in 0..steps as usize {
        w = runge_kutta(w, h);
    }
    Ok(Layer { f: w[0], velocity: w[1], shear: w[2], normal: 0.5 * (eta * w[1] - w[0]) })
}

/// Skin-friction coefficient τ_w/(½ρU²) at the Reynolds number `re_x` of the distance from the leading edge.
pub fn skin_friction(re_x: f64) -> f64 {
    2.0 * WALL_SHEAR / re_x.sqrt()
}

/// Drag coefficient of one side, on the length of the plate, at the Reynolds number `re` of that length.
pub fn drag(re: f64) -> f64 {
    4.0 * WALL_SHEAR / re.sqrt()
}

fn runge_kutta(w: [f64; 3], h: f64) -> [f64; 3] {
    let slope = |w: [f64; 3]| [w[1], w[2], -0.5 * w[0] * w[2]];
    let ahead = |k: [f64; 3], s: f64| std::array::from_fn(|i| w[i] + s * k[i]);
    let k1 = slope(w);
    let k2 = slope(ahead(k1, 0.5 * h));
    let k3 = slope(ahead(k2, 0.5 * h));
    let k4 = slope(ahead(k3, h));
    std::array::from_fn(|i| w[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test] // reference/computed_exact/blasius.csv
    fn the_profile_is_that_of_the_table() {
        let rows = [
            (1.0, 0.16557173, 0.32978003, 0.32300712, 0.08210415),
            (3.0, 1.39680823, 0.84604444, 0.16136032, 0.57066255),
            (5.0, 3.28327367, 0.99154190, 0.01590680, 0.83721792),
            (10.0, 8.27921234, 1.0, 0.00000001, 0.86039382),
        ];
        for (eta, f, velocity, shear, normal) in rows {
            let l = layer(eta).unwrap();
            for (a, b) in [(l.f, f), (l.velocity, velocity), (l.shear, shear), (l.normal, normal)] {
                assert!((a - b).abs() < 2e-8, "{eta}: {a} is not {b}");
            }
        }
        let (inside, outside) = (layer(FAR - 1e-9).unwrap(), layer(FAR).unwrap());
        assert!((inside.f - outside.f).abs() < 1e-8 && (inside.velocity - 1.0).abs() < 1e-11);
        assert!(layer(-1.0).is_err() && layer(f64::NAN).is_err());
    }

    #[test]
    fn friction_and_thickness_agree() {
        // Kármán: the drag of the plate up to x is twice its momentum thickness
        assert!((skin_friction(1e4) - 0.006_641_15).abs() < 1e-8 && (drag(1e4) - 2.0 * MOMENTUM / 100.0).abs() < 1e-16);
        let h = 0.01;
        let theta: f64 =
            (0..1200).map(|k| layer((f64::from(k) + 0.5) * h).unwrap().velocity).map(|u| u * (1.0 - u) * h).sum();
        assert!((theta - MOMENTUM).abs() < 1e-5);
    }
}
