//! Stages: what a run is a plain list of.
use serde::{Deserialize, Serialize};

use crate::problem::coarser::times_the_spacing;

/// What a stage does on its cloud.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Task {
    /// Relaxes to a steady state.
    Relax,
    /// Marches in time.
    March,
    /// Marches a few coarse periods that a harmonic balance begins from.
    Lead,
    /// Finds a periodic state with a number of harmonics.
    Balance {
        /// The number.
        harmonics: usize,
    },
}

/// One stage of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Stage {
    /// Factor on every spacing of the case: 1 except for the clouds that a steady case starts on.
    pub(crate) factor: f64,
    /// Cycle of adaptation, 0 before any.
    pub(crate) cycle: u32,
    /// Point of a polar; absent where there is one flow only.
    #[serde(default)]
    pub(crate) point: Option<usize>,
    /// True where a run goes back to a coarser cloud, for want of a steady flow on the finer one.
    #[serde(default)]
    pub(crate) back: bool,
    /// What is done there.
    pub(crate) task: Task,
}

impl Stage {
    /// A relaxation on the cloud of the case itself.
    pub(crate) const PLAIN: Self = Self { factor: 1.0, cycle: 0, point: None, back: false, task: Task::Relax };

    /// True when both stand on the same cloud, in the same free stream.
    pub(crate) fn shares_cloud(&self, other: &Self) -> bool {
        self.factor == other.factor && self.cycle == other.cycle && self.point == other.point
    }

    /// What is told while its cloud is built.
    pub(crate) fn building(&self) -> String {
        let spacing =
            if self.factor == 1.0 { String::new() } else { format!(" with {}", times_the_spacing(self.factor)) };
        let cycle = if self.cycle == 0 { String::new() } else { format!(", refined {} times", self.cycle) };
        format!("building the cloud{spacing}{cycle}")
    }

    /// Instances of a period that a state of this stage holds.
    pub(crate) fn instances(&self) -> usize {
        match self.task {
            Task::Balance { harmonics } => 2 * harmonics + 1,
            _ => 1,
        }
    }
}

/// The stages of a run in words, the last cloud of which has `n` fluid particles.
pub(crate) fn describe(stages: &[Stage], n: usize) -> String {
    let first = || stages.iter().filter(|s| s.point.unwrap_or(0) == 0);
    let mut factors: Vec<f64> = first().map(|s| s.factor).filter(|f| *f > 1.0).collect();
    factors.dedup();
    let coarse = factors.len();
    let cycles = (1..).take_while(|c| first().any(|s| s.factor == 1.0 && s.cycle == *c)).count();
    let points = stages.last().and_then(|s| s.point).map_or_else(String::new, |p| format!("; {} points", p + 1));
    format!("{n} fluid particles; {coarse} coarser clouds for the start, {cycles} cycles of adaptation{points}")
}
