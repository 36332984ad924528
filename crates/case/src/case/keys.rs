//! The keys of the case file: the one place where names, ranges, defaults and meanings are written down.
//!
//! Ranges that are not plain logic come from the numerics: particles nearer to the wall than 0.3 spacings spoil the
//! conditioning of their clouds, more than 0.6 leave a gap; fewer than 3 particles a level do not fill a cloud.
use super::body_keys::BODY;
use super::flutter::keys::{FLUTTER, LIMIT_CYCLES};
use super::gaf_keys::GAF;
use super::kinds::{ANGLE, COUNT, PLANE_POINT, POINT, POSITIVE, SIZE};
use super::motion_keys::MOTION;
use super::quantity::{Density, Pressure, Ratio, Temperature, Time, Velocity, Viscosity, WallTime};
use super::schema::{Absent, Field, Kind, List, Range, Table, Variant};
use super::solid_keys::CONTACT;
use super::structure_keys::STRUCTURE;
use super::time_keys::TIME;

const ANY: Kind = Kind::Number(Range::ANY);
const LEVELS: Kind = Kind::Integer(0, 16);
const STATE: Kind = Kind::List(&List { item: ANY, min: 3, max: 3, single: false });

/// The whole file.
pub(super) static CASE: Table = Table::of(&[
    Field::optional("title", Kind::Text, "the name of the file", "One line that names the case in reports."),
    Field::optional(
        "dimension",
        Kind::Integer(2, 3),
        "taken from the bodies, else from `cloud.domain`",
        "Number of space dimensions.",
    ),
    Field::defaulted(
        "flow",
        Kind::Table(&FLOW),
        Absent::Filled,
        "Free stream: `mach` alone (density 1, sound speed 1) or dimensional, from two of `pressure`, `temperature`, \
         `density` and one of `mach`, `velocity`. Without this table a case of bodies with `solid` has no gas.",
    ),
    Field::optional(
        "motion",
        Kind::Table(&MOTION),
        "only bodies with a `motion` of their own move",
        "Motion of particles and of every body without a `motion` of its own (of the whole cloud when there is no body). \
         All parts add up: x = R(θ)(X − pivot) + pivot + d.",
    ),
    Field::defaulted("body", Kind::Tables(&BODY), Absent::Filled, "A solid body: one shape key, then its placement."),
    Field::defaulted(
        "structure",
        Kind::Tables(&STRUCTURE),
        Absent::Filled,
        "A body on springs, whose coordinates are unknowns beside those of the gas; `[structure]` serves where there is one. In 2-D its \
         masses, inertias, stiffnesses and forces are per unit span. Without a dimensional free stream they are in units of its density, \
         its sound speed and the unit of length.",
    ),
    Field::optional(
        "contact",
        Kind::Table(&CONTACT),
        "bodies pass through one another",
        "Bodies made of particles touch one another and rigid planes.",
    ),
    Field::defaulted(
        "reference",
        Kind::Table(&REFERENCE),
        Absent::Filled,
        "Reference lengths of the load coefficients.",
    ),
    Field::defaulted("cloud", Kind::Table(&CLOUD), Absent::Filled, "How particles fill the domain."),
    Field::optional(
        "accuracy",
        Kind::Table(&ACCURACY),
        "1 % where `[cloud]` gives no `spacing` to a steady case, else the loads are those of one cloud",
        "How well the loads of a steady case are to be known: finer and finer clouds until their error bars are short enough. Of marches and \
         harmonic balances `error` alone: error bars of their loads by further runs.",
    ),
    Field::defaulted("boundary", Kind::Table(&BOUNDARY), Absent::Filled, "Conditions on the sides of the domain."),
    Field::defaulted("initial", Kind::Choice(INITIAL), Absent::Word("free_stream"), "Field at the start."),
    Field::defaulted("scheme", Kind::Table(&SCHEME), Absent::Filled, "Spatial scheme."),
    Field::defaulted("time", Kind::Choice(TIME), Absent::Word("steady"), "Steady relaxation or time marching."),
    Field::defaulted(
        "adapt",
        Kind::Table(&ADAPT),
        Absent::Filled,
        "Refinement that follows the solution; with `[accuracy]` each finer cloud is refined where the one before tells.",
    ),
    Field::defaulted("output", Kind::Table(&OUTPUT), Absent::Filled, "What is written, and how often."),
    Field::defaulted(
        "compare",
        Kind::Tables(&COMPARE),
        Absent::Filled,
        "A reference curve of Cp that the report draws beside the result.",
    ),
    Field::defaulted(
        "hinge",
        Kind::Tables(&HINGE),
        Absent::Filled,
        "A hinge about which the moment of what lies behind it is told.",
    ),
    Field::optional(
        "gaf",
        Kind::Table(&GAF),
        "`alula gaf` has nothing to do",
        "Generalised aerodynamic forces: the matrix of `alula gaf`. `alula run` takes the modes from it that a harmonic balance tells \
         forces on, and leaves the rest aside.",
    ),
    Field::optional(
        "flutter",
        Kind::Table(&FLUTTER),
        "`alula flutter` has nothing to do",
        "The flutter boundary that `alula flutter` seeks; `alula run` leaves it aside.",
    ),
    Field::optional(
        "lco",
        Kind::Table(&LIMIT_CYCLES),
        "no limit cycles",
        "Limit cycles that `alula flutter` seeks beside the boundary: at which speed does the motion have which amplitude?",
    ),
]);

