//! Structures of a case, attached to its bodies.
use std::path::Path;
use std::sync::Arc;

use super::error::RunError;
use super::files;
use super::reference::chord;
use super::solids::{NaturalModes, structure as natural_structure};
use crate::case::{Case, SolidProbe, StructureModel, Temporal, Units};
use crate::coupling::{Attached, body_motion};
use crate::geometry::Surface;
use crate::math::Vector;
use crate::motion::{ModeShape, Motions, mode_shape};
use crate::observe::structure::{CoordinateName, StructureNames};
use crate::structure::{BodyFrame, Coordinate, ForceHistory, Structure};

/// Axes by their names.
const AXES: [&str; 3] = ["x", "y", "z"];

/// A structure in words.
#[derive(Clone, Debug)]
pub(crate) struct Described {
    /// Its body and coordinates.
    pub(crate) names: StructureNames,
    /// Its conventions, numbers and frequencies.
    pub(crate) lines: Vec<String>,
}

/// The structures of a case, one after another, of which some move in natural `modes`; `motions` then hand their bodies over to them.
pub(crate) fn bodies<const D: usize>(
    (case, modes): (&Case, &NaturalModes),
    input: &Path,
    surface: Option<&Surface<D>>,
    motions: &mut Motions<D>,
) -> Result<Vec<Attached<D>>, RunError> {
    let Some(surface) = surface else { return Ok(Vec::new()) };
    let mut all: Vec<Attached<D>> = Vec::new();
    for body in 0..case.bodies.len() {
        let Some(data) = case.structure_of(body) else { continue };
        let frame = frame(case, surface, body);
        let (structure, shapes) = match modes.of_body(case, body) {
            Some(modes) => natural_structure::<D>(modes, &case.flow.units())?,
            None => {
                let read = |name: &str| files::text(input, name);
                let shapes = data.modes.iter().map(|mode| mode_shape(&mode.file, &read));
                (Structure::of_case(case, data, frame)?, shapes.collect::<Result<_, _>>()?)
            }
        };
        let shapes: Vec<Arc<ModeShape<D>>> = shapes.into_iter().map(Arc::new).collect();
        // a structure of no body by name moves all
        let alone = data.body.as_ref().map(|_| body);
        shapes.iter().try_for_each(|shape| super::modes::lies_on(surface, alone, shape))?;
        let shared = data.model == StructureModel::Floating;
        let first = all.last().filter(|_| !shared).map_or(0, |b| b.range().end);
        motions.free(body, body_motion(&structure, first, &shapes));
        let probes: Vec<_> =
            probes(case, body).map(|p| Vector::from_fn(|d| p.at.get(d).map_or(0.0, |x| x.0))).collect();
        let attached = Attached::new(structure, body, frame.chord, first, shapes).with_probes(&probes);
        all.push(attached);
    }
    if let Some(omega) = case.force_frequency(chord(case, Some(surface))).filter(|_| !all.is_empty()) {
        motions.force_with(case.flow.units().solver_time(std::f64::consts::TAU / omega));
    }
    Ok(all)
}

/// The structures with the constant forces `forces` on their coordinates, one after another, in the units of the case; none where there are no
/// forces.
pub(super) fn with_steady_forces<const D: usize>(
    structures: Vec<Attached<D>>,
    forces: &[f64],
    units: &Units,
) -> Result<Vec<Attached<D>>, RunError> {
    if forces.is_empty() {
        return Ok(structures);
    }
    let factor = 1.0 / units.pressure();
    let loaded = |mut attached: Attached<D>| -> Result<Attached<D>, RunError> {
        let own = &attached.structure;
        let on = |(k, c): (usize, &Coordinate)| match forces.get(attached.first + k) {
            Some(force) => Coordinate { force: ForceHistory::steady(factor * force), ..c.clone() },
            None => c.clone(),
        };
        let coordinates = own.coordinates().iter().enumerate().map(on).collect();
        attached.structure = Structure::new(own.model().clone(), coordinates)?;
        Ok(attached)
    };
    structures.into_iter().map(loaded).collect()
}

/// Points of a body that moves in own modes whose displacements are told.
fn probes(case: &Case, body: usize) -> impl Iterator<Item = &SolidProbe> {
    case.bodies[body].solid.iter().flat_map(|solid| &solid.probes)
}

/// The structures in words.
pub(crate) fn described<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    bodies: &[Attached<D>],
) -> Vec<Described> {
    let one = |attached: &Attached<D>| {
        let (surface, data) = (surface?, case.structure_of(attached.body)?);
        let structure = &attached.structure;
        let named =
            |k: usize| CoordinateName { name: structure.coordinates()[k].name.clone(), angle: structure.is_angle(k) };
        let axis = |name: &str, d: usize| CoordinateName { name: format!("{name}_{}", AXES[d]), angle: false };
        let told = probes(case, attached.body).flat_map(|p| (0..D).map(move |d| axis(&p.name, d)));
        let coordinates = (0..structure.len()).map(named).chain(told).collect();
        let names = StructureNames { body: surface.bodies[attached.body].clone(), coordinates, samples: false };
        let lines = structure.description(case, data, frame(case, surface, attached.body));
        Some(Described { names, lines })
    };
    Attached::distinct(bodies).filter_map(one).collect()
}

/// What the numbers of flutter are measured with.
pub(crate) fn frame<const D: usize>(case: &Case, surface: &Surface<D>, body: usize) -> BodyFrame {
    BodyFrame { chord: chord(case, Some(surface)), middle: surface.bounds_of(body).centre().to_3d() }
}

/// Refuses a steady flow beside a body that no spring holds: there is no equilibrium to find.
pub(crate) fn check_equilibrium<const D: usize>(
    case: &Case,
    surface: Option<&Surface<D>>,
    bodies: &[Attached<D>],
) -> Result<(), RunError> {
    let loose = bodies.iter().find(|b| matches!(case.time, Temporal::Steady(_)) && !b.is_held());
    let name = loose.zip(surface).map(|(b, surface)| &surface.bodies[b.body]);
    name.map_or(Ok(()), |name| Err(unheld(name)))
}

fn unheld(name: &str) -> RunError {
    RunError::Motion {
        what: format!("no spring holds the body `{name}`, so that it has no equilibrium in a steady flow"),
        hint: "give every coordinate a spring without free play, leave it out of `free`, or march with `[time.dual]`",
    }
}
