//! Sweeps on a hierarchy of ever coarser matrices.
//!
//! Rows are gathered into groups of a few strongly coupled neighbours; the matrix of the groups is the sum of the blocks of
//! their members (Galerkin with piecewise-constant transfer; Lallemand, Steve and Dervieux 1992). For the first-order upwind
//! operator this is again a first-order upwind operator on a coarser cloud.
use super::block_matrix::{BlockMatrix, Sweeps};
use super::sweep::sweep;

/// Rows at which coarsening stops.
const COARSEST: usize = 60;
/// Sweeps on the coarsest level.
const COARSEST_SWEEPS: usize = 8;

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
    group: Vec<u32>,
    target: Vec<u32>,
    sweeps: Sweeps,
}

/// A matrix and its coarser versions.
pub struct Multilevel {
    levels: Vec<Level>,
    cycle: Cycle,
}

impl Multilevel {
    /// Builds the hierarchy from the pattern of `matrix` alone: `size` rows a group.
    pub fn new(matrix: BlockMatrix, size: usize, cycle: Cycle) -> Self {
        let mut levels = vec![level(matrix)];
        while levels.len() < cycle.levels {
            let Some(last) = levels.last_mut() else { break };
            if last.matrix.n_rows() <= COARSEST {
                break;
            }
            let (group, n) = groups(&last.matrix, size);
            if n * 10 > last.matrix.n_rows() * 9 {
                break;
            }
            let (coarse, target) = last.matrix.coarse(&group, n);
            (last.group, last.target) = (group, target);
            levels.push(level(coarse));
        }
        Self { levels, cycle }
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
            fine.matrix.invert_diagonal();
            if let Some(coarse) = coarse.first_mut() {
                coarse.matrix.gather(&fine.matrix, &fine.group, &fine.target);
            }
        }
    }

    /// z ≈ A⁻¹ r, where `r(k)` is component k of the right-hand side.
    pub fn apply(&mut self, r: impl Fn(usize) -> f32 + Sync, z: &mut [f64]) {
        let finest = &mut self.levels[0].sweeps;
        sweep(&mut finest.b, r);
        finest.clear();
        cycle(&mut self.levels, self.cycle);
        let x = &self.levels[0].sweeps.x;
        sweep(z, |k| f64::from(x[k]));
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|l| l.matrix.bytes() + l.sweeps.bytes() + 4 * (l.group.len() + l.target.len())).sum()
    }

    /// Rows of each level.
    pub fn sizes(&self) -> Vec<usize> {
        self.levels.iter().map(|l| l.matrix.n_rows()).collect()
    }
}

fn level(matrix: BlockMatrix) -> Level {
    Level { group: Vec::new(), target: Vec::new(), sweeps: Sweeps::new(&matrix), matrix }
}

fn cycle(levels: &mut [Level], how: Cycle) {
    let Some((fine, coarse)) = levels.split_first_mut() else { return };
    let bottom = coarse.is_empty();
    let sweeps = if bottom && how.levels > 1 { COARSEST_SWEEPS } else { how.sweeps };
    for _ in 0..sweeps {
        fine.matrix.symmetric_sweep(&mut fine.sweeps);
    }
    if bottom {
        return;
    }
    fine.matrix.residual(&mut fine.sweeps);
    let n = fine.matrix.block();
    let next = &mut coarse[0].sweeps;
    next.b.fill(0.0);
    for (r, g) in fine.sweeps.r.chunks_exact(n).zip(&fine.group) {
        let at = *g as usize * n;
        next.b[at..at + n].iter_mut().zip(r).for_each(|(b, r)| *b += r);
    }
    next.clear();
    for _ in 0..how.visits {
        cycle(coarse, how);
    }
    let next = &coarse[0].sweeps;
    for (x, g) in fine.sweeps.x.chunks_exact_mut(n).zip(&fine.group) {
        let at = *g as usize * n;
        x.iter_mut().zip(&next.x[at..at + n]).for_each(|(x, c)| *x += c);
    }
    fine.matrix.restart(&mut fine.sweeps);
    for _ in 0..sweeps {
        fine.matrix.symmetric_sweep(&mut fine.sweeps);
    }
}

/// Groups of up to `size` rows that see one another, nearest in storage order first.
fn groups(matrix: &BlockMatrix, size: usize) -> (Vec<u32>, usize) {
    const FREE: u32 = u32::MAX;
    let n = matrix.n_rows();
    let mut group = vec![FREE; n];
    let mut count = 0;
    let mut near: Vec<u32> = Vec::new();
    for i in 0..n {
        if group[i] != FREE {
            continue;
        }
        near.clear();
        near.extend(matrix.columns(i).iter().filter(|j| group[**j as usize] == FREE));
        near.sort_unstable_by_key(|j| (j.abs_diff(i as u32), *j));
        if near.is_empty() && size > 1 {
            // a lone row joins the group of its nearest neighbour
            if let Some(j) = matrix.columns(i).iter().min_by_key(|j| (j.abs_diff(i as u32), **j)) {
                group[i] = group[*j as usize];
                continue;
            }
        }
        group[i] = count;
        near.iter().take(size - 1).for_each(|j| group[*j as usize] = count);
        count += 1;
    }
    (group, count as usize)
}
