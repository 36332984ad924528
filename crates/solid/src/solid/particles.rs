//! Particles of an undeformed solid: positions, volumes, and the fit of gradients.
//!
//! The gradients are the least-squares fits of the flow solver, ∇φ_i = Σ_j g_ij (φ_j − φ_i) with the weights
//! w = 1/|d|², over all neighbours j, which are adjacent particles of its rows or all particles within [`REACH`]
//! spacings. They are then made *variationally consistent*: of all corrections that preserve exactness for linear
//! fields, the smallest one in the norm of the weights is added such that the discrete divergence theorem Σ_i V_i
//! g_ij = A_j holds with the area vectors A of the surface. Uniform stress then has no internal force, and the exact
//! traction on the surface, on any cloud. Corrections that preserve exactness for linear fields are residuals of the
//! fit itself, R_ij(λ) = λ_j − λ_i − d_ij·∇λ_i, so that λ solves L λ = A − Σ V g once for each axis, with L = Σ_i V_i
//! Σ_j w R_ijᵀR_ij (following Chen, Hillman and Rüter 2013, doi:10.1002/nme.4512, who correct test functions in this
//! manner). In a body of revolution, Σ_i V_i g_ij = A_j − 2π a_j e_r takes the place of the divergence theorem
//! (`axis`).
use std::ops::Range;

use crate::cloud::grid::Grid;
use crate::math::Vector;
use crate::math::conjugate::{Symmetric, conjugate_gradients};
use crate::math::least_squares::{gradient_weight, normal_inverse, normal_matrix};
use crate::math::parallel::{sweep, sweep_each};
use crate::math::reduce::{first, maximum, sum};
use crate::math::sparse;

/// Radius of a neighbour list in spacings, in 2-D and 3-D, where rows do not define the neighbours. It lies between the
/// second and the third shell of a square and of a body-centred cubic lattice, so that no diagonal of a sheared cell is
/// lost.
pub const REACH: [f64; 2] = [1.8, 1.4];
/// Number of neighbours below which a particle is joined to all others with which it shares simplices.
const FEW: usize = 8;
/// Tolerance of the divergence theorem, relative to the area h^(D−1) of a particle.
const CLOSED: f64 = 1e-11;
/// Greatest number of particles for which the equations of the correction are preconditioned by factors, in 2-D and
/// 3-D.
const FACTORED: [usize; 2] = [200_000, 30_000];
/// Fraction of its diagonal that is added to a matrix which is singular for linear fields.
const LITTLE: f64 = 1e-10;
/// Greatest relative change of the weights by the correction, as root mean square over a neighbour list; it is one half
/// on random clouds.
const MAX_CORRECTION: f64 = 0.8;
/// Greatest number of iterations for the correction.
const ITERATIONS: usize = 5000;

/// A neighbour of a particle.
#[derive(Clone, Copy, Debug)]
pub struct Edge<const D: usize> {
    /// Index of the neighbour.
    pub other: u32,
    /// Weight w of the pair in the fits.
    pub weight: f64,
    /// V_i g_ij of the particle itself.
    pub own: Vector<D>,
    /// V_j g_ji of the neighbour.
    pub counter: Vector<D>,
}

/// A flat piece of the surface between particles, which share its area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet<const D: usize> {
    /// Particles at its corners, in order when viewed from outside; the first `count` entries are valid.
    corners: [u32; 4],
    count: u8,
    /// Fraction of the area that belongs to each corner.
    parts: [f64; 4],
    /// Area vector, directed outward (length instead of area in 2-D).
    pub area: Vector<D>,
}

impl<const D: usize> Facet<D> {
    /// The facet between at most four particles, which share its area equally.
    pub fn new(between: &[u32], area: Vector<D>) -> Self {
        let mut corners = [0; 4];
        corners[..between.len()].copy_from_slice(between);
        Self { corners, count: between.len() as u8, parts: [1.0 / between.len() as f64; 4], area }
    }

