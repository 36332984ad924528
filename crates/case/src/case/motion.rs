//! Motion of bodies and particles, as data.
//!
//! A motion is a sum of parts: the angles add up to θ(t) about one axis through the pivot, the displacements to d(t). A
//! point X of the body in its initial placement is at x(t) = R(θ)(X + Σ q φ(X) − pivot) + pivot + d, with the shapes φ
//! and the coordinates q of its modes. Sines are amplitude·sin(ωt + phase): α = α_m + α_0 sin ωt as in the AGARD cases,
//! with the mean α_m from `flow.alpha` or
//! `rotate`. Pitch is nose up positive and plunge is up positive.
use serde::{Deserialize, Serialize};

use super::{Angle, Case, Flow, Frequency, Length, Rate, Shape, Temporal, Time, Velocity};

/// The table `[motion]`: motion of the particles, and motion of every body without a motion of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Motion {
    /// How the particles follow the bodies.
    pub particles: ParticleMotion,
    /// Motion of every body without a motion of its own; without bodies, motion of the cloud.
    #[serde(flatten)]
    pub law: BodyMotionSpec,
}

/// How the particles follow the bodies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ParticleMotion {
    /// The whole cloud moves rigidly with the body.
    Rigid,
    /// The displacement of the surface is continued into the cloud and decays towards the far field.
    #[default]
    Deforming,
    /// The particles move with the fluid (Lagrangian).
    Lagrangian,
}

/// Motion of one body as the sum of its parts; without parts the body is at rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BodyMotionSpec {
    /// Frequency of pitch, plunge and modes.
    pub frequency: Option<Frequency>,
    /// Reduced frequency k = ωL/U∞, an alternative to `frequency`.
    pub reduced_frequency: Option<f64>,
    /// Length L of the reduced frequency; absent: half the reference chord.
    pub reduced_length: Option<Length>,
    /// Period 2π/ω, an alternative to `frequency`.
    pub period: Option<Time>,
    /// Centre of rotation in the initial placement; it moves with the displacement.
    pub pivot: Option<Vec<Length>>,
    /// Axis of rotation in 3-D, right-handed; absent: +y, which is nose up positive for a stream along +x with lift
    /// along +z.
    pub axis: Option<Vec<f64>>,
    /// Sinusoidal rotations.
    #[serde(default)]
    pub pitch: Vec<Pitch>,
    /// Sinusoidal displacements.
    #[serde(default)]
    pub plunge: Vec<Plunge>,
    /// Rotation at a constant rate.
    pub rotation: Option<Rotation>,
    /// Translation at a constant velocity.
    pub translation: Option<Translation>,
    /// Tabulated displacement and angle.
    pub table: Option<MotionTable>,
    /// Displacement and angle as formulas of time.
    pub formula: Option<MotionFormula>,
    /// Modes of a flexible body.
    #[serde(default, rename = "mode")]
    pub modes: Vec<ModeMotion>,
}

/// Prescribed motion of a mode: coordinate q(t) = amplitude·sin(ωt + phase) and the file of the shape φ.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ModeMotion {
    /// CSV file of points and displacements, see [`super::read_mode`].
    pub file: String,
    /// Amplitude of the coordinate.
    pub amplitude: f64,
    /// Phase at t = 0.
    pub phase: Angle,
}

/// Sinusoidal rotation θ(t) = amplitude·sin(ωt + phase), nose up positive.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pitch {
    /// Amplitude.
    pub amplitude: Angle,
    /// Phase at t = 0.
    pub phase: Angle,
    /// Frequency of this part, if it differs from that of the motion.
    #[serde(flatten)]
    pub own: OwnFrequency,
}

/// Sinusoidal displacement d(t) = amplitude·sin(ωt + phase)·direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plunge {
    /// Amplitude of the displacement.
    pub amplitude: Length,
    /// Phase at t = 0.
    pub phase: Angle,
    /// Direction of positive displacement, normalised; absent: up, +y in 2-D and +z in 3-D.
    pub direction: Option<Vec<f64>>,
    /// Frequency of this part, if it differs from that of the motion.
    #[serde(flatten)]
    pub own: OwnFrequency,
}

/// Frequency of one part of a motion; absent: that of the motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OwnFrequency {
    /// Frequency.
    pub frequency: Option<Frequency>,
    /// Reduced frequency k = ωL/U∞ with the length L of the motion, an alternative to `frequency`.
    pub reduced_frequency: Option<f64>,
    /// Period 2π/ω, an alternative to `frequency`.
    pub period: Option<Time>,
}

/// θ(t) = rate·t.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rotation {
    /// Angular velocity, positive in the same sense as pitch.
    pub rate: Rate,
}

/// d(t) = velocity·t.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Translation {
    /// Velocity.
    pub velocity: Vec<Velocity>,
}

/// Displacement and angle at given times, interpolated by cubic splines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MotionTable {
    /// CSV file in place of the lists, with the columns `time` and any of `x`, `y`, `z`, `angle_deg`, `angle_rad`.
    pub file: Option<String>,
    /// Times in ascending order.
    pub time: Option<Vec<Time>>,
    /// Displacements along x.
    pub x: Option<Vec<Length>>,
    /// Displacements along y.
    pub y: Option<Vec<Length>>,
    /// Displacements along z.
    pub z: Option<Vec<Length>>,
    /// Angles.
    pub angle: Option<Vec<Angle>>,
    /// True when the table repeats; otherwise the motion starts and ends with zero velocity and stays at its end
    /// positions.
    pub periodic: bool,
}

