//! Exactly conservative coefficients.
//!
//! The unknowns are one area vector per pair of particles, s_ij = −s_ji, and one volume per fluid particle. They are to
//! be as near as possible to those of the least-squares fit, s⁰_ij = V⁰_i a_ij − V⁰_j a_ji: minimise Σ
//! |s − s⁰|²/w_ij + Σ (V − V⁰)²/b_i subject to
//!
//! - Σ_j s_ij + Σ_w s_iw = 0 for every fluid particle (hard constraint): what one particle loses another one gains;
//! - ½ Σ_j s_ij ⊗ d_ij + Σ_w s_iw ⊗ d_iw = V_i I (soft constraint with parameter ε): exactness for linear fields.
//!
//! A pair across a plane of symmetry or a periodic side is the same unknown viewed from its other end: s_ki' = −T
//! s_ik'. The area vector A_w of interface particle w is shared among the fluid particles in front of it, s_iw = −β_iw
//! A_w with Σ_i β_iw = 1 (hard constraint). Only pressure acts there, so that neither mass nor energy crosses a wall,
//! and the force on a body equals the momentum that the fluid loses.
//!
//! Eliminating s, β and V leaves a symmetric positive definite system for the Lagrange multipliers, with one small
//! block per particle (Nocedal and Wright, *Numerical Optimization*, 2nd ed., §16.2-16.3). It is solved by conjugate
//! gradients, preconditioned by sweeps over the particles and over groups of them (module `cycle`). A second system for
//! the closure alone then reduces the closure defect to round-off (module `closure`). Antisymmetric coefficients of
//! this kind were introduced by Chiu, Wang, Hu and Jameson (SIAM J. Sci. Comput. 34, 2012).
mod closure;
mod cycle;
mod field;
mod levels;
mod rows;
mod symmetry;
mod walls;

use std::cmp::Ordering;
use std::collections::HashMap;
use std::ops::Range;

use cycle::{Cycle, Levels, Way};
use field::{Field, Moments};
use walls::along;

use super::coefficient_unknowns::{ITSELF, Kind, Link, Links};
use super::layers::{below_first, grown_face};
use super::multipliers::{Factors, Lanes, Row, add_to, lanes, opposite, part_of};
use super::operators::{Reverse, WallFace};
use super::{Cloud, Operators};
use crate::math::Vector;
use crate::math::conjugate::{Row as _, Symmetric, conjugate_gradients};
use crate::math::parallel::{sweep, sweep_parts, sweep_slots};
use crate::math::reduce::sum;

/// Softness ε in 2-D and 3-D: the square of the tolerated relative error of linear consistency in units of relative
/// changes of s, measured by w and b. In 3-D, the errors with 0.02 would still be visible in the pressure on a sphere.
const SOFTNESS: [f64; 2] = [0.02, 0.005];
/// Factor on ε around particles whose volume became too small.
const SOFTEN: f64 = 10.0;
/// Greatest number of times that ε is raised.
const SOFTEN_ROUNDS: usize = 4;
/// Smallest permitted volume, in units of h^D.
const SMALLEST_VOLUME: f64 = 0.2;
/// Mobility b of the volumes, in units of h^2D.
const VOLUME_FREEDOM: f64 = 1.0;
/// Exponent of the inverse distance in the initial guess of the shares.
const SHARE_POWER: i32 = 4;
/// Relative residual to which the multipliers are solved.
const TOLERANCE: f64 = 1e-2;
/// Relative residual where only the volumes are needed.
const ROUGH: f64 = 5e-2;

/// Greatest number of iterations for the multipliers; about thirty are usual. At thin edges and in crevices, the
/// constraints nearly contradict one another, and hundreds of iterations more would only shift the linear error from
/// one particle to another.
const MAX_MULTIPLIER_ITERATIONS: usize = 100;
/// Greatest number of iterations for the closure, which has to reach round-off.
const MAX_CLOSURE_ITERATIONS: usize = 4000;
/// Largest linear error with which a flow can be computed, chosen generously: a sound cloud has less than one. In
/// crevices narrower than the spacing, the constraints may contradict one another and yield area vectors of any size.
const WORST_ERROR: f64 = 1e3;

