//! Coarser levels of the system for the multipliers: groups of particles that share a field.
//!
//! Each level is the Galerkin projection of the finer one onto fields that are affine on every group, except for the
//! pairs between groups: affine fields on groups have steps between them that a smooth field does not have, and these
//! pairs are made less stiff. A wall belongs to the nearest particle in front of it and follows the field there.
use super::field::{Field, Moments, STIFFNESS};
use super::{Problem, Sharer};
use crate::cloud::coefficient_unknowns::{ITSELF, Kind, Link};
use crate::cloud::multipliers::{Factors, Row, opposite, part_of};
use crate::math::Vector;
use crate::math::groups::Groups;
use crate::math::parallel::{sweep, sweep_each};

/// Number of rows per group.
const GROUP: usize = 8;
/// Where there are thin layers, rows are grouped only along pairs with at least this fraction of the greatest weight of
/// a row: first across the layers, where large faces have large weights.
const STRONG: f64 = 0.1;
/// Number of rows at which coarsening stops, and greatest number of levels.
const COARSEST: usize = 200;
const MAX_LEVELS: usize = 12;

/// Coupling of a group with another one.
#[derive(Clone, Copy)]
pub(super) struct Edge<const D: usize> {
    pub(super) other: u32,
    /// Transform under which the other group is coupled, or `ITSELF`.
    transform: u8,
    /// Offset from the centre of the group to that of the other.
    shift: [f32; D],
    /// Moments of the pairs, with midpoints relative to the centre of the group.
    moments: Moments<D>,
}

impl<const D: usize> Edge<D> {
    /// Contribution of the field of the other group to the product in the row of the group.
    #[inline(always)]
    pub(super) fn pull<V: Field<D>>(&self, signs: &[Vector<D>], other: &V) -> V {
        let back = opposite(&self.shift);
        match self.transform {
            ITSELF => other.at(&back).weighed(&self.moments),
            t => other.mirrored(&signs[t as usize]).at(&back).weighed(&self.moments),
        }
    }
}

/// A level, or the particles, whose rows are grouped.
trait Finer<const D: usize>: Sync {
    fn n_rows(&self) -> usize;
    fn centre(&self, i: usize) -> Vector<D>;
    /// Calls `f` with every coupling of row `i`.
    fn edges(&self, i: usize, f: &mut dyn FnMut(&Edge<D>));
    /// Moments of the pairs whose other end has no multipliers.
    fn open(&self, i: usize) -> Moments<D>;
    /// Softness of row `i` and mobility of its volume.
    fn soft(&self, i: usize) -> [f64; 2];
}

/// One of the coarser levels.
pub(super) struct Level<const D: usize> {
    /// Rows of the finer level that share a field.
    pub(super) groups: Groups,
    /// Offset of each of those rows from the centre of its group.
    pub(super) offset: Vec<[f32; D]>,
    centre: Vec<Vector<D>>,
    first: Vec<u32>,
    edges: Vec<Edge<D>>,
    open: Vec<Moments<D>>,
    /// Moments of all pairs of a group with others.
    pub(super) own: Vec<Moments<D>>,
    /// Softness of each group and mobility of its volume.
    pub(super) soft: Vec<[f64; 2]>,
    pub(super) factors: Factors<D>,
}

/// All coarser levels, from fine to coarse.
pub(super) fn levels<const D: usize>(problem: &Problem<'_, D>) -> Vec<Level<D>> {
    let mut all: Vec<Level<D>> = Vec::new();
    let strong = if problem.cloud.layers.is_empty() { 0.0 } else { STRONG };
    while all.len() < MAX_LEVELS {
        let next = match all.last() {
            Some(last) => Level::new(last, &problem.signs, strong),
            None => Level::new(&Particles::new(problem), &problem.signs, strong),
        };
        match next {
            Some(level) => all.push(level),
            None => break,
        }
    }
    all
}

