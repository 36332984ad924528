//! Deformable solids of particles, as data: material, particles, supports and loads of `[body.solid]`.
//!
//! Values are in SI units. A 2-D body has the given thickness under plane strain and plane stress alike. In an
//! axisymmetric case, y is the axis and x the radius.
use serde::{Deserialize, Serialize};

use super::initial::Initial;
use super::kinds::{LENGTH, POINT, SIZE};
use super::quantity::{Acceleration, Density, Force, Length, PerTime, Pressure, SpecificHeat, Temperature, Time};
use super::schema::{Absent, Kind, List, Range, defaulted, keys, optional, required, words};
use super::structure::StructureModel;
use super::{Body, Case};

const ANY: Kind = Kind::Number(Range::ANY);
const PART: Kind = Kind::Number(Range::between(0.0, 1.0));
/// What no solid is beyond, in SI units, or those of a nondimensional stream: numbers that are larger, or smaller, are slips of a unit or
/// of an exponent, and what is computed of them is round-off.
const STRESSES: f64 = 1e18;
const MODULUS: Kind = Kind::Quantity(Pressure::DIMENSION, Range::between(1e-9, STRESSES));
const STRESS: Kind = Kind::Quantity(Pressure::DIMENSION, Range::between(0.0, STRESSES));
const STRESS_OF_ANY_SIGN: Kind = Kind::Quantity(Pressure::DIMENSION, Range::between(-STRESSES, STRESSES));
const DENSITY: Kind = Kind::Quantity(Density::DIMENSION, Range::between(1e-9, 1e9));
const KELVIN: Kind = Kind::Quantity(Temperature::DIMENSION, Range { min: 0.0, max: 1e6, closed: false });
const NUMBER: Kind = Kind::Number(Range::between(0.0, 1e6));
const THICKNESS: Kind = Kind::Quantity(Length::DIMENSION, Range::between(1e-9, 1e6));
const ACCELERATION: Kind = Kind::Quantity(Acceleration::DIMENSION, Range::between(-1e6, 1e6));
const HEAT_CAPACITY: Kind = Kind::Quantity(SpecificHeat::DIMENSION, Range { min: 0.0, max: 1e9, closed: false });
const OF_RELAXATION: Kind = Kind::Number(Range::between(1e-15, 1e12));
const STRAIN_RATE: Kind = Kind::Quantity(PerTime::DIMENSION, Range::between(1e-12, 1e12));
const OVERSTRESS_TIME: Kind = Kind::Quantity(Time::DIMENSION, Range::between(1e-15, 1e12));
const FORCE: Kind = Kind::Quantity(Force::DIMENSION, Range::between(-1e18, 1e18));
const FORMULAS: Kind = Kind::List(&List { item: Kind::Formula, min: 0, max: 3, single: false });
const PLACE: Kind = Kind::TableOr(&PLACE_KEYS, "all");
/// No more than a lattice bears before particles meet.
const MOST_JITTER: f64 = 0.4;
const FROM_BASE: &str = "that of `base`";
const TWO: &str = "that of `base`, or from two others";

const THREE_MODULI: Kind = Kind::List(&List { item: MODULUS, min: 3, max: 3, single: false });
const THREE: Kind = Kind::List(&List { item: ANY, min: 3, max: 3, single: false });

const ONE_LOAD: &str = "another of `pressure`, `traction` and `force`";

