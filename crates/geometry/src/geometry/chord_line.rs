//! Chord lines of sections, from the leading edge to the trailing edge, for any orientation of the section.
//!
//! The chord line of a NACA section is that of its formulas. An outline from a file starts at its trailing edge, or at
//! the two ends of its base; its leading edge is the point farthest from there. For other shapes, the foremost and
//! rearmost points along the axis of the shape nearest to the stream are used.
//!
//! The section of a wing is normalised to unit chord with its nose at x = 0, because its chord is a key of the wing.
use std::f64::consts::{FRAC_PI_2, PI};

use super::GeometryError;
use super::placement::{placed, turned};
use super::shell::Shell;
use super::simplex;
use crate::case::{Body, Shape};
use crate::math::{Bounds, Vector};

/// Distances from (0, 0) and (1, 0), in chords, within which an outline counts as a section of unit chord. The leading
/// edge of a table is where the table defines it, which on cambered sections is not the farthest point.
const UNIT_NOSE: f64 = 0.02;
const UNIT_TAIL: f64 = 0.005;
/// Relative distance within which points are equally far back.
const SAME: f64 = 1e-6;
/// Angle between a chord line and the x axis above which a warning is given (rad) (60°).
const ACROSS: f64 = PI / 3.0;
/// Distance from the trailing edge, as a fraction of the chord, within which corners belong to a base.
const BASE: f64 = 0.1;

/// Warning for an outline that is much thicker near its trailing edge than near its nose.
const DRAWN_BACKWARDS: &str =
    "it is round where its trailing edge should be, and sharp at its nose: it is drawn backwards";

/// Leading and trailing edge of `body`, whose outline before placement is `shell`.
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

/// Chord line of an outline that starts at its trailing edge. For an outline with sharp ends on both sides, the nose is
/// the end at smaller x.
pub(super) fn of_outline(shell: &Shell<2>) -> [Vector<2>; 2] {
    let points = &shell.vertices;
    let (first, last) = (points[0], points[points.len() - 1]);
    let corners = corners(shell);
    let blunt = corners.contains(&last);
    let tail = if blunt { (first + last) * 0.5 } else { first };
    let far = |x: &&Vector<2>| (**x - tail).norm_squared();
    let nose = points.iter().max_by(|a, b| far(a).total_cmp(&far(b))).copied().unwrap_or(tail);
    let sharp = !blunt && corners.contains(&nose) && corners.contains(&tail);
    if sharp && tail[0] < nose[0] { [tail, nose] } else { [nose, tail] }
}

/// Sharp corners of an outline.
fn corners(shell: &Shell<2>) -> Vec<Vector<2>> {
    shell.features().edges.iter().map(|edge| edge.ends[0]).collect()
}

