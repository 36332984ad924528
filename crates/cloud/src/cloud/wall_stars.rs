//! Adjacent columns of wall layers in 3-D.
//!
//! The feet of the columns are scattered over the surface. The feet around each foot are mapped to its tangent plane,
//! preserving distance and direction, as long as their normals differ by less than 60°. Adjacent are those whose
//! bisectors bound the Voronoi cell of the foot in this plane. Adjacency is made mutual: the result is a Delaunay
//! triangulation of the surface, found locally. A cell that is unbounded on one side lies at a sharp edge.
use std::collections::BTreeMap;

use super::Transform;
use super::grid::Grid;
use super::interface::Placed;
use super::layers::{Around, Beside};
use crate::math::Vector;
use crate::math::parallel::sweep;
use crate::math::square::frame_of;

/// Search radius in spacings: the cells of Lloyd's partition have radii below 0.8, and spacings may double.
const REACH: f64 = 2.6;
/// Feet whose normals have a cosine below this value are separated by a sharp edge.
const SMOOTH: f64 = 0.5;
/// Sides of a cell shorter than this fraction of the spacing connect no feet: four feet on a circle.
const SHORT: f64 = 0.1;
/// Marks the sides of the initial square from which a cell is cut.
const OPEN: usize = usize::MAX;

/// The foot of a column, or its image.
struct Foot<const D: usize> {
    x: Vector<D>,
    normal: Vector<D>,
    column: u32,
    image: Option<u8>,
}

/// Axes of the columns over scattered feet, and the adjacent columns of each.
pub(super) fn stars<const D: usize>(placed: &Placed<D>, transforms: &[Transform<D>]) -> Around<D> {
    let axes: Vec<[Vector<D>; D]> = placed.interface.iter().map(|w| frame_of(&w.normal)).collect();
    let feet = feet(placed, transforms);
    let mut grids: BTreeMap<u64, (f64, Grid<D>)> = BTreeMap::new();
    for h in &placed.spacing {
        grids.entry(h.to_bits()).or_insert_with(|| (*h, Grid::new(REACH * h)));
    }
    for (foot, k) in feet.iter().zip(0..) {
        grids.values_mut().for_each(|g| g.1.insert(&foot.x, k));
    }
    let mut found = vec![(Vec::new(), false); placed.x.len()];
    sweep(&mut found, |w| {
        let h = placed.spacing[w];
        star(&feet, w, &axes[w], (h, &grids[&h.to_bits()].1))
    });
    answer(&mut found, placed, &axes, transforms);
    for (beside, _) in &mut found {
        let length = |b: &Beside| b.step[0].hypot(b.step[1]);
        let mean = beside.iter().map(length).sum::<f64>() / beside.len().max(1) as f64;
        beside.iter_mut().for_each(|b| b.step = b.step.map(|s| s / mean));
    }
    (axes, found)
}

/// All feet and their images.
fn feet<const D: usize>(placed: &Placed<D>, transforms: &[Transform<D>]) -> Vec<Foot<D>> {
    let own = placed.x.iter().zip(&placed.interface).zip(0..);
    let own = own.map(|((x, w), column)| Foot { x: *x, normal: w.normal, column, image: None });
    let images = transforms.iter().zip(0..).flat_map(|(t, image)| {
        let all = placed.x.iter().zip(&placed.interface).zip(0..);
        all.map(move |((x, w), column)| Foot {
            x: t.point(x),
            normal: t.direction(&w.normal),
            column,
            image: Some(image),
        })
    });
    own.chain(images).collect()
}

/// Adjacent columns of foot `w` with the offsets to them, and whether its cell is unbounded.
fn star<const D: usize>(
    feet: &[Foot<D>],
    w: usize,
    axes: &[Vector<D>; D],
    (h, grid): (f64, &Grid<D>),
) -> (Vec<Beside>, bool) {
    let own = &feet[w];
    let mut around = Vec::new();
    grid.near(&own.x, REACH * h, |k| {
        let foot = &feet[k as usize];
        let r = (foot.x - own.x).norm();
        if k as usize != w && r < REACH * h && r > 0.0 && foot.normal.dot(&own.normal) > SMOOTH {
            around.push((r, k));
        }
    });
    around.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let ways: Vec<[f64; 2]> = around.iter().map(|(_, k)| way(&(feet[*k as usize].x - own.x), axes)).collect();
    let mut cell = VoronoiCell::square(0.5 * REACH * h);
    ways.iter().enumerate().for_each(|(k, p)| cell.cut(*p, k));
    let sides = cell.sides(SHORT * h);
    let beside = |k: &usize| {
        let foot = &feet[around[*k].1 as usize];
        Beside { column: foot.column, image: foot.image, step: ways[*k] }
    };
    (sides.iter().filter(|k| **k != OPEN).map(beside).collect(), sides.contains(&OPEN))
}

