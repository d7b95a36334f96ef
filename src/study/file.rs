//! The study file: a base case and a grid; every combination of the grid's values is a case.
//!
//! ```toml
//! [base.sphere]                        # the case's own tables, under base
//! radius = 1.0
//! # ... [base.material], [base.material.hardening], [base.contact], [base.mesh], [[base.path]]
//! [grid]                               # a dotted key of the case, a list of its values
//! "material.hardening.yield_stress" = [100.0, 400.0, 1600.0]
//! "contact.friction" = [0.1, 0.3, "stick"]
//! "path.0.indentation" = [0.005, 0.02]
//! ```
//! A value may be a whole table, such as one hardening law for each kind of material. The last key
//! of the file runs fastest.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::StudyError;
use crate::bounded;
use crate::case::{Case, CaseError, Document, Entry, Place, Reader, Value, short};

/// Most combinations that a grid may have.
const MOST_CASES: usize = 100_000;
/// Most values of all cases together, those of the base counted once for each: every case is a copy
/// of it.
const MOST_VALUES: usize = 20_000_000;

const BASE: &str = "the case's own tables under base, as in [base.sphere]";
const GRID: &str = "dotted keys of the case with lists of values, as in \"contact.friction\" = [0.1, 0.3]";
const LIST: &str = "a list of values, as in [0.1, 0.3]";

/// One case of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyCase {
    /// Number of the combination in grid order, from 1, with leading zeros: the name of its
    /// directory.
    pub id: String,
    /// Its values of the grid's keys, in the order of the keys, as text: numbers in digits, strings
    /// bare, tables as inline TOML.
    pub values: Vec<String>,
    /// The case, in the user's units.
    pub case: Case,
}

/// A study: a base case and a grid over it, every combination checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The file as it was read.
    pub text: String,
    /// The grid's keys in the order of their lines.
    pub keys: Vec<String>,
    /// How many values each key has.
    pub counts: Vec<usize>,
    /// Every combination, the last key fastest. Where the base says nothing about it, a case of a
    /// study writes no fields and no plots.
    pub cases: Vec<StudyCase>,
}

impl Study {
    /// Whether a document is meant as a study, not as a case.
    pub fn is_study(document: &Document) -> bool {
        matches!(&document.root.value, Value::Table(table) if table.contains_key("base") || table.contains_key("grid"))
    }

    /// Reads a study file and checks every combination of its grid.
    ///
    /// # Errors
    /// [`StudyError::File`] and [`StudyError::Combination`] with file, line, key and what is
    /// allowed; [`StudyError::Hardening`].
    pub fn load(file: &Path) -> Result<Self, StudyError> {
        let name = file.display().to_string();
        let text = bounded::read_to_string(file, bounded::CASE)
            .map_err(|source| CaseError::Unreadable { file: name.clone(), source })?;
        Self::parse(&text, &name)
    }

    /// [`Study::load`] for a text in memory; `file` is the name that errors give.
    ///
    /// # Errors
    /// As [`Study::load`].
    pub fn parse(text: &str, file: &str) -> Result<Self, StudyError> {
        let document = Document::parse(text, file)?;
        let root = Reader::new(&document)?;
        root.only(&["base", "grid"])?;
        root.require_table("base", BASE)?;
        root.require_table("grid", GRID)?;
        let grid = read_grid(&document)?;
        let base = document.table("base").ok_or_else(|| root.missing("base", BASE))?;
        let base = with_study_defaults(base)?;
        let count = grid.iter().try_fold(1usize, |count, key| count.checked_mul(key.values.len()).filter(|n| *n <= MOST_CASES));
        let Some(count) = count else {
            let refused =
                not_allowed(&grid[0].place, "grid", &format!("has more than {MOST_CASES} combinations"), "fewer values");
            return Err(refused.into());
        };
        let values = values_of(&base.root.value)
            + grid.iter().map(|key| key.values.iter().map(|v| values_of(&v.value)).max().unwrap_or(0)).sum::<usize>();
        if values.saturating_mul(count) > MOST_VALUES {
            let what = format!("has {count} combinations of about {values} values each, more than {MOST_VALUES} together");
            return Err(not_allowed(&grid[0].place, "grid", &what, "fewer combinations, or a shorter path or table").into());
        }
        let cases = check_all(&base, &grid, count, file)?;
        Ok(Self {
            text: text.to_owned(),
            keys: grid.iter().map(|key| key.name.clone()).collect(),
            counts: grid.iter().map(|key| key.values.len()).collect(),
            cases,
        })
    }

