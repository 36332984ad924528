//! Checkpoints of a flow as files.
use std::borrow::Cow;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::observe::checkpoint::{self, Array, Checkpoint, Field};
use crate::observe::convergence::CloudLoads;
use crate::observe::table::TableMark;
use crate::problem::RunError;
use crate::scheme::RemapLedger;
use crate::study::record::polar::PolarRecord;
use crate::study::record::saved::{FILE, Kept, LagrangianCheckpoint, Saved, Settling, require};
use crate::study::stage::{Stage, Task};
use crate::system::Reach;
use crate::time::control::Phase;
use crate::time::relax::Resume;
use crate::time::{Memory, Past};

/// What the numbers of a checkpoint mean; another number, another meaning.
const MEANING: u32 = 4;

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

/// Numbers of [`Settling`] that are not arrays.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct SettlingCounts {
    best_bits: u64,
    best_iteration: u32,
    evaluations: u64,
    earlier: u64,
    width: usize,
}

/// Writes the checkpoint of a run folder.
pub(crate) fn write(saved: Saved<'_>, out: &Path) -> Result<(), RunError> {
    let (relax, past) = match saved.memory {
        Memory::Relaxation(resume) => (resume, Past::default()),
        Memory::March(past) => (bare(past.iteration), past),
    };
    let bits = |v: &[f64]| v.iter().map(|v| v.to_bits()).collect();
    let meta = Meta {
        meaning: MEANING,
        stage: saved.stage,
        stages: saved.stages,
        iteration: saved.iteration,
        stage_iteration: relax.iteration,
        time_bits: saved.time.to_bits(),
        cfl_bits: relax.cfl.to_bits(),
        linear: saved.linear,
        newton: relax.phase.newton,
        phase_age: relax.phase.age,
        phase_best_bits: relax.phase.best.to_bits(),
        phase_best_age: relax.phase.best_age,
        start_totals_bits: bits(&saved.start_totals),
        cycles: saved.cycles,
        clouds: saved.clouds,
        cpu_seconds: saved.cpu_seconds,
        wall_seconds: saved.wall_seconds,
        broad: past.reach == Reach::Far,
        work: saved.work,
        served: past.served,
        made_bits: past.made.to_bits(),
        halved: past.halved,
        steps: [past.last.to_bits(), past.next.to_bits(), u64::from(past.unconverged)],
        settling: settling_counts(&saved.settling),
        roaming: saved.lagrangian.as_ref().map(counts),
        polar: PolarMeta {
            record: saved.polar,
            kept: saved.kept.iter().map(|k| (k.factor, k.point, k.state.len())).collect(),
            sources: saved.kept.iter().map(|k| k.sources.len()).collect(),
        },
        equations: saved.equations,
        tables: saved.tables,
    };
    let meta = serde_json::to_value(meta).map_err(|e| other_version(&e))?;
    let mut fields = vec![
        field("state", saved.state),
        field("scale", &relax.scale[..]),
        field("before", past.before),
        field("older", past.older),
        field("sources", saved.sources),
        field("settling", saved.settling.recent.concat()),
        field(
            "kept",
            saved.kept.iter().flat_map(|k| [&k.state[..], &k.sources]).flatten().copied().collect::<Vec<_>>(),
        ),
    ];
    if let Some(lagrangian) = saved.lagrangian {
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
        Some(counts) => Some(travelled(counts, [part("lists")?, part("places")?, part("velocity")?, part("course")?])),
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
        settling: settling(&m.settling, &part("settling")?),
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

/// What re-clouding did, and when.
fn counts(lagrangian: &LagrangianCheckpoint) -> Counts {
    let (t, bits) = (&lagrangian.ledger, |v: &[f64]| v.iter().map(|v| v.to_bits()).collect());
    Counts {
        since_bits: lagrangian.since.to_bits(),
        now_bits: lagrangian.now.to_bits(),
        renewals: t.renewals,
        inserted: t.inserted,
        removed: t.removed,
        first_order: t.first_order,
        lost_bits: bits(&t.lost),
        exchanged_bits: bits(&t.exchanged),
    }
}

/// Particles that travel, from what a checkpoint holds.
fn travelled(counts: &Counts, [lists, places, velocity, course]: [Vec<f64>; 4]) -> LagrangianCheckpoint {
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
    LagrangianCheckpoint { lists, now, places, velocity, course, since, ledger }
}

/// Numbers of a settling balance that are not arrays.
fn settling_counts(settling: &Settling) -> SettlingCounts {
    SettlingCounts {
        best_bits: settling.best.to_bits(),
        best_iteration: settling.best_iteration,
        evaluations: settling.evaluations,
        earlier: settling.earlier,
        width: settling.recent.first().map_or(0, Vec::len),
    }
}

/// A settling balance, from what a checkpoint holds.
fn settling(counts: &SettlingCounts, recent: &[f64]) -> Settling {
    Settling {
        recent: recent.chunks_exact(counts.width.max(1)).map(<[f64]>::to_vec).collect(),
        best: f64::from_bits(counts.best_bits),
        best_iteration: counts.best_iteration,
        evaluations: counts.evaluations,
        earlier: counts.earlier,
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
