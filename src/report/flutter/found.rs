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
    pub(super) crossings: Vec<Crossing>,
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
    pub(super) mode: usize,
    pub(super) speed_ratio: f64,
    pub(super) speed_index: Option<f64>,
    pub(super) reduced_speed: Option<f64>,
    pub(super) speed: f64,
    pub(super) density: f64,
    pub(super) dynamic_pressure: f64,
    pub(super) mass_ratio: Option<f64>,
    pub(super) altitude: Option<f64>,
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
    /// Half the length of its error bar, over the speed: the greater of both errors.
    pub(super) fn bar(&self) -> f64 {
        self.error.into_iter().chain(self.cloud_error).reduce(f64::max).unwrap_or(f64::NAN)
    }
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
    pub(super) mode: usize,
    pub(super) speed_ratio: f64,
    pub(super) damping: f64,
    pub(super) frequency: f64,
    pub(super) eigenvalue: [f64; 2],
    pub(super) density: f64,
    pub(super) altitude: f64,
}

impl Found {
    /// What is in a folder, or why it cannot be read.
    pub(super) fn of(run: &RunFolder) -> Result<Self, String> {
        let mut found: Self =
            serde_json::from_value(run.json(SUMMARY)?).map_err(|e| format!("`{SUMMARY}` has no flutter: {e}"))?;
        found.motions = run.table(HISTORY).map(|table| motions(&table)).unwrap_or_default();
        Ok(found)
    }

    /// Motions at a Mach number, mode by mode.
    pub(super) fn modes(&self, mach: f64) -> Vec<(usize, Vec<&Motion>)> {
        let own = || self.motions.iter().filter(|m| m.mach == mach);
        let most = own().map(|m| m.mode).max().unwrap_or(0);
        let one = |mode: usize| (mode, own().filter(|m| m.mode == mode).collect::<Vec<_>>());
        (1..=most).map(one).filter(|(_, all)| !all.is_empty()).collect()
    }
}

impl At {
    /// What begins to grow first, or what else happens first.
    pub(super) fn first(&self) -> Option<&Crossing> {
        self.crossings.iter().find(|c| c.kind == "flutter").or(self.crossings.first())
    }

    /// What is varied, as axes call it.
    pub(super) fn varied(&self) -> &'static str {
        match &self.matching[..] {
            "density" => "density",
            "altitude" => "altitude, m",
            _ if self.reference.speed_index.is_some() => "speed index",
            _ => "speed over that of the case",
        }
    }

    /// Where a motion stands on that axis.
    pub(super) fn place(&self, motion: &Motion) -> f64 {
        match &self.matching[..] {
            "density" => motion.density,
            "altitude" => motion.altitude,
            _ => motion.speed_ratio * self.reference.speed_index.unwrap_or(1.0),
        }
    }

    /// Where a crossing stands there.
    pub(super) fn place_of(&self, crossing: &Crossing) -> f64 {
        match &self.matching[..] {
            "density" => crossing.density,
            "altitude" => crossing.altitude.unwrap_or(f64::NAN),
            _ => crossing.speed_ratio * self.reference.speed_index.unwrap_or(1.0),
        }
    }
}

fn motions(table: &Csv) -> Vec<Motion> {
    let column = |name: &str| table.numbers(name).unwrap_or_default();
    let names = ["mach", "mode", "speed_ratio", "damping_g", "frequency", "eigenvalue_re", "eigenvalue_im", "density"];
    let all = names.map(column);
    let altitude = column("altitude");
    let at = |values: &[f64], k: usize| values.get(k).copied().unwrap_or(f64::NAN);
    let row = |k: usize| {
        let [mach, mode, speed_ratio, damping, frequency, re, im, density] =
            [0, 1, 2, 3, 4, 5, 6, 7].map(|c| at(&all[c], k));
        let (mode, altitude) = (mode as usize, at(&altitude, k));
        Motion { mach, mode, speed_ratio, damping, frequency, eigenvalue: [re, im], density, altitude }
    };
    (0..table.rows.len()).map(row).collect()
}
