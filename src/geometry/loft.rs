//! Wings from planform and sections, bodies of revolution from profiles, bodies of any section through stations.
//!
//! A wing is a row of stations along the span, each with the place of its leading edge, a chord, a twist and a section; between
//! them straight lines join points at equal parts of the length of the sides. Sections stand across the span: in planes y = const,
//! or z = const for fins. A round tip is half a body of revolution of the last section, a flat one its face.
use std::f64::consts::PI;

use super::GeometryError;
use super::outline;
use super::section::{Chain, Sides, clustered};
use super::shell::{Exact, Shell};
use super::spline::{End, Spline};
use crate::case::{PlanformShape, Tip, Wing, WingSides};
use crate::math::Vector;

/// Panels of a side of the section, and of a profile.
const AROUND: usize = 96;
const PROFILE: usize = 160;
/// Panels along the span for each mean chord, fewest and most.
const PER_CHORD: f64 = 10.0;
const ALONG: [f64; 2] = [8.0, 96.0];
/// Last chord of an elliptic planform over the first.
const LAST: f64 = 0.05;
/// Panels of a round tip from the upper to the lower side, and of a body of revolution around it.
const CAP: usize = 12;
const TURN: usize = 96;
/// Dihedral beyond which a wing is a fin: its sections stand in planes z = const.
const FIN: f64 = 0.25 * PI;
/// Part of the chord about which sections are twisted.
const TWISTED_ABOUT: f64 = 0.25;
/// Turning angle of sharp edges, radians (40°).
const CREASE: f64 = 40.0 * PI / 180.0;

/// The wing; `sections` are the outlines of those of root and tip, `place` names it in messages.
pub(super) fn wing(place: &str, wing: &Wing, sections: [&Shell<2>; 2]) -> Result<Shell<3>, GeometryError> {
    let plan = Plan::of(place, wing)?;
    let sides = sections.map(|outline| Sides::of(outline, &clustered(AROUND)));
    let sharp = sides.iter().all(Sides::is_sharp);
    let half: Vec<Vec<Vector<3>>> = plan.stations().iter().map(|s| plan.ring(s, &sides)).collect();
    let mut skin = Skin::default();
    let right: Vec<Vec<u32>> = half.iter().map(|ring| skin.ring(ring, sharp)).collect();
    let tip = &half[half.len() - 1];
    let outward = plan.span * (1.0 / plan.span.norm());
    let mut rows = plan.cap(tip, &outward);
    if !plan.both {
        skin.strips(&right, true);
        skin.cap(&right[right.len() - 1], &rows, false);
        skin.cap(&right[0], &[], true);
        return Ok(skin.shell());
    }
    let mirrored = |x: &Vector<3>| Vector([x[0], -x[1], x[2]]);
    let left = half[1..].iter().rev().map(|ring| ring.iter().map(mirrored).collect::<Vec<_>>());
    let mut all: Vec<Vec<u32>> = left.map(|ring| skin.ring(&ring, sharp)).collect();
    all.extend(right);
    skin.strips(&all, true);
    skin.cap(&all[all.len() - 1], &rows, false);
    rows.iter_mut().flatten().for_each(|x| *x = mirrored(x));
    skin.cap(&all[0], &rows, true);
    let shell = skin.shell();
    let kink = wing.planform == PlanformShape::Straight || wing.sweep.0 != 0.0 || wing.dihedral.0 != 0.0;
    Ok(if kink { shell.kinked(|x| x[1] == 0.0) } else { shell })
}

/// A body of revolution about the x axis, of the profile `chain` from the nose to the rear; closed by a face where it does not end
/// on the axis.
pub(super) fn revolution(chain: &Chain) -> Shell<3> {
    let around = |x: &Vector<2>, [c, s]: [f64; 2]| Vector([x[0], x[1] * c, x[1] * s]);
    along_axis(chain, around)
}

