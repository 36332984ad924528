//! Results of flows.
use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use solver::case::Case;
use solver::geometry::dimension;
use solver::observe::loads::Coefficients;
use solver::run::{PolarPoint, Solution, WallSnapshot};

use crate::tables::{arrays, python_of};

/// What a run found.
///
/// Lengths are in the unit of the geometry. In a stream with units (`pressure`, `temperature`, ... in the case) all else is in SI units;
/// otherwise densities are over that of the free stream, velocities over its sound speed c, pressures over density times c².
#[pyclass(frozen, module = "alula")]
pub(crate) struct Result {
    /// Title of the case.
    #[pyo3(get)]
    title: String,
    /// Lift coefficient; of a polar that of its last point, of a march that of its end: means and harmonics of the last period are in
    /// `summary["periodic_loads"]`.
    #[pyo3(get)]
    cl: f64,
    /// Drag coefficient.
    #[pyo3(get)]
    cd: f64,
    /// Moment coefficient about the reference point, nose up positive.
    #[pyo3(get)]
    cm: f64,
    /// Half widths of the error bars of the loads, `{"cl": ..., "cd": ..., "cm": ...}`; None without a family of clouds.
    #[pyo3(get)]
    loads_error: Option<Py<PyDict>>,
    /// True when the goal was reached; None of a march that came to its end and was asked for nothing else.
    #[pyo3(get)]
    converged: Option<bool>,
    /// Everything else that is one number: what `summary.json` holds.
    #[pyo3(get)]
    summary: Py<PyAny>,
    /// Arrays of shape (iterations,), named as the columns of `history.csv`.
    #[pyo3(get)]
    history: Py<PyDict>,
    /// Arrays over all particles: `positions` (N, 2 or 3), `velocity` and `vorticity` (N, 2 or 3; (N,) for the vorticity of a plane
    /// flow), `density`, `pressure`, `mach`, `cp`, `temperature` (K; without units over that of the free stream), `total_pressure`, `total_pressure_loss`, `entropy`, `spacing`,
    /// `volume`, `level`, `kind` (0 fluid, 1 wall, 2 outer) (N,).
    #[pyo3(get)]
    fields: Py<PyDict>,
    /// Arrays over the particles on walls: `positions`, `normal` (into the gas), `area_vector`, `velocity` (M, 2 or 3), `area`, `arc`, `x_c`,
    /// `pressure`, `cp`, `mach`, `density`, with viscosity `cf`, `heat_flux`, `y_plus`, and the indices `body` and `tag` (M,).
    #[pyo3(get)]
    surface: Py<PyDict>,
    /// Arrays over the particles of bodies made of particles at the end, as `Solid.fields`, in the units of the case; None without such bodies.
    #[pyo3(get)]
    solid: Option<Py<PyDict>>,
    /// Names of bodies, which `surface["body"]` counts from 0.
    #[pyo3(get)]
    bodies: Vec<String>,
    /// Names of their parts, which `surface["tag"]` counts from 0.
    #[pyo3(get)]
    tags: Vec<String>,
    /// Arrays over the points of a polar, NaN where a point failed: `mach`, `alpha_deg`, `cl`, `cd`, `cm`, `cl_error`, `cd_error`, `cm_error`
    /// (half widths of error bars), `converged`, and the lists `long_bars` (names of loads whose bars are longer than asked for),
    /// `within_accuracy` (whether all are as short as that; None where there
    /// are none) and `reason`; None for a single flow.
    #[pyo3(get)]
    polar: Option<Py<PyDict>>,
    /// Folder of the run; None without one.
    #[pyo3(get)]
    folder: Option<PathBuf>,
}

#[pymethods]
impl Result {
    fn __repr__(&self) -> String {
        let state = match self.converged {
            Some(true) => "converged",
            Some(false) => "not converged",
            None => "marched to its end",
        };
        format!("<alula.Result of '{}': cl {:.5}, cd {:.5}, cm {:.5}, {state}>", self.title, self.cl, self.cd, self.cm)
    }
}

impl Result {
    /// What was found, handed over to Python.
    pub(crate) fn of(py: Python<'_>, case: &Case, found: Solution, folder: Option<PathBuf>) -> PyResult<Self> {
        let (summary, d) = (found.summary, usize::from(dimension(case)));
        let history = PyDict::new(py);
        for (name, values) in found.history.names.iter().zip(found.history.columns) {
            history.set_item(name, PyArray1::from_vec(py, values))?;
        }
        let bars = |bars: Coefficients| -> PyResult<Py<PyDict>> {
            let told = PyDict::new(py);
            [("cl", bars.cl), ("cd", bars.cd), ("cm", bars.cm)]
                .into_iter()
                .try_for_each(|(n, v)| told.set_item(n, v))?;
            Ok(told.unbind())
        };
        let WallSnapshot { on, body, tag, bodies, tags } = found.walls;
        let surface = arrays(py, on, d)?;
        surface.set_item("body", PyArray1::from_vec(py, body))?;
        surface.set_item("tag", PyArray1::from_vec(py, tag))?;
        let told = serde_json::to_value(&summary).unwrap_or_default();
        Ok(Self {
            title: case.title.clone(),
            cl: summary.loads.total.cl,
            cd: summary.loads.total.cd,
            cm: summary.loads.total.cm,
            loads_error: summary.grid.loads_error.map(bars).transpose()?,
            converged: summary.convergence.converged,
            summary: python_of(py, &told)?,
            history: history.unbind(),
            fields: arrays(py, found.field, d)?.unbind(),
            surface: surface.unbind(),
            solid: found.solid.map(|on| arrays(py, on, d).map(Bound::unbind)).transpose()?,
            bodies,
            tags,
            polar: (!summary.polar.is_empty()).then(|| polar(py, &summary.polar)).transpose()?,
            folder,
        })
    }
}

/// The table of a polar.
fn polar(py: Python<'_>, points: &[PolarPoint]) -> PyResult<Py<PyDict>> {
    let table = PyDict::new(py);
    let column = |f: &dyn Fn(&PolarPoint) -> f64| PyArray1::from_vec(py, points.iter().map(f).collect());
    let load = |c: Option<Coefficients>, f: fn(&Coefficients) -> f64| c.as_ref().map_or(f64::NAN, f);
    table.set_item("mach", column(&|p| p.mach))?;
    table.set_item("alpha_deg", column(&|p| p.alpha_deg))?;
    let loads = |name: &str, f: fn(&Coefficients) -> f64| -> PyResult<()> {
        table.set_item(name, column(&|p| load(p.loads, f)))?;
        table.set_item(format!("{name}_error"), column(&|p| load(p.loads_error, f)))
    };
    loads("cl", |c| c.cl)?;
    loads("cd", |c| c.cd)?;
    loads("cm", |c| c.cm)?;
    table.set_item("within_accuracy", PyList::new(py, points.iter().map(|p| p.within_accuracy))?)?;
    table.set_item("long_bars", PyList::new(py, points.iter().map(|p| &p.long_bars))?)?;
    table.set_item("converged", PyArray1::from_vec(py, points.iter().map(|p| p.converged).collect()))?;
    table.set_item("reason", PyList::new(py, points.iter().map(|p| &p.reason))?)?;
    Ok(table.unbind())
}
