//! The linear solver of a batch's slots.

use super::super::buffers::{DeviceReal, ReadBack, StorageBuffer};
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::pipelines::KernelList;
use super::super::pools::Pools;
use super::arrays::Arrays;
use super::calls::{SizedKernel, append, count};
use super::kernels::LinearKernels;
use super::levels::Levels;
use super::plan::Plan;
use super::records::{FULL, RUNNING, Record, Solves};
use super::tied::{TiedSolver, Ties};
use crate::compute::CaseModel;
use crate::compute::linear::SideReport;

/// Krylov iterations of a list that goes on with those that have not finished.
const MORE: usize = 4;

/// One right-hand side of every slot, `[slot][component][node]`.
#[derive(Debug, Default)]
pub struct Right {
    /// Right-hand sides; at fixed unknowns their values.
    pub rhs: Vec<f32>,
    /// Guesses, the values of fixed unknowns in them; none if all are zero.
    pub guess: Option<Vec<f32>>,
    /// Relative residual to be reached, by slot.
    pub tolerance: Vec<f32>,
    /// Whether it is relative to the residual at the guess, by slot.
    pub relative_to_guess: Vec<bool>,
    /// Krylov iterations that the slot that takes most will probably take.
    pub expected: usize,
}

/// Solutions `[slot][component][node]` of one side, and how they went by slot.
pub type SideSolutions = (Vec<f32>, Vec<SideReport>);

/// The linear solver of a batch's slots.
#[derive(Debug)]
pub struct SlotSolver {
    pub(super) levels: Levels,
    pub(super) arrays: Arrays,
    pub(super) kernels: LinearKernels,
    pub(super) unknowns: usize,
    /// Numbers of the tangent's upper blocks.
    pub(super) upper_numbers: usize,
    /// As `assemble.wgsl` has them.
    counts: [u32; 4],
    /// The systems of pairs, if the batch is of those.
    tied: Option<TiedSolver>,
}

impl SlotSolver {
    /// The arrays and kernels for so many slots, some in memory that they share with others;
    /// `blocks` are the tangents that the gathering kernels leave.
    ///
    /// # Errors
    /// What the device says.
    pub fn new<T: DeviceReal>(
        context: &GpuContext,
        plan: &Plan,
        slots: (usize, &Pools),
        blocks: &StorageBuffer<T>,
    ) -> Result<Self, GpuError> {
        let records = context.zeros("linear solves", slots.0)?;
        let levels = Levels::new(context, &plan.layout, slots, plan.plate.len(), &records)?;
        let arrays = Arrays::new(context, plan, slots, records)?;
        let kernels = LinearKernels::new(context, plan, (&levels, &arrays), blocks)?;
        let unknowns = 3 * plan.layout.levels[0].nodes;
        let tied =
            plan.tied.as_ref().map(|tied| TiedSolver::new(context, tied, slots, (&levels.levels[0], &arrays, &kernels), blocks));
        let tied = tied.transpose()?;
        Ok(Self { levels, arrays, kernels, unknowns, upper_numbers: 9 * plan.upper_blocks, counts: plan.counts(), tied })
    }

    /// Has matrices turned into the frames of contact points where a case of the batch has a curved
    /// opponent: over planes alone there is nothing to turn.
    ///
    /// # Errors
    /// The device's fault.
    pub fn face(&self, context: &GpuContext, models: &[CaseModel]) -> Result<(), GpuError> {
        let is_curved = models.iter().any(|model| !model.surface.is_plane());
        let [blocks, points, ..] = self.counts;
        context.upload(&self.arrays.counts, &[[blocks, points, u32::from(is_curved), 0]])
    }

    /// Appends what makes the hierarchy's matrices from the tangents that are on the device.
    /// `rows` are the contact rows `[slot][slides, force rows, displacement rows][point]`, `fixed`
    /// the fixed components `[slot][node]`, a bit each.
    ///
    /// # Errors
    /// The device's fault.
    pub fn update(
        &self,
        context: &GpuContext,
        list: &mut KernelList<'_>,
        rows: &[f32],
        fixed: &[u32],
        slots: usize,
    ) -> Result<(), GpuError> {
        context.upload_at(&self.arrays.rows, 0, rows)?;
        context.upload_at(&self.levels.levels[0].fixed, 0, fixed)?;
        self.append_update(list, slots)
    }

