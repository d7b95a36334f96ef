//! Parts of a linear solve by themselves: how long they take, and what they move.

use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::calls::append;
use super::records::Record;
use super::sizes::Cost;
use super::solver::SlotSolver;

/// A part of a linear solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolvePart {
    /// The finest matrix from the tangent's upper blocks.
    Matrix,
    /// The next level's matrix from the finest one.
    Galerkin,
    /// A step of the smoother on the finest level.
    Smoother,
    /// A product with the finest matrix.
    Product,
    /// A V-cycle.
    Cycle,
}

impl SolvePart {
    /// All of them, with the names of their rows.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Matrix, "matrix"),
        (Self::Galerkin, "Galerkin"),
        (Self::Smoother, "smoother"),
        (Self::Product, "product"),
        (Self::Cycle, "V-cycle"),
    ];
}

impl SlotSolver {
    /// Runs a part `times` times for so many slots, over the numbers that are there, and waits.
    ///
    /// # Errors
    /// The device's fault.
    pub fn repeat(&self, context: &GpuContext, part: SolvePart, slots: usize, times: usize) -> Result<(), GpuError> {
        // Slots that are done would be left out.
        context.upload_at(&self.arrays.records, 0, &Record::of_slots(slots))?;
        let mut list = context.record();
        for _ in 0..times {
            match part {
                SolvePart::Matrix => self.kernels.assemble.append(&mut list, slots)?,
                SolvePart::Galerkin => append(self.levels.galerkin(), &mut list, slots)?,
                SolvePart::Smoother => append(self.levels.smoother_step(), &mut list, slots)?,
                SolvePart::Product => append(&self.kernels.iteration[..1], &mut list, slots)?,
                SolvePart::Cycle => append(&self.levels.cycle, &mut list, slots)?,
            }
        }
        list.submit_and_read(&mut [self.arrays.records.read(0, &mut [Record::default()])?])
    }

    /// The account of a part.
    pub fn account(&self, part: SolvePart) -> Cost {
        let finest = &self.levels.levels[0];
        let (nodes, width) = finest.size();
        match part {
            SolvePart::Matrix => Cost { numbers: self.upper_numbers + 9 * width * nodes, shared: width * nodes, operations: 0 },
            SolvePart::Galerkin => finest.galerkin_account(),
            SolvePart::Smoother => finest.step_account(),
            SolvePart::Product => finest.product_account(),
            SolvePart::Cycle => self.levels.cycle_account(),
        }
    }
}
