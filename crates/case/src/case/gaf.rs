//! Generalised aerodynamic forces, as data: modes, reduced frequencies and method.
use serde::{Deserialize, Serialize};

use super::{
    Angle, BodyMotionSpec, Case, Freedom, HarmonicCount, Harmonics, Length, ModeMotion, Motion, OwnFrequency,
    ParticleMotion, Pitch, Plunge, SteadyMethod, Structure, StructureMode, StructureModel, Temporal,
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

impl Case {
    /// The harmonic balance of one mode at the reduced frequency `k`, with `factor` times the amplitude of `[gaf]`. The
    /// case keeps the table, because generalised forces are evaluated for its modes.
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

    /// The steady case about which the forces in all modes of `gaf` are linearised. All bodies belong to one structure
    /// at rest, whose masses and springs do not affect the forces. If all modes are rigid-body modes, the cloud moves
    /// rigidly.
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
    /// The modes as coordinates of one structure in the order of the columns, with unit masses and stiffnesses.
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
