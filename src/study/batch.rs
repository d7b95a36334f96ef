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

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use crate::compute::iterate::{self, IterateRequest, Keeps};
use crate::compute::linear::{LinearRequest, Side, SideReport};
use crate::compute::traffic::Traffic;
use crate::compute::{
    Blocks, CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, Energies,
    ForceRequest, Outcome, TangentRequest, TrialRequest,
};
use crate::contact::coulomb::Rows;

/// What a case asks for, and the answer when it comes back.
enum Ask {
    Force { displacement: Vec<f64>, force: Vec<f64>, outcome: Outcome },
    Trial { displacement: Vec<f64>, force: Vec<f64>, rows: Vec<Rows<f64>>, outcome: Outcome },
    Contact { displacement: Vec<f64>, force: Vec<f64>, rows: Vec<Rows<f64>> },
    Tangent { displacement: Vec<f64>, blocks: OwnBlocks, outcome: Outcome },
    Linear(LinearAsk),
    Commit { displacement: Vec<f64>, energies: Energies, outcome: Outcome },
    Iterate(Box<IterateRequest>),
    Begin(f64),
    Fields(Option<CaseFields>),
    State(Option<CaseState>),
    Restore(CaseState),
    Replace(Box<CaseModel>),
    Replaced(bool),
}

/// [`Blocks`] that own their numbers.
enum OwnBlocks {
    Double(Vec<[f64; 9]>),
    Single(Vec<[f32; 9]>),
}

impl Default for OwnBlocks {
    fn default() -> Self {
        Self::Single(Vec::new())
    }
}

impl OwnBlocks {
    /// Of the size and precision of `asked`; the memory is used again where it fits.
    fn like(self, asked: &Blocks<'_>) -> Self {
        match (self, asked) {
            (Self::Double(mut own), Blocks::Double(asked)) => {
                own.resize(asked.len(), [0.0; 9]);
                Self::Double(own)
            }
            (Self::Single(mut own), Blocks::Single(asked)) => {
                own.resize(asked.len(), [0.0; 9]);
                Self::Single(own)
            }
            (_, Blocks::Double(asked)) => Self::Double(vec![[0.0; 9]; asked.len()]),
            (_, Blocks::Single(asked)) => Self::Single(vec![[0.0; 9]; asked.len()]),
        }
    }

    fn request(&mut self) -> Blocks<'_> {
        match self {
            Self::Double(blocks) => Blocks::Double(blocks),
            Self::Single(blocks) => Blocks::Single(blocks),
        }
    }

    /// Copies to where they were asked for.
    fn copy_to(&self, asked: &mut Blocks<'_>) -> Result<(), ComputeError> {
        match (self, asked) {
            (Self::Double(own), Blocks::Double(asked)) => asked.copy_from_slice(own),
            (Self::Single(own), Blocks::Single(asked)) => asked.copy_from_slice(own),
            _ => return Err(ComputeError::Device("a tangent came back in another precision".to_owned())),
        }
        Ok(())
    }
}

/// A [`LinearRequest`] that owns what it is about.
struct LinearAsk {
    displacement: Vec<f64>,
    rows: Vec<Rows<f64>>,
    fixed: Vec<bool>,
    sides: Vec<SideAsk>,
    outcome: Outcome,
}

/// A [`Side`] that owns its vectors.
struct SideAsk {
    rhs: Vec<f64>,
    tolerance: f64,
    relative_to_guess: bool,
    expected: usize,
    x: Vec<f64>,
    report: SideReport,
}

impl LinearAsk {
    fn new(request: &LinearRequest<'_>) -> Self {
        let side = |side: &Side<'_>| SideAsk {
            rhs: side.rhs.to_vec(),
            tolerance: side.tolerance,
            relative_to_guess: side.relative_to_guess,
            expected: side.expected,
            x: side.x.to_vec(),
            report: side.report,
        };
        Self {
            displacement: request.displacement.to_vec(),
            rows: request.rows.to_vec(),
            fixed: request.fixed.to_vec(),
            sides: request.sides.iter().map(side).collect(),
            outcome: request.outcome,
        }
    }

    fn request(&mut self, case: usize) -> LinearRequest<'_> {
        let sides = self.sides.iter_mut().map(SideAsk::side).collect();
        let (displacement, rows, fixed) = (&self.displacement, &self.rows, &self.fixed);
        LinearRequest { case, displacement, rows, fixed, sides, outcome: self.outcome }
    }
}

impl SideAsk {
    fn side(&mut self) -> Side<'_> {
        let Self { rhs, tolerance, relative_to_guess, expected, x, report } = self;
        Side { rhs, tolerance: *tolerance, relative_to_guess: *relative_to_guess, expected: *expected, x, report: *report }
    }
}

type Answer = Result<Ask, ComputeError>;

struct Request {
    case: usize,
    ask: Ask,
    reply: Sender<Answer>,
}

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
    let places = (0..cases).map(|slot| Place { slot, requests: sender.clone(), told: told.clone() }).collect();
    (Host { backend, requests, told }, places)
}

impl Place {
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
        let (mut forces, mut trials, mut contacts) = (vec![], vec![], vec![]);
        let (mut tangents, mut systems) = (vec![], vec![]);
        let (mut commits, mut others) = (vec![], vec![]);
        let mut iterates: Vec<Vec<Request>> = vec![];
        for request in waiting {
            match request.ask {
                Ask::Force { .. } => forces.push(request),
                Ask::Trial { .. } => trials.push(request),
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
        let kinds = [
            (internal_force as Call, forces),
            (trial, trials),
            (contact, contacts),
            (tangent, tangents),
            (linear, systems),
            (commit, commits),
        ];
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

fn trial(backend: &mut dyn Compute, requests: &mut [Request]) -> Result<(), ComputeError> {
    let mut outcomes = Vec::new();
    let mut calls: Vec<TrialRequest<'_>> = Vec::new();
    for Request { case, ask, .. } in requests {
        if let Ask::Trial { displacement, force, rows, outcome } = ask {
            calls.push(TrialRequest { case: *case, displacement, force, rows, outcome: Outcome::Valid });
            outcomes.push(outcome);
        }
    }
    backend.trial(&mut calls)?;
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

    fn trial(&mut self, requests: &mut [TrialRequest<'_>]) -> Result<(), ComputeError> {
        for request in requests {
            let mut force = std::mem::take(&mut self.force);
            force.resize(request.force.len(), 0.0);
            let displacement = filled(&mut self.displacement, request.displacement);
            let ask = Ask::Trial { displacement, force, rows: request.rows.to_vec(), outcome: Outcome::Valid };
            if let Ask::Trial { displacement, force, rows, outcome } = self.ask(ask)? {
                request.force.copy_from_slice(&force);
                request.rows.copy_from_slice(&rows);
                request.outcome = outcome;
                (self.displacement, self.force) = (displacement, force);
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
