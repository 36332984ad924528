//! Points of outlines, and the lines of the files that list them.
use super::shell::{Exact, Shell};
use crate::math::{Bounds, Vector};
use std::f64::consts::PI;

/// Turning angle of a sharp corner of an airfoil, radians (35°).
pub(super) const CORNER: f64 = 35.0 * PI / 180.0;
/// Points nearer than this fraction of the extent are one point.
pub(super) const SAME: f64 = 1e-9;

/// A point of an outline and the line of the file that it stands in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) point: Vector<2>,
    pub(super) line: usize,
}

/// Longest side of the box around the points.
pub(super) fn extent<const D: usize>(points: &[Vector<D>]) -> f64 {
    if points.is_empty() { 0.0 } else { Bounds::around(points).extent().max_abs() }
}

/// The coordinates of a point and its line.
pub(super) fn at(mark: &Mark) -> String {
    format!("({}, {}) in line {}", mark.point[0], mark.point[1], mark.line)
}

/// Straight sides between points, the last of which is followed by the first.
pub(super) fn straight_shell(marks: &[Mark]) -> Shell<2> {
    let n = marks.len() as u32;
    Shell {
        vertices: marks.iter().map(|m| m.point).collect(),
        elements: (0..n).map(|i| [i, (i + 1) % n]).collect(),
        normals: None,
        curvature: None,
        tags: Vec::new(),
        tag_names: Vec::new(),
        exact: Exact::None,
        crease: CORNER,
    }
}
