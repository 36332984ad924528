//! Surfaces of wings, bodies of revolution, and bodies with general cross-sections.
//!
//! A wing is a sequence of stations along the span, each with the position of its leading edge, a chord, a twist and a
//! section. Between stations, straight lines connect points at equal fractions of the length of the sides. Sections lie
//! in planes normal to the span, y = const, or z = const for fins. A flat tip is closed by the last section. A round
//! tip lies inside the planform: where the tip section has the thickness 2 δ, the thickness decreases from δ (1 − sin
//! φ) inboard of the tip as cos φ and vanishes at the tip. The planform is then exactly as specified, and the tip is a
//! semicircle in front view. A revolved tip is half a body of revolution of the last section beyond the planform.
use std::f64::consts::PI;

use super::GeometryError;
use super::outline;
use super::planform::{Planform, QUARTER};
use super::section::{Chain, Sides, clustered};
use super::shell::{Exact, Shell};
use crate::case::{PlanformShape, Tip, Wing, WingSides};
use crate::math::Vector;

/// Number of panels of a side of the section, and of a profile.
const AROUND: usize = 96;
const PROFILE: usize = 160;
/// Number of panels along the span per mean chord, with minimum and maximum.
const PER_CHORD: f64 = 10.0;
const ALONG: [f64; 2] = [8.0, 96.0];
/// Ratio of the last to the first chord of an elliptic planform whose tips do not end in a point.
const LAST: f64 = 0.05;
/// Number of panels of a round tip from the upper to the lower side, and of a body of revolution around its axis.
const CAP: usize = 12;
const TURN: usize = 96;
/// Greatest depth of a round tip as a fraction of the half span, and the room for the last panel next to it.
const DEEPEST: f64 = 0.5;
const BESIDE: f64 = 1.5;
/// Dihedral angle above which a wing is a fin, whose sections lie in planes z = const.
const FIN: f64 = 0.25 * PI;
/// Chord fraction of the twist axis.
const TWISTED_ABOUT: f64 = 0.25;
/// Angle above which an edge is sharp (rad) (40°).
const CREASE: f64 = 40.0 * PI / 180.0;

/// The surface of a wing. `sections` are the outlines at root and tip; `place` names the wing in messages. Fails for
/// inconsistent values.
pub(super) fn wing(place: &str, wing: &Wing, sections: [&Shell<2>; 2]) -> Result<Shell<3>, GeometryError> {
    let plan = Plan::of(place, wing)?;
    let sides = sections.map(|outline| Sides::of(outline, &clustered(AROUND)));
    let sharp = sides.iter().all(Sides::is_sharp);
    let depths = plan.depths(&sides);
    let half = plan.rings(&sides, &depths);
    let mut rows = plan.cap(&sides, &depths);
    let mut skin = Skin::default();
    let number = |skin: &mut Skin, ring: &[Vector<3>]| {
        if ring.windows(2).all(|x| x[0] == x[1]) { skin.ring_or_point(ring, true) } else { skin.ring(ring, sharp) }
    };
    let right: Vec<Vec<u32>> = half.iter().map(|ring| number(&mut skin, ring)).collect();
    if !plan.both {
        skin.strips(&right, true);
        skin.cap(&right[right.len() - 1], &rows, false);
        skin.cap(&right[0], &[], true);
        return Ok(skin.shell());
    }
    let mirrored = |x: &Vector<3>| Vector([x[0], -x[1], x[2]]);
    let left = half[1..].iter().rev().map(|ring| ring.iter().map(mirrored).collect::<Vec<_>>());
    let mut all: Vec<Vec<u32>> = left.map(|ring| number(&mut skin, &ring)).collect();
    all.extend(right);
    skin.strips(&all, true);
    skin.cap(&all[all.len() - 1], &rows, false);
    rows.iter_mut().flatten().for_each(|x| *x = mirrored(x));
    skin.cap(&all[0], &rows, true);
    let shell = skin.shell();
    let kink = wing.planform == PlanformShape::Straight || wing.sweep.0 != 0.0 || wing.dihedral.0 != 0.0;
    Ok(if kink { shell.kinked(|x| x[1] == 0.0) } else { shell })
}

