//! From a case file's material to the constants that the kernels take.

use super::Material;
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
