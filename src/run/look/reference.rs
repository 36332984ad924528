//! Reference values: those of the case, else those of the planform of its bodies.
use crate::case::Case;
use crate::cloud::CloudSpec;
use crate::geometry::{Planform, Surface};

/// Chord and area that coefficients are made with.
pub(crate) fn planform<const D: usize>(case: &Case, surface: &Surface<D>) -> Planform {
    let given = &case.reference;
    let body = given.body.as_ref().and_then(|name| surface.bodies.iter().position(|b| b == name));
    let seen = surface.planform(&CloudSpec::of_case(case).limits(), body);
    Planform { chord: given.chord.map_or(seen.chord, |c| c.0), area: given.area.unwrap_or(seen.area), ..seen }
}

/// Reference chord: that of the case, else of its bodies; 1 without any.
pub(crate) fn chord<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> f64 {
    let of = |surface| planform(case, surface).chord;
    case.reference.chord.map_or_else(|| surface.map_or(1.0, of), |c| c.0)
}
