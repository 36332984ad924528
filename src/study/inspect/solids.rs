//! What would be computed of a structure alone: what `check` tells.
use std::path::Path;

use serde::Serialize;

use super::super::solids::possible;
use super::trial;
use crate::case::{Case, Temporal};
use crate::geometry::dimension;
use crate::problem::RunError;
use crate::problem::solids::{Filling, supported};
use crate::solid::forces::State;
use crate::solid::{Plane, Support};
use crate::system::Mechanical;

/// A structure of particles before it is computed, in SI units; in the plane of the thickness of the case, of a whole turn about an axis.
#[derive(Clone, Debug, Serialize)]
pub struct SolidReport {
    /// Solid particles.
    pub particles: usize,
    /// Mean number of neighbours.
    pub neighbours: f64,
    /// Rms part of the gradients' weights that the divergence theorem changed.
    pub correction: f64,
    /// Smallest and largest distance of neighbours.
    pub spacing: [f64; 2],
    /// Bodies.
    pub bodies: Vec<String>,
    /// Mass.
    pub mass: f64,
    /// Particles that each support holds.
    pub held: Vec<usize>,
    /// Area at rest that each load acts on.
    pub loaded: Vec<f64>,
    /// Forces of loads and gravity at the start, added up.
    pub force: Vec<f64>,
    /// Speed of pressure waves in each material.
    pub wave_speeds: Vec<f64>,
    /// Longest step of an explicit march.
    pub stable_step: f64,
    /// Steps that the march takes, about, or at least; absent elsewhere.
    pub steps: Option<f64>,
    /// True where `steps` are at least so many: a trial of an explicit march was not over soon.
    pub more_steps: bool,
    /// What makes results doubtful.
    pub warnings: Vec<String>,
}

/// Builds the structure of a case and tells what it is.
pub fn inspect_structure(case: &Case, input: &Path) -> Result<SolidReport, RunError> {
    supported(case)?;
    match dimension(case) {
        2 => report::<2>(case, input),
        _ => report::<3>(case, input),
    }
}

/// What the bodies made of particles in a gas are; `None` where there are none.
pub(super) fn inspect_in_gas(case: &Case, input: &Path) -> Result<Option<SolidReport>, RunError> {
    case.solids().next().is_some().then(|| inspect_structure(case, input)).transpose()
}

fn report<const D: usize>(case: &Case, input: &Path) -> Result<SolidReport, RunError> {
    let filling = Filling::of(case, input);
    let built = filling.build::<D>()?;
    if case.has_gas() {
        filling.remembers(&built)?;
    } else if let Temporal::Harmonics(plan) = &case.time {
        possible(&built, plan)?;
    }
    let structure = &built.structure;
    let (solid, n) = (&structure.solid, structure.solid.len());
    let still = vec![[0.0; D]; n];
    let history = solid.virgin();
    let state = State { time: 0.0, step: 0.0, displacement: &still, velocity: &still, history: &history };
    let mut force = vec![[0.0; D]; n];
    solid.all_outside(&state, &mut force);
    let stable_step = structure.stable_step(&vec![0.0; n * D]);
    let (steps, more_steps) = match &case.time {
        // the step of the gas is another one
        Temporal::Explicit(e) if case.has_gas() => (e.until.map(|until| until.0 / (e.cfl * stable_step)), true),
        Temporal::Newmark(n) => (Some(n.until.0 / n.step.0), false),
        _ => trial::steps((case, filling), &built).map_or((None, false), |s| (Some(s.number), !s.is_known)),
    };
    let mut warnings = built.warnings;
    // a body of revolution moves as a whole along its axis alone
    let holds = |s: &Support<D>| solid.plane != Plane::Axisymmetric || s.fixed[1];
    if matches!(case.time, Temporal::Steady(_)) && !solid.supports.iter().any(holds) {
        warnings.push("nothing holds the structure: it has no equilibrium but where all forces cancel".into());
    }
    let spacing = &solid.particles.spacing;
    Ok(SolidReport {
        particles: n,
        neighbours: solid.particles.mean_neighbours(),
        correction: solid.particles.correction,
        spacing: [
            spacing.iter().fold(f64::INFINITY, |a, b| a.min(*b)),
            spacing.iter().fold(0.0, |a: f64, b| a.max(*b)),
        ],
        bodies: built.bodies,
        mass: built.thickness * solid.mass().iter().sum::<f64>(),
        held: solid.supports.iter().map(|s| s.particles.len()).collect(),
        loaded: solid
            .loads
            .iter()
            .map(|l| built.thickness * l.areas.iter().map(|(_, a)| a.norm()).sum::<f64>())
            .collect(),
        force: (0..D).map(|d| built.thickness * force.iter().map(|f| f[d]).sum::<f64>()).collect(),
        wave_speeds: solid.materials.iter().map(|m| m.pressure_wave_speed()).collect(),
        stable_step,
        steps,
        more_steps,
        warnings,
    })
}
