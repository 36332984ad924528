//! Checkpoints: what a stage cannot rebuild from the case.
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::RunError;
use super::setup::Stage;
use crate::cloud::CloudError;
use crate::cloud::sources::Source;
use crate::math::Vector;
use crate::observe::checkpoint::{self, Array, Checkpoint, Field};
use crate::scheme::{CloudMotion, Fluid, Frame, ParticleKinematics, RemapLedger};
use crate::system::Reach;
use crate::time::Past;
use crate::time::control::Phase;
use crate::time::relax::Resume;

/// Name of the checkpoint in the run folder.
pub(super) const FILE: &str = "checkpoint.alula";

/// Where a run stands among its stages.
pub(super) struct Position<'a> {
    /// Index of the stage.
    pub(super) stage: usize,
    /// All stages.
    pub(super) stages: &'a [Stage],
    /// Sources of refinement, flat.
    pub(super) sources: &'a [f64],
}

/// Numbers of a checkpoint that are not arrays.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Meta {
    stage: usize,
    stages: Vec<Stage>,
    iteration: u64,
    stage_iteration: u32,
    time_bits: u64,
    cfl_bits: u64,
    first_norm_bits: u64,
    linear: u32,
    newton: bool,
    phase_age: u32,
    phase_best_bits: u64,
    phase_best_age: u32,
    start_totals_bits: Vec<u64>,
    cycles: Vec<[f64; 5]>,
    cpu_seconds: f64,
    wall_seconds: f64,
    #[serde(default)]
    work: u64,
    #[serde(default)]
    steps: [u64; 3],
    #[serde(default)]
    broad: bool,
    #[serde(default)]
    served: u32,
    #[serde(default)]
    made_bits: u64,
    #[serde(default)]
    halved: u32,
    #[serde(default)]
    roaming: Option<Counts>,
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
pub(super) struct LagrangianCheckpoint {
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
    pub(super) ledger: RemapLedger,
}

