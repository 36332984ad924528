//! Deformable solids of particles, as data: material, particles, supports and loads of `[body.solid]`.
//!
//! Values are in SI units. A 2-D body has the given thickness under plane strain and plane stress alike. In an
//! axisymmetric case, y is the axis and x the radius.
use serde::{Deserialize, Serialize};

use super::{
    Acceleration, Body, Case, Density, Force, Initial, Length, PerTime, Pressure, SpecificHeat, StructureModel,
    Temperature, Time,
};

/// The table `[body.solid]`: a deformable body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solid {
    /// Material outside the regions.
    pub material: SolidMaterial,
    /// Distance between particles; either this or `through` is given.
    pub spacing: Option<Length>,
    /// Number of particles across the shortest side of the body, both surfaces included.
    pub through: Option<u32>,
    /// Arrangement of the particles; absent: a lattice in boxes, relaxed in other shapes.
    pub fill: Option<SolidFill>,
    /// Amplitude of the random displacement of particles as a fraction of the spacing.
    pub jitter: f64,
    /// Assumption for the direction normal to the plane.
    pub plane: PlaneState,
    /// Thickness of a 2-D body, for masses, energies and forces.
    pub thickness: Length,
    /// Coefficient of the stabilisation against zero-energy modes, 0 to 1; absent: 0.3 in 2-D, 0.4 in 3-D.
    pub stabilisation: Option<f64>,
    /// Artificial viscosity for shocks, 0 to 1; absent: 0.1 in explicit marches with plastic materials, contact or gas
    /// shocks, otherwise 0.
    pub viscosity: Option<f64>,
    /// Damping proportional to mass.
    pub damping: PerTime,
    /// Damping proportional to stiffness.
    pub stiffness_damping: Time,
    /// Initial velocity, a formula of x, y, z for each axis; empty: at rest.
    pub velocity: Vec<String>,
    /// Acceleration of gravity; empty: zero.
    pub gravity: Vec<Acceleration>,
    /// Regions of other materials; where they overlap, the last one applies.
    #[serde(default, rename = "region")]
    pub regions: Vec<SolidRegion>,
    /// Supports.
    #[serde(default, rename = "support")]
    pub supports: Vec<SolidSupport>,
    /// Loads on the surface.
    #[serde(default, rename = "load")]
    pub loads: Vec<SolidLoad>,
    /// Points whose displacements are recorded.
    #[serde(default, rename = "probe")]
    pub probes: Vec<SolidProbe>,
}

/// Arrangement of the particles in a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidFill {
    /// Lattice along the axes of the shape.
    Lattice,
    /// Relaxed until the particles are evenly spread.
    Relaxed,
}

/// Assumption for the direction normal to the plane of a 2-D body.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum PlaneState {
    /// Plane strain.
    #[default]
    Strain,
    /// Plane stress.
    Stress,
    /// Axial symmetry about the y axis, with the radius x ≥ 0.
    Axisymmetric,
}

/// A material: the one named `base` in the catalogue, with the given values in place of its own.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SolidMaterial {
    /// Name in the catalogue of materials; this crate does not know the catalogue.
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
    /// Constants of an orthotropic material, an alternative to the isotropic moduli.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orthotropic: Option<Orthotropic>,
    /// Yield stress.
    #[serde(rename = "yield")]
    pub yield_stress: Option<Pressure>,
    /// Modulus of linear isotropic hardening.
    pub hardening: Option<Pressure>,
    /// Total increase of the yield stress by exponential hardening.
    pub saturation: Option<Pressure>,
    /// Rate δ of exponential hardening, saturation·(1 − exp(−δ ε)).
    pub saturation_rate: Option<f64>,
    /// Modulus of linear kinematic hardening.
    pub kinematic: Option<Pressure>,
    /// Johnson-Cook flow stress (1983).
    pub johnson_cook: Option<JohnsonCook>,
    /// Perzyna viscoplasticity (1966).
    pub perzyna: Option<Perzyna>,
    /// Specific heat capacity at constant volume.
    pub heat_capacity: Option<SpecificHeat>,
    /// Fraction of the plastic work that is converted to heat (Taylor and Quinney 1934); absent: 0.9 where the heat
    /// capacity is given.
    pub heating: Option<f64>,
    /// Initial temperature.
    pub temperature: Option<Temperature>,
    /// Prony series: pairs of a fraction of the shear modulus and a relaxation time in seconds; empty: no relaxation.
    pub relaxation: Vec<[f64; 2]>,
}

/// Constitutive law.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum SolidLaw {
    /// Linear elasticity at small strains.
    Linear,
    /// Saint-Venant-Kirchhoff: linear relation between the Green-Lagrange strain and the second Piola-Kirchhoff stress.
    SaintVenantKirchhoff,
    /// Compressible neo-Hookean.
    NeoHookean,
    /// Orthotropic Saint-Venant-Kirchhoff material.
    Orthotropic,
    /// Hypoelastic: stress rate proportional to the strain rate.
    Hypoelastic,
    /// Elastoplastic.
    Plastic,
    /// Viscoelastic.
    Viscoelastic,
}

/// The table `orthotropic`: elastic constants along the axes of the material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Orthotropic {
    /// E₁, E₂, E₃.
    pub young: Vec<Pressure>,
    /// ν₁₂, ν₁₃, ν₂₃.
    pub poisson: Vec<f64>,
    /// G₁₂, G₁₃, G₂₃.
    pub shear: Vec<Pressure>,
    /// Direction of the first material axis; absent: x.
    pub axis_1: Option<Vec<f64>>,
    /// Direction to which the third material axis is as close as possible; absent: z.
    pub axis_3: Option<Vec<f64>>,
}

