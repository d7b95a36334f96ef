//! A contact in a line of options, for commands that otherwise read a case file.

use clap::Args;

use super::CliError;
use super::input::InputFile;
use crate::case::{Case, CaseError};

/// What a case of one press and one shear needs. `--E` takes the place of the file.
#[derive(Clone, Debug, Args)]
pub struct ContactArgs {
    /// Instead of a case file: Young's modulus of a sphere with radius 1, in any unit of stress.
    #[arg(long = "E", value_name = "E", conflicts_with = "case", requires_all = ["nu", "yield_stress", "mu", "h"],
          allow_negative_numbers = true, value_parser = number)]
    pub youngs_modulus: Option<f64>,
    /// With --E: Poisson's ratio.
    #[arg(long, requires = "youngs_modulus", allow_negative_numbers = true, value_parser = number)]
    pub nu: Option<f64>,
    /// With --E: yield stress, in the unit of E; the sphere is ideally plastic.
    #[arg(long = "yield", value_name = "STRESS", requires = "youngs_modulus", allow_negative_numbers = true,
          value_parser = number)]
    pub yield_stress: Option<f64>,
    /// With --E: friction coefficient.
    #[arg(long, requires = "youngs_modulus", allow_negative_numbers = true, value_parser = number)]
    pub mu: Option<f64>,
    /// With --E: indentation over R, before the sphere is sheared to full slip.
    #[arg(long, requires = "youngs_modulus", allow_negative_numbers = true, value_parser = number)]
    pub h: Option<f64>,
    /// With --E: against an equal sphere instead of a rigid plane.
    #[arg(long, requires = "youngs_modulus")]
    pub equal: bool,
}

/// The keys of a case by the options that give them.
const OPTIONS: [(&str, &str); 5] = [
    ("material.youngs_modulus", "--E"),
    ("material.poissons_ratio", "--nu"),
    ("material.hardening.yield_stress", "--yield"),
    ("contact.friction", "--mu"),
    ("path.0.indentation", "--h"),
];

fn number(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| "it is no number; write it as in 0.3 or 200e3, with a decimal point and no unit".to_owned())
}

impl ContactArgs {
    /// The case that the options describe, or `None` without `--E`.
    ///
    /// # Errors
    /// [`CliError::Options`] with the option and what it may be.
    pub fn case(&self, settings: &[String]) -> Result<Option<Case>, CliError> {
        let numbers = (self.youngs_modulus, self.nu, self.yield_stress, self.mu, self.h);
        let (Some(e), Some(nu), Some(stress), Some(mu), Some(h)) = numbers else { return Ok(None) };
        let opponent = if self.equal { "[opponent]\nequal = true\n" } else { "" };
        let text = format!(
            "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = {e:?}\npoissons_ratio = {nu:?}\n\
             [material.hardening]\nlaw = \"ideal\"\nyield_stress = {stress:?}\n[contact]\nfriction = {mu:?}\n\
             {opponent}[[path]]\nindentation = {h:?}\n[[path]]\nshear = \"full-slip\"\n"
        );
        let input = InputFile { text, name: "the options".to_owned() };
        match input.case(settings) {
            Ok(case) => Ok(Some(case)),
            Err(CliError::Mistakes { errors, .. }) => {
                Err(CliError::Options { what: errors.iter().map(|error| by_option(error, settings)).collect() })
            }
            Err(error) => Err(error),
        }
    }
}

/// What is wrong, at the option that says it, unless a setting has replaced that.
fn by_option(error: &CaseError, settings: &[String]) -> String {
    let text = error.to_string();
    let given = |key: &str| !settings.iter().any(|setting| setting.trim_start().starts_with(key));
    let found = OPTIONS
        .iter()
        .filter(|(key, _)| given(key))
        .find_map(|(key, option)| Some((option, text.split_once(&format!("{key}: "))?.1)));
    found.map_or_else(|| text.clone(), |(option, what)| format!("{option}: {what}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wrong_number_is_told_at_its_option() {
        let given = ContactArgs {
            youngs_modulus: Some(200e3),
            nu: Some(0.3),
            yield_stress: Some(400.0),
            mu: Some(0.3),
            h: Some(0.02),
            equal: false,
        };
        assert_eq!(given.case(&[]).unwrap().unwrap().contact.friction, crate::case::Friction::Coefficient(0.3));
        for (wrong, option) in [
            (ContactArgs { youngs_modulus: Some(-1.0), ..given.clone() }, "--E: is -1"),
            (ContactArgs { nu: Some(0.5), ..given.clone() }, "--nu: is 0.5"),
            (ContactArgs { yield_stress: Some(0.0), ..given.clone() }, "--yield: is 0"),
            (ContactArgs { mu: Some(-0.3), ..given.clone() }, "--mu: is -0.3"),
            (ContactArgs { h: Some(1.0), ..given.clone() }, "--h: is 1"),
        ] {
            let told = wrong.case(&[]).unwrap_err().to_string();
            assert!(told.starts_with(option) && told.contains("Allowed"), "{told}");
        }
        assert!(number("0,3").is_err() && number("nan").is_err() && number("2e5") == Ok(2e5));
    }
}
