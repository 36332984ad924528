//! Placement of the particles in the background tree.
//!
//! A fluid particle is placed at the centre of every leaf that lies outside the bodies and keeps a minimum distance
//! from the surface and from the interface particles. In 3-D the fluid particles next to a wall are then moved (module
//! `near_wall_smoothing`). The leaves along the sides of the domain hold the outer particles.
use std::sync::Arc;

use super::columns::{Columns, LayerContext};
use super::interface::{Placed, place};
use super::layers::Layers;
use super::layout::Layout;
use super::near_wall_smoothing::smooth_near_wall;
use super::neighbours::NEAR;
use super::particles::{LeafIndex, ParticleSite, Particles};
use super::tree::{Leaf, Tree};
use super::{CloudSpec, Transform};
use crate::case::Side;
use crate::geometry::Surface;
use crate::math::hilbert::hilbert_index;
use crate::math::parallel::{CHUNK, order_by_key, parts, sweep_parts};
use crate::math::{Bounds, Vector};

/// Minimum distance, in spacings, between fluid particles and interface particles.
const CLEARANCE: f64 = 0.4;
/// Dimension in which the particles next to a wall are moved. Wall layers follow the wall by construction and need no
/// move.
const SETTLED: usize = 3;
/// Number of bits of the address of a background cell along one axis.
const CELL_BITS: u32 = 31;
/// Fraction of the sum of two radii below which two balls overlap for certain.
const FREE: f64 = 0.999;

impl<const D: usize> Particles<D> {
    /// Places all particles in the background tree.
    pub fn fill(
        tree: Arc<Tree<D>>,
        layout: &Layout<D>,
        transforms: &[Transform<D>],
        spec: &CloudSpec<D>,
        surface: Option<&Surface<D>>,
    ) -> Self {
        let mut placed = surface.map(|s| place(s, &tree, &layout.planes())).unwrap_or_default();
        let mut fluid = Vec::new();
        let mut outer = Vec::new();
        let leaves: Vec<Leaf<D>> = tree.leaves().collect();
        let mut distance = vec![None; leaves.len()];
        let walls = Walls::new(surface, tree.bounds(), transforms);
        let chunks = parts(leaves.len(), CHUNK);
        sweep_parts(&chunks, 1, &mut distance, &|k, slots| {
            let mut last = None;
            for (leaf, slot) in leaves[chunks[k].clone()].iter().zip(slots) {
                *slot = walls.distance((&leaf.centre, leaf.size), spec.blank, &mut last);
            }
        });
        for (leaf, distance) in leaves.iter().zip(&distance) {
            let Some(distance) = distance else { continue };
            match side_of(leaf, &tree.bounds(), &layout.sides) {
                Some(side) => outer.push((*leaf, side)),
                None => fluid.push((*leaf, *distance)),
            }
        }
        blank_near_interface(&tree, &placed, &mut fluid);
        let context = surface.map(|surface| LayerContext { surface, tree: &tree, layout, transforms });
        let columns = spec.wall_layers.zip(context).map(|(layers, context)| {
            let columns = Columns::grow(&placed, &layers, &context);
            columns.blank(&context, spec.blank, &mut fluid);
            columns.straighten(&mut placed);
            columns
        });
        let leaf_site = |(leaf, distance): &(Leaf<D>, f64)| ParticleSite {
            cell: tree.cell_at(&leaf.centre),
            centre: leaf.centre,
            spacing: leaf.size,
            node: leaf.node,
            distance: *distance,
            layer: None,
        };
        let sites = fluid.iter().map(leaf_site).chain(columns.iter().flat_map(|c| c.sites(&tree))).collect::<Vec<_>>();
        let order = order_by_key(sites.len(), |k| curve_position(sites[k].cell));
        let sites: Vec<ParticleSite<D>> = order.into_iter().map(|k| sites[k as usize]).collect();
        let order = order_by_key(outer.len(), |k| curve_position(tree.anchor(outer[k].0.node)));
        let outer: Vec<_> = order.into_iter().map(|k| outer[k as usize]).collect();
        let layers = columns.map(|c| gather(c, &sites)).unwrap_or_default();
        let mut all = Self::assemble(tree, layout, (sites, placed, outer), layers);
        if let (Some(surface), SETTLED, true) = (surface, D, all.layers.is_empty()) {
            smooth_near_wall(&mut all, surface, transforms);
        }
        all.shake(spec.jitter);
        all
    }

