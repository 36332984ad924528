//! Catalogue of materials.
//!
//! Values are in SI units. Each entry names the publication of its values; where a source gives a range, the value lies
//! within it. The Johnson-Cook metals have the room temperature as T_r and soften adiabatically, with 0.9 of their
//! plastic work converted to heat (Taylor and Quinney 1934).
use super::elastic::Moduli;
use super::flow::{JohnsonCook, Plasticity, Softening};
use super::{Law, Material, ROOM_TEMPERATURE, Thermal};

/// An entry of the catalogue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Named {
    /// Name of the material.
    pub name: &'static str,
    /// Alternative names.
    pub aliases: &'static [&'static str],
    /// The material.
    pub material: Material,
    /// Source of the values.
    pub source: &'static str,
}

/// The material with this name or alias; upper case, spaces, hyphens and underscores are ignored.
pub fn named(name: &str) -> Option<&'static Named> {
    let plain = |s: &str| s.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    let wanted = plain(name);
    LIBRARY.iter().find(|m| std::iter::once(&m.name).chain(m.aliases).any(|n| plain(n) == wanted))
}

/// Fraction of the plastic work that is converted to heat in metals (Taylor and Quinney 1934).
const HEATED_FRACTION: f64 = 0.9;
/// One megapascal, in Pa.
const MPA: f64 = 1e6;
/// One gigapascal, in Pa.
const GPA: f64 = 1e9;
/// One million pounds per square inch, in Pa.
const MSI: f64 = 6.894_757_293e9;
/// One pound per cubic inch, in kg/m³.
const POUND_PER_CUBIC_INCH: f64 = 27_679.904_7;

/// A metal with the given density, Young's modulus, Poisson's ratio and heat capacity.
const fn metal(density: f64, young: f64, poisson: f64, heat_capacity: f64, law: Law) -> Material {
    Material {
        density,
        moduli: Moduli::of_young(young, poisson),
        law,
        thermal: Thermal { heat_capacity, heated_fraction: HEATED_FRACTION, start: ROOM_TEMPERATURE },
        elastic_limit: None,
    }
}

/// A Johnson-Cook law: A and B in MPa, n, C and m at the reference rate 1/s, and the melting temperature in K.
const fn johnson_cook([a, b, n, c, m]: [f64; 5], melting: f64) -> Law {
    Law::Plastic(Plasticity::johnson_cook(JohnsonCook {
        start: a * MPA,
        modulus: b * MPA,
        exponent: n,
        rate_factor: c,
        rate: 1.0,
        softening: Softening { reference: ROOM_TEMPERATURE, melting, exponent: m },
    }))
}

/// An elastic material with the given density, Young's modulus and Poisson's ratio.
const fn elastic(density: f64, young: f64, poisson: f64, law: Law) -> Material {
    Material::new(density, Moduli::of_young(young, poisson), law)
}

const fn entry(
    name: &'static str,
    aliases: &'static [&'static str],
    material: Material,
    source: &'static str,
) -> Named {
    Named { name, aliases, material, source }
}

const JOHNSON_COOK_1983: &str = "flow: Johnson & Cook (1983), 7th Int. Symp. on Ballistics, table 1; elasticity: Johnson & \
                                 Cook (1985), Eng. Fract. Mech. 21";
const JOHNSON_COOK_AND_HANDBOOK: &str = "flow, density, heat: Johnson & Cook (1983), 7th Int. Symp. on Ballistics, table 1; \
                                         elasticity: MIL-HDBK-5J (2003), chapters 2 and 3";
const LESUER_AND_HANDBOOK: &str =
    "flow: Lesuer (2000), DOT/FAA/AR-00/25; elasticity, density, heat: MIL-HDBK-5J (2003)";

