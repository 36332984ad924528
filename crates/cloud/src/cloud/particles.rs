//! Fluid, interface and outer particles of a background tree, before neighbour lists and ghosts exist.
use std::sync::Arc;

use super::Interface;
use super::layers::Layers;
use super::tree::Tree;
use crate::case::Side;
use crate::math::Vector;

/// Fluid, interface and outer particles of a background tree, without ghosts. Lengths are in the unit of the geometry.
pub struct Particles<const D: usize> {
    /// The background tree.
    pub tree: Arc<Tree<D>>,
    /// Positions of the fluid, interface and outer particles, in this order.
    pub x: Vec<Vector<D>>,
    /// Local spacing of each particle.
    pub spacing: Vec<f64>,
    /// Distance to the surface where it is less than a few spacings; infinite elsewhere.
    pub wall_distance: Vec<f64>,
    /// Number of fluid particles.
    pub n_fluid: usize,
    /// Data of the interface particles.
    pub interface: Vec<Interface<D>>,
    /// Side of each outer particle: the axis, and 0 for the smallest or 1 for the largest coordinate.
    pub outer: Vec<(usize, usize)>,
    /// Boundary conditions on the sides, `[axis][0: smallest, 1: largest coordinate]`.
    pub sides: [[Side; 2]; D],
    pub(super) centre: Vec<Vector<D>>,
    pub(super) next: Vec<u32>,
    /// Layers along the walls.
    pub layers: Layers<D>,
    /// The particles in each leaf of the tree.
    pub leaves: LeafIndex,
    pub(super) leaf_of: Vec<u32>,
}

/// A position at which a fluid particle can be placed.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParticleSite<const D: usize> {
    /// Integer coordinates of the finest cell there; they give the order along the space-filling curve.
    pub(super) cell: [u32; D],
    /// Centre of the leaf; in a wall layer the position itself.
    pub(super) centre: Vector<D>,
    /// Size of the leaf; in a wall layer the mean distance to the adjacent columns.
    pub(super) spacing: f64,
    /// Index of the leaf, for particles outside the wall layers.
    pub(super) node: u32,
    /// Distance to the surface; infinite when it is far away.
    pub(super) distance: f64,
    /// Column and layer number, for particles in a wall layer.
    pub(super) layer: Option<(u32, u32)>,
}

/// The particles in each leaf of the background tree, as compressed rows.
#[derive(Clone, Debug, Default)]
pub struct LeafIndex {
    first: Vec<u32>,
    index: Vec<u32>,
}

impl LeafIndex {
    /// Sorts the particles by the leaf that holds them (counting sort).
    pub(super) fn new(leaf_of: &[u32], n_nodes: usize) -> Self {
        let mut first = vec![0u32; n_nodes + 1];
        leaf_of.iter().for_each(|k| first[*k as usize + 1] += 1);
        (0..n_nodes).for_each(|k| first[k + 1] += first[k]);
        let mut slot = first.clone();
        let mut index = vec![0; leaf_of.len()];
        for (i, k) in leaf_of.iter().enumerate() {
            index[slot[*k as usize] as usize] = i as u32;
            slot[*k as usize] += 1;
        }
        Self { first, index }
    }

    /// Particles in the leaf `node`.
    #[inline]
    pub fn of(&self, node: u32) -> &[u32] {
        let k = node as usize;
        &self.index[self.first[k] as usize..self.first[k + 1] as usize]
    }
}

impl<const D: usize> Particles<D> {
    /// Particles in the leaf `node`.
    pub fn in_leaf(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        self.leaves.of(node).iter().copied()
    }

    /// Index of the leaf that contains particle `i`.
    pub(super) fn leaf_of(&self, i: usize) -> u32 {
        self.leaf_of[i]
    }

    /// Centre of the leaf of a fluid or outer particle; for an interface particle, its position.
    pub fn cell_centre(&self, i: usize) -> Vector<D> {
        self.centre[i]
    }

    /// True when particle `i` is an interface particle.
    #[inline]
    pub fn is_interface(&self, i: usize) -> bool {
        (self.n_fluid..self.n_rows()).contains(&i)
    }

    /// Number of fluid and interface particles.
    pub fn n_rows(&self) -> usize {
        self.n_fluid + self.interface.len()
    }

    /// True when two interface particles are neighbours along an outline (2-D).
    pub fn adjacent(&self, i: usize, k: usize) -> bool {
        let next = |a: usize| self.next.get(a - self.n_fluid).map_or(usize::MAX, |n| *n as usize);
        next(i) == k || next(k) == i
    }
}
