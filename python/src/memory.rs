//! Memory for as many numbers as Python asks for: what there is not is a `MemoryError`, where an
//! allocation of Rust's would end the process.

use asperity::contact_law::ContactState;
use asperity::internals::memory::left;
use pyo3::PyResult;
use pyo3::exceptions::PyMemoryError;

/// So few bytes are not worth the question what is left.
const SMALL: usize = 16 << 20;

/// Refuses more bytes than the machine has left, before some of them are written to: a system that
/// promises more than it has kills the process then.
pub fn check(what: &str, count: usize, bytes_each: usize) -> PyResult<()> {
    let needed = count.checked_mul(bytes_each).filter(|bytes| isize::try_from(*bytes).is_ok());
    if needed.is_some_and(|needed| needed < SMALL) {
        return Ok(());
    }
    let left = left();
    if needed.is_some_and(|needed| left.is_none_or(|left| needed as u64 <= left)) {
        return Ok(());
    }
    let left = left.map_or(String::new(), |left| format!(", and {:.1} are left", gib(left as f64)));
    let needed = gib(count as f64 * bytes_each as f64);
    Err(PyMemoryError::new_err(format!("{what}: {count} contacts need {needed:.1} GiB{left}. Take fewer at a time")))
}

fn gib(bytes: f64) -> f64 {
    bytes / f64::from(1_u32 << 30)
}

/// So many copies of a value.
pub fn filled<T: Clone>(what: &str, count: usize, value: T) -> PyResult<Vec<T>> {
    let mut values = reserved(what, count)?;
    values.resize(count, value);
    Ok(values)
}

/// An empty vector with room for so many values.
pub fn reserved<T>(what: &str, count: usize) -> PyResult<Vec<T>> {
    let mut values = Vec::new();
    values.try_reserve_exact(count).map_err(|_| {
        let needed = gib(count as f64 * size_of::<T>() as f64);
        PyMemoryError::new_err(format!("{what}: there is no room for {needed:.1} GiB. Take fewer contacts at a time"))
    })?;
    Ok(values)
}

/// Bytes of the memory of a contact.
pub const CONTACT: usize = size_of::<ContactState>();
