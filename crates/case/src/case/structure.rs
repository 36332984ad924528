//! Elastically supported and flexible bodies, as data: the numbers of `[structure]` in units of the case.
//!
//! The coordinates are the displacements `surge`, `sway`, `plunge` of the pivot and the angles `roll`, `pitch`, `yaw`
//! about it. In 2-D there are `surge`, `plunge` (up positive), `pitch` (nose up positive) and the angle `flap`
//! (trailing edge down positive). Masses, inertias, stiffnesses and forces of a 2-D case are per unit span.
use serde::{Deserialize, Serialize};

use super::Case;
use super::flow::Flow;
use super::kinds::ANGLE;
use super::quantity::{
    Acceleration, AngularDamper, AngularStiffness, Damper, Frequency, Inertia, Length, Mass, PerArea, PerSquareAngle,
    PerTime, Rate, Ratio, Stiffness, Time, Velocity,
};
use super::schema::{Absent, Field, Kind, List, Range, Table, defaulted, keys, optional, required, words};

use std::collections::BTreeMap;

/// What no structure is beyond, in SI units, or those of a nondimensional stream: numbers that are larger, or smaller, are slips of a
/// unit or of an exponent, and what is computed of them is round-off. From grains to ships of 10¹² kg and 10⁶ m.
const MASSES: Range = Range::between(1e-12, 1e12);
const INERTIAS: Range = Range::between(-1e18, 1e18);
const STIFF: Range = Range::between(0.0, 1e18);
const FREQUENCIES: Range = Range::between(1e-9, 1e9);
const LENGTHS: Range = Range::between(-1e6, 1e6);
const SPEEDS: Range = Range::between(-1e6, 1e6);
const RATES_OF_TURN: Range = Range::between(-1e6, 1e6);
/// Of places in semichords: a swept wing whose axis is ahead of the section has -2, an aircraft about its tail some tens.
const SEMICHORDS: Range = Range::between(-100.0, 100.0);
/// The square of such a length.
const SQUARE: Range = Range::between(1e-9, 1e4);
/// Of ratios of masses, from bubbles to bodies in hardly any air.
const MASS_RATIOS: Range = Range::between(1e-6, 1e9);
/// Of frequencies and speeds over one another.
const RATIOS_OF_SPEED: Range = Range::between(1e-6, 1e6);
/// Cubic parts of springs, over length or angle squared.
const CUBIC: Range = Range::between(-1e15, 1e15);

const SEMICHORD: Kind = Kind::Number(SEMICHORDS);
const SPEED_RATIO: Kind = Kind::Number(RATIOS_OF_SPEED);
const RADIUS_SQUARED: Kind = Kind::Number(SQUARE);
const COORDINATE: Kind = Kind::Number(LENGTHS);
const MASS: Kind = Kind::Quantity(Mass::DIMENSION, MASSES);
const SIZE: Kind = Kind::Quantity(Length::DIMENSION, Range::between(1e-9, 1e6));
const LENGTH: Kind = Kind::Quantity(Length::DIMENSION, LENGTHS);
const POINT: Kind = Kind::List(&List { item: LENGTH, min: 2, max: 3, single: false });
/// Part of critical damping; beyond half of it nothing flutters.
const RATIO: Kind = Kind::Quantity(Ratio::DIMENSION, Range::between(0.0, 100.0));
const HERTZ: Kind = Kind::Quantity(Frequency::DIMENSION, FREQUENCIES);
const SPRING: Kind = Kind::Quantity(Stiffness::DIMENSION, STIFF);
const TWIST: Kind = Kind::Quantity(AngularStiffness::DIMENSION, STIFF);
const DASHPOT: Kind = Kind::Quantity(Damper::DIMENSION, STIFF);
const TWIST_DASHPOT: Kind = Kind::Quantity(AngularDamper::DIMENSION, STIFF);
const PLAY: Kind = Kind::Quantity(Length::DIMENSION, Range::between(0.0, 1e6));
const SPEED: Kind = Kind::Quantity(Velocity::DIMENSION, SPEEDS);
const TURN_RATE: Kind = Kind::Quantity(Rate::DIMENSION, RATES_OF_TURN);
const ACCELERATION: Kind = Kind::Quantity(Acceleration::DIMENSION, Range::between(-1e6, 1e6));
const PERIOD: Kind = Kind::Quantity(Time::DIMENSION, Range::between(1e-9, 1e12));
const ONE: &str = "another of its alternatives";
const NO_SPRING: &str = "no spring, or from another key";

