//! Flutter boundaries and generalised aerodynamic forces.
use std::path::PathBuf;

use numpy::{Complex64, PyArray1};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde_json::{Value, json};
use solver::observe::columns::{Scale, unit_of};
use solver::run::flutter::{Boundary, FlutterAt, FlutterRow};
use solver::run::gaf::{Column, Matrices};
use solver::run::{self, Places};

use crate::cases::Given;
use crate::tables::{list, python_of, shaped, table};
use crate::work::{Wishes, computed};

/// Seeks the flutter boundary of the table `[flutter]` of a case.
///
/// Parameters
/// ----------
/// case : str, os.PathLike or dict
///     As for `run`, with a `[structure]` and a table `[flutter]`.
/// out : str or os.PathLike, optional
///     Folder for tables, pictures and the report; it must hold no earlier results. Without it no file is written.
/// forces : str or os.PathLike, optional
///     `flutter.json` or `gaf.json` of a former run: the boundary of the structure with these forces, without a flow.
/// progress, threads : optional
///     As for `run`.
///
/// Returns
/// -------
/// Flutter
///     Boundary, crossings, motions at all speeds, limit cycles.
///
/// Raises
/// ------
/// CaseError, ComputationError, OSError
///     As for `run`.
/// KeyboardInterrupt
///     Ctrl-C; with `out`, `resume` goes on with the Mach numbers that were not finished.
#[pyfunction]
#[pyo3(signature = (case, out=None, forces=None, progress=None, threads=None))]
pub(crate) fn flutter(
    py: Python<'_>,
    case: &Bound<'_, PyAny>,
    out: Option<PathBuf>,
    forces: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> PyResult<Flutter> {
    let wishes = Wishes::of(py, progress, threads)?;
    let Given { case, input } = Given::of(case)?.with_gas(py)?;
    let folder = out.clone();
    let found = computed(py, wishes, move |relay| {
        let Some(out) = folder else { return run::flutter::in_memory(&case, &input, forces.as_deref(), relay) };
        let places = Places { input, out };
        match &forces {
            Some(forces) => run::flutter::again(&case, &places, forces, relay),
            None => run::flutter::flutter(&case, &places, relay),
        }
    })?;
    Flutter::of(py, &found, out)
}

/// Computes the generalised aerodynamic forces of the table `[gaf]` of a case.
///
/// Parameters
/// ----------
/// case : str, os.PathLike or dict
///     As for `run`, with a table `[gaf]`.
/// out : str or os.PathLike, optional
///     Folder for `gaf.csv` and `gaf.json`; it must hold no earlier results. Without it no file is written.
/// progress, threads : optional
///     As for `run`.
///
/// Returns
/// -------
/// Gaf
///     Matrices of all reduced frequencies, with error bars.
///
/// Raises
/// ------
/// CaseError, ComputationError, OSError
///     As for `run`.
/// KeyboardInterrupt
///     Ctrl-C. Matrices that were not all found begin again.
#[pyfunction]
#[pyo3(signature = (case, out=None, progress=None, threads=None))]
pub(crate) fn gaf(
    py: Python<'_>,
    case: &Bound<'_, PyAny>,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> PyResult<Gaf> {
    let wishes = Wishes::of(py, progress, threads)?;
    let Given { case, input } = Given::of(case)?.with_gas(py)?;
    let (folder, title, scale) = (out.clone(), case.title.clone(), scale_of(&case));
    let found = computed(py, wishes, move |relay| match folder {
        Some(out) => run::gaf::gaf(&case, &Places { input, out }, relay),
        None => run::gaf::in_memory(&case, &input, relay),
    })?;
    Gaf::of(py, title, &found, scale, out)
}

fn scale_of(case: &solver::case::Case) -> Scale {
    Scale { dimensional: case.flow.is_dimensional(), dimension: solver::geometry::dimension(case).into() }
}

/// A flutter boundary.
#[pyclass(frozen, module = "alula")]
pub(crate) struct Flutter {
    /// Title of the case.
    #[pyo3(get)]
    title: String,
    /// Mach numbers (n,).
    #[pyo3(get)]
    mach: Py<PyArray1<f64>>,
    /// Speed at which a motion begins to grow at each Mach number (n,): at constant density the lowest, at varied density or altitude that of
    /// the first crossing. NaN where nothing grows, or something from the first speed on.
    #[pyo3(get)]
    speeds: Py<PyArray1<f64>>,
    /// Half widths of the error bars of `speeds` (n,); NaN where they are not known or the speed is not what varies.
    #[pyo3(get)]
    speed_errors: Py<PyArray1<f64>>,
    /// Frequencies of the motions that begin to grow (n,), in cycles per unit of time; 0 of divergence.
    #[pyo3(get)]
    frequencies: Py<PyArray1<f64>>,
    /// Every crossing as a dict with the names of `flutter.json`: `mach`, `kind` (`flutter`, `restabilised`, `divergence`), `branch`, `mode`, `speed`,
    /// `frequency`, `density`, `dynamic_pressure`, `speed_index`, ..., half widths of error bars `..._error`, `remarks`, `shape`; None where
    /// something is not known or has no meaning.
    #[pyo3(get)]
    crossings: Py<PyAny>,
    /// Ranges of speed in which the spacing of the cloud decides whether a motion grows, as dicts with `mach`, `branch`, `kind`, `speed`
    /// (first, last), `damping`, `damping_coarser`, ...
    #[pyo3(get)]
    doubts: Py<PyAny>,
    /// Motions at all speeds that were looked at (V-g and V-f diagrams), arrays (m,): `mach`, `branch`, `mode` (NaN where motions do not
    /// oscillate), `speed`, `damping` (g, growth positive), `frequency`, `reduced_frequency` (NaN where nothing flows), `eigenvalue` (complex), `speed_ratio`,
    /// `equivalent_airspeed`, `density`, `dynamic_pressure`, `altitude`.
    #[pyo3(get)]
    vg: Py<PyDict>,
    /// Limit cycles as dicts, where `[lco]` asks for them.
    #[pyo3(get)]
    lco: Py<PyAny>,
    /// Units of the numbers in `crossings` and `vg` by name, as in UCUM: `1` of a pure number; without units in the case `a` is the sound speed and `rho` the density
    /// of the free stream, `L` the unit of the geometry.
    #[pyo3(get)]
    units: Py<PyAny>,
    /// Signs and definitions.
    #[pyo3(get)]
    conventions: String,
    /// What makes results doubtful, with the Mach number.
    #[pyo3(get)]
    warnings: Vec<String>,
    /// Folder of the boundary; None without one.
    #[pyo3(get)]
    folder: Option<PathBuf>,
    whole: Value,
}

#[pymethods]
impl Flutter {
    /// Everything as plain dicts and lists, as in `flutter.json`: also generalised forces, natural modes, clearance, cost of each Mach number.
    fn to_dict(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        python_of(py, &self.whole)
    }

    fn __repr__(&self) -> String {
        let n = self.whole["flutter"].as_array().map_or(0, Vec::len);
        let crossings = self.whole["flutter"].as_array().into_iter().flatten();
        let crossings: usize = crossings.map(|at| at["crossings"].as_array().map_or(0, Vec::len)).sum();
        format!("<alula.Flutter of '{}': {crossings} crossings at {n} Mach numbers>", self.title)
    }
}

impl Flutter {
    /// What was found, handed over to Python.
    pub(crate) fn of(py: Python<'_>, found: &Boundary, folder: Option<PathBuf>) -> PyResult<Self> {
        let all = &found.flutter;
        let column = |f: &dyn Fn(&FlutterAt) -> f64| PyArray1::from_vec(py, all.iter().map(f).collect()).unbind();
        let onset = |f: &dyn Fn(&FlutterRow) -> Option<f64>| column(&|at| at.onset().and_then(f).unwrap_or(f64::NAN));
        let (crossings, doubts) = (rows(all, |at| &at.crossings), rows(all, |at| &at.doubts));
        let motions = rows(all, |at| &at.motions);
        let vg = table(py, &motions)?;
        let eigenvalues =
            all.iter().flat_map(|at| &at.motions).map(|m| Complex64::new(m.eigenvalue[0], m.eigenvalue[1]));
        vg.set_item("eigenvalue", PyArray1::from_iter(py, eigenvalues))?;
        let warning = |at: &FlutterAt| at.warnings.iter().map(|w| format!("Mach {}: {w}", at.mach)).collect::<Vec<_>>();
        Ok(Self {
            title: found.title.clone(),
            mach: column(&|at| at.mach),
            speeds: onset(&|c| Some(c.speed)),
            speed_errors: onset(&|c| c.bars.speed_error),
            frequencies: onset(&|c| Some(c.frequency)),
            crossings: list(py, &crossings)?,
            doubts: list(py, &doubts)?,
            vg: vg.unbind(),
            lco: list(py, &found.lco.iter().map(|c| serde_json::to_value(c).unwrap_or_default()).collect::<Vec<_>>())?,
            units: python_of(py, &units(all, crossings.iter().chain(&motions)))?,
            conventions: found.conventions.clone(),
            warnings: all.iter().flat_map(warning).collect(),
            folder,
            whole: serde_json::to_value(found).unwrap_or_default(),
        })
    }
}

/// Rows of all Mach numbers, each with its own.
fn rows<T: serde::Serialize>(all: &[FlutterAt], of: impl Fn(&FlutterAt) -> &[T]) -> Vec<Value> {
    let row = |mach: f64, row: &T| {
        let mut told = json!({ "mach": mach });
        if let (Some(told), Ok(Value::Object(row))) = (told.as_object_mut(), serde_json::to_value(row)) {
            told.extend(row);
        }
        told
    };
    all.iter().flat_map(|at| of(at).iter().map(|r| row(at.mach, r)).collect::<Vec<_>>()).collect()
}

/// Units of the numbers in rows.
fn units<'v>(all: &[FlutterAt], rows: impl Iterator<Item = &'v Value>) -> Value {
    let scale = all.first().map_or(Scale { dimensional: false, dimension: 2 }, |at| Scale {
        dimensional: at.dimensional,
        dimension: at.dimension,
    });
    let is_number = |v: &Value| v.is_number() || v.is_null();
    let names = rows.filter_map(Value::as_object).flatten().filter(|(_, v)| is_number(v)).map(|(name, _)| name);
    names.map(|name| (name.clone(), Value::from(unit_of("flutter.csv", name, scale).unwrap_or("1")))).collect()
}

