//! The unknowns of the conservative coefficients: one for each neighbour entry.
use super::layers::face_volume;
use super::operators::Reverse;
use super::{Cloud, Neighbours};
use crate::math::Vector;
use crate::math::parallel::{CHUNK, parts, sweep_parts};

/// Relative mobility of the shares β of a wall area.
const SHARE_FREEDOM: f64 = 0.1;
/// Stands in place of a transform for the interface particle itself.
pub(super) const ITSELF: u8 = u8::MAX;

/// Kind of particle at the other end of a neighbour entry.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A fluid particle that has the first one as a neighbour too.
    Pair,
    /// The image of a fluid particle under this transform.
    Image(u8),
    /// A particle on a side of the domain, or one that does not have the first as a neighbour.
    Open,
    /// An interface particle: its image under this transform, or `ITSELF`.
    Wall(u8),
}

/// A neighbour entry of a fluid particle.
#[derive(Clone, Copy)]
pub(super) struct Link<const D: usize> {
    /// Row of the particle at the other end.
    pub(super) other: u32,
    /// Weight w of the objective.
    pub(super) weight: f64,
    pub(super) offset: Vector<D>,
    pub(super) kind: Kind,
}

impl<const D: usize> Link<D> {
    pub(super) fn is_wall(&self) -> bool {
        matches!(self.kind, Kind::Wall(_))
    }
}

/// The neighbour entries of the fluid particles of a cloud. Except for the weights, their data are recomputed at every
/// access: stored, they would be the largest part of the memory of a cloud of millions of particles.
pub(super) struct Links<'a, const D: usize> {
    cloud: &'a Cloud<D>,
    /// True when the particle at the other end of an entry has the first one as a neighbour.
    seen_back: Vec<bool>,
    /// Weight w of every entry.
    weight: Vec<f32>,
}

impl<'a, const D: usize> Links<'a, D> {
    pub(super) fn new(cloud: &'a Cloud<D>) -> Self {
        let reverse = Reverse::new(cloud);
        let Neighbours { first, index, .. } = &cloud.neighbours;
        let first = &first[..=cloud.n_fluid];
        let seen_back = of_entries(first, false, |i, p| reverse.position(i, index[p] as usize).is_some());
        let weight = of_entries(first, 0.0, |i, p| weight(cloud, i, index[p] as usize) as f32);
        Self { cloud, seen_back, weight }
    }

    /// Range of the entries of row `i`.
    #[inline(always)]
    pub(super) fn range(&self, i: usize) -> std::ops::Range<usize> {
        self.cloud.neighbours.range(i)
    }

    /// Entries of row `i` and their data.
    #[inline(always)]
    pub(super) fn of(&self, i: usize) -> impl Iterator<Item = (usize, Link<D>)> {
        self.range(i).map(move |p| (p, self.at(i, p)))
    }

    /// The entry of particle `i` for particle `j`; `None` when `j` is not in its list.
    pub(super) fn between(&self, i: usize, j: usize) -> Option<(usize, Link<D>)> {
        let p = self.cloud.neighbours.of(i).binary_search(&(j as u32)).ok()? + self.range(i).start;
        Some((p, self.at(i, p)))
    }

    /// Particle, or image, at the other end of entry `p`.
    #[inline(always)]
    pub(super) fn end(&self, p: usize) -> usize {
        self.cloud.neighbours.index[p] as usize
    }

    /// Data of entry `p` of row `i`.
    #[inline(always)]
    pub(super) fn at(&self, i: usize, p: usize) -> Link<D> {
        let (cloud, j) = (self.cloud, self.end(p));
        let offset = cloud.x[j] - cloud.x[i];
        if j < cloud.n_fluid {
            let kind = if self.seen_back[p] { Kind::Pair } else { Kind::Open };
            return Link { other: j as u32, weight: f64::from(self.weight[p]), offset, kind };
        }
        self.beyond(p, offset)
    }

    /// The entries of row `i` for fluid particles, followed by the other entries.
    #[inline(always)]
    pub(super) fn sorted(&self, i: usize) -> [std::ops::Range<usize>; 2] {
        let range = self.range(i);
        let mut middle = range.start;
        while middle < range.end && self.end(middle) < self.cloud.n_fluid {
            middle += 1;
        }
        [range.start..middle, middle..range.end]
    }

    /// For entry `p` of row `i`, whose other end is a fluid particle: its index, half the offset to it in single
    /// precision, the weight, and whether it has particle `i` as a neighbour.
    #[inline(always)]
    pub(super) fn near(&self, i: usize, p: usize) -> (usize, [f32; D], f32, bool) {
        let (here, there) = (&self.cloud.x[i], &self.cloud.x[self.end(p)]);
        let mut middle = [0.0; D];
        for d in 0..D {
            middle[d] = (0.5 * (there[d] - here[d])) as f32;
        }
        (self.end(p), middle, self.weight[p], self.seen_back[p])
    }

    /// Data of an entry whose other end is not a fluid particle.
    #[inline(never)]
    fn beyond(&self, p: usize, offset: Vector<D>) -> Link<D> {
        let (cloud, j) = (self.cloud, self.end(p));
        let image = j.checked_sub(cloud.n_real()).and_then(|k| cloud.ghosts.get(k));
        let source = image.map_or(j, |m| m.source as usize);
        let kind = match image {
            _ if cloud.interface_range().contains(&source) => Kind::Wall(image.map_or(ITSELF, |m| m.transform)),
            Some(m) if self.seen_back[p] => Kind::Image(m.transform),
            _ => Kind::Open,
        };
        Link { other: source as u32, weight: f64::from(self.weight[p]), offset, kind }
    }
}

/// Evaluates `f(i, p)` for every neighbour entry p of the rows i that `first` delimits.
fn of_entries<T: Copy + Send>(first: &[u32], blank: T, f: impl Fn(usize, usize) -> T + Sync) -> Vec<T> {
    let rows = parts(first.len() - 1, CHUNK);
    let entries: Vec<_> = rows.iter().map(|r| first[r.start] as usize..first[r.end] as usize).collect();
    let mut all = vec![blank; entries.last().map_or(0, |e| e.end)];
    sweep_parts(&entries, 1, &mut all, &|k, slots| {
        for i in rows[k].clone() {
            (first[i] as usize..first[i + 1] as usize).for_each(|p| slots[p - entries[k].start] = f(i, p));
        }
    });
    all
}

/// Weight w of the entry of particle `i` for particle, or image, `j`.
fn weight<const D: usize>(cloud: &Cloud<D>, i: usize, j: usize) -> f64 {
    let source = cloud.source(j).index;
    if cloud.interface_range().contains(&source) {
        return SHARE_FREEDOM;
    }
    let face = face_volume(cloud, i, source);
    face * face / (cloud.x[j] - cloud.x[i]).norm_squared()
}
