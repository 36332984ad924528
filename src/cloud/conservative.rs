//! Exactly conservative coefficients.
//!
//! Wanted are one area vector per pair of particles, s_ij = −s_ji, and one volume per fluid particle, as near as possible to
//! those of the least-squares fit, s⁰_ij = V⁰_i a_ij − V⁰_j a_ji: minimise Σ |s − s⁰|²/w_ij + Σ (V − V⁰)²/b_i subject to
//!
//! - Σ_j s_ij + Σ_w s_iw = 0 for every fluid particle (hard): what one particle loses another gains;
//! - ½ Σ_j s_ij ⊗ d_ij + Σ_w s_iw ⊗ d_iw = V_i I (soft, with parameter ε): exact for linear fields.
//!
//! A pair seen through a plane of symmetry or a periodic side is the same unknown seen from its other end: s_ki' = −T s_ik'.
//! The area vector A_w of interface particle w is shared out among the fluid particles in front of it, s_iw = −β_iw A_w with
//! Σ_i β_iw = 1 (hard): only pressure acts there, so neither mass nor energy passes a wall, and the force on a body is what
//! the fluid loses.
//!
//! Eliminating s, β and V leaves a symmetric positive system for the multipliers of the conditions, one small block a
//! particle (Nocedal and Wright, *Numerical Optimization*, 2nd ed., §16.2-16.3): conjugate gradients, preconditioned by sweeps over
//! the particles and over groups of them (in `cycle`). A second solve over the closure alone then drives its defect to round-off (in
//! `closure`).
//! Antisymmetric coefficients of this kind are those of Chiu, Wang, Hu and Jameson (SIAM J. Sci. Comput. 34, 2012).
mod closure;
mod cycle;
mod field;
mod levels;
mod symmetry;

use std::ops::Range;

use cycle::{Cycle, Grid, Levels, Way};

use super::coefficient_unknowns::{ITSELF, Kind, Link, links, sweep_entries};
use super::layers::stand_on_wall;
use super::multipliers::{Factors, Row};
use super::operators::WallFace;
use super::{Cloud, Operators};
use crate::math::Vector;
use crate::math::conjugate::{Row as _, Symmetric, conjugate_gradients};
use crate::math::sweep::{sum, sweep, sweep_slots};

/// ε: square of the tolerated relative error of linear consistency against relative changes of s, in the measure of w and b;
/// in 2-D and 3-D, where the errors of 0.02 would still be seen in the pressure on a sphere.
const SOFTNESS: [f64; 2] = [0.02, 0.005];
/// Factor on ε around particles whose volume came out too small.
const SOFTEN: f64 = 10.0;
/// Rounds of softening.
const SOFTEN_ROUNDS: usize = 4;
/// Smallest volume allowed, in h^D.
const SMALLEST_VOLUME: f64 = 0.2;
/// b: how freely volumes move, relative to h^2D.
const VOLUME_FREEDOM: f64 = 1.0;
/// Power of the distance in the first guess of the shares.
const SHARE_POWER: i32 = 4;
/// Reduction of the residual of the multipliers.
const TOLERANCE: f64 = 1e-2;

/// Most iterations for the multipliers: some thirty are usual. At thin edges and in crevices the conditions nearly contradict one
/// another, and hundreds more would only trade one particle's linear error for another's.
const MOST_FOR_MULTIPLIERS: usize = 100;
/// Most iterations for the closure, which is to be round-off.
const MOST_ITERATIONS: usize = 4000;
/// Largest linear error of coefficients that a flow can be computed with, generously: a healthy cloud has less than one. In
/// crevices narrower than the spacing the conditions may contradict one another, and area vectors of any size come out.
const WORST_ERROR: f64 = 1e3;