/// Accuracy and cost of the conservative coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConservativeReport {
    /// Number of iterations for the multipliers.
    pub iterations: usize,
    /// Number of iterations of the closure solver.
    pub polish_iterations: usize,
    /// Largest relative closure defect |Σ s| / Σ |s| of a fluid particle.
    pub closure_defect: f64,
    /// Root mean square over the fluid particles of the relative linear error |½ Σ s ⊗ d − V I| / V.
    pub linear_error_rms: f64,
    /// Largest relative linear error.
    pub linear_error_max: f64,
    /// Index of the particle with the largest linear error.
    pub worst: usize,
    /// Smallest volume in units of h^D.
    pub min_volume_ratio: f64,
    /// Softness ε that was used before any increase.
    pub softness: f64,
    /// Number of particles around which ε was raised to keep the volumes positive.
    pub n_softened: usize,
}

impl ConservativeReport {
    /// True when a flow can be computed with the coefficients.
    pub fn is_sound(&self) -> bool {
        self.linear_error_max < WORST_ERROR && self.min_volume_ratio.is_finite()
    }
}

/// Replaces the area vectors of the edges, the wall faces and the volumes of the fluid particles by exactly
/// conservative ones, for a flux that uses no other coefficients. The default flux cannot use the result.
pub fn conservative<const D: usize>(cloud: &mut Cloud<D>, operators: &mut Operators<D>) -> ConservativeReport {
    conservative_with(cloud, operators, SOFTNESS[D - 2])
}

/// Computes conservative coefficients as [`conservative`] does, with a given softness ε.
pub fn conservative_with<const D: usize>(
    cloud: &mut Cloud<D>,
    operators: &mut Operators<D>,
    softness: f64,
) -> ConservativeReport {
    let (volume, faces, report) = find(cloud, operators, softness);
    operators.set_wall_faces(faces);
    cloud.volume[..volume.len()].copy_from_slice(&volume);
    let first = cloud.n_real();
    for (k, image) in cloud.ghosts.iter().enumerate() {
        cloud.volume[first + k] = cloud.volume[image.source as usize];
    }
    report
}

/// Finds volumes and wall faces, and sets the area vectors of the edges.
fn find<const D: usize>(
    cloud: &Cloud<D>,
    operators: &mut Operators<D>,
    softness: f64,
) -> (Vec<f64>, Vec<WallFace<D>>, ConservativeReport) {
    // initial guess: the area vectors of the least-squares fit, and none to walls
    operators.alter_areas(|i, j, s| match cloud.interface_range().contains(&cloud.source(j).index) {
        true => Vector::ZERO,
        false => *s * grown_face(cloud, i, j),
    });
    let mut problem = Problem::new(cloud, softness);
    let levels = Levels::new(&problem, symmetry::mirrors(cloud));
    let mut multipliers = vec![Row::ZERO; problem.n_rows()];
    // a rough solution determines the volumes accurately enough
    let (mut iterations, mut n_softened, mut tolerance) = (0, 0, ROUGH);
    for round in 0.. {
        iterations += problem.solve(operators, &mut multipliers, &levels, tolerance);
        let softened = if round < SOFTEN_ROUNDS { problem.soften(&problem.volumes(&multipliers)) } else { 0 };
        match softened {
            0 if tolerance == TOLERANCE => break,
            0 => tolerance = TOLERANCE,
            _ => n_softened = softened,
        }
    }
    problem.recover(operators, multipliers);
    let polish_iterations = problem.close(operators, &levels);
    drop(levels);
    let report = ConservativeReport { iterations, polish_iterations, n_softened, softness, ..problem.judge(operators) };
    let faces = problem.wall_faces();
    (problem.volume, faces, report)
}

/// A fluid particle that has a share of the area of an interface particle, or of its image.
#[derive(Clone, Copy)]
struct Sharer {
    /// Index of the fluid particle.
    i: u32,
    /// Its neighbour entry for the interface particle.
    p: u32,
    /// Share β of the area.
    share: f64,
}

/// The constrained problem: its weights, the volumes of the fluid particles and the shares of the walls. The area
/// vectors are stored in the edges.
struct Problem<'a, const D: usize> {
    n_fluid: usize,
    cloud: &'a Cloud<D>,
    links: Links<'a, D>,
    /// Area vectors of the interface particles, directed out of the fluid.
    walls: Vec<Vector<D>>,
    /// Signs of the transforms.
    signs: Vec<Vector<D>>,
    /// Volumes; until the multipliers are known, their initial guess.
    volume: Vec<f64>,
    /// Unit of the volumes, spacing^D.
    unit: Vec<f64>,
    softness: Vec<f64>,
    softened: Vec<bool>,
    /// For each interface particle, the fluid particles that share its area.
    sharers: Vec<Vec<Sharer>>,
    /// For each interface particle, the sum of the weights of these.
    shared: Vec<f64>,
    /// For each row, the sum of the weights of all entries whose area vectors may change.
    passing: Vec<f64>,
    factors: Factors<D>,
}

