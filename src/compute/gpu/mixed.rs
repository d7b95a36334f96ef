//! A batch on a device without double precision: residuals from the CPU in f64, tangents and linear
//! systems on the device in f32.
//!
//! The residual decides what a converged step is, the tangent only how fast it is found: the answer
//! does not depend on the device. Over a plane the device makes whole steps in f32, each a guess
//! that the CPU's residual then confirms or that the host goes on from ([`Keeps::Guesses`]).

use std::sync::Arc;

use super::backend::Gpu;
use super::context::GpuContext;
use crate::compute::cpu::Cpu;
use crate::compute::iterate::{Answer, Ask, IterateRequest, Keeps, Plate};
use crate::compute::linear::LinearRequest;
use crate::compute::traffic::Traffic;
use crate::compute::{
    CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, ForceRequest, Outcome,
    TangentRequest,
};

/// Evaluates a batch in f64 on the CPU, and its tangents and linear systems in f32 on a device.
pub struct Mixed {
    residual: Cpu<f64>,
    single: Gpu<f32>,
}

impl Mixed {
    /// Takes a batch of cases in their undeformed, virgin state.
    ///
    /// # Errors
    /// As [`Gpu::new`].
    pub fn new(context: Arc<GpuContext>, models: Vec<CaseModel>) -> Result<Self, ComputeError> {
        Ok(Self { residual: Cpu::new(models.clone())?, single: Gpu::with_iterates(context, models)? })
    }

    /// As [`Gpu::notes`].
    pub fn notes(&self) -> Vec<String> {
        self.single.notes()
    }

    /// The device; none for an empty batch.
    pub fn context(&self) -> Option<&Arc<GpuContext>> {
        self.single.context()
    }
}

impl Compute for Mixed {
    fn description(&self) -> Description {
        let (cpu, gpu) = (self.residual.description(), self.single.description());
        Description { device: format!("{}, in f32; residuals on the {}", gpu.device, cpu.device), precision: cpu.precision }
    }

    fn models(&self) -> &[CaseModel] {
        self.residual.models()
    }

    fn traffic(&self) -> Option<Traffic> {
        self.single.traffic()
    }

    fn begin_step(&mut self, case: usize, weight: f64) -> Result<(), ComputeError> {
        self.residual.begin_step(case, weight)?;
        self.single.begin_step(case, weight)
    }

    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        self.residual.internal_force(requests)
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        self.single.tangent(requests)
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        self.residual.contact(requests)
    }

    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        self.single.linear(requests)
    }

    fn keeps(&self) -> Keeps {
        if self.single.keeps() == Keeps::Nothing { Keeps::Nothing } else { Keeps::Guesses }
    }

    fn iterate(&mut self, requests: &mut [IterateRequest]) -> Result<(), ComputeError> {
        self.single.iterate(requests)
    }

    /// The device takes over the state that the CPU has found.
    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError> {
        let keeps = self.keeps() != Keeps::Nothing;
        let before: Vec<Vec<f64>> = requests.iter().filter(|_| keeps).map(|r| self.single.committed[r.case].clone()).collect();
        self.residual.commit(requests)?;
        for request in requests.iter().filter(|r| r.outcome == Outcome::Valid) {
            self.single.restore(request.case, &self.residual.state(request.case)?)?;
        }
        let valid = requests.iter().zip(before).filter(|(r, _)| r.outcome == Outcome::Valid);
        let mut earlier: Vec<IterateRequest> = valid
            .map(|(r, before)| {
                let (plate, ask) = (Plate::default(), Ask::SetEarlier(before));
                IterateRequest { case: r.case, kept: false, plate, ask, answer: Answer::Nothing }
            })
            .collect();
        if earlier.is_empty() { Ok(()) } else { self.single.iterate(&mut earlier) }
    }

    fn fields(&mut self, case: usize) -> Result<CaseFields, ComputeError> {
        self.residual.fields(case)
    }

    fn state(&mut self, case: usize) -> Result<CaseState, ComputeError> {
        self.residual.state(case)
    }

    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError> {
        self.residual.restore(case, state)?;
        self.single.restore(case, state)
    }

    fn replace(&mut self, case: usize, model: CaseModel) -> Result<bool, ComputeError> {
        Ok(self.single.replace(case, model.clone())? && self.residual.replace(case, model)?)
    }
}
