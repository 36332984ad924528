//! What a run writes, how often, and beside what.
use serde::{Deserialize, Serialize};

use super::quantity::{Time, WallTime};

/// What is written, and how often.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Iterations between checkpoints, at most.
    pub checkpoint: u32,
    /// Wall-clock time between checkpoints, at most.
    pub checkpoint_time: WallTime,
    /// Time between field files in marching runs; absent: the last field only.
    pub field_interval: Option<Time>,
    /// Most fluid particles in a field file; absent: all.
    pub field_particles: Option<u32>,
    /// Periods at the end of a march that loops and harmonics of the loads are the mean of.
    pub loop_periods: u32,
    /// Write `report.html` and pictures.
    pub report: bool,
    /// Parts of the half span at which Cp is drawn along the chord, in space; absent: those of the references, else a usual list.
    pub stations: Option<Vec<f64>>,
}

/// A reference curve of Cp against x/c.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compare {
    /// CSV file with columns `x_c` and `Cp`, in space `eta`, the part of the half span, relative to the case file.
    pub file: String,
    /// Name in the legend.
    pub label: String,
}

impl Default for Output {
    fn default() -> Self {
        Self {
            checkpoint: 50,
            checkpoint_time: WallTime(600.0),
            field_interval: None,
            field_particles: None,
            loop_periods: 1,
            report: true,
            stations: None,
        }
    }
}
