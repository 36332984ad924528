//! Limit cycles: periodic motions of given size, and what marches from them end with.
use serde::{Deserialize, Serialize};

use super::numbers::or_infinite;

/// A limit cycle.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct LimitCycle {
    /// Mach number.
    pub mach: f64,
    /// Number of the branch, from 1.
    pub branch: usize,
    /// Coordinate whose amplitude is told.
    pub coordinate: String,
    /// Amplitude of its first harmonic, of angles in degrees.
    pub amplitude: f64,
    /// Speed over that of the structure in the case.
    pub speed_ratio: f64,
    /// V_f, where the structure has one.
    pub speed_index: Option<f64>,
    /// V*, the same times the root of the mass ratio.
    pub reduced_speed: Option<f64>,
    /// Speed in the units of the case.
    pub speed: f64,
    /// Density, dynamic pressure and, where that is varied, altitude in metres.
    pub density: f64,
    /// See density.
    pub dynamic_pressure: f64,
    /// See density.
    pub altitude: Option<f64>,
    /// k.
    pub reduced_frequency: f64,
    /// Cycles per unit of time of the case.
    pub frequency: f64,
    /// True where smaller and larger motions go to it.
    pub stable: bool,
    /// Mean of the coordinate, of angles in degrees.
    pub mean: f64,
    /// Means of all coordinates in base units.
    pub means: Vec<f64>,
    /// Harmonics.
    pub harmonics: usize,
    /// Relative change of the speed with the last of them; infinite where none were added.
    #[serde(deserialize_with = "or_infinite")]
    pub error: f64,
    /// Harmonic balances of the gas.
    pub balances: usize,
    /// Amplitudes of all coordinates, harmonic by harmonic: real and imaginary part in base units.
    pub motion: Vec<Vec<[f64; 2]>>,
    /// True where a harmonic lies beyond the frequencies that forces were computed at.
    pub extrapolated: bool,
    /// What a march from it ends with, where there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub march: Option<MarchedCycle>,
}

/// What a march from a limit cycle ends with.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct MarchedCycle {
    /// Amplitude of the first harmonic of the coordinate over the last period, of angles in degrees.
    pub amplitude: f64,
    /// Mean over it, of angles in degrees.
    pub mean: f64,
    /// Frequency in cycles per unit of time of the case.
    pub frequency: f64,
    /// Periods that were marched.
    pub periods: f64,
    /// Amplitude over that of the balance, less one.
    pub difference: f64,
    /// Change of the amplitude in the last period, over it.
    pub change: f64,
    /// Processor seconds.
    pub cpu_seconds: f64,
}
