//! What touches what: the sphere, its material, what it is pressed against, and the friction in
//! between.

use serde::Serialize;

use super::hardening::Hardening;

/// The body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sphere {
    /// Radius R > 0, the unit of length of the path.
    pub radius: f64,
    /// The body is no sphere but a flat: half a ball of radius 2 R, pressed onto its flat face.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub flat: bool,
    /// Whether the plane of the equator may widen.
    pub equator: Equator,
}

/// Whether the equatorial plane, whose nodes move along its normal as one, may widen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Equator {
    /// They move as a rigid plate.
    #[default]
    Clamped,
    /// It widens as the mid-plane of a sphere does that is pressed equally from both sides.
    Free,
}

impl Equator {
    /// Whether the plate is rigid.
    pub fn is_clamped(&self) -> bool {
        *self == Self::Clamped
    }
}

/// An isotropic elastic-plastic material.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Material {
    /// Young's modulus E > 0, in units of stress.
    pub youngs_modulus: f64,
    /// Poisson's ratio nu in (-1, 0.5).
    pub poissons_ratio: f64,
    /// The yield stress as a function of the equivalent plastic strain.
    pub hardening: Hardening,
}

/// The interface between sphere and plane.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Contact {
    /// Friction.
    pub friction: Friction,
}

/// Friction between sphere and plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Friction {
    /// Coulomb's coefficient mu >= 0: tangential traction at most mu times the pressure, at every
    /// point.
    Coefficient(f64),
    /// A point in contact never slips.
    Stick,
}

/// What the sphere is pressed against, in place of a rigid plane.
#[derive(Clone, Debug, PartialEq)]
pub enum Opponent {
    /// The same sphere. Indentation and shear are then the relative displacements of the two
    /// equators, twice what each of them moves.
    Equal,
    /// A rigid sphere.
    Rigid {
        /// Its radius > 0, a length.
        radius: f64,
    },
    /// Another body that deforms, meshed as the sphere is.
    Deforming {
        /// Its radius > 0, a length; `None` for a flat, half a ball of twice the sphere's radius.
        radius: Option<f64>,
        /// What it is made of.
        material: Material,
    },
}
