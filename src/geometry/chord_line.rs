//! Chord lines of sections: from the leading edge to the trailing edge, whichever way a section is drawn and turned.
//!
//! The chord line of a NACA section is the one that its formulas are written for. An outline from a file begins at its trailing edge, or at the two ends
//! of its base; its leading edge is the point farthest from there. Of other shapes the foremost and the rearmost points count, along the
//! axis of the shape that lies nearest to the stream.
use std::f64::consts::{FRAC_PI_2, PI};

use super::placement::placed;
use super::shell::Shell;
use super::simplex;
use crate::case::{Body, Shape};
use crate::math::{Bounds, Vector};

/// Distance in chords from (0, 0) and (1, 0) within which the ends of an outline are those of a section of unit chord: the leading edge of
/// tables is where they put it, which on cambered sections is not the farthest point.
const UNIT_NOSE: f64 = 0.02;
const UNIT_TAIL: f64 = 0.005;
/// Distance in sizes of the shape within which points are as far back as others.
const SAME: f64 = 1e-6;
/// Angle between a chord line and the x axis from which on it is told, radians (60°).
const ACROSS: f64 = PI / 3.0;

/// Leading and trailing edge of `body`, whose outline before it is placed is `shell`.
pub(super) fn chord_line(body: &Body, shell: &Shell<2>) -> [Vector<2>; 2] {
    let unit = [Vector([0.0, 0.0]), Vector([1.0, 0.0])];
    match &body.shape {
        Shape::Naca(_) => unit,
        Shape::Airfoil(_) => {
            let line = of_outline(shell);
            let near = (line[0] - unit[0]).norm() < UNIT_NOSE && (line[1] - unit[1]).norm() < UNIT_TAIL;
            if near { unit } else { line }
        }
        _ => along(shell, body.placement.rotate.first().map_or(0.0, |angle| angle.0)),
    }
}

/// The chord line of an outline that begins at its trailing edge.
fn of_outline(shell: &Shell<2>) -> [Vector<2>; 2] {
    let points = &shell.vertices;
    let (first, last) = (points[0], points[points.len() - 1]);
    let tail = if is_blunt(shell) { (first + last) * 0.5 } else { first };
    let far = |x: &&Vector<2>| (**x - tail).norm_squared();
    let nose = points.iter().max_by(|a, b| far(a).total_cmp(&far(b))).copied();
    [nose.unwrap_or(tail), tail]
}

/// From the foremost points to the rearmost ones of a shape that is turned nose up by `angle`.
fn along(shell: &Shell<2>, angle: f64) -> [Vector<2>; 2] {
    // of the axis of the shape, since small angles do not change which points are foremost
    let quarters = (angle / FRAC_PI_2).round() * FRAC_PI_2;
    let back = Vector([quarters.cos(), quarters.sin()]);
    let size = Bounds::around(&shell.vertices).extent().max_abs();
    let middle_of = |sign: f64| {
        let most = shell.vertices.iter().map(|x| sign * back.dot(x)).fold(f64::NEG_INFINITY, f64::max);
        let ends: Vec<&Vector<2>> = shell.vertices.iter().filter(|x| sign * back.dot(x) > most - SAME * size).collect();
        ends.iter().fold(Vector::ZERO, |sum, x| sum + **x) * (1.0 / ends.len() as f64)
    };
    [middle_of(-1.0), middle_of(1.0)]
}

/// What is told of a section of a file or a formula whose chord line, placed, does not run downstream; `line` is that of the shape.
pub(super) fn astray(name: &str, body: &Body, shell: &Shell<2>, line: &[Vector<2>; 2]) -> Option<String> {
    if !matches!(body.shape, Shape::Naca(_) | Shape::Airfoil(_)) {
        return None;
    }
    let [nose, tail] = line.map(|x| placed(&x, &body.placement));
    let off = simplex::angle_between(&(tail - nose).unit(), &Vector([1.0, 0.0]));
    let way = if matches!(body.shape, Shape::Airfoil(_)) && is_reversed(shell, line) {
        "it is round where its trailing edge should be, and sharp at its nose: it is drawn backwards".to_owned()
    } else if off > PI - ACROSS {
        format!("its trailing edge is upstream, {:.0} deg from the x axis", off.to_degrees())
    } else if off > ACROSS {
        format!("its chord line runs across the stream, {:.0} deg from the x axis", off.to_degrees())
    } else {
        return None;
    };
    Some(format!(
        "body `{name}`: {way}; a section has its nose at smaller x than its trailing edge: turn it with `rotate`"
    ))
}

/// True for a section without base that is much thicker beside its trailing edge than beside its nose.
fn is_reversed(shell: &Shell<2>, [nose, tail]: &[Vector<2>; 2]) -> bool {
    /// Part of the chord beside an end within which thickness is looked at, and times the other from which on it is much thicker.
    const BESIDE: f64 = 0.02;
    const MUCH: f64 = 2.0;
    let (chord, along) = ((*tail - *nose).norm(), (*tail - *nose).unit());
    let thickness = |end: &Vector<2>| {
        let near = |x: &&Vector<2>| (**x - *end).dot(&along).abs() <= BESIDE * chord;
        let across = |x: &Vector<2>| (*x - *end).dot(&Vector([-along[1], along[0]]));
        let ends = shell.vertices.iter().filter(near).map(across);
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], y| [a.min(y), b.max(y)]);
        high - low
    };
    !is_blunt(shell) && thickness(tail) > MUCH * thickness(nose)
}

/// True for an outline that begins and ends at the two corners of a base.
fn is_blunt(shell: &Shell<2>) -> bool {
    let last = shell.vertices[shell.vertices.len() - 1];
    shell.features().edges.iter().any(|edge| edge.ends[0] == last)
}
