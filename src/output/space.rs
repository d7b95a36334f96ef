//! Where two bodies lie in space: each is computed in its own coordinates (see
//! [`crate::mesh::couple`]), in which the opponent is the mirror image of itself.

use crate::mesh::{Corners, Mesh};

/// The points of a mesh in space, those that hang after the nodes, and its cells.
pub struct Space<'a> {
    mesh: &'a Mesh,
    corners: Corners,
}

impl<'a> Space<'a> {
    /// Of a mesh.
    pub fn new(mesh: &'a Mesh) -> Self {
        Self { mesh, corners: Corners::of(mesh) }
    }

    /// Vectors at the points, or the points' positions, in space, from those at the nodes.
    pub fn vectors(&self, vectors: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let (nodes, from) = (self.mesh.nodes.len(), self.mesh.own_nodes());
        let own = |point: usize| match point.checked_sub(nodes) {
            None => point < from,
            Some(hanging) => self.corners.means[hanging].iter().all(|&n| (n as usize) < from),
        };
        // 0 - z, not -z: what is at rest moves by 0, not -0.
        let placed = |(point, [x, y, z]): (usize, [f64; 3])| if own(point) { [x, y, z] } else { [x, y, 0.0 - z] };
        // Of another number of nodes: the writer says so.
        let extended = if vectors.len() == nodes { self.corners.extended(vectors) } else { vectors.to_vec() };
        extended.into_iter().enumerate().map(placed).collect()
    }

    /// Points of the elements, those of mirrored ones in an order that keeps their volume positive.
    pub fn elements(&self) -> Vec<[u32; 8]> {
        let from = self.mesh.own_elements();
        let turned = |[a, b, c, d, e, f, g, h]: [u32; 8]| [e, f, g, h, a, b, c, d];
        let points = |(e, &points): (usize, &[u32; 8])| if e < from { points } else { turned(points) };
        self.corners.elements.iter().enumerate().map(points).collect()
    }
}

/// Stresses [xx, yy, zz, xy, yz, zx] of the elements in space.
pub fn stresses_in_space(mesh: &Mesh, stresses: &[[f64; 6]]) -> Vec<[f64; 6]> {
    let from = mesh.own_elements();
    let mirrored = |[xx, yy, zz, xy, yz, zx]: [f64; 6]| [xx, yy, zz, xy, 0.0 - yz, 0.0 - zx];
    stresses.iter().enumerate().map(|(e, &stress)| if e < from { stress } else { mirrored(stress) }).collect()
}

/// Body of each element, 0 the sphere, 1 the opponent; `None` if there is one alone.
pub fn bodies(mesh: &Mesh) -> Option<Vec<i32>> {
    let couple = mesh.couple.as_ref()?;
    Some((0..mesh.elements.len()).map(|e| i32::from(e >= couple.element)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{Hanging, SphereSpec, couple, quality, sphere_mesh};

    #[test]
    fn the_opponent_lies_below_and_its_elements_keep_their_volume() {
        for skin_levels in [0, 1] {
            let spec =
                SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 4, fine_zone: 1.3, skin_levels, first_layer: 1.0 };
            let sphere = sphere_mesh(&spec).unwrap();
            let mesh = couple(sphere.clone(), sphere.clone());
            // As meshes whose corners are all nodes.
            let drawn = |mesh: &Mesh| {
                let space = Space::new(mesh);
                let hanging = vec![Hanging::NONE; mesh.elements.len()];
                Mesh { nodes: space.vectors(&mesh.nodes), elements: space.elements(), hanging, ..mesh.clone() }
            };
            let (both, own) = (drawn(&mesh), drawn(&sphere));
            assert_eq!(both.nodes.len(), 2 * own.nodes.len());
            assert_eq!(own.nodes.len() > sphere.nodes.len(), skin_levels > 0);
            let below = |e: usize| both.elements[e].iter().all(|&n| both.nodes[n as usize][2] <= 0.0);
            assert!((0..both.elements.len()).all(|e| below(e) == (e >= sphere.elements.len())));
            assert!((quality::volume(&both) / (2.0 * quality::volume(&sphere)) - 1.0).abs() < 1e-12);
            assert!((0..both.elements.len()).all(|e| quality::scaled_jacobian(&both.corners(e)) > 0.0));
            // One body is where it is.
            assert_eq!(own.nodes[..sphere.nodes.len()], sphere.nodes);
            let apart = |e: usize| {
                let pairs = own.corners(e).into_iter().flatten().zip(sphere.corners(e).into_iter().flatten());
                pairs.fold(0f64, |m, (a, b)| m.max((a - b).abs()))
            };
            assert!((0..own.elements.len()).all(|e| apart(e) < 1e-15));
        }
    }
}
