//! The case: plain data that define a computation. This module knows no solver type.
//!
//! A case file is written in TOML. [`read()`] reports all errors in it at once; [`write()`] is its inverse. [`Case`] is
//! the resolved form: every default is filled in and every quantity is in base units. Angles are in radians; lengths
//! are in the unit of the geometry, which is the metre when the free stream is dimensional.
use serde::{Deserialize, Serialize};

mod accuracy;
mod body_keys;
mod check;
mod draft;
mod error;
mod facts;
mod flow;
mod flutter;
pub mod formula;
mod gaf;
mod gaf_check;
mod gaf_keys;
mod idle;
mod keys;
mod kinds;
mod mode_file;
mod motion;
mod motion_check;
mod motion_keys;
mod naca;
mod output;
mod plausible;
mod polar;
pub mod quantity;
mod read;
mod reference;
mod schema;
mod schema_text;
mod solid;
mod solid_check;
mod solid_keys;
mod structure;
mod structure_check;
mod structure_keys;
mod templates;
#[cfg(test)]
mod tests;
mod text;
mod time;
mod time_keys;
mod verdict;
mod wing;
mod write;

pub use accuracy::{Accuracy, LoadErrors};
pub use error::{CaseError, CaseErrors};
pub use flow::{FreeStreamScales, NEVER_LAMINAR, NO_CONTINUUM, Units, ViscosityLaw, Viscous, Wall};
pub use flutter::{Flutter, GasResponse, LimitCycles, Matching};
pub use gaf::{AnyMode, FlexibleMode, Gaf, GafMethod, Mode};
pub use mode_file::{ModeFile, ModeTable, read_mode};
pub use motion::{
    BodyMotionSpec, ModeMotion, Motion, MotionFormula, MotionTable, OwnFrequency, ParticleMotion, Pitch, Plunge,
    Rotation, Translation,
};
pub use naca::{MeanLine, Naca, NacaDesign, NoSection, SixSeries, ThicknessForm, TrailingEdge};
pub use output::{Compare, Output};
pub use polar::Polar;
pub use quantity::{
    Acceleration, Angle, AngularStiffness, Density, Force, Frequency, Inertia, Length, Mass, PerTime, Pressure, Rate,
    Ratio, SpecificHeat, Stiffness, Temperature, Time, Velocity, Viscosity, WallTime,
};
pub use read::{read, read_in};
pub use reference::{reference_markdown, schema};
pub use schema_text::schema_text;
pub use solid::{
    Contact, ContactPlane, Everywhere, JohnsonCook, Orthotropic, Perzyna, PlaneState, Solid, SolidAxis, SolidBox,
    SolidFill, SolidLaw, SolidLoad, SolidMaterial, SolidPlace, SolidProbe, SolidRegion, SolidSupport,
};
pub use structure::{
    Freedom, PerCoordinate, SpringShape, Structure, StructureFlap, StructureForce, StructureMode, StructureModel,
};
pub use templates::{SCHEMA_FILE, SCHEMA_LINE, TEMPLATES, mode_files, template};
pub use text::{
    TextError, abridged, decimal_comma, numbers_of, open_regular, read_regular, read_written, refuse_longer, rounded,
    separator, text_of,
};
pub use time::{
    Automatic, Dual, Explicit, HarmonicCount, Harmonics, Modes, Newmark, RungeKutta, Steady, SteadyMethod, Temporal,
};
pub use verdict::ClaimRow;
pub use wing::{PlanformShape, ProfileSides, Tip, Wing, WingSides};
pub use write::{write, write_cloud};

