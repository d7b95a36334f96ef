//! Typed arrays on the device, within a memory budget; reading back is proved fresh.

use super::arguments::{Argument, Array, Extent};
use super::context::{GpuContext, PATIENCE};
use super::error::GpuError;
use super::memory::{Reservation, Staging};
use super::source::Precision;
use crate::real::Real;
use bytemuck::{Pod, cast_slice};
use std::marker::PhantomData;
use std::time::Instant;

/// Uploads go through pieces of this size, so that the driver's copy of what is on the way stays
/// small.
const UPLOAD_PIECE: usize = 32 << 20;
/// Bytes behind the numbers in the staging buffer: the ticket, and padding to the alignment of
/// mappings.
const TICKET_BYTES: u64 = 16;

/// A binding may begin at any multiple of this: Vulkan lets no driver ask for more.
pub const ALIGNMENT: u64 = 256;

/// A precision in which kernels run.
pub trait DeviceReal: Real + Pod {
    /// The prelude that goes with it.
    const PRECISION: Precision;
}

impl DeviceReal for f32 {
    const PRECISION: Precision = Precision::F32;
}

impl DeviceReal for f64 {
    const PRECISION: Precision = Precision::F64;
}

/// `count` records from `first` on, small enough to be processed in one go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Chunk {
    /// First record.
    pub first: usize,
    /// Number of records.
    pub count: usize,
}

/// Splits `records` into equal chunks whose widest array (`widest` bytes a record) is at most
/// `binding` bytes and whose arrays together (`total` bytes a record) take at most `memory` bytes.
///
/// # Errors
/// [`GpuError::TooLarge`] if a single record does not fit.
pub fn chunks(what: &str, records: usize, widest: u64, total: u64, binding: u64, memory: u64) -> Result<Vec<Chunk>, GpuError> {
    let too_large = |bytes, limit| GpuError::TooLarge { what: format!("{what}, one record"), bytes, limit };
    if widest > binding {
        return Err(too_large(widest, binding));
    }
    if total > memory {
        return Err(too_large(total, memory));
    }
    let most = (binding / widest.max(1)).min(memory / total.max(1)).max(1);
    let parts = (records as u64).div_ceil(most) as usize;
    let mut first = 0;
    Ok((0..parts)
        .map(|i| {
            // the first `records % parts` chunks are one longer
            let count = records / parts + usize::from(i < records % parts);
            first += count;
            Chunk { first: first - count, count }
        })
        .collect())
}

/// An array of `T` on the device, readable and writable by kernels.
#[derive(Debug)]
pub struct StorageBuffer<T> {
    pub(super) raw: wgpu::Buffer,
    what: String,
    len: usize,
    /// First byte in `raw`: 0 but of a view.
    pub(super) first: u64,
    extent: Extent,
    /// None of a view.
    _reservation: Option<Reservation>,
    _type: PhantomData<T>,
}

/// A part of an array that is to be read back after a list of kernels.
#[derive(Debug)]
pub struct ReadBack<'a> {
    raw: &'a wgpu::Buffer,
    what: &'a str,
    /// First byte.
    offset: u64,
    out: &'a mut [u8],
}

impl<T> StorageBuffer<T> {
    /// Number of elements.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether it has no elements.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Its name in errors.
    pub fn what(&self) -> &str {
        &self.what
    }

    /// The same, of which a kernel touches all, however many slots it serves: a list. This and
    /// [`StorageBuffer::each`] are for counting bytes.
    pub fn whole(self) -> Self {
        Self { extent: Extent::Whole, ..self }
    }

    /// The same, of which a kernel touches one of so many equal parts for each slot that it serves.
    pub fn each(self, parts: usize) -> Self {
        Self { extent: Extent::Each(parts as u64), ..self }
    }

