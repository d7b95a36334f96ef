//! The exceptions of the package, which are Python classes, and what of the library becomes which.

use std::fmt::Display;

use pyo3::PyErr;

mod python {
    #![allow(missing_docs)]
    pyo3::import_exception!(asperity.errors, AsperityError);
    pyo3::import_exception!(asperity.errors, CaseError);
}

/// What the command line calls its options, and what they are called here; the first that fits.
const OPTIONS: [(&str, &str); 13] = [
    ("--resume", "resume=True"),
    ("--force", "force=True"),
    ("--extend", "extend=True"),
    ("--retry", "retry=True"),
    ("--interpolate", "interpolate=True"),
    ("--device cpu", "device=\"cpu\""),
    ("--device gpu", "device=\"gpu\""),
    ("--precision auto, mixed or f32", "precision=\"auto\", \"mixed\" or \"f32\""),
    ("--precision", "precision"),
    ("--threads", "threads"),
    ("--format", "format"),
    ("--out", "out"),
    ("--set", "set"),
];

/// The program's text in the words of Python. What stands within a word, as in a name of the
/// user's, stays.
pub fn in_python(error: impl Display) -> String {
    let mut text = error.to_string();
    for (option, word) in OPTIONS {
        let mut from = 0;
        while let Some(at) = text[from..].find(option).map(|at| from + at) {
            let joins = |c: char| c.is_alphanumeric() || "-_/.".contains(c);
            let (before, after) = (text[..at].chars().next_back(), text[at + option.len()..].chars().next());
            let alone = !before.is_some_and(joins) && !after.is_some_and(|c| c.is_alphanumeric() || c == '-' || c == '_');
            if alone {
                text.replace_range(at..at + option.len(), word);
            }
            from = at + if alone { word.len() } else { option.len() };
        }
    }
    text
}

/// A case, a study file or an option that is refused; the text is the program's.
pub fn refused(error: impl Display) -> PyErr {
    python::CaseError::new_err(in_python(error))
}

/// Anything else; the text is the program's.
pub fn failed(error: impl Display) -> PyErr {
    python::AsperityError::new_err(in_python(error))
}
