//! NACA sections of four and five digits, modified or not, and of the 6-series.
//!
//! Half thickness is laid off perpendicular to a mean line (Jacobs, Ward, Pinkerton, NACA report 460, 1933). In s = √x all functions
//! are smooth, so the outline and its normals are exact through the leading edge.
mod mean_line;
mod six_series;
mod thickness;

use std::f64::consts::PI;

use self::thickness::Thickness;
use super::GeometryError;
use super::marks::CORNER;
use super::outline::{self, Sample};
use super::shell::Shell;
use crate::case::{MeanLine, Naca, NoSection, TrailingEdge};
use crate::math::Vector;

/// Segments of each side: the chord error, largest at the nose, is 0.63/N² of the chord at any thickness.
const SEGMENTS: usize = 3200;

/// A section as a function of s = √(x / extent).
struct Section {
    line: MeanLine,
    thickness: Thickness,
    /// Both sides meet at the end.
    sharp: bool,
    extent: f64,
}

/// The outline of a NACA section of unit chord, leading edge at the origin.
pub(super) fn shell(naca: &Naca) -> Result<Shell<2>, GeometryError> {
    let section = Section::new(naca)?;
    let s = |i: usize| (0.5 * PI * i as f64 / SEGMENTS as f64).sin();
    let mut outline: Vec<Sample> = (0..=SEGMENTS).rev().map(|i| section.point(s(i), 1.0)).collect();
    outline.extend((1..=SEGMENTS).map(|i| section.point(s(i), -1.0)));
    let mut pieces = vec![outline];
    if !section.sharp {
        let ends = (pieces[0][2 * SEGMENTS].0, pieces[0][0].0);
        pieces.push(outline::straight(ends.0, ends.1));
    }
    Ok(outline::shell_of_pieces(&pieces, CORNER))
}

impl Section {
    fn new(naca: &Naca) -> Result<Self, GeometryError> {
        let design = naca.design();
        let refused = |no| {
            let NoSection { what, hint } = no;
            GeometryError::refused(format!("`naca = \"{}\"`", naca.digits), what, hint)
        };
        let design = design.map_err(refused)?;
        let closed = naca.trailing_edge == TrailingEdge::Closed;
        let thickness = Thickness::new(design.thickness, design.form, closed);
        let extended = naca.trailing_edge == TrailingEdge::Extended;
        let extent = if extended { thickness.end() } else { 1.0 };
        let sharp = closed || extended || thickness.at(1.0).0 == 0.0;
        Ok(Self { line: design.line, thickness, sharp, extent })
    }

    /// Point and outward normal at √(x / extent) on the upper (`sign` 1) or lower (−1) side.
    fn point(&self, fraction: f64, sign: f64) -> (Vector<2>, Vector<2>) {
        let s = fraction * self.extent.sqrt();
        let x = s * s;
        // The closed ends are zero by definition; rounding would leave 1e-17 and open the outline.
        let (value, half_slope) = self.thickness.at(s);
        let half = if self.sharp && fraction == 1.0 { 0.0 } else { value };
        let (height, slope, bend) = mean_line::at(&self.line, x);
        let along = Vector([1.0, slope]).unit();
        let across = Vector([-along[1], along[0]]);
        let turning = 2.0 * s * bend / (1.0 + slope * slope);
        let point = (Vector([x, height]) + across * (sign * half)) * (1.0 / self.extent);
        let tangent =
            Vector([2.0 * s, 2.0 * s * slope]) + across * (sign * half_slope) - along * (sign * half * turning);
        // The tangent points downstream: the upper normal is on its left, the lower one on its right.
        (point, (Vector([-tangent[1], tangent[0]]) * sign).unit())
    }
}

#[cfg(test)]
mod tests {
    use super::super::surface::{Nearest, Surface};
    use super::*;

    fn section(digits: &str, trailing_edge: TrailingEdge) -> Shell<2> {
        shell(&Naca { digits: digits.into(), trailing_edge }).unwrap()
    }

    /// Rows `x_c, closed, open, extended` computed independently from the published polynomial.
    const TABLE: &str = include_str!("../testdata/naca0012_formula_variants.csv");

    #[test]
    fn thickness_follows_the_published_polynomial() {
        let kinds = [TrailingEdge::Closed, TrailingEdge::Blunt, TrailingEdge::Extended];
        for (column, kind) in kinds.into_iter().enumerate() {
            let s = Section::new(&Naca { digits: "0012".into(), trailing_edge: kind }).unwrap();
            for line in TABLE.lines().skip_while(|l| !l.starts_with(char::is_numeric)) {
                let row: Vec<f64> = line.split(',').map(|v| v.parse().unwrap()).collect();
                let (p, _) = s.point(row[0].sqrt(), 1.0);
                assert!(
                    (p[0] - row[0]).abs() < 1e-12 && (p[1] - row[1 + column]).abs() < 1.5e-8,
                    "{kind:?} {row:?} {p:?}"
                );
            }
        }
    }

    #[test]
    fn the_extended_section_ends_where_the_polynomial_vanishes() {
        let s = Section::new(&Naca { digits: "0012".into(), trailing_edge: TrailingEdge::Extended }).unwrap();
        assert!((s.extent - 1.008930411).abs() < 1e-9);
    }

    #[test]
    fn chords_and_normals_are_accurate() {
        for digits in ["0012", "2412", "4424", "0003"] {
            let shell = section(digits, TrailingEdge::Closed);
            let surface = Surface::new(&[("wing".into(), shell)]);
            for (e, element) in surface.elements.iter().enumerate() {
                let (x, _) = surface.element_point(e as u32, &[0.5, 0.5]);
                // The parabolas of the mean line meet with a jump of curvature: a cambered section has a true kink there.
                if (x[0] - 0.4).abs() < 1e-2 {
                    continue;
                }
                let near = Nearest {
                    point: x,
                    normal: element.normals[0],
                    distance: 0.0,
                    element: e as u32,
                    weights: [0.5; 2],
                };
                assert!((surface.project(&near).point - x).norm() < 1e-7, "{digits} {x:?}");
                let n = surface.element_area_vector(e as u32).unit();
                let mean = (element.normals[0] + element.normals[1]).unit();
                assert!((n - mean).norm() < 2e-4, "{digits} {x:?}");
            }
            assert_eq!(surface.sharp.len(), 1, "{digits}");
            assert!(surface.intersection().is_none());
        }
    }

    #[test]
    fn nose_radius_is_the_published_one() {
        let surface = Surface::new(&[("wing".into(), section("0012", TrailingEdge::Blunt))]);
        let nose = surface.nearest(&Vector([-0.1, 0.0]), 1.0).unwrap();
        // 1.1019 τ² (Abbott and von Doenhoff 1959, p. 113)
        assert!((surface.radius[nose.element as usize] / (1.1019 * 0.0144) - 1.0).abs() < 1e-3);
        assert_eq!(surface.sharp.len(), 2);
    }

    #[test]
    fn bad_digits_are_refused() {
        for digits in ["", "12", "0000", "2012", "23612", "66A010", "00a2", "00-12"] {
            let naca = Naca { digits: digits.into(), trailing_edge: TrailingEdge::Closed };
            assert!(shell(&naca).is_err(), "{digits}");
        }
    }
}
