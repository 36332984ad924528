//! Finite-strain plasticity of metals: von Mises yield condition with radial return.
//!
//! F = Fᵉ Fᵖ; the history stores Cᵖ⁻¹ = (FᵖᵀFᵖ)⁻¹, which does not change with rigid rotations. For a given F, the trial
//! state is b̄ = J^(−2/3) F Cᵖ⁻¹ Fᵀ, s = μ dev b̄. With ξ = s − β, n = ξ/|ξ|, μ̄ = ⅓ μ tr b̄ the return is radial (Simo
//! & Hughes 1998, *Computational Inelasticity*, box 9.1):
//!
//! |ξ| − 2μ̄ Δγ − ⅔ H Γ = √⅔ σ_y(ε_p + √⅔ Γ, √⅔ Γ/Δt, T), s ← s − 2μ̄ Δγ n, β ← β + ⅔ H Γ n.
//!
//! The book uses Γ = Δγ, which is the plastic strain to first order, because b̄ also contains the squares of a step. Γ
//! = Δγ/(1 + Δγ tr n³) removes this error; in tension, √⅔ Γ = ⅔ tanh(3/2 Δε) for a logarithmic strain Δε of any
//! magnitude.
//!
//! The trace of b̄ follows from det b̄ = 1, so that plastic flow conserves volume for any number of steps. The
//! Kirchhoff stress is τ = s + ½ K (J² − 1) I and P = τ F⁻ᵀ. The back stress β rotates with F, so that elastic strain
//! stores no energy in it. The plastic work is ∫ π dγ with π = −½ μ d(tr b̄)/dγ, the loss of elastic energy at fixed F,
//! by the trapezoidal rule; its fraction χ heats the solid adiabatically, ΔT = χ Δw/(ρc) (Taylor & Quinney 1934).
//!
//! Δγ is found in real arithmetic. One more Newton step in the scalar type of the caller gives its first derivative, so
//! that the tangent is consistent.
use super::elastic::{Moduli, excess_volume, isochoric, volumetric_energy};
use super::flow::{Plasticity, Rate};
use super::tensor::{self, Tensor};
use super::{Response, Step};
use crate::math::dual::Dual;
use crate::math::jet::Scalar;
use std::ops::Range;

/// √⅔, the factor between the norm of a deviator and the equivalent uniaxial stress.
const ROOT: f64 = 0.816_496_580_927_726;
/// Maximum number of Newton steps; afterwards the root is accepted, because rounding may keep the last digit from
/// settling.
const MOST_STEPS: usize = 100;
/// Relative size of a step at which the iteration ends.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Fraction of the upper limit of the bracket at which a search continues that left a bracket with the lower limit zero.
const RETREAT: f64 = 0.05;

/// Range of Cᵖ⁻¹ in the history.
const METRIC: Range<usize> = 0..6;
/// Range of the back stress in the history, rotated back by the rotation of F.
const BACK: Range<usize> = 6..12;
/// Index of the equivalent plastic strain in the history.
pub(super) const STRAIN: usize = 12;
/// Index of the temperature in the history.
pub(super) const TEMPERATURE: usize = 13;
/// Index of the plastic work per undeformed volume in the history.
pub(super) const WORK: usize = 14;
/// Index of the plastic work per unit of γ, minus that on the back stress, at the end of the last step; 0 after an
/// elastic step.
const POWER: usize = 15;
/// Number of history variables.
pub(super) const LENGTH: usize = 16;

/// Material constants and data of a step.
#[derive(Clone, Copy)]
struct Point<'a> {
    moduli: &'a Moduli,
    law: &'a Plasticity,
    /// Temperature rise per plastic work.
    heating: f64,
    old: &'a [f64],
    dt: f64,
}

/// Trial state, before plastic flow.
struct Trial<S> {
    /// Deviator dev b̄ of the trial state.
    shape: Tensor<S>,
    /// ⅓ tr b̄.
    mean: S,
    /// Back stress β.
    back: Tensor<S>,
    /// Direction n of ξ.
    direction: Tensor<S>,
    /// Norm |ξ| of the relative stress.
    norm: S,
    /// Third invariant tr n³ of the direction.
    cubic: S,
}

/// Writes the history of the undeformed state without plastic flow.
pub(super) fn begin(temperature: f64, history: &mut [f64]) {
    history[..LENGTH].fill(0.0);
    history[..3].fill(1.0);
    history[TEMPERATURE] = temperature;
}

