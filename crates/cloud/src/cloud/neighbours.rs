//! Neighbour lists of the particles.
//!
//! Away from walls, the neighbours of a particle form the 3×3 (3×3×3) stencil of the background: the leaves that touch
//! its own. In 3-D, pairs that touch along an edge of the cube only are left out, which halves the cost at the same
//! accuracy. Near a wall, the neighbours lie in the ball r ≤ ρ (h_i + h_j)/2 and include interface particles. No pair
//! extends through a body: two particles are not neighbours when the segment between them crosses a surface, and an
//! interface particle has neighbours only in front of it. In 2-D, its neighbours on the surface are the two adjacent
//! ones along the outline, but none across a sharp edge.
use std::cell::OnceCell;
use std::sync::Arc;

use super::Transform;
use super::layers::Source;
use super::particles::Particles;
use crate::geometry::Surface;
use crate::math::parallel::{CHUNK, sweep_each, sweep_parts};
use crate::math::{Bounds, Vector};

/// Distance to the wall, in spacings, below which the ball rule applies to the pairs of a particle.
pub const NEAR: f64 = 3.0;
/// Sine of the smallest angle between the tangent plane of an interface particle and the direction to a neighbour.
const GRAZING: f64 = 0.05;
/// Interface particles whose normals have a cosine below this value are not neighbours.
const FACING: f64 = 0.2;
/// Distance from the surface, as a fraction of the spacing, at which lines of sight of interface particles start.
const LIFT: f64 = 1e-3;
/// Radius, in spacings, of the fit for the state of an interface particle; it contains two rows of fluid particles.
const FIT_REACH: f64 = 3.2;
/// Radius of this fit where the ordinary radius contains fewer than D + 1 particles (crevices).
const FIT_REACH_WIDE: f64 = 6.4;
/// Search radius, in spacings, for the nearest fluid particle of an interface particle that sees none.
const FIT_REACH_LAST: f64 = 200.0;
/// Fraction of the distance to the surface that is certainly free of surface.
const FREE: f64 = 0.99;
/// Tolerance, in spacings, within which leaves count as touching.
const TOUCH: f64 = 1e-6;
/// Minimum height, in spacings, of a free line of sight above all surface nearby; it covers round-off.
const ABOVE: f64 = 1e-9;
/// A quarter plus more than round-off.
const BEYOND: f64 = 0.2500001;
/// Initial capacity of the list of a chunk, in neighbours per row.
const ROOM: usize = 20;

/// Neighbour lists in compressed-row storage.
#[derive(Clone, Debug, Default)]
pub struct Neighbours {
    /// Start of each row in `index`, followed by the end of the last row.
    pub first: Arc<Vec<u32>>,
    /// Particle indices, in ascending order within each row.
    pub index: Arc<Vec<u32>>,
}

impl Neighbours {
    /// Neighbours of particle `i`.
    #[inline]
    pub fn of(&self, i: usize) -> &[u32] {
        &self.index[self.range(i)]
    }

    /// Range of the neighbours of particle `i` in `index`.
    #[inline]
    pub fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.first[i] as usize..self.first[i + 1] as usize
    }

    /// Number of rows: fluid and interface particles.
    pub fn len(&self) -> usize {
        self.first.len() - 1
    }

    /// True when there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A neighbour before ghosts are numbered: particle and transform (`IDENTITY` for the particle itself).
pub(super) type Seen = (u32, u8);
pub(super) const IDENTITY: u8 = u8::MAX;

/// Neighbour lists before ghosts are numbered, in chunks of `CHUNK` rows that are filled in parallel.
pub(super) struct Rows {
    chunks: Vec<(Vec<u32>, Vec<Seen>)>,
}

