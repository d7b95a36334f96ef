//! A checked case.

use std::path::PathBuf;

use asperity::Case;
use asperity::case::{CaseError, Document, mistakes};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyList, PyMapping, PyString, PyTuple};

use crate::arguments::check_length;
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
    fn from_dict(table: &Bound<'_, PyAny>) -> PyResult<Self> {
        let Ok(table) = table.cast::<PyMapping>() else {
            let kind = table.get_type().name()?;
            return Err(refused(format!("case: is a {kind}, which is the wrong type. Allowed: a dictionary of tables")));
        };
        Self::of(&Document::from_table(&Reading::default().table(table, "")?))
    }

    /// Of the text of a case file.
    #[staticmethod]
    fn parse(text: &str, name: &str, settings: Vec<String>) -> PyResult<Self> {
        check_length(name, text)?;
        let mut document = Document::parse(text, name).map_err(refused)?;
        document.set_arguments(&settings).map_err(refused)?;
        Self::of(&document)
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
            // All that is wrong with it; what cannot be read twice has been told once.
            Err(first) => {
                // A pipe has been read, and what is too long has been refused.
                let is_short = std::fs::metadata(&file).is_ok_and(|found| found.is_file() && found.len() <= MOST_TEXT);
                let again = is_short.then(|| std::fs::read_to_string(&file).ok()).flatten();
                let document = again.and_then(|text| Document::parse(&text, &file.display().to_string()).ok());
                let set = document.and_then(|mut document| document.set_arguments(&settings).ok().map(|()| document));
                set.map_or_else(|| Err(refused(first)), |document| Self::of(&document))
            }
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

impl NativeCase {
    /// The case, or all that is wrong with it, a line each.
    fn of(document: &Document) -> PyResult<Self> {
        Case::from_document(document).map(|case| Self { case }).map_err(|first| match mistakes(document) {
            found if found.len() > 1 => refused(found.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")),
            _ => refused(first),
        })
    }
}

/// A value as TOML has it, in one line: for the text of a study, and for a setting.
#[pyfunction]
pub fn toml_value(value: &Bound<'_, PyAny>, at: &str) -> PyResult<String> {
    check_key(at)?;
    Reading::default().value(value, at).map(|value| value.to_string())
}

/// Most bytes of a case file that is read once more, for all of its mistakes.
const MOST_TEXT: u64 = 1 << 20;
/// Most values of a case, of which the points of a table have the most.
const MOST: usize = 100_000;
/// Most bytes of a key.
const LONGEST: usize = 1000;
/// Most tables and lists within each other.
const DEEPEST: usize = 64;

fn check_key(key: &str) -> PyResult<()> {
    if key.len() <= LONGEST {
        return Ok(());
    }
    let (start, bytes) = (key.chars().take(20).collect::<String>(), key.len());
    Err(refused(format!("case: the key {start:?}... has {bytes} bytes. Allowed: at most {LONGEST}")))
}

/// How far a value has been read: one that contains itself, or another without end, is refused.
#[derive(Default)]
struct Reading {
    values: usize,
    depth: usize,
}

impl Reading {
    /// A mapping with names as keys. `None` is a key that is not there.
    fn table(&mut self, table: &Bound<'_, PyMapping>, at: &str) -> PyResult<toml::Table> {
        let mut converted = toml::Table::new();
        for key in table.try_iter()? {
            let key = key?;
            let name = key.cast::<PyString>().ok().and_then(|name| name.to_cow().ok());
            let place = if at.is_empty() { String::new() } else { format!("{at}: ") };
            let name = name
                .ok_or_else(|| refused(format!("case: {place}has a key that is not a string. Allowed: strings")))?
                .into_owned();
            check_key(&name)?;
            let below = if at.is_empty() { name.clone() } else { format!("{at}.{name}") };
            let value = table.get_item(&key)?;
            if !value.is_none() {
                converted.insert(name, self.value(&value, &below)?);
            }
        }
        Ok(converted)
    }

    fn value(&mut self, value: &Bound<'_, PyAny>, at: &str) -> PyResult<toml::Value> {
        if self.depth >= DEEPEST {
            return Err(refused(format!("case: {at}: is in more than {DEEPEST} tables and lists. Allowed: fewer")));
        }
        self.count(1, at)?;
        self.depth += 1;
        let read = self.within(value, at);
        self.depth -= 1;
        read
    }

    /// Refuses more values than a case may have, before they are there.
    fn count(&mut self, more: usize, at: &str) -> PyResult<()> {
        self.values = self.values.saturating_add(more);
        let few = self.values <= MOST;
        if few { Ok(()) } else { Err(refused(format!("case: {at}: has too many values. Allowed: {MOST} in all"))) }
    }

    fn within(&mut self, value: &Bound<'_, PyAny>, at: &str) -> PyResult<toml::Value> {
        if let Ok(truth) = value.cast::<PyBool>() {
            return Ok(toml::Value::Boolean(truth.is_true()));
        }
        if let Ok(text) = value.cast::<PyString>() {
            let text = text.to_cow().map_err(|_| refused(format!("case: {at}: is no valid text. Allowed: Unicode")))?;
            return Ok(toml::Value::String(text.into_owned()));
        }
        if value.is_instance_of::<PyInt>() {
            // An integer beyond 64 bits is still a number, as in a file.
            let integer = value.extract::<i64>().map(toml::Value::Integer);
            let number = integer.or_else(|_| value.extract::<f64>().map(toml::Value::Float));
            return number.map_err(|_| refused(format!("case: {at}: is a number beyond 1.8e308. Allowed: smaller ones")));
        }
        if value.is_instance_of::<PyFloat>() {
            return Ok(toml::Value::Float(value.extract()?));
        }
        if value.is_instance_of::<PyList>() || value.is_instance_of::<PyTuple>() {
            let item = |(i, item): (usize, PyResult<Bound<'_, PyAny>>)| self.value(&item?, &format!("{at}.{i}"));
            return value.try_iter()?.enumerate().map(item).collect::<PyResult<Vec<_>>>().map(toml::Value::Array);
        }
        if let Ok(table) = value.cast::<PyMapping>() {
            return self.table(table, at).map(toml::Value::Table);
        }
        self.of_numpy(value, at)
    }

    /// NumPy's scalars and arrays.
    fn of_numpy(&mut self, value: &Bound<'_, PyAny>, at: &str) -> PyResult<toml::Value> {
        if let Ok(list) = value.getattr("tolist") {
            let size = value.getattr("size").and_then(|size| size.extract::<usize>()).unwrap_or(0);
            self.count(size, at)?;
            self.values -= size;
            if value.getattr("mask").and_then(|mask| mask.call_method0("any")?.is_truthy()).unwrap_or(false) {
                return Err(refused(format!("case: {at}: has masked values. Allowed: numbers")));
            }
            return self.value(&list.call0()?, at);
        }
        let kind = value.get_type().name()?;
        Err(refused(format!(
            "case: {at}: is a {kind}, which is the wrong type. Allowed: numbers, strings, booleans, lists and dictionaries"
        )))
    }
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