keys! {
    /// The table `[body.solid]`: a deformable body.
    pub struct Solid, SOLID {
        /// Material where no region has another one: a name of the catalogue, `material = "aluminium 2024-T3"`, or its
        /// numbers.
        material: SolidMaterial = required(Kind::Table(&MATERIAL)),
        /// Distance of particles.
        spacing: Option<Length> = optional(SIZE, "from `through`"),
        /// Number of particles through the shortest side of the body instead, both surfaces counted.
        through: Option<u32> = optional(Kind::Integer(2, 100_000), "9, or from `spacing`"),
        /// How particles fill the body.
        fill: Option<SolidFill> = optional(Kind::Words(FILLS), "`\"lattice\"` in boxes, `\"relaxed\"` in others"),
        /// Random displacement of particles inside as a fraction of the spacing (for tests of robustness).
        jitter: f64 = defaulted(Kind::Number(Range::between(0.0, MOST_JITTER)), Absent::Number(0.0)),
        /// What holds across the plane (2-D).
        plane: PlaneState = defaulted(Kind::Words(PLANES), Absent::Word("strain")),
        /// Thickness of bodies in the plane: masses, energies and forces are those of so much of them; not beside a
        /// gas, which acts on one unit of length.
        thickness: Length = defaulted(THICKNESS, Absent::Number(1.0)),
        /// Strength of the forces against zigzag modes, whose strains particles do not see: as a part of the modulus of
        /// the material.
        stabilisation: Option<f64> = optional(PART, "0.3 in the plane, 0.4 in space"),
        /// Artificial viscosity that holds shocks.
        viscosity: Option<f64> = optional(
            PART, "0.1 in explicit marches of plastic materials, with contact or with a gas; 0 otherwise",
        ),
        /// Damping α in proportion to mass, force −α m v.
        damping: PerTime = defaulted(
            Kind::Quantity(PerTime::DIMENSION, Range::between(0.0, 1e12)), Absent::Number(0.0),
        ),
        /// Damping β in proportion to stiffness: second Piola-Kirchhoff stress β C₀ : Ė, damping ratio βω/2 of small
        /// vibration.
        stiffness_damping: Time = defaulted(
            Kind::Quantity(Time::DIMENSION, Range::between(0.0, 1e6)), Absent::Number(0.0),
        ),
        /// Velocity at the start, a number or a formula in `x`, `y`, `z` of the body as placed for each axis: `[0, "2 *
        /// x^2"]`.
        velocity: Vec<String> = defaulted(FORMULAS, Absent::Filled),
        /// Acceleration of gravity, `[0, "-9.81 m/s2"]`.
        gravity: Vec<Acceleration> = defaulted(
            Kind::List(&List { item: ACCELERATION, min: 0, max: 3, single: false }), Absent::Filled,
        ),
        /// Another material inside a box; of several the last one counts.
        #[serde(default)]
        regions as "region": Vec<SolidRegion> = defaulted(Kind::Tables(&REGION), Absent::Filled),
        /// Where particles of the body are held, or led along a given path.
        #[serde(default)]
        supports as "support": Vec<SolidSupport> = defaulted(Kind::Tables(&SUPPORT), Absent::Filled),
        /// A load on the surface; several add up.
        #[serde(default)]
        loads as "load": Vec<SolidLoad> = defaulted(Kind::Tables(&LOAD), Absent::Filled),
        /// A point whose displacement is recorded.
        #[serde(default)]
        probes as "probe": Vec<SolidProbe> = defaulted(Kind::Tables(&PROBE), Absent::Filled),
    }
}

words! {
    /// Arrangement of the particles in a body.
    pub enum SolidFill, FILLS {
        /// on a lattice along the axes of the shape
        Lattice = "lattice",
        /// moved until their distances are even and the outer ones lie on the surface
        Relaxed = "relaxed",
    }

    /// Assumption for the direction normal to the plane of a 2-D body.
    pub enum PlaneState, PLANES = Strain {
        /// no strain across the plane
        Strain = "strain",
        /// no stress across the plane
        Stress = "stress",
        /// the y axis is the axis of revolution, x is the radius and not negative
        Axisymmetric = "axisymmetric",
    }
}

