//! Reference values: those of the case, else those of its bodies.
use crate::case::Case;
use crate::cloud::CloudSpec;
use crate::geometry::{Planform, Surface, reference};

/// Chord, area and point that coefficients are made with, but for a point of moments that the case gives.
pub(crate) fn planform<const D: usize>(case: &Case, surface: &Surface<D>) -> Planform {
    let (given, seen) = (&case.reference, of_bodies(case, surface));
    let chord = given.chord.map_or(seen.chord, |c| c.0);
    // forces in the plane are those of a unit of span
    let area = if D == 2 { chord } else { seen.area };
    Planform { chord, area: given.area.unwrap_or(area), ..seen }
}

/// The same of the bodies alone: of the one that the case names, else of those that count.
pub(crate) fn of_bodies<const D: usize>(case: &Case, surface: &Surface<D>) -> Planform {
    let named = case.reference.body.as_ref().and_then(|name| surface.bodies.iter().position(|b| b == name));
    reference(&case.bodies, surface, &CloudSpec::of_case(case).limits(), named)
}

/// Reference chord: that of the case, else of its bodies; 1 without any.
pub(crate) fn chord<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> f64 {
    let of = |surface| planform(case, surface).chord;
    case.reference.chord.map_or_else(|| surface.map_or(1.0, of), |c| c.0)
}
