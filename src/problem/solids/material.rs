//! Materials of a case.
use super::super::error::RunError;
use crate::case::{self, SolidLaw, SolidMaterial};
use crate::physics::solid::orthotropic::Constants;
use crate::physics::solid::{
    Hardening, LIBRARY, Law, Material, Moduli, Orthotropic, Plasticity, Prony, Rate, Softening, Thermal, named,
};

/// The material that a case describes; `place` names it in messages.
pub(super) fn material(data: &SolidMaterial, place: &str) -> Result<Material, RunError> {
    let base = data.base.as_deref().map(|name| known(name, place)).transpose()?;
    let refuse = |what: &str| RunError::Solid {
        what: format!("{place}: {what}"),
        hint: "name a `base` from the catalogue, or give the number".into(),
    };
    let density =
        data.density.map(|d| d.0).or(base.map(|b| b.density)).ok_or_else(|| refuse("`density` is missing"))?;
    let constants = data.orthotropic.as_ref().map(|o| {
        let unfit = "`orthotropic`: these constants allow strains that store no energy, or its two directions are one";
        orthotropic(o).ok_or_else(|| refuse(unfit))
    });
    let constants = constants.transpose()?;
    let moduli = constants.map(|c| c.mean()).or_else(|| moduli(data)).or(base.map(|b| b.moduli));
    let moduli = moduli.ok_or_else(|| refuse("two elastic constants are missing"))?;
    let law = match data.law() {
        None => base.map_or(Law::NeoHookean, |b| b.law),
        Some(SolidLaw::Linear) => Law::Linear,
        Some(SolidLaw::SaintVenantKirchhoff) => Law::SaintVenantKirchhoff,
        Some(SolidLaw::NeoHookean) => Law::NeoHookean,
        Some(SolidLaw::Orthotropic) => Law::Orthotropic(constants.ok_or_else(|| refuse("`orthotropic` is missing"))?),
        Some(SolidLaw::Hypoelastic) => Law::Hypoelastic,
        Some(SolidLaw::Plastic) => {
            Law::Plastic(plasticity(data, base.as_ref()).ok_or_else(|| refuse("`yield` is missing"))?)
        }
        Some(SolidLaw::Viscoelastic) => Law::Viscoelastic(relaxation(data, base.as_ref())),
    };
    let mut material = Material::new(density, moduli, law);
    material.thermal = thermal(data, base.as_ref());
    match &material.faults()[..] {
        [] => Ok(material),
        faults => Err(RunError::Solid {
            what: format!("{place}: {}", faults.join("; ")),
            hint: "materials are physical only within these limits".into(),
        }),
    }
}

fn known(name: &str, place: &str) -> Result<Material, RunError> {
    named(name).map(|n| n.material).ok_or_else(|| RunError::Solid {
        what: format!("{place}: there is no material `{name}` in the catalogue"),
        hint: format!("it has {}", LIBRARY.iter().map(|n| format!("`{}`", n.name)).collect::<Vec<_>>().join(", ")),
    })
}

/// Three planes of symmetry.
fn orthotropic(data: &case::Orthotropic) -> Option<Orthotropic> {
    let three = |v: &[f64]| std::array::from_fn(|d| v.get(d).copied().unwrap_or(0.0));
    let moduli = |v: &[case::Pressure]| three(&v.iter().map(|p| p.0).collect::<Vec<_>>());
    let constants = Constants { young: moduli(&data.young), poisson: three(&data.poisson), shear: moduli(&data.shear) };
    let axis = |given: &Option<Vec<f64>>, usual: [f64; 3]| given.as_deref().map_or(usual, three);
    Orthotropic::new(&constants, axis(&data.axis_1, [1.0, 0.0, 0.0]), axis(&data.axis_3, [0.0, 0.0, 1.0]))
}

/// Two of E, ν, G and K say what the others are.
fn moduli(data: &SolidMaterial) -> Option<Moduli> {
    let [young, shear, bulk] = [data.young, data.shear, data.bulk].map(|p| p.map(|p| p.0));
    match (young, data.poisson, shear, bulk) {
        (Some(e), Some(nu), ..) => Some(Moduli::of_young(e, nu)),
        (Some(e), None, Some(g), _) => Some(Moduli { shear: g, bulk: e * g / (3.0 * (3.0 * g - e)) }),
        (Some(e), None, None, Some(k)) => Some(Moduli { shear: 3.0 * k * e / (9.0 * k - e), bulk: k }),
        (None, Some(nu), Some(g), _) => {
            Some(Moduli { shear: g, bulk: 2.0 * g * (1.0 + nu) / (3.0 * (1.0 - 2.0 * nu)) })
        }
        (None, Some(nu), None, Some(k)) => Some(Moduli { shear: 1.5 * k * (1.0 - 2.0 * nu) / (1.0 + nu), bulk: k }),
        (None, None, Some(g), Some(k)) => Some(Moduli { shear: g, bulk: k }),
        _ => None,
    }
}

/// Plasticity by what is given, or that of the base.
fn plasticity(data: &SolidMaterial, base: Option<&Material>) -> Option<Plasticity> {
    let known = base.and_then(|b| match b.law {
        Law::Plastic(p) => Some(p),
        _ => None,
    });
    let mut law = match (&data.johnson_cook, data.yield_stress) {
        (Some(c), _) => Plasticity {
            hardening: Hardening::Power { start: c.a.0, modulus: c.b.0, exponent: c.n },
            kinematic: 0.0,
            rate: Rate::Logarithmic { factor: c.c, reference: c.rate.0 },
            softening: c.melt.map(|melt| Softening { reference: c.room.0, melting: melt.0, exponent: c.m }),
        },
        (None, Some(start)) => Plasticity {
            hardening: Hardening::Voce {
                start: start.0,
                linear: data.hardening.map_or(0.0, |h| h.0),
                saturation: data.saturation.map_or(0.0, |h| h.0),
                exponent: data.saturation_rate.unwrap_or(0.0),
            },
            kinematic: 0.0,
            rate: Rate::Independent,
            softening: None,
        },
        (None, None) => known?,
    };
    law.kinematic = data.kinematic.map_or(law.kinematic, |k| k.0);
    if let Some(p) = &data.perzyna {
        law.rate = Rate::Overstress { viscosity: p.viscosity.0, exponent: p.exponent };
    }
    Some(law)
}

fn relaxation(data: &SolidMaterial, base: Option<&Material>) -> Prony {
    let pairs: Vec<(f64, f64)> = data.relaxation.iter().map(|[g, time]| (*g, *time)).collect();
    match base.map(|b| b.law) {
        Some(Law::Viscoelastic(known)) if pairs.is_empty() => known,
        _ => Prony::new(&pairs),
    }
}

fn thermal(data: &SolidMaterial, base: Option<&Material>) -> Thermal {
    let known = base.map_or(Thermal::ISOTHERMAL, |b| b.thermal);
    Thermal {
        heat_capacity: data.heat_capacity.map_or(known.heat_capacity, |c| c.0),
        heated_fraction: data.heating().unwrap_or(known.heated_fraction),
        start: data.temperature.map_or(known.start, |t| t.0),
    }
}
