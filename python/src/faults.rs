//! Exceptions: who has to act decides which one.
use pyo3::create_exception;
use pyo3::exceptions::{PyOSError, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use solver::case::CaseErrors;
use solver::run::{Blame, RunError};

use crate::results::python_of;

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
    let told = || -> PyResult<PyErr> {
        let mut mistakes = serde_json::to_value(&errors.errors).unwrap_or_default();
        for place in mistakes.as_array_mut().into_iter().flatten().filter(|_| !in_file) {
            ["line", "column", "end_column"].into_iter().for_each(|name| place[name] = serde_json::Value::Null);
        }
        let exception = CaseError::new_err(errors.render(false));
        exception.value(py).setattr("mistakes", python_of(py, &mistakes)?)?;
        Ok(exception)
    };
    told().unwrap_or_else(|problem| problem)
}

/// Why a run failed, as an exception.
pub(crate) fn of_run(py: Python<'_>, error: &RunError) -> PyErr {
    let text = match error {
        // the hint names options of the command
        RunError::Folder { what, .. } => format!("{what}\nhint: choose another folder with `out`"),
        other => other.to_string(),
    };
    match error.blame() {
        Blame::Files => PyOSError::new_err(text),
        Blame::Computation => ComputationError::new_err(text),
        Blame::Case => without_place(py, &error.messages()),
    }
}

/// A mistake that has no place in a file.
pub(crate) fn single(py: Python<'_>, text: &str) -> PyErr {
    without_place(py, &[text.to_owned()])
}

/// Mistakes that have no place in a file.
fn without_place(py: Python<'_>, texts: &[String]) -> PyErr {
    let mistake = |text: &String| {
        let (message, hint) =
            text.split_once("\nhint: ").map_or((text.as_str(), None), |(what, hint)| (what, Some(hint)));
        serde_json::json!({
            "key": null, "line": null, "column": null, "end_column": null,
            "message": message, "value": null, "allowed": null, "hint": hint,
        })
    };
    let told = || -> PyResult<PyErr> {
        let mistakes = serde_json::Value::Array(texts.iter().map(mistake).collect());
        let exception = CaseError::new_err(texts.join("\n\n"));
        exception.value(py).setattr("mistakes", python_of(py, &mistakes)?)?;
        Ok(exception)
    };
    told().unwrap_or_else(|problem| problem)
}