    /// Whether another study has the same cases under the same values, in the same order.
    pub fn cases_are(&self, other: &Self) -> bool {
        let same = |(ours, theirs): (&StudyCase, &StudyCase)| ours.values == theirs.values && ours.case == theirs.case;
        self.keys == other.keys && self.cases.len() == other.cases.len() && self.cases.iter().zip(&other.cases).all(same)
    }

    /// The values of a case as `key = value, ...`.
    pub fn combination(&self, case: &StudyCase) -> String {
        describe(self.keys.iter().map(String::as_str).zip(case.values.iter().map(String::as_str)))
    }

    /// The size of the grid in words: `12 cases: contact.friction (3) x path.0.indentation (4)`.
    pub fn size(&self) -> String {
        let keys: Vec<String> = self.keys.iter().zip(&self.counts).map(|(key, count)| format!("{key} ({count})")).collect();
        format!("{} case{}: {}", self.cases.len(), if self.cases.len() == 1 { "" } else { "s" }, keys.join(" x "))
    }
}

/// One key of the grid.
struct GridKey {
    name: String,
    place: Place,
    values: Vec<Entry>,
}

/// The grid's keys in the order of their lines, those of one line in alphabetical order.
/// `contact.friction = [..]` without quotes is the same key as `"contact.friction" = [..]`.
fn read_grid(document: &Document) -> Result<Vec<GridKey>, CaseError> {
    let mut keys = Vec::new();
    if let Value::Table(root) = &document.root.value
        && let Some(grid) = root.get("grid")
        && let Value::Table(table) = &grid.value
    {
        collect(table, "", &mut keys)?;
        if keys.is_empty() {
            return Err(not_allowed(&grid.place, "grid", "is empty", GRID));
        }
    }
    keys.sort_by(|a, b| a.place.line().cmp(&b.place.line()).then_with(|| a.name.cmp(&b.name)));
    let mut seen = BTreeSet::new();
    match keys.iter().find(|key| !seen.insert(&key.name)) {
        Some(twice) => Err(not_allowed(&twice.place, &grid_key(&twice.name), "is there twice", "each key once")),
        None => Ok(keys),
    }
}

fn collect(table: &BTreeMap<String, Entry>, above: &str, keys: &mut Vec<GridKey>) -> Result<(), CaseError> {
    for (part, entry) in table {
        let name = if above.is_empty() { part.clone() } else { format!("{above}.{part}") };
        match &entry.value {
            Value::Table(inner) if !inner.is_empty() => collect(inner, &name, keys)?,
            Value::Array(values) if values.is_empty() => {
                return Err(not_allowed(&entry.place, &grid_key(&name), "is an empty list", LIST));
            }
            Value::Array(values) => {
                let mut seen = BTreeSet::new();
                for value in values {
                    let text = plain(&value.value);
                    let what = format!("has the value {text} twice");
                    if !seen.insert(text) {
                        return Err(not_allowed(&value.place, &grid_key(&name), &what, "each value once"));
                    }
                }
                keys.push(GridKey { name, place: entry.place.clone(), values: values.clone() });
            }
            other => {
                return Err(CaseError::WrongType {
                    place: entry.place.clone(),
                    key: grid_key(&name),
                    found: other.describe(),
                    allowed: LIST.to_owned(),
                });
            }
        }
    }
    Ok(())
}

/// How many values there are, in tables and arrays too.
fn values_of(value: &Value) -> usize {
    match value {
        Value::Array(items) => 1 + items.iter().map(|item| values_of(&item.value)).sum::<usize>(),
        Value::Table(table) => 1 + table.values().map(|entry| values_of(&entry.value)).sum::<usize>(),
        _ => 1,
    }
}

fn grid_key(name: &str) -> String {
    format!("grid.{name}")
}

fn not_allowed(place: &Place, key: &str, what: &str, allowed: &str) -> CaseError {
    CaseError::NotAllowed { place: place.clone(), key: key.to_owned(), what: what.to_owned(), allowed: allowed.to_owned() }
}

