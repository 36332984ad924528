//! The keys of `[structure]`.
use super::kinds::ANGLE;
use super::motion_keys::MODE_FILE;
use super::quantity::{
    Acceleration, AngularDamper, AngularStiffness, Damper, Frequency, Inertia, Length, Mass, PerArea, PerSquareAngle,
    PerTime, Rate, Ratio, Stiffness, Time, Velocity,
};
use super::schema::{Absent, Field, Kind, List, Range, Table};

/// What no structure is beyond, in SI units, or those of a nondimensional stream: numbers that are larger, or smaller, are slips of a
/// unit or of an exponent, and what is computed of them is round-off. From grains to ships of 10¹² kg and 10⁶ m.
const MASSES: Range = Range::between(1e-12, 1e12);
const INERTIAS: Range = Range::between(-1e18, 1e18);
const STIFF: Range = Range::between(0.0, 1e18);
const FREQUENCIES: Range = Range::between(1e-9, 1e9);
const LENGTHS: Range = Range::between(-1e6, 1e6);
const SPEEDS: Range = Range::between(-1e6, 1e6);
const RATES: Range = Range::between(-1e6, 1e6);
/// Of places in semichords: a swept wing whose axis is ahead of the section has -2, an aircraft about its tail some tens.
const SEMICHORDS: Range = Range::between(-100.0, 100.0);
/// The square of such a length.
const SQUARE: Range = Range::between(1e-9, 1e4);
/// Of ratios of masses, from bubbles to bodies in hardly any air.
const MASS_RATIOS: Range = Range::between(1e-6, 1e9);
/// Of frequencies and speeds over one another.
const RATIOS_OF_SPEED: Range = Range::between(1e-6, 1e6);
/// Cubic parts of springs, over length or angle squared.
const CUBIC: Range = Range::between(-1e15, 1e15);

const SEMICHORD: Kind = Kind::Number(SEMICHORDS);
const SPEED_RATIO: Kind = Kind::Number(RATIOS_OF_SPEED);
const RADIUS_SQUARED: Kind = Kind::Number(SQUARE);
const COORDINATE: Kind = Kind::Number(LENGTHS);
const MASS: Kind = Kind::Quantity(Mass::DIMENSION, MASSES);
const SIZE: Kind = Kind::Quantity(Length::DIMENSION, Range::between(1e-9, 1e6));
const LENGTH: Kind = Kind::Quantity(Length::DIMENSION, LENGTHS);
const POINT: Kind = Kind::List(&List { item: LENGTH, min: 2, max: 3, single: false });
/// Part of critical damping; beyond half of it nothing flutters.
const RATIO: Kind = Kind::Quantity(Ratio::DIMENSION, Range::between(0.0, 100.0));
const HERTZ: Kind = Kind::Quantity(Frequency::DIMENSION, FREQUENCIES);
const SPRING: Kind = Kind::Quantity(Stiffness::DIMENSION, STIFF);
const TWIST: Kind = Kind::Quantity(AngularStiffness::DIMENSION, STIFF);
const DASHPOT: Kind = Kind::Quantity(Damper::DIMENSION, STIFF);
const TWIST_DASHPOT: Kind = Kind::Quantity(AngularDamper::DIMENSION, STIFF);
const PLAY: Kind = Kind::Quantity(Length::DIMENSION, Range::between(0.0, 1e6));
const SPEED: Kind = Kind::Quantity(Velocity::DIMENSION, SPEEDS);
const TURN_RATE: Kind = Kind::Quantity(Rate::DIMENSION, RATES);
const ACCELERATION: Kind = Kind::Quantity(Acceleration::DIMENSION, Range::between(-1e6, 1e6));
const PERIOD: Kind = Kind::Quantity(Time::DIMENSION, Range::between(1e-9, 1e12));
const ONE: &str = "another of its alternatives";
const NO_SPRING: &str = "no spring, or from another key";

