//! The kernels of the linear solver. All of them run in single precision.

use super::super::kernel::Kernel;
use super::super::source::{ShaderSource, source};

const LEVEL: ShaderSource = source!("linalg/level.wgsl");
const RECORD: ShaderSource = source!("linalg/record.wgsl");
const HALVES: ShaderSource = source!("linalg/halves.wgsl");
const KEEP_HALVES: ShaderSource = source!("linalg/keep_halves.wgsl");
const PRODUCT: ShaderSource = source!("linalg/product.wgsl");
const ROW_TIMES: ShaderSource = source!("linalg/row_times.wgsl");
const ROUNDED_ROW_TIMES: ShaderSource = source!("linalg/rounded_row_times.wgsl");
const GALERKIN: ShaderSource = source!("linalg/galerkin.wgsl");
const TRANSFER: ShaderSource = source!("linalg/transfer.wgsl");
const KRYLOV: ShaderSource = source!("linalg/krylov.wgsl");
const SUMS: ShaderSource = source!("linalg/sums.wgsl");
const SMALL: ShaderSource = source!("linalg/small.wgsl");
const NORM: ShaderSource = source!("linalg/norm.wgsl");

/// The tangent as the finest level's matrix.
pub static ASSEMBLE: Kernel = Kernel::new("assemble", &[LEVEL, HALVES, KEEP_HALVES, source!("linalg/assemble.wgsl")]);

/// Inverses of a level's diagonal blocks, and what rounding takes from its rows.
pub static INVERT_DIAGONAL: Kernel = Kernel::new("invert_diagonal", &[LEVEL, HALVES, source!("linalg/diagonal.wgsl")]);

/// A P.
pub static GALERKIN_PRODUCT: Kernel =
    Kernel::new("galerkin_product", &[LEVEL, HALVES, GALERKIN, source!("linalg/galerkin_product.wgsl")]);

/// P^T (A P).
pub static GALERKIN_COARSE: Kernel =
    Kernel::new("galerkin_coarse", &[LEVEL, HALVES, KEEP_HALVES, GALERKIN, source!("linalg/galerkin_coarse.wgsl")]);

/// What is fixed.
pub static PRESCRIBE: Kernel = Kernel::new("prescribe", &[LEVEL, source!("linalg/prescribe.wgsl")]);

/// The smoother's first step from zero.
pub static SMOOTH_START: Kernel = Kernel::new("smooth_start", &[LEVEL, RECORD, source!("linalg/chebyshev_start.wgsl")]);

/// A step of the smoother.
pub static SMOOTH_STEP: Kernel =
    Kernel::new("smooth_step", &[LEVEL, RECORD, HALVES, PRODUCT, ROUNDED_ROW_TIMES, source!("linalg/chebyshev.wgsl")]);

/// The coarsest level.
pub static SOLVE_COARSEST: Kernel = Kernel::new("solve_coarsest", &[LEVEL, RECORD, HALVES, source!("linalg/coarsest.wgsl")]);

/// A small level on the way down.
pub static SMALL_DOWN: Kernel =
    Kernel::new("small_down", &[LEVEL, RECORD, HALVES, SMALL, ROUNDED_ROW_TIMES, source!("linalg/small_down.wgsl")]);

/// A small level on the way up.
pub static SMALL_UP: Kernel =
    Kernel::new("small_up", &[LEVEL, RECORD, HALVES, SMALL, ROUNDED_ROW_TIMES, source!("linalg/small_up.wgsl")]);

/// b - A x.
pub static RESIDUAL: Kernel =
    Kernel::new("residual", &[LEVEL, RECORD, HALVES, PRODUCT, ROW_TIMES, source!("linalg/residual.wgsl")]);

/// The same of the rounded matrix, within a V-cycle.
pub static CYCLE_RESIDUAL: Kernel =
    Kernel::new("cycle_residual", &[LEVEL, RECORD, HALVES, PRODUCT, ROUNDED_ROW_TIMES, source!("linalg/cycle_residual.wgsl")]);

/// To the next level.
pub static RESTRICT: Kernel = Kernel::new("restrict_residual", &[LEVEL, RECORD, TRANSFER, source!("linalg/restrict.wgsl")]);

/// From the next level.
pub static PROLONG: Kernel = Kernel::new("prolong_add", &[LEVEL, RECORD, TRANSFER, source!("linalg/prolong.wgsl")]);