impl Rows {
    /// Calls `fill(i, list)` for every row, which appends the neighbours of row `i` to `list`.
    pub(super) fn new(n: usize, fill: impl Fn(usize, &mut Vec<Seen>) + Sync) -> Self {
        let mut chunks = vec![(Vec::new(), Vec::new()); n.div_ceil(CHUNK)];
        sweep_each(&mut chunks, |c| {
            let (mut first, mut list) = (vec![0], Vec::with_capacity(ROOM * CHUNK));
            for i in c * CHUNK..n.min((c + 1) * CHUNK) {
                fill(i, &mut list);
                first.push(list.len() as u32);
            }
            (first, list)
        });
        Self { chunks }
    }

    /// Neighbours of row `i`.
    pub(super) fn of(&self, i: usize) -> &[Seen] {
        let (first, list) = &self.chunks[i / CHUNK];
        &list[first[i % CHUNK] as usize..first[i % CHUNK + 1] as usize]
    }

    /// All neighbours that are images.
    pub(super) fn ghosts(&self) -> impl Iterator<Item = Seen> + '_ {
        self.chunks.iter().flat_map(|(_, list)| list).filter(|s| s.1 != IDENTITY).copied()
    }

    /// Removes entries, given as pairs (row, neighbour) in sorted order.
    pub(super) fn remove(&mut self, unwanted: &[(u32, Seen)]) {
        for (c, (first, list)) in self.chunks.iter_mut().enumerate() {
            let below = |row: usize| unwanted.partition_point(|u| (u.0 as usize) < row);
            let own = &unwanted[below(c * CHUNK)..below((c + 1) * CHUNK)];
            if own.is_empty() {
                continue;
            }
            let old = std::mem::replace(first, vec![0]);
            let mut kept = Vec::with_capacity(list.len());
            for (row, ends) in (c * CHUNK..).zip(old.windows(2)) {
                let entries = list[ends[0] as usize..ends[1] as usize].iter();
                kept.extend(entries.filter(|s| own.binary_search(&(row as u32, **s)).is_err()));
                first.push(kept.len() as u32);
            }
            *list = kept;
        }
    }

    /// Final neighbour lists: `number` gives the particle index of a neighbour, and `extra` holds sorted pairs (row,
    /// neighbour) that are added.
    pub(super) fn pack(self, extra: &[(u32, Seen)], number: impl Fn(&Seen) -> u32 + Sync) -> Neighbours {
        let joins = |i: usize| {
            &extra[extra.partition_point(|e| (e.0 as usize) < i)..extra.partition_point(|e| e.0 as usize <= i)]
        };
        let mut first = vec![0u32];
        let mut chunks = Vec::with_capacity(self.chunks.len());
        for (ends, _) in &self.chunks {
            let start = first[first.len() - 1];
            for pair in ends.windows(2) {
                let row = first.len() - 1;
                first.push(first[row] + pair[1] - pair[0] + joins(row).len() as u32);
            }
            chunks.push(start as usize..first[first.len() - 1] as usize);
        }
        let mut index = vec![0; first[first.len() - 1] as usize];
        sweep_parts(&chunks, 1, &mut index, &|c, slots| {
            for i in c * CHUNK..c * CHUNK + self.chunks[c].0.len() - 1 {
                let row = &mut slots[first[i] as usize - chunks[c].start..first[i + 1] as usize - chunks[c].start];
                let seen = self.of(i).iter().chain(joins(i).iter().map(|e| &e.1));
                row.iter_mut().zip(seen).for_each(|(slot, s)| *slot = number(s));
                row.sort_unstable();
            }
        });
        Neighbours { first: Arc::new(first), index: Arc::new(index) }
    }
}

/// Whether the line of sight between two particles is tested, or was tested from the other end.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sight {
    Tested,
    Granted,
}

/// A particle whose neighbours are searched, with its cached knowledge of the nearby surface.
struct Eye<const D: usize> {
    i: usize,
    reach: f64,
    horizon: OnceCell<Option<Horizon<D>>>,
}

impl<const D: usize> Eye<D> {
    fn new(i: usize, reach: f64) -> Self {
        Self { i, reach, horizon: OnceCell::new() }
    }
}

