//! The normalised variables in which contacts of any hardening law fall together: sigma_rep,
//! Lambda, Hbar, c^2.
//!
//! The formulas are those of [`crate::analytical::johnson`] (Johnson 1970; Olsson & Larsson 2014,
//! eqs 1 and 2); here they are evaluated for the hardening law of a case.

use crate::analytical::olsson_larsson::plastic_share;
use crate::analytical::{ElasticSphere, johnson, yielding};
use crate::case::{self, Case};
use crate::material::{FlowStress, MaterialError};

/// What a sphere is made of: all that its axisymmetric contact depends on. Any one consistent
/// system of units.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// R, E, nu.
    pub sphere: ElasticSphere,
    /// sigma(eps_p), in the unit of E.
    pub hardening: FlowStress<f64>,
}

/// The normalised variables of one contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Variables {
    /// sigma_rep, stress: the flow stress at the representative strain 0.2 a/R, never below
    /// sigma_Y; infinite for an elastic sphere.
    pub sigma_rep: f64,
    /// Johnson's parameter Lambda = E a/((1 - nu^2) sigma_rep R); 0 for an elastic sphere.
    pub lambda: f64,
    /// Normalised hardness Hbar = F_N/(pi a^2 sigma_rep); 0 for an elastic sphere.
    pub hardness: f64,
    /// c^2 = a^2/(2 R h): 1/2 for Hertz, 1.43 for a fully plastic contact without hardening.
    pub c_squared: f64,
}

impl Body {
    /// The sphere of a case, in the case's units; against a rigid sphere one of radius R*.
    ///
    /// # Errors
    /// A hardening law whose numbers make no law.
    pub fn from_case(case: &Case) -> Result<Self, MaterialError> {
        Self::new(case.body_radius(), &case.material)
    }

    /// A sphere of the radius R of a case file's material.
    ///
    /// # Errors
    /// As [`from_case`](Self::from_case).
    pub fn new(radius: f64, material: &case::Material) -> Result<Self, MaterialError> {
        let (youngs_modulus, poissons_ratio) = (material.youngs_modulus, material.poissons_ratio);
        Ok(Self {
            sphere: ElasticSphere { radius, youngs_modulus, poissons_ratio },
            hardening: material.hardening.law(youngs_modulus)?,
        })
    }

    /// Whether the sphere never yields.
    pub fn is_elastic(&self) -> bool {
        matches!(self.hardening, FlowStress::Elastic)
    }

    /// sigma_rep at the contact radius `a`: the flow stress at the total strain eps_rep = 0.2 a/R
    /// (Tabor 1951), split as eps = eps_p + sigma/E; sigma_Y while eps_rep E < sigma_Y (Olsson &
    /// Larsson 2016). Continuous in `a` and not decreasing. Infinite for an elastic sphere.
    pub fn representative_stress(&self, a: f64) -> f64 {
        if self.is_elastic() {
            return f64::INFINITY;
        }
        let flow = |plastic: f64| self.hardening.flow_stress(plastic);
        flow(plastic_share(self.sphere.youngs_modulus, johnson::representative_strain(&self.sphere, a), flow))
    }

    /// Lambda at the contact radius `a`.
    pub fn lambda(&self, a: f64) -> f64 {
        johnson::lambda(&self.sphere, self.representative_stress(a), a)
    }

    /// All of them, for the contact radius `a` at the indentation `h` under the normal force `f_n`.
    pub fn variables(&self, h: f64, a: f64, f_n: f64) -> Variables {
        let sigma_rep = self.representative_stress(a);
        Variables {
            sigma_rep,
            lambda: johnson::lambda(&self.sphere, sigma_rep, a),
            hardness: johnson::normalized_hardness(f_n, sigma_rep, a),
            c_squared: c_squared(self.sphere.radius, h, a),
        }
    }

    /// Local hardening exponent d ln sigma/d ln eps_p, as the secant over two octaves, at the
    /// representative strain of `a`; in \[0, 1\], 0 for an elastic and for an ideally plastic
    /// sphere. It is the 1/m of the closed forms.
    pub fn hardening_exponent(&self, a: f64) -> f64 {
        if self.is_elastic() {
            return 0.0;
        }
        let flow = |plastic: f64| self.hardening.flow_stress(plastic);
        let plastic = plastic_share(self.sphere.youngs_modulus, johnson::representative_strain(&self.sphere, a), flow);
        ((flow(plastic) / flow(0.25 * plastic)).ln() / 4f64.ln()).clamp(0.0, 1.0)
    }
}

/// c^2 = a^2/(2 R h) of a sphere of the radius `radius`.
pub fn c_squared(radius: f64, h: f64, a: f64) -> f64 {
    a * a / (2.0 * radius * h)
}