keys! {
    /// A material: the one named `base` in the catalogue, with the given values in place of its own.
    #[derive(Default)]
    pub struct SolidMaterial, MATERIAL.short("base") {
        /// Name in the catalogue of materials; what is given beside it replaces its numbers.
        base: Option<String> = optional(Kind::Text, "all numbers must be given"),
        /// Constitutive law.
        law: Option<SolidLaw> = optional(
            Kind::Words(LAWS),
            "`\"orthotropic\"` with `orthotropic`, `\"plastic\"` with `yield` or `johnson_cook`, `\"viscoelastic\"` \
             with `relaxation`, else that of `base`, else `\"neo_hookean\"`",
        ),
        /// Density.
        density: Option<Density> = optional(DENSITY, FROM_BASE),
        /// Young's modulus E; two of `young`, `poisson`, `shear` and `bulk` are given.
        young: Option<Pressure> = optional(MODULUS, TWO).known_as(&["e", "youngs_modulus", "elasticity"]),
        /// Poisson's ratio ν, less than 0.5.
        poisson: Option<f64> = optional(
            Kind::Number(Range { min: -1.0, max: 0.5, closed: false }), TWO,
        ).known_as(&["nu", "poissons_ratio"]),
        /// Shear modulus G.
        shear: Option<Pressure> = optional(MODULUS, TWO).known_as(&["g", "mu", "shear_modulus"]),
        /// Bulk modulus K.
        bulk: Option<Pressure> = optional(MODULUS, TWO).known_as(&["k", "bulk_modulus"]),
        /// Constants of a material with three planes of symmetry, wood or a laminate, in place of the moduli above.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        orthotropic: Option<Orthotropic> = optional(Kind::Table(&ORTHOTROPIC), "one modulus for all directions"),
        /// Yield stress.
        yield_stress as "yield": Option<Pressure> = optional(
            MODULUS, "that of `base`, or from `johnson_cook`",
        ).known_as(&["yield_stress", "yield_strength"]),
        /// Modulus of the linear isotropic hardening.
        hardening: Option<Pressure> = optional(STRESS, "that of `base`, or none"),
        /// Stress Q of the exponential hardening Q (1 − exp(−δ ε)).
        saturation: Option<Pressure> = optional(STRESS, "that of `base`, or none"),
        /// Its rate δ.
        saturation_rate: Option<f64> = optional(NUMBER, "that of `base`, or none"),
        /// Modulus of the linear kinematic hardening.
        kinematic: Option<Pressure> = optional(STRESS, "that of `base`, or none"),
        /// Yield stress (a + b εⁿ)(1 + c ln(ε̇/rate))(1 − T*ᵐ) of Johnson and Cook instead, T* = (T − room)/(melt −
        /// room).
        johnson_cook: Option<JohnsonCook> = optional(Kind::Table(&JOHNSON_COOK), "that of `base`, or from `yield`"),
        /// Plastic strain by overstress, at the rate (overstress over yield stress)^exponent/viscosity.
        perzyna: Option<Perzyna> = optional(
            Kind::Table(&PERZYNA), "that of `base`, or none: stresses do not exceed the yield stress",
        ),
        /// Heat capacity of a unit of mass.
        heat_capacity: Option<SpecificHeat> = optional(HEAT_CAPACITY, "that of `base`, or plastic work heats nothing"),
        /// Part of the plastic work that becomes heat.
        heating: Option<f64> = optional(PART, "0.9 where the heat capacity is known"),
        /// Temperature at the start.
        temperature: Option<Temperature> = optional(KELVIN, "`room` of `johnson_cook`"),
        /// Prony series of the shear modulus, `[[0.3, 0.01], [0.2, 1]]`: part of the modulus and its time of relaxation
        /// in seconds. The moduli above are those of fast loads.
        relaxation: Vec<[f64; 2]> = defaulted(
            Kind::List(&List { item: Kind::List(&List { item: OF_RELAXATION, min: 2, max: 2, single: false }), min: 0, max: 32, single: false }),
            Absent::Filled,
        ),
    }
}