/// A times the preconditioned vector, which is kept.
pub static KRYLOV_PRODUCT: Kernel =
    Kernel::new("krylov_product", &[LEVEL, RECORD, HALVES, PRODUCT, ROW_TIMES, source!("linalg/krylov_product.wgsl")]);

/// Products of a vector with the basis.
pub static KRYLOV_DOTS: Kernel = Kernel::new("krylov_dots", &[LEVEL, RECORD, KRYLOV, SUMS, source!("linalg/dots.wgsl")]);

/// A pass of Gram-Schmidt.
pub static KRYLOV_ORTHOGONALISE: Kernel =
    Kernel::new("krylov_orthogonalise", &[LEVEL, RECORD, KRYLOV, SUMS, source!("linalg/orthogonalise.wgsl")]);

/// The norm by which tolerances are measured.
pub static KRYLOV_MEASURE: Kernel = Kernel::new("krylov_measure", &[LEVEL, RECORD, KRYLOV, NORM, source!("linalg/measure.wgsl")]);

/// The beginning of a cycle.
pub static KRYLOV_BEGIN: Kernel = Kernel::new("krylov_begin", &[LEVEL, RECORD, KRYLOV, NORM, source!("linalg/begin_cycle.wgsl")]);

/// The end of a Krylov iteration.
pub static KRYLOV_ADVANCE: Kernel = Kernel::new("krylov_advance", &[LEVEL, RECORD, KRYLOV, source!("linalg/advance.wgsl")]);

/// The next basis vector.
pub static KRYLOV_NORMALISE: Kernel = Kernel::new("krylov_normalise", &[LEVEL, RECORD, source!("linalg/normalise.wgsl")]);

/// The list of the slots that run.
pub static KRYLOV_RUNNING: Kernel = Kernel::new("krylov_running", &[LEVEL, RECORD, source!("linalg/running.wgsl")]);

/// The combination of least residual.
pub static KRYLOV_LEAST_SQUARES: Kernel =
    Kernel::new("krylov_least_squares", &[LEVEL, RECORD, KRYLOV, source!("linalg/least_squares.wgsl")]);

/// The solution.
pub static KRYLOV_COMBINE: Kernel = Kernel::new("krylov_combine", &[LEVEL, RECORD, KRYLOV, source!("linalg/combine.wgsl")]);

/// The plate's force along the solution.
pub static PLATE_FORCE: Kernel =
    Kernel::new("plate_force", &[LEVEL, RECORD, HALVES, PRODUCT, ROW_TIMES, SUMS, source!("linalg/plate_force.wgsl")]);

const TIE: ShaderSource = source!("linalg/tie.wgsl");
const TIE_MET: ShaderSource = source!("linalg/tie_met.wgsl");

/// Half of a pair's body: its finest matrix.
pub static FOLD_MATRIX: Kernel = Kernel::new("fold_matrix", &[LEVEL, HALVES, KEEP_HALVES, source!("linalg/fold_matrix.wgsl")]);

/// Forces of half of the body.
pub static FOLD: Kernel = Kernel::new("fold", &[LEVEL, RECORD, source!("linalg/fold.wgsl")]);

/// Displacements of all of it.
pub static UNFOLD: Kernel = Kernel::new("unfold", &[LEVEL, RECORD, source!("linalg/unfold.wgsl")]);

/// A vector through a map of a pair's interface.
pub static TIE_MAP: Kernel = Kernel::new("tie_map", &[LEVEL, RECORD, TIE, source!("linalg/tie_map.wgsl")]);

/// K times a vector.
pub static TIE_PRODUCT: Kernel =
    Kernel::new("tie_product", &[LEVEL, RECORD, HALVES, PRODUCT, ROW_TIMES, source!("linalg/tie_product.wgsl")]);

/// A pair's system times the preconditioned vector, which is kept.
pub static TIE_MEET: Kernel = Kernel::new("tie_meet", &[LEVEL, RECORD, TIE_MET, source!("linalg/tie_meet.wgsl")]);

/// The residual of a pair's system.
pub static TIE_RESIDUAL: Kernel = Kernel::new("tie_residual", &[LEVEL, RECORD, TIE_MET, source!("linalg/tie_residual.wgsl")]);

/// Which halves run.
pub static TIE_RUNNING: Kernel = Kernel::new("tie_running", &[LEVEL, RECORD, source!("linalg/tie_running.wgsl")]);
