//! Finite viscoelasticity: a neo-Hookean material whose shear response relaxes.
//!
//! S = S_vol + g∞ S_iso + Σ Q_i with dQ_i/dt + Q_i/τ_i = g_i dS_iso/dt and g∞ = 1 − Σ g_i (Simo 1987; Holzapfel 2000,
//! *Nonlinear Solid Mechanics*, §6.10). S is the second Piola-Kirchhoff stress; S_vol and S_iso are those of the
//! neo-Hookean material with the *instantaneous* moduli. After a long time the shear modulus is g∞ μ. The volumetric
//! response does not relax.
//!
//! A step is exact where S_iso is a linear function of time: Q ← e^(−Δt/τ) Q + g (1 − e^(−Δt/τ)) τ/Δt ΔS_iso (Simo and
//! Hughes 1998, eq. 10.3.12). The stored energy of a branch is that of a linear spring, (CQ):(QC)/(4 g μ); the
//! difference between the work ½ Q:ΔC of a branch and the change of its stored energy is dissipated.
use super::elastic::{Moduli, excess_volume, isochoric, neo_hookean_energy, volumetric_energy};
use super::tensor::{self, Tensor};
use super::{Response, Step};
use crate::math::jet::Scalar;

/// Greatest number of branches of a series.
pub const MOST_BRANCHES: usize = 6;
/// Number of history variables with all branches in use: C and one stress per branch.
pub(super) const MOST_LENGTH: usize = 6 * (1 + MOST_BRANCHES);

/// A branch of the Prony series: a spring and a dashpot in series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Branch {
    /// Fraction g of the instantaneous shear modulus.
    pub fraction: f64,
    /// Relaxation time τ.
    pub time: f64,
}

/// A Prony series of up to six branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prony {
    /// The branches; the first `count` are in use.
    pub branches: [Branch; MOST_BRANCHES],
    /// Number of branches in use.
    pub count: usize,
}

impl Prony {
    /// The series of the pairs (fraction, relaxation time); pairs beyond the sixth are ignored.
    pub const fn new(pairs: &[(f64, f64)]) -> Self {
        let mut branches = [Branch { fraction: 0.0, time: 1.0 }; MOST_BRANCHES];
        let count = if pairs.len() < MOST_BRANCHES { pairs.len() } else { MOST_BRANCHES };
        let mut k = 0;
        while k < count {
            branches[k] = Branch { fraction: pairs[k].0, time: pairs[k].1 };
            k += 1;
        }
        Self { branches, count }
    }

    /// The branches in use.
    pub fn used(&self) -> &[Branch] {
        &self.branches[..self.count.min(MOST_BRANCHES)]
    }

    /// Fraction g∞ of the shear modulus that does not relax.
    pub fn lasting(&self) -> f64 {
        1.0 - self.used().iter().map(|b| b.fraction).sum::<f64>()
    }

    /// Number of history variables.
    pub(super) fn length(&self) -> usize {
        6 * (1 + self.used().len())
    }

    /// Writes the history of the relaxed, undeformed state.
    pub(super) fn begin(&self, history: &mut [f64]) {
        history[..self.length()].fill(0.0);
        history[..3].fill(1.0);
    }
}

/// Response to a step.
pub(super) fn respond<S: Scalar>(moduli: &Moduli, law: &Prony, step: &Step<'_, S>, new: &mut [S]) -> Response<S> {
    let f = step.gradient;
    let square = tensor::transposed_product(f, f);
    let volume = tensor::determinant(f);
    let inverse = tensor::inverse(&square);
    let fast = isochoric_stress(moduli, &square, &inverse, isochoric(volume));
    let old_square: Tensor<S> = tensor::constant(&step.old[..6]);
    let rise = tensor::difference(&fast, &old_stress(moduli, &step.old[..6]));
    let strain = tensor::times(&tensor::difference(&square, &old_square), S::constant(0.5));
    new[..6].copy_from_slice(&tensor::pack(&square));
    let volumetric = (volume * volume - 1.0) * (0.5 * moduli.bulk);
    let mut second = tensor::plus(&tensor::times(&fast, S::constant(law.lasting())), volumetric, &inverse);
    let full = neo_hookean_energy(moduli, f);
    let bulk = volumetric_energy(moduli, excess_volume(f));
    let mut stored = (full - bulk) * law.lasting() + bulk;
    let mut dissipated = S::constant(0.0);
    for (k, branch) in law.used().iter().enumerate() {
        let place = 6 * (k + 1)..6 * (k + 2);
        let old: Tensor<S> = tensor::constant(&step.old[place.clone()]);
        let (left, gain) = decay(step.dt / branch.time);
        let gained = tensor::times(&rise, S::constant(gain * branch.fraction));
        let stress = tensor::plus(&gained, S::constant(left), &old);
        new[place].copy_from_slice(&tensor::pack(&stress));
        second = tensor::sum(&second, &stress);
        let modulus = moduli.shear * branch.fraction;
        let energy = branch_energy(modulus, &square, &stress);
        let work = tensor::contraction(&tensor::sum(&old, &stress), &strain) * 0.5;
        stored = stored + energy;
        dissipated = dissipated + work - (energy - branch_energy(modulus, &old_square, &old));
    }
    Response { stress: tensor::product(f, &second), stored, dissipated }
}

