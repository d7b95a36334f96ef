//! A batch that outlives its device: when the device fails, the CPU goes on from the last committed
//! states.

use super::cpu::Cpu;
use super::linear::LinearRequest;
use super::traffic::Traffic;
use super::{
    CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, ForceRequest, Outcome,
    TangentRequest, TrialRequest,
};

/// A device with a copy of every committed state on the host, and the CPU in waiting.
///
/// The first failure of the device ends its use: the call that failed is made again on the CPU in
/// f64, which starts from the copies, so that no accepted step is lost. What happened is in
/// [`Compute::take_notes`] and, from then on, in [`Compute::description`].
pub struct Fallback {
    device: Option<Box<dyn Compute>>,
    cpu: Option<Cpu<f64, f32>>,
    models: Vec<CaseModel>,
    name: String,
    committed: Vec<Option<CaseState>>,
    /// What the present step of each case anticipates.
    weights: Vec<f64>,
    commits: usize,
    /// What had passed to the device and back when it failed.
    traffic: Option<Traffic>,
    notes: Vec<String>,
}

impl Fallback {
    /// Watches over a device with a batch in its virgin state.
    pub fn new(device: Box<dyn Compute>) -> Self {
        let models = device.models().to_vec();
        let committed = models.iter().map(|_| None).collect();
        let weights = vec![0.0; models.len()];
        let name = device.description().device;
        Self { device: Some(device), cpu: None, models, name, committed, weights, commits: 0, traffic: None, notes: Vec::new() }
    }

    /// Calls `f` on the device; if that fails, on the CPU, now and ever after.
    fn call<T>(&mut self, mut f: impl FnMut(&mut dyn Compute) -> Result<T, ComputeError>) -> Result<T, ComputeError> {
        if let Some(device) = &mut self.device {
            match f(device.as_mut()) {
                Err(ComputeError::Device(reason)) => self.give_up(&reason)?,
                answer => return answer,
            }
        }
        match &mut self.cpu {
            Some(cpu) => f(cpu),
            None => Err(ComputeError::Device(format!("{} failed, and the CPU could not take over", self.name))),
        }
    }

    /// Leaves the device for the CPU, which starts from the committed states.
    fn give_up(&mut self, reason: &str) -> Result<(), ComputeError> {
        self.traffic = self.traffic();
        self.device = None;
        let mut cpu = Cpu::with_tangents(self.models.clone())?;
        for (case, state) in self.committed.iter().enumerate() {
            if let Some(state) = state {
                cpu.restore(case, state)?;
                cpu.begin_step(case, self.weights[case])?;
            }
        }
        let note = format!(
            "{} failed after {} accepted steps ({reason}); the CPU went on from there in f64, and no accepted step was lost",
            self.name, self.commits
        );
        log::info!("{note}");
        self.notes.push(note);
        self.cpu = Some(cpu);
        Ok(())
    }
}

impl Compute for Fallback {
    fn description(&self) -> Description {
        match (&self.device, &self.cpu) {
            (Some(device), _) => device.description(),
            (None, Some(cpu)) => {
                let cpu = cpu.description();
                Description { device: format!("{}, after {} failed", cpu.device, self.name), precision: cpu.precision }
            }
            (None, None) => Description { device: format!("{} (failed)", self.name), precision: "f64" },
        }
    }

    fn models(&self) -> &[CaseModel] {
        &self.models
    }

    fn traffic(&self) -> Option<Traffic> {
        self.device.as_ref().map_or(self.traffic, |device| device.traffic())
    }

    fn begin_step(&mut self, case: usize, weight: f64) -> Result<(), ComputeError> {
        self.weights[case] = weight;
        self.call(|backend| backend.begin_step(case, weight))
    }

    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.internal_force(requests))
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.tangent(requests))
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.contact(requests))
    }

    fn trial(&mut self, requests: &mut [TrialRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.trial(requests))
    }

    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.linear(requests))
    }

    /// The copies follow the device: where a state cannot be read back, the step is committed on
    /// the CPU instead.
    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError> {
        let on_device = self.device.is_some();
        let states = self.call(|backend| {
            backend.commit(requests)?;
            let valid = requests.iter().filter(|r| r.outcome == Outcome::Valid);
            valid
                .map(|r| Ok((r.case, if on_device { Some(backend.state(r.case)?) } else { None })))
                .collect::<Result<Vec<_>, _>>()
        })?;
        for (case, state) in states {
            self.commits += 1;
            self.weights[case] = 0.0;
            if self.device.is_some() {
                self.committed[case] = state;
            }
        }
        Ok(())
    }

    fn fields(&mut self, case: usize) -> Result<CaseFields, ComputeError> {
        self.call(|backend| backend.fields(case))
    }

    fn state(&mut self, case: usize) -> Result<CaseState, ComputeError> {
        self.call(|backend| backend.state(case))
    }

    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError> {
        self.call(|backend| backend.restore(case, state))?;
        if self.device.is_some() {
            self.committed[case] = Some(state.clone());
        }
        Ok(())
    }

    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}
