//! What a run in memory leaves.
use super::look::{Snapshot, WallSnapshot};
use super::record::IterationHistory;
use crate::claims::Loops;
use crate::record::summary::Summary;

/// Solution of a case: loads, fields, history.
#[derive(Clone, Debug)]
pub struct Solution {
    /// Loads, and what it took.
    pub summary: Summary,
    /// The solution on all particles, in the units of the case.
    pub field: Snapshot,
    /// The solution on the walls, in the units of the case.
    pub walls: WallSnapshot,
    /// Particles of bodies made of particles at the end, in the units of the case; `None` without such bodies.
    pub solid: Option<Snapshot>,
    /// What every iteration left.
    pub history: IterationHistory,
    /// Loads over the last period of a motion, empty where there is none.
    pub loops: Loops,
}
