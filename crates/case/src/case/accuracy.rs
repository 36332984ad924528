//! How well loads are to be known: the table `[accuracy]`.
use serde::{Deserialize, Serialize};

use super::quantity::{Ratio, WallTime};

/// How well the loads of a steady case are to be known, and which errors of other loads are told.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Accuracy {
    /// Half width of the error bars over the loads.
    pub loads: Ratio,
    /// Greatest number of particles.
    pub particles: usize,
    /// Wall-clock time within which the last cloud is to end.
    pub time: Option<WallTime>,
    /// Which errors of the loads of a march or a harmonic balance are told.
    #[serde(default)]
    pub error: LoadErrors,
}

/// Errors of the loads of a march or a harmonic balance that further runs tell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LoadErrors {
    /// None.
    #[default]
    None,
    /// That of the cloud.
    Cloud,
    /// That of the step in time of a march.
    Step,
    /// That of the number of harmonics of a balance.
    Harmonics,
    /// That of the cloud, and that of the step or of the number of harmonics.
    All,
}

impl Default for Accuracy {
    fn default() -> Self {
        Self { loads: Ratio(0.01), particles: 50_000, time: None, error: LoadErrors::None }
    }
}

impl Accuracy {
    /// Greatest number of particles of cases in space that do not say.
    pub const PARTICLES_IN_SPACE: usize = 250_000;

    /// Half width of the error bars over the loads that is asked of the points of a polar, in 2-D and 3-D: a step of many is judged beside
    /// its neighbours. In the plane 5 % is 5 counts of a drag near zero.
    pub const OF_POLARS: [f64; 2] = [0.05, 0.1];

    /// What is asked of a case that says nothing.
    pub fn in_dimension(dimension: usize) -> Self {
        let usual = Self::default();
        Self { particles: if dimension == 3 { Self::PARTICLES_IN_SPACE } else { usual.particles }, ..usual }
    }

    /// The same of a case with or without a polar.
    pub fn usual(dimension: usize, polar: bool) -> Self {
        let one = Self::in_dimension(dimension);
        Self { loads: if polar { Ratio(Self::OF_POLARS[dimension - 2]) } else { one.loads }, ..one }
    }
}
