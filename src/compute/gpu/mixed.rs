//! A batch on a device without double precision: residuals from the CPU in f64, tangents and linear
//! systems on the device in f32.
//!
//! The residual decides what a converged step is, the tangent only how fast it is found: the answer
//! does not depend on the device.

use std::sync::Arc;

use super::backend::Gpu;
use super::context::GpuContext;
use crate::compute::cpu::Cpu;
use crate::compute::linear::LinearRequest;
use crate::compute::traffic::Traffic;
use crate::compute::{
    CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, ForceRequest, Outcome,
    TangentRequest,
};

/// Evaluates a batch in f64 on the CPU, and its tangents and linear systems in f32 on a device.
pub struct Mixed {
    residual: Cpu<f64>,
    tangent: Gpu<f32>,
}

impl Mixed {
    /// Takes a batch of cases in their undeformed, virgin state.
    ///
    /// # Errors
    /// As [`Gpu::new`].
    pub fn new(context: Arc<GpuContext>, models: Vec<CaseModel>) -> Result<Self, ComputeError> {
        Ok(Self { residual: Cpu::new(models.clone())?, tangent: Gpu::new(context, models)? })
    }

    /// As [`Gpu::notes`].
    pub fn notes(&self) -> Vec<String> {
        self.tangent.notes()
    }

    /// The device; none for an empty batch.
    pub fn context(&self) -> Option<&Arc<GpuContext>> {
        self.tangent.context()
    }
}

impl Compute for Mixed {
    fn description(&self) -> Description {
        let (cpu, gpu) = (self.residual.description(), self.tangent.description());
        Description {
            device: format!("{}, tangents in f32; residuals on the {}", gpu.device, cpu.device),
            precision: cpu.precision,
        }
    }

    fn models(&self) -> &[CaseModel] {
        self.residual.models()
    }

    fn traffic(&self) -> Option<Traffic> {
        self.tangent.traffic()
    }

    fn begin_step(&mut self, case: usize, weight: f64) -> Result<(), ComputeError> {
        self.residual.begin_step(case, weight)?;
        self.tangent.begin_step(case, weight)
    }

    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        self.residual.internal_force(requests)
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        self.tangent.tangent(requests)
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        self.residual.contact(requests)
    }

    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        self.tangent.linear(requests)
    }

    /// The device takes over the state that the CPU has found.
    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError> {
        self.residual.commit(requests)?;
        for request in requests.iter().filter(|r| r.outcome == Outcome::Valid) {
            self.tangent.restore(request.case, &self.residual.state(request.case)?)?;
        }
        Ok(())
    }

    fn fields(&mut self, case: usize) -> Result<CaseFields, ComputeError> {
        self.residual.fields(case)
    }

    fn state(&mut self, case: usize) -> Result<CaseState, ComputeError> {
        self.residual.state(case)
    }

    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError> {
        self.residual.restore(case, state)?;
        self.tangent.restore(case, state)
    }
}
