//! Tree of boxes around surface elements: nearest point, crossing of segments, winding number.
//!
//! The tree is binary, split at the median along the longest side of the centroids' box, so its depth is at most
//! log2(n) + 1 and a fixed stack suffices: queries allocate nothing. Each node also carries the dipole of its elements
//! (Barill, Dickson, Schmidt, Levin, Jacobson, "Fast winding numbers for soups and clouds", ACM TOG 37(4), 2018).
use super::bar::Bar;
use super::simplex::{self, Corners};
use crate::math::{Bounds, Vector};

/// Greatest number of elements in a leaf.
const LEAF: usize = 4;
/// Entries of the traversal stack: depth is below 33 for fewer than 2³² elements, each level leaves one entry behind.
const STACK: usize = 64;
/// A node is far when its distance exceeds its reach by this factor. Barill et al. use 2; with 3 the error
/// of the sum stays below 0.1 (tested), far from what would confuse 0 with 1.
const FAR: f64 = 3.0;

/// Greatest number of elements that a bar is looked for around.
const BARRED: usize = 1024;
/// Number of the bar of a node that has none.
const NONE: u32 = u32::MAX;

/// A node: inner (`count` = 0, children at the next index and at `right`) or leaf.
#[derive(Clone, Debug)]
struct Node<const D: usize> {
    bounds: Bounds<D>,
    first: u32,
    count: u32,
    right: u32,
    bar: u32,
}

/// Sum of area vectors of a node, their mean place and the largest distance of an element from it.
#[derive(Clone, Debug)]
struct Dipole<const D: usize> {
    area: Vector<D>,
    centre: Vector<D>,
    reach: f64,
}

/// The disc around an element in its plane: a cheap lower bound of the distance. Boxes around slanted elements are thick,
/// so near a curved surface ten elements pass the test of their box for one that passes this.
#[derive(Clone, Debug)]
struct Disc<const D: usize> {
    centre: Vector<D>,
    normal: Vector<D>,
    radius: f64,
}

/// Tree over elements. Corners are stored in leaf order, so that a leaf is one read.
#[derive(Clone, Debug)]
pub(super) struct Tree<const D: usize> {
    nodes: Vec<Node<D>>,
    dipoles: Vec<Dipole<D>>,
    discs: Vec<Disc<D>>,
    bars: Vec<Bar<D>>,
    /// Of each node a corner that all its elements share, as the triangles of a fan do.
    apices: Vec<Option<Vector<D>>>,
    /// Of each node the greatest number of an element.
    lasts: Vec<u32>,
    corners: Vec<Corners<D>>,
    order: Vec<u32>,
}

/// The corner that all elements share.
fn apex<const D: usize>(elements: &[Corners<D>], items: &[(u32, Vector<D>)]) -> Option<Vector<D>> {
    let first = &elements[items.first()?.0 as usize];
    first.iter().copied().find(|x| items.iter().all(|i| elements[i.0 as usize].contains(x)))
}

/// Result of a search: element, barycentric weights, square of the distance.
pub(super) struct Hit<const D: usize> {
    pub(super) element: u32,
    pub(super) weights: [f64; D],
    pub(super) distance_squared: f64,
}

impl<const D: usize> Tree<D> {
    /// Builds the tree over `elements`.
    pub(super) fn new(elements: &[Corners<D>]) -> Self {
        let mut items: Vec<(u32, Vector<D>)> =
            elements.iter().enumerate().map(|(e, c)| (e as u32, simplex::centroid(c))).collect();
        let mut tree = Self {
            nodes: Vec::new(),
            dipoles: Vec::new(),
            discs: Vec::new(),
            bars: Vec::new(),
            apices: Vec::new(),
            lasts: Vec::new(),
            corners: Vec::new(),
            order: Vec::new(),
        };
        if !items.is_empty() {
            tree.split(elements, &mut items, 0);
        }
        tree.order = items.iter().map(|item| item.0).collect();
        tree.corners = tree.order.iter().map(|&e| elements[e as usize]).collect();
        tree.discs = tree.corners.iter().map(Disc::around).collect();
        tree
    }

