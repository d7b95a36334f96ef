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
use crate::compute::handle::at;
use crate::compute::iterate::{Ask, Keeps, Plate, Request};
use crate::compute::{About, Answer, Call, CaseModel, Compute, ComputeError, Description, Evaluated};

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

    /// The device takes over the states that the CPU has found.
    fn commit(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        let cases: Vec<usize> = calls.iter().map(|(case, _)| *case).collect();
        let keeps = self.single.about().keeps != Keeps::Nothing;
        let before: Vec<Vec<f64>> = cases.iter().filter(|_| keeps).map(|&case| self.single.committed[case].clone()).collect();
        let answers = self.residual.call(calls)?;
        let is_valid = |answer: &Answer| matches!(answer, Answer::Commit { outcome: Evaluated::Valid, .. });
        for (&case, _) in cases.iter().zip(&answers).filter(|(_, answer)| is_valid(answer)) {
            at(&mut self.single, case).restore(at(&mut self.residual, case).state()?)?;
        }
        let valid = cases.iter().zip(before).zip(&answers).filter(|(_, answer)| is_valid(answer));
        let earlier = valid.map(|((&case, before), _)| {
            (case, Call::Iterate(Request { kept: false, plate: Plate::default(), ask: Ask::SetEarlier(before) }))
        });
        let earlier: Vec<(usize, Call)> = earlier.collect();
        if !earlier.is_empty() {
            self.single.call(earlier)?;
        }
        Ok(answers)
    }
}

impl Compute for Mixed {
    fn models(&self) -> &[CaseModel] {
        self.residual.models()
    }

    fn about(&self) -> About {
        let (cpu, gpu) = (self.residual.about().description, self.single.about());
        let device = format!("{}, in f32; residuals on the {}", gpu.description.device, cpu.device);
        let keeps = if gpu.keeps == Keeps::Nothing { Keeps::Nothing } else { Keeps::Guesses };
        About { description: Description { device, precision: cpu.precision }, keeps, ..gpu }
    }

    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        match calls.first() {
            None | Some((_, Call::Force { .. } | Call::Contact { .. } | Call::Fields | Call::State)) => self.residual.call(calls),
            Some((_, Call::Tangent { .. } | Call::Solve(_) | Call::Iterate(_))) => self.single.call(calls),
            Some((_, Call::Commit { .. })) => self.commit(calls),
            Some((_, Call::BeginStep(_) | Call::Restore(_))) => {
                self.residual.call(calls.clone())?;
                self.single.call(calls)
            }
            Some((_, Call::Replace(_))) => {
                let answers = self.single.call(calls.clone())?;
                if matches!(answers[..], [Answer::Replaced(true)]) { self.residual.call(calls) } else { Ok(answers) }
            }
        }
    }
}
