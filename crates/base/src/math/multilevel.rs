//! Multilevel sweeps on a hierarchy of coarser and coarser matrices.
//!
//! Rows are combined into groups of a few strongly coupled neighbours. The row of a group is the volume-weighted mean
//! of the rows of its members (Galerkin with piecewise-constant transfer; Lallemand, Steve and Dervieux 1992). Fluxes
//! between members of a group then cancel, and the first-order upwind operator becomes a first-order upwind operator on
//! a coarser cloud.
//!
//! The same hierarchy solves systems that are periodic in time, harmonic by harmonic ([`super::circulant`]).
use super::block_matrix::{BlockMatrix, Sweeps};
use super::circulant::{HarmonicSweeps, MOST_HARMONICS};
use super::fourier::Instances;
use super::groups::Groups;
use super::parallel::{sweep, sweep_rows};

/// Number of rows at which coarsening stops.
const COARSEST: usize = 60;
/// Number of sweeps on the coarsest level.
const COARSEST_SWEEPS: usize = 8;
/// Relaxation factor of the coarse-level correction. The full correction is best for smooth flow (laminar flow takes 15
/// % more iterations with 0.8) but overshoots at shocks: a transonic aerofoil takes 308 linear iterations with 1, 137
/// with 0.8, 109 with 0.6.
const STEP: f32 = 0.8;

/// Maximum number of unknowns of a row at all instances of a period.
const MOST_VALUES: usize = 6 * (2 * MOST_HARMONICS + 1);

/// Parameters of a multigrid cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// Number of symmetric sweeps before and after the coarse-level correction.
    pub sweeps: usize,
    /// Number of visits to the next coarser level: 1 is a V-cycle, 2 a W-cycle.
    pub visits: usize,
    /// Maximum number of levels; 1 means sweeps without coarser levels.
    pub levels: usize,
}

struct Level {
    matrix: BlockMatrix,
    groups: Groups,
    /// Weight of each row in its group.
    share: Vec<f32>,
    sweeps: Sweeps,
    harmonic_sweeps: Option<HarmonicSweeps>,
}

/// A matrix with its coarser levels.
pub struct Multilevel {
    levels: Vec<Level>,
    cycle: Cycle,
    times: Option<Times>,
}

/// Transforms between the instances of a period and coefficients in the order of [`HarmonicSweeps`].
struct Times {
    /// Weights of the values in each coefficient, coefficient by coefficient.
    forth: Vec<f32>,
    /// Weights of the coefficients in each value, instance by instance.
    back: Vec<f64>,
    count: usize,
}

impl Multilevel {
    /// Builds the hierarchy from the pattern of `matrix`, whose rows have the volumes `volume`, with groups of at most
    /// `size` rows.
    pub fn new(matrix: BlockMatrix, mut volume: Vec<f64>, size: usize, cycle: Cycle) -> Self {
        let mut levels = vec![level(matrix)];
        while levels.len() < cycle.levels {
            let Some(last) = levels.last_mut() else { break };
            if last.matrix.n_rows() <= COARSEST {
                break;
            }
            let fine = &last.matrix;
            let columns = |i: usize, list: &mut Vec<u32>| list.extend(fine.columns(i));
            let groups = Groups::new(fine.n_rows(), size, columns);
            if groups.len() * 10 > fine.n_rows() * 9 {
                break;
            }
            let coarse = fine.coarse(groups.of(), groups.len());
            let mut gathered = vec![0.0; groups.len()];
            volume.iter().zip(groups.of()).for_each(|(v, g)| gathered[*g as usize] += v);
            last.share = volume.iter().zip(groups.of()).map(|(v, g)| (v / gathered[*g as usize]) as f32).collect();
            (last.groups, volume) = (groups, gathered);
            levels.push(level(coarse));
        }
        Self { levels, cycle, times: None }
    }

    /// This hierarchy for (A + ∂/∂t) x = b at the instances of a period of angular frequency `omega`. Vectors hold, for
    /// each row, the unknowns of the first instance, then those of the second, and so on. Without `mean`, the solution
    /// has zero mean.
    pub fn in_time(mut self, instances: Instances, omega: f64, mean: bool) -> Self {
        for level in &mut self.levels {
            level.harmonic_sweeps = Some(HarmonicSweeps::new(&level.matrix, instances.harmonics(), omega, mean));
            level.sweeps = Sweeps::default();
        }
        let count = instances.count();
        let (forth, back) = (instances.to_coefficients(), instances.to_values());
        let forth = (0..count).flat_map(|c| forth.row(sorted(c, count)).iter().map(|e| *e as f32).collect::<Vec<_>>());
        let back = (0..count * count).map(|k| back.row(k / count)[sorted(k % count, count)]);
        self.times = Some(Times { forth: forth.collect(), back: back.collect(), count });
        self
    }

