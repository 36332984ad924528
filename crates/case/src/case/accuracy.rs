//! Required accuracy of the loads: the table `[accuracy]`.
use serde::{Deserialize, Serialize};

use super::quantity::{Ratio, WallTime};

/// Required accuracy of the loads of a steady case, and the kinds of errors that are estimated in other cases.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Half-width of the error bars divided by the loads.
    pub loads: Ratio,
    /// Greatest number of particles.
    pub particles: usize,
    /// Wall-clock time within which the computation on the last cloud should end.
    pub time: Option<WallTime>,
    /// Errors of the loads of a time march or a harmonic balance that are estimated.
    #[serde(default)]
    pub error: LoadErrors,
}

/// Errors of the loads of a time march or a harmonic balance that are estimated by additional runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadErrors {
    /// No estimate.
    #[default]
    None,
    /// Error due to the spacing of the cloud.
    Cloud,
    /// Error due to the time step of a march.
    Step,
    /// Error due to the number of harmonics of a harmonic balance.
    Harmonics,
    /// Error due to the cloud, and error due to the time step or the number of harmonics.
    All,
}

impl Default for Accuracy {
    fn default() -> Self {
        Self { loads: Ratio(0.01), particles: 50_000, time: None, error: LoadErrors::None }
    }
}

impl Accuracy {
    /// Default limit of the number of particles in 3-D.
    pub const PARTICLES_IN_SPACE: usize = 250_000;

    /// Default of the relative half-width of the error bars for the points of a polar, in 2-D and 3-D. It is larger
    /// than for single cases, because a point is judged together with its neighbours. In 2-D, 5 % is 5 drag counts
    /// where the drag is near zero.
    pub const OF_POLARS: [f64; 2] = [0.05, 0.1];

    /// Defaults for a case of this dimension.
    pub fn in_dimension(dimension: usize) -> Self {
        let usual = Self::default();
        Self { particles: if dimension == 3 { Self::PARTICLES_IN_SPACE } else { usual.particles }, ..usual }
    }

    /// Defaults for a case with or without a polar.
    pub fn usual(dimension: usize, polar: bool) -> Self {
        let one = Self::in_dimension(dimension);
        Self { loads: if polar { Ratio(Self::OF_POLARS[dimension - 2]) } else { one.loads }, ..one }
    }
}