/// An offset mapped to the tangent plane, with its length preserved.
fn way<const D: usize>(d: &Vector<D>, axes: &[Vector<D>; D]) -> [f64; 2] {
    let [a, b] = [d.dot(&axes[0]), d.dot(&axes[1])];
    let flat = a.hypot(b).max(f64::MIN_POSITIVE);
    [a, b].map(|c| c * d.norm() / flat)
}

/// Makes adjacency mutual.
fn answer<const D: usize>(
    found: &mut [(Vec<Beside>, bool)],
    placed: &Placed<D>,
    axes: &[[Vector<D>; D]],
    transforms: &[Transform<D>],
) {
    let back = |image: u8| transforms.iter().position(|t| t.undoes(&transforms[usize::from(image)])).map(|t| t as u8);
    for w in 0..found.len() {
        for b in found[w].0.clone() {
            let image = match b.image {
                None => None,
                Some(t) => match back(t) {
                    None => continue,
                    found => found,
                },
            };
            let list = &mut found[b.column as usize].0;
            if list.iter().any(|o| o.column as usize == w && o.image == image) {
                continue;
            }
            let here = image.map_or(placed.x[w], |t| transforms[usize::from(t)].point(&placed.x[w]));
            let step = way(&(here - placed.x[b.column as usize]), &axes[b.column as usize]);
            list.push(Beside { column: w as u32, image, step });
        }
    }
}

/// A convex polygon around the origin, given by its corners; each has the label of the side from there to the next
/// corner.
struct VoronoiCell {
    corners: Vec<([f64; 2], usize)>,
}

impl VoronoiCell {
    /// The square of this half-width.
    fn square(half: f64) -> Self {
        let corners = [[-half, -half], [half, -half], [half, half], [-half, half]];
        Self { corners: corners.map(|c| (c, OPEN)).to_vec() }
    }

    /// Cuts off the region that is nearer to `p` than to the origin.
    fn cut(&mut self, p: [f64; 2], label: usize) {
        let beyond = |x: &[f64; 2]| x[0] * p[0] + x[1] * p[1] - 0.5 * (p[0] * p[0] + p[1] * p[1]);
        let mut left = Vec::with_capacity(self.corners.len() + 1);
        for (k, (a, bound)) in self.corners.iter().enumerate() {
            let b = &self.corners[(k + 1) % self.corners.len()].0;
            let (from, to) = (beyond(a), beyond(b));
            let crossing = || {
                let f = from / (from - to);
                [a[0] + f * (b[0] - a[0]), a[1] + f * (b[1] - a[1])]
            };
            if from <= 0.0 {
                left.push((*a, *bound));
                if to > 0.0 {
                    left.push((crossing(), label));
                }
            } else if to <= 0.0 {
                left.push((crossing(), *bound));
            }
        }
        self.corners = left;
    }

    /// Labels of the sides longer than `length`, in order around the polygon.
    fn sides(&self, length: f64) -> Vec<usize> {
        let n = self.corners.len();
        let long = |k: &usize| {
            let (a, b) = (self.corners[*k].0, self.corners[(k + 1) % n].0);
            (b[0] - a[0]).hypot(b[1] - a[1]) > length
        };
        let mut all: Vec<usize> = (0..n).filter(long).map(|k| self.corners[k].1).collect();
        all.dedup();
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hexagon_has_six_sides_and_what_lies_behind_them_none() {
        let mut cell = VoronoiCell::square(2.0);
        let at = |k: usize, r: f64| {
            let angle = std::f64::consts::FRAC_PI_3 * k as f64;
            [r * angle.cos(), r * angle.sin()]
        };
        (0..6).for_each(|k| cell.cut(at(k, 1.0), k));
        (0..6).for_each(|k| cell.cut(at(k, 2.0), 6 + k));
        let mut sides = cell.sides(1e-6);
        sides.sort_unstable();
        assert_eq!(sides, [0, 1, 2, 3, 4, 5]);
    }

    #[test]
    fn a_cell_without_a_neighbour_on_a_side_is_open() {
        let mut cell = VoronoiCell::square(1.3);
        for (k, p) in [[1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]].into_iter().enumerate() {
            cell.cut(p, k);
        }
        assert!(cell.sides(0.1).contains(&OPEN));
        cell.cut([0.0, -1.0], 3);
        assert!(!cell.sides(0.1).contains(&OPEN));
    }
}
