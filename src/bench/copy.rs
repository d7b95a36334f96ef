//! What memory can do: the rates of copies, next to which those of kernels are told.

use rayon::prelude::*;
use serde::Serialize;

use super::timing::{Patience, measure, of_kernels};
use super::{BenchError, Options, ThreadPools};
use crate::compute::gpu::{GpuContext, GpuError, StorageBuffer};

/// Bytes a second, read and written together where both are in the same memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct CopyRates {
    /// Length of the arrays, bytes.
    pub length: usize,
    /// One thread.
    pub one_core: f64,
    /// All threads.
    pub all_cores: f64,
    /// Array to array on the device.
    pub device: Option<f64>,
    /// From the program's memory to the device.
    pub to_device: Option<f64>,
    /// From the device to the program's memory.
    pub from_device: Option<f64>,
}

/// Words of the longest array that a copy on this device may take.
fn longest(context: &GpuContext) -> usize {
    (context.adapter().max_binding.min(context.adapter().max_buffer).min(context.budget().limit() / 4) / 4) as usize
}

/// Bytes a second, read and written together, of copies from array to array on a device; the arrays
/// have `bytes` bytes, or what the device's limits allow.
///
/// # Errors
/// The device's fault.
pub fn on_device(context: &GpuContext, bytes: usize) -> Result<f64, GpuError> {
    let words = (bytes / 4).min(longest(context));
    let from: Vec<u32> = (0..words as u32).collect();
    between(context, &context.array("what is copied", &from)?, &context.zeros("the copy", words)?)
}

fn between(context: &GpuContext, a: &StorageBuffer<u32>, b: &StorageBuffer<u32>) -> Result<f64, GpuError> {
    let copies = |times: usize| {
        let mut list = context.record();
        for _ in 0..times {
            list.copy(a, 0, b, 0, a.len())?;
        }
        list.submit()?;
        context.download_at(b, 0, &mut [0u32])
    };
    // The first touches fresh memory.
    copies(1)?;
    Ok((8 * a.len()) as f64 / (1e-3 * of_kernels(copies)?))
}

/// Copies are short: enough of them for a steady median.
const PATIENCE: Patience = Patience { least: 5, most: 15, seconds: 0.5, enough: 4.0 };

impl CopyRates {
    /// Measures the copies of arrays of `options.copied` bytes, or of what the device's limits
    /// allow.
    ///
    /// # Errors
    /// The device's fault.
    pub fn measure(options: &Options, context: Option<&GpuContext>, pools: &ThreadPools) -> Result<Self, BenchError> {
        let words = options.copied / 4;
        let from: Vec<u32> = (0..words as u32).collect();
        let mut to = vec![0u32; words];
        let rate = |ms: f64, bytes: usize| bytes as f64 / (1e-3 * ms);
        let piece = words.div_ceil(4 * pools.threads).max(1);
        let mut on = |pool: &rayon::ThreadPool, piece: usize| {
            let copied = pool.install(|| {
                measure(PATIENCE, |_| {
                    to.par_chunks_mut(piece).zip(from.par_chunks(piece)).for_each(|(to, from)| to.copy_from_slice(from));
                    Ok::<(), BenchError>(())
                })
            })?;
            Ok::<f64, BenchError>(rate(copied.median_ms, 8 * words))
        };
        let (one_core, all_cores) = (on(&pools.one, words.max(1))?, on(&pools.all, piece)?);
        let mut rates = Self { length: 4 * words, one_core, all_cores, ..Self::default() };
        if let Some(context) = context {
            let words = words.min(longest(context));
            let a = context.array("what is copied", &from[..words])?;
            let b = context.zeros::<u32>("the copy", words)?;
            rates.device = Some(between(context, &a, &b)?);
            let up = measure(PATIENCE, |_| {
                context.upload(&a, &from[..words])?;
                context.download_at(&a, 0, &mut [0u32])
            })?;
            rates.to_device = Some(rate(up.median_ms, 4 * words));
            let down = measure::<GpuError>(PATIENCE, |_| context.download_at(&b, 0, &mut to[..words]))?;
            rates.from_device = Some(rate(down.median_ms, 4 * words));
        }
        Ok(rates)
    }
}
