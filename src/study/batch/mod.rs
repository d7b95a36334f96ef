//! One device for many cases: their drives run side by side, each in its thread, and meet at the
//! device.
//!
//! ```text
//! drive 1 --ask-->  queue  --all that wait-->  backend, one call a kind  --answers--> drives
//! drive 2 --ask-->
//! ```
//! Whoever serves takes all requests that wait at that moment and makes one call of each kind out
//! of them, so that one dispatch serves every case that is at that point. It does not wait for the
//! others, who are busy on the cores with what the host does of an iteration: a device that is idle
//! takes what there is, and one that is busy finds the larger a batch. What a case gets does not
//! depend on the others of the call ([`Compute`]), so neither do results.

mod ask;
mod guest;

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use self::ask::{Answer, Ask, Request};
pub use self::guest::{Guest, Place};
use crate::compute::iterate::{self, IterateRequest, Keeps};
use crate::compute::linear::{LinearRequest, SideReport};
use crate::compute::traffic::Traffic;
use crate::compute::{
    CommitRequest, Compute, ComputeError, ContactRequest, Description, Energies, ForceRequest, Outcome, TangentRequest,
};

/// What the backend says of itself, for all guests.
struct Told {
    description: Description,
    notes: Vec<String>,
    traffic: Option<Traffic>,
    keeps: Keeps,
    has_stand_in: bool,
}

/// A backend that will be shared.
pub struct Host {
    backend: Box<dyn Compute>,
    requests: Receiver<Request>,
    told: Arc<Mutex<Told>>,
}

/// A host for a backend and a place for each of its cases.
pub fn share(backend: Box<dyn Compute>) -> (Host, Vec<Place>) {
    let cases = backend.models().len();
    let told = Told {
        description: backend.description(),
        notes: Vec::new(),
        traffic: backend.traffic(),
        keeps: backend.keeps(),
        has_stand_in: backend.has_stand_in(),
    };
    let told = Arc::new(Mutex::new(told));
    let (sender, requests) = channel();
    let places = (0..cases).map(|slot| Place::new(slot, sender.clone(), told.clone())).collect();
    (Host { backend, requests, told }, places)
}

impl Host {
    /// Serves until the last place and guest have gone.
    pub fn serve(mut self) {
        while let Ok(first) = self.requests.recv() {
            let mut waiting = vec![first];
            waiting.extend(self.requests.try_iter());
            let answers = self.answer(waiting);
            let notes = self.backend.take_notes();
            let mut told = lock(&self.told);
            told.traffic = self.backend.traffic();
            told.keeps = self.backend.keeps();
            told.has_stand_in = self.backend.has_stand_in();
            if !notes.is_empty() {
                told.description = self.backend.description();
                told.notes.extend(notes);
            }
            drop(told);
            for (reply, answer) in answers {
                // A guest that has gone needs no answer.
                let _ = reply.send(answer);
            }
        }
    }

    /// Answers requests of different cases, those of a kind in one call.
    fn answer(&mut self, waiting: Vec<Request>) -> Vec<(Sender<Answer>, Answer)> {
        let (mut forces, mut contacts) = (vec![], vec![]);
        let (mut tangents, mut systems) = (vec![], vec![]);
        let (mut commits, mut others) = (vec![], vec![]);
        let mut iterates: Vec<Vec<Request>> = vec![];
        for request in waiting {
            match request.ask {
                Ask::Force { .. } => forces.push(request),
                Ask::Contact { .. } => contacts.push(request),
                Ask::Tangent { .. } => tangents.push(request),
                Ask::Linear(_) => systems.push(request),
                Ask::Commit { .. } => commits.push(request),
                Ask::Iterate(ref asked) => match iterates.iter_mut().find(|of| asks_alike(&of[0].ask, asked)) {
                    Some(alike) => alike.push(request),
                    None => iterates.push(vec![request]),
                },
                Ask::Begin(_) | Ask::Fields(_) | Ask::State(_) | Ask::Restore(_) | Ask::Replace(_) | Ask::Replaced(_) => {
                    others.push(request)
                }
            }
        }
        let backend = self.backend.as_mut();
        let mut answers = Vec::new();
        let kinds =
            [(internal_force as Call, forces), (contact, contacts), (tangent, tangents), (linear, systems), (commit, commits)];
        let kinds = kinds.into_iter().chain(iterates.into_iter().map(|alike| (iterate as Call, alike)));
        for (call, mut requests) in kinds {
            if requests.is_empty() {
                continue;
            }
            let result = call(backend, &mut requests);
            answers.extend(
                requests
                    .into_iter()
                    .map(|Request { ask, reply, .. }| (reply, result.as_ref().map(|()| ask).map_err(ComputeError::clone))),
            );
        }
        answers.extend(others.into_iter().map(|Request { case, ask, reply }| (reply, single(backend, case, ask))));
        answers
    }
}

type Call = fn(&mut dyn Compute, &mut [Request]) -> Result<(), ComputeError>;

