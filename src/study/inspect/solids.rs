//! What would be computed of a structure alone: what `check` tells.
use std::path::Path;

use serde::Serialize;

use super::super::solids::possible;
use super::trial;
use crate::case::{Case, Temporal};
use crate::geometry::dimension;
use crate::problem::RunError;
use crate::problem::solids::{Built, Expected, Filling, supported};
use crate::solid::forces::State;
use crate::solid::{Plane, Support};
use crate::system::Mechanical;

/// Particles through the thickness of such a body at least.
const THROUGH: f64 = 8.0;
/// Particles beyond which a body with fewer is looked at: a second or two to build.
const QUICK: f64 = 60_000.0;

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
    /// Greatest memory of a process that studies the structure alone.
    pub bytes: f64,
    /// Seconds that its march takes on this machine, at least so many where `more_steps` is true; absent elsewhere.
    pub seconds: Option<f64>,
    /// Factor on the distance of particles of the bodies that all but their number was seen on, where theirs are very many.
    pub seen_on: Option<f64>,
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
    let expected = Filling::of(case, input).expected::<D>()?;
    let (factor, filling, built) = sample(Filling::of(case, input), &expected)?;
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
    let stable_step = structure.stable_step(&vec![0.0; n * D]) / factor;
    let (steps, more_steps, seconds) = pace(case, (filling, &built), factor, stable_step);
    let mut warnings = built.warnings;
    // a body of revolution moves as a whole along its axis alone
    let holds = |s: &Support<D>| solid.plane != Plane::Axisymmetric || s.fixed[1];
    if matches!(case.time, Temporal::Steady(_)) && !solid.supports.iter().any(holds) {
        warnings.push("nothing holds the structure: it has no equilibrium but where all forces cancel".into());
    }
    let (least, most) =
        solid.particles.spacing.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), h| (a.min(*h), b.max(*h)));
    Ok(SolidReport {
        particles: if factor > 1.0 { expected.particles.round() as usize } else { n },
        neighbours: solid.particles.mean_neighbours(),
        correction: solid.particles.correction,
        spacing: [least / factor, most / factor],
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
        bytes: expected.bytes,
        seconds,
        seen_on: (factor > 1.0).then_some(factor),
        warnings,
    })
}

/// The bodies that are looked at: those of the case, or with some times the distance of particles where theirs are very many.
fn sample<'a, const D: usize>(own: Filling<'a>, expected: &Expected) -> Result<(f64, Filling<'a>, Built<D>), RunError> {
    let factor = (expected.particles / QUICK).powf(1.0 / D as f64).min(expected.through / THROUGH);
    if factor > 1.0 {
        let filling = own.coarser(factor);
        // what fewer particles have no place for, as a load on a small part of the surface, more may have
        if let Ok(built) = filling.build::<D>() {
            return Ok((factor, filling, built));
        }
    }
    Ok((1.0, own, own.build::<D>()?))
}

/// Steps of the march of a case, whether there are at least so many, and seconds of an explicit one; of the bodies `built`, which have `factor` times the
/// distance of particles of the case, whose longest explicit step is `stable_step`.
fn pace<const D: usize>(
    case: &Case,
    (filling, built): (Filling<'_>, &Built<D>),
    factor: f64,
    stable_step: f64,
) -> (Option<f64>, bool, Option<f64>) {
    match &case.time {
        // the step of the gas is another one
        Temporal::Explicit(e) if case.has_gas() => (e.until.map(|until| until.0 / (e.cfl * stable_step)), true, None),
        Temporal::Newmark(n) => (Some(n.until.0 / n.step.0), false, None),
        _ => match trial::steps((case, filling), built) {
            // there are more steps of more particles where these are nearer to one another
            Some(s) => (Some(factor * s.number), !s.is_known, Some(factor.powi(D as i32 + 1) * s.seconds)),
            None => (None, false, None),
        },
    }
}
