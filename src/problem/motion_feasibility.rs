//! What the motion of bodies will ask of a cloud, told before a run.
//!
//! Interface particles are carried along the laws of motion to the times of the steps, or of [`TIMES`] parts of the march.
//! Bodies that leave the domain or run into one another are refused with place and time; steps in which a body moves by more
//! than its spacing are noted, with the number of steps that would do.
use super::error::RunError;
use super::numerics;
use crate::case::{Case, ParticleMotion, Units};
use crate::cloud::Cloud;
use crate::math::{Bounds, Vector};
use crate::motion::{Motions, PointTrajectory};

/// Times at which bodies are looked at, at most.
const TIMES: usize = 512;
/// Points of a body that distances to others are measured from.
const POINTS: usize = 400;
/// Gap between two bodies that particles still fit into, in spacings of their walls.
const GAP: f64 = 0.5;

/// One body with the interface particles that lie in the domain.
struct Body<'a, const D: usize> {
    name: String,
    points: Vec<(&'a Vector<D>, f64)>,
    trajectory: PointTrajectory<D>,
}

/// Looks at the whole march; what is worth knowing, or why it cannot be done.
pub(crate) fn check<const D: usize>(
    case: &Case,
    cloud: &Cloud<D>,
    motions: &Motions<D>,
) -> Result<Vec<String>, RunError> {
    let period = motions.period();
    let Some(end) = case.end(period).filter(|_| motions.moves() && !cloud.interface.is_empty()) else {
        return Ok(Vec::new());
    };
    let (bodies, units) = (bodies(case, cloud, motions), case.flow.units());
    let span = period.map_or(end, |p| p.min(end));
    if case.particles() != ParticleMotion::Rigid {
        for k in 0..=TIMES {
            let t = span * k as f64 / TIMES as f64;
            stays_inside(&bodies, &cloud.tree.bounds(), t, &units)?;
            keeps_apart(&bodies, t, &units)?;
        }
    }
    Ok(longest_way(case, &bodies, (period, span)).into_iter().collect())
}

fn bodies<'a, const D: usize>(case: &Case, cloud: &'a Cloud<D>, motions: &Motions<D>) -> Vec<Body<'a, D>> {
    let named = |b: usize| case.bodies[b].name.clone().unwrap_or_else(|| format!("body {}", b + 1));
    let points = |b: usize| {
        let own = cloud.interface_range().zip(&cloud.interface).filter(|(_, w)| usize::from(w.body) == b);
        own.map(|(i, _)| (&cloud.x[i], cloud.spacing[i])).collect::<Vec<_>>()
    };
    let body = |b: usize| {
        let points = points(b);
        let places: Vec<Vector<D>> = points.iter().map(|(x, _)| **x).collect();
        Body { name: named(b), trajectory: PointTrajectory::new(motions.of(b), &places), points }
    };
    (0..case.bodies.len()).map(body).collect()
}

fn stays_inside<const D: usize>(
    bodies: &[Body<'_, D>],
    domain: &Bounds<D>,
    t: f64,
    units: &Units,
) -> Result<(), RunError> {
    for body in bodies {
        let at = body.trajectory.at(t);
        let out = body.points.iter().enumerate().map(|(k, (x, _))| at(k, x)).find(|x| !domain.contains(x));
        if let Some(x) = out {
            return Err(RunError::Motion {
                what: format!("`{}` leaves the domain at t = {:.4}, at {}", body.name, units.case_time(t), place(&x)),
                hint: "give it more room with `cloud.domain` or `cloud.far_field`, less motion, or let all particles move with \
                       it, `motion.particles = \"rigid\"`",
            });
        }
    }
    Ok(())
}

fn keeps_apart<const D: usize>(bodies: &[Body<'_, D>], t: f64, units: &Units) -> Result<(), RunError> {
    let carried: Vec<Vec<(Vector<D>, f64)>> = bodies
        .iter()
        .map(|b| {
            let (at, every) = (b.trajectory.at(t), b.points.len().div_ceil(POINTS).max(1));
            // particles that are left out leave gaps: a point stands for all of its neighbourhood
            b.points.iter().enumerate().step_by(every).map(|(k, (x, h))| (at(k, x), h * every as f64)).collect()
        })
        .collect();
    for (a, b) in (0..bodies.len()).flat_map(|a| (a + 1..bodies.len()).map(move |b| (a, b))) {
        if bodies[a].trajectory.law().is_fixed() && bodies[b].trajectory.law().is_fixed() {
            continue;
        }
        let [one, other] = [a, b].map(|k| Bounds::around(carried[k].iter().map(|(x, _)| x)));
        let thick = carried[a].iter().chain(&carried[b]).fold(0.0, |m: f64, (_, h)| m.max(*h));
        let apart = |d: usize| one.min[d] > other.max[d] + thick || other.min[d] > one.max[d] + thick;
        if (0..D).any(apart) {
            continue;
        }
        for (x, h) in &carried[a] {
            let near = carried[b].iter().find(|(y, g)| (*x - *y).norm() < GAP * h.max(*g));
            if near.is_some() {
                let (one, other, t) = (&bodies[a].name, &bodies[b].name, units.case_time(t));
                return Err(RunError::Motion {
                    what: format!(
                        "`{one}` and `{other}` run into one another at t = {t:.4}, at {}, where walls are spaced by {h:.3e}",
                        place(x)
                    ),
                    hint: "a gap must stay wider than a spacing of the walls: move them less, or place them farther apart",
                });
            }
        }
    }
    Ok(())
}

/// A note when an implicit step carries a body farther than the spacing of its wall.
fn longest_way<const D: usize>(
    case: &Case,
    bodies: &[Body<'_, D>],
    (period, span): (Option<f64>, f64),
) -> Option<String> {
    let numerics::FixedStep { length: dt, of_period } = numerics::fixed_step(case, period)?;
    let steps = ((span / dt).ceil() as usize).max(1);
    let looked_at = (0..steps).step_by(steps.div_ceil(TIMES)).map(|k| k as f64 * dt);
    let mut worst = (0.0, 0.0, "");
    for t in looked_at {
        for body in bodies {
            let (from, to) = (body.trajectory.at(t), body.trajectory.at(t + dt));
            for (k, (x, h)) in body.points.iter().enumerate() {
                let way = (to(k, x) - from(k, x)).norm() / h;
                if way > worst.0 {
                    worst = (way, t, body.name.as_str());
                }
            }
        }
    }
    let (way, t, name) = worst;
    if !(way > 1.0) {
        return None;
    }
    let units = case.flow.units();
    let (t, shorter) = (units.case_time(t), units.case_time(dt / way));
    let remedy = match period.filter(|_| of_period) {
        Some(period) => format!("`steps_per_period = {}`", (period / dt * way).ceil()),
        None => format!("`step = {shorter:.3e}`"),
    };
    Some(format!(
        "`{name}` moves by {way:.1} spacings of its wall in the step after t = {t:.4}: waves from it are smeared in time; \
         with {remedy} it moves by one at most"
    ))
}

fn place<const D: usize>(x: &Vector<D>) -> String {
    let numbers: Vec<String> = x.0.iter().map(|c| format!("{c:.4}")).collect();
    format!("({})", numbers.join(", "))
}
