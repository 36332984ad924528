//! Loads from the momentum of the gas around the bodies: the second evaluation that every run reports.
use super::axes::{GasView, LoadFrame};
use crate::case::{Case, Side};
use crate::math::reduce::{maximum, sums};
use crate::math::{Bounds, Vector};
use crate::observe::loads::{Balance as Sum, Load, LoadAxes};
use crate::scheme::balance::{Balance, Part, SidePiece};
use crate::scheme::probe::Probe;
use crate::scheme::start::free_stream;
use crate::scheme::{View, Work};
use crate::system::System;

/// Distance of interface particles from a plane, in their spacings, within which they tell where a body stands on it.
const RIM: f64 = 2.0;
/// Size of the smallest pieces of a plane beside a body, in spacings of the body.
const PIECE: f64 = 0.125;

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
    let axes = axes.axes(&view);
    let planes = planes(case, &view, &balance.zone.bounds());
    let (mut cut, passing): (Vec<_>, Vec<_>) = balance.through_sides().into_iter().unzip();
    cut.extend(planes.iter().flatten());
    let mut parts = balance.parts(&rate, planes.is_some().then_some(&cut));
    parts.extend(passing);
    let probe = Probe::new(view, None);
    let pressed = |piece: &SidePiece<D>| Some(balance.pressed(piece, probe.at(&piece.x)?.pressure));
    parts.extend(planes.iter().flatten().filter_map(pressed));
    Some(sum_of(&parts, &axes))
}

/// Sum of all parts.
fn sum_of<const D: usize>(parts: &[Part<D>], axes: &LoadAxes) -> Sum {
    let [x, y, z, moment, mass, energy, inward, outward] = sums(parts.len(), |k| {
        let (p, mut load) = (&parts[k], Load::default());
        axes.add(&mut load, &p.x.to_3d(), &p.force.to_3d());
        axes.turn(&mut load, &p.carried[0].to_3d(), &p.carried[1].to_3d());
        axes.twist(&mut load, &p.couple.to_3d());
        let [x, y, z] = load.force;
        [x, y, z, load.moment, p.mass, p.energy, p.passed[0], p.passed[1]]
    });
    Sum { load: Load { force: [x, y, z], moment }, mass, energy, passed: [inward, outward] }
}

/// The planes of symmetry that cut the zone, in tiles outside the bodies. `None` where sides that do are periodic: what passes one of
/// them comes back through the other.
fn planes<const D: usize>(case: &Case, view: &View<'_, D>, zone: &Bounds<D>) -> Option<Vec<SidePiece<D>>> {
    let domain = view.reference().tree.bounds();
    let clamp = |v: &Vector<D>| Vector::from_fn(|d| v[d].clamp(domain.min[d], domain.max[d]));
    let region = Bounds { min: clamp(&zone.min), max: clamp(&zone.max) };
    let s = &case.boundary;
    let conditions = s.pairs();
    let mut tiles = Vec::new();
    for (axis, sign) in (0..D).flat_map(|axis| [(axis, -1.0), (axis, 1.0)]) {
        let low = sign < 0.0;
        let beyond = if low { zone.min[axis] < domain.min[axis] } else { zone.max[axis] > domain.max[axis] };
        if !beyond {
            continue;
        }
        let condition = conditions[axis][usize::from(!low)];
        match condition {
            Side::Periodic => return None,
            Side::Symmetry => {}
            _ => continue,
        }
        let end = if low { region.min[axis] } else { region.max[axis] };
        let rim = Rim::new(view, axis, end);
        tile(view, &region, (axis, end), &mut |x, extent| {
            rim.cut(x, extent, &mut |x, extent| {
                let size: f64 = (0..D).map(|d| extent[d]).product();
                tiles.push(SidePiece { x, area: Vector::axis(axis) * (sign * size) });
            });
        });
    }
    Some(tiles)
}

/// Interface particles beside a plane across an axis: where bodies stand on it.
struct Rim<const D: usize> {
    axis: usize,
    /// Place, normal into the gas and spacing.
    walls: Vec<(Vector<D>, Vector<D>, f64)>,
    around: Bounds<D>,
}

impl<const D: usize> Rim<D> {
    fn new(view: &View<'_, D>, axis: usize, end: f64) -> Self {
        let cloud = view.cloud();
        let wall = |i: usize| {
            let normal = view.frame.to_inertial_axes(&cloud.interface[i - cloud.n_fluid].area).unit();
            (view.frame.place(i), normal, view.fluid.discretisation.cloud.spacing[i])
        };
        let beside = |w: &(Vector<D>, Vector<D>, f64)| (w.0[axis] - end).abs() < RIM * w.2;
        let walls: Vec<_> = cloud.interface_range().map(wall).filter(beside).collect();
        let widest = maximum(walls.len(), |k| walls[k].2);
        let places: Vec<_> = walls.iter().map(|w| w.0).collect();
        Self { axis, around: Bounds::around(&places).padded(RIM * widest), walls }
    }

    /// Calls `f` with the pieces of a tile that lie outside the bodies, small ones at their rims.
    fn cut(&self, x: Vector<D>, extent: Vector<D>, f: &mut dyn FnMut(Vector<D>, Vector<D>)) {
        let apart = |w: &(Vector<D>, Vector<D>, f64)| (x - w.0).norm_squared();
        let within =
            self.around.contains(&Vector::from_fn(|d| if d == self.axis { self.around.centre()[d] } else { x[d] }));
        let near = self.walls.iter().filter(|_| within).min_by(|a, b| apart(a).total_cmp(&apart(b)));
        let Some(wall) = near else { return f(x, extent) };
        let across = |d: &usize| *d != self.axis;
        let size = (0..D).filter(across).map(|d| extent[d]).fold(0.0, f64::max);
        if apart(wall).sqrt() < size * (D as f64).sqrt() && size > PIECE * wall.2 {
            let half = Vector::from_fn(|d| if d == self.axis { extent[d] } else { 0.5 * extent[d] });
            for corner in 0..1 << (D - 1) {
                let mut bits = (0..D - 1).map(|k| if corner >> k & 1 == 0 { -0.5 } else { 0.5 });
                let at =
                    Vector::from_fn(
                        |d| if d == self.axis { x[d] } else { x[d] + bits.next().unwrap_or(0.0) * half[d] },
                    );
                self.cut(at, half, f);
            }
        } else if (x - wall.0).dot(&wall.1) > 0.0 {
            f(x, extent);
        }
    }
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