/// A plane such that all surface within `bounds` lies below it: a line of sight above it is free.
struct Horizon<const D: usize> {
    normal: Vector<D>,
    height: f64,
    bounds: Bounds<D>,
}

impl<const D: usize> Horizon<D> {
    fn is_above(&self, x: &Vector<D>) -> bool {
        self.bounds.contains(x) && x.dot(&self.normal) > self.height
    }
}

/// Neighbour search among the particles of a background tree.
pub struct Search<'a, const D: usize> {
    particles: &'a Particles<D>,
    surface: Option<&'a Surface<D>>,
    transforms: &'a [Transform<D>],
    inverse: Vec<u8>,
    radius: f64,
    free: Option<Vec<f64>>,
}

impl<'a, const D: usize> Search<'a, D> {
    /// Prepares a search; `radius` is the radius ρ of the ball rule in spacings.
    pub fn new(
        particles: &'a Particles<D>,
        surface: Option<&'a Surface<D>>,
        transforms: &'a [Transform<D>],
        radius: f64,
    ) -> Self {
        let find = |t: &Transform<D>| transforms.iter().position(|o| o.undoes(t)).map_or(IDENTITY, |k| k as u8);
        let inverse = transforms.iter().map(find).collect();
        Self { particles, surface, transforms, inverse, radius, free: None }
    }

    /// Search among particles that are not located at the centres of leaves, so that the ball rule applies everywhere.
    /// `reach` is the search radius of each fluid and interface particle.
    pub(super) fn free(self, reach: Vec<f64>) -> Self {
        Self { free: Some(reach), ..self }
    }

    /// True when no particle, image or other, is nearer to `x` than `within`.
    pub(super) fn is_empty(&self, x: &Vector<D>, within: f64) -> bool {
        let p = self.particles;
        let near = |k: u32, t: u8| (self.position(k as usize, t) - *x).norm() < within;
        if p.in_leaf(p.tree.leaf_at(x).node).any(|k| near(k, IDENTITY)) {
            return false;
        }
        let mut empty = true;
        self.around(x, within, |k, t| empty &= !near(k, t));
        empty
    }

    /// The particles that are searched.
    pub(super) fn particles(&self) -> &Particles<D> {
        self.particles
    }

    /// Entries without a counterpart in the other row. Lines of sight are tested from one end only, and round-off or an
    /// abrupt change of the spacing may decide differently at the other end. Pairs of the regular background always
    /// agree.
    pub(super) fn unanswered(&self, rows: &Rows) -> Vec<(u32, Seen)> {
        let p = self.particles;
        let n = p.n_rows();
        let mut chunks = vec![Vec::new(); n.div_ceil(CHUNK)];
        sweep_each(&mut chunks, |c| {
            let mut found = Vec::new();
            for i in c * CHUNK..n.min((c + 1) * CHUNK) {
                let near = p.is_interface(i) || self.near(i);
                let refused = |s: &&Seen| {
                    let doubtful = near || s.1 != IDENTITY || p.is_interface(s.0 as usize);
                    let back = doubtful.then(|| self.seen_from(i, **s)).flatten();
                    back.is_some_and(|(k, back)| !rows.of(k as usize).contains(&back))
                };
                found.extend(rows.of(i).iter().filter(refused).map(|s| (i as u32, *s)));
            }
            found.sort_unstable();
            found
        });
        chunks.concat()
    }

    /// The entry of particle `i` in the row of its neighbour `s`, if the neighbour has a row.
    pub(super) fn seen_from(&self, i: usize, s: Seen) -> Option<(u32, Seen)> {
        let back = if s.1 == IDENTITY { IDENTITY } else { self.inverse[s.1 as usize] };
        let known = (s.0 as usize) < self.particles.n_rows() && (s.1 == IDENTITY || back != IDENTITY);
        known.then_some((s.0, (i as u32, back)))
    }

