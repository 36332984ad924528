//! The keys of `[gaf]`.
use super::kinds::{FROZEN_LIMITER, POSITIVE, SIZE};
use super::motion_keys::MODE_FILE;
use super::quantity::{Angle, Length, Ratio};
use super::schema::{Absent, Field, Kind, List, Range, Table};

/// Zero or more.
const NOT_NEGATIVE: Kind = Kind::Number(Range { min: 0.0, max: f64::INFINITY, closed: true });

pub(super) static GAF: Table = Table::of(&[
    Field::required(
        "reduced_frequencies",
        Kind::List(&List { item: NOT_NEGATIVE, min: 1, max: 64, single: true }),
        "Reduced frequencies k = ωL/U∞; 0 is a displacement at rest.",
    ),
    Field::optional("reduced_length", SIZE, "half of the reference chord", "Length L of the reduced frequency."),
    Field::defaulted(
        "modes",
        Kind::List(&List { item: Kind::Words(MODES), min: 0, max: 2, single: true }),
        Absent::Words(&["plunge", "pitch"]),
        "Rigid modes, in the order of the columns; those of `[[gaf.mode]]` follow.",
    ),
    Field::defaulted(
        "mode",
        Kind::Tables(&FLEXIBLE),
        Absent::Filled,
        "A mode of a flexible body. Its cloud is always a deforming one.",
    ),
    Field::optional(
        "pivot",
        Kind::List(&List { item: Kind::Quantity(Length::DIMENSION, Range::ANY), min: 2, max: 3, single: false }),
        "must be given for `pitch`",
        "Point about which the body pitches and moments are taken.",
    ),
    Field::optional(
        "method",
        Kind::Words(METHODS),
        "`linear`, or `balance` where there are `pitch`, `plunge`, `harmonics`, `linearity`, an `amplitude`, or bodies with a motion of \
         their own",
        "How forces are found.",
    ),
    Field::optional(
        "pitch",
        Kind::Quantity(Angle::DIMENSION, Range::ANY),
        "a quarter of a degree",
        "Amplitude of pitch with `method = \"balance\"`. It is halved once to see whether forces are linear.",
    ),
    Field::optional("plunge", SIZE, "0.005", "Amplitude of plunge with `method = \"balance\"`."),
    Field::defaulted(
        "particles",
        Kind::Words(FOLLOWING),
        Absent::Word("rigid"),
        "How particles follow plunge and pitch. With `method = \"linear\"` and a `[[gaf.mode]]` they always deform.",
    ),
    Field::optional("harmonics", Kind::Integer(1, 16), "1", "Number of harmonics with `method = \"balance\"`."),
    Field::optional(
        "linearity",
        Kind::Quantity(Ratio::DIMENSION, Range::POSITIVE),
        "0.005",
        "Part by which forces may change when the amplitude is halved, with `method = \"balance\"`.",
    ),
    FROZEN_LIMITER,
    Field::defaulted(
        "cloud_error",
        Kind::Flag,
        Absent::Flag(true),
        "Give every entry an error bar, from its change on a cloud with twice the spacing, and with 3/2 of it where there are shocks.",
    ),
]);

static FLEXIBLE: Table = Table::of(&[
    Field::required(
        "name",
        Kind::Text,
        "Name of its row and column, and of its folders: letters, digits, `-` and `_`.",
    ),
    MODE_FILE,
    Field::optional(
        "amplitude",
        POSITIVE,
        "must be given for `method = \"balance\"`",
        "Amplitude of the coordinate with `method = \"balance\"`: displacements of half a per cent of the chord serve.",
    ),
]);

const METHODS: &[(&str, &str)] = &[
    ("linear", "small motion about one steady flow: a linear system for each mode and frequency"),
    ("balance", "two harmonic balances for each mode and frequency, with an amplitude and half of it"),
];

const MODES: &[(&str, &str)] =
    &[("plunge", "displacement, up positive"), ("pitch", "angle about the pivot, nose up positive")];

const FOLLOWING: &[(&str, &str)] = &[
    ("rigid", "the whole cloud moves as one with the body"),
    ("deforming", "the displacement of the surface is spread into the cloud, the far field stays where it is"),
];
