//! The arrays of the linear solver, but for those of the levels.

use super::super::buffers::StorageBuffer;
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::layout::POINT_ROWS;
use super::super::pools::Pools;
use super::plan::Plan;
use super::records::Record;
use super::sizes::{CHUNK, RESTART, small_numbers};

/// Arrays of all slots, under the names that kernels have for them.
#[derive(Debug)]
pub struct Arrays {
    /// How the solves stand.
    pub records: StorageBuffer<Record>,
    /// Contact rows `[slot][slides, force rows, displacement rows, frame][point]`.
    pub rows: StorageBuffer<f32>,
    /// Right-hand sides.
    pub rhs: StorageBuffer<f32>,
    /// What a cycle begins at.
    pub solution: StorageBuffer<f32>,
    /// Guesses.
    pub guess: StorageBuffer<f32>,
    /// Solutions.
    pub answer: StorageBuffer<f32>,
    /// Krylov vectors.
    pub basis: StorageBuffer<f32>,
    /// The preconditioner's answers to them.
    pub preconditioned: StorageBuffer<f32>,
    /// See `krylov.wgsl`.
    pub small: StorageBuffer<f32>,
    pub(super) partial_sums: StorageBuffer<f32>,
    pub(super) squares: StorageBuffer<f32>,
    pub(super) source: StorageBuffer<u32>,
    pub(super) point_of: StorageBuffer<u32>,
    pub(super) plate: StorageBuffer<u32>,
    pub(super) counts: StorageBuffer<[u32; 4]>,
}

impl Arrays {
    /// Those of so many slots, some in memory that they share with others.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn new(
        context: &GpuContext,
        plan: &Plan,
        (slots, pools): (usize, &Pools),
        records: StorageBuffer<Record>,
    ) -> Result<Self, GpuError> {
        let unknowns = 3 * plan.layout.levels[0].nodes;
        let chunks = unknowns.div_ceil(CHUNK);
        let zeros = |what: &str, numbers: usize| Ok::<_, GpuError>(context.zeros::<f32>(what, slots * numbers)?.each(slots));
        let rows = zeros("contact rows of the matrix", POINT_ROWS * plan.contact_points)?;
        let source = context.array("blocks of the matrix", &plan.source)?.whole();
        let point_of = context.array("contact points by node", &plan.point_of)?.whole();
        let plate = context.array("plate nodes", &plan.plate)?;
        let counts = context.block("sizes of the tangent")?;
        context.upload(&counts, &[plan.counts()])?;
        let (rhs, solution) = (zeros("right-hand sides", unknowns)?, zeros("solutions", unknowns)?);
        let (guess, answer) = (zeros("guesses", unknowns)?, zeros("answers", unknowns)?);
        let vectors = slots * (RESTART + 1);
        let basis = pools.vectors.view("Krylov vectors", vectors * unknowns)?.each(vectors);
        let vectors = slots * RESTART;
        let preconditioned = pools.vectors.view_after(Some(&basis), "preconditioned vectors", vectors * unknowns)?.each(vectors);
        let partial_sums = context.zeros("partial sums", slots * (RESTART + 2) * chunks)?;
        let squares = context.zeros("partial squares", slots * chunks)?;
        let small = context.zeros("least-squares problems", slots * small_numbers())?;
        Ok(Self {
            records,
            rows,
            rhs,
            solution,
            guess,
            answer,
            basis,
            preconditioned,
            small,
            partial_sums,
            squares,
            source,
            point_of,
            plate,
            counts,
        })
    }
}
