//! Bytes that a kernel moves at the least, from the arrays that it is bound to.
//!
//! An array that a kernel reads counts once, one that it writes once, one of both kinds twice: of
//! arrays by slot, case or geometry the parts of the slots of the dispatch, of lists that all slots
//! share the whole. What a kernel does with an array is known from its source. Arrays that have not
//! been declared do not count: a few numbers a slot, parameters of materials.

use super::arguments::Array;
use super::kernel::Kernel;
use super::reflect::Variable;

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

/// Kernels, their arguments, and what there is to know of these.
const BUT: &[(&str, &[&str], But)] = &[
    // It reads the increments and writes the Jacobians.
    ("hex8_jacobian", &["trials"], But::Once),
    // Of elements with corners that hang.
    ("gather_node_force", &["element_nodes"], But::Left),
    // The committed state, and not its last flow.
    ("hex8_update", &["history"], But::OneOf(2)),
    // The contact's rows where points slide and the diagonals for them, columns over a curved
    // opponent.
    ("assemble", &["diagonal", "rows", "column"], But::Left),
    // What is fixed.
    ("prescribe", &["rhs"], But::Left),
    // The inverses, and not what rounding takes.
    ("smooth_start", &["inverse"], But::OneOf(2)),
    // The upper halves of the matrix.
    ("smooth_step", &["matrix"], But::OneOf(2)),
    ("cycle_residual", &["matrix"], But::OneOf(2)),
    ("solve_coarsest", &["matrix"], But::OneOf(2)),
    ("small_down", &["matrix"], But::OneOf(2)),
    ("small_up", &["matrix"], But::OneOf(2)),
    // The first step of a polynomial reads none.
    ("smooth_step", &["last_step"], But::Once),
    // Levels that one workgroup smooths stay in its caches.
    ("solve_coarsest", &["x", "last_step"], But::Once),
    ("small_down", &["x"], But::Once),
    ("krylov_dots", &["basis"], But::PerVector),
    ("krylov_orthogonalise", &["basis"], But::PerVector),
    ("krylov_combine", &["preconditioned"], But::PerVector),
    // One of five maps of a pair, in the room that all have; rows of slaves alone.
    ("tie_map", &["maps"], But::Left),
    ("tie_meet", &["rows"], But::Left),
    ("tie_residual", &["rows"], But::Left),
    // Both halves of a body.
    ("fold", &["to", "is_fixed"], But::Twice),
    ("unfold", &["given"], But::Twice),
    ("fold_matrix", &["matrix"], But::Twice),
    // What a trial begins with is one of these.
    ("iterate_place", &["starts", "before", "correction", "facing"], But::Left),
    ("iterate_place", &["iterates"], But::Once),
    // Of prescribed nodes and contact points.
    ("iterate_contact", &["iterates"], But::Left),
    ("iterate_measure", &["starts", "rows"], But::Left),
    // The forces of both.
    ("iterate_measure", &["iterates"], But::Twice),
    ("iterate_system", &["starts"], But::Left),
    ("iterate_expand", &["starts", "rows"], But::Left),
    // From the second iteration of a step on, and the frames of contact points.
    ("iterate_unit", &["response", "rows"], But::Left),
    ("iterate_press", &["rows"], But::Left),
    ("iterate_commit", &["rows"], But::Left),
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
    "tie_running",
    "iterate_read",
    "iterate_depth",
    "iterate_land",
];

/// Bytes of a dispatch over these arrays, in the order of the kernel's variables, for so many slots
/// whose Krylov bases have so many vectors; none where what it moves is not known.
pub(super) fn bytes(kernel: &Kernel, arrays: &[Array], slots: usize, vectors: usize) -> Option<u64> {
    let variables = &kernel.interface().ok()?.variables;
    let of = |(variable, array): (&Variable, &Array)| touched(kernel.name, variable, array, slots as u64, vectors as u64);
    (!UNKNOWN.contains(&kernel.name)).then(|| variables.iter().zip(arrays).map(of).sum())
}

