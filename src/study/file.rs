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
//! Beside the grid, or in its place, keys may be gone through together (`[zip]`) and cases listed
//! one by one (`[[list]]`), see [`super::sweep`]. A value may be a whole table, such as one
//! hardening law for each kind of material. The last key of the file runs fastest.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use super::StudyError;
use super::id::case_id;
use super::sweep::{Sweep, SweepKey, not_allowed, plain, require};
use crate::bounded;
use crate::case::{Case, CaseError, Document, Entry, Reader, Value, short};

/// Most combinations that a grid may have.
const MOST_CASES: usize = 100_000;
/// Most values of all cases together, those of the base counted once for each: every case is a copy
/// of it.
const MOST_VALUES: usize = 20_000_000;

const BASE: &str = "the case's own tables under base, as in [base.sphere]";
/// One case of a study.
#[derive(Clone, Debug, PartialEq)]
pub struct StudyCase {
    /// Number of the combination in grid order, from 1, as in `c0001`: the name of its directory.
    pub id: String,
    /// Its values of the study's keys, in the order of the keys, as text: numbers in digits,
    /// strings bare, tables as inline TOML; empty where a case of the list leaves a key to the
    /// base.
    pub values: Vec<String>,
    /// The case, in the user's units.
    pub case: Case,
}

/// A study: a base case and a grid over it, every combination checked.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// The file as it was read.
    pub text: String,
    /// The keys that are varied, in the order of their lines.
    pub keys: Vec<String>,
    /// What varies them, with the number of its values: a key of the grid, the keys of a zip, the
    /// list.
    pub axes: Vec<(String, usize)>,
    /// Every combination, the last of those fastest. Where the base says nothing about it, a case
    /// of a study writes contact tables, but no fields and no plots, and is computed without a
    /// companion.
    pub cases: Vec<StudyCase>,
}

impl Study {
    /// Whether a document is meant as a study, not as a case.
    pub fn is_study(document: &Document) -> bool {
        matches!(&document.root.value, Value::Table(table) if ["base", "grid", "zip"].iter().any(|name| table.contains_key(*name)))
    }

    /// What is odd about its cases (see [`Case::doubts`]), each key once, with the number of the
    /// first case that it is odd in.
    pub fn doubts(&self) -> Vec<(String, String)> {
        let mut found: Vec<(&str, crate::case::Doubt, usize)> = Vec::new();
        for case in &self.cases {
            for doubt in case.case.doubts() {
                match found.iter_mut().find(|(_, earlier, _)| earlier.key == doubt.key) {
                    Some((_, _, others)) => *others += 1,
                    None => found.push((&case.id, doubt, 0)),
                }
            }
        }
        let told = |(id, doubt, others): (&str, crate::case::Doubt, usize)| {
            let also = if others > 0 { format!(" (and {others} more cases)") } else { String::new() };
            (id.to_owned(), format!("{doubt}{also}"))
        };
        found.into_iter().map(told).collect()
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
        root.only_with(&["base", "grid", "zip", "list"], "base.")?;
        root.require_table("base", BASE)?;
        require(&root)?;
        let sweep = Sweep::read(&document)?;
        let base = document.table("base").ok_or_else(|| root.missing("base", BASE))?;
        let base = with_study_defaults(base)?;
        let place = sweep.axes.first().map_or(&document.root.place, |axis| &axis.place);
        let Some(count) = sweep.count(MOST_CASES) else {
            return Err(not_allowed(place, "grid", &format!("has more than {MOST_CASES} combinations"), "fewer values").into());
        };
        let row = |row: &Vec<(usize, Entry)>| row.iter().map(|(_, entry)| values_of(&entry.value)).sum::<usize>();
        let values = values_of(&base.root.value)
            + sweep.axes.iter().map(|axis| axis.rows.iter().map(row).max().unwrap_or(0)).sum::<usize>();
        if values.saturating_mul(count) > MOST_VALUES {
            let what = format!("has {count} combinations of about {values} values each, more than {MOST_VALUES} together");
            return Err(not_allowed(place, "grid", &what, "fewer combinations, or a shorter path or table").into());
        }
        let cases = check_all(&base, &sweep, count, file)?;
        Ok(Self {
            text: text.to_owned(),
            keys: sweep.keys.into_iter().map(|key| key.name).collect(),
            axes: sweep.axes.into_iter().map(|axis| (axis.label, axis.rows.len())).collect(),
            cases,
        })
    }

