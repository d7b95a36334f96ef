//! The elastic sphere that every closed form takes.

/// An isotropic elastic sphere; the plane it touches is rigid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ElasticSphere {
    /// Radius R.
    pub radius: f64,
    /// Young's modulus E.
    pub youngs_modulus: f64,
    /// Poisson's ratio nu, in \[0, 0.5\].
    pub poissons_ratio: f64,
}

impl ElasticSphere {
    /// The sphere in scaled units, R = 1 and E = 1.
    pub fn unit(poissons_ratio: f64) -> Self {
        Self { radius: 1.0, youngs_modulus: 1.0, poissons_ratio }
    }

    /// Effective modulus E* = E / (1 - nu^2) (Johnson 1985, eq. 4.20, rigid counterpart).
    pub fn effective_modulus(&self) -> f64 {
        self.youngs_modulus / (1.0 - self.poissons_ratio * self.poissons_ratio)
    }

    /// Shear modulus G = E / (2 (1 + nu)).
    pub fn shear_modulus(&self) -> f64 {
        0.5 * self.youngs_modulus / (1.0 + self.poissons_ratio)
    }

    /// Ratio of normal to tangential contact stiffness, kappa = (2 - nu) / (2 (1 - nu)) = 2 E* a /
    /// (8 G a/(2 - nu)) (Mindlin 1949).
    pub fn stiffness_ratio(&self) -> f64 {
        (2.0 - self.poissons_ratio) / (2.0 * (1.0 - self.poissons_ratio))
    }

    /// Dundurs' second constant against a rigid plane, beta = (1 - 2 nu) / (2 (1 - nu)): the
    /// coupling between normal and tangential problem that Hertz and Cattaneo-Mindlin neglect;
    /// 0.286 at nu = 0.3, zero only at nu = 0.5.
    pub fn dundurs_beta(&self) -> f64 {
        (1.0 - 2.0 * self.poissons_ratio) / (2.0 * (1.0 - self.poissons_ratio))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derived_constants() {
        let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };
        assert!((sphere.effective_modulus() - 219_780.219_78).abs() < 1e-4);
        assert!((sphere.shear_modulus() - 76_923.076_92).abs() < 1e-4);
        assert!((sphere.dundurs_beta() - 0.2857).abs() < 1e-4);
        let normal_over_tangential = 2.0 * sphere.effective_modulus() / (8.0 * sphere.shear_modulus() / 1.7);
        assert!((sphere.stiffness_ratio() / normal_over_tangential - 1.0).abs() < 1e-14);
    }
}