    /// The same corners with another area, of which these fractions belong to the first two corners.
    pub(super) fn weighted(&self, area: Vector<D>, [a, b]: [f64; 2]) -> Self {
        Self { parts: [a, b, 0.0, 0.0], area, ..*self }
    }

    /// Particles at the corners.
    pub fn corners(&self) -> &[u32] {
        &self.corners[..usize::from(self.count)]
    }

    /// Corners with the part of the area vector that belongs to each.
    pub fn shares(&self) -> impl Iterator<Item = (usize, Vector<D>)> {
        self.corners().iter().zip(self.parts).map(|(i, part)| (*i as usize, self.area * part))
    }

    /// The facet with its corners renumbered.
    fn renumbered(&self, new: &[u32]) -> Self {
        let between: Vec<u32> = self.corners().iter().map(|i| new[*i as usize]).collect();
        Self { parts: self.parts, ..Self::new(&between, self.area) }
    }
}

/// Positions, volumes and surface of particles, before gradients are fitted. Lengths are in the unit of the geometry.
#[derive(Clone, Debug, Default)]
pub struct Fill<const D: usize> {
    /// Undeformed positions; surface particles come first.
    pub x: Vec<Vector<D>>,
    /// Volume of each particle; area in 2-D.
    pub volume: Vec<f64>,
    /// Facets of the surface.
    pub facets: Vec<Facet<D>>,
    /// Distance between neighbours.
    pub spacing: f64,
    /// Neighbours of each particle in ascending order, where rows define them; empty: all particles within reach.
    pub rows: Vec<Vec<u32>>,
    /// For each particle, the others with which it shares simplices, in ascending order; empty unless volumes come from
    /// tetrahedra.
    pub ties: Vec<Vec<u32>>,
    /// First moment that each particle represents in addition to volume times position, in 2-D; empty in 3-D.
    pub moment: Vec<Vector<D>>,
    /// 2π times the plane area of each particle of a body of revolution; empty for other bodies.
    pub turn: Vec<f64>,
}

impl<const D: usize> Fill<D> {
    /// The fill with neighbours defined as all particles within reach, except pairs for which `apart` holds and that
    /// share no simplex. Particles with few neighbours, such as those at sharp edges, get all those with which they
    /// share simplices.
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

    /// Defines all particles within reach as neighbours where rows do not define them.
    pub(super) fn find_rows(&mut self) {
        if self.rows.is_empty() {
            self.rows = neighbours(&self.x, REACH[D - 2] * self.spacing);
        }
    }

    /// Area vectors of all particles, directed outward; zero inside the body.
    pub fn areas(&self) -> Vec<Vector<D>> {
        let mut areas = vec![Vector::ZERO; self.x.len()];
        for facet in &self.facets {
            facet.shares().for_each(|(i, area)| areas[i] += area);
        }
        areas
    }

