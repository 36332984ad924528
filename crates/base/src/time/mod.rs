//! Integrators in time, for any [`System`]; they know nothing of its physics.
pub mod control;
pub mod dual;
pub mod explicit;
pub mod forced;
pub mod formula;
pub mod full;
pub mod harmonic;
pub mod linear;
mod norm;
pub mod ordinary;
mod preconditioning;
mod recycled;
pub mod relax;
pub mod structural;
pub mod symplectic;
pub mod vibration;

use crate::system::{Reach, System};
use relax::Resume;

/// Result of one step of an integrator.
#[derive(Clone, Copy, Debug, Default)]
pub struct Step {
    /// Number of iterations or steps since the start.
    pub iteration: u32,
    /// Physical time at the end of the step; 0 in a relaxation.
    pub time: f64,
    /// Courant number of the step.
    pub cfl: f64,
    /// Ratio of the residual norm to its initial value.
    pub residual: f64,
    /// Total number of linear iterations.
    pub linear: u32,
}

/// Data, beside the state, that a march needs to continue.
#[derive(Clone, Debug, Default)]
pub struct Past {
    /// Time reached so far.
    pub time: f64,
    /// Number of steps taken.
    pub iteration: u32,
    /// Length of the last step.
    pub last: f64,
    /// Length of the next step.
    pub next: f64,
    /// State one step ago; empty at the start, and for methods that do not need it.
    pub before: Vec<f64>,
    /// State two steps ago if all steps have the same length, else empty.
    pub older: Vec<f64>,
    /// Range of coupling of the linear systems of the last steps.
    pub reach: Reach,
    /// Number of steps in which the current preconditioner has been used; 0 if the next step builds a new one.
    pub served: u32,
    /// Time at the end of the first of those steps.
    pub made: f64,
    /// Number of steps that did not reach the required reduction of the residual.
    pub unconverged: u32,
    /// Number of times that a step was halved because its equations could not be solved.
    pub halved: u32,
}

impl Past {
    /// Progress of the march.
    pub fn mark(&self) -> Mark {
        Mark { iteration: self.iteration, time: self.time, last: self.last, residual: 1.0, resting: 0 }
    }
}

/// Data, beside the state, that an integrator needs to continue with identical results.
#[derive(Clone, Debug)]
pub enum Memory {
    /// Data of a relaxation.
    Relaxation(Resume),
    /// Data of a march.
    March(Past),
}

/// Progress of an integrator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mark {
    /// Number of iterations or steps since the start.
    pub iteration: u32,
    /// Physical time; 0 in a relaxation.
    pub time: f64,
    /// Length of the last time step; 0 before the first one and in a relaxation.
    pub last: f64,
    /// Ratio of the residual norm to its initial value, at present or at the end of the last time step.
    pub residual: f64,
    /// Number of Newton iterations on a steady state since the last minimum of the residual.
    pub resting: u32,
}

/// Computational cost of an integrator so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Number of evaluations of the residual since the integrator was created.
    pub evaluations: u64,
    /// Total number of linear iterations.
    pub linear: u32,
    /// Number of iterations within the last step.
    pub inner: u32,
    /// Memory in use (bytes).
    pub bytes: usize,
    /// Number of time steps that did not reach the required reduction of the residual.
    pub unconverged: u32,
    /// Number of times that a time step was halved because its equations could not be solved.
    pub halved: u32,
}

/// View of the current solution of an integrator, for observers.
pub struct Standing<'a, S: System> {
    /// The system that is integrated.
    pub system: &'a S,
    /// Frame of the state.
    pub frame: &'a S::Frame,
    /// Working storage, which observers may use for evaluations.
    pub work: &'a mut S::Work,
    /// State that belongs to the frame.
    pub state: &'a [f64],
}

/// A method that proceeds in steps until it is finished: a relaxation, a march, or a relaxation of all instances of a
/// period. Callers do not need to know which.
pub trait Integrator<S: System> {
    /// Computes one step from a state that passes [`check`](Self::check) to another such state. After an error, the
    /// state is the last accepted one.
    fn advance(&mut self) -> Result<Step, TimeError>;
    /// True if the goal is reached.
    fn finished(&self) -> bool;
    /// Progress so far.
    fn mark(&self) -> Mark;
    /// View of the current solution.
    fn standing(&mut self) -> Standing<'_, S>;
    /// Data, beside the state, that a later run needs to continue.
    fn memory(&self) -> Memory;
    /// Computational cost so far.
    fn cost(&self) -> Cost;
    /// Returns an error if the initial state is not physical: values that are NaN or infinite, or densities and
    /// pressures that are not positive. The comparisons in norms and goals are not reliable for NaN, so that such a
    /// state must be excluded beforehand. Steps check their own results.
    fn check(&mut self) -> Result<(), TimeError> {
        let iteration = self.mark().iteration;
        let Standing { system, frame, state, .. } = self.standing();
        system.check(frame, state).map_err(|fault| TimeError::Fault { fault, iteration, hint: UNSOUND })
    }
}

/// Hint for a state that is not physical.
const UNSOUND: &str = "the initial state of this computation is damaged: start the run again from the beginning";

/// Hint for motion that leaves a particle without suitable neighbours.
pub const CROWDED: &str = "bodies come too close to one another or to a boundary of the domain, or move too far for the \
                       particles between them; increase their distance, reduce their motion, or set \
                       `motion.particles = \"rigid\"` if there is only one body";

/// Error that ends an integration.
#[derive(Debug, thiserror::Error)]
pub enum TimeError {
    /// A state became unphysical.
    #[error("{fault}; last step {iteration}\nhint: {hint}")]
    Fault {
        /// Row, position and description of the fault.
        fault: crate::system::Fault,
        /// Index of the last step.
        iteration: u32,
        /// Suggested remedy.
        hint: &'static str,
    },
    /// The relaxation to a steady state cannot continue.
    #[error(
        "the relaxation stopped at iteration {iteration}: every step down to a Courant number of {cfl:.1e} was rejected; the largest residual is at {place}\nhint: lower `cfl` (in `[time.steady]`, `[time.dual]` or `[time.harmonics]`), take shorter steps in a march, or refine the cloud there"
    )]
    Stalled {
        /// Iteration at which the relaxation stopped.
        iteration: u32,
        /// Minimum Courant number tried.
        cfl: f64,
        /// Location of the maximum scaled residual: a particle with its position, or a row of another field.
        place: String,
    },
}