    /// Whether another study has the same cases under the same values, in the same order.
    pub fn cases_are(&self, other: &Self) -> bool {
        let same = |(ours, theirs): (&StudyCase, &StudyCase)| ours.values == theirs.values && ours.case == theirs.case;
        self.keys == other.keys && self.cases.len() == other.cases.len() && self.cases.iter().zip(&other.cases).all(same)
    }

    /// A number by which this study is told from others: of its keys and its cases.
    pub fn fingerprint(&self) -> String {
        let mut hasher = DefaultHasher::new();
        self.keys.hash(&mut hasher);
        for case in &self.cases {
            (&case.values, case.case.identity()).hash(&mut hasher);
        }
        format!("study {:016x}", hasher.finish())
    }

    /// The values of a case as `key = value, ...`.
    pub fn combination(&self, case: &StudyCase) -> String {
        describe(self.keys.iter().map(String::as_str).zip(case.values.iter().map(String::as_str)))
    }

    /// The size of the study in words: `12 cases: contact.friction (3) x path.0.indentation (4)`.
    pub fn size(&self) -> String {
        let axes: Vec<String> = self.axes.iter().map(|(name, count)| format!("{name} ({count})")).collect();
        format!("{} case{}: {}", self.cases.len(), if self.cases.len() == 1 { "" } else { "s" }, axes.join(" x "))
    }
}

/// How many values there are, in tables and arrays too.
fn values_of(value: &Value) -> usize {
    match value {
        Value::Array(items) => 1 + items.iter().map(|item| values_of(&item.value)).sum::<usize>(),
        Value::Table(table) => 1 + table.values().map(|entry| values_of(&entry.value)).sum::<usize>(),
        _ => 1,
    }
}

/// Contact tables alone, no fields, no plots and no companions, for each of hundreds of cases,
/// unless the base says otherwise.
fn with_study_defaults(mut base: Document) -> Result<Document, CaseError> {
    let place = base.root.place.clone();
    let defaults = [
        ("output", "fields", Value::String("contact".to_owned())),
        ("output", "plots", Value::Boolean(false)),
        ("solver", "error_estimate", Value::Boolean(false)),
    ];
    for (table, key, value) in defaults {
        let given = Reader::new(&base)?.table(table)?.get(key).is_some();
        if !given {
            let entry = Entry { place: place.clone(), value };
            base.set(&format!("{table}.{key}"), entry).map_err(|what| not_allowed(&place, table, &what, "a table"))?;
        }
    }
    Ok(base)
}

/// So many refusals are counted; what is wrong so often is the base, or a key.
const MOST_REFUSALS: usize = 1000;

/// What is refused of the combinations that were looked at.
struct Refused {
    first: CaseError,
    combination: String,
    count: usize,
    /// Whether every combination so far was refused, in the same words.
    alike: bool,
}

impl Refused {
    /// The first refusal; where all are refused alike, it is the base or a key that is wrong and
    /// not the combination.
    fn told(self, looked_at: usize, of: usize) -> StudyError {
        if self.alike && self.count == looked_at {
            return self.first.into();
        }
        StudyError::Combination {
            source: Box::new(self.first),
            combination: self.combination,
            failing: self.count,
            count: looked_at,
            more: looked_at < of,
        }
    }
}

