//! What the solver's kernels leave on the device, brought to the host: for comparisons with what
//! the CPU makes of the same numbers.

use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::parts::SolvePart;
use super::records::Record;
use super::sizes::{RESTART, small_numbers};
use super::solver::SlotSolver;

/// What a slot has on a level after an update and a V-cycle.
#[derive(Clone, Debug)]
pub struct OnLevel {
    /// Blocks in a row.
    pub width: usize,
    /// The matrix, `[3 i + j][k][node]`: block k of the row of a node, in the order of the pattern.
    /// On the finest level rows and columns of fixed unknowns are in it: masks leave them out.
    pub matrix: Vec<f32>,
    /// Inverses of the diagonal blocks, `[3 i + j][node]`; 0 at fixed unknowns.
    pub inverse: Vec<f32>,
    /// What the V-cycle took, `[component][node]`.
    pub b: Vec<f32>,
    /// What it left, `[component][node]`.
    pub x: Vec<f32>,
}

/// The last cycle of a slot's FGMRES. Vectors are `[component][node]`, one after another.
#[derive(Clone, Debug)]
pub struct Cycle {
    /// Krylov iterations of the cycle.
    pub steps: usize,
    /// Norm of what is left, by the recurrence.
    pub residual: f32,
    /// Orthonormal vectors, of which there are `steps`.
    pub basis: Vec<f32>,
    /// The preconditioner's answers to them.
    pub preconditioned: Vec<f32>,
    /// How much of each of these the answer has.
    pub combination: Vec<f32>,
    /// What the cycle began at.
    pub solution: Vec<f32>,
    /// What it came to.
    pub answer: Vec<f32>,
}

impl SlotSolver {
    /// Number of levels of the hierarchy.
    pub fn depth(&self) -> usize {
        self.levels.levels.len()
    }

    /// One V-cycle of slot 0, from `b` `[component][node]`, which is 0 at fixed unknowns.
    ///
    /// # Errors
    /// The device's fault.
    pub fn v_cycle(&self, context: &GpuContext, b: &[f32]) -> Result<(), GpuError> {
        context.upload_at(&self.levels.levels[0].b, 0, b)?;
        self.repeat(context, SolvePart::Cycle, 1, 1)
    }

    /// What slot 0 has on a level, the finest being 0.
    ///
    /// # Errors
    /// The device's fault.
    pub fn on_level(&self, context: &GpuContext, l: usize) -> Result<OnLevel, GpuError> {
        let level = &self.levels.levels[l];
        let (nodes, width) = level.size();
        let mut out = OnLevel {
            width,
            matrix: vec![0.0; 9 * width * nodes],
            inverse: vec![0.0; 9 * nodes],
            b: vec![0.0; 3 * nodes],
            x: vec![0.0; 3 * nodes],
        };
        let mut halves = vec![0; out.matrix.len()];
        context.download_at(&level.matrix, 0, &mut halves)?;
        join(&halves, nodes, &mut out.matrix);
        context.download_at(&level.inverse, 0, &mut out.inverse)?;
        context.download_at(&level.b, 0, &mut out.b)?;
        context.download_at(&level.x, 0, &mut out.x)?;
        Ok(out)
    }

    /// The last cycle of slot 0, right after a solution.
    ///
    /// # Errors
    /// The device's fault.
    pub fn last_cycle(&self, context: &GpuContext) -> Result<Cycle, GpuError> {
        let mut record = [Record::default()];
        context.download_at(&self.arrays.records, 0, &mut record)?;
        let steps = record[0].steps as usize;
        let vectors = |n: usize| vec![0.0; n * self.unknowns];
        let mut small = vec![0.0; small_numbers()];
        let mut out = Cycle {
            steps,
            residual: record[0].residual,
            basis: vectors(steps),
            preconditioned: vectors(steps),
            combination: Vec::new(),
            solution: vectors(1),
            answer: vectors(1),
        };
        context.download_at(&self.arrays.basis, 0, &mut out.basis)?;
        context.download_at(&self.arrays.preconditioned, 0, &mut out.preconditioned)?;
        context.download_at(&self.arrays.small, 0, &mut small)?;
        context.download_at(&self.arrays.solution, 0, &mut out.solution)?;
        context.download_at(&self.arrays.answer, 0, &mut out.answer)?;
        out.combination = small[small.len() - RESTART..][..steps].to_vec();
        Ok(out)
    }
}

/// Numbers of halves that lie as `halves.wgsl` says.
fn join(halves: &[u32], nodes: usize, to: &mut [f32]) {
    let (upper, lower) = halves.split_at(halves.len() / 2);
    for ((pair, upper), lower) in to.chunks_exact_mut(2 * nodes).zip(upper.chunks_exact(nodes)).zip(lower.chunks_exact(nodes)) {
        let (first, second) = pair.split_at_mut(nodes);
        for (node, (&u, &l)) in upper.iter().zip(lower).enumerate() {
            let whole = |u: u32, l: u32| f32::from_bits((u & 0xffff_0000).wrapping_add((l.cast_signed() >> 16).cast_unsigned()));
            first[node] = whole(u << 16, l << 16);
            second[node] = whole(u, l);
        }
    }
}
