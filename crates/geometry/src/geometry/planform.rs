//! Planform: what bodies look like from above, which the coefficients of wings are made with.
//!
//! The chord c at a station of the span is the length along x of what lies under or above it; with the area S = ∫ c dy the mean
//! aerodynamic chord is ∫ c² dy / S, and its leading edge is at ∫ c (x_le, y, z) dy / S.
use super::Surface;
use crate::math::parallel::sweep_each;
use crate::math::{Bounds, Vector};

/// Stations along the span.
const STATIONS: usize = 1024;
/// Stations that are cut together.
const TOGETHER: usize = 16;
/// Part of the chord at which moments are taken.
pub(super) const QUARTER: f64 = 0.25;
/// Distance over the length within which points are as far back as others.
const SAME: f64 = 1e-9;

/// Reference values that follow from the shape of the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planform {
    /// Mean aerodynamic chord; in 2-D the extent along the chord.
    pub chord: f64,
    /// Area seen along z; in 2-D the chord.
    pub area: f64,
    /// The point at a quarter of that chord, on the line or the surface of the chords.
    pub quarter: [f64; 3],
}

/// A section of a body across its span.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Station {
    /// Length along x of what is cut; 0 where nothing is.
    pub chord: f64,
    /// Least x.
    pub leading: f64,
    /// The point at a quarter of the chord, on the line from the foremost point to the rearmost one.
    pub quarter: [f64; 3],
    /// z of that point, between the middles of a blunt front and a base.
    pub height: f64,
}

impl<const D: usize> Surface<D> {
    /// Smallest and greatest coordinate along `axis` of what of body number `body` lies on either side of `middle`; `None` for a side
    /// without any.
    pub fn sides(&self, body: u16, axis: usize, middle: f64) -> [Option<[f64; 2]>; 2] {
        let mut sides: [Option<[f64; 2]>; 2] = [None; 2];
        for e in (0..self.elements.len()).filter(|e| self.elements[*e].body == body) {
            let ends = self
                .corners(e as u32)
                .iter()
                .fold([f64::INFINITY, f64::NEG_INFINITY], |r, c| [r[0].min(c[axis]), r[1].max(c[axis])]);
            for (side, [low, high]) in
                sides.iter_mut().zip([[ends[0], ends[1].min(middle)], [ends[0].max(middle), ends[1]]])
            {
                if low < high {
                    *side = Some(side.map_or([low, high], |s| [s[0].min(low), s[1].max(high)]));
                }
            }
        }
        sides
    }

    /// Sections of body number `body` at the coordinates `at` along `axis`, which ascend.
    pub fn stations(&self, body: u16, axis: usize, at: &[f64]) -> Vec<Station> {
        let own = (0..self.elements.len()).filter(|e| self.elements[*e].body == body);
        let corners: Vec<[Vector<D>; D]> = own.map(|e| self.corners(e as u32)).collect();
        stations_of(&corners, axis, at)
    }

    /// The planform of the part of the bodies `within` a box, x along the chord and y along the span; of body number `body` alone where one is
    /// given, which counts whole where others cut it.
    pub fn planform(&self, within: &Bounds<D>, body: Option<usize>) -> Planform {
        planform_of(&self.corners_of(body), within)
    }
}

/// The planform of triangles within a box, x along the chord and y along the span; in the plane the extent along x, and a quarter of it on
/// the line from the foremost to the rearmost point.
pub(super) fn planform_of<const D: usize>(all: &[[Vector<D>; D]], within: &Bounds<D>) -> Planform {
    let bounds = all.iter().fold(Bounds::EMPTY, |b: Bounds<D>, c| b.union(&Bounds::around(c)));
    let length = bounds.extent()[0];
    let (low, high) = (bounds.min[1].max(within.min[1]), bounds.max[1].min(within.max[1]));
    let width = (high - low) / STATIONS as f64;
    let at: Vec<f64> = (0..STATIONS).map(|k| low + (k as f64 + 0.5) * width).collect();
    let mut sums = [0.0; 5];
    for Station { chord, leading, quarter, height } in if D == 2 { Vec::new() } else { stations_of(all, 1, &at) } {
        let own = [1.0, chord, leading, quarter[1], height];
        sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += chord * own);
    }
    let [sum, squares, edge, station, height] = sums;
    if sum > 0.0 {
        let chord = squares / sum;
        let quarter = [edge / sum + QUARTER * chord, station / sum, height / sum];
        return Planform { chord, area: sum * width, quarter };
    }
    let area = if D == 2 { length } else { length * (high - low).max(0.0) };
    Planform { chord: length, area, quarter: on_the_long_line(all, &bounds) }
}

/// The point at a quarter of the line from the foremost points to the rearmost ones.
fn on_the_long_line<const D: usize>(all: &[[Vector<D>; D]], bounds: &Bounds<D>) -> [f64; 3] {
    let slack = SAME * bounds.extent()[0];
    let middle = |end: f64| {
        let (count, sum) = all
            .iter()
            .flatten()
            .filter(|x| (x[0] - end).abs() <= slack)
            .fold((0.0, Vector::<D>::ZERO), |(n, sum), x| (n + 1.0, sum + *x));
        sum * (1.0 / f64::max(count, 1.0))
    };
    let [front, rear] = [bounds.min[0], bounds.max[0]].map(middle);
    (front + (rear - front) * QUARTER).to_3d()
}

