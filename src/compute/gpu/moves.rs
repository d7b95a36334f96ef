//! Bytes that a kernel moves at the least, from the arrays that it is bound to.
//!
//! An array that a kernel reads counts once, one that it writes once, one of both kinds twice: of
//! arrays by slot, case or geometry the parts of the slots of the dispatch, of lists that all slots
//! share the whole. What a kernel does with an array is known from its source. Arrays that have not
//! been declared do not count: a few numbers a slot, parameters of materials.

use super::shader_sources::{Kernel, Precision};
use super::validate::validate;

/// How much of an array a dispatch touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Extent {
    /// So little that it is not counted.
    #[default]
    Little,
    /// All of it, however many slots there are.
    Whole,
    /// One of so many equal parts for each slot: there are as many as slots, cases or geometries,
    /// or as iterates or vectors of these.
    Each(u64),
}

/// An argument of a kernel.
#[derive(Clone, Debug)]
pub struct Argument<'a> {
    pub(super) resource: wgpu::BindingResource<'a>,
    pub(super) array: Array,
}

/// Its size.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Array {
    /// Bytes of the array.
    pub bytes: u64,
    /// What of it is touched.
    pub extent: Extent,
}

impl Array {
    fn touched(&self, slots: u64) -> u64 {
        match self.extent {
            Extent::Little => 0,
            Extent::Whole => self.bytes,
            // Cases may share a geometry, which then moves once.
            Extent::Each(parts) => self.bytes / parts.max(1) * slots.min(parts),
        }
    }
}

/// What a kernel does with an argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Use {
    reads: bool,
    writes: bool,
}

/// What is not seen from a kernel's bindings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum But {
    /// Touched at some places only, which are not counted.
    Left,
    /// Touched once: what is read was written by the same kernel.
    Once,
    /// Two parts for each slot.
    Twice,
    /// One of so many components.
    OneOf(u64),
    /// One part for each vector of the Krylov basis.
    PerVector,
}

/// Kernels by name, argument, and what there is to know.
const BUT: &[(&str, usize, But)] = &[
    // The largest alpha alone.
    ("hex8_energies", 10, But::OneOf(super::resident::HISTORY as u64)),
    // Of elements with corners that hang.
    ("gather_node_force", 2, But::Left),
    // The committed state, and not its last flow.
    ("hex8_update", 12, But::OneOf(2)),
    // The contact's rows where points slide, and the diagonals for them.
    ("assemble", 2, But::Left),
    ("assemble", 5, But::Left),
    // What is fixed.
    ("prescribe", 1, But::Left),
    // The inverses, and not what rounding takes.
    ("smooth_start", 1, But::OneOf(2)),
    // The upper halves of the matrix.
    ("smooth_step", 2, But::OneOf(2)),
    ("cycle_residual", 2, But::OneOf(2)),
    ("solve_coarsest", 2, But::OneOf(2)),
    ("small_down", 2, But::OneOf(2)),
    ("small_up", 2, But::OneOf(2)),
    // The first step of a polynomial reads none.
    ("smooth_step", 6, But::Once),
    // Levels that one workgroup smooths stay in its caches.
    ("solve_coarsest", 3, But::Once),
    ("solve_coarsest", 6, But::Once),
    ("small_down", 5, But::Once),
    ("small_down", 6, But::Once),
    ("small_down", 7, But::Once),
    ("small_up", 6, But::Once),
    ("small_up", 7, But::Once),
    ("krylov_dots", 2, But::PerVector),
    ("krylov_orthogonalise", 2, But::PerVector),
    ("krylov_combine", 3, But::PerVector),
    // What a trial begins with is one of these.
    ("iterate_place", 5, But::Left),
    ("iterate_place", 6, But::Left),
    ("iterate_place", 7, But::Left),
    ("iterate_place", 9, But::Left),
    ("iterate_place", 10, But::Once),
    // Of prescribed nodes and contact points.
    ("iterate_contact", 11, But::Left),
    ("iterate_contact", 12, But::Left),
    ("iterate_measure", 5, But::Left),
    ("iterate_measure", 7, But::Left),
    ("iterate_measure", 8, But::Left),
    ("iterate_measure", 9, But::Twice),
    ("iterate_measure", 10, But::Left),
    ("iterate_system", 5, But::Left),
    ("iterate_system", 7, But::Left),
    ("iterate_system", 8, But::Left),
    ("iterate_expand", 5, But::Left),
    ("iterate_expand", 7, But::Left),
    ("iterate_expand", 8, But::Left),
    ("iterate_expand", 10, But::Left),
    ("iterate_expand", 14, But::Once),
    // From the second iteration of a step on.
    ("iterate_unit", 7, But::Left),
    ("iterate_commit", 8, But::Left),
    ("iterate_commit", 9, But::Left),
];

