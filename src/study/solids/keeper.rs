//! Keeping the study of a structure alone: what it hands over on its way to whoever writes it down.
use super::record::{Row, SolidSummary, Work};
use crate::case::{Case, Harmonics};
use crate::math::fourier::Instances;
use crate::problem::RunError;
use crate::problem::solids::Built;
use crate::solid::modes::Mode;
use crate::time::Past;
use crate::time::forced::Place;

/// Keeps the study of a structure in `D` dimensions.
pub(crate) trait SolidKeeper<const D: usize> {
    /// Where an interrupted march stands; `None` where it begins.
    fn standing(&self, case: &Case, built: &Built<D>) -> Result<Option<Standing>, RunError>;
    /// Where an interrupted search for a periodic motion stands; `None` where it begins.
    fn sought(&self, plan: &Harmonics, built: &Built<D>) -> Result<Option<Sought>, RunError>;
    /// Keeps a checkpoint of a march.
    fn keep_march(&self, past: Past, state: &[f64], rows: &[Row], work: &Work) -> Result<(), RunError>;
    /// Keeps a checkpoint of a search with these instances, and what was spent with fewer.
    fn keep_search(&self, place: &Place, held: Instances, before: [u32; 3]) -> Result<(), RunError>;
    /// The name of the checkpoint in messages.
    fn checkpoint_name(&self) -> String;
    /// Writes the history.
    fn history(&self, built: &Built<D>, rows: &[Row]) -> Result<(), RunError>;
    /// Writes the field number `number` of a series.
    fn frame(&self, number: usize, time: f64, built: &Built<D>, state: &[f64]) -> Result<(), RunError>;
    /// Writes all that is left at the end: state, natural modes and summary.
    fn end(&self, built: &Built<D>, found: (&[f64], &[Mode]), summary: &SolidSummary) -> Result<(), RunError>;
}

/// Keeps the study of a structure in either dimension.
pub(crate) trait SolidsKeeper: SolidKeeper<2> + SolidKeeper<3> {}

/// Where a march stands.
pub(crate) struct Standing {
    /// What the method must remember.
    pub(crate) past: Past,
    /// State.
    pub(crate) u: Vec<f64>,
    /// The history so far.
    pub(crate) rows: Vec<Row>,
    /// Work so far.
    pub(crate) work: Work,
}

/// Where the search for a periodic motion stands.
pub(crate) struct Sought {
    /// Its harmonics.
    pub(crate) held: Instances,
    /// Where the search among these stands.
    pub(crate) place: Place,
    /// Iterations with fewer harmonics, linear ones, and halvings.
    pub(crate) before: [u32; 3],
}