pub(super) static STRUCTURE: Table = Table::of(&[
    Field::optional("body", Kind::Text, "the only body", "Name of the body."),
    Field::defaulted("model", Kind::Words(MODELS), Absent::Word("typical_section"), "What moves."),
    Field::defaulted(
        "free",
        Kind::List(&List { item: Kind::Words(FREEDOMS), min: 0, max: 7, single: true }),
        Absent::Filled,
        "Coordinates that are unknowns, the others stay as placed. None named: those of the model. A cylinder that moves across the stream \
         has `free = \"plunge\"`.",
    ),
    Field::optional(
        "number",
        Kind::Integer(1, 100),
        "4",
        "How many natural modes move (`model = \"own_modes\"`), from the slowest on.",
    ),
    Field::optional(
        "pivot",
        POINT,
        "`elastic_axis`, else the centre of mass",
        "The elastic axis: the point whose displacement is counted and about which the body turns, as placed.",
    ),
    Field::optional(
        "elastic_axis",
        SEMICHORD,
        "`pivot`",
        "a: the elastic axis in semichords aft of the middle of the chord (2-D); -0.5 is the quarter chord.",
    ),
    Field::optional(
        "semichord",
        SIZE,
        "half of the reference chord",
        "b of all numbers of flutter; half the diameter of a cylinder.",
    ),
    Field::optional("mass", MASS, "`mass_ratio`", "Mass, in 2-D per span."),
    Field::optional(
        "mass_ratio",
        Kind::Number(MASS_RATIOS),
        "`mass`",
        "μ = m/(π ρ∞ b²) instead (2-D); for a cylinder of diameter D = 2b that is m* = m/(ρ∞ π D²/4).",
    ),
    Field::optional("centre_of_mass", POINT, "at the pivot", "Centre of mass, as placed."),
    Field::optional(
        "x_alpha",
        SEMICHORD,
        "`centre_of_mass`",
        "Static unbalance x_α = S_α/(m b) instead: the centre of mass in semichords aft of the elastic axis (2-D).",
    ),
    Field::optional(
        "inertia",
        Kind::List(&List { item: Kind::Quantity(Inertia::DIMENSION, INERTIAS), min: 1, max: 6, single: true }),
        "`r_alpha2`",
        "Moment of inertia about the pivot: one value in 2-D (per span), Jxx, Jyy, Jzz in 3-D, and Jxy, Jyz, Jzx (entries of the tensor: \
         minus the products of inertia) where they are not zero.",
    ),
    Field::optional(
        "r_alpha2",
        RADIUS_SQUARED,
        "`inertia`",
        "r_α² = I_α/(m b²) instead: square of the radius of gyration about the elastic axis, in semichords (2-D).",
    ),
    Field::defaulted(
        "large_angles",
        Kind::Flag,
        Absent::Flag(false),
        "The inertia of a typical section is that of a rigid body at any angle; else that of small angles, as in the literature of \
         flutter. A rigid body has it always.",
    ),
    Field::optional("stiffness", Kind::Table(&STIFFNESS), NO_SPRING, "Stiffnesses of the springs; zero: none."),
    Field::optional(
        "frequency",
        Kind::Table(&FREQUENCY),
        NO_SPRING,
        "Uncoupled frequencies √(K/m), √(K_α/I_α) of the springs instead; they need a dimensional free stream.",
    ),
    Field::optional(
        "frequency_ratio",
        SPEED_RATIO,
        "`frequency` or `stiffness` of `plunge`",
        "ω_h/ω_α: the uncoupled frequency of plunge over that of pitch.",
    ),
    Field::optional(
        "reduced_speed",
        SPEED_RATIO,
        ONE,
        "V* = U∞/(b ω_α), which fixes the spring of pitch; that of plunge where pitch is not free.",
    ),
    Field::optional(
        "reduced_velocity",
        SPEED_RATIO,
        ONE,
        "U* = U∞/(f D) instead, with D = 2b and f = ω/2π: what vortex-induced vibration is told by.",
    ),
    Field::optional(
        "speed_index",
        SPEED_RATIO,
        "another of its alternatives; 1 with `[flutter]`, which varies the speed",
        "V_f = U∞/(b ω_α √μ) instead.",
    ),
    Field::optional(
        "damping_ratio",
        Kind::Table(&RATIOS),
        "no damping",
        "Damping ratios ζ of the uncoupled coordinates: dampers of 2ζ√(K m), 2ζ√(K_α I_α).",
    ),
    Field::optional(
        "damping",
        Kind::Table(&DAMPERS),
        "no damping",
        "Coefficients of dampers instead, force over velocity and moment over rate, `damping = { plunge = \"40 N s/m\" }`.",
    ),
    Field::optional("flap", Kind::Table(&FLAP), "no flap", "Trailing-edge flap of a typical section."),
    Field::optional(
        "springs",
        Kind::Table(&SPRINGS),
        "linear springs",
        "What makes springs nonlinear: with the elongation e beyond the play their force is K (e + cubic e³), \
         `springs = { pitch = { cubic = 40 } }`.",
    ),
    Field::optional(
        "initial",
        Kind::Table(&INITIAL),
        "at rest as placed",
        "Coordinates and their rates at the start, `initial = { pitch = \"1 deg\", plunge_rate = 0.01 }`.",
    ),
    Field::optional(
        "force",
        Kind::Table(&FORCE),
        "none",
        "External forces and moments as formulas in `t`, `force = { pitch = \"1e-3 * cos(omega * t)\", reduced_frequency = 0.1 }`, in base \
         units.",
    ),
    Field::optional(
        "gravity",
        Kind::List(&List { item: ACCELERATION, min: 2, max: 3, single: false }),
        "none",
        "Acceleration of gravity, `gravity = [0, \"-9.81 m/s2\"]`.",
    ),
    Field::defaulted(
        "mode",
        Kind::Tables(&MODE),
        Absent::Filled,
        "A mode of a flexible body (`model = \"modal\"`): every point X goes q·φ(X). Needs a deforming cloud.",
    ),
])
.or_within("section");

