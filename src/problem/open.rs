//! Surfaces and motions of the bodies of a case.
use std::path::Path;

use super::error::RunError;
use super::files;
use super::modes;
use super::reference::chord;
use crate::case::Case;
use crate::geometry::{GeometryError, Surface, load_surface};
use crate::motion::Motions;

/// Reads the bodies of a case; `None` when it has none.
pub(crate) fn surface<const D: usize>(
    case: &Case,
    input: &Path,
) -> Result<(Option<Surface<D>>, Vec<String>), GeometryError> {
    if case.bodies.is_empty() {
        return Ok((None, Vec::new()));
    }
    let (surface, notes) = load_surface(&case.bodies, input)?;
    Ok((Some(surface), notes))
}

/// The motions of a case.
pub(crate) fn motions<const D: usize>(
    case: &Case,
    input: &Path,
    surface: Option<&Surface<D>>,
) -> Result<Motions<D>, RunError> {
    let chord = chord(case, surface);
    let read = |name: &str| files::text(input, name);
    let motions = Motions::of_case(case, chord, &read)?;
    if let Some(surface) = surface {
        let bodies = 0..motions.len().min(surface.bodies.len());
        let led = bodies.flat_map(|b| motions.of(b).shapes().map(move |shape| (Some(b), shape)));
        let all = led.chain(motions.shapes_of_forces().iter().map(|shape| (None, shape)));
        let astray = all.filter_map(|(b, shape)| modes::lies_on(surface, b, shape).err()).collect();
        RunError::all(astray).map_or(Ok(()), Err)?;
    }
    Ok(motions)
}
