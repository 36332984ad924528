//! Sampling of a surface, for refinement sources and interface particles.
use super::shell::Exact;
use super::simplex::{self, CurvedPatch};
use super::surface::{Element, Surface};
use crate::math::Vector;
use crate::math::parallel::sweep_each;

/// Number of elements that one parallel task samples.
const GROUP: usize = 256;
/// Ratio of longest to shortest side above which a triangle is a sliver, for which bisection of the longest side is
/// inefficient.
const SLIVER: f64 = 4.0;

/// A smooth piece of outline: consecutive elements, each starting at the end of the previous one.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Indices of the elements.
    pub elements: Vec<u32>,
    /// True when the last element is connected to the first without a sharp corner.
    pub closed: bool,
}

impl<const D: usize> Surface<D> {
    /// Element number `element`.
    pub fn element(&self, element: u32) -> &Element<D> {
        &self.elements[element as usize]
    }

    /// The outlines of a 2-D surface, cut at sharp corners; empty in 3-D.
    pub fn chains(&self) -> Vec<Chain> {
        if D != 2 {
            return Vec::new();
        }
        let n = self.elements.len();
        let mut starts_at = vec![u32::MAX; self.vertices.len()];
        self.elements.iter().zip(0u32..).for_each(|(e, k)| starts_at[e.vertices[0] as usize] = k);
        let follower = |e: u32| starts_at[self.elements[e as usize].vertices[D - 1] as usize];
        let mut sharp = vec![false; n];
        self.sharp.iter().for_each(|c| sharp[self.after_corner(&c.elements) as usize] = true);
        let mut used = vec![false; n];
        let mut chains = Vec::new();
        let heads = (0..n as u32).filter(|e| sharp[*e as usize]);
        for head in heads.chain(0..n as u32).collect::<Vec<_>>() {
            let mut elements = Vec::new();
            let mut e = head;
            while e != u32::MAX && !used[e as usize] && (elements.is_empty() || !sharp[e as usize]) {
                used[e as usize] = true;
                elements.push(e);
                e = follower(e);
            }
            if !elements.is_empty() {
                chains.push(Chain { closed: e == head && !sharp[head as usize], elements });
            }
        }
        chains
    }

    /// Of the two elements at a corner, the one that starts there.
    fn after_corner(&self, pair: &[u32; 2]) -> u32 {
        let [a, b] = *pair;
        let (first, second) = (&self.elements[a as usize].vertices, &self.elements[b as usize].vertices);
        if first[D - 1] == second[0] { b } else { a }
    }

    /// Evaluates `f(x, radius of curvature)` at points of the surface with distances of at most about `size`.
    pub fn samples<T: Clone + Send>(&self, size: f64, f: impl Fn(&Vector<D>, f64) -> T + Sync) -> Vec<T> {
        self.pieces(|_| size, |x, _, _, e| Some(f(x, self.radius[e as usize])))
    }

    /// Calls `f(x)` at points along edges that turn by more than `angle` (rad), at most `spacing` apart.
    pub fn for_each_sharp_point(&self, angle: f64, spacing: f64, mut f: impl FnMut(&Vector<D>)) {
        for edge in self.sharp.iter().filter(|e| e.turn.abs() > angle) {
            let along = edge.ends[1] - edge.ends[0];
            let n = (along.norm() / spacing).ceil().max(1.0) as usize;
            (0..=n).for_each(|k| f(&(edge.ends[0] + along * (k as f64 / n as f64))));
        }
    }

    /// Evaluates `f(x, normal, share of the element, element)` for pieces of the surface no larger than `size(x)`,
    /// element by element.
    pub fn pieces<T: Clone + Send>(
        &self,
        size: impl Fn(&Vector<D>) -> f64 + Sync,
        f: impl Fn(&Vector<D>, &Vector<D>, f64, u32) -> Option<T> + Sync,
    ) -> Vec<T> {
        let groups = self.grouped_pieces(|x, ()| size(x), |x, normal, share, e, ()| f(x, normal, share, e));
        // one after the other, to avoid two copies of the whole list
        let mut all = Vec::with_capacity(groups.iter().map(Vec::len).sum());
        groups.into_iter().for_each(|found| all.extend(found));
        all
    }

