//! Reads back what a run has written, and draws it.

use std::path::PathBuf;

use asperity::law::plots::beside_run;
use asperity::output::plots::{Picture, replot};
use asperity::output::{OutputDirectory, StepRecord, read_history};
use numpy::PyArray1;
use pyo3::prelude::*;

use crate::errors::failed;
use crate::law::NativeLaw;
use crate::pictures::{NativePicture, chosen, view};
use crate::process::compute;

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

/// A picture of a run, of its directory.
#[pyfunction]
pub fn run_picture(
    py: Python<'_>,
    dir: PathBuf,
    name: Option<&str>,
    law: Option<&NativeLaw>,
    width: Option<&str>,
    title: bool,
) -> PyResult<NativePicture> {
    let out = OutputDirectory::existing(dir);
    let case = out.load_case().map_err(failed)?;
    let view = view(&case, width, title)?;
    let pictures = compute(py, || -> PyResult<Vec<Picture>> {
        let history = read_history(&out.history()).map_err(failed)?;
        let mut pictures = replot(&out, &case, &history, &view).map_err(failed)?;
        if let Some(law) = law {
            pictures.push(beside_run(law.file(), &case, &history, &view).map_err(failed)?.0);
        }
        Ok(pictures)
    })??;
    chosen(pictures, name)
}
