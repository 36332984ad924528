//! What a run took.
use serde::{Deserialize, Serialize};

use crate::observe::usage::peak_bytes;

/// The phase in which files, pictures and the report are written.
pub const FILES: &str = "files and pictures";

/// The phase in which error bars of marches and balances are found.
const BARS: &str = "error bars";

/// What a run took.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cost {
    /// Processor time.
    pub cpu_seconds: f64,
    /// Wall time.
    pub wall_seconds: f64,
    /// Greatest memory of the process; 0 where the system does not tell.
    pub peak_bytes: u64,
    /// Evaluations of the residual of one instance on the cloud of the end, over all stages: those on coarser clouds count with
    /// their part of its particles.
    pub work_units: f64,
    /// Bytes per particle: cloud, operators, state and integrator.
    pub bytes_per_particle: f64,
    /// Processor milliseconds per particle.
    pub cpu_ms_per_particle: f64,
    /// Where the time went: name and wall seconds.
    pub phases: Vec<(String, f64)>,
}

impl Cost {
    /// Adds what finding the error bars took; `[processor, wall]` seconds as below.
    pub fn spent_on_bars(&mut self, [cpu, wall]: [f64; 2]) {
        self.phases.insert(1.min(self.phases.len()), (BARS.into(), wall - self.wall_seconds));
        (self.cpu_seconds, self.wall_seconds) = (cpu, wall);
    }

    /// Brings it up to date for a flow on so many particles: `[processor, wall]` seconds since its beginning, the rest as the system tells it.
    pub fn spent(&mut self, [cpu, wall]: [f64; 2], particles: usize) {
        let files = self.phases.iter_mut().find(|(name, _)| name == FILES);
        files.into_iter().for_each(|(_, seconds)| *seconds += wall - self.wall_seconds);
        (self.cpu_seconds, self.wall_seconds, self.peak_bytes) = (cpu, wall, peak_bytes());
        self.cpu_ms_per_particle = 1e3 * cpu / particles as f64;
    }
}
