//! Derivative weights and the edges of the cloud.
//!
//! ∇f_i = Σ_j a_ij (f_j − f_i) by a linear least-squares fit with weights 1/r² (eqs (10)-(15)). The scheme works on *edges*:
//! pairs of particles that see one another, each with a_ij, a_ji and the antisymmetric vector s_ij = V_i a_ij − V_j a_ji that
//! weights the upwind dissipation. On a uniform lattice s_ij = 2 V a_ij and everything reduces to one set of coefficients.
//!
//! Rows are cut into contiguous *parts*; an edge inside a part is visited once and serves both ends, an edge between parts
//! is stored with both. Every part writes only its own rows, so results do not depend on the number of threads.
use std::ops::Range;

use super::neighbours::Neighbours;
use super::{Cloud, Image, Transform};
use crate::math::Vector;
use crate::math::least_squares::{bounded_gradient_matrix, gradient_matrix, gradient_weight};
use crate::math::sweep::{parts, sweep, sweep_each, sweep_each_slot};

/// Fewest and most rows in one part, in 2-D and in 3-D: large enough that few edges are visited twice (of 4,096 rows in 3-D
/// a quarter of the edges are), small enough to stay in the second cache and to balance threads.
const PART: [[usize; 2]; 2] = [[1024, 8192], [4096, 16384]];
/// Parts that a large cloud has at least.
const MANY_PARTS: usize = 32;
/// Marks an edge whose second end lies in the same part.
const BOTH: u32 = 1 << 31;

/// Two particles that see one another.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Edge<const D: usize> {
    i: u32,
    j: u32,
    /// Weight a_ij of the derivative at the first end.
    pub a_i: Vector<D>,
    /// Weight a_ji of the derivative at the second end, zero if that has no cloud.
    pub a_j: Vector<D>,
    /// V_i a_ij − V_j a_ji.
    pub s: Vector<D>,
}

impl<const D: usize> Edge<D> {
    /// First end.
    #[inline(always)]
    pub fn i(&self) -> usize {
        self.i as usize
    }

    /// Second end.
    #[inline(always)]
    pub fn j(&self) -> usize {
        (self.j & !BOTH) as usize
    }

    /// True when this visit serves the second end as well.
    #[inline(always)]
    pub fn both(&self) -> bool {
        self.j & BOTH != 0
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
    /// Condition number of the normal matrix of each row, infinite where the cloud determines no gradient.
    pub condition: Vec<f64>,
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
        let (inverse, condition) = fit_rows(cloud);
        let lookup = Reverse::new(cloud);
        let [fewest, most] = PART[usize::from(D == 3)];
        let size = (cloud.n_fluid / MANY_PARTS).clamp(fewest, most);
        let mut all = parts(cloud.n_fluid, size);
        let n_fluid_parts = all.len();
        let start = cloud.n_fluid;
        all.extend(parts(cloud.interface.len(), size).into_iter().map(|p| p.start + start..p.end + start));
        let mut edges = vec![Vec::new(); all.len()];
        sweep_each(&mut edges, |k| part_edges(cloud, &inverse, &lookup, &all[k]));
        let wall_first = vec![0; n_fluid_parts + 1];
        Self { parts: all, n_fluid_parts, edges, condition, conservative: false, walls: Vec::new(), wall_first }
    }

    /// Fits the weights anew to the positions of `cloud`, whose lists are those of the fit before; volumes stay. The
    /// coefficients that come out are not conservative unless they are carried along, see [`Operators::carry`].
    pub fn refit(&mut self, cloud: &Cloud<D>) {
        let (inverse, condition) = fit_rows(cloud);
        self.condition = condition;
        self.conservative = false;
        self.walls.clear();
        self.wall_first.fill(0);
        let lookup = Reverse::new(cloud);
        let parts = &self.parts;
        sweep_each_slot(&mut self.edges, |k, edges| {
            edges.iter_mut().for_each(|e| *e = edge(cloud, &inverse, &lookup, (e.i(), e.j()), &parts[k]));
        });
    }

    /// Turns all vectors.
    pub fn turn(&mut self, turned: impl Fn(&Vector<D>) -> Vector<D>) {
        for e in self.edges_mut() {
            (e.a_i, e.a_j, e.s) = (turned(&e.a_i), turned(&e.a_j), turned(&e.s));
        }
        self.walls.iter_mut().for_each(|w| w.area = turned(&w.area));
    }

