//! Smooth closed outlines in 2-D from points.
//!
//! The points of an airfoil become a closed curve of pieces between corners. Each piece is a cubic spline (see
//! [`super::spline`]), sampled so densely that chords deviate from it by at most 5e-8 of the chord length. The leading
//! edge lies inside a piece, so that the curve is smooth there. A point is a corner where consecutive chords turn by
//! more than 35°, except at a rounded nose: near the leading edge, coarse points turn by more than this, but so do
//! their neighbours, whereas next to a sharp nose the outline is nearly straight.
use super::GeometryError;
use super::marks::{CORNER, Mark, SAME, at, extent, straight_shell};
use super::section::Chain;
use super::shell::{Exact, Shell};
use super::simple_outline::{self, Opposite};
use super::simplex;
use super::spline::{End, Spline};
use super::surface::Surface;
use crate::math::Vector;
use std::f64::consts::PI;

/// Distance, as a fraction of the chord, below which points of an airfoil coincide. Files have five or six digits, and
/// the round-off of a repeated point would form two corners.
const NEAR: f64 = 1e-6;
/// Smallest size of an outline; squares of lengths of smaller ones would underflow.
const SMALLEST: f64 = 1e-100;
/// Gap of a trailing edge, as a fraction of the chord, below which it is closed; it is below the five digits of
/// coordinate files.
const CLOSED: f64 = 2e-5;
/// Gap along the chord, as a fraction of it, below which it is closed at its middle; files with three digits have such
/// gaps.
const NARROW: f64 = 1e-3;
/// Gap of a trailing edge, as a fraction of the chord, above which it is an error; the thickest flatback airfoils have
/// a quarter.
const OPEN: f64 = 0.5;
/// Greatest gap, relative to the longer adjacent side, where the first point is not repeated at the end.
const NEXT: f64 = 2.5;
/// Greatest deviation of a segment from the curve, as a fraction of the chord.
const SAGITTA: f64 = 5e-8;
/// Minimum number of segments per chord length.
const SEGMENTS: f64 = 1500.0;
/// Greatest number of segments between two points; a nose given by a few points needs a thousand.
const PARTS: f64 = 1024.0;
/// Slope of the first side of a profile above which its nose is round (30° from the axis).
const STEEP: f64 = 0.577;
/// Extent of the nose from the leading edge, as a fraction of the chord.
const NOSE: f64 = 0.1;
/// Ratio of the turning angle next to the nose and at the nose, below which the nose is sharp.
const SHARP_NOSE: f64 = 0.05;

/// Greatest number of corners whose lines are reported.
const TOLD: usize = 8;

/// A point of the outline with its outward normal.
pub(super) type Sample = (Vector<2>, Vector<2>);

/// The smooth shell through `marks`, which are ordered around the section from trailing edge to trailing edge. Repairs
/// are appended to `notes`; `file` names the source. Fails when the outline cannot be used.
pub(super) fn airfoil(file: &str, marks: Vec<Mark>, notes: &mut Vec<String>) -> Result<Shell<2>, GeometryError> {
    let (mut marks, base) = closed_loop(file, marks, notes)?;
    simple_outline::drop_further_rounds(file, &mut marks, 4, notes);
    simple_outline::refuse_crossing(file, &marks)?;
    if orient(file, &mut marks, notes)? && !base {
        // the trailing edge stays the first point
        marks.rotate_right(1);
    }
    simple_outline::refuse_overlap(file, &marks, Opposite::Allowed)?;
    let base = base || ends_with_base(&mut marks);
    let points: Vec<Vector<2>> = marks.iter().map(|m| m.point).collect();
    let corners = corners(&points, base);
    let chord = extent(&points);
    let ends = if base { "with a blunt base" } else { rear(&corners) };
    let further = corners.iter().filter(|k| **k > 0 && !(base && **k == points.len() - 1));
    let lines: Vec<String> = further.map(|k| marks[*k].line.to_string()).collect();
    let more = match lines.len() {
        0 => String::new(),
        1 => format!(" and one more corner in line {}", lines[0]),
        n => format!(" and {n} more corners, in lines {}", lines[..n.min(TOLD)].join(", ")),
    };
    notes.push(format!("{file}: {} points, chord {chord:.6}, {ends}{more}", points.len()));
    notes.extend(wide_gaps(&marks, &corners, chord).into_iter().map(|gap| format!("{file}: {gap}")));
    let pieces = pieces(&points, &corners, base, chord);
    let shell = shell_of_pieces(&pieces, CORNER);
    let surface = Surface::new(&[(String::new(), shell.clone())]);
    if let Some((x, _)) = surface.intersection() {
        let what = format!("the smooth outline crosses itself at ({:.6}, {:.6})", x[0], x[1]);
        return Err(GeometryError::refused(file, what, "add points there, or remove uneven ones"));
    }
    let waves = surface.curvature.windows(2).filter(|k| k[0] * k[1] < 0.0).count();
    if waves > points.len() / 4 {
        notes.push(format!("{file}: the curvature is wavy, {waves} changes of sign: the points carry few digits"));
    }
    Ok(shell)
}