    /// What is to be read back into `out`, from element `offset` on.
    ///
    /// # Errors
    /// [`GpuError::Length`] if `out` reaches beyond the end.
    pub fn read<'a>(&'a self, offset: usize, out: &'a mut [T]) -> Result<ReadBack<'a>, GpuError>
    where
        T: Pod,
    {
        if offset.checked_add(out.len()).is_none_or(|end| end > self.len) {
            return Err(GpuError::Length { what: self.what.clone(), expected: self.len, given: offset + out.len() });
        }
        let offset = self.first + (offset * size_of::<T>()) as u64;
        Ok(ReadBack { raw: &self.raw, what: &self.what, offset, out: bytemuck::cast_slice_mut(out) })
    }

    /// Another array in the same memory, for numbers that are not needed at the same time: no
    /// kernel may be bound to both, and what the one holds is lost when the other is written.
    ///
    /// # Errors
    /// [`GpuError::Length`] if it would be longer.
    pub fn view<U>(&self, what: &str, len: usize) -> Result<StorageBuffer<U>, GpuError> {
        self.view_after::<(), U>(None, what, len)
    }

    /// As [`StorageBuffer::view`], behind another view of the same memory: the two may be in use at
    /// the same time, but a kernel that writes one may not be bound to the other.
    ///
    /// # Errors
    /// As [`StorageBuffer::view`].
    pub fn view_after<V, U>(
        &self,
        before: Option<&StorageBuffer<V>>,
        what: &str,
        len: usize,
    ) -> Result<StorageBuffer<U>, GpuError> {
        let end = |view: &StorageBuffer<V>| view.first + (view.len * size_of::<V>()) as u64;
        let first = before.map_or(0, end).next_multiple_of(ALIGNMENT);
        let bytes = padded_bytes::<U>(len);
        if first + bytes > self.raw.size() {
            let expected = self.raw.size().saturating_sub(first) as usize / size_of::<U>().max(1);
            return Err(GpuError::Length { what: what.to_owned(), expected, given: len });
        }
        let (raw, what) = (self.raw.clone(), what.to_owned());
        Ok(StorageBuffer { raw, what, len, first, extent: Extent::Little, _reservation: None, _type: PhantomData })
    }

    /// The whole array, as the argument that goes to this variable of a kernel.
    pub fn named(&self, name: &'static str) -> Argument<'_> {
        let size = std::num::NonZeroU64::new(padded_bytes::<T>(self.len));
        Argument {
            name,
            resource: wgpu::BindingResource::Buffer(wgpu::BufferBinding { buffer: &self.raw, offset: self.first, size }),
            array: Array { bytes: (self.len * size_of::<T>()) as u64, extent: self.extent },
        }
    }

    /// The same for a kernel that touches no more than so many numbers of each of its parts.
    pub fn partly(&self, numbers: usize) -> Partly<'_, T> {
        Partly { array: self, numbers }
    }
}

/// An array of which a kernel touches some numbers of each part: it is bound whole, and they count.
#[derive(Clone, Copy, Debug)]
pub struct Partly<'a, T> {
    array: &'a StorageBuffer<T>,
    numbers: usize,
}

impl<'a, T> Partly<'a, T> {
    /// As [`StorageBuffer::named`].
    pub fn named(&self, name: &'static str) -> Argument<'a> {
        let of_parts = |parts: u64| parts * (self.numbers * size_of::<T>()) as u64;
        let mut argument = self.array.named(name);
        argument.array.bytes = match self.array.extent {
            Extent::Little => 0,
            Extent::Whole => of_parts(1),
            Extent::Each(parts) => of_parts(parts),
        };
        argument
    }
}

/// Bytes that an array takes: an empty binding is invalid, 16 bytes stand for it.
fn padded_bytes<T>(len: usize) -> u64 {
    ((len * size_of::<T>()) as u64).next_multiple_of(16).max(16)
}

impl GpuContext {
    /// Splits `records` by this device's limits and what is left of the memory budget, as
    /// [`chunks`].
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if a single record does not fit.
    pub fn chunks(&self, what: &str, records: usize, widest: u64, total: u64) -> Result<Vec<Chunk>, GpuError> {
        let binding = self.adapter().max_binding.min(self.adapter().max_buffer);
        chunks(what, records, widest, total, binding, self.budget.limit().saturating_sub(self.budget.used()))
    }

