//! Integrators: they know a [`System`] and nothing of what it means.
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

/// What one call of an integrator did.
#[derive(Clone, Copy, Debug, Default)]
pub struct Step {
    /// Iterations or steps since the start.
    pub iteration: u32,
    /// Physical time.
    pub time: f64,
    /// Courant number used.
    pub cfl: f64,
    /// Size of the residual over its size at the start.
    pub residual: f64,
    /// Linear iterations spent.
    pub linear: u32,
}

/// What a march needs, beside the state, to go on where it stopped.
#[derive(Clone, Debug, Default)]
pub struct Past {
    /// Time reached.
    pub time: f64,
    /// Steps taken.
    pub iteration: u32,
    /// Length of the step before.
    pub last: f64,
    /// Length of the next step.
    pub next: f64,
    /// State one step ago; empty at the start, and for methods that need none.
    pub before: Vec<f64>,
    /// State two steps ago, where all steps are of one length; else empty.
    pub older: Vec<f64>,
    /// How far the linear systems of the last steps reached.
    pub reach: Reach,
    /// Steps for which the preconditioner at hand has served; 0 when the next step makes its own.
    pub served: u32,
    /// Time at the end of the first of those steps.
    pub made: f64,
    /// Steps that did not reach their goal.
    pub unconverged: u32,
    /// Times a step was halved because its equations could not be solved.
    pub halved: u32,
}

impl Past {
    /// How far the march has come.
    pub fn mark(&self) -> Mark {
        Mark { iteration: self.iteration, time: self.time, last: self.last, residual: 1.0, resting: 0 }
    }
}

/// What an integrator must remember, beside the state, to go on to the same bits.
#[derive(Clone, Debug)]
pub enum Memory {
    /// A relaxation.
    Relaxation(Resume),
    /// A march.
    March(Past),
}

/// How far an integrator has come.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Mark {
    /// Iterations or steps since the start.
    pub iteration: u32,
    /// Physical time; zero in a relaxation.
    pub time: f64,
    /// Length of the last step in time; zero before the first one and in a relaxation.
    pub last: f64,
    /// Size of the residual over its first value, or that in the last step.
    pub residual: f64,
    /// Iterations of Newton's method on a steady state since the residual was last smallest.
    pub resting: u32,
}

/// What an integrator has spent and holds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Evaluations of the residual since it was made.
    pub evaluations: u64,
    /// Linear iterations so far.
    pub linear: u32,
    /// Iterations within the last step.
    pub inner: u32,
    /// Bytes held.
    pub bytes: usize,
    /// Steps in time that did not reach their goal.
    pub unconverged: u32,
    /// Times a step in time was halved because its equations could not be solved.
    pub halved: u32,
}

/// Where an integrator stands, for those who watch.
pub struct Standing<'a, S: System> {
    /// What is integrated.
    pub system: &'a S,
    /// Frame of the state.
    pub frame: &'a S::Frame,
    /// Storage that may be used to look at it.
    pub work: &'a mut S::Work,
    /// State.
    pub state: &'a [f64],
}

/// A method that goes on step by step until it is finished: a relaxation, a march, or a relaxation of all instances of a
/// period. Who drives it need not know which.
pub trait Integrator<S: System> {
    /// One step, from a state that [`check`](Self::check) lets pass to another such; after an error the state is the last good one.
    fn advance(&mut self) -> Result<Step, TimeError>;
    /// True when the goal is reached.
    fn finished(&self) -> bool;
    /// How far it has come.
    fn mark(&self) -> Mark;
    /// Where it stands.
    fn standing(&mut self) -> Standing<'_, S>;
    /// What a later run needs beside the state.
    fn memory(&self) -> Memory;
    /// What it has spent.
    fn cost(&self) -> Cost;
    /// Refuses to begin at a state that is not physical: numbers that are none, densities and pressures that are not positive. Goals and
    /// norms are compared, and a comparison with what is no number holds or fails as it happens to be written. Steps check their own ends.
    fn check(&mut self) -> Result<(), TimeError> {
        let iteration = self.mark().iteration;
        let Standing { system, frame, state, .. } = self.standing();
        system.check(frame, state).map_err(|fault| TimeError::Fault { fault, iteration, hint: UNSOUND })
    }
}

/// What may help where a state is not physical.
const UNSOUND: &str = "the state that this goes on from is damaged: begin the run again";

/// What may help where motion leaves a particle without a good cloud.
pub const CROWDED: &str = "bodies come too close to one another or to a side of the domain, or move too far for the particles \
                       between them; give them more room, less motion, or `motion.particles = \"rigid\"` if there is one body";

/// Why an integration stopped early.
#[derive(Debug, thiserror::Error)]
pub enum TimeError {
    /// A state became unphysical.
    #[error("{fault}; last step {iteration}\nhint: {hint}")]
    Fault {
        /// Where and why.
        fault: crate::system::Fault,
        /// Step at which it happened.
        iteration: u32,
        /// What may help.
        hint: &'static str,
    },
    /// The steady relaxation cannot get on.
    #[error(
        "the relaxation stopped at iteration {iteration}: every step down to a Courant number of {cfl:.1e} was rejected; the largest residual is at {place}\nhint: lower `cfl` (in `[time.steady]`, `[time.dual]` or `[time.harmonics]`), take shorter steps in a march, or refine the cloud there"
    )]
    Stalled {
        /// Iteration.
        iteration: u32,
        /// Smallest Courant number tried.
        cfl: f64,
        /// Where the largest scaled residual is: a particle and its place, or a row of another field.
        place: String,
    },
}
