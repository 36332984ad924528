//! Airfoil coordinate files.
//!
//! Rows of numbers, separated by blanks, commas or semicolons ([`table`]); `#` begins a comment. The order is detected:
//!
//! - Selig: once around the section from trailing edge to trailing edge, in either direction, or from any other point;
//! - Lednicer: a row of two counts, then both sides from the leading edge to the trailing edge; the counts may be absent, and both
//!   sides may run from the trailing edge;
//! - a header with a column `surface` whose values begin with `u` or `l`;
//! - both sides in one row: `x`, upper, lower, or `x`, lower, upper;
//! - one side only: half thickness of a symmetric section; of several thickness columns the first counts.
//!
//! Columns of a header are recognised by name: `x…` the first coordinate, the next one the second; `pct` in a name
//! means percent of the chord, and so does a chord of 100 from the origin. What was assumed is reported. A file has one element: what follows a
//! closed outline behind a blank line is refused.
mod table;

use super::GeometryError;
use super::marks::Mark;
use super::outline;
use super::shell::Shell;
use crate::math::{Bounds, Vector};
use std::io::Read;
use table::Table;

/// Longest file that is read, bytes: a section with a million points.
pub(super) const LONGEST: u64 = 64 << 20;

/// Length of a chord that is given in percent, and by how much it may differ from that.
const PERCENT: [f64; 2] = [100.0, 1.0];
/// Greatest `scale` of a body whose file is in a unit of length: an inch. With a larger one a chord of 100 is in percent.
const LARGEST_UNIT: f64 = 0.0254;
/// Other factors that are units of length: yard, foot and the unit of the case itself.
const UNITS: [f64; 3] = [0.9144, 0.3048, 1.0];
/// Longest chord in a file that may be one of metres or feet; longer ones are in millimetres, centimetres or inches.
const LONG: f64 = 10.0;
/// Part by which a chord may differ from 1 without a word.
const UNIT: f64 = 0.02;
/// A gap between the ends of an outline is closed where it is at most so many times as long as the longer of the two sides beside it.
const GAP: f64 = 2.5;

/// The smooth shell of the section in `input`, which a body uses with the factor `scale`; `file` names it in messages, `notes` says
/// what was assumed.
pub(super) fn read(
    file: &str,
    input: impl Read,
    scale: f64,
    notes: &mut Vec<String>,
) -> Result<Shell<2>, GeometryError> {
    let mut bytes = Vec::new();
    let input = input.take(LONGEST).read_to_end(&mut bytes);
    input.map_err(|source| GeometryError::Open { file: file.to_string(), source })?;
    let table = table::read(file, &super::plain(file, &bytes)?, notes)?;
    let mut marks = around(file, &table, notes)?;
    if scale > LARGEST_UNIT {
        from_percent(file, &mut marks, notes);
        other_unit(file, &marks, scale, notes)?;
    }
    outline::airfoil(file, marks, notes)
}

/// Scales a section that is given in percent of its chord to a chord of one.
fn from_percent(file: &str, marks: &mut [Mark], notes: &mut Vec<String>) {
    let bounds = Bounds::around(marks.iter().map(|m| &m.point));
    let [chord, within] = PERCENT;
    if bounds.min[0].abs() > within || (bounds.extent()[0] - chord).abs() > within {
        return;
    }
    notes.push(format!(
        "{file}: x goes from {} to {}: coordinates are taken as percent of the chord, and the chord is 1",
        bounds.min[0], bounds.max[0]
    ));
    marks.iter_mut().for_each(|m| m.point = m.point * (1.0 / chord));
}

/// Refuses a file in a small unit of length that is multiplied by the length of a chord, which `chord` is for sections of unit chord; tells where
/// the chord of the body is not the number that was typed.
fn other_unit(file: &str, marks: &[Mark], scale: f64, notes: &mut Vec<String>) -> Result<(), GeometryError> {
    let length = Bounds::around(marks.iter().map(|m| &m.point)).extent().max_abs();
    if UNITS.contains(&scale) || (length - 1.0).abs() <= UNIT {
        return Ok(());
    }
    let what = format!(
        "its section is {length} long, and `chord` (or `scale`) {scale} multiplies it: the body is {} long",
        scale * length
    );
    if length <= LONG || scale * length <= LONG {
        notes.push(format!("{file}: {what}"));
        return Ok(());
    }
    let hint = "`chord` is for sections of unit chord; a file in millimetres takes `scale = \"1 mm\"`, or a part of it for a model";
    Err(GeometryError::refused(file, what, hint))
}

