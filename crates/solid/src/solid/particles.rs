//! Clouds of solid particles: where they are at rest, how much of the body each holds, and how gradients are fitted among them.
//!
//! Gradients are the least-squares fits of the gas, ∇φ_i = Σ_j g_ij (φ_j − φ_i) with weights w = 1/|d|², over all j around i
//! in its rows, or within [`REACH`] spacings. They are then made *variationally consistent*: of all corrections that leave the gradients of linear fields
//! exact, the least one, in the norm of the weights, is added for which the discrete divergence theorem holds,
//! Σ_i V_i g_ij = A_j, with the area vectors A of the surface: uniform stress then has no force inside, and the exact traction on
//! the surface, on any cloud. Corrections that leave linear fields exact are residuals of the fit itself,
//! R_ij(λ) = λ_j − λ_i − d_ij·∇λ_i, so that λ solves L λ = A − Σ V g once for each axis, L = Σ_i V_i Σ_j w R_ijᵀR_ij
//! (after Chen, Hillman and Rüter 2013, doi:10.1002/nme.4512, whose test functions are corrected in like manner). About an axis of
//! revolution Σ_i V_i g_ij = A_j − 2π a_j e_r takes its place (`axis`).
use std::ops::Range;

use crate::cloud::grid::Grid;
use crate::math::Vector;
use crate::math::conjugate::{Symmetric, conjugate_gradients};
use crate::math::least_squares::{gradient_weight, normal_inverse, normal_matrix};
use crate::math::parallel::{sweep, sweep_each};
use crate::math::reduce::{first, maximum, sum};
use crate::math::sparse;

/// Radius of a cloud in spacings, in the plane and in space, where rows do not say who neighbours are: between the second and the
/// third ring of a square and of a body-centred lattice, so that no diagonal of a sheared cell is lost.
pub const REACH: [f64; 2] = [1.8, 1.4];
/// Neighbours below which particles are joined to all that they share simplices with.
const FEW: usize = 8;
/// What the divergence theorem may leave of a particle's area h^(D−1).
const CLOSED: f64 = 1e-11;
/// Particles up to which the equations of the correction are preconditioned by their factors, in the plane and in space.
const FACTORED: [usize; 2] = [200_000, 30_000];
/// Part of its diagonal that is added to a matrix which does not see linear fields.
const LITTLE: f64 = 1e-10;
/// Part of the weights of fits that the correction may change, rms over the cloud: half on random clouds.
const MOST: f64 = 0.8;
/// Most iterations of the correction.
const ITERATIONS: usize = 5000;

/// A neighbour of a particle.
#[derive(Clone, Copy, Debug)]
pub struct Edge<const D: usize> {
    /// Its number.
    pub other: u32,
    /// w, the weight of the pair in fits.
    pub weight: f64,
    /// V_i g_ij of the particle at hand.
    pub own: Vector<D>,
    /// V_j g_ji of the neighbour.
    pub counter: Vector<D>,
}

/// A flat piece of surface between particles, which share its area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet<const D: usize> {
    /// Particles at its corners, in order around it seen from outside; the first `count` of them.
    corners: [u32; 4],
    count: u8,
    /// Part of the area that each of them has.
    parts: [f64; 4],
    /// Area vector, pointing outwards; length in the plane.
    pub area: Vector<D>,
}

impl<const D: usize> Facet<D> {
    /// The facet between four particles at most.
    pub fn new(between: &[u32], area: Vector<D>) -> Self {
        let mut corners = [0; 4];
        corners[..between.len()].copy_from_slice(between);
        Self { corners, count: between.len() as u8, parts: [1.0 / between.len() as f64; 4], area }
    }

    /// The same piece with another area, of which its first two corners have these parts.
    pub(super) fn weighted(&self, area: Vector<D>, [a, b]: [f64; 2]) -> Self {
        Self { parts: [a, b, 0.0, 0.0], area, ..*self }
    }

    /// Particles at its corners.
    pub fn corners(&self) -> &[u32] {
        &self.corners[..usize::from(self.count)]
    }

    /// Its corners, each with the area that it has.
    pub fn shares(&self) -> impl Iterator<Item = (usize, Vector<D>)> {
        self.corners().iter().zip(self.parts).map(|(i, part)| (*i as usize, self.area * part))
    }