/// Rows of all coordinates: `long` for displacements, `turned` for angles.
const fn each(long: Kind, turned: Kind, absent: &'static str, doc: &'static str) -> [Field; 7] {
    let (long, turned) = (optional(long, absent), optional(turned, absent));
    [
        long.named("surge", doc),
        long.named("sway", doc),
        long.named("plunge", doc),
        turned.named("roll", doc),
        turned.named("pitch", doc),
        turned.named("yaw", doc),
        turned.named("flap", doc),
    ]
}

const OWN: &str = "That of the coordinate.";
const UNDAMPED: &str = "no damping";

static STIFFNESS: Table = Table::of(&each(SPRING, TWIST, NO_SPRING, OWN));
static FREQUENCY: Table = Table::of(&each(HERTZ, HERTZ, NO_SPRING, OWN));
static RATIOS: Table = Table::of(&each(RATIO, RATIO, UNDAMPED, OWN));
static DAMPERS: Table = Table::of(&each(DASHPOT, TWIST_DASHPOT, UNDAMPED, OWN));
static SPRINGS: Table = Table::of(&each(
    Kind::Table(&LONG_SPRING),
    Kind::Table(&TURNED_SPRING),
    "a linear spring",
    "Cubic part, play and place of rest of its spring.",
));

const fn cubic(kind: Kind, doc: &'static str) -> Field {
    Field::defaulted("cubic", kind, Absent::Number(0.0), doc)
}
const FREE_PLAY: &str = "Half the gap: the spring does nothing within `rest` ± this.";
const REST: &str = "Where the spring is at ease.";

static LONG_SPRING: Table = Table::of(&[
    cubic(Kind::Quantity(PerArea::DIMENSION, CUBIC), "Over length squared."),
    Field::defaulted("free_play", PLAY, Absent::Number(0.0), FREE_PLAY),
    Field::defaulted("rest", LENGTH, Absent::Number(0.0), REST),
]);

static TURNED_SPRING: Table = Table::of(&[
    cubic(
        Kind::Quantity(PerSquareAngle::DIMENSION, CUBIC),
        "Over angle squared; a plain number is over radian squared.",
    ),
    Field::defaulted(
        "free_play",
        Kind::Quantity(super::quantity::Angle::DIMENSION, Range { min: 0.0, max: f64::INFINITY, closed: true }),
        Absent::Number(0.0),
        FREE_PLAY,
    ),
    Field::defaulted("rest", ANGLE, Absent::Number(0.0), REST),
]);

const ZERO: &str = "zero";

static RATES: Table = Table::of(&[
    optional(SPEED, ZERO).named("surge_rate", OWN),
    optional(SPEED, ZERO).named("sway_rate", OWN),
    optional(SPEED, ZERO).named("plunge_rate", OWN),
    optional(TURN_RATE, ZERO).named("roll_rate", OWN),
    optional(TURN_RATE, ZERO).named("pitch_rate", OWN),
    optional(TURN_RATE, ZERO).named("yaw_rate", OWN),
    optional(TURN_RATE, ZERO).named("flap_rate", OWN),
]);
static INITIAL: Table = Table::of(&each(LENGTH, ANGLE, ZERO, OWN)).with_keys_of(&RATES);

static FORMULAS: Table = Table::of(&each(Kind::Text, Kind::Text, ZERO, OWN));