/// Lambda at first yield under Hertz's pressure: 2.533 at nu = 0.3. Below it every correction of
/// the law is exactly none.
pub fn yield_lambda(nu: f64) -> f64 {
    yielding::first_yield(nu).lambda()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytical::{hertz, olsson_larsson};

    const E: f64 = 200e3;

    fn body(hardening: case::Hardening) -> Body {
        Body::new(2.0, &case::Material { youngs_modulus: E, poissons_ratio: 0.3, hardening }).unwrap()
    }

    fn laws() -> Vec<case::Hardening> {
        vec![
            case::Hardening::Ideal { yield_stress: 400.0 },
            case::Hardening::Linear { yield_stress: 300.0, modulus: 2000.0 },
            case::Hardening::Power { yield_stress: 200.0, coefficient: 800.0, exponent: 0.3 },
            case::Hardening::Hollomon { coefficient: 1200.0, exponent: 4.0 },
            case::Hardening::Voce { yield_stress: 200.0, saturation_stress: 500.0, rate: 20.0 },
            case::Hardening::Table { points: vec![[0.0, 250.0], [0.02, 450.0]] },
        ]
    }

    #[test]
    fn sigma_rep_is_never_below_yield_and_never_jumps() {
        for law in laws() {
            let yield_stress = law.yield_stress(E).unwrap();
            let body = body(law.clone());
            let mut last = yield_stress;
            for i in 0..4000 {
                let a = 2e-4 * (i as f64 * 2e-3).exp();
                let now = body.representative_stress(a);
                assert!(now >= last * (1.0 - 1e-12) && now < last * 1.1, "{law:?} at a = {a}: {now} after {last}");
                last = now;
            }
            assert!((body.representative_stress(1e-6) / yield_stress - 1.0).abs() < 1e-15, "{law:?}");
        }
    }

    #[test]
    fn the_closed_forms_have_the_same_sigma_rep() {
        let sphere = ElasticSphere { radius: 2.0, youngs_modulus: E, poissons_ratio: 0.3 };
        let pairs = [
            (laws()[0].clone(), olsson_larsson::OlssonLarssonHardening::Ideal { yield_stress: 400.0 }),
            // sigma_Y (1 + k eps_p^(1/m)) and sigma_Y + K eps_p^n.
            (
                laws()[2].clone(),
                olsson_larsson::OlssonLarssonHardening::ThreeParameter {
                    yield_stress: 200.0,
                    coefficient: 4.0,
                    exponent: 1.0 / 0.3,
                },
            ),
            (laws()[3].clone(), olsson_larsson::OlssonLarssonHardening::TwoParameter { coefficient: 1200.0, exponent: 4.0 }),
        ];
        for (law, hardening) in pairs {
            let closed = olsson_larsson::OlssonLarsson { sphere, hardening };
            for a in [0.001, 0.02, 0.1, 0.5] {
                let (ours, theirs) = (body(law.clone()).representative_stress(a), closed.representative_stress(a));
                assert!((ours / theirs - 1.0).abs() < 1e-10, "{law:?} at {a}: {ours} and {theirs}");
            }
        }
    }

    #[test]
    fn hertz_at_first_yield() {
        let body = body(case::Hardening::Ideal { yield_stress: 400.0 });
        let a = yield_lambda(0.3) * 400.0 * 2.0 / body.sphere.effective_modulus();
        let h = a * a / 2.0;
        let at_yield = body.variables(h, a, hertz::force(&body.sphere, h));
        assert!((at_yield.lambda - 2.533).abs() < 5e-4 && (at_yield.c_squared - 0.5).abs() < 1e-14);
        assert!((at_yield.hardness / johnson::elastic_hardness(at_yield.lambda) - 1.0).abs() < 1e-13);
    }

    #[test]
    fn an_elastic_sphere_has_lambda_zero() {
        let body = body(case::Hardening::Elastic);
        let variables = body.variables(0.01, 0.1, 5.0);
        assert_eq!((variables.lambda, variables.hardness, variables.sigma_rep), (0.0, 0.0, f64::INFINITY));
        assert_eq!(body.hardening_exponent(0.1), 0.0);
    }

    #[test]
    fn the_hardening_exponent_of_each_law() {
        assert_eq!(body(laws()[0].clone()).hardening_exponent(0.2), 0.0);
        // Far beyond yield the exponent of a Hollomon law is 1/m
        assert!((body(laws()[3].clone()).hardening_exponent(0.5) - 0.25).abs() < 0.03);
        for law in laws() {
            assert!((0.0..=1.0).contains(&body(law.clone()).hardening_exponent(0.1)), "{law:?}");
        }
    }
}