    /// The same between particles that have other numbers.
    fn renumbered(&self, new: &[u32]) -> Self {
        let between: Vec<u32> = self.corners().iter().map(|i| new[*i as usize]).collect();
        Self { parts: self.parts, ..Self::new(&between, self.area) }
    }
}

/// Places, volumes and surface of particles, before gradients are known.
#[derive(Clone, Debug, Default)]
pub struct Fill<const D: usize> {
    /// Places at rest; those on the surface first.
    pub x: Vec<Vector<D>>,
    /// Volume of each, area in the plane.
    pub volume: Vec<f64>,
    /// The surface.
    pub facets: Vec<Facet<D>>,
    /// Distance of neighbours.
    pub spacing: f64,
    /// Neighbours of each in the order of their numbers, where rows say who they are; empty: all within reach.
    pub rows: Vec<Vec<u32>>,
    /// Particles that each shares simplices with, in the order of their numbers; empty where volumes are not those of tetrahedra.
    pub ties: Vec<Vec<u32>>,
    /// First moment in the plane that each stands for beyond volume times place; empty in space.
    pub moment: Vec<Vector<D>>,
    /// 2π times the plane area of each about an axis of revolution; empty elsewhere.
    pub turn: Vec<f64>,
}

impl<const D: usize> Fill<D> {
    /// The same with all within reach as neighbours, but those for which `apart` holds and that share no simplex; particles with few
    /// neighbours, as at sharp edges, get all that they share simplices with.
    pub fn seen(mut self, apart: impl Fn(usize, usize) -> bool) -> Self {
        self.find_rows();
        let tied = |i: usize, j: u32| self.ties.get(i).is_some_and(|ties| ties.binary_search(&j).is_ok());
        for (i, row) in self.rows.iter_mut().enumerate() {
            row.retain(|j| tied(i, *j) || !apart(i.min(*j as usize), i.max(*j as usize)));
        }
        let few: Vec<bool> = self.rows.iter().map(|row| row.len() < FEW).collect();
        for (i, (row, ties)) in self.rows.iter_mut().zip(&self.ties).enumerate() {
            row.extend(ties.iter().filter(|j| few[i] || few[**j as usize]));
            row.sort_unstable();
            row.dedup();
        }
        self
    }

    /// Makes all within reach neighbours where nobody has said who they are.
    pub(super) fn find_rows(&mut self) {
        if self.rows.is_empty() {
            self.rows = neighbours(&self.x, REACH[D - 2] * self.spacing);
        }
    }

    /// Area vectors of all particles, pointing outwards; zero inside.
    pub fn areas(&self) -> Vec<Vector<D>> {
        let mut areas = vec![Vector::ZERO; self.x.len()];
        for facet in &self.facets {
            facet.shares().for_each(|(i, area)| areas[i] += area);
        }
        areas
    }

    /// The particles `order` alone, and the facets between them.
    pub(super) fn taken(&self, order: &[usize]) -> Self {
        let mut new = vec![u32::MAX; self.x.len()];
        order.iter().enumerate().for_each(|(k, i)| new[*i] = k as u32);
        let kept = self.facets.iter().filter(|f| f.corners().iter().all(|i| new[*i as usize] != u32::MAX));
        Self {
            x: order.iter().map(|i| self.x[*i]).collect(),
            volume: order.iter().map(|i| self.volume[*i]).collect(),
            facets: kept.map(|f| f.renumbered(&new)).collect(),
            spacing: self.spacing,
            rows: renumbered_rows(&self.rows, order, &new),
            ties: renumbered_rows(&self.ties, order, &new),
            moment: picked(&self.moment, order),
            turn: picked(&self.turn, order),
        }
    }
}

/// Those of `all` that are in `order`, if there are any.
fn picked<T: Copy>(all: &[T], order: &[usize]) -> Vec<T> {
    order.iter().filter_map(|i| all.get(*i).copied()).collect()
}

/// The rows of `order` by new numbers, if there are any.
fn renumbered_rows(rows: &[Vec<u32>], order: &[usize], new: &[u32]) -> Vec<Vec<u32>> {
    order.iter().filter_map(|i| rows.get(*i)).map(|row| renumbered(row, new)).collect()
}

