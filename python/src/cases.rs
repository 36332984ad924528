//! Cases from files and from dicts.
use std::path::{Path, PathBuf};

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyMapping, PyString};
use solver::case::{Case, open_regular, read_in, read_written, text_of};
use toml::{Table, Value};

use crate::faults;

/// What messages call a case that is a dict.
const DICT: &str = "case";
/// Ends of the names of files of triangles; others hold the coordinates of a section.
const SOLID: [&str; 3] = ["stl", "obj", "ply"];

/// A case, and the folder that its file names refer to.
pub(crate) struct Given {
    pub(crate) case: Case,
    pub(crate) input: PathBuf,
}

impl Given {
    /// The case in the file at a path, or in a dict whose file names refer to the working folder.
    pub(crate) fn of(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = given.py();
        if let Ok(path) = given.extract::<PathBuf>() {
            let input = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
            let case = read_in(&text_at(py, &path)?, &path.display().to_string(), &input);
            let case = case.map_err(|mistakes| faults::of_case(py, &mistakes, true))?;
            return Ok(Self { case, input });
        }
        Self::of_table(py, &table(mapping(given)?, "")?, PathBuf::new())
    }

    /// The same; refuses structures alone.
    pub(crate) fn with_gas(self, py: Python<'_>) -> PyResult<Self> {
        if self.case.has_gas() {
            return Ok(self);
        }
        let text = "the case has no gas: it is a structure of particles alone\nhint: `alula.solid` computes it";
        Err(faults::single(py, text))
    }

    /// Bodies: those of a case, of a dict that needs nothing but `body`, or that of a surface file, which is one that is not called `.toml`.
    pub(crate) fn bodies_of(given: &Bound<'_, PyAny>) -> PyResult<Self> {
        let py = given.py();
        let ends = |path: &Path, end: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(end));
        let (mut entries, input) = match given.extract::<PathBuf>() {
            Ok(path) if ends(&path, "toml") => return Self::of(given),
            Ok(path) => {
                open_regular(&path).map_err(|problem| unreadable(&path, &problem))?;
                let shape = if SOLID.iter().any(|end| ends(&path, end)) { "surface" } else { "airfoil" };
                let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
                let body = Table::from_iter([(shape.to_owned(), Value::String(name))]);
                let input = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
                (Table::from_iter([("body".to_owned(), Value::Array(vec![Value::Table(body)]))]), input)
            }
            Err(_) => (table(mapping(given)?, "")?, PathBuf::new()),
        };
        if ["flow", "initial", "time"].iter().all(|name| !entries.contains_key(*name)) {
            entries.insert("flow".to_owned(), Value::Table(Table::from_iter([("mach".to_owned(), Value::Float(0.5))])));
        }
        Self::of_table(py, &entries, input)
    }

    fn of_table(py: Python<'_>, table: &Table, input: PathBuf) -> PyResult<Self> {
        let case = read_in(&table.to_string(), DICT, &input);
        Ok(Self { case: case.map_err(|mistakes| faults::of_case(py, &mistakes, false))?, input })
    }
}

fn mapping<'a, 'py>(given: &'a Bound<'py, PyAny>) -> PyResult<&'a Bound<'py, PyMapping>> {
    given.cast::<PyMapping>().or_else(|_| {
        let kind = given.get_type().name()?;
        Err(PyTypeError::new_err(format!("a case is the path of a case file or a dict with its keys, not a `{kind}`")))
    })
}

fn unreadable(path: &Path, problem: &std::io::Error) -> PyErr {
    std::io::Error::new(problem.kind(), format!("cannot read `{}`: {problem}", path.display())).into()
}

fn text_at(py: Python<'_>, path: &Path) -> PyResult<String> {
    let bytes = read_written(path).map_err(|problem| unreadable(path, &problem))?;
    text_of(&bytes).map_err(|problem| {
        let hint = "a case file is TOML, saved as UTF-8";
        faults::single(py, &format!("cannot read `{}`: {problem}\nhint: {hint}", path.display()))
    })
}

/// The entries of a mapping at `path`; those that are None are left out.
fn table(given: &Bound<'_, PyMapping>, path: &str) -> PyResult<Table> {
    let mut entries = Table::new();
    for item in given.items()?.iter() {
        let (key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let key = key.cast::<PyString>().map_err(|_| {
            PyTypeError::new_err(format!("keys of a case are text; `{}` has the key {key}", place(path)))
        })?;
        let here = if path.is_empty() { key.to_string() } else { format!("{path}.{key}") };
        if !value.is_none() {
            entries.insert(key.to_string(), self::value(&value, &here)?);
        }
    }
    Ok(entries)
}

/// Numbers, among them those of NumPy, text, paths, mappings and sequences.
fn value(given: &Bound<'_, PyAny>, path: &str) -> PyResult<Value> {
    if let Ok(flag) = given.cast::<PyBool>() {
        return Ok(Value::Boolean(flag.is_true()));
    }
    if let Ok(text) = given.extract::<String>() {
        return Ok(Value::String(text));
    }
    if given.cast::<PyDict>().is_ok() || given.cast::<PyMapping>().is_ok() {
        return Ok(Value::Table(table(given.cast()?, path)?));
    }
    if given.cast::<PyFloat>().is_ok() {
        return Ok(Value::Float(given.extract()?));
    }
    // whole numbers of any kind, which a float is not
    if given.hasattr("__index__")? && !given.hasattr("__len__")? {
        let whole = given.extract().map_err(|_| PyValueError::new_err(format!("`{path}` is too large: {given}")))?;
        return Ok(Value::Integer(whole));
    }
    if let Ok(file) = given.extract::<PathBuf>() {
        return Ok(Value::String(file.to_string_lossy().into_owned()));
    }
    if let Ok(items) = given.try_iter() {
        let item = |(k, item): (usize, PyResult<Bound<'_, PyAny>>)| value(&item?, &format!("{path}[{k}]"));
        return Ok(Value::Array(items.enumerate().map(item).collect::<PyResult<_>>()?));
    }
    if let Ok(number) = given.extract::<f64>() {
        return Ok(Value::Float(number));
    }
    let kind = given.get_type().name()?;
    Err(PyTypeError::new_err(format!(
        "`{path}` is a `{kind}`; allowed: numbers, text with units, booleans, paths, dicts and lists of these"
    )))
}

fn place(path: &str) -> &str {
    if path.is_empty() { DICT } else { path }
}
