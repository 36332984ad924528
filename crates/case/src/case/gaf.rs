//! Generalised aerodynamic forces, as data: modes, reduced frequencies and method.
use serde::{Deserialize, Serialize};

use super::{
    Angle, BodyMotionSpec, Freedom, Length, ModeMotion, OwnFrequency, ParticleMotion, Pitch, Plunge, Structure,
    StructureMode, StructureModel,
};

/// The table `[gaf]`: settings of the generalised aerodynamic forces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gaf {
    /// Reduced frequencies k = ωL/U∞.
    pub reduced_frequencies: Vec<f64>,
    /// Length L of the reduced frequency; absent: half the reference chord.
    pub reduced_length: Option<Length>,
    /// Rigid-body modes, in the order of the columns.
    pub modes: Vec<Mode>,
    /// Flexible modes, in the columns after the rigid-body modes.
    #[serde(default, rename = "mode")]
    pub flexible: Vec<FlexibleMode>,
    /// Centre of rotation of pitch, about which moments are taken.
    pub pivot: Option<Vec<Length>>,
    /// Method by which the forces are computed.
    pub method: GafMethod,
    /// Amplitude of pitch for the harmonic balance; absent: [`Self::PITCH`].
    pub pitch: Option<Angle>,
    /// Amplitude of plunge for the harmonic balance; absent: [`Self::PLUNGE`].
    pub plunge: Option<Length>,
    /// How the particles follow plunge and pitch.
    pub particles: ParticleMotion,
    /// Number of harmonics; absent: one.
    pub harmonics: Option<u32>,
    /// Relative change of a column on halving the amplitude above which it is reported as nonlinear; absent:
    /// [`Self::LINEARITY`].
    pub linearity: Option<f64>,
    /// True when the limiter keeps the values of the steady flow.
    #[serde(default)]
    pub frozen_limiter: bool,
    /// True when the matrices have error bars, computed on a cloud with twice the spacing.
    pub cloud_error: bool,
}

/// Method by which generalised aerodynamic forces are computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GafMethod {
    /// Linearisation about the steady flow: one linear system for each mode and frequency.
    Linear,
    /// Two harmonic balances for each mode and frequency, with the full and half the amplitude.
    Balance,
}

/// A rigid-body mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// Displacement, up positive.
    Plunge,
    /// Angle about the pivot, nose up positive.
    Pitch,
}

/// A flexible mode.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlexibleMode {
    /// Name of the mode.
    pub name: String,
    /// File of the mode shape, see [`super::read_mode`].
    pub file: String,
    /// Amplitude of the modal coordinate; required by the harmonic balance.
    pub amplitude: Option<f64>,
}

/// A mode of `[gaf]`, rigid or flexible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyMode<'a> {
    /// A rigid-body mode.
    Rigid(Mode),
    /// A flexible mode.
    Flexible(&'a FlexibleMode),
}

impl Mode {
    /// Name of the mode in the case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Plunge => "plunge",
            Self::Pitch => "pitch",
        }
    }
}

impl AnyMode<'_> {
    /// Name of the mode.
    pub fn name(&self) -> &str {
        match self {
            Self::Rigid(mode) => mode.name(),
            Self::Flexible(mode) => &mode.name,
        }
    }
}

impl Gaf {
    /// Default amplitude of pitch in a harmonic balance: a quarter of a degree, in radians.
    pub const PITCH: Angle = Angle(0.25 * std::f64::consts::PI / 180.0);
    /// Default amplitude of plunge in a harmonic balance, in units of the case.
    pub const PLUNGE: Length = Length(0.005);
    /// Default relative change of the forces that is permitted when the amplitude is halved.
    pub const LINEARITY: f64 = 0.005;

    /// All modes in the order of rows and columns.
    pub fn all_modes(&self) -> impl Iterator<Item = AnyMode<'_>> {
        self.modes.iter().map(|m| AnyMode::Rigid(*m)).chain(self.flexible.iter().map(AnyMode::Flexible))
    }
}

impl Gaf {
    /// The motion of one mode at the reduced frequency `k`, with `factor` times the amplitude of the table.
    pub fn motion_of(&self, mode: AnyMode<'_>, k: f64, factor: f64) -> BodyMotionSpec {
        let none = Angle(0.0);
        let mut law = BodyMotionSpec {
            reduced_frequency: Some(k),
            reduced_length: self.reduced_length,
            pivot: self.pivot.clone(),
            ..BodyMotionSpec::default()
        };
        match mode {
            AnyMode::Rigid(Mode::Pitch) => {
                let amplitude = Angle(factor * self.pitch.unwrap_or(Self::PITCH).0);
                law.pitch = vec![Pitch { amplitude, phase: none, own: OwnFrequency::default() }];
            }
            AnyMode::Rigid(Mode::Plunge) => {
                let amplitude = Length(factor * self.plunge.unwrap_or(Self::PLUNGE).0);
                law.plunge = vec![Plunge { amplitude, phase: none, direction: None, own: OwnFrequency::default() }];
            }
            AnyMode::Flexible(mode) => {
                let amplitude = factor * mode.amplitude.unwrap_or_default();
                law.modes = vec![ModeMotion { file: mode.file.clone(), amplitude, phase: none }];
            }
        }
        law
    }

    /// How particles follow the modes: those of flexible ones deform the cloud.
    pub fn particles_of<'a>(&self, mut modes: impl Iterator<Item = AnyMode<'a>>) -> ParticleMotion {
        match modes.any(|mode| matches!(mode, AnyMode::Flexible(_))) {
            true => ParticleMotion::Deforming,
            false => self.particles,
        }
    }

    /// The modes as coordinates of one structure in the order of the columns, with unit masses and stiffnesses.
    pub fn structure(&self) -> Structure {
        let freedom = |mode: &Mode| match mode {
            Mode::Plunge => Freedom::Plunge,
            Mode::Pitch => Freedom::Pitch,
        };
        let mode = |mode: &FlexibleMode| StructureMode::unit(&mode.name, &mode.file);
        Structure {
            free: self.modes.iter().map(freedom).collect(),
            pivot: self.pivot.clone(),
            modes: self.flexible.iter().map(mode).collect(),
            ..Structure::of(StructureModel::Floating)
        }
    }
}