/// Neighbours by their new numbers, without those that have none.
fn renumbered(row: &[u32], new: &[u32]) -> Vec<u32> {
    let mut row: Vec<u32> = row.iter().map(|j| new[*j as usize]).filter(|j| *j != u32::MAX).collect();
    row.sort_unstable();
    row
}

/// Particles at rest with the gradients among them.
#[derive(Clone, Debug)]
pub struct Particles<const D: usize> {
    /// Places at rest.
    pub x: Vec<Vector<D>>,
    /// Volume of each.
    pub volume: Vec<f64>,
    /// Area vector of each, pointing outwards; zero inside.
    pub area: Vec<Vector<D>>,
    /// The surface.
    pub facets: Vec<Facet<D>>,
    /// Distance of neighbours of each.
    pub spacing: Vec<f64>,
    /// Largest part of a fit's weights that the correction changed, rms over the cloud.
    pub correction: f64,
    /// Iterations that the correction took.
    pub iterations: usize,
    first: Vec<u32>,
    edges: Vec<Edge<D>>,
    inverse: Vec<[[f64; D]; D]>,
    /// 2π times the plane area of each about an axis of revolution; empty elsewhere.
    turn: Vec<f64>,
}

/// Why particles make no body.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unfit {
    /// A particle has too few neighbours around it.
    #[error(
        "the solid particle at {place:?} has {count} neighbours, which do not determine a gradient: the body is too thin there for a spacing of {spacing:.3e}"
    )]
    Alone {
        /// Where.
        place: Vec<f64>,
        /// How many it has.
        count: usize,
        /// Spacing.
        spacing: f64,
    },
    /// Gradients would be more correction than fit.
    #[error(
        "the divergence theorem would change the gradients of solid particles by {:.0} %, most at {place:?}, where they have {count} neighbours",
        100.0 * .correction
    )]
    Distorted {
        /// Where they change most.
        place: Vec<f64>,
        /// Neighbours there.
        count: usize,
        /// Part of the weights that changes, rms over the cloud.
        correction: f64,
    },
    /// The divergence theorem cannot be had.
    #[error(
        "the divergence theorem stays open by {left:.1e} of a particle's area after {iterations} iterations: solid particles have too few neighbours, the one at {place:?} only {count}"
    )]
    Open {
        /// Where the particle with the fewest neighbours is.
        place: Vec<f64>,
        /// How many it has.
        count: usize,
        /// What is left.
        left: f64,
        /// Iterations.
        iterations: usize,
    },
}

impl<const D: usize> Particles<D> {
    /// Fits gradients among the particles of bodies that do not see one another.
    pub fn new(bodies: Vec<Fill<D>>) -> Result<Self, Unfit> {
        let areas = bodies.iter().flat_map(Fill::areas).collect();
        let (mut x, mut volume, mut facets) = (Vec::new(), Vec::new(), Vec::new());
        let (mut spacing, mut lists, mut turn) = (Vec::new(), Vec::new(), Vec::new());
        for body in bodies {
            let (n, first) = (body.x.len(), x.len() as u32);
            let new: Vec<u32> = (first..first + n as u32).collect();
            let rows = if body.rows.is_empty() { neighbours(&body.x, REACH[D - 2] * body.spacing) } else { body.rows };
            lists.extend(rows.iter().map(|row| row.iter().map(|j| j + first).collect::<Vec<u32>>()));
            facets.extend(body.facets.iter().map(|f| f.renumbered(&new)));
            spacing.extend(std::iter::repeat_n(body.spacing, n));
            x.extend(body.x);
            volume.extend(body.volume);
            turn.extend(body.turn);
        }
        let mut first = vec![0u32];
        lists.iter().for_each(|l| first.push(first[first.len() - 1] + l.len() as u32));
        let mut all = Self {
            edges: Vec::with_capacity(first[x.len()] as usize),
            inverse: Vec::with_capacity(x.len()),
            correction: 0.0,
            iterations: 0,
            x,
            volume,
            area: areas,
            facets,
            spacing,
            first,
            turn,
        };
        all.fit(&lists)?;
        all.close()?;
        Ok(all)
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.x.len()
    }

    /// True when there are none.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Neighbours of a particle.
    #[inline(always)]
    pub fn of(&self, i: usize) -> &[Edge<D>] {
        &self.edges[self.range(i)]
    }