impl<const D: usize> Level<D> {
    /// Groups the rows of `finer`; `None` when there are few, or when they are hardly coupled.
    fn new(finer: &impl Finer<D>, signs: &[Vector<D>], strong: f64) -> Option<Self> {
        let n = finer.n_rows();
        if n <= COARSEST {
            return None;
        }
        let others = |i: usize, list: &mut Vec<u32>| {
            let mut least = 0.0f64;
            if strong > 0.0 {
                finer.edges(i, &mut |e| least = least.max(strong * e.moments.weight()));
            }
            finer.edges(i, &mut |e| {
                if e.moments.weight() >= least {
                    list.push(e.other);
                }
            });
        };
        let groups = Groups::new(n, GROUP, others);
        if groups.len() * 10 > n * 9 {
            return None;
        }
        let mut centre = vec![Vector::ZERO; groups.len()];
        sweep(&mut centre, |g| {
            let members = groups.members(g);
            members.iter().fold(Vector::ZERO, |x, i| x + finer.centre(*i as usize)) * (1.0 / members.len() as f64)
        });
        let mut offset = vec![[0.0; D]; n];
        sweep(&mut offset, |i| part_of(&(finer.centre(i) - centre[groups.of()[i] as usize]), 1.0));
        let mut rows = vec![Vec::new(); groups.len()];
        sweep_each(&mut rows, |g| gather(finer, signs, &groups, &offset, g));
        let mut first = vec![0];
        first.extend(rows.iter().scan(0, |n, r| {
            *n += r.len() as u32;
            Some(*n)
        }));
        let [mut open, mut own] = [(); 2].map(|()| vec![Moments::ZERO; groups.len()]);
        let members = |g: usize| groups.members(g).iter().map(|i| *i as usize);
        sweep(&mut open, |g| members(g).fold(Moments::ZERO, |m, i| m.plus(1.0, &finer.open(i).seen_from(&offset[i]))));
        sweep(&mut own, |g| rows[g].iter().fold(open[g], |m, e| m.plus(1.0, &e.moments)));
        let mut soft = vec![[0.0; 2]; groups.len()];
        sweep(&mut soft, |g| members(g).map(|i| finer.soft(i)).fold([0.0; 2], |a, b| [a[0] + b[0], a[1] + b[1]]));
        let mut edges = Vec::with_capacity(rows.iter().map(Vec::len).sum());
        rows.into_iter().for_each(|row| edges.extend(row));
        let factors = Factors::new(groups.len(), |g| {
            let (own, soft) = (&own[g], soft[g]);
            move |e: &Row<D>| e.own(own, soft)
        });
        Some(Self { groups, offset, centre, first, edges, open, own, soft, factors })
    }

    pub(super) fn len(&self) -> usize {
        self.centre.len()
    }

    pub(super) fn edges(&self, i: usize) -> &[Edge<D>] {
        &self.edges[self.first[i] as usize..self.first[i + 1] as usize]
    }
}

/// The couplings of group `g`: the sums of those of its members.
fn gather<const D: usize>(
    finer: &impl Finer<D>,
    signs: &[Vector<D>],
    groups: &Groups,
    offset: &[[f32; D]],
    g: usize,
) -> Vec<Edge<D>> {
    let mut all: Vec<Edge<D>> = Vec::new();
    for i in groups.members(g).iter().map(|i| *i as usize) {
        finer.edges(i, &mut |e| {
            let other = groups.of()[e.other as usize];
            if other as usize == g && e.transform == ITSELF {
                return;
            }
            let moments = e.moments.seen_from(&offset[i]);
            match all.iter_mut().find(|a| a.other == other && a.transform == e.transform) {
                Some(a) => a.moments = a.moments.plus(STIFFNESS, &moments),
                None => {
                    // shift from centre to centre: that of the members, corrected by the offsets of both
                    let mut shift = e.shift;
                    let behind = seen(signs, e.transform, &offset[e.other as usize]);
                    (0..D).for_each(|d| shift[d] += offset[i][d] - behind[d]);
                    let moments = Moments::ZERO.plus(STIFFNESS, &moments);
                    all.push(Edge { other, transform: e.transform, shift, moments });
                }
            }
        });
    }
    all
}

/// An offset under a transform.
fn seen<const D: usize>(signs: &[Vector<D>], transform: u8, offset: &[f32; D]) -> [f32; D] {
    let mut seen = *offset;
    if transform != ITSELF {
        (0..D).for_each(|d| seen[d] *= signs[transform as usize][d] as f32);
    }
    seen
}

