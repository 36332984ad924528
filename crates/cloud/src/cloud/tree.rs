//! The background: a forest of square (cubic) root cells, each the root of a quadtree (octree).
//!
//! Cells are addressed by integers in units of the finest possible cell, so that neighbours are found by arithmetic alone.
//! The forest is balanced: cells that touch, corners included, differ by one level at most.
use std::cell::Cell;

use crate::math::parallel::sweep;
use crate::math::{Bounds, Vector};

/// Deepest level below a root, for a box of many roots and of few roots: a cell is addressed by 31 bits.
const LEVELS: [u8; 2] = [20, 26];
/// Number of roots along an axis below which the deeper levels can be addressed.
const FEW_ROOTS: u32 = 1 << 5;
const NONE: u32 = u32::MAX;

/// A cell. Its children, if any, are stored consecutively from `first_child`.
#[derive(Clone, Copy, Debug)]
struct Node<const D: usize> {
    first_child: u32,
    level: u8,
    anchor: [u32; D],
}

/// A balanced forest of cells that fills a box. Lengths are in the unit of the geometry.
#[derive(Clone, Debug)]
pub struct Tree<const D: usize> {
    origin: Vector<D>,
    root_size: f64,
    roots: [u32; D],
    periodic: [bool; D],
    max_level: u8,
    nodes: Vec<Node<D>>,
}

/// A cell without children.
#[derive(Clone, Copy, Debug)]
pub struct Leaf<const D: usize> {
    /// Index of the cell, valid as long as the tree exists.
    pub node: u32,
    /// Centre of the cell.
    pub centre: Vector<D>,
    /// Edge length.
    pub size: f64,
    /// Levels below the root.
    pub level: u8,
}

/// The box that a tree fills, its root cells and its periodic axes.
#[derive(Clone, Copy, Debug)]
pub struct Forest<const D: usize> {
    /// Corner with the smallest coordinates.
    pub origin: Vector<D>,
    /// Edge length of the root cells.
    pub root_size: f64,
    /// Number of root cells along each axis.
    pub roots: [u32; D],
    /// True for the axes along which the box is periodic.
    pub periodic: [bool; D],
}

impl<const D: usize> Forest<D> {
    /// Deepest level below a root.
    fn max_level(&self) -> u8 {
        LEVELS[usize::from(self.roots.iter().all(|r| *r < FEW_ROOTS))]
    }

    /// Edge length of the finest possible cell.
    pub fn finest(&self) -> f64 {
        self.root_size / (1u64 << self.max_level()) as f64
    }
}

impl<const D: usize> Tree<D> {
    /// Splits every cell for which `wanted(centre, size)` holds, then balances the tree; `None` as soon as this takes
    /// more than `most` cells, parents included.
    pub fn build(forest: &Forest<D>, most: usize, wanted: impl Fn(&Vector<D>, f64) -> bool + Sync) -> Option<Self> {
        let count = forest.roots.iter().map(|r| u64::from(*r)).product::<u64>();
        let count = u32::try_from(count).ok().filter(|n| (*n as usize) <= most)?;
        let max_level = forest.max_level();
        let root =
            |k| Node { first_child: NONE, level: 0, anchor: root_cell(k, &forest.roots).map(|c| c << max_level) };
        let nodes = (0..count).map(root).collect();
        let mut tree = Self {
            origin: forest.origin,
            root_size: forest.root_size,
            roots: forest.roots,
            periodic: forest.periodic,
            max_level,
            nodes,
        };
        // the children are stored after all cells of the generation of their parents
        let mut generation = 0..tree.nodes.len();
        while !generation.is_empty() {
            let mut split = vec![false; generation.len()];
            sweep(&mut split, |k| {
                let leaf = tree.leaf((generation.start + k) as u32);
                leaf.level < max_level && wanted(&leaf.centre, leaf.size)
            });
            let wanted = split.iter().filter(|s| **s).count();
            if tree.nodes.len() + (wanted << D) > most {
                return None;
            }
            generation.clone().zip(split).filter(|s| s.1).for_each(|(k, _)| tree.split(k as u32));
            generation = generation.end..tree.nodes.len();
        }
        tree.balance(most).then_some(tree)
    }

