//! Particles in a tree: fluid, interface and outer ones, before they have neighbours.
use std::sync::Arc;

use super::Interface;
use super::layers::Layers;
use super::tree::Tree;
use crate::case::Side;
use crate::math::Vector;

/// Particles in a tree, without images.
pub struct Particles<const D: usize> {
    /// The background.
    pub tree: Arc<Tree<D>>,
    /// Positions: fluid, interface, outer.
    pub x: Vec<Vector<D>>,
    /// Local spacings.
    pub spacing: Vec<f64>,
    /// Distance to the surface where it is below a few spacings, else infinite.
    pub wall_distance: Vec<f64>,
    /// Number of fluid particles.
    pub n_fluid: usize,
    /// Interface particles.
    pub interface: Vec<Interface<D>>,
    /// Sides that the outer particles belong to: (axis, 0 for the smallest coordinate).
    pub outer: Vec<(usize, usize)>,
    /// Conditions on the sides.
    pub sides: [[Side; 2]; D],
    pub(super) centre: Vec<Vector<D>>,
    pub(super) next: Vec<u32>,
    /// Layers along the walls.
    pub layers: Layers<D>,
    /// Which particles sit in which leaf.
    pub leaves: LeafIndex,
    pub(super) leaf_of: Vec<u32>,
}

/// A place for a particle.
#[derive(Clone, Copy, Debug)]
pub(super) struct ParticleSite<const D: usize> {
    /// Integer coordinates that give its place along the space-filling curve.
    pub(super) cell: [u32; D],
    /// Middle of the leaf, or the place itself in a layer.
    pub(super) centre: Vector<D>,
    /// Size of the leaf, or distance to the adjacent columns.
    pub(super) spacing: f64,
    /// Leaf of the background, for particles outside the layers.
    pub(super) node: u32,
    /// Distance to the surface.
    pub(super) distance: f64,
    /// Column and layer.
    pub(super) layer: Option<(u32, u32)>,
}

/// Which particles sit in which leaf.
#[derive(Clone, Debug, Default)]
pub struct LeafIndex {
    first: Vec<u32>,
    index: Vec<u32>,
}

impl LeafIndex {
    /// Counting sort of the particles by the leaf that holds them.
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

    /// Particles in a leaf.
    #[inline]
    pub fn of(&self, node: u32) -> &[u32] {
        let k = node as usize;
        &self.index[self.first[k] as usize..self.first[k + 1] as usize]
    }
}

impl<const D: usize> Particles<D> {
    /// Particles inside a leaf.
    pub fn in_leaf(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        self.leaves.of(node).iter().copied()
    }

    /// The leaf that particle `i` sits in.
    pub(super) fn leaf_of(&self, i: usize) -> u32 {
        self.leaf_of[i]
    }

    /// Middle of the leaf of a fluid or outer particle; the position of an interface particle.
    pub fn cell_centre(&self, i: usize) -> Vector<D> {
        self.centre[i]
    }

    /// True for interface particles.
    #[inline]
    pub fn is_interface(&self, i: usize) -> bool {
        (self.n_fluid..self.n_rows()).contains(&i)
    }

    /// Fluid and interface particles.
    pub fn n_rows(&self) -> usize {
        self.n_fluid + self.interface.len()
    }

    /// True when two interface particles follow one another along an outline.
    pub fn adjacent(&self, i: usize, k: usize) -> bool {
        let next = |a: usize| self.next.get(a - self.n_fluid).map_or(usize::MAX, |n| *n as usize);
        next(i) == k || next(k) == i
    }
}