/// Description of the rear end of an outline without a base.
fn rear(corners: &[usize]) -> &'static str {
    if corners.contains(&0) { "with a sharp trailing edge" } else { "with a round trailing edge" }
}

/// A shell of straight sides between `points`; a turn of more than `crease` is a sharp corner.
pub(super) fn polygon(
    name: &str,
    points: &[Vector<2>],
    crease: f64,
    notes: &mut Vec<String>,
) -> Result<Shell<2>, GeometryError> {
    let mut marks: Vec<Mark> = points.iter().enumerate().map(|(i, p)| Mark { point: *p, line: i + 1 }).collect();
    if let Some(bad) = marks.iter().find(|m| !m.point.is_finite()) {
        return Err(GeometryError::refused(name, format!("point {} is not finite", bad.line), "check its numbers"));
    }
    let size = extent(points);
    drop_repeated(name, &mut marks, SAME * size, notes);
    if marks.len() > 1 && (marks[0].point - marks[marks.len() - 1].point).norm() <= SAME * size {
        marks.pop();
    }
    if marks.len() < 3 {
        let what = format!("has {} distinct points; an outline needs at least 3", marks.len());
        return Err(GeometryError::refused(name, what, "list the corners once around the body"));
    }
    simple_outline::drop_further_rounds(name, &mut marks, 3, notes);
    simple_outline::refuse_crossing(name, &marks)?;
    orient(name, &mut marks, notes)?;
    simple_outline::refuse_overlap(name, &marks, Opposite::Refused)?;
    Ok(Shell { crease, ..straight_shell(&marks) })
}

/// The pieces of a profile. `points` run from the nose to the rear; each has the position on the axis, followed by
/// measures of the cross-section. Pieces are straight between all points, or smooth between corners. Smooth pieces stay
/// between their points; they meet the axis at a right angle where they approach it steeply, and form a point
/// elsewhere.
pub(super) fn profile<const D: usize>(points: &[Vector<D>], straight: bool) -> Chain<D> {
    let last = points.len() - 1;
    let turn =
        |i: usize| simplex::angle_between(&(points[i] - points[i - 1]).unit(), &(points[i + 1] - points[i]).unit());
    let inner = (1..last).filter(|i| straight || turn(*i) > CORNER);
    let corners: Vec<usize> = std::iter::once(0).chain(inner).chain([last]).collect();
    let across = |x: Vector<D>| Vector::<D>::from_fn(|d| if d == 0 { 0.0 } else { x[d] });
    let end = |i: usize, beside: usize| {
        let along = points[beside] - points[i];
        // the first measure is a width; in 2-D it is the radius
        let steep = points[i][1] == 0.0 && across(along).norm() > STEEP * along[0].abs();
        let outward = across(along).unit() * if i < beside { 1.0 } else { -1.0 };
        if steep && !straight { End::Along(outward) } else { End::Natural }
    };
    let piece = |ends: &[usize]| {
        let [from, to] = [ends[0], ends[1]];
        let start = if from == 0 { end(0, 1) } else { End::Natural };
        let stop = if to == last { end(last, last - 1) } else { End::Natural };
        let spline = Spline::monotone(points[from..=to].to_vec(), start, stop);
        let mut all = places(&spline, extent(points));
        let n = all.len() - 1;
        (all[0], all[n]) = (points[from], points[to]);
        all
    };
    Chain(corners.windows(2).map(piece).collect())
}