    /// All cells without children.
    pub fn leaves(&self) -> impl Iterator<Item = Leaf<D>> + '_ {
        (0..self.nodes.len() as u32).filter(|k| self.nodes[*k as usize].first_child == NONE).map(|k| self.leaf(k))
    }

    /// Cell `k`, if it has no children.
    pub fn as_leaf(&self, k: u32) -> Option<Leaf<D>> {
        (self.nodes[k as usize].first_child == NONE).then(|| self.leaf(k))
    }

    /// For each cell, true when it is a leaf and all leaves within `reach` times its size around its centre have the
    /// same size.
    pub fn even(&self, reach: f64) -> Vec<bool> {
        let bounds = self.bounds();
        let mut even = vec![false; self.nodes.len()];
        sweep(&mut even, |k| {
            let Some(leaf) = self.as_leaf(k as u32) else { return false };
            let cube = Bounds { min: leaf.centre, max: leaf.centre }.padded(reach * leaf.size);
            let within = |d: usize| bounds.min[d] <= cube.min[d] && cube.max[d] <= bounds.max[d];
            // leaves beyond a periodic side cannot be tested
            let mut even = (0..D).all(|d| !self.periodic[d] || within(d));
            self.overlapping(&cube, |other| even &= self.nodes[other as usize].level == leaf.level);
            even
        });
        even
    }

    /// Integer coordinates of the lower corner of cell `k` on a grid that does not depend on the greatest depth of the
    /// tree. Cells deeper than the grid share the coordinates of the cell that contains them.
    pub fn label(&self, k: u32) -> [u32; D] {
        self.anchor(k).map(|c| c >> (self.max_level - LEVELS[0]))
    }

    /// Number of cells, parents included; every `Leaf::node` is below it.
    pub fn n_nodes(&self) -> usize {
        self.nodes.len()
    }

    /// The box that the tree fills.
    pub fn bounds(&self) -> Bounds<D> {
        let extent = Vector::from_fn(|d| f64::from(self.roots[d]) * self.root_size);
        Bounds { min: self.origin, max: self.origin + extent }
    }

    /// True for the axes along which the box is periodic.
    pub fn periodic(&self) -> [bool; D] {
        self.periodic
    }

    /// The leaf that contains `x`; a point outside the box is moved to its border.
    pub fn leaf_at(&self, x: &Vector<D>) -> Leaf<D> {
        self.leaf(self.find(&self.cell_at(x).map(i64::from)).unwrap_or(0))
    }

    /// Size of the leaf that contains `x`, as of [`leaf_at`](Self::leaf_at). The leaf is looked for in `last` first, the
    /// one of the point before.
    pub fn size_at(&self, x: &Vector<D>, last: &Cell<u32>) -> f64 {
        let cell = self.cell_at(x);
        let node = &self.nodes[last.get() as usize];
        let size = 1u32 << (self.max_level - node.level);
        let within = (0..D).all(|d| cell[d].wrapping_sub(node.anchor[d]) < size);
        if !within || node.first_child != NONE {
            last.set(self.find(&cell.map(i64::from)).unwrap_or(0));
        }
        self.root_size / (1u64 << self.nodes[last.get() as usize].level) as f64
    }

    /// Integer coordinates of the finest possible cell that contains `x`; a point outside the box is moved to its
    /// border.
    pub fn cell_at(&self, x: &Vector<D>) -> [u32; D] {
        let unit = self.unit();
        std::array::from_fn(|d| {
            let top = i64::from(self.roots[d]) << self.max_level;
            (((x[d] - self.origin[d]) / unit).floor() as i64).clamp(0, top - 1) as u32
        })
    }

    /// Calls `f(node)` for every leaf that overlaps `cube`.
    pub fn overlapping(&self, cube: &Bounds<D>, mut f: impl FnMut(u32)) {
        let unit = self.unit();
        let low: [i64; D] = std::array::from_fn(|d| ((cube.min[d] - self.origin[d]) / unit).floor() as i64);
        let high: [i64; D] = std::array::from_fn(|d| ((cube.max[d] - self.origin[d]) / unit).floor() as i64);
        let root = |c: i64, d: usize| (c >> self.max_level).clamp(0, i64::from(self.roots[d]) - 1);
        let mut cell: [i64; D] = std::array::from_fn(|d| root(low[d], d));
        loop {
            let k = (0..D).rev().fold(0, |k, d| k * i64::from(self.roots[d]) + cell[d]);
            if self.meets(k as u32, &low, &high) {
                self.descend(k as u32, &low, &high, &mut f);
            }
            let Some(d) = (0..D).find(|d| cell[*d] < root(high[*d], *d)) else { return };
            cell[d] += 1;
            (0..d).for_each(|e| cell[e] = root(low[e], e));
        }
    }

    fn meets(&self, k: u32, low: &[i64; D], high: &[i64; D]) -> bool {
        let node = &self.nodes[k as usize];
        let size = 1i64 << (self.max_level - node.level);
        (0..D).all(|d| i64::from(node.anchor[d]) <= high[d] && i64::from(node.anchor[d]) + size > low[d])
    }

    /// Visits the leaves below cell `k`, which overlaps the box from `low` to `high`.
    fn descend(&self, k: u32, low: &[i64; D], high: &[i64; D], f: &mut impl FnMut(u32)) {
        let node = &self.nodes[k as usize];
        if node.first_child == NONE {
            f(k);
            return;
        }
        let half = 1i64 << (self.max_level - node.level - 1);
        // bit d: no child on the lower (upper) side of axis d overlaps the box
        let (mut no_lower, mut no_upper) = (0, 0);
        for d in 0..D {
            let middle = i64::from(node.anchor[d]) + half;
            no_lower |= u32::from(low[d] >= middle) << d;
            no_upper |= u32::from(high[d] < middle) << d;
        }
        for c in 0..1u32 << D {
            if c & no_upper == 0 && !c & no_lower == 0 {
                self.descend(node.first_child + c, low, high, f);
            }
        }
    }

    fn unit(&self) -> f64 {
        self.root_size / (1u64 << self.max_level) as f64
    }

    /// Cell `k` as a leaf, whether it has children or not.
    pub fn leaf(&self, k: u32) -> Leaf<D> {
        let node = &self.nodes[k as usize];
        let size = self.root_size / (1u64 << node.level) as f64;
        let unit = self.unit();
        let centre = Vector::from_fn(|d| self.origin[d] + f64::from(node.anchor[d]) * unit + 0.5 * size);
        Leaf { node: k, centre, size, level: node.level }
    }

    /// Integer coordinates of the lower corner of cell `k`.
    pub fn anchor(&self, k: u32) -> [u32; D] {
        self.nodes[k as usize].anchor
    }

    /// The leaf that contains the finest cell `p`, wrapped along periodic axes; `None` outside the box.
    fn find(&self, p: &[i64; D]) -> Option<u32> {
        let mut q = [0u32; D];
        for d in 0..D {
            let top = i64::from(self.roots[d]) << self.max_level;
            let c = if self.periodic[d] { p[d].rem_euclid(top) } else { p[d] };
            if c < 0 || c >= top {
                return None;
            }
            q[d] = c as u32;
        }
        let mut k = (0..D).rev().fold(0, |k, d| k * self.roots[d] + (q[d] >> self.max_level)) as usize;
        while self.nodes[k].first_child != NONE {
            let bit = self.max_level - 1 - self.nodes[k].level;
            let child = (0..D).fold(0, |c, d| c | (q[d] >> bit & 1) << d);
            k = (self.nodes[k].first_child + child) as usize;
        }
        Some(k as u32)
    }

    fn split(&mut self, k: u32) {
        let node = self.nodes[k as usize];
        self.nodes[k as usize].first_child = self.nodes.len() as u32;
        let half = 1u32 << (self.max_level - node.level - 1);
        for c in 0..1u32 << D {
            let anchor = std::array::from_fn(|d| node.anchor[d] + (c >> d & 1) * half);
            self.nodes.push(Node { first_child: NONE, level: node.level + 1, anchor });
        }
    }

    /// Splits cells until touching leaves differ by at most one level: whatever touches a cell that has children must
    /// not be larger than that cell. Returns false when this takes more than `most` cells.
    fn balance(&mut self, most: usize) -> bool {
        // a cell without coarser neighbours keeps none when other cells are split
        let mut unbalanced = vec![false; self.nodes.len()];
        sweep(&mut unbalanced, |k| self.nodes[k].first_child != NONE && !self.coarser(k as u32).is_empty());
        let mut queue: Vec<u32> = (0..self.nodes.len() as u32).filter(|k| unbalanced[*k as usize]).collect();
        while let Some(k) = queue.pop() {
            if self.nodes.len() > most {
                return false;
            }
            let coarse = self.coarser(k);
            if !coarse.is_empty() {
                queue.push(k);
            }
            for j in coarse {
                self.split(j);
                queue.push(j);
            }
        }
        true
    }

    /// Leaves that touch cell `k` and are larger.
    fn coarser(&self, k: u32) -> Vec<u32> {
        let node = &self.nodes[k as usize];
        let size = 1i64 << (self.max_level - node.level);
        let mut coarse = Vec::new();
        for_each_direction(|direction: [i64; D]| {
            let p = std::array::from_fn(|d| i64::from(node.anchor[d]) + direction[d] * size);
            if let Some(j) = self.find(&p)
                && self.nodes[j as usize].level < node.level
                && !coarse.contains(&j)
            {
                coarse.push(j);
            }
        });
        coarse
    }
}