/// A resolved case: all that defines a computation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Title of the case, one line, for reports.
    pub title: String,
    /// Number of space dimensions, 2 or 3. When absent, [`read()`] derives it from the bodies or the domain.
    pub dimension: Option<u8>,
    /// Free stream; for a polar, that of its first point.
    pub flow: Flow,
    /// Values of a polar, when `alpha` or `mach` is a list in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polar: Option<Polar>,
    /// Motion of bodies and particles; absent: only bodies with a motion of their own move.
    pub motion: Option<Motion>,
    /// Bodies; empty for a case without walls.
    #[serde(default, rename = "body")]
    pub bodies: Vec<Body>,
    /// Elastically supported or flexible bodies, whose coordinates are unknowns.
    #[serde(default, rename = "structure")]
    pub structures: Vec<Structure>,
    /// Contact between deformable solids; absent: no contact forces.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contact>,
    /// Reference lengths of the load coefficients.
    #[serde(default)]
    pub reference: Reference,
    /// Distribution of the particles in the domain.
    pub cloud: Cloud,
    /// Required accuracy of the loads of a steady case.
    pub accuracy: Option<Accuracy>,
    /// Boundary conditions on the sides of the domain.
    #[serde(default)]
    pub boundary: Sides,
    /// Initial field.
    #[serde(default)]
    pub initial: Initial,
    /// Spatial discretisation.
    #[serde(default)]
    pub scheme: Scheme,
    /// Steady relaxation, time marching or harmonic balance.
    #[serde(default)]
    pub time: Temporal,
    /// Solution-adaptive refinement.
    #[serde(default)]
    pub adapt: Adapt,
    /// Output files and their intervals.
    #[serde(default)]
    pub output: Output,
    /// Reference curves for the report.
    #[serde(default)]
    pub compare: Vec<Compare>,
    /// Hinge lines about which hinge moments are evaluated.
    #[serde(default)]
    pub hinge: Vec<Hinge>,
    /// Settings of `alula gaf` (generalised aerodynamic forces).
    pub gaf: Option<Gaf>,
    /// Settings of `alula flutter`.
    pub flutter: Option<Flutter>,
    /// Settings of the limit-cycle analysis, which extends the flutter analysis.
    pub lco: Option<LimitCycles>,
}

/// Free stream, given by `mach` alone (nondimensional: density 1 and sound speed 1) or by dimensional values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flow {
    /// Mach number.
    pub mach: Option<f64>,
    /// Speed [m/s]; an alternative to `mach` when the free stream is dimensional.
    pub velocity: Option<Velocity>,
    /// Static pressure (Pa).
    pub pressure: Option<Pressure>,
    /// Static temperature (K).
    pub temperature: Option<Temperature>,
    /// Density [kg/m³]; an alternative to `temperature`.
    pub density: Option<Density>,
    /// Specific gas constant [J/(kg K)], 287.05 for air.
    pub gas_constant: f64,
    /// Ratio of specific heats, 1.4 for air.
    pub gamma: f64,
    /// True when the entropy of the gas is constant and equal to that of the free stream.
    #[serde(default)]
    pub isentropic: bool,
    /// Angle of attack (rad), nose up positive: the velocity turns from +x towards +y in 2-D, towards +z in 3-D.
    #[serde(default)]
    pub alpha: Angle,
    /// Sideslip angle (rad), 3-D only: the velocity turns towards +y.
    #[serde(default)]
    pub beta: Angle,
    /// Reynolds number based on `reynolds_length`; the flow is inviscid when this and `viscosity` are absent.
    pub reynolds: Option<f64>,
    /// Reference length of the Reynolds number; absent: the reference chord.
    pub reynolds_length: Option<Length>,
    /// Dynamic viscosity of the free stream (Pa s); an alternative to `reynolds` when the free stream is dimensional.
    pub viscosity: Option<Viscosity>,
    /// Temperature dependence of the viscosity; absent: Sutherland's law.
    pub viscosity_law: Option<ViscosityLaw>,
    /// Sutherland's constant (K); absent: 110.4 K, air.
    pub sutherland: Option<Temperature>,
    /// Prandtl number; absent: 0.72, air.
    pub prandtl: Option<f64>,
}

/// A body: exactly one shape key, followed by its placement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name in tables of loads; when absent, [`read()`] assigns `body-1`, `body-2`, …
    pub name: Option<String>,
    /// Geometry.
    #[serde(flatten)]
    pub shape: Shape,
    /// Placement: scaling, then rotation about the origin of the shape, then translation.
    #[serde(flatten)]
    pub placement: Placement,
    /// Distance up to which vertices of a surface file are merged; absent: the smallest distance that closes the
    /// surface, at most a ten thousandth of its size.
    pub weld: Option<Length>,
    /// Wall condition; absent: slip for an inviscid gas, adiabatic no-slip for a viscous one.
    pub wall: Option<Wall>,
    /// Motion of this body, which replaces that of `[motion]`; an empty table keeps the body at rest.
    pub motion: Option<BodyMotionSpec>,
    /// Material and discretisation of a deformable body; absent: the body is rigid, or deforms in modes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<Solid>,
}

