//! The normal contact of a case before its shear.

use crate::law::LawError;
use crate::law::variables::{Body, Variables};
use crate::output::{OutputDirectory, Summary, SummaryInputs, read_history};

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
