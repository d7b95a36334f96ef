//! One device for many cases: their drives run side by side, each in its thread, and meet at the
//! device.
//!
//! ```text
//! drive 1 --ask-->  queue  --all that wait-->  backend, one call a kind  --answers--> drives
//! drive 2 --ask-->
//! ```
//! Whoever serves makes one call of each kind out of the requests that wait, so that one dispatch
//! serves every case that is at that point. Before it does, it waits for the guests who have not
//! asked yet, who are busy on the cores with what the host does of an iteration, but no longer than
//! a tenth of the last call took: else cases that are out of step stay so, and each call serves a
//! part of them. What a case gets does not depend on the others of the call ([`Compute`]), so
//! neither do results.

mod guest;
mod queue;

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

pub use self::guest::{Guest, Slot};
use self::queue::{Answered, HostReport, QueuedCall, lock};
use crate::compute::select::SharedCalls;
use crate::compute::{Call, Compute};

/// A call waits for late guests for at most one part in so many of the time that the last one took.
const PATIENCE: u32 = 10;

/// A backend that will be shared.
pub struct Host {
    backend: Box<dyn Compute>,
    requests: Receiver<QueuedCall>,
    told: Arc<Mutex<HostReport>>,
    /// Guests that there are.
    running: Arc<AtomicUsize>,
    /// How long the last round of calls took.
    last: Duration,
}

/// A host for a backend and a place for each of its cases.
pub fn share(backend: Box<dyn Compute>) -> (Host, Vec<Slot>) {
    let cases = backend.models().len();
    let told = Arc::new(Mutex::new(HostReport { about: backend.about(), notes: Vec::new() }));
    let (sender, requests) = channel();
    let running = Arc::new(AtomicUsize::new(0));
    let places = (0..cases).map(|slot| Slot::new(slot, sender.clone(), told.clone(), running.clone())).collect();
    (Host { backend, requests, told, running, last: Duration::ZERO }, places)
}

impl Host {
    /// Serves until the last place and guest have gone; gives the calls of iterates that they
    /// shared.
    pub fn serve(mut self) -> SharedCalls {
        let mut shared = SharedCalls::default();
        while let Ok(first) = self.requests.recv() {
            let waiting = self.gather(first);
            let begun = Instant::now();
            let mut alike: Vec<Vec<QueuedCall>> = Vec::new();
            for request in waiting {
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
            self.last = begun.elapsed();
            for (reply, answer) in answered {
                // A guest that has gone needs no answer.
                let _ = reply.send(answer);
            }
        }
        shared
    }

    /// The requests that wait, once all guests have asked or those that have not have had their
    /// time.
    fn gather(&self, first: QueuedCall) -> Vec<QueuedCall> {
        let mut waiting = vec![first];
        let until = Instant::now() + self.last / PATIENCE;
        loop {
            waiting.extend(self.requests.try_iter());
            let left = until.saturating_duration_since(Instant::now());
            if waiting.len() >= self.running.load(Ordering::Relaxed) || left.is_zero() {
                return waiting;
            }
            match self.requests.recv_timeout(left) {
                Ok(request) => waiting.push(request),
                Err(_) => return waiting,
            }
        }
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
