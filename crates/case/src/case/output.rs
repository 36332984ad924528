//! Output of a run, its intervals, and reference curves.
use serde::{Deserialize, Serialize};

use super::quantity::{Time, WallTime};

/// Output files and their intervals.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Output {
    /// Greatest number of iterations between checkpoints.
    pub checkpoint: u32,
    /// Greatest wall-clock time between checkpoints [s].
    pub checkpoint_time: WallTime,
    /// Time between field files of a time march; absent: only the last field is written.
    pub field_interval: Option<Time>,
    /// Greatest number of fluid particles in a field file; absent: all.
    pub field_particles: Option<u32>,
    /// Number of periods at the end of a march over which loops and harmonics of the loads are averaged.
    pub loop_periods: u32,
    /// True when `report.html` and pictures are written.
    pub report: bool,
    /// Fractions of the half span at which the chordwise Cp is plotted (3-D); absent: those of the reference curves, or
    /// a standard list.
    pub stations: Option<Vec<f64>>,
}

/// A reference curve of Cp against x/c.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Compare {
    /// Path of a CSV file, relative to the case file, with the columns `x_c` and `Cp` and, in 3-D, `eta` (fraction of the half span).
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
