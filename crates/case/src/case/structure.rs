//! Bodies on springs, as data: what the numbers of `[structure]` say, before any of them is given the units of a solver.
//!
//! Coordinates are displacements `surge`, `sway`, `plunge` of the pivot and angles `roll`, `pitch`, `yaw` about it; in the plane there are
//! `surge`, `plunge` (up positive), `pitch` (nose up positive) and the angle `flap` (trailing edge down positive). Masses, inertias,
//! stiffnesses and forces of a 2-D case are per unit span.
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::mode_file::ModeTable;
use super::{Acceleration, Case, Flow, Frequency, Inertia, Length, Mass, Time};

/// Values by the name of the coordinate, for those that were given.
pub type PerCoordinate<T> = BTreeMap<String, T>;

/// One `[[structure]]`: a body whose coordinates are unknowns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Structure {
    /// Name of the body; absent: the only one.
    pub body: Option<String>,
    /// What moves.
    pub model: StructureModel,
    /// Coordinates that are unknowns; empty: those of the model.
    pub free: Vec<Freedom>,
    /// Point whose displacement is counted and about which the body turns, as placed.
    pub pivot: Option<Vec<Length>>,
    /// The same in semichords aft of the middle of the chord, a.
    pub elastic_axis: Option<f64>,
    /// b; absent: half the reference chord.
    pub semichord: Option<Length>,
    /// Mass m.
    pub mass: Option<Mass>,
    /// μ = m/(πρ∞b²) instead.
    pub mass_ratio: Option<f64>,
    /// Centre of mass, as placed.
    pub centre_of_mass: Option<Vec<Length>>,
    /// The same in semichords aft of the pivot, x_α.
    pub x_alpha: Option<f64>,
    /// Moments of inertia about the pivot: one in the plane; xx, yy, zz and perhaps xy, yz, zx in space.
    pub inertia: Option<Vec<Inertia>>,
    /// r_α² = I/(m b²) instead.
    pub r_alpha2: Option<f64>,
    /// A typical section whose inertia is that of a rigid body at any angle.
    pub large_angles: bool,
    /// Stiffnesses of the springs in base units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub stiffness: PerCoordinate<f64>,
    /// Uncoupled frequencies instead.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub frequency: PerCoordinate<Frequency>,
    /// ω_h/ω_α.
    pub frequency_ratio: Option<f64>,
    /// V* = U∞/(b ω_α), of plunge when there is no pitch.
    pub reduced_speed: Option<f64>,
    /// U* = U∞/(f D) with D = 2b instead.
    pub reduced_velocity: Option<f64>,
    /// V_f = V*/√μ instead.
    pub speed_index: Option<f64>,
    /// Damping ratios of the uncoupled coordinates.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub damping_ratio: PerCoordinate<f64>,
    /// Coefficients of dampers instead, in base units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub damping: PerCoordinate<f64>,
    /// Trailing-edge flap.
    pub flap: Option<StructureFlap>,
    /// What makes springs nonlinear.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub springs: PerCoordinate<SpringShape>,
    /// Values at the start, and rates by `<coordinate>_rate`, in base units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub initial: PerCoordinate<f64>,
    /// External forces.
    pub force: Option<StructureForce>,
    /// Acceleration of gravity.
    pub gravity: Option<Vec<Acceleration>>,
    /// How many natural modes of the body's own particles move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// Modes.
    #[serde(default, rename = "mode", skip_serializing_if = "are_found")]
    pub modes: Vec<StructureMode>,
}

/// What moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StructureModel {
    /// Plunge and pitch of a section, perhaps with a flap.
    TypicalSection,
    /// A rigid body.
    RigidBody,
    /// Modes of a flexible body.
    Modal,
    /// Natural modes of the body's own particles.
    OwnModes,
    /// Plunge, pitch and modes together, for forces of small motions in them: a program may ask for it, a case file does not.
    Floating,
}

/// A coordinate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Freedom {
    /// Displacement along x.
    Surge,
    /// Displacement along y in space.
    Sway,
    /// Displacement up: along y in the plane, along z in space.
    Plunge,
    /// Angle about x in space.
    Roll,
    /// Angle, nose up positive.
    Pitch,
    /// Angle about z in space.
    Yaw,
    /// Angle of the flap, trailing edge down positive.
    Flap,
}

/// A trailing-edge flap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StructureFlap {
    /// Hinge in semichords aft of the middle of the chord, c.
    pub hinge: Option<f64>,
    /// The same as a point, as placed.
    pub hinge_point: Option<Vec<Length>>,
    /// x_β = S_β/(m b) with the mass m of the whole section.
    pub x_beta: f64,
    /// r_β² = I_β/(m b²) with the mass of the whole section.
    pub r_beta2: f64,
    /// ω_β/ω_α.
    pub frequency_ratio: Option<f64>,
    /// Length over which the surface goes from still to turning.
    pub blend: Length,
}

/// What makes a spring nonlinear: with the elongation e beyond the play its force is k (e + cubic e³).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SpringShape {
    /// Over length or radian squared.
    pub cubic: f64,
    /// Half the gap, a length or radians.
    pub free_play: f64,
    /// Where the spring is at ease, a length or radians.
    pub rest: f64,
}

