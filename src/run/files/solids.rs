//! Bodies made of particles in a gas: their fields, and a picture of them.
use std::path::Path;

use super::super::solids::files::write;
use super::super::solids::pictures::draw;
use crate::coupling::SolidSnapshot;
use crate::observe::About;
use crate::problem::RunError;

/// Their fields: `<name>.vtu`.
pub(crate) fn write_solid<const D: usize>(
    (out, name): (&Path, &str),
    about: &About,
    at: &SolidSnapshot<'_, D>,
) -> Result<(), RunError> {
    write(&out.join(format!("{name}.vtu")), about, at.solid, &at.state())
}

/// Pictures of the bodies: displacement, stress and, where they move, each component of the velocity.
pub(crate) fn draw_solid<const D: usize>(
    (out, about): (&Path, &About),
    at: &SolidSnapshot<'_, D>,
) -> Result<(), RunError> {
    draw((out, about.scale), at.solid, &at.state())
}
