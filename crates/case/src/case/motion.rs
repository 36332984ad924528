//! Motion of bodies and particles, as data.
//!
//! A motion is a sum of parts: the angles add up to θ(t) about one axis through the pivot, the displacements to d(t). A
//! point X of the body in its initial placement is at x(t) = R(θ)(X + Σ q φ(X) − pivot) + pivot + d, with the shapes φ
//! and the coordinates q of its modes. Sines are amplitude·sin(ωt + phase): α = α_m + α_0 sin ωt as in the AGARD cases,
//! with the mean α_m from `flow.alpha` or
//! `rotate`. Pitch is nose up positive and plunge is up positive.
use super::flow::Flow;
use super::kinds::{ANGLE, LENGTH, POINT, POSITIVE, SIZE};
use super::quantity::{Angle, Frequency, Length, Rate, Time, Velocity};
use super::schema::{Absent, Kind, List, Range, defaulted, keys, optional, required, words};
use super::time::Temporal;
use super::{Case, Shape};

/// A direction in two or three dimensions.
const DIRECTION: Kind = Kind::List(&List { item: Kind::Number(Range::ANY), min: 2, max: 3, single: false });
const ONE: &str = "another of `frequency`, `reduced_frequency` and `period`";
const STILL: &str = "no such part";
const OWN: &str = "that of the motion";
static LENGTHS: List =
    List { item: Kind::Quantity(Length::DIMENSION, Range::ANY), min: 2, max: usize::MAX, single: false };
static ANGLES: List =
    List { item: Kind::Quantity(Angle::DIMENSION, Range::ANY), min: 2, max: usize::MAX, single: false };
static TIMES: List = List { item: Kind::Quantity(Time::DIMENSION, Range::ANY), min: 2, max: usize::MAX, single: false };

keys! {
    /// The table `[motion]`: motion of the particles, and motion of every body without a motion of its own.
    pub struct Motion, MOTION.with_keys_of(&BODY_MOTION) {
        /// How particles follow the bodies.
        particles: ParticleMotion = defaulted(Kind::Words(PARTICLES), Absent::Word("deforming")),
    } and {
        /// Motion of every body without a motion of its own; without bodies, motion of the cloud.
        #[serde(flatten)]
        law: BodyMotionSpec,
    }
}

words! {
    /// How the particles follow the bodies.
    pub enum ParticleMotion, PARTICLES = Deforming {
        /// the whole cloud moves as one with the body
        Rigid = "rigid",
        /// the displacement of the surface is spread into the cloud, the far field stays where it is
        Deforming = "deforming",
        /// particles travel with the fluid
        Lagrangian = "lagrangian",
    }
}