static FLOW: Table = Table::of(&[
    Field::optional(
        "mach",
        Kind::Values(&POSITIVE),
        "`velocity` must be given",
        "Mach number of the free stream; several make a polar.",
    )
    .known_as(&["m", "ma", "mach_number"]),
    Field::optional(
        "velocity",
        Kind::Quantity(Velocity::DIMENSION, Range::POSITIVE),
        "`mach` must be given",
        "Speed of the free stream; needs a dimensional free stream.",
    )
    .known_as(&["speed", "u", "v", "airspeed"]),
    Field::optional(
        "pressure",
        Kind::Quantity(Pressure::DIMENSION, Range::POSITIVE),
        "nondimensional, or from the other two",
        "Static pressure of the free stream.",
    ),
    Field::optional(
        "temperature",
        Kind::Quantity(Temperature::DIMENSION, Range::POSITIVE),
        "nondimensional, or from the other two",
        "Static temperature of the free stream.",
    ),
    Field::optional(
        "density",
        Kind::Quantity(Density::DIMENSION, Range::POSITIVE),
        "nondimensional, or from the other two",
        "Density of the free stream.",
    ),
    Field::defaulted(
        "gas_constant",
        POSITIVE,
        Absent::Number(287.05),
        "Specific gas constant, J/(kg K); the default is air.",
    ),
    Field::defaulted("gamma", Kind::Number(Range::above(1.0)), Absent::Number(1.4), "Ratio of specific heats."),
    Field::defaulted(
        "isentropic",
        Kind::Flag,
        Absent::Flag(false),
        "The gas keeps the entropy of the free stream, as sound does: for periodic flow that no stream passes through, where any \
         distribution of entropy would be a solution. Without viscosity only; shocks lose no total pressure.",
    ),
    Field::defaulted(
        "alpha",
        Kind::Values(&ANGLE),
        Absent::Number(0.0),
        "Angle of attack, nose up positive: the flow turns from +x towards +y in 2-D, towards +z in 3-D. Several, \
          `\"-4:8:1 deg\"` or `[-2, 0, 2, 4]`, make a polar: one run through all of them, at every Mach number of `mach`. \
          Several without a unit are degrees.",
    )
    .known_as(&["aoa", "angle", "angle_of_attack", "incidence"]),
    Field::defaulted("beta", ANGLE, Absent::Number(0.0), "Sideslip angle, 3-D only: the flow turns towards +y."),
    Field::optional(
        "reynolds",
        POSITIVE,
        "no viscosity, or from `viscosity`",
        "Reynolds number ρ∞ U∞ L/μ∞ with L = `reynolds_length`.",
    )
    .known_as(&["re", "reynolds_number"]),
    Field::optional("reynolds_length", SIZE, "the reference chord", "Length of the Reynolds number."),
    Field::optional(
        "viscosity",
        Kind::Quantity(Viscosity::DIMENSION, Range::POSITIVE),
        "no viscosity, or from `reynolds`",
        "Dynamic viscosity of the free stream; needs a dimensional free stream.",
    ),
    Field::optional(
        "viscosity_law",
        Kind::Words(VISCOSITY_LAWS),
        "`\"sutherland\"`",
        "How the viscosity depends on temperature.",
    ),
    Field::optional(
        "sutherland",
        Kind::Quantity(Temperature::DIMENSION, Range::POSITIVE),
        "110.4 K, air",
        "Constant S of Sutherland's law. The law needs the temperature of the free stream: `temperature`, which may stand \
         alone for this purpose, else 288.15 K.",
    ),
    Field::optional("prandtl", POSITIVE, "0.72, air", "Prandtl number."),
]);

