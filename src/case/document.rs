//! A TOML document in which every value remembers where it was written, so that `--set` can replace
//! values and an error can still name the line.
//!
//! `serde` loses the places of values behind tagged enums and merged documents; so the schema is
//! read from this tree by hand (`read.rs`).

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{CaseError, Place, Spans};
use super::hints::line_meant;

/// A value and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Where it was written: the line of its key, of its table's header, or the `--set` argument.
    pub place: Place,
    /// The value.
    pub value: Value,
}

/// A TOML value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A string.
    String(String),
    /// An integer.
    Integer(i64),
    /// A float.
    Float(f64),
    /// A boolean.
    Boolean(bool),
    /// A date or time: no key takes one, it is kept for the message.
    Datetime(String),
    /// An array.
    Array(Vec<Entry>),
    /// A table, its keys in alphabetical order.
    Table(BTreeMap<String, Entry>),
}

impl Value {
    /// The value as a message names it: `the string "stick"`, `the number 0.3`, `a table`.
    pub fn describe(&self) -> String {
        match self {
            Value::String(text) => format!("the string {text:?}"),
            Value::Integer(number) => format!("the number {number}"),
            Value::Float(number) => format!("the number {number:?}"),
            Value::Boolean(truth) => format!("the boolean {truth}"),
            Value::Datetime(date) => format!("the date {date}"),
            Value::Array(_) => "an array".to_owned(),
            Value::Table(_) => "a table".to_owned(),
        }
    }
}

/// A parsed file, before its keys are given a meaning.
#[derive(Clone, Debug, PartialEq)]
pub struct Document {
    /// The top-level table; its place is the file's first line.
    pub root: Entry,
}

impl Document {
    /// Parses TOML; `file` is the name that errors give.
    pub fn parse(text: &str, file: &str) -> Result<Self, CaseError> {
        // A mark of the byte order, which some editors put in front.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let lines = Lines::of(text, file);
        if let Some(offset) = too_deep(text) {
            let what = format!("tables within tables, more than {DEEPEST} deep");
            return Err(CaseError::Syntax { place: lines.place(offset..offset + 1, offset..offset + 1), what });
        }
        let table = DeTable::parse(text).map_err(|error| CaseError::Syntax {
            place: error.span().map_or_else(|| lines.place(0..0, 0..0), |span| lines.place(span.clone(), span)),
            what: told(&error, text),
        })?;
        Ok(Self {
            root: Entry {
                place: lines.place(0..0, 0..0),
                value: table_value(table.get_ref(), &|key, value| lines.place(key, value))?,
            },
        })
    }

    /// The document of a table that a program has made: a value has no line then, so that errors
    /// name the key alone.
    pub fn from_table(table: &toml::Table) -> Self {
        Self { root: given(&toml::Value::Table(table.clone())) }
    }

    /// Applies `--set` arguments, in order: see [`Document::set_argument`].
    pub fn set_arguments(&mut self, arguments: &[String]) -> Result<(), CaseError> {
        self.will_set(arguments.iter().map(|argument| argument.split('=').next().unwrap_or_default().trim()));
        arguments.iter().try_for_each(|argument| self.set_argument(argument))
    }

