//! The case: plain data that says what to compute. It knows no solver type.
//!
//! A case file is TOML; [`read()`] tells all its mistakes at once, [`write()`] is its inverse. [`Case`] is its resolved form: every default
//! filled in, every quantity in base units. Angles are radians, lengths are in the unit of the geometry (metres when the free stream is dimensional).
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
pub use text::{TextError, decimal_comma, numbers_of, open_regular, read_regular, rounded, separator, text_of};
pub use time::{
    Automatic, Dual, Explicit, HarmonicCount, Harmonics, Modes, Newmark, RungeKutta, Steady, SteadyMethod, Temporal,
};
pub use verdict::ClaimRow;
pub use wing::{PlanformShape, ProfileSides, Tip, Wing, WingSides};
pub use write::{write, write_cloud};

/// Everything a run needs to know.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// One line that names the case in reports.
    pub title: String,
    /// Number of space dimensions, 2 or 3; taken from the bodies or the domain when absent: [`read()`] always fills it in.
    pub dimension: Option<u8>,
    /// Free stream; of a polar that of its first point.
    pub flow: Flow,
    /// Values of a polar, where `alpha` or `mach` is a list in the file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub polar: Option<Polar>,
    /// Motion of bodies and particles; absent: only bodies with a motion of their own move.
    pub motion: Option<Motion>,
    /// Solid bodies, none for a case without walls.
    #[serde(default, rename = "body")]
    pub bodies: Vec<Body>,
    /// Bodies on springs, whose coordinates are unknowns.
    #[serde(default, rename = "structure")]
    pub structures: Vec<Structure>,
    /// Contact of bodies made of particles; absent: they pass through one another.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact: Option<Contact>,
    /// Reference lengths of the load coefficients.
    #[serde(default)]
    pub reference: Reference,
    /// How particles fill the domain.
    pub cloud: Cloud,
    /// How well the loads of a steady case are to be known.
    pub accuracy: Option<Accuracy>,
    /// Conditions on the sides of the domain.
    #[serde(default)]
    pub boundary: Sides,
    /// Field at the start.
    #[serde(default)]
    pub initial: Initial,
    /// Spatial scheme.
    #[serde(default)]
    pub scheme: Scheme,
    /// Steady relaxation or time marching.
    #[serde(default)]
    pub time: Temporal,
    /// Refinement that follows the solution.
    #[serde(default)]
    pub adapt: Adapt,
    /// What is written, and how often.
    #[serde(default)]
    pub output: Output,
    /// Reference curves that the report draws beside the result.
    #[serde(default)]
    pub compare: Vec<Compare>,
    /// Hinges about which moments are told.
    #[serde(default)]
    pub hinge: Vec<Hinge>,
    /// What `alula gaf` computes.
    pub gaf: Option<Gaf>,
    /// What `alula flutter` seeks.
    pub flutter: Option<Flutter>,
    /// The limit cycles that it seeks beside it.
    pub lco: Option<LimitCycles>,
}

/// Free stream: either `mach` alone (nondimensional: density 1, sound speed 1) or dimensional values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Flow {
    /// Mach number.
    pub mach: Option<f64>,
    /// Speed; an alternative to `mach` when the free stream is dimensional.
    pub velocity: Option<Velocity>,
    /// Static pressure.
    pub pressure: Option<Pressure>,
    /// Static temperature.
    pub temperature: Option<Temperature>,
    /// Density; an alternative to `temperature`.
    pub density: Option<Density>,
    /// Specific gas constant, J/(kg K), 287.05 for air.
    pub gas_constant: f64,
    /// Ratio of specific heats, 1.4 for air.
    pub gamma: f64,
    /// The gas keeps the entropy of the free stream.
    #[serde(default)]
    pub isentropic: bool,
    /// Angle of attack, nose up positive: the flow turns from +x towards +y in 2-D, towards +z in 3-D.
    #[serde(default)]
    pub alpha: Angle,
    /// Sideslip angle, 3-D only: the flow turns towards +y.
    #[serde(default)]
    pub beta: Angle,
    /// Reynolds number of `reynolds_length`; absent, as `viscosity`: no viscosity.
    pub reynolds: Option<f64>,
    /// Length of the Reynolds number; absent: the reference chord.
    pub reynolds_length: Option<Length>,
    /// Dynamic viscosity of the free stream, an alternative to `reynolds` when the free stream is dimensional.
    pub viscosity: Option<Viscosity>,
    /// How viscosity depends on temperature; absent: Sutherland's law.
    pub viscosity_law: Option<ViscosityLaw>,
    /// Constant of Sutherland's law; absent: 110.4 K, air.
    pub sutherland: Option<Temperature>,
    /// Prandtl number; absent: 0.72, air.
    pub prandtl: Option<f64>,
}