/// Values by name of the coordinate, for those that are given.
pub type PerCoordinate<T> = BTreeMap<String, T>;

keys! {
    /// One table `[[structure]]`: a body whose coordinates are unknowns.
    pub struct Structure, STRUCTURE.or_within("section") {
        /// Name of the body.
        body: Option<String> = optional(Kind::Text, "the only body"),
        /// What moves.
        model: StructureModel = defaulted(Kind::Words(MODELS), Absent::Word("typical_section")),
        /// Coordinates that are unknowns, the others stay as placed. None named: those of the model. A cylinder that
        /// moves across the stream has `free = "plunge"`.
        free: Vec<Freedom> = defaulted(
            Kind::List(&List { item: Kind::Words(FREEDOMS), min: 0, max: 7, single: true }), Absent::Filled,
        ),
        /// How many natural modes move (`model = "own_modes"`), from the slowest on.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        number: Option<u32> = optional(Kind::Integer(1, 100), "4"),
        /// The elastic axis: the point whose displacement is counted and about which the body turns, as placed.
        pivot: Option<Vec<Length>> = optional(POINT, "`elastic_axis`, else the centre of mass"),
        /// a: the elastic axis in semichords aft of the middle of the chord (2-D); -0.5 is the quarter chord.
        elastic_axis: Option<f64> = optional(SEMICHORD, "`pivot`"),
        /// b of all numbers of flutter; half the diameter of a cylinder.
        semichord: Option<Length> = optional(SIZE, "half of the reference chord"),
        /// Mass, in 2-D per span.
        mass: Option<Mass> = optional(MASS, "`mass_ratio`"),
        /// μ = m/(π ρ∞ b²) instead (2-D); for a cylinder of diameter D = 2b that is m* = m/(ρ∞ π D²/4).
        mass_ratio: Option<f64> = optional(Kind::Number(MASS_RATIOS), "`mass`"),
        /// Centre of mass, as placed.
        centre_of_mass: Option<Vec<Length>> = optional(POINT, "at the pivot"),
        /// Static unbalance x_α = S_α/(m b) instead: the centre of mass in semichords aft of the elastic axis (2-D).
        x_alpha: Option<f64> = optional(SEMICHORD, "`centre_of_mass`"),
        /// Moment of inertia about the pivot: one value in 2-D (per span), Jxx, Jyy, Jzz in 3-D, and Jxy, Jyz, Jzx
        /// (entries of the tensor: minus the products of inertia) where they are not zero.
        inertia: Option<Vec<Inertia>> = optional(
            Kind::List(&List { item: Kind::Quantity(Inertia::DIMENSION, INERTIAS), min: 1, max: 6, single: true }),
            "`r_alpha2`",
        ),
        /// r_α² = I_α/(m b²) instead: square of the radius of gyration about the elastic axis, in semichords (2-D).
        r_alpha2: Option<f64> = optional(RADIUS_SQUARED, "`inertia`"),
        /// The inertia of a typical section is that of a rigid body at any angle; else that of small angles, as in the
        /// literature of flutter. A rigid body has it always.
        large_angles: bool = defaulted(Kind::Flag, Absent::Flag(false)),
        /// Stiffnesses of the springs; zero: none.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        stiffness: PerCoordinate<f64> = optional(Kind::Table(&STIFFNESS), NO_SPRING),
        /// Uncoupled frequencies √(K/m), √(K_α/I_α) of the springs instead; they need a dimensional free stream.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        frequency: PerCoordinate<Frequency> = optional(Kind::Table(&FREQUENCY), NO_SPRING),
        /// ω_h/ω_α: the uncoupled frequency of plunge over that of pitch.
        frequency_ratio: Option<f64> = optional(SPEED_RATIO, "`frequency` or `stiffness` of `plunge`"),
        /// V* = U∞/(b ω_α), which fixes the spring of pitch; that of plunge where pitch is not free.
        reduced_speed: Option<f64> = optional(SPEED_RATIO, ONE),
        /// U* = U∞/(f D) instead, with D = 2b and f = ω/2π: what vortex-induced vibration is told by.
        reduced_velocity: Option<f64> = optional(SPEED_RATIO, ONE),
        /// V_f = U∞/(b ω_α √μ) instead.
        speed_index: Option<f64> = optional(
            SPEED_RATIO, "another of its alternatives; 1 with `[flutter]`, which varies the speed",
        ),
        /// Damping ratios ζ of the uncoupled coordinates: dampers of 2ζ√(K m), 2ζ√(K_α I_α).
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        damping_ratio: PerCoordinate<f64> = optional(Kind::Table(&RATIOS), "no damping"),
        /// Coefficients of dampers instead, force over velocity and moment over rate, `damping = { plunge = "40 N s/m"
        /// }`.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        damping: PerCoordinate<f64> = optional(Kind::Table(&DAMPERS), "no damping"),
        /// Trailing-edge flap of a typical section.
        flap: Option<StructureFlap> = optional(Kind::Table(&FLAP), "no flap"),
        /// What makes springs nonlinear: with the elongation e beyond the play their force is K (e + cubic e³),
        /// `springs = { pitch = { cubic = 40 } }`.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        springs: PerCoordinate<SpringShape> = optional(Kind::Table(&SPRINGS), "linear springs"),
        /// Coordinates and their rates at the start, `initial = { pitch = "1 deg", plunge_rate = 0.01 }`.
        #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
        initial: PerCoordinate<f64> = optional(Kind::Table(&INITIAL), "at rest as placed"),
        /// External forces and moments as formulas in `t`, `force = { pitch = "1e-3 * cos(omega * t)",
        /// reduced_frequency = 0.1 }`, in base units.
        force: Option<StructureForce> = optional(Kind::Table(&FORCE), "none"),
        /// Acceleration of gravity, `gravity = [0, "-9.81 m/s2"]`.
        gravity: Option<Vec<Acceleration>> = optional(
            Kind::List(&List { item: ACCELERATION, min: 2, max: 3, single: false }), "none",
        ),
        /// A mode of a flexible body (`model = "modal"`): every point X goes q·φ(X). Needs a deforming cloud.
        #[serde(default)]
        modes as "mode": Vec<StructureMode> = defaulted(Kind::Tables(&MODE), Absent::Filled),
    }
}

