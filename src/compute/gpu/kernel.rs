//! A kernel: files of WGSL with one entry point.

use super::error::GpuError;
use super::reflect::KernelInterface;
use super::source::{Assembled, Precision, ShaderSource};
use std::sync::OnceLock;

/// A kernel: one entry point and what it needs.
#[derive(Debug)]
pub struct Kernel {
    /// Name, unique; also the name of the entry point.
    pub name: &'static str,
    /// Its files after the prelude, in order.
    pub sources: &'static [ShaderSource],
    interface: OnceLock<Result<KernelInterface, GpuError>>,
}

impl Kernel {
    /// The kernel `name`, made of these files after the prelude.
    pub const fn new(name: &'static str, sources: &'static [ShaderSource]) -> Self {
        Self { name, sources, interface: OnceLock::new() }
    }

    /// The whole source in one precision.
    pub fn assemble(&self, precision: Precision) -> Assembled {
        Assembled::with_prelude(precision, self.sources)
    }

    /// What it takes; read from its source once. Numbers are counted in double precision, in which
    /// they take the most.
    ///
    /// # Errors
    /// [`GpuError::Shader`] if its source does not compile.
    pub fn interface(&self) -> Result<&KernelInterface, GpuError> {
        self.interface.get_or_init(|| KernelInterface::of(&self.assemble(Precision::F64))).as_ref().map_err(Clone::clone)
    }
}
