//! Surfaces: from a case file's bodies to one discretised surface that everything else uses.
//!
//! Every input becomes a [`Shell`], segments in 2-D or triangles in 3-D with outward normals: NACA formulas, airfoil
//! coordinate files, polygons, circles, ellipses, spheres, boxes, STL and OBJ files. Shells are placed and joined to a [`Surface`],
//! which answers nearest-point, crossing and inside questions through a tree of boxes.
//!
//! Limits: a surface must bound a volume (thin sheets and large holes are refused), bodies must not overlap.
//! Only [`load_surface`] opens files; all readers take any input.
mod airfoil;
mod holes;
mod mesh;
mod naca;
mod outline;
mod placement;
mod planform;
mod primitive;
mod repair;
mod sampling;
mod shell;
mod simplex;
mod spline;
mod surface;
#[cfg(test)]
mod tests;
mod tree;
mod weld;
mod wing;

pub use planform::Planform;
pub use primitive::{icosphere, write_stl};
pub use sampling::Chain;
pub use shell::{Edge, Exact, Shell};
pub use surface::{Element, Nearest, Projection, Surface};
pub use wing::wing;

use crate::case::{Body, Case, Shape};
use crate::math::Vector;
use std::f64::consts::PI;
use std::fs::File;
use std::io;
use std::path::Path;

/// Turning angle of a polygon's sharp corners, radians (5°): whoever lists corners means them.
const POLYGON_CREASE: f64 = 5.0 * PI / 180.0;

/// Distance over the size of a body below which another one touches it.
const TOUCHING: f64 = 1e-9;

/// Why a surface could not be made.
#[derive(Debug, thiserror::Error)]
pub enum GeometryError {
    /// A file could not be read.
    #[error("cannot read `{file}`: {source}\nhint: paths are relative to the case file")]
    Open {
        /// File as named in the case.
        file: String,
        /// Reason.
        source: io::Error,
    },
    /// A shape is not usable.
    #[error("{place}: {what}\nhint: {hint}")]
    Refused {
        /// File and line, or body.
        place: String,
        /// What is wrong, with the value.
        what: String,
        /// What to do about it.
        hint: String,
    },
}

impl GeometryError {
    fn refused(place: impl Into<String>, what: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Refused { place: place.into(), what: what.into(), hint: hint.into() }
    }
}

/// A shell of either dimension.
enum AnyShell {
    Plane(Shell<2>),
    Space(Shell<3>),
}

/// Number of space dimensions of a case: as given, otherwise that of its first body, otherwise 2.
pub fn dimension(case: &Case) -> u8 {
    let of = |body: &Body| match &body.shape {
        Shape::Naca(_) | Shape::Airfoil(_) | Shape::Polygon(_) | Shape::Circle { .. } | Shape::Ellipse { .. } => 2,
        Shape::Sphere { .. } | Shape::Surface(_) => 3,
        Shape::Box { size } => {
            if size.len() == 3 {
                3
            } else {
                2
            }
        }
    };
    case.dimension.unwrap_or_else(|| case.bodies.first().map_or(2, of))
}

/// The surface of all bodies, and notes on what was assumed or mended. Files are looked up in `folder`.
pub fn load_surface<const D: usize>(
    bodies: &[Body],
    folder: &Path,
) -> Result<(Surface<D>, Vec<String>), GeometryError> {
    let mut notes = Vec::new();
    let mut shells = Vec::new();
    for (i, body) in bodies.iter().enumerate() {
        let name = body.name.clone().unwrap_or_else(|| format!("body-{}", i + 1));
        let shell = load_shell(&name, body, folder, &mut notes)?;
        let mut shell = shell.in_dimension::<D>().ok_or_else(|| {
            let what = format!("its shape is not {D}-dimensional as the case is");
            GeometryError::refused(format!("body `{name}`"), what, "change the shape or `dimension`")
        })?;
        placement::place(&name, &mut shell, &body.placement)?;
        shells.push((name, shell));
    }
    let surface = Surface::new(&shells);
    if shells.len() > 1 {
        refuse_overlap(&surface, &shells)?;
    }
    Ok((surface, notes))
}