/// e^(−x) and (1 − e^(−x))/x for a step of x relaxation times: remaining fractions of a stress and of a linear increase
/// during the step.
fn decay(x: f64) -> (f64, f64) {
    if x > 0.0 { ((-x).exp(), -(-x).exp_m1() / x) } else { (1.0, 1.0) }
}

/// Isochoric stress S_iso = μ J^(−2/3) (I − ⅓ tr C C⁻¹).
#[inline(always)]
fn isochoric_stress<S: Scalar>(m: &Moduli, square: &Tensor<S>, inverse: &Tensor<S>, isochoric: S) -> Tensor<S> {
    let scale = isochoric * m.shear;
    let third = -(scale * tensor::trace(square) * (1.0 / 3.0));
    tensor::plus_identity(&tensor::times(inverse, third), scale)
}

/// Isochoric stress S_iso for C of the history.
#[inline(always)]
fn old_stress<S: Scalar>(m: &Moduli, kept: &[f64]) -> Tensor<S> {
    let square: Tensor = tensor::constant(kept);
    let volume = tensor::determinant(&square).sqrt();
    let stress = isochoric_stress(m, &square, &tensor::inverse(&square), isochoric(volume));
    tensor::convert(&stress, S::constant)
}

/// Stored energy of a branch, (CQ):(QC)/(4 g μ); zero for a branch without stiffness.
#[inline(always)]
fn branch_energy<S: Scalar>(modulus: f64, square: &Tensor<S>, stress: &Tensor<S>) -> S {
    if modulus == 0.0 {
        return S::constant(0.0);
    }
    let mixed = tensor::product(square, stress);
    tensor::contraction(&mixed, &tensor::transpose(&mixed)) * (0.25 / modulus)
}

#[cfg(test)]
mod tests {
    use super::super::samples::{close, random_tensor};
    use super::super::{Law, Material, neo_hookean};
    use super::*;
    use crate::math::dual::Dual;

    const MODULI: Moduli = Moduli { shear: 1.0, bulk: 2.2 };

    fn solid(pairs: &[(f64, f64)]) -> (Material, Vec<f64>) {
        let material = Material::new(1.0, MODULI, Law::Viscoelastic(Prony::new(pairs)));
        let mut history = vec![0.0; material.history_len()];
        material.begin(&mut history);
        (material, history)
    }

    #[test]
    fn stress_at_constant_strain_relaxes_along_the_series() {
        let pairs = [(0.3, 0.5), (0.2, 3.0)];
        let (material, mut old) = solid(&pairs);
        let f = tensor::plus_identity(&random_tensor(2, 0.3), 1.0);
        let full = neo_hookean(&MODULI, &f);
        let second = |x: f64| Moduli { shear: x, ..MODULI };
        let mut new = old.clone();
        close(&material.respond(&f, &old, 0.0, &mut new).stress, &full, 1e-14);
        let first = material.respond(&f, &old, 0.0, &mut new).stored;
        let (dt, mut lost, mut stored) = (0.1, 0.0, 0.0);
        for k in 1..=40 {
            old.copy_from_slice(&new);
            let answer = material.respond(&f, &old, dt, &mut new);
            let t = dt * f64::from(k);
            let left = 0.5 + pairs.iter().map(|(g, tau)| g * (-t / tau).exp()).sum::<f64>();
            close(&answer.stress, &neo_hookean(&second(left), &f), 1e-14);
            assert!(answer.dissipated > 0.0);
            lost += answer.dissipated;
            stored = answer.stored;
        }
        assert!((first - stored - lost).abs() < 1e-14);
    }

    #[test]
    fn shear_under_constant_stress_creeps_as_the_standard_linear_solid() {
        let (g, tau, stress) = (0.6, 1.0, 1e-5);
        let (material, mut old) = solid(&[(g, tau)]);
        let lasting = 1.0 - g;
        let (n, end) = (2000, 4.0);
        let mut shear = stress;
        for k in 0..=n {
            let dt = if k == 0 { 0.0 } else { end / f64::from(n) };
            let mut new = vec![Dual::constant(0.0); old.len()];
            for _ in 0..3 {
                let mut f = tensor::identity();
                f[0][1] = Dual::variable(shear);
                let p = material.respond(&f, &old, dt, &mut new).stress[0][1];
                shear -= (p.value - stress) / p.derivative;
            }
            let mut f = tensor::identity();
            f[0][1] = shear;
            let mut moved = old.clone();
            material.respond(&f, &old, dt, &mut moved);
            old = moved;
            // compliance 1/G∞ − (1/G∞ − 1/G₀) e^(−t/τ_c), τ_c = τ G₀/G∞
            let t = end * f64::from(k) / f64::from(n);
            let exact = stress * (1.0 / lasting - (1.0 / lasting - 1.0) * (-t * lasting / tau).exp());
            assert!((shear / exact - 1.0).abs() < 1e-6, "{k}: {:.1e}", shear / exact - 1.0);
        }
    }
}
