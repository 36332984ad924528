//! Studies: functions that take a problem, or what another study found, and return a value. They know no folder.
//!
//! | function | takes | returns |
//! |---|---|---|
//! | [`steady`] | a problem | the steady flow, [`SteadyFlow`]: loads, convergence, fields |
//! | [`forces`] | a steady flow and reduced frequencies | [`GeneralisedForces`] on the coordinates of its structures |
//! | [`flutter`](fn@flutter), [`limit_cycle`] | a problem with `[flutter]`, `[lco]` | the boundary, the cycles |
//! | [`polar`], [`family`] | a problem with several angles of attack, with `[accuracy]` | its points, how the loads converge |
//! | [`march`], [`harmonic`] | a problem with `[time]` | its [`Solution`] |
//! | [`solid`] | a problem without `[flow]` | [`SolidSolution`] |
//!
//! Those whose names end in `_with` tell a [`Monitor`] how far they are, and return `None` when it says stop. A run keeps a study in a
//! folder and goes on with it: see [`run`](crate::run).
//!
//! Rooms, each of which uses those before it only: `monitor`, `stage` and `recipe` (what is done, in which order), `look` (loads and
//! fields of a flow), `record` (what a study knows about itself), `found` (what it tells at its end), `setup` (from a problem to its
//! equations on a cloud), `keeper` (what is handed over on the way), `watch` (the loop that drives any integrator, and those who watch it),
//! `studies` (what is done on one cloud), `course` and `flow` (the way through the stages), `solids` (structures of particles alone),
//! `flutter`, `gaf`; beside them `inspect` (what is known of a problem before it is solved) and `cloud_table`.
pub(crate) mod accuracy;
mod build;
mod cloud_table;
pub(crate) mod cost;
mod course;
pub(crate) mod disk;
mod doubts;
pub(crate) mod error_bars;
pub(crate) mod flow;
pub(crate) mod flutter;
pub(crate) mod found;
pub mod gaf;
mod generalised_forces;
pub(crate) mod inspect;
pub(crate) mod keeper;
pub(crate) mod look;
pub(crate) mod monitor;
mod recipe;
pub(crate) mod record;
pub(crate) mod setup;
pub(crate) mod solids;
mod solution;
mod solve;
pub(crate) mod stage;
mod steady;
pub(crate) mod studies;
mod time_left;
mod watch;

pub(crate) use studies::PeriodFields;

pub use crate::record::summary::{
    Apart, BalanceReport, Change, FirstHarmonics, GeneralisedForce, LastPeriod, Ledger, LoadCrosscheck, LoadsApart,
    MarchingCheck, PeriodicLoads, PolarPoint, ProbeEnd, Reclouding, ReferenceValues, Separation, SolidEnd, Summary,
    TipVortex, WakePlane,
};
pub use build::{build_cloud, build_solver};
pub use cloud_table::{CloudTable, cloud_table};
pub use cost::Cost;
pub use generalised_forces::{GeneralisedForces, forces};
pub use inspect::{
    Aeroelastic, BodyBox, CloudReport, NeighbourCount, SolidReport, SpacingRange, Understood, UnderstoodFlutter,
    UnderstoodGaf, UnderstoodStructure, inspect_structure,
};
pub use look::{Snapshot, WallSnapshot};
pub use monitor::{MarchTick, Monitor, Silent, Tick};
pub use record::IterationHistory;
pub use solids::{
    Ended as SolidOutcome, ModeRow, PeriodicRow, ProbeHarmonic, ProbeRow, SolidLedger, SolidSolution, SolidSummary,
};
pub use solution::Solution;
pub use solve::{
    family, flutter, flutter_with, harmonic, harmonic_with, limit_cycle, march, march_with, polar, polar_with, solid,
    solid_with,
};
pub use steady::{FlowConvergence, SteadyFlow, steady, steady_with};
pub use time_left::{Portion, TimeLeft};

use crate::problem::RunError;

/// Refuses what a function does not serve.
fn refuse(wrong: bool, what: &str, hint: &'static str) -> Result<(), RunError> {
    match wrong {
        true => Err(RunError::Unsupported { what: format!("this function does not compute {what}"), hint }),
        false => Ok(()),
    }
}