fn internal_force(backend: &mut dyn Compute, requests: &mut [Request]) -> Result<(), ComputeError> {
    let mut outcomes = Vec::new();
    let mut calls: Vec<ForceRequest<'_>> = Vec::new();
    for Request { case, ask, .. } in requests {
        if let Ask::Force { displacement, force, outcome } = ask {
            calls.push(ForceRequest { case: *case, displacement, force, outcome: Outcome::Valid });
            outcomes.push(outcome);
        }
    }
    backend.internal_force(&mut calls)?;
    outcomes.into_iter().zip(&calls).for_each(|(out, call)| *out = call.outcome);
    Ok(())
}

fn contact(backend: &mut dyn Compute, requests: &mut [Request]) -> Result<(), ComputeError> {
    let mut calls: Vec<ContactRequest<'_>> = Vec::new();
    for Request { case, ask, .. } in requests {
        if let Ask::Contact { displacement, force, rows } = ask {
            calls.push(ContactRequest { case: *case, displacement, force, rows });
        }
    }
    backend.contact(&mut calls)
}

fn tangent(backend: &mut dyn Compute, requests: &mut [Request]) -> Result<(), ComputeError> {
    let mut outcomes = Vec::new();
    let mut calls: Vec<TangentRequest<'_>> = Vec::new();
    for Request { case, ask, .. } in requests {
        if let Ask::Tangent { displacement, blocks, outcome } = ask {
            calls.push(TangentRequest { case: *case, displacement, blocks: blocks.request(), outcome: Outcome::Valid });
            outcomes.push(outcome);
        }
    }
    backend.tangent(&mut calls)?;
    outcomes.into_iter().zip(&calls).for_each(|(out, call)| *out = call.outcome);
    Ok(())
}

fn linear(backend: &mut dyn Compute, requests: &mut [Request]) -> Result<(), ComputeError> {
    let mut calls: Vec<LinearRequest<'_>> = Vec::new();
    for Request { case, ask, .. } in requests.iter_mut() {
        if let Ask::Linear(ask) = ask {
            calls.push(ask.request(*case));
        }
    }
    backend.linear(&mut calls)?;
    let answers: Vec<(Outcome, Vec<SideReport>)> =
        calls.iter().map(|call| (call.outcome, call.sides.iter().map(|side| side.report).collect())).collect();
    let asks = requests.iter_mut().filter_map(|request| if let Ask::Linear(ask) = &mut request.ask { Some(ask) } else { None });
    for (ask, (outcome, reports)) in asks.zip(answers) {
        ask.outcome = outcome;
        ask.sides.iter_mut().zip(reports).for_each(|(side, report)| side.report = report);
    }
    Ok(())
}

/// Whether a request asks of its iterates what `asked` does: they go into one call.
fn asks_alike(ask: &Ask, asked: &IterateRequest) -> bool {
    matches!(ask, Ask::Iterate(other) if std::mem::discriminant(&other.ask) == std::mem::discriminant(&asked.ask))
}

fn iterate(backend: &mut dyn Compute, requests: &mut [Request]) -> Result<(), ComputeError> {
    let mut calls = Vec::with_capacity(requests.len());
    for Request { case, ask, .. } in requests.iter_mut() {
        if let Ask::Iterate(asked) = ask {
            let nothing = IterateRequest { ask: iterate::Ask::Land, answer: iterate::Answer::Nothing, ..**asked };
            calls.push(IterateRequest { case: *case, ..std::mem::replace(&mut **asked, nothing) });
        }
    }
    backend.iterate(&mut calls)?;
    let asks =
        requests.iter_mut().filter_map(|request| if let Ask::Iterate(asked) = &mut request.ask { Some(asked) } else { None });
    asks.zip(calls).for_each(|(asked, call)| **asked = call);
    Ok(())
}

fn commit(backend: &mut dyn Compute, requests: &mut [Request]) -> Result<(), ComputeError> {
    let mut answers = Vec::new();
    let mut calls: Vec<CommitRequest<'_>> = Vec::new();
    for Request { case, ask, .. } in requests {
        if let Ask::Commit { displacement, energies, outcome } = ask {
            calls.push(CommitRequest { case: *case, displacement, energies: Energies::default(), outcome: Outcome::Valid });
            answers.push((energies, outcome));
        }
    }
    backend.commit(&mut calls)?;
    for ((energies, outcome), call) in answers.into_iter().zip(&calls) {
        (*energies, *outcome) = (call.energies, call.outcome);
    }
    Ok(())
}

/// What the trait has no batch of.
fn single(backend: &mut dyn Compute, case: usize, ask: Ask) -> Result<Ask, ComputeError> {
    Ok(match ask {
        Ask::Begin(weight) => {
            backend.begin_step(case, weight)?;
            Ask::Begin(weight)
        }
        Ask::Fields(_) => Ask::Fields(Some(backend.fields(case)?)),
        Ask::State(_) => Ask::State(Some(backend.state(case)?)),
        Ask::Restore(state) => {
            backend.restore(case, &state)?;
            Ask::Restore(state)
        }
        Ask::Replace(model) => Ask::Replaced(backend.replace(case, *model)?),
        other => other,
    })
}

fn lock(told: &Mutex<Told>) -> MutexGuard<'_, Told> {
    told.lock().unwrap_or_else(PoisonError::into_inner)
}
