//! What a study varies: a grid of keys, whose combinations are the cases; keys that are gone
//! through together, as a zip; and lists of cases that say their keys themselves. Where several of
//! them are there, all of their combinations are cases.
//!
//! ```toml
//! [grid]                                        # every combination
//! "contact.friction" = [0.1, 0.3]
//! [zip]                                         # the first of each, the second of each, ...
//! "material.youngs_modulus" = [200e3, 70e3]
//! "material.hardening.yield_stress" = [400.0, 100.0]
//! [[list]]                                      # one after the other
//! "path.0.indentation" = 0.005
//! [[list]]
//! "path.0.indentation" = 0.02
//! "mesh.elements_per_contact_radius" = 8
//! ```

use std::collections::{BTreeMap, BTreeSet};

use crate::case::{CaseError, Document, Entry, Place, Reader, Value};

pub const GRID: &str = "dotted keys of the case with lists of values, as in \"contact.friction\" = [0.1, 0.3]";
const ZIP: &str = "dotted keys of the case with lists of one length, whose first values make the first case, and so on";
const LISTED: &str =
    "tables of dotted keys of the case with a value each, as in [[list]] and \"contact.friction\" = 0.1 below it";
const LIST: &str = "a list of values, as in [0.1, 0.3]";

/// One key that a study varies.
#[derive(Clone, Debug)]
pub struct SweepKey {
    /// Of the case, dotted.
    pub name: String,
    /// As messages call it: with its table.
    pub told: String,
}

/// What goes through its values together: one key of the grid, a zip, or the list.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Where it stands in the file.
    pub place: Place,
    /// Its name: that of its key, those of a zip, or `list`.
    pub label: String,
    /// What it sets, each time: keys by their numbers, with values.
    pub rows: Vec<Vec<(usize, Entry)>>,
}

/// All that a study varies.
#[derive(Clone, Debug, Default)]
pub struct Sweep {
    /// The keys, in the order of their lines.
    pub keys: Vec<SweepKey>,
    /// What varies them, in the order of their first lines; the last one fastest.
    pub axes: Vec<Axis>,
}

/// A key as it was found, before all of them are in order.
struct FoundKey {
    name: String,
    told: String,
    line: usize,
}

/// An axis as it was found: its rows by the names of keys.
struct FoundAxis {
    place: Place,
    label: String,
    rows: Vec<Vec<(String, Entry)>>,
}

impl Sweep {
    /// Reads the tables `grid`, `zip` and `list` of a study file. `contact.friction = [..]` without
    /// quotes is the same key as `"contact.friction" = [..]`.
    ///
    /// # Errors
    /// What is not allowed, with its place.
    pub fn read(document: &Document) -> Result<Self, CaseError> {
        let Value::Table(root) = &document.root.value else { return Ok(Self::default()) };
        let (mut found, mut axes) = (Vec::new(), Vec::new());
        if let Some(entry) = root.get("grid") {
            read_grid(entry, &mut found, &mut axes)?;
        }
        if let Some(entry) = root.get("zip") {
            for group in groups(entry, "zip", ZIP)? {
                read_zip(group, &mut found, &mut axes)?;
            }
        }
        if let Some(entry) = root.get("list") {
            read_list(entry, &mut found, &mut axes)?;
        }
        // Those of one line in alphabetical order.
        found.sort_by(|a, b| a.line.cmp(&b.line).then_with(|| a.name.cmp(&b.name)));
        let number = |name: &str| found.iter().position(|key| key.name == name).unwrap_or_default();
        axes.sort_by(|a, b| a.place.line().cmp(&b.place.line()).then_with(|| a.label.cmp(&b.label)));
        let axes = axes
            .into_iter()
            .map(|FoundAxis { place, label, rows }| {
                let numbered = |row: Vec<(String, Entry)>| row.into_iter().map(|(name, entry)| (number(&name), entry)).collect();
                Axis { place, label, rows: rows.into_iter().map(numbered).collect() }
            })
            .collect();
        Ok(Self { keys: found.into_iter().map(|FoundKey { name, told, .. }| SweepKey { name, told }).collect(), axes })
    }

    /// How many cases there are; `None` beyond `most`.
    pub fn count(&self, most: usize) -> Option<usize> {
        self.axes.iter().try_fold(1usize, |count, axis| count.checked_mul(axis.rows.len()).filter(|n| *n <= most))
    }