    /// Adds the neighbours of particle `i`, except those in wall layers.
    pub(super) fn cloud_of(&self, i: usize, list: &mut Vec<Seen>) {
        if self.in_layers(i) {
            return;
        }
        let eye = Eye::new(i, self.reach(i));
        self.candidates(i, eye.reach, |k, t| {
            let near = self.free.is_none() || t != IDENTITY || self.within_ball(i, k as usize);
            if near && !self.in_layers(k as usize) && self.sees(&eye, k as usize, t) {
                list.push((k, t));
            }
        });
    }

    /// All visible particles within `radius` spacings of particle `i`, independent of the leaves.
    pub(super) fn visible_within(&self, i: usize, radius: f64) -> Vec<Seen> {
        let mut list = Vec::new();
        let eye = Eye::new(i, radius * self.particles.spacing[i]);
        self.candidates(i, eye.reach, |k, t| {
            let d = self.position(k as usize, t) - self.particles.x[i];
            if self.may_join(i, (k, t), &d) && self.sees_in_ball(&eye, k as usize, t, radius, Sight::Tested) {
                list.push((k, t));
            }
        });
        list
    }

    /// Whether particle `k` is visible from particle `i` within `wider` times the radius of the ball rule.
    pub(super) fn sees_within_radius(&self, i: usize, k: usize, t: u8, wider: f64) -> bool {
        let radius = wider * self.radius;
        self.sees_in_ball(&Eye::new(i, radius * self.particles.spacing[i]), k, t, radius, Sight::Tested)
    }

    /// Half-width of a cube that contains the leaves of all particles within that radius.
    pub(super) fn ball(&self, i: usize) -> f64 {
        0.5 * self.radius * 3.0 * self.particles.spacing[i]
    }

    /// Direction `v` under transform `t`.
    pub(super) fn direction(&self, v: &Vector<D>, t: u8) -> Vector<D> {
        if t == IDENTITY { *v } else { self.transforms[t as usize].direction(v) }
    }

    /// Offset from particle `i`, located at `x`, to its neighbour `s`, in the coordinates of the fit of row `i`.
    pub(super) fn offset(&self, i: usize, x: &Vector<D>, s: Seen) -> Vector<D> {
        let d = self.position(s.0 as usize, s.1) - *x;
        let source = Source { index: s.0 as usize, image: s.1 != IDENTITY };
        self.particles.layers.offset(i, self.particles.spacing[i], source, &d)
    }

    /// Adds the visible fluid particles in front of interface particle `i`; the radius is enlarged where there are too
    /// few.
    pub(super) fn fluid_in_front(&self, i: usize, list: &mut Vec<Seen>) {
        let start = list.len();
        for (reach, least) in [(FIT_REACH, D + 1), (FIT_REACH_WIDE, 1)] {
            list.truncate(start);
            let eye = Eye::new(i, reach * self.particles.spacing[i]);
            self.fluid_within(i, reach, |s, d| {
                if self.in_front(i, d, IDENTITY) && self.in_sight(&eye, s.0 as usize, s.1, d) {
                    list.push(s);
                }
            });
            if list.len() - start >= least {
                return;
            }
        }
        list.extend(self.nearest_fluid(i));
    }

    /// The D fluid particles nearest to an interface particle that lies so deep in a crevice that it sees none.
    fn nearest_fluid(&self, i: usize) -> Vec<Seen> {
        let mut found = Vec::new();
        let mut reach = FIT_REACH_WIDE;
        while found.len() < D && reach < FIT_REACH_LAST {
            found.clear();
            self.fluid_within(i, reach, |s, d| found.push((d.norm_squared(), s)));
            reach *= 2.0;
        }
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        found.into_iter().take(D).map(|f| f.1).collect()
    }

    /// Calls `f` with every fluid particle within `reach` spacings of particle `i` and the offset to it.
    fn fluid_within(&self, i: usize, reach: f64, mut f: impl FnMut(Seen, &Vector<D>)) {
        let p = self.particles;
        let radius = reach * p.spacing[i];
        self.candidates(i, radius, |k, t| {
            let d = self.position(k as usize, t) - p.x[i];
            if (k as usize) < p.n_fluid && d.norm() < radius {
                f((k, t), &d);
            }
        });
    }

