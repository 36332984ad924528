//! Closure to round-off: the smallest change of the area vectors between particles after which the sum of each particle
//! is zero.
//!
//! The area vector s_ij changes by w_ij (y_i − y_j), where Σ_j w_ij (y_i − y_j) equals the missing part of the sum of
//! particle i.
use std::ops::Range;

use super::cycle::{Cycle, Grid, Levels, Way};
use super::{MAX_CLOSURE_ITERATIONS, Problem};
use crate::cloud::Operators;
use crate::cloud::coefficient_unknowns::{Kind, Link};
use crate::math::Vector;
use crate::math::conjugate::{Symmetric, conjugate_gradients};
use crate::math::parallel::sweep;
use crate::math::reduce::sum;

/// Relative reduction of the defect in one round.
const TOLERANCE: f64 = 1e-9;
/// Defect, relative to the area of a particle, that counts as round-off.
const ROUND_OFF: f64 = 1e-14;
/// Fraction of this defect at which the iteration stops: the largest defect exceeds the root mean square.
const FLOOR: f64 = 0.1;
/// Greatest number of rounds.
const ROUNDS: usize = 4;

impl<const D: usize> Problem<'_, D> {
    /// Closes the area vectors of all particles and returns the number of iterations.
    pub(super) fn close(&self, operators: &mut Operators<D>, levels: &Levels<D>) -> usize {
        let (n, mut iterations, weight) = (self.n_fluid, 0, &self.passing);
        let mut cycle = Cycle::new(levels, n);
        for _ in 0..ROUNDS {
            let surfaces = self.surfaces(operators);
            let allowed = |i: usize| ROUND_OFF * surfaces[i];
            let mut r = self.open(operators);
            if (0..n).all(|i| r[i].norm() <= allowed(i)) {
                break;
            }
            let size = |r: &[Vector<D>]| sum(n, |i| r[i].norm_squared() / weight[i]);
            let floor = sum(n, |i| D as f64 * allowed(i).powi(2) / weight[i]);
            let goal = (size(&r) * TOLERANCE * TOLERANCE).max(FLOOR * FLOOR * floor);
            let product = |y: &[Vector<D>], out: &mut [Vector<D>]| {
                sweep(out, |i| self.closure_row(i, y));
            };
            let precondition = |r: &[Vector<D>], z: &mut [Vector<D>]| cycle.nearly_solve(self, r, z);
            let mut y = vec![Vector::ZERO; n];
            let system = Symmetric { enough: |r: &[Vector<D>]| size(r) <= goal, product, precondition };
            iterations += conjugate_gradients(&mut y, &mut r, MAX_CLOSURE_ITERATIONS, system);
            self.alter(operators, |i, link| self.closure_change(i, link, &y));
        }
        iterations
    }

    /// Missing part of the sum of the area vectors of every fluid particle.
    pub(super) fn open(&self, operators: &Operators<D>) -> Vec<Vector<D>> {
        self.sums(operators, Vector::ZERO, |sum, s, _| *sum -= *s)
    }

    #[inline(always)]
    fn closure_row(&self, i: usize, y: &[Vector<D>]) -> Vector<D> {
        let (own, mut sum) = (y[i], Vector::ZERO);
        let [near, beyond] = self.links.sorted(i);
        for p in near {
            let (j, _, weight, both) = self.links.near(i, p);
            sum += if both { own - y[j] } else { own } * f64::from(weight);
        }
        for p in beyond {
            sum += self.closure_change(i, &self.links.at(i, p), y);
        }
        sum
    }

    /// Change of the area vector of an entry of row `i` due to `y`.
    #[inline(always)]
    fn closure_change(&self, i: usize, link: &Link<D>, y: &[Vector<D>]) -> Vector<D> {
        match link.kind {
            Kind::Pair | Kind::Image(_) => {
                Vector::from_fn(|d| y[i][d] - self.sign(link, d) * y[link.other as usize][d]) * link.weight
            }
            Kind::Open => y[i] * link.weight,
            Kind::Wall(_) => Vector::ZERO,
        }
    }
}

impl<const D: usize> Grid<Vector<D>> for Problem<'_, D> {
    #[inline(always)]
    fn left(&self, i: usize, b: &Vector<D>, x: &[Vector<D>]) -> Vector<D> {
        *b - self.closure_row(i, x)
    }

    #[inline(always)]
    fn less(&self, i: usize, r: Vector<D>, range: &Range<usize>, found: &[Vector<D>], way: Way) -> Vector<D> {
        let mut r = r;
        self.each_passed(i, range, way, |j, _, weight| r += found[j - range.start] * f64::from(weight));
        r
    }

    #[inline(always)]
    fn solved(&self, i: usize, r: &Vector<D>) -> Vector<D> {
        *r * (1.0 / self.passing[i])
    }
}
