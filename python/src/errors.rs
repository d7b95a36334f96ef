//! The exceptions of the package, which are Python classes, and what of the library becomes which.

use std::fmt::Display;

use pyo3::PyErr;

mod python {
    #![allow(missing_docs)]
    pyo3::import_exception!(asperity.errors, AsperityError);
    pyo3::import_exception!(asperity.errors, CaseError);
}

/// What the command line calls its options, and what they are called here.
const OPTIONS: [(&str, &str); 12] = [
    ("--resume", "resume=True"),
    ("--force", "force=True"),
    ("--extend", "extend=True"),
    ("--retry", "retry=True"),
    ("--interpolate", "interpolate=True"),
    ("--device cpu", "device=\"cpu\""),
    ("--device gpu", "device=\"gpu\""),
    ("--precision auto", "precision=\"auto\""),
    ("--precision mixed", "precision=\"mixed\""),
    ("--threads", "threads"),
    ("--out ", "out="),
    ("--set ", "set "),
];

/// The program's text in the words of Python.
pub fn in_python(error: impl Display) -> String {
    OPTIONS.iter().fold(error.to_string(), |text, (option, word)| text.replace(option, word))
}

/// A case, a study file or an option that is refused; the text is the program's.
pub fn refused(error: impl Display) -> PyErr {
    python::CaseError::new_err(in_python(error))
}

/// Anything else; the text is the program's.
pub fn failed(error: impl Display) -> PyErr {
    python::AsperityError::new_err(in_python(error))
}
