//! Neighbour lists of the particles in wall layers, and at the interface between layers and background.
//!
//! Inside the layers, a particle has the neighbours (i ± 1, k) and (i, k ± 1), in 3-D those in all adjacent columns;
//! where the adjacent column is one layer shorter, its last particle instead. The particles of the last two layers, and
//! of every layer of a column at a sharp edge, have background neighbours as well: all visible particles within ρ (h_i
//! + h_j)/2, which include the last two layers of columns on opposite walls.
use super::layers::Beside;
use super::neighbours::{IDENTITY, Search, Seen};
use crate::math::Vector;

/// Columns on walls whose normals are more similar than this cosine are not neighbours.
const OTHER_WALL: f64 = 0.5;
/// Factor on the search radius where a particle of the last layer has no neighbour above it.
const WIDER: f64 = 1.5;
/// Height, in layers, above which a neighbour counts as lying above a particle.
const HIGHER: f64 = 0.5;
/// Number of layers that a wall fit uses.
const FIT_LAYERS: usize = 3;
/// Number of columns that a wall fit uses in 2-D, and at least in 3-D.
const FIT_COLUMNS: [usize; 2] = [3, 5];
/// Minimum number of particles of a wall fit inside the layers: a quadratic fit with three rows to spare.
const MIN_FIT: [usize; 2] = [8, 12];