/// Kernels that touch single nodes or points, or a number of entries that only the device knows:
/// what they move is not known, and little.
const UNKNOWN: &[&str] = &[
    "krylov_measure",
    "krylov_begin",
    "krylov_advance",
    "krylov_running",
    "krylov_least_squares",
    "plate_force",
    "iterate_read",
    "iterate_depth",
    "iterate_land",
];

/// What the entry point of a kernel does with each of its arguments; `None` if its source does not
/// compile, or what it moves is not known.
pub(super) fn uses(kernel: &Kernel) -> Option<Vec<Use>> {
    if UNKNOWN.contains(&kernel.name) {
        return None;
    }
    let checked = validate(&kernel.assemble(Precision::F32)).ok()?;
    let of_entry = checked.info.get_entry_point(0);
    let mut uses = vec![Use::default(); kernel.bindings.len()];
    for (handle, variable) in checked.module.global_variables.iter() {
        let at = variable.binding.map_or(usize::MAX, |place| place.binding as usize);
        if let Some(of_argument) = uses.get_mut(at) {
            let flags = of_entry[handle];
            of_argument.reads = flags.contains(naga::valid::GlobalUse::READ);
            of_argument.writes = flags.contains(naga::valid::GlobalUse::WRITE);
        }
    }
    Some(uses)
}

/// Bytes of a dispatch for so many slots, whose Krylov bases have so many vectors.
pub(super) fn bytes(kernel: &str, uses: &[Use], arrays: &[Array], slots: usize, vectors: usize) -> u64 {
    let slots = slots as u64;
    if slots == 0 {
        return 0;
    }
    let of_argument = |(at, (argument, array)): (usize, (&Use, &Array))| {
        let touched = array.touched(slots);
        let times = u64::from(argument.reads) + u64::from(argument.writes);
        let but = BUT.iter().find(|(name, place, _)| *name == kernel && *place == at).map(|(_, _, but)| *but);
        match but {
            None => times * touched,
            Some(But::Left) => 0,
            Some(But::Once) => touched,
            Some(But::Twice) => 2 * times * touched,
            Some(But::OneOf(components)) => times * touched / components,
            Some(But::PerVector) => times * touched * vectors as u64,
        }
    };
    uses.iter().zip(arrays).enumerate().map(of_argument).sum()
}

#[cfg(test)]
mod tests {
    use super::super::linear::sources::{KRYLOV_DOTS, SMOOTH_STEP};
    use super::super::shader_sources::{HEX8_JACOBIAN, KERNELS};
    use super::*;

    #[test]
    fn what_is_said_of_kernels_is_of_kernels_that_there_are() {
        for name in BUT.iter().map(|(name, _, _)| name).chain(UNKNOWN) {
            assert!(KERNELS.iter().any(|kernel| kernel.name == *name), "{name}");
        }
        for &(name, at, _) in BUT {
            let kernel = KERNELS.iter().find(|kernel| kernel.name == name).unwrap();
            let of_argument = uses(kernel).unwrap()[at];
            assert!(of_argument.reads || of_argument.writes, "{name} {at}");
        }
        assert!(KERNELS.iter().all(|kernel| uses(kernel).is_some() != UNKNOWN.contains(&kernel.name)));
    }

    #[test]
    fn arguments_count_as_they_are_used() {
        let (read, write) = (Use { reads: true, writes: false }, Use { reads: false, writes: true });
        // Volumes are bound to every kernel of the element, and not read by this one.
        let jacobian = uses(&HEX8_JACOBIAN).unwrap();
        assert_eq!((jacobian[4], jacobian[6], jacobian[7]), (Use::default(), read, write));
        let step = uses(&SMOOTH_STEP).unwrap();
        assert_eq!((step[6], step[7]), (Use { reads: true, writes: true }, write));

        let each = |bytes, parts| Array { bytes, extent: Extent::Each(parts) };
        let arrays = [each(800, 8), Array { bytes: 50, extent: Extent::Whole }, each(7, 1), Array::default()];
        let both = Use { reads: true, writes: true };
        assert_eq!(bytes("narrow", &[both, read, write, read], &arrays, 3, 0), 2 * 300 + 50 + 7);
        assert_eq!(bytes("narrow", &[both, read, write, read], &arrays, 0, 0), 0);
        // three slots with four vectors of 20 bytes and a vector to be multiplied
        let dots = uses(&KRYLOV_DOTS).unwrap();
        let arrays = [Array::default(), Array::default(), each(20 * 8 * 31, 8 * 31), each(160, 8), Array::default()];
        assert_eq!(bytes("krylov_dots", &dots, &arrays, 3, 4), 3 * 4 * 20 + 3 * 20);
        assert_eq!(bytes("krylov_dots", &dots, &arrays, 3, 0), 3 * 20);
    }
}
