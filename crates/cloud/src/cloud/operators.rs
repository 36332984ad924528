//! Derivative weights and the edges of the cloud.
//!
//! ∇f_i = Σ_j a_ij (f_j − f_i) by a linear least-squares fit with the weights 1/r² (eqs (10)-(15)). The scheme loops
//! over *edges*: pairs of neighbouring particles, each with the antisymmetric area vector s_ij = V_i a_ij − V_j a_ji
//! that weights the upwind dissipation. The derivative weights a_ij and a_ji follow from one small matrix per row. On a
//! uniform lattice, s_ij = 2 V a_ij, and a single set of coefficients remains.
//!
//! The rows are divided into contiguous *parts*. An edge inside a part is visited once and contributes to both ends; an
//! edge between two parts is stored in both. Every part writes its own rows only, so that results do not depend on the
//! number of threads.
use std::ops::Range;

use super::{Cloud, Ghost, Transform};
use crate::math::Vector;
use crate::math::least_squares::{bounded_inverse, gradient_weight, normal_inverse, normal_matrix};
use crate::math::parallel::{parts, sweep, sweep_each, sweep_each_slot, sweep_parts, sweep_two_parts};
use crate::math::square::{Symmetric, cofactors, determinant};

/// Minimum and maximum number of rows of a part, in 2-D and in 3-D: large enough that few edges are visited twice (with
/// 4,096 rows in 3-D, a quarter of the edges), small enough to fit into the second-level cache and to balance threads.
const PART: [[usize; 2]; 2] = [[1024, 8192], [4096, 16384]];
/// Minimum number of parts of a large cloud.
const MANY_PARTS: usize = 32;
/// Flag of an edge whose second end lies in the same part.
const BOTH: u32 = 1 << 31;
/// Flag of an edge whose second end is a particle, not an image, and has the first end as a neighbour.
const SEEN_BACK: u32 = 1 << 30;

/// A pair of neighbouring particles with its area vector.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Edge<const D: usize> {
    i: u32,
    j: u32,
    /// Area vector s_ij = V_i a_ij − V_j a_ji [length^(D−1)].
    pub s: Vector<D>,
}

impl<const D: usize> Edge<D> {
    /// The edge from `i` to `j` with the area vector `s`, whose visit contributes to both ends.
    pub fn of_both(i: u32, j: u32, s: Vector<D>) -> Self {
        Self { i, j: j | BOTH, s }
    }

    /// Index of the first end.
    #[inline(always)]
    pub fn i(&self) -> usize {
        self.i as usize
    }

    /// Index of the second end.
    #[inline(always)]
    pub fn j(&self) -> usize {
        (self.j & !(BOTH | SEEN_BACK)) as usize
    }

    /// True when the second end is a particle, not an image, and has the first end as a neighbour.
    #[inline(always)]
    pub fn seen_back(&self) -> bool {
        self.j & SEEN_BACK != 0
    }

    /// True when a visit of this edge contributes to the second end as well.
    #[inline(always)]
    pub fn both(&self) -> bool {
        self.j & BOTH != 0
    }
}

/// Derivative weights a_ij and a_ji at both ends of the edges of a part [1/length]. The weight is zero at an end that
/// has no neighbour list or to which the visit does not contribute.
#[derive(Clone, Copy)]
pub struct Weights<'a, const D: usize> {
    /// For each row, the matrix that maps an offset divided by its square to a weight, where offsets are plain
    /// differences.
    inverse: &'a [Symmetric<D>],
    /// For each edge, the stored weights of both ends, where offsets are not plain differences (wall layers).
    stored: &'a [[Vector<D>; 2]],
}

impl<'a, const D: usize> Weights<'a, D> {
    /// Weights given for each edge, in the order of the edges.
    pub fn stored(stored: &'a [[Vector<D>; 2]]) -> Self {
        Self { inverse: &[], stored }
    }

    /// Weights at both ends of the `n`-th edge `e` of the part, where `d` is the offset from its first to its second
    /// end.
    #[inline(always)]
    pub fn of(&self, n: usize, e: &Edge<D>, d: &Vector<D>) -> [Vector<D>; 2] {
        if let Some(pair) = self.stored.get(n) {
            return *pair;
        }
        let back = e.both() && e.seen_back();
        let a_j = if back { gradient_weight(&self.inverse[e.j()].full(), &-*d) } else { Vector::ZERO };
        [gradient_weight(&self.inverse[e.i()].full(), d), a_j]
    }
}

