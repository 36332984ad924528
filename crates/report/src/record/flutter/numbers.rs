//! Numbers that JSON has no word for: it writes `null` where they are infinite or unknown.
use serde::{Deserialize, Deserializer};

/// A number that is infinite where the file has `null`.
pub(super) fn or_infinite<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Option::<f64>::deserialize(from).map(|x| x.unwrap_or(f64::INFINITY))
}

/// A number that is not known, NaN, where the file has `null`.
pub(super) fn or_unknown<'de, D: Deserializer<'de>>(from: D) -> Result<f64, D::Error> {
    Option::<f64>::deserialize(from).map(|x| x.unwrap_or(f64::NAN))
}

/// Three numbers, each NaN where the file has `null`.
pub(super) fn each_or_unknown<'de, D: Deserializer<'de>>(from: D) -> Result<[f64; 3], D::Error> {
    <[Option<f64>; 3]>::deserialize(from).map(|all| all.map(|x| x.unwrap_or(f64::NAN)))
}
