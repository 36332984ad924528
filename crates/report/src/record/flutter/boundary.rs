//! A flutter boundary: what was found at each Mach number, and limit cycles.
use serde::{Deserialize, Serialize};

use super::crossing::{Clearance, Doubt, FlutterRow, MotionRow};
use super::cycle::LimitCycle;
use super::numbers::{each_or_unknown, or_unknown};
use super::shape::{Mark, NaturalMode};
use super::state_space::StateSpaceAt;
use crate::case::Matching;

/// What files say about signs and units.
const CONVENTIONS: &str = "match none: speeds at constant density and Mach number; density: densities at constant speed; altitude: standard \
                           atmosphere of 1976, geometric altitude in metres; error, cloud_error and g_method: relative, of the speed at constant \
                           density, the root of the dynamic pressure; other columns that end in _error: half width of the error bar in the \
                           unit of the column; equivalent airspeed sqrt(2 q/1.225 kg/m3); V* = U/(b omega_alpha), speed index V* / sqrt(mu), k = omega b/U, \
                           b half of the reference chord; g = 2 zeta = 2 Re(lambda)/|lambda|, of motions that do not oscillate \
                           2 b lambda/(U ln 2): growth over a chord of the way, in doublings; motion exp(i omega t); plunge up, pitch \
                           nose up positive; shapes: the largest amplitude is 1 with phase 0, angles in radians, displacements of rigid \
                           bodies in b, modes in what their files have";

/// What makes a result doubtful, and what helps, one of [`remedy`](super::remedy).
pub type Warning = (String, &'static str);

/// The whole boundary.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Boundary {
    /// What the case is called.
    pub title: String,
    /// Signs and units.
    pub conventions: String,
    /// All Mach numbers.
    pub flutter: Vec<FlutterAt>,
    /// Limit cycles.
    pub lco: Vec<LimitCycle>,
}

impl Boundary {
    /// An empty one of a case.
    pub fn new(title: &str) -> Self {
        Self { title: title.to_owned(), conventions: CONVENTIONS.to_owned(), ..Self::default() }
    }
}

/// The equilibrium that forces are about.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct Trim {
    /// Speed of the stream over that of the case.
    pub speed_ratio: f64,
    /// Its dynamic pressure in the units of the case.
    pub dynamic_pressure: f64,
    /// Coordinates there, in base units.
    pub coordinates: Vec<f64>,
    /// Equilibria found on the way.
    pub rounds: usize,
}

/// Stream and structure of the case at a Mach number, which ratios refer to.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct CaseReference {
    /// Speed in the units of the case.
    pub speed: f64,
    /// Density in the units of the case.
    pub density: f64,
    /// Dynamic pressure in the units of the case.
    pub dynamic_pressure: f64,
    /// V_f, where the structure has one.
    pub speed_index: Option<f64>,
    /// V*, where the structure has one.
    pub reduced_speed: Option<f64>,
    /// Mass ratio, where the structure is a section.
    pub mass_ratio: Option<f64>,
}

