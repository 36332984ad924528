//! Bodies made of particles in a gas: their fields, and a picture of them.
use std::path::Path;

use super::super::error::RunError;
use super::super::solids::files::{von_mises, write};
use crate::coupling::SolidSnapshot;
use crate::math::{Bounds, Vector};
use crate::report::{Colormap, Dots, Scatter, scatter_png, write_file};
use crate::solid::forces::State;

/// Room around the bodies in a picture, in their length.
const MARGIN: f64 = 0.1;

/// Their fields: `<name>.vtu`.
pub(crate) fn write_solid<const D: usize>(out: &Path, name: &str, at: &SolidSnapshot<'_, D>) -> Result<(), RunError> {
    write(&out.join(format!("{name}.vtu")), at.solid, &state(at))
}

fn state<'a, const D: usize>(at: &'a SolidSnapshot<'_, D>) -> State<'a, D> {
    State { time: 0.0, step: 0.0, displacement: &at.displacement, velocity: &at.velocity, history: &at.history }
}

/// A picture of plane bodies with the stress in them and, where they move, one of each component of the velocity.
pub(crate) fn draw_solid<const D: usize>(out: &Path, at: &SolidSnapshot<'_, D>) -> Result<(), RunError> {
    if D != 2 {
        return Ok(());
    }
    let place = |i: usize| {
        let (x, u) = (&at.solid.particles.x[i], &at.displacement[i]);
        Vector([x[0] + u[0], x[1] + u[1]])
    };
    let points: Vec<Vector<2>> = (0..at.solid.len()).map(place).collect();
    let bounds = Bounds::around(&points);
    let window = bounds.padded(MARGIN * bounds.extent().max_abs());
    let mut all = vec![("solid", "Stress in the solid", "von Mises stress", von_mises(at.solid, &state(at)))];
    if at.velocity.iter().flatten().any(|v| *v != 0.0) {
        let along = |a: usize| at.velocity.iter().map(|v| v[a]).collect();
        all.push(("solid-u", "Velocity of the solid along x", "u", along(0)));
        all.push(("solid-v", "Velocity of the solid along y", "v", along(1)));
    }
    for (file, title, quantity, values) in all {
        let dots = Dots::Value { values: &values, quantity, map: Colormap::Sequential };
        let scatter = Scatter { points: &points, dots, interface: &[], outlines: &[] };
        let png = scatter_png(&scatter, window, title)?;
        write_file(&out.join(format!("pictures/{file}.png")), &png)?;
    }
    Ok(())
}
