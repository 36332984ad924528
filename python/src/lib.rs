//! Alula for Python: a case in, loads and fields as NumPy arrays out.
//!
//! The module is a thin layer on [`run`](solver::run) of the library: [`cases`] reads files and dicts, [`work`] computes beside the interpreter
//! and passes on what happens, [`tables`] hands arrays over without copying them, [`faults`] are the exceptions. What is found is
//! in [`results`] (flows), [`aeroelastic`] (flutter, generalised forces), [`solids`] and [`shapes`] (clouds, bodies).
use pyo3::prelude::*;

mod aeroelastic;
mod cases;
mod faults;
mod results;
mod shapes;
mod solids;
mod tables;
mod work;

/// Aeroelastic loads from a surface file, without a mesh.
///
/// `run` solves a case, `flutter` seeks its flutter boundary, `gaf` its generalised aerodynamic forces, `solid` solves a structure alone; `check`,
/// `cloud` and `geometry` tell what a case means before it is solved. A case is the path of a case file, or a dict with the same
/// keys: tables are dicts, `[[body]]` is a list of dicts, quantities are numbers or strings with a unit.
#[pymodule(name = "alula")]
mod module {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::aeroelastic::{Flutter, Gaf, flutter, gaf};
    #[pymodule_export]
    use super::faults::{CaseError, ComputationError};
    #[pymodule_export]
    use super::results::Result;
    #[pymodule_export]
    use super::shapes::{Cloud, Geometry, cloud, geometry};
    #[pymodule_export]
    use super::solids::{Solid, solid};
    #[pymodule_export]
    use super::work::{check, resume, run};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
