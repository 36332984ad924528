//! What is known of a structure alone on its way and at its end: plain data.
use serde::{Deserialize, Serialize};

use super::super::look::Snapshot;
use crate::solid::forces::Energy;

/// Work since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Work {
    /// Of loads and gravity.
    pub(crate) loads: f64,
    /// Of supports that move.
    pub(crate) supports: f64,
    /// Taken by damping.
    pub(crate) damped: f64,
}

impl Work {
    /// That of `thickness` units of length across the plane.
    pub(crate) fn times(&self, thickness: f64) -> Self {
        Self { loads: self.loads * thickness, supports: self.supports * thickness, damped: self.damped * thickness }
    }
}

/// A row of `history.csv`; in the plane of the thickness of the case.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Row {
    pub(crate) step: u32,
    pub(crate) time: f64,
    pub(crate) energy: Energy,
    pub(crate) work: Work,
    /// Displacement of each probe.
    pub(crate) probes: Vec<[f64; 3]>,
}

impl Row {
    /// True where this row is of an earlier moment than `other`.
    pub(crate) fn is_before(&self, other: &Self) -> bool {
        self.step < other.step && self.time < other.time
    }
}

/// What was found of a structure alone, in SI units.
#[derive(Clone, Debug)]
pub struct SolidSolution {
    /// All that is one number.
    pub summary: SolidSummary,
    /// Particles where they are at the end, at the start of the period where the motion is periodic: `displacement`, `velocity`,
    /// `von_mises_stress`, `pressure`, `body`, `material`, of metals `plastic_strain` and `temperature`, `at_rest` (places), `stress` (Cauchy's,
    /// nine components, rows first), `volume` and `spacing` at rest.
    pub field: Snapshot,
    /// Columns of `history.csv` by name.
    pub history: Vec<(String, Vec<f64>)>,
    /// Displacement of every particle in each natural mode, the greatest component of which is one.
    pub shapes: Vec<Vec<[f64; 3]>>,
}

/// Numbers that were found of a structure alone.
#[derive(Clone, Debug, Serialize)]
pub struct SolidSummary {
    /// Always `summary`.
    pub event: &'static str,
    /// Title of the case.
    pub title: String,
    /// `equilibrium`, `march`, `modes` or `periodic`.
    pub study: &'static str,
    /// True where it came to its end.
    pub converged: bool,
    /// Bodies.
    pub bodies: Vec<String>,
    /// Solid particles.
    pub particles: usize,
    /// Mean number of neighbours.
    pub neighbours: f64,
    /// Rms part of the gradients' weights that the divergence theorem changed.
    pub correction: f64,
    /// Mass of all bodies, in the plane of the thickness of the case, of a whole turn about an axis.
    pub mass: f64,
    /// Steps taken.
    pub steps: u64,
    /// Time reached.
    pub time: f64,
    /// Largest force that equilibrium left over the largest there is; absent elsewhere.
    pub residual: Option<f64>,
    /// What was found of a periodic motion; absent elsewhere.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub periodic: Option<PeriodicRow>,
    /// Energies at the end, and what closes; of a periodic motion work and damping are those of one period.
    pub ledger: Option<SolidLedger>,
    /// Displacements of probes at the end.
    pub probes: Vec<ProbeRow>,
    /// Natural modes.
    pub modes: Vec<ModeRow>,
    /// Processor seconds.
    pub cpu_seconds: f64,
    /// Wall seconds.
    pub wall_seconds: f64,
    /// What makes results doubtful.
    pub warnings: Vec<String>,
}

/// Energies of a structure, in the plane of the thickness of the case, of a whole turn about an axis.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct SolidLedger {
    /// Kinetic energy at the start.
    pub kinetic_at_start: f64,
    /// Kinetic energy.
    pub kinetic: f64,
    /// Energy that materials give back.
    pub strain: f64,
    /// Energy held by stabilisation.
    pub stabilisation: f64,
    /// Energy held by contact.
    pub contact: f64,
    /// Energy that materials lost.
    pub dissipated: f64,
    /// Energy that damping took.
    pub damped: f64,
    /// Work of loads, gravity and supports that move.
    pub work: f64,
    /// What is missing, over the largest of all terms.
    pub open: f64,
}

/// A probe.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ProbeRow {
    /// Its name.
    pub name: String,
    /// Its displacement; that at the start of the period where the motion is periodic.
    pub displacement: Vec<f64>,
    /// Its mean displacement where the motion is periodic.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub mean: Vec<f64>,
    /// Its harmonics where the motion is periodic.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub harmonics: Vec<ProbeHarmonic>,
}

/// Harmonic k of the displacement of a probe: amplitude · cos(kωt + phase) along each axis.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ProbeHarmonic {
    /// k.
    pub harmonic: usize,
    /// Amplitudes, m.
    pub amplitude: Vec<f64>,
    /// Phases, degrees.
    pub phase_deg: Vec<f64>,
}

/// How a periodic motion was found.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct PeriodicRow {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Harmonics that are held.
    pub harmonics: usize,
    /// Part that the last harmonic has of all, by displacements weighed with masses; absent with a single one.
    pub tail: Option<f64>,
    /// Iterations of Newton's method.
    pub iterations: u32,
    /// Linear iterations.
    pub linear: u32,
}

/// A natural mode.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct ModeRow {
    /// Frequency, Hz.
    pub frequency: f64,
    /// Angular frequency, rad/s.
    pub omega: f64,
    /// Σ m φ² with the greatest component of φ one.
    pub generalised_mass: f64,
    /// What is left of its equation.
    pub residual: f64,
}

/// Energies between two moments.
pub(crate) fn ledger(first: &Row, last: &Row) -> SolidLedger {
    let (e, work) = (&last.energy, last.work.loads + last.work.supports);
    let whole =
        |r: &Row| r.energy.kinetic + r.energy.strain + r.energy.stabilisation + r.energy.contact + r.energy.dissipated;
    let missing = whole(last) + last.work.damped - whole(first) - work;
    let terms = [first.energy.kinetic, e.kinetic, e.strain, e.dissipated, last.work.damped, work];
    let size = terms.iter().fold(0.0f64, |m, x| m.max(x.abs()));
    SolidLedger {
        kinetic_at_start: first.energy.kinetic,
        kinetic: e.kinetic,
        strain: e.strain,
        stabilisation: e.stabilisation,
        contact: e.contact,
        dissipated: e.dissipated - first.energy.dissipated,
        damped: last.work.damped,
        work,
        open: if size > 0.0 { missing / size } else { 0.0 },
    }
}
