//! Integrators: they know a [`System`](crate::system::System) and nothing of what it means.
pub mod explicit;
pub mod relax;

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
        "the relaxation stopped at iteration {iteration}: every step down to a Courant number of {cfl:.1e} was rejected; the largest residual is at particle {particle}\nhint: lower `time.steady.cfl`, or refine the cloud there"
    )]
    Stalled {
        /// Iteration.
        iteration: u32,
        /// Smallest Courant number tried.
        cfl: f64,
        /// Particle with the largest scaled residual.
        particle: usize,
    },
}