/// One solid body: exactly one shape key, then placement.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Name used in tables of loads; [`read()`] fills in `body-1`, `body-2`, … when absent.
    pub name: Option<String>,
    /// Geometry.
    #[serde(flatten)]
    pub shape: Shape,
    /// Placement: scale first, then rotation about the origin of the shape, then translation.
    #[serde(flatten)]
    pub placement: Placement,
    /// Distance up to which vertices of a surface file are joined; absent: as little as closes the surface, a ten thousandth of its
    /// size at most.
    pub weld: Option<Length>,
    /// Condition of the gas on the surface; absent: slip without viscosity, adiabatic with.
    pub wall: Option<Wall>,
    /// Motion of its own, in place of that of `[motion]`; an empty one keeps the body at rest.
    pub motion: Option<BodyMotionSpec>,
    /// What makes it deform; absent: it is rigid, or bends in modes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub solid: Option<Solid>,
}

/// What a body is made of. In the file this is one key of the body table.
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
        /// Lengths of its axes along x and y.
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
    /// Wing, tail or fin by planform and sections.
    Wing(Box<Wing>),
    /// Body of revolution about the x axis.
    Revolution {
        /// Points x, r from the nose to the rear.
        profile: Vec<[f64; 2]>,
        /// What joins them.
        sides: ProfileSides,
    },
    /// Body along the x axis with oval or boxy sections.
    Loft {
        /// Sections x, width, height and, where it is not zero, z of the middle, from the nose to the rear.
        stations: Vec<Vec<f64>>,
        /// n of the sections |2y/width|ⁿ + |2z/height|ⁿ = 1.
        exponent: f64,
        /// What joins them.
        sides: ProfileSides,
    },
    /// Ellipsoid centred on the origin of the shape.
    Ellipsoid {
        /// Lengths of its axes.
        size: [Length; 3],
    },
}

/// Placement of a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Length of one unit of the shape, so a factor on its coordinates; the chord of an airfoil of unit chord.
    pub scale: f64,
    /// Rotation: one angle in 2-D (nose up positive about the origin of the shape), three in 3-D (about x, y, z); empty:
    /// none.
    pub rotate: Vec<Angle>,
    /// Translation after scaling and rotation; empty: none.
    pub translate: Vec<Length>,
}

/// Reference quantities of the coefficients.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Length of the moment coefficient (and of CL, CD in 2-D); default: the chord line of the section, in 3-D the mean aerodynamic chord of
    /// the largest wing, else of what is seen from above.
    pub chord: Option<Length>,
    /// Area of the coefficients in 3-D (in units of length squared); default: that of the planform.
    pub area: Option<f64>,
    /// Name of the body whose planform gives what is not given, in 3-D; default: the largest wing, else all of them.
    pub body: Option<String>,
    /// Point about which moments are taken; default: the quarter of that chord.
    pub moment_point: Option<Vec<Length>>,
}

/// How particles fill the domain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Cloud {
    /// Particle spacing at the surface; of the whole domain when there is no body. Absent: chosen from the size of the bodies.
    pub spacing: Option<Length>,
    /// Half-width of the far field around the bodies; not beside `domain`. Default 40 chords (2-D), 10 (3-D).
    pub far_field: Option<Length>,
    /// Explicit domain; its sides must be whole numbers of `coarse` cells.
    pub domain: Option<Domain>,
    /// Particles per level of refinement, counted away from the surface; default 6; without `spacing` 12, in 3-D 8.
    pub layers: Option<f64>,
    /// Extra levels of refinement at sharp edges; default 2.
    pub edge_levels: u32,
    /// Spacing is at most this fraction of the local radius of curvature (never finer than `curvature_levels`);
    /// default 0.125.
    pub curvature: f64,
    /// Greatest number of extra levels that curvature may ask for; default 3.
    pub curvature_levels: u32,
    /// Boxes with their own spacing.
    #[serde(default, rename = "box")]
    pub boxes: Vec<RefineBox>,
    /// Refinement behind the bodies along the free stream.
    pub wake: Option<Wake>,
    /// Layers of particles along the walls; default none.
    pub wall_layers: Option<WallLayers>,
    /// Fluid particles nearer to the wall than this fraction of the local spacing are left out; default 0.4.
    pub blank: f64,
    /// Radius of the clouds near the wall in local spacings; default 1.6.
    pub radius: f64,
    /// Random displacement of interior particles as a fraction of the local spacing (for tests of robustness); default 0.
    pub jitter: f64,
}

/// An explicit domain.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Domain {
    /// Corner with the smallest coordinates.
    pub min: Vec<Length>,
    /// Corner with the largest coordinates.
    pub max: Vec<Length>,
}

