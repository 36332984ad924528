//! Derivative weights and the edges of the cloud.
//!
//! ∇f_i = Σ_j a_ij (f_j − f_i) by a linear least-squares fit with weights 1/r² (eqs (10)-(15)). The scheme works on *edges*:
//! pairs of particles that see one another, each with the antisymmetric vector s_ij = V_i a_ij − V_j a_ji that weights the upwind
//! dissipation; a_ij and a_ji follow from one small matrix a row. On a uniform lattice s_ij = 2 V a_ij and everything reduces to
//! one set of coefficients.
//!
//! Rows are cut into contiguous *parts*; an edge inside a part is visited once and serves both ends, an edge between parts
//! is stored with both. Every part writes only its own rows, so results do not depend on the number of threads.
use std::ops::Range;

use super::neighbours::Neighbours;
use super::{Cloud, Ghost, Transform};
use crate::math::Vector;
use crate::math::least_squares::{bounded_inverse, gradient_weight, normal_inverse, normal_matrix};
use crate::math::parallel::{parts, sweep, sweep_each, sweep_each_slot, sweep_parts, sweep_two_parts};
use crate::math::square::{Symmetric, cofactors, determinant};

/// Fewest and most rows in one part, in 2-D and in 3-D: large enough that few edges are visited twice (of 4,096 rows in 3-D
/// a quarter of the edges are), small enough to stay in the second cache and to balance threads.
const PART: [[usize; 2]; 2] = [[1024, 8192], [4096, 16384]];
/// Parts that a large cloud has at least.
const MANY_PARTS: usize = 32;
/// Marks an edge whose second end lies in the same part.
const BOTH: u32 = 1 << 31;
/// Marks an edge whose second end is a particle, not an image, that sees the first.
const SEEN_BACK: u32 = 1 << 30;

/// Two particles that see one another.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Edge<const D: usize> {
    i: u32,
    j: u32,
    /// V_i a_ij − V_j a_ji.
    pub s: Vector<D>,
}

impl<const D: usize> Edge<D> {
    /// The edge from `i` to `j` that serves both, with its area vector.
    pub fn of_both(i: u32, j: u32, s: Vector<D>) -> Self {
        Self { i, j: j | BOTH, s }
    }

    /// First end.
    #[inline(always)]
    pub fn i(&self) -> usize {
        self.i as usize
    }

    /// Second end.
    #[inline(always)]
    pub fn j(&self) -> usize {
        (self.j & !(BOTH | SEEN_BACK)) as usize
    }

    /// True where the second end is a particle, not an image, that sees the first.
    #[inline(always)]
    pub fn seen_back(&self) -> bool {
        self.j & SEEN_BACK != 0
    }

    /// True when this visit serves the second end as well.
    #[inline(always)]
    pub fn both(&self) -> bool {
        self.j & BOTH != 0
    }
}

/// Weights a_ij and a_ji of the derivatives at both ends of the edges of a part; that of an end that has no cloud, or is not served
/// by the visit, is zero.
#[derive(Clone, Copy)]
pub struct Weights<'a, const D: usize> {
    /// Of each row the matrix that makes a weight of an offset over its square, where offsets are plain differences.
    inverse: &'a [Symmetric<D>],
    /// Of each edge, where they are not.
    stored: &'a [[Vector<D>; 2]],
}

impl<'a, const D: usize> Weights<'a, D> {
    /// Those of edges in the order in which they come.
    pub fn stored(stored: &'a [[Vector<D>; 2]]) -> Self {
        Self { inverse: &[], stored }
    }