/// Response to a step; `heating` is the temperature rise per plastic work.
pub(super) fn respond<S: Scalar>(
    moduli: &Moduli,
    law: &Plasticity,
    heating: f64,
    step: &Step<'_, S>,
    new: &mut [S],
) -> Response<S> {
    let f = step.gradient;
    let point = Point { moduli, law, heating, old: step.old, dt: step.dt };
    let cofactor = tensor::cofactor(f);
    let volume = f[0][0] * cofactor[0][0] + f[0][1] * cofactor[0][1] + f[0][2] * cofactor[0][2];
    let isochoric = isochoric(volume);
    let rotation = (law.kinematic != 0.0).then(|| tensor::rotation(f));
    let trial = point.trial(f, isochoric, rotation.as_ref());
    let flow = point.flow(&trial);
    for (new, old) in new.iter_mut().zip(step.old) {
        *new = S::constant(*old);
    }
    new[POWER] = S::constant(0.0);
    let (mut shape, mut mean, mut back) = (trial.shape, trial.mean, trial.back);
    let mut dissipated = S::constant(0.0);
    if flow.value() > 0.0 {
        shape = tensor::plus(&shape, -(mean * flow * 2.0), &trial.direction);
        mean = unimodular_mean(&shape);
        let strain = trial.plastic_strain(flow);
        back = tensor::plus(&back, strain * (law.kinematic * 2.0 / 3.0), &trial.direction);
        let (work, power) = point.work(&trial, flow);
        // Cᵖ⁻¹ = J^(2/3) F⁻¹ b̄ F⁻ᵀ, and F⁻¹ is the transposed cofactor over J
        let elastic = tensor::plus_identity(&shape, mean);
        let pulled = tensor::transposed_product(&cofactor, &tensor::product(&elastic, &cofactor));
        let scale = (isochoric * volume * volume).inverse();
        new[METRIC].copy_from_slice(&tensor::pack(&tensor::times(&pulled, scale)));
        if let Some(r) = &rotation {
            let turned = tensor::transposed_product(r, &tensor::product(&back, r));
            new[BACK].copy_from_slice(&tensor::pack(&turned));
        }
        new[STRAIN] = strain * ROOT + step.old[STRAIN];
        new[TEMPERATURE] = work * heating + step.old[TEMPERATURE];
        new[WORK] = work + step.old[WORK];
        new[POWER] = power;
        dissipated = work - (point.back_energy(&back) - point.back_energy(&trial.back));
    }
    let pressure = (volume * volume - 1.0) * (0.5 * moduli.bulk);
    let kirchhoff = tensor::plus_identity(&tensor::times(&shape, S::constant(moduli.shear)), pressure);
    let elastic = excess_of_mean(&shape, mean) * (1.5 * moduli.shear) + volumetric_energy(moduli, excess_volume(f));
    Response {
        stress: tensor::times(&tensor::product(&kirchhoff, &cofactor), volume.inverse()),
        stored: elastic + point.back_energy(&back),
        dissipated,
    }
}

