//! The keys of `[motion]` and of the motion of one body.
use super::kinds::{ANGLE, LENGTH, POINT, POSITIVE, SIZE};
use super::quantity::{Angle, Frequency, Length, Rate, Time, Velocity};
use super::schema::{Absent, Field, Kind, List, Range, Table, Variant};

/// A direction in two or three dimensions.
const DIRECTION: Kind = Kind::List(&List { item: Kind::Number(Range::ANY), min: 2, max: 3, single: false });
const ONE: &str = "another of `frequency`, `reduced_frequency` and `period`";
const STILL: &str = "no such part";

const FREQUENCY: Field = Field::optional(
    "frequency",
    Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE),
    ONE,
    "Frequency of pitch and plunge, and `omega` of formulas; needs a dimensional free stream.",
);
const REDUCED_FREQUENCY: Field = Field::optional(
    "reduced_frequency",
    POSITIVE,
    ONE,
    "Reduced frequency k = ωL/U∞ instead, with L = `reduced_length` and the speed U∞ of the free stream.",
);
const REDUCED_LENGTH: Field = Field::optional(
    "reduced_length",
    SIZE,
    "half of the reference chord",
    "Length L of the reduced frequency; give the chord itself when k = ωc/U∞ is meant.",
);
const PERIOD: Field = Field::optional(
    "period",
    Kind::Quantity(Time::DIMENSION, Range::POSITIVE),
    ONE,
    "Period 2π/ω instead, in seconds or lengths over sound speed.",
);
const PIVOT: Field = Field::optional(
    "pivot",
    POINT,
    "must be given when the body turns",
    "Point about which the body turns, at its place before any motion; it travels with the displacement.",
);
const AXIS: Field = Field::optional(
    "axis",
    DIRECTION,
    "+y in 3-D: nose up positive for a stream along +x with lift along +z",
    "Axis of the turn (3-D only), right-handed. In 2-D angles are nose up positive: clockwise.",
);
const PITCH: Field = Field::defaulted(
    "pitch",
    Kind::Tables(&PITCH_KEYS),
    Absent::Filled,
    "Angle amplitude·sin(ωt + phase), nose up positive; the mean angle is `flow.alpha` or `rotate` of the body. \
     `pitch = \"2 deg\"` is an amplitude alone. Several in a list add up, each with a frequency of its own where it has one.",
);
const PLUNGE: Field = Field::defaulted(
    "plunge",
    Kind::Tables(&PLUNGE_KEYS),
    Absent::Filled,
    "Displacement amplitude·sin(ωt + phase), up positive. `plunge = 0.1` is an amplitude alone. Several in a list add up.",
);
const ROTATION: Field = Field::optional(
    "rotation",
    Kind::Table(&ROTATION_KEYS),
    STILL,
    "Angle rate·t with the sign of pitch, `rotation = \"10 deg/s\"`.",
);
const TRANSLATION: Field = Field::optional(
    "translation",
    Kind::Table(&TRANSLATION_KEYS),
    STILL,
    "Displacement velocity·t, `translation = [0.1, 0]`.",
);
const TABLE: Field = Field::optional(
    "table",
    Kind::Table(&TABLE_KEYS),
    STILL,
    "Displacement and angle at given times, joined by cubic splines: lists, or a file `table = \"motion.csv\"`.",
);
const FORMULA: Field = Field::optional(
    "formula",
    Kind::Table(&FORMULA_KEYS),
    STILL,
    "Formulas in `t`, the time of the case (seconds, or lengths over sound speed without a dimensional free stream), with \
     `omega`, `pi`, `e`, `deg`, the operators `+ - * / ^` and the functions `sin`, `cos`, `tan`, `asin`, `acos`, `atan`, `sinh`, \
     `cosh`, `tanh`, `exp`, `ln`, `sqrt`, `abs`, `min`, `max`.",
);

const MODE: Field = Field::defaulted(
    "mode",
    Kind::Tables(&MODE_KEYS),
    Absent::Filled,
    "A mode of a flexible body: every point X goes q·φ(X) before all other parts, with the coordinate \
     q = amplitude·sin(ωt + phase). Needs a deforming cloud.",
);

pub(super) static MOTION: Table = Table::of(&[
    Field::defaulted(
        "particles",
        Kind::Words(PARTICLES),
        Absent::Word("deforming"),
        "How particles follow the bodies.",
    ),
    FREQUENCY,
    REDUCED_FREQUENCY,
    REDUCED_LENGTH,
    PERIOD,
    PIVOT,
    AXIS,
    PITCH,
    PLUNGE,
    ROTATION,
    TRANSLATION,
    TABLE,
    FORMULA,
    MODE,
]);

pub(super) static BODY_MOTION: Table = Table::of(&[
    FREQUENCY,
    REDUCED_FREQUENCY,
    REDUCED_LENGTH,
    PERIOD,
    PIVOT,
    AXIS,
    PITCH,
    PLUNGE,
    ROTATION,
    TRANSLATION,
    TABLE,
    FORMULA,
    MODE,
]);

const PARTICLES: &[(&str, &str)] = &[
    ("rigid", "the whole cloud moves as one with the body"),
    ("deforming", "the displacement of the surface is spread into the cloud, the far field stays where it is"),
    ("lagrangian", "particles travel with the fluid"),
];