    /// Splits `records` by what one binding of this device holds, where each has `widest` bytes.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`] if a single record does not fit.
    pub fn chunks_of_bindings(&self, what: &str, records: usize, widest: u64) -> Result<Vec<Chunk>, GpuError> {
        chunks(what, records, widest, 0, self.adapter().max_binding.min(self.adapter().max_buffer), u64::MAX)
    }

    /// Whether `bytes` are left of the memory budget.
    ///
    /// # Errors
    /// [`GpuError::OutOfBudget`].
    pub fn has_room(&self, what: &str, bytes: u64) -> Result<(), GpuError> {
        self.budget.reserve(what, bytes).map(drop)
    }

    /// An array of `len` zeros. `what` names it in errors.
    ///
    /// # Errors
    /// [`GpuError::TooLarge`], [`GpuError::OutOfBudget`], [`GpuError::Rejected`], or the device's
    /// fault.
    pub fn zeros<T: Pod>(&self, what: &str, len: usize) -> Result<StorageBuffer<T>, GpuError> {
        self.allocate(what, len, wgpu::BufferUsages::STORAGE)
    }

    fn allocate<T: Pod>(&self, what: &str, len: usize, kind: wgpu::BufferUsages) -> Result<StorageBuffer<T>, GpuError> {
        let bytes = padded_bytes::<T>(len);
        let limit = self.adapter().max_binding.min(self.adapter().max_buffer);
        if bytes > limit {
            return Err(GpuError::TooLarge { what: what.to_owned(), bytes, limit });
        }
        let reservation = self.budget.reserve(what, bytes)?;
        let usage = kind | wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST;
        let raw = self.buffer(what, bytes, usage)?;
        let (what, extent) = (what.to_owned(), Extent::Little);
        Ok(StorageBuffer { raw, what, len, first: 0, extent, _reservation: Some(reservation), _type: PhantomData })
    }

    /// An array with these numbers of workgroups along x, y and z, for
    /// [`super::pipelines::Recorder::dispatch_as_told`].
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn calls(&self, what: &str, data: &[u32]) -> Result<StorageBuffer<u32>, GpuError> {
        let buffer = self.allocate(what, data.len(), wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::INDIRECT)?;
        self.upload(&buffer, data)?;
        Ok(buffer)
    }

    /// An array with these elements.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn array<T: Pod>(&self, what: &str, data: &[T]) -> Result<StorageBuffer<T>, GpuError> {
        let buffer = self.zeros(what, data.len())?;
        self.upload(&buffer, data)?;
        Ok(buffer)
    }

