//! Smooth multipliers, which block after block finds only after as many iterations as the cloud is particles wide.
//!
//! A smooth field λ of closures with its gradient as moments moves no area vector: λ_i − λ_j + ½ (∇λ_i + ∇λ_j)·d vanishes. What is
//! left of its energy is that of the softness and of the volumes, ε |∇λ|² + b (∇·λ)², at most that of the graph times a constant c.
//! So (c L)⁻¹, between P, which makes multipliers of a field, and Pᵀ, is the other half of the preconditioner (Xu, *The auxiliary
//! space method*, Computing 56, 1996). At a wall its own multiplier follows the field.
use super::graph::Graph;
use super::{Problem, Row};
use crate::cloud::coefficient_unknowns::{Kind, Link, sweep_entries};
use crate::math::Vector;
use crate::math::conjugate::Row as _;
use crate::math::square::{cofactors, determinant, times};
use crate::math::sweep::{sum, sweep};

/// Smallest determinant, relative to the trace, of the least squares of a gradient.
const FLAT: f64 = 1e-6;

/// What it takes.
pub(super) struct Smooth<const D: usize> {
    /// Coefficients g of ∇λ_i = Σ g (λ_j − λ_i), entry by entry; zero at walls.
    slope: Vec<Vector<D>>,
    /// One over the weights of all who share each wall.
    total: Vec<f64>,
    /// 1/c.
    scale: f64,
    /// A field, and what is gathered to it.
    field: Vec<Vector<D>>,
    gathered: Vec<Row<D>>,
}

impl<const D: usize> Smooth<D> {
    pub(super) fn new(problem: &Problem<D>) -> Self {
        let n = problem.n_fluid;
        let mut inverse = vec![[Vector::ZERO; D]; n];
        sweep(&mut inverse, |i| {
            let mut square = [Vector::ZERO; D];
            for l in problem.passing(i) {
                let d = l.offset * (1.0 / l.offset.norm());
                (0..D).for_each(|r| square[r] += d * d[r]);
            }
            let (size, trace) = (determinant(&square), (0..D).map(|r| square[r][r]).sum::<f64>());
            if size <= FLAT * trace.powi(D as i32) {
                return [Vector::ZERO; D];
            }
            cofactors(&square).map(|row| row * (1.0 / size))
        });
        let mut slope = vec![Vector::ZERO; problem.links.len()];
        sweep_entries(&problem.first, &mut slope, |i, p, slot| {
            let link = &problem.links[p];
            if !matches!(link.kind, Kind::Wall(_) | Kind::Open) {
                *slot = times(&inverse[i], &link.offset) * (1.0 / link.offset.norm_squared());
            }
        });
        let total = problem.sharers.iter().map(|all| {
            let weight: f64 = all.iter().map(|(_, p)| problem.links[*p as usize].weight).sum();
            1.0 / weight.max(f64::MIN_POSITIVE)
        });
        let graph = |i: usize| problem.passing(i).map(|l| l.weight * l.offset.norm_squared()).sum::<f64>();
        let own = |i: usize| problem.softness[i] * problem.unit[i] * problem.unit[i] + problem.volume_freedom(i);
        let scale = sum(n, |i| graph(i) / own(i)) / (2.0 * (D * n.max(1)) as f64);
        Self { slope, total: total.collect(), scale, field: vec![Vector::ZERO; n], gathered: vec![Row::ZERO; n] }
    }

    /// z ≈ P (c L)⁻¹ Pᵀ r.
    pub(super) fn apply(&mut self, problem: &Problem<D>, graph: &mut Graph, r: &[Row<D>], z: &mut [Row<D>]) {
        let n = problem.n_fluid;
        let (slope, total) = (&self.slope, &self.total);
        // what walls pass on to those who share them
        sweep(&mut self.gathered, |i| {
            let mut row = r[i];
            for link in problem.links[problem.range(i)].iter().filter(|l| l.is_wall()) {
                let w = link.other as usize - n;
                let passed = -link.weight * total[w] * r[link.other as usize].closure[0];
                row.add(&(problem.wall(link) * passed), &link.offset, 1.0);
            }
            row
        });
        let gathered = &self.gathered;
        sweep(&mut self.field, |i| {
            let mut value = gathered[i].closure;
            for p in problem.range(i) {
                let link: &Link<D> = &problem.links[p];
                if link.is_wall() || matches!(link.kind, Kind::Open) {
                    continue;
                }
                let (from, back) = (&gathered[link.other as usize], &slope[link.partner as usize]);
                for c in 0..D {
                    value[c] += problem.sign(link, c) * from.moment[c].dot(back) - gathered[i].moment[c].dot(&slope[p]);
                }
            }
            value
        });
        let mut found = vec![Vector::ZERO; n];
        graph.nearly_solve(&self.field, &mut found);
        let scale = self.scale;
        sweep(&mut self.field, |i| found[i] * scale);
        let field = &self.field;
        sweep(&mut z[..n], |i| {
            let mut moment = [Vector::ZERO; D];
            for p in problem.range(i) {
                let link = &problem.links[p];
                if link.is_wall() || matches!(link.kind, Kind::Open) {
                    continue;
                }
                let other = &field[link.other as usize];
                (0..D).for_each(|c| moment[c] += slope[p] * (problem.sign(link, c) * other[c] - field[i][c]));
            }
            Row { closure: field[i], moment }
        });
        let (fluid, walls) = z.split_at_mut(n);
        sweep(walls, |w| {
            let mut row = Row::ZERO;
            for (k, p) in &problem.sharers[w] {
                let link = &problem.links[*p as usize];
                let y = &fluid[*k as usize];
                let along = Vector::from_fn(|c| y.closure[c] + y.moment[c].dot(&link.offset)).dot(&problem.wall(link));
                row.closure[0] -= link.weight * total[w] * along;
            }
            row
        });
    }
}
