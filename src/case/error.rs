//! What can be wrong with a case file, and where.

use std::borrow::Cow;
use std::fmt;
use std::ops::Range;
use std::sync::Arc;

/// Where in a text a key and its value stand.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spans {
    /// Line number of the key, from 1.
    pub line: usize,
    /// The key, in bytes; of an item of an array, the item.
    pub key: Range<usize>,
    /// Its value, in bytes.
    pub value: Range<usize>,
}

/// Where a value was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// A line of a file.
    Line {
        /// The file as the user named it.
        file: Arc<str>,
        /// Where in the text the key and its value stand.
        spans: Box<Spans>,
    },
    /// A `--set key=value` argument; the key.
    Set(Arc<str>),
    /// No file: a value that a program has given.
    Given,
}

impl Place {
    /// The line, by which places of one file are ordered; what stands in no file comes last.
    pub fn line(&self) -> usize {
        match self {
            Place::Line { spans, .. } => spans.line,
            Place::Set(_) | Place::Given => usize::MAX,
        }
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Line { file, spans } => write!(f, "{}:{}", short(file), spans.line),
            Place::Set(key) => write!(f, "--set {}", short(key)),
            Place::Given => f.write_str("case"),
        }
    }
}

/// A case that cannot be run, with the place, the key and what would be allowed.
#[derive(Debug, thiserror::Error)]
pub enum CaseError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {source}{}", short(.file), reading_remedy(.source))]
    Unreadable {
        /// The file as the user named it.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The text is not TOML.
    #[error("{place}: not valid TOML: {}", short(.what))]
    Syntax {
        /// Where the parser stopped.
        place: Place,
        /// What it found.
        what: String,
    },
    /// A key that no case has.
    #[error("{}: unknown key{} Allowed: {allowed}", at(.place, .key), did_you_mean(.nearest))]
    UnknownKey {
        /// Where the key stands.
        place: Place,
        /// The dotted key.
        key: String,
        /// The known key that was probably meant: of its own table, or of another with all parts.
        nearest: Option<String>,
        /// The keys known here.
        allowed: String,
    },
    /// A key without which there is no case.
    #[error("{}: missing. Allowed: {allowed}", at(.place, .key))]
    Missing {
        /// The table that lacks the key.
        place: Place,
        /// The dotted key.
        key: String,
        /// What its value may be.
        allowed: String,
    },
    /// A value of another type than the key takes.
    #[error("{}: is {}, which is the wrong type. Allowed: {allowed}", at(.place, .key), short(.found))]
    WrongType {
        /// Where the value stands.
        place: Place,
        /// The dotted key.
        key: String,
        /// What was found there.
        found: String,
        /// What the value may be.
        allowed: String,
    },
    /// A value out of range, or one that does not go with the rest of the case.
    #[error("{}: {}. Allowed: {allowed}", at(.place, .key), short(.what))]
    NotAllowed {
        /// Where the value stands.
        place: Place,
        /// The dotted key.
        key: String,
        /// What is wrong with it.
        what: String,
        /// What the value may be.
        allowed: String,
    },
    /// A `--set` argument that cannot be applied.
    #[error(
        "--set {}: {}. Allowed: KEY=VALUE with a dotted key, as in contact.friction=0.1 or path.0.indentation=0.01",
        short(.argument),
        short(.what)
    )]
    Set {
        /// The argument.
        argument: String,
        /// What is wrong with it.
        what: String,
    },
}

impl CaseError {
    /// Where it is, if it is anywhere.
    pub fn place(&self) -> Option<&Place> {
        match self {
            CaseError::Syntax { place, .. }
            | CaseError::UnknownKey { place, .. }
            | CaseError::Missing { place, .. }
            | CaseError::WrongType { place, .. }
            | CaseError::NotAllowed { place, .. } => Some(place),
            CaseError::Unreadable { .. } | CaseError::Set { .. } => None,
        }
    }

    /// The dotted key that it is about, if there is one.
    pub fn key(&self) -> Option<&str> {
        match self {
            CaseError::UnknownKey { key, .. }
            | CaseError::Missing { key, .. }
            | CaseError::WrongType { key, .. }
            | CaseError::NotAllowed { key, .. } => Some(key),
            CaseError::Unreadable { .. } | CaseError::Syntax { .. } | CaseError::Set { .. } => None,
        }
    }

    /// The part of the file's text that is wrong, in bytes: a key that is unknown or lacks
    /// something, otherwise a value.
    pub fn span(&self) -> Option<Range<usize>> {
        let Some(Place::Line { spans, .. }) = self.place() else { return None };
        let wrong = match self {
            CaseError::UnknownKey { .. } | CaseError::Missing { .. } => &spans.key,
            _ => &spans.value,
        };
        Some(wrong.clone())
    }
}

/// Of what is no text in UTF-8 the source says what to do.
fn reading_remedy(source: &std::io::Error) -> &'static str {
    if source.kind() == std::io::ErrorKind::InvalidData { "" } else { ". Give the path of a readable case file" }
}

/// A text as a message gives it: whole, or if it is long its beginning, its end and how much is
/// left out.
pub fn short(text: &str) -> Cow<'_, str> {
    const MOST: usize = 240;
    let count = text.chars().count();
    if count <= MOST {
        return Cow::Borrowed(text);
    }
    let (head, tail): (String, String) = (text.chars().take(MOST / 2).collect(), text.chars().skip(count - MOST / 4).collect());
    Cow::Owned(format!("{head} [... {} characters ...] {tail}", count - MOST / 2 - MOST / 4))
}

/// Place and key; a `--set` argument that names the key is both.
fn at(place: &Place, key: &str) -> String {
    match place {
        Place::Set(set) if **set == *key => place.to_string(),
        _ => format!("{place}: {}", short(key)),
    }
}

fn did_you_mean(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or(".".to_owned(), |key| format!(", did you mean `{key}`?"))
}
