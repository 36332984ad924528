//! What `alula flutter` left in its folder, as the page and its charts read it.
use serde::Deserialize;

use super::super::files::{Csv, RunFolder};

/// Tables of a run.
const SUMMARY: &str = "flutter.json";
const HISTORY: &str = "v-g.csv";

/// The whole boundary.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Found {
    pub(super) title: String,
    pub(super) flutter: Vec<At>,
    pub(super) lco: Vec<Cycle>,
    /// Motions at all speeds.
    #[serde(skip)]
    pub(super) motions: Vec<Motion>,
}

/// One Mach number.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct At {
    pub(super) mach: f64,
    #[serde(rename = "match")]
    pub(super) matching: String,
    /// True where numbers are in SI units.
    pub(super) dimensional: bool,
    pub(super) crossings: Vec<Crossing>,
    pub(super) doubts: Vec<Doubt>,
    pub(super) clearance: Option<Clearance>,
    pub(super) natural: Vec<Natural>,
    pub(super) reference: Reference,
    pub(super) reduced_frequencies: Vec<f64>,
    pub(super) coordinates: Vec<String>,
    pub(super) chord: f64,
    pub(super) semichord: f64,
    pub(super) alpha_deg: f64,
    pub(super) read: Option<String>,
    pub(super) trim: Option<Trim>,
    pub(super) steady: [Option<f64>; 3],
    pub(super) orders: f64,
    pub(super) particles: f64,
    pub(super) linear_iterations: f64,
    pub(super) residual: Option<f64>,
    pub(super) cpu_seconds: f64,
    pub(super) warnings: Vec<String>,
    #[serde(default)]
    pub(super) notes: Vec<String>,
}

/// Stream and structure of the case.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Reference {
    pub(super) speed: f64,
    pub(super) density: f64,
    pub(super) dynamic_pressure: f64,
    pub(super) speed_index: Option<f64>,
    pub(super) reduced_speed: Option<f64>,
    pub(super) mass_ratio: Option<f64>,
}

/// The static equilibrium that forces are about.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Trim {
    pub(super) speed_ratio: f64,
    pub(super) dynamic_pressure: f64,
    pub(super) coordinates: Vec<f64>,
}

/// A change from decay to growth, or back.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Crossing {
    pub(super) kind: String,
    pub(super) branch: String,
    pub(super) mode: Option<usize>,
    pub(super) speed_ratio: f64,
    pub(super) speed_index: Option<f64>,
    pub(super) reduced_speed: Option<f64>,
    pub(super) speed: f64,
    pub(super) equivalent_airspeed: Option<f64>,
    pub(super) density: f64,
    pub(super) dynamic_pressure: f64,
    pub(super) mass_ratio: Option<f64>,
    pub(super) altitude: Option<f64>,
    pub(super) speed_ratio_error: Option<f64>,
    pub(super) speed_index_error: Option<f64>,
    pub(super) reduced_speed_error: Option<f64>,
    pub(super) speed_error: Option<f64>,
    pub(super) equivalent_airspeed_error: Option<f64>,
    pub(super) density_error: Option<f64>,
    pub(super) dynamic_pressure_error: Option<f64>,
    pub(super) altitude_error: Option<f64>,
    pub(super) remarks: Vec<String>,
    pub(super) margin: Option<f64>,
    pub(super) reduced_frequency: f64,
    pub(super) frequency: f64,
    pub(super) frequency_ratio: Option<f64>,
    /// Of the root of the dynamic pressure; none where nothing is known of it.
    pub(super) error: Option<f64>,
    pub(super) cloud_error: Option<f64>,
    pub(super) g_method: Option<f64>,
    pub(super) extrapolated: bool,
    pub(super) shape: Vec<Share>,
}

impl Crossing {
    /// The motion that it belongs to; runs of former versions number it alone.
    pub(super) fn name(&self) -> String {
        match (self.branch.is_empty(), self.mode) {
            (true, Some(mode)) => format!("mode {mode}"),
            _ => self.branch.clone(),
        }
    }
}

/// A range of speed in which the spacing of the cloud decides whether a motion grows.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Doubt {
    pub(super) branch: String,
    pub(super) kind: String,
    pub(super) speed_ratio: [f64; 2],
    pub(super) speed: [f64; 2],
    pub(super) equivalent_airspeed: Option<[f64; 2]>,
    pub(super) dynamic_pressure: [f64; 2],
    pub(super) altitude: Option<[f64; 2]>,
    pub(super) damping: f64,
    pub(super) damping_coarser: f64,
}

/// What is left to the design speed.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Clearance {
    pub(super) design_speed: f64,
    pub(super) required: f64,
    pub(super) lowest: Option<f64>,
    pub(super) lowest_error: Option<f64>,
    pub(super) margin: Option<f64>,
    pub(super) passes: bool,
    pub(super) reason: String,
}

/// A natural mode.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Natural {
    pub(super) mode: usize,
    pub(super) frequency: f64,
    pub(super) shape: Vec<Share>,
}

/// A coordinate in a motion.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Share {
    pub(super) coordinate: String,
    pub(super) amplitude: f64,
    pub(super) phase_deg: f64,
}

