//! Checkpoints: what a stage cannot rebuild from the case.
use std::borrow::Cow;

use serde::{Deserialize, Deserializer, Serialize, Serializer};

use super::super::stage::Stage;
use super::polar::PolarRecord;
use crate::case::Case;
use crate::cloud::sources::Source;
use crate::math::Vector;
use crate::observe::convergence::CloudLoads;
use crate::observe::table::TableMark;
use crate::problem::RunError;
use crate::scheme::{Fluid, Frame, ParticleKinematics, RemapLedger};
use crate::time::{Memory, Past};

/// Name of the checkpoint in the run folder.
pub(crate) const FILE: &str = "checkpoint.alula";

/// Where a run stands among its stages.
pub(crate) struct Position<'a> {
    /// Index of the stage.
    pub(crate) stage: usize,
    /// All stages.
    pub(crate) stages: &'a [Stage],
    /// Sources of refinement, flat.
    pub(crate) sources: &'a [f64],
    /// States that points of a polar leave to those to come, or a family of clouds to itself.
    pub(crate) kept: &'a [Kept],
}

/// The state of a point of a polar, or of a single flow, on a cloud.
#[derive(Clone, Debug)]
pub(crate) struct Kept {
    /// Factor on the spacing of the cloud.
    pub(crate) factor: f64,
    /// The point.
    pub(crate) point: usize,
    /// Its state there.
    pub(crate) state: Vec<f64>,
    /// Sources of refinement of the cloud, flat.
    pub(crate) sources: Vec<f64>,
}

/// Particles that travel with the fluid.
#[derive(Clone, Debug)]
pub(crate) struct LagrangianCheckpoint {
    /// Where fluid particles were when the cloud was built.
    pub(crate) lists: Vec<f64>,
    /// Time.
    pub(crate) now: f64,
    /// Where fluid and interface particles are.
    pub(crate) places: Vec<f64>,
    /// Their velocities, by the formula that serves the state.
    pub(crate) velocity: Vec<f64>,
    /// The straight course of fluid particles in the step before.
    pub(crate) course: Vec<f64>,
    /// Time at which the cloud was built.
    pub(crate) since: f64,
    /// What re-clouding did so far.
    pub(crate) ledger: RemapLedger,
}

impl LagrangianCheckpoint {
    /// The particles of a march; `None` where they do not travel.
    pub(crate) fn of<const D: usize>(fluid: &Fluid<D>, frame: &Frame<D>, ledger: &RemapLedger) -> Option<Self> {
        let travel = fluid.cloud_motion.travel()?;
        let flat = |x: &[Vector<D>], n: usize| x.iter().take(n).flat_map(|x| x.0).collect();
        let cloud = &fluid.discretisation.cloud;
        let lists = flat(&cloud.x, cloud.n_fluid);
        let (places, velocity) =
            (flat(&frame.discretisation.cloud.x, cloud.n_rows()), flat(&frame.velocity, cloud.n_rows()));
        let course = flat(&frame.lagrangian_step.course, cloud.n_fluid);
        let (now, since, ledger) = (frame.time, travel.since, ledger.clone());
        Some(Self { lists, now, places, velocity, course, since, ledger })
    }

    /// The equations on the cloud that was kept.
    pub(crate) fn resume<const D: usize>(&self, fluid: &Fluid<D>) -> Result<Option<Fluid<D>>, RunError> {
        self.fits(fluid)?;
        let points = |v: &[f64]| v.chunks_exact(D).map(|x| Vector::from_fn(|d| x[d])).collect::<Vec<Vector<D>>>();
        let lists = points(&self.lists);
        // until it is built anew a march stands on the cloud of the case
        let lists = (self.ledger.renewals > 0).then_some((&lists[..], self.since));
        let [places, velocity, course] = [&self.places, &self.velocity, &self.course].map(|v| points(v));
        Ok(fluid.resumed(lists, ParticleKinematics { now: self.now, places, velocity, course })?)
    }

    /// Refuses fields of another length than the particles ask for, and particles outside the domain.
    fn fits<const D: usize>(&self, fluid: &Fluid<D>) -> Result<(), RunError> {
        let cloud = &fluid.discretisation.cloud;
        let n_fluid = if self.ledger.renewals > 0 { self.lists.len() / D } else { cloud.n_fluid };
        let rows = n_fluid + cloud.interface.len();
        let full = |v: &[f64], n: usize| v.len() == D * n;
        let known = |v: &[f64], n: usize| v.is_empty() || full(v, n);
        let fits = full(&self.lists, n_fluid) && full(&self.places, rows);
        require(
            fits && known(&self.velocity, rows) && known(&self.course, n_fluid),
            "its particles are of another cloud",
        )?;
        let domain = cloud.tree.bounds();
        let inside = |x: &[f64]| domain.contains(&Vector::from_fn(|d| x[d]));
        require(self.lists.chunks_exact(D).all(inside), "its particles lie outside the domain")?;
        let totals = [&self.ledger.lost, &self.ledger.exchanged].map(Vec::len);
        require(self.ledger.renewals == 0 || totals[0] == D + 2, "its ledger is of another dimension")
    }

