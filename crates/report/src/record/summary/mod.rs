//! What a run of a gas found and what it took, section by section: `summary.json`.
mod conditions;
mod convergence;
mod cost;
mod grid;
mod loads;
mod periodic;
mod polar;
mod polar_table;
mod reference;
mod structures;

use serde::ser::{Error, SerializeMap};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};

use crate::math::digits::short;
use crate::observe::error_bars::ErrorBars;

pub use conditions::{Conditions, FreeStream};
pub use convergence::{Ledger, Progress, Reclouding};
pub use cost::{Cost, FILES};
pub use grid::GridConvergence;
pub use loads::{Loads, Separation, TipVortex, WakePlane};
pub use periodic::{
    Apart, BalanceReport, Change, FirstHarmonics, GeneralisedForce, LastPeriod, LoadCrosscheck, LoadsApart,
    MarchingCheck, Periodic, PeriodicLoads,
};
pub use polar::PolarPoint;
pub use polar_table::write_polar;
pub use reference::{ReferenceValues, list};
pub use structures::{ProbeEnd, SolidEnd, Structures};

/// Keys of `summary.json` in the order in which they are written; those that a run has no value of are absent.
const KEYS: [&str; 56] = [
    "event",
    "case",
    "run",
    "particles",
    "iterations",
    "residual_drop",
    "converged",
    "cpu_seconds",
    "wall_seconds",
    "peak_bytes",
    "loads",
    "loads_pressure",
    "loads_friction",
    "separation",
    "loads_momentum_balance",
    "tip_vortex",
    "ledger",
    "root_loads",
    "hinge_moments",
    "span_load",
    "wake_planes",
    "work_units",
    "free_stream",
    "chord",
    "cloud",
    "loads_at",
    "mach",
    "alpha_deg",
    "reynolds",
    "reference",
    "harmonic_balance",
    "structure",
    "solid",
    "swings",
    "generalised_forces",
    "time",
    "unconverged_steps",
    "halved_steps",
    "re_clouding",
    "periodic_change",
    "first_harmonics",
    "momentum_of_period",
    "last_period",
    "periodic_loads",
    "lift_cycles",
    "bytes_per_particle",
    "cpu_ms_per_particle",
    "linear_iterations",
    "error_l2_density",
    "loads_error",
    "grid_convergence",
    "error_bars",
    "polar",
    "warnings",
    "adapt_change",
    "phases",
];

/// What a run found and what it took: all sections in one table.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub struct Summary {
    /// What was computed, and what results refer to.
    #[serde(flatten)]
    pub conditions: Conditions,
    /// How far a flow came: iterations, residual, conservation.
    #[serde(flatten)]
    pub convergence: Progress,
    /// Loads on all bodies.
    #[serde(flatten)]
    pub loads: Loads,
    /// Loads on a family of clouds.
    #[serde(flatten)]
    pub grid: GridConvergence,
    /// Numbers of a march or a balance with their error bars, where these are asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_bars: Option<ErrorBars>,
    /// The points of a polar; all else is of the last of them whose flow is known.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub polar: Vec<PolarPoint>,
    /// Loads of a motion that repeats.
    #[serde(flatten)]
    pub periodic: Periodic,
    /// What became of bodies that move with the gas.
    #[serde(flatten)]
    pub structures: Structures,
    /// What a run took.
    #[serde(flatten)]
    pub cost: Cost,
}

/// The keys are in the order that readers of the file know, not section by section.
impl Serialize for Summary {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let sections = Self::serialize(self, serde_json::value::Serializer).map_err(S::Error::custom)?;
        let Value::Object(mut all) = sections else { return Err(S::Error::custom("sections are tables")) };
        all.insert("event".to_owned(), "summary".into());
        in_order(&all, serializer)
    }
}

impl<'de> Deserialize<'de> for Summary {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        Self::deserialize(deserializer)
    }
}

fn in_order<S: Serializer>(all: &Map<String, Value>, serializer: S) -> Result<S::Ok, S::Error> {
    let told = KEYS.iter().filter_map(|key| Some((key, all.get(*key)?)));
    let mut map = serializer.serialize_map(None)?;
    for (key, value) in told {
        map.serialize_entry(key, value)?;
    }
    map.end()
}

impl Summary {
    /// False where the goal was not reached. A march to its end has reached all that it was asked for.
    pub fn succeeded(&self) -> bool {
        self.convergence.converged != Some(false)
    }

    /// Stream and reference values in one line; the stream of a polar differs from point to point.
    pub fn conditions(&self) -> String {
        let alone = self.polar.is_empty();
        let stream = format!("M {}, alpha {} deg", short(self.conditions.mach), short(self.conditions.alpha_deg));
        let reynolds = self.conditions.reynolds.filter(|_| alone).map(|re| format!("Re {}", short(re)));
        let reference = self.conditions.reference.as_ref().map(ReferenceValues::told);
        let all = [alone.then_some(stream), reynolds, reference];
        all.into_iter().flatten().collect::<Vec<_>>().join(", ")
    }

    /// True where the loads are those of an instant: of a march, not of a balance.
    pub fn is_march(&self) -> bool {
        self.conditions.loads_at.is_some() && self.periodic.harmonic_balance.is_none()
    }
}
