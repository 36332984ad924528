//! Generalised aerodynamic forces: which modes at which frequencies, as data.
use serde::{Deserialize, Serialize};

use super::{
    Angle, BodyMotion, Case, HarmonicCount, Harmonics, Length, Motion, ParticleMotion, Pitch, Plunge, SteadyMethod,
    Temporal,
};

/// The table `[gaf]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gaf {
    /// Reduced frequencies k = ωL/U∞.
    pub reduced_frequencies: Vec<f64>,
    /// Length L; absent: half the reference chord.
    pub reduced_length: Option<Length>,
    /// Modes, in the order of the columns.
    pub modes: Vec<Mode>,
    /// Point about which the body pitches, and moments are taken.
    pub pivot: Option<Vec<Length>>,
    /// Amplitude of pitch.
    pub pitch: Angle,
    /// Amplitude of plunge.
    pub plunge: Length,
    /// How particles follow.
    pub particles: ParticleMotion,
    /// Number of harmonics.
    pub harmonics: u32,
    /// Change of a column, when the amplitude is halved, above which it is told to be nonlinear.
    pub linearity: f64,
}

/// A mode of a rigid body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Displacement, up positive.
    Plunge,
    /// Angle about the pivot, nose up positive.
    Pitch,
}

impl Mode {
    /// The word of the case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plunge => "plunge",
            Self::Pitch => "pitch",
        }
    }
}

impl Case {
    /// The harmonic balance of one mode at reduced frequency `k`, with `factor` times the amplitude of `[gaf]`.
    pub fn gaf_case(&self, gaf: &Gaf, mode: Mode, k: f64, factor: f64) -> Self {
        let none = Angle(0.0);
        let pitch = Pitch { amplitude: Angle(factor * gaf.pitch.0), phase: none };
        let plunge = Plunge { amplitude: Length(factor * gaf.plunge.0), phase: none, direction: None };
        let law = BodyMotion {
            reduced_frequency: Some(k),
            reduced_length: gaf.reduced_length,
            pivot: gaf.pivot.clone(),
            pitch: (mode == Mode::Pitch).then_some(pitch),
            plunge: (mode == Mode::Plunge).then_some(plunge),
            ..BodyMotion::default()
        };
        let mut case = self.clone();
        case.title = format!("{}: {} at k = {k}", self.title, mode.name());
        case.motion = Some(Motion { particles: gaf.particles, law });
        case.reference.moment_point = gaf.pivot.clone().or(case.reference.moment_point);
        case.time = Temporal::Harmonics(Harmonics {
            number: HarmonicCount::Fixed(gaf.harmonics),
            oversample: 1.0,
            tail: 0.01,
            most: gaf.harmonics,
            orders: 5.0,
            tolerance: 1e-4,
            iterations: 500,
            method: SteadyMethod::NewtonKrylov,
            cfl: 10.0,
            cfl_max: 1e6,
        });
        case.gaf = None;
        case.output.report = false;
        case
    }
}
