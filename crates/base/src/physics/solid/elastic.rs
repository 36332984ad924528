//! Elastic laws: the stress is the derivative of a stored energy with respect to the deformation gradient F.
//!
//! P = ∂ψ/∂F with ψ per undeformed volume, for three energies that agree to second order at small strain:
//!
//! - linear: ψ = μ ε:ε + ½ λ (tr ε)², ε = sym(F − I); for small rotations only,
//! - Saint-Venant-Kirchhoff: the same form with Green's strain E = ½(FᵀF − I); for large rotations and small strains,
//! - neo-Hookean: ψ = ½ μ (J^(−2/3) tr(FᵀF) − 3) + ¼ K (J² − 1 − 2 ln J), J = det F; for large strains, compressible
//!   (Simo & Hughes 1998, *Computational Inelasticity*, eq. 9.2.3, 9.2.6).
//!
//! All laws are three-dimensional: plane strain is F₃₃ = 1.
use super::tensor::{self, Tensor};
use crate::math::jet::Scalar;

/// Elastic moduli of an isotropic solid, in units of pressure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moduli {
    /// Shear modulus μ.
    pub shear: f64,
    /// Bulk modulus K.
    pub bulk: f64,
}

impl Moduli {
    /// Moduli μ = E/(2(1 + ν)) and K = E/(3(1 − 2ν)) for Young's modulus E and Poisson's ratio ν.
    pub const fn of_young(young: f64, poisson: f64) -> Self {
        Self { shear: 0.5 * young / (1.0 + poisson), bulk: young / (3.0 * (1.0 - 2.0 * poisson)) }
    }

    /// Lamé's first parameter λ = K − ⅔ μ.
    #[inline(always)]
    pub const fn lame(&self) -> f64 {
        self.bulk - self.shear * (2.0 / 3.0)
    }

    /// Young's modulus E = 9Kμ/(3K + μ).
    pub const fn young(&self) -> f64 {
        9.0 * self.bulk * self.shear / (3.0 * self.bulk + self.shear)
    }

    /// Poisson's ratio ν = (3K − 2μ)/(6K + 2μ).
    pub const fn poisson(&self) -> f64 {
        (3.0 * self.bulk - 2.0 * self.shear) / (6.0 * self.bulk + 2.0 * self.shear)
    }

    /// Modulus of pressure waves K + 4/3 μ (P-wave modulus).
    pub const fn pressure_wave(&self) -> f64 {
        self.bulk + self.shear * (4.0 / 3.0)
    }
}

/// First Piola-Kirchhoff stress of linear elasticity, P = 2μ ε + λ tr ε I with ε = sym(F − I).
#[inline(always)]
pub fn linear<S: Scalar>(m: &Moduli, f: &Tensor<S>) -> Tensor<S> {
    let strain = small_strain(f);
    let mean = tensor::trace(&strain) * m.lame();
    tensor::plus_identity(&tensor::times(&strain, S::constant(2.0 * m.shear)), mean)
}

/// Energy of linear elasticity per undeformed volume, μ ε:ε + ½ λ (tr ε)².
#[inline(always)]
pub fn linear_energy<S: Scalar>(m: &Moduli, f: &Tensor<S>) -> S {
    quadratic(m, &small_strain(f))
}

/// First Piola-Kirchhoff stress of the Saint-Venant-Kirchhoff law, P = F (2μ E + λ tr E I) with E = ½(FᵀF − I).
#[inline(always)]
pub fn saint_venant_kirchhoff<S: Scalar>(m: &Moduli, f: &Tensor<S>) -> Tensor<S> {
    let strain = green_strain(f);
    let mean = tensor::trace(&strain) * m.lame();
    tensor::product(f, &tensor::plus_identity(&tensor::times(&strain, S::constant(2.0 * m.shear)), mean))
}

/// Energy of the Saint-Venant-Kirchhoff law per undeformed volume, μ E:E + ½ λ (tr E)².
#[inline(always)]
pub fn saint_venant_kirchhoff_energy<S: Scalar>(m: &Moduli, f: &Tensor<S>) -> S {
    quadratic(m, &green_strain(f))
}

/// First Piola-Kirchhoff stress of the neo-Hookean law, P = μ J^(−2/3) (F − ⅓ tr(FᵀF) F⁻ᵀ) + ½ K (J² − 1) F⁻ᵀ; NaN if J
/// ≤ 0.
#[inline(always)]
pub fn neo_hookean<S: Scalar>(m: &Moduli, f: &Tensor<S>) -> Tensor<S> {
    let cofactor = tensor::cofactor(f);
    let volume = f[0][0] * cofactor[0][0] + f[0][1] * cofactor[0][1] + f[0][2] * cofactor[0][2];
    let shear = isochoric(volume) * m.shear;
    let square = tensor::contraction(f, f) * (1.0 / 3.0);
    let along = ((volume * volume - 1.0) * (0.5 * m.bulk) - shear * square) / volume;
    tensor::of(|i, j| shear * f[i][j] + along * cofactor[i][j])
}

