//! What is known before a study is looked at: the constants of a law that was fitted to more.
//!
//! A small study determines a few combinations of the constants and leaves the others open. Its fit
//! may start from the constants of a bigger law and be drawn back to them: the constant c adds the
//! residual w ln(c/c_prior) to those of the data, which are shares of a force, every case counting
//! as one. Which weight w, or none, is a question to the cross-validation.

use std::path::Path;

use super::model::Law;
use crate::law::{LawError, json};

/// The weights that are tried. The greatest all but keeps the prior's constants; the least decides
/// only what the data leave open.
pub const WEIGHTS: [f64; 4] = [0.03, 0.1, 0.3, 1.0];
/// The law of wear-2014 is offered to studies with less than this share of its cases.
const SMALL: f64 = 0.25;

/// The law in fixtures/law/, fitted to the study fixtures/studies/wear-2014.toml.
const WEAR_2014: &str = include_str!("../../../fixtures/law/law.json");

/// Whether a fit knows of another law.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Prior {
    /// That of [`Law::wear_2014`], for a study with less than a quarter as many cases as it has;
    /// else none.
    #[default]
    Wear2014,
    /// None: the constants are drawn to one, weakly.
    None,
    /// A given law. One that was fitted to cases of the study itself makes the cross-validated
    /// errors too small.
    Law(Box<Law>),
}

impl Prior {
    /// What `--prior` says: `wear-2014`, which earlier versions called `built-in`, `none`, or the
    /// path of a law.json.
    ///
    /// # Errors
    /// A file that is no law.
    pub fn from_option(text: &str) -> Result<Self, LawError> {
        Ok(match text {
            "wear-2014" | "built-in" => Self::Wear2014,
            "none" => Self::None,
            path => {
                json::refuse_misspelt(Path::new(path), &["wear-2014", "none"])?;
                Self::Law(Box::new(Law::read(Path::new(path))?))
            }
        })
    }

    /// The law for a study of that many cases.
    ///
    /// # Errors
    /// Those of [`Law::wear_2014`].
    pub(super) fn law(&self, cases: usize) -> Result<Option<Law>, LawError> {
        Ok(match self {
            Self::None => None,
            Self::Law(law) => Some((**law).clone()),
            Self::Wear2014 => Some(Law::wear_2014()?).filter(|law| (cases as f64) < SMALL * law.provenance.cases as f64),
        })
    }
}

impl Law {
    /// The formulas with the constants of the study wear-2014 (`fixtures/law`): 240 cases of 15
    /// materials on a plane, nu = 0.3, mu 0.05 to 0.5, h/R 0.001 to 0.05. The built-in law holds
    /// for more and is nearer: [`LawFile::built_in`](crate::law::LawFile::built_in).
    ///
    /// # Errors
    /// A file that was no law when the program was built.
    pub fn wear_2014() -> Result<Self, LawError> {
        Self::from_json(WEAR_2014).map_err(|problem| LawError::BadLaw { path: "fixtures/law/law.json".into(), problem })
    }
}

#[cfg(test)]
mod tests {
    use super::Prior;

    #[test]
    fn the_earlier_name_of_wear_2014_is_taken() {
        for name in ["wear-2014", "built-in"] {
            assert!(matches!(Prior::from_option(name), Ok(Prior::Wear2014)), "{name}");
        }
    }
}