    fn reach(&self, i: usize) -> f64 {
        let h = self.particles.spacing[i];
        match &self.free {
            Some(reach) => reach[i],
            None if self.near(i) => self.ball(i),
            None => h * (0.5 + TOUCH),
        }
    }

    fn near(&self, i: usize) -> bool {
        self.particles.wall_distance[i] < NEAR * self.particles.spacing[i]
    }

    /// Mean spacing of two particles.
    pub(super) fn mean_spacing(&self, i: usize, k: usize) -> f64 {
        0.5 * (self.particles.spacing[i] + self.particles.spacing[k])
    }

    /// Position of particle `k` under transform `t`.
    pub(super) fn position(&self, k: usize, t: u8) -> Vector<D> {
        let x = self.particles.x[k];
        if t == IDENTITY { x } else { self.transforms[t as usize].point(&x) }
    }

    /// Calls `f` for every particle, or image, whose leaf overlaps the cube of half-width `reach` around particle `i`.
    pub(super) fn candidates(&self, i: usize, reach: f64, mut f: impl FnMut(u32, u8)) {
        self.around(&self.particles.cell_centre(i), reach, |k, t| {
            if k as usize != i || t != IDENTITY {
                f(k, t);
            }
        });
    }

    /// Calls `f` for every particle, or image, whose leaf overlaps the cube of half-width `reach` around `x`.
    fn around(&self, x: &Vector<D>, reach: f64, mut f: impl FnMut(u32, u8)) {
        let p = self.particles;
        let domain = p.tree.bounds();
        let mut visit = |centre: &Vector<D>, t: u8| {
            let cube = Bounds { min: *centre - Vector::splat(reach), max: *centre + Vector::splat(reach) };
            p.tree.overlapping(&cube, |node| p.in_leaf(node).for_each(|k| f(k, t)));
        };
        visit(x, IDENTITY);
        for (t, transform) in self.transforms.iter().enumerate() {
            let back = transform.inverse().point(x);
            // the corner of the cube may extend into the domain where its faces do not
            if domain.distance_squared(&back) <= D as f64 * reach * reach {
                visit(&back, t as u8);
            }
        }
    }

    /// Whether particle `k`, moved by transform `t`, is a neighbour of particle `i`.
    fn sees(&self, eye: &Eye<D>, k: usize, t: u8) -> bool {
        let (p, i) = (self.particles, eye.i);
        let wall = p.is_interface(i) || p.is_interface(k);
        let near = wall || self.near(i) || self.near(k);
        let free = self.free.is_some();
        if !wall && !free && !self.leaves_touch(i, k, t, near) {
            return false;
        }
        // the line of sight is tested from the end with the smaller index
        let test = if i <= k { Sight::Tested } else { Sight::Granted };
        !(near || free) || self.sees_in_ball(eye, k, t, self.radius, test)
    }

    /// False for most pairs outside the ball; an inexpensive first test.
    #[inline(always)]
    fn within_ball(&self, i: usize, k: usize) -> bool {
        let p = self.particles;
        let size = p.spacing[i] + p.spacing[k];
        (p.x[k] - p.x[i]).norm_squared() < BEYOND * self.radius * self.radius * size * size
    }

    /// Whether particle `k` is visible from particle `i` within `radius` times their mean spacing.
    fn sees_in_ball(&self, eye: &Eye<D>, k: usize, t: u8, radius: f64, sight: Sight) -> bool {
        let (p, i) = (self.particles, eye.i);
        let d = self.position(k, t) - p.x[i];
        if d.norm() > radius * self.mean_spacing(i, k) {
            return false;
        }
        let in_sight = || sight == Sight::Granted || self.in_sight(eye, k, t, &d);
        match (p.is_interface(i), p.is_interface(k)) {
            (false, false) => in_sight(),
            (true, false) => self.in_front(i, &d, IDENTITY) && in_sight(),
            (false, true) => self.in_front(k, &-d, t) && in_sight(),
            (true, true) => self.walls_see(i, k, t),
        }
    }

