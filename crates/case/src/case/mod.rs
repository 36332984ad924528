//! The case: plain data that define a computation. This module knows no solver type.
//!
//! A case file is written in TOML. [`read()`] reports all errors in it at once; [`write()`] is its inverse. [`Case`] is
//! the resolved form: every default is filled in and every quantity is in base units. Angles are in radians; lengths
//! are in the unit of the geometry, which is the metre when the free stream is dimensional.
mod accuracy;
mod body;
mod check;
mod cloud;
mod draft;
mod error;
mod facts;
mod flow;
mod flutter;
pub mod formula;
mod gaf;
mod gaf_check;
mod idle;
mod initial;
mod kinds;
mod mode_file;
mod motion;
mod motion_check;
mod naca;
mod output;
mod plausible;
mod polar;
pub mod quantity;
mod read;
mod reference;
mod schema;
mod schema_text;
mod scheme;
mod sides;
mod solid;
mod solid_check;
mod structure;
mod structure_check;
mod templates;
#[cfg(test)]
mod tests;
mod text;
mod time;
mod verdict;
mod wing;
mod write;

pub use accuracy::{Accuracy, LoadErrors};
pub use body::{Body, Placement, Shape};
pub use cloud::{Adapt, Cloud, Domain, RefineBox, Sensor, Wake, WallLayers};
pub use error::{CaseError, CaseErrors};
pub use flow::{Flow, FreeStreamScales, NEVER_LAMINAR, NO_CONTINUUM, Units, ViscosityLaw, Viscous, Wall};
pub use flutter::{Flutter, GasResponse, LimitCycles, Matching};
pub use gaf::{AnyMode, FlexibleMode, Gaf, GafMethod, Mode};
pub use initial::Initial;
pub use mode_file::{ModeFile, ModeTable, read_mode};
pub use motion::{
    BodyMotionSpec, ModeMotion, Motion, MotionFormula, MotionTable, OwnFrequency, ParticleMotion, Pitch, Plunge,
    Rotation, Translation,
};
pub use naca::{MeanLine, Naca, NacaDesign, NoSection, SixSeries, ThicknessForm, TrailingEdge};
pub use output::{Compare, Hinge, Output, Reference};
pub use polar::Polar;
pub use quantity::{
    Acceleration, Angle, AngularStiffness, Density, Force, Frequency, Inertia, Length, Mass, PerTime, Pressure, Rate,
    Ratio, SpecificHeat, Stiffness, Temperature, Time, Velocity, Viscosity, WallTime,
};
pub use read::{read, read_in};
pub use reference::{reference_markdown, schema};
pub use schema_text::schema_text;
pub use scheme::{Flux, Limiter, Scheme};
pub use sides::{Side, Sides};
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

use accuracy::ACCURACY;
use body::BODY;
use cloud::{ADAPT, CLOUD};
use flow::FLOW;
use flutter::{FLUTTER, LIMIT_CYCLES};
use gaf::GAF;
use initial::INITIAL;
use motion::MOTION;
use output::{COMPARE, HINGE, OUTPUT, REFERENCE};
use schema::{Absent, Kind, defaulted, keys, optional};
use scheme::SCHEME;
use sides::BOUNDARY;
use solid::CONTACT;
use structure::STRUCTURE;
use time::TIME;