const VISCOSITY_LAWS: &[(&str, &str)] =
    &[("sutherland", "μ/μ∞ = (T/T∞)^1.5 (T∞ + S)/(T + S)"), ("constant", "the same everywhere")];

static REFERENCE: Table = Table::of(&[
    Field::optional(
        "chord",
        SIZE,
        "chord line of a section (1 for NACA sections and files of unit chord, times `scale`), of several their extent along x; in 3-D the mean aerodynamic \
         chord of the largest wing as it is typed, the length of bodies of revolution and lofts, else the mean aerodynamic chord of what is seen from above",
        "Length of the moment coefficient (and of CL, CD in 2-D).",
    ),
    Field::optional(
        "area",
        POSITIVE,
        "planform of the largest wing as it is typed, else of what is seen from above, fins left out; of what stands upright alone, a wing with its span along z, from the side",
        "Area of the coefficients in 3-D, length squared.",
    ),
    Field::optional(
        "body",
        Kind::Text,
        "the largest wing, else all bodies",
        "Name of the body that gives the values that are not given: the wing of an aircraft, the main part of a section. It counts whole, with what lies inside other bodies.",
    ),
    Field::optional(
        "moment_point",
        POINT,
        "quarter of the chord line (2-D), of the mean aerodynamic chord (3-D), moved with the body by `scale`, `rotate` and `translate`",
        "Point about which moments are taken; it moves with the first body.",
    ),
]);

static CLOUD: Table = Table::of(&[
    Field::optional(
        "spacing",
        SIZE,
        "1/64 of the shortest body; a steady case goes on to finer clouds as `[accuracy]` says",
        "Particle spacing at the surface; of the whole domain when there is no body, where it must be given. In space and with viscosity too.",
    ),
    Field::optional(
        "far_field",
        SIZE,
        "40 chords (2-D), 10 (3-D)",
        "Half-width of the far field around the bodies; not beside `domain`.",
    ),
    Field::optional(
        "domain",
        Kind::Table(&DOMAIN),
        "a square or cube of half-width `far_field`; must be given when there is no body",
        "Explicit domain: whole numbers of `spacing` long. Where the program chooses the spacing, far sides move outward until they are.",
    ),
    Field::optional(
        "layers",
        Kind::Number(Range::between(3.0, 1000.0)),
        "6; 12 where no `spacing` is given",
        "Particles per level of refinement, counted away from the surface.",
    ),
    Field::defaulted("edge_levels", LEVELS, Absent::Integer(2), "Extra levels of refinement at sharp edges."),
    Field::defaulted(
        "curvature",
        Kind::Number(Range { min: 0.0, max: 1.0, closed: false }),
        Absent::Number(0.125),
        "Spacing is at most this fraction of the local radius of curvature.",
    ),
    Field::defaulted(
        "curvature_levels",
        LEVELS,
        Absent::Integer(3),
        "Greatest number of extra levels that curvature may ask for.",
    ),
    Field::defaulted("box", Kind::Tables(&REFINE), Absent::Filled, "A box with its own spacing."),
    Field::optional("wake", Kind::Table(&WAKE), "no refinement", "Refinement behind the bodies along the free stream."),
    Field::optional(
        "wall_layers",
        Kind::Table(&WALL_LAYERS),
        "no layers",
        "Layers of particles along the walls, thin across them.",
    ),
    Field::defaulted(
        "blank",
        Kind::Number(Range::between(0.3, 0.6)),
        Absent::Number(0.4),
        "Fluid particles nearer to the wall than this fraction of the local spacing are left out.",
    ),
    Field::defaulted(
        "radius",
        Kind::Number(Range::between(1.0, 4.0)),
        Absent::Number(1.6),
        "Radius of the clouds near the wall in local spacings.",
    ),
    Field::defaulted(
        "jitter",
        Kind::Number(Range::between(0.0, 0.45)),
        Absent::Number(0.0),
        "Random displacement of interior particles as a fraction of the local spacing (for tests of robustness).",
    ),
]);