/// A straight piece between two corners of a counter-clockwise outline.
pub(super) fn straight(from: Vector<2>, to: Vector<2>) -> Vec<Sample> {
    let normal = right_of(to - from);
    vec![(from, normal), (to, normal)]
}

/// Joins consecutive pieces to a closed counter-clockwise shell.
pub(super) fn shell_of_pieces(pieces: &[Vec<Sample>], crease: f64) -> Shell<2> {
    let vertices: Vec<Vector<2>> = pieces.iter().flat_map(|p| p[..p.len() - 1].iter().map(|s| s.0)).collect();
    let normals = pieces.iter().flat_map(|p| p.windows(2).map(|s| [s[0].1, s[1].1])).collect();
    let n = vertices.len() as u32;
    let elements = (0..n).map(|i| [i, (i + 1) % n]).collect();
    let (tags, tag_names) = (Vec::new(), Vec::new());
    Shell { vertices, elements, normals: Some(normals), curvature: None, tags, tag_names, exact: Exact::None, crease }
}

/// Removes repeated points and determines the shape of the trailing edge. Returns the distinct points, and true for a
/// blunt base.
fn closed_loop(file: &str, mut marks: Vec<Mark>, notes: &mut Vec<String>) -> Result<(Vec<Mark>, bool), GeometryError> {
    let chord = extent(&marks.iter().map(|m| m.point).collect::<Vec<_>>());
    drop_repeated(file, &mut marks, NEAR * chord, notes);
    if marks.len() < 5 {
        let what = format!("has {} distinct points; a smooth outline needs at least 5", marks.len());
        return Err(GeometryError::refused(file, what, "use `polygon` for outlines with straight sides"));
    }
    let n = marks.len();
    let (first, last) = (marks[0], marks[n - 1]);
    let gap = (first.point - last.point).norm() / chord;
    let open = format!("from {} to {}", at(&last), at(&first));
    if gap > OPEN {
        let what = format!("the outline begins at {} and ends at {}", at(&first), at(&last));
        let hint = "both ends must be the trailing edge: check the order of the points";
        return Err(GeometryError::refused(file, what, hint));
    }
    if gap <= SAME {
        marks.pop();
        return Ok((marks, false));
    }
    if gap > CLOSED && goes_on(&marks) {
        notes.push(format!("{file}: the first point is not repeated at the end: the outline is closed {open}"));
        return Ok((marks, false));
    }
    let across = is_across(&marks);
    if gap <= CLOSED || (gap <= NARROW && !across) {
        notes.push(format!("{file}: the trailing edge, open by {gap:.1e} chords {open}, is closed"));
        marks[0].point = (first.point + last.point) * 0.5;
        marks.pop();
        return Ok((marks, false));
    }
    if across {
        return Ok((marks, true));
    }
    let what = format!("the outline is open {open}, along its side");
    let hint = "add the points that are missing at the trailing edge; a blunt base stands across the section";
    Err(GeometryError::refused(file, what, hint))
}

/// True when the closing line of an open outline continues it at one end at least and is not longer than the adjacent
/// sides, so that only the repetition of the first point is missing.
fn goes_on(marks: &[Mark]) -> bool {
    let n = marks.len();
    let side = |a: usize, b: usize| marks[b].point - marks[a].point;
    let (before, gap, after) = (side(n - 2, n - 1), side(n - 1, 0), side(0, 1));
    let turn = |a: &Vector<2>, b: &Vector<2>| simplex::angle_between(&a.unit(), &b.unit());
    gap.norm() <= NEXT * before.norm().max(after.norm()) && turn(&before, &gap).min(turn(&gap, &after)) < CORNER
}

