//! Compiling kernels once, and running them.

use super::arguments::Argument;
use super::buffers::{ReadBack, StorageBuffer};
use super::compiled::Pipeline;
use super::context::GpuContext;
use super::error::GpuError;
use super::kernel::Kernel;
use super::profile::{Moved, Stamps};
use super::reflect::{Binding, Variable};
use super::source::{Assembled, Precision};
use super::validate::validate;
use std::sync::{Arc, PoisonError};
use std::time::Instant;

/// Bytes of a number of workgroups.
const INDEX: u64 = size_of::<u32>() as u64;

/// A kernel with its arguments, ready to run; made once and run often.
#[derive(Debug)]
pub struct Bound {
    pipeline: Arc<Pipeline>,
    group: wgpu::BindGroup,
    /// None without a profile.
    pub(super) moved: Option<Moved>,
}

impl Bound {
    /// Workgroups of so many threads.
    pub fn groups(&self, threads: usize) -> usize {
        threads.div_ceil(self.pipeline.interface.workgroup as usize)
    }
}

/// Kernels to be run one after the other, each seeing what those before it wrote.
pub struct KernelList<'a> {
    context: &'a GpuContext,
    encoder: wgpu::CommandEncoder,
    /// What goes ahead of that, each in a submission of its own.
    ahead: Vec<wgpu::CommandBuffer>,
    commands: usize,
    dispatches: u64,
    /// Kernels of a piece; none where the list goes whole.
    most: Option<u64>,
    /// None without a profile.
    stamps: Option<Stamps>,
    counted: Option<usize>,
}

impl GpuContext {
    /// The kernel compiled in one precision; compiled at the first call, from memory afterwards.
    ///
    /// # Errors
    /// [`GpuError::NoDoublePrecision`], [`GpuError::Shader`], [`GpuError::Rejected`], or the
    /// device's fault.
    pub fn pipeline(&self, kernel: &'static Kernel, precision: Precision) -> Result<Arc<Pipeline>, GpuError> {
        self.supports(precision)?;
        // Held while compiling: a second thread that wants the same kernel waits for it and does
        // not compile it again.
        let mut compiled = self.pipelines.compiled.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(pipeline) = compiled.get(&(kernel.name, precision)) {
            return Ok(Arc::clone(pipeline));
        }
        let start = Instant::now();
        let source = kernel.assemble(precision);
        let pipeline =
            Arc::new(self.compile(kernel, &source).inspect_err(|e| log::debug!("{} in {precision}: {e}", kernel.name))?);
        log::debug!("compiled {} in {precision}: {:.3} s before the driver's share", kernel.name, start.elapsed().as_secs_f64());
        compiled.insert((kernel.name, precision), Arc::clone(&pipeline));
        Ok(pipeline)
    }

