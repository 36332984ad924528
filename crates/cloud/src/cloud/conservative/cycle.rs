//! Multilevel preconditioner: sweeps over the particles and over increasingly coarse groups of them
//! ([`super::levels`]). The number of iterations hardly depends on the number of particles.
//!
//! Every level sweeps forward on the way down and backward on the way up, chunk by chunk: with updated values inside a
//! chunk and with old values outside it. The energy w |φ_i − φ_j|² of a pair is at most twice the sum of the energies
//! of its two ends alone. Such sweeps are therefore positive definite preconditioners in any order.
use std::ops::Range;

use multiversion::multiversion;

use super::Problem;
use super::field::Field;
use super::levels::{Edge, Level, levels};
use super::symmetry::Mirror;
use crate::math::Vector;
use crate::math::conjugate;
use crate::math::parallel::{copy, sweep_chunks, sweep_slots};

/// Number of visits to the next coarser level.
const VISITS: usize = 2;
/// Number of forward and backward sweeps on the coarsest level.
const COARSEST_SWEEPS: usize = 10;

/// Direction of a sweep.
#[derive(Clone, Copy)]
pub(super) enum Way {
    Forth,
    Back,
}

impl Way {
    /// True when row `j` of a range comes before row `i` in this direction.
    #[inline(always)]
    pub(super) fn has_passed(self, range: &Range<usize>, i: usize, j: usize) -> bool {
        match self {
            Self::Forth => range.start <= j && j < i,
            Self::Back => i < j && j < range.end,
        }
    }
}

/// A symmetric positive definite matrix given by its rows.
pub(super) trait Grid<V>: Sync {
    /// Residual b − A x of row `i`.
    fn left(&self, i: usize, b: &V, x: &[V]) -> V;

    /// r minus the contribution to row `i` of the rows of a range that the sweep has passed, whose values are in
    /// `found`.
    fn less(&self, i: usize, r: V, range: &Range<usize>, found: &[V], way: Way) -> V;

    /// Solution of the diagonal block of row `i` for the right-hand side r.
    fn solved(&self, i: usize, r: &V) -> V;

    /// Sets the values that follow from all others.
    fn follow(&self, _b: &[V], _x: &mut [V]) {}
}

/// Work arrays of a level.
struct Store<V> {
    b: Vec<V>,
    x: Vec<V>,
    left: Vec<V>,
}

/// The levels and their work arrays.
pub(super) struct Cycle<'a, const D: usize, V> {
    levels: &'a Levels<D>,
    stores: Vec<Store<V>>,
}

/// Coarser versions of a problem, and its planes of symmetry.
pub(super) struct Levels<const D: usize> {
    coarser: Vec<Level<D>>,
    mirrors: Vec<Mirror>,
}

impl<const D: usize> Levels<D> {
    pub(super) fn new(problem: &Problem<'_, D>, mirrors: Vec<Mirror>) -> Self {
        Self { coarser: levels(problem), mirrors }
    }
}

impl<'a, const D: usize, V: Field<D>> Cycle<'a, D, V>
where
    for<'p> Problem<'p, D>: Grid<V>,
    for<'l> Signed<'l, D>: Grid<V>,
{
    pub(super) fn new(levels: &'a Levels<D>, n: usize) -> Self {
        let zeros = |n: usize| vec![V::ZERO; n];
        let finest = Store { b: Vec::new(), x: Vec::new(), left: zeros(n) };
        let coarser =
            levels.coarser.iter().map(|l| l.len()).map(|n| Store { b: zeros(n), x: zeros(n), left: zeros(n) });
        Self { levels, stores: std::iter::once(finest).chain(coarser).collect() }
    }

    /// Approximate solution z ≈ A⁻¹ r.
    pub(super) fn nearly_solve(&mut self, problem: &Problem<'_, D>, r: &[V], z: &mut [V]) {
        sweep_slots(z, |_, z| *z = V::ZERO);
        visit(problem, &self.levels.coarser, &problem.signs, &mut self.stores, (r, &mut *z), true);
        let n = self.stores[0].left.len();
        let mirrors = self.levels.mirrors.iter().filter(|m| m.keeps(&r[..n]));
        let mut averaged = false;
        for mirror in mirrors {
            mirror.average(&mut z[..n], &mut self.stores[0].left);
            averaged = true;
        }
        if averaged {
            problem.follow(r, z);
        }
    }
}

/// A level with the signs of the transforms under which its groups are coupled.
pub(super) struct Signed<'a, const D: usize> {
    level: &'a Level<D>,
    signs: &'a [Vector<D>],
}

