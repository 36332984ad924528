//! Neighbour entries as unknowns of the conservative coefficients.
use super::Cloud;
use super::layers::face_volume;
use super::operators::Reverse;
use crate::math::Vector;
use crate::math::sweep::{CHUNK, parts, sweep_parts};

/// How freely shares β of a wall area move.
const SHARE_FREEDOM: f64 = 0.1;
/// In place of a transform: the interface particle itself.
pub(super) const ITSELF: u8 = u8::MAX;

/// What stands at the other end of a neighbour entry.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    /// A fluid particle.
    Pair,
    /// The image of a fluid particle under this transform.
    Image(u8),
    /// A particle on a side of the domain.
    Open,
    /// An interface particle: its image under this transform, or `ITSELF`.
    Wall(u8),
}

/// A neighbour entry of a fluid particle.
#[derive(Clone, Copy)]
pub(super) struct Link<const D: usize> {
    /// Row at the other end.
    pub(super) other: u32,
    /// Entry of that row that is the same unknown; its own number when there is none.
    pub(super) partner: u32,
    /// w of the objective.
    pub(super) weight: f64,
    pub(super) offset: Vector<D>,
    pub(super) kind: Kind,
}

impl<const D: usize> Link<D> {
    const EMPTY: Self = Self { other: 0, partner: 0, weight: 0.0, offset: Vector::ZERO, kind: Kind::Open };

    pub(super) fn is_wall(&self) -> bool {
        matches!(self.kind, Kind::Wall(_))
    }

    /// Part of the way to the other end at which the area vector stands.
    #[inline(always)]
    pub(super) fn reach(&self) -> f64 {
        if self.is_wall() { 1.0 } else { 0.5 }
    }
}

/// Sets `out[p] = f(i, p)` for every neighbour entry p of the rows i that `first` delimits.
pub(super) fn sweep_entries<T: Send>(first: &[u32], out: &mut [T], f: impl Fn(usize, usize, &mut T) + Sync) {
    let rows = parts(first.len() - 1, CHUNK);
    let entries: Vec<_> = rows.iter().map(|r| first[r.start] as usize..first[r.end] as usize).collect();
    sweep_parts(&entries, 1, out, &|k, slots| {
        for i in rows[k].clone() {
            for p in first[i] as usize..first[i + 1] as usize {
                f(i, p, &mut slots[p - entries[k].start]);
            }
        }
    });
}

/// Classifies the neighbour entries of all fluid particles.
pub(super) fn links<const D: usize>(cloud: &Cloud<D>) -> Vec<Link<D>> {
    let reverse = Reverse::new(cloud);
    let first = &cloud.neighbours.first[..=cloud.n_fluid];
    let mut all = vec![Link::EMPTY; first[cloud.n_fluid] as usize];
    sweep_entries(first, &mut all, |i, p, slot| *slot = link(cloud, &reverse, i, p));
    all
}

fn link<const D: usize>(cloud: &Cloud<D>, reverse: &Reverse<'_, D>, i: usize, p: usize) -> Link<D> {
    let j = cloud.neighbours.index[p] as usize;
    let offset = cloud.x[j] - cloud.x[i];
    let image = j.checked_sub(cloud.n_real()).and_then(|k| cloud.ghosts.get(k));
    let source = image.map_or(j, |m| m.source as usize);
    let transform = image.map(|m| m.transform);
    let partner = reverse.position(i, j).map(|(e, _)| e as u32);
    let face = face_volume(cloud, i, source) / offset.norm();
    let mut weight = face * face;
    let kind = match (transform, partner) {
        _ if cloud.interface_range().contains(&source) => {
            weight = SHARE_FREEDOM;
            Kind::Wall(transform.unwrap_or(ITSELF))
        }
        (None, Some(_)) => Kind::Pair,
        (Some(t), Some(_)) => Kind::Image(t),
        _ => Kind::Open,
    };
    Link { other: source as u32, partner: partner.unwrap_or(p as u32), weight, offset, kind }
}