/// No fields and no plots for each of hundreds of cases, unless the base asks for them.
fn with_study_defaults(mut base: Document) -> Result<Document, CaseError> {
    let place = base.root.place.clone();
    for (key, value) in [("fields", Value::String("none".to_owned())), ("plots", Value::Boolean(false))] {
        let given = Reader::new(&base)?.table("output")?.get(key).is_some();
        if !given {
            let entry = Entry { place: place.clone(), value };
            base.set(&format!("output.{key}"), entry).map_err(|what| not_allowed(&place, "output", &what, "a table"))?;
        }
    }
    Ok(base)
}

/// Every combination as a case. The first refusal is the one that is told; where all are refused
/// alike, it is the base or a key that is wrong and not the combination.
fn check_all(base: &Document, grid: &[GridKey], count: usize, file: &str) -> Result<Vec<StudyCase>, StudyError> {
    let width = count.to_string().len().max(4);
    // A table is set before a key within it, wherever they stand in the file.
    let mut order: Vec<usize> = (0..grid.len()).collect();
    order.sort_by_key(|&key| grid[key].name.split('.').count());
    let mut cases = Vec::with_capacity(count);
    let mut refused: Vec<(CaseError, String)> = Vec::new();
    for number in 0..count {
        let chosen = choice(grid, number);
        let values: Vec<String> = chosen.iter().map(|entry| plain(&entry.value)).collect();
        let combination = || describe(grid.iter().map(|key| key.name.as_str()).zip(values.iter().map(String::as_str)));
        let mut document = base.clone();
        let set = order.iter().try_for_each(|&key| {
            let (name, entry) = (&grid[key].name, chosen[key]);
            let refuse = |what: String| not_allowed(&entry.place, &grid_key(name), &what, "a dotted key of the case");
            document.set(name, entry.clone()).map_err(refuse)
        });
        match set.and_then(|()| Case::from_document(&document)) {
            Ok(case) => {
                case.material.constants::<f64>().map_err(|source| StudyError::Hardening {
                    file: file.to_owned(),
                    source,
                    combination: combination(),
                })?;
                cases.push(StudyCase { id: format!("{:0width$}", number + 1), values, case });
            }
            Err(error) => refused.push((error, combination())),
        }
    }
    let failing = refused.len();
    let alike = failing == count && refused.windows(2).all(|pair| pair[0].0.to_string() == pair[1].0.to_string());
    match refused.into_iter().next() {
        None => Ok(cases),
        Some((error, _)) if alike => Err(error.into()),
        Some((error, combination)) => Err(StudyError::Combination { source: Box::new(error), combination, failing, count }),
    }
}

/// The values of a combination, the last key fastest.
fn choice(grid: &[GridKey], mut number: usize) -> Vec<&Entry> {
    let mut chosen: Vec<&Entry> = grid
        .iter()
        .rev()
        .map(|key| {
            let entry = &key.values[number % key.values.len()];
            number /= key.values.len();
            entry
        })
        .collect();
    chosen.reverse();
    chosen
}

fn describe<'a>(pairs: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    let text = pairs.map(|(key, value)| format!("{key} = {value}")).collect::<Vec<_>>().join(", ");
    short(&text).into_owned()
}

/// A value as text: a string bare, everything else as TOML on one line.
fn plain(value: &Value) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Fields, Friction, Hardening};

    const BASE_CASE: &str = r#"
