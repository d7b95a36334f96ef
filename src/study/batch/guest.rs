//! A case's side of a shared backend.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};

use super::queue::{HostReport, QueuedCall, lock};
use crate::compute::traffic::Traffic;
use crate::compute::{About, Answer, Call, CaseModel, Compute, ComputeError};

/// The way to one of the places of a shared backend.
pub struct Slot {
    slot: usize,
    requests: Sender<QueuedCall>,
    told: Arc<Mutex<HostReport>>,
    running: Arc<AtomicUsize>,
}

/// One case at its place of a shared backend, which it takes for its own: there it is the only
/// case.
pub struct Guest {
    model: [CaseModel; 1],
    slot: usize,
    requests: Sender<QueuedCall>,
    told: Arc<Mutex<HostReport>>,
    /// Notes heard so far.
    heard: usize,
    /// What had passed to the device and back before this case.
    before: Traffic,
    /// Guests that there are: a call waits for them.
    running: Arc<AtomicUsize>,
}

impl Drop for Guest {
    fn drop(&mut self) {
        self.running.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Slot {
    pub(super) fn new(
        slot: usize,
        requests: Sender<QueuedCall>,
        told: Arc<Mutex<HostReport>>,
        running: Arc<AtomicUsize>,
    ) -> Self {
        Self { slot, requests, told, running }
    }

    /// The guest for the case that the backend has had here from the beginning.
    pub fn first(&self, model: CaseModel) -> Guest {
        self.guest(model, 0, Traffic::default())
    }

    /// The guest for a case that takes this place from the one before, whose guest has gone; `None`
    /// where the backend does not take it (see [`Call::Replace`]).
    ///
    /// # Errors
    /// [`ComputeError::Device`], also where nobody serves any more.
    pub fn next(&self, model: &CaseModel) -> Result<Option<Guest>, ComputeError> {
        let (heard, before) = {
            let told = lock(&self.told);
            (told.notes.len(), told.about.traffic.unwrap_or_default())
        };
        let call = Call::Replace(Box::new(model.clone()));
        let taken = matches!(ask(&self.requests, self.slot, call)?, Answer::Replaced(true));
        Ok(taken.then(|| self.guest(model.clone(), heard, before)))
    }

    fn guest(&self, model: CaseModel, heard: usize, before: Traffic) -> Guest {
        self.running.fetch_add(1, Ordering::Relaxed);
        Guest {
            model: [model],
            slot: self.slot,
            requests: self.requests.clone(),
            told: self.told.clone(),
            heard,
            before,
            running: self.running.clone(),
        }
    }
}

fn gone() -> ComputeError {
    ComputeError::Device("whoever served the batch has gone".to_owned())
}

fn ask(host: &Sender<QueuedCall>, case: usize, call: Call) -> Result<Answer, ComputeError> {
    // A channel for each request: it closes with the request if the host goes before it answers.
    let (reply, answer) = channel();
    host.send(QueuedCall { case, call, reply }).map_err(|_| gone())?;
    answer.recv().map_err(|_| gone())?
}

impl Compute for Guest {
    fn models(&self) -> &[CaseModel] {
        &self.model
    }

    fn about(&self) -> About {
        let about = lock(&self.told).about.clone();
        About { traffic: about.traffic.map(|now| now - self.before), ..about }
    }

    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        calls.into_iter().map(|(_, call)| ask(&self.requests, self.slot, call)).collect()
    }

    fn take_notes(&mut self) -> Vec<String> {
        let told = lock(&self.told);
        let new = told.notes[self.heard..].to_vec();
        self.heard = told.notes.len();
        new
    }
}
