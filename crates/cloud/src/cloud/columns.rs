//! Growing columns of particles on the wall normals.
//!
//! All columns advance together, one layer after the other, and a column stops for good where its next particle would
//!
//! - be as far from the last one as from those beside it: the layers have become isotropic;
//! - lie more than twice as far from those beside it as the interface particles do: a fan around a convex bend;
//! - lie less than 0.35 times as far from them, measured along the wall: a fold in a concave bend;
//! - come nearer than 0.6 min(Δs, 2Δn) to a column that is not adjacent, or nearer to another wall than to its own;
//! - leave the domain.
//!
//! Where less than two spacings lie between two walls there are no columns at all.
//!
//! Then the columns are cut until neighbours differ by one layer at most. Particles of the background inside the layers, or
//! too near to them, are left out.
use super::Transform;
use super::grid::Grid;
use super::interface::Placed;
use super::layers::{Around, Beside, Column, End};
use super::layout::Layout;
use super::neighbours::NEAR;
use super::particles::ParticleSite;
use super::tree::{Leaf, Tree};
use super::wall_stars::stars;
use crate::case::{Side, WallLayers};
use crate::geometry::Surface;
use crate::math::{Bounds, Vector};

/// Layers stop where they are this many times as far apart as the particles of a layer.
const ISOTROPIC: f64 = 1.0;
/// Widest fan: spacing of a layer over that of the interface particles.
const WIDEST: f64 = 2.0;
/// Tightest fold: spacing of a layer along the wall over that of the interface particles.
const TIGHTEST: f64 = 0.35;
/// Clearance from columns that are not adjacent, in min(Δs, 2Δn).
const CLEARANCE: f64 = 0.6;
/// Distance to the nearest wall over the height in a column, below which another wall is nearer.
const OWN_WALL: f64 = 0.8;
/// A column that keeps this part of the distance of its foot from a plane of symmetry stands beside its image.
const LEANING: f64 = 0.9;
/// A column needs this many spacings between its wall and the next.
const ROOM: f64 = 2.0;
/// Height, in spacings, at which the look for the next wall begins.
const LIFT: f64 = 1e-3;
/// Most layers.
const MOST: usize = 1000;
/// Half-width of the part of the background that a column takes the place of, in its spacings; of one amid others in space: there
/// columns stand around triangles.
const HALF_WIDTH: f64 = 0.55;
const AMID: f64 = 0.75;
/// Height above the last layer, in spacings, up to which the background is left out.
const ABOVE: f64 = 0.5;
/// Smallest distance of a background particle to one in a layer, in mean spacings.
const APART: f64 = 0.6;
/// A leaf larger than this many spacings of a layer may be cut in quarters.
const COARSE: f64 = 1.4;
/// Distance to its own image, in spacings, up to which an interface particle has that for a neighbour.
const ACROSS_PLANE: f64 = 1.5;
/// Largest cosine between the normal and the way to that image.
const ALONG_WALL: f64 = 0.3;

/// Columns over all interface particles, before the fluid particles have numbers.
pub(super) struct Columns<const D: usize> {
    /// Directions along the wall and normal.
    pub axes: Vec<[Vector<D>; D]>,
    /// Heights of the layers, the same for all columns.
    heights: Vec<f64>,
    /// Number of layers of each column.
    counts: Vec<usize>,
    /// Why each column ends there.
    ends: Vec<End>,
    beside: Vec<Vec<Beside>>,
    /// Whether one is missing on a side.
    open: Vec<bool>,
    x: Vec<Vector<D>>,
    /// Reflections and shifts of the domain.
    transforms: Vec<Transform<D>>,
}

/// What columns grow in.
pub(super) struct LayerContext<'a, const D: usize> {
    /// The bodies.
    pub surface: &'a Surface<D>,
    /// The background.
    pub tree: &'a Tree<D>,
    /// The box and its sides.
    pub layout: &'a Layout<D>,
    /// Its reflections and shifts.
    pub transforms: &'a [Transform<D>],
}