fn load_shell(name: &str, body: &Body, folder: &Path, notes: &mut Vec<String>) -> Result<AnyShell, GeometryError> {
    let open = |file: &str| {
        File::open(folder.join(file)).map_err(|source| GeometryError::Open { file: file.to_string(), source })
    };
    let place = format!("body `{name}`");
    Ok(match &body.shape {
        Shape::Naca(naca) => AnyShell::Plane(naca::shell(naca)?),
        Shape::Airfoil(file) => AnyShell::Plane(airfoil::read(file, open(file)?, notes)?),
        Shape::Polygon(points) => {
            let points: Vec<Vector<2>> = points.iter().map(|p| Vector(*p)).collect();
            AnyShell::Plane(outline::polygon(&place, &points, POLYGON_CREASE, notes)?)
        }
        Shape::Circle { radius } => AnyShell::Plane(primitive::circle(positive(&place, "radius", radius.0)?)),
        Shape::Ellipse { size: [a, b] } => {
            let (a, b) = (positive(&place, "size", a.0)?, positive(&place, "size", b.0)?);
            AnyShell::Plane(primitive::ellipse([0.5 * a, 0.5 * b]))
        }
        Shape::Sphere { radius } => AnyShell::Space(primitive::sphere(positive(&place, "radius", radius.0)?)),
        Shape::Box { size } => {
            let size: Vec<f64> = size.iter().map(|l| positive(&place, "size", l.0)).collect::<Result<_, _>>()?;
            match size[..] {
                [a, b] => {
                    let corners = primitive::rectangle([a, b]);
                    AnyShell::Plane(outline::polygon(&place, &corners, POLYGON_CREASE, notes)?)
                }
                [a, b, c] => AnyShell::Space(primitive::cuboid([a, b, c])),
                _ => {
                    let what = format!("`size` has {} numbers", size.len());
                    return Err(GeometryError::refused(place, what, "give two (2-D) or three (3-D)"));
                }
            }
        }
        Shape::Surface(file) => {
            let within = body.weld.map(|l| l.0 / body.placement.scale);
            AnyShell::Space(repair::shell(file, &mesh::read(file, open(file)?)?, within, notes)?)
        }
    })
}

fn positive(place: &str, key: &str, value: f64) -> Result<f64, GeometryError> {
    if 0.0 < value && value < 1e50 {
        return Ok(value);
    }
    Err(GeometryError::refused(place, format!("`{key}` is {value}"), "use a positive length"))
}

/// Refuses bodies that overlap or touch; names all pairs that do.
fn refuse_overlap<const D: usize>(surface: &Surface<D>, shells: &[(String, Shell<D>)]) -> Result<(), GeometryError> {
    let alone: Vec<Surface<D>> = shells.iter().map(|shell| Surface::new(std::slice::from_ref(shell))).collect();
    let within = |a: usize, b: usize| {
        let (other, touching) = (&shells[a].1.vertices, TOUCHING * alone[b].bounds().extent().max_abs());
        let meets = |x: &&Vector<D>| alone[b].nearest(x, touching).is_some();
        other.first().filter(|x| alone[b].inside(x)).or_else(|| other.iter().find(meets)).copied()
    };
    let crossed = surface.intersection().is_some();
    let crossing = |a: usize, b: usize| {
        let two = Surface::new(&[shells[a].clone(), shells[b].clone()]);
        two.intersection().map(|(x, _)| x)
    };
    let pairs = (0..shells.len()).flat_map(|a| (a + 1..shells.len()).map(move |b| [a, b]));
    let meeting = |[a, b]: [usize; 2]| {
        let x = within(a, b).or_else(|| within(b, a)).or_else(|| if crossed { crossing(a, b) } else { None })?;
        let [a, b] = [a, b].map(|k| &shells[k].0);
        Some((format!("body `{a}`"), format!("overlaps or touches body `{b}` at {:?}", x.0)))
    };
    let mut found = pairs.filter_map(meeting);
    let Some((place, mut what)) = found.next() else { return Ok(()) };
    found.for_each(|(place, more)| what.push_str(&format!("; {place} {more}")));
    Err(GeometryError::refused(place, what, "move the bodies apart, or unite them in one surface"))
}

impl AnyShell {
    /// The shell when it has `D` dimensions.
    fn in_dimension<const D: usize>(self) -> Option<Shell<D>> {
        match self {
            Self::Plane(shell) => shell.cast(),
            Self::Space(shell) => shell.cast(),
        }
    }
}
