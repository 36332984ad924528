//! Bodies made of particles, as data: what `[body.solid]` says of material, particles, supports and loads.
//!
//! Numbers are in SI units. In the plane a body has the thickness that is given, whatever its state across the plane; about the y axis
//! x is the radius.
use serde::{Deserialize, Serialize};

use super::{
    Acceleration, Body, Case, Density, Force, Initial, Length, PerTime, Pressure, SpecificHeat, StructureModel,
    Temperature, Time,
};

/// `[body.solid]`: a body that deforms.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solid {
    /// Material where no region has another one.
    pub material: SolidMaterial,
    /// Distance of particles; one of this and `through` is there.
    pub spacing: Option<Length>,
    /// Particles through the shortest side of the body, both surfaces counted.
    pub through: Option<u32>,
    /// How particles fill the body; absent: a lattice in boxes, relaxed in other shapes.
    pub fill: Option<SolidFill>,
    /// Random displacement of particles as a fraction of the spacing.
    pub jitter: f64,
    /// What holds across the plane.
    pub plane: PlaneState,
    /// Thickness of plane bodies, of which masses, energies and forces are told.
    pub thickness: Length,
    /// Strength of the forces against modes that particles do not see, 0 to 1; absent: 0.3 in the plane, 0.4 in space.
    pub stabilisation: Option<f64>,
    /// Artificial viscosity of shocks, 0 to 1; absent: 0.1 in explicit marches of plastic materials, contact or gas shocks, 0 otherwise.
    pub viscosity: Option<f64>,
    /// Damping in proportion to mass.
    pub damping: PerTime,
    /// Damping in proportion to stiffness.
    pub stiffness_damping: Time,
    /// Velocity at the start, a formula in x, y, z for each axis; empty: at rest.
    pub velocity: Vec<String>,
    /// Acceleration of gravity; empty: none.
    pub gravity: Vec<Acceleration>,
    /// Regions of other materials; the last one that holds a point counts.
    #[serde(default, rename = "region")]
    pub regions: Vec<SolidRegion>,
    /// Where the body is held or led.
    #[serde(default, rename = "support")]
    pub supports: Vec<SolidSupport>,
    /// Loads on the surface.
    #[serde(default, rename = "load")]
    pub loads: Vec<SolidLoad>,
    /// Points whose displacements are recorded.
    #[serde(default, rename = "probe")]
    pub probes: Vec<SolidProbe>,
}

/// How particles fill a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidFill {
    /// On a lattice along the axes of the shape.
    Lattice,
    /// Moved until they are as far from one another and from the surface as they can be.
    Relaxed,
}

/// What holds across the plane of a 2-D body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlaneState {
    /// No strain across the plane.
    #[default]
    Strain,
    /// No stress across the plane.
    Stress,
    /// The y axis is the axis of revolution, x ≥ 0 the radius.
    Axisymmetric,
}

/// A material: that of the catalogue called `base`, with what is given in place of its numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolidMaterial {
    /// Name in the catalogue of materials, which is not known here.
    pub base: Option<String>,
    /// Constitutive law; see [`SolidMaterial::law`].
    pub law: Option<SolidLaw>,
    /// Density.
    pub density: Option<Density>,
    /// Young's modulus E.
    pub young: Option<Pressure>,
    /// Poisson's ratio ν.
    pub poisson: Option<f64>,
    /// Shear modulus G.
    pub shear: Option<Pressure>,
    /// Bulk modulus K.
    pub bulk: Option<Pressure>,
    /// The constants of a material with three planes of symmetry instead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orthotropic: Option<Orthotropic>,
    /// Yield stress.
    #[serde(rename = "yield")]
    pub yield_stress: Option<Pressure>,
    /// Modulus of the linear isotropic hardening.
    pub hardening: Option<Pressure>,
    /// Stress by which the exponential hardening grows in all.
    pub saturation: Option<Pressure>,
    /// Its rate δ in saturation·(1 − exp(−δ ε)).
    pub saturation_rate: Option<f64>,
    /// Modulus of the linear kinematic hardening.
    pub kinematic: Option<Pressure>,
    /// Flow stress of Johnson and Cook (1983).
    pub johnson_cook: Option<JohnsonCook>,
    /// Overstress of Perzyna (1966).
    pub perzyna: Option<Perzyna>,
    /// Heat capacity at constant volume.
    pub heat_capacity: Option<SpecificHeat>,
    /// Part of the plastic work that becomes heat (Taylor and Quinney 1934); absent: 0.9 where the heat capacity is given, else none.
    pub heating: Option<f64>,
    /// Temperature at the start.
    pub temperature: Option<Temperature>,
    /// Prony series: fraction of the shear modulus and time of relaxation in seconds; empty: none.
    pub relaxation: Vec<[f64; 2]>,
}