    /// The same of pairs with what ties them; which of their systems are solved here.
    ///
    /// # Errors
    /// The device's fault.
    pub fn update_tied(
        &self,
        context: &GpuContext,
        list: &mut KernelList<'_>,
        (rows, fixed): (&[f32], &[u32]),
        ties: &Ties<'_>,
    ) -> Result<Vec<bool>, GpuError> {
        let Some(tied) = &self.tied else { return Ok(vec![false; ties.len()]) };
        context.upload_at(&self.arrays.rows, 0, rows)?;
        context.upload_at(&self.levels.levels[0].fixed, 0, fixed)?;
        let has_room = tied.send(context, ties)?;
        self.kernels.assemble.append(list, ties.len())?;
        tied.append_update(list, ties.len())?;
        Ok(has_room)
    }

    /// The same with rows and fixed components that are on the device.
    ///
    /// # Errors
    /// The device's fault.
    pub fn append_update(&self, list: &mut KernelList<'_>, slots: usize) -> Result<(), GpuError> {
        self.kernels.assemble.append(list, slots)?;
        append(&self.levels.update, list, slots)
    }

    /// Solves with a right-hand side of each slot after the kernels of `list`; returns the
    /// solutions `[slot][component][node]`. `and` are other arrays to be read at the first chance;
    /// `is_tied` says that the systems are those of [`SlotSolver::update_tied`].
    ///
    /// # Errors
    /// The device's fault.
    pub fn solve(
        &self,
        context: &GpuContext,
        mut list: KernelList<'_>,
        right: &Right,
        is_tied: bool,
        and: (&StorageBuffer<u32>, &mut [u32]),
    ) -> Result<(Vec<f32>, Vec<SideReport>), GpuError> {
        let slots = right.tolerance.len();
        let mut solves = Solves::new(&right.tolerance, &right.relative_to_guess, right.expected);
        context.upload_at(&self.arrays.rhs, 0, &right.rhs)?;
        if let Some(guess) = &right.guess {
            context.upload_at(&self.arrays.guess, 0, guess)?;
        }
        context.upload_at(&self.arrays.records, 0, &solves.records)?;
        self.append_begin(&mut list, slots, right.guess.is_some(), is_tied)?;
        let mut answer = vec![0.0; slots * self.unknowns];
        self.iterate_of(&mut list, solves.first_list(), slots, is_tied)?;
        list.submit_and_read(&mut [self.read(&mut solves)?, self.arrays.answer.read(0, &mut answer)?, and.0.read(0, and.1)?])?;
        let count = |solves: &mut Solves| match self.tied(is_tied) {
            Some(tied) => tied.count(context, &self.kernels.next, solves),
            None => self.count(context, solves),
        };
        count(&mut solves);
        while solves.go_on() {
            let mut list = context.record();
            self.take_up_of(context, &mut list, &mut solves, is_tied)?;
            list.submit_and_read(&mut [self.read(&mut solves)?, self.arrays.answer.read(0, &mut answer)?])?;
            count(&mut solves);
        }
        Ok((answer, solves.reports()))
    }