    fn split(&mut self, elements: &[Corners<D>], items: &mut [(u32, Vector<D>)], first: usize) {
        let bounds =
            items.iter().fold(Bounds::EMPTY, |b: Bounds<D>, i| b.union(&simplex::bounds(&elements[i.0 as usize])));
        let index = self.nodes.len();
        self.dipoles.push(Dipole::of(elements, items));
        let bar = self.bar_around(elements, items);
        self.apices.push(apex(elements, items));
        self.lasts.push(items.iter().map(|item| item.0).max().unwrap_or(0));
        self.nodes.push(Node { bounds, first: first as u32, count: items.len() as u32, right: 0, bar });
        if items.len() <= LEAF {
            return;
        }
        let extent = Bounds::around(items.iter().map(|i| &i.1)).extent();
        let axis = (0..D).fold(0, |a, d| if extent[d] > extent[a] { d } else { a });
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| a.1[axis].total_cmp(&b.1[axis]).then(a.0.cmp(&b.0)));
        let (left, right) = items.split_at_mut(half);
        self.split(elements, left, first);
        self.nodes[index].count = 0;
        self.nodes[index].right = self.nodes.len() as u32;
        self.split(elements, right, first + half);
    }

    /// Makes a bar around slivers that lie side by side and tells its number.
    fn bar_around(&mut self, elements: &[Corners<D>], items: &[(u32, Vector<D>)]) -> u32 {
        let own = items.iter().map(|i| elements[i.0 as usize]);
        let Some(bar) = Some(own).filter(|_| items.len() <= BARRED).and_then(Bar::around) else { return NONE };
        self.bars.push(bar);
        self.bars.len() as u32 - 1
    }

    fn bar(&self, node: &Node<D>) -> Option<&Bar<D>> {
        if node.bar == NONE { None } else { self.bars.get(node.bar as usize) }
    }

    /// The element nearest to `x` among those nearer than `within`.
    pub(super) fn nearest(&self, x: &Vector<D>, within: f64) -> Option<Hit<D>> {
        let mut best = within * within;
        let mut hit = None;
        let mut stack = [(0_u32, 0.0_f64); STACK];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (index, gap) = stack[depth];
            if gap >= best {
                continue;
            }
            let node = &self.nodes[index as usize];
            if self.bar(node).is_some_and(|bar| bar.distance_squared(x) >= best) {
                continue;
            }
            if node.count > 0 {
                self.nearest_in_leaf(node, x, &mut best, &mut hit);
                continue;
            }
            let left = (index + 1, self.nodes[index as usize + 1].bounds.distance_squared(x));
            let right = (node.right, self.nodes[node.right as usize].bounds.distance_squared(x));
            let (near, far) = if left.1 <= right.1 { (left, right) } else { (right, left) };
            for child in [far, near] {
                if child.1 < best {
                    stack[depth] = child;
                    depth += 1;
                }
            }
        }
        hit
    }

    #[inline]
    fn nearest_in_leaf(&self, node: &Node<D>, x: &Vector<D>, best: &mut f64, hit: &mut Option<Hit<D>>) {
        for slot in node.first as usize..(node.first + node.count) as usize {
            if self.discs[slot].distance_squared(x) > *best {
                continue;
            }
            let corners = &self.corners[slot];
            let weights = simplex::closest(x, corners);
            let distance_squared = (simplex::blend(corners, &weights) - *x).norm_squared();
            if distance_squared < *best {
                *best = distance_squared;
                *hit = Some(Hit { element: self.order[slot], weights, distance_squared });
            }
        }
    }

    /// True when the open segment from `a` to `b` passes through an element.
    pub(super) fn crosses(&self, a: &Vector<D>, b: &Vector<D>) -> bool {
        let (middle, half) = ((*a + *b) * 0.5, (*b - *a) * 0.5);
        let mut found = false;
        let along = |bar: &Bar<D>| {
            let (middle, half, bounds) = bar.segment(&middle, &half);
            segment_meets_box(&middle, &half, &bounds)
        };
        self.visit(
            |_, node| segment_meets_box(&middle, &half, &node.bounds) && self.bar(node).is_none_or(along),
            |_, corners| {
                found = simplex::crosses(a, b, corners);
                found
            },
        );
        found
    }

    /// Largest height n·y along `direction` of elements whose leaf overlaps `bounds`; −∞ without any.
    pub(super) fn highest(&self, direction: &Vector<D>, bounds: &Bounds<D>) -> f64 {
        let mut best = f64::NEG_INFINITY;
        let mut stack = [(0_u32, f64::INFINITY); STACK];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let (index, top) = stack[depth];
            let node = &self.nodes[index as usize];
            if top <= best || !meets(&node.bounds, bounds) {
                continue;
            }
            if node.count > 0 {
                let leaf = node.first as usize..(node.first + node.count) as usize;
                best = self.corners[leaf].iter().flatten().map(|c| direction.dot(c)).fold(best, f64::max);
                continue;
            }
            let child = |k: u32| (k, support(&self.nodes[k as usize].bounds, direction));
            let (left, right) = (child(index + 1), child(node.right));
            (stack[depth], stack[depth + 1]) = if left.1 < right.1 { (left, right) } else { (right, left) };
            depth += 2;
        }
        best
    }

    /// Calls `f(element, corners)` for elements whose leaf overlaps `bounds`, until it returns true.
    pub(super) fn overlapping(&self, bounds: &Bounds<D>, f: impl FnMut(u32, &Corners<D>) -> bool) {
        self.visit(|_, node| meets(&node.bounds, bounds), f);
    }

    /// Calls `f(element, corners)` for elements numbered from `from` that may meet the one with `corners`, until it returns true; some of smaller
    /// numbers are among them, and many of those that share a corner with it are passed over.
    pub(super) fn meeting(&self, from: u32, corners: &Corners<D>, f: impl FnMut(u32, &Corners<D>) -> bool) {
        let bounds = simplex::bounds(corners);
        let normal = simplex::area_vector(corners);
        let enter = |index: u32, node: &Node<D>| {
            self.lasts[index as usize] >= from
                && meets(&node.bounds, &bounds)
                && !simplex::is_box_beside(&node.bounds, &normal, &corners[0])
                && self.apices[index as usize].is_none_or(|apex| !corners.contains(&apex))
                && self.bar(node).is_none_or(|bar| !bar.misses(corners))
        };
        self.visit(enter, f);
    }

    fn visit(&self, enter: impl Fn(u32, &Node<D>) -> bool, mut f: impl FnMut(u32, &Corners<D>) -> bool) {
        let mut stack = [0_u32; STACK];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let index = stack[depth];
            let node = &self.nodes[index as usize];
            if !enter(index, node) {
                continue;
            }
            if node.count == 0 {
                stack[depth] = node.right;
                stack[depth + 1] = index + 1;
                depth += 2;
                continue;
            }
            for slot in node.first as usize..(node.first + node.count) as usize {
                if f(self.order[slot], &self.corners[slot]) {
                    return;
                }
            }
        }
    }

    /// Generalised winding number at `x`: 1 inside a closed surface, 0 outside, in between near the holes of an open one.
    pub(super) fn winding(&self, x: &Vector<D>) -> f64 {
        let mut sum = 0.0;
        let mut stack = [0_u32; STACK];
        let mut depth = usize::from(!self.nodes.is_empty());
        while depth > 0 {
            depth -= 1;
            let index = stack[depth];
            let (node, dipole) = (&self.nodes[index as usize], &self.dipoles[index as usize]);
            let offset = dipole.centre - *x;
            let distance = offset.norm();
            if distance > FAR * dipole.reach {
                sum += simplex::winding_far(&offset, distance, &dipole.area);
            } else if node.count > 0 {
                let leaf = node.first as usize..(node.first + node.count) as usize;
                sum += self.corners[leaf].iter().map(|c| simplex::winding(x, c)).sum::<f64>();
            } else {
                stack[depth] = node.right;
                stack[depth + 1] = index + 1;
                depth += 2;
            }
        }
        sum
    }
}

