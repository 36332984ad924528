//! What one cloud of a run tells the next: where it must be finer.
//!
//! A case that is adapted without error bars keeps its spacing and refines, cycle by cycle, where the sensors of
//! [`crate::scheme::adapt`] tell. In a family of clouds all of that is scaled with the spacing: each cloud is refined by what was found
//! on the one before, with the distance between particles scaled, so that the clouds stay alike and their loads have an error bar. Without
//! `[adapt]` a family follows the gas behind detached shocks.
use super::super::accuracy;
use super::super::look::{Snapshot, field};
use super::super::stage::Stage;
use super::shock_layer::ShockLayer;
use crate::case::{Accuracy, Case};
use crate::cloud::CloudSpec;
use crate::cloud::layout::count;
use crate::cloud::sources::Source;
use crate::geometry::Surface;
use crate::problem::{ProblemIn, spacing};
use crate::scheme::{HasGas, View, adapt};
use crate::system::{Instant, System};

/// Factor on what is asked for where there would be too many particles: cells come in powers of two.
const COARSER: f64 = 2.0;

/// Sources of refinement for the `next` stage, from the solution of `this` one.
pub(crate) fn adapted<S: HasGas<D>, const D: usize>(
    problem: &ProblemIn<D>,
    [this, next]: [&Stage; 2],
    system: &S,
    state: &[f64],
) -> Vec<Source<D>> {
    let (fluid, gas) = (system.gas(), system.gas_state(state));
    let mut work = fluid.work();
    let frame = fluid.frame(&Instant::still(0.0), gas);
    let view = fluid.view(&frame, gas, &mut work);
    match (spacing::asked(problem.case()), problem.surface()) {
        (Some(_), Some(surface)) if problem.case().adapt.cycles == 0 => {
            behind_shocks(problem.case(), surface, &field(problem.case(), &view), next.factor)
        }
        (Some(asked), Some(surface)) => in_family(problem.case(), surface, &view, (&asked, [this.factor, next.factor])),
        (None, Some(surface)) => on_its_own(problem.case(), surface, &view),
        _ => adapt::sources(&view, &problem.case().adapt.sensors, finest(problem.case())),
    }
}

/// What the sensors ask of the one cloud of a case, within the particles that `[adapt]` allows.
fn on_its_own<const D: usize>(case: &Case, surface: &Surface<D>, view: &View<'_, D>) -> Vec<Source<D>> {
    let all = adapt::sources(view, &case.adapt.sensors, finest(case));
    let at = |coarser: f64| all.iter().map(|s| Source { spacing: coarser * s.spacing, ..*s }).collect();
    affordable(case, surface, (case.adapt.particles as f64, 1.0), at)
}

/// Finest spacing that adaptation may ask for.
fn finest(case: &Case) -> f64 {
    case.adapt.spacing.or(case.cloud.spacing).map_or(0.0, |l| l.0)
}

/// What detached shocks in `field` ask of the cloud with `factor` times the spacing of the case.
pub(crate) fn behind_shocks<const D: usize>(
    case: &Case,
    surface: &Surface<D>,
    field: &Snapshot,
    factor: f64,
) -> Vec<Source<D>> {
    let asked = spacing::asked(case).filter(|_| accuracy::follows_shocks(case));
    let layer = asked.and_then(|asked| Some((ShockLayer::of(case, surface, field)?, asked)));
    let (Some((layer, asked)), Some(spacing)) = (layer, case.cloud.spacing) else { return Vec::new() };
    let at = |coarser: f64| layer.sources(factor * spacing.0, factor, coarser);
    affordable(case, surface, (accuracy::room(&asked, factor), factor), at)
}

/// What the sensors ask of that cloud.
fn in_family<const D: usize>(
    case: &Case,
    surface: &Surface<D>,
    view: &View<'_, D>,
    (asked, [before, factor]): (&Accuracy, [f64; 2]),
) -> Vec<Source<D>> {
    let finer = factor / before;
    let room = accuracy::room_adapted::<D>(asked.particles.min(case.adapt.particles), factor);
    let finest = factor * finest(case);
    let all = adapt::sources(view, &case.adapt.sensors, finest / finer);
    let at = |coarser: f64| {
        let asks = |s: &Source<D>| Source { spacing: coarser * finer * s.spacing, ..*s };
        all.iter().map(asks).collect()
    };
    affordable(case, surface, (room, factor), at)
}

/// The finest of the sources `at(1)`, `at(2)`, `at(4)` … with which the cloud with `factor` times the spacing of the case has no more
/// particles than there is `room` for; none where even that has more.
fn affordable<const D: usize>(
    case: &Case,
    surface: &Surface<D>,
    (room, factor): (f64, f64),
    at: impl Fn(f64) -> Vec<Source<D>>,
) -> Vec<Source<D>> {
    let spec = CloudSpec::of(&spacing::of_stage(case, factor), &case.boundary);
    let cells = |sources: &[_]| count(&spec, Some(surface), sources).ok();
    let Some(alone) = cells(&[]) else { return Vec::new() };
    let mut coarser = 1.0;
    loop {
        let all = at(coarser);
        let found = cells(&all);
        // where sources refine nothing more, nothing is gained by coarser ones
        if all.is_empty() || found.is_some_and(|n| n as f64 <= room) {
            return all;
        }
        if found.is_some_and(|n| n <= alone) {
            return Vec::new();
        }
        coarser *= COARSER;
    }
}
