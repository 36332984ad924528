//! Quantities with units: placeholder, see the case module.
use serde::{Deserialize, Serialize};
macro_rules! q { ($($n:ident),*) => { $(
/// A quantity in base units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct $n(pub f64);
)* } }
q!(Angle, Density, Length, Pressure, Temperature, Time, Velocity);
