//! Sweeps on a hierarchy of ever coarser matrices.
//!
//! Rows are gathered into groups of a few strongly coupled neighbours; the matrix of the groups is the sum of the blocks of
//! their members (Galerkin with piecewise-constant transfer; Lallemand, Steve and Dervieux 1992). For the first-order upwind
//! operator this is again a first-order upwind operator on a coarser cloud.
//!
//! The same hierarchy serves systems that repeat in time, harmonic by harmonic ([`super::circulant`]).
use super::block_matrix::{BlockMatrix, Sweeps};
use super::circulant::{HarmonicSweeps, MOST_HARMONICS};
use super::fourier::Instances;
use super::groups::{Gathering, Groups};
use super::sweep::{sweep, sweep_rows};

/// Rows at which coarsening stops.
const COARSEST: usize = 60;
/// Sweeps on the coarsest level.
const COARSEST_SWEEPS: usize = 8;

/// Unknowns of a row at all instances of a period, at most.
const MOST_VALUES: usize = 6 * (2 * MOST_HARMONICS + 1);

/// How a cycle visits the levels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cycle {
    /// Symmetric sweeps before and after the coarse correction.
    pub sweeps: usize,
    /// Visits to the next coarser level: 1 is a V-cycle, 2 a W-cycle.
    pub visits: usize,
    /// Greatest number of levels; 1 means plain sweeps.
    pub levels: usize,
}

struct Level {
    matrix: BlockMatrix,
    groups: Groups,
    sweeps: Sweeps,
    harmonic_sweeps: Option<HarmonicSweeps>,
}

/// A matrix and its coarser versions.
pub struct Multilevel {
    levels: Vec<Level>,
    cycle: Cycle,
    /// Part of what a coarser level finds that the finer one takes.
    step: f32,
    times: Option<Times>,
}

/// Transforms between instances of a period and coefficients in the order of [`HarmonicSweeps`].
struct Times {
    /// Coefficient by coefficient, from values.
    forth: Vec<f32>,
    /// Instance by instance, from coefficients.
    back: Vec<f64>,
    count: usize,
}

impl Multilevel {
    /// Builds the hierarchy from the pattern of `matrix` alone.
    pub fn new(matrix: BlockMatrix, gathering: Gathering, cycle: Cycle) -> Self {
        let mut levels = vec![level(matrix)];
        while levels.len() < cycle.levels {
            let Some(last) = levels.last_mut() else { break };
            if last.matrix.n_rows() <= COARSEST {
                break;
            }
            let fine = &last.matrix;
            let columns = |i: usize, list: &mut Vec<u32>| list.extend(fine.columns(i));
            let groups = Groups::new(fine.n_rows(), gathering, columns);
            if groups.len() * 10 > fine.n_rows() * 9 {
                break;
            }
            let coarse = fine.coarse(groups.of(), groups.len());
            last.groups = groups;
            levels.push(level(coarse));
        }
        Self { levels, cycle, step: 1.0, times: None }
    }

    /// The same where a finer level takes this part of what a coarser one finds.
    pub fn stepping(self, step: f32) -> Self {
        Self { step, ..self }
    }

    /// The same for (A + ∂/∂t) x = b at the instances of a period of frequency `omega`: vectors hold, for each row, the
    /// unknowns of the first instance, then those of the second, and so on.
    pub fn in_time(mut self, instances: Instances, omega: f64) -> Self {
        let mut mass = vec![1.0; self.levels[0].matrix.n_rows()];
        for k in 0..self.levels.len() {
            let next = self.levels.get(k + 1).map_or(0, |l| l.matrix.n_rows());
            let level = &mut self.levels[k];
            let harmonic_sweeps = HarmonicSweeps::new(&level.matrix, instances.harmonics(), omega, mass);
            mass = harmonic_sweeps.gathered(level.groups.of(), next);
            level.harmonic_sweeps = Some(harmonic_sweeps);
            level.sweeps = Sweeps::default();
        }
        let count = instances.count();
        let (forth, back) = (instances.to_coefficients(), instances.to_values());
        let forth = (0..count).flat_map(|c| forth.row(sorted(c, count)).iter().map(|e| *e as f32).collect::<Vec<_>>());
        let back = (0..count * count).map(|k| back.row(k / count)[sorted(k % count, count)]);
        self.times = Some(Times { forth: forth.collect(), back: back.collect(), count });
        self
    }

    /// The finest matrix, to be filled.
    pub fn finest(&mut self) -> &mut BlockMatrix {
        &mut self.levels[0].matrix
    }

    /// Carries a newly filled finest matrix to all levels.
    pub fn refresh(&mut self) {
        for k in 0..self.levels.len() {
            let (fine, coarse) = self.levels.split_at_mut(k + 1);
            let fine = &mut fine[k];
            if let Some(coarse) = coarse.first_mut() {
                coarse.matrix.gather(&fine.matrix, |g| fine.groups.members(g), fine.groups.of());
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

    /// z ≈ A⁻¹ r, where `r(i, row)` sets row i of the right-hand side.
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
        cycle(&mut self.levels, self.cycle, self.step);
        let Level { matrix, sweeps, .. } = &self.levels[0];
        sweep(z, |k| f64::from(matrix.leave(&sweeps.x, k)));
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let harmonic_sweeps = |l: &Level| l.harmonic_sweeps.as_ref().map_or(0, HarmonicSweeps::bytes);
        self.levels.iter().map(|l| l.matrix.bytes() + l.sweeps.bytes() + harmonic_sweeps(l) + l.groups.bytes()).sum()
    }

    /// Rows of each level.
    pub fn sizes(&self) -> Vec<usize> {
        self.levels.iter().map(|l| l.matrix.n_rows()).collect()
    }
}

fn level(matrix: BlockMatrix) -> Level {
    let sweeps = Sweeps::new(&matrix);
    Level { groups: Groups::default(), sweeps, matrix, harmonic_sweeps: None }
}

/// The place of coefficient `c` (mean, cosine, sine, cosine, ...) among mean, cosines, sines.
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
    // places inside a row: (instance or coefficient, unknown)
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
    cycle(levels, how, 1.0);
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

    /// Unknowns of a row.
    fn width(&self) -> usize {
        self.matrix.block() * self.harmonic_sweeps.as_ref().map_or(1, HarmonicSweeps::count)
    }

    /// What is left of the right-hand side.
    fn left(&self) -> &[f32] {
        self.harmonic_sweeps.as_ref().map_or(&self.sweeps.r, |w| &w.r)
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

fn cycle(levels: &mut [Level], how: Cycle, step: f32) {
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
            b.iter_mut().zip(&left[i * n..(i + 1) * n]).for_each(|(b, r)| *b += r);
        }
    });
    coarse[0].clear();
    for _ in 0..how.visits {
        cycle(coarse, how, step);
    }
    let found = coarse[0].solution();
    let groups = std::mem::take(&mut fine.groups);
    sweep_rows(fine.solution_mut(), n, |i, x| {
        let at = groups.of()[i] as usize * n;
        x.iter_mut().zip(&found[at..at + n]).for_each(|(x, c)| *x += step * c);
    });
    fine.groups = groups;
    fine.restart();
    (0..sweeps).for_each(|_| fine.smooth());
}
