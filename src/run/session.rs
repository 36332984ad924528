//! A session: a case in, fields and loads out.
//!
//! A session opens no file but those that the case names, unless it keeps its run in a folder.
use std::path::{Path, PathBuf};

use super::folder::{self, Hold};
use super::keeper::FolderKeeper;
use super::outcome::Outcome;
use crate::case::Case;
use crate::claims::{Loops, wall::Wall};
use crate::observe::loads::Coefficients;
use crate::problem::{Problem, RunError};
use crate::study::flow::{self, Bars, Origin, Way};
use crate::study::keeper::Keeper;
use crate::study::{IterationHistory, Monitor, Snapshot, Solution, Summary, WallSnapshot};

/// A case that is solved in memory.
///
/// ```no_run
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let case = alula::case::read("title = \"cylinder\"\n[flow]\nmach = 0.3\n[[body]]\ncircle = { radius = 0.5 }\n", "case")?;
/// let mut session = alula::run::Session::open(&case, ".")?;
/// session.solve(&mut alula::run::Silent)?;
/// println!("{:?}", session.loads());
/// # Ok(())
/// # }
/// ```
pub struct Session {
    problem: Problem,
    out: Option<PathBuf>,
    held: Option<Hold>,
    origin: Origin,
    solution: Option<Solution>,
}

impl Session {
    /// Opens a case whose file names refer to the folder `input`.
    pub fn open(case: &Case, input: impl AsRef<Path>) -> Result<Self, RunError> {
        Ok(Self::of(Problem::of_case(case, input)?))
    }

    /// A session that solves a problem.
    pub fn of(problem: Problem) -> Self {
        Self { problem, out: None, held: None, origin: Origin::Case, solution: None }
    }

    /// The same with a folder for tables, checkpoints, fields and pictures, which is made and gets the resolved case. Fails where
    /// it holds an earlier run already.
    pub fn keep_in(self, out: impl AsRef<Path>, monitor: &mut dyn Monitor) -> Result<Self, RunError> {
        let (out, case, input) = (out.as_ref(), self.problem.given(), self.problem.input());
        folder::check_compared(case, input)?;
        let (again, held) = folder::create(case, input, out)?;
        if again {
            let out = out.display();
            monitor.note(&format!("the run in `{out}` was stopped before its first checkpoint: it begins again"));
        }
        Ok(self.kept_in(out, held))
    }

    /// The same with a folder, which exists.
    pub(crate) fn kept_in(self, out: &Path, held: Hold) -> Self {
        Self { out: Some(out.to_path_buf()), held: Some(held), ..self }
    }

    /// The same from elsewhere than the start of the case.
    pub(crate) fn from(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    /// Solves the case, from its start or from where it was stopped; tells how it went. Error bars of marches and balances are found by
    /// [`solve`](super::solve).
    pub fn solve(&mut self, monitor: &mut dyn Monitor) -> Result<Outcome, RunError> {
        self.solve_with(None, monitor)
    }

    /// The same; `bars` finds its error bars at the end.
    pub(crate) fn solve_with(
        &mut self,
        bars: Option<Bars<'_>>,
        monitor: &mut dyn Monitor,
    ) -> Result<Outcome, RunError> {
        let origin = std::mem::replace(&mut self.origin, Origin::Case);
        let keeper = self.out.as_deref().map(|out| Box::new(FolderKeeper::new(out)) as Box<dyn Keeper>);
        let way = Way { keeper, ..Way::of(origin) };
        let ended = match flow::solve(&self.problem, way, monitor)? {
            Ok(mut flow) => flow.conclude(bars)?,
            Err(iteration) => Err(iteration),
        };
        self.held = None;
        Ok(match ended {
            Ok(solution) => {
                let summary = Box::new(solution.summary.clone());
                self.solution = Some(solution);
                Outcome::Finished(summary)
            }
            Err(iteration) => Outcome::Interrupted { iteration },
        })
    }

    /// The problem that it solves.
    pub(crate) fn problem(&self) -> &Problem {
        &self.problem
    }

    /// The folder that it is kept in.
    pub(crate) fn folder(&self) -> Option<PathBuf> {
        self.out.clone()
    }

    /// The case.
    pub fn case(&self) -> &Case {
        self.problem.given()
    }

    /// What was found and what it took; `None` before it is solved.
    pub fn summary(&self) -> Option<&Summary> {
        self.solution.as_ref().map(|s| &s.summary)
    }

    /// Loads on all bodies, of pressure and friction; `None` before it is solved.
    pub fn loads(&self) -> Option<Coefficients> {
        self.summary().map(|s| s.loads.total)
    }

    /// The solution on all particles, in the units of the case; `None` before it is solved.
    pub fn field(&self) -> Option<&Snapshot> {
        self.solution.as_ref().map(|s| &s.field)
    }

    /// The solution on the walls, in the units of the case; `None` before it is solved.
    pub fn walls(&self) -> Option<&WallSnapshot> {
        self.solution.as_ref().map(|s| &s.walls)
    }

    /// Pressure and friction on the walls, as claims are measured on them; `None` before it is solved.
    pub fn wall(&self) -> Option<Wall> {
        self.walls().map(WallSnapshot::measured)
    }

    /// What every iteration left; `None` before it is solved.
    pub fn history(&self) -> Option<&IterationHistory> {
        self.solution.as_ref().map(|s| &s.history)
    }

    /// Loads over the last period of a motion, empty where there is none; `None` before it is solved.
    pub fn loops(&self) -> Option<&Loops> {
        self.solution.as_ref().map(|s| &s.loops)
    }

    /// All that it has found, handed over; `None` before it is solved.
    pub fn into_solution(self) -> Option<Solution> {
        self.solution
    }
}
