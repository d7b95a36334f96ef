//! The rigid plane z = 0: gap and slip of a surface point.

use crate::real::Real;

/// Gap g = z of the current position; negative when the point has passed the plane.
///
/// `reference_z` is the reference height, computed without cancellation by the mesh;
/// `displacement_z` the displacement.
#[inline(always)]
pub fn gap<R: Real>(reference_z: R, displacement_z: R) -> R {
    reference_z + displacement_z
}

/// Slip du_t = u_t - u_t,n: tangential displacement over the plane since the start of the step.
#[inline(always)]
pub fn slip<R: Real>(displacement: [R; 2], step_start: [R; 2]) -> [R; 2] {
    [displacement[0] - step_start[0], displacement[1] - step_start[1]]
}
