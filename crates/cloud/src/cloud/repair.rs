//! Repair of neighbour lists that would spoil a computation, before it starts.
//!
//! The least-squares gradient of a particle needs neighbours on all sides at a suitable distance. A row of the
//! neighbour lists is
//! *insufficient* when it has fewer than D + 2 entries, when the condition number of its normal matrix M = Σ d dᵀ/|d|²
//! exceeds 10³,
//! or, for a fluid particle, when all neighbours lie on one side: |Σ d/|d|²| / Σ 1/|d| above 0.9. A fluid particle
//! nearer than 0.3 spacings to another is *crowded*: the weights 1/|d| of this neighbour would outweigh all others. The
//! remedies are tried in this order:
//!
//! 1. *wider*: all visible particles within 2.4 spacings are added to the row, and the particle is added to their rows;
//! 2. *moved*: a crowded fluid particle is moved straight away from its nearest neighbour;
//! 3. *first order*: the fluxes use a bounded gradient (see `Operators`), the reconstruction uses none;
//! 4. the cloud is rejected if a fluid particle is left with fewer than D neighbours.
//!
//! An interface particle that is a neighbour of no fluid particle would exert no pressure on the gas, although the
//! loads count its force. It is added to the row of the nearest of the fluid particles from which its own state is
//! fitted.
//!
//! Rows that need no repair are not changed, so that sound clouds keep every bit.
use super::neighbours::{Rows, Search, Seen};
use super::particles::Particles;
use crate::math::Vector;
use crate::math::least_squares::condition_symmetric;
use crate::math::parallel::sweep;

/// Condition number of the normal matrix above which a row is insufficient.
pub const WORST_CONDITION: f64 = 1e3;
/// One-sidedness above which the row of a fluid particle is insufficient; a corner of a body gives 0.6, a cone of 25°
/// gives 0.9.
pub const WORST_ONE_SIDED: f64 = 0.9;
/// Distance to the nearest neighbour, in spacings, below which a fluid particle is crowded (computations diverged at
/// 0.03).
pub const NEAREST: f64 = 0.3;
/// Radius, in spacings, of an enlarged row.
const WIDE: f64 = 2.4;
/// Distance, in spacings, to which a crowded particle is moved away from its nearest neighbour.
const NUDGE: f64 = 0.36;

/// The repairs of a cloud.
#[derive(Clone, Debug, Default)]
pub struct Repair<const D: usize> {
    /// Entries that are added to rows, as pairs (row, neighbour) in sorted order.
    pub extra: Vec<(u32, Seen)>,
    /// Particles that were moved, with their new positions.
    pub moved: Vec<(u32, Vector<D>)>,
    /// Particles whose reconstruction is first order, in ascending order.
    pub first_order: Vec<u32>,
    /// One message for each particle that cannot be repaired.
    pub refused: Vec<String>,
    /// Number of rows that were enlarged successfully.
    pub widened: usize,
    /// Number of interface particles that were neighbours of no fluid particle.
    pub joined: usize,
}

impl<const D: usize> Repair<D> {
    /// Examines every row and repairs the insufficient ones. `walls` holds the fluid particles from which interface
    /// particles are fitted.
    pub(super) fn of(search: &Search<'_, D>, rows: &Rows, walls: &Rows) -> Self {
        let particles = search.particles();
        let mut sick = vec![false; particles.n_rows()];
        sweep(&mut sick, |i| is_sick(search, i, &particles.x[i], rows.of(i)));
        let mut repair = Self::default();
        for i in (0..sick.len()).filter(|i| sick[*i]) {
            repair.treat(search, rows, i);
        }
        repair.join_walls(search, rows, walls);
        repair.extra.sort_unstable();
        repair.extra.dedup();
        repair.extra.retain(|(row, seen)| !rows.of(*row as usize).contains(seen));
        repair
    }

    /// Adds each interface particle that is a neighbour of no fluid particle to the row of the nearest one in front of
    /// it.
    fn join_walls(&mut self, search: &Search<'_, D>, rows: &Rows, walls: &Rows) {
        let particles = search.particles();
        let fluid = |s: &&Seen| (s.0 as usize) < particles.n_fluid;
        for (w, i) in (particles.n_fluid..particles.n_rows()).enumerate() {
            let widened = self.extra.iter().any(|e| e.0 as usize == i && fluid(&&e.1));
            if widened || rows.of(i).iter().any(|s| fluid(&s)) || search.in_layers(i) {
                continue;
            }
            let distance = |s: &Seen| (search.position(s.0 as usize, s.1) - particles.x[i]).norm_squared();
            let nearest = walls.of(w).iter().min_by(|a, b| distance(a).total_cmp(&distance(b)).then(a.cmp(b)));
            if let Some(s) = nearest {
                self.extra.push((i as u32, *s));
                self.extra.extend(search.seen_from(i, *s));
                self.joined += 1;
            }
        }
    }

