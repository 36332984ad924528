//! Laws of solids, at one place: stress from the deformation gradient F and what was before.
//!
//! [`Material::respond`] maps F at the end of a step, the history and the duration of the step to the first stress of Piola
//! and Kirchhoff P (force per reference area: `p[a][b]` is the component a of the force on the reference face b), the energy
//! stored and the energy lost. It is written once over [`Scalar`]: with [`Dual`] numbers the same lines give the tangent
//! dP = (∂P/∂F):dF of the whole step, return to the yield surface included; [`tangent_product`] does that. First derivatives
//! are exact; second derivatives of laws with a history are not.
//!
//! | law | history | source |
//! |---|---|---|
//! | [`Law::Linear`], [`Law::SaintVenantKirchhoff`], [`Law::NeoHookean`] | none | [`elastic`] |
//! | [`Law::Orthotropic`] | none | [`orthotropic`] |
//! | [`Law::Hypoelastic`] | F and Cauchy's stress | [`hypoelastic`] |
//! | [`Law::Plastic`] | plastic metric, back stress, plastic strain, temperature, work | [`plasticity`] |
//! | [`Law::Viscoelastic`] | C and a stress per branch | [`viscoelastic`] |
//!
//! All is in three dimensions: plane strain is F₃₃ = 1, plane stress [`plane_stress()`]. Numbers are in SI units, or in any
//! units that agree. [`library`] holds materials by name.
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

/// Most numbers of history that any law keeps.
pub const MOST_HISTORY: usize = viscoelastic::MOST_LENGTH;
/// Temperature of a room, K.
pub const ROOM_TEMPERATURE: f64 = 293.15;

/// How stress follows from deformation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    /// Linear elasticity, for small strains and rotations.
    Linear,
    /// Elasticity of Saint-Venant and Kirchhoff, for small strains and any rotation.
    SaintVenantKirchhoff,
    /// Compressible neo-Hookean elasticity, for large strains.
    NeoHookean,
    /// Saint-Venant and Kirchhoff's elasticity with three planes of symmetry; the moduli are means.
    Orthotropic(Orthotropic),
    /// Rates of stress from rates of deformation.
    Hypoelastic,
    /// Metals: neo-Hookean up to von Mises' yield condition.
    Plastic(Plasticity),
    /// Neo-Hookean with a resistance to shear that relaxes; the moduli are the instantaneous ones.
    Viscoelastic(Prony),
}

/// What plastic work does to the temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thermal {
    /// Heat capacity per mass, J/(kg K).
    pub heat_capacity: f64,
    /// Part of plastic work that becomes heat (Taylor & Quinney 1934); 0 keeps the temperature.
    pub heated_fraction: f64,
    /// Temperature at the start, K.
    pub start: f64,
}

/// A solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Mass per reference volume.
    pub density: f64,
    /// Elastic moduli.
    pub moduli: Moduli,
    /// How stress follows from deformation.
    pub law: Law,
    /// What plastic work does to the temperature.
    pub thermal: Thermal,
    /// Von Mises stress up to which an elastic law stands for a metal that yields there; none where it holds anywhere.
    pub elastic_limit: Option<f64>,
}

/// What a solid answers to a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Response<S = f64> {
    /// First stress of Piola and Kirchhoff P at the end of the step.
    pub stress: Tensor<S>,
    /// Energy stored per reference volume at the end of the step.
    pub stored: S,
    /// Energy lost per reference volume within the step.
    pub dissipated: S,
}

/// What a law with a history is asked.
#[derive(Clone, Copy)]
struct Step<'a, S> {
    /// F at the end of the step.
    gradient: &'a Tensor<S>,
    /// History before it.
    old: &'a [f64],
    /// Duration.
    dt: f64,
}

impl Thermal {
    /// A room in which plastic work heats nothing.
    pub const ISOTHERMAL: Self = Self { heat_capacity: 1.0, heated_fraction: 0.0, start: ROOM_TEMPERATURE };
}

impl Material {
    /// A solid at room temperature that plastic work does not heat.
    pub const fn new(density: f64, moduli: Moduli, law: Law) -> Self {
        Self { density, moduli, law, thermal: Thermal::ISOTHERMAL, elastic_limit: None }
    }

    /// The same solid with another law.
    pub const fn with_law(self, law: Law) -> Self {
        Self { law, ..self }
    }