impl<const D: usize> Columns<D> {
    /// Grows columns over the interface particles.
    pub(super) fn grow(placed: &Placed<D>, spec: &WallLayers, context: &LayerContext<'_, D>) -> Self {
        let mut columns = Self::start(placed, context.transforms);
        let n = placed.x.len();
        let most = spec.count.map_or(MOST, |c| c as usize);
        let mut active: Vec<bool> = (0..n).map(|w| columns.may_start(w, context.surface)).collect();
        (0..n).filter(|w| !active[*w]).for_each(|w| columns.ends[w] = End::Meeting);
        let bin = placed.spacing.iter().fold(0.0, |m: f64, h| m.max(*h)).max(f64::MIN_POSITIVE);
        let mut grid = Grid::new(bin);
        let mut taken: Vec<(u32, Vector<D>)> = Vec::new();
        columns.x.iter().zip(0..).for_each(|(x, w)| {
            grid.insert(x, taken.len() as u32);
            taken.push((w, *x));
        });
        let (mut height, mut thickness) = (0.0, spec.first.0);
        while columns.heights.len() < most && active.iter().any(|a| *a) {
            height += thickness;
            for w in (0..n).filter(|w| active[*w]).collect::<Vec<_>>() {
                match columns.end_at(w, (height, thickness), context) {
                    Some(end) => (active[w], columns.ends[w]) = (false, end),
                    None => {
                        grid.insert(&columns.at(w, height), taken.len() as u32);
                        taken.push((w as u32, columns.at(w, height)));
                    }
                }
            }
            let free = |w: usize| columns.is_free(w, (height, thickness), &grid, &taken);
            let blocked: Vec<usize> = (0..n).filter(|w| active[*w] && !free(*w)).collect();
            blocked.into_iter().for_each(|w| (active[w], columns.ends[w]) = (false, End::Meeting));
            columns.heights.push(height);
            (0..n).filter(|w| active[*w]).for_each(|w| columns.counts[w] += 1);
            thickness *= spec.growth;
        }
        columns.cut();
        columns
    }

    /// Interface particles with their neighbours along the wall, no layers yet.
    fn start(placed: &Placed<D>, transforms: &[Transform<D>]) -> Self {
        let n = placed.x.len();
        let (axes, around) = match D {
            2 => outline(placed, transforms),
            _ => stars(placed, transforms),
        };
        let (beside, open) = around.into_iter().unzip();
        Self {
            axes,
            heights: Vec::new(),
            counts: vec![0; n],
            ends: vec![End::Planned; n],
            beside,
            open,
            x: placed.x.clone(),
            transforms: transforms.to_vec(),
        }
    }

    /// The point of column `w` at a height.
    fn at(&self, w: usize, height: f64) -> Vector<D> {
        self.x[w] + self.axes[w][D - 1] * height
    }

    /// Offset from column `w` to one beside it, at a height.
    fn step(&self, w: usize, b: &Beside, height: f64) -> Vector<D> {
        let there = self.at(b.column as usize, height);
        let there = b.image.map_or(there, |t| self.transforms[usize::from(t)].point(&there));
        there - self.at(w, height)
    }

    /// Mean distance to the adjacent columns at a height.
    fn spacing(&self, w: usize, height: f64) -> f64 {
        let steps = self.beside[w].iter().map(|b| self.step(w, b, height).norm());
        steps.sum::<f64>() / self.beside[w].len().max(1) as f64
    }

    /// Whether column `w` has one beside it, and room before the next wall.
    fn may_start(&self, w: usize, surface: &Surface<D>) -> bool {
        let h = self.spacing(w, 0.0);
        !self.beside[w].is_empty() && !surface.crosses(&self.at(w, LIFT * h), &self.at(w, ROOM * h))
    }