    /// Places of the neighbours of a particle among all.
    #[inline(always)]
    pub fn range(&self, i: usize) -> Range<usize> {
        self.first[i] as usize..self.first[i + 1] as usize
    }

    /// Inverse normal matrix of the plain fit around a particle.
    #[inline(always)]
    pub fn inverse(&self, i: usize) -> &[[f64; D]; D] {
        &self.inverse[i]
    }

    /// Mean number of neighbours.
    pub fn mean_neighbours(&self) -> f64 {
        self.edges.len() as f64 / self.len().max(1) as f64
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.edges.len() * size_of::<Edge<D>>()
            + self.len() * (size_of::<[[f64; D]; D]>() + 2 * size_of::<Vector<D>>() + 12)
    }

    /// Plain fits.
    fn fit(&mut self, lists: &[Vec<u32>]) -> Result<(), Unfit> {
        for (i, list) in lists.iter().enumerate() {
            let offset = |j: &u32| self.x[*j as usize] - self.x[i];
            let (normal, count) = normal_matrix(list.iter().map(offset));
            let Some((inverse, _)) = normal_inverse(&normal) else {
                return Err(Unfit::Alone { place: self.x[i].0.to_vec(), count, spacing: self.spacing[i] });
            };
            self.inverse.push(inverse);
        }
        for (i, list) in lists.iter().enumerate() {
            self.edges.extend(list.iter().map(|j| {
                let (j, d) = (*j as usize, self.x[*j as usize] - self.x[i]);
                let own = gradient_weight(&self.inverse[i], &d) * self.volume[i];
                let counter = gradient_weight(&self.inverse[j], &(-d)) * self.volume[j];
                Edge { other: j as u32, weight: 1.0 / d.norm_squared(), own, counter }
            }));
        }
        Ok(())
    }

    /// True about an axis of revolution, where the first coordinate is the radius.
    pub fn is_round(&self) -> bool {
        !self.turn.is_empty()
    }

    /// Volume of a particle whose gradient may be corrected: on an axis of revolution it is the plain fit.
    #[inline(always)]
    fn corrected(&self, i: usize) -> f64 {
        if self.is_round() && self.x[i][0] == 0.0 { 0.0 } else { self.volume[i] }
    }

    /// 2π times the plane area of a particle about an axis of revolution.
    #[cfg(test)]
    pub(super) fn turn(&self, i: usize) -> f64 {
        self.turn[i]
    }

    /// 2π times the radius about an axis, half a spacing at least; 1 in the plane and in space: what h^D is taken times for the
    /// volume around a particle.
    pub fn around(&self, i: usize) -> f64 {
        if self.is_round() { std::f64::consts::TAU * self.x[i][0].max(0.5 * self.spacing[i]) } else { 1.0 }
    }

    /// Σ_i V_i g_ij − A_j, and 2π a_j along the radius about an axis: what the divergence theorem leaves at a particle.
    fn open(&self, j: usize) -> Vector<D> {
        let mut left = self.of(j).iter().fold(-self.area[j], |sum, e| sum + e.counter - e.own);
        if let Some(turn) = self.turn.get(j) {
            left[0] += turn;
        }
        left
    }

