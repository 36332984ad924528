//! Exceptions: who has to act decides which one.
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use serde_json::{Value, json};
use solver::case::{CaseErrors, abridged};
use solver::run::{Blame, RunError};

use crate::tables::python_of;

create_exception!(
    alula,
    CaseError,
    PyValueError,
    "A case cannot be computed as it is written. `mistakes` lists all that is wrong: dicts with `key`, `line`, `column`, `end_column`, \
     `message`, `value`, `allowed` and `hint`, each None where unknown."
);
create_exception!(
    alula,
    ComputationError,
    PyRuntimeError,
    "A computation broke off: the message says where, and what may help."
);

/// All mistakes of a case as one exception. Lines and columns are told `in_file` only.
pub(crate) fn of_case(py: Python<'_>, errors: &CaseErrors, in_file: bool) -> PyErr {
    raised(py, errors.render(false), mistakes(errors, in_file))
}

fn mistakes(errors: &CaseErrors, in_file: bool) -> Vec<Value> {
    let mut mistakes = serde_json::to_value(&errors.errors).unwrap_or_default();
    for place in mistakes.as_array_mut().into_iter().flatten().filter(|_| !in_file) {
        ["line", "column", "end_column"].into_iter().for_each(|name| place[name] = Value::Null);
    }
    mistakes.as_array().cloned().unwrap_or_default()
}

/// Why a run failed, as an exception.
pub(crate) fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    let text = match error {
        RunError::Folder { what, hint } => format!("{what}\nhint: {}", in_python(hint)),
        other => abridged(&other.to_string()),
    };
    match error.blame() {
        Blame::Files => PyOSError::new_err(text),
        Blame::Computation => ComputationError::new_err(text),
        Blame::Case => match error {
            RunError::Several(all) => of_all(py, all),
            one => of_all(py, std::slice::from_ref(one)),
        },
    }
}

/// All that keeps a case from being computed as one exception.
pub(crate) fn of_all(py: Python<'_>, errors: &[RunError]) -> PyErr {
    let of = |error: &RunError| match error {
        RunError::Case(errors) => mistakes(errors, true),
        other => vec![mistake(&abridged(&other.to_string()))],
    };
    let text = |error: &RunError| match error {
        RunError::Case(errors) => errors.render(false),
        other => abridged(&other.to_string()),
    };
    raised(py, errors.iter().map(text).collect::<Vec<_>>().join("\n"), errors.iter().flat_map(of).collect())
}

/// A mistake that has no place in a file.
pub(crate) fn single(py: Python<'_>, text: &str) -> PyErr {
    raised(py, text.to_owned(), vec![mistake(text)])
}

/// A hint that names options of the command, in the words of this package.
fn in_python(hint: &str) -> String {
    hint.replace(", or replace it with `--force`", "").replace(" --force", "").replace("--out", "out")
}

fn mistake(text: &str) -> Value {
    let (message, hint) = text.split_once("\nhint: ").map_or((text, None), |(what, hint)| (what, Some(hint)));
    json!({
        "key": null, "line": null, "column": null, "end_column": null,
        "message": message, "value": null, "allowed": null, "hint": hint,
    })
}

fn raised(py: Python<'_>, text: String, mistakes: Vec<Value>) -> PyErr {
    let told = || -> PyResult<PyErr> {
        let exception = CaseError::new_err(text);
        exception.value(py).setattr("mistakes", python_of(py, &Value::Array(mistakes))?)?;
        Ok(exception)
    };
    told().unwrap_or_else(|problem| problem)
}