[base.sphere]
radius = 1.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 400.0
[base.contact]
friction = 0.3
[[base.path]]
indentation = 0.02
"#;

    fn study(grid: &str) -> Result<Study, StudyError> {
        Study::parse(&format!("{BASE_CASE}[grid]\n{grid}"), "study.toml")
    }

    fn refused(grid: &str) -> String {
        study(grid).expect_err("no study").to_string()
    }

    #[test]
    fn the_last_key_of_the_file_is_the_fastest() {
        let study = study("\"path.0.indentation\" = [0.005, 0.02]\n\"contact.friction\" = [0.1, \"stick\", 1]").unwrap();
        assert_eq!(study.keys, ["path.0.indentation", "contact.friction"]);
        assert_eq!(study.size(), "6 cases: path.0.indentation (2) x contact.friction (3)");
        let rows: Vec<_> = study.cases.iter().map(|case| (case.id.as_str(), case.values.join(" "))).collect();
        assert_eq!(rows[0], ("0001", "0.005 0.1".into()));
        assert_eq!(rows[1], ("0002", "0.005 stick".into()));
        assert_eq!(rows[5], ("0006", "0.02 1".into()));
        assert_eq!(study.cases[1].case.contact.friction, Friction::Stick);
        assert_eq!(study.combination(&study.cases[5]), "path.0.indentation = 0.02, contact.friction = 1");
        assert!(study.cases.iter().all(|case| case.case.output.fields == Fields::None && !case.case.output.plots));
    }

    #[test]
    fn a_value_may_be_a_table_and_a_key_within_it_varies_it() {
        let study = study(
            "material.hardening.yield_stress = [100.0, 200.0]\n\
             material.hardening_ = [1]\n",
        );
        assert!(study.unwrap_err().to_string().contains("did you mean `hardening`"));
        let study = self::study(
            "\"material.hardening.yield_stress\" = [100.0, 200.0]\n\
             \"material.hardening\" = [{ law = \"ideal\" }, { law = \"linear\", modulus = 50.0 }]",
        )
        .unwrap();
        assert_eq!(study.cases[3].values[1], "{ law = \"linear\", modulus = 50.0 }");
        assert_eq!(study.cases[1].case.material.hardening, Hardening::Linear { yield_stress: 100.0, modulus: 50.0 });
        assert_eq!(study.cases[2].case.material.hardening, Hardening::Ideal { yield_stress: 200.0 });
    }

    #[test]
    fn bare_and_quoted_keys_are_the_same() {
        let bare = study("contact.friction = [0.1, 0.2]").unwrap();
        let quoted = study("\"contact.friction\" = [0.1, 0.2]").unwrap();
        assert_eq!((&bare.keys, &bare.cases), (&quoted.keys, &quoted.cases));
        assert!(
            refused("\"contact.friction\" = [0.1]\ncontact.friction = [0.2]").contains("grid.contact.friction: is there twice")
        );
    }

    #[test]
    fn what_the_base_says_of_output_stays() {
        let text = format!("{BASE_CASE}[base.output]\nfields = \"segments\"\n[grid]\n\"contact.friction\" = [0.1]");
        let study = Study::parse(&text, "study.toml").unwrap();
        assert_eq!(study.cases[0].case.output.fields, Fields::Segments);
        assert!(!study.cases[0].case.output.plots);
        assert!(study.size().starts_with("1 case: "));
    }

    #[test]
    fn mistakes_name_line_key_and_what_is_allowed() {
        for (grid, parts) in [
            (
                "\"contact.frictoin\" = [0.1, 0.2]",
                &["study.toml:15: contact.frictoin: unknown key", "did you mean `friction`"][..],
            ),
            ("\"contact.friction\" = []", &["study.toml:15: grid.contact.friction: is an empty list", "a list of values"]),
            ("\"contact.friction\" = 0.1", &["study.toml:15: grid.contact.friction: is the number 0.1", "wrong type"]),
            ("\"contact.friction\" = [0.1, 0.1]", &["has the value 0.1 twice"]),
            ("\"contact.friction.x\" = [0.1]", &["study.toml:15: ", "is the number 0.3, it has no key `x`"]),
            ("\"path.3.indentation\" = [0.1]", &["study.toml:15: grid.path.3.indentation", "has 1 items"]),
            (
                "\"contact.friction\" = [\n0.1,\n-0.2]",
                &["study.toml:17: contact.friction: is -0.2", "contact.friction = -0.2; 1 of 2"],
            ),
            (
                "\"contact.friction\" = [0.1, \"stick\"]\n\"path.1.shear\" = [\"full-slip\", 0.001]",
                &[
                    "study.toml:16: path.1.shear",
                    "never reaches",
                    "combination contact.friction = stick, path.1.shear = full-slip; 1 of 4",
                ],
            ),
            ("", &["study.toml:14: grid: is empty"]),
            ("\"contact\" = [{}]", &["contact.friction: missing"]),
        ] {
            let message = refused(grid);
            assert!(parts.iter().all(|part| message.contains(part)), "{grid}\n{message}");
        }
        let alone = Study::parse(BASE_CASE, "study.toml").unwrap_err().to_string();
        assert!(alone.contains("grid: missing"), "{alone}");
        let other = Study::parse(&format!("{BASE_CASE}[grids]\n"), "study.toml").unwrap_err().to_string();
        assert!(other.contains("grids: unknown key, did you mean `grid`?"), "{other}");
        let lines: Vec<String> =
            (0..6).map(|i| format!("\"k{i}\" = [{}]", (0..10).map(|n| n.to_string()).collect::<Vec<_>>().join(", "))).collect();
        assert!(refused(&lines.join("\n")).contains("more than 100000 combinations"));
    }
}