words! {
    /// Structural model.
    pub enum StructureModel, MODELS {
        /// plunge and pitch of a section on springs, perhaps with a flap (2-D)
        TypicalSection = "typical_section",
        /// a rigid body: `surge`, `plunge`, `pitch` in 2-D; `surge`, `sway`, `plunge`, `roll`, `pitch`, `yaw` in 3-D
        RigidBody = "rigid_body",
        /// modes of a flexible body
        Modal = "modal",
        /// natural modes of a body made of particles (`[body.solid]`), found before the run
        OwnModes = "own_modes",
    } and {
        /// Plunge, pitch and modes together, for generalised forces; used internally and not available in case files.
        Floating,
    }

    /// A coordinate (degree of freedom) of a body.
    pub enum Freedom, FREEDOMS {
        /// displacement along x
        Surge = "surge",
        /// displacement along y (3-D)
        Sway = "sway",
        /// displacement up: along y in 2-D, along z in 3-D
        Plunge = "plunge",
        /// rotation about x (3-D): with `pitch` and `yaw` the components of the rotation vector
        Roll = "roll",
        /// rotation, nose up positive: clockwise in 2-D, about y in 3-D
        Pitch = "pitch",
        /// rotation about z (3-D)
        Yaw = "yaw",
        /// angle of the flap, trailing edge down positive (2-D)
        Flap = "flap",
    }
}

