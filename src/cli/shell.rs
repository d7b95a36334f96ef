//! `asperity completions` and `asperity man`: what shells and `man` know of the program, made from
//! its own definition of the command line.

use std::fs;
use std::path::PathBuf;

use clap::Args;
use clap_complete::Shell;

use crate::output::refuse_foreign;

use super::{CliError, Exit, print};

/// Print completions for a shell.
///
/// For bash: asperity completions bash > ~/.local/share/bash-completion/completions/asperity
#[derive(Clone, Debug, Args)]
pub struct CompletionsArgs {
    /// The shell.
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: Shell,
}

/// Write man pages to a directory, one for each subcommand.
#[derive(Clone, Debug, Args)]
pub struct ManArgs {
    /// The directory; it is created if necessary, and existing pages are replaced.
    #[arg(value_name = "DIR")]
    pub dir: PathBuf,
}

/// Prints the completions for a command line.
pub fn completions(args: &CompletionsArgs, mut command: clap::Command) -> Result<Exit, CliError> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "asperity", &mut script);
    print(&String::from_utf8_lossy(&script))?;
    Ok(Exit::Done)
}

/// Writes the pages of a command line and says where.
pub fn man(args: &ManArgs, command: clap::Command) -> Result<Exit, CliError> {
    let failed = |what| move |source| CliError::Out { dir: args.dir.clone(), what, source };
    fs::create_dir_all(&args.dir).map_err(failed("be created"))?;
    for entry in fs::read_dir(&args.dir).map_err(failed("be read"))?.flatten() {
        let name = entry.file_name();
        if name.to_string_lossy().starts_with("asperity") && name.to_string_lossy().ends_with(".1") {
            refuse_foreign(&entry.path())?;
        }
    }
    clap_mangen::generate_to(command, &args.dir).map_err(failed("be written"))?;
    print(&format!("man pages in {0}; `man -l {0}/asperity.1` shows the first\n", args.dir.display()))?;
    Ok(Exit::Done)
}