/// External forces as formulas in time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StructureForce {
    /// Frequency, `omega` of the formulas.
    pub frequency: Option<Frequency>,
    /// k = ωL/U∞ instead.
    pub reduced_frequency: Option<f64>,
    /// L; absent: half the reference chord.
    pub reduced_length: Option<Length>,
    /// 2π/ω instead.
    pub period: Option<Time>,
    /// Formulas by coordinate.
    #[serde(flatten)]
    pub formulas: PerCoordinate<String>,
}

/// A mode of a flexible body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StructureMode {
    /// Name.
    pub name: String,
    /// File of its shape, see [`super::read_mode`].
    pub file: String,
    /// Generalised mass.
    pub mass: f64,
    /// Frequency.
    pub frequency: Option<Frequency>,
    /// k = ωb/U∞ instead.
    pub reduced_frequency: Option<f64>,
    /// Generalised stiffness instead.
    pub stiffness: Option<f64>,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// The spring's force is k (e + cubic e³).
    pub cubic: f64,
    /// Half the gap of the spring.
    pub free_play: f64,
    /// Coordinate at the start.
    pub initial: f64,
    /// Its rate at the start.
    pub initial_rate: f64,
    /// External force as a formula.
    pub force: Option<String>,
    /// The shape of a mode that was found and has no file.
    #[serde(skip)]
    pub table: Option<ModeTable>,
    /// What is told of a mode that was found.
    #[serde(skip)]
    pub told: String,
}

/// True for modes that were found: a written case does not hold them.
fn are_found(modes: &[StructureMode]) -> bool {
    modes.iter().any(|mode| mode.table.is_some())
}

impl Freedom {
    /// All of them.
    pub const ALL: [Self; 7] = [Self::Surge, Self::Sway, Self::Plunge, Self::Roll, Self::Pitch, Self::Yaw, Self::Flap];

    /// The word of the case file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Surge => "surge",
            Self::Sway => "sway",
            Self::Plunge => "plunge",
            Self::Roll => "roll",
            Self::Pitch => "pitch",
            Self::Yaw => "yaw",
            Self::Flap => "flap",
        }
    }

    /// True for angles.
    pub fn turns(self) -> bool {
        matches!(self, Self::Roll | Self::Pitch | Self::Yaw | Self::Flap)
    }
}

impl StructureMode {
    /// A mode of unit mass and stiffness, at rest.
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
            table: None,
            told: String::new(),
        }
    }
}

impl Structure {
    /// A structure of which only the model is given.
    pub fn of(model: StructureModel) -> Self {
        Self {
            body: None,
            model,
            free: Vec::new(),
            pivot: None,
            elastic_axis: None,
            semichord: None,
            mass: None,
            mass_ratio: None,
            centre_of_mass: None,
            x_alpha: None,
            inertia: None,
            r_alpha2: None,
            large_angles: false,
            stiffness: PerCoordinate::new(),
            frequency: PerCoordinate::new(),
            frequency_ratio: None,
            reduced_speed: None,
            reduced_velocity: None,
            speed_index: None,
            damping_ratio: PerCoordinate::new(),
            damping: PerCoordinate::new(),
            flap: None,
            springs: PerCoordinate::new(),
            initial: PerCoordinate::new(),
            force: None,
            gravity: None,
            number: None,
            modes: Vec::new(),
        }
    }

    /// The structure without modes that were found.
    pub fn as_given(&self) -> Self {
        let mut given = self.clone();
        given.modes.retain(|mode| mode.table.is_none());
        given
    }

    /// Coordinates that are unknowns, in the order of the model; none for modes, which are all.
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

impl Freedom {
    /// True when cases of this dimension have the coordinate.
    pub fn exists_in(self, dimension: usize) -> bool {
        match self {
            Self::Surge | Self::Plunge | Self::Pitch => true,
            Self::Flap => dimension == 2,
            Self::Sway | Self::Roll | Self::Yaw => dimension == 3,
        }
    }
}

impl StructureForce {
    /// Angular frequency ω in the units of the case; `chord` is the reference chord.
    pub fn angular_frequency(&self, flow: &Flow, chord: f64) -> Option<f64> {
        let length = self.reduced_length.map_or(0.5 * chord, |l| l.0);
        let reduced = self.reduced_frequency.map(|k| k * flow.reference().speed / length);
        reduced.or(self.frequency.map(|f| f.0)).or(self.period.map(|t| std::f64::consts::TAU / t.0))
    }
}

impl Case {
    /// The structure of body number `body`, if it is on springs.
    pub fn structure_of(&self, body: usize) -> Option<&Structure> {
        let name = self.bodies.get(body)?.name.as_deref();
        self.structures.iter().find(|s| s.body.as_deref().is_none_or(|wanted| Some(wanted) == name))
    }

    /// Angular frequency of the forces on structures in the units of the case, if they have one.
    pub fn force_frequency(&self, chord: f64) -> Option<f64> {
        self.structures.iter().find_map(|s| s.force.as_ref()?.angular_frequency(&self.flow, chord))
    }
}

impl SpringShape {
    /// Those of a mode.
    pub fn of(mode: &StructureMode) -> Self {
        Self { cubic: mode.cubic, free_play: mode.free_play, rest: 0.0 }
    }
}

impl StructureFlap {
    /// Hinge for the middle of the chord and the semichord `b`.
    pub fn hinge_at(&self, middle: [f64; 2], b: f64) -> [f64; 2] {
        match (&self.hinge_point, self.hinge) {
            (Some(point), _) => [point[0].0, point[1].0],
            (None, c) => [middle[0] + c.unwrap_or_default() * b, middle[1]],
        }
    }
}
