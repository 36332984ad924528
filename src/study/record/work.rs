//! Work and time that a study takes.
use std::time::Instant;

use crate::observe::usage::cpu_seconds;

/// Work of a run: evaluations of the residual of one instance times fluid particles, over all stages.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Work {
    /// So far.
    pub(crate) total: u64,
    /// Evaluations of the present stage that are in it.
    counted: u64,
}

impl Work {
    /// What was done before a restart.
    pub(crate) fn before(total: u64) -> Self {
        Self { total, counted: 0 }
    }

    /// A stage begins whose integrator has counted `evaluations` already.
    pub(crate) fn begin(&mut self, evaluations: u64) {
        self.counted = evaluations;
    }

    /// The integrator has counted up to `evaluations`, each of so many particles.
    pub(crate) fn add(&mut self, evaluations: u64, particles: usize) {
        self.total += evaluations.saturating_sub(self.counted) * particles as u64;
        self.counted = evaluations;
    }
}

/// Processor and wall time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clock {
    wall: Instant,
    cpu: f64,
}

impl Clock {
    /// Starts now.
    pub(crate) fn start() -> Self {
        Self { wall: Instant::now(), cpu: cpu_seconds() }
    }

    /// Wall seconds since the start.
    pub(crate) fn wall_seconds(&self) -> f64 {
        self.wall.elapsed().as_secs_f64()
    }

    /// Processor seconds since the start.
    pub(crate) fn cpu_seconds(&self) -> f64 {
        // threads that have ended are not counted any more
        (cpu_seconds() - self.cpu).max(0.0)
    }
}