impl<const D: usize> Search<'_, D> {
    /// True when particle `i` lies in a layer, or is the interface particle of a column with layers.
    pub(super) fn in_layers(&self, i: usize) -> bool {
        self.particles().layers.slot(i).is_some()
    }

    /// All neighbour pairs of the particles in layers, in both directions, sorted.
    pub(super) fn links(&self) -> Vec<(u32, Seen)> {
        let layers = &self.particles().layers;
        let mut links = Vec::new();
        for c in (0..layers.columns.len()).filter(|c| layers.count(*c) > 0) {
            for k in 0..=layers.count(c) {
                let Some(i) = self.member(c, k) else { continue };
                let mut seen = self.cross(c, k);
                if layers.is_rim(c, k) {
                    self.beyond(c, i, 1.0, &mut seen);
                }
                if k == layers.count(c) && !self.sees_above(i, &seen) {
                    self.beyond(c, i, WIDER, &mut seen);
                }
                links.extend(seen.iter().map(|s| (i as u32, *s)));
                links.extend(seen.iter().filter_map(|s| self.seen_from(i, *s)));
            }
        }
        links.sort_unstable();
        links.dedup();
        links
    }

    /// Particle of layer `k` of column `c`; layer 0 is the interface particle. `None` when the column has no such
    /// layer.
    fn member(&self, c: usize, k: usize) -> Option<usize> {
        let p = self.particles();
        match k.checked_sub(1) {
            None => Some(p.n_fluid + c),
            Some(k) => p.layers.columns[c].particles.get(k).map(|i| *i as usize),
        }
    }

    /// Particle of layer `k` of an adjacent column, or its image.
    fn member_beside(&self, other: &Beside, k: usize) -> Option<Seen> {
        self.member(other.column as usize, k).map(|i| (i as u32, other.image.unwrap_or(IDENTITY)))
    }

    /// Neighbours of layer `k` of column `c` in the adjacent columns, below and above.
    fn cross(&self, c: usize, k: usize) -> Vec<Seen> {
        let mut seen: Vec<Seen> = [k.checked_sub(1), Some(k + 1)]
            .into_iter()
            .flatten()
            .filter_map(|k| self.member(c, k))
            .map(|i| (i as u32, IDENTITY))
            .collect();
        let beside = |b: &Beside| self.member_beside(b, k).or_else(|| self.member_beside(b, k.checked_sub(1)?));
        seen.extend(self.particles().layers.columns[c].beside.iter().filter_map(beside));
        seen
    }

    /// True when one of the neighbours lies above particle `i` of the last layer.
    fn sees_above(&self, i: usize, seen: &[Seen]) -> bool {
        let p = self.particles();
        let rise = |s: &Seen| self.offset(i, &p.x[i], *s)[D - 1];
        seen.iter().any(|s| rise(s) > HIGHER * p.spacing[i])
    }

    /// Adds the neighbours of particle `i` in column `c` outside its own and the adjacent columns, within `wider` times
    /// the usual radius.
    fn beyond(&self, c: usize, i: usize, wider: f64, seen: &mut Vec<Seen>) {
        let layers = &self.particles().layers;
        self.candidates(i, wider * self.ball(i), |k, t| {
            let visible = match layers.slot(k as usize) {
                None => true,
                Some((other, layer)) => self.faces(i, c, (other, layer), t),
            };
            if visible && self.sees_within_radius(i, k as usize, t, wider) {
                seen.push((k, t));
            }
        });
    }

    /// Whether two particles of columns on opposite walls may be neighbours: both must lie in the last two layers;
    /// beside a sharp edge it suffices that one of them lies there or at the wall.
    fn faces(&self, i: usize, c: usize, (other, layer): (usize, usize), t: u8) -> bool {
        let layers = &self.particles().layers;
        let last = |c: usize, k: usize| k > 0 && k + 2 > layers.count(c);
        let broken = |c: usize| layers.columns[c].open;
        let Some((_, own)) = layers.slot(i) else { return false };
        let normal = self.direction(layers.normal(other), t);
        let (a, b) = (last(c, own), last(other, layer));
        normal.dot(layers.normal(c)) < OTHER_WALL && (a && b || broken(c) && broken(other) && (a || b))
    }

    /// Whether a pair may be added when a neighbour list is enlarged: inside the layers only pairs one step apart may.
    pub(super) fn may_join(&self, i: usize, (k, t): Seen, d: &Vector<D>) -> bool {
        let layers = &self.particles().layers;
        let inner = |i: usize| layers.slot(i).is_some_and(|(c, k)| !layers.is_rim(c, k));
        if !self.in_layers(i) && !self.in_layers(k as usize) {
            return true;
        }
        let source = super::layers::Source { index: k as usize, image: t != IDENTITY };
        let both = self.in_layers(i) && self.in_layers(k as usize);
        !inner(i) && !inner(k as usize) && (!both || layers.steps(i, source, d).is_some_and(|s| s.1.abs() <= 1))
    }

    /// Fluid particles of the layers from which the state of the interface particle of column `c` is fitted; too few
    /// where the layers end.
    fn column_cloud(&self, c: usize) -> Vec<Seen> {
        let layers = &self.particles().layers;
        let mut columns = vec![(c, IDENTITY)];
        // the adjacent columns; beside a sharp edge also those adjacent to them
        let mut ring = 0..1;
        while columns.len() < FIT_COLUMNS[D - 2] && !ring.is_empty() {
            for k in ring.clone() {
                let (column, image) = columns[k];
                for b in layers.columns[column].beside.iter().filter(|_| image == IDENTITY) {
                    let there = (b.column as usize, b.image.unwrap_or(IDENTITY));
                    let room = D > 2 || columns.len() < FIT_COLUMNS[0];
                    if room && !columns.contains(&there) {
                        columns.push(there);
                    }
                }
            }
            ring = ring.end..columns.len();
        }
        let of = |(c, t): &(usize, u8)| {
            let particles = &layers.columns[*c].particles;
            particles.iter().take(FIT_LAYERS).map(|i| (*i, *t)).collect::<Vec<_>>()
        };
        columns.iter().flat_map(of).collect()
    }

    /// Adds the fluid particles from which the state of interface particle `w` is fitted: those of its own and the
    /// adjacent columns, or all visible ones in front of it.
    pub(super) fn wall_cloud(&self, w: usize, list: &mut Vec<Seen>) {
        let i = w + self.particles().n_fluid;
        let layers = if self.in_layers(i) { self.column_cloud(w) } else { Vec::new() };
        if layers.len() >= MIN_FIT[D - 2] {
            list.extend(layers);
        } else {
            self.fluid_in_front(i, list);
        }
    }
}