/// Constitutive law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidLaw {
    /// Small strains.
    Linear,
    /// Linear between Green's strain and the second Piola-Kirchhoff stress.
    SaintVenantKirchhoff,
    /// Compressible neo-Hookean.
    NeoHookean,
    /// As Saint-Venant and Kirchhoff's, with three planes of symmetry.
    Orthotropic,
    /// Rate of the stress in proportion to that of the strain.
    Hypoelastic,
    /// Elastic and plastic strains.
    Plastic,
    /// Stress that relaxes.
    Viscoelastic,
}

/// `orthotropic`: elastic constants by the axes of the material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orthotropic {
    /// E₁, E₂, E₃.
    pub young: Vec<Pressure>,
    /// ν₁₂, ν₁₃, ν₂₃.
    pub poisson: Vec<f64>,
    /// G₁₂, G₁₃, G₂₃.
    pub shear: Vec<Pressure>,
    /// Direction of the first axis; absent: x.
    pub axis_1: Option<Vec<f64>>,
    /// Direction to which the third axis is as near as it can be; absent: z.
    pub axis_3: Option<Vec<f64>>,
}

/// σ = (a + b εⁿ)(1 + c ln(ε̇/rate))(1 − T*ᵐ), T* = (T − room)/(melt − room).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JohnsonCook {
    /// a, the yield stress.
    pub a: Pressure,
    /// b of the hardening.
    pub b: Pressure,
    /// n of the hardening.
    pub n: f64,
    /// c of the rate of strain.
    pub c: f64,
    /// Rate of strain at which a and b were measured.
    pub rate: PerTime,
    /// m of the temperature.
    pub m: f64,
    /// Temperature at which the material melts; absent: the stress does not depend on temperature.
    pub melt: Option<Temperature>,
    /// Temperature at which a and b were measured.
    pub room: Temperature,
}

/// Plastic rate ε̇ = (overstress/yield stress)^exponent / viscosity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Perzyna {
    /// A time.
    pub viscosity: Time,
    /// Exponent.
    pub exponent: f64,
}

/// `[[body.solid.region]]`: another material inside a box.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidRegion {
    /// Where.
    #[serde(rename = "where")]
    pub place: SolidPlace,
    /// Its material.
    pub material: SolidMaterial,
}

/// `[[body.solid.support]]`: where the body is held or led.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidSupport {
    /// Where, of all particles of the body.
    #[serde(rename = "where")]
    pub place: SolidPlace,
    /// Axes along which particles are held; empty: all.
    pub fix: Vec<SolidAxis>,
    /// Displacement along each of those axes, in the same order, a formula in t; empty: none.
    pub motion: Vec<String>,
}

/// An axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidAxis {
    /// x.
    X,
    /// y.
    Y,
    /// z.
    Z,
}

/// `[[body.solid.load]]`: a load on the surface; one of `pressure`, `traction` and `force` is there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidLoad {
    /// Where, of the surface of the body as placed.
    #[serde(rename = "where")]
    pub place: SolidPlace,
    /// Against the outward normal of the deformed surface.
    pub pressure: Option<Pressure>,
    /// Force over the area of the undeformed surface, of fixed direction.
    pub traction: Option<Vec<Pressure>>,
    /// Force on all of the place, spread by area, of fixed direction.
    pub force: Option<Vec<Force>>,
    /// Factor in time, a formula in t; absent: 1.
    pub history: Option<String>,
}

/// `[[body.solid.probe]]`: a point whose displacement is recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidProbe {
    /// Name of its columns.
    pub name: String,
    /// Point of the body as placed.
    pub at: Vec<Length>,
}

/// Part of a body as placed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SolidPlace {
    /// `"all"`.
    All(Everywhere),
    /// What lies inside a box.
    Box(SolidBox),
}

/// The word `all`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Everywhere {
    /// `all`.
    All,
}