/// Generalised aerodynamic forces.
///
/// Motions are q(t) = Re q exp(iωt) with the reduced frequency k = ωL/U; forces of mode i over its coordinate, due to mode j, are q S c Q_ij with
/// the dynamic pressure q, the area S (in the plane the chord, for a unit of span) and the chord c.
#[pyclass(frozen, module = "alula")]
pub(crate) struct Gaf {
    /// Title of the case.
    #[pyo3(get)]
    title: String,
    /// Names of the N modes, in the order of rows and columns.
    #[pyo3(get)]
    modes: Vec<String>,
    /// Reduced frequencies k (K,), in the order of the case.
    #[pyo3(get)]
    reduced_frequencies: Py<PyArray1<f64>>,
    /// Frequencies (K,), in cycles per unit of time: k U/(2π L).
    #[pyo3(get)]
    frequencies: Py<PyArray1<f64>>,
    /// Generalised forces, complex (K, N, N): `q[k, i, j]` is the force on mode i that mode j makes.
    #[pyo3(get)]
    q: Py<PyAny>,
    /// Error bars of `q` for the spacing of the cloud (K, N, N): radii of circles in the complex plane; NaN where no coarser cloud tells them.
    #[pyo3(get)]
    q_error: Py<PyAny>,
    /// Lift over motion, complex (K, N).
    #[pyo3(get)]
    cl: Py<PyAny>,
    /// Error bars of `cl` (K, N).
    #[pyo3(get)]
    cl_error: Py<PyAny>,
    /// Moment about the pivot over motion, nose up positive, complex (K, N).
    #[pyo3(get)]
    cm: Py<PyAny>,
    /// Error bars of `cm` (K, N).
    #[pyo3(get)]
    cm_error: Py<PyAny>,
    /// True where the equations were solved (K, N).
    #[pyo3(get)]
    converged: Py<PyAny>,
    /// Part by which forces change when the amplitude is halved (K, N); NaN of infinitely small motions.
    #[pyo3(get)]
    nonlinearity: Py<PyAny>,
    /// What the forces hold for: `mach`, `alpha_deg`, `speed` U and `dynamic_pressure` q of the stream, `chord` c, `area` S, `reduced_length` L and
    /// `pivot` (None without one), in the units of the case.
    #[pyo3(get)]
    conditions: Py<PyAny>,
    /// Units as in UCUM of `frequencies`, `q`, `cl`, `cm` and of the numbers in `conditions`.
    #[pyo3(get)]
    units: Py<PyAny>,
    /// Signs and definitions.
    #[pyo3(get)]
    conventions: String,
    /// Folder of the matrices; None without one.
    #[pyo3(get)]
    folder: Option<PathBuf>,
    columns: Vec<Value>,
}