/// What came out of the search for conservative coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConservativeReport {
    /// Iterations for the multipliers.
    pub iterations: usize,
    /// Iterations that polished the closure.
    pub polish_iterations: usize,
    /// Largest |Σ s| of a fluid particle over its Σ |s|.
    pub closure_defect: f64,
    /// Root mean square over fluid particles of |½ Σ s ⊗ d − V I| / V.
    pub linear_error_rms: f64,
    /// Largest value of the same.
    pub linear_error_max: f64,
    /// The particle where that is.
    pub worst: usize,
    /// Smallest volume over h^D.
    pub min_volume_ratio: f64,
    /// ε that was used, before any softening.
    pub softness: f64,
    /// Particles around which linear consistency was softened to keep volumes positive.
    pub n_softened: usize,
}

impl ConservativeReport {
    /// Whether a flow can be computed with the coefficients.
    pub fn is_sound(&self) -> bool {
        self.linear_error_max < WORST_ERROR && self.min_volume_ratio.is_finite()
    }
}

/// Rewrites `edge.s`, the pieces of wall and the volumes of the fluid particles so that a flux that uses nothing else
/// conserves mass, momentum and energy. The default flux does not work with the result.
pub fn conservative<const D: usize>(cloud: &mut Cloud<D>, operators: &mut Operators<D>) -> ConservativeReport {
    conservative_with(cloud, operators, SOFTNESS[D - 2])
}

/// The same with another ε.
pub fn conservative_with<const D: usize>(
    cloud: &mut Cloud<D>,
    operators: &mut Operators<D>,
    softness: f64,
) -> ConservativeReport {
    let mut problem = Problem::new(cloud, operators, softness);
    let levels = Levels::new(&problem, symmetry::mirrors(cloud));
    let mut multipliers = vec![Row::ZERO; problem.n_rows()];
    let mut iterations = problem.solve(&mut multipliers, &levels);
    let mut n_softened = 0;
    for _ in 0..SOFTEN_ROUNDS {
        let softened = problem.soften(&problem.volumes(&multipliers));
        if softened == 0 {
            break;
        }
        n_softened = softened;
        iterations += problem.solve(&mut multipliers, &levels);
    }
    let mut x = problem.recover(multipliers);
    problem.fix_shares(&mut x);
    let polish_iterations = problem.close(&mut x, &levels);
    let report = ConservativeReport { iterations, polish_iterations, n_softened, softness, ..problem.judge(&x) };
    store(cloud, operators, &problem, &x);
    report
}

/// The unknowns: an area vector, or a share, per entry, and a volume per fluid particle.
struct Unknowns<const D: usize> {
    area: Vec<Vector<D>>,
    volume: Vec<f64>,
}

struct Problem<const D: usize> {
    n_fluid: usize,
    first: Vec<u32>,
    links: Vec<Link<D>>,
    place: Vec<Vector<D>>,
    /// Area vectors of the interface particles, out of the fluid.
    walls: Vec<Vector<D>>,
    /// Signs of the transforms.
    signs: Vec<Vector<D>>,
    guess: Unknowns<D>,
    /// Spacing^D, the unit of the volumes.
    unit: Vec<f64>,
    softness: Vec<f64>,
    softened: Vec<bool>,
    /// Entries (row, entry) that share each wall.
    sharers: Vec<Vec<(u32, u32)>>,
    /// Weight of all who share each wall.
    shared: Vec<f64>,
    factors: Factors<D>,
}

