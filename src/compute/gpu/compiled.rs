//! Kernels that are compiled.

use super::kernel::Kernel;
use super::reflect::KernelInterface;
use super::source::Precision;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

/// A compiled kernel.
#[derive(Debug)]
pub struct Pipeline {
    pub(super) raw: wgpu::ComputePipeline,
    pub(super) layout: wgpu::BindGroupLayout,
    pub(super) kernel: &'static Kernel,
    pub(super) interface: &'static KernelInterface,
    pub(super) precision: Precision,
}

/// Compiled kernels by name and precision.
#[derive(Debug, Default)]
pub(super) struct PipelineCache {
    pub compiled: Mutex<BTreeMap<(&'static str, Precision), Arc<Pipeline>>>,
}
