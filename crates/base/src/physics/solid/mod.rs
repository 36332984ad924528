//! Constitutive laws of solids, evaluated pointwise: stress from the deformation gradient F and the history.
//!
//! [`Material::respond`] maps F at the end of a step, the history variables and the duration of the step to the first
//! Piola-Kirchhoff stress P (force per undeformed area: `p[a][b]` is component a of the force on the undeformed face
//! b), the stored energy and the dissipated energy. It is generic in [`Scalar`]: with [`Dual`] numbers, the same code
//! yields the tangent dP = (∂P/∂F):dF of the whole step, including the return to the yield surface
//! ([`tangent_product`]). First derivatives are exact; second derivatives of laws with a history are not.
//!
//! | law | history | source |
//! |---|---|---|
//! | [`Law::Linear`], [`Law::SaintVenantKirchhoff`], [`Law::NeoHookean`] | none | [`elastic`] |
//! | [`Law::Orthotropic`] | none | [`orthotropic`] |
//! | [`Law::Hypoelastic`] | F and Cauchy's stress | [`hypoelastic`] |
//! | [`Law::Plastic`] | plastic metric, back stress, plastic strain, temperature, work | [`plasticity`] |
//! | [`Law::Viscoelastic`] | C and a stress per branch | [`viscoelastic`] |
//!
//! All laws are three-dimensional: plane strain is F₃₃ = 1, plane stress [`plane_stress()`]. Values are in SI units, or
//! in any consistent units. [`library`] is the catalogue of materials.
use crate::math::dual::Dual;
use crate::math::jet::Scalar;

pub mod elastic;
mod faults;
pub mod flow;
pub mod hypoelastic;
pub mod library;
pub mod orthotropic;
pub mod plane_stress;
pub mod plasticity;
#[cfg(test)]
mod samples;
pub mod tensor;
#[cfg(test)]
mod tests;
pub mod viscoelastic;

pub use elastic::{
    Moduli, linear, linear_energy, neo_hookean, neo_hookean_energy, saint_venant_kirchhoff,
    saint_venant_kirchhoff_energy,
};
pub use flow::{Hardening, JohnsonCook, Plasticity, Rate, Softening};
pub use library::{LIBRARY, Named, named};
pub use orthotropic::Orthotropic;
pub use plane_stress::plane_stress;
pub use tensor::Tensor;
pub use viscoelastic::{Branch, Prony};

/// Greatest number of history variables of a law.
pub const MOST_HISTORY: usize = viscoelastic::MOST_LENGTH;
/// Room temperature (K).
pub const ROOM_TEMPERATURE: f64 = 293.15;

/// Constitutive law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Linear elasticity for small strains and rotations.
    Linear,
    /// Saint-Venant-Kirchhoff elasticity for small strains and any rotation.
    SaintVenantKirchhoff,
    /// Compressible neo-Hookean elasticity for large strains.
    NeoHookean,
    /// Orthotropic Saint-Venant-Kirchhoff elasticity; the moduli of the material are mean values.
    Orthotropic(Orthotropic),
    /// Hypoelasticity: the stress rate is a function of the strain rate.
    Hypoelastic,
    /// Metal plasticity: neo-Hookean up to the von Mises yield condition.
    Plastic(Plasticity),
    /// Viscoelasticity: neo-Hookean with relaxation of the shear response; the moduli are the instantaneous ones.
    Viscoelastic(Prony),
}

/// Heating by plastic work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermal {
    /// Specific heat capacity [J/(kg K)].
    pub heat_capacity: f64,
    /// Fraction of the plastic work that is converted to heat (Taylor and Quinney 1934); with 0 the temperature is
    /// constant.
    pub heated_fraction: f64,
    /// Initial temperature (K).
    pub start: f64,
}

/// A solid material. Values are in SI units, or in any consistent units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Mass per undeformed volume.
    pub density: f64,
    /// Elastic moduli.
    pub moduli: Moduli,
    /// Constitutive law.
    pub law: Law,
    /// Heating by plastic work.
    pub thermal: Thermal,
    /// Von Mises stress up to which an elastic law is valid for a metal that yields there; `None` where there is no
    /// such limit.
    pub elastic_limit: Option<f64>,
}

/// Response of a material to a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<S = f64> {
    /// First Piola-Kirchhoff stress P at the end of the step.
    pub stress: Tensor<S>,
    /// Stored energy per undeformed volume at the end of the step.
    pub stored: S,
    /// Dissipated energy per undeformed volume during the step.
    pub dissipated: S,
}

/// Input of a law with history.
#[derive(Clone, Copy)]
struct Step<'a, S> {
    /// Deformation gradient F at the end of the step.
    gradient: &'a Tensor<S>,
    /// History variables at the start of the step.
    old: &'a [f64],
    /// Duration of the step.
    dt: f64,
}

impl Thermal {
    /// Room temperature without heating by plastic work.
    pub const ISOTHERMAL: Self = Self { heat_capacity: 1.0, heated_fraction: 0.0, start: ROOM_TEMPERATURE };
}

impl Material {
    /// A material at room temperature without heating by plastic work.
    pub const fn new(density: f64, moduli: Moduli, law: Law) -> Self {
        Self { density, moduli, law, thermal: Thermal::ISOTHERMAL, elastic_limit: None }
    }

    /// The material with another law.
    pub const fn with_law(self, law: Law) -> Self {
        Self { law, ..self }
    }

    /// The material without plasticity: its elastic law with the yield stress as `elastic_limit`. Other materials are
    /// unchanged.
    pub fn as_elastic(self) -> Self {
        match self.yield_stress() {
            Some(limit) => Self { law: Law::NeoHookean, elastic_limit: Some(limit), ..self },
            None => self,
        }
    }