/// Edges and derivative weights of a cloud.
#[derive(Clone, Debug)]
pub struct Operators<const D: usize> {
    /// Rows of each part; the parts of fluid particles come first, then those of interface particles.
    pub parts: Vec<Range<usize>>,
    /// Number of parts of fluid particles.
    pub n_fluid_parts: usize,
    /// Edges of each part.
    edges: Vec<Vec<Edge<D>>>,
    /// Inverse normal matrix of each row, from which weights follow; empty where there are layers.
    inverse: Vec<Symmetric<D>>,
    /// Weights at both ends of each edge, for each part; empty where there are no layers.
    stored: Vec<Vec<[Vector<D>; 2]>>,
    /// Condition number of the normal matrix of each row; infinite where the neighbours do not determine a gradient.
    pub condition: Vec<f32>,
    /// True when the area vectors are exactly conservative (module `conservative`).
    pub conservative: bool,
    walls: Vec<WallFace<D>>,
    wall_first: Vec<u32>,
}

/// A piece of wall that bounds the volume of one fluid particle; used by conservative coefficients only.
#[derive(Clone, Copy, Debug)]
pub struct WallFace<const D: usize> {
    /// Index of the fluid particle.
    pub i: u32,
    /// Index of the interface particle, or of an image of one, whose pressure acts on the fluid particle.
    pub wall: u32,
    /// Area vector, directed out of the fluid [length^(D−1)].
    pub area: Vector<D>,
}

impl<const D: usize> Operators<D> {
    /// Computes the edges and the weights of all rows of a cloud.
    pub fn new(cloud: &Cloud<D>) -> Self {
        let lookup = Reverse::new(cloud);
        let [fewest, most] = PART[usize::from(D == 3)];
        let size = (cloud.n_fluid / MANY_PARTS).clamp(fewest, most);
        let mut all = parts(cloud.n_fluid, size);
        let n_fluid_parts = all.len();
        let start = cloud.n_fluid;
        all.extend(parts(cloud.interface.len(), size).into_iter().map(|p| p.start + start..p.end + start));
        let mut edges = vec![Vec::new(); all.len()];
        sweep_each(&mut edges, |k| part_edges(cloud, &lookup, &all[k]));
        let (walls, wall_first) = (Vec::new(), vec![0; n_fluid_parts + 1]);
        let mut operators = Self {
            parts: all,
            n_fluid_parts,
            edges,
            inverse: Vec::new(),
            stored: Vec::new(),
            condition: Vec::new(),
            conservative: false,
            walls,
            wall_first,
        };
        operators.fit(cloud, &lookup);
        operators
    }

    /// Recomputes the weights for new positions of the particles of `cloud`, with the same neighbour lists and volumes.
    /// The coefficients are then no longer conservative unless [`Operators::metric_update`] follows.
    pub fn refit(&mut self, cloud: &Cloud<D>) {
        self.conservative = false;
        self.walls.clear();
        self.wall_first.fill(0);
        self.fit(cloud, &Reverse::new(cloud));
    }

    fn fit(&mut self, cloud: &Cloud<D>, lookup: &Reverse<'_, D>) {
        if cloud.layers.is_empty() {
            self.fit_by_edges(cloud);
            let inverse = &self.inverse;
            sweep_each_slot(&mut self.edges, |_, edges| {
                edges.iter_mut().for_each(|e| match e.j() < cloud.n_real() {
                    true => e.weigh(cloud, inverse),
                    false => e.s = weights(cloud, |i| inverse[i].full(), lookup, (e.i(), e.j())).1,
                });
            });
            return;
        }
        let inverse = self.fit_by_rows(cloud);
        self.stored.resize(self.parts.len(), Vec::new());
        let mut both: Vec<_> = self.edges.iter_mut().zip(&mut self.stored).collect();
        sweep_each_slot(&mut both, |_, (edges, stored)| {
            stored.clear();
            stored.extend(edges.iter_mut().map(|e| {
                let (pair, s) = weights(cloud, |i| inverse[i], lookup, (e.i(), e.j()));
                e.s = s;
                pair
            }));
        });
    }