    /// What a case sets: for each key its value, where it has one. The last axis is the fastest.
    pub fn choice(&self, mut number: usize) -> Vec<Option<&Entry>> {
        let mut chosen = vec![None; self.keys.len()];
        for axis in self.axes.iter().rev() {
            for (key, entry) in &axis.rows[number % axis.rows.len()] {
                chosen[*key] = Some(entry);
            }
            number /= axis.rows.len();
        }
        chosen
    }
}

fn read_grid(entry: &Entry, found: &mut Vec<FoundKey>, axes: &mut Vec<FoundAxis>) -> Result<(), CaseError> {
    let mut keys = Vec::new();
    lists(entry, "grid", &mut keys)?;
    if keys.is_empty() {
        return Err(not_allowed(&entry.place, "grid", "is empty", GRID));
    }
    for (name, place, values) in keys {
        let told = format!("grid.{name}");
        let mut seen = BTreeSet::new();
        for value in &values {
            let text = plain(&value.value);
            let what = format!("has the value {text} twice");
            if !seen.insert(text) {
                return Err(not_allowed(&value.place, &told, &what, "each value once"));
            }
        }
        let label = name.clone();
        let rows = values.into_iter().map(|value| vec![(name.clone(), value)]).collect();
        add(found, name, told, &place)?;
        axes.push(FoundAxis { place, label, rows });
    }
    Ok(())
}

fn read_zip(entry: &Entry, found: &mut Vec<FoundKey>, axes: &mut Vec<FoundAxis>) -> Result<(), CaseError> {
    let mut keys = Vec::new();
    lists(entry, "zip", &mut keys)?;
    keys.sort_by_key(|(_, place, _)| place.line());
    let Some((first, place, values)) = keys.first().cloned() else {
        return Err(not_allowed(&entry.place, "zip", "is empty", ZIP));
    };
    let length = values.len();
    if let Some((name, place, values)) = keys.iter().find(|(_, _, values)| values.len() != length) {
        let what = format!("has {} values, and zip.{first} has {length}", values.len());
        return Err(not_allowed(place, &format!("zip.{name}"), &what, ZIP));
    }
    let names: Vec<&str> = keys.iter().map(|(name, ..)| name.as_str()).collect();
    let label = names.join(" with ");
    let rows: Vec<Vec<(String, Entry)>> =
        (0..length).map(|i| keys.iter().map(|(name, _, values)| (name.clone(), values[i].clone())).collect()).collect();
    refuse_twice(&rows, "zip")?;
    for (name, place, _) in &keys {
        add(found, name.clone(), format!("zip.{name}"), place)?;
    }
    axes.push(FoundAxis { place, label, rows });
    Ok(())
}

fn read_list(entry: &Entry, found: &mut Vec<FoundKey>, axes: &mut Vec<FoundAxis>) -> Result<(), CaseError> {
    let mut rows = Vec::new();
    let mut keys: BTreeMap<String, Place> = BTreeMap::new();
    for (i, case) in groups(entry, "list", LISTED)?.into_iter().enumerate() {
        let mut row = Vec::new();
        values(case, "", &mut row);
        if row.is_empty() {
            return Err(not_allowed(&case.place, &format!("list.{i}"), "is empty", LISTED));
        }
        for (name, value) in &row {
            keys.entry(name.clone()).or_insert_with(|| value.place.clone());
        }
        rows.push(row);
    }
    let Some(first) = rows.first().and_then(|row| row.iter().map(|(_, value)| &value.place).min_by_key(|place| place.line()))
    else {
        return Err(not_allowed(&entry.place, "list", "is empty", LISTED));
    };
    let (place, label) = (first.clone(), "list".to_owned());
    refuse_twice(&rows, "list")?;
    for (name, place) in &keys {
        add(found, name.clone(), format!("list.{name}"), place)?;
    }
    axes.push(FoundAxis { place, label, rows });
    Ok(())
}

/// One table, or several of an array of tables.
fn groups<'e>(entry: &'e Entry, name: &str, allowed: &str) -> Result<Vec<&'e Entry>, CaseError> {
    let wrong = |entry: &Entry| CaseError::WrongType {
        place: entry.place.clone(),
        key: name.to_owned(),
        found: entry.value.describe(),
        allowed: allowed.to_owned(),
    };
    match &entry.value {
        Value::Table(_) if name == "zip" => Ok(vec![entry]),
        Value::Array(items) => match items.iter().find(|item| !matches!(item.value, Value::Table(_))) {
            Some(other) => Err(wrong(other)),
            None => Ok(items.iter().collect()),
        },
        _ => Err(wrong(entry)),
    }
}

