//! The native half of the Python package: cases, runs, studies and laws of the `asperity` library.
//! What only reads files and shapes answers is Python.

mod arguments;
mod case;
mod contacts;
mod errors;
mod law;
mod memory;
mod pictures;
mod process;
mod results;
mod run;
mod wait;

use pyo3::exceptions::PyImportError;
use pyo3::prelude::*;

/// The private module `asperity._asperity`.
#[pymodule]
mod _asperity {
    #[pymodule_export]
    use super::case::{NativeCase, toml_value};
    #[pymodule_export]
    use super::contacts::Contacts;
    #[pymodule_export]
    use super::law::{NativeLaw, fit_law, interpolate_law, table_law, table_study};
    #[pymodule_export]
    use super::pictures::{NativePicture, program};
    #[pymodule_export]
    use super::results::{history, resolved_case, run_picture};
    #[pymodule_export]
    use super::run::{run, study};
    use super::*;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        // Compiled for AVX2: on an older processor the first run would die of an illegal
        // instruction.
        asperity::internals::processor::check().map_err(|error| PyImportError::new_err(error.to_string()))?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