    /// The fill restricted to the particles `order`, with the facets between them.
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

/// The elements `order` of `all`; empty when `all` is empty.
fn picked<T: Copy>(all: &[T], order: &[usize]) -> Vec<T> {
    order.iter().filter_map(|i| all.get(*i).copied()).collect()
}

/// The rows `order` with renumbered neighbours; empty when `rows` is empty.
fn renumbered_rows(rows: &[Vec<u32>], order: &[usize], new: &[u32]) -> Vec<Vec<u32>> {
    order.iter().filter_map(|i| rows.get(*i)).map(|row| renumbered(row, new)).collect()
}

/// Renumbered neighbours, without those that have no new number.
fn renumbered(row: &[u32], new: &[u32]) -> Vec<u32> {
    let mut row: Vec<u32> = row.iter().map(|j| new[*j as usize]).filter(|j| *j != u32::MAX).collect();
    row.sort_unstable();
    row
}

/// Undeformed particles with the gradients among them.
#[derive(Clone, Debug)]
pub struct Particles<const D: usize> {
    /// Undeformed positions.
    pub x: Vec<Vector<D>>,
    /// Volume of each particle; area in 2-D.
    pub volume: Vec<f64>,
    /// Area vector of each particle, directed outward; zero inside the body.
    pub area: Vec<Vector<D>>,
    /// Facets of the surface.
    pub facets: Vec<Facet<D>>,
    /// Distance between neighbours at each particle.
    pub spacing: Vec<f64>,
    /// Largest relative change of the weights by the correction, as root mean square over a neighbour list.
    pub correction: f64,
    /// Number of iterations of the correction.
    pub iterations: usize,
    first: Vec<u32>,
    edges: Vec<Edge<D>>,
    inverse: Vec<[[f64; D]; D]>,
    /// 2π times the plane area of each particle of a body of revolution; empty for other bodies.
    turn: Vec<f64>,
}

/// Reason why no gradients could be fitted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParticlesError {
    /// A particle has too few neighbours, or all of them in one line or plane.
    #[error(
        "the solid particle at {place:?} has {count} neighbours, which do not determine a gradient: the body is too thin there for the spacing {spacing:.3e}"
    )]
    Alone {
        /// Position of the particle.
        place: Vec<f64>,
        /// Number of its neighbours.
        count: usize,
        /// Distance between neighbours there.
        spacing: f64,
    },
    /// The correction would change the weights by more than permitted.
    #[error(
        "the divergence theorem would change the gradients of solid particles by {:.0} %, most at {place:?}, where a particle has {count} neighbours",
        100.0 * .correction
    )]
    Distorted {
        /// Position of the greatest change.
        place: Vec<f64>,
        /// Number of neighbours there.
        count: usize,
        /// Relative change of the weights, as root mean square.
        correction: f64,
    },
    /// The iteration for the divergence theorem did not converge.
    #[error(
        "the defect of the divergence theorem is {left:.1e} of a particle's area after {iterations} iterations: solid particles have too few neighbours, the one at {place:?} only {count}"
    )]
    Open {
        /// Position of the particle with the fewest neighbours.
        place: Vec<f64>,
        /// Number of its neighbours.
        count: usize,
        /// Remaining defect, relative to the area of a particle.
        left: f64,
        /// Number of iterations.
        iterations: usize,
    },
}

