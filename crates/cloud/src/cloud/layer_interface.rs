//! Neighbours in the layers, and where layers meet the background.
//!
//! In the layers a particle sees the cross (i ± 1, k), (i, k ± 1), in space all columns beside its own; where the adjacent column is one
//! layer shorter, its last particle instead. The last two layers, and every layer of a column beside a sharp edge, see the background as well:
//! everything in sight within ρ (h_i + h_j)/2, which includes the last two layers of columns on other walls that face them.
use super::layers::Beside;
use super::neighbours::{IDENTITY, Search, Seen};
use crate::math::Vector;

/// Columns on walls whose normals differ less (cosine) do not see one another.
const OTHER_WALL: f64 = 0.5;
/// Factor on the radius where a last layer sees nothing above it.
const WIDER: f64 = 1.5;
/// Rise, in layers, of what counts as above.
const HIGHER: f64 = 0.5;
/// Layers that a wall fit uses.
const FIT_LAYERS: usize = 3;
/// Columns that a wall fit uses, in 2-D, and at least in 3-D.
const FIT_COLUMNS: [usize; 2] = [3, 5];
/// Fewest particles of a wall fit in the layers: a quadratic one with three rows to spare.
const FIT_LEAST: [usize; 2] = [8, 12];

impl<const D: usize> Search<'_, D> {
    /// True when particle `i` lies in a layer, or is the interface particle under one.
    pub(super) fn in_layers(&self, i: usize) -> bool {
        self.particles().layers.slot(i).is_some()
    }

    /// Everything that particles in layers see and are seen by, sorted.
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

    /// Particle in layer `k` of a column; layer 0 is the interface particle.
    fn member(&self, c: usize, k: usize) -> Option<usize> {
        let p = self.particles();
        match k.checked_sub(1) {
            None => Some(p.n_fluid + c),
            Some(k) => p.layers.columns[c].particles.get(k).map(|i| *i as usize),
        }
    }

    /// Particle in layer `k` of a column beside another, or the image of it.
    fn member_beside(&self, other: &Beside, k: usize) -> Option<Seen> {
        self.member(other.column as usize, k).map(|i| (i as u32, other.image.unwrap_or(IDENTITY)))
    }

    /// The particles beside, below and above layer `k` of a column.
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

    /// Whether anything lies above a particle in the last layer.
    fn sees_above(&self, i: usize, seen: &[Seen]) -> bool {
        let p = self.particles();
        let rise = |s: &Seen| self.offset(i, &p.x[i], *s)[D - 1];
        seen.iter().any(|s| rise(s) > HIGHER * p.spacing[i])
    }

    /// What particle `i` in column `c` sees beyond its column and those beside it, in a ball `wider` than usual.
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

    /// Whether two particles of columns on walls that face one another may see one another: both in the last two layers, or,
    /// in the two columns beside a sharp edge, one of them there or at the wall.
    fn faces(&self, i: usize, c: usize, (other, layer): (usize, usize), t: u8) -> bool {
        let layers = &self.particles().layers;
        let last = |c: usize, k: usize| k > 0 && k + 2 > layers.count(c);
        let broken = |c: usize| layers.columns[c].open;
        let Some((_, own)) = layers.slot(i) else { return false };
        let normal = self.direction(layers.normal(other), t);
        let (a, b) = (last(c, own), last(other, layer));
        normal.dot(layers.normal(c)) < OTHER_WALL && (a && b || broken(c) && broken(other) && (a || b))
    }

    /// Pairs that a widened row may have: none inside the layers but those a step away.
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

    /// Fluid particles from which the state of the interface particle under column `c` is fitted; too few where the layers
    /// are.
    fn column_cloud(&self, c: usize) -> Vec<Seen> {
        let layers = &self.particles().layers;
        let mut columns = vec![(c, IDENTITY)];
        // those around, and around them beside a sharp edge
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

    /// The fluid that an interface particle takes its state from: its own layers and those beside, else all in front of it.
    pub(super) fn wall_cloud(&self, w: usize, list: &mut Vec<Seen>) {
        let i = w + self.particles().n_fluid;
        let layers = if self.in_layers(i) { self.column_cloud(w) } else { Vec::new() };
        if layers.len() >= FIT_LEAST[D - 2] {
            list.extend(layers);
        } else {
            self.fluid_in_front(i, list);
        }
    }
}