    /// Of the `n`-th edge of the part, which goes along `d`.
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
    /// Rows of each part; fluid parts first, then interface parts.
    pub parts: Vec<Range<usize>>,
    /// Number of parts that hold fluid particles.
    pub n_fluid_parts: usize,
    /// Edges of each part.
    edges: Vec<Vec<Edge<D>>>,
    /// Of each row the matrix that makes weights; empty where there are layers.
    inverse: Vec<Symmetric<D>>,
    /// Weights of each edge of each part; empty where there are no layers.
    stored: Vec<Vec<[Vector<D>; 2]>>,
    /// Condition number of the normal matrix of each row, infinite where the cloud determines no gradient.
    pub condition: Vec<f32>,
    /// True when what one particle loses another gains.
    pub conservative: bool,
    walls: Vec<WallFace<D>>,
    wall_first: Vec<u32>,
}

/// A piece of wall that bounds the volume of one fluid particle; only conservative coefficients need it.
#[derive(Clone, Copy, Debug)]
pub struct WallFace<const D: usize> {
    /// Fluid particle.
    pub i: u32,
    /// Interface particle, or image of one, whose pressure acts on it.
    pub wall: u32,
    /// Area vector, out of the fluid.
    pub area: Vector<D>,
}

impl<const D: usize> Operators<D> {
    /// Fits all rows of a cloud.
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

    /// Fits the weights anew to the positions of `cloud`, whose lists are those of the fit before; volumes stay. The
    /// coefficients that come out are not conservative unless they are carried along, see [`Operators::metric_update`].
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

    /// Finds the inverse normal matrices, from which every weight follows, where offsets are plain differences: those of the two ends
    /// of an edge are opposite, and add the same to both.
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

    /// The same on any cloud, row by row.
    fn fit_by_rows(&mut self, cloud: &Cloud<D>) -> Vec<[[f64; D]; D]> {
        let mut rows = vec![([[0.0; D]; D], 0.0f32); cloud.neighbours.len()];
        sweep(&mut rows, |i| fit_row(cloud, i));
        let (inverse, condition) = rows.into_iter().unzip();
        self.condition = condition;
        inverse
    }

    /// Gradient of a field at every fluid and interface particle from its `values` at all particles: exact where it is linear.
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

    /// Weights of the derivatives at both ends of the edges of part `k`.
    #[inline]
    pub fn weights(&self, k: usize) -> Weights<'_, D> {
        Weights { inverse: &self.inverse, stored: self.stored.get(k).map_or(&[], Vec::as_slice) }
    }

    /// Edges of part `k` with the weights of the derivatives at both ends; `cloud` is the one that the weights were fitted to.
    #[inline]
    pub fn weighed_edges<'a>(
        &'a self,
        cloud: &'a Cloud<D>,
        k: usize,
    ) -> impl Iterator<Item = (&'a Edge<D>, [Vector<D>; 2])> {
        let weights = self.weights(k);
        self.edges(k).iter().enumerate().map(move |(n, e)| (e, weights.of(n, e, &(cloud.x[e.j()] - cloud.x[e.i()]))))
    }

    /// Of each row the matrix that makes the gradient of Σ (d/d²)(f_j − f_i); nothing where there are layers.
    #[inline]
    pub fn inverse(&self) -> &[Symmetric<D>] {
        &self.inverse
    }

    /// Area vectors s of all edges: those of `origin`, on the same lists, after `f(i, j, s)`.
    pub(super) fn carry_edges(&mut self, origin: &Self, f: impl Fn(usize, usize, &Vector<D>) -> Vector<D> + Sync) {
        let before = &origin.edges;
        sweep_each_slot(&mut self.edges, |k, edges| {
            edges.iter_mut().zip(&before[k]).for_each(|(e, o)| e.s = f(o.i(), o.j(), &o.s));
        });
    }

    /// Replaces the area vectors of the edges of fluid particles by `f(i, j, s)`.
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

    /// Parts of fluid particles.
    pub fn fluid_parts(&self) -> &[Range<usize>] {
        &self.parts[..self.n_fluid_parts]
    }

    /// Pieces of wall of fluid part `k`; none unless the coefficients are conservative.
    #[inline]
    pub fn wall_faces(&self, k: usize) -> &[WallFace<D>] {
        &self.walls[self.wall_first[k] as usize..self.wall_first[k + 1] as usize]
    }

    /// Replaces the pieces of wall, sorted by fluid particle, of coefficients that are conservative from now on.
    pub(super) fn set_wall_faces(&mut self, walls: Vec<WallFace<D>>) {
        self.conservative = true;
        let before = |i: usize| walls.partition_point(|f| (f.i as usize) < i) as u32;
        let ends = self.parts[..self.n_fluid_parts].iter().map(|p| before(p.end));
        self.wall_first = std::iter::once(0).chain(ends).collect();
        self.walls = walls;
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let edges: usize = self.edges.iter().map(Vec::len).sum();
        let weights =
            self.inverse.len() * size_of::<Symmetric<D>>() + self.stored.iter().map(Vec::len).sum::<usize>() * 16 * D;
        self.walls.len() * size_of::<WallFace<D>>() + edges * size_of::<Edge<D>>() + weights + self.condition.len() * 4
    }
}