/// Shape of a body. In the file, each variant is a key of the body table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Shape {
    /// NACA section, `naca = "0012"` or `naca = "23012"`, or a table with `digits` and `trailing_edge`.
    Naca(Naca),
    /// Airfoil coordinate file, `airfoil = "rae2822.dat"` (Selig, Lednicer or CSV order).
    Airfoil(String),
    /// Closed polygon with sharp corners, `polygon = [[0, 0], [1, 0.1], [1, -0.1]]`.
    Polygon(Vec<[f64; 2]>),
    /// Circle (2-D), `circle = { radius = 0.5 }`.
    Circle {
        /// Radius.
        radius: Length,
    },
    /// Ellipse centred on the origin of the shape (2-D), `ellipse = { size = [1, 0.12] }`.
    Ellipse {
        /// Lengths of the axes along x and y.
        size: [Length; 2],
    },
    /// Sphere (3-D), `sphere = { radius = 0.5 }`.
    Sphere {
        /// Radius.
        radius: Length,
    },
    /// Box centred on the origin of the shape, `box = { size = [1, 1, 1] }` (two or three numbers).
    Box {
        /// Edge lengths.
        size: Vec<Length>,
    },
    /// STL, OBJ or PLY file, `surface = "wing.stl"`.
    Surface(String),
    /// Wing, tail or fin, given by its planform and sections.
    Wing(Box<Wing>),
    /// Body of revolution about the x axis.
    Revolution {
        /// Points (x, r) from the nose to the rear.
        profile: Vec<[f64; 2]>,
        /// Curve through the points.
        sides: ProfileSides,
    },
    /// Body along the x axis with oval or rounded rectangular cross-sections.
    Loft {
        /// Cross-sections (x, width, height and optionally z of the centre) from the nose to the rear.
        stations: Vec<Vec<f64>>,
        /// Exponent n of the cross-sections |2y/width|ⁿ + |2z/height|ⁿ = 1.
        exponent: f64,
        /// Curve through the cross-sections.
        sides: ProfileSides,
    },
    /// Ellipsoid centred on the origin of the shape.
    Ellipsoid {
        /// Lengths of the three axes.
        size: [Length; 3],
    },
}

/// Placement of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Length of one unit of the shape: a factor on its coordinates. For an airfoil of unit chord this is the chord.
    pub scale: f64,
    /// Rotation: one angle in 2-D (nose up positive, about the origin of the shape), three in 3-D (about x, y, z);
    /// empty: no rotation.
    pub rotate: Vec<Angle>,
    /// Translation after scaling and rotation; empty: no translation.
    pub translate: Vec<Length>,
}

/// Reference quantities of the load coefficients.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Reference length of the moment coefficient, and of CL and CD in 2-D. Default: the chord of the section; in 3-D
    /// the mean aerodynamic chord of the largest wing, or that of the projection on the xy plane when there is no wing.
    pub chord: Option<Length>,
    /// Reference area in 3-D, in squared units of length; default: the planform area.
    pub area: Option<f64>,
    /// Name of the body whose planform defines the missing values in 3-D; default: the largest wing, or all bodies when
    /// there is no wing.
    pub body: Option<String>,
    /// Point about which moments are taken; default: the quarter-chord point.
    pub moment_point: Option<Vec<Length>>,
}

/// Distribution of the particles in the domain. Lengths are in the unit of the geometry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloud {
    /// Particle spacing at the surface, or in the whole domain when there is no body; absent: chosen from the size of
    /// the bodies.
    pub spacing: Option<Length>,
    /// Half-width of the far field around the bodies; not together with `domain`. Default: 40 chords (2-D), 10 chords
    /// (3-D).
    pub far_field: Option<Length>,
    /// Explicit domain, whose sides must be whole multiples of `spacing`.
    pub domain: Option<Domain>,
    /// Number of particles across each level of refinement, counted away from the surface. Default: 6; without
    /// `spacing` 12, in 3-D 8.
    pub layers: Option<f64>,
    /// Number of additional levels of refinement at sharp edges; default 2.
    pub edge_levels: u32,
    /// Upper bound of the spacing as a fraction of the local radius of curvature, limited by `curvature_levels`;
    /// default 0.125.
    pub curvature: f64,
    /// Greatest number of additional levels of refinement due to curvature; default 3.
    pub curvature_levels: u32,
    /// Boxes with a spacing of their own.
    #[serde(default, rename = "box")]
    pub boxes: Vec<RefineBox>,
    /// Refinement behind the bodies along the free stream.
    pub wake: Option<Wake>,
    /// Layers of particles along the walls; default: none.
    pub wall_layers: Option<WallLayers>,
    /// Clearance of fluid particles from the wall as a fraction of the local spacing; default 0.4.
    pub blank: f64,
    /// Radius of the neighbour lists near walls in local spacings; default 1.6.
    pub radius: f64,
    /// Amplitude of the random displacement of interior particles as a fraction of the local spacing, for tests of
    /// robustness; default 0.
    pub jitter: f64,
}

