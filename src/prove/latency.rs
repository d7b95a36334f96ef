//! What a device takes for nothing: a submission, a dispatch, and a barrier between two.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use crate::bench::BenchError;
use crate::compute::gpu::source::ShaderSource;
use crate::compute::gpu::{GpuContext, GpuError, Kernel, Precision};

/// Dispatches of a list.
const DISPATCHES: usize = 1000;
/// Lists of which the quickest counts.
const REPEATS: usize = 7;

/// Microseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Latency {
    /// Of a submission with nothing in it, and of waiting for it.
    pub submission_us: f64,
    /// Of a dispatch that does nothing, beside others that do not depend on it.
    pub dispatch_us: f64,
    /// More for one that has to wait for the one before it.
    pub barrier_us: f64,
}

/// Reads nothing and writes nothing.
static NOTHING: Kernel = Kernel::new(
    "nothing",
    &[ShaderSource {
        path: "src/prove/latency.rs",
        text: "
@group(0) @binding(0) var<storage, read> numbers: array<real>;
@compute @workgroup_size(1)
fn nothing(@builtin(global_invocation_id) id: vec3<u32>) {
    if numbers[0] > real(id.x) + 1 { return; }
}
",
    }],
);

/// Adds one to a number, which the next dispatch needs.
static COUNT: Kernel = Kernel::new(
    "count",
    &[ShaderSource {
        path: "src/prove/latency.rs",
        text: "
@group(0) @binding(0) var<storage, read_write> numbers: array<real>;
@compute @workgroup_size(1)
fn count() {
    numbers[0] += real(1);
}
",
    }],
);

/// Measures the three.
///
/// # Errors
/// The device's fault; [`GpuError::Stale`] where dispatches were left out.
pub fn measure(context: Arc<GpuContext>) -> Result<Latency, BenchError> {
    let numbers = context.array("what is counted", &[0.0f32; 4])?;
    let bound = |kernel: &'static Kernel| context.bind(kernel, Precision::F32, &[numbers.named("numbers")]);
    let (nothing, count) = (bound(&NOTHING)?, bound(&COUNT)?);
    let quickest = |kernel, dispatches: usize| -> Result<f64, GpuError> {
        let mut best = f64::INFINITY;
        for _ in 0..REPEATS {
            let mut list = context.record();
            for _ in 0..dispatches {
                list.dispatch(kernel, 1, 1)?;
            }
            let begun = Instant::now();
            list.submit_and_read(&mut [numbers.read(0, &mut [0.0])?])?;
            best = best.min(begun.elapsed().as_secs_f64());
        }
        Ok(1e6 * best)
    };
    // The first time the driver compiles.
    quickest(&nothing, 1)?;
    quickest(&count, 1)?;
    let submission_us = quickest(&nothing, 0)?;
    let each = |kernel| -> Result<f64, GpuError> { Ok((quickest(kernel, DISPATCHES)? - submission_us) / DISPATCHES as f64) };
    let (dispatch_us, waiting_us) = (each(&nothing)?, each(&count)?);
    let counted = context.download(&numbers)?[0];
    if counted != (REPEATS * (DISPATCHES + 1)) as f32 {
        return Err(GpuError::Stale { what: "what is counted".to_owned() }.into());
    }
    Ok(Latency { submission_us, dispatch_us, barrier_us: (waiting_us - dispatch_us).max(0.0) })
}
