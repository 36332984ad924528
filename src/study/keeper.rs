//! Keeping a study: what it hands over on its way to whoever writes it down.
//!
//! A study knows no folder. It asks its [`Keeper`] to append rows to tables, to keep checkpoints and to write fields, and goes on without
//! one in memory alone.
use std::sync::Arc;

use super::found::Found;
use super::look::{GasView, Snapshot, WallSnapshot};
use super::record::crosscheck::Twofold;
use super::record::polar::PolarRecord;
use super::record::saved::Saved;
use super::record::trace::Trace;
use super::record::{IterationHistory, Log};
use super::studies::PeriodFields;
use crate::case::Case;
use crate::coupling::SolidSnapshot;
use crate::geometry::Surface;
use crate::math::parallel::sweep_each;
use crate::observe::structure::{StructureNames, StructureSample, StructureTable};
use crate::problem::RunError;
use crate::record::summary::Summary;
use crate::scheme::Work;

/// Keeps a study of a gas.
pub(crate) trait Keeper {
    /// Refuses a study that writes more than there is room for: of a case in `dimension` dimensions on a cloud of so many particles, with a
    /// motion of this period in the time of the solver.
    fn check_room(&self, case: &Case, particles: usize, dimension: usize, period: Option<f64>) -> Result<(), RunError>;
    /// Begins the tables, or goes on where a checkpoint stands; returns what they hold.
    fn open(&mut self, tables: &Tables<'_>, saved: Option<&Saved<'_>>) -> Result<Earlier, RunError>;
    /// Appends an iteration.
    fn row(&mut self, row: &[f64]) -> Result<(), RunError>;
    /// Appends how structures moved in an iteration.
    fn structure(&mut self, iteration: u64, sample: &StructureSample) -> Result<(), RunError>;
    /// Appends loads that were evaluated twice.
    fn moment(&mut self, row: &[f64]) -> Result<(), RunError>;
    /// Keeps the points of a polar that are over.
    fn points(&self, polar: &PolarRecord) -> Result<(), RunError>;
    /// Keeps a checkpoint.
    fn checkpoint(&self, saved: Saved<'_>) -> Result<(), RunError>;
    /// Tells the units of all tables.
    fn describe(&self) -> Result<(), RunError>;
    /// Its name in messages.
    fn name(&self) -> String;
    /// The name of its checkpoint in messages.
    fn checkpoint_name(&self) -> String;
    /// What writes fields of flows in the plane.
    fn plane(&self) -> Arc<dyn Camera<2>>;
    /// What writes fields of flows in space.
    fn space(&self) -> Arc<dyn Camera<3>>;
}

/// Tables of a study of a gas.
pub(crate) struct Tables<'a> {
    /// The case.
    pub(crate) case: &'a Case,
    /// True where loads are evaluated twice.
    pub(crate) twice: bool,
    /// Structures.
    pub(crate) structures: &'a [StructureNames],
}

/// What the tables of an interrupted study hold.
#[derive(Default)]
pub(crate) struct Earlier {
    /// Iterations.
    pub(crate) history: IterationHistory,
    /// Loads in time.
    pub(crate) trace: Trace,
    /// Loads evaluated twice.
    pub(crate) moments: Twofold,
    /// How structures moved.
    pub(crate) structures: StructureTable,
}

/// Writes fields and pictures of a flow in `D` dimensions; times and intervals are those of the solver.
pub(crate) trait Camera<const D: usize>: Send + Sync {
    /// The field of one moment of a march, at multiples of `interval`.
    fn field(&self, case: &Case, gas: &GasView<'_, D>, work: &mut Work<D>, interval: f64) -> Result<(), RunError>;
    /// Bodies made of particles at the same moment, `time`.
    fn solid(&self, case: &Case, at: &SolidSnapshot<'_, D>, time: f64, interval: f64) -> Result<(), RunError>;
    /// A picture at the end of a part of the period of the motion, counted from 1.
    fn picture(
        &self,
        case: &Case,
        surface: &Surface<D>,
        gas: &GasView<'_, D>,
        work: &mut Work<D>,
        part: u64,
    ) -> Result<(), RunError>;
    /// A field at the end of a part of the `period` of the motion, counted from 1.
    fn frame(
        &self,
        case: &Case,
        gas: &GasView<'_, D>,
        work: &mut Work<D>,
        period: f64,
        part: u64,
    ) -> Result<(), RunError>;
    /// Loads and fields of a harmonic balance.
    fn period(&self, case: &Case, instances: &[[f64; 6]], fields: &PeriodFields<'_, D>) -> Result<(), RunError>;
    /// All that a flow leaves at its end; its summary is given what writing took.
    fn end(&self, end: End<'_, D>, summary: &mut Summary, log: &Log<'_>) -> Result<(), RunError>;
}

/// The end of a flow.
pub(crate) struct End<'a, const D: usize> {
    /// What was found.
    pub(crate) found: &'a Found<'a, D>,
    /// The solution on all particles.
    pub(crate) field: &'a Snapshot,
    /// The solution on the walls.
    pub(crate) walls: &'a WallSnapshot,
    /// Bodies made of particles.
    pub(crate) solid: Option<&'a SolidSnapshot<'a, D>>,
    /// True where the cloud of the end is another than that of the case.
    pub(crate) chosen: bool,
    /// True where it was refined by what was found.
    pub(crate) refined: bool,
}

/// Pictures of one period of a motion.
pub(crate) const FILM: u32 = 6;
/// Fields of the last period of a march: a picture of every second one.
pub(crate) const FILM_FIELDS: u32 = 2 * FILM;

/// Does `n` things side by side; the first error in their order.
pub(crate) fn together(n: usize, task: impl Fn(usize) -> Result<(), RunError> + Sync) -> Result<(), RunError> {
    let mut done: Vec<Result<(), RunError>> = (0..n).map(|_| Ok(())).collect();
    sweep_each(&mut done, task);
    done.into_iter().collect()
}