/// Displacements and angle (radians) as formulas of the time `t` of the case.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MotionFormula {
    /// Displacement along x.
    pub x: Option<String>,
    /// Displacement along y.
    pub y: Option<String>,
    /// Displacement along z.
    pub z: Option<String>,
    /// Angle in radians.
    pub angle: Option<String>,
}

impl BodyMotionSpec {
    /// True when no part of the motion moves the body.
    pub fn is_still(&self) -> bool {
        self.pitch.is_empty()
            && self.plunge.is_empty()
            && self.rotation.is_none()
            && self.translation.is_none()
            && self.table.is_none()
            && self.formula.is_none()
            && self.modes.is_empty()
    }

    /// Angular frequency ω of this table alone in units of the case; `chord` is the reference chord, half of which is
    /// the default length of k.
    fn own_angular_frequency(&self, flow: &Flow, chord: f64) -> Option<f64> {
        let own =
            OwnFrequency { frequency: self.frequency, reduced_frequency: self.reduced_frequency, period: self.period };
        own.angular(self, flow, chord)
    }
}

impl OwnFrequency {
    /// Angular frequency ω in units of the case for a part of the motion `law`.
    fn angular(&self, law: &BodyMotionSpec, flow: &Flow, chord: f64) -> Option<f64> {
        if let Some(k) = self.reduced_frequency {
            let length = law.reduced_length.map_or(0.5 * chord, |l| l.0);
            return Some(k * flow.reference().speed / length);
        }
        self.frequency.map(|f| f.0).or(self.period.map(|t| std::f64::consts::TAU / t.0))
    }
}

impl Case {
    /// Motion of body number `body`: its own, or that of `[motion]`; `None` when the body is at rest.
    pub fn motion_of(&self, body: usize) -> Option<&BodyMotionSpec> {
        let own = self.bodies.get(body).and_then(|b| b.motion.as_ref());
        own.or(self.motion.as_ref().map(|m| &m.law)).filter(|law| !law.is_still())
    }

    /// Angular frequency of `law` in units of the case (rad/s when dimensional): its own, or that of `[motion]`.
    pub fn angular_frequency(&self, law: &BodyMotionSpec, chord: f64) -> Option<f64> {
        let general = || self.motion.as_ref().and_then(|m| m.law.own_angular_frequency(&self.flow, chord));
        law.own_angular_frequency(&self.flow, chord).or_else(general)
    }

    /// Angular frequency of one part of `law`: its own, or that of the motion.
    pub fn part_frequency(&self, part: &OwnFrequency, law: &BodyMotionSpec, chord: f64) -> Option<f64> {
        part.angular(law, &self.flow, chord).or_else(|| self.angular_frequency(law, chord))
    }

    /// True when a body deforms.
    pub fn bends(&self) -> bool {
        (0..self.bodies.len()).any(|i| self.motion_of(i).is_some_and(|law| !law.modes.is_empty()))
    }

    /// How the particles follow the bodies.
    pub fn particles(&self) -> ParticleMotion {
        match self.motion.as_ref().map(|m| m.particles).unwrap_or_default() {
            ParticleMotion::Rigid if self.has_gas() && self.solids().next().is_some() => ParticleMotion::Deforming,
            given => given,
        }
    }

    /// Names of all files other than the case file that a run reads.
    pub fn files(&self) -> impl Iterator<Item = &str> {
        let shapes = self.bodies.iter().flat_map(|body| match &body.shape {
            Shape::Airfoil(file) | Shape::Surface(file) => [Some(file.as_str()), None],
            Shape::Wing(wing) => [wing.airfoil.as_deref(), wing.tip_airfoil.as_deref()],
            _ => [None; 2],
        });
        let shapes = shapes.flatten();
        let laws = self.bodies.iter().filter_map(|b| b.motion.as_ref()).chain(self.motion.as_ref().map(|m| &m.law));
        let tables = laws.clone().filter_map(|law| law.table.as_ref()?.file.as_deref());
        let modes = laws.flat_map(|law| &law.modes).map(|mode| mode.file.as_str());
        let balanced = self.gaf.iter().filter(|_| matches!(self.time, Temporal::Harmonics(_)));
        let forces = balanced.flat_map(|g| &g.flexible).map(|mode| mode.file.as_str());
        let elastic = self.structures.iter().flat_map(|s| &s.modes).map(|mode| mode.file.as_str());
        shapes.chain(tables).chain(modes).chain(forces).chain(elastic)
    }

    /// True when particles move: a body does, the whole cloud does, or they travel with the fluid.
    pub fn moves(&self) -> bool {
        let general = self.motion.as_ref();
        let alone = self.bodies.is_empty() && general.is_some_and(|m| !m.law.is_still());
        alone
            || general.is_some_and(|m| m.particles == ParticleMotion::Lagrangian)
            || (0..self.bodies.len()).any(|i| self.motion_of(i).is_some())
            || !self.structures.is_empty()
            || self.has_gas() && self.solids().next().is_some()
    }
}