    #[allow(clippy::type_complexity)]
    pub(super) fn assemble(
        tree: Arc<Tree<D>>,
        layout: &Layout<D>,
        (fluid, placed, outer): (Vec<ParticleSite<D>>, Placed<D>, Vec<(Leaf<D>, (usize, usize))>),
        layers: Layers<D>,
    ) -> Self {
        let n_fluid = fluid.len();
        let outer_leaves = outer.iter().map(|(l, _)| l);
        let centre: Vec<_> = fluid
            .iter()
            .map(|s| s.centre)
            .chain(placed.x.iter().copied())
            .chain(outer_leaves.clone().map(|l| l.centre))
            .collect();
        let spacing = fluid
            .iter()
            .map(|s| s.spacing)
            .chain(placed.spacing.iter().copied())
            .chain(outer_leaves.clone().map(|l| l.size))
            .collect();
        let wall_distance = fluid
            .iter()
            .map(|s| s.distance)
            .chain(placed.x.iter().map(|_| 0.0))
            .chain(outer_leaves.map(|_| f64::INFINITY))
            .collect::<Vec<_>>();
        let next = placed.next.iter().map(|k| if *k == u32::MAX { *k } else { k + n_fluid as u32 }).collect();
        let node_of = |s: &ParticleSite<D>| if layers.is_empty() { s.node } else { tree.leaf_at(&s.centre).node };
        let leaf_of = fluid.iter().map(node_of).chain(placed.x.iter().map(|x| tree.leaf_at(x).node));
        let leaf_of: Vec<u32> = leaf_of.chain(outer.iter().map(|(l, _)| l.node)).collect();
        Self {
            x: centre.clone(),
            spacing,
            wall_distance,
            n_fluid,
            interface: placed.interface,
            outer: outer.iter().map(|(_, side)| *side).collect(),
            sides: layout.sides,
            centre,
            next,
            layers,
            leaves: LeafIndex::new(&leaf_of, tree.n_nodes()),
            leaf_of,
            tree,
        }
    }

    /// Displaces the fluid particles far from walls at random, by at most `jitter` spacings along each axis.
    fn shake(&mut self, jitter: f64) {
        for i in 0..self.n_fluid {
            if jitter > 0.0 && self.wall_distance[i].is_infinite() {
                let cell = self.tree.label(self.tree.leaf_at(&self.centre[i]).node);
                self.x[i] += random_direction(cell) * (jitter * self.spacing[i]);
            }
        }
    }
}

/// The surface and its images beyond the sides of the domain.
pub(super) struct Walls<'a, const D: usize> {
    surface: Option<&'a Surface<D>>,
    closed: bool,
    domain: Bounds<D>,
    back: Vec<Transform<D>>,
}

/// A ball that contains no part of the surface: centre, radius, and whether it lies inside a body.
pub(super) type Ball<const D: usize> = (Vector<D>, f64, bool);

impl<'a, const D: usize> Walls<'a, D> {
    /// Prepares distance queries to `surface`, if there is one, and to its images under `transforms`.
    pub(super) fn new(surface: Option<&'a Surface<D>>, domain: Bounds<D>, transforms: &[Transform<D>]) -> Self {
        let back = transforms.iter().map(Transform::inverse).collect();
        Self { surface, closed: surface.is_some_and(Surface::is_closed), domain, back }
    }

    /// Distance from `centre`, the position of a particle of spacing `size`, to the surface; infinite when it is far
    /// away, `None` when no particle may be placed there. `last` holds the free ball around the previous position and
    /// is updated.
    pub(super) fn distance(
        &self,
        (centre, size): (&Vector<D>, f64),
        blank: f64,
        last: &mut Option<Ball<D>>,
    ) -> Option<f64> {
        let Some(surface) = self.surface else { return Some(f64::INFINITY) };
        let reach = (NEAR + 1.0) * size;
        let images = self.back.iter().map(|t| t.point(centre));
        let images = images.filter(|x| self.domain.distance_squared(x) <= reach * reach);
        let mut distance = f64::INFINITY;
        for x in std::iter::once(*centre).chain(images) {
            distance = surface.nearest(&x, reach.min(distance)).map_or(distance, |n| n.distance);
            if distance < blank * size || self.inside(surface, &x, reach.min(distance), last) {
                return None;
            }
        }
        Some(distance)
    }

