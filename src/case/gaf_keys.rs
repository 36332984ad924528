//! The keys of `[gaf]`.
use super::kinds::{POSITIVE, SIZE};
use super::motion_keys::MODE_FILE;
use super::quantity::{Angle, Length};
use super::schema::{Absent, Field, Kind, List, Range, Table};

pub(super) static GAF: Table = Table::of(&[
    Field::required(
        "reduced_frequencies",
        Kind::List(&List { item: POSITIVE, min: 1, max: 64, single: true }),
        "Reduced frequencies k = ωL/U∞.",
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
    Field::defaulted(
        "pitch",
        Kind::Quantity(Angle::DIMENSION, Range::ANY),
        Absent::Number(0.25 * std::f64::consts::PI / 180.0),
        "Amplitude of pitch: a quarter of a degree unless it says otherwise. It is halved once to see whether forces are linear.",
    ),
    Field::defaulted("plunge", SIZE, Absent::Number(0.005), "Amplitude of plunge."),
    Field::defaulted(
        "particles",
        Kind::Words(FOLLOWING),
        Absent::Word("rigid"),
        "How particles follow plunge and pitch.",
    ),
    Field::defaulted("harmonics", Kind::Integer(1, 16), Absent::Integer(1), "Number of harmonics."),
    Field::defaulted(
        "linearity",
        POSITIVE,
        Absent::Number(0.005),
        "Part by which forces may change when the amplitude is halved.",
    ),
]);

static FLEXIBLE: Table = Table::of(&[
    Field::required(
        "name",
        Kind::Text,
        "Name of its row and column, and of its folders: letters, digits, `-` and `_`.",
    ),
    MODE_FILE,
    Field::required(
        "amplitude",
        POSITIVE,
        "Amplitude of the coordinate: displacements of half a per cent of the chord serve.",
    ),
]);

const MODES: &[(&str, &str)] =
    &[("plunge", "displacement, up positive"), ("pitch", "angle about the pivot, nose up positive")];

const FOLLOWING: &[(&str, &str)] = &[
    ("rigid", "the whole cloud moves as one with the body"),
    ("deforming", "the displacement of the surface is spread into the cloud, the far field stays where it is"),
];