impl Point<'_> {
    /// Trial state for the deformation gradient, without plastic flow.
    #[inline(always)]
    fn trial<S: Scalar>(&self, f: &Tensor<S>, isochoric: S, rotation: Option<&Tensor<S>>) -> Trial<S> {
        let pushed = tensor::product(f, &tensor::constant(&self.old[METRIC]));
        let elastic = tensor::times(&tensor::product_transposed(&pushed, f), isochoric);
        let mean = tensor::trace(&elastic) * (1.0 / 3.0);
        let shape = tensor::plus_identity(&elastic, -mean);
        let back = rotation.map_or([[S::constant(0.0); 3]; 3], |r| {
            tensor::product_transposed(&tensor::product(r, &tensor::constant(&self.old[BACK])), r)
        });
        let relative = tensor::difference(&tensor::times(&shape, S::constant(self.moduli.shear)), &back);
        let square = tensor::contraction(&relative, &relative);
        // the norm of a zero tensor has no derivative, and is not needed
        let norm = if square.value() > 0.0 { square.sqrt() } else { S::constant(0.0) };
        let over = if square.value() > 0.0 { norm.inverse() } else { S::constant(0.0) };
        let direction = tensor::times(&relative, over);
        Trial { shape, mean, back, direction, norm, cubic: tensor::determinant(&direction) * 3.0 }
    }

    /// Plastic flow Δγ of the step; zero if the trial state does not yield.
    #[inline(always)]
    fn flow<S: Scalar>(&self, trial: &Trial<S>) -> S {
        let plain = trial.convert(S::value);
        let excess = plain.norm - ROOT * self.flow_stress(0.0, plain.norm * 0.0 + self.old[TEMPERATURE]);
        let instant = self.dt <= 0.0 && matches!(self.law.rate, Rate::Overstress { .. });
        if !(excess > 0.0) || instant {
            return S::constant(0.0);
        }
        let (flow, slope) = self.root(&plain, excess);
        let left = self.excess(trial, S::constant(flow));
        S::constant(flow) - left * (1.0 / slope)
    }

    /// Root Δγ of the yield condition and the slope there, by Newton's method within a shrinking bracket.
    fn root(&self, trial: &Trial<f64>, excess: f64) -> (f64, f64) {
        let stiffness = 2.0 * self.moduli.shear * trial.mean + self.law.kinematic * (2.0 / 3.0);
        let (mut low, mut high) = (0.0, trial.norm / (2.0 * self.moduli.shear * trial.mean));
        let mut flow = excess / stiffness;
        let dual = trial.convert(Dual::constant);
        let mut slope = -stiffness;
        for _ in 0..MOST_STEPS {
            let left = self.excess(&dual, Dual::variable(flow));
            slope = left.derivative;
            if left.value > 0.0 {
                low = flow;
            } else {
                high = flow;
            }
            let mut next = flow - left.value / slope;
            if !(low <= next && next <= high) {
                next = if low > 0.0 { (low * high).sqrt() } else { RETREAT * high };
            }
            let change = (next - flow).abs();
            flow = next;
            if !(change > ROUNDING * flow) {
                break;
            }
        }
        (flow, slope)
    }

    /// |ξ| − √⅔ σ_y after the plastic flow `flow`: positive as long as the state yields.
    #[inline(always)]
    fn excess<S: Scalar>(&self, trial: &Trial<S>, flow: S) -> S {
        let strain = trial.plastic_strain(flow);
        let relieved = flow * trial.mean * (2.0 * self.moduli.shear) + strain * (self.law.kinematic * 2.0 / 3.0);
        let warms = self.heating != 0.0 && self.law.softening.is_some();
        let heat = if warms { self.work(trial, flow).0 * self.heating } else { S::constant(0.0) };
        trial.norm - relieved - self.flow_stress(strain * ROOT, heat + self.old[TEMPERATURE]) * ROOT
    }

    /// Flow stress after an increase of the plastic strain in this step.
    #[inline(always)]
    fn flow_stress<S: Scalar>(&self, rise: S, temperature: S) -> S {
        // a step without duration has no strain rate: the quasi-static response is used
        let rate = if self.dt > 0.0 { rise * (1.0 / self.dt) } else { S::constant(0.0) };
        self.law.flow_stress(rise + self.old[STRAIN], rate, temperature)
    }

    /// Plastic work of the step, and its rate π with respect to γ at the end, minus the part β:n on the back stress.
    ///
    /// With d = dev b̄, x = ⅓ tr b̄ and det b̄ = 1, d(tr b̄)/dγ along dd/dγ = −2x n gives π = 3μx (x n:d − n:d²)/I₂,
    /// I₂ = 3x² − ½ d:d; for small elastic strain that is s:n.
    #[inline(always)]
    fn work<S: Scalar>(&self, trial: &Trial<S>, flow: S) -> (S, S) {
        let n = &trial.direction;
        let d = tensor::plus(&trial.shape, -(trial.mean * flow * 2.0), n);
        let x = unimodular_mean(&d);
        let second = x * x * 3.0 - tensor::contraction(&d, &d) * 0.5;
        let along = x * tensor::contraction(n, &d) - tensor::contraction(n, &tensor::product(&d, &d));
        let back = tensor::contraction(n, &trial.back);
        let strain = trial.plastic_strain(flow);
        let back_end = back + strain * (self.law.kinematic * 2.0 / 3.0);
        let power = x * along / second * (3.0 * self.moduli.shear) - back_end;
        // plastic flow started within the step, at about the stress of its end
        let start = if self.old[POWER] == 0.0 { power } else { S::constant(self.old[POWER]) };
        // the return used the x of the trial state
        ((start + power + back + back_end) * strain * (trial.mean / x) * 0.5, power)
    }

    /// Energy ¾ β:β/H of the back stress.
    #[inline(always)]
    fn back_energy<S: Scalar>(&self, back: &Tensor<S>) -> S {
        if self.law.kinematic == 0.0 {
            return S::constant(0.0);
        }
        tensor::contraction(back, back) * (0.75 / self.law.kinematic)
    }
}

