//! Two bodies as one mesh: the sphere and the opponent that deforms.
//!
//! The opponent's nodes, elements and lists follow the sphere's. It has coordinates of its own, in
//! which it lies as the sphere does: its pole is the origin, it fills z >= 0. In space it is the
//! mirror image of that, z to -z. No element touches both bodies, so what is formed from the
//! elements (forces, tangents, patterns) falls into a part for each.

use super::{Couple, Mesh, NodeElements};

/// A mesh with all lengths times `by`.
pub fn scaled(mut mesh: Mesh, by: f64) -> Mesh {
    mesh.nodes.as_flattened_mut().iter_mut().for_each(|x| *x *= by);
    mesh.contact_area.iter_mut().for_each(|area| *area *= by * by);
    mesh.contact_size.iter_mut().for_each(|size| *size *= by);
    mesh.fine_radius *= by;
    mesh
}

/// The mesh of a sphere and its opponent, each in its own coordinates and in the same unit of
/// length.
pub fn couple(sphere: Mesh, opponent: Mesh) -> Mesh {
    let (nodes, elements) = (sphere.nodes.len(), sphere.elements.len());
    let (nodes_before, elements_before) = (nodes as u32, elements as u32);
    let couple = Couple {
        node: nodes,
        element: elements,
        contact: sphere.contact_nodes.len(),
        contact_face: sphere.contact_faces.len(),
        hierarchies: [sphere.hierarchy, opponent.hierarchy],
        halves: [sphere.half, opponent.half],
    };
    let after = |first: Vec<u32>, second: Vec<u32>| -> Vec<u32> {
        first.into_iter().chain(second.into_iter().map(|n| n + nodes_before)).collect()
    };
    let entries = sphere.node_elements.entry.len() as u32;
    let start = sphere.node_elements.start.iter().copied();
    let start = start.chain(opponent.node_elements.start.iter().skip(1).map(|&s| s + entries)).collect();
    let entry = sphere.node_elements.entry.iter().copied();
    let entry = entry.chain(opponent.node_elements.entry.iter().map(|&e| e + 8 * elements_before)).collect();
    Mesh {
        nodes: [sphere.nodes, opponent.nodes].concat(),
        elements: [sphere.elements, opponent.elements.into_iter().map(|e| e.map(|n| n + nodes_before)).collect()].concat(),
        hanging: [sphere.hanging, opponent.hanging].concat(),
        node_elements: NodeElements { start, entry },
        contact_nodes: after(sphere.contact_nodes, opponent.contact_nodes),
        contact_faces: [sphere.contact_faces, opponent.contact_faces.into_iter().map(|f| f.map(|n| n + nodes_before)).collect()]
            .concat(),
        contact_area: [sphere.contact_area, opponent.contact_area].concat(),
        contact_size: [sphere.contact_size, opponent.contact_size].concat(),
        plate_nodes: after(sphere.plate_nodes, opponent.plate_nodes),
        symmetry_nodes: after(sphere.symmetry_nodes, opponent.symmetry_nodes),
        copies: sphere.copies,
        // Each body has its own: see `Couple`.
        hierarchy: Vec::new(),
        half: None,
        fine_radius: sphere.fine_radius.min(opponent.fine_radius),
        couple: Some(Box::new(couple)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::connectivity::node_elements;
    use crate::mesh::{SphereSpec, flat_mesh, sphere_mesh};

    #[test]
    fn two_bodies_are_one_mesh_that_holds_together_in_itself() {
        let spec = |a| SphereSpec {
            contact_radius: a,
            elements_per_contact_radius: 4,
            fine_zone: 1.3,
            skin_levels: 0,
            first_layer: 1.0,
        };
        let (sphere, other) = (sphere_mesh(&spec(0.2)).unwrap(), scaled(sphere_mesh(&spec(0.1)).unwrap(), 2.0));
        let mesh = couple(sphere.clone(), other.clone());
        let parts = mesh.couple.clone().unwrap();
        assert_eq!(mesh.node_elements, node_elements(mesh.nodes.len(), &mesh.elements));
        assert_eq!((parts.node, parts.element), (sphere.nodes.len(), sphere.elements.len()));
        assert!(mesh.contact_nodes.is_sorted() && mesh.plate_nodes.is_sorted() && mesh.symmetry_nodes.is_sorted());
        assert!(mesh.contact_nodes[parts.contact..].iter().all(|&n| parts.body_of(n as usize) == 1));
        assert!(mesh.contact_nodes[..parts.contact].iter().all(|&n| parts.body_of(n as usize) == 0));
        assert_eq!(mesh.contact_area.len(), mesh.contact_nodes.len());
        assert!(mesh.contact_faces[parts.contact_face..].iter().flatten().all(|&n| n as usize >= parts.node));
        // Both are as finely meshed where they meet.
        let finest = |sizes: &[f64]| sizes.iter().copied().fold(f64::INFINITY, f64::min);
        let [a, b] = [&mesh.contact_size[..parts.contact], &mesh.contact_size[parts.contact..]].map(finest);
        assert!((a / b - 1.0).abs() < 0.05, "{a} {b}");
        let flat = couple(sphere, flat_mesh(&spec(0.2)).unwrap());
        assert!(flat.contact_nodes[parts.contact..].iter().all(|&n| flat.nodes[n as usize][2] == 0.0));
    }
}