    /// The correction.
    fn close(&mut self) -> Result<(), Unfit> {
        let n = self.len();
        let sizes: Vec<f64> = (0..n).map(|i| self.spacing[i].powi(D as i32 - 1) * self.around(i)).collect();
        let size = |i: usize| sizes[i];
        let (mut lambda, mut left) = (vec![Vector::ZERO; n], vec![Vector::ZERO; n]);
        sweep(&mut left, |j| -self.open(j));
        let mut gradient = vec![[Vector::ZERO; D]; n];
        let mut diagonal = vec![0.0; n];
        sweep(&mut diagonal, |i| {
            let of = |e: &Edge<D>| {
                (self.corrected(i) + self.corrected(e.other as usize))
                    / (self.x[e.other as usize] - self.x[i]).norm_squared()
            };
            self.of(i).iter().map(of).sum::<f64>()
        });
        let factors = self.factored(&diagonal);
        let mut column = vec![0.0; n];
        self.iterations = conjugate_gradients(
            &mut lambda,
            &mut left,
            ITERATIONS,
            Symmetric {
                enough: |r: &[Vector<D>]| maximum(n, |i| r[i].max_abs() / size(i)) <= CLOSED,
                product: |q: &[Vector<D>], out: &mut [Vector<D>]| {
                    sweep(&mut gradient, |i| self.raw_gradient(i, q));
                    sweep(out, |i| self.residuals(i, q, &gradient));
                },
                precondition: |r: &[Vector<D>], z: &mut [Vector<D>]| match &factors {
                    None => sweep(z, |i| r[i] * (1.0 / diagonal[i])),
                    Some(factors) => {
                        for a in 0..D {
                            column.iter_mut().zip(r).for_each(|(c, r)| *c = r[a]);
                            factors.solve(&mut column);
                            z.iter_mut().zip(&column).for_each(|(z, c)| z[a] = *c);
                        }
                    }
                },
            },
        );
        let worst = self.correct(&lambda);
        if self.correction > MOST {
            let (place, count) = (self.x[worst].0.to_vec(), self.of(worst).len());
            return Err(Unfit::Distorted { place, count, correction: self.correction });
        }
        let left = maximum(n, |j| self.open(j).max_abs() / size(j));
        if left <= 100.0 * CLOSED && first(n, |j| !self.open(j).is_finite()).is_none() {
            return Ok(());
        }
        let fewest = (0..n).min_by_key(|i| self.of(*i).len()).unwrap_or(0);
        let (place, count) = (self.x[fewest].0.to_vec(), self.of(fewest).len());
        Err(Unfit::Open { place, count, left, iterations: self.iterations })
    }

    /// Adds the residuals of `lambda` to the gradients; the particle whose weights change most.
    fn correct(&mut self, lambda: &[Vector<D>]) -> usize {
        let n = self.len();
        let mut gradient = vec![[Vector::ZERO; D]; n];
        sweep(&mut gradient, |i| self.raw_gradient(i, lambda));
        let mut edges = std::mem::take(&mut self.edges);
        let added = |i: usize, j: usize| {
            let d = self.x[j] - self.x[i];
            residual((lambda, &gradient), (i, j), &d) * (self.corrected(i) / d.norm_squared())
        };
        let (mut changed, mut whole, mut worst) = (0.0, 0.0, (0.0, 0));
        for i in 0..n {
            let before: f64 = changed;
            for e in &mut edges[self.range(i)] {
                let (own, counter) = (added(i, e.other as usize), added(e.other as usize, i));
                changed += own.norm_squared();
                whole += e.own.norm_squared();
                (e.own, e.counter) = (e.own + own, e.counter + counter);
            }
            if changed - before > worst.0 {
                worst = (changed - before, i);
            }
        }
        (self.edges, self.correction) = (edges, (changed / f64::max(whole, f64::MIN_POSITIVE)).sqrt());
        worst.1
    }

    /// Σ_j w R_ijᵀR_ij of the cloud around particle `m`, among itself and then its neighbours.
    pub(super) fn residual_block(&self, m: usize) -> Vec<Vec<f64>> {
        let edges = self.of(m);
        let n = edges.len() + 1;
        let offset = |k: usize| self.x[edges[k - 1].other as usize] - self.x[m];
        let inverse = self.inverse(m);
        let solved = |k: usize| Vector::from_fn(|r| (0..D).map(|c| inverse[r][c] * offset(k)[c]).sum::<f64>());
        let solved: Vec<Vector<D>> = (1..n).map(solved).collect();
        let weight = |k: usize| 1.0 / offset(k).norm_squared();
        let mut residual = vec![vec![0.0; n]; n];
        for j in 1..n {
            for k in 1..n {
                let diagonal = if j == k { weight(j) } else { 0.0 };
                let entry = diagonal - weight(j) * weight(k) * offset(j).dot(&solved[k - 1]);
                residual[j][k] += entry;
                residual[0][k] -= entry;
                residual[j][0] -= entry;
                residual[0][0] += entry;
            }
        }
        residual
    }

