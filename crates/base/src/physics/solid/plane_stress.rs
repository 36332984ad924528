//! Plane stress: thin sheets whose thickness can change freely.
//!
//! F₃₃ is determined by P₃₃ = 0; the other out-of-plane components are given, usually zero. Newton's iteration in plain
//! numbers finds F₃₃, and one more step in the scalar type of the caller yields its first derivative, so that the
//! tangent is consistent.
use super::tensor::{self, Tensor};
use super::{MOST_HISTORY, Material, Response};
use crate::math::dual::Dual;
use crate::math::jet::Scalar;

/// Greatest number of Newton steps.
const MOST_STEPS: usize = 50;
/// Relative size of a step at which the iteration ends.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Minimum and maximum factor by which a step changes the thickness.
const FACTORS: (f64, f64) = (0.5, 2.0);

/// Response of `material` in plane stress and the corresponding F₃₃, with `guess` as the initial value.
///
/// `f[2][2]` is ignored; `guess` is the value of the last step, initially 1. History and `dt` are as for
/// [`Material::respond`].
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
