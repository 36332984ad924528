//! What keeps a case from being computed, as far as it is known before any flow: what `check` refuses as `run`, `flutter` and `gaf` do.
//!
//! Each look is one that a command begins with, and stops at the first thing that it does not like; the looks are independent of one
//! another, so that mistakes in the flow, in tables of modes, in `[flutter]` and in `[gaf]` are all told at once. What only a cloud shows
//! is told by [`inspect`](super::inspect).
use std::path::Path;

use super::{flutter, folder, gaf};
use crate::case::{Case, Temporal, read_mode};
use crate::cloud::layout::count;
use crate::geometry::dimension;
use crate::motion::faulty_tables;
use crate::problem::{Problem, ProblemIn, RunError, files, solids, spec, surface};
use crate::study::studies;

/// All that the commands refuse of a case whose file names refer to the folder `input`; empty where they can begin.
pub fn refusals(case: &Case, input: &Path) -> Vec<RunError> {
    let mut all = Refusals::default();
    all.look(folder::check_compared(case, input));
    if !case.has_gas() {
        all.look(solids::supported(case));
        return all.found;
    }
    for problem in shapes(case, input).into_iter().chain(tables(case, input)) {
        all.look::<()>(Err(problem));
    }
    // small motions are about bodies as drawn, unless they are trimmed
    let held = case.flutter.is_some() && !case.is_trimmed();
    all.look(Problem::of_case(case, input).and_then(|problem| rehearse(&problem, held)));
    if case.flutter.is_some() {
        all.look(flutter::rehearse(case, input));
    }
    if case.gaf.is_some() {
        all.look(gaf::rehearse(case, input));
    }
    all.found
}

/// Refuses a problem of which it is known before its cloud is built that it cannot begin; bodies that are `held` need no springs.
pub(super) fn rehearse(problem: &Problem, held: bool) -> Result<(), RunError> {
    match problem {
        Problem::Plane(problem) => within(problem, held),
        Problem::Space(problem) => within(problem, held),
    }
}

fn within<const D: usize>(problem: &ProblemIn<D>, held: bool) -> Result<(), RunError> {
    let case = problem.case();
    if !held {
        problem.check_equilibrium()?;
    }
    // supports of bodies made of particles have periods as well
    if matches!(case.time, Temporal::Harmonics(_)) && case.solids().next().is_none() {
        studies::check_period(problem.motions())?;
    }
    count(&spec(case), problem.surface(), &[])?;
    Ok(())
}

/// What a command refuses of a case; where a file is to blame, all files of it that cannot be used together.
pub(super) fn with_other_files(case: &Case, input: &Path, problem: RunError) -> RunError {
    use RunError::{Geometry, Law, Motion, Structure};
    if !matches!(problem, Geometry(_) | Law(_) | RunError::Case(_) | Structure(_) | Motion { .. }) {
        return problem;
    }
    let mut all = Refusals::default();
    all.look::<()>(Err(problem));
    let surfaces = match dimension(case) {
        2 => surface::<2>(case, input).map(|_| ()),
        _ => surface::<3>(case, input).map(|_| ()),
    };
    all.look(surfaces.map_err(Geometry));
    for other in shapes(case, input).into_iter().chain(tables(case, input)) {
        all.look::<()>(Err(other));
    }
    RunError::all(all.found).unwrap_or(RunError::NoStage)
}

/// Mistakes in the tables of all motions that a case names.
fn tables(case: &Case, input: &Path) -> Vec<RunError> {
    let read = |name: &str| files::text(input, name);
    let found = match dimension(case) {
        2 => faulty_tables::<2>(case, &read),
        _ => faulty_tables::<3>(case, &read),
    };
    found.into_iter().map(RunError::Law).collect()
}

/// Mistakes in the tables of all modes that a case names.
fn shapes(case: &Case, input: &Path) -> Vec<RunError> {
    let laws = case.bodies.iter().filter_map(|b| b.motion.as_ref()).chain(case.motion.as_ref().map(|m| &m.law));
    let prescribed = laws.flat_map(|law| &law.modes).map(|mode| &mode.file);
    let elastic = case.structures.iter().flat_map(|s| &s.modes).map(|mode| &mode.file);
    let flexible = case.gaf.iter().flat_map(|g| &g.flexible).map(|mode| &mode.file);
    let mut files: Vec<&String> = prescribed.chain(elastic).chain(flexible).collect();
    files.sort();
    files.dedup();
    let read = |file: &String| read_mode(&files::text(input, file).ok()?, file, usize::from(dimension(case))).err();
    files.into_iter().filter_map(read).map(RunError::Case).collect()
}

/// What was refused so far, each thing once.
#[derive(Default)]
struct Refusals {
    found: Vec<RunError>,
}

impl Refusals {
    fn look<T>(&mut self, seen: Result<T, RunError>) -> Option<T> {
        match seen {
            Ok(value) => Some(value),
            Err(problem) => {
                for problem in problem.parts() {
                    let told = problem.to_string();
                    if self.found.iter().all(|known| known.to_string() != told) {
                        self.found.push(problem);
                    }
                }
                None
            }
        }
    }
}