/// True when an open end is a base across the chord, as opposed to a gap of missing points along the chord.
fn is_across(marks: &[Mark]) -> bool {
    /// Smallest angle between a base and the chord (rad) (30°).
    const ACROSS: f64 = PI / 6.0;
    let (first, last) = (marks[0].point, marks[marks.len() - 1].point);
    let middle = (first + last) * 0.5;
    let far = marks
        .iter()
        .map(|m| middle - m.point)
        .fold(Vector::ZERO, |a: Vector<2>, b| if b.norm() > a.norm() { b } else { a });
    let angle = simplex::angle_between(&(first - last).unit(), &far.unit());
    angle.min(PI - angle) >= ACROSS
}

/// True when a closed outline ends with a base, a straight side between two corners; the outline is rotated to start
/// after this side.
fn ends_with_base(marks: &mut [Mark]) -> bool {
    let points: Vec<Vector<2>> = marks.iter().map(|m| m.point).collect();
    let (corners, last) = (corners(&points, false), marks.len() - 1);
    let is_base = |marks: &[Mark]| {
        let width = (marks[0].point - marks[last].point).norm();
        width <= OPEN * extent(&points) && is_across(marks)
    };
    if !corners.contains(&0) {
        return false;
    }
    if corners.contains(&last) && is_base(marks) {
        return true;
    }
    if !corners.contains(&1) {
        return false;
    }
    marks.rotate_left(1);
    let found = is_base(marks);
    if !found {
        marks.rotate_right(1);
    }
    found
}

/// Removes points that are nearer than `within` to the previous one.
fn drop_repeated(file: &str, marks: &mut Vec<Mark>, within: f64, notes: &mut Vec<String>) {
    let mut lines = Vec::new();
    marks.dedup_by(|b, a| {
        let same = (b.point - a.point).norm() <= within;
        lines.extend(same.then_some(b.line));
        same
    });
    if let Some(line) = lines.first() {
        let count = lines.len();
        let more = if count > 1 {
            format!("{count} points repeat the one before, the first in")
        } else {
            "the point of".into()
        };
        let end = if count > 1 { "" } else { " repeats the one before" };
        notes.push(format!("{file}: {more} line {line}{end}: left out"));
    }
}

/// Reverses a clockwise outline and returns whether it did; rejects an outline without area.
fn orient(file: &str, marks: &mut [Mark], notes: &mut Vec<String>) -> Result<bool, GeometryError> {
    let origin = marks[0].point;
    let twice = (1..marks.len() - 1)
        .map(|i| {
            let (u, v) = (marks[i].point - origin, marks[i + 1].point - origin);
            u[0] * v[1] - u[1] * v[0]
        })
        .sum::<f64>();
    let size = extent(&marks.iter().map(|m| m.point).collect::<Vec<_>>());
    let flat = twice.abs() <= SAME * size * size;
    if flat || size < SMALLEST || !twice.is_finite() {
        return Err(GeometryError::refused(file, "the outline encloses no area", "check the second coordinate"));
    }
    if twice < 0.0 {
        notes.push(format!("{file}: the points run clockwise and are taken in reverse order"));
        marks.reverse();
    }
    Ok(twice < 0.0)
}

/// Indices of the corners of a closed outline that starts at the trailing edge; with a base, its two ends are corners.
fn corners(points: &[Vector<2>], base: bool) -> Vec<usize> {
    let n = points.len();
    let turn = |i: usize| {
        let (before, here, after) = (points[(i + n - 1) % n], points[i % n], points[(i + 1) % n]);
        simplex::angle_between(&(here - before).unit(), &(after - here).unit())
    };
    let tail = if base { (points[0] + points[n - 1]) * 0.5 } else { points[0] };
    let nose = (0..n).fold(0, |a, i| if (points[i] - tail).norm() > (points[a] - tail).norm() { i } else { a });
    let chord = (points[nose] - tail).norm();
    let sharp = |i: usize| {
        let around = turn(i + n - 1).max(turn(i + 1));
        let rounded = (points[i] - points[nose]).norm() < NOSE * chord && around > SHARP_NOSE * turn(i);
        turn(i) > CORNER && !rounded
    };
    (0..n).filter(|&i| sharp(i) || (base && (i == 0 || i == n - 1))).collect()
}