impl<const D: usize> Finer<D> for Level<D> {
    fn n_rows(&self) -> usize {
        self.len()
    }

    fn centre(&self, i: usize) -> Vector<D> {
        self.centre[i]
    }

    fn edges(&self, i: usize, f: &mut dyn FnMut(&Edge<D>)) {
        Level::edges(self, i).iter().for_each(f);
    }

    fn open(&self, i: usize) -> Moments<D> {
        self.open[i]
    }

    fn soft(&self, i: usize) -> [f64; 2] {
        self.soft[i]
    }
}

/// The particles, with the nearest one of those that share each wall.
struct Particles<'a, const D: usize> {
    problem: &'a Problem<'a, D>,
    nearest: Vec<Option<Sharer>>,
}

impl<'a, const D: usize> Particles<'a, D> {
    fn new(problem: &'a Problem<'a, D>) -> Self {
        let mut nearest = vec![None; problem.sharers.len()];
        sweep(&mut nearest, |w| {
            let link = |s: &Sharer| problem.link(s);
            let here = problem.sharers[w].iter().filter(|s| link(s).kind == Kind::Wall(ITSELF));
            here.min_by(|a, b| link(a).offset.norm_squared().total_cmp(&link(b).offset.norm_squared())).copied()
        });
        Self { problem, nearest }
    }

    /// Coupling of a particle with the entry `own` for a wall to one that has the entry `other` for the same wall.
    fn along_wall(&self, row: u32, transform: u8, own: &Link<D>, other: &Link<D>, weight: f64) -> Edge<D> {
        let signs = &self.problem.signs;
        let own = part_of(&own.offset, 1.0);
        let behind = seen(signs, transform, &part_of(&other.offset, 1.0));
        let mut shift = own;
        (0..D).for_each(|d| shift[d] -= behind[d]);
        Edge { other: row, transform, shift, moments: Moments::of(weight, &own) }
    }

    fn edges_along_wall(&self, i: usize, p: usize, transform: u8, f: &mut dyn FnMut(&Edge<D>)) {
        let problem = self.problem;
        let link = &problem.links.at(i, p);
        let w = link.other as usize - problem.n_fluid;
        let Some(nearest) = self.nearest[w] else { return };
        // all components are coupled although the wall couples the normal one only: stiffer than necessary, but equal
        // in all components
        let weight = |l: &Link<D>| l.weight * problem.walls[w].norm_squared();
        if nearest.p as usize != p {
            f(&self.along_wall(nearest.i, transform, link, &problem.link(&nearest), weight(link)));
            return;
        }
        for s in problem.sharers[w].iter().filter(|s| s.p as usize != p) {
            let other = &problem.link(s);
            if let Kind::Wall(t) = other.kind
                && (s.i as usize != i || t != ITSELF)
            {
                f(&self.along_wall(s.i, t, link, other, weight(other)));
            }
        }
    }
}

impl<const D: usize> Finer<D> for Particles<'_, D> {
    fn n_rows(&self) -> usize {
        self.problem.n_fluid
    }

    fn centre(&self, i: usize) -> Vector<D> {
        self.problem.cloud.x[i]
    }

    fn edges(&self, i: usize, f: &mut dyn FnMut(&Edge<D>)) {
        for (p, link) in self.problem.links.of(i) {
            let transform = match link.kind {
                Kind::Pair => ITSELF,
                Kind::Image(t) => t,
                Kind::Open => continue,
                Kind::Wall(t) => {
                    self.edges_along_wall(i, p, t, f);
                    continue;
                }
            };
            let moments = Moments::of(link.weight, &part_of(&link.offset, 0.5));
            f(&Edge { other: link.other, transform, shift: part_of(&link.offset, 1.0), moments });
        }
    }

    fn open(&self, i: usize) -> Moments<D> {
        let open = self.problem.passing(i).filter(|l| l.kind == Kind::Open);
        open.fold(Moments::ZERO, |m, l| m.plus(1.0, &Moments::of(l.weight, &part_of(&l.offset, 0.5))))
    }

    fn soft(&self, i: usize) -> [f64; 2] {
        [self.problem.tolerance(i), self.problem.volume_freedom(i)]
    }
}
