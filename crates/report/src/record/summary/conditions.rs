//! What a flow was computed for.
use serde::{Deserialize, Serialize};

use super::reference::ReferenceValues;
use crate::case::{Cloud, FreeStreamScales};

/// What was computed, and what results refer to.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Conditions {
    /// Title of the case.
    pub case: String,
    /// Run folder.
    pub run: String,
    /// Mach number of the free stream.
    pub mach: f64,
    /// Angle of attack in degrees, nose up positive.
    pub alpha_deg: f64,
    /// Reynolds number of the chord; null without viscosity.
    pub reynolds: Option<f64>,
    /// Density, pressure, speed, sound speed and Mach number of the free stream, and the ratio of specific heats.
    pub free_stream: FreeStream,
    /// Chord of the load coefficients.
    pub chord: f64,
    /// What loads are divided by; null without bodies.
    pub reference: Option<ReferenceValues>,
    /// The cloud of the end in the words of the case file, where the run refined it by what it found without that.
    pub cloud: Cloud,
    /// Time of the instant that `loads`, fields and pictures are of, in the units of the case; null of steady flows.
    pub loads_at: Option<f64>,
}

/// The free stream in the units of the case.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FreeStream {
    /// Density.
    pub density: f64,
    /// Speed of sound.
    pub sound_speed: f64,
    /// Static pressure.
    pub pressure: f64,
    /// Speed of the stream.
    pub speed: f64,
    /// Mach number.
    pub mach: f64,
    /// Ratio of specific heats.
    pub gamma: f64,
}

impl FreeStream {
    /// Of these scales, of a gas with this ratio of specific heats.
    pub fn of(scales: &FreeStreamScales, gamma: f64) -> Self {
        let FreeStreamScales { density, sound_speed, pressure, speed, mach } = *scales;
        Self { density, sound_speed, pressure, speed, mach, gamma }
    }
}