impl<'a, const D: usize> Problem<'a, D> {
    fn new(cloud: &'a Cloud<D>, softness: f64) -> Self {
        let n_fluid = cloud.n_fluid;
        let links = Links::new(cloud);
        let mut sharers = vec![Vec::new(); cloud.interface.len()];
        for i in 0..n_fluid {
            for p in links.range(i).filter(|p| links.end(*p) >= n_fluid) {
                let link = links.at(i, p);
                if link.is_wall() {
                    sharers[link.other as usize - n_fluid].push(Sharer { i: i as u32, p: p as u32, share: 0.0 });
                }
            }
        }
        // initial guess of the shares of every wall: inverse powers of the distance
        for all in &mut sharers {
            let weight = |s: &Sharer| links.at(s.i as usize, s.p as usize).offset.norm().powi(-SHARE_POWER);
            let total: f64 = all.iter().map(weight).sum();
            all.iter_mut().for_each(|s| s.share = weight(s) / total);
        }
        let mut volume = cloud.volume[..n_fluid].to_vec();
        volume.iter_mut().enumerate().for_each(|(i, v)| *v += below_first(cloud, i).unwrap_or(0.0));
        let walls = cloud.interface.iter().map(|w| -w.area).collect();
        let signs = cloud.transforms.iter().map(|t| t.sign).collect();
        let weight = |s: &Sharer| links.at(s.i as usize, s.p as usize).weight;
        let shared =
            sharers.iter().map(|all: &Vec<_>| all.iter().map(weight).sum::<f64>().max(f64::MIN_POSITIVE)).collect();
        let mut passing = vec![0.0; n_fluid];
        sweep(&mut passing, |i| {
            let weights = links.of(i).filter(|(_, l)| !l.is_wall()).map(|(_, l)| l.weight);
            weights.sum::<f64>().max(f64::MIN_POSITIVE)
        });
        Self {
            n_fluid,
            cloud,
            links,
            walls,
            signs,
            unit: volume.clone(),
            volume,
            softness: vec![softness; n_fluid],
            softened: vec![false; n_fluid],
            sharers,
            shared,
            passing,
            factors: Factors::default(),
        }
    }

    fn link(&self, s: &Sharer) -> Link<D> {
        self.links.at(s.i as usize, s.p as usize)
    }

    fn n_rows(&self) -> usize {
        self.n_fluid + self.sharers.len()
    }

    /// Area vector of the interface particle, or of its image, at the other end of an entry.
    fn wall(&self, link: &Link<D>) -> Vector<D> {
        let Kind::Wall(transform) = link.kind else { return Vector::ZERO };
        let a = self.walls[link.other as usize - self.n_fluid];
        if transform == ITSELF { a } else { Vector::from_fn(|d| self.signs[transform as usize][d] * a[d]) }
    }

    /// Change of the area vector of one entry of row `i`: W Aᵀ λ.
    #[inline(always)]
    fn change(&self, i: usize, link: &Link<D>, y: &[Row<D>]) -> Vector<D> {
        match link.kind {
            Kind::Wall(_) => self.wall_change(i, link, y),
            _ => {
                let middle = part_of(&link.offset, 0.5);
                let change = self.pair_change(&y[i], link, &middle, y);
                Vector::from_fn(|d| link.weight * f64::from(change[d]))
            }
        }
    }

    /// Change of the area vector between two particles, located at the midpoint, divided by its weight.
    #[inline(always)]
    fn pair_change(&self, own: &Row<D>, link: &Link<D>, middle: &[f32; D], y: &[Row<D>]) -> Lanes {
        let mut change = own.at(middle);
        if link.kind != Kind::Open {
            add_to(&mut change, -1.0, &self.there(link, middle, &y[link.other as usize]));
        }
        change
    }

