//! The words by which a file names its formulas. Earlier versions of the program chose between
//! sixteen ways to write a shear and four to write F_N0; of these one is left, and a file of
//! another one is told from a file that is damaged.

use serde::{Deserialize, Serialize};

use crate::output::plain_json;

/// The formulas of the shear, as the key `forms` has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Forms {
    variable: PlasticVariable,
    slip_displacement: SlipDisplacement,
    normal_curve: NormalCurve,
}

/// In what plasticity is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum PlasticVariable {
    #[default]
    Area,
}

/// How the displacement at full slip is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum SlipDisplacement {
    #[default]
    ThroughStiffness,
}

/// How f_N is written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum NormalCurve {
    #[default]
    ComplementOfPower,
}

/// The formulas of a0 and F_N0, as the key `normal.form` has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NormalForm {
    /// Composed of the elastic and the plastic limit.
    #[default]
    Composed,
}

/// The words of any version.
#[derive(Deserialize)]
struct Named {
    forms: NamedForms,
    normal: NamedNormal,
}

#[derive(Deserialize)]
struct NamedForms {
    variable: String,
    slip_displacement: String,
    normal_curve: String,
}

#[derive(Deserialize)]
struct NamedNormal {
    form: String,
}

/// What each key may have been, the word that is left first.
const EARLIER: [(&str, &[&str]); 4] = [
    ("forms.variable", &["area", "lambda", "friction-lambda", "stiffness"]),
    ("forms.slip_displacement", &["through-stiffness", "direct"]),
    ("forms.normal_curve", &["complement-of-power", "power-of-complement"]),
    ("normal.form", &["composed", "published", "corrected", "smooth"]),
];

/// Refuses the text of a law whose formulas an earlier version had; what is wrong with any other
/// text is for others to tell.
pub(super) fn refuse_earlier(text: &str) -> Result<(), String> {
    let Ok(Named { forms, normal }) = plain_json::from_str(text) else { return Ok(()) };
    let words = [forms.variable, forms.slip_displacement, forms.normal_curve, normal.form];
    for ((key, known), word) in EARLIER.into_iter().zip(words) {
        if known[1..].contains(&word.as_str()) {
            return Err(format!(
                "is a law of formulas that earlier versions had: {key} is {word:?}, and this version has {:?} alone",
                known[0]
            ));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::law::Law;

    /// Every word of earlier versions, in the place of the one that is left.
    #[test]
    fn formulas_of_earlier_versions_are_told_by_name() {
        let text = include_str!("../../../fixtures/law/law.json");
        assert!(Law::from_json(text).is_ok());
        for (key, words) in super::EARLIER {
            let name = key.split('.').next_back().unwrap();
            for word in &words[1..] {
                let line = |word: &str| format!("\"{name}\": \"{word}\"");
                assert_eq!(text.matches(&line(words[0])).count(), 1, "{key}");
                let told = Law::from_json(&text.replace(&line(words[0]), &line(word))).unwrap_err();
                assert!(told.contains("earlier versions had") && told.contains(&format!("{key} is {word:?}")), "{told}");
            }
            let damaged = Law::from_json(&text.replace(&format!("\"{name}\": \"{}\"", words[0]), &format!("\"{name}\": \"x\"")));
            assert!(!damaged.unwrap_err().contains("earlier versions"), "{key}");
        }
    }
}
