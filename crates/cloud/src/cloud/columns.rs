//! Construction of the wall layers: columns of particles along the wall normals.
//!
//! All columns advance together, one layer after the other. A column ends where its next particle would
//!
//! - be as far from the previous one as from the adjacent columns, because the layers have become isotropic;
//! - lie more than twice as far from the adjacent columns as the interface particles do (a fan around a convex bend);
//! - lie less than 0.35 times as far from them, measured along the wall (a fold in a concave bend);
//! - come nearer than 0.6 min(Δs, 2Δn) to a column that is not adjacent, or nearer to another wall than to its own;
//! - leave the domain.
//!
//! No columns are placed where two walls are less than two spacings apart.
//!
//! Afterwards the columns are shortened until adjacent ones differ by at most one layer. Background particles inside
//! the layers, or too near to them, are removed.
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

/// Layers end where their distance exceeds this multiple of the distance between the particles of one layer.
const ISOTROPIC: f64 = 1.0;
/// Greatest spacing of a layer relative to the spacing of the interface particles (convex bends).
const WIDEST: f64 = 2.0;
/// Smallest spacing of a layer along the wall relative to that of the interface particles (concave bends).
const TIGHTEST: f64 = 0.35;
/// Minimum distance to columns that are not adjacent, as a multiple of min(Δs, 2Δn).
const CLEARANCE: f64 = 0.6;
/// Ratio of the distance to the nearest wall to the height in the column, below which another wall is nearer than the
/// column's own.
const OWN_WALL: f64 = 0.8;
/// A column that keeps at least this fraction of the distance of its foot from a plane of symmetry has its own image as
/// a neighbour.
const LEANING: f64 = 0.9;
/// Minimum distance, in spacings, between a wall and the next one for a column to start.
const ROOM: f64 = 2.0;
/// Height, in spacings, at which the search for the next wall starts.
const LIFT: f64 = 1e-3;
/// Greatest number of layers.
const MAX_LAYERS: usize = 1000;
/// Half-width, in spacings of the column, of the background region that a column replaces.
const HALF_WIDTH: f64 = 0.55;
/// The same half-width for a column that is surrounded by others in 3-D, where columns form triangles.
const HALF_WIDTH_SURROUNDED: f64 = 0.75;
/// Height above the last layer, in spacings, below which background particles are removed.
const ABOVE: f64 = 0.5;
/// Minimum distance, in mean spacings, between a background particle and a particle in a layer.
const APART: f64 = 0.6;
/// A leaf larger than this multiple of the spacing of a layer may be divided into its quarters (octants in 3-D).
const COARSE: f64 = 1.4;
/// Greatest distance, in spacings, at which the image of an interface particle is its neighbour along the wall.
const ACROSS_PLANE: f64 = 1.5;
/// Largest cosine between the normal and the direction to that image.
const ALONG_WALL: f64 = 0.3;

/// Columns over all interface particles, before the fluid particles are numbered.
pub(super) struct Columns<const D: usize> {
    /// Unit vectors along the wall, followed by the normal, for each column.
    pub axes: Vec<[Vector<D>; D]>,
    /// Heights of the layers, common to all columns.
    heights: Vec<f64>,
    /// Number of layers of each column.
    counts: Vec<usize>,
    /// Reason why each column ends.
    ends: Vec<End>,
    beside: Vec<Vec<Beside>>,
    /// True for a column that has no neighbour on one side.
    open: Vec<bool>,
    x: Vec<Vector<D>>,
    /// Reflections and translations of the domain.
    transforms: Vec<Transform<D>>,
}

/// Geometry in which the columns are built.
pub(super) struct LayerContext<'a, const D: usize> {
    /// Surface of the bodies.
    pub surface: &'a Surface<D>,
    /// Background tree.
    pub tree: &'a Tree<D>,
    /// The domain and its sides.
    pub layout: &'a Layout<D>,
    /// Reflections and translations of the domain.
    pub transforms: &'a [Transform<D>],
}

