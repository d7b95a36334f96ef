//! Every kernel of the program.

use super::iterate::sources as iterate;
use super::kernel::Kernel;
use super::linear::sources as linear;
use super::shader_sources as elements;

/// Every kernel of the program.
pub static KERNELS: &[&Kernel] = &[
    &elements::RETURN_MAPPING,
    &elements::HEX8_JACOBIAN,
    &elements::HEX8_INTERNAL_FORCE,
    &elements::HEX8_TANGENT,
    &elements::HEX8_BEGIN_STEP,
    &elements::HEX8_UPDATE,
    &elements::HEX8_ENERGIES,
    &elements::NARROW,
    &elements::GATHER_NODE_FORCE,
    &elements::GATHER_TANGENT_BLOCKS,
    &elements::CONTACT_POINTS,
    &linear::ASSEMBLE,
    &linear::INVERT_DIAGONAL,
    &linear::GALERKIN_PRODUCT,
    &linear::GALERKIN_COARSE,
    &linear::PRESCRIBE,
    &linear::SMOOTH_START,
    &linear::SMOOTH_STEP,
    &linear::CYCLE_RESIDUAL,
    &linear::SOLVE_COARSEST,
    &linear::SMALL_DOWN,
    &linear::SMALL_UP,
    &linear::RESIDUAL,
    &linear::RESTRICT,
    &linear::PROLONG,
    &linear::KRYLOV_PRODUCT,
    &linear::KRYLOV_DOTS,
    &linear::KRYLOV_ORTHOGONALISE,
    &linear::KRYLOV_MEASURE,
    &linear::KRYLOV_BEGIN,
    &linear::KRYLOV_ADVANCE,
    &linear::KRYLOV_RUNNING,
    &linear::KRYLOV_NORMALISE,
    &linear::KRYLOV_LEAST_SQUARES,
    &linear::KRYLOV_COMBINE,
    &linear::PLATE_FORCE,
    &linear::FOLD_MATRIX,
    &linear::FOLD,
    &linear::UNFOLD,
    &linear::TIE_MAP,
    &linear::TIE_PRODUCT,
    &linear::TIE_MEET,
    &linear::TIE_RESIDUAL,
    &linear::TIE_RUNNING,
    &iterate::PLACE,
    &iterate::CURRENT,
    &iterate::SAVE,
    &iterate::CONTACT,
    &iterate::MEASURE,
    &iterate::READ,
    &iterate::SYSTEM,
    &iterate::EXPAND,
    &iterate::UNIT,
    &iterate::RESPOND,
    &iterate::DEPTH,
    &iterate::PRESS,
    &iterate::LAND,
    &iterate::COMMIT,
    &iterate::ENERGIES,
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernel_names_are_unique() {
        let mut names: Vec<_> = KERNELS.iter().map(|k| k.name).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), KERNELS.len());
    }
}
