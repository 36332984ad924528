//! Steady flows.
use super::flow::{self, Flow, Origin, Way};
use super::look::{Snapshot, WallSnapshot};
use super::monitor::{Monitor, Silent};
use super::record::IterationHistory;
use super::solution::Solution;
use super::studies::ForceSource;
use crate::observe::convergence::Convergence;
use crate::observe::loads::Coefficients;
use crate::problem::{Problem, RunError};
use crate::record::summary::Summary;

/// A steady flow with its equations, so that it can be asked for forces of small motions.
pub struct SteadyFlow<'a> {
    flow: Box<dyn Flow<'a> + 'a>,
    solution: Solution,
}

/// How far the residual of a flow fell.
#[derive(Clone, Debug, PartialEq)]
pub struct FlowConvergence {
    /// True where the residual fell as far as was asked for.
    pub converged: bool,
    /// Orders of magnitude by which the residual fell on the last cloud; `None` where the flow was steady from the start.
    pub orders: Option<f64>,
    /// Iterations on all clouds.
    pub iterations: u64,
    /// What makes the results doubtful.
    pub warnings: Vec<String>,
}

/// Solves the steady flow of a problem. Bodies on springs come to equilibrium; with a table `[flutter]` that does not ask for trim they stay as
/// drawn.
///
/// ```no_run
/// use alula::{problem::Problem, study};
/// # fn main() -> Result<(), alula::problem::RunError> {
/// let flow = study::steady(&Problem::open("case.toml")?)?;
/// println!("{:?}, {:?}", flow.loads(), flow.convergence());
/// # Ok(())
/// # }
/// ```
pub fn steady(problem: &Problem) -> Result<SteadyFlow<'static>, RunError> {
    // a monitor that holds nothing: its box takes no memory
    let silent: &'static mut Silent = Box::leak(Box::new(Silent));
    steady_with(problem, silent)?.ok_or(RunError::NoStage)
}

/// Solves the steady flow of a problem under the eyes of `monitor`; `None` when that says stop.
pub fn steady_with<'a>(problem: &Problem, monitor: &'a mut dyn Monitor) -> Result<Option<SteadyFlow<'a>>, RunError> {
    let case = problem.case();
    super::refuse(
        case.is_unsteady() || case.polar.is_some() || !case.has_gas(),
        "a steady flow of a case that asks for something else",
        "call `study::polar` for several angles of attack, `march` or `harmonic` with `[time]`, `solid` without `[flow]`",
    )?;
    let held = case.flutter.is_some() && !problem.given().is_trimmed();
    let way = Way { held, ..Way::of(Origin::Case) };
    let Ok(mut flow) = flow::solve(problem, way, monitor)? else { return Ok(None) };
    Ok(flow.conclude(None)?.ok().map(|solution| SteadyFlow { flow, solution }))
}

impl SteadyFlow<'_> {
    /// Loads on all bodies, of pressure and friction.
    pub fn loads(&self) -> Coefficients {
        self.solution.summary.loads.total
    }

    /// How far the residual fell.
    pub fn convergence(&self) -> FlowConvergence {
        let progress = &self.solution.summary.convergence;
        FlowConvergence {
            converged: progress.converged != Some(false),
            orders: progress.residual_drop,
            iterations: progress.iterations,
            warnings: progress.warnings.clone(),
        }
    }

    /// How the loads converge on the family of clouds; `None` where the case gives one cloud.
    pub fn grid_convergence(&self) -> Option<&Convergence> {
        self.solution.summary.grid.grid_convergence.as_ref()
    }

    /// The solution on all particles, in the units of the case.
    pub fn field(&self) -> &Snapshot {
        &self.solution.field
    }

    /// The solution on the walls, in the units of the case.
    pub fn walls(&self) -> &WallSnapshot {
        &self.solution.walls
    }

    /// What every iteration left.
    pub fn history(&self) -> &IterationHistory {
        &self.solution.history
    }

    /// All numbers that a run tells at its end.
    pub fn summary(&self) -> &Summary {
        &self.solution.summary
    }

    /// What forces of small motions about it are computed by.
    pub(super) fn source(&self) -> Result<Box<dyn ForceSource + '_>, RunError> {
        self.flow.source()
    }
}