impl<const D: usize> Columns<D> {
    /// Builds the columns over the interface particles.
    pub(super) fn grow(placed: &Placed<D>, spec: &WallLayers, context: &LayerContext<'_, D>) -> Self {
        let mut columns = Self::start(placed, context.transforms);
        let n = placed.x.len();
        let most = spec.count.map_or(MAX_LAYERS, |c| c as usize);
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

    /// Columns without layers, with their adjacent columns along the wall.
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

    /// Point of column `w` at the distance `height` from the wall.
    fn at(&self, w: usize, height: f64) -> Vector<D> {
        self.x[w] + self.axes[w][D - 1] * height
    }

    /// Offset from column `w` to the adjacent column `b` at a height.
    fn step(&self, w: usize, b: &Beside, height: f64) -> Vector<D> {
        let there = self.at(b.column as usize, height);
        let there = b.image.map_or(there, |t| self.transforms[usize::from(t)].point(&there));
        there - self.at(w, height)
    }

    /// Mean distance from column `w` to the adjacent columns at a height.
    fn spacing(&self, w: usize, height: f64) -> f64 {
        let steps = self.beside[w].iter().map(|b| self.step(w, b, height).norm());
        steps.sum::<f64>() / self.beside[w].len().max(1) as f64
    }

    /// True when column `w` has an adjacent column and the next wall is far enough away.
    fn may_start(&self, w: usize, surface: &Surface<D>) -> bool {
        let h = self.spacing(w, 0.0);
        !self.beside[w].is_empty() && !surface.crosses(&self.at(w, LIFT * h), &self.at(w, ROOM * h))
    }

    /// Reason why column `w` ends below this height; `None` when the next particle keeps its distance from its own
    /// wall, from the adjacent columns and from the sides of the domain.
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

    /// True when `x` lies inside the domain: at least `margin` from closed sides towards which the column leans from
    /// its foot, and more than one cell from open sides.
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

    /// True when the particle of column `w` at a height keeps its distance from all columns that are not adjacent.
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

    /// Shortens the columns until adjacent ones differ by at most one layer.
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

    /// Moves the border between adjacent interface particles below layers from the outline to the middle of their chord
    /// (2-D). The faces of the layers above lie on chords, and a thin layer would not cover the sagitta of the arc. The
    /// sum of the area vectors does not change. In 3-D the area vectors keep their values; the conservative
    /// coefficients close the remaining gap.
    pub(super) fn straighten(&self, placed: &mut Placed<D>) {
        for w in (0..self.counts.len()).filter(|_| D == 2) {
            let Some(ahead) = self.beside[w].iter().find(|b| b.step[0] > 0.0) else { continue };
            let next = ahead.column as usize;
            if self.counts[w] + self.counts[next] == 0 {
                continue;
            }
            let shift = self.x[w] + self.step(w, ahead, 0.0) * 0.5 - placed.end[w];
            let (along, normal) = (&self.axes[w][0], self.axes[w][D - 1]);
            // the chord along the outline, rotated by a right angle in the sense that rotates `along` to the normal
            let turn = along[0] * normal[1] - along[1] * normal[0];
            let mut area = Vector::ZERO;
            (area[0], area[1]) = (-turn * shift[1], turn * shift[0]);
            placed.interface[w].area += area;
            if next != w {
                placed.interface[next].area -= area;
            }
        }
    }

    /// All particles of the layers: (column, layer counted from 1, position, spacing along the wall, height).
    fn each(&self) -> impl Iterator<Item = (usize, usize, Vector<D>, f64, f64)> + '_ {
        (0..self.counts.len()).flat_map(move |w| {
            (1..=self.counts[w]).map(move |k| {
                let height = self.heights[k - 1];
                (w, k, self.at(w, height), self.spacing(w, height), height)
            })
        })
    }

    /// Positions of the fluid particles in the layers.
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

    /// Removes the leaves that the layers replace. A leaf that is only too near to a layer finer than itself is
    /// replaced by those of its quarters that keep the minimum distance.
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

    /// The regions of the background that the particles of the columns, interface particles included, replace.
    fn cells(&self) -> impl Iterator<Item = Cell<D>> + '_ {
        let walls =
            (0..self.counts.len()).filter(|w| self.counts[*w] > 0).map(|w| (w, 0, self.x[w], self.spacing(w, 0.0)));
        walls.chain(self.each().map(|(w, k, x, h, _)| (w, k, x, h))).map(|(w, k, x, spacing)| {
            let height = |k: usize| if k == 0 { 0.0 } else { self.heights[k - 1] };
            let above = if k == self.counts[w] { ABOVE * spacing } else { height(k + 1) - height(k) };
            let width = spacing * if D == 2 || self.open[w] { HALF_WIDTH } else { HALF_WIDTH_SURROUNDED };
            Cell { x, axes: self.axes[w], spacing, width, above }
        })
    }

    /// The finished columns; `numbers` are the indices of the fluid particles in the order of [`sites`](Self::sites).
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

/// The region that a particle of a column replaces: a box from its height up to the next layer.
struct Cell<const D: usize> {
    x: Vector<D>,
    axes: [Vector<D>; D],
    spacing: f64,
    width: f64,
    above: f64,
}

/// Position of a leaf relative to a cell of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// The centre of the leaf lies in the box.
    Inside,
    /// The leaf lies outside the box but too near to the particle.
    Near,
    /// The leaf keeps the minimum distance.
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

/// Axes of the columns over an outline (2-D), with the adjacent columns of each.
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

/// At a plane of symmetry, the end of an outline continues with its own image.
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

/// The parts of a leaf that is halved along every axis.
fn quarters<const D: usize>(leaf: &Leaf<D>) -> Vec<Leaf<D>> {
    let part = |c: u32| {
        let side = Vector::from_fn(|d| if c >> d & 1 == 1 { 0.25 } else { -0.25 });
        Leaf { centre: leaf.centre + side * leaf.size, size: 0.5 * leaf.size, level: leaf.level + 1, ..*leaf }
    };
    (0..1 << D).map(part).collect()
}