    /// The same in groups of consecutive elements. Both functions of a group get what it remembers from one call to the
    /// next, such as the place of the last point in a tree.
    pub fn grouped_pieces<T: Clone + Send, M: Default>(
        &self,
        size: impl Fn(&Vector<D>, &M) -> f64 + Sync,
        f: impl Fn(&Vector<D>, &Vector<D>, f64, u32, &M) -> Option<T> + Sync,
    ) -> Vec<Vec<T>> {
        let n = self.elements.len();
        let mut groups = vec![Vec::new(); n.div_ceil(GROUP)];
        sweep_each(&mut groups, |g| {
            let (mut found, memory) = (Vec::new(), M::default());
            for e in (g * GROUP) as u32..n.min((g + 1) * GROUP) as u32 {
                let mut keep = |x: &_, normal: &_, share| found.extend(f(x, normal, share, e, &memory));
                self.subdivide(e, &|x| size(x, &memory), &mut keep);
            }
            found
        });
        groups
    }

    /// Bisects an element across its longest side until the parts are small enough; points lie on the exact shape.
    fn subdivide(&self, e: u32, size: &dyn Fn(&Vector<D>) -> f64, f: &mut dyn FnMut(&Vector<D>, &Vector<D>, f64)) {
        let shape = Shape::of(self, e);
        let corners = self.corners(e);
        if let Some(bands) = Bands::along(&corners) {
            return bands.cut(size, &mut |weights, share| shape.give(&weights, share, f));
        }
        let identity: [[f64; D]; D] = std::array::from_fn(|r| std::array::from_fn(|c| if r == c { 1.0 } else { 0.0 }));
        let mut stack = vec![(identity, 1.0)];
        while let Some((w, share)) = stack.pop() {
            let at = |w: &[f64; D]| (0..D).fold(Vector::ZERO, |x, k| x + corners[k] * w[k]);
            let middle: [f64; D] = std::array::from_fn(|c| (0..D).map(|r| w[r][c]).sum::<f64>() / D as f64);
            let points = w.map(|w| at(&w));
            let mut longest = (0, 1, 0.0);
            for a in 0..D {
                for b in a + 1..D {
                    let l = (points[a] - points[b]).norm();
                    if l > longest.2 {
                        longest = (a, b, l);
                    }
                }
            }
            if longest.2 > size(&at(&middle)) {
                let half: [f64; D] = std::array::from_fn(|c| 0.5 * (w[longest.0][c] + w[longest.1][c]));
                for replaced in [longest.0, longest.1] {
                    let mut child = w;
                    child[replaced] = half;
                    stack.push((child, 0.5 * share));
                }
                continue;
            }
            shape.give(&middle, share, f);
        }
    }
}

/// The shape that an element approximates, as [`Surface::project`] gives it.
struct Shape<'a, const D: usize> {
    corners: [Vector<D>; D],
    normals: &'a [Vector<D>; D],
    exact: Exact<D>,
    patch: CurvedPatch<D>,
}

impl<'a, const D: usize> Shape<'a, D> {
    fn of(surface: &'a Surface<D>, e: u32) -> Self {
        let (corners, element) = (surface.corners(e), surface.element(e));
        let exact = surface.exact[usize::from(element.body)];
        Self { corners, normals: &element.normals, exact, patch: CurvedPatch::new(&corners, &element.normals) }
    }

    /// Calls `f` with the point of the shape at these barycentric weights and with its share of the element.
    fn give(&self, weights: &[f64; D], share: f64, f: &mut dyn FnMut(&Vector<D>, &Vector<D>, f64)) {
        if let Exact::Ball { centre, radius } = self.exact {
            let normal = (simplex::blend(&self.corners, weights) - centre).unit();
            return f(&(centre + normal * radius), &normal, share);
        }
        f(&self.patch.at(weights), &simplex::blend(self.normals, weights).unit(), share);
    }
}

