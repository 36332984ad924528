//! Walls in the constrained problem: their area vectors are shared among the fluid particles in front of them.
use super::{Problem, Sharer};
use crate::cloud::coefficient_unknowns::Link;
use crate::cloud::multipliers::{Row, part_of};
use crate::cloud::operators::WallFace;
use crate::math::Vector;
use crate::math::parallel::sweep_slots;

impl<const D: usize> Problem<'_, D> {
    /// Change of the area vector of a wall entry of row `i`: W Aᵀ λ.
    #[inline(never)]
    pub(super) fn wall_change(&self, i: usize, link: &Link<D>, y: &[Row<D>]) -> Vector<D> {
        let a = self.wall(link);
        a * (link.weight * (along(&y[i], link, &a) + y[link.other as usize].share()))
    }

    /// Share β that corresponds to the area vector of a wall entry.
    pub(super) fn share(&self, link: &Link<D>, area: &Vector<D>) -> f64 {
        let a = self.wall(link);
        area.dot(&a) / a.norm_squared().max(f64::MIN_POSITIVE)
    }

    /// The product (A W Aᵀ + ε) y in the row of wall `w`.
    pub(super) fn wall_row(&self, w: usize, y: &[Row<D>]) -> f64 {
        let share = |s: &Sharer| {
            let link = self.link(s);
            self.share(&link, &self.wall_change(s.i as usize, &link, y))
        };
        self.sharers[w].iter().map(share).sum()
    }

    /// Updates the shares for the multipliers `y` of the particles; the multiplier of each wall makes its shares sum to
    /// one.
    pub(super) fn share_out(&mut self, y: &[Row<D>]) {
        let mut sharers = std::mem::take(&mut self.sharers);
        sweep_slots(&mut sharers, |_, all| {
            let (mut missing, mut weight) = (1.0, 0.0);
            for s in all.iter_mut() {
                let link = self.link(s);
                s.share += link.weight * along(&y[s.i as usize], &link, &self.wall(&link));
                (missing, weight) = (missing - s.share, weight + link.weight);
            }
            all.iter_mut().for_each(|s| s.share += missing * self.link(s).weight / weight);
        });
        self.sharers = sharers;
    }

    /// The wall faces of the fluid particles, in the order of their entries.
    pub(super) fn wall_faces(&self) -> Vec<WallFace<D>> {
        let mut all: Vec<&Sharer> = self.sharers.iter().flatten().collect();
        all.sort_unstable_by_key(|s| s.p);
        let face = |s: &&Sharer| {
            let area = self.wall(&self.link(s)) * s.share;
            WallFace { i: s.i, wall: self.links.end(s.p as usize) as u32, area }
        };
        all.iter().map(face).collect()
    }
}

/// Component of the field of `own` along the area vector at the other end of an entry.
pub(super) fn along<const D: usize>(own: &Row<D>, link: &Link<D>, area: &Vector<D>) -> f64 {
    let field = own.at(&part_of(&link.offset, 1.0));
    (0..D).map(|d| f64::from(field[d]) * area[d]).sum()
}
