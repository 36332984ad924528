//! What is told of a flutter boundary: Mach numbers, limit cycles, pictures.
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::super::error::RunError;
use super::super::files::write_state_script;
use super::super::folder::BOUNDARY;
use super::held::Mark;
use super::rows::{Clearance, Doubt, FlutterRow, MotionRow, or_infinite};
use super::scales::CaseReference;
use super::shapes::NaturalMode;
use super::skin::Skin;
use super::state_space::StateSpaceAt;
use crate::case::Matching;
use crate::observe::About;
use crate::observe::columns::Scale;
use crate::observe::table::write_json;
use crate::report;

/// The surface that moves, for the page.
const MODES: &str = "modes.json";
/// What files say about signs and units.
const CONVENTIONS: &str = "match none: speeds at constant density and Mach number; density: densities at constant speed; altitude: standard \
                           atmosphere of 1976, geometric altitude in metres; error, cloud_error and g_method: relative, of the speed at constant \
                           density, the root of the dynamic pressure; other columns that end in _error: half width of the error bar in the \
                           unit of the column; equivalent airspeed sqrt(2 q/1.225 kg/m3); V* = U/(b omega_alpha), speed index V* / sqrt(mu), k = omega b/U, \
                           b half of the reference chord; g = 2 zeta = 2 Re(lambda)/|lambda|, of motions that do not oscillate \
                           2 b lambda/(U ln 2): growth over a chord of the way, in doublings; motion exp(i omega t); plunge up, pitch \
                           nose up positive; shapes: the largest amplitude is 1 with phase 0, angles in radians, displacements of rigid \
                           bodies in b, modes in what their files have";

/// The equilibrium that forces are about.
#[derive(Clone, Debug, Serialize, Deserialize)]
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

/// What was found at one Mach number.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct FlutterAt {
    /// Mach number.
    pub mach: f64,
    /// What is varied.
    #[serde(rename = "match")]
    pub matching: Matching,
    /// True where the stream of the case has units: numbers are in SI units then.
    #[serde(default)]
    pub dimensional: bool,
    /// Number of space dimensions.
    #[serde(default)]
    pub dimension: usize,
    /// Every crossing, by what is varied: rising speed, rising density, falling altitude.
    pub crossings: Vec<FlutterRow>,
    /// Branches that grow already where forces are known for the first time: they have no crossing there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub growing_from_start: Vec<String>,
    /// Ranges of speed in which the spacing of the cloud decides whether motions grow.
    #[serde(default)]
    pub doubts: Vec<Doubt>,
    /// What is left to the design speed, where one is given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
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
    pub steady: [f64; 3],
    /// Orders that its residual fell by.
    pub orders: f64,
    /// Particles.
    pub particles: usize,
    /// True where the steady flow is faster than sound somewhere.
    #[serde(default)]
    pub supersonic: bool,
    /// Particles of the coarsest cloud that speeds were held against; zero where there was none.
    pub coarser_particles: usize,
    /// Linear iterations of all columns.
    pub linear_iterations: usize,
    /// Greatest relative residual of a column.
    pub residual: f64,
    /// Processor seconds.
    pub cpu_seconds: f64,
    /// What makes results doubtful.
    pub warnings: Vec<String>,
    /// What helps against each of the warnings, in their order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub remedies: Vec<String>,
    /// What is to be known of them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
}

/// A limit cycle.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct LimitCycle {
    /// Mach number.
    pub mach: f64,
    /// Number of the branch, from 1.
    pub branch: usize,
    /// Coordinate whose amplitude is told.
    pub coordinate: String,
    /// Amplitude of its first harmonic, of angles in degrees.
    pub amplitude: f64,
    /// Speed over that of the structure in the case.
    pub speed_ratio: f64,
    /// V_f, where the structure has one.
    pub speed_index: Option<f64>,
    /// V*, the same times the root of the mass ratio.
    pub reduced_speed: Option<f64>,
    /// Speed in the units of the case.
    pub speed: f64,
    /// Density, dynamic pressure and, where that is varied, altitude in metres.
    pub density: f64,
    /// See density.
    pub dynamic_pressure: f64,
    /// See density.
    pub altitude: Option<f64>,
    /// k.
    pub reduced_frequency: f64,
    /// Cycles per unit of time of the case.
    pub frequency: f64,
    /// True where smaller and larger motions go to it.
    pub stable: bool,
    /// Mean of the coordinate, of angles in degrees.
    pub mean: f64,
    /// Means of all coordinates in base units.
    pub means: Vec<f64>,
    /// Harmonics.
    pub harmonics: usize,
    /// Relative change of the speed with the last of them; infinite where none were added.
    #[serde(deserialize_with = "or_infinite")]
    pub error: f64,
    /// Harmonic balances of the gas.
    pub balances: usize,
    /// Amplitudes of all coordinates, harmonic by harmonic: real and imaginary part in base units.
    pub motion: Vec<Vec<[f64; 2]>>,
    /// True where a harmonic lies beyond the frequencies that forces were computed at.
    pub extrapolated: bool,
    /// What a march from it ends with, where there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub march: Option<MarchedCycle>,
}

