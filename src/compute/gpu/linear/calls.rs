//! Kernels with the threads that they take, and for which slots they are dispatched.

use std::collections::BTreeSet;

use super::super::arguments::{Argument, args};
use super::super::buffers::StorageBuffer;
use super::super::context::GpuContext;
use super::super::error::GpuError;
use super::super::kernel::Kernel;
use super::super::pipelines::{Bound, KernelList};
use super::super::source::Precision;
use super::records::Record;
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
