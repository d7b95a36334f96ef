//! The table of keys against the parser.

use std::collections::BTreeSet;

use super::*;
use crate::case::{Case, CaseError, starter_case};

fn parsed(law: &str, sets: &[String]) -> Result<Case, CaseError> {
    Case::parse(&starter_case(law, "case.toml"), "case.toml", sets)
}

/// The names that the parser knows in a table, from its refusal of one that nobody knows.
fn known(law: &str, table: &str) -> Option<BTreeSet<String>> {
    let key = if table.is_empty() { "no_such_key".to_owned() } else { format!("{table}.no_such_key") };
    match parsed(law, &[format!("{key}=1")]) {
        Err(CaseError::UnknownKey { allowed, .. }) => Some(allowed.split(", ").map(str::to_owned).collect()),
        _ => None,
    }
}

fn listed(law: &str, table: &str) -> BTreeSet<String> {
    let keys = KEYS.iter().filter(|key| key.table == table && key.fits(law)).map(|key| key.name.to_owned());
    let below = TABLES.iter().filter_map(|(name, _)| {
        let (above, last) = name.rsplit_once('.').unwrap_or(("", name));
        (above == table).then(|| last.to_owned())
    });
    keys.chain(below).collect()
}

#[test]
fn the_table_has_every_key_of_the_parser_and_no_other() {
    for law in LAWS {
        // From the parser, so that a table that is missing here is found as well.
        let mut tables = vec![String::new()];
        while let Some(table) = tables.pop() {
            let place = if table == "path" { "path.0".to_owned() } else { table.clone() };
            let Some(known) = known(law, &place) else { continue };
            assert_eq!(known, listed(law, table.strip_prefix("opponent.").unwrap_or(&table)), "{law}: [{table}]");
            let dotted = |name: &String| if table.is_empty() { name.clone() } else { format!("{table}.{name}") };
            tables.extend(known.iter().map(dotted));
        }
    }
    let named: BTreeSet<&str> = KEYS.iter().map(|key| key.table).collect();
    assert_eq!(named, TABLES.iter().map(|(table, _)| *table).collect());
}

#[test]
fn the_keys_of_hardening_are_those_of_its_laws() {
    for law in HardeningLaw::ALL.into_iter().filter(|law| *law != HardeningLaw::Table) {
        let of_law = |key: &&Key| key.table == "material.hardening" && key.laws.contains(&law.word());
        let keys: BTreeSet<_> = KEYS.iter().filter(of_law).map(|key| (key.name, key.unit == STRESS)).collect();
        assert_eq!(keys, law.parameters().iter().map(|parameter| (parameter.key, parameter.is_stress)).collect(), "{law:?}");
    }
    let range = KEYS.iter().find(|key| key.dotted() == "material.hardening.law").map(|key| key.range).unwrap();
    let words = range.replace(" or ", ", ").replace('"', "");
    assert_eq!(words.split(", ").collect::<Vec<_>>(), LAWS);
}

/// The segment, or the table, to which a key belongs.
fn place(key: &Key) -> String {
    match key.name {
        "shear" | "shear_direction" | "hold" => format!("path.1.{}", key.name),
        "release" => "path.2.release".to_owned(),
        _ => key.dotted().replace("N", "0"),
    }
}

fn refused(law: &str, key: &Key, value: &str) -> bool {
    match parsed(law, &[format!("{}={value}", place(key))]) {
        Err(CaseError::NotAllowed { key: named, .. } | CaseError::WrongType { key: named, .. }) => {
            // Of a pair the component.
            named == place(key) || matches!(key.kind, Components(_)) && named.starts_with(&format!("{}.", place(key)))
        }
        _ => false,
    }
}

fn laws(key: &Key) -> Vec<&'static str> {
    LAWS.into_iter().filter(|law| key.fits(law)).collect()
}

