//! What the pictures of a case show beside its curves.

use super::super::units::coefficient;
use crate::analytical::ElasticSphere;
use crate::analytical::olsson_larsson::OlssonLarssonHardening;
use crate::case::{self, Case};

/// What the plots show beside the computed curves, in the user's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlotInputs {
    /// The sphere, for Hertz's curve; against a rigid sphere that of radius R*.
    pub sphere: ElasticSphere,
    /// The law for Olsson & Larsson's curve; `None` where theirs has no counterpart.
    pub hardening: Option<OlssonLarssonHardening>,
    /// Coulomb's coefficient for the line that F_T/F_N runs up to; `None` for full stick.
    pub friction: Option<f64>,
    /// Bodies that deform (see [`crate::case::Case::bodies`]): closed forms are of one of them,
    /// over a plane.
    pub bodies: f64,
}

impl PlotInputs {
    /// Those of a case in the user's units. Olsson & Larsson's laws cover ideal, power (k =
    /// K/sigma_Y, m = 1/n), linear (m = 1) and Hollomon.
    pub fn of(case: &Case) -> Self {
        let material = &case.material;
        let three = |yield_stress: f64, coefficient: f64, exponent: f64| OlssonLarssonHardening::ThreeParameter {
            yield_stress,
            coefficient: coefficient / yield_stress,
            exponent,
        };
        let hardening = match material.hardening {
            // Two materials have no law of their own.
            _ if matches!(case.opponent, Some(case::Opponent::Deforming { .. })) => None,
            case::Hardening::Ideal { yield_stress } => Some(OlssonLarssonHardening::Ideal { yield_stress }),
            case::Hardening::Linear { yield_stress, modulus } => Some(three(yield_stress, modulus, 1.0)),
            case::Hardening::Power { yield_stress, coefficient, exponent } => {
                Some(three(yield_stress, coefficient, 1.0 / exponent))
            }
            case::Hardening::Hollomon { coefficient, exponent } => {
                Some(OlssonLarssonHardening::TwoParameter { coefficient, exponent })
            }
            _ => None,
        };
        Self {
            sphere: ElasticSphere {
                radius: case.body_radius(),
                // Of two bodies E*.
                youngs_modulus: material.youngs_modulus / case.compliance()[0],
                poissons_ratio: material.poissons_ratio,
            },
            hardening,
            bodies: case.bodies(),
            friction: coefficient(case.contact.friction),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn olsson_larsson_has_the_stress_of_the_case() {
        let text = |law: &str| {
            format!(
                "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\n{law}\n\
                 [contact]\nfriction = 0.3\n[[path]]\nindentation = 0.02\n"
            )
        };
        for (law, expected) in [
            ("law = \"ideal\"\nyield_stress = 400.0", Some(400.0)),
            ("law = \"linear\"\nyield_stress = 400.0\nmodulus = 1000.0", Some(400.0 + 1000.0 * 0.05)),
            ("law = \"power\"\nyield_stress = 400.0\ncoefficient = 300.0\nexponent = 0.5", Some(400.0 + 300.0 * 0.05f64.sqrt())),
            ("law = \"voce\"\nyield_stress = 400.0\nsaturation_stress = 600.0\nrate = 10.0", None),
        ] {
            let inputs = PlotInputs::of(&Case::parse(&text(law), "case.toml", &[]).unwrap());
            let stress = inputs.hardening.map(|law| law.stress_at_total_strain(200e3, 0.05 + expected.unwrap_or(0.0) / 200e3));
            assert_eq!(stress.is_some(), expected.is_some(), "{law}");
            if let (Some(stress), Some(expected)) = (stress, expected) {
                assert!((stress / expected - 1.0).abs() < 1e-12, "{law}: {stress}");
            }
            assert_eq!(inputs.friction, Some(0.3));
        }
    }
}