    /// The finest matrix, for assembly.
    pub fn finest(&mut self) -> &mut BlockMatrix {
        &mut self.levels[0].matrix
    }

    /// Recomputes all coarser levels after an assembly of the finest matrix.
    pub fn refresh(&mut self) {
        for k in 0..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(k + 1);
            let fine = &mut fine[k];
            if let Some(coarse) = coarse.first_mut() {
                coarse.matrix.gather(&fine.matrix, |g| fine.groups.members(g), (fine.groups.of(), &fine.share));
            }
            match fine.harmonic_sweeps.as_mut() {
                None => fine.matrix.make_sweepable(),
                Some(harmonic_sweeps) => {
                    fine.matrix.invert_diagonal();
                    harmonic_sweeps.invert(&fine.matrix);
                }
            }
        }
    }

    /// Computes z ≈ A⁻¹ r, where `r(i, row)` sets row i of the right-hand side.
    pub fn apply(&mut self, r: impl Fn(usize, &mut [f32]) + Sync, z: &mut [f64]) {
        if let Some(times) = &self.times {
            return apply_in_time(&mut self.levels, self.cycle, times, r, z);
        }
        let n = self.levels[0].matrix.block();
        let Level { matrix, sweeps, .. } = &mut self.levels[0];
        sweep_rows(&mut sweeps.b, n, |i, b| {
            r(i, b);
            matrix.enter(b);
        });
        sweeps.clear();
        cycle(&mut self.levels, self.cycle);
        let Level { matrix, sweeps, .. } = &self.levels[0];
        sweep(z, |k| f64::from(matrix.leave(&sweeps.x, k)));
    }

    /// Memory in use (bytes).
    pub fn bytes(&self) -> usize {
        let harmonic_sweeps = |l: &Level| l.harmonic_sweeps.as_ref().map_or(0, HarmonicSweeps::bytes);
        self.levels
            .iter()
            .map(|l| l.matrix.bytes() + l.sweeps.bytes() + harmonic_sweeps(l) + l.groups.bytes() + 4 * l.share.len())
            .sum()
    }

    /// Number of rows of each level.
    pub fn sizes(&self) -> Vec<usize> {
        self.levels.iter().map(|l| l.matrix.n_rows()).collect()
    }
}

fn level(matrix: BlockMatrix) -> Level {
    let sweeps = Sweeps::new(&matrix);
    Level { groups: Groups::default(), share: Vec::new(), sweeps, matrix, harmonic_sweeps: None }
}

/// Index of coefficient `c` of the order (mean, cosine, sine, cosine, ...) in the order mean, cosines, sines.
fn sorted(c: usize, count: usize) -> usize {
    match c {
        0 => 0,
        c if c % 2 == 1 => c.div_ceil(2),
        c => count / 2 + c / 2,
    }
}

fn apply_in_time(levels: &mut [Level], how: Cycle, times: &Times, r: impl Fn(usize, &mut [f32]) + Sync, z: &mut [f64]) {
    let (n, count) = (levels[0].matrix.block(), times.count);
    let Level { matrix, harmonic_sweeps, .. } = &mut levels[0];
    let Some(finest) = harmonic_sweeps.as_mut() else { return };
    // positions inside a row: (instance or coefficient, unknown)
    let row = |k: usize| (k / (n * count) * n * count, k / n % count, k % n);
    sweep_rows(&mut finest.b, n * count, |i, b| {
        let mut values = [0.0; MOST_VALUES];
        r(i, &mut values[..n * count]);
        matrix.enter(&mut values[..n * count]);
        b.fill(0.0);
        for instance in 0..count {
            for v in 0..n {
                let value = values[instance * n + v];
                (0..count).for_each(|c| b[c * n + v] += times.forth[c * count + instance] * value);
            }
        }
    });
    finest.clear();
    cycle(levels, how);
    let Level { matrix, harmonic_sweeps, .. } = &levels[0];
    let Some(finest) = harmonic_sweeps.as_ref() else { return };
    sweep(z, |k| {
        let (at, instance, v) = row(k);
        let weights = &times.back[instance * count..(instance + 1) * count];
        weights.iter().enumerate().map(|(c, w)| w * f64::from(matrix.leave(&finest.x, at + c * n + v))).sum()
    });
}

impl Level {
    fn smooth(&mut self) {
        match self.harmonic_sweeps.as_mut() {
            Some(harmonic_sweeps) => harmonic_sweeps.symmetric_sweep(&self.matrix),
            None => self.matrix.symmetric_sweep(&mut self.sweeps),
        }
    }

    fn residual(&mut self) {
        match self.harmonic_sweeps.as_mut() {
            Some(harmonic_sweeps) => harmonic_sweeps.residual(&self.matrix),
            None => self.matrix.residual(&mut self.sweeps),
        }
    }