/// A sliver x(s, c) = A + s ((1 - c) (B - A) + c (C - A)), whose shortest side is BC. Cells in s and c stay compact
/// where halves of triangles do not. A cell has the share (s₁² - s₀²) (c₁ - c₀) of the area.
struct Bands<'a, const D: usize> {
    corners: &'a [Vector<D>; D],
    apex: usize,
    length: f64,
    width: f64,
}

impl<'a, const D: usize> Bands<'a, D> {
    /// The bands of a triangle, if it is a sliver.
    fn along(corners: &'a [Vector<D>; D]) -> Option<Self> {
        if D != 3 {
            return None;
        }
        let across = |apex: usize| (corners[(apex + 1) % D] - corners[(apex + 2) % D]).norm();
        let apex = (0..D).fold(0, |best, k| if across(k) < across(best) { k } else { best });
        let length = (0..D).map(across).fold(0.0, f64::max);
        (length > SLIVER * across(apex)).then(|| Self { corners, apex, length, width: across(apex) })
    }

    fn weights(&self, s: f64, c: f64) -> [f64; D] {
        let mut w = [0.0; D];
        (w[self.apex], w[(self.apex + 1) % D], w[(self.apex + 2) % D]) = (1.0 - s, s * (1.0 - c), s * c);
        w
    }

    /// Bisects cells until each is no larger than `size` at its centre; passes on the barycentric weights of the centre
    /// and its share of the area.
    fn cut(&self, size: &dyn Fn(&Vector<D>) -> f64, f: &mut dyn FnMut([f64; D], f64)) {
        let mut stack = vec![([0.0, 1.0], [0.0, 1.0])];
        while let Some(([s0, s1], [c0, c1])) = stack.pop() {
            let middle = 2.0 / 3.0 * (s0 * s0 + s0 * s1 + s1 * s1) / (s0 + s1);
            let w = self.weights(middle, 0.5 * (c0 + c1));
            let (along, across) = ((s1 - s0) * self.length, s1 * (c1 - c0) * self.width);
            if along.hypot(across) <= size(&(0..D).fold(Vector::ZERO, |x, k| x + self.corners[k] * w[k])) {
                f(w, (s1 * s1 - s0 * s0) * (c1 - c0));
            } else if along >= across {
                let half = 0.5 * (s0 + s1);
                stack.extend([([s0, half], [c0, c1]), ([half, s1], [c0, c1])]);
            } else {
                let half = 0.5 * (c0 + c1);
                stack.extend([([s0, s1], [c0, half]), ([s0, s1], [half, c1])]);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_lie_on_the_shape_of_the_surface() {
        let surface = Surface::new(&[("ball".to_owned(), super::super::icosphere(0.5, 1))]);
        let pieces = surface.pieces(|_| 0.1, |x, normal, _, e| Some((*x, *normal, e)));
        assert!(pieces.len() > 2 * surface.elements.len());
        for (x, normal, e) in pieces {
            let near = surface.nearest(&x, 0.1).unwrap();
            assert!(near.distance < 0.05 && (normal - x.unit()).norm() < 0.05, "{x:?} {e}");
        }
    }

    #[test]
    fn slivers_are_cut_into_pieces_that_grow_with_their_length() {
        let corners = [Vector([0.0, 0.0, 0.0]), Vector([5.0, 1.0, 0.0]), Vector([5.0, 1.004, 0.0])];
        let mut area = 0.0;
        let mut centre = Vector::<3>::ZERO;
        let mut pieces = 0;
        Bands::along(&corners).expect("a sliver").cut(&|_| 0.01, &mut |w, share| {
            (area, pieces) = (area + share, pieces + 1);
            centre += (0..3).fold(Vector::ZERO, |x, k| x + corners[k] * w[k]) * share;
        });
        assert!((area - 1.0).abs() < 1e-12 && pieces <= 1024, "{area} {pieces}");
        assert!((centre - (corners[0] + corners[1] + corners[2]) * (1.0 / 3.0)).norm() < 1e-12);
    }
}