    fn treat(&mut self, search: &Search<'_, D>, rows: &Rows, i: usize) {
        let particles = search.particles();
        let mut row = rows.of(i).to_vec();
        if !is_well_spread(&offsets(search, i, &particles.x[i], &row), particles.is_interface(i)) {
            let wide = search.visible_within(i, WIDE);
            if wide.len() > row.len() {
                self.extra.extend(wide.iter().map(|s| (i as u32, *s)));
                self.extra.extend(wide.iter().filter_map(|s| search.seen_from(i, *s)));
                row = wide;
            }
        }
        let mut x = particles.x[i];
        if is_crowded(search, i, &x, &row)
            && let Some(place) = nudged(search, i, &row)
        {
            self.moved.push((i as u32, place));
            x = place;
        }
        if row.len() < D && !particles.is_interface(i) {
            self.refused.push(complaint(particles, i, row.len()));
        } else if is_well_spread(&offsets(search, i, &x, &row), particles.is_interface(i)) {
            self.widened += usize::from(row.len() > rows.of(i).len());
        } else {
            self.first_order.push(i as u32);
        }
    }

    /// The repairs as messages, one for each kind.
    pub fn notes(&self) -> Vec<String> {
        let line = |n: usize, what: &str| {
            (n > 0).then(|| format!("{n} {} {what}", if n == 1 { "particle" } else { "particles" }))
        };
        [
            line(self.widened, "had too few neighbours; all visible particles within 2.4 spacings were added"),
            line(self.moved.len(), "moved away from a neighbour that was nearer than 0.3 spacings"),
            line(self.joined, "on the surface had no fluid neighbour; the nearest fluid particle was added"),
            line(self.first_order.len(), "limited to first-order reconstruction: too few neighbours"),
        ]
        .into_iter()
        .flatten()
        .collect()
    }
}

fn complaint<const D: usize>(particles: &Particles<D>, i: usize, n: usize) -> String {
    let place: Vec<String> = particles.x[i].0.iter().map(|c| format!("{c:.5}")).collect();
    format!("particle {i} at ({}) has {n} neighbours; a gradient needs at least {D}", place.join(", "))
}

fn offsets<const D: usize>(search: &Search<'_, D>, i: usize, x: &Vector<D>, row: &[Seen]) -> Vec<Vector<D>> {
    row.iter().map(|s| search.offset(i, x, *s)).collect()
}

fn is_sick<const D: usize>(search: &Search<'_, D>, i: usize, x: &Vector<D>, row: &[Seen]) -> bool {
    let particles = search.particles();
    let nearest = (!particles.is_interface(i)).then_some(NEAREST * particles.spacing[i]);
    let mut sums = Sums::default();
    let mut crowded = false;
    for s in row {
        let d = search.offset(i, x, *s);
        crowded |= nearest.is_some_and(|r| d.norm_squared() < r * r);
        sums.add(&d);
    }
    crowded && is_crowded(search, i, x, row) || !sums.is_well_spread(particles.is_interface(i))
}

/// True when a fluid particle has a neighbour nearer than allowed; particles in layers keep their distances by
/// construction.
fn is_crowded<const D: usize>(search: &Search<'_, D>, i: usize, x: &Vector<D>, row: &[Seen]) -> bool {
    let particles = search.particles();
    let near =
        |s: &Seen| (search.position(s.0 as usize, s.1) - *x).norm() < NEAREST * search.mean_spacing(i, s.0 as usize);
    !particles.is_interface(i) && !search.in_layers(i) && row.iter().any(near)
}

/// Position farther away from the nearest neighbour; `None` when it is not visible from the particle or is crowded as
/// well.
fn nudged<const D: usize>(search: &Search<'_, D>, i: usize, row: &[Seen]) -> Option<Vector<D>> {
    let x = search.particles().x[i];
    let distance = |s: &Seen| (search.position(s.0 as usize, s.1) - x).norm_squared();
    let worst = row.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))?;
    let away = x - search.position(worst.0 as usize, worst.1);
    let place = x + away.unit() * (NUDGE * search.mean_spacing(i, worst.0 as usize) - away.norm());
    let free = !is_crowded(search, i, &place, row) && !search.blocked(&x, &place);
    (free && away.norm() > 0.0).then_some(place)
}

