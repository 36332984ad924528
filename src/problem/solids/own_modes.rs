//! Bodies made of particles of which a few natural modes move: found before a run, they are the modes of a modal structure.
use std::path::Path;

use super::super::error::RunError;
use super::build::{Built, build, remembers};
use super::natural::Natural;
use super::spline_modes::spline_modes;
use crate::case::{Case, ModeTable, Steady, Structure, StructureMode, StructureModel, Temporal};
use crate::geometry::dimension;
use crate::math::Vector;
use crate::solid::modes::{Mode, ModeRequest, modes};

/// Modes that move unless the case says otherwise.
const USUAL: u32 = 4;
/// Most points that a shape is carried by: the interpolation solves a full system with as many unknowns.
const MOST_POINTS: usize = 1000;

/// The case with the own modes of its bodies, which are looked for where they are not there yet.
pub(crate) fn with_own_modes(case: &Case, input: &Path) -> Result<Case, RunError> {
    let mut filled = case.clone();
    for body in 0..case.bodies.len() {
        let Some(own) = case.structure_of(body) else { continue };
        if own.model != StructureModel::OwnModes || !own.modes.is_empty() {
            continue;
        }
        let count = own.number.unwrap_or(USUAL) as usize;
        let alone = alone(case, body);
        let found = match dimension(case) {
            2 => found(&alone, input, count)?,
            _ => spline_modes(&alone, input, body, count)?,
        };
        let place = case.structures.iter().position(|s| std::ptr::eq(s, own));
        place.into_iter().for_each(|k| filled.structures[k].modes.clone_from(&found));
    }
    Ok(filled)
}

/// The own modes of all bodies in words.
pub(crate) fn told_of_own_modes(case: &Case) -> Vec<String> {
    let of = |own: &Structure| {
        let all: Vec<&str> = own.modes.iter().map(|m| m.told.as_str()).collect();
        format!("own modes, cycles per unit of time: {}", all.join(", "))
    };
    case.structures.iter().filter(|s| s.model == StructureModel::OwnModes).map(of).collect()
}

/// The case with the particles of one body alone.
fn alone(case: &Case, body: usize) -> Case {
    let mut alone = case.clone();
    alone.structures.clear();
    // modes last as steady states do, whatever is computed with them
    alone.time = Temporal::Steady(Steady::default());
    let others = alone.bodies.iter_mut().enumerate().filter(|(k, _)| *k != body);
    others.for_each(|(_, other)| other.solid = None);
    alone
}

fn found(alone: &Case, input: &Path, count: usize) -> Result<Vec<StructureMode>, RunError> {
    let built = build::<2>(alone, input)?;
    let structure = &built.structure;
    remembers(alone, &built)?;
    let still = structure.start(|_| [0.0; 2]);
    let wanted = ModeRequest { count, above: 0.0 };
    let all = modes(structure, &still, &wanted)
        .map_err(|e| RunError::Solid { what: e.to_string(), hint: "see the guide `solids`".into() })?;
    let points = points(&built);
    Ok(all.iter().enumerate().map(|(k, mode)| of_particles(&built, &points, (k, mode))).collect())
}

/// Particles of the surface that carry the shapes: all, or every so many.
fn points(built: &Built<2>) -> Vec<usize> {
    let particles = &built.structure.solid.particles;
    let skin: Vec<usize> = (0..particles.len()).filter(|i| particles.area[*i] != Vector::ZERO).collect();
    let every = skin.len().div_ceil(MOST_POINTS);
    skin.into_iter().step_by(every).collect()
}

/// A mode of particles as the case would have it from a file.
fn of_particles(built: &Built<2>, points: &[usize], (k, mode): (usize, &Mode)) -> StructureMode {
    let solid = &built.structure.solid;
    let shape: &[[f64; 2]] = mode.shape.as_chunks().0;
    let along = |v: &dyn Fn(usize) -> [f64; 2]| -> f64 {
        let one = |i: usize| Vector(v(i)).dot(&Vector(shape[i])) * solid.mass()[i];
        (0..solid.len()).map(one).sum()
    };
    let raised = |v: &[f64; 2]| [v[0], v[1], 0.0];
    Natural {
        omega: mode.omega,
        mass: mode.generalised_mass,
        weight: along(&|_| solid.gravity.0),
        momentum: along(&|i| built.velocity[i]),
        damping: [solid.damping.mass, solid.damping.stiffness],
        error: None,
        table: ModeTable {
            points: points.iter().map(|i| raised(&solid.particles.x[*i].0)).collect(),
            displacements: points.iter().map(|i| raised(&shape[*i])).collect(),
        },
    }
    .into_mode(k)
}
