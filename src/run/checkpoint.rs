//! Checkpoints of a flow as files.
//!
//! What [`Saved`] tells in few numbers is JSON; states and what an integrator remembers are arrays, bit by bit.
use std::borrow::Cow;
use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::json;

use crate::observe::checkpoint::{self, Array, Checkpoint, Field};
use crate::problem::RunError;
use crate::scheme::RemapLedger;
use crate::study::record::saved::{FILE, Kept, LagrangianCheckpoint, Saved, require};
use crate::study::stage::Task;
use crate::system::Reach;
use crate::time::control::Phase;
use crate::time::relax::Resume;
use crate::time::{Memory, Past};

/// What the numbers of a checkpoint mean; another number, another meaning.
const MEANING: u32 = 5;

/// What is not an array in a checkpoint.
#[derive(Serialize, Deserialize)]
struct Meta<'a> {
    meaning: u32,
    saved: Saved<'a>,
    kept: Lengths,
}

/// Factor and point of each state that is kept, its length and that of its sources.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Lengths(Vec<(f64, usize, usize, usize)>);

/// Writes the checkpoint of a run folder.
pub(crate) fn write(saved: Saved<'_>, out: &Path) -> Result<(), RunError> {
    let mut fields = vec![
        field("state", &saved.state[..]),
        field("sources", &saved.sources[..]),
        field("kept", saved.kept.iter().flat_map(|k| [&k.state[..], &k.sources].concat()).collect::<Vec<_>>()),
    ];
    match &saved.memory {
        Memory::Relaxation(resume) => {
            let Resume { iteration, cfl, phase, scale, .. } = resume;
            let steps = [*iteration, u32::from(phase.newton), phase.age, phase.best_age].map(f64::from);
            fields.push(field("memory", [&steps[..], &[*cfl, phase.best]].concat()));
            fields.push(field("scale", &scale[..]));
        }
        Memory::March(past) => {
            let far = u32::from(past.reach == Reach::Far);
            let steps = [past.iteration, far, past.served, past.unconverged, past.halved].map(f64::from);
            fields.push(field("memory", [&steps[..], &[past.last, past.next, past.made]].concat()));
            fields.extend([field("before", &past.before[..]), field("older", &past.older[..])]);
        }
    }
    if let Some(lagrangian) = &saved.lagrangian {
        let LagrangianCheckpoint { lists, now, places, velocity, course, since, ledger } = lagrangian;
        let counts = [ledger.renewals.into(), ledger.inserted, ledger.removed, ledger.first_order.into()];
        fields.push(field("travel", [&[*now, *since], &counts.map(|n| n as f64)[..]].concat()));
        let parts = [("lists", lists), ("places", places), ("velocity", velocity), ("course", course)];
        fields.extend(parts.map(|(name, data)| field(name, &data[..])));
        fields.extend([field("lost", &ledger.lost[..]), field("exchanged", &ledger.exchanged[..])]);
    }
    let kept = Lengths(saved.kept.iter().map(|k| (k.factor, k.point, k.state.len(), k.sources.len())).collect());
    let meta = json!({ "meaning": MEANING, "saved": &saved, "kept": kept });
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
    let Meta { saved, kept, .. } = serde_json::from_value(file.meta.clone()).map_err(|e| other_version(&e))?;
    let part = |name: &str| file.f64(name).map(<[f64]>::to_vec);
    let marches = saved.stages.get(saved.stage).is_some_and(|s| s.task == Task::March);
    Ok(Saved {
        memory: if marches { march(&file, saved.time)? } else { relaxation(&file, saved.linear)? },
        lagrangian: file.f64("travel").ok().map(|_| travelled(&file)).transpose()?,
        state: part("state")?.into(),
        sources: part("sources")?,
        kept: kept.states(file.f64("kept")?)?.into(),
        ..saved
    })
}

/// Where a relaxation stands.
fn relaxation(file: &Checkpoint<'_>, linear: u32) -> Result<Memory, RunError> {
    let [iteration, newton, age, best_age, cfl, best] = *row(file, "memory")?;
    let phase = Phase { newton: newton != 0.0, age: age as u32, best, best_age: best_age as u32 };
    let scale = file.f64("scale")?.into();
    Ok(Memory::Relaxation(Resume { iteration: iteration as u32, cfl, linear, phase, scale }))
}

/// Where a march stands.
fn march(file: &Checkpoint<'_>, time: f64) -> Result<Memory, RunError> {
    let [iteration, far, served, unconverged, halved, last, next, made] = *row(file, "memory")?;
    Ok(Memory::March(Past {
        time,
        iteration: iteration as u32,
        last,
        next,
        before: file.f64("before")?.to_vec(),
        older: file.f64("older")?.to_vec(),
        reach: if far != 0.0 { Reach::Far } else { Reach::Near },
        served: served as u32,
        made,
        unconverged: unconverged as u32,
        halved: halved as u32,
    }))
}

/// Particles that travel.
fn travelled(file: &Checkpoint<'_>) -> Result<LagrangianCheckpoint, RunError> {
    let [now, since, renewals, inserted, removed, first_order] = *row(file, "travel")?;
    let part = |name: &str| file.f64(name).map(<[f64]>::to_vec);
    let ledger = RemapLedger {
        renewals: renewals as u32,
        inserted: inserted as u64,
        removed: removed as u64,
        first_order: first_order as u32,
        lost: part("lost")?,
        exchanged: part("exchanged")?,
    };
    let [lists, places, velocity, course] = [part("lists")?, part("places")?, part("velocity")?, part("course")?];
    Ok(LagrangianCheckpoint { lists, now, places, velocity, course, since, ledger })
}

/// The numbers of a short array; refuses more or fewer.
fn row<'f, const N: usize>(file: &'f Checkpoint<'_>, name: &str) -> Result<&'f [f64; N], RunError> {
    let whole = file.f64(name)?.try_into();
    whole.map_err(|_| other_version(&format!("`{name}` has another number of values")))
}

impl Lengths {
    /// The states that are kept, from all their numbers; refuses more or fewer than they are said to have.
    fn states(&self, mut numbers: &[f64]) -> Result<Vec<Kept>, RunError> {
        let mut lengths = self.0.iter().flat_map(|k| [k.2, k.3]);
        let told = lengths.try_fold(0_usize, usize::checked_add);
        require(told == Some(numbers.len()), "the states that it keeps have other lengths than it says")?;
        let mut take = |length: usize| {
            let (taken, rest) = numbers.split_at(length);
            numbers = rest;
            taken.to_vec()
        };
        let state = |&(factor, point, state, sources): &(f64, usize, usize, usize)| Kept {
            factor,
            point,
            state: take(state),
            sources: take(sources),
        };
        Ok(self.0.iter().map(state).collect())
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_that_are_kept_have_the_lengths_that_are_told() {
        let kept = |lengths: &[[usize; 2]]| Lengths(lengths.iter().map(|n| (1.0, 0, n[0], n[1])).collect());
        let states = kept(&[[2, 0], [1, 1]]).states(&[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert_eq!(
            (&states[0].state[..], &states[1].state[..], &states[1].sources[..]),
            (&[1.0, 2.0][..], &[3.0][..], &[4.0][..])
        );
        assert!(Lengths::default().states(&[]).unwrap().is_empty());
        for lengths in [&[[2, 0]][..], &[[4, 0], [1, 0]], &[[usize::MAX, 0], [5, 0]], &[[4, usize::MAX]]] {
            assert!(kept(lengths).states(&[0.0; 4]).is_err(), "{lengths:?}");
        }
    }
}