/// A box with its own spacing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RefineBox {
    /// Corner with the smallest coordinates.
    pub min: Vec<Length>,
    /// Corner with the largest coordinates.
    pub max: Vec<Length>,
    /// Largest spacing inside.
    pub spacing: Length,
}

/// Refinement behind the bodies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Wake {
    /// Length behind the trailing edge.
    pub length: Length,
    /// Largest spacing inside.
    pub spacing: Length,
}

/// Layers of particles along the walls (2-D).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WallLayers {
    /// Distance of the first layer from the wall.
    pub first: Length,
    /// Ratio of the distances between successive layers; default 1.2.
    pub growth: f64,
    /// Greatest number of layers; absent: until they are as far apart as the particles of a layer.
    pub count: Option<u32>,
}

/// Conditions on the sides of the domain.
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

/// Condition on one side of the domain.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Free stream, with the vortex of the lift in 2-D; waves leave through the upwind flux.
    #[default]
    FarField,
    /// The state of `[initial]` held for ever (supersonic inflow, exact solutions).
    Held,
    /// Zero normal gradient; with a static pressure when the outflow is subsonic.
    Outflow {
        /// Static pressure over free-stream pressure; absent: extrapolated.
        pressure: Option<f64>,
    },
    /// Plane of symmetry.
    Symmetry,
    /// Periodic with the opposite side.
    Periodic,
}

/// Field at the start.
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
        /// Axis across the plane, 0 for x.
        axis: u8,
    },
    /// Isentropic vortex (Shu 1998) with the strength, centre and mean velocity given; density and pressure 1 far away.
    Vortex {
        /// Strength β.
        strength: f64,
        /// Centre at the start.
        centre: [f64; 2],
        /// Mean velocity.
        velocity: [f64; 2],
    },
    /// Ringleb's flow, stagnation density and sound speed 1.
    Ringleb,
}

impl Initial {
    /// The same in the units of the solver. Vortex and Ringleb's flow have units of their own, which are those of the solver.
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

/// Spatial scheme.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scheme {
    /// Upwind flux.
    pub flux: Flux,
    /// Order of the reconstruction: 1 or 2.
    pub order: u8,
    /// Slope limiter.
    pub limiter: Limiter,
    /// Relative size of second differences below which the limiter leaves a field alone; absent: by the number of dimensions.
    pub limiter_threshold: Option<f64>,
    /// κ of the reconstruction: 0 for steady flow, 1/3 for waves and vortices.
    pub kappa: f64,
    /// The jump of the normal velocity counts in the upwind flux in proportion to the Mach number.
    pub low_mach: bool,
    /// Exactly conservative coefficients; absent: the solver's own choice.
    pub conservative: Option<bool>,
}

/// Upwind flux at the middle of an edge.
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
    /// Unlimited: smooth flow only.
    None,
    /// Van Albada (1982) with a threshold, differentiable.
    VanAlbada,
    /// Venkatakrishnan's (1995) rational function on edges.
    Venkatakrishnan,
}

/// Refinement that follows the solution.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adapt {
    /// Number of refinements (0: none).
    pub cycles: u32,
    /// Finest spacing that adaptation may ask for; default: `cloud.spacing`.
    pub spacing: Option<Length>,
    /// Greatest number of particles.
    pub particles: usize,
    /// Sensors in use.
    pub sensors: Vec<Sensor>,
}

/// Sensor of the adaptation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Sensor {
    /// Jumps of pressure across an edge.
    Shock,
    /// Jumps of tangential velocity across an edge.
    Shear,
    /// Second differences of density and velocity.
    Curvature,
}

/// The hinge of a control surface: what of a body lies behind it, between its ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Hinge {
    /// Its name.
    pub name: String,
    /// Name of the body that the control surface is part of; absent: all bodies.
    pub body: Option<String>,
    /// One end of the line, in the plane the hinge.
    pub from: Vec<Length>,
    /// The other end, in space.
    pub to: Option<Vec<Length>>,
}

impl Default for Placement {
    /// As the shape is.
    fn default() -> Self {
        Self { scale: 1.0, rotate: Vec::new(), translate: Vec::new() }
    }
}

impl Body {
    /// A body of this shape, without name, at rest where the shape puts it.
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
    /// Particles per level of refinement, counted away from the surface.
    pub fn particles_per_level(&self) -> f64 {
        self.layers.unwrap_or(6.0)
    }
}

impl Default for Adapt {
    fn default() -> Self {
        Self { cycles: 0, spacing: None, particles: 2_000_000, sensors: vec![Sensor::Shock, Sensor::Curvature] }
    }
}
