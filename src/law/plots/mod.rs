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
mod normal_maps;
mod run;
mod table;

#[cfg(test)]
mod tests;

pub use comparison::greatest_errors;
pub use run::{as_step, beside_run, law_beside_run, table_beside_run};
pub use table::picture as table_picture;

use super::data::StudyData;
use super::variables::{Body, Variables};
use super::{Law, LawError};
use crate::output::plots::Sheet;
use crate::output::{OutputDirectory, Picture, Summary, SummaryInputs, read_history};

/// The normal contact of a case before its shear, normalised: what Johnson's map and that of c^2
/// show.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalContact {
    /// Lambda, Hbar, c^2 and sigma_rep.
    pub variables: Variables,
    /// Hardening exponent d ln sigma/d ln eps_p at the representative strain.
    pub hardening_exponent: f64,
    /// h0/R.
    pub relative_indentation: f64,
    /// a0/R.
    pub relative_radius: f64,
    /// nu.
    pub poissons_ratio: f64,
}

impl NormalContact {
    /// Reads it from the directory of a run; `None` if the run never was in contact.
    ///
    /// # Errors
    /// A case or a history that cannot be read.
    pub fn read(directory: &OutputDirectory) -> Result<Option<Self>, LawError> {
        let case = directory.load_case()?;
        let summary = Summary::from_history(&read_history(&directory.history())?, &SummaryInputs::of(&case));
        let (Some(h0), Some(a0), Some(f_n0)) = (summary.h0, summary.a0, summary.f_n0) else { return Ok(None) };
        if !(h0 > 0.0 && a0 > 0.0 && f_n0 > 0.0) {
            return Ok(None);
        }
        let body = Body::from_case(&case)?;
        Ok(Some(Self {
            variables: body.variables(h0, a0, f_n0),
            hardening_exponent: body.hardening_exponent(a0),
            relative_indentation: h0 / case.sphere.radius,
            relative_radius: a0 / case.sphere.radius,
            poissons_ratio: case.material.poissons_ratio,
        }))
    }
}

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