    /// A matrix of zeros among those that share a cloud, with `block` rows a particle: each with itself and later ones.
    pub(super) fn pattern(&self, block: usize) -> sparse::Symmetric {
        let mut all = sparse::Symmetric { first: vec![0], ..sparse::Symmetric::default() };
        let (mut later, mut seen) = (Vec::new(), vec![usize::MAX; self.len()]);
        for i in 0..self.len() {
            later.clear();
            let near = |i: usize| self.of(i).iter().map(|e| e.other as usize);
            for k in near(i).chain(std::iter::once(i)).flat_map(|m| near(m).chain(std::iter::once(m))) {
                if k >= i && seen[k] != i {
                    seen[k] = i;
                    later.push(k);
                }
            }
            later.sort_unstable();
            for a in 0..block {
                for k in &later {
                    let from = if *k == i { a } else { 0 };
                    all.row.extend((from..block).map(|c| k * block + c));
                }
                all.first.push(all.row.len());
            }
        }
        all.value = vec![0.0; all.row.len()];
        all
    }

    /// Factors of L, which the linear fields that it does not see would make singular, with a little of its diagonal; `None` of
    /// large clouds.
    fn factored(&self, diagonal: &[f64]) -> Option<sparse::Factors> {
        if self.len() > FACTORED[D - 2] {
            return None;
        }
        let mut all = self.pattern(1);
        for m in 0..self.len() {
            let block = self.residual_block(m);
            let members: Vec<usize> = std::iter::once(m).chain(self.of(m).iter().map(|e| e.other as usize)).collect();
            for (j, row) in members.iter().enumerate() {
                for (k, column) in members.iter().enumerate().filter(|(_, column)| **column <= *row) {
                    let range = all.first[*column]..all.first[*column + 1];
                    let at = range.start + all.row[range.clone()].partition_point(|r| r < row);
                    all.value[at] += self.corrected(m) * block[j][k];
                }
            }
        }
        for (k, d) in diagonal.iter().enumerate() {
            all.value[all.first[k]] += LITTLE * d;
        }
        all.factor()
    }

    /// Gradients of all components of a field by the plain fit.
    fn raw_gradient(&self, i: usize, q: &[Vector<D>]) -> [Vector<D>; D] {
        let mut moments = [Vector::ZERO; D];
        for e in self.of(i) {
            let d = self.x[e.other as usize] - self.x[i];
            let change = (q[e.other as usize] - q[i]) * (1.0 / d.norm_squared());
            (0..D).for_each(|a| moments[a] += d * change[a]);
        }
        let inverse = &self.inverse[i];
        moments.map(|m| Vector::from_fn(|r| (0..D).map(|c| inverse[r][c] * m[c]).sum()))
    }

    /// (L q)_i = Σ_j w (V_j R_ji − V_i R_ij).
    fn residuals(&self, i: usize, q: &[Vector<D>], gradient: &[[Vector<D>; D]]) -> Vector<D> {
        self.of(i).iter().fold(Vector::ZERO, |sum, e| {
            let j = e.other as usize;
            let d = self.x[j] - self.x[i];
            let (there, here) = (residual((q, gradient), (j, i), &-d), residual((q, gradient), (i, j), &d));
            sum + (there * self.corrected(j) - here * self.corrected(i)) * (1.0 / d.norm_squared())
        })
    }

    /// Volume of all.
    pub fn whole(&self) -> f64 {
        sum(self.len(), |i| self.volume[i])
    }
}

/// R_ij(q) of all components.
#[inline(always)]
fn residual<const D: usize>(
    (q, gradient): (&[Vector<D>], &[[Vector<D>; D]]),
    (i, j): (usize, usize),
    d: &Vector<D>,
) -> Vector<D> {
    Vector::from_fn(|a| q[j][a] - q[i][a] - d.dot(&gradient[i][a]))
}

/// All particles within `reach` of each, in the order of their numbers.
fn neighbours<const D: usize>(x: &[Vector<D>], reach: f64) -> Vec<Vec<u32>> {
    let mut grid = Grid::new(reach);
    x.iter().enumerate().for_each(|(k, x)| grid.insert(x, k as u32));
    let mut lists = vec![Vec::new(); x.len()];
    sweep_each(&mut lists, |i| {
        let mut list = Vec::new();
        grid.near(&x[i], reach, |j| {
            let near = (x[j as usize] - x[i]).norm_squared() < reach * reach;
            if near && j as usize != i {
                list.push(j);
            }
        });
        list.sort_unstable();
        list
    });
    lists
}