    /// Area vectors s of all edges: those of `origin`, on the same lists, after `f(i, j, s)`.
    pub(super) fn carry_edges(&mut self, origin: &Self, f: impl Fn(usize, usize, &Vector<D>) -> Vector<D> + Sync) {
        let before = &origin.edges;
        sweep_each_slot(&mut self.edges, |k, edges| {
            edges.iter_mut().zip(&before[k]).for_each(|(e, o)| e.s = f(o.i(), o.j(), &o.s));
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

    /// All edges, part after part, to rewrite the dissipation vectors.
    pub fn edges_mut(&mut self) -> impl Iterator<Item = &mut Edge<D>> {
        self.edges.iter_mut().flatten()
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
        self.walls.len() * size_of::<WallFace<D>>() + edges * size_of::<Edge<D>>() + self.condition.len() * 8
    }
}

/// Volume of the metric terms over that of the straight axes of the column, below which layers are folded.
const FOLDED: f64 = 0.05;

/// The normal matrices, inverted, from which every weight follows, and the conditioning of every row.
fn fit_rows<const D: usize>(cloud: &Cloud<D>) -> (Vec<[[f64; D]; D]>, Vec<f64>) {
    let n = cloud.neighbours.len();
    let mut rows = vec![([[0.0; D]; D], 0.0); n];
    sweep(&mut rows, |i| fit_row(cloud, i));
    rows.into_iter().unzip()
}

/// Inverse normal matrix of row `i`; the weights of a first-order row are bounded whatever the neighbours.
fn fit_row<const D: usize>(cloud: &Cloud<D>, i: usize) -> ([[f64; D]; D], f64) {
    let offsets = || cloud.neighbours.of(i).iter().map(|j| cloud.offset(i, *j as usize));
    let (inverse, condition) = gradient_matrix(offsets()).unzip();
    let inverse = inverse.filter(|_| cloud.first_order.binary_search(&(i as u32)).is_err());
    let exact = inverse.is_some();
    let inverse = inverse.unwrap_or_else(|| bounded_gradient_matrix(offsets()));
    let inverse = match cloud.layers.slot(i) {
        Some(slot) => through_metric((cloud, slot), i, inverse, exact),
        None => inverse,
    };
    (inverse, condition.unwrap_or(f64::INFINITY))
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
    let cross = |a: &Vector<D>, b: &Vector<D>| a[0] * b[1] - a[1] * b[0];
    let [along, normal] = cloud.layers.axes(column);
    let straight = [*along, *normal * (cloud.layers.thickness(column, layer) / cloud.spacing[i])];
    let upright = cross(&metric[0], &metric[1]) / cross(&straight[0], &straight[1]) > FOLDED;
    let [a, b] = if exact && upright { [metric[0], metric[1]] } else { straight };
    let det = cross(&a, &b);
    let mut turned = inverse;
    for c in 0..D {
        let (f, g) = (inverse[0][c], inverse[1][c]);
        (turned[0][c], turned[1][c]) = ((f * b[1] - g * a[1]) / det, (g * a[0] - f * b[0]) / det);
    }
    turned
}

/// Finds the entry (j, i) that belongs to the entry (i, j), through images where needed.
pub(super) struct Reverse<'a, const D: usize> {
    cloud: &'a Cloud<D>,
    images: std::collections::HashMap<(u32, u8), u32>,
    inverse: Vec<Option<u8>>,
}

impl<'a, const D: usize> Reverse<'a, D> {
    pub(super) fn new(cloud: &'a Cloud<D>) -> Self {
        let first = cloud.n_real() as u32;
        let images = cloud.images.iter().zip(first..).map(|(m, k)| ((m.source, m.transform), k)).collect();
        let same = |a: &Transform<D>, b: &Transform<D>| a.sign == b.sign && (a.offset - b.offset).max_abs() < 1e-9;
        let find = |t: &Transform<D>| cloud.transforms.iter().position(|o| same(o, &t.inverse())).map(|k| k as u8);
        Self { cloud, images, inverse: cloud.transforms.iter().map(find).collect() }
    }

    /// Position of that entry among all neighbour entries, and the transform that brings its vectors to the first end;
    /// `None` when the second end has no cloud or does not see the first.
    pub(super) fn position(&self, i: usize, j: usize) -> Option<(usize, Option<u8>)> {
        let c = self.cloud;
        if j < c.n_rows() {
            return self.entry(j, i as u32).map(|e| (e, None));
        }
        let Image { source, transform } = *c.images.get(j.checked_sub(c.n_real())?)?;
        if source as usize >= c.n_rows() {
            return None;
        }
        let back = self.inverse[transform as usize]?;
        let mirrored = *self.images.get(&(i as u32, back))?;
        self.entry(source as usize, mirrored).map(|e| (e, Some(transform)))
    }

    fn entry(&self, row: usize, j: u32) -> Option<usize> {
        let position = self.cloud.neighbours.of(row).binary_search(&j).ok()?;
        Some(self.cloud.neighbours.first[row] as usize + position)
    }
}

fn part_edges<const D: usize>(
    cloud: &Cloud<D>,
    inverse: &[[[f64; D]; D]],
    reverse: &Reverse<'_, D>,
    part: &Range<usize>,
) -> Vec<Edge<D>> {
    // an edge inside the part belongs to its smaller end
    let visited = |i: usize, j: u32| !(part.start..i).contains(&(j as usize));
    let count = |i: usize| cloud.neighbours.of(i).iter().filter(|j| visited(i, **j)).count();
    let mut edges = Vec::with_capacity(part.clone().map(count).sum());
    for i in part.clone() {
        let row = cloud.neighbours.of(i).iter().filter(|j| visited(i, **j));
        edges.extend(row.map(|j| edge(cloud, inverse, reverse, (i, *j as usize), part)));
    }
    edges
}

fn edge<const D: usize>(
    cloud: &Cloud<D>,
    inverse: &[[[f64; D]; D]],
    reverse: &Reverse<'_, D>,
    (i, j): (usize, usize),
    part: &Range<usize>,
) -> Edge<D> {
    let a_i = gradient_weight(&inverse[i], &cloud.offset(i, j));
    let back = reverse.position(i, j).map(|(e, transform)| match transform {
        None => gradient_weight(&inverse[j], &cloud.offset(j, i)),
        Some(t) => {
            let source = cloud.images[j - cloud.n_real()].source as usize;
            let d = cloud.offset(source, cloud.neighbours.index[e] as usize);
            cloud.transforms[t as usize].direction(&gradient_weight(&inverse[source], &d))
        }
    });
    // an end without a cloud counts as the mirror image of this one
    let s = match back {
        Some(a_j) => a_i * cloud.volume[i] - a_j * cloud.volume[j],
        None => a_i * (2.0 * cloud.volume[i]),
    };
    let flag = if part.contains(&j) { BOTH } else { 0 };
    Edge { i: i as u32, j: j as u32 | flag, a_i, a_j: back.unwrap_or(Vector::ZERO), s }
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
