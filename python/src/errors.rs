//! The exceptions of the package, which are Python classes, and what of the library becomes which.

use std::fmt::Display;

use pyo3::PyErr;

mod python {
    #![allow(missing_docs)]
    pyo3::import_exception!(asperity.errors, AsperityError);
    pyo3::import_exception!(asperity.errors, CaseError);
}

/// A case, a study file or an option that is refused; the text is the program's.
pub fn refused(error: impl Display) -> PyErr {
    python::CaseError::new_err(error.to_string())
}

/// Anything else; the text is the program's.
pub fn failed(error: impl Display) -> PyErr {
    python::AsperityError::new_err(error.to_string())
}