    /// Computes the inverse normal matrices where offsets are plain differences. The offsets at the two ends of an edge
    /// are opposite and contribute equally to both matrices, so that a loop over edges suffices.
    fn fit_by_edges(&mut self, cloud: &Cloud<D>) {
        let n = cloud.neighbours.len();
        self.inverse.resize(n, Symmetric::ZERO);
        self.condition.resize(n, 0.0);
        let (parts, edges) = (&self.parts, &self.edges);
        let (inverse, condition) = (self.inverse.as_mut_slice(), self.condition.as_mut_slice());
        sweep_two_parts((parts, 1, inverse), (parts, 1, condition), &|k, rows, condition| {
            let start = parts[k].start;
            rows.fill(Symmetric::ZERO);
            for e in &edges[k] {
                let d = cloud.x[e.j()] - cloud.x[e.i()];
                let scaled = d * (1.0 / d.norm_squared());
                rows[e.i() - start].add_product(&scaled, &d);
                if e.both() && e.seen_back() {
                    rows[e.j() - start].add_product(&scaled, &d);
                }
            }
            for (i, (row, condition)) in parts[k].clone().zip(rows.iter_mut().zip(condition)) {
                let count = cloud.neighbours.range(i).len();
                let (own, worst, _) = invert_row(cloud, i, &row.full(), count);
                (*row, *condition) = (Symmetric::of(&own), worst as f32);
            }
        });
    }

    /// Computes the inverse normal matrices of any cloud, row by row.
    fn fit_by_rows(&mut self, cloud: &Cloud<D>) -> Vec<[[f64; D]; D]> {
        let mut rows = vec![([[0.0; D]; D], 0.0f32); cloud.neighbours.len()];
        sweep(&mut rows, |i| fit_row(cloud, i));
        let (inverse, condition) = rows.into_iter().unzip();
        self.condition = condition;
        inverse
    }

    /// Gradient at every fluid and interface particle of a field given by its `values` at all particles; exact for
    /// linear fields.
    pub fn gradient(&self, cloud: &Cloud<D>, values: &[f64]) -> Vec<Vector<D>> {
        let mut gradient = vec![Vector::ZERO; self.parts.last().map_or(0, |p| p.end)];
        sweep_parts(&self.parts, 1, &mut gradient, &|k, out| {
            let start = self.parts[k].start;
            for (e, [a_i, a_j]) in self.weighed_edges(cloud, k) {
                let change = values[e.j()] - values[e.i()];
                out[e.i() - start] += a_i * change;
                if e.both() {
                    out[e.j() - start] -= a_j * change;
                }
            }
        });
        gradient
    }

    /// Derivative weights at both ends of the edges of part `k`.
    #[inline]
    pub fn weights(&self, k: usize) -> Weights<'_, D> {
        Weights { inverse: &self.inverse, stored: self.stored.get(k).map_or(&[], Vec::as_slice) }
    }

    /// Edges of part `k` with the derivative weights at both ends. `cloud` must be the cloud to which the weights were
    /// fitted.
    #[inline]
    pub fn weighed_edges<'a>(
        &'a self,
        cloud: &'a Cloud<D>,
        k: usize,
    ) -> impl Iterator<Item = (&'a Edge<D>, [Vector<D>; 2])> {
        let weights = self.weights(k);
        self.edges(k).iter().enumerate().map(move |(n, e)| (e, weights.of(n, e, &(cloud.x[e.j()] - cloud.x[e.i()]))))
    }

    /// For each row, the matrix that maps Σ (d/d²)(f_j − f_i) to the gradient; empty where there are layers.
    #[inline]
    pub fn inverse(&self) -> &[Symmetric<D>] {
        &self.inverse
    }

    /// Sets the area vectors of all edges to `f(i, j, s)`, where s is the area vector in `origin`, which has the same
    /// edges.
    pub(super) fn carry_edges(&mut self, origin: &Self, f: impl Fn(usize, usize, &Vector<D>) -> Vector<D> + Sync) {
        let before = &origin.edges;
        sweep_each_slot(&mut self.edges, |k, edges| {
            edges.iter_mut().zip(&before[k]).for_each(|(e, o)| e.s = f(o.i(), o.j(), &o.s));
        });
    }

    /// Replaces the area vector s of each edge of fluid particles by `f(i, j, s)`.
    pub(super) fn alter_areas(&mut self, f: impl Fn(usize, usize, &Vector<D>) -> Vector<D> + Sync) {
        sweep_each_slot(&mut self.edges[..self.n_fluid_parts], |_, edges| {
            edges.iter_mut().for_each(|e| e.s = f(e.i(), e.j(), &e.s));
        });
    }

    /// Edges of part `k`.
    #[inline]
    pub fn edges(&self, k: usize) -> &[Edge<D>] {
        &self.edges[k]
    }

    /// Rows of the parts of fluid particles.
    pub fn fluid_parts(&self) -> &[Range<usize>] {
        &self.parts[..self.n_fluid_parts]
    }

    /// Wall faces of the particles of fluid part `k`; none unless the coefficients are conservative.
    #[inline]
    pub fn wall_faces(&self, k: usize) -> &[WallFace<D>] {
        &self.walls[self.wall_first[k] as usize..self.wall_first[k + 1] as usize]
    }

    /// Sets the wall faces, sorted by fluid particle, and marks the coefficients as conservative.
    pub(super) fn set_wall_faces(&mut self, walls: Vec<WallFace<D>>) {
        self.conservative = true;
        let before = |i: usize| walls.partition_point(|f| (f.i as usize) < i) as u32;
        let ends = self.parts[..self.n_fluid_parts].iter().map(|p| before(p.end));
        self.wall_first = std::iter::once(0).chain(ends).collect();
        self.walls = walls;
    }

    /// Memory of the operators in bytes.
    pub fn bytes(&self) -> usize {
        let edges: usize = self.edges.iter().map(Vec::len).sum();
        let weights =
            self.inverse.len() * size_of::<Symmetric<D>>() + self.stored.iter().map(Vec::len).sum::<usize>() * 16 * D;
        self.walls.len() * size_of::<WallFace<D>>() + edges * size_of::<Edge<D>>() + weights + self.condition.len() * 4
    }
}