    /// Value at the midpoint of the field of the particle at the other end of an entry.
    #[inline(always)]
    fn there(&self, link: &Link<D>, middle: &[f32; D], other: &Row<D>) -> Lanes {
        let back = opposite(middle);
        match link.kind {
            Kind::Image(t) => other.mirrored(&self.signs[t as usize]).at(&back),
            _ => other.at(&back),
        }
    }

    /// The product (A W Aᵀ + ε) y in the row of a fluid particle.
    #[inline(always)]
    fn row(&self, i: usize, y: &[Row<D>]) -> Row<D> {
        let (own, mut row) = (&y[i], self.soft(i, &y[i]));
        let [near, beyond] = self.links.sorted(i);
        for p in near {
            let (j, middle, weight, both) = self.links.near(i, p);
            let mut change = own.at(&middle);
            if both {
                add_to(&mut change, -1.0, &y[j].at(&opposite(&middle)));
            }
            row.add(weight, &change, &middle);
        }
        if beyond.is_empty() { row } else { row.plus(1.0, &self.row_beyond(i, beyond, y)) }
    }

    /// Contribution to the product from entries whose other end is not a fluid particle.
    #[inline(never)]
    fn row_beyond(&self, i: usize, entries: Range<usize>, y: &[Row<D>]) -> Row<D> {
        let mut row = Row::ZERO;
        for p in entries {
            let link = &self.links.at(i, p);
            match link.kind {
                Kind::Wall(_) => row.add(1.0, &lanes(&self.wall_change(i, link, y)), &part_of(&link.offset, 1.0)),
                _ => {
                    let middle = part_of(&link.offset, 0.5);
                    row.add(link.weight as f32, &self.pair_change(&y[i], link, &middle, y), &middle);
                }
            }
        }
        row
    }

    /// Contribution to the product from the softness and the mobility of the volume.
    #[inline(always)]
    fn soft(&self, i: usize, y: &Row<D>) -> Row<D> {
        let mut row = y.slopes(self.tolerance(i));
        row.add_to_trace(self.volume_freedom(i) * y.trace());
        row
    }

    /// Computes out = (A W Aᵀ + ε) y.
    fn apply(&self, y: &[Row<D>], out: &mut [Row<D>]) {
        let (fluid, walls) = out.split_at_mut(self.n_fluid);
        sweep(fluid, |i| self.row(i, y));
        sweep(walls, |w| Row::ZERO.with_share(self.wall_row(w, y)));
    }

    /// Softness of linear consistency for particle `i`, with units.
    fn tolerance(&self, i: usize) -> f64 {
        self.softness[i] * self.unit[i] * self.unit[i]
    }

    fn volume_freedom(&self, i: usize) -> f64 {
        VOLUME_FREEDOM * self.unit[i] * self.unit[i]
    }

    /// Defects of all constraints for the current area vectors, shares and volumes.
    fn defects(&self, operators: &Operators<D>) -> Vec<Row<D>> {
        let mut all = self.sums(operators, Row::ZERO, |row, s, d| row.add(1.0, &lanes(s), &part_of(d, 1.0)));
        sweep_slots(&mut all, |i, row| row.add_to_trace(-self.volume[i]));
        let missing = |sharers: &Vec<Sharer>| match &sharers[..] {
            [] => Row::ZERO,
            all => Row::ZERO.with_share(all.iter().map(|s| s.share).sum::<f64>() - 1.0),
        };
        all.extend(self.sharers.iter().map(missing));
        all
    }

    /// For every fluid particle, accumulates `add(sum, s, d)` over its area vectors s at the offsets d.
    fn sums<T: Clone + Send>(
        &self,
        operators: &Operators<D>,
        zero: T,
        add: impl Fn(&mut T, &Vector<D>, &Vector<D>) + Sync,
    ) -> Vec<T> {
        // capacity for the walls too
        let mut all = Vec::with_capacity(self.n_rows());
        all.resize(self.n_fluid, zero);
        let (cloud, parts) = (self.cloud, operators.fluid_parts());
        sweep_parts(parts, 1, &mut all, &|k, out| {
            let start = parts[k].start;
            for e in operators.edges(k) {
                let middle = (cloud.x[e.j()] - cloud.x[e.i()]) * 0.5;
                add(&mut out[e.i() - start], &e.s, &middle);
                if e.both() && e.seen_back() {
                    add(&mut out[e.j() - start], &-e.s, &-middle);
                }
            }
        });
        for s in self.sharers.iter().flatten() {
            let link = self.link(s);
            add(&mut all[s.i as usize], &(self.wall(&link) * s.share), &link.offset);
        }
        all
    }