impl<const D: usize> Particles<D> {
    /// Fits gradients among the particles of unconnected bodies. Fails where a body is too thin for its spacing.
    pub fn new(bodies: Vec<Fill<D>>) -> Result<Self, ParticlesError> {
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

    /// True when there are no particles.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }

    /// Neighbours of particle `i`.
    #[inline(always)]
    pub fn of(&self, i: usize) -> &[Edge<D>] {
        &self.edges[self.range(i)]
    }

    /// Range of the neighbours of particle `i` among all pairs.
    #[inline(always)]
    pub fn range(&self, i: usize) -> Range<usize> {
        self.first[i] as usize..self.first[i + 1] as usize
    }

    /// Inverse normal matrix of the uncorrected fit at particle `i`.
    #[inline(always)]
    pub fn inverse(&self, i: usize) -> &[[f64; D]; D] {
        &self.inverse[i]
    }

    /// Mean number of neighbours.
    pub fn mean_neighbours(&self) -> f64 {
        self.edges.len() as f64 / self.len().max(1) as f64
    }

    /// Memory of the particles in bytes.
    pub fn bytes(&self) -> usize {
        self.edges.len() * size_of::<Edge<D>>()
            + self.len() * (size_of::<[[f64; D]; D]>() + 2 * size_of::<Vector<D>>() + 12)
    }

    /// Computes the uncorrected fits.
    fn fit(&mut self, lists: &[Vec<u32>]) -> Result<(), ParticlesError> {
        for (i, list) in lists.iter().enumerate() {
            let offset = |j: &u32| self.x[*j as usize] - self.x[i];
            let (normal, count) = normal_matrix(list.iter().map(offset));
            let Some((inverse, _)) = normal_inverse(&normal) else {
                return Err(ParticlesError::Alone { place: self.x[i].0.to_vec(), count, spacing: self.spacing[i] });
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

    /// True for a body of revolution, where the first coordinate is the radius.
    pub fn is_round(&self) -> bool {
        !self.turn.is_empty()
    }

    /// Volume of particle `i` for the correction; zero on an axis of revolution, where the gradient stays the
    /// uncorrected fit.
    #[inline(always)]
    fn corrected(&self, i: usize) -> f64 {
        if self.is_round() && self.x[i][0] == 0.0 { 0.0 } else { self.volume[i] }
    }

    /// 2π times the plane area of particle `i` of a body of revolution.
    #[cfg(test)]
    pub(super) fn turn(&self, i: usize) -> f64 {
        self.turn[i]
    }

    /// Length of the ring of particle `i` in a body of revolution, 2π times the radius but at least half a spacing; 1
    /// for other bodies. The volume around a particle is this length times h^D.
    pub fn around(&self, i: usize) -> f64 {
        if self.is_round() { std::f64::consts::TAU * self.x[i][0].max(0.5 * self.spacing[i]) } else { 1.0 }
    }

    /// Defect of the divergence theorem at particle `j`: Σ_i V_i g_ij − A_j, plus 2π a_j along the radius in a body of
    /// revolution.
    fn open(&self, j: usize) -> Vector<D> {
        let mut left = self.of(j).iter().fold(-self.area[j], |sum, e| sum + e.counter - e.own);
        if let Some(turn) = self.turn.get(j) {
            left[0] += turn;
        }
        left
    }

    /// Computes and applies the correction.
    fn close(&mut self) -> Result<(), ParticlesError> {
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
        if self.correction > MAX_CORRECTION {
            let (place, count) = (self.x[worst].0.to_vec(), self.of(worst).len());
            return Err(ParticlesError::Distorted { place, count, correction: self.correction });
        }
        let left = maximum(n, |j| self.open(j).max_abs() / size(j));
        if left <= 100.0 * CLOSED && first(n, |j| !self.open(j).is_finite()).is_none() {
            return Ok(());
        }
        let fewest = (0..n).min_by_key(|i| self.of(*i).len()).unwrap_or(0);
        let (place, count) = (self.x[fewest].0.to_vec(), self.of(fewest).len());
        Err(ParticlesError::Open { place, count, left, iterations: self.iterations })
    }

    /// Adds the residuals of `lambda` to the gradients; returns the particle whose weights change most.
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

    /// The matrix Σ_j w R_ijᵀR_ij of particle `m`, with itself first and then its neighbours.
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

    /// A zero matrix that couples all particles of common neighbour lists, with `block` rows per particle, lower
    /// triangle.
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

    /// Factors of L plus a small fraction of its diagonal, because L is singular for linear fields; `None` for large
    /// clouds.
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

    /// Gradients of all components of a field by the uncorrected fit.
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

    /// The product (L q)_i = Σ_j w (V_j R_ji − V_i R_ij).
    fn residuals(&self, i: usize, q: &[Vector<D>], gradient: &[[Vector<D>; D]]) -> Vector<D> {
        self.of(i).iter().fold(Vector::ZERO, |sum, e| {
            let j = e.other as usize;
            let d = self.x[j] - self.x[i];
            let (there, here) = (residual((q, gradient), (j, i), &-d), residual((q, gradient), (i, j), &d));
            sum + (there * self.corrected(j) - here * self.corrected(i)) * (1.0 / d.norm_squared())
        })
    }

    /// Total volume; area in 2-D.
    pub fn whole(&self) -> f64 {
        sum(self.len(), |i| self.volume[i])
    }
}

/// Residual R_ij(q) of all components.
#[inline(always)]
fn residual<const D: usize>(
    (q, gradient): (&[Vector<D>], &[[Vector<D>; D]]),
    (i, j): (usize, usize),
    d: &Vector<D>,
) -> Vector<D> {
    Vector::from_fn(|a| q[j][a] - q[i][a] - d.dot(&gradient[i][a]))
}

/// For each particle, all others within `reach`, in ascending order.
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
