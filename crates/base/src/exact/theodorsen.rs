//! A pitching and plunging thin plate in incompressible flow.
//!
//! Theodorsen (NACA report 496, 1935). With k = ωb/U, b the half chord, C(k) = H₁⁽²⁾/(H₁⁽²⁾ + iH₀⁽²⁾), the axis a half
//! chords aft of mid-chord and motions e^{+iωt} in plunge z = (displacement up)/b and pitch α, positive nose up,
//!
//! c_l = π (k² z + ik α + a k² α) + 2πC [−ik z + α + (1/2 − a) ik α],
//! c_m = (π/2) [a k² z − (1/2 − a) ik α + (1/8 + a²) k² α] + π (a + 1/2) C [−ik z + α + (1/2 − a) ik α],
//!
//! with the lift divided by q c and the moment about the axis, positive nose up, divided by q c². Limits: small
//! amplitudes, no thickness, no stall, a planar wake.
use num_complex::Complex64;

use super::Error;
use super::bessel::modified_second;

/// Complex amplitudes of the load coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlateLoads {
    /// Lift coefficient.
    pub lift: Complex64,
    /// Moment coefficient about the axis, positive nose up.
    pub moment: Complex64,
}

/// Theodorsen's function C(k) = F + iG of the reduced frequency k ≥ 0; an error for any other k.
pub fn theodorsen(k: f64) -> Result<Complex64, Error> {
    if !(0.0 <= k && k.is_finite()) {
        return Err(Error::Parameter { what: "reduced frequency", value: k, range: "a number that is not negative" });
    }
    if k == 0.0 {
        return Ok(Complex64::new(1.0, 0.0));
    }
    // Hankel functions of the second kind, J − iY
    let first = Complex64::new(libm::j1(k), -libm::y1(k));
    let zeroth = Complex64::new(libm::j0(k), -libm::y0(k));
    Ok(first / (first + Complex64::i() * zeroth))
}

/// Load coefficients of a plate at the reduced frequency `k` (on the half chord), with its axis `a` half chords aft of
/// mid-chord (−1/2: quarter chord), for the complex amplitudes `pitch` (rad, nose up) and `plunge` (up, divided by the
/// half chord). Returns an error if `k` is negative or not finite.
pub fn plate(k: f64, a: f64, pitch: Complex64, plunge: Complex64) -> Result<PlateLoads, Error> {
    Ok(plate_loads(Complex64::new(0.0, k), theodorsen(k)?, a, [pitch, plunge]))
}

/// Theodorsen's function C(p) = K₁/(K₀ + K₁), continued to growing or decaying motions e^{pUt/b} (Edwards, Ashley and
/// Breakwell, AIAA J. 17, 1979), with a branch cut along the negative real axis; an error if p is outside its range.
pub fn theodorsen_growing(p: Complex64) -> Result<Complex64, Error> {
    if !p.is_finite() || (p.im == 0.0 && p.re < 0.0) {
        let range = "a number that is neither infinite nor real and negative";
        return Err(Error::Parameter { what: "reduced exponent", value: p.re, range });
    }
    if p.norm() == 0.0 {
        return Ok(Complex64::new(1.0, 0.0));
    }
    let [zeroth, first] = modified_second(p);
    Ok(first / (zeroth + first))
}

/// Load coefficients for the exponent p and the value `c` of C(p), exact or approximate; the evaluation of C(p) is by
/// far the largest cost.
pub fn plate_loads(p: Complex64, c: Complex64, a: f64, [pitch, plunge]: [Complex64; 2]) -> PlateLoads {
    use std::f64::consts::PI;
    let square = -p * p;
    // downwash at three quarters of the chord
    let circulation = c * (-p * plunge + pitch + (0.5 - a) * p * pitch);
    let lift = PI * (square * plunge + p * pitch + a * square * pitch) + 2.0 * PI * circulation;
    let inertia = a * square * plunge - (0.5 - a) * p * pitch + (0.125 + a * a) * square * pitch;
    let moment = 0.5 * PI * inertia + PI * (a + 0.5) * circulation;
    PlateLoads { lift, moment }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ZERO: Complex64 = Complex64::new(0.0, 0.0);
    const ONE: Complex64 = Complex64::new(1.0, 0.0);

    fn near(z: Complex64, re: f64, im: f64) {
        assert!((z - Complex64::new(re, im)).norm() < 1e-8, "{z} is not {re} + {im} i");
    }

    #[test] // reference/computed_exact/theodorsen_sears.csv
    fn the_function_has_the_values_of_the_table() {
        near(theodorsen(0.1).unwrap(), 0.83192410, -0.17230223);
        near(theodorsen(0.5).unwrap(), 0.59793606, -0.15070950);
        near(theodorsen(1.0).unwrap(), 0.53943487, -0.10027290);
        near(theodorsen(1e-4).unwrap(), 0.99984208, -0.00093233);
        assert_eq!(theodorsen(0.0).unwrap(), ONE);
        assert!((theodorsen(1e4).unwrap() - 0.5).norm() < 1e-4);
        assert!(theodorsen(-1.0).is_err() && theodorsen(f64::NAN).is_err());
    }

    #[test] // reference/harmonics/theodorsen_incompressible.csv, axes at c/4 and c/2
    fn plates_have_the_loads_of_the_table() {
        let plunge = plate(0.3, -0.5, ZERO, ONE).unwrap();
        near(plunge.lift, -0.05526525918, -1.253441049);
        near(plunge.moment, -0.07068583471, 0.0);
        let pitch = plate(0.3, -0.5, ONE, ZERO).unwrap();
        near(pitch.lift, 4.374773759, 1.069223519);
        near(pitch.moment, 0.05301437603, -0.471238898);
        let plunge = plate(1.0, 0.0, ZERO, ONE).unwrap();
        near(plunge.lift, 2.511559424, -3.389369256);
        near(plunge.moment, -0.1575083075, -0.847342314);
        let pitch = plate(1.0, 0.0, ONE, ZERO).unwrap();
        near(pitch.lift, 3.704385871, 4.206244052);
        near(pitch.moment, 1.122446009, -0.5192353139);
    }

    #[test]
    fn growing_motions_continue_steady_oscillations() {
        for k in [1e-3, 0.1, 0.7, 3.0, 50.0] {
            let there = theodorsen_growing(Complex64::new(0.0, k)).unwrap();
            assert!((there - theodorsen(k).unwrap()).norm() < 1e-13);
        }
        assert_eq!(theodorsen_growing(ZERO).unwrap(), ONE);
        assert!(theodorsen_growing(-ONE).is_err() && theodorsen_growing(ONE * f64::NAN).is_err());
        let (p, a) = (Complex64::new(0.0, 0.3), -0.2);
        assert!(
            (plate_loads(p, theodorsen_growing(p).unwrap(), a, [ONE, ZERO]).lift
                - plate(0.3, a, ONE, ZERO).unwrap().lift)
                .norm()
                < 1e-13
        );
    }

    #[test]
    fn slow_pitch_is_the_thin_section() {
        let slow = plate(0.0, -0.5, ONE, ZERO).unwrap();
        near(slow.lift, 2.0 * std::f64::consts::PI, 0.0);
        near(slow.moment, 0.0, 0.0);
    }
}
