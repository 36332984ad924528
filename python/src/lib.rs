//! Alula for Python: a case in, loads and fields as NumPy arrays out.
//!
//! The module is a thin layer on the [`Session`](solver::run::Session) of the library: [`cases`] reads files and dicts, [`work`] solves
//! beside the interpreter and passes on what happens, [`results`] hands arrays over without copying them, [`faults`] are the
//! exceptions.
use pyo3::prelude::*;

mod cases;
mod faults;
mod results;
mod work;

/// Aeroelastic loads from a surface file, without a mesh.
///
/// `run` solves a case, `check` tells what one means before it is solved. A case is the path of a case file, or a dict with the same
/// keys: tables are dicts, `[[body]]` is a list of dicts, quantities are numbers or strings with a unit.
#[pymodule(name = "alula")]
mod module {
    use pyo3::prelude::*;

    #[pymodule_export]
    use super::faults::{CaseError, ComputationError};
    #[pymodule_export]
    use super::results::Result;
    #[pymodule_export]
    use super::work::{check, resume, run};

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
