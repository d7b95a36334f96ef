//! Where two bodies lie in space: each is computed in its own coordinates (see
//! [`crate::mesh::couple`]), in which the opponent is the mirror image of itself.

use crate::mesh::Mesh;

/// Vectors at the nodes, or the nodes' positions, in space.
pub fn vectors_in_space(mesh: &Mesh, vectors: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let from = mesh.own_nodes();
    // 0 - z, not -z: what is at rest moves by 0, not -0.
    vectors.iter().enumerate().map(|(n, &[x, y, z])| if n < from { [x, y, z] } else { [x, y, 0.0 - z] }).collect()
}

/// Nodes of the elements, those of mirrored ones in an order that keeps their volume positive.
pub fn elements_in_space(mesh: &Mesh) -> Vec<[u32; 8]> {
    let from = mesh.own_elements();
    let turned = |[a, b, c, d, e, f, g, h]: [u32; 8]| [e, f, g, h, a, b, c, d];
    mesh.elements.iter().enumerate().map(|(e, &nodes)| if e < from { nodes } else { turned(nodes) }).collect()
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
    use crate::mesh::{SphereSpec, couple, quality, sphere_mesh};

    #[test]
    fn the_opponent_lies_below_and_its_elements_keep_their_volume() {
        let sphere = sphere_mesh(&SphereSpec { contact_radius: 0.2, elements_per_contact_radius: 4, fine_zone: 1.3 }).unwrap();
        let mesh = couple(sphere.clone(), sphere.clone());
        let nodes = vectors_in_space(&mesh, &mesh.nodes);
        let from = sphere.nodes.len();
        assert!(nodes[..from].iter().all(|x| x[2] >= 0.0) && nodes[from..].iter().all(|x| x[2] <= 0.0));
        let space = Mesh { nodes, elements: elements_in_space(&mesh), ..mesh.clone() };
        assert!((quality::volume(&space) / (2.0 * quality::volume(&sphere)) - 1.0).abs() < 1e-12);
        assert!((0..space.elements.len()).all(|e| quality::scaled_jacobian(&quality::corners(&space, e)) > 0.0));
        // One body is where it is.
        assert_eq!(
            (vectors_in_space(&sphere, &sphere.nodes), elements_in_space(&sphere)),
            (sphere.nodes.clone(), sphere.elements.clone())
        );
        assert_eq!(
            (bodies(&sphere), bodies(&mesh).map(|bodies| bodies.iter().sum::<i32>() as usize)),
            (None, Some(sphere.elements.len()))
        );
    }
}
