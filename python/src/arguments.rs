//! Arguments that Python hands over as anything, each refused by its name.

use std::ops::RangeInclusive;

use asperity::internals::bounded;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyInt};

use crate::errors::refused;

/// A whole number in a range: an `int`, or what has `__index__`, as NumPy's integers have; no
/// boolean. `allowed` is the range in words.
pub fn whole(name: &str, value: &Bound<'_, PyAny>, range: RangeInclusive<usize>, allowed: &str) -> PyResult<usize> {
    let kind = value.get_type().name()?;
    if value.is_instance_of::<PyBool>() || !(value.is_instance_of::<PyInt>() || value.hasattr("__index__")?) {
        return Err(refused(format!("{name}: is a {kind}, which is the wrong type. Allowed: {allowed}")));
    }
    // What does not fit, negative or too large, is out of range as well.
    match value.extract::<usize>() {
        Ok(number) if range.contains(&number) => Ok(number),
        Ok(number) => Err(refused(format!("{name}: is {number}. Allowed: {allowed}"))),
        Err(error) if error.is_instance_of::<pyo3::exceptions::PyOverflowError>(value.py()) => {
            Err(refused(format!("{name}: is {}. Allowed: {allowed}", briefly(value))))
        }
        Err(error) => Err(error),
    }
}

/// A number as Python writes it, if that is not too long.
fn briefly(value: &Bound<'_, PyAny>) -> String {
    match value.str().map(|text| text.to_string()) {
        Ok(text) if text.len() <= 40 => text,
        _ => "a number of many digits".to_owned(),
    }
}

/// Elements along the contact radius of simulations for a law.
pub fn elements(value: &Bound<'_, PyAny>) -> PyResult<usize> {
    whole("elements", value, 4..=16, "4 to 16")
}

/// Refuses a text that is longer than the file in which it would be read.
pub fn check_length(name: &str, text: &str) -> PyResult<()> {
    if text.len() as u64 <= bounded::CASE {
        return Ok(());
    }
    Err(refused(format!("{name}: has {} bytes. Allowed: at most {} MiB", text.len(), bounded::CASE >> 20)))
}
