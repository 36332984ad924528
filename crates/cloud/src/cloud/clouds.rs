//! The neighbour lists of all particles: searched, made symmetric, repaired, and completed with the ghosts that they
//! need.
use super::neighbours::{IDENTITY, Neighbours, Rows, Search, Seen};
use super::repair::Repair;
use super::{CloudError, Ghost};

/// Result of the neighbour search.
pub struct Clouds<const D: usize> {
    /// Neighbour lists of the fluid and interface particles.
    pub neighbours: Neighbours,
    /// For each interface particle, the fluid particles from which its state is fitted.
    pub wall_stencils: Neighbours,
    /// Ghosts that appear in one of the two lists.
    pub ghosts: Vec<Ghost>,
    /// Repairs of unsuitable neighbour lists.
    pub repair: Repair<D>,
    /// Number of interface particles with too few fluid particles in front of them for an ordinary fit.
    pub n_crevice: usize,
}

impl<const D: usize> Search<'_, D> {
    /// Neighbour lists of all fluid and interface particles, repaired where necessary. Fails where a list cannot be
    /// repaired.
    pub fn clouds(&self) -> Result<Clouds<D>, CloudError> {
        let p = self.particles();
        let links = self.links();
        let mut rows = Rows::new(p.n_rows(), |i, list| {
            self.cloud_of(i, list);
            let own = links.partition_point(|l| (l.0 as usize) < i)..links.partition_point(|l| l.0 as usize <= i);
            list.extend(links[own].iter().map(|l| l.1));
        });
        let unanswered = self.unanswered(&rows);
        rows.remove(&unanswered);
        let walls = Rows::new(p.interface.len(), |w, list| self.wall_cloud(w, list));
        let mut repair = Repair::of(self, &rows, &walls);
        let blind = (0..p.interface.len()).filter(|w| walls.of(*w).is_empty());
        repair
            .refused
            .extend(blind.map(|w| format!("interface particle at {} has no fluid in front of it", p.x[p.n_fluid + w])));
        if !repair.refused.is_empty() {
            return Err(CloudError::Quality(repair.refused));
        }
        let extra = &repair.extra;
        let mut ghosts: Vec<Seen> =
            rows.ghosts().chain(walls.ghosts()).chain(extra.iter().map(|e| e.1).filter(|s| s.1 != IDENTITY)).collect();
        ghosts.sort_unstable();
        ghosts.dedup();
        let first_ghost = p.x.len() as u32;
        let number = |s: &Seen| match s.1 {
            IDENTITY => s.0,
            _ => first_ghost + ghosts.binary_search(s).unwrap_or(0) as u32,
        };
        let n_crevice = (0..p.interface.len()).filter(|w| walls.of(*w).len() <= D).count();
        let (neighbours, wall_stencils) = (rows.pack(extra, number), walls.pack(&[], number));
        let ghosts = ghosts.iter().map(|s| Ghost { source: s.0, transform: s.1 }).collect();
        Ok(Clouds { neighbours, wall_stencils, ghosts, repair, n_crevice })
    }
}
