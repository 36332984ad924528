//! Checkpoints: what a stage cannot rebuild from the case.
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::super::stage::{Stage, Task};
use super::polar::PolarRecord;
use crate::case::{Case, Structure};
use crate::cloud::sources::Source;
use crate::math::Vector;
use crate::observe::checkpoint::{self, Array, Checkpoint, Field};
use crate::observe::convergence::CloudLoads;
use crate::observe::table::TableMark;
use crate::problem::RunError;
use crate::scheme::{Fluid, Frame, ParticleKinematics, RemapLedger};
use crate::system::Reach;
use crate::time::control::Phase;
use crate::time::relax::Resume;
use crate::time::{Memory, Past};

/// Name of the checkpoint in the run folder.
pub(crate) const FILE: &str = "checkpoint.alula";

/// What the numbers of a checkpoint mean; another number, another meaning.
const MEANING: u32 = 4;

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

/// What a checkpoint says of a polar.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct PolarMeta {
    record: PolarRecord,
    /// Factor, point and length of each state that is kept.
    kept: Vec<(f64, usize, usize)>,
    /// Length of the sources of each.
    #[serde(default)]
    sources: Vec<usize>,
}

/// Numbers of a checkpoint that are not arrays.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Meta {
    meaning: u32,
    stage: usize,
    stages: Vec<Stage>,
    iteration: u64,
    stage_iteration: u32,
    time_bits: u64,
    cfl_bits: u64,
    linear: u32,
    newton: bool,
    phase_age: u32,
    phase_best_bits: u64,
    phase_best_age: u32,
    start_totals_bits: Vec<u64>,
    cycles: Vec<[f64; 5]>,
    clouds: Vec<CloudLoads>,
    cpu_seconds: f64,
    wall_seconds: f64,
    work: u64,
    steps: [u64; 3],
    broad: bool,
    served: u32,
    made_bits: u64,
    halved: u32,
    settling: SettlingCounts,
    roaming: Option<Counts>,
    #[serde(default)]
    polar: PolarMeta,
    #[serde(default)]
    equations: Option<u32>,
    tables: Vec<TableMark>,
}

/// What re-clouding did until a checkpoint, and the time at which the cloud was built.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Counts {
    since_bits: u64,
    now_bits: u64,
    renewals: u32,
    inserted: u64,
    removed: u64,
    first_order: u32,
    lost_bits: Vec<u64>,
    exchanged_bits: Vec<u64>,
}

/// Particles that travel with the fluid.
#[derive(Clone, Debug)]
pub(crate) struct LagrangianCheckpoint {
    /// Where fluid particles were when the cloud was built.
    lists: Vec<f64>,
    /// Time.
    now: f64,
    /// Where fluid and interface particles are.
    places: Vec<f64>,
    /// Their velocities, by the formula that serves the state.
    velocity: Vec<f64>,
    /// The straight course of fluid particles in the step before.
    course: Vec<f64>,
    /// Time at which the cloud was built.
    since: f64,
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

    fn counts(&self) -> Counts {
        let (t, bits) = (&self.ledger, |v: &[f64]| v.iter().map(|v| v.to_bits()).collect());
        Counts {
            since_bits: self.since.to_bits(),
            now_bits: self.now.to_bits(),
            renewals: t.renewals,
            inserted: t.inserted,
            removed: t.removed,
            first_order: t.first_order,
            lost_bits: bits(&t.lost),
            exchanged_bits: bits(&t.exchanged),
        }
    }

    fn new(counts: &Counts, [lists, places, velocity, course]: [Vec<f64>; 4]) -> Self {
        let numbers = |bits: &[u64]| bits.iter().map(|b| f64::from_bits(*b)).collect();
        let ledger = RemapLedger {
            renewals: counts.renewals,
            inserted: counts.inserted,
            removed: counts.removed,
            first_order: counts.first_order,
            lost: numbers(&counts.lost_bits),
            exchanged: numbers(&counts.exchanged_bits),
        };
        let (since, now) = (f64::from_bits(counts.since_bits), f64::from_bits(counts.now_bits));
        Self { lists, now, places, velocity, course, since, ledger }
    }
}

/// Numbers of [`Settling`] that are not arrays.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SettlingCounts {
    best_bits: u64,
    best_iteration: u32,
    evaluations: u64,
    earlier: u64,
    width: usize,
}

/// What the end of a harmonic balance depends on beside its state.
#[derive(Clone, Debug)]
pub(crate) struct Settling {
    /// Coefficients in time of the loads after each of the last iterations.
    pub(crate) recent: Vec<Vec<f64>>,
    /// Smallest residual.
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

impl Settling {
    fn counts(&self) -> SettlingCounts {
        SettlingCounts {
            best_bits: self.best.to_bits(),
            best_iteration: self.best_iteration,
            evaluations: self.evaluations,
            earlier: self.earlier,
            width: self.recent.first().map_or(0, Vec::len),
        }
    }