    /// Adds `change(i, link)` to the area vectors; the change is computed equally, except for its sign, at either end
    /// of a pair.
    fn alter(&self, operators: &mut Operators<D>, change: impl Fn(usize, &Link<D>) -> Vector<D> + Sync) {
        operators.alter_areas(|i, j, s| match self.links.between(i, j) {
            Some((_, link)) if !link.is_wall() => *s + change(i, &link),
            _ => *s,
        });
        self.mirror(operators);
    }

    /// Sets the area vectors to images: computed at one end and copied to the other with the reversed sign.
    fn mirror(&self, operators: &mut Operators<D>) {
        let reverse = Reverse::new(self.cloud);
        let beyond = self.cloud.n_real();
        let known: HashMap<(usize, usize), Vector<D>> = match self.signs.is_empty() {
            true => return,
            false => (0..operators.n_fluid_parts)
                .flat_map(|k| operators.edges(k))
                .filter(|e| e.j() >= beyond)
                .map(|e| ((e.i(), e.j()), e.s))
                .collect(),
        };
        operators.alter_areas(|i, j, s| {
            let Some((p, Link { kind: Kind::Image(t), other, .. })) =
                (j >= beyond).then(|| self.links.between(i, j)).flatten()
            else {
                return *s;
            };
            let Some((partner, _)) = reverse.position(i, j) else { return *s };
            let signs = &self.signs[t as usize];
            match partner.cmp(&p) {
                Ordering::Greater => *s,
                // between a particle and its own image, only the component normal to the plane remains
                Ordering::Equal => Vector::from_fn(|d| if signs[d] < 0.0 { s[d] } else { 0.0 }),
                Ordering::Less => match known.get(&(other as usize, self.links.end(partner))) {
                    Some(seen) => Vector::from_fn(|d| -signs[d] * seen[d]),
                    None => *s,
                },
            }
        });
    }

    /// Volumes that correspond to the multipliers `y`.
    fn volumes(&self, y: &[Row<D>]) -> Vec<f64> {
        let mut volume = vec![0.0; self.n_fluid];
        sweep(&mut volume, |i| self.volume[i] - self.volume_freedom(i) * y[i].trace());
        volume
    }

    /// Replaces the initial guess by the solution that corresponds to the multipliers.
    fn recover(&mut self, operators: &mut Operators<D>, y: Vec<Row<D>>) {
        self.factors = Factors::default();
        self.alter(operators, |i, link| self.change(i, link, &y));
        self.share_out(&y);
        self.volume = self.volumes(&y);
    }

    /// Solves for the multipliers by conjugate gradients, starting from `y`; returns the number of iterations.
    fn solve(&mut self, operators: &Operators<D>, y: &mut [Row<D>], levels: &Levels<D>, tolerance: f64) -> usize {
        self.factors = Factors::new(self.n_fluid, |i| self.own(i));
        let mut r = self.defects(operators);
        let size = |r: &Row<D>, i: usize| match i.checked_sub(self.n_fluid) {
            Some(w) => r.share().powi(2) / self.shared[w],
            None => r.dot(&self.factors.solve(i, r)),
        };
        let goal = tolerance * tolerance * sum(self.n_rows(), |i| size(&r[i], i));
        let less = |i: usize, r: &mut Row<D>| *r = Row::ZERO.plus(-1.0, &r.plus(1.0, &self.row(i, y)));
        sweep_slots(&mut r[..self.n_fluid], less);
        sweep_slots(&mut r[self.n_fluid..], |w, r| *r = r.with_share(-r.share() - self.wall_row(w, y)));
        let mut cycle = Cycle::new(levels, self.n_fluid);
        let precondition = |r: &[Row<D>], z: &mut [Row<D>]| cycle.nearly_solve(self, r, z);
        let enough = |r: &[Row<D>]| sum(r.len(), |i| size(&r[i], i)) <= goal;
        let product = |y: &[Row<D>], out: &mut [Row<D>]| self.apply(y, out);
        conjugate_gradients(y, &mut r, MAX_MULTIPLIER_ITERATIONS, Symmetric { enough, product, precondition })
    }