impl<const D: usize> Disc<D> {
    fn around(c: &Corners<D>) -> Self {
        let centre = simplex::centroid(c);
        let radius = c.iter().fold(0.0_f64, |r, p| r.max((*p - centre).norm()));
        Self { centre, normal: simplex::area_vector(c).unit(), radius }
    }

    /// Square of the distance from `x` to the disc, from below: height above the plane and distance beyond the rim.
    #[inline]
    fn distance_squared(&self, x: &Vector<D>) -> f64 {
        // Rounding must not put the disc farther away than its element.
        const BELOW: f64 = 1.0 - 1e-9;
        let offset = *x - self.centre;
        let height = offset.dot(&self.normal);
        let height2 = height * height;
        let beyond = (offset.norm_squared() - height2).max(0.0).sqrt() - self.radius;
        (height2 + beyond.max(0.0) * beyond.max(0.0)) * BELOW
    }
}

impl<const D: usize> Dipole<D> {
    fn of(elements: &[Corners<D>], items: &[(u32, Vector<D>)]) -> Self {
        let (mut area, mut centre, mut total) = (Vector::ZERO, Vector::ZERO, 0.0);
        for (e, middle) in items {
            let a = simplex::area_vector(&elements[*e as usize]);
            let size = a.norm();
            area += a;
            centre += *middle * size;
            total += size;
        }
        let centre = if total > 0.0 { centre * (1.0 / total) } else { items[0].1 };
        let corners = items.iter().flat_map(|i| elements[i.0 as usize].iter());
        let reach = corners.fold(0.0_f64, |r, p| r.max((*p - centre).norm_squared())).sqrt();
        Self { area, centre, reach }
    }
}

fn meets<const D: usize>(a: &Bounds<D>, b: &Bounds<D>) -> bool {
    (0..D).all(|d| a.min[d] <= b.max[d] && b.min[d] <= a.max[d])
}

/// Largest n·y over a box.
fn support<const D: usize>(bounds: &Bounds<D>, n: &Vector<D>) -> f64 {
    (0..D).map(|d| (n[d] * bounds.min[d]).max(n[d] * bounds.max[d])).sum()
}

/// Separating axes of a segment (`middle` ± `half`) and a box: the coordinate axes and their products with the segment.
fn segment_meets_box<const D: usize>(middle: &Vector<D>, half: &Vector<D>, bounds: &Bounds<D>) -> bool {
    // Rounding of the products must not separate what touches.
    const SLACK: f64 = 1e-12;
    let m = *middle - bounds.centre();
    let slack = SLACK * (middle.max_abs() + half.max_abs() + bounds.max.max_abs());
    let e = bounds.extent() * 0.5 + Vector::splat(slack);
    for i in 0..D {
        if m[i].abs() > e[i] + half[i].abs() {
            return false;
        }
        for j in i + 1..D {
            let reach = e[i] * half[j].abs() + e[j] * half[i].abs();
            if (m[i] * half[j] - m[j] * half[i]).abs() > reach {
                return false;
            }
        }
    }
    true
}
