//! From a case to a run folder: the only place that chooses between dimensions, physics and integrators.
//!
//! A run is a list of *stages*: coarse clouds that give a steady case its start, the cloud of the case, then one cloud for
//! each cycle of adaptation. Every stage builds its cloud, takes over the state of the one before by the solver's own fit,
//! and integrates. Checkpoints hold what a stage cannot rebuild from the case: its sources of refinement, the state, and
//! where the integrator stands; a killed run goes on to the same bits.
mod balance;
mod folder;
pub mod forces;
mod friction;
pub mod gaf;
pub mod harmonic;
mod inspect;
pub mod load_crosscheck;
pub mod marching_check;
mod marching_start;
mod measure;
mod motion_feasibility;
mod outputs;
pub mod periodic;
mod persist;
mod pictures;
mod run_recorder;
mod setup;
mod snapshot;
mod solve;
pub mod summary;
pub mod verify;

use std::path::{Path, PathBuf};

use crate::case::{Case, Temporal};
use crate::cloud::sources::Source;
use crate::cloud::{Cloud, CloudError};
use crate::geometry::{GeometryError, Surface, dimension};
use crate::observe::{CheckpointError, FileError, VtkError};
use crate::report::ReportError;
use crate::scheme::start::StartError;
use crate::scheme::{Fluid, adapt};
use crate::system::{Instant, System};
use crate::time::TimeError;

pub use folder::fresh_folder;
pub use friction::Separation;
pub use inspect::{CloudReport, inspect};
pub use snapshot::Snapshot;
pub use summary::Summary;

use persist::Saved;
use setup::{Solver, Stage};

/// What a run tells while it goes, and what it is told.
pub trait Monitor {
    /// After every iteration.
    fn tick(&mut self, tick: &Tick);
    /// Something worth a line.
    fn note(&mut self, text: &str);
    /// The solution, once, at the end.
    fn solution(&mut self, _: &Snapshot) {}
    /// True when the run should write a checkpoint and stop.
    fn stop(&self) -> bool {
        false
    }
    /// True when a checkpoint should be written now.
    fn checkpoint(&self) -> bool {
        false
    }
}

/// A monitor that says nothing.
pub struct Silent;
impl Monitor for Silent {
    fn tick(&mut self, _: &Tick) {}
    fn note(&mut self, _: &str) {}
}

/// State of a run after an iteration.
#[derive(Clone, Copy, Debug)]
pub struct Tick {
    /// Iterations over all stages.
    pub iteration: u64,
    /// Orders of magnitude to go in all (steady) or fraction of the time (marching), and reached.
    pub goal: f64,
    /// Reached of `goal`.
    pub reached: f64,
    /// Residual over its first value.
    pub residual: f64,
    /// Courant number.
    pub cfl: f64,
    /// CL, CD, CM when there are bodies.
    pub loads: Option<[f64; 3]>,
    /// Number of fluid particles.
    pub particles: usize,
}

/// How a run ended.
#[derive(Debug)]
pub enum Outcome {
    /// It ran to its end.
    Finished(Box<Summary>),
    /// It was told to stop; a checkpoint is written.
    Interrupted {
        /// Iteration at which it stopped.
        iteration: u64,
    },
}