    /// Why column `w` ends before a particle at a height; `None` when that keeps its distance from its own wall, the
    /// adjacent columns and the sides.
    fn end_at(&self, w: usize, (height, thickness): (f64, f64), context: &LayerContext<'_, D>) -> Option<End> {
        let x = self.at(w, height);
        let h = self.spacing(w, height);
        let along =
            |b: &Beside, d: &Vector<D>| -> f64 { (0..D - 1).map(|a| b.step[a] * d.dot(&self.axes[w][a])).sum() };
        let steps = |b: &Beside| (*b, self.step(w, b, 0.0), self.step(w, b, height));
        let wide = |(_, d0, d): &(Beside, Vector<D>, Vector<D>)| d.norm() > WIDEST * d0.norm();
        let tight = |(b, d0, d): &(Beside, Vector<D>, Vector<D>)| along(b, d) < TIGHTEST * along(b, d0);
        let steps: Vec<_> = self.beside[w].iter().map(steps).collect();
        if thickness > ISOTROPIC * h {
            Some(End::Planned)
        } else if steps.iter().any(wide) {
            Some(End::Fan)
        } else if steps.iter().any(tight) {
            Some(End::Fold)
        } else if !self.is_inside((&self.x[w], &x), CLEARANCE * h.min(2.0 * thickness), context) {
            Some(End::Side)
        } else {
            context.surface.nearest(&x, OWN_WALL * height).map(|_| End::Meeting)
        }
    }

    /// Inside the domain, by `margin` from closed sides, where the column leans to them from its foot, and by more than a cell from open
    /// ones.
    fn is_inside(&self, (foot, x): (&Vector<D>, &Vector<D>), margin: f64, context: &LayerContext<'_, D>) -> bool {
        let bounds = context.tree.bounds();
        let cell = 2.0 * context.tree.leaf_at(x).size;
        (0..D).all(|d| {
            let gaps = |x: &Vector<D>| [x[d] - bounds.min[d], bounds.max[d] - x[d]];
            gaps(x).into_iter().zip(gaps(foot)).zip(context.layout.sides[d]).all(|((gap, start), side)| match side {
                Side::Symmetry | Side::Periodic => gap > 0.5 * margin || gap > LEANING * start,
                _ => gap > cell,
            })
        })
    }

    /// Whether the particle of column `w` at a height is clear of columns that are not adjacent.
    fn is_free(&self, w: usize, (height, thickness): (f64, f64), grid: &Grid<D>, taken: &[(u32, Vector<D>)]) -> bool {
        let x = self.at(w, height);
        let reach = CLEARANCE * self.spacing(w, height).min(2.0 * thickness);
        let mut free = true;
        grid.near(&x, reach, |k| {
            let (other, y) = &taken[k as usize];
            let related = *other as usize == w || self.beside[w].iter().any(|b| b.column == *other);
            free &= related || (*y - x).norm_squared() >= reach * reach;
        });
        free
    }

    /// Cuts columns until adjacent ones differ by one layer at most.
    fn cut(&mut self) {
        let mut changed = true;
        while changed {
            changed = false;
            for w in 0..self.counts.len() {
                let beside = self.beside[w].iter().map(|b| b.column as usize);
                let shortest = beside.min_by_key(|b| self.counts[*b]);
                if let Some(b) = shortest.filter(|b| self.counts[*b] + 1 < self.counts[w]) {
                    (self.counts[w], self.ends[w]) = (self.counts[b] + 1, self.ends[b]);
                    changed = true;
                }
            }
        }
    }

    /// Moves the border between adjacent interface particles under layers from the outline to the middle of their chord: the
    /// faces of the layers above stand on chords, and a thin layer would not cover the sagitta. Area vectors keep their sum.
    /// Walls in space keep theirs: the coefficients of the scheme close what is left.
    pub(super) fn straighten(&self, placed: &mut Placed<D>) {
        for w in (0..self.counts.len()).filter(|_| D == 2) {
            let Some(ahead) = self.beside[w].iter().find(|b| b.step[0] > 0.0) else { continue };
            let next = ahead.column as usize;
            if self.counts[w] + self.counts[next] == 0 {
                continue;
            }
            let shift = self.x[w] + self.step(w, ahead, 0.0) * 0.5 - placed.end[w];
            let (along, normal) = (&self.axes[w][0], self.axes[w][D - 1]);
            // a chord along the outline turned by a right angle, the way that takes `along` to the normal
            let turn = along[0] * normal[1] - along[1] * normal[0];
            let mut area = Vector::ZERO;
            (area[0], area[1]) = (-turn * shift[1], turn * shift[0]);
            placed.interface[w].area += area;
            if next != w {
                placed.interface[next].area -= area;
            }
        }
    }