/// What was found at one Mach number.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub struct FlutterAt {
    /// Mach number.
    pub mach: f64,
    /// What is varied.
    #[serde(rename = "match")]
    pub matching: Matching,
    /// True where the stream of the case has units: numbers are in SI units then.
    pub dimensional: bool,
    /// Number of space dimensions.
    pub dimension: usize,
    /// Every crossing, by what is varied: rising speed, rising density, falling altitude.
    pub crossings: Vec<FlutterRow>,
    /// Branches that grow already where forces are known for the first time: they have no crossing there.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub growing_from_start: Vec<String>,
    /// Ranges of speed in which the spacing of the cloud decides whether motions grow.
    pub doubts: Vec<Doubt>,
    /// What is left to the design speed, where one is given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<Clearance>,
    /// Natural modes in still air.
    pub natural: Vec<NaturalMode>,
    /// What ratios refer to.
    pub reference: CaseReference,
    /// Motions at the speeds looked at, mode by mode.
    #[serde(skip)]
    pub motions: Vec<MotionRow>,
    /// The structure in the stream as a linear system, where that is asked for.
    #[serde(skip)]
    pub state_space: Option<StateSpaceAt>,
    /// Limit cycles, where they are asked for.
    #[serde(skip)]
    pub cycles: Vec<LimitCycle>,
    /// Reduced frequencies that forces were computed at, zero first.
    pub reduced_frequencies: Vec<f64>,
    /// Generalised forces at these, rows one after another, in units of the solver: density and sound speed one.
    pub forces: Vec<Vec<[f64; 2]>>,
    /// Names of the coordinates.
    pub coordinates: Vec<String>,
    /// What these move.
    pub moved: Vec<Mark>,
    /// Coordinates of the steady flow.
    #[serde(skip)]
    pub still: Vec<f64>,
    /// Generalised forces of the steady flow, in units of the solver.
    #[serde(skip)]
    pub borne: Vec<f64>,
    /// The static equilibrium that forces are about; none where bodies stay as drawn.
    pub trim: Option<Trim>,
    /// Reference chord.
    pub chord: f64,
    /// b of the reduced frequencies.
    pub semichord: f64,
    /// Angle of attack.
    pub alpha_deg: f64,
    /// File that forces were read from; none where they were computed.
    pub read: Option<String>,
    /// Lift, drag and moment of the steady flow.
    #[serde(deserialize_with = "each_or_unknown")]
    pub steady: [f64; 3],
    /// Orders that its residual fell by.
    pub orders: f64,
    /// Particles.
    pub particles: usize,
    /// True where the steady flow is faster than sound somewhere.
    pub supersonic: bool,
    /// Particles of the coarsest cloud that speeds were held against; zero where there was none.
    pub coarser_particles: usize,
    /// Linear iterations of all columns.
    pub linear_iterations: usize,
    /// Greatest relative residual of a column.
    #[serde(deserialize_with = "or_unknown")]
    pub residual: f64,
    /// Processor seconds.
    pub cpu_seconds: f64,
    /// What makes results doubtful.
    pub warnings: Vec<String>,
    /// What helps against each of the warnings, in their order.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub remedies: Vec<String>,
    /// What is to be known of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

impl FlutterAt {
    /// The first crossing at which a motion begins to grow; `None` where none does, or where one grows from the first speed on.
    pub fn onset(&self) -> Option<&FlutterRow> {
        let begins = || self.crossings.iter().find(|c| c.kind != "restabilised");
        if self.growing_from_start.is_empty() { begins() } else { None }
    }

    /// Adds limit cycles, and what makes them doubtful.
    pub fn add_cycles(&mut self, (cycles, doubts): (Vec<LimitCycle>, Vec<Warning>)) {
        self.cycles = cycles;
        doubts.into_iter().for_each(|doubt| self.warn(doubt));
    }

    /// Adds a warning and what helps against it.
    pub fn warn(&mut self, (what, remedy): Warning) {
        self.warnings.push(what);
        self.remedies.push(remedy.to_owned());
    }

    /// Adds the warnings of another boundary of the same case that are not among these.
    pub fn warn_of(&mut self, other: &Self) {
        for (what, remedy) in other.warnings.iter().zip(&other.remedies) {
            if !self.warnings.contains(what) {
                self.warnings.push(what.clone());
                self.remedies.push(remedy.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::remedy;
    use super::*;

    #[test]
    fn warnings_keep_their_remedies() {
        let mut at = FlutterAt::default();
        at.warn(("a doubt".into(), remedy::FREQUENCIES));
        let mut other = FlutterAt::default();
        other.warn(("a doubt".into(), remedy::SPACING));
        other.warn(("another".into(), remedy::STEADY));
        at.warn_of(&other);
        assert_eq!(at.warnings, ["a doubt", "another"]);
        assert_eq!(at.remedies, [remedy::FREQUENCIES, remedy::STEADY]);
    }
}
