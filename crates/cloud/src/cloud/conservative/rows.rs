//! Rows of the system for the multipliers, as the sweeps over the particles use them.
use std::ops::Range;

use super::Problem;
use super::cycle::{Grid, Way};
use crate::cloud::multipliers::{Row, opposite};
use crate::math::conjugate::Row as _;
use crate::math::parallel::{sweep, sweep_slots};

impl<const D: usize> Grid<Row<D>> for Problem<'_, D> {
    #[inline(always)]
    fn left(&self, i: usize, b: &Row<D>, x: &[Row<D>]) -> Row<D> {
        b.plus(-1.0, &self.row(i, x))
    }

    #[inline(always)]
    fn less(&self, i: usize, mut r: Row<D>, range: &Range<usize>, found: &[Row<D>], way: Way) -> Row<D> {
        self.each_passed(i, range, way, |j, middle, weight| {
            r.add(weight, &found[j - range.start].at(&opposite(middle)), middle);
        });
        r
    }

    #[inline(always)]
    fn solved(&self, i: usize, r: &Row<D>) -> Row<D> {
        self.factors.solve(i, r)
    }

    /// Computes the multipliers of the walls from those of the particles.
    fn follow(&self, b: &[Row<D>], x: &mut [Row<D>]) {
        let mut walls = vec![0.0; self.sharers.len()];
        sweep(&mut walls, |w| (b[self.n_fluid + w].share() - self.wall_row(w, x)) / self.shared[w]);
        sweep_slots(&mut x[self.n_fluid..], |w, x| *x = x.with_share(x.share() + walls[w]));
    }
}