/// An explicit rectangular domain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// Corner with the smallest coordinates.
    pub min: Vec<Length>,
    /// Corner with the largest coordinates.
    pub max: Vec<Length>,
}

/// A box with a spacing of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefineBox {
    /// Corner with the smallest coordinates.
    pub min: Vec<Length>,
    /// Corner with the largest coordinates.
    pub max: Vec<Length>,
    /// Greatest spacing in the box.
    pub spacing: Length,
}

/// Refinement of the wake.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wake {
    /// Length of the refined region behind the trailing edge.
    pub length: Length,
    /// Greatest spacing in the region.
    pub spacing: Length,
}

/// Layers of particles along the walls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WallLayers {
    /// Distance of the first layer from the wall.
    pub first: Length,
    /// Ratio of the distances between successive layers; default 1.2.
    pub growth: f64,
    /// Greatest number of layers; absent: layers are added until they are isotropic.
    pub count: Option<u32>,
}

/// Boundary conditions on the sides of the domain.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Sides {
    /// Side of smallest x.
    pub x_min: Side,
    /// Side of largest x.
    pub x_max: Side,
    /// Side of smallest y.
    pub y_min: Side,
    /// Side of largest y.
    pub y_max: Side,
    /// Side of smallest z.
    pub z_min: Side,
    /// Side of largest z.
    pub z_max: Side,
}

impl Sides {
    /// Conditions on the sides of smallest and largest coordinate along each axis.
    pub const fn pairs(&self) -> [[Side; 2]; 3] {
        [[self.x_min, self.x_max], [self.y_min, self.y_max], [self.z_min, self.z_max]]
    }
}

/// Boundary condition on a side of the domain. What the gas does at an open side stands in `scheme::sides`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Free stream, in 2-D with the far-field vortex of the lift; waves leave through the upwind flux.
    #[default]
    FarField,
    /// State of `[initial]`, prescribed for all times (supersonic inflow, exact solutions).
    Held,
    /// Zero normal gradient, with a prescribed static pressure when the outflow is subsonic.
    Outflow {
        /// Static pressure divided by that of the free stream; absent: extrapolated.
        pressure: Option<f64>,
    },
    /// Plane of symmetry.
    Symmetry,
    /// Periodicity with the opposite side.
    Periodic,
}

impl Side {
    /// True where images of the gas are beyond the side: at planes of symmetry and periodic sides.
    pub const fn has_images(self) -> bool {
        matches!(self, Self::Symmetry | Self::Periodic)
    }
}

/// Initial field.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Initial {
    /// Free stream everywhere.
    #[default]
    FreeStream,
    /// Two states (density, velocity along `axis`, pressure) on either side of a plane.
    Riemann {
        /// Left state (density, velocity, pressure).
        left: [f64; 3],
        /// Right state (density, velocity, pressure).
        right: [f64; 3],
        /// Position of the plane.
        position: f64,
        /// Axis normal to the plane, 0 for x.
        axis: u8,
    },
    /// Isentropic vortex (Shu 1998) of given strength, centre and mean velocity; density and pressure are 1 far away.
    Vortex {
        /// Strength β.
        strength: f64,
        /// Initial centre.
        centre: [f64; 2],
        /// Mean velocity.
        velocity: [f64; 2],
    },
    /// Ringleb's flow with stagnation density and stagnation sound speed 1.
    Ringleb,
}

