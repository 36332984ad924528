//! Reference values: those of the case, else those of the planform of its bodies.
use crate::case::{Case, Shape};
use crate::cloud::CloudSpec;
use crate::geometry::{Planform, Surface};

/// Chord and area that coefficients are made with.
pub(crate) fn planform<const D: usize>(case: &Case, surface: &Surface<D>) -> Planform {
    let given = &case.reference;
    let body = given.body.as_ref().and_then(|name| surface.bodies.iter().position(|b| b == name));
    let seen = match turned(case, surface) {
        Some(angle) => surface.section(body, angle),
        None => surface.planform(&CloudSpec::of_case(case).limits(), body),
    };
    let length = round(case, surface, body).unwrap_or(seen.chord);
    Planform { chord: given.chord.map_or(length, |c| c.0), area: given.area.unwrap_or(seen.area), ..seen }
}

/// Length of bodies that are all spheres, ellipsoids, bodies of revolution or lofts, or of the named one: of a sphere its diameter, which Reynolds
/// numbers are told with, not the mean chord of its shadow.
fn round<const D: usize>(case: &Case, surface: &Surface<D>, body: Option<usize>) -> Option<f64> {
    let is_round = |shape: &Shape| {
        matches!(shape, Shape::Sphere { .. } | Shape::Ellipsoid { .. } | Shape::Revolution { .. } | Shape::Loft { .. })
    };
    let counted = || case.bodies.iter().enumerate().filter(|(k, _)| body.is_none_or(|b| b == *k));
    let round = D == 3 && counted().next().is_some() && counted().all(|(_, b)| is_round(&b.shape));
    round.then(|| counted().map(|(k, _)| surface.bounds_of(k).extent()[0]).fold(0.0, f64::max))
}

/// Reference chord: that of the case, else of its bodies; 1 without any.
pub(crate) fn chord<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> f64 {
    let of = |surface| planform(case, surface).chord;
    case.reference.chord.map_or_else(|| surface.map_or(1.0, of), |c| c.0)
}

/// Angle by which the section of a plane that coefficients are made with is turned, nose up: the only one, or the one that is named.
pub(crate) fn turned<const D: usize>(case: &Case, surface: &Surface<D>) -> Option<f64> {
    let named = |name: &String| surface.bodies.iter().position(|b| b == name);
    let only = || (surface.bodies.len() == 1).then_some(0);
    let body = case.reference.body.as_ref().map_or_else(only, named).filter(|_| D == 2)?;
    case.bodies.get(body)?.placement.rotate.first().map(|angle| angle.0)
}
