//! What makes the loads of a finished run doubtful.
use super::solids::von_mises;
use crate::case::Case;
use crate::coupling::SolidSnapshot;
use crate::geometry::Surface;
use crate::observe::convergence::LEAST;
use crate::problem;
use crate::problem::spacing;
use crate::record::summary::Summary;

/// Part of a load that its two evaluations may differ by.
const DISAGREEMENT: f64 = 0.05;
/// Negative drag without viscosity that rounding and the cloud may leave: a count.
const NEGATIVE_DRAG: f64 = -1e-4;

/// What is to be said of the loads on the cloud that they are told of, the last of a family where there is one, and of bodies made of
/// particles; `largest` are lift and drag at their greatest in a march.
pub(crate) fn told<const D: usize>(
    case: &Case,
    (s, surface): (&Summary, Option<&Surface<D>>),
    largest: [f64; 2],
    solid: Option<&SolidSnapshot<'_, D>>,
) -> Vec<String> {
    let rough = spacing::asked(case).map_or_else(Vec::new, |_| problem::rough(&s.conditions.cloud, surface));
    of_loads(case, s, largest).into_iter().chain(rough).chain(solid.and_then(of_solid)).collect()
}

/// What is to be said of the loads of a steady flow, or at the end of a march.
fn of_loads(case: &Case, s: &Summary, largest: [f64; 2]) -> Vec<String> {
    let marched = s.is_march();
    if (case.is_unsteady() && !marched) || !s.succeeded() {
        return Vec::new();
    }
    let mut doubts = Vec::new();
    let finer = match case.accuracy.filter(|_| !marched) {
        Some(_) => "allow more `accuracy.particles`",
        None => "take a finer `spacing` or more `layers`",
    };
    let wall = s.loads.total;
    if let Some(through) = s.loads.momentum_balance {
        // a load of a march may pass through zero
        let pairs = [
            ("CL", wall.cl, through.cl, LEAST[0].max(largest[0])),
            ("CD", wall.cd, through.cd, LEAST[1].max(largest[1])),
        ];
        for (name, wall, through, least) in pairs {
            let part = (wall - through).abs() / wall.abs().max(through.abs()).max(least);
            if part >= DISAGREEMENT {
                let of = if marched { " of the greatest" } else { "" };
                doubts.push(format!(
                    "{name} is {wall:.5} by wall pressure and {through:.5} by momentum, {:.0} %{of} apart: the cloud is too coarse for it \
                     near the bodies or around them; {finer}",
                    100.0 * part
                ));
            }
        }
    }
    if marched {
        return doubts;
    }
    let allowed = NEGATIVE_DRAG - s.grid.loads_error.map_or(0.0, |bar| bar.cd);
    if !case.flow.is_viscous() && wall.cd < allowed {
        doubts.push(format!(
            "the drag of a gas without viscosity is negative, CD {:.5}: the cloud is too coarse for it; {finer}",
            wall.cd
        ));
    }
    doubts
}

/// Where a metal that is computed as elastic would have yielded.
fn of_solid<const D: usize>(at: &SolidSnapshot<'_, D>) -> Option<String> {
    let part = |(i, stress): (usize, f64)| Some((i, stress, stress / at.solid.material_of(i).elastic_limit?));
    let all = von_mises(at.solid, &at.state()).into_iter().enumerate().filter_map(part);
    let (i, stress, _) = all.max_by(|a, b| a.2.total_cmp(&b.2)).filter(|(.., part)| *part > 1.0)?;
    Some(format!(
        "the metal at {} would have yielded: von Mises stress {stress:.3e} of an elastic one; march with `[time.dual]`",
        at.solid.particles.x[i]
    ))
}
