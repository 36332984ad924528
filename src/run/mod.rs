//! From a case to fields and loads: the only place that chooses between dimensions, physics and integrators.
//!
//! A [`Session`] solves a case in memory; [`run`] is a session that keeps what it finds in a folder. Checkpoints hold what a
//! stage cannot rebuild from the case: its sources of refinement, the state, and where the integrator stands; a killed run goes
//! on to the same bits.
//!
//! `folder`, `journal`, `checkpoint` and `keeper` keep a study, `files` and `about` write what it found, `session` solves one in memory or in a
//! folder, `error_bars` its further runs; `flutter`, `gaf`, `solids` and `inspect` are those of other studies; `refusals` tells what keeps a case
//! from being computed.
mod about;
mod checkpoint;
mod error_bars;
mod files;
pub mod flutter;
mod folder;
pub mod gaf;
mod inspect;
mod journal;
mod keeper;
mod outcome;
mod refusals;
mod resumed;
mod room;
mod session;
mod solids;

use std::path::{Path, PathBuf};

use crate::case::Case;
use crate::problem::{self, Problem};
use crate::report::ReportError;

pub use crate::problem::{Blame, BodyTable, Measures, RunError, body_table};
pub use error_bars::solve;
pub use folder::{Places, fresh_folder, has_begun};
pub use inspect::inspect;
pub use outcome::Outcome;
pub use refusals::refusals;
pub use resumed::continued;
pub use session::Session;

use crate::study;
use crate::study::flow::Origin;
use crate::study::solids::SolidsKeeper;
pub use crate::study::{
    Aeroelastic, Apart, BalanceReport, BodyBox, Change, CloudReport, CloudTable, Cost, FirstHarmonics,
    GeneralisedForce, IterationHistory, LastPeriod, Ledger, LoadCrosscheck, LoadsApart, MarchTick, MarchingCheck,
    ModeRow, Monitor, NeighbourCount, PeriodicLoads, PeriodicRow, PolarPoint, Portion, ProbeEnd, ProbeHarmonic,
    ProbeRow, Reclouding, ReferenceValues, Separation, Silent, Snapshot, SolidEnd, SolidLedger, SolidOutcome,
    SolidReport, SolidSolution, SolidSummary, Solution, SpacingRange, Summary, Tick, TimeLeft, TipVortex, Understood,
    UnderstoodFlutter, UnderstoodGaf, UnderstoodStructure, WakePlane, WallSnapshot, build_cloud, build_solver,
    cloud_table, inspect_structure,
};

impl From<ReportError> for RunError {
    fn from(problem: ReportError) -> Self {
        Self::Report(Box::new(problem))
    }
}

/// Runs a case into a fresh folder.
pub fn run(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    solved(case, places, monitor).map_err(|problem| refusals::with_other_files(case, &places.input, problem))
}

fn solved(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    if !case.has_gas() {
        return solid(case, &places.input, Some(&places.out), monitor).map(structure);
    }
    solve(&mut Session::open(case, &places.input)?.keep_in(&places.out, monitor)?, monitor)
}

/// Solves a structure alone, into the fresh folder `out` where one is given.
pub fn solid(
    case: &Case,
    input: &Path,
    out: Option<&Path>,
    monitor: &mut dyn Monitor,
) -> Result<SolidOutcome, RunError> {
    problem::solids::supported(case)?;
    let _held = out.map(|out| folder::create(case, input, out)).transpose()?;
    let files = out.map(|out| solids::Files { case, out, from: None });
    study::solids::solve((case, input), files.as_ref().map(|files| files as &dyn SolidsKeeper), monitor)
}

/// Goes on with a structure alone that was interrupted or killed, from its checkpoint.
pub fn resume_solid(out: &Path, monitor: &mut dyn Monitor) -> Result<SolidOutcome, RunError> {
    let (case, input) = folder::read_case(out)?;
    folder::check_input(&case, &input, out)?;
    folder::check_begun(out)?;
    let _held = folder::hold(out)?;
    let saved = solids::Saved::read(out, &case)?;
    folder::reopen(out)?;
    let files = solids::Files { case: &case, out, from: Some(&saved) };
    study::solids::solve((&case, &input), Some(&files), monitor)
}