/// What a march from a limit cycle ends with.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MarchedCycle {
    /// Amplitude of the first harmonic of the coordinate over the last period, of angles in degrees.
    pub amplitude: f64,
    /// Mean over it, of angles in degrees.
    pub mean: f64,
    /// Frequency in cycles per unit of time of the case.
    pub frequency: f64,
    /// Periods that were marched.
    pub periods: f64,
    /// Amplitude over that of the balance, less one.
    pub difference: f64,
    /// Change of the amplitude in the last period, over it.
    pub change: f64,
    /// Processor seconds.
    pub cpu_seconds: f64,
}

/// Cycles, and what makes them doubtful.
pub(super) type Found = (Vec<LimitCycle>, Vec<Warning>);

/// What makes a result doubtful, and what helps, one of [`remedy`].
pub(super) type Warning = (String, &'static str);

/// What helps against a warning, or where more is told of it.
pub(super) mod remedy {
    /// A steady flow that did not converge.
    pub(in super::super) const STEADY: &str = "raise `iterations`, or lower `orders`, in `[time.steady]`";
    /// Motions that grow at the lowest speed at which forces are known.
    pub(in super::super) const LOWEST: &str =
        "give higher `reduced_frequencies` in `[flutter]`: they reach lower speeds";
    /// No motion within the frequencies at which forces are known.
    pub(in super::super) const HIGHER: &str = "give higher `reduced_frequencies` in `[flutter]`";
    /// Motions that grow at any density.
    pub(in super::super) const DAMPING: &str = "give the structure its damping, `damping_ratio`";
    /// What the spacing of the cloud decides.
    pub(in super::super) const SPACING: &str =
        "lower `spacing` in `[cloud]`: the range of speed is that of `doubts` in `flutter.json`";
    /// Crossings that more frequencies would tell better.
    pub(in super::super) const FREQUENCIES: &str = "raise `frequencies` in `[flutter]`";
    /// Limit cycles that more harmonics would tell better.
    pub(in super::super) const HARMONICS: &str = "raise `harmonics` in `[lco]`";
    /// Equilibria that do not come to the crossing.
    pub(in super::super) const EQUILIBRIA: &str =
        "give the structure a speed nearer to the crossing, from which the equilibria are sought";
    /// The march of a limit cycle.
    pub(in super::super) const MARCH: &str =
        "leave `march` out of `[lco]`, or compute that march with a case of its own";
    /// Limit cycles.
    pub(in super::super) const CYCLES: &str = "see the branches in `lco.csv`; other amplitudes are given in `[lco]`";
    /// All else.
    pub(in super::super) const SEE: &str = "see `warnings` and the crossings in `flutter.json`";
}

/// The whole boundary.
#[derive(Clone, Debug, Serialize)]
pub struct Boundary {
    /// What the case is called.
    pub title: String,
    /// Signs and units.
    pub conventions: &'static str,
    /// All Mach numbers.
    pub flutter: Vec<FlutterAt>,
    /// Limit cycles.
    pub lco: Vec<LimitCycle>,
    /// What draws motions, where pictures are asked for.
    #[serde(skip)]
    pub(super) skin: Option<Skin>,
}

impl Boundary {
    /// An empty one of a case.
    pub(super) fn new(title: &str) -> Self {
        Self { title: title.to_owned(), conventions: CONVENTIONS, flutter: Vec::new(), lco: Vec::new(), skin: None }
    }
}

impl Boundary {
    /// Writes tables and pictures into a folder.
    pub(super) fn write(&self, out: &Path) -> Result<(), RunError> {
        self.write_tables(out)?;
        for at in &self.flutter {
            at.state_space.iter().try_for_each(|system| system.write(at.mach, out))?;
        }
        self.describe_tables(out)?;
        write_json(&out.join(BOUNDARY), &self)?;
        self.skin.as_ref().map_or(Ok(()), |skin| self.picture(skin, out))
    }

    /// Writes pictures and page, and the motions at which the last Mach number begins to flutter.
    fn picture(&self, skin: &Skin, out: &Path) -> Result<(), RunError> {
        if self.flutter.len() == 1 {
            skin.write(&out.join(MODES))?;
        }
        if let Some(at) = self.flutter.last() {
            let flutter = at.crossings.iter().filter(|c| c.kind == "flutter");
            let shown: Vec<&FlutterRow> = match flutter.clone().next() {
                Some(_) => flutter.collect(),
                None => at.crossings.iter().take(1).collect(),
            };
            for (k, crossing) in shown.into_iter().enumerate() {
                let more = if k > 0 { format!("-{}", k + 1) } else { String::new() };
                let name = format!("flutter-mode-mach-{:.3}{more}", at.mach);
                // one that was written with pressures before it was interrupted stays
                if crossing.walls.is_some() || !out.join(format!("{name}.pvd")).is_file() {
                    skin.write_series(out, (&name, &at.about(&self.title, crossing)), crossing)?;
                }
            }
        }
        write_state_script(out)?;
        report::write_flutter(out)?;
        report::write_report(out)?;
        Ok(())
    }
}

impl FlutterAt {
    /// What files of the motion at a crossing tell.
    fn about(&self, title: &str, crossing: &FlutterRow) -> About {
        let unit = |what: &str, si: &str, own: &str| format!("{what} [{}]", if self.dimensional { si } else { own });
        About {
            scale: Some(Scale { dimensional: self.dimensional, dimension: self.dimension }),
            numbers: vec![
                ("Mach number".to_owned(), self.mach),
                ("alpha [deg]".to_owned(), self.alpha_deg),
                (unit("speed", "m/s", "a"), crossing.speed),
                (unit("density", "kg/m3", "rho"), crossing.density),
                (unit("dynamic pressure", "Pa", "rho.a2"), crossing.dynamic_pressure),
                (unit("frequency", "Hz", "a/L"), crossing.frequency),
                ("reduced frequency".to_owned(), crossing.reduced_frequency),
            ],
            words: vec![("title", title.to_owned()), ("motion", format!("{}, {}", crossing.kind, crossing.branch))],
            scalars: if crossing.walls.is_some() { "cp_unsteady" } else { "displacement" },
            vectors: "displacement",
        }
    }

    /// The first crossing at which a motion begins to grow; `None` where none does, or where one grows from the first speed on.
    pub fn onset(&self) -> Option<&FlutterRow> {
        let begins = || self.crossings.iter().find(|c| c.kind != "restabilised");
        if self.growing_from_start.is_empty() { begins() } else { None }
    }

    /// Adds limit cycles, and what makes them doubtful.
    pub(super) fn add_cycles(&mut self, (cycles, doubts): Found) {
        self.cycles = cycles;
        doubts.into_iter().for_each(|doubt| self.warn(doubt));
    }

    /// Adds a warning and what helps against it.
    pub(super) fn warn(&mut self, (what, remedy): Warning) {
        self.warnings.push(what);
        self.remedies.push(remedy.to_owned());
    }

    /// Adds the warnings of another boundary of the same case that are not among these.
    pub(super) fn warn_of(&mut self, other: &Self) {
        for (what, remedy) in other.warnings.iter().zip(&other.remedies) {
            if !self.warnings.contains(what) {
                self.warnings.push(what.clone());
                self.remedies.push(remedy.clone());
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
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

    /// A limit cycle of two degrees of pitch.
    pub(in super::super) fn cycle() -> LimitCycle {
        LimitCycle {
            mach: 0.8,
            branch: 1,
            coordinate: "pitch".into(),
            amplitude: 2.0,
            speed_ratio: 1.2,
            speed_index: Some(0.72),
            reduced_speed: None,
            speed: 0.96,
            density: 1.0,
            dynamic_pressure: 0.4,
            altitude: None,
            reduced_frequency: 0.1,
            frequency: 0.03,
            stable: true,
            mean: 0.0,
            means: vec![0.01, 0.0],
            harmonics: 2,
            error: 0.001,
            balances: 5,
            motion: vec![vec![[-0.14, 0.03], [0.035, 0.0]], vec![[1e-3, 2e-3], [-1e-3, 5e-4]]],
            extrapolated: false,
            march: None,
        }
    }
}
