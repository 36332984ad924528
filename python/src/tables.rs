//! What the library found as NumPy arrays, which own it: nothing is copied.
use numpy::ndarray::IntoDimension;
use numpy::{Element, PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PySlice};
use serde_json::Value;
use solver::run::Snapshot;

/// Values in the order of their last index as an array of this shape.
pub(crate) fn shaped<'py, T: Element, S: IntoDimension>(
    py: Python<'py>,
    values: Vec<T>,
    shape: S,
) -> PyResult<Bound<'py, PyAny>> {
    Ok(PyArray1::from_vec(py, values).reshape(shape)?.into_any())
}

/// Vectors with three components, one after another, as an array of shape (N, dimension): a view of their first components.
pub(crate) fn vectors(py: Python<'_>, flat: Vec<f64>, dimension: usize) -> PyResult<Bound<'_, PyAny>> {
    let rows = [flat.len() / 3, 3];
    shaped(py, flat, rows)?.get_item((PySlice::full(py), PySlice::new(py, 0, dimension.cast_signed(), 1)))
}

/// Columns by name; vectors in the plane have two components, vorticity has one there, tensors have the shape (N, 3, 3).
pub(crate) fn arrays<'py>(py: Python<'py>, snapshot: Snapshot, dimension: usize) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    all.set_item("positions", vectors(py, snapshot.points.into_flattened(), dimension)?)?;
    for (name, n, values) in snapshot.columns {
        let rows = values.len() / n;
        let array = match (n, name, dimension) {
            (1, ..) => PyArray1::from_vec(py, values).into_any(),
            (9, ..) => shaped(py, values, [rows, 3, 3])?,
            (_, "vorticity", 2) => shaped(py, values, [rows, n])?.get_item((PySlice::full(py), 2))?,
            _ => vectors(py, values, dimension)?,
        };
        all.set_item(name, array)?;
    }
    Ok(all)
}

/// Rows that are dicts with the same names, as a dict of columns: arrays of numbers, NaN where there is none, of flags and of text; lists of
/// all else.
pub(crate) fn table<'py>(py: Python<'py>, rows: &[Value]) -> PyResult<Bound<'py, PyDict>> {
    let all = PyDict::new(py);
    let names = rows.iter().filter_map(Value::as_object).flat_map(|row| row.keys());
    for name in names {
        if all.contains(name)? {
            continue;
        }
        let column: Vec<Value> = rows.iter().map(|row| row[name].clone()).collect();
        let array = match &column {
            all if all.iter().all(|v| v.is_number() || v.is_null()) => {
                PyArray1::from_vec(py, all.iter().map(|v| v.as_f64().unwrap_or(f64::NAN)).collect()).into_any()
            }
            all if all.iter().all(|v| v.is_string() || v.is_boolean()) => {
                py.import("numpy")?.call_method1("array", (list(py, all)?,))?
            }
            all => list(py, all)?.into_bound(py),
        };
        all.set_item(name, array)?;
    }
    Ok(all)
}

/// Rows as a list of dicts, in which None stands for what is not known.
pub(crate) fn list(py: Python<'_>, rows: &[Value]) -> PyResult<Py<PyAny>> {
    python_of(py, &Value::Array(rows.to_vec()))
}

/// A JSON value as what Python makes of it.
pub(crate) fn python_of(py: Python<'_>, value: &Value) -> PyResult<Py<PyAny>> {
    Ok(py.import("json")?.call_method1("loads", (value.to_string(),))?.unbind())
}
