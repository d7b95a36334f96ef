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

mod guest;
mod queue;

use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

pub use self::guest::{Guest, Slot};
use self::queue::{Answered, HostReport, QueuedCall, lock};
use crate::compute::select::SharedCalls;
use crate::compute::{Call, Compute};

/// A backend that will be shared.
pub struct Host {
    backend: Box<dyn Compute>,
    requests: Receiver<QueuedCall>,
    told: Arc<Mutex<HostReport>>,
}

/// A host for a backend and a place for each of its cases.
pub fn share(backend: Box<dyn Compute>) -> (Host, Vec<Slot>) {
    let cases = backend.models().len();
    let told = Arc::new(Mutex::new(HostReport { about: backend.about(), notes: Vec::new() }));
    let (sender, requests) = channel();
    let places = (0..cases).map(|slot| Slot::new(slot, sender.clone(), told.clone())).collect();
    (Host { backend, requests, told }, places)
}

impl Host {
    /// Serves until the last place and guest have gone; gives the calls of iterates that they
    /// shared.
    pub fn serve(mut self) -> SharedCalls {
        let mut shared = SharedCalls::default();
        while let Ok(first) = self.requests.recv() {
            let mut alike: Vec<Vec<QueuedCall>> = vec![vec![first]];
            for request in self.requests.try_iter() {
                match alike.iter_mut().find(|of| of[0].call.goes_with(&request.call)) {
                    Some(of) => of.push(request),
                    None => alike.push(vec![request]),
                }
            }
            for of in alike.iter().filter(|of| matches!(of[0].call, Call::Iterate(_))) {
                shared += SharedCalls { calls: 1, cases: of.len() as u64 };
            }
            let answered: Vec<_> = alike.into_iter().flat_map(|of| self.answer(of)).collect();
            let notes = self.backend.take_notes();
            let mut told = lock(&self.told);
            told.about = self.backend.about();
            told.notes.extend(notes);
            drop(told);
            for (reply, answer) in answered {
                // A guest that has gone needs no answer.
                let _ = reply.send(answer);
            }
        }
        shared
    }

    /// Answers requests of different cases, all of a kind, in one call.
    fn answer(&mut self, alike: Vec<QueuedCall>) -> Vec<(Sender<Answered>, Answered)> {
        let (replies, calls): (Vec<_>, Vec<_>) = alike.into_iter().map(|r| (r.reply, (r.case, r.call))).unzip();
        match self.backend.call(calls) {
            Ok(answers) => replies.into_iter().zip(answers.into_iter().map(Ok)).collect(),
            Err(error) => replies.into_iter().map(|reply| (reply, Err(error.clone()))).collect(),
        }
    }
}
