//! How laws of either kind are kept in a file: as JSON that begins with its format and version.

use std::io;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::LawError;
use crate::bounded;
use crate::output::write_own;

/// Read first, so that a file of another kind or version is called that.
#[derive(Deserialize)]
pub(super) struct Head {
    pub format: String,
    #[serde(default)]
    pub version: u32,
}

/// The format and version of a text.
pub(super) fn head(text: &str) -> Result<Head, String> {
    serde_json::from_str(text).map_err(|error| format!("is not a law: {error}"))
}

/// Writes a law, whole or not at all.
pub(super) fn write(path: &Path, law: &impl Serialize) -> Result<(), LawError> {
    Ok(write_own(path, |out| {
        serde_json::to_writer_pretty(&mut *out, law).map_err(io::Error::from)?;
        out.write_all(b"\n")
    })?)
}

/// As [`write`], a line in all: of what nobody reads number by number.
pub(super) fn write_compact(path: &Path, law: &impl Serialize) -> Result<(), LawError> {
    Ok(write_own(path, |out| {
        serde_json::to_writer(&mut *out, law).map_err(io::Error::from)?;
        out.write_all(b"\n")
    })?)
}

/// Reads a file and makes of its text what `parse` does, whose error is what is wrong, in words.
pub(super) fn read<T>(path: &Path, parse: impl FnOnce(&str) -> Result<T, String>) -> Result<T, LawError> {
    let bad = |problem: String| LawError::BadLaw { path: path.to_owned(), problem };
    let text = bounded::read_to_string(path, bounded::RESULT).map_err(|error| bad(format!("cannot be read: {error}")))?;
    parse(&text).map_err(bad)
}

/// The law in a text of this format and version; `kind` is its name in what is wrong.
pub(super) fn parse<T: DeserializeOwned>(text: &str, kind: &str, format: &str, version: u32) -> Result<T, String> {
    let head = head(text)?;
    if head.format != format {
        return Err(format!("is not a {kind}: its format is {:?}", head.format));
    }
    if head.version != version {
        return Err(format!("is a {kind} of version {}, and this program reads version {version}", head.version));
    }
    serde_json::from_str(text).map_err(|error| format!("is not a {kind}: {error}"))
}