/// Ratio of the volume by the metric terms to the volume by the straight axes of the column, below which layers count
/// as folded.
const FOLDED: f64 = 0.05;

/// Inverse normal matrix and condition number of row `i`.
fn fit_row<const D: usize>(cloud: &Cloud<D>, i: usize) -> ([[f64; D]; D], f32) {
    let (matrix, count) = normal_matrix(cloud.neighbours.of(i).iter().map(|j| cloud.offset(i, *j as usize)));
    let (inverse, condition, exact) = invert_row(cloud, i, &matrix, count);
    match cloud.layers.in_steps(i) {
        Some(slot) => (through_metric((cloud, slot), i, inverse, exact), condition as f32),
        None => (inverse, condition as f32),
    }
}

/// Inverse of the normal matrix of `count` neighbours, its condition number (infinite where they do not determine a
/// gradient), and whether the fit is exact for linear fields. The weights of a first-order row are bounded for any
/// neighbours.
fn invert_row<const D: usize>(
    cloud: &Cloud<D>,
    i: usize,
    matrix: &[[f64; D]; D],
    count: usize,
) -> ([[f64; D]; D], f64, bool) {
    let (inverse, condition) = normal_inverse(matrix).unzip();
    let inverse = inverse.filter(|_| cloud.first_order.binary_search(&(i as u32)).is_err());
    let exact = inverse.is_some();
    (inverse.unwrap_or_else(|| bounded_inverse(matrix, count)), condition.unwrap_or(f64::INFINITY), exact)
}

/// Converts slopes in the space of steps into slopes in physical space, with the metric terms computed by the same
/// weights. First-order rows do not determine metric terms, and those of folded layers are invalid: the straight axes
/// of the column replace them there, which keeps the weights bounded.
fn through_metric<const D: usize>(
    (cloud, (column, layer)): (&Cloud<D>, (usize, usize)),
    i: usize,
    inverse: [[f64; D]; D],
    exact: bool,
) -> [[f64; D]; D] {
    let mut metric = [Vector::<D>::ZERO; D];
    for j in cloud.neighbours.of(i) {
        let weight = gradient_weight(&inverse, &cloud.offset(i, *j as usize));
        let d = cloud.x[*j as usize] - cloud.x[i];
        (0..D).for_each(|c| metric[c] += d * weight[c]);
    }
    let mut straight = *cloud.layers.axes(column);
    straight[D - 1] = straight[D - 1] * (cloud.layers.thickness(column, layer) / cloud.spacing[i]);
    let upright = determinant(&metric) / determinant(&straight) > FOLDED;
    let rows = if exact && upright { metric } else { straight };
    let (cofactors, det) = (cofactors(&rows), determinant(&rows));
    // J⁻¹ is the transpose of the cofactors divided by the determinant
    std::array::from_fn(|r| std::array::from_fn(|c| (0..D).map(|k| cofactors[k][r] * inverse[k][c]).sum::<f64>() / det))
}

/// Finds the entry (j, i) that corresponds to the entry (i, j) of the neighbour lists, through images where necessary.
pub(super) struct Reverse<'a, const D: usize> {
    cloud: &'a Cloud<D>,
    inverse: Vec<Option<u8>>,
}

