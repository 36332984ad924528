//! Moments about the hinges that a case names.
use crate::case::{Case, Hinge};
use crate::observe::hinge::{HingeMoment, Line, Patch, behind};
use crate::scheme::View;
use crate::scheme::start::free_stream;

/// Moments about all hinges; lines move with their bodies.
pub(crate) fn hinge_moments<const D: usize>(case: &Case, view: &View<'_, D>, bodies: &[String]) -> Vec<HingeMoment> {
    case.hinge.iter().map(|hinge| moment(case, view, hinge, bodies)).collect()
}

fn moment<const D: usize>(case: &Case, view: &View<'_, D>, hinge: &Hinge, bodies: &[String]) -> HingeMoment {
    let body = hinge.body.as_ref().and_then(|name| bodies.iter().position(|b| b == name));
    let place = |x: &[crate::case::Length]| {
        let x = crate::math::Vector::from_fn(|d| x.get(d).map_or(0.0, |l| l.0));
        view.carried(body.unwrap_or(0), &x).to_3d()
    };
    let line = Line { from: place(&hinge.from), to: hinge.to.as_deref().map(place) };
    let (cloud, units) = (view.cloud(), case.flow.units());
    let own = |w: &usize| body.is_none_or(|b| usize::from(cloud.interface[*w].body) == b);
    let patch = |w: usize| Patch {
        x: view.place(cloud.n_fluid + w).to_3d(),
        area: view.frame.to_inertial_axes(&cloud.interface[w].area).to_3d(),
        force: view.wall_force(w).to_3d(),
    };
    let found = behind(&line, (0..cloud.interface.len()).filter(own).map(patch));
    let free = free_stream::<D>(case);
    let scale = 0.5 * free.density * free.velocity.norm_squared() * found.area * found.chord;
    HingeMoment {
        name: hinge.name.clone(),
        moment: found.moment * units.pressure(),
        coefficient: if scale > 0.0 { found.moment / scale } else { 0.0 },
        area: found.area,
        chord: found.chord,
    }
}