impl LagrangianCheckpoint {
    /// The particles of a march; `None` where they do not travel.
    pub(super) fn of<const D: usize>(fluid: &Fluid<D>, frame: &Frame<D>, ledger: &RemapLedger) -> Option<Self> {
        let CloudMotion::Travel(travel) = &fluid.cloud_motion else { return None };
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
    pub(super) fn resume<const D: usize>(&self, fluid: &Fluid<D>) -> Result<Option<Fluid<D>>, CloudError> {
        let points = |v: &[f64]| v.chunks_exact(D).map(|x| Vector::from_fn(|d| x[d])).collect::<Vec<Vector<D>>>();
        let lists = points(&self.lists);
        // until it is built anew a march stands on the cloud of the case
        let lists = (self.ledger.renewals > 0).then_some((&lists[..], self.since));
        let [places, velocity, course] = [&self.places, &self.velocity, &self.course].map(|v| points(v));
        fluid.resumed(lists, ParticleKinematics { now: self.now, places, velocity, course })
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

/// A checkpoint in memory.
#[derive(Clone, Debug)]
pub(super) struct Saved {
    /// Index of the stage.
    pub(super) stage: usize,
    /// All stages.
    pub(super) stages: Vec<Stage>,
    /// Iterations over all stages.
    pub(super) iteration: u64,
    /// Physical time.
    pub(super) time: f64,
    /// State.
    pub(super) state: Vec<f64>,
    /// Where the relaxation stands.
    pub(super) relax: Resume,
    /// Totals of the conserved quantities when the march began.
    pub(super) start_totals: Vec<f64>,
    /// Finished cycles: cycle, particles, CL, CD, CM.
    pub(super) cycles: Vec<[f64; 5]>,
    /// Processor time spent before.
    pub(super) cpu_seconds: f64,
    /// Wall time spent before.
    pub(super) wall_seconds: f64,
    /// Work done before, see [`super::summary::Work`].
    pub(super) work: u64,
    /// Where an implicit march stands.
    pub(super) past: Past,
    /// Particles that travel with the fluid.
    pub(super) lagrangian: Option<LagrangianCheckpoint>,
    sources: Vec<f64>,
}

/// Sources of refinement as numbers.
pub(super) fn flatten<const D: usize>(sources: &[Source<D>]) -> Vec<f64> {
    sources.iter().flat_map(|s| s.x.0.into_iter().chain([s.spacing, s.layers])).collect()
}

impl Saved {
    /// A checkpoint of the present moment.
    pub(super) fn new(at: &Position<'_>, iteration: u64, time: f64, state: &[f64], relax: Resume) -> Self {
        Self {
            stage: at.stage,
            stages: at.stages.to_vec(),
            iteration,
            time,
            state: state.to_vec(),
            relax,
            start_totals: Vec::new(),
            cycles: Vec::new(),
            cpu_seconds: 0.0,
            wall_seconds: 0.0,
            work: 0,
            past: Past::default(),
            lagrangian: None,
            sources: at.sources.to_vec(),
        }
    }

    /// Sources of refinement of the stage.
    pub(super) fn sources<const D: usize>(&self) -> Vec<Source<D>> {
        let source = |row: &[f64]| Source { x: Vector::from_fn(|d| row[d]), spacing: row[D], layers: row[D + 1] };
        self.sources.chunks_exact(D + 2).map(source).collect()
    }

    /// Writes the checkpoint of a run folder.
    pub(super) fn write(self, out: &Path) -> Result<(), RunError> {
        let meta = Meta {
            stage: self.stage,
            stages: self.stages,
            iteration: self.iteration,
            stage_iteration: self.relax.iteration,
            time_bits: self.time.to_bits(),
            cfl_bits: self.relax.cfl.to_bits(),
            first_norm_bits: self.relax.first_norm.to_bits(),
            linear: self.relax.linear,
            newton: self.relax.phase.newton,
            phase_age: self.relax.phase.age,
            phase_best_bits: self.relax.phase.best.to_bits(),
            phase_best_age: self.relax.phase.best_age,
            start_totals_bits: self.start_totals.iter().map(|v| v.to_bits()).collect(),
            cycles: self.cycles,
            cpu_seconds: self.cpu_seconds,
            wall_seconds: self.wall_seconds,
            broad: self.past.reach == Reach::Far,
            work: self.work,
            served: self.past.served,
            made_bits: self.past.made.to_bits(),
            halved: self.past.halved,
            steps: [self.past.last.to_bits(), self.past.next.to_bits(), u64::from(self.past.unconverged)],
            roaming: self.lagrangian.as_ref().map(LagrangianCheckpoint::counts),
        };
        let field =
            |name: &str, data: Vec<f64>| Field { name: name.into(), shape: vec![data.len()], data: Array::F64(data) };
        let meta = serde_json::to_value(meta).map_err(|e| RunError::Folder(e.to_string()))?;
        let mut fields = vec![
            field("state", self.state),
            field("scale", self.relax.scale),
            field("before", self.past.before),
            field("older", self.past.older),
            field("sources", self.sources),
        ];
        if let Some(lagrangian) = self.lagrangian {
            let LagrangianCheckpoint { lists, places, velocity, course, .. } = lagrangian;
            let parts = [("lists", lists), ("places", places), ("velocity", velocity), ("course", course)];
            fields.extend(parts.map(|(name, data)| field(name, data)));
        }
        Ok(checkpoint::write(&out.join(FILE), &Checkpoint { meta, fields })?)
    }

    /// Reads the checkpoint of a run folder.
    pub(super) fn read(out: &Path) -> Result<Self, RunError> {
        let file = checkpoint::read(&out.join(FILE))?;
        let wrong = |e: serde_json::Error| RunError::Folder(format!("`{FILE}` was written by another version: {e}"));
        let m: Meta = serde_json::from_value(file.meta.clone()).map_err(wrong)?;
        let phase = Phase {
            newton: m.newton,
            age: m.phase_age,
            best: f64::from_bits(m.phase_best_bits),
            best_age: m.phase_best_age,
        };
        let lagrangian = match &m.roaming {
            Some(counts) => {
                let part = |name: &str| file.f64(name).map(<[f64]>::to_vec);
                Some(LagrangianCheckpoint::new(
                    counts,
                    [part("lists")?, part("places")?, part("velocity")?, part("course")?],
                ))
            }
            None => None,
        };
        Ok(Self {
            lagrangian,
            stage: m.stage,
            stages: m.stages,
            iteration: m.iteration,
            time: f64::from_bits(m.time_bits),
            state: file.f64("state")?.to_vec(),
            relax: Resume {
                iteration: m.stage_iteration,
                cfl: f64::from_bits(m.cfl_bits),
                first_norm: f64::from_bits(m.first_norm_bits),
                linear: m.linear,
                phase,
                scale: file.f64("scale")?.to_vec(),
            },
            start_totals: m.start_totals_bits.iter().map(|b| f64::from_bits(*b)).collect(),
            cycles: m.cycles,
            cpu_seconds: m.cpu_seconds,
            wall_seconds: m.wall_seconds,
            work: m.work,
            past: Past {
                time: f64::from_bits(m.time_bits),
                iteration: m.stage_iteration,
                last: f64::from_bits(m.steps[0]),
                next: f64::from_bits(m.steps[1]),
                before: file.f64("before")?.to_vec(),
                older: file.f64("older").map(<[f64]>::to_vec).unwrap_or_default(),
                reach: if m.broad { Reach::Far } else { Reach::Near },
                served: m.served,
                made: f64::from_bits(m.made_bits),
                unconverged: m.steps[2] as u32,
                halved: m.halved,
            },
            sources: file.f64("sources")?.to_vec(),
        })
    }
}
