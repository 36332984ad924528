//! Checkpoints of structures alone: what they hold, and whether they are those of the case at hand.
//!
//! A run goes on with the bodies, the contact and the method that it began with; how long it goes on, with which steps, and what it writes
//! may be changed. What a checkpoint holds must be numbers, as many as the structure of the case has: checksums tell damage of the
//! file, not what was written into it.
use std::path::Path;

use serde_json::{Value, json};

use crate::case::{Case, HarmonicCount, Harmonics, Temporal};
use crate::math::fourier::Instances;
use crate::observe::checkpoint::{self, Array, Checkpoint, Field};
use crate::problem::RunError;
use crate::problem::solids::Built;
use crate::solid::forces::Energy;
use crate::study::record::saved::FILE;
use crate::study::solids::{Row, Sought, Standing, Work};
use crate::system::{Mechanical, System, unknowns};
use crate::time::Past;
use crate::time::forced::Place;

/// Numbers of a row of the history before those of its probes.
const OF_ROW: usize = 10;

/// Steps of an explicit march over the longest that are stable where it stands now: one that breaks off has been squeezed since they were found.
const LONGER: f64 = 1e3;

/// The checkpoint of a run of a structure alone.
pub(in super::super) struct Saved(Checkpoint<'static>);

/// Writes the checkpoint of a march.
pub(super) fn write_march(
    past: Past,
    u: &[f64],
    (rows, work): (&[Row], &Work),
    case: &Case,
    out: &Path,
) -> Result<(), RunError> {
    let mut flat = Vec::new();
    for row in rows {
        let e = &row.energy;
        flat.extend([f64::from(row.step), row.time, e.kinetic, e.strain, e.stabilisation, e.contact, e.dissipated]);
        flat.extend([row.work.loads, row.work.supports, row.work.damped]);
        flat.extend(row.probes.iter().flatten());
    }
    let clock = vec![past.time, past.last, past.next, work.loads, work.supports, work.damped];
    let meta = json!({ "kind": kind(case), "iteration": past.iteration, "halved": past.halved });
    let fields = [("state", u.to_vec()), ("before", past.before), ("clock", clock), ("history", flat)];
    write(meta, fields.into(), case, out)
}

/// Writes the checkpoint of a search for a periodic motion.
pub(super) fn write_search(
    place: &Place,
    (held, before): (Instances, [u32; 3]),
    case: &Case,
    out: &Path,
) -> Result<(), RunError> {
    let meta = json!({
        "kind": kind(case), "harmonics": held.harmonics(), "before": before, "within": place.within,
        "iterations": place.iterations, "linear": place.linear, "halved": place.halved,
    });
    let fields = [
        ("state", place.u.clone()),
        ("last_good", place.last_good.clone()),
        ("start", place.start.clone()),
        ("parts", vec![place.reached, place.sought, place.first]),
    ];
    write(meta, fields.into(), case, out)
}

impl Saved {
    /// Reads the checkpoint of the run folder `out`. Refuses those of another case or method, and what is no number.
    pub(in super::super) fn read(out: &Path, case: &Case) -> Result<Self, RunError> {
        let saved = Self(checkpoint::read(&out.join(FILE))?);
        let meta = |name: &str| saved.0.meta.get(name).filter(|v| !v.is_null());
        require(meta("kind").is_some_and(|k| k == kind(case)), "it is of another kind of study")?;
        let named = out.display();
        if meta("method").is_none_or(|m| m != method(case)) {
            let began = meta("method").and_then(Value::as_str).unwrap_or("another").to_owned();
            return Err(RunError::OtherRun {
                what: format!(
                    "`{named}/case.toml` asks for `[time.{}]`, but the run began with `[time.{began}]`",
                    method(case)
                ),
                hint: "go on with the method that it began with, or begin another run",
            });
        }
        if meta("equations").is_none_or(|known| *known != json!(equations_of(case))) {
            return Err(RunError::OtherRun {
                what: format!("`{named}/case.toml` has other bodies or contact than those that the run began with"),
                hint: "only `[output]` and how long and with which steps `[time]` goes on may change: put back the case as it was, or begin \
                       another run",
            });
        }
        for field in &saved.0.fields {
            let numbers = matches!(&field.data, Array::F64(all) if all.iter().all(|x| x.is_finite()));
            require(numbers, "a field holds what is not a finite number")?;
        }
        Ok(saved)
    }

    /// Where a march of this structure stands.
    pub(super) fn standing<const D: usize>(&self, case: &Case, built: &Built<D>) -> Result<Standing, RunError> {
        let (structure, list) = (&built.structure, |name: &str| self.0.f64(name));
        let [time, last, next, loads, supports, damped] = list("clock")?[..] else {
            return Err(untrue("its clock is broken"));
        };
        let iteration = whole(self.0.meta.get("iteration"))?;
        // of equilibrium it is the part of the load
        let end = if matches!(case.time, Temporal::Steady(_) | Temporal::Modes(_)) { 1.0 } else { f64::INFINITY };
        let forwards = 0.0 <= time && time <= end && 0.0 <= last && 0.0 <= next;
        // explicit steps are parts of this one
        let steps = iteration == 0 || next > 0.0 || !matches!(case.time, Temporal::Explicit(_));
        require(forwards && steps, "its clock does not run forwards")?;
        let (u, before) = (list("state")?, list("before")?);
        require(u.len() == unknowns(structure.fields()), "its state is of another structure")?;
        let known = before.is_empty() || before.len() == structure.displacements();
        require(known, "its forces are of another structure")?;
        let stable = if matches!(case.time, Temporal::Explicit(_)) {
            structure.stable_step(&u[..structure.displacements()])
        } else {
            f64::INFINITY
        };
        require(last.max(next) <= LONGER * stable, "its steps are longer than its march is stable with")?;
        let width = OF_ROW + 3 * built.probes.len();
        let rows = list("history")?;
        require(rows.len().is_multiple_of(width), "its history has other probes than the case")?;
        let row = |r: &[f64]| Row {
            step: r[0] as u32,
            time: r[1],
            energy: Energy { kinetic: r[2], strain: r[3], stabilisation: r[4], contact: r[5], dissipated: r[6] },
            work: Work { loads: r[7], supports: r[8], damped: r[9] },
            probes: r[OF_ROW..].as_chunks().0.to_vec(),
        };
        let halved = self.0.meta.get("halved").map_or(Ok(0), |n| whole(Some(n)))?;
        let past = Past { time, iteration, halved, last, next, before: before.to_vec(), ..Past::default() };
        let rows = rows.chunks_exact(width).map(row).collect();
        Ok(Standing { past, u: u.to_vec(), rows, work: Work { loads, supports, damped } })
    }

    /// Where the search for a periodic motion of this structure stands.
    pub(super) fn sought<const D: usize>(&self, plan: &Harmonics, built: &Built<D>) -> Result<Sought, RunError> {
        let meta = |name: &str| whole(self.0.meta.get(name));
        let harmonics = meta("harmonics")?;
        let most = match plan.number {
            HarmonicCount::Fixed(n) => n,
            HarmonicCount::Auto(_) => plan.most.max(1),
        };
        require(harmonics <= most, "it has more harmonics than the case asks for")?;
        let held = Instances::of_harmonics(harmonics as usize);
        let [reached, sought, first] = self.0.f64("parts")?[..] else { return Err(untrue("its parts are broken")) };
        let parts = 0.0 <= reached && reached <= sought && 0.0 < sought && sought <= 1.0 && 0.0 <= first;
        require(parts, "its parts of the load are none")?;
        let n = built.structure.displacements() * held.count();
        let list = |name: &str| {
            let list = self.0.f64(name)?;
            require(list.len() == n, "it is of another structure")?;
            Ok::<_, RunError>(list.to_vec())
        };
        let before = |k: usize| whole(self.0.meta.get("before").and_then(|b| b.get(k)));
        let place = Place {
            u: list("state")?,
            last_good: list("last_good")?,
            start: list("start")?,
            reached,
            sought,
            first,
            within: meta("within")?,
            iterations: meta("iterations")?,
            linear: meta("linear")?,
            halved: meta("halved")?,
        };
        Ok(Sought { held, place, before: [before(0)?, before(1)?, before(2)?] })
    }
}

/// Writes a checkpoint of these lists, and what tells the case that it is of.
fn write(mut meta: Value, lists: Vec<(&str, Vec<f64>)>, case: &Case, out: &Path) -> Result<(), RunError> {
    meta["method"] = json!(method(case));
    meta["equations"] = json!(equations_of(case));
    let field = |(name, values): (&str, Vec<f64>)| Field {
        name: name.to_owned(),
        shape: vec![values.len()],
        data: Array::F64(values.into()),
    };
    let fields = lists.into_iter().map(field).collect();
    Ok(checkpoint::write(&out.join(FILE), &Checkpoint { meta, fields })?)
}

/// What kind of study a case asks for: a march or equilibrium, or a periodic motion.
fn kind(case: &Case) -> &'static str {
    if matches!(case.time, Temporal::Harmonics(_)) { "periodic" } else { "structure" }
}