impl<S: Scalar> Trial<S> {
    /// Norm Γ of the plastic strain of a radial return by `flow`, to second order.
    #[inline(always)]
    fn plastic_strain(&self, flow: S) -> S {
        flow / (flow * self.cubic + 1.0)
    }

    /// The trial state in another scalar type.
    #[inline(always)]
    fn convert<T: Scalar>(&self, f: impl Fn(S) -> T + Copy) -> Trial<T> {
        Trial {
            shape: tensor::convert(&self.shape, f),
            mean: f(self.mean),
            back: tensor::convert(&self.back, f),
            direction: tensor::convert(&self.direction, f),
            norm: f(self.norm),
            cubic: f(self.cubic),
        }
    }
}

/// The x for which det(d + x I) = 1 for a deviator d: the largest root of x³ − ½ (d:d) x + det d − 1.
#[inline(always)]
fn unimodular_mean<S: Scalar>(d: &Tensor<S>) -> S {
    let (linear, constant) = (tensor::contraction(d, d) * 0.5, tensor::determinant(d) - 1.0);
    let (a, b) = (linear.value(), constant.value());
    // to the right of the turning point √(a/3) the cubic is convex, and all steps but the first decrease to the root
    let mut x = 1.0 + (a / 3.0).sqrt();
    for _ in 0..MOST_STEPS {
        let change = ((x * x - a) * x + b) / (3.0 * x * x - a);
        x -= change;
        if !(change.abs() > ROUNDING * x) {
            break;
        }
    }
    let x = S::constant(x);
    x - ((x * x - linear) * x + constant) * (1.0 / (3.0 * x.value() * x.value() - a))
}

/// The value of x − 1 = −⅓ (x I₂ + I₃ + e² (3 + e)) with the invariants of d, from e = x − 1, so that small strains
/// remain accurate.
#[inline(always)]
fn excess_of_mean<S: Scalar>(d: &Tensor<S>, mean: S) -> S {
    let e = mean - 1.0;
    let second = tensor::contraction(d, d) * -0.5;
    (mean * second + tensor::determinant(d) + e * e * (e + 3.0)) * (-1.0 / 3.0)
}

#[cfg(test)]
mod tests {
    use super::super::flow::{Hardening, Softening};
    use super::super::{Law, Material, Thermal};
    use super::*;

    const MODULI: Moduli = Moduli { shear: 1.0, bulk: 2.2 };

    fn solid(law: Plasticity) -> (Material, Vec<f64>) {
        let material = Material::new(1.0, MODULI, Law::Plastic(law));
        let mut history = vec![0.0; LENGTH];
        material.begin(&mut history);
        (material, history)
    }

    /// Kirchhoff stress along a bar with free sides that is stretched to `stretch`; updates the history.
    fn pull(material: &Material, stretch: f64, dt: f64, history: &mut Vec<f64>) -> f64 {
        let at = |side: Dual| {
            let mut f = tensor::identity();
            (f[0][0], f[1][1], f[2][2]) = (Dual::constant(stretch), side, side);
            material.respond(&f, history, dt, &mut [Dual::constant(0.0); LENGTH]).stress
        };
        let mut side = stretch.powf(-0.5);
        for _ in 0..30 {
            let p = at(Dual::variable(side))[1][1];
            side -= p.value / p.derivative;
        }
        let mut f = tensor::identity();
        (f[0][0], f[1][1], f[2][2]) = (stretch, side, side);
        let mut new = history.clone();
        let stress = material.respond(&f, history, dt, &mut new).stress;
        assert!(stress[1][1].abs() < 1e-14 * material.moduli.shear);
        *history = new;
        stress[0][0] * stretch
    }