    fn new(counts: &SettlingCounts, recent: &[f64]) -> Self {
        Self {
            recent: recent.chunks_exact(counts.width.max(1)).map(<[f64]>::to_vec).collect(),
            best: f64::from_bits(counts.best_bits),
            best_iteration: counts.best_iteration,
            evaluations: counts.evaluations,
            earlier: counts.earlier,
        }
    }
}

/// A checkpoint in memory.
#[derive(Clone, Debug)]
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
    pub(crate) state: Cow<'a, [f64]>,
    /// What the integrator must remember.
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
    pub(crate) lagrangian: Option<LagrangianCheckpoint>,
    /// Sources of refinement, flat.
    pub(crate) sources: Vec<f64>,
    /// The points of a polar so far.
    pub(crate) polar: PolarRecord,
    /// The states that they leave to those to come.
    pub(crate) kept: Cow<'a, [Kept]>,
    /// What [`equations_of`] says of the case; `None` for polars, and in checkpoints of versions that did not ask.
    pub(crate) equations: Option<u32>,
    /// What the tables of the run folder held.
    pub(crate) tables: Vec<TableMark>,
}

/// Checksum of what the equations of a case are made of. A run goes on with these alone: how long it goes on, and what it writes, may
/// be changed.
pub(crate) fn equations_of(case: &Case) -> u32 {
    let air = (&case.flow, &case.boundary, &case.initial, &case.scheme);
    let structures: Vec<_> = case.structures.iter().map(Structure::as_given).collect();
    let solids = (&case.bodies, &case.motion, &structures);
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

    /// Writes the checkpoint of a run folder.
    pub(crate) fn write(self, out: &Path) -> Result<(), RunError> {
        let (relax, past) = match self.memory {
            Memory::Relaxation(resume) => (resume, Past::default()),
            Memory::March(past) => (bare(past.iteration), past),
        };
        let bits = |v: &[f64]| v.iter().map(|v| v.to_bits()).collect();
        let meta = Meta {
            meaning: MEANING,
            stage: self.stage,
            stages: self.stages,
            iteration: self.iteration,
            stage_iteration: relax.iteration,
            time_bits: self.time.to_bits(),
            cfl_bits: relax.cfl.to_bits(),
            linear: self.linear,
            newton: relax.phase.newton,
            phase_age: relax.phase.age,
            phase_best_bits: relax.phase.best.to_bits(),
            phase_best_age: relax.phase.best_age,
            start_totals_bits: bits(&self.start_totals),
            cycles: self.cycles,
            clouds: self.clouds,
            cpu_seconds: self.cpu_seconds,
            wall_seconds: self.wall_seconds,
            broad: past.reach == Reach::Far,
            work: self.work,
            served: past.served,
            made_bits: past.made.to_bits(),
            halved: past.halved,
            steps: [past.last.to_bits(), past.next.to_bits(), u64::from(past.unconverged)],
            settling: self.settling.counts(),
            roaming: self.lagrangian.as_ref().map(LagrangianCheckpoint::counts),
            polar: PolarMeta {
                record: self.polar,
                kept: self.kept.iter().map(|k| (k.factor, k.point, k.state.len())).collect(),
                sources: self.kept.iter().map(|k| k.sources.len()).collect(),
            },
            equations: self.equations,
            tables: self.tables,
        };
        let meta = serde_json::to_value(meta).map_err(|e| other_version(&e))?;
        let mut fields = vec![
            field("state", self.state),
            field("scale", &relax.scale[..]),
            field("before", past.before),
            field("older", past.older),
            field("sources", self.sources),
            field("settling", self.settling.recent.concat()),
            field(
                "kept",
                self.kept.iter().flat_map(|k| [&k.state[..], &k.sources]).flatten().copied().collect::<Vec<_>>(),
            ),
        ];
        if let Some(lagrangian) = self.lagrangian {
            let LagrangianCheckpoint { lists, places, velocity, course, .. } = lagrangian;
            let parts = [("lists", lists), ("places", places), ("velocity", velocity), ("course", course)];
            fields.extend(parts.map(|(name, data)| field(name, data)));
        }
        Ok(checkpoint::write(&out.join(FILE), &Checkpoint { meta, fields })?)
    }

    /// Reads the checkpoint of a run folder.
    pub(crate) fn read(out: &Path) -> Result<Saved<'static>, RunError> {
        let file = checkpoint::read(&out.join(FILE))?;
        let meaning = file.meta.get("meaning").and_then(serde_json::Value::as_u64).unwrap_or(1);
        if meaning != u64::from(MEANING) {
            return Err(other_version(&format!(
                "its numbers are those of kind {meaning}, this program reads kind {MEANING}"
            )));
        }
        let m: Meta = serde_json::from_value(file.meta.clone()).map_err(|e| other_version(&e))?;
        let part = |name: &str| file.f64(name).map(<[f64]>::to_vec);
        let lagrangian = match &m.roaming {
            Some(counts) => Some(LagrangianCheckpoint::new(
                counts,
                [part("lists")?, part("places")?, part("velocity")?, part("course")?],
            )),
            None => None,
        };
        let marches = m.stages.get(m.stage).is_some_and(|s| s.task == Task::March);
        let memory = if marches {
            Memory::March(m.past(part("before")?, part("older")?))
        } else {
            Memory::Relaxation(m.resume(part("scale")?))
        };
        Ok(Saved {
            lagrangian,
            settling: Settling::new(&m.settling, &part("settling")?),
            // checkpoints of versions without polars have none
            kept: m.polar.kept(&part("kept").unwrap_or_default())?.into(),
            polar: m.polar.record,
            iteration: m.iteration,
            time: f64::from_bits(m.time_bits),
            state: part("state")?.into(),
            memory,
            start_totals: m.start_totals_bits.iter().map(|b| f64::from_bits(*b)).collect(),
            stage: m.stage,
            stages: m.stages,
            cycles: m.cycles,
            clouds: m.clouds,
            cpu_seconds: m.cpu_seconds,
            wall_seconds: m.wall_seconds,
            work: m.work,
            linear: m.linear,
            sources: part("sources")?,
            equations: m.equations,
            tables: m.tables,
        })
    }
}