/// The method of a case, by the key of `[time]`: what one of them remembers says nothing to another.
fn method(case: &Case) -> &'static str {
    match &case.time {
        Temporal::Explicit(_) => "explicit",
        Temporal::Newmark(_) => "newmark",
        Temporal::Dual(_) => "dual",
        Temporal::Harmonics(_) => "harmonics",
        Temporal::Steady(_) => "steady",
        Temporal::Modes(_) => "modes",
    }
}

/// Checksum of what the equations of a structure alone are made of, probes among it, whose displacements the history holds.
fn equations_of(case: &Case) -> u32 {
    let all = (&case.dimension, &case.bodies, &case.contact, case.balance_frequency());
    crc32fast::hash(format!("{all:?}").as_bytes())
}

/// A whole number of a checkpoint.
fn whole(value: Option<&Value>) -> Result<u32, RunError> {
    let number = value.and_then(Value::as_u64).and_then(|n| u32::try_from(n).ok());
    number.ok_or_else(|| untrue("it does not say how far it came"))
}

/// Nothing, or what is wrong with a checkpoint.
fn require(holds: bool, problem: &'static str) -> Result<(), RunError> {
    if holds { Ok(()) } else { Err(untrue(problem)) }
}

fn untrue(problem: &'static str) -> RunError {
    RunError::Untrue { file: FILE, problem }
}
