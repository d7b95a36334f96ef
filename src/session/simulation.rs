//! A simulation that is owned: options, steps, results.

use std::sync::Arc;

use rayon::ThreadPool;

use super::claim::{Claim, claim, tidy};
use super::memory::Memory;
use super::pacer::{Pace, Pacer};
use super::plan::{forecast, plan};
use super::prepare::prepare;
use super::prior::{PriorRun, prior_run, refused};
use super::sink::Sink;
use super::{Canceller, Earlier, Options, Outcome, SessionError};
use crate::case::{Case, check_room};
use crate::compute::select::{Selected, select};
use crate::compute::{ComputeError, Description};
use crate::memory;
use crate::output::space::{Space, stresses_in_space};
use crate::output::{
    Checkpoint, Clock, ContactPoint, OutputDirectory, Progress, ResultWriter, RunStatus, Setting, SilentProgress, StepRecord,
    Summary, Units, mises, read_history,
};
use crate::simulation::SimulationError;
use crate::simulation::drive::Ending;
use crate::simulation::follow::{Follower, Seat, seats};
use crate::simulation::problem::Problem;
use crate::simulation::scout::{Scout, first_zone, scout};
use crate::simulation::zone::Zone;

/// One case on its way along its path.
///
/// [`Simulation::run`] goes to the end of the path. [`Simulation::step`] takes one step,
/// [`Simulation::steps`] iterates over those that are left; in between, contact and fields can be
/// looked at. All of it gives the same bits, those of `asperity run`. A simulation with a directory
/// that is dropped before the end of its path leaves a checkpoint there, as an interrupted run
/// does.
///
/// ```
/// use asperity::{Case, Simulation};
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// # let text = include_str!("../../fixtures/cases/ideal.toml");
/// # let case = Case::parse(text, "ideal.toml", &["mesh.elements_per_contact_radius=4".into(), "solver.error_estimate=false".into()])?;
/// let mut simulation = Simulation::new(&case)?;
/// for row in simulation.steps().take(3) {
///     let row = row?;
///     println!("h = {}, F_N = {}", row.h, row.f_n);
/// }
/// assert_eq!(simulation.history().len(), 3);
/// # Ok(()) }
/// ```
pub struct Simulation {
    case: Case,
    options: Options,
    clock: Clock,
    progress: Option<Box<dyn Progress>>,
    pool: Option<Arc<ThreadPool>>,
    notes: Vec<String>,
    history: Vec<StepRecord>,
    stage: RunStage,
    /// Kept until the end: nobody else writes there. Last, so that it is given back when all is
    /// written.
    claim: Option<Claim>,
}

type Seats = Box<dyn FnMut(&Problem) -> Result<Seat<'static>, SimulationError> + Send>;

/// How far it is.
enum RunStage {
    /// Nothing is computed; what is needed for it is there.
    Ready(Box<Ready>),
    Running(Box<Running>),
    /// To the end of the path, or as far as it went; without a follower it had ended before.
    Ended(Box<Outcome>, Option<Box<Follower<'static>>>),
    BrokenOff,
}

struct Ready {
    problem: Problem,
    seats: Seats,
    computed_on: Description,
    selection: Vec<String>,
    checkpoint: Option<Box<Checkpoint>>,
    /// The checkpoint is the end of a path of so many segments, with which this one begins.
    extends: Option<usize>,
}

struct Running {
    follower: Follower<'static>,
    seats: Seats,
    sink: Sink,
}

/// What the last accepted step shows, of the meshed half, y >= 0, in the user's units.
#[derive(Clone, Debug, PartialEq)]
pub struct StepFields {
    /// Positions of the nodes before deformation, lengths.
    pub nodes: Vec<[f64; 3]>,
    /// Hexahedra: eight nodes each, in the order of VTK.
    pub elements: Vec<[u32; 8]>,
    /// Displacement of the nodes, lengths.
    pub displacement: Vec<[f64; 3]>,
    /// Cauchy stress xx, yy, zz, xy, yz, zx of the elements.
    pub stress: Vec<[f64; 6]>,
    /// Mises' equivalent stress of the elements.
    pub mises: Vec<f64>,
    /// Equivalent plastic strain of the elements.
    pub alpha: Vec<f64>,
}

impl Simulation {
    /// A simulation of `case` in the pool of threads from which it is called, on a GPU if there is
    /// one worth it, that writes nothing. Simulations side by side should each have
    /// [`Options::threads`] of their own: in one pool one may have to wait for another.
    ///
    /// # Errors
    /// [`SessionError`]: an invalid case, with the name of the key.
    pub fn new(case: &Case) -> Result<Self, SessionError> {
        Self::with(case, Options::default())
    }

