//! What a structure alone tells at its end.
use super::super::record::work::Clock;
use super::fields::{history, snapshot};
use super::march::{Marched, Study};
use super::record::{ModeRow, ProbeRow, SolidSolution, SolidSummary, ledger};
use crate::case::Temporal;
use crate::math::Vector;
use crate::solid::modes::Mode;

/// Part of the energy that passed by which the ledger of a march may be open: beyond, results are doubtful; beyond the second, wrong.
const DOUBTFUL: f64 = 0.01;
const WRONG: f64 = 0.05;

/// Where a study ended.
pub(super) struct Ending<'a> {
    pub(super) marched: &'a Marched,
    pub(super) modes: &'a [Mode],
    pub(super) clock: &'a Clock,
}

/// What was found.
pub(super) fn solution<const D: usize>(study: &Study<'_, D>, ending: &Ending<'_>) -> SolidSolution {
    let (structure, marched) = (&study.built.structure, ending.marched);
    let (names, rows) = history(study.built, &marched.rows);
    let column = |(k, name): (usize, String)| (name, rows.iter().map(|row| row[k]).collect());
    let raised = |v: &[f64; D]| Vector(*v).to_3d();
    SolidSolution {
        summary: summary(study, ending),
        field: snapshot(&structure.solid, &structure.state(marched.time, &marched.state)),
        history: names.into_iter().enumerate().map(column).collect(),
        shapes: ending.modes.iter().map(|m| m.shape.as_chunks().0.iter().map(raised).collect()).collect(),
    }
}

/// What is told at the end.
fn summary<const D: usize>(study: &Study<'_, D>, ending: &Ending<'_>) -> SolidSummary {
    let (built, marched) = (study.built, ending.marched);
    let solid = &built.structure.solid;
    let name = match study.case.time {
        Temporal::Modes(_) => "modes",
        Temporal::Steady(_) => "equilibrium",
        Temporal::Harmonics(_) => "periodic",
        _ => "march",
    };
    let mut warnings = doubts(study, marched);
    let ledger = marched.rows.first().zip(marched.rows.last()).map(|(first, last)| ledger(first, last));
    let open = ledger.as_ref().filter(|_| ["march", "periodic"].contains(&name)).map_or(0.0, |l| l.open.abs());
    if open > DOUBTFUL {
        let (why, what) = match name {
            "march" => ("the march makes or loses energy", "take shorter steps (`cfl`, `step`)"),
            _ => ("loads and damping differ over a period", "take more harmonics (`number`) or `oversample = 2`"),
        };
        warnings.push(format!("the ledger of energy is open by {:.1} %: {why}; {what}", 100.0 * open));
    }
    let probe = |(k, (name, ..)): (usize, &(String, usize, Vector<D>))| {
        let periodic = marched.periodic.as_ref().map(|(_, probes)| probes[k].clone());
        let (mean, harmonics) = periodic.unwrap_or_default();
        let displacement = marched.rows.last().map_or_else(Vec::new, |row| row.probes[k][..D].to_vec());
        ProbeRow { name: name.clone(), displacement, mean, harmonics }
    };
    let mode = |m: &Mode| ModeRow {
        frequency: m.omega / std::f64::consts::TAU,
        omega: m.omega,
        generalised_mass: built.thickness * m.generalised_mass,
        residual: m.left,
    };
    SolidSummary {
        event: "summary",
        title: study.case.title.clone(),
        study: name,
        converged: open <= WRONG,
        bodies: built.bodies.clone(),
        particles: solid.len(),
        neighbours: solid.particles.mean_neighbours(),
        correction: solid.particles.correction,
        mass: built.thickness * solid.mass().iter().sum::<f64>(),
        steps: marched.iteration,
        time: if name == "march" { marched.time } else { 0.0 },
        residual: marched.residual,
        periodic: marched.periodic.as_ref().map(|(row, _)| *row),
        ledger,
        probes: built.probes.iter().enumerate().map(probe).collect(),
        modes: ending.modes.iter().map(mode).collect(),
        cpu_seconds: ending.clock.cpu_seconds(),
        wall_seconds: ending.clock.wall_seconds(),
        warnings,
    }
}

/// What makes results doubtful, but the ledger.
fn doubts<const D: usize>(study: &Study<'_, D>, marched: &Marched) -> Vec<String> {
    let mut warnings = study.built.warnings.clone();
    if marched.halved > 0 {
        warnings.push(format!("steps were halved {} times, where Newton's method did not get on", marched.halved));
    }
    if let (Temporal::Harmonics(plan), Some((row, _))) = (&study.case.time, &marched.periodic)
        && let Some(tail) = row.tail.filter(|t| *t > plan.tail)
    {
        warnings.push(format!("the last harmonic is {:.1} % of all: more are needed (`time.harmonics`)", 100.0 * tail));
    }
    warnings
}