keys! {
    /// Motion of one body as the sum of its parts; without parts the body is at rest.
    #[derive(Default)]
    pub struct BodyMotionSpec, BODY_MOTION {
        /// Frequency of pitch and plunge, and `omega` of formulas; needs a dimensional free stream.
        frequency: Option<Frequency> = optional(Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE), ONE),
        /// Reduced frequency k = ωL/U∞ instead, with L = `reduced_length` and the speed U∞ of the free stream.
        reduced_frequency: Option<f64> = optional(POSITIVE, ONE),
        /// Length L of the reduced frequency; give the chord itself when k = ωc/U∞ is meant.
        reduced_length: Option<Length> = optional(SIZE, "half of the reference chord"),
        /// Period 2π/ω instead, in seconds or lengths over sound speed.
        period: Option<Time> = optional(Kind::Quantity(Time::DIMENSION, Range::POSITIVE), ONE),
        /// Point about which the body turns, at its place before any motion; it travels with the displacement.
        pivot: Option<Vec<Length>> = optional(POINT, "must be given when the body turns"),
        /// Axis of the turn (3-D only), right-handed. In 2-D angles are nose up positive: clockwise.
        axis: Option<Vec<f64>> = optional(
            DIRECTION, "+y in 3-D: nose up positive for a stream along +x with lift along +z",
        ),
        /// Angle amplitude·sin(ωt + phase), nose up positive; the mean angle is `flow.alpha` or `rotate` of the body.
        /// `pitch = "2 deg"` is an amplitude alone. Several in a list add up, each with a frequency of its own where it
        /// has one.
        #[serde(default)]
        pitch: Vec<Pitch> = defaulted(Kind::Tables(&PITCH_KEYS), Absent::Filled),
        /// Displacement amplitude·sin(ωt + phase), up positive. `plunge = 0.1` is an amplitude alone. Several in a list
        /// add up.
        #[serde(default)]
        plunge: Vec<Plunge> = defaulted(Kind::Tables(&PLUNGE_KEYS), Absent::Filled),
        /// Angle rate·t with the sign of pitch, `rotation = "10 deg/s"`.
        rotation: Option<Rotation> = optional(Kind::Table(&ROTATION_KEYS), STILL),
        /// Displacement velocity·t, `translation = [0.1, 0]`.
        translation: Option<Translation> = optional(Kind::Table(&TRANSLATION_KEYS), STILL),
        /// Displacement and angle at given times, joined by cubic splines: lists, or a file `table = "motion.csv"`.
        table: Option<MotionTable> = optional(Kind::Table(&TABLE_KEYS), STILL),
        /// Formulas in `t`, the time of the case (seconds, or lengths over sound speed without a dimensional free
        /// stream), with `omega`, `pi`, `e`, `deg`, the operators `+ - * / ^` and the functions `sin`, `cos`, `tan`,
        /// `asin`, `acos`, `atan`, `sinh`, `cosh`, `tanh`, `exp`, `ln`, `sqrt`, `abs`, `min`, `max`.
        formula: Option<MotionFormula> = optional(Kind::Table(&FORMULA_KEYS), STILL),
        /// A mode of a flexible body: every point X goes q·φ(X) before all other parts, with the coordinate q =
        /// amplitude·sin(ωt + phase). Needs a deforming cloud.
        #[serde(default)]
        modes as "mode": Vec<ModeMotion> = defaulted(Kind::Tables(&MODE_KEYS), Absent::Filled),
    }

    /// Prescribed motion of a mode: coordinate q(t) = amplitude·sin(ωt + phase) and the file of the shape φ.
    pub struct ModeMotion, MODE_KEYS {
        /// CSV file of the shape, relative to the case file: columns `x`, `y` (`z`) of points of the body as placed,
        /// and `dx`, `dy` (`dz`), their displacements when the coordinate is one.
        file: String = required(Kind::File),
        /// Amplitude of the coordinate.
        amplitude: f64 = required(Kind::Number(Range::ANY)),
        /// Phase at t = 0; `"90 deg"` makes the sine a cosine.
        phase: Angle = defaulted(ANGLE, Absent::Number(0.0)),
    }

    /// Sinusoidal rotation θ(t) = amplitude·sin(ωt + phase), nose up positive.
    pub struct Pitch, PITCH_KEYS.short("amplitude").with_keys_of(&OWN_FREQUENCY) {
        /// Amplitude.
        amplitude: Angle = required(ANGLE),
        /// Phase at t = 0; `"90 deg"` makes the sine a cosine.
        phase: Angle = defaulted(ANGLE, Absent::Number(0.0)),
    } and {
        /// Frequency of this part, if it differs from that of the motion.
        #[serde(flatten)]
        own: OwnFrequency,
    }

    /// Sinusoidal displacement d(t) = amplitude·sin(ωt + phase)·direction.
    pub struct Plunge, PLUNGE_KEYS.short("amplitude").with_keys_of(&OWN_FREQUENCY) {
        /// Amplitude of the displacement.
        amplitude: Length = required(LENGTH),
        /// Phase at t = 0; `"90 deg"` makes the sine a cosine.
        phase: Angle = defaulted(ANGLE, Absent::Number(0.0)),
        /// Direction of positive displacement; its length does not matter.
        direction: Option<Vec<f64>> = optional(DIRECTION, "up: +y in 2-D, +z in 3-D"),
    } and {
        /// Frequency of this part, if it differs from that of the motion.
        #[serde(flatten)]
        own: OwnFrequency,
    }

    /// Frequency of one part of a motion; absent: that of the motion.
    #[derive(Copy, Default)]
    pub struct OwnFrequency, OWN_FREQUENCY {
        /// Frequency of this part alone; needs a dimensional free stream. Frequencies of one motion are whole multiples
        /// of a common one.
        frequency: Option<Frequency> = optional(Kind::Quantity(Frequency::DIMENSION, Range::POSITIVE), OWN),
        /// Reduced frequency of this part, with `reduced_length` of the motion.
        reduced_frequency: Option<f64> = optional(POSITIVE, OWN),
        /// Period of this part instead.
        period: Option<Time> = optional(Kind::Quantity(Time::DIMENSION, Range::POSITIVE), OWN),
    }

    /// θ(t) = rate·t.
    pub struct Rotation, ROTATION_KEYS.short("rate") {
        /// Rate; a plain number is radians per unit of time.
        rate: Rate = required(Kind::Quantity(Rate::DIMENSION, Range::ANY)),
    }

    /// d(t) = velocity·t.
    pub struct Translation, TRANSLATION_KEYS.short("velocity") {
        /// Velocity.
        velocity: Vec<Velocity> = required(
            Kind::List(&List { item: Kind::Quantity(Velocity::DIMENSION, Range::ANY), min: 2, max: 3, single: false }),
        ),
    }

    /// Displacement and angle at given times, interpolated by cubic splines.
    pub struct MotionTable, TABLE_KEYS.short("file") {
        /// CSV file, relative to the case file, with columns `time` and any of `x`, `y`, `z`, `angle_deg`, `angle_rad`.
        file: Option<String> = optional(Kind::File, "the lists `time`, `x`, …"),
        /// Times, rising.
        time: Option<Vec<Time>> = optional(Kind::List(&TIMES), "`file` must be given"),
        /// Displacements along x.
        x: Option<Vec<Length>> = optional(Kind::List(&LENGTHS), "zero"),
        /// Displacements along y.
        y: Option<Vec<Length>> = optional(Kind::List(&LENGTHS), "zero"),
        /// Displacements along z (3-D).
        z: Option<Vec<Length>> = optional(Kind::List(&LENGTHS), "zero"),
        /// Angles, of the sign of pitch.
        angle: Option<Vec<Angle>> = optional(Kind::List(&ANGLES), "zero"),
        /// The table repeats, its last row is its first one a period later; else it begins and ends at rest and its
        /// ends are held.
        periodic: bool = defaulted(Kind::Flag, Absent::Flag(false)),
    }

    /// Displacements and angle (radians) as formulas of the time `t` of the case.
    #[derive(Default)]
    pub struct MotionFormula, FORMULA_KEYS {
        /// Displacement along x, `x = "0.1 * cos(omega * t)"`.
        x: Option<String> = optional(Kind::Text, "zero"),
        /// Displacement along y.
        y: Option<String> = optional(Kind::Text, "zero"),
        /// Displacement along z (3-D).
        z: Option<String> = optional(Kind::Text, "zero"),
        /// Angle in radians, of the sign of pitch: `"2 * deg * sin(omega * t)"`.
        angle: Option<String> = optional(Kind::Text, "zero"),
    }
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
