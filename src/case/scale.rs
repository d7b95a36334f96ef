//! The case in units in which R = 1 and E = 1.

use super::{Case, Contact, Material, Mesh, Segment, ShearTarget, Sphere};

impl Case {
    /// A copy with lengths divided by R and stresses by E: R = 1, E = 1, forces in units of E R^2.
    pub fn scaled(&self) -> Case {
        let (radius, modulus) = (self.sphere.radius, self.material.youngs_modulus);
        let segment = |segment: &Segment| match *segment {
            Segment::Indentation { indentation } => Segment::Indentation { indentation: indentation / radius },
            Segment::Shear { shear: ShearTarget::Displacement(delta), hold } => {
                Segment::Shear { shear: ShearTarget::Displacement(delta / radius), hold }
            }
            Segment::Oblique { indentation, shear } => {
                Segment::Oblique { indentation: indentation / radius, shear: shear / radius }
            }
            unscaled => unscaled,
        };
        Case {
            sphere: Sphere { radius: 1.0 },
            material: Material {
                youngs_modulus: 1.0,
                poissons_ratio: self.material.poissons_ratio,
                hardening: self.material.hardening.scaled(modulus),
            },
            contact: Contact { friction: self.contact.friction },
            mesh: Mesh { contact_radius: self.mesh.contact_radius.map(|a| a / radius), ..self.mesh.clone() },
            solver: self.solver.clone(),
            output: self.output.clone(),
            path: self.path.iter().map(segment).collect(),
        }
    }
}