    /// Whether the ball of radius `free` around `x`, which contains no surface, lies inside a body. If it overlaps the
    /// previous ball, both lie on the same side of a closed surface, and no ray test is necessary.
    fn inside(&self, surface: &Surface<D>, x: &Vector<D>, free: f64, last: &mut Option<Ball<D>>) -> bool {
        let same = last.filter(|l| self.closed && (l.0 - *x).norm() < FREE * (l.1 + free)).map(|l| l.2);
        let inside = same.unwrap_or_else(|| surface.inside(x));
        *last = Some((*x, free, inside));
        inside
    }
}

/// Removes fluid leaves whose centre is too near to an interface particle.
fn blank_near_interface<const D: usize>(tree: &Tree<D>, placed: &Placed<D>, fluid: &mut Vec<(Leaf<D>, f64)>) {
    let mut drop = vec![false; tree.n_nodes()];
    for (x, h) in placed.x.iter().zip(&placed.spacing) {
        let reach = Vector::splat(CLEARANCE * h);
        tree.overlapping(&Bounds { min: *x - reach, max: *x + reach }, |k| {
            let leaf = tree.leaf(k);
            drop[k as usize] |= (leaf.centre - *x).norm() < CLEARANCE * leaf.size;
        });
    }
    fluid.retain(|(leaf, _)| !drop[leaf.node as usize]);
}

/// The side of the domain that a leaf touches; `None` where particles exist beyond the side (symmetry, periodicity).
pub(super) fn side_of<const D: usize>(
    leaf: &Leaf<D>,
    bounds: &Bounds<D>,
    sides: &[[Side; 2]; D],
) -> Option<(usize, usize)> {
    let mut found: Option<(usize, usize)> = None;
    for d in 0..D {
        for end in 0..2 {
            let gap = if end == 0 { leaf.centre[d] - bounds.min[d] } else { bounds.max[d] - leaf.centre[d] };
            let open = matches!(sides[d][end], Side::FarField | Side::Held | Side::Outflow { .. });
            // Where two sides meet, the condition that prescribes a state has priority over an outflow.
            let better = found.is_none_or(|f| matches!(sides[f.0][f.1], Side::Outflow { .. }));
            if open && gap < 0.75 * leaf.size && better {
                found = Some((d, end));
            }
        }
    }
    found
}

/// Enters the indices of the fluid particles into the columns.
fn gather<const D: usize>(columns: Columns<D>, sites: &[ParticleSite<D>]) -> Layers<D> {
    let mut numbers: Vec<(u32, u32, u32)> =
        sites.iter().zip(0..).filter_map(|(s, i)| s.layer.map(|(column, layer)| (column, layer, i))).collect();
    numbers.sort_unstable();
    let finished = columns.finish(numbers.into_iter().map(|n| n.2));
    Layers::new(finished, columns.axes, sites.len())
}

/// Position of a cell along the Hilbert curve.
pub(super) fn curve_position<const D: usize>(cell: [u32; D]) -> u64 {
    let bits = 64 / D as u32;
    let shift = CELL_BITS.saturating_sub(bits);
    hilbert_index(cell.map(|c| c >> shift), bits.min(CELL_BITS))
}

/// A pseudo-random vector with components in [−1, 1] that depends on the cell only.
fn random_direction<const D: usize>(anchor: [u32; D]) -> Vector<D> {
    let mut state =
        anchor.iter().fold(0x9e37_79b9_7f4a_7c15u64, |s, a| (s ^ u64::from(*a)).wrapping_mul(0xbf58_476d_1ce4_e5b9));
    Vector::from_fn(|_| {
        state ^= state >> 29;
        state = state.wrapping_mul(0x94d0_49bb_1331_11eb);
        state ^= state >> 32;
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    })
}