/// Reference values of the planform of a wing as specified, in its own axes, for the part between these fractions of
/// the span from the left tip, −1, to the right one, 1. `None` for a wing that cannot be constructed.
pub(super) fn typed_planform(wing: &Wing, [low, high]: [f64; 2]) -> Option<Planform> {
    /// Number of panels of Simpson's rule on a half wing, which is exact for straight edges.
    const PANELS: usize = 64;
    let plan = Plan::of("", wing).ok()?;
    let elliptic = wing.planform == PlanformShape::Elliptic;
    let mut sums = [0.0; 5];
    for side in [1.0, -1.0] {
        let (from, to) = if side > 0.0 { (low.max(0.0), high.min(1.0)) } else { ((-high).max(0.0), (-low).min(1.0)) };
        if from >= to || (side < 0.0 && !plan.both) {
            continue;
        }
        let ends = if elliptic { [from.asin(), to.asin()] } else { [from, to] };
        let step = (ends[1] - ends[0]) / PANELS as f64;
        for k in 0..=PANELS {
            let angle = ends[0] + step * k as f64;
            let (part, slope) = if elliptic { angle.sin_cos() } else { (angle, 1.0) };
            let weight = if k == 0 || k == PANELS { 1.0 } else { 2.0 * (1 + k % 2) as f64 } * step / 3.0 * slope;
            let Station { nose, chord } = plan.station(part);
            let own = [1.0, chord, nose[0], side * nose[1], nose[2]];
            sums.iter_mut().zip(own).for_each(|(sum, own)| *sum += weight * chord * own);
        }
    }
    let [sum, squares, edge, y, z] = sums;
    let across = if plan.up[2] != 0.0 { plan.span[1] } else { plan.span[2].abs() };
    let chord = squares / sum;
    // the round-off of cancelling halves is removed
    let y = if y.abs() < f64::EPSILON * sum * across { 0.0 } else { y / sum };
    let quarter = [edge / sum + QUARTER * chord, y, z / sum];
    (sum > 0.0).then_some(Planform { chord, area: sum * across, quarter })
}

/// Vector from root to tip of a half wing along the span; `None` for a wing that cannot be constructed.
pub(super) fn span_of(wing: &Wing) -> Option<Vector<3>> {
    Plan::of("", wing).ok().map(|plan| plan.span)
}

/// A body of revolution about the x axis with the profile `chain` from the nose to the rear; a flat face closes it
/// where the profile does not end on the axis.
pub(super) fn revolution(chain: &Chain<2>) -> Shell<3> {
    let around = |x: &Vector<2>, [c, s]: [f64; 2]| Vector([x[0], x[1] * c, x[1] * s]);
    along_axis(chain, around)
}

/// The body through the cross-sections x, width, height and z of the centre, which are |2y/width|^n + |2z/height|^n = 1
/// with n = `exponent`; flat faces close it where it does not end in points.
///
/// Width, upper and lower edge follow curves that stay between the stations, and that give a body of revolution where
/// the cross-sections are circles about one axis.
pub(super) fn through(stations: &[Vec<f64>], exponent: f64, straight: bool) -> Shell<3> {
    // measures that equal r for a circle of radius r
    let measures = |s: &Vec<f64>| {
        let (width, height, middle) = (s[1], s[2], s.get(3).copied().unwrap_or(0.0));
        Vector([s[0], width / 8f64.sqrt(), 0.25 * height + 0.5 * middle, 0.25 * height - 0.5 * middle])
    };
    let sections: Vec<Vector<4>> = stations.iter().map(measures).collect();
    let bent = |x: f64| x.signum() * x.abs().powf(2.0 / exponent);
    along_axis(&outline::profile(&sections, straight), |x, [c, s]| {
        Vector([x[0], 2f64.sqrt() * x[1] * bent(c), x[2] - x[3] + (x[2] + x[3]) * bent(s)])
    })
}

