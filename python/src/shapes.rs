//! Clouds and bodies before a run.
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::Value;
use solver::geometry::dimension;
use solver::run::{BodyTable, CloudTable, body_table, cloud_table};

use crate::cases::Given;
use crate::tables::{arrays, python_of, shaped, vectors};
use crate::work::{Wishes, computed};

/// Builds the cloud of a case, as a run on it would begin with; computes no flow.
///
/// Parameters
/// ----------
/// case : str, os.PathLike or dict
///     As for `run`.
///
/// Returns
/// -------
/// Cloud
///     Particles: places, kinds, sizes, boundaries.
///
/// Raises
/// ------
/// CaseError, OSError
///     As for `run`.
/// KeyboardInterrupt
///     Ctrl-C.
#[pyfunction]
pub(crate) fn cloud(py: Python<'_>, case: &Bound<'_, PyAny>) -> PyResult<Cloud> {
    let Given { case, input } = Given::of(case)?.with_gas(py)?;
    let (title, d) = (case.title.clone(), usize::from(dimension(&case)));
    let found = computed(py, Wishes::NONE, move |_| cloud_table(&case, &input).map(Some))?;
    Cloud::of(py, title, found, d)
}

/// Reads bodies as a run would have them: placed, repaired, clipped where they intersect, closed.
///
/// Parameters
/// ----------
/// shape : str, os.PathLike or dict
///     A case, of which `body` is enough in a dict, or the path of a surface file: triangles (`.stl`, `.obj`, `.ply`), else the coordinates
///     of a section. A file whose name ends in `.toml` is a case.
///
/// Returns
/// -------
/// Geometry
///     Elements of the surface, and what is measured on it.
///
/// Raises
/// ------
/// CaseError
///     The case has mistakes, or its bodies bound no volume.
/// OSError
///     A file cannot be read.
/// KeyboardInterrupt
///     Ctrl-C.
#[pyfunction]
pub(crate) fn geometry(py: Python<'_>, shape: &Bound<'_, PyAny>) -> PyResult<Geometry> {
    let Given { case, input } = Given::bodies_of(shape)?;
    let found = computed(py, Wishes::NONE, move |_| body_table(&case, &input).map(Some))?;
    Geometry::of(py, found)
}

/// The cloud of a case before a run, in the unit of the geometry; images across planes of symmetry and periodic sides are left out.
#[pyclass(frozen, module = "alula")]
pub(crate) struct Cloud {
    /// Title of the case.
    #[pyo3(get)]
    title: String,
    /// Places (N, 2 or 3).
    #[pyo3(get)]
    positions: Py<PyAny>,
    /// 0 fluid, 1 on a wall, 2 on a side of the domain (N,).
    #[pyo3(get)]
    kind: Py<PyArray1<u8>>,
    /// Distance of neighbours (N,).
    #[pyo3(get)]
    spacing: Py<PyAny>,
    /// Volume that a particle stands for, area in the plane (N,).
    #[pyo3(get)]
    volume: Py<PyAny>,
    /// Unit normals (N, 2 or 3): of walls into the gas, of sides of the domain out of it; zero of fluid particles.
    #[pyo3(get)]
    normal: Py<PyAny>,
    /// Area times normal of particles on walls (N, 2 or 3), else zero; it closes around a body.
    #[pyo3(get)]
    area_vector: Py<PyAny>,
    /// Index into `bodies` (N,); -1 of particles on no body.
    #[pyo3(get)]
    body: Py<PyArray1<i32>>,
    /// Index into `boundaries` (N,); -1 of fluid particles.
    #[pyo3(get)]
    boundary: Py<PyArray1<i32>>,
    /// Names of the bodies.
    #[pyo3(get)]
    bodies: Vec<String>,
    /// Names of the parts of bodies (a body without parts is one), then of the sides of the domain, `x_min` to `y_max` or `z_max`.
    #[pyo3(get)]
    boundaries: Vec<String>,
    /// Condition of each side of the domain, in the words of the case file.
    #[pyo3(get)]
    conditions: Py<PyAny>,
    /// What was repaired or assumed.
    #[pyo3(get)]
    notes: Vec<String>,
}

#[pymethods]
impl Cloud {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("<alula.Cloud of '{}': {} particles>", self.title, self.kind.bind(py).len()?))
    }
}

impl Cloud {
    fn of(py: Python<'_>, title: String, found: CloudTable, dimension: usize) -> PyResult<Self> {
        let columns = arrays(py, found.on, dimension)?;
        let column = |name: &str| columns.as_any().get_item(name).map(Bound::unbind);
        let conditions: Value = found.conditions.into_iter().map(|(side, is)| (side.to_owned(), is)).collect();
        Ok(Self {
            title,
            positions: column("positions")?,
            kind: PyArray1::from_vec(py, found.kind).unbind(),
            spacing: column("spacing")?,
            volume: column("volume")?,
            normal: column("normal")?,
            area_vector: column("area_vector")?,
            body: PyArray1::from_vec(py, found.body).unbind(),
            boundary: PyArray1::from_vec(py, found.boundary).unbind(),
            bodies: found.bodies,
            boundaries: found.boundaries,
            conditions: python_of(py, &conditions)?,
            notes: found.notes,
        })
    }
}

