//! The case in units in which R = 1 and E = 1, as one body sees it.

use serde::{Deserialize, Serialize};

use super::{Case, Contact, Material, Mesh, Motion, Opponent, Segment, ShearTarget, Sphere};

/// Lengths over R, stresses over E, forces over E R^2, energies over E R^3, of one body. It is no
/// `T`, and none is made of it unseen: what is in the user's units is not taken for what is scaled,
/// nor the other way round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Scaled<T>(pub T);

impl Case {
    /// A copy with lengths divided by R and stresses by E: R = 1, E = 1, forces in units of E R^2.
    /// Indentation, shear and angles are what one body moves: in an equal pair half of the relative
    /// motion, so the copy of one is not to be scaled again. The opponent is scaled too.
    pub fn scaled(&self) -> Scaled<Case> {
        let (radius, modulus) = (self.sphere.radius, self.material.youngs_modulus);
        let bodies = self.bodies();
        let travel = radius * bodies;
        let segment = |segment: &Segment| match *segment {
            Segment::Indentation { indentation } => Segment::Indentation { indentation: indentation / travel },
            Segment::Shear { shear: ShearTarget::Displacement(delta), hold } => {
                Segment::Shear { shear: ShearTarget::Displacement(delta / travel), hold }
            }
            Segment::Oblique { indentation, shear } => {
                Segment::Oblique { indentation: indentation / travel, shear: shear / travel }
            }
            Segment::Motion { to, hold } => Segment::Motion {
                to: Motion {
                    indentation: to.indentation.map(|h| h / travel),
                    shear: to.shear.map(|delta| delta.map(|delta| delta / travel)),
                    roll: to.roll.map(|roll| roll.map(|angle| angle / bodies)),
                    twist: to.twist.map(|twist| twist / bodies),
                },
                hold,
            },
            Segment::Release { .. } | Segment::Slip { .. } | Segment::Shear { shear: ShearTarget::FullSlip, .. } => *segment,
        };
        Scaled(Case {
            sphere: Sphere { radius: 1.0, ..self.sphere.clone() },
            material: Material {
                youngs_modulus: 1.0,
                poissons_ratio: self.material.poissons_ratio,
                hardening: self.material.hardening.scaled(modulus),
            },
            contact: Contact { friction: self.contact.friction },
            opponent: match self.opponent {
                Some(Opponent::Rigid { radius: other }) => Some(Opponent::Rigid { radius: other / radius }),
                Some(Opponent::Deforming { radius: other, ref material }) => Some(Opponent::Deforming {
                    radius: other.map(|other| other / radius),
                    material: Material {
                        youngs_modulus: material.youngs_modulus / modulus,
                        poissons_ratio: material.poissons_ratio,
                        hardening: material.hardening.scaled(modulus),
                    },
                }),
                // Both are meshed.
                Some(Opponent::Equal) if self.image().is_none() => Some(Opponent::Deforming {
                    radius: Some(1.0),
                    material: Material {
                        youngs_modulus: 1.0,
                        poissons_ratio: self.material.poissons_ratio,
                        hardening: self.material.hardening.scaled(modulus),
                    },
                }),
                Some(Opponent::Equal) => Some(Opponent::Equal),
                None => None,
            },
            mesh: Mesh { contact_radius: self.mesh.contact_radius.map(|a| a / radius), ..self.mesh.clone() },
            solver: self.solver.clone(),
            output: self.output.clone(),
            units: self.units.clone(),
            path: self.path.iter().map(segment).collect(),
        })
    }
}