keys! {
    /// A trailing-edge flap.
    pub struct StructureFlap, FLAP {
        /// c: the hinge in semichords aft of the middle of the chord; 0.6 leaves a flap of a fifth of the chord.
        hinge: Option<f64> = optional(SEMICHORD, "`hinge_point`"),
        /// The hinge as a point instead, as placed.
        hinge_point: Option<Vec<Length>> = optional(POINT, "`hinge`"),
        /// x_β = S_β/(m b): static moment of the flap about its hinge, with the mass m of the whole section.
        x_beta: f64 = required(SEMICHORD),
        /// r_β² = I_β/(m b²), with the mass of the whole section.
        r_beta2: f64 = required(RADIUS_SQUARED),
        /// ω_β/ω_α: the uncoupled frequency of the flap over that of pitch.
        frequency_ratio: Option<f64> = optional(SPEED_RATIO, "`frequency` or `stiffness` of `flap`"),
        /// Length along x over which the surface goes from still to turning, centred on the hinge; 0: a kink.
        blend: Length = defaulted(PLAY, Absent::Number(0.0)),
    }
}

/// Nonlinear spring: with the elongation e beyond the free play, its force is k (e + cubic e³).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpringShape {
    /// Cubic coefficient [1/length² or 1/rad²].
    pub cubic: f64,
    /// Half the free play (length or rad).
    pub free_play: f64,
    /// Coordinate at which the spring is unloaded (length or rad).
    pub rest: f64,
}

keys! {
    /// External forces as formulas of time.
    #[derive(Default)]
    pub struct StructureForce, FORCE.with_keys_of(&FORMULAS) {
        /// Frequency, `omega` of the formulas; needs a dimensional free stream.
        frequency: Option<Frequency> = optional(HERTZ, ONE),
        /// Reduced frequency k = ωL/U∞ instead, with L = `reduced_length`.
        reduced_frequency: Option<f64> = optional(SPEED_RATIO, ONE),
        /// Length L of the reduced frequency.
        reduced_length: Option<Length> = optional(SIZE, "half of the reference chord"),
        /// Period 2π/ω instead.
        period: Option<Time> = optional(PERIOD, ONE),
    } and {
        /// Formulas by name of the coordinate.
        #[serde(flatten)]
        formulas: PerCoordinate<String>,
    }

    /// A mode of a flexible body.
    pub struct StructureMode, MODE {
        /// Name: letters, digits, `-` and `_`.
        name: String = required(Kind::Text),
        /// CSV file of the shape, relative to the case file: columns `x`, `y` (`z`) of points of the body as placed,
        /// and `dx`, `dy` (`dz`), their displacements when the coordinate is one.
        file: String = required(Kind::File),
        /// Generalised mass ∫ φ·φ dm with the shape of the file, `mass = "10 kg"`, in 2-D per span, `"10 kg/m"`.
        mass: f64 = required(MASS),
        /// Frequency; needs a dimensional free stream.
        frequency: Option<Frequency> = optional(HERTZ, ONE),
        /// k = ωb/U∞ instead, with b = `semichord`.
        reduced_frequency: Option<f64> = optional(SPEED_RATIO, ONE),
        /// Generalised stiffness instead, of the unit of the mass over time squared.
        stiffness: Option<f64> = optional(SPRING, ONE),
        /// Damping ratio ζ.
        damping_ratio: f64 = defaulted(RATIO, Absent::Number(0.0)),
        /// The force of the spring is k (e + cubic e³).
        cubic: f64 = defaulted(Kind::Number(CUBIC), Absent::Number(0.0)),
        /// Half the gap of the spring.
        free_play: f64 = defaulted(Kind::Number(Range::between(0.0, 1e6)), Absent::Number(0.0)),
        /// Coordinate at the start.
        initial: f64 = defaulted(COORDINATE, Absent::Number(0.0)),
        /// Its rate at the start.
        initial_rate: f64 = defaulted(Kind::Quantity(PerTime::DIMENSION, RATES_OF_TURN), Absent::Number(0.0)),
        /// External generalised force as a formula in `t`, in base units; `omega` is that of `[structure.force]`.
        force: Option<String> = optional(Kind::Text, ZERO),
    }
}