/// Energy of the neo-Hookean law per undeformed volume, ½ μ (J^(−2/3) tr(FᵀF) − 3) + ¼ K (J² − 1 − 2 ln J). It is
/// accurate for small strains too, whose squares are below the round-off of 1.
#[inline(always)]
pub fn neo_hookean_energy<S: Scalar>(m: &Moduli, f: &Tensor<S>) -> S {
    let excess = excess_volume(f);
    // because tr(FᵀF) = 3 + 2 tr E
    let less = excess.map(|e| {
        let (j, less) = (1.0 + e, (-2.0 / 3.0 * e.ln_1p()).exp_m1());
        let slope = -2.0 / 3.0 * (1.0 + less) / j;
        [less, slope, -5.0 / 3.0 * slope / j]
    });
    let strain = tensor::trace(&green_strain(f)) * 2.0;
    let shape = strain + less * (strain + 3.0);
    shape * (0.5 * m.shear) + volumetric_energy(m, excess)
}

/// J − 1 from the displacement gradient H = F − I: tr H + ½ ((tr H)² − tr H²) + det H.
#[inline(always)]
pub(super) fn excess_volume<S: Scalar>(f: &Tensor<S>) -> S {
    let h = tensor::plus_identity(f, S::constant(-1.0));
    let minor = |i: usize, j: usize| h[i][i] * h[j][j] - h[i][j] * h[j][i];
    tensor::trace(&h) + (minor(0, 1) + minor(1, 2) + minor(2, 0)) + tensor::determinant(&h)
}

/// Volumetric energy ¼ K (J² − 1 − 2 ln J) from e = J − 1.
#[inline(always)]
pub(super) fn volumetric_energy<S: Scalar>(m: &Moduli, excess: S) -> S {
    let energy = excess.map(|e| {
        // J² − 1 − 2 ln J = e² + 2 (e − ln(1 + e)); for small e, the second term is computed by its series
        let left = match e.abs() < SMALL {
            true => e * e * (0.5 - e * (1.0 / 3.0 - e * (0.25 - e * (0.2 - e / 6.0)))),
            false => e - e.ln_1p(),
        };
        let j = 1.0 + e;
        [e * e + 2.0 * left, 2.0 * e * (1.0 + 1.0 / j), 2.0 + 2.0 / (j * j)]
    });
    energy * (0.25 * m.bulk)
}

/// Limit of J − 1 below which five terms of this series are accurate to round-off.
const SMALL: f64 = 1e-3;

/// Infinitesimal strain sym(F − I).
#[inline(always)]
fn small_strain<S: Scalar>(f: &Tensor<S>) -> Tensor<S> {
    tensor::plus_identity(&tensor::symmetric(f), S::constant(-1.0))
}

/// Green's strain ½(FᵀF − I), computed from the displacement gradient so that small strains remain accurate.
#[inline(always)]
pub(super) fn green_strain<S: Scalar>(f: &Tensor<S>) -> Tensor<S> {
    let h = tensor::plus_identity(f, S::constant(-1.0));
    tensor::of(|i, j| (h[i][j] + h[j][i] + h[0][i] * h[0][j] + h[1][i] * h[1][j] + h[2][i] * h[2][j]) * 0.5)
}

/// Quadratic energy μ e:e + ½ λ (tr e)² of a strain e.
#[inline(always)]
fn quadratic<S: Scalar>(m: &Moduli, e: &Tensor<S>) -> S {
    let trace = tensor::trace(e);
    tensor::contraction(e, e) * m.shear + trace * trace * (0.5 * m.lame())
}

/// Isochoric factor J^(−2/3); NaN if J ≤ 0.
#[inline(always)]
pub(super) fn isochoric<S: Scalar>(volume: S) -> S {
    volume.map(|j| {
        let root = inverse_cube_root(j);
        let value = root * root;
        // derivatives of J^(−2/3): −2/3 J^(−5/3) and 10/9 J^(−8/3), with 1/J = root³
        let over = value * root;
        [value, value * over * (-2.0 / 3.0), value * over * over * (10.0 / 9.0)]
    })
}

/// Constant whose upper word, minus a third of the exponent and fraction of x, approximates x^(−1/3) within 4 %.
const CUBE_ROOT_START: u64 = 0x553e_f0ff;
/// One third of 2³², rounded up.
const A_THIRD: u64 = 0x5555_5556;