static DOMAIN: Table = Table::of(&[
    Field::required("min", POINT, "Corner with the smallest coordinates."),
    Field::required("max", POINT, "Corner with the largest coordinates."),
]);

static REFINE: Table = Table::of(&[
    Field::required("min", POINT, "Corner with the smallest coordinates."),
    Field::required("max", POINT, "Corner with the largest coordinates."),
    Field::required("spacing", SIZE, "Largest spacing inside."),
]);

static WAKE: Table = Table::of(&[
    Field::required("length", SIZE, "Length behind the trailing edge."),
    Field::required("spacing", SIZE, "Largest spacing inside."),
]);

/// Layers that grow faster than 1.5 leave cells of very different thickness side by side.
static WALL_LAYERS: Table = Table::of(&[
    Field::required("first", SIZE, "Distance of the first layer from the wall."),
    Field::defaulted(
        "growth",
        Kind::Number(Range::between(1.0, 1.5)),
        Absent::Number(1.2),
        "Ratio of the distances between successive layers.",
    ),
    Field::optional(
        "count",
        Kind::Integer(1, 1000),
        "until layers are as far apart as the particles of a layer",
        "Greatest number of layers; fewer where the surface turns sharply or another wall is near.",
    ),
]);

/// Sides of the domain, two for each axis.
pub(super) const SIDES: [(&str, &str); 3] = [("x_min", "x_max"), ("y_min", "y_max"), ("z_min", "z_max")];

const fn side(key: &'static str, doc: &'static str) -> Field {
    Field::defaulted(key, Kind::Choice(SIDE), Absent::Word("far_field"), doc)
}

static BOUNDARY: Table = Table::of(&[
    side("x_min", "Side of smallest x."),
    side("x_max", "Side of largest x."),
    side("y_min", "Side of smallest y."),
    side("y_max", "Side of largest y."),
    side("z_min", "Side of smallest z."),
    side("z_max", "Side of largest z."),
]);

const SIDE: &[Variant] = &[
    Variant::word("far_field", "free stream, with the vortex of the lift in 2-D; waves leave"),
    Variant::word("held", "the state of `[initial]` held for ever (supersonic inflow, exact solutions)"),
    Variant::table("outflow", &OUTFLOW, "zero normal gradient; with a static pressure when the outflow is subsonic"),
    Variant::word("symmetry", "plane of symmetry"),
    Variant::word("periodic", "periodic with the opposite side"),
];

static OUTFLOW: Table =
    Table::of(&[Field::optional("pressure", POSITIVE, "extrapolated", "Static pressure over free-stream pressure.")]);

const INITIAL: &[Variant] = &[
    Variant::word("free_stream", "free stream everywhere"),
    Variant::table("riemann", &RIEMANN, "two states on either side of a plane"),
    Variant::table(
        "vortex",
        &VORTEX,
        "isentropic vortex (Shu 1998), density and pressure 1 far away; in 3-D a column along z",
    ),
    Variant::word("ringleb", "Ringleb's flow, stagnation density and sound speed 1, 2-D"),
    Variant::table(
        "formula",
        &FORMULA_FIELD,
        "formulas of the position: a velocity profile of a channel, a pulse of pressure",
    ),
];

static FORMULA_FIELD: Table = Table::of(&[
    Field::required(
        "velocity",
        Kind::List(&List { item: Kind::Formula, min: 2, max: 3, single: false }),
        "Velocity, a number or a formula in `x`, `y`, `z` for each axis, `[\"6 * y * (1 - y)\", 0]`: m/s with a dimensional free stream, else over its sound speed.",
    ),
    Field::optional(
        "density",
        Kind::Formula,
        "that of the free stream",
        "Density, a number or a formula: kg/m3 with a dimensional free stream, else over that of the free stream.",
    ),
    Field::optional(
        "pressure",
        Kind::Formula,
        "that of the free stream",
        "Pressure, a number or a formula: Pa with a dimensional free stream, else over ρ∞ a∞², so that the free stream has 1/γ.",
    ),
]);