impl Freedom {
    /// True when the coordinate exists in cases of this dimension.
    pub fn exists_in(self, dimension: usize) -> bool {
        match self {
            Self::Surge | Self::Plunge | Self::Pitch => true,
            Self::Flap => dimension == 2,
            Self::Sway | Self::Roll | Self::Yaw => dimension == 3,
        }
    }

    /// True for angles.
    pub fn turns(self) -> bool {
        matches!(self, Self::Roll | Self::Pitch | Self::Yaw | Self::Flap)
    }
}

impl StructureMode {
    /// A mode of unit mass and unit stiffness, initially at rest.
    pub fn unit(name: &str, file: &str) -> Self {
        Self {
            name: name.to_owned(),
            file: file.to_owned(),
            mass: 1.0,
            frequency: None,
            reduced_frequency: None,
            stiffness: Some(1.0),
            damping_ratio: 0.0,
            cubic: 0.0,
            free_play: 0.0,
            initial: 0.0,
            initial_rate: 0.0,
            force: None,
        }
    }
}

impl Structure {
    /// A structure of this model without any other values.
    pub fn of(model: StructureModel) -> Self {
        Self { model, ..STRUCTURE.value() }
    }

    /// Coordinates that are unknowns, in the order of the model; empty for modal models, all of whose modes are
    /// unknowns.
    pub fn freedoms(&self, dimension: usize) -> Vec<Freedom> {
        if matches!(self.model, StructureModel::Modal | StructureModel::OwnModes) {
            return Vec::new();
        }
        let section = [Freedom::Plunge, Freedom::Pitch];
        let all: Vec<Freedom> = Freedom::ALL.into_iter().filter(|f| f.exists_in(dimension)).collect();
        let free = |f: &Freedom| match (self.free.is_empty(), self.model) {
            (false, _) => self.free.contains(f),
            (true, StructureModel::TypicalSection) => {
                section.contains(f) || (*f == Freedom::Flap && self.flap.is_some())
            }
            (true, _) => *f != Freedom::Flap,
        };
        all.into_iter().filter(free).collect()
    }
}

impl StructureForce {
    /// Angular frequency ω in units of the case; `chord` is the reference chord.
    pub fn angular_frequency(&self, flow: &Flow, chord: f64) -> Option<f64> {
        let length = self.reduced_length.map_or(0.5 * chord, |l| l.0);
        let reduced = self.reduced_frequency.map(|k| k * flow.reference().speed / length);
        reduced.or(self.frequency.map(|f| f.0)).or(self.period.map(|t| std::f64::consts::TAU / t.0))
    }
}

impl Case {
    /// The structure of body number `body`, if it has one.
    pub fn structure_of(&self, body: usize) -> Option<&Structure> {
        let name = self.bodies.get(body)?.name.as_deref();
        self.structures.iter().find(|s| s.body.as_deref().is_none_or(|wanted| Some(wanted) == name))
    }

    /// Angular frequency of the forces on structures in units of the case; `None` when no force has a frequency.
    pub fn force_frequency(&self, chord: f64) -> Option<f64> {
        self.structures.iter().find_map(|s| s.force.as_ref()?.angular_frequency(&self.flow, chord))
    }
}

impl SpringShape {
    /// The spring of a mode.
    pub fn of(mode: &StructureMode) -> Self {
        Self { cubic: mode.cubic, free_play: mode.free_play, rest: 0.0 }
    }
}

impl StructureFlap {
    /// Hinge point, given the middle of the chord and the semichord `b`.
    pub fn hinge_at(&self, middle: [f64; 2], b: f64) -> [f64; 2] {
        match (&self.hinge_point, self.hinge) {
            (Some(point), _) => [point[0].0, point[1].0],
            (None, c) => [middle[0] + c.unwrap_or_default() * b, middle[1]],
        }
    }
}
