//! Integration points in a solid, along rays through it.
//!
//! The rays run along the axis in which the body is thinnest, through the Gauss points of each cell of the lattice
//! across it. The points at which a ray enters and leaves the body are exact, so that sharp edges and sections thinner
//! than a cell need no special treatment. Cells that the outline of the body cuts are subdivided.
use super::basis::Axis;
use crate::geometry::Surface;
use crate::math::Vector;

/// An integration point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Position.
    pub(super) x: Vector<3>,
    /// Weight: the volume, or area, that the point represents.
    pub(super) weight: f64,
}

/// Abscissae and weights of the Gauss rule with 2 points on [0, 1].
const TWO: [[f64; 2]; 2] = [[0.211_324_865_405_187_1, 0.5], [0.788_675_134_594_812_9, 0.5]];
/// Abscissae and weights of the Gauss rule with 4 points on [0, 1].
pub(super) const FOUR: [[f64; 2]; 4] = [
    [0.069_431_844_202_973_71, 0.173_927_422_568_726_93],
    [0.330_009_478_207_571_9, 0.326_072_577_431_273_07],
    [0.669_990_521_792_428_1, 0.326_072_577_431_273_07],
    [0.930_568_155_797_026_3, 0.173_927_422_568_726_93],
];
/// Number of subdivisions along each side of a cell that the outline cuts.
const PARTS: usize = 4;

/// The triangles of a surface, sorted into the columns of the lattice that they overlap.
pub(super) struct Rays<'a> {
    surface: &'a Surface<3>,
    axes: &'a [Axis; 3],
    /// Axis of the rays, followed by the two other axes.
    along: usize,
    across: [usize; 2],
    columns: Vec<Vec<u32>>,
}

impl<'a> Rays<'a> {
    pub(super) fn new(surface: &'a Surface<3>, axes: &'a [Axis; 3], along: usize) -> Self {
        let across = [(along + 1) % 3, (along + 2) % 3];
        let [a, b] = across;
        let mut columns = vec![Vec::new(); axes[a].cells() * axes[b].cells()];
        for e in 0..surface.elements.len() as u32 {
            let corners = surface.corners(e);
            let range = |d: usize| {
                let of = |pick: fn(f64, f64) -> f64, start: f64| corners.iter().fold(start, |m, c| pick(m, c[d]));
                axes[d].cell(of(f64::min, f64::INFINITY))..=axes[d].cell(of(f64::max, f64::NEG_INFINITY))
            };
            for i in range(a) {
                range(b).for_each(|j| columns[i * axes[b].cells() + j].push(e));
            }
        }
        Self { surface, axes, along, across, columns }
    }

    /// Number of columns of the lattice.
    pub(super) fn columns(&self) -> usize {
        self.columns.len()
    }

    /// Integration points of the solid in a column.
    pub(super) fn points(&self, column: usize) -> Vec<Point> {
        let whole = self.shoot(column, 1, &FOUR);
        let lengths = whole.iter().map(|(_, parts)| parts.iter().map(|[low, high]| high - low).sum::<f64>());
        let (least, most) = lengths.fold((f64::INFINITY, 0.0f64), |(l, m), x| (l.min(x), m.max(x)));
        let rays = if most > 0.0 && least < 0.5 * most { self.shoot(column, PARTS, &TWO) } else { whole };
        let mut points = Vec::new();
        for (ray, parts) in rays {
            parts.iter().for_each(|part| self.fill(&ray, *part, &mut points));
        }
        points
    }

    /// Adds the integration points between two positions on a ray, cell by cell.
    fn fill(&self, ray: &Point, [low, high]: [f64; 2], points: &mut Vec<Point>) {
        let ends = &self.axes[self.along].ends;
        for cell in self.axes[self.along].cell(low)..=self.axes[self.along].cell(high) {
            let (from, to) = (low.max(ends[cell]), high.min(ends[cell + 1]));
            for [at, weight] in FOUR.iter().filter(|_| to > from) {
                let mut x = ray.x;
                x[self.along] = from + (to - from) * at;
                points.push(Point { x, weight: ray.weight * weight * (to - from) });
            }
        }
    }