static RIEMANN: Table = Table::of(&[
    Field::required(
        "left",
        STATE,
        "Left state: density, velocity along `axis`, pressure; SI units with a dimensional free stream.",
    ),
    Field::required("right", STATE, "Right state: density, velocity along `axis`, pressure, in the same units."),
    Field::defaulted("position", ANY, Absent::Number(0.0), "Position of the plane."),
    Field::defaulted("axis", Kind::Integer(0, 2), Absent::Integer(0), "Axis across the plane, 0 for x."),
]);

static VORTEX: Table = Table::of(&[
    Field::required("strength", ANY, "Strength β."),
    Field::required("centre", PLANE_POINT, "Centre at the start, in the plane of x and y."),
    Field::required("velocity", PLANE_POINT, "Mean velocity."),
]);

static SCHEME: Table = Table::of(&[
    Field::defaulted("flux", Kind::Words(FLUXES), Absent::Word("hllc"), "Upwind flux at the middle of an edge."),
    Field::defaulted("order", Kind::Integer(1, 2), Absent::Integer(2), "Order of the reconstruction."),
    Field::defaulted("limiter", Kind::Words(LIMITERS), Absent::Word("van_albada"), "Slope limiter."),
    Field::optional(
        "limiter_threshold",
        Kind::Number(Range::between(0.0, 1.0)),
        "0.1 in 2-D without viscosity, 0.4 otherwise",
        "Relative size of second differences below which the limiter leaves a field alone: more in 3-D, where clouds are coarser, and in viscous layers.",
    ),
    Field::defaulted(
        "kappa",
        Kind::Number(Range::between(-1.0, 1.0)),
        Absent::Number(0.0),
        "κ of the reconstruction: 0 for steady flow, 1/3 for waves and vortices.",
    ),
    Field::defaulted(
        "low_mach",
        Kind::Flag,
        Absent::Flag(false),
        "The jump of the velocity across an edge counts in the upwind flux in proportion to the Mach number: for slow flow, with \
         conservative coefficients.",
    ),
    Field::optional("conservative", Kind::Flag, "the solver's own choice", "Exactly conservative coefficients."),
]);

const FLUXES: &[(&str, &str)] = &[
    ("hllc", "Harten-Lax-van Leer with contact (Toro 1994)"),
    ("roe", "Roe (1981) with a smooth entropy fix"),
    ("ausm_plus_up", "AUSM+-up (Liou 2006)"),
    ("rusanov", "local Lax-Friedrichs"),
];

const LIMITERS: &[(&str, &str)] = &[
    ("none", "unlimited: smooth flow only"),
    ("van_albada", "van Albada (1982) with a threshold, differentiable"),
    ("venkatakrishnan", "Venkatakrishnan's (1995) rational function on edges"),
];

static ACCURACY: Table = Table::of(&[
    Field::defaulted(
        "loads",
        Kind::Quantity(Ratio::DIMENSION, Range { min: 0.0, max: 0.5, closed: false }),
        Absent::Number(0.01),
        "Half width of the error bars of CL, CD and CM over their value, or over 0.1, 0.01 and 0.02 where that is smaller. Polars: 5 %, in \
         3-D 10 %.",
    ),
    Field::defaulted(
        "particles",
        COUNT,
        Absent::Integer(50_000),
        "Greatest number of particles: the run ends on the finest cloud below it where the error bars are not short enough before \
         (in 3-D: 250 000).",
    ),
    Field::optional(
        "time",
        Kind::Quantity(WallTime::DIMENSION, Range::POSITIVE),
        "none",
        "Wall-clock time, a plain number in seconds: the run ends on the cloud after which the next, finer one would not end within it.",
    ),
    Field::defaulted(
        "error",
        Kind::Words(LOAD_ERRORS),
        Absent::Word("none"),
        "Errors of the loads of a march or a harmonic balance that are told, each by one further run. Steady cases have a family of clouds.",
    ),
]);