    #[test]
    fn a_bar_in_tension_and_back_follows_isotropic_and_kinematic_hardening() {
        let (start, isotropic, kinematic) = (0.01, 0.03, 0.08);
        let (material, mut history) = solid(Plasticity { kinematic, ..Plasticity::linear(start, isotropic) });
        for k in 1..=20 {
            let stress = pull(&material, 1.0 + 0.02 * f64::from(k), 1.0, &mut history);
            let exact = start + (isotropic + kinematic) * history[STRAIN];
            assert!((stress - exact).abs() < 1e-13, "{stress} {exact}");
        }
        let first = history[STRAIN];
        assert!((first - 1.4f64.ln()).abs() < 0.02);
        // Bauschinger effect: reverse loading yields about the centre that has moved by the kinematic part
        for k in 1..=20 {
            let stress = pull(&material, 1.4 - 0.02 * f64::from(k), 1.0, &mut history);
            let all = history[STRAIN];
            let exact = kinematic * (2.0 * first - all) - (start + isotropic * all);
            assert!(k == 1 || (stress - exact).abs() < 1e-13, "{stress} {exact}");
        }
        assert!((tensor::determinant(&tensor::unpack(&history[METRIC])) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn small_strains_follow_the_elastoplastic_moduli() {
        let (start, slope) = (1e-7, 0.3);
        let (material, virgin) = solid(Plasticity::linear(start, slope));
        let young = MODULI.young();
        let strain = 3e-7;
        let stress = pull(&material, 1.0 + strain, 1.0, &mut virgin.clone());
        let exact = start + young * slope / (young + slope) * (strain - start / young);
        assert!((stress / exact - 1.0).abs() < 1e-6, "{:.1e}", stress / exact - 1.0);
        let mut f = tensor::identity();
        f[0][1] = strain;
        let shear = material.respond(&f, &virgin, 1.0, &mut [0.0; LENGTH]).stress[0][1];
        let first = start / 3f64.sqrt();
        let exact = first + slope / (3.0 + slope) * (strain - first);
        assert!((shear / exact - 1.0).abs() < 1e-6, "{:.1e}", shear / exact - 1.0);
    }

    #[test]
    fn the_root_is_found_for_any_hardening_rate_and_step() {
        use super::super::samples::random_tensor;
        let softening = Some(Softening { reference: 290.0, melting: 900.0, exponent: 0.7 });
        let thermal = Thermal { heat_capacity: 1e-4, heated_fraction: 0.9, start: 300.0 };
        for seed in 0..400 {
            let r = random_tensor(seed, 1.0);
            let wide = |x: f64, decades: f64| 10f64.powf(decades * x);
            let hardening =
                Hardening::Power { start: 0.01, modulus: 0.03 * wide(r[0][0], 2.0), exponent: 0.55 + 0.5 * r[0][1] };
            let viscosity = wide(r[0][2], 8.0);
            let rate = match seed % 3 {
                0 => Rate::Independent,
                1 => Rate::Logarithmic { factor: 0.05, reference: wide(r[1][0], 6.0) },
                _ => Rate::Overstress { viscosity, exponent: 5.5 + 4.5 * r[1][1] },
            };
            let law = Plasticity { hardening, kinematic: 0.0, rate, softening: softening.filter(|_| seed % 2 == 0) };
            let (material, old) = solid(law);
            let material = Material { thermal, ..material };
            let f = tensor::plus_identity(&random_tensor(seed + 1000, 0.2 * wide(r[1][2] - 1.0, 1.0)), 1.0);
            let (dt, mut new) = (wide(r[2][0], 6.0), old.clone());
            let p = material.respond(&f, &old, dt, &mut new).stress;
            let shape = tensor::norm(&tensor::deviator(&tensor::product_transposed(&p, &f))) / ROOT;
            let strain = new[STRAIN];
            // the rate is as accurate as the strain, whose error may be 1e-15 of the step
            let found = law.flow_stress(strain, strain / dt, new[TEMPERATURE]);
            assert!(strain > 0.0 || shape <= found, "seed {seed}");
            assert!(
                strain == 0.0 || (shape - found).abs() < 1e-13,
                "seed {seed}: {shape} {found} {strain:.1e} {law:?}"
            );
        }
    }

    #[test]
    fn large_shear_stays_on_the_yield_surface() {
        let hardening = Hardening::Voce { start: 0.01, linear: 0.002, saturation: 0.02, exponent: 5.0 };
        let law = Plasticity { hardening, ..Plasticity::linear(0.0, 0.0) };
        let (material, mut history) = solid(law);
        let mut f = tensor::identity();
        for k in 1..=100 {
            f[0][1] = 0.05 * f64::from(k);
            let mut new = history.clone();
            let p = material.respond(&f, &history, 1.0, &mut new).stress;
            let shape = tensor::deviator(&tensor::product_transposed(&p, &f));
            let yields = hardening.stress(new[STRAIN]);
            assert!((tensor::norm(&shape) / ROOT - yields).abs() < 1e-14, "step {k}");
            history = new;
        }
        assert!((tensor::determinant(&tensor::unpack(&history[METRIC])) - 1.0).abs() < 1e-12);
        assert!((history[STRAIN] - 5.0 / 3f64.sqrt()).abs() < 0.02);
    }

    #[test]
    fn flow_under_johnson_cook_is_at_the_stress_of_the_formula() {
        let found = super::super::named("copper ofhc").map(|m| m.material);
        let Some(material) = found else { panic!("copper is in the library") };
        let Law::Plastic(law) = material.law else { panic!("copper flows") };
        let mut history = vec![0.0; LENGTH];
        material.begin(&mut history);
        let dt = 1e-6;
        for k in 1..=50 {
            let before = history[STRAIN];
            let stress = pull(&material, 1.0 + 0.01 * f64::from(k), dt, &mut history);
            let rate = (history[STRAIN] - before) / dt;
            let star: f64 = (history[TEMPERATURE] - 293.15) / (1356.0 - 293.15);
            let cold = (90e6 + 292e6 * history[STRAIN].powf(0.31)) * (1.0 + 0.025 * rate.ln());
            let exact = cold * (1.0 - star.powf(1.09));
            assert!((stress / exact - 1.0).abs() < 1e-12, "{k}: {stress} {exact}");
            assert!((law.flow_stress(history[STRAIN], rate, history[TEMPERATURE]) / exact - 1.0).abs() < 1e-12);
        }
        let heat = 0.9 * history[WORK] / (8960.0 * 383.0);
        assert!((material.temperature(&history) - 293.15 - heat).abs() < 1e-9 && heat > 20.0);
    }

    #[test]
    fn overstress_settles_at_the_value_of_the_rate() {
        let (start, viscosity, exponent, rate) = (1e-7, 0.2, 3.0, 0.5);
        let overstress = Rate::Overstress { viscosity, exponent };
        let (material, mut history) = solid(Plasticity { rate: overstress, ..Plasticity::linear(start, 0.0) });
        let dt = 2e-8;
        let mut stress = 0.0;
        for k in 1..=400 {
            stress = pull(&material, (rate * dt * f64::from(k)).exp(), dt, &mut history);
        }
        let exact = start * (1.0 + (viscosity * rate).powf(1.0 / exponent));
        assert!((stress / exact - 1.0).abs() < 1e-6, "{:.1e}", stress / exact - 1.0);
        // a step without duration causes no viscoplastic flow
        let before = history[STRAIN];
        pull(&material, 1.1, 0.0, &mut history);
        assert_eq!(history[STRAIN], before);
    }

    #[test]
    fn adiabatic_flow_softens_exponentially() {
        let softening = Some(Softening { reference: 300.0, melting: 800.0, exponent: 1.0 });
        let start = 1e-7;
        let (material, mut history) = solid(Plasticity { softening, ..Plasticity::linear(start, 0.0) });
        // all plastic work becomes heat, so that a strain of 1 without softening would give a rise of 500 K
        let thermal = Thermal { heat_capacity: start / 500.0, heated_fraction: 1.0, start: 300.0 };
        let material = Material { thermal, ..material };
        material.begin(&mut history);
        let n = 1000;
        let mut stress = 0.0;
        for k in 1..=n {
            stress = pull(&material, (0.5 * f64::from(k) / f64::from(n)).exp(), 1.0, &mut history);
        }
        let strain = history[STRAIN];
        assert!((strain - 0.5).abs() < 1e-6);
        let exact = start * (-strain).exp();
        assert!((stress / exact - 1.0).abs() < 1e-6, "{:.1e}", stress / exact - 1.0);
        let hot = 300.0 + 500.0 * (1.0 - (-strain).exp());
        assert!((history[TEMPERATURE] / hot - 1.0).abs() < 1e-6);
    }
}