    /// A small block of parameters that every thread of a kernel reads (`var<uniform>`), zero at
    /// first; `T` is laid out as WGSL lays the struct out.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn block<T: Pod>(&self, what: &str) -> Result<StorageBuffer<T>, GpuError> {
        self.blocks(what, 1)
    }

    /// A block of parameters that is a list of so many.
    ///
    /// # Errors
    /// As [`GpuContext::zeros`].
    pub fn blocks<T: Pod>(&self, what: &str, len: usize) -> Result<StorageBuffer<T>, GpuError> {
        self.allocate(what, len, wgpu::BufferUsages::UNIFORM)
    }

    /// Overwrites the array.
    ///
    /// # Errors
    /// [`GpuError::Length`], or the device's fault.
    pub fn upload<T: Pod>(&self, buffer: &StorageBuffer<T>, data: &[T]) -> Result<(), GpuError> {
        if data.len() != buffer.len {
            return Err(GpuError::Length { what: buffer.what.clone(), expected: buffer.len, given: data.len() });
        }
        self.upload_at(buffer, 0, data)
    }

    /// Overwrites the elements from `offset` on. Elements of less than four bytes are not supported
    /// by wgpu.
    ///
    /// # Errors
    /// [`GpuError::Length`] if the data reaches beyond the end, or the device's fault.
    pub fn upload_at<T: Pod>(&self, buffer: &StorageBuffer<T>, offset: usize, data: &[T]) -> Result<(), GpuError> {
        if offset.checked_add(data.len()).is_none_or(|end| end > buffer.len) {
            return Err(GpuError::Length { what: buffer.what.clone(), expected: buffer.len, given: offset + data.len() });
        }
        let bytes: &[u8] = cast_slice(data);
        let start = offset * size_of::<T>();
        self.scoped(&buffer.what, || {
            for (i, piece) in bytes.chunks(UPLOAD_PIECE).enumerate() {
                self.queue.write_buffer(&buffer.raw, buffer.first + (start + i * UPLOAD_PIECE) as u64, piece);
                self.meter.went_up(piece.len() as u64);
                if bytes.len() > UPLOAD_PIECE {
                    self.queue.submit([]);
                    self.meter.submitted(0);
                }
            }
        })
    }

    /// Reads the whole array back, after everything submitted before.
    ///
    /// # Errors
    /// [`GpuError::Stale`], [`GpuError::Lost`], [`GpuError::Timeout`]: then no numbers come back at
    /// all.
    pub fn download<T: Pod>(&self, buffer: &StorageBuffer<T>) -> Result<Vec<T>, GpuError> {
        let mut out = vec![T::zeroed(); buffer.len];
        self.download_at(buffer, 0, &mut out)?;
        Ok(out)
    }

    /// Reads the elements from `offset` on into `out`, after everything submitted before.
    ///
    /// The staging buffer is filled together with a ticket, a number that was never used before.
    /// Only if the ticket has arrived did this submission run, and only then are the numbers those
    /// that the kernels left.
    ///
    /// # Errors
    /// As [`GpuContext::download`]; [`GpuError::Length`] if `out` reaches beyond the end.
    pub fn download_at<T: Pod>(&self, buffer: &StorageBuffer<T>, offset: usize, out: &mut [T]) -> Result<(), GpuError> {
        self.record().submit_and_read(&mut [buffer.read(offset, out)?])
    }

    /// Hands over the kernels and copies of a list together with copies of what is to be read back,
    /// waits for them, and reads: one submission and one wait, however much there is to read.
    pub(super) fn read_after(
        &self,
        (ahead, mut encoder): (Vec<wgpu::CommandBuffer>, wgpu::CommandEncoder),
        dispatches: u64,
        reads: &mut [ReadBack<'_>],
    ) -> Result<wgpu::SubmissionIndex, GpuError> {
        let what = reads.first().map_or("nothing", |read| read.what).to_owned();
        let padded = |read: &ReadBack<'_>| (read.out.len() as u64).next_multiple_of(16);
        let bytes = reads.iter().map(padded).sum::<u64>();
        let mut slot = self.staging();
        let staging = self.staging_for(&mut slot, bytes)?;
        staging.number += 1;
        let ticket = staging.number;
        let begun = Instant::now();
        let submission = self.scoped(&what, || {
            self.queue.write_buffer(&staging.ticket, 0, &ticket.to_le_bytes());
            let mut at = 0;
            for read in reads.iter().filter(|read| !read.out.is_empty()) {
                encoder.copy_buffer_to_buffer(read.raw, read.offset, &staging.mapped, at, read.out.len() as u64);
                at += padded(read);
            }
            encoder.copy_buffer_to_buffer(&staging.ticket, 0, &staging.mapped, bytes, 8);
            self.send((ahead, encoder))
        })?;
        self.meter.submitted(dispatches);
        self.meter.went_up(size_of_val(&ticket) as u64);
        self.meter.came_down(reads.iter().map(|read| read.out.len() as u64).sum::<u64>() + size_of_val(&ticket) as u64);
        let slice = staging.mapped.slice(..bytes + TICKET_BYTES);
        let (report, outcome) = std::sync::mpsc::channel();
        slice.map_async(wgpu::MapMode::Read, move |result| {
            // Whoever has given up does not listen any more.
            let _ = report.send(result.is_ok());
        });
        let waited = self.wait(&what, submission.clone());
        self.pace.took(dispatches, begun.elapsed());
        // Another thread that waits for the device may be the one that is told.
        if waited.is_err() || outcome.recv_timeout(PATIENCE) != Ok(true) {
            *slot = None; // its mapping is in an unknown state
            waited?;
            return Err(self.fault(GpuError::Lost { reason: format!("{what} cannot be mapped") }));
        }
        let fresh = slice.get_mapped_range().is_ok_and(|view| {
            let (mut numbers, tail) = view.split_at(bytes as usize);
            for read in &mut *reads {
                let (mine, rest) = numbers.split_at(padded(read) as usize);
                read.out.copy_from_slice(&mine[..read.out.len()]);
                numbers = rest;
            }
            tail[..8] == ticket.to_le_bytes()
        });
        staging.mapped.unmap();
        if !fresh {
            reads.iter_mut().for_each(|read| read.out.fill(0));
            return Err(self.fault(GpuError::Stale { what }));
        }
        Ok(submission)
    }

    fn buffer(&self, what: &str, size: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer, GpuError> {
        let descriptor = wgpu::BufferDescriptor { label: Some(what), size, usage, mapped_at_creation: false };
        self.scoped(what, || self.device.create_buffer(&descriptor))
    }

    /// The staging buffer, made anew if it is shorter than `bytes` and the ticket.
    fn staging_for<'a>(&self, slot: &'a mut Option<Staging>, bytes: u64) -> Result<&'a mut Staging, GpuError> {
        let needed = bytes.next_multiple_of(16) + TICKET_BYTES;
        let number = slot.as_ref().map_or(0, |s| s.number);
        if slot.as_ref().is_none_or(|s| s.mapped.size() < needed) {
            *slot = None;
            let reservation = self.budget.reserve("staging", needed)?;
            let mapped = self.buffer("staging", needed, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST)?;
            let ticket = self.buffer("ticket", TICKET_BYTES, wgpu::BufferUsages::COPY_SRC | wgpu::BufferUsages::COPY_DST)?;
            *slot = Some(Staging { mapped, ticket, number, reservation });
        }
        slot.as_mut().ok_or_else(|| GpuError::Lost { reason: "no staging buffer".to_owned() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_cover_every_record_once_and_fit() {
        for (records, widest, total, binding, memory) in
            [(1, 8, 16, 8, 16), (10, 3, 9, 10, 1000), (1000, 7, 30, 1 << 20, 3000), (64, 1 << 20, 5 << 20, 128 << 20, 2 << 30)]
        {
            let parts = chunks("state", records, widest, total, binding, memory).unwrap();
            let mut next = 0;
            for c in &parts {
                assert_eq!(c.first, next);
                assert!(c.count > 0 && c.count as u64 * widest <= binding && c.count as u64 * total <= memory);
                next += c.count;
            }
            assert_eq!(next, records);
            let (most, least) = (parts.iter().map(|c| c.count).max(), parts.iter().map(|c| c.count).min());
            assert!(most.unwrap() - least.unwrap() <= 1);
        }
        assert_eq!(chunks("state", 0, 1, 1, 1, 1), Ok(vec![]));
        assert!(matches!(chunks("state", 3, 9, 9, 8, 100), Err(GpuError::TooLarge { bytes: 9, limit: 8, .. })));
        assert!(matches!(chunks("state", 3, 9, 19, 9, 18), Err(GpuError::TooLarge { bytes: 19, limit: 18, .. })));
    }
}
