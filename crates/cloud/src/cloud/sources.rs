//! Refinement sources: points and boxes that limit the size of the background cells around them.
//!
//! A source at x_k with spacing h_k and `layers` n splits every cell of size s > h_k whose centre is nearer than (n/2 +
//! 0.87) s. This leaves about n cells of each size before the next coarser size begins.
use crate::math::{Bounds, Vector};

/// Number of points in a leaf of the search tree.
const BUCKET: usize = 8;
/// Half the diagonal of the unit cube: the extent of the cell itself.
const HALF_DIAGONAL: f64 = 0.87;
/// Relative tolerance for the comparison of sizes that are powers of two apart.
pub(super) const SIZE_SLACK: f64 = 1.001;

/// A point around which the cells must not be larger than a spacing.
#[derive(Clone, Copy, Debug)]
pub struct Source<const D: usize> {
    /// Position, in the unit of the geometry.
    pub x: Vector<D>,
    /// Greatest cell size around the point.
    pub spacing: f64,
    /// Number of cells of each size around the point.
    pub layers: f64,
}

/// A box in which the cells must not be larger than `spacing`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourceBox<const D: usize> {
    /// Extent of the box.
    pub bounds: Bounds<D>,
    /// Greatest cell size in the box.
    pub spacing: f64,
}

struct Node<const D: usize> {
    bounds: Bounds<D>,
    spacing: f64,
    layers: f64,
    from: u32,
    to: u32,
    right: u32,
}

/// Refinement sources in a bounding-volume tree.
pub struct Sources<const D: usize> {
    points: Vec<Source<D>>,
    boxes: Vec<SourceBox<D>>,
    nodes: Vec<Node<D>>,
}

impl<const D: usize> Sources<D> {
    /// Builds the tree of the sources.
    pub fn new(mut points: Vec<Source<D>>, boxes: Vec<SourceBox<D>>) -> Self {
        let mut nodes = Vec::new();
        if !points.is_empty() {
            let n = points.len();
            build(&mut points, 0, n, &mut nodes);
        }
        Self { points, boxes, nodes }
    }

    /// True when a cell of this size around `centre` must be split.
    pub fn split(&self, centre: &Vector<D>, size: f64) -> bool {
        self.split_by_box(centre, size) || (!self.nodes.is_empty() && self.split_by_point(centre, size))
    }

    fn split_by_box(&self, centre: &Vector<D>, size: f64) -> bool {
        let reach = 0.5 * size * (1.0 - 1e-9);
        self.boxes.iter().any(|b| {
            size > SIZE_SLACK * b.spacing
                && (0..D).all(|d| centre[d] + reach > b.bounds.min[d] && centre[d] - reach < b.bounds.max[d])
        })
    }

    fn split_by_point(&self, centre: &Vector<D>, size: f64) -> bool {
        let mut stack = [0u32; 64];
        let mut top = 1;
        while top > 0 {
            top -= 1;
            let k = stack[top];
            let node = &self.nodes[k as usize];
            let reach = (0.5 * node.layers + HALF_DIAGONAL) * size;
            if size <= SIZE_SLACK * node.spacing || node.bounds.distance_squared(centre) > reach * reach {
                continue;
            }
            if node.right == 0 {
                if self.points[node.from as usize..node.to as usize].iter().any(|p| wants(p, centre, size)) {
                    return true;
                }
            } else {
                stack[top] = node.right;
                stack[top + 1] = k + 1;
                top += 2;
            }
        }
        false
    }
}

fn wants<const D: usize>(p: &Source<D>, centre: &Vector<D>, size: f64) -> bool {
    let reach = (0.5 * p.layers + HALF_DIAGONAL) * size;
    size > SIZE_SLACK * p.spacing && (p.x - *centre).norm_squared() < reach * reach
}

fn build<const D: usize>(points: &mut [Source<D>], from: usize, to: usize, nodes: &mut Vec<Node<D>>) {
    let own = &mut points[from..to];
    let bounds = Bounds::around(own.iter().map(|p| &p.x));
    let spacing = own.iter().fold(f64::INFINITY, |m, p| m.min(p.spacing));
    let layers = own.iter().fold(0.0f64, |m, p| m.max(p.layers));
    let at = nodes.len();
    nodes.push(Node { bounds, spacing, layers, from: from as u32, to: to as u32, right: 0 });
    if to - from <= BUCKET {
        return;
    }
    let extent = bounds.extent();
    let axis = (0..D).fold(0, |a, d| if extent[d] > extent[a] { d } else { a });
    let middle = (to - from) / 2;
    own.select_nth_unstable_by(middle, |p, q| p.x[axis].total_cmp(&q.x[axis]));
    build(points, from, from + middle, nodes);
    nodes[at].right = nodes.len() as u32;
    build(points, from + middle, to, nodes);
}