/// All materials of the catalogue.
pub static LIBRARY: [Named; 16] = [
    entry(
        "aluminium 2024-T3",
        &["aluminum 2024-T3", "2024-T3"],
        metal(
            0.100 * POUND_PER_CUBIC_INCH,
            10.5 * MSI,
            0.33,
            875.0,
            johnson_cook([369.0, 684.0, 0.73, 0.0083, 1.7], 775.0),
        ),
        LESUER_AND_HANDBOOK,
    ),
    entry(
        "aluminium 2024-T351",
        &["aluminum 2024-T351", "2024-T351"],
        metal(2770.0, 10.7 * MSI, 0.33, 875.0, johnson_cook([265.0, 426.0, 0.34, 0.015, 1.0], 775.0)),
        JOHNSON_COOK_AND_HANDBOOK,
    ),
    entry(
        "aluminium 6061-T6",
        &["aluminum 6061-T6", "6061-T6"],
        metal(
            0.098 * POUND_PER_CUBIC_INCH,
            9.9 * MSI,
            0.33,
            896.0,
            johnson_cook([324.0, 114.0, 0.42, 0.002, 1.34], 925.0),
        ),
        "flow: Lesuer, Kay & LeBlanc (2001), UCRL-JC-134118; elasticity, density: MIL-HDBK-5J (2003), table 3.6.2",
    ),
    entry(
        "aluminium 7039",
        &["aluminum 7039", "7039"],
        metal(2770.0, 10.0 * MSI, 0.33, 875.0, johnson_cook([337.0, 343.0, 0.41, 0.010, 1.0], 877.0)),
        "flow, density, heat: Johnson & Cook (1983), 7th Int. Symp. on Ballistics, table 1; elasticity: about that of \
         all aluminium alloys",
    ),
    entry(
        "aluminium 7075-T6",
        &["aluminum 7075-T6", "7075-T6"],
        metal(0.101 * POUND_PER_CUBIC_INCH, 10.3 * MSI, 0.33, 960.0, Law::NeoHookean),
        "elasticity, density: MIL-HDBK-5J (2003), table 3.7.6 (sheet); elastic only",
    ),
    entry(
        "steel 4340",
        &["4340"],
        metal(7830.0, 29.0 * MSI, 0.32, 477.0, johnson_cook([792.0, 510.0, 0.26, 0.014, 1.03], 1793.0)),
        JOHNSON_COOK_AND_HANDBOOK,
    ),
    entry(
        "steel 4130",
        &["4130"],
        metal(0.283 * POUND_PER_CUBIC_INCH, 29.0 * MSI, 0.32, 477.0, Law::NeoHookean),
        "elasticity, density: MIL-HDBK-5J (2003), table 2.3.1; elastic only",
    ),
    entry(
        "steel 1006",
        &["1006"],
        metal(7890.0, 207.0 * GPA, 0.29, 452.0, johnson_cook([350.0, 275.0, 0.36, 0.022, 1.0], 1811.0)),
        "flow, density, heat: Johnson & Cook (1983), 7th Int. Symp. on Ballistics, table 1; elasticity: that of Armco iron",
    ),
    entry(
        "iron armco",
        &["armco"],
        metal(7890.0, 207.0 * GPA, 0.29, 452.0, johnson_cook([175.0, 380.0, 0.32, 0.060, 0.55], 1811.0)),
        JOHNSON_COOK_1983,
    ),
    entry(
        "copper ofhc",
        &["ofhc", "copper"],
        metal(8960.0, 124.0 * GPA, 0.34, 383.0, johnson_cook([90.0, 292.0, 0.31, 0.025, 1.09], 1356.0)),
        JOHNSON_COOK_1983,
    ),
    entry(
        "titanium Ti-6Al-4V",
        &["Ti-6Al-4V", "Ti64"],
        metal(
            0.160 * POUND_PER_CUBIC_INCH,
            16.0 * MSI,
            0.31,
            565.0,
            johnson_cook([1098.0, 1092.0, 0.93, 0.014, 1.1], 1878.0),
        ),
        LESUER_AND_HANDBOOK,
    ),
    entry(
        "carbon-epoxy quasi-isotropic",
        &["cfrp quasi-isotropic", "cfrp", "T300/5208 quasi-isotropic"],
        elastic(1600.0, 69.7 * GPA, 0.296, Law::SaintVenantKirchhoff),
        "moduli in the plane of a quasi-isotropic laminate of T300/5208 (181, 10.3, 7.17 GPa, 0.28): Tsai & Hahn (1980), \
         Introduction to Composite Materials; across the plane a laminate is far softer",
    ),
    entry(
        "mahogany AGARD 445.6",
        &["mahogany"],
        elastic(381.98, 3.151 * GPA, 0.31, Law::SaintVenantKirchhoff),
        "along the grain of the weakened wing 445.6, model 3: Yates (1987), NASA TM-100492, with the orthotropic constants \
         3.151, 0.416, 0.4392 GPa of later studies; an isotropic stand-in, too stiff across the grain and in torsion",
    ),
    entry(
        "pmma",
        &["acrylic", "plexiglas", "perspex"],
        elastic(1190.0, 3.0 * GPA, 0.39, Law::NeoHookean),
        "within the ranges of Ashby (2011), Materials Selection in Mechanical Design, appendix A: 1160-1220 kg/m3, \
         2.24-3.8 GPa",
    ),
    entry(
        "epoxy",
        &["epoxy resin"],
        elastic(1200.0, 2.8 * GPA, 0.39, Law::NeoHookean),
        "within the ranges of Ashby (2011), Materials Selection in Mechanical Design, appendix A: 1110-1400 kg/m3, \
         2.35-3.08 GPa",
    ),
    entry(
        "rubber natural",
        &["rubber", "natural rubber"],
        Material::new(930.0, Moduli { shear: 0.39 * MPA, bulk: 1.95 * GPA }, Law::NeoHookean),
        "shear modulus: Treloar (1944), Trans. Faraday Soc. 40; bulk modulus: Wood & Martin (1964), J. Res. NBS 68A; \
         good up to a stretch of about 1.5",
    ),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_is_sound_and_found_by_all_of_its_names() {
        for m in &LIBRARY {
            assert!(m.material.faults().is_empty(), "{}: {:?}", m.name, m.material.faults());
            assert!(!m.source.is_empty());
            for name in std::iter::once(&m.name).chain(m.aliases) {
                assert_eq!(named(name).map(|f| f.name), Some(m.name), "{name}");
            }
        }
        assert!(named("unobtainium").is_none());
        assert_eq!(named("Aluminum_2024 t3").map(|m| m.name), Some("aluminium 2024-T3"));
    }

    #[test]
    fn waves_run_as_fast_as_tables_say() {
        // pure metals, CRC Handbook of Chemistry and Physics; their alloys differ by a few per cent
        for (name, speed) in [("6061-T6", 6420.0), ("armco", 5950.0), ("ofhc", 4760.0), ("Ti64", 6070.0)] {
            let found = named(name).map_or(0.0, |m| m.material.pressure_wave_speed());
            assert!((found / speed - 1.0).abs() < 0.06, "{name}: {found}");
        }
    }
}