words! {
    /// Constitutive law.
    pub enum SolidLaw, LAWS {
        /// small strains
        Linear = "linear",
        /// large rotations, strains that stay small
        SaintVenantKirchhoff = "saint_venant_kirchhoff",
        /// large strains
        NeoHookean = "neo_hookean",
        /// large rotations, small strains, other constants along each of three axes
        Orthotropic = "orthotropic",
        /// rate of the stress by the rate of strain, in a frame that turns with the material
        Hypoelastic = "hypoelastic",
        /// large strains, of which a part stays: metals
        Plastic = "plastic",
        /// large strains whose stress relaxes: rubber, polymers
        Viscoelastic = "viscoelastic",
    }
}

keys! {
    /// The table `orthotropic`: elastic constants along the axes of the material.
    pub struct Orthotropic, ORTHOTROPIC {
        /// Young's moduli along the axes of the material, `[E1, E2, E3]`.
        young: Vec<Pressure> = required(THREE_MODULI),
        /// Poisson's ratios `[nu12, nu13, nu23]`: contraction along the second number when pulled along the first.
        poisson: Vec<f64> = required(THREE),
        /// Shear moduli `[G12, G13, G23]`.
        shear: Vec<Pressure> = required(THREE_MODULI),
        /// Direction of the first axis, the grain or the fibres, of the body as placed.
        axis_1: Option<Vec<f64>> = optional(THREE, "x"),
        /// Direction to which the third axis is as near as it can be, across the plies.
        axis_3: Option<Vec<f64>> = optional(THREE, "z"),
    }

    /// Johnson-Cook flow stress σ = (a + b εⁿ)(1 + c ln(ε̇/rate))(1 − T*ᵐ), T* = (T − room)/(melt − room).
    #[derive(Copy)]
    pub struct JohnsonCook, JOHNSON_COOK {
        /// Yield stress.
        a: Pressure = required(MODULUS),
        /// Stress of the hardening.
        b: Pressure = required(STRESS),
        /// Exponent of the hardening.
        n: f64 = required(NUMBER),
        /// Factor of the rate of strain.
        c: f64 = defaulted(NUMBER, Absent::Number(0.0)),
        /// Rate of strain at which the others were measured.
        rate: PerTime = defaulted(STRAIN_RATE, Absent::Number(1.0)),
        /// Exponent of the temperature.
        m: f64 = defaulted(NUMBER, Absent::Number(1.0)),
        /// Temperature at which the material melts.
        melt: Option<Temperature> = optional(KELVIN, "no dependence on temperature"),
        /// Temperature at which the others were measured.
        room: Temperature = defaulted(KELVIN, Absent::Number(293.0)),
    }

    /// Perzyna viscoplasticity: plastic strain rate ε̇ = (overstress/yield stress)^exponent / viscosity.
    #[derive(Copy)]
    pub struct Perzyna, PERZYNA {
        /// A time.
        viscosity: Time = required(OVERSTRESS_TIME),
        /// Exponent.
        exponent: f64 = defaulted(Kind::Number(Range::between(1e-3, 1e3)), Absent::Number(1.0)),
    }

    /// The table `[[body.solid.region]]`: another material in a part of the body.
    pub struct SolidRegion, REGION {
        /// What lies inside a box, `{ x_max = 0.1 }`, of the body as placed.
        place as "where": SolidPlace = required(PLACE),
        /// Material of the region.
        material: SolidMaterial = required(Kind::Table(&MATERIAL)),
    }

    /// The table `[[body.solid.support]]`: particles with a prescribed displacement.
    pub struct SolidSupport, SUPPORT {
        /// Particles inside a box, `{ x_max = "1 mm" }`, of the body as placed; `"all"` of them.
        place as "where": SolidPlace = required(PLACE),
        /// Axes along which they are held; none named: all.
        fix: Vec<SolidAxis> = defaulted(
            Kind::List(&List { item: Kind::Words(AXES), min: 0, max: 3, single: true }), Absent::Filled,
        ),
        /// Displacement along each of these axes in the same order, a number or a formula in `t`; none: zero.
        motion: Vec<String> = defaulted(
            Kind::List(&List { item: Kind::Formula, min: 0, max: 3, single: true }), Absent::Filled,
        ),
    }
}