/// One cycle for A x = b on a level and all coarser ones; `first` when x is zero.
fn visit<const D: usize, V: Field<D>, G: Grid<V>>(
    grid: &G,
    coarser: &[Level<D>],
    signs: &[Vector<D>],
    stores: &mut [Store<V>],
    (b, x): (&[V], &mut [V]),
    first: bool,
) where
    for<'l> Signed<'l, D>: Grid<V>,
{
    let Some((store, below)) = stores.split_first_mut() else { return };
    let left = &mut store.left;
    let n = left.len();
    let (Some((level, rest)), Some(_)) = (coarser.split_first(), below.first()) else {
        (0..COARSEST_SWEEPS)
            .for_each(|_| [Way::Forth, Way::Back].into_iter().for_each(|way| improve(grid, b, x, left, way)));
        return;
    };
    if first {
        copy(&b[..n], left);
        step(grid, x, left, Way::Forth);
    } else {
        improve(grid, b, x, left, Way::Forth);
    }
    grid.follow(b, x);
    sweep_chunks(left, |range, left| lefts(grid, (b, x), range, left));
    let mut next = std::mem::take(&mut below[0].b);
    let mut found = std::mem::take(&mut below[0].x);
    sweep_slots(&mut next, |g, b| {
        *b = level
            .groups
            .members(g)
            .iter()
            .map(|i| *i as usize)
            .fold(V::ZERO, |b, i| b.plus(1.0, &left[i].gathered(&level.offset[i])));
    });
    sweep_slots(&mut found, |_, x| *x = V::ZERO);
    for visit_number in 0..VISITS {
        let grid = Signed { level, signs };
        visit(&grid, rest, signs, below, (&next, &mut found), visit_number == 0);
    }
    sweep_slots(&mut x[..n], |i, x| *x = x.plus(V::STEP, &found[level.groups.of()[i] as usize].at(&level.offset[i])));
    (below[0].b, below[0].x) = (next, found);
    grid.follow(b, x);
    improve(grid, b, x, &mut store.left, Way::Back);
}

/// One sweep for A x = b.
fn improve<V: conjugate::Row, G: Grid<V>>(grid: &G, b: &[V], x: &mut [V], left: &mut [V], way: Way) {
    sweep_chunks(left, |range, left| lefts(grid, (b, x), range, left));
    step(grid, x, left, way);
}

/// Adds the correction of a sweep for the residual `left` to x.
fn step<V: conjugate::Row, G: Grid<V>>(grid: &G, x: &mut [V], left: &mut [V], way: Way) {
    sweep_chunks(left, |range, found| find(grid, range, found, way));
    sweep_slots(&mut x[..left.len()], |i, x| *x = x.plus(1.0, &left[i]));
}

// The sums over rows are also compiled for wider vector registers.

/// Residual b − A x in the rows of a range.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn lefts<V, G: Grid<V>>(grid: &G, (b, x): (&[V], &[V]), range: Range<usize>, left: &mut [V]) {
    for (k, left) in left.iter_mut().enumerate() {
        let i = range.start + k;
        *left = grid.left(i, &b[i], x);
    }
}

/// Replaces the residual in the rows of a range by the correction of a sweep.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
#[allow(unsafe_code, reason = "the attribute calls the version that the processor has just been asked for")]
fn find<V: conjugate::Row, G: Grid<V>>(grid: &G, range: Range<usize>, found: &mut [V], way: Way) {
    for k in 0..found.len() {
        let k = if let Way::Forth = way { k } else { found.len() - 1 - k };
        let i = range.start + k;
        let r = grid.less(i, found[k], &range, found, way);
        found[k] = grid.solved(i, &r);
    }
}

impl<const D: usize, V: Field<D>> Grid<V> for Signed<'_, D> {
    #[inline(always)]
    fn left(&self, i: usize, b: &V, x: &[V]) -> V {
        let pull = |row: V, e: &Edge<D>| row.plus(1.0, &e.pull(self.signs, &x[e.other as usize]));
        self.level.edges(i).iter().fold(b.plus(-1.0, &x[i].own(&self.level.own[i], self.level.soft[i])), pull)
    }

    #[inline(always)]
    fn less(&self, i: usize, r: V, range: &Range<usize>, found: &[V], way: Way) -> V {
        let passed = self.level.edges(i).iter().filter(|e| way.has_passed(range, i, e.other as usize));
        passed.fold(r, |r, e| r.plus(1.0, &e.pull(self.signs, &found[e.other as usize - range.start])))
    }

    #[inline(always)]
    fn solved(&self, i: usize, r: &V) -> V {
        r.solved(&self.level.own[i], &self.level.factors, i)
    }
}