    /// Whether the leaves of two particles touch; contacts along an edge of the cube count only near a wall.
    fn leaves_touch(&self, i: usize, k: usize, t: u8, near: bool) -> bool {
        let p = self.particles;
        let mut other = p.cell_centre(k);
        if t != IDENTITY {
            other = self.transforms[t as usize].point(&other);
        }
        let d = other - p.cell_centre(i);
        let reach = 0.5 * (p.spacing[i] + p.spacing[k]);
        let tolerance = TOUCH * p.spacing[i].min(p.spacing[k]);
        if d.max_abs() > reach + tolerance {
            return false;
        }
        let contacts = (0..D).filter(|a| d[*a].abs() > reach - tolerance).count();
        D == 2 || near || contacts != 2
    }

    fn in_front(&self, wall: usize, d: &Vector<D>, t: u8) -> bool {
        let normal = self.direction(&self.particles.interface[wall - self.particles.n_fluid].normal, t);
        d.dot(&normal) > GRAZING * d.norm()
    }

    /// 2-D: true for neighbours along the outline, and for a particle and its own image at a plane of symmetry that
    /// cuts the outline.
    fn walls_see(&self, i: usize, k: usize, t: u8) -> bool {
        let p = self.particles;
        if D == 2 && (if t == IDENTITY { !p.adjacent(i, k) } else { i != k }) {
            return false;
        }
        if D == 2 && t == IDENTITY {
            return true;
        }
        let (a, b) = (&p.interface[i - p.n_fluid], &p.interface[k - p.n_fluid]);
        a.normal.dot(&self.direction(&b.normal, t)) > FACING
    }

    /// True when no surface lies between the particle of `eye` and particle `k` moved by `t`, at the offset `d`.
    fn in_sight(&self, eye: &Eye<D>, k: usize, t: u8, d: &Vector<D>) -> bool {
        let (p, i) = (self.particles, eye.i);
        if self.surface.is_none() || p.wall_distance[i] + p.wall_distance[k] > d.norm() {
            return true;
        }
        let lifted = |w: usize| match p.is_interface(w) {
            true => p.interface[w - p.n_fluid].normal * (LIFT * p.spacing[w]),
            false => Vector::ZERO,
        };
        let (a, b) = (p.x[i] + lifted(i), p.x[i] + *d + self.direction(&lifted(k), t));
        // balls around both ends contain no surface: only the segment between them is tested
        let way = (b - a) * (FREE / d.norm());
        let (a, b) = (a + way * p.wall_distance[i], b - way * p.wall_distance[k]);
        if t == IDENTITY {
            let horizon = eye.horizon.get_or_init(|| self.horizon(eye));
            return horizon.as_ref().is_some_and(|h| h.is_above(&a) && h.is_above(&b)) || !self.blocked(&a, &b);
        }
        // the part of the segment beyond the side of the domain may be blocked by the image of a body
        let back = self.transforms[t as usize].inverse();
        !self.blocked(&a, &b) && !self.blocked(&back.point(&a), &back.point(&b))
    }

    /// The plane above the surface around a particle; most lines of sight need no other test.
    fn horizon(&self, eye: &Eye<D>) -> Option<Horizon<D>> {
        let (p, surface) = (self.particles, self.surface?);
        let x = p.x[eye.i];
        let normal = match p.is_interface(eye.i) {
            true => p.interface[eye.i - p.n_fluid].normal,
            false => (x - surface.nearest(&x, 2.0 * eye.reach)?.point).unit(),
        };
        let bounds = Bounds { min: x, max: x }.padded(eye.reach);
        let height = surface.highest(&normal, &bounds) + ABOVE * p.spacing[eye.i];
        Some(Horizon { normal, height, bounds })
    }

    /// True when a surface lies between two points.
    pub(super) fn blocked(&self, a: &Vector<D>, b: &Vector<D>) -> bool {
        self.surface.is_some_and(|s| s.crosses(a, b))
    }
}
