//! What the gas does to the walls it sticks to: friction, heat, separation.
use super::axes::load_on_walls;
use crate::case::Case;
use crate::math::{Bounds, Vector};
use crate::observe::loads::{Load, LoadAxes};
use crate::record::summary::Separation;
use crate::scheme::View;
use crate::scheme::start::{free_stream, stream_axes};

/// Friction on one interface particle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct WallFriction {
    /// Shear along the surface in the direction of the stream, over the dynamic pressure.
    pub(crate) cf: f64,
    /// Heat into the wall per area and time, in the units of the case.
    pub(crate) heat_flux: f64,
    /// Distance of the first particle in viscous lengths.
    pub(crate) y_plus: f64,
}

/// Load of the viscous stress on the interface particles chosen.
pub(crate) fn friction_load<const D: usize>(
    view: &View<'_, D>,
    axes: &LoadAxes,
    chosen: impl Fn(usize) -> bool + Sync,
) -> Load {
    if view.fluid.viscous_model.is_none() {
        return Load::default();
    }
    load_on_walls(view, axes, |w| if chosen(w) { view.friction_force(w) } else { None })
}

/// Friction on every interface particle; `None` for an inviscid gas.
pub(crate) fn wall_friction<const D: usize>(case: &Case, view: &View<'_, D>) -> Option<Vec<WallFriction>> {
    view.fluid.viscous_model.as_ref()?;
    let (cloud, units) = (view.cloud(), case.flow.units());
    let free = free_stream::<D>(case);
    let dynamic = (0.5 * free.density * free.velocity.norm_squared()).max(f64::MIN_POSITIVE);
    let stream = stream_axes::<D>(case).0;
    let at = |w: usize| {
        let Some(found) = view.wall_slopes(w) else { return WallFriction::default() };
        let normal = view.normal(w);
        let along = (stream - normal * stream.dot(&normal)).unit();
        WallFriction {
            cf: found.stress.dot(&along) / dynamic,
            heat_flux: found.heat * units.pressure() * units.speed,
            y_plus: view.y_plus(w).unwrap_or_default(),
        }
    };
    Some((0..cloud.interface.len()).map(at).collect())
}

/// Distances of the interface particles from the nose, over the extent `bounds` of the bodies along x.
pub(crate) fn chordwise<const D: usize>(view: &View<'_, D>, bounds: &Bounds<D>) -> Vec<f64> {
    let x_c = |x: &Vector<D>| (x[0] - bounds.min[0]) / bounds.extent()[0];
    view.fluid.walls_before().iter().map(x_c).collect()
}

/// Where friction changes from along to against the stream on each side of each body; plane cases only. `x_c` are the
/// distances of the interface particles from the nose.
pub(crate) fn separations<const D: usize>(
    case: &Case,
    view: &View<'_, D>,
    friction: &[WallFriction],
    x_c: &[f64],
) -> Vec<Separation> {
    falls_below_zero(case, view, |w| friction[w].cf, x_c)
}

/// Where the flow along the walls falls below the speed of sound farthest downstream, on the upper and on the lower side: the feet of shocks, or
/// the ends of regions without; plane cases of one body only.
pub(crate) fn sonic_places<const D: usize>(case: &Case, view: &View<'_, D>, x_c: &[f64]) -> [Option<f64>; 2] {
    let cloud = view.cloud();
    if cloud.interface.iter().any(|w| w.body > 0) {
        return [None; 2];
    }
    let beyond_sound = |w: usize| {
        let state = view.state(cloud.n_fluid + w);
        state.velocity.norm() / view.fluid.gas.sound_speed(&state) - 1.0
    };
    let places = falls_below_zero(case, view, beyond_sound, x_c);
    [true, false].map(|upper| places.iter().filter(|p| p.upper == upper).map(|p| p.x_c).reduce(f64::max))
}

/// Where a quantity on the walls falls below zero, from the nose on each side of each body; plane cases only.
fn falls_below_zero<const D: usize>(
    case: &Case,
    view: &View<'_, D>,
    quantity: impl Fn(usize) -> f64,
    x_c: &[f64],
) -> Vec<Separation> {
    let walls = &view.cloud().interface;
    let lift: Vector<D> = stream_axes::<D>(case).1;
    let mut found = Vec::new();
    let n_bodies = if D == 2 { walls.iter().map(|w| w.body + 1).max().unwrap_or(0) } else { 0 };
    for (body, upper) in (0..n_bodies).flat_map(|b| [(b, true), (b, false)]) {
        let on_side = |w: &usize| walls[*w].body == body && (view.normal(*w).dot(&lift) > 0.0) == upper;
        let mut side: Vec<usize> = (0..walls.len()).filter(on_side).collect();
        side.sort_by(|a, b| x_c[*a].total_cmp(&x_c[*b]));
        for pair in side.windows(2) {
            let [a, b] = [quantity(pair[0]), quantity(pair[1])];
            if a > 0.0 && b <= 0.0 {
                let place = x_c[pair[0]] + (x_c[pair[1]] - x_c[pair[0]]) * a / (a - b);
                found.push(Separation { body, upper, x_c: place });
            }
        }
    }
    found
}
