//! What the sphere of a table meets, and the elastic contact that the two make.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::analytical::ElasticSphere;
use crate::case::{Case, Material, Opponent};
use crate::law::variables::yield_lambda;
use crate::material::{FlowStress, MaterialError};

/// What the sphere of a table meets. Its radius and its material are in the table's case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Against {
    /// A rigid plane.
    #[serde(rename = "plane")]
    Plane,
    /// A sphere like itself; h and delta_T are then relative displacements, twice what each of the
    /// two moves.
    #[serde(rename = "equal pair")]
    EqualSphere,
    /// A rigid sphere.
    #[serde(rename = "rigid sphere")]
    RigidSphere,
    /// Another sphere that deforms; h and delta_T are relative displacements.
    #[serde(rename = "pair")]
    OtherSphere,
    /// A flat that deforms.
    #[serde(rename = "flat")]
    Flat,
}

impl Against {
    /// What the sphere of a case meets.
    pub fn of(case: &Case) -> Self {
        match &case.opponent {
            None => Self::Plane,
            Some(Opponent::Equal) => Self::EqualSphere,
            Some(Opponent::Rigid { .. }) => Self::RigidSphere,
            Some(Opponent::Deforming { radius: None, .. }) => Self::Flat,
            Some(Opponent::Deforming { .. }) => Self::OtherSphere,
        }
    }

    /// Its name in files, one word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Plane => "plane",
            Self::EqualSphere => "equal-pair",
            Self::RigidSphere => "rigid-sphere",
            Self::OtherSphere => "pair",
            Self::Flat => "flat",
        }
    }
}

impl fmt::Display for Against {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Plane => "a rigid plane",
            Self::EqualSphere => "an equal sphere",
            Self::RigidSphere => "a rigid sphere",
            Self::OtherSphere => "another sphere",
            Self::Flat => "a flat that deforms",
        })
    }
}

/// Whether the contact of a case is one of a sphere with a flat surface, whichever of the two is
/// flat: a wall's.
pub fn is_on_a_flat(case: &Case) -> bool {
    case.sphere.flat || matches!(case.opponent, None | Some(Opponent::Deforming { radius: None, .. }))
}

/// The bodies of a case that deform: their materials.
fn bodies(case: &Case) -> impl Iterator<Item = &Material> {
    let other = match &case.opponent {
        Some(Opponent::Deforming { material, .. }) => Some(material),
        _ => None,
    };
    std::iter::once(&case.material).chain(other)
}

/// The sphere that makes the same elastic contact on a rigid plane as the bodies of a case do: its
/// radius is R*, its effective modulus E*, and its tangential stiffness that of both in series
/// (Johnson 1985, sections 4.2 and 7.2), which is what its Poisson's ratio is chosen for. Two equal
/// bodies have R/2 and E/2.
pub fn equivalent(case: &Case) -> ElasticSphere {
    let Material { youngs_modulus, poissons_ratio, .. } = case.material;
    let [normal, tangential] = case.compliance().map(|one| case.bodies() * one);
    let effective_modulus = youngs_modulus / ((1.0 - poissons_ratio * poissons_ratio) * normal);
    // Of one body, tangential over normal compliance is (2 - nu)/(2 (1 - nu)).
    let ratio = (2.0 - poissons_ratio) / (1.0 - poissons_ratio) * tangential / normal;
    let same = if tangential == normal { poissons_ratio } else { (ratio - 2.0) / (ratio - 1.0) };
    ElasticSphere {
        radius: case.effective_radius(),
        youngs_modulus: effective_modulus * (1.0 - same * same),
        poissons_ratio: same,
    }
}

