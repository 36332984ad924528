//! Plane stress: thin sheets, free to become thinner or thicker.
//!
//! F₃₃ is what makes P₃₃ = 0; the other components out of the plane are those given, usually zero. Newton's steps in plain
//! numbers find it, and one more in the numbers of the caller gives its first derivative: the tangent is the consistent one.
use super::tensor::{self, Tensor};
use super::{MOST_HISTORY, Material, Response};
use crate::math::dual::Dual;
use crate::math::jet::Scalar;

/// Steps after which the search ends.
const MOST_STEPS: usize = 50;
/// Relative size of a step that no longer matters.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Least and greatest factor by which a step changes the thickness.
const FACTORS: (f64, f64) = (0.5, 2.0);

/// Response of `material` in plane stress and the F₃₃ that goes with it, searched from `guess`.
///
/// `f[2][2]` is not read; `guess` is that of the last step, 1 at first. History and `dt` are those of [`Material::respond`].
pub fn plane_stress<S: Scalar>(
    material: &Material,
    f: &Tensor<S>,
    guess: f64,
    old: &[f64],
    dt: f64,
    new: &mut [S],
) -> (Response<S>, S) {
    let plain = tensor::convert(f, S::value);
    let mut thickness = guess;
    let mut slope = material.moduli.pressure_wave();
    let mut scratch = [Dual::constant(0.0); MOST_HISTORY];
    for _ in 0..MOST_STEPS {
        let mut f = tensor::convert(&plain, Dual::constant);
        f[2][2] = Dual::variable(thickness);
        let through = material.respond(&f, old, dt, &mut scratch).stress[2][2];
        slope = through.derivative;
        let next = (thickness - through.value / slope).clamp(thickness * FACTORS.0, thickness * FACTORS.1);
        let change = (next - thickness).abs();
        thickness = next;
        if !(change > ROUNDING * thickness) {
            break;
        }
    }
    let mut f = *f;
    f[2][2] = S::constant(thickness);
    let left = material.respond(&f, old, dt, new).stress[2][2];
    f[2][2] = S::constant(thickness) - left * (1.0 / slope);
    (material.respond(&f, old, dt, new), f[2][2])
}
