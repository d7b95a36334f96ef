//! The mesh: hex8 elements of half the lower hemisphere, connectivity, node-to-element lists and the index hierarchy.
//!
//! Lengths are in sphere radii. The pole is the origin, the rigid plane is z = 0, the centre of the sphere is (0, 0, 1), the symmetry
//! plane is y = 0 and the body fills y >= 0, 0 <= z <= 1.

pub mod pattern;

/// Sparse interpolation from a coarse level's nodes to a fine level's nodes, in rows of (coarse node, weight); the weights of a row sum to 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Prolongation {
    /// Number of coarse nodes (columns).
    pub coarse_nodes: usize,
    /// Row starts, one more than there are fine nodes.
    pub row_start: Vec<u32>,
    /// Coarse node of each entry, increasing within a row.
    pub column: Vec<u32>,
    /// Weight of each entry.
    pub weight: Vec<f64>,
}

/// For every node the elements around it, in increasing element order: the lists by which forces and tangents are gathered.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeElements {
    /// Starts of the nodes' lists, one more than there are nodes.
    pub start: Vec<u32>,
    /// Entries `8 * element + local node`.
    pub entry: Vec<u32>,
}

/// A hex8 mesh with what the solver needs to know of it.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// Reference positions of the nodes.
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of each element in VTK_HEXAHEDRON order.
    pub elements: Vec<[u32; 8]>,
    /// Elements around each node.
    pub node_elements: NodeElements,
    /// Nodes on the surface that can touch the plane, in increasing order.
    pub contact_nodes: Vec<u32>,
    /// Outer faces that can touch the plane, counter-clockwise seen from outside.
    pub contact_faces: Vec<[u32; 4]>,
    /// Nodes that move as the rigid plate (the equator plane).
    pub plate_nodes: Vec<u32>,
    /// Nodes on the symmetry plane y = 0.
    pub symmetry_nodes: Vec<u32>,
    /// Interpolations, finest first; empty if the mesh has no hierarchy.
    pub hierarchy: Vec<Prolongation>,
    /// Contact radius up to which the surface is finely meshed.
    pub fine_radius: f64,
}