/// x^(−1/3) for normal positive x, and NaN otherwise; plain arithmetic, so that loops can be vectorised.
///
/// The exponent is divided by minus three in integer arithmetic, followed by two steps of fourth order: the relative
/// error decreases from 4e-2 to 1e-5 and to below round-off (Householder's method; initial guess as in Lomont's inverse
/// square root, 2003).
#[inline(always)]
fn inverse_cube_root(x: f64) -> f64 {
    let third = ((x.to_bits() >> 32) * A_THIRD) >> 32;
    let mut y = f64::from_bits(CUBE_ROOT_START.wrapping_sub(third) << 32);
    for _ in 0..2 {
        // (1 − e)^(−1/3) = 1 + e/3 + 2e²/9 + 14e³/81 + …
        let e = 1.0 - x * y * y * y;
        y += y * e * (1.0 / 3.0 + e * (2.0 / 9.0 + e * (14.0 / 81.0)));
    }
    if x > 0.0 { y } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::super::samples::{close, random_tensor};
    use super::*;
    use crate::math::dual::Dual;
    use crate::math::jet::Jet;

    type Pair = (fn(&Moduli, &Tensor<f64>) -> Tensor<f64>, fn(&Moduli, &Tensor<Jet>) -> Jet);
    const LAWS: [Pair; 3] = [
        (linear, linear_energy),
        (saint_venant_kirchhoff, saint_venant_kirchhoff_energy),
        (neo_hookean, neo_hookean_energy),
    ];
    const STEEL: Moduli = Moduli::of_young(2.0, 0.3);

    #[test]
    fn the_cube_root_is_exact_to_rounding() {
        for k in -300..300 {
            let x = 10f64.powf(f64::from(k) / 30.0) * 1.07;
            let exact = 1.0 / x.cbrt();
            assert!((inverse_cube_root(x) / exact - 1.0).abs() < 5e-16, "{x}");
        }
        assert!(
            inverse_cube_root(-1.0).is_nan() && inverse_cube_root(0.0).is_nan() && inverse_cube_root(f64::NAN).is_nan()
        );
    }

    #[test]
    fn moduli_are_those_of_young_and_poisson() {
        let m = Moduli::of_young(7.0, 0.25);
        assert!((m.young() - 7.0).abs() < 1e-14 && (m.poisson() - 0.25).abs() < 1e-15);
        assert!((m.lame() - 7.0 * 0.25 / (1.25 * 0.5)).abs() < 1e-14);
        assert!((m.pressure_wave() - m.lame() - 2.0 * m.shear).abs() < 1e-14);
    }

    #[test] // ½ e:C:e of small strains, however small
    fn energies_of_small_strains_keep_their_digits() {
        for size in [1e-4, 1e-7, 1e-10] {
            for seed in 0..5 {
                let f = tensor::plus_identity(&tensor::times(&random_tensor(seed, 1.0), size), 1.0);
                let [exact, found] = [linear_energy(&STEEL, &f), neo_hookean_energy(&STEEL, &f)];
                assert!((found / exact - 1.0).abs() < 10.0 * size + 1e-5, "{size}: {found:e} for {exact:e}");
            }
        }
    }

    #[test]
    fn stress_is_the_derivative_of_energy() {
        for (seed, (stress, energy)) in (0..30).map(|k| (k, LAWS[k as usize % 3])) {
            let f = tensor::plus_identity(&random_tensor(seed, 0.4), 1.0);
            let p = stress(&STEEL, &f);
            let slope = tensor::of(|i, j| {
                let mut f = tensor::convert(&f, Jet::constant);
                f[i][j].first = 1.0;
                energy(&STEEL, &f).first
            });
            close(&p, &slope, 2e-14);
            let h = 1e-5;
            let at = |i: usize, j: usize, h: f64| {
                let mut f = tensor::convert(&f, Jet::constant);
                f[i][j] = f[i][j] + h;
                energy(&STEEL, &f).value
            };
            close(&p, &tensor::of(|i, j| (at(i, j, h) - at(i, j, -h)) / (2.0 * h)), 1e-9);
        }
    }

    #[test]
    fn the_laws_agree_at_small_strain() {
        let e = 1e-7;
        let f = tensor::plus_identity(&random_tensor(7, e), 1.0);
        let p = linear(&STEEL, &f);
        // the two laws differ by squares of the strain
        close(&saint_venant_kirchhoff(&STEEL, &f), &p, 20.0 * e * e);
        close(&neo_hookean(&STEEL, &f), &p, 20.0 * e * e + 1e-15);
    }

    #[test]
    fn nearly_incompressible_rubber_keeps_its_digits() {
        let m = Moduli::of_young(1.0, 0.4999);
        // a volume-preserving change of shape: pressure results from rounding only
        let f = [[2.0, 0.3, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.0]];
        let p = neo_hookean(&m, &f);
        let tau = tensor::product_transposed(&p, &f);
        assert!(tensor::trace(&tau).abs() < 1e-12, "{}", tensor::trace(&tau));
        let b = tensor::product_transposed(&f, &f);
        close(&tau, &tensor::times(&tensor::deviator(&b), m.shear), 1e-12);
    }

    #[test]
    fn second_derivatives_of_energy_are_first_ones_of_stress() {
        let (f, d) = (tensor::plus_identity(&random_tensor(5, 0.3), 1.0), random_tensor(6, 1.0));
        let dual = neo_hookean(&STEEL, &tensor::of(|i, j| Dual { value: f[i][j], derivative: d[i][j] }));
        let jet = neo_hookean_energy(&STEEL, &tensor::of(|i, j| Jet { value: f[i][j], first: d[i][j], second: 0.0 }));
        let work = tensor::contraction(&tensor::convert(&dual, |x| x.derivative), &d);
        assert!((jet.second - work).abs() < 1e-13 * work.abs());
    }
}