    fn compile(&self, kernel: &'static Kernel, source: &Assembled) -> Result<Pipeline, GpuError> {
        let interface = kernel.interface()?;
        let module = self.module(kernel.name, source)?;
        let entries: Vec<wgpu::BindGroupLayoutEntry> = interface.variables.iter().map(layout_entry).collect();
        let label = Some(kernel.name);
        self.scoped(kernel.name, || {
            let layout = self.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label, entries: &entries });
            let pipeline_layout = self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
                label,
                bind_group_layouts: &[Some(&layout)],
                immediate_size: 0,
            });
            let raw = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label,
                layout: Some(&pipeline_layout),
                module: &module,
                entry_point: Some(kernel.name),
                compilation_options: Default::default(),
                cache: None,
            });
            Pipeline { raw, layout, kernel, interface, precision: source.precision }
        })
    }

    /// Bounds checks or not, as [`GpuContext::with_checks`] says.
    fn module(&self, name: &str, source: &Assembled) -> Result<wgpu::ShaderModule, GpuError> {
        let descriptor =
            wgpu::ShaderModuleDescriptor { label: Some(name), source: wgpu::ShaderSource::Wgsl(source.text.as_str().into()) };
        let made = self.scoped(name, || {
            if self.checked {
                self.device.create_shader_module(descriptor)
            } else {
                // SAFETY: the source is compiled into this program. Its kernels return at once
                // beyond the dimensions in their uniform block, whose drivers size every bound
                // array by those dimensions. All their loops have fixed counts, or run along lists
                // built by this program, or to the vectors and steps of a record, which only
                // kernels raise, to the length of a cycle. Debug builds run the same kernels with
                // the checks on.
                #[allow(unsafe_code)]
                unsafe {
                    self.device.create_shader_module_trusted(descriptor, wgpu::ShaderRuntimeChecks::unchecked())
                }
            }
        });
        made.map_err(|error| match (validate(source), error) {
            // naga's own words with the place in the file, where it is the source that is wrong
            (Err(located), GpuError::Rejected { .. }) => located,
            (_, error) => error,
        })
    }

    /// Binds arguments to a kernel in one precision, each to the variable of its name.
    ///
    /// # Errors
    /// [`GpuError::Argument`] for one that is missing, unknown or there twice; as
    /// [`GpuContext::pipeline`].
    pub fn bind(&self, kernel: &'static Kernel, precision: Precision, arguments: &[Argument<'_>]) -> Result<Bound, GpuError> {
        let pipeline = self.pipeline(kernel, precision)?;
        let (interface, kernel) = (pipeline.interface, pipeline.kernel.name);
        let arguments = interface.in_order(kernel, arguments)?;
        let entries: Vec<wgpu::BindGroupEntry<'_>> = std::iter::zip(&interface.variables, &arguments)
            .map(|(variable, argument)| wgpu::BindGroupEntry { binding: variable.binding, resource: argument.resource.clone() })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: Some(kernel), layout: &pipeline.layout, entries: &entries };
        let group = self.scoped(kernel, || self.device.create_bind_group(&descriptor))?;
        let moved = self.moved(&pipeline, arguments.iter().map(|argument| argument.array).collect());
        Ok(Bound { pipeline, group, moved })
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("kernels") })
    }

    /// Starts a list of kernels to be run in one submission, or in several where the last list took
    /// too long for a driver's patience. They are sent one right after the other, once the list is
    /// complete: what is uploaded meanwhile comes before all of them.
    pub fn record(&self) -> KernelList<'_> {
        KernelList {
            context: self,
            encoder: self.encoder(),
            ahead: Vec::new(),
            commands: 0,
            dispatches: 0,
            most: self.pace.most(),
            stamps: self.stamps(),
            counted: None,
        }
    }
}

impl GpuContext {
    /// Sends a list off: what goes ahead of the last piece, and that.
    pub(super) fn send(&self, (ahead, last): (Vec<wgpu::CommandBuffer>, wgpu::CommandEncoder)) -> wgpu::SubmissionIndex {
        for piece in ahead {
            self.queue.submit([piece]);
            self.pace.sent_ahead();
        }
        self.queue.submit([last.finish()])
    }
}

