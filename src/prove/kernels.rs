//! Each kernel against the CPU, in every precision that the adapter has.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;

use super::progress::ProveProgress;
use crate::compute::gpu::kernels::KERNELS;
use crate::compute::gpu::{GpuContext, Precision};
use crate::conformance::{Comparison, comparisons};

/// A comparison that was made.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KernelProof {
    /// What was compared.
    pub name: &'static str,
    /// Precision of the residual's kernels: tangents and linear systems are in f32 beside f64.
    pub precision: String,
    /// Seconds on the wall, the driver's compilation included.
    pub seconds: f64,
    /// What did not hold, or what the device said; none where all agrees.
    pub disagrees: Option<String>,
}

/// A kernel in one precision.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct OfKernel {
    /// Its name.
    pub kernel: &'static str,
    /// f64 or f32.
    pub precision: String,
    /// How often it was dispatched in comparisons.
    pub dispatches: u64,
    /// Comparisons in which it was.
    pub comparisons: usize,
    /// Those of them that disagree.
    pub disagree: usize,
}

/// All of it.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct KernelReport {
    /// The comparisons, in their order.
    pub comparisons: Vec<KernelProof>,
    /// The kernels that took part.
    pub kernels: Vec<OfKernel>,
    /// Kernels that took part in none: they do in whole cases.
    pub not_compared: Vec<&'static str>,
}

impl KernelReport {
    /// A sentence for each comparison that disagrees.
    pub fn disagreements(&self) -> Vec<String> {
        let said = |compared: &KernelProof| {
            let why = compared.disagrees.as_ref()?;
            Some(format!("{} in {}: {why}", compared.name, compared.precision))
        };
        self.comparisons.iter().filter_map(said).collect()
    }
}

type Key = (&'static str, Precision);

/// How often each kernel has been dispatched.
fn dispatched(context: &GpuContext) -> BTreeMap<Key, u64> {
    let times = context.kernel_times().unwrap_or_default();
    times.kernels.iter().map(|of| ((of.kernel, of.precision), of.dispatches)).collect()
}

/// The comparisons of a run.
pub fn comparisons_of(has_double: bool, quick: bool) -> Vec<Comparison> {
    comparisons(has_double).into_iter().filter(|of| !(quick && of.is_long())).collect()
}

/// Makes the comparisons, those that take long on a software driver only where there is time.
pub fn compare(context: GpuContext, quick: bool, progress: &mut ProveProgress) -> KernelReport {
    let has_double = context.supports(Precision::F64).is_ok();
    // Who ran is asked of the profile; times are not.
    let context = Arc::new(context.without_timestamps().with_profile());
    let of_these = comparisons_of(has_double, quick);
    let mut report = KernelReport::default();
    let mut kernels: BTreeMap<Key, OfKernel> = BTreeMap::new();
    for comparison in &of_these {
        progress.begins(&format!("{} in {}", comparison.name, comparison.precision), 1.0);
        let (before, begun) = (dispatched(&context), Instant::now());
        let disagrees = comparison.run(&context).err();
        for (key, count) in dispatched(&context) {
            let count = count - before.get(&key).copied().unwrap_or(0);
            if count > 0 {
                let of = kernels.entry(key).or_insert_with(|| OfKernel {
                    kernel: key.0,
                    precision: key.1.to_string(),
                    dispatches: 0,
                    comparisons: 0,
                    disagree: 0,
                });
                of.dispatches += count;
                of.comparisons += 1;
                of.disagree += usize::from(disagrees.is_some());
            }
        }
        let (name, precision, seconds) = (comparison.name, comparison.precision.to_string(), begun.elapsed().as_secs_f64());
        report.comparisons.push(KernelProof { name, precision, seconds, disagrees });
    }
    report.kernels = kernels.into_values().collect();
    let took_part = |name: &str| report.kernels.iter().any(|of| of.kernel == name);
    report.not_compared = KERNELS.iter().map(|kernel| kernel.name).filter(|name| !took_part(name)).collect();
    report
}
