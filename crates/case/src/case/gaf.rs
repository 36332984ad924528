//! Generalised aerodynamic forces, as data: modes, reduced frequencies and method.
use super::kinds::{POSITIVE, SIZE};
use super::motion::{BodyMotionSpec, ModeMotion, OwnFrequency, ParticleMotion, Pitch, Plunge};
use super::quantity::{Angle, Length, Ratio};
use super::schema::{Absent, Kind, List, Range, defaulted, keys, optional, required, words};
use super::structure::{Freedom, Structure, StructureMode, StructureModel};

/// Zero or more.
const NOT_NEGATIVE: Kind = Kind::Number(Range { min: 0.0, max: f64::INFINITY, closed: true });

const FOLLOWING: &[(&str, &str)] = &[
    ("rigid", "the whole cloud moves as one with the body"),
    ("deforming", "the displacement of the surface is spread into the cloud, the far field stays where it is"),
];

keys! {
    /// The table `[gaf]`: settings of the generalised aerodynamic forces.
    pub struct Gaf, GAF {
        /// Reduced frequencies k = ωL/U∞; 0 is a displacement at rest.
        reduced_frequencies: Vec<f64> = required(
            Kind::List(&List { item: NOT_NEGATIVE, min: 1, max: 64, single: true }),
        ),
        /// Length L of the reduced frequency.
        reduced_length: Option<Length> = optional(SIZE, "half of the reference chord"),
        /// Rigid modes, in the order of the columns; those of `[[gaf.mode]]` follow.
        modes: Vec<Mode> = defaulted(
            Kind::List(&List { item: Kind::Words(MODES), min: 0, max: 2, single: true }),
            Absent::Words(&["plunge", "pitch"]),
        ),
        /// A mode of a flexible body. Its cloud is always a deforming one.
        #[serde(default)]
        flexible as "mode": Vec<FlexibleMode> = defaulted(Kind::Tables(&FLEXIBLE), Absent::Filled),
        /// Point about which the body pitches and moments are taken.
        pivot: Option<Vec<Length>> = optional(
            Kind::List(&List { item: Kind::Quantity(Length::DIMENSION, Range::ANY), min: 2, max: 3, single: false }),
            "must be given for `pitch`",
        ),
        /// How forces are found.
        method: GafMethod = optional(
            Kind::Words(METHODS),
            "`linear`, or `balance` where there are `pitch`, `plunge`, `harmonics`, `linearity`, an `amplitude`, \
             or bodies with a motion of their own",
        ),
        /// Amplitude of pitch with `method = "balance"`. It is halved once to see whether forces are linear.
        pitch: Option<Angle> = optional(Kind::Quantity(Angle::DIMENSION, Range::ANY), "a quarter of a degree"),
        /// Amplitude of plunge with `method = "balance"`.
        plunge: Option<Length> = optional(SIZE, "0.005"),
        /// How particles follow plunge and pitch. With `method = "linear"` and a `[[gaf.mode]]` they always deform.
        particles: ParticleMotion = defaulted(Kind::Words(FOLLOWING), Absent::Word("rigid")),
        /// Number of harmonics with `method = "balance"`.
        harmonics: Option<u32> = optional(Kind::Integer(1, 16), "1"),
        /// Part by which forces may change when the amplitude is halved, with `method = "balance"`.
        linearity: Option<f64> = optional(Kind::Quantity(Ratio::DIMENSION, Range::POSITIVE), "0.005"),
        /// In small motions the limiter, and where it takes shocks to be, stay what they are in the steady flow. Else
        /// forces are those that the equations of a march have in a motion that is small enough.
        #[serde(default)]
        frozen_limiter: bool = defaulted(Kind::Flag, Absent::Flag(false)),
        /// Give every entry an error bar, from its change on a cloud with twice the spacing, and with 3/2 of it where
        /// there are shocks.
        cloud_error: bool = defaulted(Kind::Flag, Absent::Flag(true)),
    }
}

words! {
    /// Method by which generalised aerodynamic forces are computed.
    pub enum GafMethod, METHODS {
        /// small motion about one steady flow: a linear system for each mode and frequency
        Linear = "linear",
        /// two harmonic balances for each mode and frequency, with an amplitude and half of it
        Balance = "balance",
    }

    /// A rigid-body mode.
    pub enum Mode, MODES {
        /// displacement, up positive
        Plunge = "plunge",
        /// angle about the pivot, nose up positive
        Pitch = "pitch",
    }
}

keys! {
    /// A flexible mode.
    pub struct FlexibleMode, FLEXIBLE {
        /// Name of its row and column, and of its folders: letters, digits, `-` and `_`.
        name: String = required(Kind::Text),
        /// CSV file of the shape, relative to the case file: columns `x`, `y` (`z`) of points of the body as placed,
        /// and `dx`, `dy` (`dz`), their displacements when the coordinate is one.
        file: String = required(Kind::File),
        /// Amplitude of the coordinate with `method = "balance"`: displacements of half a per cent of the chord serve.
        amplitude: Option<f64> = optional(POSITIVE, "must be given for `method = \"balance\"`"),
    }
}

/// A mode of `[gaf]`, rigid or flexible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyMode<'a> {
    /// A rigid-body mode.
    Rigid(Mode),
    /// A flexible mode.
    Flexible(&'a FlexibleMode),
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