/// Reports gaps between two points that are much farther apart than their neighbours where the outline is curved:
/// points may be missing. Sides that end at corners are excluded, because they may be straight.
fn wide_gaps(marks: &[Mark], corners: &[usize], chord: f64) -> Vec<String> {
    /// Ratio to the longer of the two adjacent sides above which a gap is wide.
    const WIDE: f64 = 2.5;
    /// Smallest height of the arc over the gap, as a fraction of the chord: the possible error of a spline there.
    const HEIGHT: f64 = 2e-4;
    let n = marks.len();
    let side = |i: usize| marks[(i + 1) % n].point - marks[i % n].point;
    let gap = |i: usize| {
        let [before, here, after] = [side(i + n - 1), side(i), side(i + 1)];
        let times = here.norm() / before.norm().max(after.norm());
        let turned = simplex::angle_between(&before.unit(), &after.unit());
        let height = turned * here.norm() / (8.0 * chord);
        let smooth = !corners.contains(&i) && !corners.contains(&((i + 1) % n));
        (smooth && times > WIDE && height > HEIGHT).then(|| {
            let (from, to) = (at(&marks[i]), at(&marks[(i + 1) % n]));
            format!("{times:.1} times as far from {from} to {to} as beside it: are points missing there?")
        })
    };
    (0..n).filter_map(gap).collect()
}

/// Spline pieces between corners. An outline without corners is a single piece with a common tangent at its ends; a
/// `base` is a straight side, the last one.
fn pieces(points: &[Vector<2>], corners: &[usize], base: bool, chord: f64) -> Vec<Vec<Sample>> {
    let n = points.len();
    if corners.is_empty() {
        let along = End::Along((points[1] - points[n - 1]).unit());
        let ring = (0..=n).map(|i| points[i % n]).collect();
        return vec![sample(&Spline::new(ring, along, along), chord)];
    }
    let piece = |(k, &start): (usize, &usize)| {
        let next = if k + 1 < corners.len() { corners[k + 1] } else { corners[0] + n };
        if base && start == n - 1 {
            return straight(points[start], points[0]);
        }
        let part: Vec<Vector<2>> = (start..=next).map(|i| points[i % n]).collect();
        sample(&Spline::new(part, End::Natural, End::Natural), chord)
    };
    corners.iter().enumerate().map(piece).collect()
}

/// Points and outward normals along a spline, with the density of [`SAGITTA`] and [`SEGMENTS`].
fn sample(spline: &Spline<2>, chord: f64) -> Vec<Sample> {
    let sample = |(i, s)| {
        let (point, tangent) = spline.at(i, s);
        (point, right_of(tangent))
    };
    parts(spline, chord).into_iter().map(sample).collect()
}

/// Points along a spline with this density.
fn places<const D: usize>(spline: &Spline<D>, chord: f64) -> Vec<Vector<D>> {
    parts(spline, chord).into_iter().map(|(i, s)| spline.at(i, s).0).collect()
}

/// Intervals of a spline, and fractions of them, with this density.
fn parts<const D: usize>(spline: &Spline<D>, chord: f64) -> Vec<(usize, f64)> {
    let mut all = Vec::new();
    for i in 0..spline.intervals() {
        let bend = (spline.sagitta(i) / (SAGITTA * chord)).sqrt();
        let parts = bend.max(spline.chord(i) * SEGMENTS / chord).ceil().clamp(1.0, PARTS);
        all.extend((0..parts as usize).map(|k| (i, k as f64 / parts)));
    }
    all.push((spline.intervals() - 1, 1.0));
    all
}

/// Unit normal to the right of a direction, which is outward for counter-clockwise outlines.
fn right_of(direction: Vector<2>) -> Vector<2> {
    Vector([direction[1], -direction[0]]).unit()
}
