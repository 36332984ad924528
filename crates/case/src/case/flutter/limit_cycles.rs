//! Limit cycles: of which coordinate, how large, with what accuracy, as data.
use serde::{Deserialize, Serialize};

use super::super::{Angle, Length};

/// The table `[lco]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LimitCycles {
    /// Mach number; absent: that of `[flow]`.
    pub mach: Option<f64>,
    /// Coordinate whose amplitude is given; absent: `pitch`, or the first one.
    pub coordinate: Option<String>,
    /// Least and greatest amplitude of an angle.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub amplitude: Vec<Angle>,
    /// Least and greatest amplitude of another coordinate.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub displacement: Vec<Length>,
    /// Number of amplitudes.
    pub points: u32,
    /// Greatest number of harmonics.
    pub harmonics: u32,
    /// Part by which more harmonics may change a speed.
    pub accuracy: f64,
    /// What the gas does.
    pub gas: GasResponse,
    /// The largest stable motion is marched in time as well.
    pub march: bool,
}

/// How the gas answers to a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GasResponse {
    /// As it does, by harmonic balance.
    Nonlinear,
    /// As it does to small motions.
    Linear,
}

impl LimitCycles {
    /// All amplitudes, rising, in base units.
    pub fn amplitudes(&self) -> Vec<f64> {
        let angles = self.amplitude.iter().map(|a| a.0);
        let ends: Vec<f64> = angles.chain(self.displacement.iter().map(|l| l.0)).collect();
        let [first, .., last] = ends[..] else { return ends };
        let n = self.points.max(2);
        (0..n).map(|k| first + (last - first) * f64::from(k) / f64::from(n - 1)).collect()
    }
}