/// Refuses points after a closed outline that a blank line or one of text divides from it: another element, or a camber line.
fn refuse_another(file: &str, marks: &[Mark]) -> Result<(), GeometryError> {
    /// Fewest points of an outline, and of what is more than its end.
    const FEWEST: [usize; 2] = [5, 3];
    /// Greatest gap between the ends of an outline over its extent.
    const CLOSED: f64 = 0.1;
    let size = |marks: &[Mark]| Bounds::around(marks.iter().map(|m| &m.point)).extent().max_abs();
    let gap = |marks: &[Mark]| (marks[0].point - marks[marks.len() - 1].point).norm();
    let another = |k: &usize| {
        let (first, rest) = marks.split_at(*k);
        let closed = is_ring(first) && gap(first) <= CLOSED * size(first);
        // points that close the gap are no farther apart than it is wide, and a second round is told elsewhere
        let ends = size(rest) <= 2.0 * gap(first).max(0.01 * size(first));
        let again = rest.len() == first.len() && rest.iter().zip(first).all(|(a, b)| a.point == b.point);
        closed && !ends && !again
    };
    let [least, more] = FEWEST;
    let divided = |k: &usize| marks[*k].line > marks[k - 1].line + 1;
    let Some(k) = (least..(marks.len() + 1).saturating_sub(more)).filter(divided).find(another) else { return Ok(()) };
    let what = format!("a second line of points begins after the outline that is closed in line {}", marks[k - 1].line);
    let hint = "give one element per file, and a `[[body]]` for each; remove camber lines";
    Err(GeometryError::refused(format!("{file}, line {}", marks[k].line), what, hint))
}

/// The points once around the section, from trailing edge to trailing edge.
fn around(file: &str, table: &Table, notes: &mut Vec<String>) -> Result<Vec<Mark>, GeometryError> {
    let marks: Vec<Mark> = table.rows.iter().map(|r| r.mark).collect();
    if marks.len() < 3 {
        let what = format!("holds {} points", marks.len());
        return Err(GeometryError::refused(file, what, "an airfoil file lists `x y` row by row"));
    }
    if table.has_surface {
        return by_name(file, table);
    }
    let lower: Vec<Mark> = table.rows.iter().filter_map(|r| r.lower).collect();
    if !lower.is_empty() {
        return Ok(join(&marks, &lower));
    }
    refuse_another(file, &marks)?;
    let sides = Sides::of(&marks);
    if let Some(([upper, lower], line)) = table.counts {
        if upper + lower == marks.len() {
            notes.push(format!("{file}: Lednicer order, {upper} and {lower} points"));
            return Ok(join(&marks[..upper], &marks[upper..]));
        }
        let what = format!("announces {upper} and {lower} points but {} follow", marks.len());
        let (Some(cut), place) = (sides.cut, format!("{file}, line {line}")) else {
            let hint = "correct the counts in this line or remove it";
            return Err(GeometryError::refused(format!("{file}, line {line}"), what, hint));
        };
        notes.push(format!(
            "{place}: {what}; the sides are told apart by their places, {cut} and {}",
            marks.len() - cut
        ));
        return Ok(join(&marks[..cut], &marks[cut..]));
    }
    if let Some(cut) = sides.cut {
        let (line, count) = (marks[cut].line, marks.len() - cut);
        let from = if sides.from_rear { "both sides from the trailing edge" } else { "Lednicer order without counts" };
        notes.push(format!("{file}: {from}, {cut} and {count} points, the second side begins in line {line}"));
        return Ok(join(&marks[..cut], &marks[cut..]));
    }
    if sides.is_single {
        return mirrored(file, marks, notes);
    }
    if !sides.ends_at_rear && is_ring(&marks) && !begins_at_an_edge(&marks) {
        let line = marks[0].line;
        notes.push(format!("{file}: once around from ({}, {}) in line {line}", marks[0].point[0], marks[0].point[1]));
        return Ok(from_the_rear(&marks));
    }
    notes.push(format!("{file}: Selig order{}", if table.has_more { "; further columns are not used" } else { "" }));
    Ok(marks)
}

/// What the first coordinates tell of the order of points.
struct Sides {
    /// Where a second side begins at the same edge as the first one.
    cut: Option<usize>,
    /// That edge is the trailing one.
    from_rear: bool,
    /// Points run from one edge to the other once.
    is_single: bool,
    /// The first and the last point are at the trailing edge.
    ends_at_rear: bool,
}

impl Sides {
    fn of(marks: &[Mark]) -> Self {
        let bounds = Bounds::around(marks.iter().map(|m| &m.point));
        let (low, range) = (bounds.min[0], bounds.extent()[0]);
        let at = |k: usize| marks[k].point[0] - low;
        let (front, rear) = (|k: usize| at(k) < 0.25 * range, |k: usize| at(k) > 0.75 * range);
        let last = marks.len() - 1;
        // sides of one point are the gap of a section that is not closed
        let cuts = || 2..last;
        let forward = cuts().find(|k| front(0) && rear(k - 1) && front(*k) && rear(last));
        let backward = cuts().find(|k| rear(0) && front(k - 1) && rear(*k) && front(last));
        Self {
            cut: forward.or(backward),
            from_rear: forward.is_none() && backward.is_some(),
            is_single: (front(0) && rear(last)) || (rear(0) && front(last)),
            ends_at_rear: rear(0) && rear(last),
        }
    }
}

