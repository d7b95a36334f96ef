//! The kernels of the linear solver, bound to its arrays, but for those of the V-cycle.

use super::super::arguments::{Argument, args};
use super::super::buffers::{DeviceReal, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::kernel::Kernel;
use super::arrays::Arrays;
use super::calls::{RunningSlots, SizedKernel};
use super::levels::{LevelArrays, Levels};
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
        let (by_rows, w) = (row_threads(finest.nodes), &level.b);
        let Arrays { records, rows, rhs, solution, answer, preconditioned, small, partial_sums, .. } = arrays;
        let vectors = VectorKernels { context, level, arrays };
        let call = |kernel, threads, arguments: &[Argument<'_>]| vectors.call(kernel, threads, arguments);
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
        let product = args! { is_fixed: level.fixed, records, w, preconditioned };
        let mut iteration = vec![with_product(&KRYLOV_PRODUCT, by_rows, &level.x, &product)?];
        iteration.extend(vectors.orthogonalisation()?);
        let next = vectors.normalise()?;
        let kernels = levels.cycle.iter().chain(&iteration).chain([&next]);
        let residual = args! { b: rhs, is_fixed: level.fixed, r: w, records };
        Ok(Self {
            assemble: SizedKernel::of(context.bind(&ASSEMBLE, T::PRECISION, &of_matrix)?, finest.blocks() / 2),
            prescribe: call(&PRESCRIBE, by_rows, &args! { rhs, is_fixed: level.fixed, solution })?,
            residual: vec![with_product(&RESIDUAL, by_rows, solution, &residual)?, vectors.dots()?],
            measure: call(&KRYLOV_MEASURE, 1, &args! { records, partial_sums })?,
            begin: vec![call(&KRYLOV_BEGIN, 1, &args! { records, partial_sums, small })?, vectors.normalise()?],
            running: RunningSlots::new(context, kernels.map(SizedKernel::groups), &level.block, records)?,
            iteration,
            next,
            finish: {
                let mut finish = vectors.answer()?;
                finish.push(with_product(&PLATE_FORCE, 1, answer, &args! { plate: arrays.plate, records })?);
                finish
            },
        })
    }
}

/// Binds kernels that take the vectors of FGMRES, whatever the matrix.
#[derive(Clone, Copy, Debug)]
pub struct VectorKernels<'a> {
    /// The device.
    pub context: &'a GpuContext,
    /// The finest level.
    pub level: &'a LevelArrays,
    /// The other arrays.
    pub arrays: &'a Arrays,
}

impl VectorKernels<'_> {
    fn unknowns(&self) -> usize {
        3 * self.level.size().0
    }

    fn by_chunks(&self) -> usize {
        self.unknowns().div_ceil(CHUNK) * THREADS
    }

    fn call(&self, kernel: &'static Kernel, threads: usize, arguments: &[Argument<'_>]) -> Result<SizedKernel, GpuError> {
        SizedKernel::new(self.context, kernel, threads, &[&args! { level: self.level.block }, arguments].concat())
    }

    /// Products of w with the basis; of a residual the square.
    ///
    /// # Errors
    /// As [`GpuContext::bind`].
    pub fn dots(&self) -> Result<SizedKernel, GpuError> {
        let Arrays { records, basis, partial_sums, .. } = self.arrays;
        self.call(&KRYLOV_DOTS, self.by_chunks(), &args! { records, basis, w: self.level.b, partial_sums })
    }

    /// The basis taken out of w, up to the decision which slots go on. Twice is enough (Giraud,
    /// Langou & Rozloznik, Comput. Math. Appl. 50, 2005).
    ///
    /// # Errors
    /// As [`GpuContext::bind`].
    pub fn orthogonalisation(&self) -> Result<[SizedKernel; 5], GpuError> {
        let Arrays { records, basis, partial_sums, small, squares, .. } = self.arrays;
        let orthogonalise = || {
            let arguments = args! { records, basis, partial_sums, w: self.level.b, small, squares };
            self.call(&KRYLOV_ORTHOGONALISE, self.by_chunks(), &arguments)
        };
        let advance = self.call(&KRYLOV_ADVANCE, 1, &args! { records, squares, small })?;
        Ok([self.dots()?, orthogonalise()?, self.dots()?, orthogonalise()?, advance])
    }

    fn normalise(&self) -> Result<SizedKernel, GpuError> {
        let Arrays { records, basis, .. } = self.arrays;
        self.call(&KRYLOV_NORMALISE, self.unknowns(), &args! { records, w: self.level.b, basis })
    }

    /// The answer, from the vectors of a cycle.
    ///
    /// # Errors
    /// As [`GpuContext::bind`].
    pub fn answer(&self) -> Result<Vec<SizedKernel>, GpuError> {
        let Arrays { records, small, preconditioned, solution, answer, .. } = self.arrays;
        Ok(vec![
            self.call(&KRYLOV_LEAST_SQUARES, 1, &args! { records, small })?,
            self.call(&KRYLOV_COMBINE, self.unknowns(), &args! { records, small, preconditioned, solution, answer })?,
        ])
    }
}