impl Initial {
    /// The field in units of the solver. The vortex and Ringleb's flow are defined in the units of the solver already.
    pub fn in_solver_units(&self, units: &Units) -> Self {
        let state = |s: &[f64; 3]| [s[0] / units.density, units.solver_rate(s[1]), s[2] / units.pressure()];
        match self {
            Self::Riemann { left, right, position, axis } => {
                Self::Riemann { left: state(left), right: state(right), position: *position, axis: *axis }
            }
            other => other.clone(),
        }
    }
}

/// Spatial discretisation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scheme {
    /// Upwind flux function.
    pub flux: Flux,
    /// Order of the reconstruction, 1 or 2.
    pub order: u8,
    /// Slope limiter.
    pub limiter: Limiter,
    /// Relative size of second differences below which the limiter is inactive; absent: depends on the number of
    /// dimensions.
    pub limiter_threshold: Option<f64>,
    /// Parameter κ of the reconstruction: 0 for steady flow, 1/3 for waves and vortices.
    pub kappa: f64,
    /// Low-Mach-number correction: the jump of the normal velocity in the upwind flux is multiplied by the local Mach
    /// number.
    pub low_mach: bool,
    /// Exactly conservative coefficients; absent: chosen by the solver.
    pub conservative: Option<bool>,
}

/// Upwind flux function, evaluated at the midpoint of an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Flux {
    /// Harten-Lax-van Leer with contact (Toro 1994).
    Hllc,
    /// Roe (1981) with a smooth entropy fix.
    Roe,
    /// AUSM⁺-up (Liou 2006).
    AusmPlusUp,
    /// Local Lax-Friedrichs.
    Rusanov,
}

/// Slope limiter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Limiter {
    /// No limiter, for smooth flow only.
    None,
    /// Van Albada (1982) with a threshold; differentiable.
    VanAlbada,
    /// Rational function of Venkatakrishnan (1995), evaluated on edges.
    Venkatakrishnan,
}

/// Solution-adaptive refinement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adapt {
    /// Number of refinement cycles; 0: none.
    pub cycles: u32,
    /// Finest spacing of the adaptation; default: `cloud.spacing`.
    pub spacing: Option<Length>,
    /// Greatest number of particles.
    pub particles: usize,
    /// Active sensors.
    pub sensors: Vec<Sensor>,
}

/// Sensor of the adaptive refinement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// Pressure jump across an edge.
    Shock,
    /// Jump of the tangential velocity across an edge.
    Shear,
    /// Second differences of density and velocity.
    Curvature,
}

/// Hinge line of a control surface. The control surface is the part of a body behind the line, between its ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hinge {
    /// Name of the control surface.
    pub name: String,
    /// Name of the body that it is part of; absent: all bodies.
    pub body: Option<String>,
    /// First end of the hinge line; in 2-D the hinge point.
    pub from: Vec<Length>,
    /// Second end of the hinge line (3-D).
    pub to: Option<Vec<Length>>,
}

impl Default for Placement {
    /// No scaling, rotation or translation.
    fn default() -> Self {
        Self { scale: 1.0, rotate: Vec::new(), translate: Vec::new() }
    }
}

impl Body {
    /// A body of this shape without name and motion, placed as the shape defines it.
    pub fn new(shape: Shape) -> Self {
        Self { name: None, shape, placement: Placement::default(), weld: None, wall: None, motion: None, solid: None }
    }

    /// A NACA 4-digit section of unit chord with a closed trailing edge, nose at the origin.
    pub fn naca(digits: &str) -> Self {
        Self::new(Shape::Naca(Naca { digits: digits.to_owned(), trailing_edge: TrailingEdge::Closed }))
    }
}

impl Default for Scheme {
    fn default() -> Self {
        Self {
            flux: Flux::Hllc,
            order: 2,
            limiter: Limiter::VanAlbada,
            limiter_threshold: None,
            kappa: 0.0,
            low_mach: false,
            conservative: None,
        }
    }
}

impl Cloud {
    /// Number of particles across each level of refinement.
    pub fn particles_per_level(&self) -> f64 {
        self.layers.unwrap_or(6.0)
    }
}

impl Default for Adapt {
    fn default() -> Self {
        Self { cycles: 0, spacing: None, particles: 2_000_000, sensors: vec![Sensor::Shock, Sensor::Curvature] }
    }
}