/// Sections of triangles at the coordinates `at` along `axis`, which ascend.
fn stations_of<const D: usize>(all: &[[Vector<D>; D]], axis: usize, at: &[f64]) -> Vec<Station> {
    let slack = SAME * Bounds::around(all.iter().flatten()).extent()[0];
    let mut groups = vec![Vec::new(); at.len().div_ceil(TOGETHER)];
    let from = |g: usize| g * TOGETHER;
    sweep_each(&mut groups, |g| group_of(all, axis, &at[from(g)..at.len().min(from(g + 1))], slack));
    groups.concat()
}

/// The same of stations that are few enough to be kept in fast memory while triangles go by.
fn group_of<const D: usize>(all: &[[Vector<D>; D]], axis: usize, at: &[f64], slack: f64) -> Vec<Station> {
    let mut spans: Vec<Vec<[f64; 2]>> = vec![Vec::new(); at.len()];
    let mut ends = vec![[[f64::INFINITY, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]]; at.len()];
    let mut rims = vec![[Rim::default(), Rim::default()]; at.len()];
    for corners in all {
        let heights = corners.iter().map(|c| c[axis]);
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
        for k in at.partition_point(|s| *s < low)..at.partition_point(|s| *s <= high) {
            let Some(points) = cut(corners, axis, at[k]) else { continue };
            let [a, b] = points;
            let [front, rear] = if a[0] == b[0] {
                [a, a]
            } else if a[0] < b[0] {
                [a, b]
            } else {
                [b, a]
            };
            spans[k].push([front[0], rear[0]]);
            if front[0] < ends[k][0][0] {
                ends[k][0] = front;
            }
            if rear[0] > ends[k][1][0] {
                ends[k][1] = rear;
            }
            for x in &points {
                rims[k][0].take(-x[0], x[2], slack);
                rims[k][1].take(x[0], x[2], slack);
            }
        }
    }
    let station = |k: usize| {
        let ([front, rear], rims) = (&ends[k], &rims[k]);
        let chord = covered(&mut spans[k]);
        let part = if chord > 0.0 { QUARTER * chord / (rear[0] - front[0]) } else { return Station::default() };
        let quarter = std::array::from_fn(|d| front[d] + part * (rear[d] - front[d]));
        let [nose, tail] = rims.each_ref().map(Rim::middle);
        Station { chord, leading: front[0], quarter, height: nose + part * (tail - nose) }
    };
    (0..ends.len()).map(station).collect()
}

/// Heights of the points that are farthest in one direction.
#[derive(Clone, Copy, Debug)]
struct Rim {
    far: f64,
    heights: [f64; 2],
}

impl Default for Rim {
    fn default() -> Self {
        Self { far: f64::NEG_INFINITY, heights: [f64::INFINITY, f64::NEG_INFINITY] }
    }
}

impl Rim {
    /// Takes a point into account; those within `slack` are equally far.
    fn take(&mut self, far: f64, height: f64, slack: f64) {
        if far > self.far + slack {
            *self = Self { far, heights: [height, height] };
        } else if far > self.far - slack {
            self.heights = [self.heights[0].min(height), self.heights[1].max(height)];
        }
    }

    fn middle(&self) -> f64 {
        f64::midpoint(self.heights[0], self.heights[1])
    }
}

/// The points where a triangle has the coordinate `at` along `axis`; `None` where it does not reach there.
fn cut<const D: usize>(corners: &[Vector<D>; D], axis: usize, at: f64) -> Option<[[f64; 3]; 2]> {
    let mut found = (0..D).filter_map(|k| {
        let (a, b) = (&corners[k], &corners[(k + 1) % D]);
        let crosses = (a[axis] <= at) != (b[axis] <= at);
        crosses.then(|| (*a + (*b - *a) * ((at - a[axis]) / (b[axis] - a[axis]))).to_3d())
    });
    Some([found.next()?, found.next()?])
}

/// Length of the union of stretches.
fn covered(stretches: &mut [[f64; 2]]) -> f64 {
    stretches.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut end = f64::NEG_INFINITY;
    let mut length = 0.0;
    for [from, to] in stretches.iter() {
        length += (to - from.max(end)).max(0.0);
        end = end.max(*to);
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::icosphere;

    fn everywhere() -> Bounds<3> {
        Bounds { min: Vector([-1e3; 3]), max: Vector([1e3; 3]) }
    }

    #[test]
    fn stations_do_not_depend_on_those_beside_them() {
        let corners = icosphere(0.5, 3).all_corners();
        let at: Vec<f64> = (0..40).map(|k| -0.49 + 0.024 * f64::from(k)).collect();
        let alone: Vec<Station> = at.iter().flat_map(|s| stations_of(&corners, 1, &[*s])).collect();
        assert_eq!(stations_of(&corners, 1, &at), alone);
        assert!(alone.iter().all(|s| s.chord > 0.0));
    }

    #[test]
    fn a_sphere_is_seen_as_a_circle() {
        let surface = Surface::new(&[("ball".to_owned(), icosphere(0.5, 5))]);
        let seen = surface.planform(&everywhere(), None);
        let area = std::f64::consts::FRAC_PI_4;
        assert!((seen.area / area - 1.0).abs() < 2e-3, "{seen:?}");
        assert!((seen.chord / (2.0 / 3.0 / area) - 1.0).abs() < 2e-3, "{seen:?}");
    }
}