impl<const D: usize> Problem<D> {
    fn new(cloud: &Cloud<D>, operators: &Operators<D>, softness: f64) -> Self {
        let n_fluid = cloud.n_fluid;
        let first = cloud.neighbours.first[..=n_fluid].to_vec();
        let links = links(cloud);
        let mut area = vec![Vector::ZERO; links.len()];
        for k in 0..operators.n_fluid_parts {
            for e in operators.edges(k) {
                let mut place = |i: usize, j: usize, s: Vector<D>| {
                    if let Ok(p) = cloud.neighbours.of(i).binary_search(&(j as u32)) {
                        area[first[i] as usize + p] = s;
                    }
                };
                place(e.i(), e.j(), e.s);
                if e.both() {
                    place(e.j(), e.i(), -e.s);
                }
            }
        }
        let mut sharers = vec![Vec::new(); cloud.interface.len()];
        for i in 0..n_fluid {
            for p in first[i]..first[i + 1] {
                let link = &links[p as usize];
                if let Kind::Wall(_) = link.kind {
                    sharers[link.other as usize - n_fluid].push((i as u32, p));
                }
            }
        }
        let mut guess = Unknowns { area, volume: cloud.volume[..n_fluid].to_vec() };
        stand_on_wall(cloud, &first, &mut guess.area, &mut guess.volume);
        let unit = guess.volume.clone();
        let softness = vec![softness; n_fluid];
        let softened = vec![false; n_fluid];
        let walls = cloud.interface.iter().map(|w| -w.area).collect();
        let signs = cloud.transforms.iter().map(|t| t.sign).collect();
        let weight = |s: &(u32, u32)| links[s.1 as usize].weight;
        let shared =
            sharers.iter().map(|all: &Vec<_>| all.iter().map(weight).sum::<f64>().max(f64::MIN_POSITIVE)).collect();
        let (place, factors) = (cloud.x[..n_fluid].to_vec(), Factors::default());
        let mut all = Self {
            n_fluid,
            first,
            links,
            place,
            walls,
            signs,
            guess,
            unit,
            softness,
            softened,
            sharers,
            shared,
            factors,
        };
        all.guess_shares();
        all
    }

    fn n_rows(&self) -> usize {
        self.n_fluid + self.sharers.len()
    }

    fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.first[i] as usize..self.first[i + 1] as usize
    }

    /// Area vector of the interface particle, or image of one, at the other end of an entry.
    fn wall(&self, link: &Link<D>) -> Vector<D> {
        let Kind::Wall(transform) = link.kind else { return Vector::ZERO };
        let a = self.walls[link.other as usize - self.n_fluid];
        if transform == ITSELF { a } else { Vector::from_fn(|d| self.signs[transform as usize][d] * a[d]) }
    }

    /// First guess of the shares of every wall: inverse powers of the distance. An entry holds s_iw = −β_iw A_w.
    fn guess_shares(&mut self) {
        for sharers in &self.sharers {
            let weight = |p: u32| self.links[p as usize].offset.norm().powi(-SHARE_POWER);
            let total: f64 = sharers.iter().map(|s| weight(s.1)).sum();
            for (_, p) in sharers {
                self.guess.area[*p as usize] = self.wall(&self.links[*p as usize]) * (weight(*p) / total);
            }
        }
    }

    /// W Aᵀ λ of one entry of row `i`: the change of its area vector.
    #[inline(always)]
    fn change(&self, i: usize, link: &Link<D>, y: &[Row<D>]) -> Vector<D> {
        let own = &y[i];
        let d = &link.offset;
        match link.kind {
            Kind::Pair | Kind::Image(_) => {
                let across = self.across(link, &y[link.other as usize]);
                Vector::from_fn(|r| own.closure[r] + 0.5 * own.moment[r].dot(d) - across[r]) * link.weight
            }
            Kind::Open => Vector::from_fn(|r| own.closure[r] + 0.5 * own.moment[r].dot(d)) * link.weight,
            Kind::Wall(_) => self.wall_change(i, link, y),
        }
    }

    /// The field of the particle at the other end of an entry in the middle between both.
    #[inline(always)]
    fn across(&self, link: &Link<D>, other: &Row<D>) -> Vector<D> {
        let d = &link.offset;
        match link.kind {
            Kind::Image(t) => {
                let t = &self.signs[t as usize];
                let back = Vector::from_fn(|c| t[c] * d[c]);
                Vector::from_fn(|r| t[r] * (other.closure[r] - 0.5 * other.moment[r].dot(&back)))
            }
            _ => Vector::from_fn(|r| other.closure[r] - 0.5 * other.moment[r].dot(d)),
        }
    }

    #[inline(never)]
    fn wall_change(&self, i: usize, link: &Link<D>, y: &[Row<D>]) -> Vector<D> {
        let a = self.wall(link);
        let along = Vector::from_fn(|r| y[i].closure[r] + y[i].moment[r].dot(&link.offset)).dot(&a);
        a * (link.weight * (along + y[link.other as usize].closure[0]))
    }

    /// The share that belongs to an area vector of a wall entry.
    fn share(&self, link: &Link<D>, area: &Vector<D>) -> f64 {
        let a = self.wall(link);
        area.dot(&a) / a.norm_squared().max(f64::MIN_POSITIVE)
    }

    /// (A W Aᵀ + ε) y in the row of a fluid particle.
    #[inline(always)]
    fn row(&self, i: usize, y: &[Row<D>]) -> Row<D> {
        let mut row = self.soft(i, &y[i]);
        for link in &self.links[self.range(i)] {
            row.add(&self.change(i, link, y), &link.offset, link.reach());
        }
        row
    }

    /// The part of it that is not of the pairs.
    #[inline(always)]
    fn soft(&self, i: usize, y: &Row<D>) -> Row<D> {
        let (volume, tolerance) = (self.volume_freedom(i) * y.trace(), self.tolerance(i));
        let mut row = Row { closure: Vector::ZERO, moment: y.moment.map(|m| m * tolerance) };
        (0..D).for_each(|r| row.moment[r][r] += volume);
        row
    }

    /// The same in the row of wall `w`.
    fn wall_row(&self, w: usize, y: &[Row<D>]) -> f64 {
        let share = |(k, p): &(u32, u32)| {
            let link = &self.links[*p as usize];
            self.share(link, &self.wall_change(*k as usize, link, y))
        };
        self.sharers[w].iter().map(share).sum()
    }

    /// out = (A W Aᵀ + ε) y.
    fn apply(&self, y: &[Row<D>], out: &mut [Row<D>]) {
        let (fluid, walls) = out.split_at_mut(self.n_fluid);
        sweep(fluid, |i| self.row(i, y));
        sweep(walls, |w| Row::ZERO.with_share(self.wall_row(w, y)));
    }

    /// How freely linear consistency is missed.
    fn tolerance(&self, i: usize) -> f64 {
        self.softness[i] * self.unit[i] * self.unit[i]
    }

    fn volume_freedom(&self, i: usize) -> f64 {
        VOLUME_FREEDOM * self.unit[i] * self.unit[i]
    }

    /// Defect of all conditions of row `i`.
    fn defect(&self, i: usize, x: &Unknowns<D>) -> Row<D> {
        let mut row = Row::ZERO;
        if i >= self.n_fluid {
            let sharers = self.sharers[i - self.n_fluid].iter();
            let total: f64 = sharers.map(|(_, p)| self.share(&self.links[*p as usize], &x.area[*p as usize])).sum();
            row.closure[0] = if self.sharers[i - self.n_fluid].is_empty() { 0.0 } else { total - 1.0 };
            return row;
        }
        for p in self.range(i) {
            let link = &self.links[p];
            row.add(&x.area[p], &link.offset, link.reach());
        }
        (0..D).for_each(|r| row.moment[r][r] -= x.volume[i]);
        row
    }

    /// The volumes that belong to multipliers.
    fn volumes(&self, y: &[Row<D>]) -> Vec<f64> {
        let mut volume = vec![0.0; self.n_fluid];
        sweep(&mut volume, |i| self.guess.volume[i] - self.volume_freedom(i) * y[i].trace());
        volume
    }

    /// Turns the guess into the unknowns that belong to multipliers. Each pair is computed at one end and copied to the other.
    fn recover(&mut self, y: Vec<Row<D>>) -> Unknowns<D> {
        self.factors = Factors::default();
        let mut area = std::mem::take(&mut self.guess.area);
        sweep_entries(&self.first, &mut area, |i, p, area| *area += self.change(i, &self.links[p], &y));
        let mut x = Unknowns { area, volume: self.volumes(&y) };
        self.mirror(&mut x);
        x
    }

    /// Copies area vectors to the partner entries, sign reversed.
    fn mirror(&self, x: &mut Unknowns<D>) {
        for (p, link) in self.links.iter().enumerate() {
            let q = link.partner as usize;
            match link.kind {
                Kind::Pair if p < q => x.area[q] = -x.area[p],
                // seen from its own image only the part across the plane is left
                Kind::Image(t) if p == q => {
                    let t = &self.signs[t as usize];
                    x.area[p] = Vector::from_fn(|d| if t[d] < 0.0 { x.area[p][d] } else { 0.0 })
                }
                Kind::Image(t) if p < q => x.area[q] = Vector::from_fn(|d| -self.signs[t as usize][d] * x.area[p][d]),
                _ => {}
            }
        }
    }

    /// Conjugate gradients for the multipliers, from those in `y`.
    fn solve(&mut self, y: &mut [Row<D>], levels: &Levels<D>) -> usize {
        self.factors = Factors::new(self.n_fluid, |i, y| self.own(i, y));
        let start = |i: usize| Row::ZERO.plus(-1.0, &self.defect(i, &self.guess));
        let mut r = vec![Row::ZERO; self.n_rows()];
        self.apply(y, &mut r);
        sweep_slots(&mut r, |i, r| *r = start(i).plus(-1.0, r));
        let size = |r: &Row<D>, i: usize| match i.checked_sub(self.n_fluid) {
            Some(w) => r.closure[0] * r.closure[0] / self.shared[w],
            None => r.dot(&self.factors.solve(i, r)),
        };
        let goal = TOLERANCE * TOLERANCE * sum(self.n_rows(), |i| size(&start(i), i));
        let mut cycle = Cycle::new(levels, self.n_fluid);
        let precondition = |r: &[Row<D>], z: &mut [Row<D>]| cycle.nearly_solve(self, r, z);
        let enough = |r: &[Row<D>]| sum(r.len(), |i| size(&r[i], i)) <= goal;
        let product = |y: &[Row<D>], out: &mut [Row<D>]| self.apply(y, out);
        conjugate_gradients(y, &mut r, MOST_FOR_MULTIPLIERS, Symmetric { enough, product, precondition })
    }

    /// Raises ε around particles whose volume is too small; number of particles touched so far, zero when nothing was done.
    fn soften(&mut self, volume: &[f64]) -> usize {
        let low: Vec<usize> = (0..self.n_fluid)
            .filter(|i| volume[*i].is_nan() || volume[*i] <= SMALLEST_VOLUME * self.unit[*i])
            .collect();
        let mut touched = low.clone();
        for i in &low {
            let links = &self.links[self.range(*i)];
            touched.extend(links.iter().map(|l| l.other as usize).filter(|k| *k < self.n_fluid));
        }
        touched.sort_unstable();
        touched.dedup();
        for i in &touched {
            self.softness[*i] *= SOFTEN;
            self.softened[*i] = true;
        }
        if low.is_empty() { 0 } else { self.softened.iter().filter(|s| **s).count() }
    }

    /// Makes the shares of every wall sum to one exactly.
    fn fix_shares(&self, x: &mut Unknowns<D>) {
        for (w, sharers) in self.sharers.iter().enumerate() {
            let excess = self.defect(self.n_fluid + w, x).closure[0] / sharers.len().max(1) as f64;
            for (_, p) in sharers {
                x.area[*p as usize] -= self.wall(&self.links[*p as usize]) * excess;
            }
        }
    }

    fn surface(&self, i: usize, x: &Unknowns<D>) -> f64 {
        self.range(i).map(|p| x.area[p].norm()).sum()
    }

    fn judge(&self, x: &Unknowns<D>) -> ConservativeReport {
        let (mut closure, mut square, mut largest, mut volume) = (0.0f64, 0.0, (0.0f64, 0), f64::INFINITY);
        for i in 0..self.n_fluid {
            let defect = self.defect(i, x);
            closure = closure.max(defect.closure.norm() / self.surface(i, x).max(f64::MIN_POSITIVE));
            let error = defect.moment.iter().map(Vector::norm_squared).sum::<f64>().sqrt() / x.volume[i].abs();
            square += error * error;
            // a number that is none counts as the largest
            largest = if error <= largest.0 || largest.0.is_nan() { largest } else { (error, i) };
            volume = volume.min(x.volume[i] / self.unit[i]);
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

    /// What row `i` makes of its own multipliers.
    fn own(&self, i: usize, y: &Row<D>) -> Row<D> {
        let mut row = self.soft(i, y);
        for link in &self.links[self.range(i)] {
            let reach = link.reach();
            let own = Vector::from_fn(|r| y.closure[r] + reach * y.moment[r].dot(&link.offset));
            let change = match link.kind {
                Kind::Wall(_) => {
                    let a = self.wall(link);
                    a * (link.weight * own.dot(&a))
                }
                _ => own * link.weight,
            };
            row.add(&change, &link.offset, reach);
        }
        row
    }

    /// Entries of row `i` whose area vectors may change.
    fn passing(&self, i: usize) -> impl Iterator<Item = &Link<D>> {
        self.links[self.range(i)].iter().filter(|l| !l.is_wall())
    }

    /// Sign with which component `r` of the row at the other end of an entry is seen.
    #[inline(always)]
    fn sign(&self, link: &Link<D>, r: usize) -> f64 {
        match link.kind {
            Kind::Image(t) => self.signs[t as usize][r],
            _ => 1.0,
        }
    }
}

impl<const D: usize> Grid<Row<D>> for Problem<D> {
    #[inline(always)]
    fn left(&self, i: usize, b: &Row<D>, x: &[Row<D>]) -> Row<D> {
        b.plus(-1.0, &self.row(i, x))
    }

    #[inline(always)]
    fn less(&self, i: usize, mut r: Row<D>, range: &Range<usize>, found: &[Row<D>], way: Way) -> Row<D> {
        for link in &self.links[self.range(i)] {
            let other = link.other as usize;
            if way.has_passed(range, i, other) && link.kind != Kind::Open {
                r.add(&(self.across(link, &found[other - range.start]) * link.weight), &link.offset, link.reach());
            }
        }
        r
    }

    #[inline(always)]
    fn solved(&self, i: usize, r: &Row<D>) -> Row<D> {
        self.factors.solve(i, r)
    }

    /// Multipliers of the walls.
    fn follow(&self, b: &[Row<D>], x: &mut [Row<D>]) {
        let mut walls = vec![0.0; self.sharers.len()];
        sweep(&mut walls, |w| (b[self.n_fluid + w].closure[0] - self.wall_row(w, x)) / self.shared[w]);
        sweep_slots(&mut x[self.n_fluid..], |w, x| x.closure[0] += walls[w]);
    }
}

/// Writes the result back.
fn store<const D: usize>(cloud: &mut Cloud<D>, operators: &mut Operators<D>, problem: &Problem<D>, x: &Unknowns<D>) {
    let mut faces = Vec::new();
    for i in 0..problem.n_fluid {
        for p in problem.range(i) {
            if problem.links[p].is_wall() {
                faces.push(WallFace { i: i as u32, wall: cloud.neighbours.index[p], area: x.area[p] });
            }
        }
    }
    operators.set_wall_faces(faces);
    for e in operators.edges_mut() {
        let i = e.i();
        if i >= problem.n_fluid {
            continue;
        }
        if let Ok(p) = cloud.neighbours.of(i).binary_search(&(e.j() as u32)) {
            let p = problem.first[i] as usize + p;
            e.s = if problem.links[p].is_wall() { Vector::ZERO } else { x.area[p] };
        }
    }
    cloud.volume[..problem.n_fluid].copy_from_slice(&x.volume);
    let first = cloud.n_real();
    for (k, image) in cloud.ghosts.iter().enumerate() {
        cloud.volume[first + k] = cloud.volume[image.source as usize];
    }
}

#[cfg(test)]
mod tests;
