//! Loads from the momentum of the gas around the bodies: the second evaluation that every run reports.
use super::axes::{GasView, LoadFrame};
use crate::case::{Case, Side};
use crate::math::{Bounds, Vector};
use crate::observe::loads::Balance as Sum;
use crate::scheme::balance::{Balance, Part};
use crate::scheme::probe::Probe;
use crate::scheme::start::free_stream;
use crate::scheme::{View, Work};
use crate::system::System;

/// What passes the zone around the bodies at the moment of `frame`; `None` without bodies. Fills `work`. A flow that
/// `marches` changes as the right-hand side of its equations says.
pub(crate) fn around<const D: usize>(
    case: &Case,
    axes: &LoadFrame,
    gas: &GasView<'_, D>,
    work: &mut Work<D>,
    marches: bool,
) -> Option<Sum> {
    let GasView { fluid, frame, state } = *gas;
    if fluid.discretisation.cloud.interface.is_empty() {
        return None;
    }
    let mut rate = Vec::new();
    if marches {
        rate = vec![0.0; fluid.len()];
        fluid.rhs(frame, state, work, &mut rate);
    }
    let view = gas.seen(work);
    let balance = Balance::new(free_stream(case), view)?;
    let mut sum = Sum::default();
    let axes = axes.axes(&view);
    let mut add = |p: Part<D>| {
        axes.add(&mut sum.load, &p.x.to_3d(), &p.force.to_3d());
        axes.turn(&mut sum.load, &p.carried[0].to_3d(), &p.carried[1].to_3d());
        sum.mass += p.mass;
        sum.energy += p.energy;
        sum.passed[0] += p.passed[0];
        sum.passed[1] += p.passed[1];
    };
    balance.parts(&rate).into_iter().for_each(&mut add);
    let cut = cuts(case, &view, &balance.zone.bounds());
    if !cut.is_empty() {
        let probe = Probe::new(view, None);
        for (axis, sign, region) in cut {
            let end = if sign < 0.0 { region.min[axis] } else { region.max[axis] };
            tile(&view, &region, (axis, end), &mut |x, extent| {
                let size: f64 = (0..D).map(|d| extent[d]).product();
                if let Some(q) = probe.at(&x) {
                    add(balance.side(x, &q, &(Vector::axis(axis) * (sign * size))));
                }
            });
        }
    }
    Some(sum)
}

/// Sides of the domain that cut the zone: axis, direction outward, and the part of the zone that lies inside. What passes one
/// of two periodic sides comes back through the other.
fn cuts<const D: usize>(case: &Case, view: &View<'_, D>, zone: &Bounds<D>) -> Vec<(usize, f64, Bounds<D>)> {
    let domain = view.reference().tree.bounds();
    let clamp = |v: &Vector<D>| Vector::from_fn(|d| v[d].clamp(domain.min[d], domain.max[d]));
    let region = Bounds { min: clamp(&zone.min), max: clamp(&zone.max) };
    let sides = (0..D).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]);
    let beyond = |(axis, sign): &(usize, f64)| match *sign < 0.0 {
        true => zone.min[*axis] < domain.min[*axis],
        false => zone.max[*axis] > domain.max[*axis],
    };
    let s = &case.boundary;
    let conditions = [[s.x_min, s.x_max], [s.y_min, s.y_max], [s.z_min, s.z_max]];
    let open = |(axis, sign): &(usize, f64)| conditions[*axis][usize::from(*sign > 0.0)] != Side::Periodic;
    sides.filter(beyond).filter(open).map(|(axis, sign)| (axis, sign, region)).collect()
}

/// Calls `f(middle, extent)` for tiles of one face of a box, or of a plane across it, about half a local spacing wide; the extent along
/// `axis` is 1.
pub(super) fn tile<const D: usize>(
    view: &View<'_, D>,
    region: &Bounds<D>,
    (axis, end): (usize, f64),
    f: &mut dyn FnMut(Vector<D>, Vector<D>),
) {
    let tree = &view.reference().tree;
    let mut stack = vec![*region];
    while let Some(b) = stack.pop() {
        let mut middle = b.centre();
        middle[axis] = end;
        let extent = b.extent();
        let side =
            (0..D).filter(|d| *d != axis).fold(axis, |a, d| if a == axis || extent[d] > extent[a] { d } else { a });
        if extent[side] > 0.5 * tree.leaf_at(&middle).size {
            let half = 0.5 * (b.min[side] + b.max[side]);
            let (mut low, mut high) = (b, b);
            (low.max[side], high.min[side]) = (half, half);
            stack.extend([low, high]);
        } else {
            f(middle, Vector::from_fn(|d| if d == axis { 1.0 } else { extent[d] }));
        }
    }
}
