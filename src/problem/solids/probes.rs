//! Probes: points of bodies made of particles whose displacements are told.
//!
//! The displacement of a probe is that of the particle nearest to it, and the gradient there times how far it is away. Within the body that
//! is less than a spacing; what is far outside would be told of points where there is nothing.
use super::super::error::RunError;
use super::filling::Part;
use crate::math::{Bounds, Vector};
use crate::solid::particles::Particles;

/// Greatest distance of a probe from the nearest particle, in spacings: 0.87 within a lattice in space, so that this is two thirds of a
/// spacing outside a face and more beside an edge.
const REACH: f64 = 1.5;
/// Distance from the surface beyond which a probe that is outside is told of, in spacings: particles lie on chords of curved surfaces.
const BESIDE: f64 = 0.25;

/// A probe: its name, the nearest particle and its place.
pub(super) type Probe<const D: usize> = (String, usize, Vector<D>);

/// The probes of all bodies, and what makes those doubtful that are beside their body. Refuses those that are far from it.
pub(super) fn probes<const D: usize>(
    parts: &[Part<'_, D>],
    particles: &Particles<D>,
    owner: &[u16],
) -> Result<(Vec<Probe<D>>, Vec<String>), RunError> {
    let (mut all, mut doubts) = (Vec::new(), Vec::new());
    for (k, part) in parts.iter().enumerate() {
        let own: Vec<usize> = (0..particles.len()).filter(|i| usize::from(owner[*i]) == k).collect();
        for probe in &part.plan.data.probes {
            let at = Vector::from_fn(|d| probe.at.get(d).map_or(0.0, |x| x.0));
            let away = |i: &usize| (particles.x[*i] - at).norm();
            let Some(i) = own.iter().copied().min_by(|a, b| away(a).total_cmp(&away(b))) else { continue };
            let spacing = particles.spacing[i];
            if !(away(&i) <= REACH * spacing) {
                let bounds = Bounds::around(&own.iter().map(|i| particles.x[*i]).collect::<Vec<_>>());
                return Err(far((&probe.name, &at), &part.plan.name, away(&i), spacing, &bounds));
            }
            if let Some(beside) = beside(part, &at).filter(|d| *d > BESIDE * spacing) {
                doubts.push(format!(
                    "probe `{}` is {beside:.3e} outside `{}`, {:.2} spacings: its displacement is continued from there",
                    probe.name,
                    part.plan.name,
                    beside / spacing
                ));
            }
            all.push((probe.name.clone(), i, at));
        }
    }
    Ok((all, doubts))
}

/// Distance of a point outside a body from its surface; `None` inside.
fn beside<const D: usize>(part: &Part<'_, D>, at: &Vector<D>) -> Option<f64> {
    let surface = &part.plan.surface;
    if surface.inside(at) {
        return None;
    }
    surface.nearest(at, 2.0 * REACH * part.fill.spacing).map(|near| near.distance)
}

/// The refusal of a probe that is far from its body.
fn far<const D: usize>(
    (probe, at): (&str, &Vector<D>),
    body: &str,
    away: f64,
    spacing: f64,
    bounds: &Bounds<D>,
) -> RunError {
    let place = (0..D).map(|d| format!("{:.6}", at[d])).collect::<Vec<_>>().join(", ");
    let side = |d: usize| format!("{} from {:.6} to {:.6}", ["x", "y", "z"][d], bounds.min[d], bounds.max[d]);
    RunError::Solid {
        what: format!(
            "probe `{probe}` at ({place}) is not in `{body}`: its nearest particle is {away:.3e} away, {:.1} spacings",
            away / spacing
        ),
        hint: format!(
            "take a point of the body, at most {REACH} spacings from its particles: it has {}",
            (0..D).map(side).collect::<Vec<_>>().join(", ")
        ),
    }
}