/// Keys with their lists of values, of tables within the table too.
fn lists(entry: &Entry, table: &str, keys: &mut Vec<(String, Place, Vec<Entry>)>) -> Result<(), CaseError> {
    fn collect(
        inner: &BTreeMap<String, Entry>,
        above: &str,
        table: &str,
        keys: &mut Vec<(String, Place, Vec<Entry>)>,
    ) -> Result<(), CaseError> {
        for (part, entry) in inner {
            let name = if above.is_empty() { part.clone() } else { format!("{above}.{part}") };
            match &entry.value {
                Value::Table(inner) if !inner.is_empty() => collect(inner, &name, table, keys)?,
                Value::Array(values) if values.is_empty() => {
                    return Err(not_allowed(&entry.place, &format!("{table}.{name}"), "is an empty list", LIST));
                }
                Value::Array(values) => keys.push((name, entry.place.clone(), values.clone())),
                other => {
                    return Err(CaseError::WrongType {
                        place: entry.place.clone(),
                        key: format!("{table}.{name}"),
                        found: other.describe(),
                        allowed: LIST.to_owned(),
                    });
                }
            }
        }
        Ok(())
    }
    match &entry.value {
        Value::Table(inner) => {
            collect(inner, "", table, keys)?;
            // In the order of the file, so that of a key said twice the second is refused.
            keys.sort_by_key(|(_, place, _)| place.line());
            Ok(())
        }
        other => Err(CaseError::WrongType {
            place: entry.place.clone(),
            key: table.to_owned(),
            found: other.describe(),
            allowed: GRID.to_owned(),
        }),
    }
}

/// The values of one case of the list. A table in braces is a value; `contact.friction` without
/// quotes, which TOML reads as tables, is a key.
fn values(entry: &Entry, above: &str, row: &mut Vec<(String, Entry)>) {
    let Value::Table(table) = &entry.value else { return };
    for (part, entry) in table {
        let name = if above.is_empty() { part.clone() } else { format!("{above}.{part}") };
        match &entry.value {
            // Within quotes a key has its dots already, and what it is set to is meant as it
            // stands.
            Value::Table(inner) if !inner.is_empty() && !part.contains('.') => values(entry, &name, row),
            _ => row.push((name, entry.clone())),
        }
    }
}

fn refuse_twice(rows: &[Vec<(String, Entry)>], table: &str) -> Result<(), CaseError> {
    let mut seen = BTreeSet::new();
    for row in rows {
        let text: Vec<String> = row.iter().map(|(name, value)| format!("{name} = {}", plain(&value.value))).collect();
        let what = format!("has {} twice", text.join(", "));
        if let Some((_, value)) = row.first()
            && !seen.insert(text)
        {
            return Err(not_allowed(&value.place, table, &what, "each case once"));
        }
    }
    Ok(())
}

/// Takes a key, unless it is varied already.
fn add(found: &mut Vec<FoundKey>, name: String, told: String, place: &Place) -> Result<(), CaseError> {
    if found.iter().any(|key| key.name == name) {
        return Err(not_allowed(place, &told, "is there twice", "each key once, in one of grid, zip and list"));
    }
    found.push(FoundKey { name, told, line: place.line() });
    Ok(())
}

/// A refusal.
pub fn not_allowed(place: &Place, key: &str, what: &str, allowed: &str) -> CaseError {
    CaseError::NotAllowed { place: place.clone(), key: key.to_owned(), what: what.to_owned(), allowed: allowed.to_owned() }
}

/// Refuses a file that varies nothing.
///
/// # Errors
/// [`CaseError::Missing`].
pub fn require(root: &Reader<'_>) -> Result<(), CaseError> {
    if ["grid", "zip", "list"].iter().any(|table| root.get(table).is_some()) {
        return Ok(());
    }
    Err(root.missing("grid", GRID))
}

/// A value as text: a string bare, everything else as TOML on one line.
pub(super) fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        other => inline(other),
    }
}

fn inline(value: &Value) -> String {
    match value {
        Value::String(text) => format!("{text:?}"),
        Value::Integer(number) => number.to_string(),
        Value::Float(number) => format!("{number:?}"),
        Value::Boolean(truth) => truth.to_string(),
        Value::Datetime(date) => date.clone(),
        Value::Array(items) => format!("[{}]", items.iter().map(|item| inline(&item.value)).collect::<Vec<_>>().join(", ")),
        Value::Table(table) => {
            let pairs: Vec<String> = table.iter().map(|(key, entry)| format!("{key} = {}", inline(&entry.value))).collect();
            format!("{{ {} }}", pairs.join(", "))
        }
    }
}