/// The body through sections x, width, height and z of the middle, which are |2y/width|^n + |2z/height|^n = 1 for the `exponent` n; closed by
/// faces where it does not end in points.
///
/// The root of width times height follows the curve of a profile; what widths are to heights, and the middles, follow splines along x.
pub(super) fn through(stations: &[Vec<f64>], exponent: f64, straight: bool) -> Shell<3> {
    let size = |s: &[f64]| 0.5 * (s[1] * s[2]).sqrt();
    let profile: Vec<Vector<2>> = stations.iter().map(|s| Vector([s[0], size(s)])).collect();
    let last = stations.len() - 1;
    let form = |k: usize| {
        // a point has the form of the section beside it
        let beside = if stations[k][1] > 0.0 {
            k
        } else if k == 0 {
            1
        } else {
            k - 1
        };
        Vector([(stations[beside][1] / stations[beside][2]).ln(), stations[k].get(3).copied().unwrap_or(0.0)])
    };
    let forms: Vec<Vector<2>> = (0..=last).map(form).collect();
    let places = stations.iter().map(|s| s[0]).collect();
    let curve = Spline::over(places, forms.clone(), End::Natural, End::Natural);
    let bent = |x: f64| x.signum() * x.abs().powf(2.0 / exponent);
    along_axis(&outline::profile(&profile, straight), |x, [c, s]| {
        let (i, part) = curve.interval(x[0]);
        let form = if straight { forms[i] * (1.0 - part) + forms[i + 1] * part } else { curve.at(i, part).0 };
        let stretch = (0.5 * form[0]).exp();
        Vector([x[0], x[1] * stretch * bent(c), form[1] + x[1] / stretch * bent(s)])
    })
}

/// A body along the x axis: `around` gives the point at the cosine and the sine of an angle of the section at a point of the profile.
fn along_axis(chain: &Chain, around: impl Fn(&Vector<2>, [f64; 2]) -> Vector<3>) -> Shell<3> {
    let mut skin = Skin::default();
    // no point beside a plane of symmetry that should lie in it
    let turn = |k: usize| {
        let (s, c) = (2.0 * PI * k as f64 / TURN as f64).sin_cos();
        [c, s].map(|x| if x.abs() < 1e-15 { 0.0 } else { x })
    };
    let ring = |x: &Vector<2>| (0..TURN).map(|k| around(x, turn(k))).collect::<Vec<_>>();
    let points = chain.resampled(PROFILE);
    let rings: Vec<Vec<u32>> = points.iter().map(|x| skin.ring_or_point(&ring(x), x[1] == 0.0)).collect();
    skin.strips(&rings, true);
    for (ring, point, last) in
        [(&rings[0], points[0], false), (&rings[rings.len() - 1], points[points.len() - 1], true)]
    {
        if point[1] > 0.0 {
            let centre = skin.ring_or_point(&[around(&Vector([point[0], 0.0]), [1.0, 0.0])], false)[0];
            let centre = vec![centre; TURN];
            skin.strips(&if last { [ring.clone(), centre] } else { [centre, ring.clone()] }, true);
        }
    }
    skin.shell()
}

/// An ellipsoid about the origin with the half axes `half`.
pub(super) fn ellipsoid(sphere: Shell<3>, half: [f64; 3]) -> Shell<3> {
    let normal = |n: Vector<3>| Vector::from_fn(|d| n[d] / half[d]).unit();
    Shell {
        vertices: sphere.vertices.iter().map(|x| Vector::from_fn(|d| half[d] * x[d])).collect(),
        normals: sphere.normals.map(|all| all.iter().map(|n| n.map(normal)).collect()),
        exact: Exact::None,
        ..sphere
    }
}

/// A station along the span.
struct Station {
    /// Place of the leading edge.
    nose: Vector<3>,
    chord: f64,
    /// Part of the way from the root to the tip.
    part: f64,
}

/// What the keys of a wing say.
struct Plan<'a> {
    wing: &'a Wing,
    /// From the leading edge of the root to that of the tip, across the stream.
    span: Vector<3>,
    /// Direction of the thickness.
    up: Vector<3>,
    both: bool,
    root_chord: f64,
}

