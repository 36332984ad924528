//! Further runs that tell the error bars of a run, in folders of their own.
//!
//! In the folder of a run they are called `coarser/cloud` and so on, and have checkpoints: a run that is stopped while they go goes on with
//! them, to the same bits.
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::folder;
use super::outcome::Outcome;
use super::resumed::continued;
use super::session::Session;
use crate::observe::error_bars::Part;
use crate::problem::{Problem, RunError};
use crate::record::summary::Summary;
use crate::study::Monitor;
use crate::study::error_bars::{Further, FurtherRuns};
use crate::study::record::Log;

/// Folder of the further runs in that of a run.
const FOLDER: &str = "coarser";

/// Solves a case as a session does, and finds the error bars that it asks for.
pub fn solve(session: &mut Session, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    let (problem, place) = (session.problem().clone(), Place { out: session.folder() });
    let further = Further { problem: &problem, runs: &place };
    let mut bars = |summary: &mut Summary, log: &mut Log<'_>| further.find(summary, log);
    session.solve_with(Some(&mut bars), monitor)
}

/// The folder of a run, where it has one.
struct Place {
    out: Option<PathBuf>,
}

impl FurtherRuns for Place {
    /// From its folder where it is finished.
    fn solve(&self, part: Part, problem: Problem, monitor: &mut dyn Monitor) -> Result<Option<Value>, RunError> {
        let Some(out) = self.out.as_deref() else {
            let outcome = solve(&mut Session::of(problem), monitor)?;
            return Ok(summary_of(outcome, None));
        };
        let name = match part {
            Part::Cloud => "cloud",
            Part::Step => "step",
            Part::Harmonics => "harmonics",
        };
        folder::make_within(out, FOLDER)?;
        let out = out.join(FOLDER).join(name);
        let outcome = kept(problem, &out, monitor)?;
        // what is read has the same bits whether or not the run was stopped since
        Ok(summary_of(outcome, Some(&out)))
    }
}

/// Solves a problem in a folder, from where it stands there.
fn kept(problem: Problem, out: &Path, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
    let own = folder::is_of(problem.given(), out);
    if let Some(summary) = folder::finished(out).filter(|_| own) {
        folder::check_files(out)?;
        return Ok(Outcome::AlreadyFinished { summary });
    }
    if own && folder::has_begun(out) {
        return solve(&mut continued(out)?, monitor);
    }
    if out.exists() && !own {
        folder::set_aside(out)?;
    }
    solve(&mut Session::of(problem).keep_in(out, monitor)?, monitor)
}

/// The summary that a run left in its folder, or in memory.
fn summary_of(outcome: Outcome, out: Option<&Path>) -> Option<Value> {
    match (outcome, out) {
        (Outcome::Interrupted { .. }, _) => None,
        (Outcome::AlreadyFinished { summary }, _) => Some(summary),
        (Outcome::Finished(summary), out) => {
            out.and_then(folder::finished).or_else(|| serde_json::to_value(&summary).ok())
        }
        (Outcome::Structure(_), _) => None,
    }
}