    /// The same with options. The directory is taken, and an earlier result is recognised, before
    /// anything is computed.
    ///
    /// # Errors
    /// [`SessionError`]: an invalid case, a directory that must not be used, a missing device.
    pub fn with(case: &Case, options: Options) -> Result<Self, SessionError> {
        let clock = Clock::start();
        case.validate()?;
        let pool = options.threads.map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build();
            pool.map(Arc::new).map_err(|error| SessionError::Threads { threads: threads.get(), what: error.to_string() })
        });
        let mut simulation = Self {
            case: case.clone(),
            clock,
            progress: None,
            pool: pool.transpose()?,
            notes: Vec::new(),
            history: Vec::new(),
            stage: RunStage::BrokenOff,
            claim: None,
            options,
        };
        simulation.stage = simulation.within_pool(Self::make_ready)?;
        Ok(simulation)
    }

    /// Shows every step to `progress`; to be called before the first one.
    pub fn watched_by(mut self, progress: Box<dyn Progress>) -> Self {
        self.progress = Some(progress);
        self
    }

    /// What the user should know of how the directory was taken, and of what is odd about the case.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Ends the run from another thread.
    pub fn canceller(&self) -> Canceller {
        self.options.canceller.clone()
    }

    /// The case.
    pub fn case(&self) -> &Case {
        &self.case
    }

    /// The accepted steps so far, in the user's units.
    pub fn history(&self) -> &[StepRecord] {
        &self.history
    }

    /// How it ended; `None` before that.
    pub fn outcome(&self) -> Option<&Outcome> {
        match &self.stage {
            RunStage::Ended(outcome, _) => Some(outcome),
            _ => None,
        }
    }

    /// Follows the path, or what is left of it, to its end.
    ///
    /// A step that does not converge and a cancelled run are no errors: what was computed is kept,
    /// and the outcome says so.
    ///
    /// # Errors
    /// [`SessionError::BrokeOff`]: results cannot be written, or the device failed; what was
    /// computed is kept.
    pub fn run(&mut self) -> Result<Outcome, SessionError> {
        self.advance(Pace::Whole)?;
        self.outcome().cloned().ok_or(SessionError::Over)
    }

    /// Takes one step and gives its row; `None` once the run has ended, of which
    /// [`Simulation::outcome`] then tells.
    ///
    /// The first call also makes the coarse run that goes before a run. A contact that leaves the
    /// finely meshed zone, which that run prevents, makes the run start over: the rows begin again
    /// at step 1.
    ///
    /// # Errors
    /// As [`Simulation::run`].
    pub fn step(&mut self) -> Result<Option<StepRecord>, SessionError> {
        Ok(self.advance(Pace::Step)?.then(|| self.history.last().copied()).flatten())
    }

    /// The steps that are left.
    pub fn steps(&mut self) -> Steps<'_> {
        Steps { simulation: self, failed: false }
    }

    /// The whole contact after the last accepted step, both halves, in the user's units; empty
    /// before the first step of this process.
    pub fn contact(&self) -> Vec<ContactPoint> {
        let points = self.follower().and_then(Follower::last).map(|last| last.points());
        points.map_or_else(Vec::new, |points| ContactPoint::whole_of(points, &Units::of(&self.case)))
    }

    /// Stresses and strains after the last accepted step; `None` before the first step of this
    /// process.
    ///
    /// # Errors
    /// [`SessionError::Simulation`] if the device fails.
    pub fn fields(&mut self) -> Result<Option<StepFields>, SessionError> {
        let units = Units::of(&self.case);
        let follower = match &mut self.stage {
            RunStage::Running(running) => &mut running.follower,
            RunStage::Ended(_, Some(follower)) => follower.as_mut(),
            _ => return Ok(None),
        };
        let fields = follower.fields().map_err(|error| SessionError::Simulation(error.into()))?;
        let Some(last) = follower.last() else { return Ok(None) };
        let mesh = &follower.problem().model.mesh;
        let space = Space::new(mesh);
        let length = |x: &[f64; 3]| units.vector(x);
        let stress: Vec<[f64; 6]> = stresses_in_space(mesh, &fields.stress).iter().map(|stress| units.stress(stress)).collect();
        Ok(Some(StepFields {
            nodes: space.vectors(&mesh.nodes).iter().map(length).collect(),
            elements: space.elements(),
            displacement: space.vectors(last.displacement().as_chunks::<3>().0).iter().map(length).collect(),
            mises: stress.iter().map(mises).collect(),
            stress,
            alpha: fields.alpha,
        }))
    }

    fn follower(&self) -> Option<&Follower<'static>> {
        match &self.stage {
            RunStage::Running(running) => Some(&running.follower),
            RunStage::Ended(_, follower) => follower.as_deref(),
            _ => None,
        }
    }

    /// Calls `work` in the pool of this simulation, or else in the one from which it is called: a
    /// step has a hundred parallel loops, each of which would have to enter it.
    fn within_pool<T: Send>(&mut self, work: impl FnOnce(&mut Self) -> T + Send) -> T {
        match self.pool.clone() {
            Some(pool) => pool.install(|| work(self)),
            None => rayon::scope(|_| work(self)),
        }
    }

    /// Takes the directory, meshes and finds a device.
    fn make_ready(&mut self) -> Result<RunStage, SessionError> {
        let (case, options) = (&self.case, &self.options);
        let (mut checkpoint, mut extends) = (None, None);
        if let Some(out) = &options.out {
            let claim = self.claim.insert(claim(out, case, options.earlier)?);
            self.notes.extend(claim.note().map(|note| format!("note: {note}")));
            if matches!(options.earlier, Earlier::Resume | Earlier::Extend) {
                match prior_run(out, case, options.earlier == Earlier::Extend)? {
                    PriorRun::Ended(summary) => return self.ended_before(*summary),
                    PriorRun::Unfinished(found) => checkpoint = Some(found),
                    PriorRun::Extendable(found, segments) => (checkpoint, extends) = (Some(found), Some(segments)),
                    PriorRun::NotBegun => {}
                }
            }
        }
        check_room(case, None, &memory::room())?;
        self.notes.extend(case.doubts().iter().map(|doubt| format!("note: {doubt}")));
        let problem = Problem::on(case, checkpoint.as_deref().and_then(Checkpoint::zone)).map_err(SessionError::Simulation)?;
        let (device, precision) = (options.device, options.precision);
        let open = move |problem: &Problem| select(device, precision, vec![problem.model.clone()]);
        let Selected { backend, notes } = open(&problem).map_err(|error| match error {
            ComputeError::Device(what) => SessionError::Device { what },
            error => SessionError::Simulation(error.into()),
        })?;
        let computed_on = backend.about().description;
        if let Some(out) = &options.out {
            match &checkpoint {
                Some(checkpoint) => {
                    checkpoint.check_precision(&OutputDirectory::existing(out).checkpoint(), computed_on.precision)?;
                    checkpoint.snapshot().check(&problem.model.mesh).map_err(|error| refused(out, &error.to_string()))?;
                    // Labels of pictures may have changed since, or an extension was killed before
                    // it got here.
                    let directory = OutputDirectory::existing(out);
                    if extends.is_none() && directory.read_case().as_deref() != Some(&case.to_toml()) {
                        directory.go_over_to(&case.to_toml())?;
                    }
                }
                None => prepare(out, case)?,
            }
        }
        let seats = Box::new(seats((backend, 0), problem.zone, open));
        Ok(RunStage::Ready(Box::new(Ready { problem, seats, computed_on, selection: notes, checkpoint, extends })))
    }

    /// A run that is not computed again.
    fn ended_before(&mut self, summary: Summary) -> Result<RunStage, SessionError> {
        if let Some(out) = &self.options.out {
            self.history = read_history(&OutputDirectory::existing(out).history())?;
            let is_done = summary.status == RunStatus::Done;
            tidy(out, is_done && self.case.output.keep_checkpoint, !is_done);
        }
        let message = summary.messages.last().filter(|_| summary.status != RunStatus::Done).cloned();
        Ok(RunStage::Ended(Box::new(Outcome { status: summary.status, message, summary, ended_before: true }), None))
    }

    /// Goes on as far as `pace` says; whether a step was accepted.
    fn advance(&mut self, pace: Pace) -> Result<bool, SessionError> {
        self.within_pool(|simulation| simulation.advance_here(pace))
    }

    fn advance_here(&mut self, pace: Pace) -> Result<bool, SessionError> {
        let mut running = match std::mem::replace(&mut self.stage, RunStage::BrokenOff) {
            RunStage::Ready(ready) => match self.set_out(*ready)? {
                RunStage::Running(running) => running,
                ended => {
                    self.stage = ended;
                    return Ok(false);
                }
            },
            RunStage::Running(running) => running,
            RunStage::Ended(outcome, follower) => {
                self.stage = RunStage::Ended(outcome, follower);
                return Ok(false);
            }
            RunStage::BrokenOff => return Err(SessionError::Over),
        };
        let Running { follower, seats, sink } = running.as_mut();
        let mut pacer = Pacer::new(sink.observer(), Units::of(&self.case), &mut self.history, pace);
        let followed = follower.go_on(seats, &mut pacer);
        let (paused, accepted) = (pacer.has_paused(), pacer.has_accepted());
        if paused && followed.is_ok() {
            self.stage = RunStage::Running(running);
            return Ok(accepted);
        }
        let Running { follower, mut sink, .. } = *running;
        if let Sink::Files(results) = &mut sink
            && followed.is_ok()
        {
            // Not where it began, if the device failed on the way.
            results.computed_on(follower.description());
        }
        let outcome = self.conclude(followed, sink)?;
        self.stage = RunStage::Ended(Box::new(outcome), Some(Box::new(follower)));
        Ok(accepted)
    }

    /// Makes the coarse run, meshes for what it has found, and begins the results.
    fn set_out(&mut self, ready: Ready) -> Result<RunStage, SessionError> {
        let Ready { mut problem, mut seats, computed_on, selection, mut checkpoint, extends } = ready;
        let case = &self.case;
        let mut progress = self.progress.take().unwrap_or_else(|| Box::new(SilentProgress));
        plan(case, &computed_on).iter().for_each(|line| progress.message(line));
        let begun = std::time::Instant::now();
        let scouts = (checkpoint.is_none() || extends.is_some()) && case.solver.error_estimate;
        let mut scout = if scouts {
            progress.message("coarse run first, for the reach of the contact and the error estimate");
            scout(case, &self.options.canceller.flag).map_err(SessionError::Simulation)?
        } else {
            None
        };
        let stopped = scouts && scout.is_none();
        let scout_took = begun.elapsed().as_secs_f64();
        if let Some(segments) = extends
            && let Some(found) = checkpoint.take()
        {
            if stopped {
                return self.not_extended_yet();
            }
            checkpoint = Some(Box::new(self.extended(*found, segments, scout.take(), scout_took)?));
        }
        if let Some(scout) = &scout {
            let zone = scout.zone(problem.zone, problem.spacing);
            if zone != problem.zone {
                problem = Problem::on(case, Some(zone)).map_err(SessionError::Simulation)?;
            }
            progress.message(&forecast(scout, &problem, scout_took));
        }
        let setting = Setting { computed_on, elements: problem.model.mesh.elements.len(), unknowns: problem.free_unknowns() };
        let found = checkpoint.as_deref();
        let mut sink = self.sink(&problem, setting, progress, found, extends.is_some())?;
        if let (Some(out), Some(_)) = (&self.options.out, found) {
            self.history = read_history(&OutputDirectory::existing(out).history())?;
        }
        // A resumed run has noted them before.
        if checkpoint.is_none() {
            case.doubts().iter().for_each(|doubt| sink.remember(&doubt.to_string()));
        }
        selection.iter().filter(|_| checkpoint.is_none()).for_each(|note| sink.observer().note(note));
        if let Some(scout) = scout {
            let asked = Problem::zone_of(case).map_err(SessionError::Simulation)?;
            if problem.zone != asked {
                sink.observer().note(&format!(
                    "the contact leaves the zone of {:.4} R around the pole that would be meshed finely: meshed to {:.4} R, with elements of {:.5} R",
                    asked.radius(),
                    problem.zone.radius(),
                    problem.spacing
                ));
            }
            sink.scouted(scout, scout_took);
        }
        if stopped {
            // Without a checkpoint: the run will begin with its coarse run again.
            return Ok(RunStage::Ended(Box::new(self.conclude(Ok(Ending::Interrupted), sink)?), None));
        }
        log::info!("the run:");
        match Follower::new(problem, checkpoint.as_deref().map(Checkpoint::snapshot), &mut seats) {
            Ok(follower) => Ok(RunStage::Running(Box::new(Running { follower, seats, sink }))),
            Err(error) => Ok(RunStage::Ended(Box::new(self.conclude(Err(error), sink)?), None)),
        }
    }

    /// Begins the results, or goes on with those that were `found`, of a path that may have been
    /// `extended`.
    fn sink(
        &self,
        problem: &Problem,
        setting: Setting,
        progress: Box<dyn Progress>,
        found: Option<&Checkpoint>,
        extended: bool,
    ) -> Result<Sink, SessionError> {
        let (case, canceller) = (&self.case, self.options.canceller.clone());
        let Some(out) = &self.options.out else {
            return Ok(Sink::Memory(Box::new(Memory::new(case, problem, setting, self.clock, progress, canceller))));
        };
        let mut results = ResultWriter::create(case, out, setting, self.clock, progress, canceller.flag, found)?;
        results.meshed(problem);
        results = results.keeping_checkpoint(case.output.keep_checkpoint);
        if let Some(interval) = self.options.checkpoint_every {
            results = results.with_checkpoints_every(interval);
        }
        match found {
            Some(checkpoint) => {
                let how = if extended { "extended" } else { "resumed" };
                results.tell(&format!("{how} after step {} of the run in {}", checkpoint.step(), out.display()));
            }
            None if self.options.earlier == Earlier::Resume => {
                results.tell(&format!("nothing to resume in {}: from the beginning", out.display()));
            }
            None => {}
        }
        Ok(Sink::Files(Box::new(results)))
    }

    /// The checkpoint of a run that is done as one of this case, whose path begins with that of
    /// `segments` segments: what goes on from it has the bits that it would have had from the
    /// beginning. From here on the directory is one of an unfinished run of this case.
    fn extended(
        &self,
        found: Checkpoint,
        segments: usize,
        scout: Option<Scout>,
        seconds: f64,
    ) -> Result<Checkpoint, SessionError> {
        let case = &self.case;
        let Some(dir) = &self.options.out else { return Err(SessionError::Over) };
        let mut shorter = case.clone();
        shorter.path.truncate(segments);
        let zone = |case, scout| first_zone(case, scout).map_err(SessionError::Simulation);
        let (there, here) = (zone(&shorter, found.scout())?, zone(case, scout.as_ref())?);
        if there != here {
            let size = |zone: &Zone| zone.contact_radius / case.mesh.surface_elements() as f64;
            let why = format!(
                "from the beginning, the longer path would have another mesh: fine to {:.4} R, with elements of {:.5} R, and its run is on one \
                 fine to {:.4} R, with elements of {:.5} R. Compute it in another directory, or with --force; mesh.contact_radius and \
                 mesh.fine_zone, given from the first run on, fix the mesh",
                here.radius(),
                size(&here),
                there.radius(),
                size(&there),
            );
            return Err(SessionError::NotExtended { dir: dir.clone(), why });
        }
        let directory = OutputDirectory::existing(dir);
        let end = found.clone();
        let extended = found.extended(case, scout, seconds);
        // In this order: killed in between, the run is the one that is done or one to be resumed.
        // If the longer path does not converge, the end of the shorter one is still there.
        end.write(&directory.end_checkpoint())?;
        extended.write(&directory.checkpoint())?;
        directory.go_over_to(&case.to_toml())?;
        Ok(extended)
    }

    /// Interrupted before an extension had begun: the directory is as it was.
    fn not_extended_yet(&mut self) -> Result<RunStage, SessionError> {
        let Some(out) = self.options.out.as_ref().map(OutputDirectory::existing) else { return Err(SessionError::Over) };
        let summary = Summary::read(&out.summary())?;
        self.history = read_history(&out.history())?;
        let by = self.options.canceller.by;
        let message = format!(
            "interrupted{by} before the extension began; the results are as they were. To extend them, run the same command again"
        );
        let outcome = Outcome { status: RunStatus::Interrupted, message: Some(message), summary, ended_before: false };
        Ok(RunStage::Ended(Box::new(outcome), None))
    }

    /// Writes the end of the results and says how it went.
    fn conclude(&self, followed: Result<Ending, SimulationError>, sink: Sink) -> Result<Outcome, SessionError> {
        let steps = self.history.len();
        let broke_off = |what: String| SessionError::BrokeOff { steps, what, dir: self.options.out.clone() };
        let (status, message) = match followed {
            Ok(Ending::Done) => (RunStatus::Done, None),
            Ok(Ending::NotConverged(reason)) => (RunStatus::NotConverged, Some(format!("no convergence: {reason}"))),
            Ok(Ending::Outgrown(outgrowth)) => {
                (RunStatus::ContactOutgrewMesh, Some(format!("{outgrowth}; there is no larger mesh")))
            }
            Ok(Ending::Interrupted) => {
                let by = self.options.canceller.by;
                let reason = format!("interrupted{by} after step {steps}; to go on, run the same command with --resume");
                (RunStatus::Interrupted, Some(reason))
            }
            Err(error) => {
                let what = error.to_string();
                let not_finite = matches!(error, SimulationError::NotFinite { .. });
                let status = if not_finite { RunStatus::Failed } else { RunStatus::Interrupted };
                if let Sink::Files(results) = sink {
                    // The disk may be full: what can still be written is written, and the first
                    // error is the one to tell.
                    let _ = results.finish(status, Some(&what));
                }
                return Err(broke_off(what));
            }
        };
        let summary = match sink {
            Sink::Files(results) => results.finish(status, message.as_deref()).map_err(|error| broke_off(error.to_string()))?,
            Sink::Memory(memory) => memory.finish(&self.history, status, message.as_deref()),
        };
        Ok(Outcome { status, message, summary, ended_before: false })
    }
}

impl Drop for Simulation {
    fn drop(&mut self) {
        let begun = matches!(&self.stage, RunStage::Running(running) if matches!(running.sink, Sink::Files(_)));
        if begun && !std::thread::panicking() {
            // What cannot be written is lost; the steps are in the history all the same.
            let _ = self.advance(Pace::Halt);
        }
    }
}

/// The steps of a simulation that are left; after an error there are no more.
pub struct Steps<'a> {
    simulation: &'a mut Simulation,
    failed: bool,
}

impl Iterator for Steps<'_> {
    type Item = Result<StepRecord, SessionError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.failed {
            return None;
        }
        let step = self.simulation.step().transpose();
        self.failed = matches!(step, Some(Err(_)));
        step
    }
}