#[pymethods]
impl Gaf {
    /// A column of the matrix a row, as a dict of lists and arrays that `pandas.DataFrame` takes: `k`, `mode` (that moves), `cl_re`, `cl_im`, `cm_re`, `cm_im`,
    /// `q_<mode>_re`, `q_<mode>_im` and, where known, `..._error`, as the columns of `gaf.csv`.
    fn to_dict(&self, py: Python<'_>) -> PyResult<Py<PyDict>> {
        table(py, &self.columns).map(Bound::unbind)
    }

    fn __repr__(&self) -> String {
        let n = self.modes.len();
        let k = self.columns.len() / n.max(1);
        format!("<alula.Gaf of '{}': {n} modes ({}) at {k} reduced frequencies>", self.title, self.modes.join(", "))
    }
}

impl Gaf {
    fn of(py: Python<'_>, title: String, found: &Matrices, scale: Scale, folder: Option<PathBuf>) -> PyResult<Self> {
        let (all, n) = (&found.columns, found.modes.len());
        let k = all.len() / n.max(1);
        let complex = |f: &dyn Fn(&Column) -> [f64; 2]| {
            shaped(py, all.iter().map(|c| of_parts(f(c))).collect(), [k, n]).map(Bound::unbind)
        };
        let real = |f: &dyn Fn(&Column) -> Option<f64>| {
            let values = all.iter().map(|c| f(c).unwrap_or(f64::NAN)).collect();
            shaped(py, values, [k, n]).map(Bound::unbind)
        };
        // columns stand one after another, entries have the row first
        let entry = |at: usize| (&all[at / (n * n) * n + at % n], at / n % n);
        let q = (0..k * n * n).map(entry).map(|(c, i)| of_parts(c.q[i])).collect();
        let bar = |(c, i): (&Column, usize)| c.errors.as_ref().map_or(f64::NAN, |e| e.q_error[i]);
        let q_error = (0..k * n * n).map(entry).map(bar).collect();
        Ok(Self {
            title,
            reduced_frequencies: PyArray1::from_vec(py, found.reduced_frequencies()).unbind(),
            frequencies: PyArray1::from_vec(py, found.frequencies()).unbind(),
            q: shaped(py, q, [k, n, n])?.unbind(),
            q_error: shaped(py, q_error, [k, n, n])?.unbind(),
            cl: complex(&|c| c.cl)?,
            cl_error: real(&|c| c.errors.as_ref().map(|e| e.cl_error))?,
            cm: complex(&|c| c.cm)?,
            cm_error: real(&|c| c.errors.as_ref().map(|e| e.cm_error))?,
            converged: shaped(py, all.iter().map(|c| c.converged).collect(), [k, n])?.unbind(),
            nonlinearity: real(&|c| c.nonlinearity)?,
            conditions: python_of(py, &serde_json::to_value(&found.conditions).unwrap_or_default())?,
            units: python_of(py, &units_of_forces(scale))?,
            conventions: run::gaf::CONVENTION.to_owned(),
            folder,
            columns: all.iter().map(|c| flat(&found.modes, c)).collect(),
            modes: found.modes.clone(),
        })
    }
}