    /// Every particle of the layers: (column, layer counted from 1, position, spacing along the wall, height).
    fn each(&self) -> impl Iterator<Item = (usize, usize, Vector<D>, f64, f64)> + '_ {
        (0..self.counts.len()).flat_map(move |w| {
            (1..=self.counts[w]).map(move |k| {
                let height = self.heights[k - 1];
                (w, k, self.at(w, height), self.spacing(w, height), height)
            })
        })
    }

    /// Seats of the fluid particles in the layers.
    pub(super) fn sites(&self, tree: &Tree<D>) -> Vec<ParticleSite<D>> {
        let site = |(w, k, x, spacing, height): (usize, usize, Vector<D>, f64, f64)| ParticleSite {
            cell: tree.cell_at(&x),
            centre: x,
            spacing,
            node: 0,
            distance: height,
            layer: Some((w as u32, k as u32)),
        };
        self.each().map(site).collect()
    }

    /// Drops the leaves that the layers take the place of. A leaf that is only too near to a layer finer than itself gives
    /// way to those of its quarters that are not.
    pub(super) fn blank(&self, context: &LayerContext<'_, D>, blank: f64, fluid: &mut Vec<(Leaf<D>, f64)>) {
        let tree = context.tree;
        let mut finest = vec![f64::INFINITY; tree.n_nodes()];
        let mut inside = vec![false; tree.n_nodes()];
        for cell in self.cells() {
            let reach = Vector::splat(cell.spacing);
            tree.overlapping(&Bounds { min: cell.x - reach, max: cell.x + reach }, |node| {
                let leaf = tree.leaf(node);
                let place = cell.place(&leaf);
                inside[node as usize] |= place == Place::Inside;
                if place != Place::Clear {
                    finest[node as usize] = finest[node as usize].min(cell.spacing);
                }
            });
        }
        let near = |leaf: &Leaf<D>| finest[leaf.node as usize].is_finite();
        let coarse = |leaf: &&(Leaf<D>, f64)| {
            !inside[leaf.0.node as usize] && near(&leaf.0) && leaf.0.size > COARSE * finest[leaf.0.node as usize]
        };
        let split: Vec<Leaf<D>> = fluid.iter().filter(coarse).flat_map(|(leaf, _)| quarters(leaf)).collect();
        fluid.retain(|(leaf, _)| !near(leaf));
        let cells: Vec<Cell<D>> = self.cells().collect();
        let mut grid = Grid::new(cells.iter().fold(f64::MIN_POSITIVE, |m, c| m.max(c.spacing)));
        cells.iter().zip(0..).for_each(|(c, k)| grid.insert(&c.x, k));
        for leaf in split {
            let mut clear = true;
            grid.near(&leaf.centre, 2.0 * leaf.size, |k| clear &= cells[k as usize].place(&leaf) == Place::Clear);
            let nearest = context.surface.nearest(&leaf.centre, (NEAR + 1.0) * leaf.size);
            let distance = nearest.map_or(f64::INFINITY, |n| n.distance);
            if clear && distance >= blank * leaf.size && !context.surface.inside(&leaf.centre) {
                fluid.push((leaf, distance));
            }
        }
    }

    /// What every particle of a column takes the place of, the interface particle included.
    fn cells(&self) -> impl Iterator<Item = Cell<D>> + '_ {
        let walls =
            (0..self.counts.len()).filter(|w| self.counts[*w] > 0).map(|w| (w, 0, self.x[w], self.spacing(w, 0.0)));
        walls.chain(self.each().map(|(w, k, x, h, _)| (w, k, x, h))).map(|(w, k, x, spacing)| {
            let height = |k: usize| if k == 0 { 0.0 } else { self.heights[k - 1] };
            let above = if k == self.counts[w] { ABOVE * spacing } else { height(k + 1) - height(k) };
            let width = spacing * if D == 2 || self.open[w] { HALF_WIDTH } else { AMID };
            Cell { x, axes: self.axes[w], spacing, width, above }
        })
    }

    /// The columns, given the numbers of the seats' particles in the order of [`sites`](Self::seats).
    pub(super) fn finish(&self, mut numbers: impl Iterator<Item = u32>) -> Vec<Column> {
        let column = |w: usize| Column {
            particles: numbers.by_ref().take(self.counts[w]).collect(),
            heights: self.heights[..self.counts[w]].to_vec(),
            beside: self.beside[w].clone(),
            open: self.open[w],
            end: self.ends[w],
        };
        (0..self.counts.len()).map(column).collect()
    }
}