    /// What goes before setting several dotted keys: the elements of the mesh, set by themselves,
    /// are those at the surface too, whatever the file has there.
    pub fn will_set<'a>(&mut self, keys: impl Iterator<Item = &'a str> + Clone) {
        const INSIDE: &str = "mesh.elements_per_contact_radius";
        const SURFACE: &str = "mesh.surface_elements_per_contact_radius";
        if keys.clone().any(|key| key == INSIDE) && !keys.clone().any(|key| key == SURFACE) {
            self.remove(SURFACE);
        }
    }

    /// Applies one `--set` argument, `key=value`: see [`Document::set`]. The value is TOML; what is
    /// not valid TOML is a string.
    pub fn set_argument(&mut self, argument: &str) -> Result<(), CaseError> {
        let refuse = |what: String| CaseError::Set { argument: argument.to_owned(), what };
        let (key, text) = argument.split_once('=').ok_or_else(|| refuse("has no `=`".to_owned()))?;
        let (key, text) = (key.trim(), text.trim());
        let place = Place::Set(key.into());
        let value = match DeValue::parse(text) {
            Ok(parsed) => value(parsed.get_ref(), &|_, _| place.clone())?,
            Err(_) if text.is_empty() => return Err(refuse("has no value".to_owned())),
            Err(error) if text.starts_with(['[', '{', '"', '\'']) => {
                return Err(refuse(format!("the value is not valid TOML: {}", told(&error, text))));
            }
            Err(_) => Value::String(text.to_owned()),
        };
        self.set(key, Entry { place, value }).map_err(refuse)
    }

    /// Puts `entry` at a dotted key; digits index an array, and the index after the last appends.
    /// Tables on the way are made if they are not there. The error says what stands in the way.
    pub fn set(&mut self, key: &str, entry: Entry) -> Result<(), String> {
        if key.split('.').count() > DEEPEST {
            return Err(format!("the key has more than {DEEPEST} parts"));
        }
        let mut at = &mut self.root;
        let mut walked = String::new();
        for part in key.split('.') {
            if part.is_empty() {
                return Err("the key has an empty part".to_owned());
            }
            let made = || Entry { place: entry.place.clone(), value: Value::Table(BTreeMap::new()) };
            // A path without segments yet is an array all the same.
            if matches!(&at.value, Value::Table(table) if table.is_empty()) && part == "0" && !walked.is_empty() {
                at.value = Value::Array(Vec::new());
            }
            at = match &mut at.value {
                Value::Table(table) => table.entry(part.to_owned()).or_insert_with(made),
                Value::Array(items) => {
                    let count = items.len();
                    let index = part.parse::<usize>().ok().filter(|index| *index <= count);
                    let index = index.ok_or_else(|| {
                        format!("`{walked}` has {count} items, so `{part}` is not one of them (0 to {count}, {count} appends)")
                    })?;
                    if index == count {
                        items.push(made());
                    }
                    &mut items[index]
                }
                other => return Err(format!("`{walked}` is {}, it has no key `{part}`", other.describe())),
            };
            if !walked.is_empty() {
                walked.push('.');
            }
            walked.push_str(part);
        }
        *at = entry;
        Ok(())
    }

    /// What stands at a dotted key.
    pub fn at(&self, key: &str) -> Option<&Entry> {
        key.split('.').try_fold(&self.root, |at, part| match &at.value {
            Value::Table(table) => table.get(part),
            Value::Array(items) => items.get(part.parse::<usize>().ok()?),
            _ => None,
        })
    }

    /// Takes away what stands at a dotted key of tables; whether there was anything.
    pub fn remove(&mut self, key: &str) -> bool {
        let (above, name) = key.rsplit_once('.').unwrap_or(("", key));
        let above = above.split('.').filter(|part| !part.is_empty()).try_fold(&mut self.root, |at, part| match &mut at.value {
            Value::Table(table) => table.get_mut(part),
            Value::Array(items) => items.get_mut(part.parse::<usize>().ok()?),
            _ => None,
        });
        match above.map(|entry| &mut entry.value) {
            Some(Value::Table(table)) => table.remove(name).is_some(),
            _ => false,
        }
    }

    /// The table under a top-level key as a document of its own, such as the `base` case of a
    /// study.
    pub fn table(&self, key: &str) -> Option<Document> {
        match &self.root.value {
            Value::Table(table) => table
                .get(key)
                .filter(|entry| matches!(entry.value, Value::Table(_)))
                .map(|entry| Document { root: entry.clone() }),
            _ => None,
        }
    }
}

/// Most parts of a dotted key. A case has four; thousands would overflow the stack, here and in the
/// TOML parser, which bounds brackets alone.
const DEEPEST: usize = 64;

