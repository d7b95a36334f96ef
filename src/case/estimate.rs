//! How large a case is, before it is meshed.

use super::document::Document;
use super::error::CaseError;
use super::reader::Reader;
use super::{Case, Opponent};
use crate::memory::{GIB, Room};
use crate::mesh::{SphereSpec, element_count};

/// Memory of an element with its share of the linear systems, in bytes: its tangent and the 3x3
/// blocks, twice, with their multigrid levels in f32, Krylov basis, states at quadrature points.
pub const BYTES_PER_ELEMENT: f64 = 10_000.0;

/// An estimate of the number of elements of the case's mesh, from its keys alone: those of the mesh
/// for a contact radius that is given, and else for (2 R h)^(1/2), h the largest indentation,
/// between the elastic and the ideally plastic contact, with R* in place of R where the opponent is
/// a sphere.
pub fn estimated_elements(case: &Case) -> usize {
    let deepest = case.greatest_indentation();
    let radius = case.sphere.radius;
    let share = case.effective_radius() / radius;
    let contact = case.mesh.contact_radius.map_or((2.0 * share * deepest / radius).sqrt(), |a| a / radius).clamp(0.0005, 0.3);
    let spec = SphereSpec {
        contact_radius: contact,
        elements_per_contact_radius: case.mesh.elements_per_contact_radius,
        fine_zone: case.mesh.fine_zone,
        skin_levels: case.mesh.skin_levels(),
        first_layer: case.mesh.first_layer(),
    };
    // Another body counts as much: the ratio of a to its radius hardly matters.
    let is_meshed_too = match case.opponent {
        Some(Opponent::Deforming { .. }) => true,
        Some(Opponent::Equal) => case.image().is_none(),
        None | Some(Opponent::Rigid { .. }) => false,
    };
    let meshed = if is_meshed_too { 2 } else { 1 };
    let meshed = if case.is_even() { meshed } else { 2 * meshed };
    // What cannot be meshed is refused before it gets here.
    element_count(&spec).map_or(usize::MAX, |elements| elements.saturating_mul(meshed))
}

/// An estimate of the memory that the case's simulation takes, in GiB.
pub fn estimated_memory(case: &Case) -> f64 {
    estimated_elements(case) as f64 * BYTES_PER_ELEMENT / GIB
}

/// Refuses a case whose mesh would take more than its own `solver.max_memory_gib`.
pub(super) fn check_memory(case: &Case, root: &Reader<'_>) -> Result<(), CaseError> {
    match case.solver.max_memory_gib {
        Some(limit) if estimated_memory(case) > limit => {
            Err(too_large(case, root, &format!("{limit:?} GiB that solver.max_memory_gib allows"))?)
        }
        _ => Ok(()),
    }
}

/// Whether the case is to be computed with this much memory: it fits, or it says itself how much it
/// may take.
pub fn fits(case: &Case, room: &Room) -> bool {
    case.solver.max_memory_gib.is_some() || estimated_memory(case) <= room.gib
}

/// Refuses a case that does not fit (see [`fits`]), with its place in `document`, or without one.
///
/// # Errors
/// [`CaseError::NotAllowed`], with what the case takes, how much there is, and what says so.
pub fn check_room(case: &Case, document: Option<&Document>, room: &Room) -> Result<(), CaseError> {
    if fits(case, room) {
        return Ok(());
    }
    let table = toml::Table::try_from(case).unwrap_or_default();
    let own = Document::from_table(&table);
    Err(too_large(case, &Reader::new(document.unwrap_or(&own))?, &room.to_string())?)
}

/// The refusal of a case that takes more than `available`.
fn too_large(case: &Case, root: &Reader<'_>, available: &str) -> Result<CaseError, CaseError> {
    let mesh = root.table("mesh")?;
    let (elements, gib) = (estimated_elements(case), estimated_memory(case));
    let takes = format!("a mesh of about {elements} elements takes about {gib:.2} GiB, of {available}");
    let allowed = "fewer mesh.elements_per_contact_radius or mesh.surface_elements_per_contact_radius, a smaller \
                   mesh.fine_zone, more memory for this process, or a larger solver.max_memory_gib, which is taken as it is given";
    // Named is what the user gave: the limit, or else the keys that make the mesh large.
    let names = ["surface_elements_per_contact_radius", "elements_per_contact_radius", "fine_zone"];
    let limit = root.table("solver")?.get("max_memory_gib");
    let blamed = std::iter::once(limit).chain(names.map(|name| mesh.get(name)));
    Ok(match blamed.flatten().next() {
        Some(field) => field.refuse(&takes, allowed),
        None => mesh.refuse(&takes, allowed),
    })
}