impl KernelList<'_> {
    /// Appends one kernel: `threads` along x (rounded up to whole workgroups) for each of `cases`
    /// along y.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] beyond the device's number of workgroups.
    pub fn dispatch(&mut self, bound: &Bound, threads: usize, cases: usize) -> Result<(), GpuError> {
        self.append(bound, threads, cases, None)
    }

    /// The same for as many of these cases as the numbers at a place of `calls` say when the
    /// kernel's turn comes (workgroups along x, y and z); along x they are those of so many
    /// threads.
    ///
    /// # Errors
    /// As [`KernelList::dispatch`].
    pub fn dispatch_as_told(
        &mut self,
        bound: &Bound,
        threads: usize,
        cases: usize,
        calls: (&StorageBuffer<u32>, usize),
    ) -> Result<(), GpuError> {
        self.append(bound, threads, cases, Some(calls))
    }

    fn append(
        &mut self,
        bound: &Bound,
        threads: usize,
        cases: usize,
        calls: Option<(&StorageBuffer<u32>, usize)>,
    ) -> Result<(), GpuError> {
        let kernel = bound.pipeline.kernel;
        let groups = bound.groups(threads);
        let limit = self.context.adapter().max_workgroups;
        if groups.max(cases) > limit as usize {
            let what = format!("the number of workgroups of {} (in place of bytes)", kernel.name);
            return Err(GpuError::TooLarge { what, bytes: groups.max(cases) as u64, limit: limit.into() });
        }
        if groups == 0 || cases == 0 {
            return Ok(());
        }
        if self.most.is_some_and(|most| self.dispatches > 0 && self.dispatches.is_multiple_of(most)) {
            let piece = std::mem::replace(&mut self.encoder, self.context.encoder());
            self.ahead.push(piece.finish());
        }
        let timestamp_writes = match (&mut self.stamps, &bound.moved) {
            (Some(stamps), Some(moved)) => self.context.stamp(stamps, moved, self.counted.unwrap_or(cases).min(cases))?,
            _ => None,
        };
        let mut pass =
            self.encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: Some(kernel.name), timestamp_writes });
        pass.set_pipeline(&bound.pipeline.raw);
        pass.set_bind_group(0, &bound.group, &[]);
        match calls {
            _ if self.context.leaves_out(kernel.name) => pass.dispatch_workgroups(0, 0, 0),
            Some((calls, place)) => pass.dispatch_workgroups_indirect(&calls.raw, calls.first + place as u64 * INDEX),
            None => pass.dispatch_workgroups(groups as u32, cases as u32, 1),
        }
        self.commands += 1;
        self.dispatches += 1;
        Ok(())
    }

    /// Counts the bytes of the kernels that follow for so many slots; without a number for all that
    /// they are dispatched for. It changes nothing but what a profile says of them.
    pub fn count_for(&mut self, slots: Option<usize>) {
        self.counted = slots;
    }

    /// Appends a copy of `count` elements from one array to another, after the kernels before it.
    ///
    /// # Errors
    /// [`GpuError::Length`] beyond the end of either.
    pub fn copy<T>(
        &mut self,
        from: &StorageBuffer<T>,
        first: usize,
        to: &StorageBuffer<T>,
        to_first: usize,
        count: usize,
    ) -> Result<(), GpuError> {
        for (buffer, first) in [(from, first), (to, to_first)] {
            if first.checked_add(count).is_none_or(|end| end > buffer.len()) {
                return Err(GpuError::Length { what: buffer.what().to_owned(), expected: buffer.len(), given: first + count });
            }
        }
        let size = size_of::<T>() as u64;
        let (at, to_at) = (from.first + first as u64 * size, to.first + to_first as u64 * size);
        self.encoder.copy_buffer_to_buffer(&from.raw, at, &to.raw, to_at, count as u64 * size);
        self.commands += 1;
        Ok(())
    }

    /// Appends that `count` elements of an array become zero, after the kernels before it. Elements
    /// of less than four bytes are not supported by wgpu.
    ///
    /// # Errors
    /// [`GpuError::Length`] beyond the end.
    pub fn clear<T>(&mut self, array: &StorageBuffer<T>, first: usize, count: usize) -> Result<(), GpuError> {
        if first.checked_add(count).is_none_or(|end| end > array.len()) {
            return Err(GpuError::Length { what: array.what().to_owned(), expected: array.len(), given: first + count });
        }
        let size = size_of::<T>() as u64;
        self.encoder.clear_buffer(&array.raw, array.first + first as u64 * size, Some(count as u64 * size));
        self.commands += 1;
        Ok(())
    }

    /// Sends the list off, waits for it and reads arrays back as it leaves them: one submission,
    /// one wait.
    ///
    /// The numbers come back together with a ticket, a number that was never used before. Only if
    /// the ticket has arrived did this submission run, and only then are the numbers those that the
    /// kernels left.
    ///
    /// # Errors
    /// [`GpuError::Stale`], [`GpuError::Lost`], [`GpuError::Timeout`], [`GpuError::Rejected`]: then
    /// no numbers come back at all.
    pub fn submit_and_read(mut self, reads: &mut [ReadBack<'_>]) -> Result<(), GpuError> {
        if let Some(stamps) = &self.stamps {
            stamps.resolve(&mut self.encoder);
        }
        let submission = self.context.read_after((self.ahead, self.encoder), self.dispatches, reads)?;
        self.context.waited_for(self.stamps, &submission);
        Ok(())
    }

    /// Sends the list off. Errors of the kernels themselves show at the next download.
    ///
    /// # Errors
    /// [`GpuError::Rejected`], or the device's fault.
    pub fn submit(mut self) -> Result<(), GpuError> {
        if self.commands == 0 {
            return self.context.check();
        }
        if let Some(stamps) = &self.stamps {
            stamps.resolve(&mut self.encoder);
        }
        self.context.scoped("a list of kernels", || self.context.send((self.ahead, self.encoder)))?;
        self.context.meter.submitted(self.dispatches);
        self.context.sent(self.stamps);
        Ok(())
    }
}

fn layout_entry(variable: &Variable) -> wgpu::BindGroupLayoutEntry {
    let ty = match variable.kind {
        Binding::Uniform => wgpu::BufferBindingType::Uniform,
        Binding::Read => wgpu::BufferBindingType::Storage { read_only: true },
        Binding::ReadWrite => wgpu::BufferBindingType::Storage { read_only: false },
    };
    wgpu::BindGroupLayoutEntry {
        binding: variable.binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
        count: None,
    }
}
