//! Bodies made of particles in the gas of a case.
use std::path::Path;
use std::sync::Arc;

use super::error::RunError;
use super::remark::Remark;
use super::solids::{Built, Filling};
use super::structures::Described;
use crate::case::{Case, Temporal};
use crate::coupling::solids::{Scales, SolidBody, Solids};
use crate::motion::{Motions, SurfaceNet};
use crate::observe::structure::{CoordinateName, StructureNames};

/// Axes by their names.
const AXES: [&str; 3] = ["x", "y", "z"];

/// Bodies made of particles.
pub(super) struct Filled<const D: usize> {
    /// The bodies.
    pub(super) solids: Arc<Solids<D>>,
    /// Each in words.
    pub(super) described: Vec<Described>,
    /// What is worth telling of them.
    pub(super) remarks: Vec<Remark>,
}

/// The bodies of a case that are made of particles, after `first` coordinates of others; `motions` then
/// hand these bodies over to their particles.
pub(super) fn fill<const D: usize>(
    case: &Case,
    input: &Path,
    first: usize,
    motions: &mut Motions<D>,
) -> Result<Option<Filled<D>>, RunError> {
    if case.solids().next().is_none() {
        return Ok(None);
    }
    let filling = Filling::of(case, input);
    let built = filling.build::<D>()?;
    let notes = built.notes.iter().cloned().map(Remark::Note);
    let remarks = notes.chain(built.warnings.iter().cloned().map(Remark::Warning)).collect();
    filling.remembers(&built)?;
    let mut bodies = Vec::new();
    for (k, (number, _, _)) in case.solids().enumerate() {
        let body = body(&built, (k, number), first, motions);
        let law = motions.of(number).clone();
        motions.free(number, law.with_net(Arc::clone(&body.net)));
        bodies.push(body);
    }
    let described = described(case, &built, &bodies);
    let units = case.flow.units();
    let scales = Scales { speed: units.speed, pressure: units.pressure() };
    let Built { structure, velocity, .. } = built;
    let solids = Solids::new(structure, bodies, scales, first).with_velocity(&velocity);
    if matches!(case.time, Temporal::Steady(_)) && !solids.are_held() {
        return Err(RunError::Solid {
            what: "no support holds a body made of particles, so that it has no equilibrium in a steady flow".into(),
            hint: "add `[[body.solid.support]]`, or march with `[time.dual]` or `[time.explicit]`".into(),
        });
    }
    Ok(Some(Filled { solids: Arc::new(solids), described, remarks }))
}

/// Body number `k` of the structure, which is body `number` of the case.
fn body<const D: usize>(
    built: &Built<D>,
    (k, number): (usize, usize),
    first: usize,
    motions: &Motions<D>,
) -> SolidBody<D> {
    let particles = &built.structure.solid.particles;
    let own = |i: &usize| usize::from(built.structure.solid.body[*i]) == k;
    let all: Vec<usize> = (0..particles.len()).filter(own).collect();
    let range = all.first().copied().unwrap_or(0)..all.last().map_or(0, |i| i + 1);
    // those on the surface come first; the areas at the edge of a thin body may cancel
    let corners = particles.facets.iter().flat_map(|f| f.corners()).map(|i| *i as usize);
    let nodes = range.start..corners.filter(|i| range.contains(i)).max().map_or(range.start, |i| i + 1);
    let (place, area) = (particles.x[nodes.clone()].to_vec(), &built.wetted[nodes.clone()]);
    let net = SurfaceNet::new(first + D * range.start, place, area, particles.spacing[range.start]);
    let law = motions.of(number);
    let probes = built.probes.iter().map(|p| p.1).filter(|i| range.contains(i)).collect();
    SolidBody {
        body: number,
        particles: range,
        net: Arc::new(net),
        lead: (!law.is_fixed()).then(|| law.clone()),
        probes,
    }
}

/// The bodies in words: the mean displacement of each, and those of its probes.
fn described<const D: usize>(case: &Case, built: &Built<D>, bodies: &[SolidBody<D>]) -> Vec<Described> {
    let one = |(k, body): (usize, &SolidBody<D>)| {
        let along = |name: &str| AXES[..D].iter().map(|a| format!("{name}_{a}")).collect::<Vec<_>>();
        let named = built.probes.iter().filter(|p| body.particles.contains(&p.1));
        let names = along("mean").into_iter().chain(named.flat_map(|p| along(&p.0)));
        let coordinates = names.map(|name| CoordinateName { name, angle: false }).collect();
        let names = StructureNames { body: built.bodies[k].clone(), coordinates, samples: true };
        let density = case.flow.units().density;
        let mass: f64 = body.particles.clone().map(|i| built.structure.solid.mass()[i]).sum();
        let volume: f64 = body.particles.clone().map(|i| built.structure.solid.particles.volume[i]).sum();
        let lines = vec![
            format!("{} particles, {} of them on the surface", body.particles.len(), body.net.len()),
            format!("mass {mass:.6e}, {:.4} times that of the gas it displaces", mass / (density * volume)),
            "mean: mass-weighted mean displacement; loads are the forces of the gas".to_owned(),
        ];
        Described { names, lines }
    };
    bodies.iter().enumerate().map(one).collect()
}
