//! Reference values: those of the case, else those of the planform of its bodies.
use crate::case::Case;
use crate::geometry::{Planform, Surface};
use crate::math::{Bounds, Vector};

/// Chord and area that coefficients are made with.
pub(crate) fn planform<const D: usize>(case: &Case, surface: &Surface<D>) -> Planform {
    let seen = surface.planform(&domain(case));
    let given = &case.reference;
    Planform { chord: given.chord.map_or(seen.chord, |c| c.0), area: given.area.unwrap_or(seen.area) }
}

/// Reference chord: that of the case, else of its bodies; 1 without any.
pub(crate) fn chord<const D: usize>(case: &Case, surface: Option<&Surface<D>>) -> f64 {
    let of = |surface| planform(case, surface).chord;
    case.reference.chord.map_or_else(|| surface.map_or(1.0, of), |c| c.0)
}

/// The domain that a case gives: what lies beyond its sides does not count.
fn domain<const D: usize>(case: &Case) -> Bounds<D> {
    let corner = |list: &[crate::case::Length], d: usize, none: f64| list.get(d).map_or(none, |l| l.0);
    let Some(given) = &case.cloud.domain else {
        return Bounds { min: Vector([f64::NEG_INFINITY; D]), max: Vector([f64::INFINITY; D]) };
    };
    Bounds {
        min: Vector::from_fn(|d| corner(&given.min, d, f64::NEG_INFINITY)),
        max: Vector::from_fn(|d| corner(&given.max, d, f64::INFINITY)),
    }
}
