//! The graph of the particles that exchange area: Σ_j w_ij (y_i − y_j), a Laplacian, and sweeps on coarser and coarser versions of
//! it ([`crate::math::multilevel`]) that nearly invert it whatever the number of particles.
use super::Problem;
use super::symmetry::Mirror;
use crate::cloud::coefficient_unknowns::{Kind, Link};
use crate::math::Vector;
use crate::math::block_matrix::BlockMatrix;
use crate::math::multilevel::{Cycle, Multilevel};
use crate::math::sweep::{CHUNK, maximum, parts, sweep};

/// How a cycle visits the coarser graphs, and rows a group of them.
const CYCLE: Cycle = Cycle { sweeps: 1, visits: 2, levels: 12 };
const GROUP: usize = 4;

/// The graph with its coarser versions.
pub(super) struct Graph {
    levels: Multilevel,
    /// Greatest weight, which counts as one in single precision.
    unit: f64,
    values: Vec<f64>,
    mirrors: Vec<Mirror>,
}

impl Graph {
    /// z ≈ L⁻¹ r.
    pub(super) fn nearly_solve<const D: usize>(&mut self, r: &[Vector<D>], z: &mut [Vector<D>]) {
        let size = maximum(r.len(), |i| r[i].max_abs()).max(f64::MIN_POSITIVE);
        self.levels.apply(|i, b| (0..D).for_each(|d| b[d] = (r[i][d] / size) as f32), &mut self.values);
        let (values, scale) = (&self.values, size / self.unit);
        sweep(z, |i| Vector::from_fn(|d| values[i * D + d] * scale));
        let mut other = Vec::new();
        self.mirrors.iter().filter(|m| m.keeps(r)).for_each(|mirror| mirror.average(z, &mut other));
    }
}

impl<const D: usize> Problem<D> {
    /// The graph of the fluid particles.
    pub(super) fn graph(&self, mirrors: Vec<Mirror>) -> Graph {
        let (mut first, mut index) = (vec![0], Vec::new());
        for i in 0..self.n_fluid {
            let mut others: Vec<u32> =
                self.passing(i).filter(|l| !matches!(l.kind, Kind::Open)).map(|l| l.other).collect();
            others.sort_unstable();
            others.dedup();
            index.extend(others);
            first.push(index.len() as u32);
        }
        let parts = parts(self.n_fluid, CHUNK);
        let mut levels = Multilevel::new(BlockMatrix::new(D, &parts, &first, &index), GROUP, CYCLE);
        let unit = self.links.iter().filter(|l| !l.is_wall()).fold(f64::MIN_POSITIVE, |m, l| m.max(l.weight));
        levels.finest().assemble(|k, rows| {
            for i in parts[k].clone() {
                for link in self.passing(i) {
                    let weight = link.weight / unit;
                    let diagonal = |r: usize, c: usize, w: f64| if r == c { w } else { 0.0 };
                    rows.add(i, i, |r, c| diagonal(r, c, weight));
                    if !matches!(link.kind, Kind::Open) {
                        rows.add(i, link.other as usize, |r, c| diagonal(r, c, -weight * self.sign(link, r)));
                    }
                }
            }
        });
        levels.refresh();
        let values = vec![0.0; self.n_fluid * D];
        Graph { levels, unit, values, mirrors }
    }

    /// Entries of row `i` whose area vectors may change.
    pub(super) fn passing(&self, i: usize) -> impl Iterator<Item = &Link<D>> {
        self.links[self.range(i)].iter().filter(|l| !l.is_wall())
    }

    /// Sign with which component `r` of the row at the other end of an entry is seen.
    #[inline(always)]
    pub(super) fn sign(&self, link: &Link<D>, r: usize) -> f64 {
        match link.kind {
            Kind::Image(t) => self.signs[t as usize][r],
            _ => 1.0,
        }
    }
}
