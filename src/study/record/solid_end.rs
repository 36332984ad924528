//! How bodies made of particles in a gas ended: what their probes did, and the greatest stress.
use super::super::solids::von_mises;
use super::log::Log;
use crate::coupling::SolidSnapshot;
use crate::record::summary::{ProbeEnd, SolidEnd};

/// What the table of a run and its last state tell.
pub(crate) fn solid_end<const D: usize>(at: &SolidSnapshot<'_, D>, log: &Log<'_>) -> SolidEnd {
    let stresses = von_mises(at.solid, &at.state());
    let worst = (0..stresses.len()).max_by(|a, b| stresses[*a].total_cmp(&stresses[*b]));
    SolidEnd {
        probes: probes::<D>(log),
        stress: worst.map_or(0.0, |i| stresses[i]),
        stress_at: worst.map_or_else(Vec::new, |i| at.solid.particles.x[i].0.to_vec()),
    }
}

fn probes<const D: usize>(log: &Log<'_>) -> Vec<ProbeEnd> {
    /// What the mean displacement of a body is called.
    const MEAN: &str = "mean";
    let mut columns = log.record.structures.coordinates.iter().map(|c| c.values.as_slice());
    let (mut means, mut probes) = (Vec::new(), Vec::new());
    for structure in &log.structures {
        let own: Vec<&[f64]> = columns.by_ref().take(structure.names.coordinates.len()).collect();
        let named = structure.names.coordinates.chunks(D).zip(own.chunks(D));
        for (names, along) in named.filter(|(_, along)| structure.names.samples && along.len() == D) {
            let name = names[0].name.trim_end_matches("_x");
            let steps = along.iter().map(|v| v.len()).min().unwrap_or(0);
            let distance = |k: usize| along.iter().map(|v| v[k] * v[k]).sum::<f64>().sqrt();
            let told = |name: &str| ProbeEnd {
                name: name.to_owned(),
                displacement: along.iter().map(|v| v.last().copied().unwrap_or(0.0)).collect(),
                farthest: (0..steps).map(distance).fold(0.0, f64::max),
            };
            if name == MEAN { means.push(told(&structure.names.body)) } else { probes.push(told(name)) }
        }
    }
    if probes.is_empty() { means } else { probes }
}