const MODELS: &[(&str, &str)] = &[
    ("typical_section", "plunge and pitch of a section on springs, perhaps with a flap (2-D)"),
    (
        "rigid_body",
        "a rigid body: `surge`, `plunge`, `pitch` in 2-D; `surge`, `sway`, `plunge`, `roll`, `pitch`, `yaw` in 3-D",
    ),
    ("modal", "modes of a flexible body"),
    ("own_modes", "natural modes of a body made of particles (`[body.solid]`), found before the run"),
];

const FREEDOMS: &[(&str, &str)] = &[
    ("surge", "displacement along x"),
    ("sway", "displacement along y (3-D)"),
    ("plunge", "displacement up: along y in 2-D, along z in 3-D"),
    ("roll", "rotation about x (3-D): with `pitch` and `yaw` the components of the rotation vector"),
    ("pitch", "rotation, nose up positive: clockwise in 2-D, about y in 3-D"),
    ("yaw", "rotation about z (3-D)"),
    ("flap", "angle of the flap, trailing edge down positive (2-D)"),
];

const fn of(key: &'static str, kind: Kind, absent: &'static str) -> Field {
    Field::optional(key, kind, absent, "That of the coordinate.")
}

static STIFFNESS: Table = Table::of(&[
    of("surge", SPRING, NO_SPRING),
    of("sway", SPRING, NO_SPRING),
    of("plunge", SPRING, NO_SPRING),
    of("roll", TWIST, NO_SPRING),
    of("pitch", TWIST, NO_SPRING),
    of("yaw", TWIST, NO_SPRING),
    of("flap", TWIST, NO_SPRING),
]);

static FREQUENCY: Table = Table::of(&[
    of("surge", HERTZ, NO_SPRING),
    of("sway", HERTZ, NO_SPRING),
    of("plunge", HERTZ, NO_SPRING),
    of("roll", HERTZ, NO_SPRING),
    of("pitch", HERTZ, NO_SPRING),
    of("yaw", HERTZ, NO_SPRING),
    of("flap", HERTZ, NO_SPRING),
]);

const UNDAMPED: &str = "no damping";

static RATIOS: Table = Table::of(&[
    of("surge", RATIO, UNDAMPED),
    of("sway", RATIO, UNDAMPED),
    of("plunge", RATIO, UNDAMPED),
    of("roll", RATIO, UNDAMPED),
    of("pitch", RATIO, UNDAMPED),
    of("yaw", RATIO, UNDAMPED),
    of("flap", RATIO, UNDAMPED),
]);

static DAMPERS: Table = Table::of(&[
    of("surge", DASHPOT, UNDAMPED),
    of("sway", DASHPOT, UNDAMPED),
    of("plunge", DASHPOT, UNDAMPED),
    of("roll", TWIST_DASHPOT, UNDAMPED),
    of("pitch", TWIST_DASHPOT, UNDAMPED),
    of("yaw", TWIST_DASHPOT, UNDAMPED),
    of("flap", TWIST_DASHPOT, UNDAMPED),
]);

const fn shaped(key: &'static str, table: &'static Table) -> Field {
    Field::optional(key, Kind::Table(table), "a linear spring", "Cubic part, play and place of rest of its spring.")
}

static SPRINGS: Table = Table::of(&[
    shaped("surge", &LONG_SPRING),
    shaped("sway", &LONG_SPRING),
    shaped("plunge", &LONG_SPRING),
    shaped("roll", &TURNED_SPRING),
    shaped("pitch", &TURNED_SPRING),
    shaped("yaw", &TURNED_SPRING),
    shaped("flap", &TURNED_SPRING),
]);

const fn cubic(kind: Kind, doc: &'static str) -> Field {
    Field::defaulted("cubic", kind, Absent::Number(0.0), doc)
}
const FREE_PLAY: &str = "Half the gap: the spring does nothing within `rest` ± this.";
const REST: &str = "Where the spring is at ease.";

static LONG_SPRING: Table = Table::of(&[
    cubic(Kind::Quantity(PerArea::DIMENSION, CUBIC), "Over length squared."),
    Field::defaulted("free_play", PLAY, Absent::Number(0.0), FREE_PLAY),
    Field::defaulted("rest", LENGTH, Absent::Number(0.0), REST),
]);

