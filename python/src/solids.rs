//! Structures of particles alone.
use std::path::PathBuf;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use solver::case::Case;
use solver::geometry::dimension;
use solver::run::{self, SolidSolution};

use crate::cases::Given;
use crate::faults;
use crate::tables::{arrays, python_of, shaped, table, vectors};
use crate::work::{Wishes, computed, of_solid};

/// Solves a structure of particles alone: its equilibrium, a march, its natural modes or a periodic motion, as `[time]` says.
///
/// Parameters
/// ----------
/// case : str, os.PathLike or dict
///     As for `run`, with bodies that have `solid` and without `flow`.
/// out : str or os.PathLike, optional
///     Folder for tables, checkpoints, fields and pictures; it must hold no run. Without it no file is written.
/// progress, threads : optional
///     As for `run`; `cl`, `cd` and `cm` are None.
///
/// Returns
/// -------
/// Solid
///     Particles at the end, histories, energies, modes.
///
/// Raises
/// ------
/// CaseError, ComputationError, OSError, KeyboardInterrupt
///     As for `run`.
#[pyfunction]
#[pyo3(signature = (case, out=None, progress=None, threads=None))]
pub(crate) fn solid(
    py: Python<'_>,
    case: &Bound<'_, PyAny>,
    out: Option<PathBuf>,
    progress: Option<Py<PyAny>>,
    threads: Option<usize>,
) -> PyResult<Solid> {
    let wishes = Wishes::of(py, progress, threads)?;
    let Given { case, input } = Given::of(case)?;
    if case.has_gas() {
        let text = "the case has a gas: its bodies are no structure alone\nhint: `alula.run` computes it, `Result.solid` has its bodies made of \
                    particles; leave out `flow` otherwise";
        return Err(faults::single(py, text));
    }
    let (folder, own) = (out.clone(), case.clone());
    let found = computed(py, wishes, move |relay| run::solid(&own, &input, folder.as_deref(), relay).map(of_solid))?;
    Solid::of(py, &case, *found, out)
}

/// What was found of a structure of particles alone.
///
/// All is in SI units; masses and energies of plane bodies are those of their `thickness`, of bodies of revolution those of a whole turn.
#[pyclass(frozen, module = "alula")]
pub(crate) struct Solid {
    /// Title of the case.
    #[pyo3(get)]
    title: String,
    /// `equilibrium`, `march`, `modes` or `periodic`.
    #[pyo3(get)]
    study: &'static str,
    /// False where the energy is so far from closed that results are wrong.
    #[pyo3(get)]
    converged: bool,
    /// Names of the bodies, which `fields["body"]` counts from 0.
    #[pyo3(get)]
    bodies: Vec<String>,
    /// Arrays over the N particles at the end, of a periodic motion at the start of the period: `positions`, `at_rest` (positions before),
    /// `displacement`, `velocity` (N, 2 or 3); `stress` (Cauchy's, N, 3, 3); `von_mises_stress`, `pressure`, of metals `plastic_strain` and `temperature`, `body`,
    /// `material`, `volume` and `spacing` at rest (N,).
    #[pyo3(get)]
    fields: Py<PyDict>,
    /// Arrays over recorded times, about 1000 of a march, the steps of the load of an equilibrium, one period of a periodic motion; named as the
    /// columns of `history.csv`: `step`, `time`, energies (`kinetic`, `strain`, `stabilisation`, `contact`, `dissipated`, `damped`), `work`, `open` (part of the
    /// energy that is missing), and the displacements of probes.
    #[pyo3(get)]
    history: Py<PyDict>,
    /// Displacements of the probes by name, arrays (T, 2 or 3) over `history["time"]`.
    #[pyo3(get)]
    probes: Py<PyDict>,
    /// Energies at the end, and `work`: a dict; None of natural modes without a load.
    #[pyo3(get)]
    energies: Py<PyAny>,
    /// Natural modes, arrays (M,): `frequency` (Hz), `omega` (rad/s), `generalised_mass`, `residual`; None where there are none.
    #[pyo3(get)]
    modes: Option<Py<PyDict>>,
    /// Displacement of every particle in each mode (M, N, 2 or 3), the greatest component of which is one; None where there are none.
    #[pyo3(get)]
    shapes: Option<Py<PyAny>>,
    /// Everything that is one number: what `summary.json` holds.
    #[pyo3(get)]
    summary: Py<PyAny>,
    /// Folder of the run; None without one.
    #[pyo3(get)]
    folder: Option<PathBuf>,
}

#[pymethods]
impl Solid {
    fn __repr__(&self) -> String {
        format!("<alula.Solid of '{}': {}>", self.title, self.study)
    }
}

impl Solid {
    /// What was found, handed over to Python.
    pub(crate) fn of(py: Python<'_>, case: &Case, found: SolidSolution, folder: Option<PathBuf>) -> PyResult<Self> {
        let SolidSolution { summary, field, history, shapes } = found;
        let d = usize::from(dimension(case));
        let (times, probes) = (PyDict::new(py), PyDict::new(py));
        let column = |name: &str| history.iter().find(|(n, _)| n == name).map_or(&[][..], |(_, values)| values);
        for probe in &summary.probes {
            let axes = ["x", "y", "z"].map(|axis| column(&format!("{}_u{axis}", probe.name)));
            let at = |k: usize| axes[..d].iter().map(move |axis| axis[k]);
            let flat: Vec<f64> = (0..axes[0].len()).flat_map(at).collect();
            probes.set_item(&probe.name, shaped(py, flat, [axes[0].len(), d])?)?;
        }
        let told = serde_json::to_value(&summary).unwrap_or_default();
        let modes = told["modes"].as_array().filter(|all| !all.is_empty());
        let modes = modes.map(|all| table(py, all).map(Bound::unbind)).transpose()?;
        let (m, n) = (shapes.len(), field.points.len());
        let flat = shapes.into_iter().flatten().flatten().collect();
        let shapes = match modes {
            Some(_) => {
                let rows = vectors(py, flat, d)?;
                Some(rows.call_method1("reshape", (m, n, d))?.unbind())
            }
            None => None,
        };
        for (name, values) in history {
            times.set_item(name, PyArray1::from_vec(py, values))?;
        }
        Ok(Self {
            title: case.title.clone(),
            study: summary.study,
            converged: summary.converged,
            bodies: summary.bodies,
            fields: arrays(py, field, d)?.unbind(),
            history: times.unbind(),
            probes: probes.unbind(),
            energies: python_of(py, &told["ledger"])?,
            modes,
            shapes,
            summary: python_of(py, &told)?,
            folder,
        })
    }
}