    /// Rays through a column with each side divided into `parts`, each with the intervals inside the body.
    fn shoot(&self, column: usize, parts: usize, rule: &[[f64; 2]]) -> Vec<(Point, Vec<[f64; 2]>)> {
        let [a, b] = self.across;
        let nb = self.axes[b].cells();
        let cell = [column / nb, column % nb];
        let along_side = |k: usize| {
            let ends = &self.axes[self.across[k]].ends;
            let (low, size) = (ends[cell[k]], (ends[cell[k] + 1] - ends[cell[k]]) / parts as f64);
            (0..parts)
                .flat_map(move |p| rule.iter().map(move |[x, w]| [low + size * (p as f64 + x), w * size]))
                .collect::<Vec<_>>()
        };
        let (first, second) = (along_side(0), along_side(1));
        let mut rays = Vec::new();
        for [u, wu] in first {
            for [v, wv] in &second {
                let mut x = Vector::ZERO;
                (x[a], x[b]) = (u, *v);
                rays.push((Point { x, weight: wu * wv }, self.inside(column, &x)));
            }
        }
        rays
    }

    /// Intervals of the ray through `x` inside the body: where it has entered more often than left.
    fn inside(&self, column: usize, x: &Vector<3>) -> Vec<[f64; 2]> {
        let crossings = self.columns[column].iter().filter_map(|e| self.crossing(*e, x));
        let mut crossings: Vec<(f64, i32)> = crossings.collect();
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (mut parts, mut depth, mut from) = (Vec::new(), 0, 0.0);
        for (at, step) in crossings {
            if depth == 0 && step > 0 {
                from = at;
            }
            if depth == 1 && step < 0 {
                parts.push([from, at]);
            }
            depth += step;
        }
        parts
    }

    /// Position at which the ray through `x` crosses triangle `e`, and whether it enters (1) or leaves (−1) the body
    /// there.
    fn crossing(&self, e: u32, x: &Vector<3>) -> Option<(f64, i32)> {
        let [a, b] = self.across;
        let ids = self.surface.elements[e as usize].vertices;
        let corners = self.surface.corners(e);
        // the same number for both triangles at an edge, so that a ray through the edge crosses exactly one of them
        let side = |i: usize, j: usize| {
            let (flip, p, q) =
                if ids[i] < ids[j] { (1.0, &corners[i], &corners[j]) } else { (-1.0, &corners[j], &corners[i]) };
            let area = (q[a] - p[a]) * (x[b] - p[b]) - (q[b] - p[b]) * (x[a] - p[a]);
            flip * if area == 0.0 { f64::MIN_POSITIVE } else { area }
        };
        let areas = [side(1, 2), side(2, 0), side(0, 1)];
        let (inside, leaves) = (areas.iter().all(|s| *s < 0.0), areas.iter().all(|s| *s > 0.0));
        if !inside && !leaves {
            return None;
        }
        let whole: f64 = areas.iter().sum();
        let at = (0..3).map(|k| corners[k][self.along] * areas[k] / whole).sum();
        Some((at, if leaves { -1 } else { 1 }))
    }
}

/// Calls `visit` with integration points on the surface: centroids of triangles, divided until no side is longer than
/// `size`.
pub(super) fn of_surface(surface: &Surface<3>, size: f64, mut visit: impl FnMut(Point)) {
    for e in 0..surface.elements.len() as u32 {
        let [p, q, r] = surface.corners(e);
        let (u, v) = (q - p, r - p);
        let area = surface.element_area_vector(e).norm();
        let longest = u.norm().max(v.norm()).max((r - q).norm());
        let n = (longest / size).ceil().clamp(1.0, 200.0) as usize;
        let weight = area / (n * n) as f64;
        for i in 0..n {
            for j in 0..n - i {
                let mut put = |third: f64| {
                    let (s, t) = ((i as f64 + third) / n as f64, (j as f64 + third) / n as f64);
                    visit(Point { x: p + u * s + v * t, weight });
                };
                put(1.0 / 3.0);
                if i + j + 1 < n {
                    put(2.0 / 3.0);
                }
            }
        }
    }
}