static TURNED_SPRING: Table = Table::of(&[
    cubic(
        Kind::Quantity(PerSquareAngle::DIMENSION, CUBIC),
        "Over angle squared; a plain number is over radian squared.",
    ),
    Field::defaulted(
        "free_play",
        Kind::Quantity(super::quantity::Angle::DIMENSION, Range { min: 0.0, max: f64::INFINITY, closed: true }),
        Absent::Number(0.0),
        FREE_PLAY,
    ),
    Field::defaulted("rest", ANGLE, Absent::Number(0.0), REST),
]);

const ZERO: &str = "zero";

static INITIAL: Table = Table::of(&[
    of("surge", LENGTH, ZERO),
    of("sway", LENGTH, ZERO),
    of("plunge", LENGTH, ZERO),
    of("roll", ANGLE, ZERO),
    of("pitch", ANGLE, ZERO),
    of("yaw", ANGLE, ZERO),
    of("flap", ANGLE, ZERO),
    of("surge_rate", SPEED, ZERO),
    of("sway_rate", SPEED, ZERO),
    of("plunge_rate", SPEED, ZERO),
    of("roll_rate", TURN_RATE, ZERO),
    of("pitch_rate", TURN_RATE, ZERO),
    of("yaw_rate", TURN_RATE, ZERO),
    of("flap_rate", TURN_RATE, ZERO),
]);

static FORCE: Table = Table::of(&[
    Field::optional("frequency", HERTZ, ONE, "Frequency, `omega` of the formulas; needs a dimensional free stream."),
    Field::optional(
        "reduced_frequency",
        SPEED_RATIO,
        ONE,
        "Reduced frequency k = ωL/U∞ instead, with L = `reduced_length`.",
    ),
    Field::optional("reduced_length", SIZE, "half of the reference chord", "Length L of the reduced frequency."),
    Field::optional("period", PERIOD, ONE, "Period 2π/ω instead."),
    of("surge", Kind::Text, ZERO),
    of("sway", Kind::Text, ZERO),
    of("plunge", Kind::Text, ZERO),
    of("roll", Kind::Text, ZERO),
    of("pitch", Kind::Text, ZERO),
    of("yaw", Kind::Text, ZERO),
    of("flap", Kind::Text, ZERO),
]);

static FLAP: Table = Table::of(&[
    Field::optional(
        "hinge",
        SEMICHORD,
        "`hinge_point`",
        "c: the hinge in semichords aft of the middle of the chord; 0.6 leaves a flap of a fifth of the chord.",
    ),
    Field::optional("hinge_point", POINT, "`hinge`", "The hinge as a point instead, as placed."),
    Field::required(
        "x_beta",
        SEMICHORD,
        "x_β = S_β/(m b): static moment of the flap about its hinge, with the mass m of the whole section.",
    ),
    Field::required("r_beta2", RADIUS_SQUARED, "r_β² = I_β/(m b²), with the mass of the whole section."),
    Field::optional(
        "frequency_ratio",
        SPEED_RATIO,
        "`frequency` or `stiffness` of `flap`",
        "ω_β/ω_α: the uncoupled frequency of the flap over that of pitch.",
    ),
    Field::defaulted(
        "blend",
        PLAY,
        Absent::Number(0.0),
        "Length along x over which the surface goes from still to turning, centred on the hinge; 0: a kink.",
    ),
]);

static MODE: Table = Table::of(&[
    Field::required("name", Kind::Text, "Name: letters, digits, `-` and `_`."),
    MODE_FILE,
    Field::required(
        "mass",
        MASS,
        "Generalised mass ∫ φ·φ dm with the shape of the file, `mass = \"10 kg\"`, in 2-D per span, `\"10 kg/m\"`.",
    ),
    Field::optional("frequency", HERTZ, ONE, "Frequency; needs a dimensional free stream."),
    Field::optional("reduced_frequency", SPEED_RATIO, ONE, "k = ωb/U∞ instead, with b = `semichord`."),
    Field::optional(
        "stiffness",
        SPRING,
        ONE,
        "Generalised stiffness instead, of the unit of the mass over time squared.",
    ),
    Field::defaulted("damping_ratio", RATIO, Absent::Number(0.0), "Damping ratio ζ."),
    Field::defaulted("cubic", Kind::Number(CUBIC), Absent::Number(0.0), "The force of the spring is k (e + cubic e³)."),
    Field::defaulted(
        "free_play",
        Kind::Number(Range::between(0.0, 1e6)),
        Absent::Number(0.0),
        "Half the gap of the spring.",
    ),
    Field::defaulted("initial", COORDINATE, Absent::Number(0.0), "Coordinate at the start."),
    Field::defaulted(
        "initial_rate",
        Kind::Quantity(PerTime::DIMENSION, RATES),
        Absent::Number(0.0),
        "Its rate at the start.",
    ),
    Field::optional(
        "force",
        Kind::Text,
        ZERO,
        "External generalised force as a formula in `t`, in base units; `omega` is that of `[structure.force]`.",
    ),
]);