#[test]
fn examples_and_words_are_taken_and_values_beyond_the_limits_are_refused() {
    for key in KEYS {
        let law = if key.name == "law" { "elastic" } else { laws(key)[0] };
        let takes = |value: &str| {
            // What goes with a rigid sphere alone.
            let beside: &[&str] = match key.dotted().as_str() {
                "opponent.radius" => &["opponent.rigid=true"],
                "opponent.flat" => &["path=[{indentation=0.01}]"],
                // Of elements inside, a multiple.
                "mesh.surface_elements_per_contact_radius" if value == "4" => &["mesh.elements_per_contact_radius=4"],
                "mesh.surface_elements_per_contact_radius" if value == key.example => &[],
                "mesh.surface_elements_per_contact_radius" => &["mesh.elements_per_contact_radius=8"],
                "sphere.flat" => &["opponent.rigid=true", "opponent.radius=2.0"],
                _ => &[],
            };
            let sets: Vec<String> =
                beside.iter().map(|set| (*set).to_owned()).chain([format!("{}={value}", place(key))]).collect();
            let case = parsed(law, &sets);
            assert!(case.is_ok(), "{} = {value}: {:?}", key.dotted(), case.err());
        };
        let (least, beyond) = (|x: f64| format!("{:?}", x - 1e-6 * x.abs()), |x: f64| format!("{:?}", x + 1e-6 * x.abs()));
        if key.name != "law" {
            takes(key.example);
        }
        match key.kind {
            Number(low, high, words) => {
                for word in words {
                    let law = if key.name == "friction" { "path.1.shear=0.001" } else { "path.1.hold=indentation" };
                    let case = parsed("ideal", &[format!("{}=\"{word}\"", place(key)), law.to_owned()]);
                    assert!(case.is_ok(), "{}: {:?}", key.dotted(), case.err());
                }
                assert!(refused(law, key, "nan") && refused(law, key, "[]"), "{}", key.dotted());
                match low {
                    Free => {}
                    AtLeast(limit) | AtMost(limit) => assert!(refused(law, key, &least(limit - 1e-300)), "{}", key.dotted()),
                    Above(limit) => assert!(refused(law, key, &format!("{limit:?}")), "{}", key.dotted()),
                }
                match high {
                    Free => {}
                    AtLeast(limit) | AtMost(limit) => assert!(refused(law, key, &beyond(limit)), "{}", key.dotted()),
                    Above(limit) => assert!(refused(law, key, &format!("{limit:?}")), "{}", key.dotted()),
                }
            }
            Whole(least, most) => {
                takes(&least.to_string());
                takes(&most.to_string());
                assert!(refused(law, key, &format!("{}", i64::from(least) - 1)), "{}", key.dotted());
                assert!(refused(law, key, &format!("{}", i64::from(most) + 1)), "{}", key.dotted());
            }
            Truth => assert!(refused(law, key, "1"), "{}", key.dotted()),
            ShareOrTrue => {
                takes("0.5");
                assert!(["false", "0.0", "1.0"].iter().all(|value| refused(law, key, value)), "{}", key.dotted());
            }
            Word(words) => {
                if key.name != "law" {
                    words.iter().for_each(|word| takes(&format!("{word:?}")));
                }
                assert!(refused(law, key, "\"no such word\""), "{}", key.dotted());
            }
            Text => assert!(refused(law, key, "1.0") && refused(law, key, "\"\""), "{}", key.dotted()),
            Components(words) => {
                words.iter().for_each(|word| takes(&format!("{word:?}")));
                takes("[0.001, 0.002]");
                let wrong = ["nan", "[]", "[0.1]", "[0.1, 0.1, 0.1]", "[0.1, nan]", "[10.0, 0.0]", "10.0", "\"no such word\""];
                for value in wrong {
                    assert!(refused(law, key, value), "{} = {value}", key.dotted());
                }
            }
            Points | Material => assert!(refused(law, key, "1.0"), "{}", key.dotted()),
        }
    }
}

#[test]
fn required_keys_are_missed_and_defaults_are_what_the_parser_takes() {
    let resolved = parsed("ideal", &[]).expect("a case").to_toml();
    for key in KEYS {
        match key.presence {
            Required => {
                let law = laws(key)[0];
                let start = starter_case(law, "case.toml");
                let line = start.lines().position(|line| line.starts_with(&format!("{} = ", key.name)));
                // An exponent or a coefficient stands once in the file of its law.
                let without: Vec<&str> =
                    start.lines().enumerate().filter(|(i, _)| Some(*i) != line).map(|(_, line)| line).collect();
                match Case::parse(&without.join("\n"), "case.toml", &[]) {
                    Err(CaseError::Missing { key: named, .. }) => assert_eq!(named, key.dotted()),
                    other => panic!("{}: {other:?}", key.dotted()),
                }
            }
            Defaults(value) => {
                let told = |line: &str| {
                    let (name, told) = line.split_once(" = ")?;
                    let same = match (told.parse::<f64>(), value.parse::<f64>()) {
                        (Ok(told), Ok(value)) => told == value,
                        _ => told == value,
                    };
                    (name == key.name).then_some(same)
                };
                assert_eq!(resolved.lines().find_map(told), Some(true), "{}: {resolved}", key.dotted());
            }
            Optional(_) => {}
        }
    }
}

#[test]
fn keys_are_found_by_whole_names_parts_and_tables() {
    let found = |name: &str| find(name).iter().map(|key| key.dotted()).collect::<Vec<_>>();
    assert_eq!(found("contact.friction"), ["contact.friction"]);
    assert_eq!(found("friction"), ["contact.friction"]);
    assert_eq!(found("path.7.shear"), ["path.N.shear"]);
    assert_eq!(found("exponent").len(), 2);
    assert_eq!(found("hardening.law"), ["material.hardening.law"]);
    assert_eq!(found("output").len(), 6);
    assert!(found("shear_").is_empty());
    assert_eq!(nearest_key("frictoin").as_deref(), Some("friction"));
}
