//! The law for other programs: C headers and a table for engines, a Python module that compiles
//! them, and test vectors for both.
//!
//! What of them is the update comes from [`contact_law::export`](crate::contact_law::export).

mod engine;
mod file;
mod start;
mod vectors;

pub use engine::{beyond_the_law, engine_files, engine_source};
pub use file::ExportedFile;
pub use start::{Engine, Start, start_files};
pub use vectors::unit_vectors;

use self::engine::python_files;
use super::{LawError, LawFile};
use crate::case::Case;
use crate::contact_law::export::{HEADER_NAME, header};

/// A language of the export.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Language {
    /// Headers and a table, C99, C++17 and CUDA.
    C,
    /// One module, Python 3.8 or later, and a C compiler.
    Python,
}

/// The files of any kind of law: the law itself first, then what belongs to it. A table needs no
/// case; of other laws it is that of a case's material and friction.
///
/// # Errors
/// What [`engine_files`] has.
pub fn law_files(law: &LawFile, language: Language, case: Option<&Case>) -> Result<Vec<ExportedFile>, LawError> {
    match language {
        Language::C => engine_files(law, case),
        Language::Python => python_files(law, case),
    }
}

/// The law itself as source of a language: for C the table, which includes the update's header.
///
/// # Errors
/// As [`law_files`].
pub fn law_source(law: &LawFile, language: Language, case: Option<&Case>) -> Result<String, LawError> {
    match language {
        Language::C => Ok(in_one_file(&engine_source(law, case)?)),
        Language::Python => Ok(python_files(law, case)?.swap_remove(0).content),
    }
}

/// A header with the update in place of the line that includes it.
fn in_one_file(text: &str) -> String {
    text.replacen(&format!("#include \"{HEADER_NAME}\"\n"), &header(), 1)
}