/// A limit cycle.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct Cycle {
    pub(super) mach: f64,
    pub(super) branch: usize,
    pub(super) coordinate: String,
    pub(super) amplitude: f64,
    pub(super) speed_index: Option<f64>,
    pub(super) speed: f64,
    pub(super) speed_ratio: f64,
    pub(super) dynamic_pressure: f64,
    pub(super) altitude: Option<f64>,
    pub(super) reduced_frequency: f64,
    pub(super) frequency: f64,
    pub(super) stable: bool,
    pub(super) mean: f64,
    pub(super) harmonics: usize,
    pub(super) error: Option<f64>,
    pub(super) balances: usize,
    pub(super) extrapolated: bool,
    pub(super) march: Option<March>,
}

/// A march from a limit cycle.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
pub(super) struct March {
    pub(super) amplitude: f64,
    pub(super) frequency: f64,
    pub(super) periods: f64,
    pub(super) difference: f64,
    pub(super) change: f64,
    pub(super) cpu_seconds: f64,
}

/// A motion at a speed.
#[derive(Clone, Debug, Default)]
pub(super) struct Motion {
    pub(super) mach: f64,
    pub(super) branch: String,
    pub(super) speed_ratio: f64,
    pub(super) speed: f64,
    pub(super) equivalent_airspeed: f64,
    pub(super) damping: f64,
    pub(super) frequency: f64,
    pub(super) eigenvalue: [f64; 2],
    pub(super) density: f64,
    pub(super) dynamic_pressure: f64,
}

impl Motion {
    /// True of a mode that decays without oscillating, whose damping says little.
    pub(super) fn rests(&self) -> bool {
        self.frequency == 0.0 && self.eigenvalue[0] <= 0.0
    }
}

impl Found {
    /// What is in a folder, or why it cannot be read.
    pub(super) fn of(run: &RunFolder) -> Result<Self, String> {
        let mut found: Self =
            serde_json::from_value(run.json(SUMMARY)?).map_err(|e| format!("`{SUMMARY}` has no flutter: {e}"))?;
        found.motions = run.table(HISTORY).map(|table| motions(&table)).unwrap_or_default();
        Ok(found)
    }

    /// Motions at a Mach number, branch by branch.
    pub(super) fn branches(&self, mach: f64) -> Vec<(&str, Vec<&Motion>)> {
        let mut all: Vec<(&str, Vec<&Motion>)> = Vec::new();
        for motion in self.motions.iter().filter(|m| m.mach == mach) {
            match all.iter_mut().find(|(name, _)| *name == motion.branch) {
                Some((_, own)) => own.push(motion),
                None => all.push((&motion.branch, vec![motion])),
            }
        }
        all
    }
}

impl At {
    /// What begins to grow first, or what else happens first.
    pub(super) fn first(&self) -> Option<&Crossing> {
        self.crossings.iter().find(|c| c.kind == "flutter").or(self.crossings.first())
    }

    /// What is varied, as axes call it.
    pub(super) fn varied(&self) -> &'static str {
        match (&self.matching[..], self.dimensional) {
            ("density", true) => "dynamic pressure, Pa",
            ("density", false) => "density",
            ("altitude", _) => "EAS, m/s",
            (_, true) => "TAS, m/s",
            _ if self.reference.speed_index.is_some() => "speed index",
            _ => "speed over that of the case",
        }
    }

    /// Where a motion stands on that axis.
    pub(super) fn place(&self, motion: &Motion) -> f64 {
        match (&self.matching[..], self.dimensional) {
            ("density", true) => motion.dynamic_pressure,
            ("density", false) => motion.density,
            ("altitude", _) => motion.equivalent_airspeed,
            (_, true) => motion.speed,
            _ => motion.speed_ratio * self.reference.speed_index.unwrap_or(1.0),
        }
    }

    /// Where a crossing stands there.
    pub(super) fn place_of(&self, crossing: &Crossing) -> f64 {
        match (&self.matching[..], self.dimensional) {
            ("density", true) => crossing.dynamic_pressure,
            ("density", false) => crossing.density,
            ("altitude", _) => crossing.equivalent_airspeed.unwrap_or(f64::NAN),
            (_, true) => crossing.speed,
            _ => crossing.speed_ratio * self.reference.speed_index.unwrap_or(1.0),
        }
    }
}

fn motions(table: &Csv) -> Vec<Motion> {
    let numbers = |name: &str| table.numbers(name).unwrap_or_default();
    let names = ["mach", "mode", "speed_ratio", "speed", "equivalent_airspeed", "damping_g", "frequency"];
    let more = ["eigenvalue_re", "eigenvalue_im", "density", "dynamic_pressure"];
    let (first, last) = (names.map(numbers), more.map(numbers));
    let branches = table.column("branch").unwrap_or_default();
    let row = |k: usize| {
        let at = |values: &Vec<f64>| values.get(k).copied().unwrap_or(f64::NAN);
        let [mach, mode, speed_ratio, speed, equivalent_airspeed, damping, frequency] = first.each_ref().map(at);
        let [re, im, density, dynamic_pressure] = last.each_ref().map(at);
        let branch = branches.get(k).map_or_else(|| format!("mode {mode}"), |name| (*name).to_owned());
        Motion {
            mach,
            branch,
            speed_ratio,
            speed,
            equivalent_airspeed,
            damping,
            frequency,
            eigenvalue: [re, im],
            density,
            dynamic_pressure,
        }
    };
    (0..table.rows.len()).map(row).collect()
}
