//! Kinds of values that keys of several tables share.
use super::quantity::{Angle, Length, Ratio};
use super::schema::{Kind, List, Range};

pub(super) const POSITIVE: Kind = Kind::Number(Range::POSITIVE);
pub(super) const LENGTH: Kind = Kind::Quantity(Length::DIMENSION, Range::ANY);
pub(super) const SIZE: Kind = Kind::Quantity(Length::DIMENSION, Range::POSITIVE);
pub(super) const ANGLE: Kind = Kind::Quantity(Angle::DIMENSION, Range::ANY);
pub(super) const COUNT: Kind = Kind::Integer(1, u32::MAX as u64);
pub(super) const POINT: Kind = Kind::List(&List { item: LENGTH, min: 2, max: 3, single: false });
pub(super) const PLANE_POINT: Kind =
    Kind::List(&List { item: Kind::Number(Range::ANY), min: 2, max: 2, single: false });
/// A small part of a number.
pub(super) const PART: Kind = Kind::Quantity(Ratio::DIMENSION, Range { min: 0.0, max: 0.2, closed: false });
