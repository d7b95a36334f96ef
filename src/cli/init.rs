//! `asperity init`: a case file to start from.

use std::path::PathBuf;

use clap::Args;
use clap::builder::PossibleValuesParser;

use super::{CliError, Exit, print};
use crate::case::keys::LAWS;
use crate::case::{short_case, starter_case};
use crate::output::write_atomically;
use crate::quoting;

/// Write a commented case file that runs as it stands.
///
/// It has every key with its meaning, unit and range; optional keys are comments with their
/// defaults.
#[derive(Clone, Debug, Args)]
pub struct InitArgs {
    /// The file to write; `.toml` is added if it has no extension. `-` writes to stdout.
    #[arg(value_name = "NAME", default_value = "case.toml")]
    pub name: PathBuf,
    /// The hardening law of the material.
    #[arg(long, value_name = "LAW", default_value = "ideal", value_parser = PossibleValuesParser::new(LAWS))]
    pub material: String,
    /// Twenty lines: only the keys that a case must have, and how to run it.
    #[arg(long)]
    pub short: bool,
    /// Replace an existing file.
    #[arg(long)]
    pub force: bool,
}

/// Writes the file and says what to do with it.
pub fn init(args: &InitArgs) -> Result<Exit, CliError> {
    let case = if args.short { short_case } else { starter_case };
    if args.name.as_os_str() == "-" {
        print(&case(&args.material, "case.toml"))?;
        return Ok(Exit::Done);
    }
    let mut file = args.name.clone();
    if file.extension().is_none() {
        file.set_extension("toml");
    }
    let name = quoting::path(&file);
    if file.exists() && !args.force {
        return Err(CliError::FileThere { file });
    }
    write_atomically(&file, |out| out.write_all(case(&args.material, &name).as_bytes()))?;
    print(&format!("{} written; `asperity run {name}` runs it\n", file.display()))?;
    Ok(Exit::Done)
}
