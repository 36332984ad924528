//! Hypoelasticity: the stress rate as a function of the strain rate.
//!
//! σ = −p I + s with dp = −K tr D dt and ds = 2G dev D dt, D = sym ∇v, where the stress rotates with the material:
//! equations (7) to (9) of the paper, with the correct sign of p and bulk modulus and an objective rate. Over a step
//! from F_n to F, the relative gradient is F F_n⁻¹ = r u, and D dt equals ln u to third order, 2(u − I)(u + I)⁻¹,
//! before the rotation r (Rashid 1993, *Int. J. Numer. Methods Eng.* 36; the mid-point rule of Hughes and Winget 1980
//! is the same for r = I). A rotation of any magnitude does not change the stress in the rotated frame.
//!
//! The law has no stored-energy function. The reported stored energy is that of the stress, J (s:s/4G + p²/2K); the
//! remaining work is reported as dissipated and may have either sign.
use super::elastic::Moduli;
use super::tensor::{self, Tensor};
use super::{Response, Step};
use crate::math::jet::Scalar;
use std::ops::Range;

/// Range of F of the last step in the history, row by row.
const GRADIENT: Range<usize> = 0..9;
/// Range of the Cauchy stress in the history.
const STRESS: Range<usize> = 9..15;
/// Number of history variables.
pub(super) const LENGTH: usize = 15;

/// Cauchy stress of a pressure and a deviator, σ = −p I + s, eq. (7).
#[doc(alias = "eq7")]
#[inline(always)]
pub fn cauchy_stress<S: Scalar>(pressure: S, deviator: &Tensor<S>) -> Tensor<S> {
    tensor::plus_identity(deviator, -pressure)
}

/// Pressure after a step with the strain `strain` = D dt, p ← p − K tr D dt, eq. (8).
#[doc(alias = "eq8")]
#[inline(always)]
pub fn pressure<S: Scalar>(moduli: &Moduli, old: S, strain: &Tensor<S>) -> S {
    old - tensor::trace(strain) * moduli.bulk
}

/// Deviator after a step with the strain `strain` = D dt and the rotation r, s ← r (s + 2G dev D dt) rᵀ, eq. (9).
#[doc(alias = "eq9")]
#[inline(always)]
pub fn deviator<S: Scalar>(moduli: &Moduli, old: &Tensor<S>, strain: &Tensor<S>, r: &Tensor<S>) -> Tensor<S> {
    let grown = tensor::plus(old, S::constant(2.0 * moduli.shear), &tensor::deviator(strain));
    tensor::product_transposed(&tensor::product(r, &grown), r)
}

/// Strain D dt in the axes before the step, and rotation r, of the relative gradient F F_n⁻¹.
#[inline(always)]
pub fn increment<S: Scalar>(relative: &Tensor<S>) -> (Tensor<S>, Tensor<S>) {
    let rotation = tensor::rotation(relative);
    let stretch = tensor::symmetric(&tensor::transposed_product(&rotation, relative));
    let one = S::constant(1.0);
    let twice = tensor::times(&tensor::plus_identity(&stretch, -one), S::constant(2.0));
    let strain = tensor::product(&twice, &tensor::inverse(&tensor::plus_identity(&stretch, one)));
    (tensor::symmetric(&strain), rotation)
}

/// Writes the history of the stress-free state.
pub(super) fn begin(history: &mut [f64]) {
    history[..LENGTH].fill(0.0);
    for k in 0..3 {
        history[4 * k] = 1.0;
    }
}

/// Response to a step.
pub(super) fn respond<S: Scalar>(moduli: &Moduli, step: &Step<'_, S>, new: &mut [S]) -> Response<S> {
    let f = step.gradient;
    let kept = &step.old[GRADIENT];
    let old_gradient: Tensor = tensor::of(|i, j| kept[3 * i + j]);
    let old_stress: Tensor = tensor::constant(&step.old[STRESS]);
    let back = tensor::convert(&tensor::inverse(&old_gradient), S::constant);
    let (strain, rotation) = increment(&tensor::product(f, &back));
    let old_pressure = tensor::trace(&old_stress) * (-1.0 / 3.0);
    let p = pressure(moduli, S::constant(old_pressure), &strain);
    let old_deviator = tensor::convert(&tensor::deviator(&old_stress), S::constant);
    let s = deviator(moduli, &old_deviator, &strain, &rotation);
    let cauchy = cauchy_stress(p, &s);
    let cofactor = tensor::cofactor(f);
    let stress = tensor::product(&cauchy, &cofactor);
    for (k, new) in new[GRADIENT].iter_mut().enumerate() {
        *new = f[k / 3][k % 3];
    }
    new[STRESS].copy_from_slice(&tensor::pack(&cauchy));
    let stored = energy(moduli, tensor::determinant(f), &cauchy);
    let old_stored = energy(moduli, tensor::determinant(&old_gradient), &old_stress);
    let old = tensor::product(&old_stress, &tensor::cofactor(&old_gradient));
    let mean = tensor::of(|i, j| (stress[i][j] + old[i][j]) * 0.5);
    let moved = tensor::of(|i, j| f[i][j] - old_gradient[i][j]);
    let dissipated = tensor::contraction(&mean, &moved) - (stored - old_stored);
    Response { stress, stored, dissipated }
}

