//! Bodies made of particles in a gas: their fields, and a picture of them.
use std::path::Path;

use super::super::error::RunError;
use super::super::solids::files::{draw, write};
use crate::coupling::SolidSnapshot;

/// Their fields: `<name>.vtu`.
pub(crate) fn write_solid<const D: usize>(out: &Path, name: &str, at: &SolidSnapshot<'_, D>) -> Result<(), RunError> {
    write(&out.join(format!("{name}.vtu")), at.solid, &at.state())
}

/// A picture of plane bodies with the stress in them and, where they move, one of each component of the velocity.
pub(crate) fn draw_solid<const D: usize>(out: &Path, at: &SolidSnapshot<'_, D>) -> Result<(), RunError> {
    draw(out, at.solid, &at.state())
}