fn of_parts([re, im]: [f64; 2]) -> Complex64 {
    Complex64::new(re, im)
}

/// A column with the names of `gaf.csv`.
fn flat(modes: &[String], c: &Column) -> Value {
    let mut row = json!({
        "k": c.k, "mode": c.mode, "cl_re": c.cl[0], "cl_im": c.cl[1], "cm_re": c.cm[0], "cm_im": c.cm[1], "converged": c.converged,
    });
    for (i, mode) in modes.iter().enumerate() {
        row[format!("q_{mode}_re")] = c.q[i][0].into();
        row[format!("q_{mode}_im")] = c.q[i][1].into();
    }
    if let Some(e) = &c.errors {
        (row["cl_error"], row["cm_error"]) = (e.cl_error.into(), e.cm_error.into());
        modes.iter().zip(&e.q_error).for_each(|(mode, bar)| row[format!("q_{mode}_error")] = (*bar).into());
    }
    row
}

fn units_of_forces(scale: Scale) -> Value {
    let of = |name: &str| unit_of("flutter.csv", name, scale).unwrap_or("1");
    let length = of("altitude");
    let area = match (scale.dimension, length) {
        (2, _) => length.to_owned(),
        _ => format!("{length}2"),
    };
    json!({
        "reduced_frequencies": "1", "frequencies": of("frequency"), "q": "1", "cl": "1", "cm": "1", "mach": "1", "alpha_deg": "deg",
        "speed": of("speed"), "dynamic_pressure": of("dynamic_pressure"), "chord": length, "area": area, "reduced_length": length,
        "pivot": length,
    })
}
