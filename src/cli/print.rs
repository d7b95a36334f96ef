//! What subcommands say: text and JSON on stdout, a warning on stderr.

use std::io::Write;
use std::path::Path;

use serde::Serialize;

use super::CliError;
use crate::law::range::OutOfRange;

/// Writes indented JSON to stdout; what is not a number is null.
pub fn print_json(value: &impl Serialize) -> Result<(), CliError> {
    // Plain numbers, words and lists: nothing that could fail.
    print(&(serde_json::to_string_pretty(value).unwrap_or_default() + "\n"))
}

/// Writes to stdout; a reader that has gone away (`asperity check ... | head`) is not an error.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(source) if source.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::Stdout { source }),
        _ => Ok(()),
    }
}

/// Says on stderr what of a case lies outside of a law's range.
pub fn warn_out_of_range(case: &Path, out_of_range: &[OutOfRange]) {
    if !out_of_range.is_empty() {
        let list: Vec<String> = out_of_range.iter().map(ToString::to_string).collect();
        // A closed stderr does not change the prediction.
        let _ = writeln!(
            std::io::stderr(),
            "warning: {} lies outside of what the law was fitted to: {}. Compare with `asperity run`",
            case.display(),
            list.join(", ")
        );
    }
}
