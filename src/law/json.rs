//! How laws of any kind are kept in a file: as JSON that begins with its format and version, and
//! that is checked as it is read. What has been read has no number that the code after it would
//! have to doubt.

use std::io;
use std::path::Path;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::LawError;
use super::bounds::Checked;
use crate::bounded;
use crate::case::{nearest, short};
use crate::output::{plain_json, write_own};

/// The name under which a law comes with the program.
pub const BUILT_IN: &str = "built-in";

/// A kind of law file.
pub(super) trait LawKind: DeserializeOwned {
    /// What it is called in messages.
    const NAME: &'static str;
    /// Its first key, by which it is recognised.
    const FORMAT: &'static str;
    /// Version of its layout.
    const VERSION: u32;

    /// Refuses whatever the code that uses it takes for granted and is not so; the error begins
    /// with the key.
    fn check(&self) -> Checked;
}

/// Read first, so that a file of another kind or version is called that.
#[derive(Deserialize)]
pub(super) struct Head {
    pub format: String,
    #[serde(default)]
    pub version: u32,
}

/// The format and version of a text.
pub(super) fn head(text: &str) -> Result<Head, String> {
    plain_json::from_str(text).map_err(|flaw| format!("line {}: is not a law file: {flaw}", flaw.line))
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
    refuse_misspelt(path, &[BUILT_IN])?;
    let bad = |problem: String| LawError::BadLaw { path: path.to_owned(), problem };
    let text = bounded::read_to_string(path, bounded::RESULT).map_err(|error| bad(format!("cannot be read: {error}")))?;
    parse(&text).map_err(bad)
}

/// Refuses the name of a file that is not there and resembles one of these words, which stand for
/// something else than a file.
pub(super) fn refuse_misspelt(path: &Path, words: &[&str]) -> Result<(), LawError> {
    let name = path.to_str().filter(|name| !name.contains(['/', '.']) && !path.exists());
    match name.and_then(|name| nearest(name, words)) {
        Some(meant) => Err(LawError::Misspelt { path: path.to_owned(), meant }),
        None => Ok(()),
    }
}

/// The law of this kind in a text, checked.
pub(super) fn parse<T: LawKind>(text: &str) -> Result<T, String> {
    let (head, name) = (head(text)?, T::NAME);
    if head.format != T::FORMAT {
        return Err(format!("is not a {name}: its format is {:?}", short(&head.format)));
    }
    if head.version != T::VERSION {
        return Err(format!("is a {name} of version {}, and this program reads version {}", head.version, T::VERSION));
    }
    let law: T = plain_json::from_str(text).map_err(|flaw| format!("line {}: is not a {name}: {flaw}", flaw.line))?;
    law.check()?;
    Ok(law)
}
