//! A wing to begin with: tapered, swept back, of a symmetric section, closed at its tips.
use super::shell::{Exact, Shell};
use crate::math::Vector;
use std::f64::consts::PI;

/// Panels of a side of the section, and of the span.
const PANELS: [usize; 2] = [32, 24];
/// Chord at the root and at the tips; the first is one.
const CHORDS: [f64; 2] = [1.0, 0.5];
/// Half of the span.
const HALF_SPAN: f64 = 1.5;
/// How far the leading edge of the tips lies behind that of the root.
const SWEEP: f64 = 0.6;
/// Thickness over chord.
const THICKNESS: f64 = 0.12;
/// Turning angle of sharp edges, radians (40°).
const CREASE: f64 = 40.0 * PI / 180.0;

/// Half the thickness of the four-digit section at `x` of its chord, with a closed trailing edge (Jacobs, Ward and Pinkerton 1933).
fn half_thickness(x: f64) -> f64 {
    let polynomial = 0.2969 * x.sqrt() + x * (-0.126 + x * (-0.3516 + x * (0.2843 - 0.1036 * x)));
    5.0 * THICKNESS * polynomial
}

/// The wing: root chord one, span 3, leading edge along +y, lift along +z, nose of the root at the origin.
pub fn wing() -> Shell<3> {
    let [n, m] = PANELS;
    let ring = 2 * n;
    let station = |j: usize| {
        let y = HALF_SPAN * (-1.0 + 2.0 * j as f64 / m as f64);
        let part = (y / HALF_SPAN).abs();
        let chord = CHORDS[0] + part * (CHORDS[1] - CHORDS[0]);
        (0..ring).map(move |k| {
            // from the trailing edge over the upper side to the nose and back below
            let (i, sign) = if k <= n { (k, 1.0) } else { (ring - k, -1.0) };
            let x = 0.5 * (1.0 + (PI * i as f64 / n as f64).cos());
            let z = if i == 0 || i == n { 0.0 } else { sign * half_thickness(x) };
            Vector([SWEEP * part + chord * x, y, chord * z])
        })
    };
    let vertices: Vec<Vector<3>> = (0..=m).flat_map(station).collect();
    let at = |j: usize, k: usize| (j * ring + k % ring) as u32;
    let mut elements = Vec::new();
    for (j, k) in (0..m).flat_map(|j| (0..ring).map(move |k| (j, k))) {
        elements.extend([[at(j, k), at(j + 1, k), at(j + 1, k + 1)], [at(j, k), at(j + 1, k + 1), at(j, k + 1)]]);
    }
    // tips: strips between the upper and the lower side
    for (j, turned) in [(0, false), (m, true)] {
        for i in 0..n {
            let (upper, next) = ([at(j, i), at(j, ring - i)], [at(j, i + 1), at(j, ring - i - 1)]);
            let strips = [[upper[0], next[0], next[1]], [upper[0], next[1], upper[1]]];
            let kept = strips.into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2]);
            elements.extend(kept.map(|[a, b, c]| if turned { [a, c, b] } else { [a, b, c] }));
        }
    }
    Shell {
        vertices,
        elements,
        normals: None,
        tags: Vec::new(),
        tag_names: Vec::new(),
        exact: Exact::None,
        crease: CREASE,
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::Surface;
    use super::*;

    #[test]
    fn it_bounds_a_volume_and_mirrors() {
        let surface = Surface::new(&[("wing".into(), wing())]);
        let all = 0..surface.elements.len() as u32;
        let area = all.map(|e| surface.element_area_vector(e)).fold(Vector::ZERO, |a, b| a + b);
        assert!(surface.is_closed() && area.norm() < 1e-12, "{area:?}");
        // sections of area 0.0822 chord², chords from 1 to 0.5: 2 · 1.5 · (1 + 0.5 + 0.25)/3 · 0.0822
        let exact = 1.75 * 0.0822;
        assert!((surface.volume() / exact - 1.0).abs() < 0.01, "{}", surface.volume());
        assert!(surface.inside(&Vector([0.5, 0.0, 0.0])) && !surface.inside(&Vector([0.1, 1.4, 0.0])));
    }
}
