//! `asperity schema`: JSON Schema of the files that users write.

use clap::{Args, ValueEnum};

use super::{CliError, Exit, print_json};
use crate::case::{case_schema, study_schema};

/// A kind of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FileKind {
    /// A case file.
    Case,
    /// A study file.
    Study,
}

/// Print the JSON Schema of case or study files, for editors.
///
/// Editors with Even Better TOML (taplo) find it through a first line `#:schema
/// ./case.schema.json`. Ranges that depend on other keys are checked by `asperity check` only.
#[derive(Clone, Debug, Args)]
pub struct SchemaArgs {
    /// The kind of file.
    #[arg(value_enum, value_name = "KIND")]
    pub kind: FileKind,
}

/// Prints the schema.
pub fn schema(args: &SchemaArgs) -> Result<Exit, CliError> {
    print_json(&match args.kind {
        FileKind::Case => case_schema(),
        FileKind::Study => study_schema(),
    })?;
    Ok(Exit::Done)
}
