//! The end of a run: how it ended, and what is done there by those who know more than a session.
use super::error::RunError;
use super::record::Log;
use super::record::summary::Summary;
use super::solids::SolidSummary;
use super::studies::ForceSource;
use crate::case::Case;

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

/// Share of the work that a steady flow takes, and what is done with it when it is found.
pub(crate) type Then<'a> = (f64, &'a mut dyn FnMut(&mut dyn ForceSource, &mut Log<'_>) -> Result<(), RunError>);

/// Finds the error bars of a run, given its case on its cloud and its summary, before that is written; false when told to stop.
pub(crate) type Bars<'a> = &'a mut dyn FnMut(&Case, &mut Summary, &mut Log<'_>) -> Result<bool, RunError>;

/// What is done at the end of a run.
#[derive(Default)]
pub(crate) struct AtEnd<'a> {
    /// With a steady flow.
    pub(crate) then: Option<Then<'a>>,
    /// With the numbers of a march or a balance.
    pub(crate) bars: Option<Bars<'a>>,
}