/// Volume of the metric terms over that of the straight axes of the column, below which layers are folded.
const FOLDED: f64 = 0.05;

/// Inverse normal matrix and conditioning of row `i`.
fn fit_row<const D: usize>(cloud: &Cloud<D>, i: usize) -> ([[f64; D]; D], f32) {
    let (matrix, count) = normal_matrix(cloud.neighbours.of(i).iter().map(|j| cloud.offset(i, *j as usize)));
    let (inverse, condition, exact) = invert_row(cloud, i, &matrix, count);
    match cloud.layers.in_steps(i) {
        Some(slot) => (through_metric((cloud, slot), i, inverse, exact), condition as f32),
        None => (inverse, condition as f32),
    }
}

/// The inverse of the normal matrix of `count` neighbours, its condition number, infinite where the cloud determines no gradient,
/// and whether it is exact for linear fields; the weights of a first-order row are bounded whatever the neighbours.
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

/// Turns slopes in the space of steps into slopes in space, through the metric terms that the same weights give. Weights of
/// a first-order row determine no such terms, and those of layers that fold are of no use: there the straight axes of the
/// column take their place, which keeps weights bounded.
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
    // J⁻¹ is the transpose of the cofactors over the determinant
    std::array::from_fn(|r| std::array::from_fn(|c| (0..D).map(|k| cofactors[k][r] * inverse[k][c]).sum::<f64>() / det))
}

/// Finds the entry (j, i) that belongs to the entry (i, j), through images where needed.
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

    /// Position of that entry among all neighbour entries, and the transform that brings its vectors to the first end;
    /// `None` when the second end has no cloud or does not see the first.
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
    // an edge inside the part belongs to its smaller end
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

    /// Sets the area vector between particles that are no images, given the inverse normal matrices of all rows.
    #[inline(always)]
    fn weigh(&mut self, cloud: &Cloud<D>, inverse: &[Symmetric<D>]) {
        let (i, j) = (self.i(), self.j());
        let d = cloud.x[j] - cloud.x[i];
        let a_i = gradient_weight(&inverse[i].full(), &d);
        // an end without a cloud counts as the mirror image of this one
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
    // an end without a cloud counts as the mirror image of this one
    let s = match back {
        Some(a_j) => a_i * cloud.volume[i] - a_j * cloud.volume[j],
        None => a_i * (2.0 * cloud.volume[i]),
    };
    ([a_i, back.unwrap_or(Vector::ZERO)], s)
}

/// Rows whose neighbours are not all fluid particles in the interior: none of their entries is missing.
pub fn is_symmetric(neighbours: &Neighbours, n_rows: usize) -> bool {
    (0..n_rows).all(|i| {
        neighbours
            .of(i)
            .iter()
            .all(|j| *j as usize >= n_rows || neighbours.of(*j as usize).binary_search(&(i as u32)).is_ok())
    })
}
