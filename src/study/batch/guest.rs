//! A case's side of a shared backend.

use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};

use super::ask::{Ask, LinearAsk, OwnBlocks, Request};
use super::{Told, lock};
use crate::compute::iterate::{IterateRequest, Keeps};
use crate::compute::linear::LinearRequest;
use crate::compute::traffic::Traffic;
use crate::compute::{
    CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, Energies, ForceRequest,
    Outcome, TangentRequest,
};

/// The way to one of the places of a shared backend.
pub struct Place {
    slot: usize,
    requests: Sender<Request>,
    told: Arc<Mutex<Told>>,
}

/// One case at its place of a shared backend, which it takes for its own: there it is the only
/// case.
pub struct Guest {
    model: [CaseModel; 1],
    slot: usize,
    requests: Sender<Request>,
    told: Arc<Mutex<Told>>,
    /// Notes heard so far.
    heard: usize,
    /// What had passed to the device and back before this case.
    before: Traffic,
    /// Buffers that go to the host and come back.
    displacement: Vec<f64>,
    force: Vec<f64>,
    blocks: OwnBlocks,
}

impl Place {
    pub(super) fn new(slot: usize, requests: Sender<Request>, told: Arc<Mutex<Told>>) -> Self {
        Self { slot, requests, told }
    }

    /// The guest for the case that the backend has had here from the beginning.
    pub fn first(&self, model: CaseModel) -> Guest {
        self.guest(model, 0, Traffic::default())
    }

    /// The guest for a case that takes this place from the one before, whose guest has gone; `None`
    /// where the backend does not take it (see [`Compute::replace`]).
    ///
    /// # Errors
    /// [`ComputeError::Device`], also where nobody serves any more.
    pub fn next(&self, model: &CaseModel) -> Result<Option<Guest>, ComputeError> {
        let (heard, before) = {
            let told = lock(&self.told);
            (told.notes.len(), told.traffic.unwrap_or_default())
        };
        let ask = Ask::Replace(Box::new(model.clone()));
        let taken = matches!(ask_host(&self.requests, self.slot, ask)?, Ask::Replaced(true));
        Ok(taken.then(|| self.guest(model.clone(), heard, before)))
    }

    fn guest(&self, model: CaseModel, heard: usize, before: Traffic) -> Guest {
        Guest {
            model: [model],
            slot: self.slot,
            requests: self.requests.clone(),
            told: self.told.clone(),
            heard,
            before,
            displacement: Vec::new(),
            force: Vec::new(),
            blocks: OwnBlocks::default(),
        }
    }
}

fn gone() -> ComputeError {
    ComputeError::Device("whoever served the batch has gone".to_owned())
}

fn ask_host(host: &Sender<Request>, case: usize, ask: Ask) -> Result<Ask, ComputeError> {
    // A channel for each request: it closes with the request if the host goes before it answers.
    let (reply, answer) = channel();
    host.send(Request { case, ask, reply }).map_err(|_| gone())?;
    answer.recv().map_err(|_| gone())?
}

impl Guest {
    fn ask(&self, ask: Ask) -> Result<Ask, ComputeError> {
        ask_host(&self.requests, self.slot, ask)
    }
}

/// A buffer with these contents.
fn filled<T: Copy>(buffer: &mut Vec<T>, contents: &[T]) -> Vec<T> {
    let mut buffer = std::mem::take(buffer);
    buffer.clear();
    buffer.extend_from_slice(contents);
    buffer
}

impl Compute for Guest {
    fn description(&self) -> Description {
        lock(&self.told).description.clone()
    }

    fn models(&self) -> &[CaseModel] {
        &self.model
    }

    fn traffic(&self) -> Option<Traffic> {
        lock(&self.told).traffic.map(|now| now - self.before)
    }

    fn begin_step(&mut self, _: usize, weight: f64) -> Result<(), ComputeError> {
        self.ask(Ask::Begin(weight)).map(drop)
    }

    fn keeps(&self) -> Keeps {
        lock(&self.told).keeps
    }

    fn has_stand_in(&self) -> bool {
        lock(&self.told).has_stand_in
    }

    fn iterate(&mut self, requests: &mut [IterateRequest]) -> Result<(), ComputeError> {
        for request in requests {
            if let Ask::Iterate(answered) = self.ask(Ask::Iterate(Box::new(request.clone())))? {
                request.answer = answered.answer;
            }
        }
        Ok(())
    }

    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        for request in requests {
            let mut force = std::mem::take(&mut self.force);
            force.resize(request.force.len(), 0.0);
            let displacement = filled(&mut self.displacement, request.displacement);
            let ask = Ask::Force { displacement, force, outcome: Outcome::Valid };
            if let Ask::Force { displacement, force, outcome } = self.ask(ask)? {
                request.force.copy_from_slice(&force);
                request.outcome = outcome;
                (self.displacement, self.force) = (displacement, force);
            }
        }
        Ok(())
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        for request in requests {
            let blocks = std::mem::take(&mut self.blocks).like(&request.blocks);
            let displacement = filled(&mut self.displacement, request.displacement);
            let ask = Ask::Tangent { displacement, blocks, outcome: Outcome::Valid };
            if let Ask::Tangent { displacement, blocks, outcome } = self.ask(ask)? {
                blocks.copy_to(&mut request.blocks)?;
                request.outcome = outcome;
                (self.displacement, self.blocks) = (displacement, blocks);
            }
        }
        Ok(())
    }

    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        for request in requests {
            if let Ask::Linear(answer) = self.ask(Ask::Linear(LinearAsk::new(request)))? {
                request.outcome = answer.outcome;
                for (side, answer) in request.sides.iter_mut().zip(answer.sides) {
                    side.x.copy_from_slice(&answer.x);
                    side.report = answer.report;
                }
            }
        }
        Ok(())
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        for request in requests {
            let displacement = filled(&mut self.displacement, request.displacement);
            let force = filled(&mut self.force, request.force);
            let ask = Ask::Contact { displacement, force, rows: request.rows.to_vec() };
            if let Ask::Contact { displacement, force, rows } = self.ask(ask)? {
                request.rows.copy_from_slice(&rows);
                (self.displacement, self.force) = (displacement, force);
            }
        }
        Ok(())
    }

    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError> {
        for request in requests {
            let displacement = filled(&mut self.displacement, request.displacement);
            let ask = Ask::Commit { displacement, energies: Energies::default(), outcome: Outcome::Valid };
            if let Ask::Commit { displacement, energies, outcome } = self.ask(ask)? {
                (request.energies, request.outcome) = (energies, outcome);
                self.displacement = displacement;
            }
        }
        Ok(())
    }

    fn fields(&mut self, _: usize) -> Result<CaseFields, ComputeError> {
        match self.ask(Ask::Fields(None))? {
            Ask::Fields(Some(fields)) => Ok(fields),
            _ => Err(gone()),
        }
    }

    fn state(&mut self, _: usize) -> Result<CaseState, ComputeError> {
        match self.ask(Ask::State(None))? {
            Ask::State(Some(state)) => Ok(state),
            _ => Err(gone()),
        }
    }

    fn restore(&mut self, _: usize, state: &CaseState) -> Result<(), ComputeError> {
        self.ask(Ask::Restore(state.clone())).map(drop)
    }

    fn take_notes(&mut self) -> Vec<String> {
        let told = lock(&self.told);
        let new = told.notes[self.heard..].to_vec();
        self.heard = told.notes.len();
        new
    }
}
