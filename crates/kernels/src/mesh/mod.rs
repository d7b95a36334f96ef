//! The mesh: hex8 elements of half the lower hemisphere, or of all of it, connectivity,
//! node-to-element lists and the index hierarchy.
//!
//! Lengths are in sphere radii. The pole is the origin, the rigid plane is z = 0, the centre of the
//! sphere is (0, 0, 1), the symmetry plane is y = 0 and the body fills y >= 0, 0 <= z <= 1. A flat
//! is half of a half ball of radius 2 about the origin.
//!
//! `sphere` builds the body, `brick` a box for tests. Both lay logical blocks of cells
//! (`hierarchy`) whose indices give the numbering, the coordinates and the multigrid levels;
//! `connectivity` derives lists and areas, `quality` measures elements, `whole` joins a half with
//! its mirror image, `couple` makes one mesh of two bodies.

pub mod brick;
pub mod connectivity;
mod corners;
pub mod couple;
pub mod hanging;
pub mod hierarchy;
mod parts;
pub mod pattern;
pub mod quality;
pub mod sphere;
pub mod whole;

pub use brick::brick;
pub use connectivity::NodeElements;
pub use corners::Corners;
pub use couple::couple;
pub use hanging::Hanging;
pub use hierarchy::Prolongation;
pub use parts::{Couple, MirrorHalf};
pub use sphere::{
    FINE_ZONES, FINEST_SURFACE, FIRST_LAYERS, LARGEST_CONTACT, LARGEST_FINE_RADIUS, SphereSpec, element_count, flat_mesh,
    opponent_mesh, sphere_mesh,
};
pub use whole::whole;

/// What is wrong with the description of a mesh, and what to do about it.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// The predicted contact radius is outside the range for which the sphere's mesh is built.
    #[error("contact radius a/R = {0} is outside 0.0005 to 0.65: change the indentation, or the estimate of the contact radius")]
    ContactRadius(f64),
    /// The number of elements per contact radius is out of range.
    #[error("elements_per_contact_radius = {0} is outside 2 to 32: 16 is a good start")]
    ElementsPerContactRadius(usize),
    /// The surface would have too many elements per contact radius.
    #[error("a surface halved {0} times is finer than 64 elements per contact radius: halve it once or twice")]
    SkinLevels(usize),
    /// The fine zone is out of range.
    #[error("a fine zone of {0} contact radii is outside 1.1 to 3: 1.3 is a good start")]
    FineZone(f64),
    /// Thickness of the first layer.
    #[error("a first layer of {0} times the elements' width is outside 0.5 to 1.5")]
    FirstLayer(f64),
    /// A brick without cells, without extent, or with more nodes than 32-bit numbers can count.
    #[error(
        "a brick of {cells:?} cells and lengths {lengths:?} cannot be meshed: each count must be at least 1, each length positive \
         and finite, and the nodes fewer than 500 million"
    )]
    Brick {
        /// Cells along x, y, z.
        cells: [usize; 3],
        /// Edge lengths along x, y, z.
        lengths: [f64; 3],
    },
}

/// A hex8 mesh with what the solver needs to know of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Reference positions of the nodes.
    pub nodes: Vec<[f64; 3]>,
    /// Nodes of each element in VTK_HEXAHEDRON order; where a corner hangs, its carrier (see
    /// `hanging`). [`Mesh::corners`] has where the corners are.
    pub elements: Vec<[u32; 8]>,
    /// Corners of each element that hang.
    pub hanging: Vec<Hanging>,
    /// Elements around each node.
    pub node_elements: NodeElements,
    /// Nodes on the surface that can touch the plane, in increasing order.
    pub contact_nodes: Vec<u32>,
    /// Outer faces that can touch the plane, counter-clockwise seen from outside.
    pub contact_faces: Vec<[u32; 4]>,
    /// Reference area tributary to each contact node (the integral of its shape function over the
    /// surface); of the meshed half only, so that a node on the symmetry plane has half of what the
    /// whole sphere would give it. In the order of `contact_nodes`.
    pub contact_area: Vec<f64>,
    /// Local element size at each contact node, the root of the mean area of the surface faces
    /// around it; in the order of `contact_nodes`.
    pub contact_size: Vec<f64>,
    /// Nodes that move as the rigid plate (the equator plane), in increasing order.
    pub plate_nodes: Vec<u32>,
    /// Nodes on the symmetry plane y = 0, in increasing order; none of a whole body.
    pub symmetry_nodes: Vec<u32>,
    /// How many of it make the body: 2 of a half, 1 of all of it. Forces and energies of the body
    /// are so many times those of the mesh.
    pub copies: usize,
    /// Interpolations, finest first; empty if the mesh has no hierarchy.
    pub hierarchy: Vec<Prolongation>,
    /// The half at x >= 0, if no element crosses x = 0.
    pub half: Option<MirrorHalf>,
    /// Contact radius up to which the surface is finely meshed.
    pub fine_radius: f64,
    /// Where the opponent begins, if the mesh is of two bodies.
    pub couple: Option<Box<Couple>>,
}

impl Mesh {
    /// Reference positions of an element's corners.
    #[inline]
    pub fn corners(&self, element: usize) -> [[f64; 3]; 8] {
        let mut corners = self.elements[element].map(|n| self.nodes[n as usize]);
        let hanging = self.hanging[element];
        if !hanging.is_none() {
            hanging.to_corners(&mut corners);
        }
        corners
    }

    /// Whether a node lies on the symmetry plane, across which the other half of the body pulls.
    #[inline]
    pub fn is_on_symmetry_plane(&self, node: u32) -> bool {
        self.copies == 2 && self.nodes[node as usize][1] == 0.0
    }

    /// Number of nodes of the sphere: those of an opponent that deforms come after them.
    pub fn own_nodes(&self) -> usize {
        self.couple.as_ref().map_or(self.nodes.len(), |couple| couple.node)
    }

    /// Number of elements of the sphere, likewise.
    pub fn own_elements(&self) -> usize {
        self.couple.as_ref().map_or(self.elements.len(), |couple| couple.element)
    }

    /// Number of contact nodes of the sphere, likewise.
    pub fn own_contacts(&self) -> usize {
        self.couple.as_ref().map_or(self.contact_nodes.len(), |couple| couple.contact)
    }
}