    fn restart(&mut self) {
        match self.harmonic_sweeps.as_mut() {
            Some(harmonic_sweeps) => harmonic_sweeps.restart(&self.matrix),
            None => self.matrix.restart(&mut self.sweeps),
        }
    }

    /// Number of unknowns of a row.
    fn width(&self) -> usize {
        self.matrix.block() * self.harmonic_sweeps.as_ref().map_or(1, HarmonicSweeps::count)
    }

    /// Residual of the right-hand side.
    fn left(&self) -> &[f32] {
        self.harmonic_sweeps.as_ref().map_or(&self.sweeps.side, |w| &w.r)
    }

    fn right_hand_side(&mut self) -> &mut [f32] {
        self.harmonic_sweeps.as_mut().map_or(&mut self.sweeps.b, |w| &mut w.b)
    }

    fn solution(&self) -> &[f32] {
        self.harmonic_sweeps.as_ref().map_or(&self.sweeps.x, |w| &w.x)
    }

    fn solution_mut(&mut self) -> &mut [f32] {
        self.harmonic_sweeps.as_mut().map_or(&mut self.sweeps.x, |w| &mut w.x)
    }

    fn clear(&mut self) {
        match self.harmonic_sweeps.as_mut() {
            Some(harmonic_sweeps) => harmonic_sweeps.clear(),
            None => self.sweeps.clear(),
        }
    }
}

fn cycle(levels: &mut [Level], how: Cycle) {
    let Some((fine, coarse)) = levels.split_first_mut() else { return };
    let bottom = coarse.is_empty();
    let sweeps = if bottom && how.levels > 1 { COARSEST_SWEEPS } else { how.sweeps };
    (0..sweeps).for_each(|_| fine.smooth());
    if bottom {
        return;
    }
    fine.residual();
    let n = fine.width();
    let left = fine.left();
    sweep_rows(coarse[0].right_hand_side(), n, |g, b| {
        b.fill(0.0);
        for i in fine.groups.members(g).iter().map(|i| *i as usize) {
            let share = fine.share[i];
            b.iter_mut().zip(&left[i * n..(i + 1) * n]).for_each(|(b, r)| *b += share * r);
        }
    });
    coarse[0].clear();
    for _ in 0..how.visits {
        cycle(coarse, how);
    }
    let found = coarse[0].solution();
    let groups = std::mem::take(&mut fine.groups);
    sweep_rows(fine.solution_mut(), n, |i, x| {
        let at = groups.of()[i] as usize * n;
        x.iter_mut().zip(&found[at..at + n]).for_each(|(x, c)| *x += STEP * c);
    });
    fine.groups = groups;
    fine.restart();
    (0..sweeps).for_each(|_| fine.smooth());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_rows_conserve_what_fine_rows_conserve() {
        // fluxes between the rows of a ring, each divided by its own volume
        let n = 240;
        let volume: Vec<f64> = (0..n).map(|i| [1.0, 0.3, 4.0, 0.02][i * i % 7 % 4]).collect();
        let first: Vec<u32> = (0..=n as u32).map(|i| 2 * i).collect();
        let index: Vec<u32> = (0..n).flat_map(|i| [(i + n - 1) % n, (i + 1) % n]).map(|j| j as u32).collect();
        let matrix = BlockMatrix::new(2, std::slice::from_ref(&(0..n)), &first.into(), &index.into());
        let mut all = Multilevel::new(matrix, volume.clone(), 4, Cycle { sweeps: 1, visits: 1, levels: 3 });
        let handed = |i: usize| 1.0 + 0.5 * (i as f64).sin();
        all.finest().assemble(|_, rows| {
            for i in 0..n {
                let before = (i + n - 1) % n;
                rows.add(i, i, |r, c| if r == c { handed(i) / volume[i] } else { 0.0 });
                rows.add(i, before, |r, c| if r == c { -handed(before) / volume[i] } else { 0.0 });
            }
        });
        let (fine, coarse) = all.levels.split_at_mut(1);
        let (fine, coarse) = (&fine[0], &mut coarse[0].matrix);
        coarse.gather(&fine.matrix, |g| fine.groups.members(g), (fine.groups.of(), &fine.share));
        let x: Vec<f32> = (0..2 * coarse.n_rows()).map(|k| (k as f32).cos()).collect();
        let mut gathered = vec![0.0; coarse.n_rows()];
        volume.iter().zip(fine.groups.of()).for_each(|(v, g)| gathered[*g as usize] += v);
        let passed: Vec<f64> = coarse.product(&x).chunks(2).zip(gathered).map(|(r, v)| f64::from(r[0]) * v).collect();
        let size: f64 = passed.iter().map(|p| p.abs()).sum();
        // blocks are rounded to 1/254; an unweighted sum of rows would be wrong by 6 %
        let sum: f64 = passed.iter().sum();
        assert!(sum.abs() < 0.03 * size, "{sum} {size}");
    }
}
