//! Moments of control surfaces about their hinges.
//!
//! A control surface is what of a body lies behind the hinge line, along the stream across it, and between its ends. With the unit
//! vector e along the line, H = Σ e · (x − x_0) × F is positive by the right-hand rule: for a line from left to right (y) where it turns the
//! trailing edge down. A piece of wall across the line counts with its part behind it. Coefficients are of the control surface itself, C_h =
//! H/(q S_f c_f), with its area S_f as seen across line and stream and its mean chord c_f = S_f over the length of the line (Abbott and von
//! Doenhoff, *Theory of Wing Sections*, 1959, §8.1); in the plane H/(q c_f²).
use serde::{Deserialize, Serialize};

/// A hinge line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line {
    /// One end.
    pub from: [f64; 3],
    /// The other; in the plane nothing.
    pub to: Option<[f64; 3]>,
}

/// A piece of wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Its place.
    pub x: [f64; 3],
    /// Its area vector; in the plane its length.
    pub area: [f64; 3],
    /// Force on it, over the pressure that makes it one.
    pub force: [f64; 3],
}

/// The moment about a hinge.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HingeMoment {
    /// Name of the hinge.
    pub name: String,
    /// Moment, in the units of the case; in the plane per unit of span.
    pub moment: f64,
    /// Moment over dynamic pressure, area and chord of the control surface.
    pub coefficient: f64,
    /// Area of the control surface; in the plane its chord.
    pub area: f64,
    /// Mean chord of the control surface.
    pub chord: f64,
}

/// Moment, area and mean chord of what lies behind a line.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Behind {
    /// Moment about the line.
    pub moment: f64,
    /// Area seen across line and stream; in the plane the chord.
    pub area: f64,
    /// Area over the length of the line.
    pub chord: f64,
}

/// Adds up the pieces behind a line.
pub fn behind(line: &Line, pieces: impl Iterator<Item = Patch>) -> Behind {
    let (along, length) = line.direction();
    // the stream across the line
    let aft = unit(&across(&[1.0, 0.0, 0.0], &along));
    let up = cross(&along, &aft);
    let mut sum = Behind::default();
    for piece in pieces {
        let d: [f64; 3] = std::array::from_fn(|k| piece.x[k] - line.from[k]);
        let spanwise = length.map_or(1.0, |l| {
            part(dot(&d, &along), extent(&piece.area, &along)) - part(dot(&d, &along) - l, extent(&piece.area, &along))
        });
        let width = if length.is_some() { extent(&piece.area, &aft) } else { dot(&piece.area, &up).abs() };
        let share = spanwise * part(dot(&d, &aft), width);
        sum.moment += share * dot(&along, &cross(&d, &piece.force));
        sum.area += 0.5 * share * dot(&piece.area, &up).abs();
    }
    sum.chord = length.map_or(sum.area, |l| sum.area / l);
    sum
}

impl Line {
    /// Its unit vector, and its length in space. In the plane it points so that a moment that turns the trailing edge down is positive.
    fn direction(&self) -> ([f64; 3], Option<f64>) {
        let Some(to) = self.to else { return ([0.0, 0.0, -1.0], None) };
        let d: [f64; 3] = std::array::from_fn(|k| to[k] - self.from[k]);
        (unit(&d), Some(dot(&d, &d).sqrt()))
    }
}

/// The part of a piece of this extent, with its middle at s, that lies beyond nought.
fn part(s: f64, extent: f64) -> f64 {
    if extent > 0.0 { (0.5 + s / extent).clamp(0.0, 1.0) } else { f64::from(u8::from(s > 0.0)) }
}

/// Extent of a square piece along a direction.
fn extent(area: &[f64; 3], along: &[f64; 3]) -> f64 {
    let (size, normal) = (dot(area, area).sqrt(), unit(area));
    (size * (1.0 - dot(&normal, along).powi(2)).max(0.0)).sqrt()
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|k| a[k] * b[k]).sum()
}

fn cross(a: &[f64; 3], b: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
}

/// What of `v` is across the unit vector `e`.
fn across(v: &[f64; 3], e: &[f64; 3]) -> [f64; 3] {
    let s = dot(v, e);
    std::array::from_fn(|k| v[k] - s * e[k])
}

fn unit(v: &[f64; 3]) -> [f64; 3] {
    let size = dot(v, v).sqrt();
    if size > 0.0 { v.map(|c| c / size) } else { *v }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both sides of a plate from x = 0 to 1 and y = 0 to 2 in n × 2n pieces, pressed from below.
    fn plate(n: usize) -> Vec<Patch> {
        let at = |k: usize| (k as f64 + 0.5) / n as f64;
        let size = 1.0 / (n * n) as f64;
        let one = |k: usize, side: f64| {
            let area = [0.0, 0.0, side * size];
            let force = [0.0, 0.0, if side < 0.0 { size } else { 0.0 }];
            Patch { x: [at(k % n), at(k / n), 0.0], area, force }
        };
        (0..2 * n * n).flat_map(|k| [one(k, 1.0), one(k, -1.0)]).collect()
    }

    #[test]
    fn a_flap_under_constant_load_has_half_its_chord_as_lever() {
        // hinge at 70 %: 0.3 long, pressed up over half the span: turns the trailing edge up
        let line = Line { from: [0.7, 0.5, 0.0], to: Some([0.7, 1.5, 0.0]) };
        let found = behind(&line, plate(64).into_iter());
        assert!((found.area - 0.3).abs() < 1e-12 && (found.chord - 0.3).abs() < 1e-12, "{found:?}");
        assert!((found.moment + 0.5 * 0.3 * 0.3).abs() < 1e-3, "{found:?}");
        // the other way round the sign changes
        let back = Line { from: [0.7, 1.5, 0.0], to: Some([0.7, 0.5, 0.0]) };
        assert!((behind(&back, plate(64).into_iter()).moment + found.moment).abs() < 1e-12);
    }

    #[test]
    fn in_the_plane_a_line_is_a_point() {
        let at = |k: usize| (k as f64 + 0.5) / 50.0;
        let pieces = (0..50).flat_map(|k| {
            let one = |side: f64| Patch {
                x: [at(k), 0.0, 0.0],
                area: [0.0, side / 50.0, 0.0],
                force: [0.0, if side < 0.0 { 1.0 / 50.0 } else { 0.0 }, 0.0],
            };
            [one(1.0), one(-1.0)]
        });
        let found = behind(&Line { from: [0.75, 0.0, 0.0], to: None }, pieces);
        assert!((found.chord - 0.25).abs() < 1e-12 && (found.moment + 0.5 * 0.0625).abs() < 1e-3, "{found:?}");
    }
}