/// A box with some of its sides; absent ones are infinitely far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolidBox {
    /// Smallest x.
    pub x_min: Option<Length>,
    /// Largest x.
    pub x_max: Option<Length>,
    /// Smallest y.
    pub y_min: Option<Length>,
    /// Largest y.
    pub y_max: Option<Length>,
    /// Smallest z.
    pub z_min: Option<Length>,
    /// Largest z.
    pub z_max: Option<Length>,
}

/// `[contact]`: bodies made of particles touch one another and planes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Rigid planes.
    #[serde(default)]
    pub planes: Vec<ContactPlane>,
    /// Bodies touch one another.
    pub bodies: bool,
    /// Stiffness over the wave modulus times area over spacing.
    pub stiffness: f64,
    /// Coefficient of Coulomb's friction.
    pub friction: f64,
}

/// A rigid plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPlane {
    /// A point of the plane.
    pub point: Vec<Length>,
    /// Its normal, towards the bodies; its length does not matter.
    pub normal: Vec<f64>,
}

impl SolidMaterial {
    /// Part of the plastic work that becomes heat where nothing else is said (Taylor and Quinney 1934).
    const USUAL_HEATING: f64 = 0.9;

    /// The law: the one given, else plastic where something yields, viscoelastic where something relaxes, else that of the base, `None`,
    /// or neo-Hookean without base.
    pub fn law(&self) -> Option<SolidLaw> {
        if self.law.is_some() {
            return self.law;
        }
        if self.orthotropic.is_some() {
            return Some(SolidLaw::Orthotropic);
        }
        if self.yield_stress.is_some() || self.johnson_cook.is_some() {
            return Some(SolidLaw::Plastic);
        }
        if !self.relaxation.is_empty() {
            return Some(SolidLaw::Viscoelastic);
        }
        self.base.is_none().then_some(SolidLaw::NeoHookean)
    }

    /// Part of the plastic work that becomes heat, `None` without one and without a heat capacity: as the base says.
    pub fn heating(&self) -> Option<f64> {
        self.heating.or(self.heat_capacity.map(|_| Self::USUAL_HEATING))
    }
}

impl SolidPlace {
    /// True for points inside, with `slack` beyond each side.
    pub fn contains(&self, x: &[f64], slack: f64) -> bool {
        let Self::Box(sides) = self else { return true };
        let bounds = sides.bounds();
        x.iter().zip(bounds).all(|(x, [low, high])| low - slack <= *x && *x <= high + slack)
    }
}

impl SolidBox {
    /// Smallest and largest coordinate along each axis.
    pub fn bounds(&self) -> [[f64; 2]; 3] {
        let side = |low: Option<Length>, high: Option<Length>| {
            [low.map_or(f64::NEG_INFINITY, |l| l.0), high.map_or(f64::INFINITY, |l| l.0)]
        };
        [side(self.x_min, self.x_max), side(self.y_min, self.y_max), side(self.z_min, self.z_max)]
    }
}

impl SolidSupport {
    /// Axes along which particles are held in a case of this dimension.
    pub fn axes(&self, dimension: usize) -> Vec<SolidAxis> {
        let all = [SolidAxis::X, SolidAxis::Y, SolidAxis::Z];
        if self.fix.is_empty() { all[..dimension.min(3)].to_vec() } else { self.fix.clone() }
    }
}

impl SolidAxis {
    /// 0 for x.
    pub fn index(self) -> usize {
        self as usize
    }
}

impl Case {
    /// Bodies made of particles that all move, with their numbers: not those of which a few modes do.
    pub fn solids(&self) -> impl Iterator<Item = (usize, &Body, &Solid)> {
        let full = |i: usize| self.structure_of(i).is_none_or(|s| s.model != StructureModel::OwnModes);
        self.bodies_of_particles().filter(move |(i, ..)| full(*i))
    }

    /// All bodies made of particles, with their numbers.
    fn bodies_of_particles(&self) -> impl Iterator<Item = (usize, &Body, &Solid)> {
        self.bodies.iter().enumerate().filter_map(|(i, body)| Some((i, body, body.solid.as_ref()?)))
    }

    /// False for structures alone.
    pub fn has_gas(&self) -> bool {
        let stream = self.flow.mach.is_some() || self.flow.velocity.is_some() || self.polar.is_some();
        stream || self.initial != Initial::FreeStream || self.bodies_of_particles().next().is_none()
    }
}