/// Why a run failed.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Geometry.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// Cloud.
    #[error(transparent)]
    Cloud(#[from] CloudError),
    /// Initial field.
    #[error(transparent)]
    Start(#[from] StartError),
    /// Integration.
    #[error("{source}\nthe last good state is in `{checkpoint}`")]
    Time {
        /// Why.
        source: TimeError,
        /// Checkpoint with the last good state.
        checkpoint: String,
    },
    /// The cloud of particles that travel with the fluid could not be built anew.
    #[error("at time {time:.6} the cloud cannot be built anew: {source}\nthe last good state is in `{checkpoint}`")]
    Recloud {
        /// Time reached.
        time: f64,
        /// Why.
        source: CloudError,
        /// Checkpoint with the last good state.
        checkpoint: String,
    },
    /// Bodies go where no particles can follow.
    #[error("{0}")]
    Motion(String),
    /// A file could not be written or read.
    #[error(transparent)]
    File(#[from] FileError),
    /// A field file could not be written.
    #[error(transparent)]
    Vtk(#[from] VtkError),
    /// A checkpoint could not be written or read.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    /// A picture or the report could not be written.
    #[error(transparent)]
    Report(#[from] ReportError),
    /// The run folder is not usable.
    #[error("{0}")]
    Folder(String),
    /// The case asks for something that can be written down but not yet computed.
    #[error("{0}")]
    Unsupported(String),
}

/// Where a run reads and writes.
#[derive(Clone, Debug)]
pub struct Places {
    /// Folder that file names in the case refer to.
    pub input: PathBuf,
    /// Run folder.
    pub out: PathBuf,
}

/// Runs a case into a fresh folder.
pub fn run(case: &Case, places: &Places, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    setup::supported(case)?;
    folder::create(case, places)?;
    match dimension(case) {
        2 => drive::<2>(case, places, Origin::Case, monitor),
        _ => drive::<3>(case, places, Origin::Case, monitor),
    }
}

/// Runs a case into a fresh folder from the last state of another run on the same cloud: a steady flow, a march or a harmonic
/// balance with any number of harmonics.
pub fn run_from(case: &Case, places: &Places, from: &Path, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    setup::supported(case)?;
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
    if !differing.is_empty() {
        let keys = differing.join("`, `");
        let hint = "start from a run on the same cloud, or without `--from`";
        return Err(RunError::Folder(format!(
            "the run `{name}` stands on another cloud: `{keys}` differ\nhint: {hint}"
        )));
    }
    let saved = persist::Saved::read(from)?;
    let last = saved.stages.get(saved.stage).is_some_and(|s| s.factor == 1.0);
    if !last || saved.lagrangian.is_some() {
        let hint = "finish it with `alula resume`; particles that travel keep a cloud of their own";
        return Err(RunError::Folder(format!(
            "the run `{name}` does not stand on the cloud of its case\nhint: {hint}"
        )));
    }
    folder::create(case, places)?;
    match dimension(case) {
        2 => drive::<2>(case, places, Origin::Other(saved), monitor),
        _ => drive::<3>(case, places, Origin::Other(saved), monitor),
    }
}

/// What a run begins with.
enum Origin {
    /// The case alone.
    Case,
    /// Its own checkpoint.
    Own(persist::Saved),
    /// The last state of another run.
    Other(persist::Saved),
}

/// Goes on with an interrupted or killed run.
pub fn resume(out: &Path, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    let (case, input) = folder::read_case(out)?;
    folder::check_input(&case, (&input, out))?;
    let places = Places { input, out: out.to_path_buf() };
    let saved = persist::Saved::read(out)?;
    match dimension(&case) {
        2 => drive::<2>(&case, &places, Origin::Own(saved), monitor),
        _ => drive::<3>(&case, &places, Origin::Own(saved), monitor),
    }
}

/// Builds the cloud of a case without running it.
pub fn build_cloud<const D: usize>(
    case: &Case,
    input: &Path,
) -> Result<(Option<Surface<D>>, Cloud<D>, Vec<String>), RunError> {
    let (surface, notes) = setup::surface::<D>(case, input)?;
    let cloud = Cloud::build(case, surface.as_ref(), &[])?;
    Ok((surface, cloud, notes))
}

/// Builds the equations of a case on its own cloud, and the state at the start, without running it.
pub fn build_solver<const D: usize>(case: &Case, input: &Path) -> Result<(Fluid<D>, Vec<f64>), RunError> {
    setup::supported(case)?;
    let (surface, _) = setup::surface::<D>(case, input)?;
    let motions = setup::motions(case, input, surface.as_ref())?;
    let plain = Stage { factor: 1.0, cycle: 0, march: false };
    let solver = setup::solver(case, &plain, surface.as_ref(), (&[], &motions), None)?;
    let start = solver.fluid.start();
    Ok((solver.fluid, start))
}

/// Solver and state at the end of a stage.
type Stood<const D: usize> = (Solver<D>, Vec<f64>);

/// Solver of a stage, and where it starts: at a checkpoint, from the stage before it, from another run, or from the start of the
/// case. `same`: the stage before has its cloud.
fn begun<const D: usize>(
    case: &Case,
    build: impl FnOnce() -> Result<Solver<D>, RunError>,
    (saved, previous, other): (Option<Saved>, Option<Stood<D>>, &mut Option<Saved>),
    same: bool,
    surface: Option<&Surface<D>>,
) -> Result<(Solver<D>, solve::Start), RunError> {
    if let Some((solver, state)) = previous.filter(|_| saved.is_none()) {
        if same {
            return Ok((solver, solve::Start::Fresh(state)));
        }
        let next = build()?;
        let state = setup::transfer(&(solver, state), &next, surface);
        return Ok((next, solve::Start::Fresh(state)));
    }
    let solver = build()?;
    let start = match (saved, other.take()) {
        (Some(saved), _) => solve::Start::Resume(Box::new(saved)),
        (None, Some(other)) => solve::Start::Fresh(setup::taken_over(case, &solver, other.state)?),
        (None, None) => solve::Start::Fresh(solver.fluid.start()),
    };
    Ok((solver, start))
}

/// All stages of a run.
fn drive<const D: usize>(
    case: &Case,
    places: &Places,
    origin: Origin,
    monitor: &mut dyn Monitor,
) -> Result<Outcome, RunError> {
    let (mut saved, mut other) = match origin {
        Origin::Case => (None, None),
        Origin::Own(saved) => (Some(saved), None),
        Origin::Other(other) => (None, Some(other)),
    };
    let clock = summary::Clock::start();
    let (surface, notes) = setup::surface::<D>(case, &places.input)?;
    notes.iter().for_each(|n| monitor.note(n));
    let motions = setup::motions(case, &places.input, surface.as_ref())?;
    let mut full = match &saved {
        Some(_) => None,
        None => Some(Cloud::build(case, surface.as_ref(), &[])?),
    };
    if let Some(cloud) = &full {
        motion_feasibility::check(case, cloud, &motions)?.iter().for_each(|n| monitor.note(n));
    }
    let stages = match (&saved, &other) {
        (Some(s), _) => s.stages.clone(),
        (None, Some(o)) => vec![Stage { march: marches(case), ..o.stages[o.stage] }],
        (None, None) => setup::stages(case, full.as_ref().map_or(0, |c| c.n_fluid), D),
    };
    let mut recorder = run_recorder::RunRecorder::open(case, places, saved.as_ref(), (motions.period(), monitor))?;
    recorder.note(&describe(&stages, full.as_ref().map_or(0, |c| c.n_fluid)));
    let mut previous: Option<Stood<D>> = None;
    let mut last_frame = None;
    let first = saved.as_ref().map_or(0, |s| s.stage);
    let known = saved.as_ref().or(other.as_ref());
    let mut sources: Vec<Source<D>> = known.map_or_else(Vec::new, persist::Saved::sources);
    for (k, stage) in stages.iter().enumerate().skip(first) {
        let ready = if stage.is_plain() { full.take() } else { None };
        let same = k > 0 && stage.shares_cloud(&stages[k - 1]);
        let build = || setup::solver(case, stage, surface.as_ref(), (&sources, &motions), ready);
        let from = (saved.take(), previous.take(), &mut other);
        let (mut solver, start) = begun(case, build, from, same, surface.as_ref())?;
        let at = persist::Position { stage: k, stages: &stages, sources: &persist::flatten(&sources) };
        let last = k + 1 == stages.len();
        let Some((state, frame)) = solve::solve(case, &mut solver, start, &at, last, &mut recorder)? else {
            return Ok(Outcome::Interrupted { iteration: recorder.iteration() });
        };
        if stages.get(k + 1).is_some_and(|s| s.cycle > 0) {
            sources = adapted(case, &solver, &state);
        }
        last_frame = Some(frame);
        previous = Some((solver, state));
    }
    let Some(solved) = previous.zip(last_frame) else {
        return Err(RunError::Folder("the checkpoint names no stage".into()));
    };
    let summary = outputs::write_all(case, places, &solved, surface.as_ref(), &mut recorder, &clock)?;
    Ok(Outcome::Finished(Box::new(summary)))
}

fn describe(stages: &[Stage], n: usize) -> String {
    let coarse = stages.iter().filter(|s| s.factor > 1.0).count();
    let cycles = stages.iter().filter(|s| s.cycle > 0).count();
    format!("{n} fluid particles; {coarse} coarser clouds for the start, {cycles} cycles of adaptation")
}

/// Sources of refinement for the next cycle.
fn adapted<const D: usize>(case: &Case, solver: &Solver<D>, state: &[f64]) -> Vec<Source<D>> {
    let fluid = &solver.fluid;
    let mut work = fluid.work();
    let frame = fluid.frame(&Instant::still(0.0), state);
    fluid.fill_states(&frame, state, &mut work);
    fluid.fill_gradients(&frame, &mut work);
    let finest = case.adapt.spacing.unwrap_or(case.cloud.spacing).0;
    adapt::sources(fluid, &work, &case.adapt.sensors, finest)
}

/// True for cases that march in time.
fn marches(case: &Case) -> bool {
    !matches!(case.time, Temporal::Steady(_))
}
