//! Sweeps on a hierarchy of ever coarser matrices.
//!
//! Rows are gathered into groups of a few strongly coupled neighbours; the matrix of the groups is the sum of the blocks of
//! their members (Galerkin with piecewise-constant transfer; Lallemand, Steve and Dervieux 1992). For the first-order upwind
//! operator this is again a first-order upwind operator on a coarser cloud.
use super::block_matrix::BlockMatrix;

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
    b: Vec<f32>,
    x: Vec<f32>,
    r: Vec<f32>,
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
                coarse.matrix.gather(&fine.matrix, &fine.target);
            }
        }
    }

    /// z ≈ A⁻¹ r.
    pub fn apply(&mut self, r: &[f64], z: &mut [f64]) {
        self.levels[0].b.iter_mut().zip(r).for_each(|(b, r)| *b = *r as f32);
        self.levels[0].x.fill(0.0);
        cycle(&mut self.levels, self.cycle);
        z.iter_mut().zip(&self.levels[0].x).for_each(|(z, x)| *z = f64::from(*x));
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        self.levels.iter().map(|l| l.matrix.bytes() + 4 * (l.group.len() + l.target.len() + 3 * l.b.len())).sum()
    }

    /// Rows of each level.
    pub fn sizes(&self) -> Vec<usize> {
        self.levels.iter().map(|l| l.matrix.n_rows()).collect()
    }
}

fn level(matrix: BlockMatrix) -> Level {
    let n = matrix.n_rows() * matrix.block();
    Level { group: Vec::new(), target: Vec::new(), b: vec![0.0; n], x: vec![0.0; n], r: vec![0.0; n], matrix }
}

fn cycle(levels: &mut [Level], how: Cycle) {
    let Some((fine, coarse)) = levels.split_first_mut() else { return };
    let bottom = coarse.is_empty();
    let sweeps = if bottom && how.levels > 1 { COARSEST_SWEEPS } else { how.sweeps };
    for _ in 0..sweeps {
        fine.matrix.symmetric_sweep(&fine.b, &mut fine.x, &mut fine.r);
    }
    if bottom {
        return;
    }
    fine.matrix.residual(&fine.b, &fine.x, &mut fine.r);
    let n = fine.matrix.block();
    let next = &mut coarse[0];
    next.b.fill(0.0);
    for (i, g) in fine.group.iter().enumerate() {
        (0..n).for_each(|c| next.b[*g as usize * n + c] += fine.r[i * n + c]);
    }
    next.x.fill(0.0);
    for _ in 0..how.visits {
        cycle(coarse, how);
    }
    let next = &coarse[0];
    for (i, g) in fine.group.iter().enumerate() {
        (0..n).for_each(|c| fine.x[i * n + c] += next.x[*g as usize * n + c]);
    }
    for _ in 0..sweeps {
        fine.matrix.symmetric_sweep(&fine.b, &mut fine.x, &mut fine.r);
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
        near.extend(matrix.columns(i)[1..].iter().filter(|j| group[**j as usize] == FREE));
        near.sort_unstable_by_key(|j| (j.abs_diff(i as u32), *j));
        if near.is_empty() && size > 1 {
            // a lone row joins the group of its nearest neighbour
            if let Some(j) = matrix.columns(i)[1..].iter().min_by_key(|j| (j.abs_diff(i as u32), **j)) {
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