/// The case in the folder of a run.
pub fn case_of(out: &Path) -> Result<Case, RunError> {
    folder::read_case(out).map(|(case, _)| case)
}

/// How a structure alone ended, as the outcome of a run.
fn structure(ended: SolidOutcome) -> Outcome {
    match ended {
        SolidOutcome::Finished(found) => Outcome::Structure(Box::new(found.summary)),
        SolidOutcome::Interrupted(iteration) => Outcome::Interrupted { iteration },
    }
}

/// Runs a case into a fresh folder from the last state of another run on the same cloud: a steady flow, a march or a harmonic
/// balance with any number of harmonics.
pub fn run_from(case: &Case, places: &Places, from: &Path, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    let session = Session::open(case, &places.input)?;
    let (other, _) = folder::read_case(from)?;
    let differing: Vec<&str> = [
        ("[cloud]", other.cloud != case.cloud),
        ("[[body]]", other.bodies != case.bodies),
        ("[adapt]", other.adapt != case.adapt),
        ("[boundary]", other.boundary != case.boundary),
        ("dimension", other.dimension != case.dimension),
    ]
    .into_iter()
    .filter_map(|(name, differs)| differs.then_some(name))
    .collect();
    let name = from.display();
    if case.polar.is_some() || other.polar.is_some() {
        return Err(RunError::OtherRun {
            what: format!("a polar neither begins from another run nor is one that others begin from (`{name}`)"),
            hint: "its points start from one another: run it without `--from`",
        });
    }
    if !differing.is_empty() {
        let keys = differing.join("`, `");
        return Err(RunError::OtherRun {
            what: format!("the run `{name}` stands on another cloud: `{keys}` differ"),
            hint: "start from a run on the same cloud, or without `--from`",
        });
    }
    let saved = checkpoint::read(from)?.trusted(&other)?;
    let last = saved.stages.get(saved.stage).is_some_and(|s| s.factor == 1.0);
    if !last || saved.lagrangian.is_some() {
        return Err(RunError::OtherRun {
            what: format!("the run `{name}` does not stand on the cloud of its case"),
            hint: "finish it with `alula resume`; particles that travel keep a cloud of their own",
        });
    }
    solve(&mut session.keep_in(&places.out, monitor)?.from(Origin::Other(Box::new(saved))), monitor)
}

/// Makes room for a case that can begin: an earlier run in its folder is renamed; its new name, if there was one.
pub fn set_aside(case: &Case, places: &Places) -> Result<Option<PathBuf>, RunError> {
    folder::make_room(&places.out, || {
        folder::check_compared(case, &places.input)?;
        if !case.has_gas() {
            return problem::solids::supported(case).map(|_| ());
        }
        let held = case.flutter.is_some() && !case.is_trimmed();
        refusals::rehearse(&Problem::of_case(case, &places.input)?, held)
    })
}

/// The same for a cloud.
pub fn set_aside_cloud(case: &Case, places: &Places) -> Result<Option<PathBuf>, RunError> {
    folder::make_room(&places.out, || Problem::of_case(case, &places.input).map(|_| ()))
}

/// Goes on with an interrupted or killed run; one that is finished stays as it is.
pub fn resume(out: &Path, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    if let Some(summary) = folder::finished(out) {
        folder::read_case(out)?;
        folder::check_files(out)?;
        return Ok(Outcome::AlreadyFinished { summary });
    }
    if !case_of(out)?.has_gas() {
        return resume_solid(out, monitor).map(structure);
    }
    solve(&mut continued(out)?, monitor)
}

/// True where the run in `out` is over.
pub fn is_finished(out: &Path) -> bool {
    folder::finished(out).is_some()
}
