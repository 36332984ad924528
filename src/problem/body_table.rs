//! The bodies of a case as plain tables: segments or triangles as repaired, clipped and closed, and what is measured on them.
use std::path::Path;

use super::error::RunError;
use super::reference;
use crate::case::Case;
use crate::geometry::{Surface, dimension, load_surface};
use crate::math::{Bounds, Vector};

/// The surface of all bodies of a case, in the unit of the geometry; vectors have three components, the last of which is zero in the plane.
#[derive(Clone, Debug)]
pub struct BodyTable {
    /// Number of space dimensions.
    pub dimension: usize,
    /// Places of the vertices.
    pub vertices: Vec<[f64; 3]>,
    /// Vertices of the elements, one element after another: two of a segment, counter-clockwise along outlines, three of a triangle,
    /// counter-clockwise seen from the gas.
    pub elements: Vec<u32>,
    /// Length of segments or area of triangles times the unit normal into the gas.
    pub area_vectors: Vec<[f64; 3]>,
    /// Body of each element, an index into `bodies`.
    pub body: Vec<u16>,
    /// Part of each element, an index into `tags`.
    pub tag: Vec<u16>,
    /// Names of the bodies.
    pub bodies: Vec<String>,
    /// Names of their parts; a body without parts is one.
    pub tags: Vec<String>,
    /// Smallest and largest coordinates of each body.
    pub boxes: Vec<[[f64; 3]; 2]>,
    /// What is measured on all bodies.
    pub measures: Measures,
    /// What was assumed or mended.
    pub notes: Vec<String>,
}

/// What is measured on all bodies of a case, in the unit of the geometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Wetted area; in the plane the length of the outlines.
    pub area: f64,
    /// Volume; in the plane the area within the outlines.
    pub volume: f64,
    /// True where every edge belongs to two elements.
    pub closed: bool,
    /// Chord that coefficients are made with: that of the case, else of its bodies.
    pub chord: f64,
    /// Area that coefficients are made with; in the plane the chord.
    pub reference_area: f64,
    /// Extent along y of what is drawn; `None` in the plane.
    pub span: Option<f64>,
    /// Smallest and largest coordinates.
    pub extents: [[f64; 3]; 2],
}

/// Reads the bodies of a case whose file names refer to the folder `input`.
pub fn body_table(case: &Case, input: &Path) -> Result<BodyTable, RunError> {
    if case.bodies.is_empty() {
        return Err(RunError::Unsupported { what: "the case has no bodies".into(), hint: "add a `[[body]]`" });
    }
    match dimension(case) {
        2 => table::<2>(case, input),
        _ => table::<3>(case, input),
    }
}

fn table<const D: usize>(case: &Case, input: &Path) -> Result<BodyTable, RunError> {
    let (surface, notes) = load_surface::<D>(&case.bodies, input)?;
    let corners = |b: Bounds<D>| [b.min.to_3d(), b.max.to_3d()];
    let all = 0..surface.elements.len() as u32;
    Ok(BodyTable {
        dimension: D,
        vertices: surface.vertices.iter().map(Vector::to_3d).collect(),
        elements: surface.elements.iter().flat_map(|e| e.vertices).collect(),
        area_vectors: all.map(|e| surface.element_area_vector(e).to_3d()).collect(),
        body: surface.elements.iter().map(|e| e.body).collect(),
        tag: surface.elements.iter().map(|e| e.tag).collect(),
        boxes: (0..surface.bodies.len()).map(|k| corners(surface.bounds_of(k))).collect(),
        measures: measures(case, &surface),
        bodies: surface.bodies,
        tags: surface.tags,
        notes,
    })
}

fn measures<const D: usize>(case: &Case, surface: &Surface<D>) -> Measures {
    let (seen, bounds) = (reference::planform(case, surface), surface.bounds());
    Measures {
        area: surface.area(),
        volume: surface.volume(),
        closed: surface.is_closed(),
        chord: seen.chord,
        reference_area: seen.area,
        span: (D == 3).then(|| bounds.extent()[1]),
        extents: [bounds.min.to_3d(), bounds.max.to_3d()],
    }
}