const PHASE: Field =
    Field::defaulted("phase", ANGLE, Absent::Number(0.0), "Phase at t = 0; `\"90 deg\"` makes the sine a cosine.");

const OWN: &str = "that of the motion";
const OWN_FREQUENCY: Field = Field::optional(
    "frequency",
    Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE),
    OWN,
    "Frequency of this part alone; needs a dimensional free stream. Frequencies of one motion are whole multiples of a common one.",
);
const OWN_REDUCED_FREQUENCY: Field = Field::optional(
    "reduced_frequency",
    POSITIVE,
    OWN,
    "Reduced frequency of this part, with `reduced_length` of the motion.",
);
const OWN_PERIOD: Field =
    Field::optional("period", Kind::Quantity(Time::DIMENSION, Range::POSITIVE), OWN, "Period of this part instead.");

static PITCH_KEYS: Table = Table::of(&[
    Field::required("amplitude", ANGLE, "Amplitude."),
    PHASE,
    OWN_FREQUENCY,
    OWN_REDUCED_FREQUENCY,
    OWN_PERIOD,
])
.short("amplitude");

static PLUNGE_KEYS: Table = Table::of(&[
    Field::required("amplitude", LENGTH, "Amplitude of the displacement."),
    PHASE,
    Field::optional(
        "direction",
        DIRECTION,
        "up: +y in 2-D, +z in 3-D",
        "Direction of positive displacement; its length does not matter.",
    ),
    OWN_FREQUENCY,
    OWN_REDUCED_FREQUENCY,
    OWN_PERIOD,
])
.short("amplitude");

static ROTATION_KEYS: Table = Table::of(&[Field::required(
    "rate",
    Kind::Quantity(Rate::DIMENSION, Range::ANY),
    "Rate; a plain number is radians per unit of time.",
)])
.short("rate");

static TRANSLATION_KEYS: Table = Table::of(&[Field::required(
    "velocity",
    Kind::List(&List { item: Kind::Quantity(Velocity::DIMENSION, Range::ANY), min: 2, max: 3, single: false }),
    "Velocity.",
)])
.short("velocity");

const fn column(key: &'static str, item: &'static List, doc: &'static str) -> Field {
    Field::optional(key, Kind::List(item), "zero", doc)
}
static LENGTHS: List =
    List { item: Kind::Quantity(Length::DIMENSION, Range::ANY), min: 2, max: usize::MAX, single: false };
static ANGLES: List =
    List { item: Kind::Quantity(Angle::DIMENSION, Range::ANY), min: 2, max: usize::MAX, single: false };
static TIMES: List = List { item: Kind::Quantity(Time::DIMENSION, Range::ANY), min: 2, max: usize::MAX, single: false };

static TABLE_KEYS: Table = Table::of(&[
    Field::optional(
        "file",
        Kind::File,
        "the lists `time`, `x`, …",
        "CSV file, relative to the case file, with columns `time` and any of `x`, `y`, `z`, `angle_deg`, `angle_rad`.",
    ),
    Field::optional("time", Kind::List(&TIMES), "`file` must be given", "Times, rising."),
    column("x", &LENGTHS, "Displacements along x."),
    column("y", &LENGTHS, "Displacements along y."),
    column("z", &LENGTHS, "Displacements along z (3-D)."),
    column("angle", &ANGLES, "Angles, of the sign of pitch."),
    Field::defaulted(
        "periodic",
        Kind::Flag,
        Absent::Flag(false),
        "The table repeats, its last row is its first one a period later; else it begins and ends at rest and its \
             ends are held.",
    ),
])
.short("file");

pub(super) const MODE_FILE: Field = Field::required(
    "file",
    Kind::File,
    "CSV file of the shape, relative to the case file: columns `x`, `y` (`z`) of points of the body as placed, and `dx`, `dy` \
     (`dz`), their displacements when the coordinate is one.",
);

static MODE_KEYS: Table = Table::of(&[
    MODE_FILE,
    Field::required("amplitude", Kind::Number(Range::ANY), "Amplitude of the coordinate."),
    PHASE,
]);

static FORMULA_KEYS: Table = Table::of(&[
    Field::optional("x", Kind::Text, "zero", "Displacement along x, `x = \"0.1 * cos(omega * t)\"`."),
    Field::optional("y", Kind::Text, "zero", "Displacement along y."),
    Field::optional("z", Kind::Text, "zero", "Displacement along z (3-D)."),
    Field::optional(
        "angle",
        Kind::Text,
        "zero",
        "Angle in radians, of the sign of pitch: `\"2 * deg * sin(omega * t)\"`.",
    ),
]);

/// Condition of the gas on the surface of a body.
pub(super) const WALL: &[Variant] = &[
    Variant::word("slip", "the gas slides along the surface"),
    Variant::word("adiabatic", "the gas sticks to the surface, no heat passes; needs viscosity"),
    Variant::table(
        "temperature",
        &WALL_TEMPERATURE,
        "the gas sticks to a surface of this temperature; needs viscosity",
    ),
];

static WALL_TEMPERATURE: Table = Table::of(&[Field::required(
    "value",
    Kind::Quantity(super::quantity::Temperature::DIMENSION, Range::POSITIVE),
    "Temperature; over that of the free stream, without unit, when the free stream has none.",
)])
.short("value");
