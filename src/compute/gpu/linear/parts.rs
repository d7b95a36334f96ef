//! Parts of a linear solve by themselves: how long they take, and what they move.

use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::calls::append;
use super::records::Record;
use super::sizes::Account;
use super::solver::Linear;

/// A part of a linear solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
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

impl Part {
    /// All of them, with the names of their rows.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Matrix, "matrix"),
        (Self::Galerkin, "Galerkin"),
        (Self::Smoother, "smoother"),
        (Self::Product, "product"),
        (Self::Cycle, "V-cycle"),
    ];
}

impl Linear {
    /// Runs a part `times` times for so many slots, over the numbers that are there, and waits.
    ///
    /// # Errors
    /// The device's fault.
    pub fn repeat(&self, context: &GpuContext, part: Part, slots: usize, times: usize) -> Result<(), GpuError> {
        // Slots that are done would be left out.
        context.upload_at(&self.arrays.records, 0, &Record::of_slots(slots))?;
        let mut list = context.record();
        for _ in 0..times {
            match part {
                Part::Matrix => self.kernels.assemble.append(&mut list, slots)?,
                Part::Galerkin => append(self.levels.galerkin(), &mut list, slots)?,
                Part::Smoother => append(self.levels.smoother_step(), &mut list, slots)?,
                Part::Product => append(&self.kernels.iteration[..1], &mut list, slots)?,
                Part::Cycle => append(&self.levels.cycle, &mut list, slots)?,
            }
        }
        list.submit_and_read(&mut [self.arrays.records.read(0, &mut [Record::default()])?])
    }

    /// The account of a part.
    pub fn account(&self, part: Part) -> Account {
        let finest = &self.levels.levels[0];
        let (nodes, width) = finest.size();
        match part {
            Part::Matrix => Account { numbers: self.upper_numbers + 9 * width * nodes, shared: width * nodes, operations: 0 },
            Part::Galerkin => finest.galerkin_account(),
            Part::Smoother => finest.step_account(),
            Part::Product => finest.product_account(),
            Part::Cycle => self.levels.cycle_account(),
        }
    }
}
