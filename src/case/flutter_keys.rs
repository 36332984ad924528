//! The keys of `[flutter]`.
use super::kinds::POSITIVE;
use super::schema::{Absent, Field, Kind, List, Range, Table};

pub(super) static FLUTTER: Table = Table::of(&[
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
        "most",
        Kind::Number(Range { min: 0.0, max: 1000.0, closed: false }),
        Absent::Number(4.0),
        "Greatest speed that is looked at, over that of the structure (`reduced_speed`, `speed_index`, or the free stream).",
    ),
    Field::defaulted(
        "accuracy",
        Kind::Number(Range { min: 0.0, max: 0.2, closed: false }),
        Absent::Number(0.005),
        "Part by which a speed may change when a frequency is left out.",
    ),
    Field::defaulted(
        "frequencies",
        Kind::Integer(3, 64),
        Absent::Integer(12),
        "Greatest number of frequencies at a Mach number.",
    ),
]);
