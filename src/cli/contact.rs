//! A contact in a line of options, for commands that otherwise read a case file.

use clap::Args;

use super::input::Input;

/// What a case of one press and one shear needs. `--E` takes the place of the file.
#[derive(Clone, Debug, Args)]
pub struct ContactArgs {
    /// Instead of a case file: Young's modulus of a sphere with radius 1, in any unit of stress.
    #[arg(long = "E", value_name = "E", conflicts_with = "case", requires_all = ["nu", "yield_stress", "mu", "h"])]
    pub youngs_modulus: Option<f64>,
    /// With --E: Poisson's ratio.
    #[arg(long, requires = "youngs_modulus", allow_negative_numbers = true)]
    pub nu: Option<f64>,
    /// With --E: yield stress, in the unit of E; the sphere is ideally plastic.
    #[arg(long = "yield", value_name = "STRESS", requires = "youngs_modulus", allow_negative_numbers = true)]
    pub yield_stress: Option<f64>,
    /// With --E: friction coefficient.
    #[arg(long, requires = "youngs_modulus", allow_negative_numbers = true)]
    pub mu: Option<f64>,
    /// With --E: indentation over R, before the sphere is sheared to full slip.
    #[arg(long, requires = "youngs_modulus", allow_negative_numbers = true)]
    pub h: Option<f64>,
    /// With --E: pressed against an equal sphere, and not a rigid plane.
    #[arg(long, requires = "youngs_modulus")]
    pub equal: bool,
}

impl ContactArgs {
    /// The case that the options describe, or `None` without `--E`.
    pub fn input(&self) -> Option<Input> {
        let [e, nu, stress, mu, h] = [self.youngs_modulus?, self.nu?, self.yield_stress?, self.mu?, self.h?];
        let opponent = if self.equal { "[opponent]\nequal = true\n" } else { "" };
        let text = format!(
            "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = {e:?}\npoissons_ratio = {nu:?}\n\
             [material.hardening]\nlaw = \"ideal\"\nyield_stress = {stress:?}\n[contact]\nfriction = {mu:?}\n\
             {opponent}[[path]]\nindentation = {h:?}\n[[path]]\nshear = \"full-slip\"\n"
        );
        Some(Input { text, name: "the options".to_owned() })
    }
}