    /// A metal without its yield: the same below its yield stress, which is kept as the limit. Other solids are as they are.
    pub fn as_elastic(self) -> Self {
        match self.yield_stress() {
            Some(limit) => Self { law: Law::NeoHookean, elastic_limit: Some(limit), ..self },
            None => self,
        }
    }

    /// Numbers of history.
    pub fn history_len(&self) -> usize {
        match &self.law {
            Law::Linear | Law::SaintVenantKirchhoff | Law::NeoHookean | Law::Orthotropic(_) => 0,
            Law::Hypoelastic => hypoelastic::LENGTH,
            Law::Plastic(_) => plasticity::LENGTH,
            Law::Viscoelastic(prony) => prony.length(),
        }
    }

    /// Writes the history of the virgin solid.
    pub fn begin(&self, history: &mut [f64]) {
        match &self.law {
            Law::Linear | Law::SaintVenantKirchhoff | Law::NeoHookean | Law::Orthotropic(_) => {}
            Law::Hypoelastic => hypoelastic::begin(history),
            Law::Plastic(_) => plasticity::begin(self.thermal.start, history),
            Law::Viscoelastic(prony) => prony.begin(history),
        }
    }

    /// Stress and energies at the deformation gradient `f` after a step of length `dt` from the history `old`; writes the new
    /// history. A `dt` of 0 is an instant: nothing relaxes, overstress does not let yield, rates count as slow.
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

    /// Stress at `f` where it depends on `f` alone.
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

    /// Energy stored per reference volume at `f` where it depends on `f` alone.
    pub fn energy<S: Scalar>(&self, f: &Tensor<S>) -> Option<S> {
        match &self.law {
            Law::Linear => Some(linear_energy(&self.moduli, f)),
            Law::SaintVenantKirchhoff => Some(saint_venant_kirchhoff_energy(&self.moduli, f)),
            Law::NeoHookean => Some(neo_hookean_energy(&self.moduli, f)),
            Law::Orthotropic(law) => Some(law.energy(f)),
            Law::Hypoelastic | Law::Plastic(_) | Law::Viscoelastic(_) => None,
        }
    }

    /// Speed of pressure waves √((K + 4/3 μ)/ρ) of the undeformed solid.
    pub fn pressure_wave_speed(&self) -> f64 {
        (self.moduli.pressure_wave() / self.density).sqrt()
    }

    /// Speed of shear waves √(μ/ρ) of the undeformed solid.
    pub fn shear_wave_speed(&self) -> f64 {
        (self.moduli.shear / self.density).sqrt()
    }

    /// Flow stress of the virgin solid in slow deformation; `None` for laws that never yield.
    pub fn yield_stress(&self) -> Option<f64> {
        match &self.law {
            Law::Plastic(law) => Some(law.hardening.stress(0.0)),
            _ => None,
        }
    }

    /// Equivalent plastic strain in a history; 0 for laws without.
    pub fn plastic_strain(&self, history: &[f64]) -> f64 {
        if matches!(self.law, Law::Plastic(_)) { history[plasticity::STRAIN] } else { 0.0 }
    }

    /// Temperature in a history, K; that of the start for laws without.
    pub fn temperature(&self, history: &[f64]) -> f64 {
        if matches!(self.law, Law::Plastic(_)) { history[plasticity::TEMPERATURE] } else { self.thermal.start }
    }

    /// Plastic work per reference volume in a history; 0 for laws without.
    pub fn plastic_work(&self, history: &[f64]) -> f64 {
        if matches!(self.law, Law::Plastic(_)) { history[plasticity::WORK] } else { 0.0 }
    }

    /// Rise of temperature per plastic work, χ/(ρc).
    fn heating(&self) -> f64 {
        self.thermal.heated_fraction / (self.density * self.thermal.heat_capacity)
    }
}

/// Change dP of the stress at the end of a step with the change `df` of F there: the consistent tangent in one direction.
pub fn tangent_product(material: &Material, f: &Tensor, df: &Tensor, old: &[f64], dt: f64) -> Tensor {
    let f = tensor::of(|i, j| Dual { value: f[i][j], derivative: df[i][j] });
    let mut scratch = [Dual::constant(0.0); MOST_HISTORY];
    let stress = material.respond(&f, old, dt, &mut scratch).stress;
    tensor::convert(&stress, |x| x.derivative)
}