impl PolarMeta {
    /// The states that are kept, from all their numbers; refuses more or fewer than they are said to have.
    fn kept(&self, mut numbers: &[f64]) -> Result<Vec<Kept>, RunError> {
        let mut lengths = self.kept.iter().map(|k| k.2).chain(self.sources.iter().copied());
        let told = lengths.try_fold(0_usize, usize::checked_add);
        let whole = told == Some(numbers.len()) && self.sources.len() <= self.kept.len();
        require(whole, "the states that it keeps have other lengths than it says")?;
        let mut take = |length: usize| {
            let (taken, rest) = numbers.split_at(length);
            numbers = rest;
            taken.to_vec()
        };
        let mut all = Vec::new();
        for (k, (factor, point, length)) in self.kept.iter().enumerate() {
            let (state, sources) = (take(*length), take(self.sources.get(k).copied().unwrap_or(0)));
            all.push(Kept { factor: *factor, point: *point, state, sources });
        }
        Ok(all)
    }
}

impl Meta {
    /// Where a relaxation stands.
    fn resume(&self, scale: Vec<f64>) -> Resume {
        let phase = Phase {
            newton: self.newton,
            age: self.phase_age,
            best: f64::from_bits(self.phase_best_bits),
            best_age: self.phase_best_age,
        };
        Resume {
            iteration: self.stage_iteration,
            cfl: f64::from_bits(self.cfl_bits),
            linear: self.linear,
            phase,
            scale: scale.into(),
        }
    }

    /// Where a march stands.
    fn past(&self, before: Vec<f64>, older: Vec<f64>) -> Past {
        Past {
            time: f64::from_bits(self.time_bits),
            iteration: self.stage_iteration,
            last: f64::from_bits(self.steps[0]),
            next: f64::from_bits(self.steps[1]),
            before,
            older,
            reach: if self.broad { Reach::Far } else { Reach::Near },
            served: self.served,
            made: f64::from_bits(self.made_bits),
            unconverged: self.steps[2] as u32,
            halved: self.halved,
        }
    }
}

/// An array of numbers with a name.
fn field<'a>(name: &str, data: impl Into<Cow<'a, [f64]>>) -> Field<'a> {
    let data = data.into();
    Field { name: name.into(), shape: vec![data.len()], data: Array::F64(data) }
}

fn other_version(problem: &dyn std::fmt::Display) -> RunError {
    RunError::OtherVersion { file: FILE, problem: problem.to_string() }
}

/// Where a march stands, in the terms of a relaxation.
fn bare(iteration: u32) -> Resume {
    Resume { iteration, cfl: 0.0, linear: 0, phase: Phase::default(), scale: Arc::default() }
}

/// Nothing, or what is wrong with a checkpoint.
pub(super) fn require(holds: bool, problem: &'static str) -> Result<(), RunError> {
    if holds { Ok(()) } else { Err(RunError::Untrue { file: FILE, problem }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_that_are_kept_have_the_lengths_that_are_told() {
        let meta = |lengths: &[usize], sources: &[usize]| PolarMeta {
            kept: lengths.iter().map(|n| (1.0, 0, *n)).collect(),
            sources: sources.to_vec(),
            ..PolarMeta::default()
        };
        let kept = meta(&[2, 1], &[0, 1]).kept(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(
            (&kept[0].state[..], &kept[1].state[..], &kept[1].sources[..]),
            (&[1.0, 2.0][..], &[3.0][..], &[4.0][..])
        );
        assert!(PolarMeta::default().kept(&[]).unwrap().is_empty());
        let others: [(Vec<usize>, Vec<usize>); 4] =
            [(vec![2], vec![]), (vec![4, 1], vec![]), (vec![usize::MAX, 5], vec![]), (vec![4], vec![0, 0])];
        for (lengths, sources) in others {
            assert!(meta(&lengths, &sources).kept(&[0.0; 4]).is_err(), "{lengths:?} {sources:?}");
        }
    }
}