fn touched(kernel: &str, variable: &Variable, array: &Array, slots: u64, vectors: u64) -> u64 {
    if slots == 0 {
        return 0;
    }
    let touched = array.touched(slots);
    let times = u64::from(variable.reads) + u64::from(variable.writes);
    let is_of = |name: &str, arguments: &[&str]| name == kernel && arguments.contains(&variable.name.as_str());
    match BUT.iter().find(|(name, arguments, _)| is_of(name, arguments)).map(|(_, _, but)| *but) {
        None => times * touched,
        Some(But::Left) => 0,
        Some(But::Once) => touched,
        Some(But::Twice) => 2 * times * touched,
        Some(But::OneOf(components)) => times * touched / components,
        Some(But::PerVector) => times * touched * vectors,
    }
}

#[cfg(test)]
mod tests {
    use super::super::arguments::Extent;
    use super::super::kernels::KERNELS;
    use super::super::linear::sources::{KRYLOV_DOTS, SMOOTH_STEP};
    use super::super::reflect::Binding;
    use super::super::shader_sources::{GATHER_NODE_FORCE, HEX8_JACOBIAN};
    use super::*;

    fn variable(name: &str, reads: bool, writes: bool) -> Variable {
        Variable { name: name.to_owned(), binding: 0, kind: Binding::ReadWrite, reads, writes }
    }

    #[test]
    fn what_is_said_of_kernels_is_of_kernels_and_arguments_that_there_are() {
        let kernel = |name: &str| *KERNELS.iter().find(|kernel| kernel.name == name).unwrap_or_else(|| panic!("{name}"));
        assert!(UNKNOWN.iter().all(|name| kernel(name).interface().is_ok()));
        for (name, arguments, _) in BUT {
            let variables = &kernel(name).interface().unwrap().variables;
            for argument in *arguments {
                let found = variables.iter().find(|variable| variable.name == *argument);
                assert!(found.is_some_and(|variable| variable.reads || variable.writes), "{name} {argument}");
                let said = BUT.iter().filter(|(other, arguments, _)| other == name && arguments.contains(argument));
                assert_eq!(said.count(), 1, "{name} {argument}");
            }
        }
        let known = |kernel: &Kernel| bytes(kernel, &[], 1, 0).is_some();
        assert!(KERNELS.iter().all(|kernel| known(kernel) != UNKNOWN.contains(&kernel.name)));
    }

    #[test]
    fn arguments_count_as_they_are_used() {
        let of = |kernel: &Kernel, name: &str| {
            let found = kernel.interface().unwrap().variables.iter().find(|variable| variable.name == name).cloned();
            found.map(|variable| (variable.reads, variable.writes))
        };
        // Declared for all who evaluate elements, and not read by those who gather.
        assert_eq!(of(&GATHER_NODE_FORCE, "geometries"), None);
        assert_eq!(
            ["element_nodes", "starts", "trials"].map(|name| of(&HEX8_JACOBIAN, name)),
            [Some((true, false)), Some((true, false)), Some((true, true))]
        );
        assert_eq!(["last_step", "next"].map(|name| of(&SMOOTH_STEP, name)), [Some((true, true)), Some((false, true))]);

        let each = |bytes, parts| Array { bytes, extent: Extent::Each(parts) };
        let count = |name, reads, writes, array| touched("narrow", &variable(name, reads, writes), &array, 3, 0);
        assert_eq!(count("wide", true, true, each(800, 8)), 2 * 300);
        assert_eq!(count("wide", true, false, Array { bytes: 50, extent: Extent::Whole }), 50);
        assert_eq!(count("copy", false, true, each(7, 1)), 7);
        assert_eq!(count("wide", true, false, Array::default()), 0);
        assert_eq!(touched("narrow", &variable("wide", true, true), &each(800, 8), 0, 0), 0);
        // three slots with four vectors of 20 bytes and a vector to be multiplied
        let by_name = |name: &str| match name {
            "basis" => each(20 * 8 * 31, 8 * 31),
            "w" => each(160, 8),
            _ => Array::default(),
        };
        let variables = &KRYLOV_DOTS.interface().unwrap().variables;
        let arrays: Vec<Array> = variables.iter().map(|variable| by_name(&variable.name)).collect();
        assert_eq!(bytes(&KRYLOV_DOTS, &arrays, 3, 4), Some(3 * 4 * 20 + 3 * 20));
        assert_eq!(bytes(&KRYLOV_DOTS, &arrays, 3, 0), Some(3 * 20));
    }
}
