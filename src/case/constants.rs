//! From a case file's material to the constants that the kernels take.

use super::{Hardening, Material};
use crate::material::{self, Elasticity, MaterialError};
use crate::real::Real;

impl Material {
    /// The material with stresses divided by Young's modulus: E = 1.
    ///
    /// # Errors
    /// [`MaterialError`] for parameters that no law has; the checks of a case file that was read
    /// leave none.
    pub fn constants<R: Real>(&self) -> Result<material::Material<R>, MaterialError> {
        let hardening = self.hardening.scaled(self.youngs_modulus).law(1.0)?;
        Ok(material::Material { elasticity: Elasticity::new(1.0, self.poissons_ratio), hardening })
    }

    /// The material in the unit that its stresses have: its Young's modulus is what it is.
    ///
    /// # Errors
    /// As [`Material::constants`].
    pub fn constants_as_given<R: Real>(&self) -> Result<material::Material<R>, MaterialError> {
        let hardening = self.hardening.law(self.youngs_modulus)?;
        Ok(material::Material { elasticity: Elasticity::new(self.youngs_modulus, self.poissons_ratio), hardening })
    }
}

impl Hardening {
    /// The hardening law; `youngs_modulus` in the unit of its stresses.
    ///
    /// # Errors
    /// [`MaterialError`] for parameters that no law has.
    pub fn law<R: Real>(&self, youngs_modulus: f64) -> Result<material::Hardening<R>, MaterialError> {
        use material::Hardening as Law;
        match *self {
            Hardening::Elastic => Ok(Law::Elastic),
            Hardening::Ideal { yield_stress } => Law::ideal(yield_stress),
            Hardening::Linear { yield_stress, modulus } => Law::linear(yield_stress, modulus),
            Hardening::Power { yield_stress, coefficient, exponent } => Law::power(yield_stress, coefficient, exponent),
            Hardening::Hollomon { coefficient, exponent } => Law::hollomon(coefficient, exponent, youngs_modulus),
            Hardening::Voce { yield_stress, saturation_stress, rate } => Law::voce(yield_stress, saturation_stress, rate),
            Hardening::Table { ref points } => Law::table(points),
        }
    }
}
