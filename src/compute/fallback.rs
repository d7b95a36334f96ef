//! A batch that outlives its device: when the device fails, the CPU goes on from the last committed
//! states.

use std::sync::Arc;

use super::cpu::Cpu;
use super::handle::at;
use super::traffic::Traffic;
use super::{About, Answer, Call, CaseModel, CaseState, Compute, ComputeError, Description, Evaluated};

/// A device with a copy of every committed state on the host, and the CPU in waiting.
///
/// The first failure of the device ends its use: the call that failed is made again on the CPU in
/// f64, which starts from the copies, so that no accepted step is lost. Where the device keeps
/// Newton's iterates a copy of each step would cost more than the step: then the answer is
/// [`ComputeError::Gone`], up to when a state is restored. What happened is in
/// [`Compute::take_notes`] and, from then on, in [`Compute::about`].
pub struct Fallback {
    device: Option<Box<dyn Compute>>,
    cpu: Option<Cpu<f64, f32>>,
    models: Vec<CaseModel>,
    name: String,
    committed: Vec<Option<Arc<CaseState>>>,
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
        let name = device.about().description.device;
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

    /// Keeps what it takes to go on without the device, after it has answered.
    fn follow(&mut self, calls: &[(usize, Call)], answers: &[Answer]) -> Result<(), ComputeError> {
        let Some(device) = &mut self.device else { return Ok(()) };
        let mut copies = Vec::new();
        for ((case, call), answer) in calls.iter().zip(answers) {
            if let (Call::Commit { .. }, Answer::Commit { outcome: Evaluated::Valid, .. }) = (call, answer) {
                copies.push((*case, Arc::new(at(device.as_mut(), *case).state()?)));
            }
        }
        // Nothing fails from here on.
        for (case, copy) in copies {
            self.commits += 1;
            (self.committed[case], self.is_away[case], self.weights[case]) = (Some(copy), false, 0.0);
        }
        for ((case, call), answer) in calls.iter().zip(answers) {
            match (call, answer) {
                (Call::Iterate(_), _) if call.commits() => {
                    self.commits += 1;
                    (self.weights[*case], self.is_away[*case]) = (0.0, true);
                }
                (Call::Restore(state), _) => (self.committed[*case], self.is_away[*case]) = (Some(state.clone()), false),
                (Call::Replace(model), Answer::Replaced(true)) => {
                    self.models[*case] = (**model).clone();
                    (self.committed[*case], self.is_away[*case], self.weights[*case]) = (None, false, 0.0);
                }
                _ => {}
            }
        }
        Ok(())
    }

    /// The CPU's answers, where it has the states. It has no iterates, and takes no more cases: it
    /// is slower than another device would be.
    fn stand_in(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        if calls.iter().any(|(_, call)| matches!(call, Call::Replace(_))) {
            return Ok(calls.iter().map(|_| Answer::Replaced(false)).collect());
        }
        for (case, _) in calls.iter().filter(|(_, call)| matches!(call, Call::Restore(_))) {
            self.is_away[*case] = false;
        }
        if calls.iter().any(|(case, _)| self.is_away[*case]) {
            return Err(ComputeError::Gone);
        }
        if calls.iter().any(|(_, call)| matches!(call, Call::Iterate(_))) {
            return Err(ComputeError::Moved);
        }
        match &mut self.cpu {
            Some(cpu) => cpu.call(calls),
            None => Err(ComputeError::Device(format!("{} failed, and the CPU could not take over", self.name))),
        }
    }

    /// Leaves the device for the CPU, which starts from the committed states.
    fn give_up(&mut self, reason: &str) -> Result<(), ComputeError> {
        self.traffic = self.about().traffic;
        self.device = None;
        let mut cpu = Cpu::with_tangents(self.models.clone())?;
        for (case, state) in self.committed.iter().enumerate() {
            if let Some(state) = state.as_ref().filter(|_| !self.is_away[case]) {
                cpu.call(vec![(case, Call::Restore(state.clone()))])?;
                cpu.call(vec![(case, Call::BeginStep(self.weights[case]))])?;
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
    fn models(&self) -> &[CaseModel] {
        &self.models
    }

    fn about(&self) -> About {
        if let Some(device) = &self.device {
            return About { has_stand_in: true, ..device.about() };
        }
        let device = match &self.cpu {
            Some(cpu) => format!("{}, after {} failed", cpu.about().description.device, self.name),
            None => format!("{} (failed)", self.name),
        };
        About { traffic: self.traffic, ..About::plain(Description { device, precision: "f64" }) }
    }

    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        for (case, call) in &calls {
            if let Call::BeginStep(weight) = call {
                self.weights[*case] = *weight;
            }
        }
        let Some(device) = &mut self.device else { return self.stand_in(calls) };
        let again: Vec<(usize, Call)> = calls.iter().map(|(case, call)| (*case, call.again())).collect();
        let answered = device.call(calls).and_then(|answers| self.follow(&again, &answers).map(|()| answers));
        match answered {
            Err(ComputeError::Device(reason)) => {
                self.give_up(&reason)?;
                self.stand_in(again)
            }
            answered => answered,
        }
    }

    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}
