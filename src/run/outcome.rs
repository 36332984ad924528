//! How a run ended.
use crate::study::{SolidSummary, Summary};

/// How a run ended.
#[derive(Debug)]
pub enum Outcome {
    /// It ran to its end.
    Finished(Box<Summary>),
    /// It ran to its end, a structure without a gas.
    Structure(Box<SolidSummary>),
    /// It had run to its end before: nothing was computed or written.
    AlreadyFinished {
        /// Its `summary.json`.
        summary: serde_json::Value,
    },
    /// It was told to stop; a checkpoint is written where it has a folder.
    Interrupted {
        /// Iteration at which it stopped.
        iteration: u64,
    },
}
