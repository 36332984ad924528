//! Bodies made of particles of which a few natural modes move: found before a run, they are the modes of a modal structure.
use std::path::Path;

use super::super::error::RunError;
use super::setup::{Built, build, remembers};
use crate::case::{Case, ModeTable, Steady, Structure, StructureMode, StructureModel, Temporal};
use crate::geometry::dimension;
use crate::math::Vector;
use crate::solid::modes::{Mode, Wanted, modes};

/// Modes that move unless the case says otherwise.
const USUAL: u32 = 4;
/// Most points that a shape is carried by: the interpolation solves a full system with as many unknowns.
const MOST_POINTS: usize = 1000;

/// The case with the own modes of its bodies, which are looked for where they are not there yet.
pub(in super::super) fn with_own_modes(case: &Case, input: &Path) -> Result<Case, RunError> {
    let mut filled = case.clone();
    for body in 0..case.bodies.len() {
        let Some(own) = case.structure_of(body) else { continue };
        if own.model != StructureModel::OwnModes || !own.modes.is_empty() {
            continue;
        }
        let count = own.number.unwrap_or(USUAL) as usize;
        let alone = alone(case, body);
        let found = match dimension(case) {
            2 => found::<2>(&alone, input, count)?,
            _ => found::<3>(&alone, input, count)?,
        };
        let place = case.structures.iter().position(|s| std::ptr::eq(s, own));
        place.into_iter().for_each(|k| filled.structures[k].modes.clone_from(&found));
    }
    Ok(filled)
}

/// The own modes of all bodies in words.
pub(in super::super) fn told_of_own_modes(case: &Case) -> Vec<String> {
    let of = |own: &Structure| {
        let one = |m: &StructureMode| {
            let omega = (m.stiffness.unwrap_or(0.0) / m.mass).sqrt();
            format!("{:.5e} (generalised mass {:.4e})", omega / std::f64::consts::TAU, m.mass)
        };
        let all: Vec<String> = own.modes.iter().map(one).collect();
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

fn found<const D: usize>(alone: &Case, input: &Path, count: usize) -> Result<Vec<StructureMode>, RunError> {
    let built = build::<D>(alone, input)?;
    let structure = &built.structure;
    remembers(alone, &built)?;
    let still = structure.start(|_| [0.0; D]);
    let wanted = Wanted { count, above: 0.0 };
    let all = modes(structure, &still, &wanted)
        .map_err(|e| RunError::Solid { what: e.to_string(), hint: "see the guide `solids`".into() })?;
    let points = points(&built);
    Ok(all.iter().enumerate().map(|(k, mode)| as_data(&built, &points, (k, mode))).collect())
}

/// Particles of the surface that carry the shapes: all, or every so many.
fn points<const D: usize>(built: &Built<D>) -> Vec<usize> {
    let particles = &built.structure.solid.particles;
    let skin: Vec<usize> = (0..particles.len()).filter(|i| particles.area[*i] != Vector::ZERO).collect();
    let every = skin.len().div_ceil(MOST_POINTS);
    skin.into_iter().step_by(every).collect()
}

/// A mode as the case would have it from a file. Damping in proportion to mass and stiffness is ζ = α/(2ω) + βω/2; the velocity
/// at the start and gravity are their parts along the mode.
fn as_data<const D: usize>(built: &Built<D>, points: &[usize], (k, mode): (usize, &Mode)) -> StructureMode {
    let solid = &built.structure.solid;
    let shape: &[[f64; D]] = mode.shape.as_chunks().0;
    let along = |v: &dyn Fn(usize) -> [f64; D]| -> f64 {
        let one = |i: usize| Vector(v(i)).dot(&Vector(shape[i])) * solid.mass()[i];
        (0..solid.len()).map(one).sum()
    };
    let (mass, omega, damping) = (mode.generalised_mass, mode.omega, &solid.damping);
    let weight = along(&|_| solid.gravity.0);
    let raised = |v: &[f64]| -> [f64; 3] { std::array::from_fn(|a| v.get(a).copied().unwrap_or(0.0)) };
    StructureMode {
        name: format!("mode-{}", k + 1),
        file: String::new(),
        mass,
        frequency: None,
        reduced_frequency: None,
        stiffness: Some(mass * omega * omega),
        damping_ratio: if omega > 0.0 { 0.5 * (damping.mass / omega + damping.stiffness * omega) } else { 0.0 },
        cubic: 0.0,
        free_play: 0.0,
        initial: 0.0,
        initial_rate: along(&|i| built.velocity[i]) / mass,
        force: (weight != 0.0).then(|| format!("{weight:?}")),
        table: Some(ModeTable {
            points: points.iter().map(|i| raised(&solid.particles.x[*i].0)).collect(),
            displacements: points.iter().map(|i| raised(&shape[*i])).collect(),
        }),
    }
}
