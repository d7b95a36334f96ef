//! How large a case is, before it is meshed.

use super::Case;
use super::error::CaseError;
use super::reader::Reader;

/// Memory of an element with its share of the linear systems, in bytes: the 3x3 blocks in f64, their multigrid levels in f32,
/// the Krylov basis and the state at the quadrature points.
pub const BYTES_PER_ELEMENT: f64 = 10_000.0;

const GIB: f64 = 1024.0 * 1024.0 * 1024.0;

/// An estimate of the number of elements of the case's mesh, from its keys alone.
///
/// Elements grow with the square of their number n along the fine radius, that is `fine_zone * elements_per_contact_radius`: the
/// contact radius itself hardly matters, as the grading towards the equator adds few layers. 31.4 n^2 gives 3,400 elements at 8
/// per contact radius and 13,600 at 16 (fine zone 1.3), where O-grids of this kind had 3,264 and 13,566.
pub fn estimated_elements(case: &Case) -> usize {
    let along_fine_radius = case.mesh.fine_zone * case.mesh.elements_per_contact_radius as f64;
    (31.4 * along_fine_radius * along_fine_radius).ceil() as usize
}

/// An estimate of the memory that the case's simulation takes, in GiB.
pub fn estimated_memory(case: &Case) -> f64 {
    estimated_elements(case) as f64 * BYTES_PER_ELEMENT / GIB
}

/// Refuses a case whose mesh would take more than `solver.max_memory_gib`.
pub(super) fn check_memory(case: &Case, root: &Reader<'_>) -> Result<(), CaseError> {
    let (needed, available) = (estimated_memory(case), case.solver.max_memory_gib);
    if needed <= available {
        return Ok(());
    }
    let mesh = root.table("mesh")?;
    let takes = format!("a mesh of about {} elements takes about {needed:.2} GiB", estimated_elements(case));
    let allowed = "fewer mesh.elements_per_contact_radius, a smaller mesh.fine_zone, or a larger solver.max_memory_gib";
    // Named is what the user gave: the limit, or else the keys that make the mesh large.
    let blamed = [root.table("solver")?.get("max_memory_gib"), mesh.get("elements_per_contact_radius"), mesh.get("fine_zone")];
    Err(match blamed.into_iter().flatten().next() {
        Some(field) => field.refuse(&format!("{takes}, of {available:?} GiB that solver.max_memory_gib allows"), allowed),
        None => root.refuse(&takes, allowed),
    })
}