/// A body along the x axis: `around` maps a point of the profile and the cosine and sine of an angle to a point of the
/// surface.
fn along_axis<const D: usize>(chain: &Chain<D>, around: impl Fn(&Vector<D>, [f64; 2]) -> Vector<3>) -> Shell<3> {
    let mut skin = Skin::default();
    // points that should lie in a plane of symmetry do so exactly
    let turn = |k: usize| {
        let (s, c) = (2.0 * PI * k as f64 / TURN as f64).sin_cos();
        [c, s].map(|x| if x.abs() < 1e-15 { 0.0 } else { x })
    };
    let ring = |x: &Vector<D>| (0..TURN).map(|k| around(x, turn(k))).collect::<Vec<_>>();
    let points = chain.resampled(PROFILE);
    let rings: Vec<Vec<u32>> = points.iter().map(|x| skin.ring_or_point(&ring(x), x[1] == 0.0)).collect();
    skin.strips(&rings, true);
    for (ring, point, last) in
        [(&rings[0], points[0], false), (&rings[rings.len() - 1], points[points.len() - 1], true)]
    {
        if point[1] > 0.0 {
            let centre = (around(&point, [1.0, 0.0]) + around(&point, [-1.0, 0.0])) * 0.5;
            let centre = skin.ring_or_point(&[centre], false)[0];
            let centre = vec![centre; TURN];
            skin.strips(&if last { [ring.clone(), centre] } else { [centre, ring.clone()] }, true);
        }
    }
    skin.shell()
}

/// An ellipsoid about the origin with the semi-axes `half`.
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
    /// Position of the leading edge.
    nose: Vector<3>,
    chord: f64,
}

