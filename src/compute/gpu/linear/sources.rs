//! The kernels of the linear solver. All of them run in single precision.

use super::super::shader_sources::Binding::{Read, ReadWrite, Uniform};
use super::super::shader_sources::{Kernel, Source, source};

const LEVEL: Source = source!("linalg/level.wgsl");
const RECORD: Source = source!("linalg/record.wgsl");
const HALVES: Source = source!("linalg/halves.wgsl");
const PRODUCT: Source = source!("linalg/product.wgsl");
const ROW_TIMES: Source = source!("linalg/row_times.wgsl");
const ROUNDED_ROW_TIMES: Source = source!("linalg/rounded_row_times.wgsl");
const GALERKIN: Source = source!("linalg/galerkin.wgsl");
const TRANSFER: Source = source!("linalg/transfer.wgsl");
const KRYLOV: Source = source!("linalg/krylov.wgsl");
const SUMS: Source = source!("linalg/sums.wgsl");
const SMALL: Source = source!("linalg/small.wgsl");
const NORM: Source = source!("linalg/norm.wgsl");

/// The tangent as the finest level's matrix.
pub static ASSEMBLE: Kernel = Kernel {
    name: "assemble",
    sources: &[LEVEL, HALVES, source!("linalg/assemble.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite, Uniform],
    workgroup: 64,
};

/// Inverses of a level's diagonal blocks, and what rounding takes from its rows.
pub static INVERT_DIAGONAL: Kernel = Kernel {
    name: "invert_diagonal",
    sources: &[LEVEL, HALVES, source!("linalg/diagonal.wgsl")],
    bindings: &[Uniform, Read, Read, Read, ReadWrite, Read],
    workgroup: 64,
};

/// A P.
pub static GALERKIN_PRODUCT: Kernel = Kernel {
    name: "galerkin_product",
    sources: &[LEVEL, HALVES, GALERKIN, source!("linalg/galerkin_product.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite, Read, Read],
    workgroup: 64,
};

/// P^T (A P).
pub static GALERKIN_COARSE: Kernel = Kernel {
    name: "galerkin_coarse",
    sources: &[LEVEL, HALVES, GALERKIN, source!("linalg/galerkin_coarse.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite],
    workgroup: 64,
};

/// What is fixed.
pub static PRESCRIBE: Kernel = Kernel {
    name: "prescribe",
    sources: &[LEVEL, source!("linalg/prescribe.wgsl")],
    bindings: &[Uniform, Read, Read, ReadWrite],
    workgroup: 192,
};

/// The smoother's first step from zero.
pub static SMOOTH_START: Kernel = Kernel {
    name: "smooth_start",
    sources: &[LEVEL, RECORD, source!("linalg/chebyshev_start.wgsl")],
    bindings: &[Uniform, Read, Read, ReadWrite, ReadWrite, Uniform, Read],
    workgroup: 192,
};

/// A step of the smoother.
pub static SMOOTH_STEP: Kernel = Kernel {
    name: "smooth_step",
    sources: &[LEVEL, RECORD, HALVES, PRODUCT, ROUNDED_ROW_TIMES, source!("linalg/chebyshev.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite, ReadWrite, Uniform, Read],
    workgroup: 192,
};

/// The coarsest level.
pub static SOLVE_COARSEST: Kernel = Kernel {
    name: "solve_coarsest",
    sources: &[LEVEL, RECORD, HALVES, source!("linalg/coarsest.wgsl")],
    bindings: &[Uniform, Read, Read, ReadWrite, Read, Read, ReadWrite, Read, Read],
    workgroup: 256,
};

/// A small level on the way down.
pub static SMALL_DOWN: Kernel = Kernel {
    name: "small_down",
    sources: &[LEVEL, RECORD, HALVES, SMALL, ROUNDED_ROW_TIMES, source!("linalg/small_down.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite, Read, Read],
    workgroup: 256,
};

/// A small level on the way up.
pub static SMALL_UP: Kernel = Kernel {
    name: "small_up",
    sources: &[LEVEL, RECORD, HALVES, SMALL, ROUNDED_ROW_TIMES, source!("linalg/small_up.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite, Read, Read, Read, Read, Read, Read],
    workgroup: 256,
};

/// b - A x.
pub static RESIDUAL: Kernel = Kernel {
    name: "residual",
    sources: &[LEVEL, RECORD, HALVES, PRODUCT, ROW_TIMES, source!("linalg/residual.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite, Read],
    workgroup: 192,
};

/// The same of the rounded matrix, within a V-cycle.
pub static CYCLE_RESIDUAL: Kernel = Kernel {
    name: "cycle_residual",
    sources: &[LEVEL, RECORD, HALVES, PRODUCT, ROUNDED_ROW_TIMES, source!("linalg/cycle_residual.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, Read, ReadWrite, Read],
    workgroup: 192,
};

/// To the next level.
pub static RESTRICT: Kernel = Kernel {
    name: "restrict_residual",
    sources: &[LEVEL, RECORD, TRANSFER, source!("linalg/restrict.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite, Read],
    workgroup: 192,
};

/// From the next level.
pub static PROLONG: Kernel = Kernel {
    name: "prolong_add",
    sources: &[LEVEL, RECORD, TRANSFER, source!("linalg/prolong.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite, Read, Read],
    workgroup: 192,
};

/// A times the preconditioned vector, which is kept.
pub static KRYLOV_PRODUCT: Kernel = Kernel {
    name: "krylov_product",
    sources: &[LEVEL, RECORD, HALVES, PRODUCT, ROW_TIMES, source!("linalg/krylov_product.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, Read, ReadWrite, ReadWrite],
    workgroup: 192,
};

/// Products of a vector with the basis.
pub static KRYLOV_DOTS: Kernel = Kernel {
    name: "krylov_dots",
    sources: &[LEVEL, RECORD, KRYLOV, SUMS, source!("linalg/dots.wgsl")],
    bindings: &[Uniform, Read, Read, Read, ReadWrite],
    workgroup: 256,
};

/// A pass of Gram-Schmidt.
pub static KRYLOV_ORTHOGONALISE: Kernel = Kernel {
    name: "krylov_orthogonalise",
    sources: &[LEVEL, RECORD, KRYLOV, SUMS, source!("linalg/orthogonalise.wgsl")],
    bindings: &[Uniform, Read, Read, Read, ReadWrite, ReadWrite, ReadWrite],
    workgroup: 256,
};

/// The norm by which tolerances are measured.
pub static KRYLOV_MEASURE: Kernel = Kernel {
    name: "krylov_measure",
    sources: &[LEVEL, RECORD, KRYLOV, NORM, source!("linalg/measure.wgsl")],
    bindings: &[Uniform, ReadWrite, Read],
    workgroup: 64,
};

/// The beginning of a cycle.
pub static KRYLOV_BEGIN: Kernel = Kernel {
    name: "krylov_begin",
    sources: &[LEVEL, RECORD, KRYLOV, NORM, source!("linalg/begin_cycle.wgsl")],
    bindings: &[Uniform, ReadWrite, Read, ReadWrite],
    workgroup: 64,
};

/// The end of a Krylov iteration.
pub static KRYLOV_ADVANCE: Kernel = Kernel {
    name: "krylov_advance",
    sources: &[LEVEL, RECORD, KRYLOV, source!("linalg/advance.wgsl")],
    bindings: &[Uniform, ReadWrite, Read, ReadWrite],
    workgroup: 64,
};

/// The next basis vector.
pub static KRYLOV_NORMALISE: Kernel = Kernel {
    name: "krylov_normalise",
    sources: &[LEVEL, RECORD, source!("linalg/normalise.wgsl")],
    bindings: &[Uniform, Read, ReadWrite, ReadWrite],
    workgroup: 256,
};

/// The list of the slots that run.
pub static KRYLOV_RUNNING: Kernel = Kernel {
    name: "krylov_running",
    sources: &[LEVEL, RECORD, source!("linalg/running.wgsl")],
    bindings: &[Uniform, ReadWrite, ReadWrite],
    workgroup: 64,
};

/// The combination of least residual.
pub static KRYLOV_LEAST_SQUARES: Kernel = Kernel {
    name: "krylov_least_squares",
    sources: &[LEVEL, RECORD, KRYLOV, source!("linalg/least_squares.wgsl")],
    bindings: &[Uniform, Read, ReadWrite],
    workgroup: 64,
};

/// The solution.
pub static KRYLOV_COMBINE: Kernel = Kernel {
    name: "krylov_combine",
    sources: &[LEVEL, RECORD, KRYLOV, source!("linalg/combine.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite],
    workgroup: 256,
};

/// The plate's force along the solution.
pub static PLATE_FORCE: Kernel = Kernel {
    name: "plate_force",
    sources: &[LEVEL, RECORD, HALVES, PRODUCT, ROW_TIMES, SUMS, source!("linalg/plate_force.wgsl")],
    bindings: &[Uniform, Read, Read, Read, Read, ReadWrite],
    workgroup: 256,
};
