//! Kinds of values that keys of several tables share.
use super::quantity::{Angle, Length};
use super::schema::{Absent, Field, Kind, List, Range};

pub(super) const POSITIVE: Kind = Kind::Number(Range::POSITIVE);
pub(super) const LENGTH: Kind = Kind::Quantity(Length::DIMENSION, Range::ANY);
pub(super) const SIZE: Kind = Kind::Quantity(Length::DIMENSION, Range::POSITIVE);
pub(super) const ANGLE: Kind = Kind::Quantity(Angle::DIMENSION, Range::ANY);
pub(super) const COUNT: Kind = Kind::Integer(1, u32::MAX as u64);
pub(super) const POINT: Kind = Kind::List(&List { item: LENGTH, min: 2, max: 3, single: false });
pub(super) const PLANE_POINT: Kind =
    Kind::List(&List { item: Kind::Number(Range::ANY), min: 2, max: 2, single: false });

/// Of small motions.
pub(super) const FROZEN_LIMITER: Field = Field::defaulted(
    "frozen_limiter",
    Kind::Flag,
    Absent::Flag(false),
    "In small motions the limiter, and where it takes shocks to be, stay what they are in the steady flow. Else forces are those that \
     the equations of a march have in a motion that is small enough.",
);
