//! The sphere's mesh: an O-grid of half the lower hemisphere, graded from the pole; and the same of
//! a flat.

mod butterfly;
mod entry;
mod geometry;
mod layout;
mod skin;
mod spec;
#[cfg(test)]
mod tests;

use super::connectivity::{node_elements, sweep_order};
use super::hierarchy::hierarchy;
use super::{Hanging, Mesh, MeshError, MirrorHalf};
use geometry::Geometry;
use layout::Layout;
pub use layout::{FINE_ZONES, FINEST_SURFACE, FIRST_LAYERS, LARGEST_CONTACT, LARGEST_FINE_RADIUS};
use skin::Skin;
pub use spec::SphereSpec;

/// Contact is watched this many fine radii from the pole. Half and twice of what is over 1:
/// `benches/constants`.
const CONTACT_MARGIN: f64 = 1.3;
/// Smallest a/R that a body is meshed for.
const SMALLEST_CONTACT: f64 = 0.000_5;

/// The mesh of half the lower hemisphere.
///
/// # Errors
/// A value of `spec` out of range.
pub fn sphere_mesh(spec: &SphereSpec) -> Result<Mesh, MeshError> {
    check(spec)?;
    Ok(mesh_of(&Layout::new(spec)?))
}

/// The mesh of the sphere that another, up to ten times smaller, is pressed against: the contact
/// may be as much smaller beside it.
///
/// # Errors
/// A value of `spec` out of range.
pub fn opponent_mesh(spec: &SphereSpec) -> Result<Mesh, MeshError> {
    Ok(mesh_of(&Layout::new(spec)?))
}

/// Refuses contacts that are too small beside the body itself.
fn check(spec: &SphereSpec) -> Result<(), MeshError> {
    if spec.contact_radius < SMALLEST_CONTACT { Err(MeshError::ContactRadius(spec.contact_radius)) } else { Ok(()) }
}

/// The mesh of a flat: half of the half ball |X| <= 2, z >= 0, with the plane z = 0 in place of the
/// sphere's surface and the half sphere |X| = 2 as its plate.
///
/// # Errors
/// A value of `spec` out of range.
pub fn flat_mesh(spec: &SphereSpec) -> Result<Mesh, MeshError> {
    check(spec)?;
    Ok(mesh_of(&Layout::of(spec, true)?))
}

/// Number of elements that [`sphere_mesh`] will make, without making them.
///
/// # Errors
/// A value of `spec` out of range.
pub fn element_count(spec: &SphereSpec) -> Result<usize, MeshError> {
    check(spec)?;
    Ok(skin::element_count(&Layout::new(spec)?))
}

/// The mesh of a layout, its surface nodes moved so that they touch evenly.
fn mesh_of(layout: &Layout) -> Mesh {
    let finest = (0..layout.skin).fold(layout.clone(), |layout, _| layout.halved());
    mesh_with(layout, &finest.touching_evenly())
}

/// The mesh of a layout whose nodes lie where those of its finest level do.
fn mesh_with(layout: &Layout, finest: &Layout) -> Mesh {
    let (blocks, geometry, skin) = (layout.blocks, Geometry::new(finest), Skin::new(layout));
    let nodes = skin.positions(&geometry);
    let (elements, hanging) = skin.elements();
    let order = sweep_order(nodes.len(), &elements);
    let elements: Vec<[u32; 8]> = order.iter().map(|&e| elements[e as usize]).collect();
    let hanging: Vec<Hanging> = order.iter().map(|&e| hanging[e as usize]).collect();

    // Rings that can touch: the fine zone and a margin, but never the equator nor its neighbour.
    let reach = layout.radii[layout.fine_rings] * CONTACT_MARGIN;
    let rings = layout.radii.iter().filter(|&&r| r < reach).count().max(layout.fine_rings + 2).min(blocks.nr - 1);
    let (contact_faces, contact_nodes) = skin.contact(rings);
    let (contact_area, contact_size) = skin.measures(&nodes).at(&contact_nodes);

    let on = |wanted: &dyn Fn(&[f64; 3]) -> bool| -> Vec<u32> {
        (0u32..).zip(&nodes).filter(|(_, x)| wanted(x)).map(|(n, _)| n).collect()
    };
    let (half_nodes, half_levels) = skin.half();
    Mesh {
        node_elements: node_elements(nodes.len(), &elements),
        plate_nodes: (0..).zip(skin.sites()).filter(|(_, site)| geometry.is_on_plate(**site)).map(|(n, _)| n).collect(),
        symmetry_nodes: on(&|x| x[1] == 0.0),
        copies: 2,
        nodes,
        elements,
        hanging,
        contact_nodes,
        contact_faces,
        contact_area,
        contact_size,
        hierarchy: [skin.prolongations(), hierarchy(blocks)].concat(),
        half: Some(MirrorHalf { node: half_nodes, hierarchy: [half_levels, hierarchy(blocks.right_half())].concat() }),
        fine_radius: layout.fine_radius,
        couple: None,
    }
}
