//! How linear solves stand, slot by slot.

use super::super::buffers::{ReadBack, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::sizes::RESTART;
use crate::compute::linear::{Ended, SideReport};

/// Iterations after which a system is given up.
const MOST: usize = 120;

/// What `record.wgsl` calls them.
pub(in super::super) const RUNNING: u32 = 0;
pub(in super::super) const CONVERGED: u32 = 1;
pub(in super::super) const FULL: u32 = 2;
pub(in super::super) const NOT_FINITE: u32 = 4;

/// What a slot solves, as `record.wgsl` has it.
#[derive(Clone, Copy, Debug, Default, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Record {
    /// 0 while it goes on.
    pub done: u32,
    /// Basis vectors that are complete.
    pub vectors: u32,
    /// Steps of the present cycle.
    pub steps: u32,
    /// Krylov iterations in all.
    pub iterations: u32,
    /// The tolerance is of the first residual.
    pub relative_to_start: u32,
    /// Relative residual to be reached.
    pub tolerance: f32,
    /// Norm of the residual to be reached.
    pub goal: f32,
    /// Norm of the right-hand side.
    pub rhs_norm: f32,
    /// Norm of the residual at the guess.
    pub start_norm: f32,
    /// Norm of the residual.
    pub residual: f32,
    /// Factor of the next basis vector.
    pub scale: f32,
    /// Plate force along the solution.
    pub along: f32,
    /// Which slot is here in the list of those that run, and after them the others.
    pub running: u32,
}

impl Record {
    /// How each of so many slots begins, all of them running.
    pub fn of_slots(slots: usize) -> Vec<Self> {
        (0..slots as u32).map(|running| Self { running, ..Self::default() }).collect()
    }

    /// Whether it has not finished.
    pub fn goes_on(&self) -> bool {
        (self.done == RUNNING || self.done == FULL) && (self.iterations as usize) < MOST
    }

    /// How it went.
    pub fn report(&self) -> SideReport {
        SideReport {
            ended: match self.done {
                CONVERGED => Ended::Converged,
                NOT_FINITE => Ended::NotFinite,
                _ => Ended::Stalled,
            },
            iterations: self.iterations as usize,
            rhs_norm: self.rhs_norm.into(),
            start_norm: self.start_norm.into(),
            residual: self.residual.into(),
            along: self.along.into(),
        }
    }
}

/// How solutions stand, a slot each.
#[derive(Clone, Debug)]
pub struct Solves {
    pub(super) records: Vec<Record>,
    expected: usize,
    /// Krylov iterations whose bytes a profile has, by slot.
    pub(super) counted: Vec<u32>,
}

impl Solves {
    /// Solutions to these relative residuals, of the right-hand side or of the residual at the
    /// guess; that which takes most will probably take `expected` Krylov iterations.
    pub fn new(tolerance: &[f32], relative_to_guess: &[bool], expected: usize) -> Self {
        let mut records = Record::of_slots(tolerance.len());
        for ((record, &tolerance), &relative) in records.iter_mut().zip(tolerance).zip(relative_to_guess) {
            (record.tolerance, record.relative_to_start) = (tolerance, relative.into());
        }
        Self { records, expected, counted: vec![0; tolerance.len()] }
    }

    /// The same with `more` Krylov iterations in the first list.
    pub fn with_more(&self, more: usize) -> Self {
        Self { expected: self.expected + more, ..self.clone() }
    }

    /// How they begin, to be copied to where they are solved.
    ///
    /// # Errors
    /// The device's fault.
    pub fn send(&self, context: &GpuContext, to: &StorageBuffer<Record>) -> Result<(), GpuError> {
        context.upload_at(to, 0, &self.records)
    }

    /// What is to be read back of a copy of how they stand.
    ///
    /// # Errors
    /// [`GpuError::Length`] for more slots than there are.
    pub fn read_kept<'a>(&'a mut self, kept: &'a StorageBuffer<Record>) -> Result<ReadBack<'a>, GpuError> {
        kept.read(0, &mut self.records)
    }

    /// Number of slots.
    pub fn slots(&self) -> usize {
        self.records.len()
    }

    /// Krylov iterations of the first list.
    pub fn first_list(&self) -> usize {
        (self.expected + 1).min(RESTART)
    }

    /// Some have not finished.
    pub fn go_on(&self) -> bool {
        self.records.iter().any(Record::goes_on)
    }

    /// How they went.
    pub fn reports(&self) -> Vec<SideReport> {
        self.records.iter().map(Record::report).collect()
    }
}