impl<'a> Plan<'a> {
    fn of(place: &str, wing: &'a Wing) -> Result<Self, GeometryError> {
        let both = wing.sides == WingSides::Both;
        let (dihedral, length) = (wing.dihedral.0, if both { 0.5 * wing.span.0 } else { wing.span.0 });
        let fin = dihedral.abs() > FIN;
        if both && fin {
            let what = format!("a wing with two sides has a dihedral of {:.1} deg", dihedral.to_degrees());
            return Err(GeometryError::refused(place, what, "a fin has `sides = \"one\"`"));
        }
        let mean = match wing.planform {
            PlanformShape::Straight => 0.5 * (1.0 + wing.taper),
            PlanformShape::Elliptic => 0.25 * PI,
        };
        let root_chord = match (wing.chord, wing.aspect_ratio) {
            (Some(chord), _) => chord.0,
            (None, Some(ratio)) => wing.span.0 / (ratio * mean),
            (None, None) => {
                return Err(GeometryError::refused(place, "a wing has neither chord nor aspect ratio", "add `chord`"));
            }
        };
        let (span, up) = if fin {
            let way = dihedral.signum();
            (Vector([0.0, way * length / dihedral.tan().abs(), way * length]), Vector([0.0, -way, 0.0]))
        } else {
            (Vector([0.0, length, length * dihedral.tan()]), Vector([0.0, 0.0, 1.0]))
        };
        Ok(Self { wing, span, up, both, root_chord })
    }

    fn stations(&self) -> Vec<Station> {
        let length = self.span.norm();
        let count = |mean: f64| (PER_CHORD * length / mean).ceil().clamp(ALONG[0], ALONG[1]) as usize;
        let parts: Vec<f64> = match self.wing.planform {
            PlanformShape::Straight => {
                let n = count(0.5 * self.root_chord * (1.0 + self.wing.taper));
                (0..=n).map(|k| k as f64 / n as f64).collect()
            }
            PlanformShape::Elliptic => {
                let (n, last) = (count(0.25 * PI * self.root_chord), LAST.acos());
                (0..=n).map(|k| (last * k as f64 / n as f64).sin()).collect()
            }
        };
        parts.into_iter().map(|part| self.station(part)).collect()
    }

    fn station(&self, part: f64) -> Station {
        let over_root = match self.wing.planform {
            PlanformShape::Straight => 1.0 + (self.wing.taper - 1.0) * part,
            PlanformShape::Elliptic => (1.0 - part * part).max(0.0).sqrt(),
        };
        let chord = self.root_chord * over_root;
        // the line at `sweep_at` is straight
        let across = if self.both { self.span[1] } else { self.span.norm() };
        let back = self.wing.sweep_at * (self.root_chord - chord) + across * part * self.wing.sweep.0.tan();
        Station { nose: self.span * part + Vector([back, 0.0, 0.0]), chord, part }
    }

    /// Points around the section of a station: from the rear over the upper side to the nose, and back below.
    fn ring(&self, station: &Station, sides: &[Sides; 2]) -> Vec<Vector<3>> {
        let (sin, cos) = (self.wing.twist.0 * station.part).sin_cos();
        let along = |pick: fn(&Sides) -> &Vec<Vector<2>>, k: usize| {
            let [root, tip] = [pick(&sides[0])[k], pick(&sides[1])[k]];
            let x = (root + (tip - root) * station.part) * station.chord;
            let axis = TWISTED_ABOUT * station.chord;
            let (x, z) = (axis + (x[0] - axis) * cos + x[1] * sin, x[1] * cos - (x[0] - axis) * sin);
            station.nose + Vector([x, 0.0, 0.0]) + self.up * z
        };
        let upper = (0..=AROUND).rev().map(|k| along(|s| &s.upper, k));
        upper.chain((1..=AROUND).map(|k| along(|s| &s.lower, k))).collect()
    }

