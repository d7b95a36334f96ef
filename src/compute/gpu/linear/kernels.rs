//! The kernels of the linear solver, bound to its arrays, but for those of the V-cycle.

use super::super::arguments::{Argument, args};
use super::super::buffers::{DeviceReal, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::arrays::Arrays;
use super::calls::{RunningSlots, SizedKernel};
use super::levels::Levels;
use super::plan::Plan;
use super::sizes::{CHUNK, THREADS, row_threads};
use super::sources::{
    ASSEMBLE, KRYLOV_ADVANCE, KRYLOV_BEGIN, KRYLOV_COMBINE, KRYLOV_DOTS, KRYLOV_LEAST_SQUARES, KRYLOV_MEASURE, KRYLOV_NORMALISE,
    KRYLOV_ORTHOGONALISE, KRYLOV_PRODUCT, PLATE_FORCE, PRESCRIBE, RESIDUAL,
};

/// Lists of kernels, in the order in which they run.
#[derive(Debug)]
pub struct LinearKernels {
    /// Forms the finest level's matrix.
    pub assemble: SizedKernel,
    /// Writes what is fixed into `solution`.
    pub prescribe: SizedKernel,
    /// The residual there, and its square.
    pub residual: Vec<SizedKernel>,
    /// What tolerances are measured by.
    pub measure: SizedKernel,
    /// The first basis vector.
    pub begin: Vec<SizedKernel>,
    /// A Krylov iteration after the V-cycle, up to the decision which slots go on.
    pub iteration: Vec<SizedKernel>,
    /// Which those are.
    pub running: RunningSlots,
    /// The next basis vector of those.
    pub next: SizedKernel,
    /// The answer, from the vectors of a cycle.
    pub finish: Vec<SizedKernel>,
}

impl LinearKernels {
    /// Binds them; `blocks` are the tangents that the gathering kernels leave.
    ///
    /// # Errors
    /// As [`GpuContext::bind`].
    pub fn new<T: DeviceReal>(
        context: &GpuContext,
        plan: &Plan,
        (levels, arrays): (&Levels, &Arrays),
        blocks: &StorageBuffer<T>,
    ) -> Result<Self, GpuError> {
        let (finest, level) = (&plan.layout.levels[0], &levels.levels[0]);
        let (unknowns, by_rows, w) = (3 * finest.nodes, row_threads(finest.nodes), &level.b);
        let by_chunks = unknowns.div_ceil(CHUNK) * THREADS;
        let Arrays { records, rows, rhs, solution, answer, basis, preconditioned, small, partial_sums, squares, .. } = arrays;
        let call = |kernel, threads, arguments: &[Argument<'_>]| {
            SizedKernel::new(context, kernel, threads, &[&args! { level: level.block }, arguments].concat())
        };
        let with_product = |kernel, threads, x, arguments: &[Argument<'_>]| {
            SizedKernel::new(context, kernel, threads, &[&level.product(x), arguments].concat())
        };
        let of_matrix = args! {
            level: level.block,
            source: arrays.source,
            diagonal: level.diagonal,
            point_of: arrays.point_of,
            blocks,
            rows,
            matrix: level.matrix,
            counts: arrays.counts,
            column: level.column,
        };
        let dots = || call(&KRYLOV_DOTS, by_chunks, &args! { records, basis, w, partial_sums });
        let orthogonalise = || call(&KRYLOV_ORTHOGONALISE, by_chunks, &args! { records, basis, partial_sums, w, small, squares });
        let normalise = || call(&KRYLOV_NORMALISE, unknowns, &args! { records, w, basis });
        // Twice is enough (Giraud, Langou & Rozloznik, Comput. Math. Appl. 50, 2005).
        let product = args! { is_fixed: level.fixed, records, w, preconditioned };
        let iteration = vec![
            with_product(&KRYLOV_PRODUCT, by_rows, &level.x, &product)?,
            dots()?,
            orthogonalise()?,
            dots()?,
            orthogonalise()?,
            call(&KRYLOV_ADVANCE, 1, &args! { records, squares, small })?,
        ];
        let next = normalise()?;
        let kernels = levels.cycle.iter().chain(&iteration).chain([&next]);
        let residual = args! { b: rhs, is_fixed: level.fixed, r: w, records };
        Ok(Self {
            assemble: SizedKernel::of(context.bind(&ASSEMBLE, T::PRECISION, &of_matrix)?, finest.blocks() / 2),
            prescribe: call(&PRESCRIBE, by_rows, &args! { rhs, is_fixed: level.fixed, solution })?,
            residual: vec![with_product(&RESIDUAL, by_rows, solution, &residual)?, dots()?],
            measure: call(&KRYLOV_MEASURE, 1, &args! { records, partial_sums })?,
            begin: vec![call(&KRYLOV_BEGIN, 1, &args! { records, partial_sums, small })?, normalise()?],
            running: RunningSlots::new(context, kernels.map(SizedKernel::groups), &level.block, records)?,
            iteration,
            next,
            finish: vec![
                call(&KRYLOV_LEAST_SQUARES, 1, &args! { records, small })?,
                call(&KRYLOV_COMBINE, unknowns, &args! { records, small, preconditioned, solution, answer })?,
                with_product(&PLATE_FORCE, 1, answer, &args! { plate: arrays.plate, records })?,
            ],
        })
    }
}
