//! What is done at the end of a run, by those who know more than a session.
use super::error::RunError;
use super::record::Log;
use super::record::summary::Summary;
use super::studies::ForceSource;
use crate::case::Case;

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