    /// Rows of points between the upper and the lower side of the last section, from the rear to the nose; none of a flat tip.
    fn cap(&self, ring: &[Vector<3>], outward: &Vector<3>) -> Vec<Vec<Vector<3>>> {
        if self.wing.tip == Tip::Flat {
            return Vec::new();
        }
        let row = |j: usize| {
            let (sin, cos) = (PI * j as f64 / CAP as f64).sin_cos();
            let point = |k: usize| {
                let (upper, lower) = (ring[k], ring[2 * AROUND - k]);
                let half = (upper - lower) * 0.5;
                (upper + lower) * 0.5 + half * cos + *outward * (half.norm() * sin)
            };
            (0..=AROUND).map(point).collect()
        };
        (1..CAP).map(row).collect()
    }
}

/// Vertices and triangles as they are put together.
#[derive(Default)]
struct Skin {
    vertices: Vec<Vector<3>>,
    elements: Vec<[u32; 3]>,
}

impl Skin {
    fn add(&mut self, x: &Vector<3>) -> u32 {
        self.vertices.push(*x);
        self.vertices.len() as u32 - 1
    }

    /// A ring of points; the last one is the first of a section that ends sharply.
    fn ring(&mut self, points: &[Vector<3>], sharp: bool) -> Vec<u32> {
        let own = points.len() - usize::from(sharp);
        let mut numbers: Vec<u32> = points[..own].iter().map(|x| self.add(x)).collect();
        if sharp {
            numbers.push(numbers[0]);
        }
        numbers
    }

    /// A ring, or as many times the one point that it is.
    fn ring_or_point(&mut self, points: &[Vector<3>], one: bool) -> Vec<u32> {
        if one { vec![self.add(&points[0]); points.len()] } else { self.ring(points, false) }
    }

    /// Triangles between rows, one after another; the last point of a closed row is followed by its first.
    fn strips(&mut self, rows: &[Vec<u32>], closed: bool) {
        for pair in rows.windows(2) {
            let n = pair[0].len();
            for k in 0..if closed { n } else { n - 1 } {
                let next = (k + 1) % n;
                let [a, b, c, d] = [pair[0][k], pair[1][k], pair[1][next], pair[0][next]];
                self.triangle([a, b, c]);
                self.triangle([a, c, d]);
            }
        }
    }

    /// Closes an end of the wing at `ring` with `rows` of points between its upper and lower side.
    fn cap(&mut self, ring: &[u32], rows: &[Vec<Vector<3>>], first: bool) {
        let half = ring.len() / 2;
        let sharp = ring[0] == ring[2 * half];
        let mut all: Vec<Vec<u32>> = vec![ring[..=half].to_vec()];
        for row in rows {
            let inner = row[1..half].iter().map(|x| self.add(x)).collect::<Vec<_>>();
            let rear = if sharp { ring[0] } else { self.add(&row[0]) };
            all.push([rear].into_iter().chain(inner).chain([ring[half]]).collect());
        }
        all.push((0..=half).map(|k| ring[2 * half - k]).collect());
        // the base of a blunt section ends in a half disc
        let rears: Vec<u32> = all.iter().map(|row| row[0]).collect();
        for pair in rears.windows(2) {
            self.triangle(if first { [rears[0], pair[0], pair[1]] } else { [rears[0], pair[1], pair[0]] });
        }
        if first {
            all.reverse();
        }
        self.strips(&all, false);
    }

    fn triangle(&mut self, v: [u32; 3]) {
        if v[0] != v[1] && v[1] != v[2] && v[2] != v[0] {
            self.elements.push(v);
        }
    }

    /// The shell, turned so that its normals point out of it.
    fn shell(self) -> Shell<3> {
        let Self { vertices, mut elements } = self;
        let volume: f64 = elements
            .iter()
            .map(|e| {
                let [a, b, c] = e.map(|v| vertices[v as usize] - vertices[0]);
                a.dot(&super::simplex::cross(&b, &c))
            })
            .sum();
        if volume < 0.0 {
            elements.iter_mut().for_each(|e| e.swap(1, 2));
        }
        let (tags, tag_names) = (Vec::new(), Vec::new());
        Shell {
            vertices,
            elements,
            normals: None,
            tags,
            tag_names,
            curvature: None,
            exact: Exact::None,
            crease: CREASE,
        }
    }
}

#[cfg(test)]
mod tests;
