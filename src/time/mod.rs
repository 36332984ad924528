//! Integrators: they know a [`System`] and nothing of what it means.
pub mod control;
pub mod dual;
pub mod explicit;
pub mod formula;
pub mod full;
pub mod harmonic;
mod norm;
mod preconditioning;
pub mod relax;

use crate::system::{Reach, System};

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

/// A method that marches in time.
pub trait March<S: System> {
    /// One step.
    fn advance(&mut self) -> Result<Step, TimeError>;
    /// True when the end is reached.
    fn finished(&self) -> bool;
    /// Frame, storage and state, for those who watch.
    fn parts(&mut self) -> (&S::Frame, &mut S::Work, &[f64]);
    /// Where the march stands.
    fn past(&self) -> &Past;
    /// Iterations within the last step.
    fn inner(&self) -> u32;
    /// Linear iterations so far.
    fn linear(&self) -> u32;
    /// Evaluations of the residual since it was made.
    fn evaluations(&self) -> u64;
    /// Bytes held.
    fn bytes(&self) -> usize;
}

/// What may help where motion leaves a particle without a good cloud.
const CROWDED: &str = "bodies come too close to one another or to a side of the domain, or move too far for the particles \
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
        "the relaxation stopped at iteration {iteration}: every step down to a Courant number of {cfl:.1e} was rejected; the largest residual is at particle {particle}{place}\nhint: lower `cfl` in `[time]`, take shorter steps in a march, or refine the cloud there"
    )]
    Stalled {
        /// Iteration.
        iteration: u32,
        /// Smallest Courant number tried.
        cfl: f64,
        /// Particle with the largest scaled residual.
        particle: usize,
        /// Where that is.
        place: String,
    },
}
