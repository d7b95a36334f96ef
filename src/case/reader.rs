//! Reads typed values out of a [`Document`](super::Document); every refusal names place, key and
//! what is allowed.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::document::{Document, Entry, Value};
use super::error::{CaseError, Place};
use super::hints::{key_meant, number_meant};
use super::likeness::nearest;

/// One table of the document.
pub struct Reader<'d> {
    place: &'d Place,
    key: String,
    table: Option<&'d BTreeMap<String, Entry>>,
}

impl<'d> Reader<'d> {
    /// The top-level table.
    pub fn new(document: &'d Document) -> Result<Self, CaseError> {
        Field { key: String::new(), entry: &document.root }.table()
    }

    /// Refuses the first key, in the order of lines, that is not one of `known`; call it before
    /// reading, so that a misspelt key is reported as such and not as a missing one.
    pub fn only(&self, known: &[&str]) -> Result<(), CaseError> {
        self.only_with(known, "")
    }

    /// [`only`](Self::only) in a file whose case stands below `root`, empty or `base.`: a key of
    /// the case that stands here is told with it.
    pub fn only_with(&self, known: &[&str], root: &str) -> Result<(), CaseError> {
        let unknown = self.table.into_iter().flatten().filter(|(name, _)| !known.contains(&name.as_str()));
        match unknown.min_by_key(|(_, entry)| entry.place.line()) {
            None => Ok(()),
            Some((name, entry)) => Err(CaseError::UnknownKey {
                place: entry.place.clone(),
                key: self.dotted(name),
                nearest: key_meant(name, &self.key, known, root),
                allowed: known.join(", "),
            }),
        }
    }

    /// The value of a key, if it is there.
    pub fn get(&self, name: &str) -> Option<Field<'d>> {
        self.table?.get(name).map(|entry| Field { key: self.dotted(name), entry })
    }

    /// The value of a key that must be there; `allowed` says what it may be.
    pub fn require(&self, name: &str, allowed: &str) -> Result<Field<'d>, CaseError> {
        self.get(name).ok_or_else(|| self.missing(name, allowed))
    }

    /// The error of a key that must be there and is not.
    pub fn missing(&self, name: &str, allowed: &str) -> CaseError {
        CaseError::Missing { place: self.place.clone(), key: self.dotted(name), allowed: allowed.to_owned() }
    }

    /// A sub-table; one that is not there reads as an empty one.
    pub fn table(&self, name: &str) -> Result<Reader<'d>, CaseError> {
        match self.get(name) {
            Some(field) => field.table(),
            None => Ok(Reader { place: self.place, key: self.dotted(name), table: None }),
        }
    }

    /// A sub-table that must be there.
    pub fn require_table(&self, name: &str, allowed: &str) -> Result<Reader<'d>, CaseError> {
        self.require(name, allowed)?.table()
    }

    /// A refusal of the table as a whole.
    pub fn refuse(&self, what: &str, allowed: &str) -> CaseError {
        CaseError::NotAllowed {
            place: self.place.clone(),
            key: self.key.clone(),
            what: what.to_owned(),
            allowed: allowed.to_owned(),
        }
    }

    fn dotted(&self, name: &str) -> String {
        if self.key.is_empty() { name.to_owned() } else { format!("{}.{name}", self.key) }
    }
}

/// One value of the document.
pub struct Field<'d> {
    key: String,
    entry: &'d Entry,
}

impl<'d> Field<'d> {
    /// A finite number for which `accept` holds.
    pub fn number(&self, allowed: &str, accept: impl Fn(f64) -> bool) -> Result<f64, CaseError> {
        let number = match self.entry.value {
            Value::Integer(number) => number as f64,
            Value::Float(number) => number,
            _ => return Err(self.wrong_type(allowed)),
        };
        if number.is_finite() && accept(number) { Ok(number) } else { Err(self.refuse(&format!("is {number:?}"), allowed)) }
    }

    /// A whole number within a range; `5.0` is one too.
    pub fn count(&self, range: RangeInclusive<usize>) -> Result<usize, CaseError> {
        let allowed = format!("a whole number from {} to {}", range.start(), range.end());
        let (count, told) = match self.entry.value {
            Value::Integer(number) => (usize::try_from(number).ok(), number.to_string()),
            // One that is too large for a count is so for the range; the conversion saturates.
            Value::Float(number) if number.fract() == 0.0 => ((number >= 0.0).then_some(number as usize), format!("{number:?}")),
            _ => return Err(self.wrong_type(&allowed)),
        };
        count.filter(|count| range.contains(count)).ok_or_else(|| self.refuse(&format!("is {told}"), &allowed))
    }