/// Position of root `k` among the roots.
fn root_cell<const D: usize>(k: u32, roots: &[u32; D]) -> [u32; D] {
    let mut rest = k;
    std::array::from_fn(|d| {
        let c = rest % roots[d];
        rest /= roots[d];
        c
    })
}

/// Calls `f` with each of the 3^D − 1 directions to adjacent cells.
fn for_each_direction<const D: usize>(mut f: impl FnMut([i64; D])) {
    for code in 0..3usize.pow(D as u32) {
        let mut rest = code;
        let direction: [i64; D] = std::array::from_fn(|_| {
            let c = (rest % 3) as i64 - 1;
            rest /= 3;
            c
        });
        if direction.iter().any(|c| *c != 0) {
            f(direction);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample() -> Tree<2> {
        let forest = Forest { origin: Vector([-1.0, -1.0]), root_size: 1.0, roots: [2, 2], periodic: [true, false] };
        Tree::build(&forest, usize::MAX, |x, size| size > 0.01 && x.norm() < size).unwrap()
    }

    #[test]
    fn sizes_do_not_depend_on_the_points_before() {
        let tree = sample();
        let last = Cell::new(0);
        for k in 0..2000 {
            let x = Vector([(k as f64 * 0.37).sin() * 1.1, (k as f64 * 0.011).cos() * 1.1]);
            assert_eq!(tree.size_at(&x, &last).to_bits(), tree.leaf_at(&x).size.to_bits(), "{x:?}");
        }
    }

    #[test]
    fn leaves_fill_the_box_and_touching_leaves_differ_by_one_level() {
        let tree = sample();
        let area: f64 = tree.leaves().map(|l| l.size * l.size).sum();
        assert!((area - 4.0).abs() < 1e-12);
        for leaf in tree.leaves() {
            let reach = Vector::splat(leaf.size * 0.5001);
            let cube = Bounds { min: leaf.centre - reach, max: leaf.centre + reach };
            let mut touching = 0;
            tree.overlapping(&cube, |k| {
                touching += 1;
                assert!(tree.leaf(k).level.abs_diff(leaf.level) <= 1);
            });
            assert!((4..=13).contains(&touching));
        }
    }
}