/// Sums over the offsets of a row from which its quality follows.
#[derive(Clone, Copy, Debug)]
pub struct Sums<const D: usize> {
    /// Σ d dᵀ/|d|²; its trace is the number of neighbours.
    pub matrix: [[f64; D]; D],
    side: Vector<D>,
    reach: f64,
    n: usize,
}

impl<const D: usize> Default for Sums<D> {
    fn default() -> Self {
        Self { matrix: [[0.0; D]; D], side: Vector::ZERO, reach: 0.0, n: 0 }
    }
}

impl<const D: usize> Sums<D> {
    /// Adds a neighbour at offset `d`.
    #[inline]
    pub fn add(&mut self, d: &Vector<D>) {
        let w = 1.0 / d.norm_squared();
        let v = *d * w;
        for r in 0..D {
            for c in 0..D {
                self.matrix[r][c] += v[r] * d[c];
            }
        }
        self.side += v;
        self.reach += w.sqrt();
        self.n += 1;
    }

    /// One-sidedness |Σ w d| / Σ w|d| with w = 1/|d|²: 0 for symmetric surroundings, 1 when all neighbours lie in one
    /// direction.
    pub fn one_sided(&self) -> f64 {
        if self.n > 0 { self.side.norm() / self.reach } else { 1.0 }
    }

    /// Condition number of the normal matrix.
    pub fn condition(&self) -> f64 {
        condition_symmetric(&self.matrix)
    }

    /// Upper bound of the condition number without eigenvalues: since the trace is n, the product of the other
    /// eigenvalues is at most (n/(D−1))^(D−1), so that λ_min ≥ det·((D−1)/n)^(D−1).
    fn condition_bound(&self) -> f64 {
        let m = &self.matrix;
        let n = self.n as f64;
        let minor = |r: usize, s: usize| m[r][r] * m[s][s] - m[r][s] * m[s][r];
        if D == 2 {
            return n * n / minor(0, 1);
        }
        let det = m[0][0] * minor(1, 2) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
            + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
        n * n * n / (4.0 * det)
    }

    fn is_well_spread(&self, interface: bool) -> bool {
        let bound = self.condition_bound();
        self.n >= D + 2 - usize::from(interface)
            && (interface || self.one_sided() < WORST_ONE_SIDED)
            && (0.0 < bound && bound < WORST_CONDITION || self.condition() < WORST_CONDITION)
    }
}

fn is_well_spread<const D: usize>(offsets: &[Vector<D>], interface: bool) -> bool {
    let mut sums = Sums::default();
    offsets.iter().for_each(|d| sums.add(d));
    sums.is_well_spread(interface)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sums<const D: usize>(offsets: &[[f64; D]]) -> Sums<D> {
        let mut sums = Sums::default();
        offsets.iter().for_each(|d| sums.add(&Vector(*d)));
        sums
    }

    #[test]
    fn a_lattice_is_healthy_and_a_line_is_not() {
        let lattice = sums(&[[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]);
        assert!(lattice.is_well_spread(false) && lattice.one_sided() < 1e-15 && lattice.condition() == 1.0);
        let line = sums(&[[1.0, 0.0], [-1.0, 0.0], [2.0, 0.01], [-2.0, 0.0], [3.0, 0.0]]);
        assert!(!line.is_well_spread(false) && line.condition() > WORST_CONDITION);
        let cone = sums(&[[1.0, 0.1, 0.0], [1.0, -0.1, 0.0], [1.0, 0.0, 0.1], [1.0, 0.0, -0.1], [2.0, 0.0, 0.0]]);
        assert!(!cone.is_well_spread(false) && cone.one_sided() > 0.99);
    }

    #[test]
    fn the_bound_lies_above_the_condition_number() {
        let mut state = 7u64;
        let mut next = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        for _ in 0..200 {
            let a = sums::<2>(&std::array::from_fn::<_, 4, _>(|_| [next(), next()]));
            let b = sums::<3>(&std::array::from_fn::<_, 5, _>(|_| [next(), next(), next()]));
            assert!(a.condition() <= a.condition_bound() * (1.0 + 1e-9));
            assert!(b.condition() <= b.condition_bound() * (1.0 + 1e-9));
        }
    }
}