/// Where something stands that has more parts between single dots than a key may have. Seen without
/// parsing, as it is the parser that has to be spared; so a string like that counts too.
fn too_deep(text: &str) -> Option<usize> {
    let (mut parts, mut after_dot) = (0, false);
    for (offset, byte) in text.bytes().enumerate() {
        match byte {
            b'.' if after_dot => parts = 0,
            b'.' => (parts, after_dot) = (parts + 1, true),
            b' ' | b'\t' => {}
            b',' | b'=' | b'[' | b']' | b'{' | b'}' | b'#' | b'\n' => (parts, after_dot) = (0, false),
            _ => after_dot = false,
        }
        if parts >= DEEPEST {
            return Some(offset);
        }
    }
    None
}

/// Turns byte offsets into line numbers.
struct Lines {
    file: Arc<str>,
    /// Offsets of the line ends, increasing: looked up by halving, as every value has a place.
    ends: Vec<usize>,
}

impl Lines {
    fn of(text: &str, file: &str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n').map(|(offset, _)| offset).collect();
        Self { file: file.into(), ends }
    }

    /// The place of a key and its value, on the line of the key.
    fn place(&self, key: Range<usize>, value: Range<usize>) -> Place {
        let line = 1 + self.ends.partition_point(|end| *end < key.start);
        Place::Line { file: self.file.clone(), spans: Box::new(Spans { line, key, value }) }
    }
}

/// Makes a place of where a key and its value stand.
type Places<'p> = &'p dyn Fn(Range<usize>, Range<usize>) -> Place;

fn table_value(table: &DeTable<'_>, place: Places<'_>) -> Result<Value, CaseError> {
    let entry = |(key, item): (&Spanned<std::borrow::Cow<'_, str>>, &Spanned<DeValue<'_>>)| {
        let value = value(item.get_ref(), place)?;
        Ok((key.get_ref().to_string(), Entry { place: place(key.span(), item.span()), value }))
    };
    table.iter().map(entry).collect::<Result<_, _>>().map(Value::Table)
}

fn value(parsed: &DeValue<'_>, place: Places<'_>) -> Result<Value, CaseError> {
    Ok(match parsed {
        DeValue::String(text) => Value::String(text.to_string()),
        // An integer beyond 64 bits is still a number.
        DeValue::Integer(number) => match i64::from_str_radix(number.as_str(), number.radix()) {
            Ok(integer) => Value::Integer(integer),
            Err(_) => Value::Float(number.as_str().parse().unwrap_or(f64::INFINITY)),
        },
        DeValue::Float(number) => Value::Float(number.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(truth) => Value::Boolean(*truth),
        DeValue::Datetime(date) => Value::Datetime(date.to_string()),
        DeValue::Array(items) => Value::Array(
            items
                .iter()
                .map(|item| Ok(Entry { place: place(item.span(), item.span()), value: value(item.get_ref(), place)? }))
                .collect::<Result<_, CaseError>>()?,
        ),
        DeValue::Table(table) => table_value(table, place)?,
    })
}

fn given(value: &toml::Value) -> Entry {
    let value = match value {
        toml::Value::String(text) => Value::String(text.clone()),
        toml::Value::Integer(number) => Value::Integer(*number),
        toml::Value::Float(number) => Value::Float(*number),
        toml::Value::Boolean(truth) => Value::Boolean(*truth),
        toml::Value::Datetime(date) => Value::Datetime(date.to_string()),
        toml::Value::Array(items) => Value::Array(items.iter().map(given).collect()),
        toml::Value::Table(table) => Value::Table(table.iter().map(|(key, item)| (key.clone(), given(item))).collect()),
    };
    Entry { place: Place::Given, value }
}

/// What the parser says, and what was probably meant.
fn told(error: &toml::de::Error, text: &str) -> String {
    let message = one_line(error.message());
    match error.span().and_then(|span| line_meant(text, span.start)) {
        Some(meant) => format!("{message}; {meant}"),
        None => message,
    }
}

fn one_line(message: &str) -> String {
    message.split_whitespace().collect::<Vec<_>>().join(" ")
}