/// h at first yield, in the case's units: of the body that yields first, Hertz's pressure in the
/// contact of both being known. `None` where nothing yields.
///
/// # Errors
/// A hardening law whose numbers make no law.
pub fn indentation_at_first_yield(case: &Case) -> Result<Option<f64>, MaterialError> {
    let sphere = equivalent(case);
    let mut first: Option<f64> = None;
    for material in bodies(case) {
        let hardening = material.hardening.law(material.youngs_modulus)?;
        if matches!(hardening, FlowStress::Elastic) {
            continue;
        }
        let a = yield_lambda(material.poissons_ratio) * hardening.flow_stress(0.0) * sphere.radius / sphere.effective_modulus();
        let h = a * a / sphere.radius;
        first = Some(first.map_or(h, |before: f64| before.min(h)));
    }
    Ok(first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytical::cattaneo_mindlin::initial_stiffness;

    fn case(opponent: &str) -> Case {
        let text = format!(
            "[sphere]\nradius = 2.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n\
             [material.hardening]\nlaw = \"ideal\"\nyield_stress = 400.0\n[contact]\nfriction = 0.3\n{opponent}\n\
             [[path]]\nindentation = 0.002\n"
        );
        Case::parse(&text, "case.toml", &[]).unwrap()
    }

    fn close(a: f64, b: f64) -> bool {
        (a / b - 1.0).abs() < 1e-12
    }

    #[test]
    fn two_bodies_are_in_series() {
        let other = |radius: &str| {
            format!(
                "[opponent]\n{radius}\n[opponent.material]\nyoungs_modulus = 70e3\npoissons_ratio = 0.42\n\
                 [opponent.material.hardening]\nlaw = \"ideal\"\nyield_stress = 100.0"
            )
        };
        let pair = case(&other("radius = 3.0"));
        let both = equivalent(&pair);
        assert!(close(both.radius, 1.2), "{both:?}");
        let (own, soft) = (
            ElasticSphere { radius: 2.0, youngs_modulus: 200e3, poissons_ratio: 0.3 },
            ElasticSphere { radius: 3.0, youngs_modulus: 70e3, poissons_ratio: 0.42 },
        );
        let series = |a: f64, b: f64| 1.0 / (1.0 / a + 1.0 / b);
        assert!(close(both.effective_modulus(), series(own.effective_modulus(), soft.effective_modulus())));
        let stiffness = |sphere: &ElasticSphere| initial_stiffness(sphere, 0.1);
        assert!(close(stiffness(&both), series(stiffness(&own), stiffness(&soft))));
        // The soft one yields, at 1/4 of the stress and so at 1/16 of the depth.
        let soft_only = |stress: f64| {
            let lambda = yield_lambda(0.42);
            let a = lambda * stress * both.radius / both.effective_modulus();
            a * a / both.radius
        };
        assert!(close(indentation_at_first_yield(&pair).unwrap().unwrap(), soft_only(100.0)));
        let flat = equivalent(&case(&other("flat = true")));
        assert!(close(flat.radius, 2.0) && close(flat.effective_modulus(), both.effective_modulus()));
    }

    #[test]
    fn an_equal_pair_is_half_as_stiff_and_yields_at_twice_the_depth() {
        let (one, two) = (case(""), case("[opponent]\nequal = true"));
        let (plane, pair) = (equivalent(&one), equivalent(&two));
        assert_eq!([pair.radius, pair.youngs_modulus, pair.poissons_ratio], [1.0, 100e3, 0.3]);
        assert_eq!([plane.radius, plane.poissons_ratio], [2.0, 0.3]);
        assert!(close(plane.youngs_modulus, 200e3), "{plane:?}");
        assert!(close(
            indentation_at_first_yield(&two).unwrap().unwrap(),
            2.0 * indentation_at_first_yield(&one).unwrap().unwrap()
        ));
        let rigid = case("[opponent]\nrigid = true\nradius = 2.0");
        assert_eq!(equivalent(&rigid).radius, 1.0);
        assert!(close(equivalent(&rigid).youngs_modulus, 200e3));
    }

    #[test]
    fn a_wall_is_flat_on_either_side() {
        assert!(is_on_a_flat(&case("")) && is_on_a_flat(&case("[opponent]\nflat = true")));
        assert!(!is_on_a_flat(&case("[opponent]\nequal = true")) && !is_on_a_flat(&case("[opponent]\nradius = 3.0")));
    }
}
