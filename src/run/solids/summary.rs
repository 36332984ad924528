//! What a structure alone tells at its end.
use serde::Serialize;

use super::super::record::summary::Clock;
use super::march::{Marched, Row, Study};
use crate::case::Temporal;
use crate::solid::modes::Mode;

/// What was found of a structure alone.
#[derive(Clone, Debug, Serialize)]
pub struct SolidSummary {
    /// Always `summary`.
    pub event: &'static str,
    /// Title of the case.
    pub title: String,
    /// `equilibrium`, `march` or `modes`.
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
    /// Mass of all bodies, per unit depth in the plane.
    pub mass: f64,
    /// Steps taken.
    pub steps: u64,
    /// Time reached.
    pub time: f64,
    /// Largest force that equilibrium left over the largest there is; absent elsewhere.
    pub residual: Option<f64>,
    /// Energies at the end, and what closes.
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

/// Energies of a structure, per unit depth in the plane.
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
#[derive(Clone, Debug, Serialize)]
pub struct ProbeRow {
    /// Its name.
    pub name: String,
    /// Its displacement.
    pub displacement: Vec<f64>,
}

/// A natural mode.
#[derive(Clone, Copy, Debug, Serialize)]
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

/// Where a study ended.
pub(super) struct Ending<'a> {
    pub(super) marched: &'a Marched,
    pub(super) modes: &'a [Mode],
    pub(super) clock: &'a Clock,
}

/// What is told at the end.
pub(super) fn summary<const D: usize>(study: &Study<'_, D>, ending: &Ending<'_>) -> SolidSummary {
    let (built, marched) = (study.built, ending.marched);
    let solid = &built.structure.solid;
    let name = match study.case.time {
        Temporal::Modes(_) => "modes",
        Temporal::Steady(_) => "equilibrium",
        _ => "march",
    };
    let mut warnings = built.warnings.clone();
    if marched.halved > 0 {
        warnings.push(format!("steps were halved {} times, where Newton's method did not get on", marched.halved));
    }
    let ledger = marched.rows.first().zip(marched.rows.last()).map(|(first, last)| ledger(first, last));
    let probe = |(k, (name, ..)): (usize, &(String, usize, crate::math::Vector<D>))| ProbeRow {
        name: name.clone(),
        displacement: marched.rows.last().map_or_else(Vec::new, |row| row.probes[k][..D].to_vec()),
    };
    let mode = |m: &Mode| ModeRow {
        frequency: m.omega / std::f64::consts::TAU,
        omega: m.omega,
        generalised_mass: m.generalised_mass,
        residual: m.left,
    };
    SolidSummary {
        event: "summary",
        title: study.case.title.clone(),
        study: name,
        converged: true,
        bodies: built.bodies.clone(),
        particles: solid.len(),
        neighbours: solid.particles.mean_neighbours(),
        correction: solid.particles.correction,
        mass: solid.mass().iter().sum(),
        steps: marched.iteration,
        time: if name == "march" { marched.time } else { 0.0 },
        residual: marched.residual,
        ledger,
        probes: built.probes.iter().enumerate().map(probe).collect(),
        modes: ending.modes.iter().map(mode).collect(),
        cpu_seconds: ending.clock.cpu_seconds(),
        wall_seconds: ending.clock.wall_seconds(),
        warnings,
    }
}

/// Energies between two moments.
pub(super) fn ledger(first: &Row, last: &Row) -> SolidLedger {
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
