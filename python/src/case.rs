//! A checked case.

use std::path::PathBuf;

use asperity::Case;
use asperity::case::CaseError;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyString, PyTuple};

use crate::errors::refused;

/// A case that has passed its checks.
#[pyclass(name = "NativeCase", frozen)]
pub struct NativeCase {
    /// The case, in the user's units.
    pub case: Case,
}

#[pymethods]
impl NativeCase {
    /// Of a table with the keys of a case file.
    #[staticmethod]
    fn from_dict(table: &Bound<'_, PyDict>) -> PyResult<Self> {
        Case::from_table(&to_table(table, "")?).map(|case| Self { case }).map_err(refused)
    }

    /// Of the text of a case file.
    #[staticmethod]
    fn parse(text: &str, name: &str, settings: Vec<String>) -> PyResult<Self> {
        Case::parse(text, name, &settings).map(|case| Self { case }).map_err(refused)
    }

    /// Of a case file.
    #[staticmethod]
    fn load(file: PathBuf, settings: Vec<String>) -> PyResult<Self> {
        match Case::load(&file, &settings) {
            Ok(case) => Ok(Self { case }),
            // As Python says it of any file.
            Err(CaseError::Unreadable { source, .. }) if source.kind() == std::io::ErrorKind::NotFound => {
                Err(pyo3::exceptions::PyFileNotFoundError::new_err(format!("{}: {source}", file.display())))
            }
            Err(error) => Err(refused(error)),
        }
    }

    /// What is odd about the case.
    fn notes(&self) -> Vec<String> {
        self.case.doubts().iter().map(ToString::to_string).collect()
    }

    /// The case as TOML, every default written out.
    fn to_toml(&self) -> String {
        self.case.to_toml()
    }

    /// The case as a table, every default written out.
    fn to_dict(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        let table = toml::Value::try_from(&self.case).map_err(refused)?;
        Ok(from_value(py, &table)?.unbind())
    }
}

/// A dictionary as TOML has it. `None` is a key that is not there.
pub fn to_table(table: &Bound<'_, PyDict>, at: &str) -> PyResult<toml::Table> {
    let mut converted = toml::Table::new();
    for (key, value) in table {
        let key: String =
            key.extract().map_err(|_| refused(format!("case: {at}: has a key that is not a string. Allowed: strings")))?;
        let below = if at.is_empty() { key.clone() } else { format!("{at}.{key}") };
        if !value.is_none() {
            converted.insert(key, to_value(&value, &below)?);
        }
    }
    Ok(converted)
}

fn to_value(value: &Bound<'_, PyAny>, at: &str) -> PyResult<toml::Value> {
    if let Ok(truth) = value.cast::<PyBool>() {
        return Ok(toml::Value::Boolean(truth.is_true()));
    }
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(toml::Value::String(text.to_string()));
    }
    if let Ok(table) = value.cast::<PyDict>() {
        return Ok(toml::Value::Table(to_table(table, at)?));
    }
    if value.is_instance_of::<PyInt>() {
        // An integer beyond 64 bits is still a number, as in a file.
        let integer = value.extract::<i64>().map(toml::Value::Integer);
        return integer.or_else(|_| value.extract::<f64>().map(toml::Value::Float));
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(toml::Value::Float(value.extract()?));
    }
    if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
        let item = |(i, item): (usize, PyResult<Bound<'_, PyAny>>)| to_value(&item?, &format!("{at}.{i}"));
        return value.try_iter()?.enumerate().map(item).collect::<PyResult<Vec<_>>>().map(toml::Value::Array);
    }
    // NumPy's scalars and arrays.
    if let Ok(list) = value.call_method0("tolist") {
        return to_value(&list, at);
    }
    let kind = value.get_type().name()?;
    Err(refused(format!(
        "case: {at}: is a {kind}, which is the wrong type. Allowed: numbers, strings, booleans, lists and dictionaries"
    )))
}

/// A TOML value as Python has it.
pub fn from_value<'py>(py: Python<'py>, value: &toml::Value) -> PyResult<Bound<'py, PyAny>> {
    Ok(match value {
        toml::Value::String(text) => PyString::new(py, text).into_any(),
        toml::Value::Integer(number) => PyInt::new(py, *number).into_any(),
        toml::Value::Float(number) => PyFloat::new(py, *number).into_any(),
        toml::Value::Boolean(truth) => PyBool::new(py, *truth).to_owned().into_any(),
        toml::Value::Datetime(date) => PyString::new(py, &date.to_string()).into_any(),
        toml::Value::Array(items) => {
            let items = items.iter().map(|item| from_value(py, item)).collect::<PyResult<Vec<_>>>()?;
            PyList::new(py, items)?.into_any()
        }
        toml::Value::Table(table) => {
            let converted = PyDict::new(py);
            for (key, item) in table {
                converted.set_item(key, from_value(py, item)?)?;
            }
            converted.into_any()
        }
    })
}
