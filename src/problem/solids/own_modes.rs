//! Bodies made of particles of which a few natural modes move: found before a run, they are the modes of a modal structure.
use std::path::Path;

use super::super::error::RunError;
use super::build::{Built, Filling};
use super::natural::{Found, NaturalMode, NaturalModes};
use super::spline_modes::spline_modes;
use crate::case::{Case, ModeTable, StructureModel};
use crate::geometry::dimension;
use crate::math::Vector;
use crate::solid::modes::{Mode, ModeRequest, modes};

/// Modes that move unless the case says otherwise.
const USUAL: u32 = 4;
/// Most points that a shape is carried by: the interpolation solves a full system with as many unknowns.
const MOST_POINTS: usize = 1000;

/// The own modes of all bodies of a case that move in such.
pub(crate) fn own_modes(case: &Case, input: &Path) -> Result<NaturalModes, RunError> {
    let of_body = |body: usize| {
        let own = case.structure_of(body).filter(|own| own.model == StructureModel::OwnModes);
        let Some(own) = own else { return Ok(Vec::new()) };
        let count = own.number.unwrap_or(USUAL) as usize;
        match dimension(case) {
            2 => found(&Filling::of(case, input).of_body_at_rest(body), count),
            _ => spline_modes(case, input, body, count),
        }
    };
    (0..case.bodies.len()).map(of_body).collect::<Result<_, _>>().map(NaturalModes::new)
}

fn found(filling: &Filling<'_>, count: usize) -> Result<Vec<NaturalMode>, RunError> {
    let built = filling.build::<2>()?;
    let structure = &built.structure;
    filling.remembers(&built)?;
    let still = structure.start(|_| [0.0; 2]);
    let wanted = ModeRequest { count, above: 0.0 };
    let all = modes(structure, &still, &wanted)
        .map_err(|e| RunError::Solid { what: e.to_string(), hint: "see the guide `solids`".into() })?;
    let points = points(&built);
    Ok(all.iter().map(|mode| of_particles(&built, &points, mode).into()).collect())
}

/// Particles of the surface that carry the shapes: all, or every so many.
fn points(built: &Built<2>) -> Vec<usize> {
    let particles = &built.structure.solid.particles;
    let skin: Vec<usize> = (0..particles.len()).filter(|i| particles.area[*i] != Vector::ZERO).collect();
    let every = skin.len().div_ceil(MOST_POINTS);
    skin.into_iter().step_by(every).collect()
}

/// A mode of particles.
fn of_particles(built: &Built<2>, points: &[usize], mode: &Mode) -> Found {
    let solid = &built.structure.solid;
    let shape: &[[f64; 2]] = mode.shape.as_chunks().0;
    let along = |v: &dyn Fn(usize) -> [f64; 2]| -> f64 {
        let one = |i: usize| Vector(v(i)).dot(&Vector(shape[i])) * solid.mass()[i];
        (0..solid.len()).map(one).sum()
    };
    let raised = |v: &[f64; 2]| [v[0], v[1], 0.0];
    Found {
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
}