    /// Number of history variables.
    pub fn history_len(&self) -> usize {
        match &self.law {
            Law::Linear | Law::SaintVenantKirchhoff | Law::NeoHookean | Law::Orthotropic(_) => 0,
            Law::Hypoelastic => hypoelastic::LENGTH,
            Law::Plastic(_) => plasticity::LENGTH,
            Law::Viscoelastic(prony) => prony.length(),
        }
    }

    /// Writes the initial history variables.
    pub fn begin(&self, history: &mut [f64]) {
        match &self.law {
            Law::Linear | Law::SaintVenantKirchhoff | Law::NeoHookean | Law::Orthotropic(_) => {}
            Law::Hypoelastic => hypoelastic::begin(history),
            Law::Plastic(_) => plasticity::begin(self.thermal.start, history),
            Law::Viscoelastic(prony) => prony.begin(history),
        }
    }

    /// Stress and energies at the deformation gradient `f` after a step of duration `dt` from the history `old`; writes
    /// the new history variables. `dt` = 0 means an instantaneous response: without relaxation, without viscoplastic
    /// flow, and at a low strain rate.
    pub fn respond<S: Scalar>(&self, f: &Tensor<S>, old: &[f64], dt: f64, new: &mut [S]) -> Response<S> {
        let m = &self.moduli;
        let elastic = |stress, stored| Response { stress, stored, dissipated: S::constant(0.0) };
        let step = Step { gradient: f, old, dt };
        match &self.law {
            Law::Linear => elastic(linear(m, f), linear_energy(m, f)),
            Law::SaintVenantKirchhoff => elastic(saint_venant_kirchhoff(m, f), saint_venant_kirchhoff_energy(m, f)),
            Law::NeoHookean => elastic(neo_hookean(m, f), neo_hookean_energy(m, f)),
            Law::Orthotropic(law) => elastic(law.stress(f), law.energy(f)),
            Law::Hypoelastic => hypoelastic::respond(m, &step, new),
            Law::Plastic(law) => plasticity::respond(m, law, self.heating(), &step, new),
            Law::Viscoelastic(law) => viscoelastic::respond(m, law, &step, new),
        }
    }

    /// Stress at `f` for laws without history; `None` for other laws.
    #[inline(always)]
    pub fn elastic_stress<S: Scalar>(&self, f: &Tensor<S>) -> Option<Tensor<S>> {
        match &self.law {
            Law::Linear => Some(linear(&self.moduli, f)),
            Law::SaintVenantKirchhoff => Some(saint_venant_kirchhoff(&self.moduli, f)),
            Law::NeoHookean => Some(neo_hookean(&self.moduli, f)),
            Law::Orthotropic(law) => Some(law.stress(f)),
            Law::Hypoelastic | Law::Plastic(_) | Law::Viscoelastic(_) => None,
        }
    }

    /// Stored energy per undeformed volume at `f` for laws without history; `None` for other laws.
    pub fn energy<S: Scalar>(&self, f: &Tensor<S>) -> Option<S> {
        match &self.law {
            Law::Linear => Some(linear_energy(&self.moduli, f)),
            Law::SaintVenantKirchhoff => Some(saint_venant_kirchhoff_energy(&self.moduli, f)),
            Law::NeoHookean => Some(neo_hookean_energy(&self.moduli, f)),
            Law::Orthotropic(law) => Some(law.energy(f)),
            Law::Hypoelastic | Law::Plastic(_) | Law::Viscoelastic(_) => None,
        }
    }

    /// Speed of pressure waves √((K + 4/3 μ)/ρ) in the undeformed material.
    pub fn pressure_wave_speed(&self) -> f64 {
        (self.moduli.pressure_wave() / self.density).sqrt()
    }

    /// Speed of shear waves √(μ/ρ) in the undeformed material.
    pub fn shear_wave_speed(&self) -> f64 {
        (self.moduli.shear / self.density).sqrt()
    }

    /// Initial yield stress at a low strain rate; `None` for laws without yield.
    pub fn yield_stress(&self) -> Option<f64> {
        match &self.law {
            Law::Plastic(law) => Some(law.hardening.stress(0.0)),
            _ => None,
        }
    }

    /// Equivalent plastic strain in the history variables; 0 for laws without plasticity.
    pub fn plastic_strain(&self, history: &[f64]) -> f64 {
        if matches!(self.law, Law::Plastic(_)) { history[plasticity::STRAIN] } else { 0.0 }
    }

    /// Temperature in the history variables (K); the initial temperature for laws without heating.
    pub fn temperature(&self, history: &[f64]) -> f64 {
        if matches!(self.law, Law::Plastic(_)) { history[plasticity::TEMPERATURE] } else { self.thermal.start }
    }

    /// Temperature rise per plastic work, χ/(ρc).
    fn heating(&self) -> f64 {
        self.thermal.heated_fraction / (self.density * self.thermal.heat_capacity)
    }
}

/// Consistent tangent in one direction: change dP of the stress at the end of a step due to the change `df` of F there.
pub fn tangent_product(material: &Material, f: &Tensor, df: &Tensor, old: &[f64], dt: f64) -> Tensor {
    let f = tensor::of(|i, j| Dual { value: f[i][j], derivative: df[i][j] });
    let mut scratch = [Dual::constant(0.0); MOST_HISTORY];
    let stress = material.respond(&f, old, dt, &mut scratch).stress;
    tensor::convert(&stress, |x| x.derivative)
}
