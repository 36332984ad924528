//! Refinement that follows the solution: which particles should have smaller neighbours.
//!
//! Sensors are undivided differences across edges, relative to the local state: pressure jumps |Δp|/p̄ (shocks), tangential
//! velocity jumps |Δv_t|/c (shear layers), and second differences 2∇q·d − Δq of density and velocity (curvature). A particle
//! above a threshold asks for half its spacing around it, one within a quarter of the threshold asks to keep its spacing.
use super::view::View;
use crate::case::Sensor;
use crate::cloud::sources::Source;
use crate::math::sweep::sweep_parts;

/// Pressure jump over mean pressure that asks for refinement.
const SHOCK: f64 = 0.06;
/// Tangential velocity jump over sound speed that asks for refinement.
const SHEAR: f64 = 0.1;
/// Relative second difference that asks for refinement.
const CURVATURE: f64 = 0.012;
/// Fraction of the threshold above which a particle keeps its spacing.
const KEEP: f64 = 0.25;
/// Cells of each size around a source of adaptation.
const LAYERS: f64 = 4.0;

/// Part of its spacing that a particle at a shock asks of the next cloud of a family: half of what that has there anyway.
const AT_SHOCKS: f64 = 0.25;

/// Sources of refinement at shocks for a cloud of half the spacing everywhere, none finer than `finest`: particles with an edge
/// along which gas faster than sound runs into a higher pressure.
pub fn shocks<const D: usize>(view: &View<'_, D>, finest: f64) -> Vec<Source<D>> {
    let n = view.cloud().n_fluid;
    let mut at_shock = vec![false; n];
    let op = &view.frame.discretisation.operators;
    for edge in (0..op.fluid_parts().len()).flat_map(|k| op.edges(k)) {
        let (i, j) = (edge.i(), edge.j());
        if is_shock(view, i, j) {
            at_shock[i] = true;
            if edge.both() {
                at_shock[j] = true;
            }
        }
    }
    let source = |i: usize| {
        let spacing = (AT_SHOCKS * view.cloud().spacing[i]).max(finest);
        Source { x: view.reference().x[i], spacing, layers: LAYERS }
    };
    (0..n).filter(|i| at_shock[*i]).map(source).collect()
}

/// True where gas faster than sound runs into a pressure that is higher by the threshold along an edge.
fn is_shock<const D: usize>(view: &View<'_, D>, i: usize, j: usize) -> bool {
    let (a, b) = (&view.work.state[i], &view.work.state[j]);
    let along = (view.cloud().x[j] - view.cloud().x[i]).unit();
    let (ahead, sign) = if a.pressure < b.pressure { (a, 1.0) } else { (b, -1.0) };
    let normal = sign * ahead.velocity.dot(&along);
    normal > view.fluid.gas.sound_speed(ahead) && measure(view, Sensor::Shock, i, j) > 1.0
}

/// Sources of refinement of the cloud before any motion from the solution and its gradients, none finer than `finest`.
pub fn sources<const D: usize>(view: &View<'_, D>, sensors: &[Sensor], finest: f64) -> Vec<Source<D>> {
    let n = view.cloud().n_fluid;
    let mut size = vec![0.0f64; n];
    let op = &view.frame.discretisation.operators;
    sweep_parts(op.fluid_parts(), 1, &mut size, &|k, out| {
        let start = op.parts[k].start;
        for e in op.edges(k) {
            let s = sensors.iter().map(|s| measure(view, *s, e.i(), e.j())).fold(0.0, f64::max);
            let slot = &mut out[e.i() - start];
            *slot = slot.max(s);
            if e.both() {
                let slot = &mut out[e.j() - start];
                *slot = slot.max(s);
            }
        }
    });
    let want = |i: usize| {
        let h = view.cloud().spacing[i];
        let spacing = if size[i] > 1.0 { 0.5 * h } else { h };
        (size[i] > KEEP).then(|| Source { x: view.reference().x[i], spacing: spacing.max(finest), layers: LAYERS })
    };
    (0..n).filter_map(want).collect()
}

/// One sensor across one edge, in units of its threshold.
fn measure<const D: usize>(view: &View<'_, D>, sensor: Sensor, i: usize, j: usize) -> f64 {
    let (a, b) = (&view.work.state[i], &view.work.state[j]);
    let d = view.cloud().x[j] - view.cloud().x[i];
    let sound = view.fluid.gas.sound_speed(a);
    match sensor {
        Sensor::Shock => (a.pressure - b.pressure).abs() / (0.5 * (a.pressure + b.pressure)) / SHOCK,
        Sensor::Shear => {
            let dv = b.velocity - a.velocity;
            let along = d.unit();
            (dv - along * dv.dot(&along)).norm() / sound / SHEAR
        }
        Sensor::Curvature => {
            let dq = b.minus(a);
            let second = view.work.gradient[i].along(&d).minus(&dq);
            (second.density.abs() / a.density).max(second.velocity.norm() / sound) / CURVATURE
        }
    }
}