words! {
    /// A coordinate axis.
    pub enum SolidAxis, AXES {
        /// along x
        X = "x",
        /// along y
        Y = "y",
        /// along z
        Z = "z",
    }
}

keys! {
    /// The table `[[body.solid.load]]`: a load on the surface, given by one of `pressure`, `traction` and `force`.
    pub struct SolidLoad, LOAD {
        /// The part of the surface inside a box, `{ y_min = 0.02 }`, of the body as placed; `"all"` of it.
        place as "where": SolidPlace = required(PLACE),
        /// Pressure, against the outward normal; it follows the surface as that deforms.
        pressure: Option<Pressure> = optional(STRESS_OF_ANY_SIGN, ONE_LOAD),
        /// Force over the area before any deformation, of fixed direction.
        traction: Option<Vec<Pressure>> = optional(
            Kind::List(&List { item: STRESS_OF_ANY_SIGN, min: 2, max: 3, single: false }), ONE_LOAD,
        ),
        /// Force on the whole place, spread evenly over its area, of fixed direction.
        force: Option<Vec<Force>> = optional(
            Kind::List(&List { item: FORCE, min: 2, max: 3, single: false }), ONE_LOAD,
        ),
        /// Factor in time, a formula in `t`: `"min(t/0.01, 1)"`; with `omega` in a harmonic balance.
        history: Option<String> = optional(Kind::Formula, "1"),
    }

    /// The table `[[body.solid.probe]]`: a point whose displacement is recorded.
    pub struct SolidProbe, PROBE {
        /// Name of its columns.
        name: String = required(Kind::Text),
        /// The point, of the body as placed.
        at: Vec<Length> = required(POINT),
    }
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

keys! {
    /// A box with some of its sides; absent sides are at infinity.
    #[derive(Copy, Default)]
    pub struct SolidBox, PLACE_KEYS {
        /// Smallest x.
        x_min: Option<Length> = optional(LENGTH, "no bound"),
        /// Largest x.
        x_max: Option<Length> = optional(LENGTH, "no bound"),
        /// Smallest y.
        y_min: Option<Length> = optional(LENGTH, "no bound"),
        /// Largest y.
        y_max: Option<Length> = optional(LENGTH, "no bound"),
        /// Smallest z.
        z_min: Option<Length> = optional(LENGTH, "no bound"),
        /// Largest z.
        z_max: Option<Length> = optional(LENGTH, "no bound"),
    }

    /// The table `[contact]`: contact of deformable solids with one another and with rigid planes.
    pub struct Contact, CONTACT {
        /// Rigid planes, `{ point = [0, 0], normal = [0, 1] }`.
        #[serde(default)]
        planes: Vec<ContactPlane> = defaulted(Kind::Tables(&PLANE), Absent::Filled),
        /// Bodies made of particles touch one another.
        bodies: bool = defaulted(Kind::Flag, Absent::Flag(true)),
        /// Stiffness of the contact as a part of the wave modulus times area over spacing.
        stiffness: f64 = defaulted(Kind::Number(Range { min: 0.0, max: 10.0, closed: false }), Absent::Number(1.0)),
        /// Coefficient of Coulomb's friction.
        friction: f64 = defaulted(NUMBER, Absent::Number(0.0)),
    }

    /// A rigid plane.
    pub struct ContactPlane, PLANE {
        /// A point of the plane.
        point: Vec<Length> = required(POINT),
        /// Its normal, towards the bodies; its length does not matter.
        normal: Vec<f64> = required(Kind::List(&List { item: ANY, min: 2, max: 3, single: false })),
    }
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