/// Geometry of a wing, derived from its keys.
struct Plan<'a> {
    wing: &'a Wing,
    /// Vector from the leading edge of the root to that of the tip, normal to the stream.
    span: Vector<3>,
    /// Unit vector of the thickness direction.
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

    /// Fractions of the span of the stations; round tips start within the last panel and are at most `deepest` deep.
    fn parts(&self, deepest: f64) -> Vec<f64> {
        let length = self.span.norm();
        let count = |mean: f64| (PER_CHORD * length / mean).ceil().clamp(ALONG[0], ALONG[1]) as usize;
        match self.wing.planform {
            PlanformShape::Straight => {
                let n = count(0.5 * self.root_chord * (1.0 + self.wing.taper));
                let last = 1.0 - BESIDE * deepest;
                let inner = (0..=n).map(|k| last * k as f64 / n as f64);
                inner.chain((deepest > 0.0).then_some(1.0)).collect()
            }
            PlanformShape::Elliptic => {
                let last = if self.wing.tip == Tip::Round { 0.5 * PI } else { LAST.acos() };
                let n = count(0.25 * PI * self.root_chord);
                (0..=n).map(|k| (last * k as f64 / n as f64).sin()).collect()
            }
        }
    }

    /// Fraction of the span at which the last section lies.
    fn tip(&self) -> f64 {
        let cut = self.wing.planform == PlanformShape::Elliptic && self.wing.tip != Tip::Round;
        if cut { LAST.acos().sin() } else { 1.0 }
    }

    /// Depth of a round tip as a fraction of the span, at the points of a side of the section from the nose to the
    /// rear.
    fn depths(&self, sides: &[Sides; 2]) -> Vec<f64> {
        let round = self.wing.tip == Tip::Round && self.wing.planform == PlanformShape::Straight;
        if !round {
            return vec![0.0; AROUND + 1];
        }
        let half = |k: usize| {
            let [upper, lower] = self.both_sides(sides, 1.0, k);
            0.5 * (upper - lower).norm() / self.span.norm()
        };
        let all: Vec<f64> = (0..=AROUND).map(half).collect();
        let deepest = all.iter().copied().fold(0.0, f64::max);
        let fit = if deepest > DEEPEST { DEEPEST / deepest } else { 1.0 };
        all.into_iter().map(|depth| depth * fit).collect()
    }

    fn station(&self, part: f64) -> Station {
        let over_root = match self.wing.planform {
            PlanformShape::Straight => 1.0 + (self.wing.taper - 1.0) * part,
            PlanformShape::Elliptic => (1.0 - part * part).max(0.0).sqrt(),
        };
        let chord = self.root_chord * over_root;
        // the line at the chord fraction `sweep_at` is straight
        let across = if self.both { self.span[1] } else { self.span.norm() };
        let back = self.wing.sweep_at * (self.root_chord - chord) + across * part * self.wing.sweep.0.tan();
        Station { nose: self.span * part + Vector([back, 0.0, 0.0]), chord }
    }

    /// Points number `k` from the nose of the upper and the lower side.
    fn both_sides(&self, sides: &[Sides; 2], part: f64, k: usize) -> [Vector<3>; 2] {
        let station = self.station(part);
        let (sin, cos) = (self.wing.twist.0 * part).sin_cos();
        let point = |[root, tip]: [Vector<2>; 2]| {
            let x = (root + (tip - root) * part) * station.chord;
            let axis = TWISTED_ABOUT * station.chord;
            let (x, z) = (axis + (x[0] - axis) * cos + x[1] * sin, x[1] * cos - (x[0] - axis) * sin);
            station.nose + Vector([x, 0.0, 0.0]) + self.up * z
        };
        [point([0, 1].map(|end| sides[end].upper[k])), point([0, 1].map(|end| sides[end].lower[k]))]
    }

    /// Points around the sections: from the rear over the upper side to the nose and back along the lower side. The
    /// last ring is the tip edge.
    fn rings(&self, sides: &[Sides; 2], depths: &[f64]) -> Vec<Vec<Vector<3>>> {
        let deepest = depths.iter().copied().fold(0.0, f64::max);
        let ring = |part: f64| {
            let at = |k: usize| self.both_sides(sides, if part < 1.0 { part } else { 1.0 - depths[k] }, k);
            let upper = (0..=AROUND).rev().map(|k| at(k)[0]);
            upper.chain((1..=AROUND).map(|k| at(k)[1])).collect()
        };
        self.parts(deepest).into_iter().map(ring).collect()
    }

    /// Rows of points between the upper and the lower side of a round tip, from the rear to the nose; empty for other
    /// tips.
    fn cap(&self, sides: &[Sides; 2], depths: &[f64]) -> Vec<Vec<Vector<3>>> {
        let revolved = self.wing.tip == Tip::Revolved;
        if !revolved && depths.iter().all(|depth| *depth == 0.0) {
            return Vec::new();
        }
        let (outward, tip) = (self.span.unit(), self.tip());
        let row = |j: usize| {
            let (sin, cos) = (PI * j as f64 / CAP as f64).sin_cos();
            let point = |k: usize| {
                let [upper, lower] = self.both_sides(sides, tip - depths[k] * (1.0 - sin), k);
                let half = (upper - lower) * 0.5;
                let beyond = if revolved { half.norm() * sin } else { 0.0 };
                (upper + lower) * 0.5 + half * cos + outward * beyond
            };
            (0..=AROUND).rev().map(point).collect()
        };
        (1..CAP).map(row).collect()
    }
}

/// Vertices and triangles under construction.
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

    /// Adds a ring of points; the last point of a section with a sharp edge is its first.
    fn ring(&mut self, points: &[Vector<3>], sharp: bool) -> Vec<u32> {
        let own = points.len() - usize::from(sharp);
        let mut numbers: Vec<u32> = points[..own].iter().map(|x| self.add(x)).collect();
        if sharp {
            numbers.push(numbers[0]);
        }
        numbers
    }

    /// Adds a ring, or the repeated index of a single point.
    fn ring_or_point(&mut self, points: &[Vector<3>], one: bool) -> Vec<u32> {
        if one { vec![self.add(&points[0]); points.len()] } else { self.ring(points, false) }
    }

    /// Adds triangles between consecutive rows; closed rows continue from the last point to the first.
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

    /// The shell, oriented so that its normals point outward.
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