    /// Appends what begins solutions with the right-hand sides that are on the device, and with the
    /// guesses that are if they count.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_out(&self, context: &GpuContext, list: &mut KernelList<'_>, solves: &Solves, guess: bool) -> Result<(), GpuError> {
        context.upload_at(&self.arrays.records, 0, &solves.records)?;
        self.append_begin(list, solves.slots(), guess, false)
    }

    /// The same after other solutions of the list: `records`, to which it was told how these begin,
    /// are on the device.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_out_after(
        &self,
        list: &mut KernelList<'_>,
        records: &StorageBuffer<Record>,
        slots: usize,
        guess: bool,
    ) -> Result<(), GpuError> {
        list.copy(records, 0, &self.arrays.records, 0, slots)?;
        self.append_begin(list, slots, guess, false)
    }

    /// Appends a copy of how the present solutions stand.
    ///
    /// # Errors
    /// The device's fault.
    pub fn append_keep(&self, list: &mut KernelList<'_>, records: &StorageBuffer<Record>, slots: usize) -> Result<(), GpuError> {
        list.copy(&self.arrays.records, 0, records, 0, slots)
    }

    fn residual(&self, is_tied: bool) -> &[SizedKernel] {
        self.tied(is_tied).map_or(&self.kernels.residual, |tied| &tied.residual)
    }

    fn append_begin(&self, list: &mut KernelList<'_>, slots: usize, guess: bool, is_tied: bool) -> Result<(), GpuError> {
        self.kernels.prescribe.append(list, slots)?;
        append(self.residual(is_tied), list, slots)?;
        self.kernels.measure.append(list, slots)?;
        if guess {
            list.copy(&self.arrays.guess, 0, &self.arrays.solution, 0, slots * self.unknowns)?;
            append(self.residual(is_tied), list, slots)?;
        }
        append(&self.kernels.begin, list, slots)
    }

    /// Appends more of solutions that have not finished.
    ///
    /// # Errors
    /// The device's fault.
    pub fn take_up(&self, context: &GpuContext, list: &mut KernelList<'_>, solves: &mut Solves) -> Result<(), GpuError> {
        self.take_up_of(context, list, solves, false)
    }

    fn take_up_of(
        &self,
        context: &GpuContext,
        list: &mut KernelList<'_>,
        solves: &mut Solves,
        is_tied: bool,
    ) -> Result<(), GpuError> {
        let slots = solves.slots();
        // All slots are in the same step of their cycles: those that go on are all full, or none.
        let records = &mut solves.records;
        let full: Vec<usize> = (0..slots).filter(|&slot| records[slot].done == FULL && records[slot].goes_on()).collect();
        for &slot in &full {
            // The next cycle begins at the answer of this one.
            list.copy(&self.arrays.answer, slot * self.unknowns, &self.arrays.solution, slot * self.unknowns, self.unknowns)?;
            (records[slot].done, records[slot].vectors, records[slot].steps) = (RUNNING, 0, 0);
            context.upload_at(&self.arrays.records, slot, &[records[slot]])?;
        }
        if !full.is_empty() {
            list.count_for(Some(full.len()));
            append(self.residual(is_tied), list, slots)?;
            append(&self.kernels.begin, list, slots)?;
        }
        self.iterate_of(list, MORE, slots, is_tied)
    }

    /// What is to be read back of solutions.
    ///
    /// # Errors
    /// [`GpuError::Length`] for more slots than there are.
    pub fn read<'a>(&'a self, solves: &'a mut Solves) -> Result<ReadBack<'a>, GpuError> {
        self.arrays.records.read(0, &mut solves.records)
    }

    /// Has a profile count what the Krylov iterations moved that came back in `solves`, which are
    /// those of one list, and the answers after them.
    pub fn count(&self, context: &GpuContext, solves: &mut Solves) {
        let of_iteration = self.levels.cycle.iter().chain(&self.kernels.iteration).chain([&self.kernels.next]);
        count(context, solves, &of_iteration.map(|call| (call, 1)).collect::<Vec<_>>(), &self.kernels.finish);
    }

    /// The systems of pairs, where a solution is one of those.
    fn tied(&self, is_tied: bool) -> Option<&TiedSolver> {
        self.tied.as_ref().filter(|_| is_tied)
    }

    /// The arrays that Newton's iterates fill and read.
    pub fn of_iterates(&self) -> OfIterates<'_> {
        OfIterates {
            rhs: &self.arrays.rhs,
            fixed: &self.levels.levels[0].fixed,
            rows: &self.arrays.rows,
            guess: &self.arrays.guess,
            answer: &self.arrays.answer,
        }
    }

    /// Appends Krylov iterations, and the answers after them.
    ///
    /// # Errors
    /// The device's fault.
    pub fn iterate(&self, list: &mut KernelList<'_>, times: usize, slots: usize) -> Result<(), GpuError> {
        self.iterate_of(list, times, slots, false)
    }

    fn iterate_of(&self, list: &mut KernelList<'_>, times: usize, slots: usize, is_tied: bool) -> Result<(), GpuError> {
        if let Some(tied) = self.tied(is_tied) {
            return tied.iterate(list, &self.kernels.next, times, slots);
        }
        // Which slots leave them out is known when they have run: see `count`.
        list.count_for(Some(0));
        let running = &self.kernels.running;
        running.list.append(list, slots)?;
        for _ in 0..times {
            running.append(&self.levels.cycle, list, slots)?;
            running.append(&self.kernels.iteration, list, slots)?;
            running.list.append(list, slots)?;
            running.append(std::slice::from_ref(&self.kernels.next), list, slots)?;
        }
        append(&self.kernels.finish, list, slots)?;
        list.count_for(None);
        Ok(())
    }
}

/// Arrays of the solver by which Newton's iterates reach it.
#[derive(Debug)]
pub struct OfIterates<'a> {
    /// Right-hand sides.
    pub rhs: &'a StorageBuffer<f32>,
    /// Fixed components.
    pub fixed: &'a StorageBuffer<u32>,
    /// Rows of points that slide.
    pub rows: &'a StorageBuffer<f32>,
    /// Guesses.
    pub guess: &'a StorageBuffer<f32>,
    /// Solutions.
    pub answer: &'a StorageBuffer<f32>,
}
