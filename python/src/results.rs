//! Reads back what a run has written.

use std::path::PathBuf;

use asperity::output::{OutputDirectory, StepRecord, read_history};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::errors::failed;

/// The columns of a history, in the order of the file, as names and arrays: whole numbers as int64,
/// others as float64.
#[pyfunction]
pub fn history(py: Python<'_>, dir: PathBuf) -> PyResult<Vec<(String, Py<PyAny>)>> {
    let rows = read_history(&OutputDirectory::existing(dir).history()).map_err(failed)?;
    let table = |row: &StepRecord| serde_json::to_value(row).map_err(failed);
    let names = asperity::output::history_columns();
    let rows = rows.iter().map(table).collect::<PyResult<Vec<_>>>()?;
    let kinds = table(&StepRecord::default())?;
    let column = |name: String| {
        let array = if kinds[&name].is_u64() {
            let values = rows.iter().map(|row| row[&name].as_i64().unwrap_or_default());
            PyArray1::from_iter(py, values).into_any().unbind()
        } else {
            let values = rows.iter().map(|row| row[&name].as_f64().unwrap_or(f64::NAN));
            PyArray1::from_iter(py, values).into_any().unbind()
        };
        (name, array)
    };
    Ok(names.into_iter().map(column).collect())
}

/// The text of the resolved case in a directory; `None` if there is no result.
#[pyfunction]
pub fn resolved_case(dir: PathBuf) -> Option<String> {
    OutputDirectory::existing(dir).read_case()
}