/// Every combination as a case, or what is told of those that are refused.
fn check_all(base: &Document, sweep: &Sweep, count: usize, file: &str) -> Result<Vec<StudyCase>, StudyError> {
    let width = count.to_string().len().max(4);
    let keys = &sweep.keys;
    // A table is set before a key within it, wherever they stand in the file.
    let mut order: Vec<usize> = (0..keys.len()).collect();
    order.sort_by_key(|&key| keys[key].name.split('.').count());
    let mut cases = Vec::new();
    let (mut refused, mut looked_at): (Option<Refused>, usize) = (None, count);
    for number in 0..count {
        let chosen = sweep.choice(number);
        let values: Vec<String> = chosen.iter().map(|entry| entry.map_or(String::new(), |entry| plain(&entry.value))).collect();
        let combination = || describe(keys.iter().map(|key| key.name.as_str()).zip(values.iter().map(String::as_str)));
        let mut document = base.clone();
        let named = keys.iter().zip(&chosen).filter(|(_, entry)| entry.is_some());
        document.will_set(named.map(|(key, _)| key.name.as_str()));
        let set = order.iter().filter_map(|&key| Some((&keys[key], chosen[key]?))).try_for_each(|(key, entry)| {
            let SweepKey { name, told } = key;
            let refuse = |what: String| not_allowed(&entry.place, told, &what, "a dotted key of the case");
            document.set(name, entry.clone()).map_err(refuse)
        });
        match set.and_then(|()| Case::from_document(&document)) {
            Ok(case) => {
                case.material.constants::<f64>().map_err(|source| StudyError::Hardening {
                    file: file.to_owned(),
                    source,
                    combination: combination(),
                })?;
                cases.push(StudyCase { id: case_id(number + 1, width), values, case });
            }
            Err(error) => {
                let refused = match &mut refused {
                    Some(earlier) => {
                        earlier.alike &= error.to_string() == earlier.first.to_string();
                        earlier.count += 1;
                        earlier
                    }
                    none => none.insert(Refused { first: error, combination: combination(), count: 1, alike: number == 0 }),
                };
                if refused.count == MOST_REFUSALS {
                    looked_at = number + 1;
                    break;
                }
            }
        }
    }
    refused.map_or(Ok(cases), |refused| Err(refused.told(looked_at, count)))
}