/// Johnson-Cook flow stress σ = (a + b εⁿ)(1 + c ln(ε̇/rate))(1 − T*ᵐ), T* = (T − room)/(melt − room).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct JohnsonCook {
    /// Yield stress a.
    pub a: Pressure,
    /// Hardening modulus b.
    pub b: Pressure,
    /// Hardening exponent n.
    pub n: f64,
    /// Strain-rate coefficient c.
    pub c: f64,
    /// Reference strain rate, at which a and b were measured.
    pub rate: PerTime,
    /// Temperature exponent m.
    pub m: f64,
    /// Melting temperature; absent: the stress does not depend on temperature.
    pub melt: Option<Temperature>,
    /// Reference temperature, at which a and b were measured.
    pub room: Temperature,
}

/// Perzyna viscoplasticity: plastic strain rate ε̇ = (overstress/yield stress)^exponent / viscosity.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Perzyna {
    /// Viscosity parameter, a time.
    pub viscosity: Time,
    /// Exponent.
    pub exponent: f64,
}

/// The table `[[body.solid.region]]`: another material in a part of the body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidRegion {
    /// Extent of the region.
    #[serde(rename = "where")]
    pub place: SolidPlace,
    /// Material of the region.
    pub material: SolidMaterial,
}

/// The table `[[body.solid.support]]`: particles with a prescribed displacement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidSupport {
    /// Extent of the support, among all particles of the body.
    #[serde(rename = "where")]
    pub place: SolidPlace,
    /// Axes along which the displacement is prescribed; empty: all axes.
    pub fix: Vec<SolidAxis>,
    /// Displacement along each of these axes as a formula of t, in the same order; empty: zero.
    pub motion: Vec<String>,
}

/// A coordinate axis.
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

/// The table `[[body.solid.load]]`: a load on the surface, given by one of `pressure`, `traction` and `force`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidLoad {
    /// Extent of the load on the surface of the body in its initial placement.
    #[serde(rename = "where")]
    pub place: SolidPlace,
    /// Pressure, opposite to the outward normal of the deformed surface.
    pub pressure: Option<Pressure>,
    /// Force per undeformed area, with a fixed direction.
    pub traction: Option<Vec<Pressure>>,
    /// Total force, distributed in proportion to area, with a fixed direction.
    pub force: Option<Vec<Force>>,
    /// Load factor as a formula of t; absent: 1.
    pub history: Option<String>,
}

/// The table `[[body.solid.probe]]`: a point whose displacement is recorded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SolidProbe {
    /// Name of the columns in the output.
    pub name: String,
    /// Point of the body in its initial placement.
    pub at: Vec<Length>,
}

/// A part of a body in its initial placement.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum SolidPlace {
    /// `"all"`.
    All(Everywhere),
    /// The part inside a box.
    Box(SolidBox),
}

/// The word `all`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Everywhere {
    /// `all`.
    All,
}

/// A box with some of its sides; absent sides are at infinity.
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

/// The table `[contact]`: contact of deformable solids with one another and with rigid planes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contact {
    /// Rigid planes.
    #[serde(default)]
    pub planes: Vec<ContactPlane>,
    /// True when the bodies can touch one another.
    pub bodies: bool,
    /// Penalty factor: contact stiffness relative to the P-wave modulus times area divided by spacing.
    pub stiffness: f64,
    /// Coefficient of Coulomb friction.
    pub friction: f64,
}

/// A rigid plane.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPlane {
    /// A point of the plane.
    pub point: Vec<Length>,
    /// Normal of the plane, directed towards the bodies; its length is ignored.
    pub normal: Vec<f64>,
}

impl SolidMaterial {
    /// Default fraction of the plastic work that is converted to heat (Taylor and Quinney 1934).
    const USUAL_HEATING: f64 = 0.9;

    /// The constitutive law: the given one; otherwise plastic when a yield stress is given, viscoelastic when a
    /// relaxation is given, that of the base (`None`), or neo-Hookean without a base.
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

    /// Fraction of the plastic work that is converted to heat; `None` when neither this nor the heat capacity is given,
    /// so that the base decides.
    pub fn heating(&self) -> Option<f64> {
        self.heating.or(self.heat_capacity.map(|_| Self::USUAL_HEATING))
    }
}

impl SolidPlace {
    /// True for points inside the part, or at most `slack` outside each side.
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
    /// Axes along which the displacement is prescribed in a case of this dimension.
    pub fn axes(&self, dimension: usize) -> Vec<SolidAxis> {
        let all = [SolidAxis::X, SolidAxis::Y, SolidAxis::Z];
        if self.fix.is_empty() { all[..dimension.min(3)].to_vec() } else { self.fix.clone() }
    }
}

impl SolidAxis {
    /// Index of the axis, 0 for x.
    pub fn index(self) -> usize {
        self as usize
    }
}

impl Case {
    /// Solids whose particles are all unknowns, with their body numbers; solids reduced to a few modes are excluded.
    pub fn solids(&self) -> impl Iterator<Item = (usize, &Body, &Solid)> {
        let full = |i: usize| self.structure_of(i).is_none_or(|s| s.model != StructureModel::OwnModes);
        self.bodies_of_particles().filter(move |(i, ..)| full(*i))
    }

    /// All solids of particles, with their body numbers.
    pub fn bodies_of_particles(&self) -> impl Iterator<Item = (usize, &Body, &Solid)> {
        self.bodies.iter().enumerate().filter_map(|(i, body)| Some((i, body, body.solid.as_ref()?)))
    }

    /// False for a purely structural case.
    pub fn has_gas(&self) -> bool {
        let stream = self.flow.mach.is_some() || self.flow.velocity.is_some() || self.polar.is_some();
        stream || self.initial != Initial::FreeStream || self.bodies_of_particles().next().is_none()
    }
}
