//! Modified Bessel functions K₀ and K₁ of a complex argument.
//!
//! K_n(z) = ∫₀^∞ e^{−z cosh t} cosh(n t) dt for Re z > 0 (Watson, A Treatise on the Theory of Bessel Functions, 1944, section 6.22).
//! Along t = s − iφ tanh s with φ = arg z, the integrand decays for every z that is not on the negative real axis, so
//! that the integral continues the functions to the left half plane. It is even and analytic in s, where the
//! trapezoidal rule converges exponentially.
use num_complex::Complex64;

/// Number of steps within the width 1/√|z| of the integrand, or within that of tanh.
const STEPS: f64 = 24.0;
/// Fraction of the sum below which terms are negligible.
const NEGLIGIBLE: f64 = 1e-19;
/// Maximum number of terms; fewer suffice for |z| above the smallest normal number.
const MOST: usize = 100_000;

/// K₀(z) and K₁(z) for z that is neither zero nor on the negative real axis.
pub(super) fn modified_second(z: Complex64) -> [Complex64; 2] {
    let (phase, step) = (z.arg(), 1.0 / (STEPS * (1.0 + z.norm()).sqrt()));
    let term = |s: f64| {
        let path = Complex64::new(s, -phase * s.tanh());
        let speed = Complex64::new(1.0, -phase / s.cosh().powi(2));
        let hyperbolic = path.cosh();
        let value = (-z * hyperbolic).exp() * speed;
        [value, value * hyperbolic]
    };
    let mut sums = term(0.0).map(|t| t * 0.5);
    for k in 1..MOST {
        let next = term(k as f64 * step);
        (0..2).for_each(|i| sums[i] += next[i]);
        if (0..2).all(|i| next[i].norm() <= NEGLIGIBLE * sums[i].norm()) {
            break;
        }
    }
    sums.map(|s| s * step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn near(z: Complex64, exact: Complex64) {
        assert!((z - exact).norm() < 1e-13 * exact.norm(), "{z} is not {exact}");
    }

    #[test] // K₀(ix) = −(π/2)(Y₀ + iJ₀), K₁(ix) = −(π/2)(J₁ − iY₁)
    fn on_the_imaginary_axis_they_are_those_of_waves() {
        for x in [1e-3, 0.05, 0.3, 1.0, 2.5, 8.0, 40.0, 900.0] {
            let [zeroth, first] = modified_second(Complex64::new(0.0, x));
            near(zeroth, Complex64::new(libm::y0(x), libm::j0(x)) * -FRAC_PI_2);
            near(first, Complex64::new(libm::j1(x), -libm::y1(x)) * -FRAC_PI_2);
        }
    }

    #[test] // Abramowitz and Stegun, tables 9.8: e^x K₀, e^x K₁ at x = 0.5, 1, 5
    fn on_the_real_axis_they_have_the_values_of_tables() {
        let table = [
            (0.5, 0.924_419_071_2, 1.656_441_120_0),
            (1.0, 0.421_024_438_2, 0.601_907_230_2),
            (5.0, 0.003_691_098_3, 0.004_044_613_4),
        ];
        for (x, zeroth, first) in table {
            let found = modified_second(Complex64::new(x, 0.0));
            assert!((found[0].re - zeroth).abs() < 6e-11 && (found[1].re - first).abs() < 6e-11, "{found:?}");
        }
    }

    /// I₀ and I₁ by their power series.
    fn modified_first(z: Complex64) -> [Complex64; 2] {
        let quarter = z * z * 0.25;
        let mut terms = [Complex64::new(1.0, 0.0), z * 0.5];
        let mut sums = terms;
        for k in 1..80 {
            terms = [terms[0] * quarter / (k * k) as f64, terms[1] * quarter / (k * (k + 1)) as f64];
            (0..2).for_each(|i| sums[i] += terms[i]);
        }
        sums
    }

    #[test] // the Wronskian I₀ K₁ + I₁ K₀ = 1/z, and dK₀/dz = −K₁
    fn everywhere_else_they_solve_their_equation() {
        for (size, angle) in [(0.02, 1.7), (0.3, -2.6), (1.0, 3.0), (2.0, 1.9), (4.0, -1.2), (6.0, 1.7)] {
            let z = Complex64::from_polar(size, angle);
            let ([i0, i1], [k0, k1]) = (modified_first(z), modified_second(z));
            assert!(((i0 * k1 + i1 * k0) * z - 1.0).norm() < 1e-12, "{z}");
            let h = 1e-4 * size;
            let slope = (modified_second(z + h)[0] - modified_second(z - h)[0]) / (2.0 * h);
            assert!((slope + k1).norm() < 1e-7 * k1.norm(), "{z}");
        }
    }
}
