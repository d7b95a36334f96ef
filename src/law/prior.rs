//! What is known before a study is looked at: the constants of a law that was fitted to more.
//!
//! A small study determines a few combinations of the constants and leaves the others open. Its fit
//! may start from the constants of a bigger law and be drawn back to them: the constant c adds the
//! residual w ln(c/c_prior) to those of the data, which are shares of a force, every case counting
//! as one. Which weight w, or none, is a question to the cross-validation.

use std::path::Path;

use super::model::Law;
use super::{LawError, json};

/// The weights that are tried. The greatest all but keeps the prior's constants; the least decides
/// only what the data leave open.
pub const WEIGHTS: [f64; 4] = [0.03, 0.1, 0.3, 1.0];
/// The built-in law is offered to studies with less than this share of its cases.
const SMALL: f64 = 0.25;

/// The law in fixtures/law/, fitted to the study fixtures/studies/wear-2014.toml.
const BUILT_IN: &str = include_str!("../../fixtures/law/law.json");

/// Whether a fit knows of another law.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Prior {
    /// The built-in law, fitted to the 240 cases of wear-2014, for a study with less than a quarter
    /// as many; else none.
    #[default]
    BuiltIn,
    /// None: the constants are drawn to one, weakly.
    None,
    /// A given law. One that was fitted to cases of the study itself makes the cross-validated
    /// errors too small.
    Law(Box<Law>),
}

impl Prior {
    /// What `--prior` says: `built-in`, `none`, or the path of a law.json.
    ///
    /// # Errors
    /// A file that is no law.
    pub fn from_option(text: &str) -> Result<Self, LawError> {
        Ok(match text {
            "built-in" => Self::BuiltIn,
            "none" => Self::None,
            path => {
                json::refuse_misspelt(Path::new(path), &["none"])?;
                Self::Law(Box::new(Law::read(Path::new(path))?))
            }
        })
    }

    /// The law for a study of that many cases.
    ///
    /// # Errors
    /// A built-in law that is none.
    pub(super) fn law(&self, cases: usize) -> Result<Option<Law>, LawError> {
        Ok(match self {
            Self::None => None,
            Self::Law(law) => Some((**law).clone()),
            Self::BuiltIn => Some(built_in()?).filter(|law| (cases as f64) < SMALL * law.provenance.cases as f64),
        })
    }
}

/// The law that comes with the program.
///
/// # Errors
/// A file that was no law when the program was built.
pub fn built_in() -> Result<Law, LawError> {
    Law::from_json(BUILT_IN).map_err(|problem| LawError::BadLaw { path: "fixtures/law/law.json".into(), problem })
}