const LOAD_ERRORS: &[(&str, &str)] = &[
    ("none", "none, without a further run"),
    (
        "cloud",
        "that of the cloud, by a run with twice the spacing: a quarter of the time more in the plane, a tenth in space",
    ),
    (
        "step",
        "that of the step in time of a march, by a run with twice the step (three quarters of the time more), of explicit steps by one with half \
         of it (twice the time more)",
    ),
    (
        "harmonics",
        "that of the number of harmonics of a balance, by a run with one harmonic less, of one or two with one more: about as much time again",
    ),
    ("all", "that of the cloud, and that of the step or of the number of harmonics"),
];

static ADAPT: Table = Table::of(&[
    Field::defaulted("cycles", Kind::Integer(0, 64), Absent::Integer(0), "Number of refinements (0: none)."),
    Field::optional("spacing", SIZE, "`cloud.spacing`", "Finest spacing that adaptation may ask for."),
    Field::defaulted("particles", COUNT, Absent::Integer(2_000_000), "Greatest number of particles."),
    Field::defaulted(
        "sensors",
        Kind::List(&List { item: Kind::Words(SENSORS), min: 1, max: 3, single: true }),
        Absent::Words(&["shock", "curvature"]),
        "Sensors in use.",
    ),
]);

const SENSORS: &[(&str, &str)] = &[
    ("shock", "jumps of pressure across an edge"),
    ("shear", "jumps of tangential velocity across an edge"),
    ("curvature", "second differences of density and velocity"),
];

static OUTPUT: Table = Table::of(&[
    Field::defaulted(
        "checkpoint",
        COUNT,
        Absent::Integer(50),
        "Iterations between checkpoints, at most. Marches of structures alone, whose steps may take less time than a file, let twenty times as \
         long pass as writing the last one took.",
    ),
    Field::defaulted(
        "checkpoint_time",
        Kind::Quantity(WallTime::DIMENSION, Range::POSITIVE),
        Absent::Number(600.0),
        "Wall-clock time between checkpoints, at most, a plain number in seconds: what a run that is killed loses. No result depends on it.",
    ),
    Field::optional(
        "field_interval",
        Kind::Quantity(Time::DIMENSION, Range::POSITIVE),
        "the last field only",
        "Time between field files in marching runs: seconds, or lengths over sound speed without a dimensional free stream.",
    ),
    Field::optional(
        "field_particles",
        COUNT,
        "all",
        "Fluid particles in a field file, at most: of more, every second, third and so on stays, so that what is fine stays finer; \
         particles on walls all stay. Up to a million particles in space have cells between them.",
    ),
    Field::defaulted(
        "loop_periods",
        COUNT,
        Absent::Integer(1),
        "Periods at the end of a march that loops and harmonics of the loads are the mean of: more than one where the flow has \
         a rhythm of its own beside that of the motion.",
    ),
    Field::defaulted("report", Kind::Flag, Absent::Flag(true), "Write `report.html` and pictures."),
    Field::optional(
        "stations",
        Kind::List(&List { item: Kind::Number(Range::between(0.0, 1.0)), min: 1, max: 24, single: true }),
        "those of the references, else 0.2, 0.44, 0.65, 0.8, 0.9, 0.95",
        "Parts of the half span at which Cp is drawn along the chord, in space.",
    ),
]);

static HINGE: Table = Table::of(&[
    Field::defaulted("name", Kind::Text, Absent::Word("hinge"), "Name in tables."),
    Field::optional("body", Kind::Text, "all bodies", "Name of the body that the control surface is part of."),
    Field::required(
        "from",
        POINT,
        "One end of the hinge line, before any motion; in 2-D the hinge. Moments are positive by the right-hand rule about the line from here \
         `to` there (from left to right: trailing edge down), in 2-D where they turn the trailing edge down.",
    ),
    Field::optional("to", POINT, "2-D: the hinge is a point", "The other end, in 3-D."),
]);

static COMPARE: Table = Table::of(&[
    Field::required(
        "file",
        Kind::File,
        "CSV file with columns `x_c` and `Cp`, in space `eta`, the part of the half span, relative to the case file.",
    ),
    Field::defaulted("label", Kind::Text, Absent::Word("reference"), "Name in the legend."),
]);