    /// Raises ε around particles whose volume is too small. Returns the number of particles affected so far, or zero
    /// when nothing changed.
    fn soften(&mut self, volume: &[f64]) -> usize {
        let low: Vec<usize> = (0..self.n_fluid)
            .filter(|i| volume[*i].is_nan() || volume[*i] <= SMALLEST_VOLUME * self.unit[*i])
            .collect();
        let mut touched = low.clone();
        for i in &low {
            touched.extend(self.links.of(*i).map(|(_, l)| l.other as usize).filter(|k| *k < self.n_fluid));
        }
        touched.sort_unstable();
        touched.dedup();
        for i in &touched {
            self.softness[*i] *= SOFTEN;
            self.softened[*i] = true;
        }
        if low.is_empty() { 0 } else { self.softened.iter().filter(|s| **s).count() }
    }

    /// For every fluid particle, the sum of the magnitudes of its area vectors.
    fn surfaces(&self, operators: &Operators<D>) -> Vec<f64> {
        self.sums(operators, 0.0, |sum, s, _| *sum += s.norm())
    }

    fn judge(&self, operators: &Operators<D>) -> ConservativeReport {
        let (mut closure, mut square, mut largest, mut volume) = (0.0f64, 0.0, (0.0f64, 0), f64::INFINITY);
        let (open, surfaces) = (self.open(operators), self.surfaces(operators));
        let moments = self.sums(operators, [Vector::ZERO; D], |m, s, d| (0..D).for_each(|c| m[c] += *s * d[c]));
        for (i, moment) in moments.iter().enumerate() {
            closure = closure.max(open[i].norm() / surfaces[i].max(f64::MIN_POSITIVE));
            let miss = |c: usize| moment[c] - Vector::axis(c) * self.volume[i];
            let error = (0..D).map(|c| miss(c).norm_squared()).sum::<f64>().sqrt() / self.volume[i].abs();
            square += error * error;
            // NaN counts as the largest error
            largest = if error <= largest.0 || largest.0.is_nan() { largest } else { (error, i) };
            volume = volume.min(self.volume[i] / self.unit[i]);
        }
        ConservativeReport {
            iterations: 0,
            polish_iterations: 0,
            closure_defect: closure,
            linear_error_rms: (square / self.n_fluid.max(1) as f64).sqrt(),
            linear_error_max: largest.0,
            worst: largest.1,
            min_volume_ratio: volume,
            softness: 0.0,
            n_softened: 0,
        }
    }

    /// The diagonal block of row `i`, as a function of its multipliers.
    fn own(&self, i: usize) -> impl Fn(&Row<D>) -> Row<D> {
        let (mut pairs, mut walls) = (Moments::<D>::ZERO, Vec::new());
        for (_, link) in self.links.of(i) {
            match link.kind {
                Kind::Wall(_) => walls.push((self.wall(&link), link)),
                _ => pairs = pairs.plus(1.0, &Moments::of(link.weight, &part_of(&link.offset, 0.5))),
            }
        }
        move |y| {
            let mut row = y.weighed(&pairs).plus(1.0, &self.soft(i, y));
            for (a, link) in &walls {
                let area = *a * (link.weight * along(y, link, a));
                row.add(1.0, &lanes(&area), &part_of(&link.offset, 1.0));
            }
            row
        }
    }

    /// Entries of row `i` whose area vectors may change.
    fn passing(&self, i: usize) -> impl Iterator<Item = Link<D>> {
        self.links.of(i).map(|(_, l)| l).filter(|l| !l.is_wall())
    }

    /// Calls `f(row, middle, weight)` for the entries of row `i` to rows of a range that the sweep has passed. Images
    /// of rows count as lying outside the range.
    #[inline(always)]
    fn each_passed(&self, i: usize, range: &Range<usize>, way: Way, mut f: impl FnMut(usize, &[f32; D], f32)) {
        for p in self.links.range(i) {
            if way.has_passed(range, i, self.links.end(p)) {
                let (j, middle, weight, both) = self.links.near(i, p);
                if both {
                    f(j, &middle, weight);
                }
            }
        }
    }

    /// Sign of component `r` of the row at the other end of an entry, as viewed from the first end.
    #[inline(always)]
    fn sign(&self, link: &Link<D>, r: usize) -> f64 {
        match link.kind {
            Kind::Image(t) => self.signs[t as usize][r],
            _ => 1.0,
        }
    }
}

#[cfg(test)]
mod tests;