    /// The truth value, if it is one.
    pub fn truth(&self) -> Option<bool> {
        match self.entry.value {
            Value::Boolean(truth) => Some(truth),
            _ => None,
        }
    }

    /// `true` or `false`.
    pub fn boolean(&self) -> Result<bool, CaseError> {
        match self.entry.value {
            Value::Boolean(truth) => Ok(truth),
            _ => Err(self.wrong_type_of_words("true or false", &["true", "false"])),
        }
    }

    /// One of some words.
    pub fn choice<T: Copy>(&self, options: &[(&str, T)]) -> Result<T, CaseError> {
        let words = options.iter().map(|(word, _)| format!("{word:?}")).collect::<Vec<_>>().join(", ");
        let Value::String(text) = &self.entry.value else {
            return Err(self.wrong_type(&words));
        };
        let chosen = options.iter().find(|(word, _)| word == text);
        chosen.map(|(_, option)| *option).ok_or_else(|| {
            let known: Vec<&str> = options.iter().map(|(word, _)| *word).collect();
            self.unknown_word(text, &known, &words)
        })
    }

    /// The refusal of a text that is none of the `known` words, with the one that was meant.
    pub fn unknown_word(&self, text: &str, known: &[&str], allowed: &str) -> CaseError {
        let meant = nearest(text, known).map(|word| format!("did you mean {word:?}?"));
        let meant = meant.or_else(|| self.number_meant()).map_or(String::new(), |meant| format!(" ({meant})"));
        self.refuse(&format!("is {text:?}{meant}"), allowed)
    }

    /// The text, if the value is a string.
    pub fn text(&self) -> Option<&'d str> {
        match &self.entry.value {
            Value::String(text) => Some(text),
            _ => None,
        }
    }

    /// A text, `allowed` for other types.
    pub fn string(&self, allowed: &str) -> Result<&'d str, CaseError> {
        self.text().ok_or_else(|| self.wrong_type(allowed))
    }

    /// The items of an array, `allowed` for other types.
    pub fn array(&self, allowed: &str) -> Result<Vec<Field<'d>>, CaseError> {
        let Value::Array(items) = &self.entry.value else {
            return Err(self.wrong_type(allowed));
        };
        Ok(items.iter().enumerate().map(|(index, entry)| Field { key: format!("{}.{index}", self.key), entry }).collect())
    }

    /// Whether it is an array.
    pub fn is_array(&self) -> bool {
        matches!(self.entry.value, Value::Array(_))
    }

    /// The two items of an array, `allowed` for others.
    pub fn pair(&self, allowed: &str) -> Result<[Field<'d>; 2], CaseError> {
        let items = self.array(allowed)?;
        let count = items.len();
        items.try_into().map_err(|_| self.refuse(&format!("has {count} component{}", if count == 1 { "" } else { "s" }), allowed))
    }

    /// The value as a table.
    pub fn table(&self) -> Result<Reader<'d>, CaseError> {
        match &self.entry.value {
            Value::Table(table) => Ok(Reader { place: &self.entry.place, key: self.key.clone(), table: Some(table) }),
            _ => Err(self.wrong_type("a table")),
        }
    }

    /// A refusal of this value: `what` is wrong, and what is `allowed`.
    pub fn refuse(&self, what: &str, allowed: &str) -> CaseError {
        CaseError::NotAllowed {
            place: self.entry.place.clone(),
            key: self.key.clone(),
            what: what.to_owned(),
            allowed: allowed.to_owned(),
        }
    }

    fn wrong_type(&self, allowed: &str) -> CaseError {
        self.wrong_type_of_words(allowed, &[])
    }

    /// A refusal of a value that is none of these `words` either, which have no quotes.
    fn wrong_type_of_words(&self, allowed: &str, words: &[&str]) -> CaseError {
        let word = self.text().and_then(|text| nearest(text, words));
        let meant = match word {
            Some(word) => format!(". Did you mean {word}?"),
            None => self.number_meant().map_or(String::new(), |meant| format!(". {}", meant.replacen("did", "Did", 1))),
        };
        CaseError::WrongType {
            place: self.entry.place.clone(),
            key: self.key.clone(),
            found: self.entry.value.describe(),
            allowed: format!("{allowed}{meant}"),
        }
    }

    /// The number that a text was meant to be.
    fn number_meant(&self) -> Option<String> {
        number_meant(self.text()?, matches!(self.entry.place, Place::Line { .. }))
    }
}