/// Stored energy of a Cauchy stress per undeformed volume, J (s:s/4G + p²/2K).
#[inline(always)]
fn energy<S: Scalar>(m: &Moduli, volume: S, cauchy: &Tensor<S>) -> S {
    let p = tensor::trace(cauchy) * (1.0 / 3.0);
    let s = tensor::plus_identity(cauchy, -p);
    volume * (tensor::contraction(&s, &s) * (0.25 / m.shear) + p * p * (0.5 / m.bulk))
}

#[cfg(test)]
mod tests {
    use super::super::samples::{close, random_rotation, random_tensor};
    use super::super::{Law, Material};
    use super::*;

    const MODULI: Moduli = Moduli { shear: 1.0, bulk: 2.2 };

    /// Cauchy's stress after `n` steps along f(t), 0 < t ≤ 1.
    fn march(n: usize, f: impl Fn(f64) -> Tensor) -> Tensor {
        let material = Material::new(1.0, MODULI, Law::Hypoelastic);
        let mut old = vec![0.0; LENGTH];
        material.begin(&mut old);
        for k in 1..=n {
            let mut new = old.clone();
            material.respond(&f(k as f64 / n as f64), &old, 1.0 / n as f64, &mut new);
            old = new;
        }
        tensor::unpack(&old[STRESS])
    }

    #[test] // eq7
    fn pressure_and_deviator_make_the_stress() {
        let s = tensor::deviator(&tensor::symmetric(&random_tensor(1, 1.0)));
        let sigma = cauchy_stress(0.7, &s);
        assert!((tensor::trace(&sigma) / -3.0 - 0.7).abs() < 1e-15);
        close(&tensor::deviator(&sigma), &s, 1e-15);
    }

    #[test] // eq8
    fn compression_raises_the_pressure_by_the_logarithm_of_volume() {
        let squeezed = |n| march(n, |t| tensor::times(&tensor::identity(), 1.0 - 0.3 * t));
        let exact = 3.0 * MODULI.bulk * 0.7f64.ln();
        let error = |n| tensor::trace(&squeezed(n)) / 3.0 - exact;
        assert!(error(1000).abs() < 1e-7, "{:.1e}", error(1000));
        let order = (error(100) / error(200)).abs().log2();
        assert!((order - 2.0).abs() < 0.05, "{order}");
        assert!(exact < 0.0 && pressure(&MODULI, 0.0, &[[-0.1, 0.0, 0.0], [0.0; 3], [0.0; 3]]) > 0.0);
    }

    #[test] // eq9
    fn simple_shear_gives_the_stress_of_the_corotational_rate() {
        // Dienes (1979): with the rate that spins with the material, σ₁₂ = G sin γ and σ₁₁ = G (1 − cos γ)
        let error = |n| {
            let sheared = march(n, |t| {
                let mut f = tensor::identity();
                f[0][1] = 2.0 * t;
                f
            });
            let (s, c) = 2f64.sin_cos();
            let exact = [[1.0 - c, s, 0.0], [s, c - 1.0, 0.0], [0.0; 3]];
            super::super::samples::distance(&sheared, &exact)
        };
        let (coarse, fine) = (error(500), error(1000));
        assert!(fine < 1e-6 && (coarse / fine).log2() > 1.9, "{coarse:.1e} {fine:.1e}");
    }

    #[test] // eq9
    fn a_rotation_of_any_size_turns_the_stress_along() {
        let old = tensor::deviator(&tensor::symmetric(&random_tensor(3, 1.0)));
        let r = random_rotation(4);
        let (strain, found) = increment(&r);
        close(&found, &r, 1e-14);
        close(&strain, &[[0.0; 3]; 3], 1e-15);
        let turned = deviator(&MODULI, &old, &strain, &found);
        close(&turned, &tensor::product_transposed(&tensor::product(&r, &old), &r), 1e-14);
    }

    #[test]
    fn a_stretched_block_that_spins_twenty_turns_keeps_its_stress() {
        let spin = |t: f64| {
            let (s, c) = (20.0 * std::f64::consts::TAU * t).sin_cos();
            let mut f = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]];
            f.iter_mut().for_each(|row| row[0] *= 1.2);
            f
        };
        // one step to the stretch, 8000 to the end
        let first = march(1, |_| spin(0.0));
        let last = march(8001, |t| spin(((8001.0 * t).round() - 1.0) / 8000.0));
        // rounding adds up: 3e-12 measured
        close(&last, &first, 2e-11);
    }
}
