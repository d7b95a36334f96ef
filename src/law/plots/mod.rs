//! Pictures of a study, and of a law fitted to it: the normal problem over Lambda, what the law
//! correlates, all curves in normalised variables, and the law against single cases.
//!
//! `groups` tells cases apart by mu and by hardening and draws the law's curve of a reference
//! sphere; `run` has a law beside the simulation of one case, `table` a table beside the depths it
//! was made from; the others are the pictures.

mod collapse;
mod comparison;
mod correlations;
mod groups;
mod normal_contact;
mod normal_maps;
mod run;
mod table;

#[cfg(test)]
mod tests;

pub use comparison::greatest_errors;
pub use normal_contact::NormalContact;
pub use run::{as_step, beside_run, law_beside_run, table_beside_run};
pub use table::picture as table_picture;

use super::data::StudyData;
use super::{Law, LawError};
use crate::output::Picture;
use crate::output::plots::Sheet;

/// Every picture for which there is something to show. `contacts` are all cases that were pressed;
/// a law adds its curves, and the pictures of its errors.
///
/// # Errors
/// A drawing fails.
pub fn study_pictures(
    contacts: &[NormalContact],
    data: &StudyData,
    law: Option<&Law>,
    sheet: Sheet,
) -> Result<Vec<Picture>, LawError> {
    let mut pictures = Vec::new();
    if contacts.iter().any(|contact| contact.variables.lambda > 0.0) {
        pictures.extend([normal_maps::johnson(contacts, law, sheet)?, normal_maps::area(contacts, law, sheet)?]);
    }
    let samples = data.samples.as_slice();
    if samples.is_empty() {
        return Ok(pictures);
    }
    if samples.iter().any(|sample| sample.variables.lambda > 0.0) {
        pictures.push(correlations::fall(samples, law, sheet)?);
        if let Some(law) = law {
            pictures.push(correlations::parameters(samples, law, sheet)?);
        }
    }
    pictures.push(collapse::tangential(samples, law, sheet)?);
    pictures.extend(collapse::normal(samples, law, sheet)?);
    if let Some(law) = law {
        pictures.extend([comparison::cases(samples, law, sheet)?, comparison::errors(samples, law, sheet)?]);
    }
    Ok(pictures)
}