/// What a particle of a column takes the place of: a box from its height up to the next.
struct Cell<const D: usize> {
    x: Vector<D>,
    axes: [Vector<D>; D],
    spacing: f64,
    width: f64,
    above: f64,
}

/// Where a leaf of the background lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// In the box.
    Inside,
    /// Too near to the particle.
    Near,
    /// Neither.
    Clear,
}

impl<const D: usize> Cell<D> {
    fn place(&self, leaf: &Leaf<D>) -> Place {
        let d = leaf.centre - self.x;
        let up = d.dot(&self.axes[D - 1]);
        let aside = (0..D - 1).map(|a| d.dot(&self.axes[a]).powi(2)).sum::<f64>().sqrt();
        if aside < self.width && 0.0 <= up && up < self.above {
            return Place::Inside;
        }
        if d.norm() < APART * 0.5 * (self.spacing + leaf.size) { Place::Near } else { Place::Clear }
    }
}

/// Axes of the columns over an outline, and what is beside each.
fn outline<const D: usize>(placed: &Placed<D>, transforms: &[Transform<D>]) -> Around<D> {
    let n = placed.x.len();
    let mut beside = vec![[None; 2]; n];
    for (w, next) in placed.next.iter().enumerate().filter(|(_, next)| **next != u32::MAX) {
        beside[w][1] = Some((*next, None));
        beside[*next as usize][0] = Some((w as u32, None));
    }
    let mut axes = Vec::with_capacity(n);
    for w in 0..n {
        let normal = placed.interface[w].normal;
        let mut along = Vector::ZERO;
        (along[0], along[1]) = (normal[1], -normal[0]);
        let ahead = match beside[w] {
            [_, Some((b, _))] => placed.x[b as usize] - placed.x[w],
            [Some((a, _)), None] => placed.x[w] - placed.x[a as usize],
            [None, None] => along,
        };
        let along = if along.dot(&ahead) >= 0.0 { along } else { -along };
        axes.push(std::array::from_fn(|a| if a + 1 < D { along } else { normal }));
    }
    (0..n).for_each(|w| look_across_planes(placed, &axes[w], w, transforms, &mut beside[w]));
    let listed = |sides: [Option<(u32, Option<u8>)>; 2]| {
        let on = |(side, step): (Option<(u32, Option<u8>)>, f64)| {
            side.map(|(column, image)| Beside { column, image, step: [step, 0.0] })
        };
        (sides.into_iter().zip([-1.0, 1.0]).filter_map(on).collect(), sides.contains(&None))
    };
    (axes, beside.into_iter().map(listed).collect())
}

/// An end of an outline at a plane of symmetry goes on with its own image.
fn look_across_planes<const D: usize>(
    placed: &Placed<D>,
    axes: &[Vector<D>; D],
    w: usize,
    transforms: &[Transform<D>],
    beside: &mut [Option<(u32, Option<u8>)>; 2],
) {
    for side in 0..2 {
        if beside[side].is_some() || beside[1 - side].is_none() {
            continue;
        }
        let sign = if side == 1 { 1.0 } else { -1.0 };
        let across = |t: &Transform<D>| {
            let d = t.point(&placed.x[w]) - placed.x[w];
            let r = d.norm();
            t.sign != Vector::splat(1.0)
                && r < ACROSS_PLANE * placed.spacing[w]
                && d.dot(&axes[0]) * sign > 0.0
                && d.dot(&axes[D - 1]).abs() < ALONG_WALL * r
        };
        let image = transforms.iter().position(across).map(|t| t as u8);
        beside[side] = image.map(|t| (w as u32, Some(t)));
    }
}

/// The leaf cut in halves along every axis.
fn quarters<const D: usize>(leaf: &Leaf<D>) -> Vec<Leaf<D>> {
    let part = |c: u32| {
        let side = Vector::from_fn(|d| if c >> d & 1 == 1 { 0.25 } else { -0.25 });
        Leaf { centre: leaf.centre + side * leaf.size, size: 0.5 * leaf.size, level: leaf.level + 1, ..*leaf }
    };
    (0..1 << D).map(part).collect()
}
