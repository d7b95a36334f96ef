//! A batch that outlives its device: when the device fails, the CPU goes on from the last committed
//! states.

use super::cpu::Cpu;
use super::iterate::{Ask, IterateRequest, Keeps};
use super::linear::LinearRequest;
use super::traffic::Traffic;
use super::{
    CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, ForceRequest, Outcome,
    TangentRequest,
};

/// A device with a copy of every committed state on the host, and the CPU in waiting.
///
/// The first failure of the device ends its use: the call that failed is made again on the CPU in
/// f64, which starts from the copies, so that no accepted step is lost. Where the device keeps
/// Newton's iterates a copy of each step would cost more than the step: then the answer is
/// [`ComputeError::Gone`], up to when a state is restored. What happened is in
/// [`Compute::take_notes`] and, from then on, in [`Compute::description`].
pub struct Fallback {
    device: Option<Box<dyn Compute>>,
    cpu: Option<Cpu<f64, f32>>,
    models: Vec<CaseModel>,
    name: String,
    committed: Vec<Option<CaseState>>,
    /// By case: the device has committed a state of which there is no copy.
    is_away: Vec<bool>,
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
        let is_away = vec![false; models.len()];
        let weights = vec![0.0; models.len()];
        let name = device.description().device;
        Self {
            device: Some(device),
            cpu: None,
            models,
            name,
            committed,
            is_away,
            weights,
            commits: 0,
            traffic: None,
            notes: Vec::new(),
        }
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

    /// Whether the CPU has the states of these cases, if it is the CPU that is asked.
    fn knows(&self, mut cases: impl Iterator<Item = usize>) -> Result<(), ComputeError> {
        if self.device.is_none() && cases.any(|case| self.is_away[case]) { Err(ComputeError::Gone) } else { Ok(()) }
    }

    /// What is left of these cases without the device.
    fn without_iterates(&self, requests: &[IterateRequest]) -> ComputeError {
        self.knows(requests.iter().map(|request| request.case)).err().unwrap_or(ComputeError::Moved)
    }

    /// Leaves the device for the CPU, which starts from the committed states.
    fn give_up(&mut self, reason: &str) -> Result<(), ComputeError> {
        self.traffic = self.traffic();
        self.device = None;
        let mut cpu = Cpu::with_tangents(self.models.clone())?;
        for (case, state) in self.committed.iter().enumerate() {
            if let Some(state) = state.as_ref().filter(|_| !self.is_away[case]) {
                cpu.restore(case, state)?;
                cpu.begin_step(case, self.weights[case])?;
            }
        }
        let note = format!(
            "{} failed after {} accepted steps ({reason}); the CPU went on in f64, and no accepted step was lost",
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
        self.call(|backend| backend.begin_step(case, weight))?;
        self.knows(std::iter::once(case))
    }

    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.internal_force(requests))?;
        self.knows(requests.iter().map(|request| request.case))
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.tangent(requests))?;
        self.knows(requests.iter().map(|request| request.case))
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.contact(requests))?;
        self.knows(requests.iter().map(|request| request.case))
    }

    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        self.call(|backend| backend.linear(requests))?;
        self.knows(requests.iter().map(|request| request.case))
    }

    fn keeps(&self) -> Keeps {
        self.device.as_ref().map_or(Keeps::Nothing, |device| device.keeps())
    }

    /// Where the device fails its iterates are gone; so are states that it has committed itself. No
    /// copy is taken of those: whoever follows the path takes one from time to time, and goes back
    /// to it.
    fn iterate(&mut self, requests: &mut [IterateRequest]) -> Result<(), ComputeError> {
        let Some(device) = &mut self.device else { return Err(self.without_iterates(requests)) };
        match device.iterate(requests) {
            Ok(()) => {
                for request in requests.iter().filter(|request| request.ask == Ask::Commit) {
                    self.commits += 1;
                    (self.weights[request.case], self.is_away[request.case]) = (0.0, true);
                }
                Ok(())
            }
            Err(ComputeError::Device(reason)) => {
                self.give_up(&reason)?;
                Err(self.without_iterates(requests))
            }
            Err(error) => Err(error),
        }
    }

    fn has_stand_in(&self) -> bool {
        self.device.is_some()
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
        self.knows(states.iter().map(|(case, _)| *case))?;
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
        let fields = self.call(|backend| backend.fields(case))?;
        self.knows(std::iter::once(case)).map(|()| fields)
    }

    fn state(&mut self, case: usize) -> Result<CaseState, ComputeError> {
        let state = self.call(|backend| backend.state(case))?;
        self.knows(std::iter::once(case)).map(|()| state)
    }

    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError> {
        self.call(|backend| backend.restore(case, state))?;
        self.is_away[case] = false;
        if self.device.is_some() {
            self.committed[case] = Some(state.clone());
        }
        Ok(())
    }

    /// The stand-in takes no more cases: it is slower than another device would be.
    fn replace(&mut self, case: usize, model: CaseModel) -> Result<bool, ComputeError> {
        let Some(device) = &mut self.device else { return Ok(false) };
        match device.replace(case, model.clone()) {
            Ok(true) => {
                self.models[case] = model;
                (self.committed[case], self.is_away[case], self.weights[case]) = (None, false, 0.0);
                Ok(true)
            }
            Err(ComputeError::Device(reason)) => self.give_up(&reason).map(|()| false),
            answer => answer,
        }
    }

    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}