keys! {
    /// A resolved case: all that defines a computation.
    pub struct Case, CASE {
        /// One line that names the case in reports.
        title: String = optional(Kind::Text, "the name of the file"),
        /// Number of space dimensions.
        dimension: Option<u8> = optional(Kind::Integer(2, 3), "taken from the bodies, else from `cloud.domain`"),
        /// Free stream: `mach` alone (density 1, sound speed 1) or dimensional, from two of `pressure`, `temperature`,
        /// `density` and one of `mach`, `velocity`. Without this table a case of bodies with `solid` has no gas.
        flow: Flow = defaulted(Kind::Table(&FLOW), Absent::Filled),
        /// Motion of particles and of every body without a `motion` of its own (of the whole cloud when there is no
        /// body). All parts add up: x = R(θ)(X − pivot) + pivot + d.
        motion: Option<Motion> = optional(Kind::Table(&MOTION), "only bodies with a `motion` of their own move"),
        /// A solid body: one shape key, then its placement.
        #[serde(default)]
        bodies as "body": Vec<Body> = defaulted(Kind::Tables(&BODY), Absent::Filled),
        /// A body on springs, whose coordinates are unknowns beside those of the gas; `[structure]` serves where there
        /// is one. In 2-D its masses, inertias, stiffnesses and forces are per unit span. Without a dimensional free
        /// stream they are in units of its density, its sound speed and the unit of length.
        #[serde(default)]
        structures as "structure": Vec<Structure> = defaulted(Kind::Tables(&STRUCTURE), Absent::Filled),
        /// Bodies made of particles touch one another and rigid planes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        contact: Option<Contact> = optional(Kind::Table(&CONTACT), "bodies pass through one another"),
        /// Reference lengths of the load coefficients.
        #[serde(default)]
        reference: Reference = defaulted(Kind::Table(&REFERENCE), Absent::Filled),
        /// How particles fill the domain.
        cloud: Cloud = defaulted(Kind::Table(&CLOUD), Absent::Filled),
        /// How well the loads of a steady case are to be known: finer and finer clouds until their error bars are short
        /// enough. Of marches and harmonic balances `error` alone: error bars of their loads by further runs.
        accuracy: Option<Accuracy> = optional(
            Kind::Table(&ACCURACY),
            "1 % where `[cloud]` gives no `spacing` to a steady case, else the loads are those of one cloud",
        ),
        /// Conditions on the sides of the domain.
        #[serde(default)]
        boundary: Sides = defaulted(Kind::Table(&BOUNDARY), Absent::Filled),
        /// Field at the start.
        #[serde(default)]
        initial: Initial = defaulted(Kind::Choice(INITIAL), Absent::Word("free_stream")),
        /// Spatial scheme.
        #[serde(default)]
        scheme: Scheme = defaulted(Kind::Table(&SCHEME), Absent::Filled),
        /// Steady relaxation or time marching.
        #[serde(default)]
        time: Temporal = defaulted(Kind::Choice(TIME), Absent::Word("steady")),
        /// Refinement that follows the solution; with `[accuracy]` each finer cloud is refined where the one before
        /// tells.
        #[serde(default)]
        adapt: Adapt = defaulted(Kind::Table(&ADAPT), Absent::Filled),
        /// What is written, and how often.
        #[serde(default)]
        output: Output = defaulted(Kind::Table(&OUTPUT), Absent::Filled),
        /// A reference curve of Cp that the report draws beside the result.
        #[serde(default)]
        compare: Vec<Compare> = defaulted(Kind::Tables(&COMPARE), Absent::Filled),
        /// A hinge about which the moment of what lies behind it is told.
        #[serde(default)]
        hinge: Vec<Hinge> = defaulted(Kind::Tables(&HINGE), Absent::Filled),
        /// Generalised aerodynamic forces: the matrix of `alula gaf`. `alula run` takes the modes from it that a
        /// harmonic balance tells forces on, and leaves the rest aside.
        gaf: Option<Gaf> = optional(Kind::Table(&GAF), "`alula gaf` has nothing to do"),
        /// The flutter boundary that `alula flutter` seeks; `alula run` leaves it aside.
        flutter: Option<Flutter> = optional(Kind::Table(&FLUTTER), "`alula flutter` has nothing to do"),
        /// Limit cycles that `alula flutter` seeks beside the boundary: at which speed does the motion have which
        /// amplitude?
        lco: Option<LimitCycles> = optional(Kind::Table(&LIMIT_CYCLES), "no limit cycles"),
    } and {
        /// Values of a polar, when `alpha` or `mach` is a list in the file.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        polar: Option<Polar>,
    }
}
