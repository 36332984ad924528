//! Pictures of bodies made of particles: where they are and what stress is in them, on dots in the plane and on the skin in space.
use std::path::Path;

use crate::math::{Bounds, Vector};
use crate::observe::columns::{Scale, unit_of_array};
use crate::problem::RunError;
use crate::report::{Colormap, Dots, Scatter, Shell, SurfaceStyle, scatter_png, surface_png, write_file};
use crate::solid::Solid;
use crate::solid::forces::State;
use crate::study::solids::von_mises;

/// Room around the bodies in a picture, in their length.
const MARGIN: f64 = 0.1;
/// Greatest displacement, in the length of the bodies, below which it is enlarged, up to about that.
const SEEN: f64 = 0.05;
/// From the eye to bodies in space: from the left, ahead and above.
const SIGHT: [f64; 3] = [0.8, 1.0, -0.68];

/// What a picture shows on the particles.
pub(super) struct Shown {
    pub(super) title: String,
    /// Quantity and unit.
    pub(super) quantity: String,
    pub(super) values: Vec<f64>,
}

/// A quantity with the unit of an array of fields, where the case has units.
pub(super) fn with_unit(quantity: &str, array: &str, scale: Option<Scale>) -> String {
    let scale = scale.filter(|scale| scale.dimensional);
    let unit = scale.and_then(|scale| unit_of_array(array, scale)).filter(|unit| *unit != "1");
    unit.map_or_else(|| quantity.to_owned(), |unit| format!("{quantity}, {unit}"))
}

/// Pictures of bodies as deformed: displacement, stress and, where they move, each component of the velocity; `scale` tells the units.
pub(in crate::run) fn draw<const D: usize>(
    (out, scale): (&Path, Option<Scale>),
    solid: &Solid<D>,
    state: &State<'_, D>,
) -> Result<(), RunError> {
    let shown = |title: &str, quantity, values| Shown { title: title.to_owned(), quantity, values };
    let mises = with_unit("von Mises stress", "von_mises_stress", scale);
    let stress = shown("Stress in the solid", mises, von_mises(solid, state));
    picture((out, "solid"), solid, state.displacement, &stress)?;
    deformation((out, scale), solid, state.displacement)?;
    if state.velocity.iter().flatten().any(|v| *v != 0.0) {
        for (a, (axis, name)) in [("x", "u"), ("y", "v"), ("z", "w")].into_iter().enumerate().take(D) {
            let along = state.velocity.iter().map(|v| v[a]).collect();
            let name_and_unit = with_unit(name, "velocity", scale);
            let velocity = shown(&format!("Velocity of the solid along {axis}"), name_and_unit, along);
            picture((out, &format!("solid-{name}")), solid, state.displacement, &velocity)?;
        }
    }
    Ok(())
}

/// Bodies displaced, by more than they are where that is too little to see: `pictures/solid-deformation.png`.
fn deformation<const D: usize>(
    (out, scale): (&Path, Option<Scale>),
    solid: &Solid<D>,
    displacement: &[[f64; D]],
) -> Result<(), RunError> {
    let values: Vec<f64> = displacement.iter().map(|u| Vector(*u).norm()).collect();
    let (most, size) = (values.iter().copied().fold(0.0, f64::max), extent(&solid.particles.x));
    if most == 0.0 {
        return Ok(());
    }
    let factor = if most < SEEN * size { round(SEEN * size / most) } else { 1.0 };
    let moved: Vec<[f64; D]> = displacement.iter().map(|u| u.map(|u| factor * u)).collect();
    let title = match factor > 1.0 {
        true => format!("Deformation, drawn {} times as large", plain(factor)),
        false => "Deformation".to_owned(),
    };
    let quantity = with_unit("displacement", "displacement", scale);
    picture((out, "solid-deformation"), solid, &moved, &Shown { title, quantity, values })
}

fn extent<const D: usize>(x: &[Vector<D>]) -> f64 {
    Bounds::around(x).extent().max_abs()
}

/// The number 1, 2 or 5 times a power of ten that is not above `x`.
fn round(x: f64) -> f64 {
    let power = 10.0f64.powf(x.log10().floor());
    [5.0, 2.0].into_iter().find(|k| k * power <= x).unwrap_or(1.0) * power
}

fn plain(factor: f64) -> String {
    if factor < 1e6 { format!("{factor:.0}") } else { format!("{factor:.0e}") }
}

/// A picture of bodies where they are displaced by `moved`, with values on their particles; in the plane with the bodies at rest behind.
pub(super) fn picture<const D: usize>(
    (out, file): (&Path, &str),
    solid: &Solid<D>,
    moved: &[[f64; D]],
    shown: &Shown,
) -> Result<(), RunError> {
    let Shown { title, quantity, values } = shown;
    let place = |i: usize| solid.particles.x[i] + Vector(moved[i]);
    let bytes = match D {
        2 => {
            let flat = |x: Vector<D>| Vector([x[0], x[1]]);
            let points: Vec<Vector<2>> = (0..solid.len()).map(|i| flat(place(i))).collect();
            let outlines = outlines(solid);
            let all: Vec<Vector<2>> = points.iter().chain(outlines.iter().flatten()).copied().collect();
            let window = Bounds::around(&all).padded(MARGIN * extent(&all));
            let dots = Dots::Value { values, quantity, map: Colormap::Sequential };
            scatter_png(&Scatter { points: &points, dots, interface: &[], outlines: &outlines }, window, title)?
        }
        _ => {
            let points: Vec<Vector<3>> = (0..solid.len()).map(|i| Vector(place(i).to_3d())).collect();
            let shell = Shell::Triangles { points: &points, triangles: &solid.skin(), values, normals: &[] };
            let style = SurfaceStyle {
                title,
                quantity,
                map: Colormap::Sequential,
                range: None,
                direction: Vector(SIGHT),
                up: Vector([0.0, 0.0, 1.0]),
            };
            surface_png(&shell, &style)?
        }
    };
    Ok(write_file(&out.join(format!("pictures/{file}.png")), &bytes)?)
}

/// Closed outlines of plane bodies at rest, along the facets of their surfaces; those that do not close, as about an axis, are left out.
fn outlines<const D: usize>(solid: &Solid<D>) -> Vec<Vec<Vector<2>>> {
    let mut next = vec![u32::MAX; solid.len()];
    for facet in &solid.particles.facets {
        if let [a, b] = *facet.corners() {
            next[a as usize] = b;
        }
    }
    let mut all = Vec::new();
    for start in 0..solid.len() {
        let (mut at, mut line) = (start as u32, Vec::new());
        while let Some(after) = next.get(at as usize).copied().filter(|n| *n != u32::MAX) {
            let x = solid.particles.x[at as usize];
            line.push(Vector([x[0], x[1]]));
            next[at as usize] = u32::MAX;
            at = after;
        }
        if line.len() > 2 && at as usize == start {
            all.push(line);
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_have_the_units_of_the_case() {
        let told = |dimensional| {
            let scale = Some(Scale { dimensional, dimension: 2 });
            ["displacement", "velocity", "von_mises_stress"].map(|array| with_unit("q", array, scale))
        };
        assert_eq!(told(true), ["q, m", "q, m/s", "q, Pa"]);
        assert_eq!(told(false), ["q", "q", "q"]);
    }

    #[test]
    fn factors_are_round() {
        assert_eq!([1.0, 1.9, 2.0, 4.9, 5.0, 99.0, 0.3].map(round), [1.0, 1.0, 2.0, 2.0, 5.0, 50.0, 0.2]);
    }
}