impl<'a, const D: usize> Reverse<'a, D> {
    pub(super) fn new(cloud: &'a Cloud<D>) -> Self {
        let same = |a: &Transform<D>, b: &Transform<D>| a.sign == b.sign && (a.offset - b.offset).max_abs() < 1e-9;
        let find = |t: &Transform<D>| cloud.transforms.iter().position(|o| same(o, &t.inverse())).map(|k| k as u8);
        Self { cloud, inverse: cloud.transforms.iter().map(find).collect() }
    }

    /// Position of the entry (j, i) among all neighbour entries, and the transform that maps its vectors to the first
    /// end; `None` when the second end has no neighbour list or does not have the first as a neighbour.
    pub(super) fn position(&self, i: usize, j: usize) -> Option<(usize, Option<u8>)> {
        let c = self.cloud;
        if j < c.n_rows() {
            return self.entry(j, i as u32).map(|e| (e, None));
        }
        let Ghost { source, transform } = *c.ghosts.get(j.checked_sub(c.n_real())?)?;
        if source as usize >= c.n_rows() {
            return None;
        }
        let back = self.inverse[transform as usize]?;
        let mirrored = c.ghosts.binary_search_by_key(&(i as u32, back), |m| (m.source, m.transform)).ok()?;
        self.entry(source as usize, (c.n_real() + mirrored) as u32).map(|e| (e, Some(transform)))
    }

    fn entry(&self, row: usize, j: u32) -> Option<usize> {
        let position = self.cloud.neighbours.of(row).binary_search(&j).ok()?;
        Some(self.cloud.neighbours.first[row] as usize + position)
    }
}

/// Edges of a part, without weights.
fn part_edges<const D: usize>(cloud: &Cloud<D>, reverse: &Reverse<'_, D>, part: &Range<usize>) -> Vec<Edge<D>> {
    // an edge inside the part is stored with its smaller end
    let visited = |i: usize, j: u32| !(part.start..i).contains(&(j as usize));
    let count = |i: usize| cloud.neighbours.of(i).iter().filter(|j| visited(i, **j)).count();
    let mut edges = Vec::with_capacity(part.clone().map(count).sum());
    for i in part.clone() {
        let row = cloud.neighbours.of(i).iter().filter(|j| visited(i, **j));
        edges.extend(row.map(|j| {
            let seen_back = (*j as usize) < cloud.n_rows() && reverse.entry(*j as usize, i as u32).is_some();
            Edge::between(i, *j as usize, part, seen_back)
        }));
    }
    edges
}

impl<const D: usize> Edge<D> {
    fn between(i: usize, j: usize, part: &Range<usize>, seen_back: bool) -> Self {
        let both = if part.contains(&j) { BOTH } else { 0 };
        let seen = if seen_back { SEEN_BACK } else { 0 };
        Self { i: i as u32, j: j as u32 | both | seen, s: Vector::ZERO }
    }

    /// Sets the area vector between particles that are not images, from the inverse normal matrices of all rows.
    #[inline(always)]
    fn weigh(&mut self, cloud: &Cloud<D>, inverse: &[Symmetric<D>]) {
        let (i, j) = (self.i(), self.j());
        let d = cloud.x[j] - cloud.x[i];
        let a_i = gradient_weight(&inverse[i].full(), &d);
        // an end without a neighbour list is treated as the mirror image of the first end
        self.s = match self.seen_back() {
            true => a_i * cloud.volume[i] - gradient_weight(&inverse[j].full(), &-d) * cloud.volume[j],
            false => a_i * (2.0 * cloud.volume[i]),
        };
    }
}

/// Weights at both ends of an edge, whatever its second end, and its area vector.
fn weights<const D: usize>(
    cloud: &Cloud<D>,
    inverse: impl Fn(usize) -> [[f64; D]; D],
    reverse: &Reverse<'_, D>,
    (i, j): (usize, usize),
) -> ([Vector<D>; 2], Vector<D>) {
    let a_i = gradient_weight(&inverse(i), &cloud.offset(i, j));
    let back = reverse.position(i, j).map(|(e, transform)| match transform {
        None => gradient_weight(&inverse(j), &cloud.offset(j, i)),
        Some(t) => {
            let source = cloud.ghosts[j - cloud.n_real()].source as usize;
            let d = cloud.offset(source, cloud.neighbours.index[e] as usize);
            cloud.transforms[t as usize].direction(&gradient_weight(&inverse(source), &d))
        }
    });
    // an end without a neighbour list is treated as the mirror image of the first end
    let s = match back {
        Some(a_j) => a_i * cloud.volume[i] - a_j * cloud.volume[j],
        None => a_i * (2.0 * cloud.volume[i]),
    };
    ([a_i, back.unwrap_or(Vector::ZERO)], s)
}
