//! Refinement that follows the solution: which particles should have smaller neighbours.
//!
//! Sensors are undivided differences across edges, relative to the local state: pressure jumps |Δp|/p̄ (shocks), tangential
//! velocity jumps |Δv_t|/c (shear layers), and second differences 2∇q·d − Δq of density and velocity (curvature). A particle
//! above a threshold asks for half its spacing around it, one within a quarter of the threshold asks to keep its spacing.
use super::view::View;
use crate::case::Sensor;
use crate::cloud::sources::Source;
use crate::math::parallel::sweep_parts;

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
