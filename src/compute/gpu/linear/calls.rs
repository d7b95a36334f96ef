//! Kernels with the threads that they take, and for which slots they are dispatched.

use std::collections::BTreeSet;

use super::super::arguments::{Argument, args};
use super::super::buffers::StorageBuffer;
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::kernel::Kernel;
use super::super::pipelines::{Bound, KernelList};
use super::super::source::Precision;
use super::records::{Record, Solves};
use super::sizes::LevelShape;
use super::sources::KRYLOV_RUNNING;

/// A kernel with the threads that it takes.
#[derive(Debug)]
pub struct SizedKernel {
    pub(super) bound: Bound,
    threads: usize,
}

impl SizedKernel {
    /// Binds a kernel, in single precision.
    ///
    /// # Errors
    /// As [`GpuContext::bind`].
    pub fn new(
        context: &GpuContext,
        kernel: &'static Kernel,
        threads: usize,
        arguments: &[Argument<'_>],
    ) -> Result<Self, GpuError> {
        Ok(Self { bound: context.bind(kernel, Precision::F32, arguments)?, threads })
    }

    /// One that takes its arguments in another precision.
    pub fn of(bound: Bound, threads: usize) -> Self {
        Self { bound, threads }
    }

    /// Workgroups of a slot.
    pub fn groups(&self) -> usize {
        self.bound.groups(self.threads)
    }

    /// Appends it for those of so many slots that run; the place is where `calls` has its
    /// workgroups.
    ///
    /// # Errors
    /// As [`KernelList::dispatch`].
    pub fn append_running(
        &self,
        list: &mut KernelList<'_>,
        slots: usize,
        calls: (&StorageBuffer<u32>, usize),
    ) -> Result<(), GpuError> {
        list.dispatch_as_told(&self.bound, self.threads, slots, calls)
    }

    /// Appends it for so many slots.
    ///
    /// # Errors
    /// As [`KernelList::dispatch`].
    pub fn append(&self, list: &mut KernelList<'_>, slots: usize) -> Result<(), GpuError> {
        list.dispatch(&self.bound, self.threads, slots)
    }
}

/// Appends kernels for so many slots.
///
/// # Errors
/// As [`KernelList::dispatch`].
pub fn append(calls: &[SizedKernel], list: &mut KernelList<'_>, slots: usize) -> Result<(), GpuError> {
    calls.iter().try_for_each(|call| call.append(list, slots))
}

/// What Krylov iterations are dispatched for: the slots that run.
#[derive(Debug)]
pub struct RunningSlots {
    /// Workgroups along x, y and z, for each number of them along x.
    calls: StorageBuffer<u32>,
    /// The numbers along x, increasing.
    groups: Vec<usize>,
    /// Lists the slots, and writes how many there are.
    pub list: SizedKernel,
}

impl RunningSlots {
    /// That of kernels which have so many workgroups for a slot.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(
        context: &GpuContext,
        groups: impl Iterator<Item = usize>,
        level: &StorageBuffer<LevelShape>,
        records: &StorageBuffer<Record>,
    ) -> Result<Self, GpuError> {
        Self::of(context, groups, |calls| SizedKernel::new(context, &KRYLOV_RUNNING, 1, &args! { level, records, calls }))
    }

    /// The same where another kernel writes the numbers.
    ///
    /// # Errors
    /// What the device says.
    pub fn of(
        context: &GpuContext,
        groups: impl Iterator<Item = usize>,
        list: impl FnOnce(&StorageBuffer<u32>) -> Result<SizedKernel, GpuError>,
    ) -> Result<Self, GpuError> {
        let groups: Vec<usize> = groups.collect::<BTreeSet<_>>().into_iter().collect();
        let numbers: Vec<u32> = groups.iter().flat_map(|&groups| [groups as u32, 0, 1]).collect();
        let calls = context.calls("workgroups of slots that run", &numbers)?;
        let list = list(&calls)?;
        Ok(Self { calls, groups, list })
    }

    /// Appends kernels for the slots of the list.
    ///
    /// # Errors
    /// As [`KernelList::dispatch`].
    pub fn append(&self, kernels: &[SizedKernel], list: &mut KernelList<'_>, slots: usize) -> Result<(), GpuError> {
        kernels.iter().try_for_each(|call| {
            let place = self.groups.partition_point(|&groups| groups < call.groups());
            call.append_running(list, slots, (&self.calls, 3 * place))
        })
    }
}

/// Has a profile count what the Krylov iterations of solutions moved since they were counted last:
/// kernels with how many of them a slot has, and those that come after the iterations.
pub fn count(context: &GpuContext, solves: &mut Solves, of_iteration: &[(&SizedKernel, usize)], finish: &[SizedKernel]) {
    if !context.is_profiled() {
        return;
    }
    let new = solves.records.iter().zip(&solves.counted).map(|(r, counted)| r.iterations.saturating_sub(*counted));
    let new: Vec<u32> = new.collect();
    for i in 0..new.iter().copied().max().unwrap_or(0) {
        let running = || solves.records.iter().zip(&new).filter(|(_, new)| i < **new);
        // Those that run are all in the same step, which takes one vector more than the last.
        let vectors = running().map(|(r, new)| (r.steps + i).saturating_sub(*new) + 1).max().unwrap_or(0);
        for (call, times) in of_iteration {
            context.credit(call.bound.moved.as_ref(), times * running().count(), vectors as usize);
        }
    }
    for record in &solves.records {
        for call in finish {
            context.credit(call.bound.moved.as_ref(), 1, record.steps as usize);
        }
    }
    solves.counted = solves.records.iter().map(|record| record.iterations).collect();
}