fn describe<'a>(pairs: impl Iterator<Item = (&'a str, &'a str)>) -> String {
    let text = pairs
        .filter(|(_, value)| !value.is_empty())
        .map(|(key, value)| format!("{key} = {value}"))
        .collect::<Vec<_>>()
        .join(", ");
    short(&text).into_owned()
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
        assert_eq!(rows[0], ("c0001", "0.005 0.1".into()));
        assert_eq!(rows[1], ("c0002", "0.005 stick".into()));
        assert_eq!(rows[5], ("c0006", "0.02 1".into()));
        assert_eq!(study.cases[1].case.contact.friction, Friction::Stick);
        assert_eq!(study.combination(&study.cases[5]), "path.0.indentation = 0.02, contact.friction = 1");
        assert!(study.cases.iter().all(|case| case.case.output.fields == Fields::Contact && !case.case.output.plots));
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
    fn what_is_wrong_in_every_combination_is_found_in_the_first_thousand() {
        let values = |count: u32, text: &dyn Fn(u32) -> String| (0..count).map(text).collect::<Vec<_>>().join(", ");
        let moduli = values(200, &|i| format!("{}.0", 200_000 + i));
        let ratios = values(50, &|i| format!("{:?}", 0.0125 * f64::from(i)));
        let grid = |key: &str| format!("\"material.youngs_modulus\" = [{moduli}]\n\"{key}\" = [{ratios}]");
        let alike = refused(&grid("contact.frictoin"));
        assert!(alike.contains("did you mean `friction`") && !alike.contains("combinations"), "{alike}");
        let some = refused(&grid("material.poissons_ratio"));
        let told = "(in the combination material.youngs_modulus = 200000.0, material.poissons_ratio = 0.5; \
                    1000 of the first 5000 combinations are refused)";
        assert!(some.ends_with(told), "{some}");
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

    const ZIPPED: &str = "\"contact.friction\" = [0.1, 0.3]\n\
        [zip]\n\"material.youngs_modulus\" = [200e3, 70e3]\nmaterial.hardening.yield_stress = [400.0, 100.0]\n";

    #[test]
    fn a_zip_goes_through_its_keys_together_beside_the_grid() {
        let study = study(ZIPPED).unwrap();
        assert_eq!(study.keys, ["contact.friction", "material.youngs_modulus", "material.hardening.yield_stress"]);
        let size = "4 cases: contact.friction (2) x material.youngs_modulus with material.hardening.yield_stress (2)";
        assert_eq!(study.size(), size);
        let values: Vec<String> = study.cases.iter().map(|case| case.values.join(" ")).collect();
        assert_eq!(values, ["0.1 200000.0 400.0", "0.1 70000.0 100.0", "0.3 200000.0 400.0", "0.3 70000.0 100.0"]);
        assert_eq!(study.cases[1].case.material.youngs_modulus, 70e3);
        // Alone, and several of them, each with every row of the others.
        let alone = Study::parse(&format!("{BASE_CASE}[zip]\ncontact.friction = [0.1, 0.3]"), "study.toml").unwrap();
        assert_eq!(alone.cases.len(), 2);
        let two = "[[zip]]\ncontact.friction = [0.1, 0.3]\n[[zip]]\npath.0.indentation = [0.01, 0.02, 0.03]";
        assert_eq!(Study::parse(&format!("{BASE_CASE}{two}"), "study.toml").unwrap().cases.len(), 6);
    }

    #[test]
    fn a_list_says_its_cases_itself_and_leaves_the_rest_to_the_base() {
        let list = "[[list]]\n\"path.0.indentation\" = 0.01\n[[list]]\ncontact.friction = \"stick\"\n\
                    \"material.hardening\" = { law = \"linear\", yield_stress = 300.0, modulus = 50.0 }\n";
        let study = Study::parse(&format!("{BASE_CASE}{list}"), "study.toml").unwrap();
        assert_eq!(study.keys, ["path.0.indentation", "contact.friction", "material.hardening"]);
        assert_eq!(study.size(), "2 cases: list (2)");
        assert_eq!(study.cases[0].values, ["0.01", "", ""]);
        assert_eq!(study.combination(&study.cases[0]), "path.0.indentation = 0.01");
        assert_eq!(
            (study.cases[0].case.contact.friction, study.cases[1].case.contact.friction),
            (Friction::Coefficient(0.3), Friction::Stick)
        );
        assert_eq!(study.cases[1].case.material.hardening, Hardening::Linear { yield_stress: 300.0, modulus: 50.0 });
        // With every value of a grid.
        let both = Study::parse(&format!("{BASE_CASE}[grid]\n\"mesh.fine_zone\" = [1.3, 1.4, 1.5]\n{list}"), "study.toml");
        assert_eq!(both.unwrap().size(), "6 cases: mesh.fine_zone (3) x list (2)");
    }

    #[test]
    fn mistakes_of_zips_and_lists_name_line_and_key() {
        for (sweep, parts) in [
            (
                "[zip]\na.b = [1, 2]\nc.d = [1, 2, 3]",
                &["study.toml:16: zip.c.d: has 3 values, and zip.a.b has 2", "lists of one length"][..],
            ),
            ("[zip]\ncontact.friction = 0.1", &["zip.contact.friction: is the number 0.1", "a list of values"]),
            ("[zip]\n", &["study.toml:14: zip: is empty"]),
            ("zip = 3\n", &["zip"]),
            ("[zip]\ncontact.friction = [0.1, 0.1]", &["zip: has contact.friction = 0.1 twice"]),
            ("[grid]\ncontact.friction = [0.1]\n[zip]\ncontact.friction = [0.2]", &["zip.contact.friction: is there twice"]),
            (
                "[zip]\ncontact.frictoin = [0.1, 0.2]",
                &["study.toml:15: contact.frictoin: unknown key", "did you mean `friction`"],
            ),
            ("[[list]]\n", &["list.0: is empty"]),
            ("[list]\ncontact.friction = 0.1", &["study.toml:14: list: is a table", "[[list]]"]),
            (
                "[[list]]\ncontact.friction = -0.1\n[[list]]\ncontact.friction = 0.1",
                &["study.toml:15: contact.friction: is -0.1", "1 of 2"],
            ),
            (
                "[[list]]\ncontact.friction = 0.1\n[[list]]\ncontact.friction = 0.1",
                &["study.toml:17: list: has contact.friction = 0.1 twice"],
            ),
        ] {
            // A key of the top level stands before all tables.
            let text = if sweep.starts_with('[') { format!("{BASE_CASE}{sweep}") } else { format!("{sweep}{BASE_CASE}") };
            let message = Study::parse(&text, "study.toml").expect_err("no study").to_string();
            assert!(parts.iter().all(|part| message.contains(part)), "{sweep}\n{message}");
        }
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
