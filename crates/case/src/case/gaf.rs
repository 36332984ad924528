//! Generalised aerodynamic forces: which modes at which frequencies, as data.
use serde::{Deserialize, Serialize};

use super::{
    Angle, BodyMotionSpec, Case, Freedom, HarmonicCount, Harmonics, Length, ModeMotion, Motion, OwnFrequency,
    ParticleMotion, Pitch, Plunge, SteadyMethod, Structure, StructureMode, StructureModel, Temporal,
};

/// The table `[gaf]`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gaf {
    /// Reduced frequencies k = ωL/U∞.
    pub reduced_frequencies: Vec<f64>,
    /// Length L; absent: half the reference chord.
    pub reduced_length: Option<Length>,
    /// Rigid modes, in the order of the columns.
    pub modes: Vec<Mode>,
    /// Modes of a flexible body, behind them.
    #[serde(default, rename = "mode")]
    pub flexible: Vec<FlexibleMode>,
    /// Point about which the body pitches, and moments are taken.
    pub pivot: Option<Vec<Length>>,
    /// How forces are found.
    pub method: GafMethod,
    /// Amplitude of pitch; absent: [`Self::PITCH`].
    pub pitch: Option<Angle>,
    /// Amplitude of plunge; absent: [`Self::PLUNGE`].
    pub plunge: Option<Length>,
    /// How particles follow plunge and pitch.
    pub particles: ParticleMotion,
    /// Number of harmonics; absent: one.
    pub harmonics: Option<u32>,
    /// Change of a column, when the amplitude is halved, above which it is told to be nonlinear; absent: [`Self::LINEARITY`].
    pub linearity: Option<f64>,
    /// The limiter stays what it is in the steady flow.
    #[serde(default)]
    pub frozen_limiter: bool,
    /// The entries of the matrices have error bars, from a cloud with twice the spacing.
    pub cloud_error: bool,
}

/// How forces are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum GafMethod {
    /// Small motion about one steady flow: a linear system for each mode and frequency.
    Linear,
    /// Two harmonic balances for each mode and frequency, with an amplitude and half of it.
    Balance,
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

/// A mode of a flexible body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FlexibleMode {
    /// Name.
    pub name: String,
    /// File of its shape, see [`super::read_mode`].
    pub file: String,
    /// Amplitude of its coordinate; there is one where forces are found by harmonic balance.
    pub amplitude: Option<f64>,
}

/// Any mode of `[gaf]`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyMode<'a> {
    /// Of a rigid body.
    Rigid(Mode),
    /// Of a flexible one.
    Flexible(&'a FlexibleMode),
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

impl AnyMode<'_> {
    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Self::Rigid(mode) => mode.name(),
            Self::Flexible(mode) => &mode.name,
        }
    }
}

impl Gaf {
    /// Amplitude of pitch in a harmonic balance unless the case says otherwise: a quarter of a degree, in radians.
    pub const PITCH: Angle = Angle(0.25 * std::f64::consts::PI / 180.0);
    /// Amplitude of plunge, in units of the case.
    pub const PLUNGE: Length = Length(0.005);
    /// Part by which forces may change when the amplitude is halved.
    pub const LINEARITY: f64 = 0.005;

    /// All modes, in the order of rows and columns.
    pub fn all_modes(&self) -> impl Iterator<Item = AnyMode<'_>> {
        self.modes.iter().map(|m| AnyMode::Rigid(*m)).chain(self.flexible.iter().map(AnyMode::Flexible))
    }
}

impl Case {
    /// The harmonic balance of one mode at reduced frequency `k`, with `factor` times the amplitude of `[gaf]`. The table stays
    /// in the case: its modes are those that forces are computed on.
    pub fn gaf_case(&self, gaf: &Gaf, mode: AnyMode<'_>, k: f64, factor: f64) -> Self {
        let (none, harmonics) = (Angle(0.0), gaf.harmonics.unwrap_or(1));
        let mut law = BodyMotionSpec {
            reduced_frequency: Some(k),
            reduced_length: gaf.reduced_length,
            pivot: gaf.pivot.clone(),
            ..BodyMotionSpec::default()
        };
        let mut particles = gaf.particles;
        match mode {
            AnyMode::Rigid(Mode::Pitch) => {
                let amplitude = Angle(factor * gaf.pitch.unwrap_or(Gaf::PITCH).0);
                law.pitch = vec![Pitch { amplitude, phase: none, own: OwnFrequency::default() }];
            }
            AnyMode::Rigid(Mode::Plunge) => {
                let amplitude = Length(factor * gaf.plunge.unwrap_or(Gaf::PLUNGE).0);
                law.plunge = vec![Plunge { amplitude, phase: none, direction: None, own: OwnFrequency::default() }];
            }
            AnyMode::Flexible(mode) => {
                particles = ParticleMotion::Deforming;
                let amplitude = factor * mode.amplitude.unwrap_or_default();
                law.modes = vec![ModeMotion { file: mode.file.clone(), amplitude, phase: none }];
            }
        }
        let mut case = self.clone();
        case.title = format!("{}: {} at k = {k}", self.title, mode.name());
        case.motion = Some(Motion { particles, law });
        case.reference.moment_point = gaf.pivot.clone().or(case.reference.moment_point);
        case.time = Temporal::Harmonics(Harmonics {
            number: HarmonicCount::Fixed(harmonics),
            oversample: 1.0,
            tail: 0.01,
            most: harmonics,
            orders: 5.0,
            tolerance: 1e-4,
            iterations: 500,
            march: 0,
            check: 0,
            method: SteadyMethod::NewtonKrylov,
            cfl: 10.0,
            cfl_max: 1e6,
            frequency: None,
            period: None,
        });
        case.output.report = false;
        case
    }

    /// The steady flow about which the forces of small motions in all modes of `gaf` are asked. All bodies share one structure, which
    /// stays where it is; its masses and springs have no part in the forces. A rigid cloud follows rigid modes alone.
    pub fn gaf_steady_case(&self, gaf: &Gaf) -> Self {
        let particles = if gaf.flexible.is_empty() { gaf.particles } else { ParticleMotion::Deforming };
        let mut case = self.settled_case(particles);
        if let Some(motion) = &mut case.motion {
            motion.law = BodyMotionSpec::default();
        }
        case.reference.moment_point = gaf.pivot.clone().or(case.reference.moment_point);
        case.structures = vec![gaf.structure()];
        case
    }
}

impl Gaf {
    /// The modes as coordinates of one structure, in the order of the columns, each with mass and spring of one.
    fn structure(&self) -> Structure {
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
