//! Verification: what a case claims, how a result is measured, and whether the claim holds.
//!
//! A folder of `verification/` holds a case, its authority, reference curves and `claim.toml`. This module is the pure part:
//! [`claim`] reads the claims and judges values, [`metric`] names what they measure, [`metrics`] turns samples into values, [`curve`] reads reference tables, [`loops`] compares
//! periods, [`truth`] finds exact
//! solutions by name, [`wall`] holds the wall of a result, [`calibration`] holds error bars against exact loads.
//! It opens no file and runs nothing; `verification` does both.
pub mod calibration;
pub mod claim;
pub mod curve;
pub mod loops;
pub mod metric;
pub mod metrics;
mod parse;
pub mod truth;
pub mod wall;

pub use crate::case::ClaimRow;
pub use claim::{Claim, ClaimError, ClaimFile, Exact, Kind, Sample, Study};
pub use curve::{Curve, Table};
pub use loops::Loops;
pub use metric::Metric;
pub use truth::{FieldTruth, WallTruth};
pub use wall::Wall;
