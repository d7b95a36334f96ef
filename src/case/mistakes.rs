//! Every mistake of a case file at once, not only the first one that the parser meets.
//!
//! The parser ends at the first mistake. It is then put right with a value from the starter case,
//! and the parser begins again, until it has nothing to say. What depends on a value that was put
//! right is not judged: it may be right with the value that was meant.

use super::{Case, CaseError, Document, starter_case};

/// Most mistakes that are told at once.
const MOST: usize = 40;

/// The mistakes of a document, in the order in which they stand in the file; none if it is a case.
pub fn mistakes(document: &Document) -> Vec<CaseError> {
    let mut found: Vec<CaseError> = Vec::new();
    let mut tried = document.clone();
    // Keys whose values are no longer the file's.
    let mut replaced: Vec<String> = Vec::new();
    while found.len() < MOST {
        let case = if replaced.is_empty() && found.is_empty() { Case::from_document(&tried) } else { Case::of_any_size(&tried) };
        let Err(error) = case else { break };
        let Some(key) = error.key().map(str::to_owned) else {
            found.push(error);
            break;
        };
        let meant = match &error {
            CaseError::UnknownKey { nearest, .. } => Some(nearest.clone()),
            _ => None,
        };
        // A key that nobody knows, and a whole table that is missing, are mistakes whatever the
        // values.
        let by_itself = match &error {
            CaseError::UnknownKey { .. } => true,
            CaseError::Missing { .. } => !key.contains('.'),
            _ => false,
        };
        if by_itself || !replaced.iter().any(|before| depends(&key, before)) {
            found.push(error);
        }
        if let Some(meant) = meant
            && rename(&mut tried, &key, meant.as_deref())
        {
            continue;
        }
        // Nothing is left to put right where a table of the starter case is refused.
        if replaced.iter().any(|before| Some(before.as_str()) == key.split('.').next()) {
            break;
        }
        replaced.extend(mend(&mut tried, &key, &replaced));
    }
    found.sort_by_key(|error| error.place().map_or(usize::MAX, super::Place::line));
    found
}

/// Whether a mistake in `key` may come from the value that replaces that of `replaced`.
fn depends(key: &str, replaced: &str) -> bool {
    let below = |table: &str| key == table || key.starts_with(&format!("{table}."));
    match replaced {
        "sphere" | "sphere.radius" => below("path") || key == "mesh.contact_radius" || below("sphere"),
        "material" | "material.youngs_modulus" | "material.hardening.law" => below("material.hardening"),
        "contact" | "contact.friction" => below("path"),
        "mesh.elements_per_contact_radius" => key == "mesh.surface_elements_per_contact_radius" || below(replaced),
        // Segments begin where others end.
        segment if segment.starts_with("path") => below("path"),
        _ => below(replaced),
    }
}

/// Takes away a key that nobody knows. What it stands for, if it is a misspelt key and that is not
/// there, gets its value: a key is not missed that is only misspelt. Whether there was such a key.
fn rename(document: &mut Document, key: &str, meant: Option<&str>) -> bool {
    let Some(entry) = document.at(key).cloned() else { return false };
    if !document.remove(key) {
        return false;
    }
    if let Some(meant) = meant {
        // One of another table has all its parts.
        let own = key.rsplit_once('.').filter(|_| !meant.contains('.'));
        let meant = own.map_or(meant.to_owned(), |(table, _)| format!("{table}.{meant}"));
        if document.at(&meant).is_none() {
            // Where something else stands on the way, it is told by itself.
            let _ = document.set(&meant, entry);
        }
    }
    true
}