/// Bodies, in the unit of the geometry.
#[pyclass(frozen, module = "alula")]
pub(crate) struct Geometry {
    /// Number of space dimensions, 2 or 3.
    #[pyo3(get)]
    dimension: usize,
    /// Places of the vertices (V, dimension).
    #[pyo3(get)]
    vertices: Py<PyAny>,
    /// Vertices of the elements (E, dimension): segments, counter-clockwise along outlines, or triangles, counter-clockwise seen from the gas.
    #[pyo3(get)]
    elements: Py<PyAny>,
    /// Length of segments or area of triangles times the unit normal into the gas (E, dimension).
    #[pyo3(get)]
    area_vectors: Py<PyAny>,
    /// Index into `bodies` of each element (E,).
    #[pyo3(get)]
    body: Py<PyArray1<u16>>,
    /// Index into `tags` of each element (E,).
    #[pyo3(get)]
    tag: Py<PyArray1<u16>>,
    /// Names of the bodies.
    #[pyo3(get)]
    bodies: Vec<String>,
    /// Names of their parts; a body without parts is one.
    #[pyo3(get)]
    tags: Vec<String>,
    /// Outlines of plane bodies, each an array (P, 2) whose last point is its first one; None in space.
    #[pyo3(get)]
    outlines: Option<Vec<Py<PyAny>>>,
    /// Wetted area; in the plane the length of the outlines.
    #[pyo3(get)]
    area: f64,
    /// Volume; in the plane the area within the outlines.
    #[pyo3(get)]
    volume: f64,
    /// True where every edge belongs to two elements.
    #[pyo3(get)]
    closed: bool,
    /// Chord that coefficients are made with: that of `[reference]`, else of the bodies.
    #[pyo3(get)]
    chord: f64,
    /// Area that coefficients are made with; in the plane the chord.
    #[pyo3(get)]
    reference_area: f64,
    /// Extent along y of what is drawn; None in the plane.
    #[pyo3(get)]
    span: Option<f64>,
    /// Smallest and largest coordinates (2, dimension).
    #[pyo3(get)]
    extents: Py<PyAny>,
    /// The same of each body by name.
    #[pyo3(get)]
    boxes: Py<PyDict>,
    /// What was assumed, repaired or closed.
    #[pyo3(get)]
    notes: Vec<String>,
}

#[pymethods]
impl Geometry {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (n, what) = (self.body.bind(py).len()?, if self.dimension == 2 { "segments" } else { "triangles" });
        Ok(format!("<alula.Geometry of {}: {n} {what}>", self.bodies.join(", ")))
    }
}

impl Geometry {
    fn of(py: Python<'_>, found: BodyTable) -> PyResult<Self> {
        let (d, m) = (found.dimension, found.measures);
        let corners = |all: [[f64; 3]; 2]| vectors(py, all.as_flattened().to_vec(), d);
        let boxes = PyDict::new(py);
        for (name, corner) in found.bodies.iter().zip(&found.boxes) {
            boxes.set_item(name, corners(*corner)?)?;
        }
        let outline = |k: usize| {
            let own = (0..found.body.len()).filter(|e| usize::from(found.body[*e]) == k);
            let start = |e: usize| found.vertices[found.elements[2 * e] as usize];
            let mut all: Vec<[f64; 3]> = own.map(start).collect();
            all.extend(all.first().copied());
            vectors(py, all.into_flattened(), 2).map(Bound::unbind)
        };
        let outlines = (d == 2).then(|| (0..found.bodies.len()).map(outline).collect::<PyResult<Vec<_>>>());
        let n = found.body.len();
        Ok(Self {
            dimension: d,
            outlines: outlines.transpose()?,
            vertices: vectors(py, found.vertices.into_flattened(), d)?.unbind(),
            elements: shaped(py, found.elements, [n, d])?.unbind(),
            area_vectors: vectors(py, found.area_vectors.into_flattened(), d)?.unbind(),
            body: PyArray1::from_vec(py, found.body).unbind(),
            tag: PyArray1::from_vec(py, found.tag).unbind(),
            bodies: found.bodies,
            tags: found.tags,
            area: m.area,
            volume: m.volume,
            closed: m.closed,
            chord: m.chord,
            reference_area: m.reference_area,
            span: m.span,
            extents: corners(m.extents)?.unbind(),
            boxes: boxes.unbind(),
            notes: found.notes,
        })
    }
}
