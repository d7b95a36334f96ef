//! What a mesh is asked for.

/// Description of the mesh of a sphere, or of a flat, with lengths in radii.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereSpec {
    /// Predicted contact radius a/R, 0.0005 to 0.65.
    pub contact_radius: f64,
    /// Elements from the pole to the contact radius, 2 to 32.
    pub elements_per_contact_radius: usize,
    /// Radius of the finely meshed surface in contact radii, 1.1 to 3; capped at 0.85 sphere radii.
    pub fine_zone: f64,
    /// How many times the elements at its surface are halved again, in all directions (see `skin`).
    pub skin_levels: usize,
    /// Thickness under the pole of the first layer of elements over their width, 0.5 to 1.5; of a
    /// halved layer too.
    pub first_layer: f64,
}