    /// All arrays of numbers.
    pub(super) fn arrays(&self) -> [&[f64]; 4] {
        [&self.lists, &self.places, &self.velocity, &self.course]
    }
}

/// What the end of a harmonic balance depends on beside its state.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Settling {
    /// Coefficients in time of the loads after each of the last iterations.
    pub(crate) recent: Vec<Vec<f64>>,
    /// Smallest residual; infinite before the first.
    #[serde(with = "bits")]
    pub(crate) best: f64,
    /// Iteration of that.
    pub(crate) best_iteration: u32,
    /// Evaluations of the residual.
    pub(crate) evaluations: u64,
    /// Evaluations by balances with fewer harmonics, of one instance.
    pub(crate) earlier: u64,
}

impl Default for Settling {
    fn default() -> Self {
        Self { recent: Vec::new(), best: f64::INFINITY, best_iteration: 0, evaluations: 0, earlier: 0 }
    }
}

/// A number as its bits: JSON has no infinity.
mod bits {
    use super::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(number.to_bits())
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
        u64::deserialize(deserializer).map(f64::from_bits)
    }
}

/// A checkpoint in memory. What serde skips are arrays, which the file holds beside the rest.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct Saved<'a> {
    /// Index of the stage.
    pub(crate) stage: usize,
    /// All stages.
    pub(crate) stages: Vec<Stage>,
    /// Iterations over all stages.
    pub(crate) iteration: u64,
    /// Physical time, in the units of the solver.
    pub(crate) time: f64,
    /// State, where it lies while it is written.
    #[serde(skip)]
    pub(crate) state: Cow<'a, [f64]>,
    /// What the integrator must remember.
    #[serde(skip, default = "nothing")]
    pub(crate) memory: Memory,
    /// What the end of a harmonic balance is told from.
    pub(crate) settling: Settling,
    /// Totals of the conserved quantities when the march began.
    pub(crate) start_totals: Vec<f64>,
    /// Finished cycles: cycle, particles, CL, CD, CM.
    pub(crate) cycles: Vec<[f64; 5]>,
    /// Loads on the clouds of a family.
    pub(crate) clouds: Vec<CloudLoads>,
    /// Processor time spent before.
    pub(crate) cpu_seconds: f64,
    /// Wall time spent before.
    pub(crate) wall_seconds: f64,
    /// Work done before, see [`super::summary::Work`].
    pub(crate) work: u64,
    /// Linear iterations of the stage.
    pub(crate) linear: u32,
    /// Particles that travel with the fluid.
    #[serde(skip)]
    pub(crate) lagrangian: Option<LagrangianCheckpoint>,
    /// Sources of refinement, flat.
    #[serde(skip)]
    pub(crate) sources: Vec<f64>,
    /// The points of a polar so far.
    pub(crate) polar: PolarRecord,
    /// The states that they leave to those to come.
    #[serde(skip)]
    pub(crate) kept: Cow<'a, [Kept]>,
    /// What [`equations_of`] says of the case; `None` for polars.
    pub(crate) equations: Option<u32>,
    /// What the tables of the run folder held.
    pub(crate) tables: Vec<TableMark>,
}

/// What an integrator remembers at the start of a march: nothing.
fn nothing() -> Memory {
    Memory::March(Past::default())
}

/// Checksum of what the equations of a case are made of. A run goes on with these alone: how long it goes on, and what it writes, may
/// be changed.
pub(crate) fn equations_of(case: &Case) -> u32 {
    let air = (&case.flow, &case.boundary, &case.initial, &case.scheme);
    let solids = (&case.bodies, &case.motion, &case.structures);
    // without contact the same number as before it was asked for
    let contact = case.contact.as_ref().map_or_else(String::new, |contact| format!(" {contact:?}"));
    crc32fast::hash(format!("{air:?} {solids:?}{contact}").as_bytes())
}

/// Sources of refinement as numbers.
pub(crate) fn flatten<const D: usize>(sources: &[Source<D>]) -> Vec<f64> {
    sources.iter().flat_map(|s| s.x.0.into_iter().chain([s.spacing, s.layers])).collect()
}

/// Sources of refinement from their numbers.
pub(crate) fn raised<const D: usize>(flat: &[f64]) -> Vec<Source<D>> {
    let source = |row: &[f64]| Source { x: Vector::from_fn(|d| row[d]), spacing: row[D], layers: row[D + 1] };
    flat.chunks_exact(D + 2).map(source).collect()
}

impl Saved<'_> {
    /// Sources of refinement of the stage.
    pub(crate) fn sources<const D: usize>(&self) -> Vec<Source<D>> {
        raised(&self.sources)
    }
}

/// Nothing, or what is wrong with a checkpoint.
pub(crate) fn require(holds: bool, problem: &'static str) -> Result<(), RunError> {
    if holds { Ok(()) } else { Err(RunError::Untrue { file: FILE, problem }) }
}