/// Puts a value from the starter case at `key`, or takes away what stands there; the keys whose
/// values are no longer the file's.
fn mend(document: &mut Document, key: &str, replaced: &[String]) -> Vec<String> {
    let law = match document.at("material.hardening.law").map(|entry| &entry.value) {
        Some(super::Value::String(law)) if super::keys::LAWS.contains(&law.as_str()) => law.clone(),
        _ => "ideal".to_owned(),
    };
    let Ok(starter) = Document::parse(&starter_case(&law, ""), "") else { return Vec::new() };
    let top = key.split('.').next().unwrap_or(key);
    // One that is wrong with the starter's value too, or a path, is replaced as a whole.
    let mended = if replaced.iter().any(|before| before == key) || top == "path" { top } else { key };
    match starter.at(mended) {
        Some(entry) => drop(document.set(mended, entry.clone())),
        None => drop(document.remove(mended)),
    }
    let mut keys = vec![key.to_owned(), mended.to_owned()];
    if top == "path" || mended == "sphere" {
        // Lengths of the starter are those of its sphere.
        for table in ["sphere", "path"] {
            if let Some(entry) = starter.at(table).filter(|_| table == top || document.at(table).is_some()) {
                // Both are tables of every case.
                let _ = document.set(table, entry.clone());
            }
        }
        document.remove("mesh.contact_radius");
    }
    keys.dedup();
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    fn told(text: &str) -> Vec<String> {
        mistakes(&Document::parse(text, "case.toml").expect("TOML")).iter().map(ToString::to_string).collect()
    }

    const GOOD: &str = include_str!("../../fixtures/cases/ideal.toml");

    #[test]
    fn a_good_case_has_none() {
        assert!(told(GOOD).is_empty());
        for law in super::super::keys::LAWS {
            assert!(told(&starter_case(law, "")).is_empty(), "{law}");
        }
    }

    #[test]
    fn all_are_told_in_the_order_of_the_file() {
        let text = GOOD
            .replace("poissons_ratio = 0.3", "poissons_ratio = 0.5")
            .replace("yield_stress", "yield_stres")
            .replace("friction = 0.3", "friction = \"glue\"\nmu = 0.3")
            .replace("hold = \"indentation\"", "holds = \"indentation\"");
        let told = told(&text);
        let keys = ["material.poissons_ratio", "yield_stres", "contact.friction", "contact.mu", "path.1.holds"];
        assert_eq!(told.len(), keys.len(), "{told:?}");
        assert!(keys.iter().all(|key| told.iter().any(|told| told.contains(&format!("{key}: ")))), "{told:?}");
        let lines: Vec<&str> = told.iter().filter_map(|told| told.split(':').nth(1)).collect();
        assert!(lines.is_sorted_by_key(|line| line.parse::<usize>().expect("a line")), "{told:?}");
    }

    /// A press of 0.02 is right for a radius of 1, and a yield stress of 400 for 200e3.
    #[test]
    fn what_depends_on_a_mistake_is_not_judged() {
        assert_eq!(told(&GOOD.replace("radius = 1.0", "radius = -1.0")).len(), 1);
        assert_eq!(told(&GOOD.replace("youngs_modulus = 200e3", "youngs_modulus = \"200e3\"")).len(), 1);
        assert_eq!(told(&GOOD.replace("law = \"ideal\"", "law = \"power\"")).len(), 2);
        assert_eq!(told(&GOOD.replace("law = \"ideal\"", "law = \"swift\"")).len(), 1);
        assert_eq!(told(&GOOD.replace("indentation = 0.02", "indentation = 0.4")).len(), 1);
    }

    /// 400 is no yield stress for 0.3; what is wrong further down is told all the same.
    #[test]
    fn one_that_cannot_be_put_right_alone_hides_no_other() {
        let text = GOOD.replace("youngs_modulus = 200e3", "youngs_modulus = 0.3").replace("friction = 0.3", "friction = -1");
        let told = told(&text);
        assert!(told.len() == 2 && told[0].contains("yield_stress") && told[1].contains("contact.friction"), "{told:?}");
    }

    #[test]
    fn an_empty_case_lacks_its_tables() {
        assert_eq!(told("").len(), 4);
    }
}
