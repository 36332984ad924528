//! The keys of `[flutter]` and `[lco]`.
use super::super::kinds::{FROZEN_LIMITER, POSITIVE, SIZE};
use super::super::quantity::{Angle, Ratio, Velocity};
use super::super::schema::{Absent, Field, Kind, List, Range, Table};

pub(in super::super) static FLUTTER: Table = Table::of(&[
    Field::optional(
        "mach",
        Kind::List(&List { item: POSITIVE, min: 1, max: 64, single: true }),
        "that of `[flow]`",
        "Mach numbers at which the boundary is sought.",
    ),
    Field::optional(
        "reduced_frequencies",
        Kind::List(&List { item: POSITIVE, min: 2, max: 64, single: false }),
        "0.02, 0.08, 0.2 and 0.5",
        "Reduced frequencies k = ωb/U∞, b half of the reference chord, at which forces are computed first; zero is always among them. \
         More are added near each crossing.",
    ),
    Field::defaulted(
        "match",
        Kind::Words(MATCHING),
        Absent::Word("none"),
        "What is varied at a Mach number until a motion neither grows nor decays.",
    ),
    Field::defaulted(
        "most",
        Kind::Number(Range { min: 0.0, max: 1000.0, closed: false }),
        Absent::Number(4.0),
        "Greatest speed that is looked at, over that of the structure (`reduced_speed`, `speed_index`, or the free stream); with \
         `match = \"density\"` greatest density over that of the case. Altitudes are looked at from 5 km below the sea.",
    ),
    Field::defaulted(
        "accuracy",
        PART,
        Absent::Number(0.005),
        "Part by which a speed may change when a frequency is left out.",
    ),
    Field::defaulted(
        "frequencies",
        Kind::Integer(3, 64),
        Absent::Integer(12),
        "Greatest number of frequencies at a Mach number.",
    ),
    Field::defaulted(
        "trim",
        Kind::Flag,
        Absent::Flag(false),
        "Forces are those about the static equilibrium of structure and gas at the first crossing, which is sought with it; else about the \
         bodies as drawn.",
    ),
    Field::defaulted(
        "state_space",
        Kind::Flag,
        Absent::Flag(false),
        "Write the structure in the stream as a linear system of first order as well, at the first crossing of each Mach number.",
    ),
    FROZEN_LIMITER,
    Field::defaulted(
        "cloud_error",
        Kind::Flag,
        Absent::Flag(true),
        "Tell the error that the spacing leaves in each speed, from a cloud with twice of it, and with 3/2 of it where there are shocks, and where it decides whether motions grow.",
    ),
    Field::optional(
        "design_speed",
        Kind::Quantity(Velocity::DIMENSION, Range::POSITIVE),
        "no margins",
        "Design speed V_D, an equivalent airspeed (EAS): margins are told against it, and whether 1.15 V_D are free of flutter and divergence.",
    ),
]);

const MATCHING: &[(&str, &str)] = &[
    ("none", "the speed, and the sound speed with it, at the density of the case"),
    ("density", "the density, at the sound speed of the case: a wind tunnel"),
    ("altitude", "the altitude in the standard atmosphere of 1976: speed, density and Mach number belong together"),
];

/// Part of a number.
const PART: Kind = Kind::Quantity(Ratio::DIMENSION, Range { min: 0.0, max: 0.2, closed: false });
const TURN: Kind = Kind::Quantity(Angle::DIMENSION, Range::POSITIVE);

pub(in super::super) static LIMIT_CYCLES: Table = Table::of(&[
    Field::optional("mach", POSITIVE, "that of `[flow]`", "Mach number."),
    Field::optional(
        "coordinate",
        Kind::Text,
        "`pitch`, else the first one",
        "Coordinate whose amplitude is given: the first harmonic of it.",
    ),
    Field::optional(
        "amplitude",
        Kind::List(&List { item: TURN, min: 2, max: 2, single: false }),
        "`displacement` must be given",
        "Least and greatest amplitude of a coordinate that is an angle, `[\"0.25 deg\", \"4 deg\"]`.",
    ),
    Field::optional(
        "displacement",
        Kind::List(&List { item: SIZE, min: 2, max: 2, single: false }),
        "`amplitude` must be given",
        "Least and greatest amplitude of a coordinate that is a length, or of a mode, of which one is what its file has.",
    ),
    Field::defaulted("points", Kind::Integer(2, 200), Absent::Integer(6), "Number of amplitudes."),
    Field::defaulted(
        "harmonics",
        Kind::Integer(1, 15),
        Absent::Integer(5),
        "Greatest number of harmonics; as many are taken as `accuracy` asks for.",
    ),
    Field::defaulted("accuracy", PART, Absent::Number(0.005), "Part by which two more harmonics may change a speed."),
    Field::defaulted(
        "gas",
        Kind::Words(GAS),
        Absent::Word("nonlinear"),
        "What the gas does in motions that are not small.",
    ),
    Field::defaulted(
        "march",
        Kind::Flag,
        Absent::Flag(false),
        "March in time from the largest stable motion that was found, until its amplitude settles, and tell by how much it differs.",
    ),
]);

const GAS: &[(&str, &str)] = &[
    ("nonlinear", "what it does: harmonic balance at each amplitude, some of them a point"),
    ("linear", "what it does in small motions: springs alone limit the motion"),
];
