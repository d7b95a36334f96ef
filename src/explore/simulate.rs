//! The simulation that the page has started: one at a time, in a thread of its own, whose rows can
//! be drawn while it runs.

use std::num::NonZeroUsize;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Instant;

use crate::case::Case;
use crate::output::plots::SlipPanel;
use crate::output::{Position, Progress, StepRecord, Summary};
use crate::session::{Canceller, DeviceChoice, Options, PrecisionChoice, Simulation};

/// Most steps of a shear whose contact is kept for the map.
const MOST_FRAMES: usize = 80;

/// Where simulations of the page compute.
#[derive(Clone, Copy, Debug)]
pub struct Resources {
    /// The device.
    pub device: DeviceChoice,
    /// Its precision.
    pub precision: PrecisionChoice,
    /// Threads; one less than the machine's cores leaves one for the page.
    pub threads: NonZeroUsize,
}

/// How far a simulation is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// It computes.
    Running,
    /// To the end of the path.
    Done,
    /// Cancelled, from the page or with the server.
    Cancelled,
    /// It did not converge or met an error; what was computed is there.
    Failed,
}

impl Stage {
    /// Its word for the page.
    pub fn word(self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Done => "done",
            Self::Cancelled => "cancelled",
            Self::Failed => "failed",
        }
    }
}

/// A simulation, as it stands.
#[derive(Clone, Debug)]
pub struct SimulatedRun {
    /// What is simulated.
    pub case: Case,
    /// The query of the page that started it.
    pub query: String,
    /// How far it is.
    pub stage: Stage,
    /// Share of the path that is behind.
    pub fraction: f64,
    /// The last that there is to say.
    pub message: String,
    /// The rows.
    pub history: Vec<StepRecord>,
    /// The contact at steps of the shear.
    pub frames: Arc<Vec<SlipPanel>>,
    /// Some numbers, once it has ended.
    pub summary: Option<Summary>,
    /// Seconds since it began, or that it took.
    pub seconds: f64,
}

/// Holds the one simulation that there may be.
#[derive(Default)]
pub struct PageSimulator {
    run: Arc<Mutex<Option<SimulatedRun>>>,
    thread: Mutex<Option<(JoinHandle<()>, Canceller)>>,
}

fn held<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl PageSimulator {
    /// Starts one, in place of one that has ended. One that runs is not replaced: then the answer
    /// is what to do.
    ///
    /// # Errors
    /// Why it was not started.
    pub fn start(&self, case: Case, query: String, place: Resources) -> Result<(), String> {
        let mut thread = held(&self.thread);
        if thread.as_ref().is_some_and(|(thread, _)| !thread.is_finished()) {
            return Err("a simulation is running; cancel it first".to_owned());
        }
        let canceller = Canceller::default();
        let run = SimulatedRun {
            case: case.clone(),
            query,
            stage: Stage::Running,
            fraction: 0.0,
            message: "meshing".to_owned(),
            history: Vec::new(),
            frames: Arc::default(),
            summary: None,
            seconds: 0.0,
        };
        *held(&self.run) = Some(run);
        let (shared, own) = (Arc::clone(&self.run), canceller.clone());
        let work = move || {
            let begun = Instant::now();
            let followed = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| follow(&case, place, own, &shared, begun)));
            let (stage, message) =
                followed.unwrap_or_else(|_| (Stage::Failed, "the simulation has met a fault of the program".to_owned()));
            change(&shared, |run| {
                (run.stage, run.message, run.seconds) = (stage, message, begun.elapsed().as_secs_f64());
            });
        };
        let spawned = std::thread::Builder::new().name("simulation".to_owned()).spawn(work);
        *thread = Some((spawned.map_err(|error| format!("the system gives no thread: {error}"))?, canceller));
        Ok(())
    }

    /// Asks it to end after its present step.
    pub fn cancel(&self) {
        if let Some((_, canceller)) = held(&self.thread).as_ref() {
            canceller.cancel();
        }
    }

    /// Ends it and waits for that; whether one was running.
    pub fn end(&self) -> bool {
        let Some((thread, canceller)) = held(&self.thread).take() else { return false };
        let running = !thread.is_finished();
        canceller.cancel();
        let _ = thread.join();
        running
    }

    /// As it stands.
    pub fn run(&self) -> Option<SimulatedRun> {
        held(&self.run).clone()
    }
}

fn change(run: &Mutex<Option<SimulatedRun>>, how: impl FnOnce(&mut SimulatedRun)) {
    if let Some(run) = held(run).as_mut() {
        how(run);
    }
}

/// Follows the path and keeps what the page shows; how it ended, in a word and in words.
fn follow(
    case: &Case,
    place: Resources,
    canceller: Canceller,
    shared: &Arc<Mutex<Option<SimulatedRun>>>,
    begun: Instant,
) -> (Stage, String) {
    let failed = |error: &dyn std::fmt::Display| (Stage::Failed, error.to_string());
    let options = Options {
        device: place.device,
        precision: place.precision,
        threads: Some(place.threads),
        canceller: canceller.clone(),
        ..Options::default()
    };
    let mut simulation = match Simulation::with(case, options) {
        Ok(simulation) => simulation.watched_by(Box::new(PageWatch(Arc::clone(shared)))),
        Err(error) => return failed(&error),
    };
    let mut frames: Vec<SlipPanel> = Vec::new();
    loop {
        let record = match simulation.step() {
            Ok(Some(record)) => record,
            Ok(None) => break,
            Err(error) => return failed(&error),
        };
        let history = simulation.history().to_vec();
        // A run that starts over has other steps.
        frames.retain(|frame| frame.step < record.step);
        let before = history.len().checked_sub(2).map_or(0.0, |before| history[before].delta_t);
        if record.delta_t != before && frames.len() < MOST_FRAMES {
            let ratio = (record.f_n > 0.0).then(|| record.f_t / record.f_n);
            frames.push(SlipPanel { step: record.step, delta_t: record.delta_t, ratio, points: simulation.contact() });
        }
        let shown = Arc::new(frames.clone());
        change(shared, |run| {
            (run.history, run.frames, run.seconds) = (history, shown, begun.elapsed().as_secs_f64());
        });
    }
    let Some(outcome) = simulation.outcome().cloned() else { return (Stage::Failed, "it ended without a result".to_owned()) };
    let (done, reason) = (outcome.is_done(), outcome.message.clone());
    let seconds = begun.elapsed().as_secs_f64();
    change(shared, |run| (run.summary, run.fraction) = (Some(outcome.summary), if done { 1.0 } else { run.fraction }));
    match (done, canceller.is_cancelled()) {
        (true, _) => (Stage::Done, format!("done in {seconds:.0} s")),
        (false, true) => (Stage::Cancelled, format!("cancelled after {} steps", simulation.history().len())),
        (false, false) => (Stage::Failed, reason.unwrap_or_default()),
    }
}

/// Puts progress where the page asks for it.
struct PageWatch(Arc<Mutex<Option<SimulatedRun>>>);

impl Progress for PageWatch {
    fn step(&mut self, position: &Position) {
        change(&self.0, |run| {
            run.fraction = position.fraction;
            run.message = format!("step {}, {}", position.step, position.detail);
        });
    }

    fn message(&mut self, text: &str) {
        change(&self.0, |run| text.clone_into(&mut run.message));
    }

    fn finish(&mut self, _: &str) {}
}