/// True when points are an outline, once around from the rear or two sides, and enclose an area.
fn is_outline(marks: &[Mark]) -> bool {
    /// Least area over the square of the extent.
    const THIN: f64 = 1e-4;
    let sides = Sides::of(marks);
    let size = Bounds::around(marks.iter().map(|m| &m.point)).extent().max_abs();
    let around = match sides.cut {
        Some(cut) => join(&marks[..cut], &marks[cut..]),
        None if sides.ends_at_rear || is_ring(marks) => marks.to_vec(),
        None => return false,
    };
    let origin = around[0].point;
    let twice = around.windows(2).map(|pair| {
        let (u, v) = (pair[0].point - origin, pair[1].point - origin);
        u[0] * v[1] - u[1] * v[0]
    });
    (0.5 * twice.sum::<f64>()).abs() > THIN * size * size
}

/// True when an outline ends where it begins, or one side before that.
fn is_ring(marks: &[Mark]) -> bool {
    let n = marks.len();
    let side = |a: usize, b: usize| (marks[a].point - marks[b].point).norm();
    side(0, n - 1) <= GAP * side(0, 1).max(side(n - 2, n - 1))
}

/// True for an outline whose first and last sides meet in a sharp edge: the trailing edge of a section that is drawn along another axis.
fn begins_at_an_edge(marks: &[Mark]) -> bool {
    /// Cosine of the angle between both sides from which on it is an edge: 45 deg, where noses have more than 90.
    const EDGE: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let n = marks.len();
    let from = |k: usize| marks[k].point - marks[0].point;
    let last = if from(n - 1).norm() > 0.0 { from(n - 1) } else { from(n - 2) };
    from(1).unit().dot(&last.unit()) > EDGE
}

/// Sides by the column `surface`.
fn by_name(file: &str, table: &Table) -> Result<Vec<Mark>, GeometryError> {
    let side = |letter: char| -> Vec<Mark> {
        table.rows.iter().filter(|r| r.surface.starts_with(letter)).map(|r| r.mark).collect()
    };
    let (upper, lower) = (side('u'), side('l'));
    if let Some(row) = table.rows.iter().find(|r| !r.surface.starts_with(['u', 'l'])) {
        let what = format!("`{}` is not a side", row.surface);
        return Err(GeometryError::refused(format!("{file}, line {}", row.mark.line), what, "use `upper` or `lower`"));
    }
    if upper.len() < 2 || lower.len() < 2 {
        let what = format!("has {} upper and {} lower points", upper.len(), lower.len());
        return Err(GeometryError::refused(file, what, "give both sides, or drop the column `surface`"));
    }
    Ok(join(&upper, &lower))
}

/// One side given: the other is its mirror image.
fn mirrored(file: &str, marks: Vec<Mark>, notes: &mut Vec<String>) -> Result<Vec<Mark>, GeometryError> {
    let size = Bounds::around(marks.iter().map(|m| &m.point)).extent().max_abs();
    if let Some(bad) = marks.iter().find(|m| m.point[1] < -1e-9 * size) {
        let what = format!("one side only, and the half thickness {} is negative", bad.point[1]);
        let hint = "list both sides from trailing edge to trailing edge (Selig order)";
        return Err(GeometryError::refused(format!("{file}, line {}", bad.line), what, hint));
    }
    notes.push(format!("{file}: one side with {} points, taken as half thickness of a symmetric section", marks.len()));
    let mirror: Vec<Mark> =
        marks.iter().map(|m| Mark { point: Vector([m.point[0], -m.point[1]]), line: m.line }).collect();
    Ok(join(&marks, &mirror))
}

/// Upper side backwards from the trailing edge, then the lower side; each may be given in either direction.
fn join(upper: &[Mark], lower: &[Mark]) -> Vec<Mark> {
    let from_front = |side: &[Mark]| {
        let mut side = side.to_vec();
        if side[0].point[0] > side[side.len() - 1].point[0] {
            side.reverse();
        }
        side
    };
    let (mut marks, lower) = (from_front(upper), from_front(lower));
    let shared = usize::from(marks[0].point == lower[0].point);
    marks.reverse();
    marks.extend(&lower[shared..]);
    marks
}

/// A closed outline turned to begin and end at its rearmost point.
fn from_the_rear(marks: &[Mark]) -> Vec<Mark> {
    let once = marks.len() - usize::from(marks[0].point == marks[marks.len() - 1].point);
    let marks = &marks[..once];
    let rear = (0..once).fold(0, |a, i| if marks[i].point[0] > marks[a].point[0] { i } else { a });
    let mut turned = marks[rear..].to_vec();
    turned.extend(&marks[..=rear]);
    turned
}

#[cfg(test)]
mod tests;
