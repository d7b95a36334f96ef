//! The words by which files of earlier versions name their formulas. Those versions chose between
//! sixteen ways to write a shear and four to write F_N0; one of each is left, and has no name. A
//! file that names it is read as what it is; one of other formulas is told from one that is
//! damaged.

use std::borrow::Cow;

use serde_json::Value;

use crate::output::plain_json;

/// What each key may have been, the word that is left first.
const EARLIER: [(&str, &str, &[&str]); 4] = [
    ("forms", "variable", &["area", "lambda", "friction-lambda", "stiffness"]),
    ("forms", "slip_displacement", &["through-stiffness", "direct"]),
    ("forms", "normal_curve", &["complement-of-power", "power-of-complement"]),
    ("normal", "form", &["composed", "published", "corrected", "smooth"]),
];

/// The text of a law without the names of its formulas; what else is wrong with it is for others to
/// tell.
///
/// # Errors
/// Formulas that an earlier version had.
pub(super) fn without_names(text: &str) -> Result<Cow<'_, str>, String> {
    let Ok(mut law) = plain_json::from_str::<Value>(text) else { return Ok(text.into()) };
    let mut named = false;
    for (table, key, known) in EARLIER {
        let Some(names) = law.get_mut(table).and_then(Value::as_object_mut) else { continue };
        match names.get(key).and_then(Value::as_str) {
            Some(word) if word == known[0] => named |= names.remove(key).is_some(),
            Some(word) if known.contains(&word) => {
                return Err(format!(
                    "is a law of formulas that earlier versions had: {table}.{key} is {word:?}, and this version has {:?} alone",
                    known[0]
                ));
            }
            _ => {}
        }
    }
    if let Some(law) =
        law.as_object_mut().filter(|law| law.get("forms").is_some_and(|forms| forms == &Value::Object(Default::default())))
    {
        law.remove("forms");
    }
    Ok(if named { format!("{law:#}").into() } else { text.into() })
}

#[cfg(test)]
mod tests {
    use super::EARLIER;
    use crate::law::Law;

    /// A file of this version, and the same with its formulas named.
    fn now_and_before() -> (&'static str, String) {
        let text = include_str!("../../../fixtures/law/law.json");
        let names = |table: &str| -> Vec<String> {
            let of = EARLIER.iter().filter(|(named, ..)| *named == table);
            of.map(|(_, key, words)| format!("\"{key}\": \"{}\"", words[0])).collect()
        };
        let named = text.replacen("\"constants\"", &format!("\"forms\": {{{}}}, \"constants\"", names("forms").join(", ")), 1);
        let named = named.replacen("\"normal\": {", &format!("\"normal\": {{{}, ", names("normal")[0]), 1);
        (text, named)
    }

    #[test]
    fn a_law_that_names_the_formulas_that_are_left_is_read() {
        let (text, named) = now_and_before();
        assert_eq!(Law::from_json(text), Law::from_json(&named));
        assert!(Law::from_json(&named).is_ok() && !text.contains("form\"") && !text.contains("forms"));
    }

    /// Every word of earlier versions, in the place of the one that is left.
    #[test]
    fn formulas_of_earlier_versions_are_told_by_name() {
        let named = now_and_before().1;
        for (table, key, words) in EARLIER {
            let line = |word: &str| format!("\"{key}\": \"{word}\"");
            assert_eq!(named.matches(&line(words[0])).count(), 1, "{key}");
            for word in &words[1..] {
                let told = Law::from_json(&named.replace(&line(words[0]), &line(word))).unwrap_err();
                assert!(told.contains("earlier versions had") && told.contains(&format!("{table}.{key} is {word:?}")), "{told}");
            }
            let damaged = Law::from_json(&named.replace(&line(words[0]), &line("x")));
            assert!(!damaged.unwrap_err().contains("earlier versions"), "{key}");
        }
    }
}
