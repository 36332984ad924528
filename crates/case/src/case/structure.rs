//! Elastically supported and flexible bodies, as data: the numbers of `[structure]` in units of the case.
//!
//! The coordinates are the displacements `surge`, `sway`, `plunge` of the pivot and the angles `roll`, `pitch`, `yaw`
//! about it. In 2-D there are `surge`, `plunge` (up positive), `pitch` (nose up positive) and the angle `flap`
//! (trailing edge down positive). Masses, inertias, stiffnesses and forces of a 2-D case are per unit span.
use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Acceleration, Case, Flow, Frequency, Inertia, Length, Mass, Time};

/// Values by name of the coordinate, for those that are given.
pub type PerCoordinate<T> = BTreeMap<String, T>;

/// One table `[[structure]]`: a body whose coordinates are unknowns.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Structure {
    /// Name of the body; absent: the only body.
    pub body: Option<String>,
    /// Structural model.
    pub model: StructureModel,
    /// Coordinates that are unknowns; empty: all those of the model.
    pub free: Vec<Freedom>,
    /// Reference point of the displacement and centre of rotation (elastic axis), in the initial placement.
    pub pivot: Option<Vec<Length>>,
    /// Position a of the elastic axis in semichords aft of the middle of the chord, an alternative to `pivot`.
    pub elastic_axis: Option<f64>,
    /// Semichord b; absent: half the reference chord.
    pub semichord: Option<Length>,
    /// Mass m.
    pub mass: Option<Mass>,
    /// Mass ratio μ = m/(πρ∞b²), an alternative to `mass`.
    pub mass_ratio: Option<f64>,
    /// Centre of mass in the initial placement.
    pub centre_of_mass: Option<Vec<Length>>,
    /// Position x_α of the centre of mass in semichords aft of the pivot, an alternative to `centre_of_mass`.
    pub x_alpha: Option<f64>,
    /// Moments of inertia about the pivot: one in 2-D; xx, yy, zz and optionally xy, yz, zx in 3-D.
    pub inertia: Option<Vec<Inertia>>,
    /// r_α² = I/(m b²), an alternative to `inertia`.
    pub r_alpha2: Option<f64>,
    /// True for a typical section with the exact inertia of a rigid body at large angles.
    pub large_angles: bool,
    /// Spring stiffnesses in base units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub stiffness: PerCoordinate<f64>,
    /// Uncoupled frequencies, an alternative to `stiffness`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub frequency: PerCoordinate<Frequency>,
    /// Frequency ratio ω_h/ω_α.
    pub frequency_ratio: Option<f64>,
    /// Reduced speed V* = U∞/(b ω_α), with the frequency of plunge when there is no pitch.
    pub reduced_speed: Option<f64>,
    /// U* = U∞/(f D) with D = 2b, an alternative to `reduced_speed`.
    pub reduced_velocity: Option<f64>,
    /// Speed index V_f = V*/√μ, an alternative to `reduced_speed`.
    pub speed_index: Option<f64>,
    /// Damping ratios of the uncoupled coordinates.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub damping_ratio: PerCoordinate<f64>,
    /// Viscous damping coefficients in base units, an alternative to `damping_ratio`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub damping: PerCoordinate<f64>,
    /// Trailing-edge flap.
    pub flap: Option<StructureFlap>,
    /// Nonlinear springs.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub springs: PerCoordinate<SpringShape>,
    /// Initial values of the coordinates, and of their rates as `<coordinate>_rate`, in base units.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub initial: PerCoordinate<f64>,
    /// External forces.
    pub force: Option<StructureForce>,
    /// Acceleration of gravity.
    pub gravity: Option<Vec<Acceleration>>,
    /// Number of natural modes computed from the particles of the body.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// Modes of a flexible body.
    #[serde(default, rename = "mode")]
    pub modes: Vec<StructureMode>,
}

/// Structural model.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StructureModel {
    /// Typical section: plunge and pitch, optionally with a flap.
    TypicalSection,
    /// A rigid body.
    RigidBody,
    /// Modes of a flexible body.
    Modal,
    /// Natural modes computed from the particles of the body.
    OwnModes,
    /// Plunge, pitch and modes together, for generalised forces; used internally and not available in case files.
    Floating,
}

/// A coordinate (degree of freedom) of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Freedom {
    /// Displacement along x.
    Surge,
    /// Displacement along y (3-D).
    Sway,
    /// Upward displacement: along y in 2-D, along z in 3-D.
    Plunge,
    /// Angle about x (3-D).
    Roll,
    /// Pitch angle, nose up positive.
    Pitch,
    /// Angle about z (3-D).
    Yaw,
    /// Angle of the flap, trailing edge down positive.
    Flap,
}

/// A trailing-edge flap.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StructureFlap {
    /// Position c of the hinge in semichords aft of the middle of the chord.
    pub hinge: Option<f64>,
    /// Position of the hinge as a point in the initial placement, an alternative to `hinge`.
    pub hinge_point: Option<Vec<Length>>,
    /// x_β = S_β/(m b) with the mass m of the whole section.
    pub x_beta: f64,
    /// r_β² = I_β/(m b²) with the mass m of the whole section.
    pub r_beta2: f64,
    /// Frequency ratio ω_β/ω_α.
    pub frequency_ratio: Option<f64>,
    /// Length over which the rotation of the surface increases from zero to its full value at the hinge.
    pub blend: Length,
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

/// External forces as formulas of time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct StructureForce {
    /// Frequency, `omega` in the formulas.
    pub frequency: Option<Frequency>,
    /// Reduced frequency k = ωL/U∞, an alternative to `frequency`.
    pub reduced_frequency: Option<f64>,
    /// Length L of the reduced frequency; absent: half the reference chord.
    pub reduced_length: Option<Length>,
    /// Period 2π/ω, an alternative to `frequency`.
    pub period: Option<Time>,
    /// Formulas by name of the coordinate.
    #[serde(flatten)]
    pub formulas: PerCoordinate<String>,
}

/// A mode of a flexible body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StructureMode {
    /// Name of the mode.
    pub name: String,
    /// File of the mode shape, see [`super::read_mode`].
    pub file: String,
    /// Generalised mass.
    pub mass: f64,
    /// Frequency.
    pub frequency: Option<Frequency>,
    /// Reduced frequency k = ωb/U∞, an alternative to `frequency`.
    pub reduced_frequency: Option<f64>,
    /// Generalised stiffness, an alternative to `frequency`.
    pub stiffness: Option<f64>,
    /// Damping ratio.
    pub damping_ratio: f64,
    /// Cubic coefficient: the force of the spring is k (e + cubic e³).
    pub cubic: f64,
    /// Half the free play of the spring.
    pub free_play: f64,
    /// Initial value of the coordinate.
    pub initial: f64,
    /// Initial rate of the coordinate.
    pub initial_rate: f64,
    /// External generalised force as a formula of time.
    pub force: Option<String>,
}

impl Freedom {
    /// All coordinates.
    pub const ALL: [Self; 7] = [Self::Surge, Self::Sway, Self::Plunge, Self::Roll, Self::Pitch, Self::Yaw, Self::Flap];

    /// Name of the coordinate in the case file.
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

impl Freedom {
    /// True when the coordinate exists in cases of this dimension.
    pub fn exists_in(self, dimension: usize) -> bool {
        match self {
            Self::Surge | Self::Plunge | Self::Pitch => true,
            Self::Flap => dimension == 2,
            Self::Sway | Self::Roll | Self::Yaw => dimension == 3,
        }
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
