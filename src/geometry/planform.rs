//! Planform: what bodies look like from above, which the coefficients of wings are made with.
//!
//! The chord c at a station of the span is the length along x of what lies under or above it; with the area S = ∫ c dy the mean
//! aerodynamic chord is ∫ c² dy / S, and its leading edge is at ∫ c (x_le, y) dy / S.
use super::Surface;
use crate::math::{Bounds, Vector};

/// Stations along the span.
const STATIONS: usize = 1024;
/// Part of the chord at which moments are taken.
const QUARTER: f64 = 0.25;

/// Reference values that follow from the shape of the bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planform {
    /// Mean aerodynamic chord; in 2-D the extent along the chord.
    pub chord: f64,
    /// Area seen along z; in 2-D the chord.
    pub area: f64,
    /// The point at a quarter of that chord, along x and y.
    pub quarter: [f64; 2],
}

/// A section of a body across its span.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Station {
    /// Length along x of what is cut; 0 where nothing is.
    pub chord: f64,
    /// The point at a quarter of the chord, on the line from the foremost point to the rearmost one.
    pub quarter: [f64; 3],
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
        let mut spans: Vec<Vec<[f64; 2]>> = vec![Vec::new(); at.len()];
        let mut ends = vec![[[f64::INFINITY, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]]; at.len()];
        for e in (0..self.elements.len()).filter(|e| self.elements[*e].body == body) {
            let corners = self.corners(e as u32);
            let heights = corners.iter().map(|c| c[axis]);
            let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
            for k in at.partition_point(|s| *s < low)..at.partition_point(|s| *s <= high) {
                let Some([front, rear]) = cut(&corners, axis, at[k]) else { continue };
                spans[k].push([front[0], rear[0]]);
                if front[0] < ends[k][0][0] {
                    ends[k][0] = front;
                }
                if rear[0] > ends[k][1][0] {
                    ends[k][1] = rear;
                }
            }
        }
        let station = |(spans, [front, rear]): (&mut Vec<[f64; 2]>, &[[f64; 3]; 2])| {
            let chord = covered(spans);
            let part = if chord > 0.0 { QUARTER * chord / (rear[0] - front[0]) } else { return Station::default() };
            Station { chord, quarter: std::array::from_fn(|d| front[d] + part * (rear[d] - front[d])) }
        };
        spans.iter_mut().zip(&ends).map(station).collect()
    }

    /// Reference values of body number `body` of a plane, or of all, turned nose up by `angle` radians: the chord is its extent along its
    /// own x axis.
    pub fn section(&self, body: Option<usize>, angle: f64) -> Planform {
        let (sin, cos) = angle.sin_cos();
        let own = |x: &Vector<D>| Vector([cos * x[0] - sin * x[1], sin * x[0] + cos * x[1]]);
        let points: Vec<Vector<2>> = self.corners_of(body).iter().flatten().map(own).collect();
        let bounds = Bounds::around(&points);
        let (chord, at) = (bounds.extent()[0], [bounds.min[0] + QUARTER * bounds.extent()[0], bounds.centre()[1]]);
        Planform { chord, area: chord, quarter: [cos * at[0] + sin * at[1], cos * at[1] - sin * at[0]] }
    }

    /// The planform of the part of the bodies `within` a box, x along the chord and y along the span; of body number `body` alone where one is
    /// given, which counts whole where others cut it.
    pub fn planform(&self, within: &Bounds<D>, body: Option<usize>) -> Planform {
        let all = self.corners_of(body);
        let bounds = all.iter().fold(Bounds::EMPTY, |b: Bounds<D>, c| b.union(&Bounds::around(c)));
        let (start, length) = (bounds.min[0], bounds.extent()[0]);
        if D == 2 {
            return self.section(body, 0.0);
        }
        let (low, high) = (bounds.min[1].max(within.min[1]), bounds.max[1].min(within.max[1]));
        let width = (high - low) / STATIONS as f64;
        let mut spans: Vec<Vec<[f64; 2]>> = vec![Vec::new(); STATIONS];
        for corners in &all {
            let heights = corners.iter().map(|c| (c[1] - low) / width - 0.5);
            let (first, last) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), h| (a.min(h), b.max(h)));
            let stations = first.ceil().max(0.0) as usize..=last.floor().min(STATIONS as f64 - 1.0).max(-1.0) as usize;
            for k in stations.filter(|_| last >= 0.0) {
                let found = cut(corners, 1, low + (k as f64 + 0.5) * width);
                spans[k].extend(found.map(|[front, rear]| [front[0], rear[0]]));
            }
        }
        let [mut sum, mut squares, mut edge, mut station] = [0.0; 4];
        for (k, spans) in spans.iter_mut().enumerate() {
            let chord = covered(spans);
            let Some([leading, _]) = spans.first() else { continue };
            sum += chord;
            squares += chord * chord;
            edge += chord * leading;
            station += chord * (low + (k as f64 + 0.5) * width);
        }
        if sum > 0.0 {
            let chord = squares / sum;
            Planform { chord, area: sum * width, quarter: [edge / sum + QUARTER * chord, station / sum] }
        } else {
            let quarter = [start + QUARTER * length, f64::midpoint(low, high)];
            Planform { chord: length, area: length * (high - low).max(0.0), quarter }
        }
    }
}

/// The foremost and the rearmost point of a triangle where its coordinate along `axis` is `at`; `None` where it does not reach there.
fn cut<const D: usize>(corners: &[Vector<D>; D], axis: usize, at: f64) -> Option<[[f64; 3]; 2]> {
    let mut ends = [[f64::INFINITY, 0.0, 0.0], [f64::NEG_INFINITY, 0.0, 0.0]];
    for k in 0..D {
        let (a, b) = (&corners[k], &corners[(k + 1) % D]);
        if (a[axis] <= at) != (b[axis] <= at) {
            let x = (*a + (*b - *a) * ((at - a[axis]) / (b[axis] - a[axis]))).to_3d();
            if x[0] < ends[0][0] {
                ends[0] = x;
            }
            if x[0] > ends[1][0] {
                ends[1] = x;
            }
        }
    }
    (ends[0][0] <= ends[1][0]).then_some(ends)
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

    #[test]
    fn a_section_keeps_its_chord_and_quarter_point_as_it_turns() {
        let text = "[flow]\nmach = 0.5\n[[body]]\nnaca = \"0012\"\nrotate = \"30 deg\"\ntranslate = [1, 2]\n";
        let case = crate::case::read(text, "t").unwrap();
        let surface = crate::geometry::load_surface::<2>(&case.bodies, std::path::Path::new(".")).unwrap().0;
        let seen = surface.section(None, 30f64.to_radians());
        let (sin, cos) = 30f64.to_radians().sin_cos();
        let quarter = [1.0 + 0.25 * cos, 2.0 - 0.25 * sin];
        assert!((seen.chord - 1.0).abs() < 1e-9, "{seen:?}");
        assert!((0..2).all(|d| (seen.quarter[d] - quarter[d]).abs() < 1e-9), "{seen:?}");
    }

    fn everywhere() -> Bounds<3> {
        Bounds { min: Vector([-1e3; 3]), max: Vector([1e3; 3]) }
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