/// From the foremost to the rearmost points of a shape that is rotated nose up by `angle`.
fn along(shell: &Shell<2>, angle: f64) -> [Vector<2>; 2] {
    // along the axis of the shape, because small angles do not change which points are foremost
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

/// A warning about a section whose chord line, after placement, is not directed downstream; `line` is that of the
/// shape.
pub(super) fn astray(name: &str, body: &Body, shell: &Shell<2>, line: &[Vector<2>; 2]) -> Option<String> {
    if !matches!(body.shape, Shape::Naca(_) | Shape::Airfoil(_)) {
        return None;
    }
    let [nose, tail] = line.map(|x| placed(&x, &body.placement));
    let way = if matches!(body.shape, Shape::Airfoil(_)) && is_reversed(shell, line) {
        DRAWN_BACKWARDS.to_owned()
    } else {
        let (edge, way) = way(&(tail - nose))?;
        format!("its {edge} {way}")
    };
    Some(format!(
        "body `{name}`: {way}; a section has its nose at smaller x than its trailing edge: turn it with `rotate`"
    ))
}

/// A warning about a wing whose chords are not directed downstream.
pub(super) fn wing_astray(name: &str, body: &Body) -> Option<String> {
    if !matches!(body.shape, Shape::Wing(_)) {
        return None;
    }
    let (edge, way) = way(&turned(&Vector([1.0, 0.0, 0.0]), &body.placement))?;
    Some(format!(
        "body `{name}`: its {edge} {way}; a wing has its leading edge at smaller x than its trailing edge: change `rotate`"
    ))
}

/// The section of a wing from a file, with its nose at x = 0 and unit chord; a section that is given so is unchanged.
pub(super) fn section_of_wing(
    file: &str,
    mut shell: Shell<2>,
    notes: &mut Vec<String>,
) -> Result<Shell<2>, GeometryError> {
    /// Greatest deviation of the ends from 0 and 1, as a fraction of the chord, that needs no message. Noses of
    /// cambered sections extend beyond 0, and sections are shortened or extended by less for a blunt or sharp end.
    const WITHIN: f64 = 0.01;
    /// Height of the nose above its axis, in chords, above which a section is displaced; it is less when drawn from a
    /// flat lower side.
    const HIGH: f64 = 0.2;
    let line = of_outline(&shell);
    let [nose, tail] = line;
    if let Some((edge, way)) = way(&(tail - nose)) {
        let ends = line.map(|x| format!("({:.6}, {:.6})", x[0], x[1]));
        let what = format!("the {edge} {way}: the nose is at {}, the trailing edge at {}", ends[0], ends[1]);
        let hint = "the section of a wing has its nose at smaller x than its trailing edge: turn its coordinates, or exchange its columns";
        return Err(GeometryError::refused(file, what, hint));
    }
    if is_reversed(&shell, &line) {
        notes.push(format!("{file}: {DRAWN_BACKWARDS}; the section of a wing has its nose at smaller x"));
    }
    let bounds = Bounds::around(&shell.vertices);
    let (low, high) = (bounds.min[0], bounds.max[0]);
    let origin = if low.abs() > WITHIN * (high - low) {
        Vector([low, nose[1]])
    } else if nose[1].abs() > HIGH * (high - low) {
        Vector([0.0, nose[1]])
    } else {
        Vector::ZERO
    };
    let chord = high - origin[0];
    if origin == Vector::ZERO && (chord - 1.0).abs() <= WITHIN {
        return Ok(shell);
    }
    notes.push(format!(
        "{file}: the section of the wing goes from x = {low:.6} to {high:.6}, its nose is at y = {:.6}: it is moved to the origin, and its chord is \
         taken as 1",
        nose[1]
    ));
    shell.vertices.iter_mut().for_each(|x| *x = (*x - origin) * (1.0 / chord));
    Ok(shell)
}

/// Which edge or line of a section has a wrong direction, for the vector `chord` from nose to tail; `None` when it is
/// directed downstream.
fn way<const D: usize>(chord: &Vector<D>) -> Option<(&'static str, String)> {
    let off = simplex::angle_between(&chord.unit(), &Vector::axis(0));
    let degrees = off.to_degrees();
    if off > PI - ACROSS {
        Some(("trailing edge", format!("is upstream, {degrees:.0} deg from the x axis")))
    } else if off > ACROSS {
        Some(("chord line", format!("runs across the stream, {degrees:.0} deg from the x axis")))
    } else {
        None
    }
}

/// True for a section without base that is much thicker near its trailing edge than near its nose.
fn is_reversed(shell: &Shell<2>, [nose, tail]: &[Vector<2>; 2]) -> bool {
    /// Distance from an end, as a fraction of the chord, at which the thickness is compared, and the ratio above which
    /// it is much thicker.
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
    let rear = corners(shell).iter().filter(|x| (**x - *tail).dot(&along) > -BASE * chord).count();
    rear < 2 && thickness(tail) > MUCH * thickness(nose)
}

#[cfg(test)]
mod tests {
    use super::super::airfoil;
    use super::*;

    /// Points of a section 20 % thick with a base of this width: from the upper corner of it to the nose and back.
    fn flatback(base: f64) -> Vec<[f64; 2]> {
        let side = |sign: f64| {
            (0..=40).map(move |k| {
                let x = 0.5 + 0.5 * (PI * f64::from(k) / 40.0).cos();
                let half = 0.2969 * x.sqrt() - 0.126 * x - 0.3516 * x * x + 0.2843 * x.powi(3) - 0.1036 * x.powi(4);
                [x, sign * (half.max(0.0) + 0.5 * base * x)]
            })
        };
        side(1.0).chain(side(-1.0).rev().skip(1)).collect()
    }

    fn text(points: &[[f64; 2]]) -> String {
        points.iter().map(|[x, y]| format!("{x} {y}\n")).collect()
    }

    fn shell(points: &[[f64; 2]]) -> Shell<2> {
        airfoil::read("s.dat", text(points).as_bytes(), 1.0, &mut Vec::new()).unwrap_or_else(|e| panic!("{e}"))
    }

    fn body() -> Body {
        let case = crate::case::read("[flow]\nmach = 0.3\n[[body]]\nname = \"a\"\nairfoil = \"s.dat\"\n", "t");
        case.unwrap_or_else(|e| panic!("{e}")).bodies.remove(0)
    }

    #[test]
    fn bases_are_found_however_wide_and_however_they_are_drawn() {
        for base in [0.01, 0.05, 0.2, 0.3] {
            for (scale, degrees) in [(1.0, 0.0), (300.0, 0.0), (1.0, 30.0), (0.35, -20.0)] {
                let (sin, cos) = f64::to_radians(degrees).sin_cos();
                let turn = |[x, y]: [f64; 2]| [scale * (cos * x - sin * y), scale * (sin * x + cos * y)];
                let open: Vec<[f64; 2]> = flatback(base).into_iter().map(turn).collect();
                let last = open[open.len() - 1];
                let closed = [open.clone(), vec![open[0]]].concat();
                let from_below = [vec![last], open.clone()].concat();
                let clockwise = closed.iter().rev().copied().collect::<Vec<_>>();
                for points in [open, closed, from_below, clockwise] {
                    let shell = shell(&points);
                    let line = chord_line(&body(), &shell);
                    let wanted = [Vector([0.0, 0.0]), Vector(turn([1.0, 0.0]))];
                    let off = (0..2).map(|k| (line[k] - wanted[k]).norm()).fold(0.0, f64::max);
                    assert!(off < 1e-9 * scale, "base {base}, {scale} times, {degrees} deg: {line:?}");
                    assert_eq!(astray("a", &body(), &shell, &line), None);
                }
            }
        }
    }

    #[test]
    fn lenses_have_their_nose_at_smaller_x_wherever_they_begin() {
        let side = |sign: f64| (0..=40).map(move |k| f64::from(k) / 40.0).map(move |x| [x, sign * 0.2 * x * (1.0 - x)]);
        let from_nose: Vec<[f64; 2]> = side(1.0).chain(side(-1.0).rev().skip(1)).collect();
        let from_rear: Vec<[f64; 2]> = side(1.0).rev().chain(side(-1.0).skip(1)).collect();
        for points in [from_nose, from_rear] {
            let shell = shell(&points);
            let line = chord_line(&body(), &shell);
            assert_eq!((line, astray("a", &body(), &shell, &line)), ([Vector([0.0, 0.0]), Vector([1.0, 0.0])], None));
        }
    }

    #[test]
    fn sections_of_wings_that_are_drawn_right_stay_as_they_are() {
        let camber = |[x, y]: [f64; 2]| [x, y + 0.2 * x * (1.0 - x)];
        let flat_below = |[x, y]: [f64; 2]| [x, y + 0.06];
        let drooped = |[x, y]: [f64; 2]| [x, y - 0.02 * x];
        for change in [|x: [f64; 2]| x, camber, flat_below, drooped] {
            for base in [0.0, 0.0014, 0.2] {
                let outline = shell(&flatback(base).into_iter().map(change).collect::<Vec<_>>());
                let mut notes = Vec::new();
                let fitted = section_of_wing("s.dat", outline.clone(), &mut notes).unwrap();
                assert!(fitted.vertices == outline.vertices && notes.is_empty(), "{notes:?}");
            }
        }
    }

    #[test]
    fn sections_of_wings_in_any_unit_and_place_are_those_of_unit_chord() {
        let wanted = shell(&flatback(0.01));
        for (scale, [x0, y0]) in [(300.0, [0.0, 0.0]), (0.35, [0.0, 0.0]), (350.0, [1200.0, 40.0]), (1.0, [-0.25, 0.0])]
        {
            let moved = flatback(0.01).into_iter().map(|[x, y]| [x0 + scale * x, y0 + scale * y]);
            let outline = shell(&moved.collect::<Vec<_>>());
            let mut notes = Vec::new();
            let fitted = section_of_wing("s.dat", outline, &mut notes).unwrap();
            let bounds = [&fitted, &wanted].map(|s| Bounds::around(&s.vertices));
            let off = (bounds[0].min - bounds[1].min).norm().max((bounds[0].max - bounds[1].max).norm());
            assert!(off < 1e-6 && notes.len() == 1 && notes[0].contains("its chord is taken as 1"), "{off} {notes:?}");
        }
        for (turn, told) in [
            ((|[x, y]| [y, x]) as fn([f64; 2]) -> [f64; 2], "s.dat: the chord line runs across the stream, 90 deg"),
            (|[x, y]| [1.0 - x, y], "s.dat: the trailing edge is upstream, 180 deg"),
        ] {
            let outline = shell(&flatback(0.0).into_iter().map(turn).collect::<Vec<_>>());
            let found = section_of_wing("s.dat", outline, &mut Vec::new()).unwrap_err().to_string();
            assert!(found.contains(told), "{found}");
        }
    }
}
