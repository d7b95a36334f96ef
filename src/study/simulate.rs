//! One case of a study, from its directory to its summary.

use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use super::StudyError;
use super::directory::StudyDirectory;
use super::file::StudyCase;
use super::progress::{CaseProgress, StudyProgress};
use super::row::{Row, RowStatus};
use crate::compute::Description;
use crate::output::{
    Checkpoint, Clock, DirectoryLock, OutputDirectory, OutputError, ResultWriter, RunStatus, Setting, Summary, SummaryInputs,
    TaskLock, read_history,
};
use crate::simulation::SimulationError;
use crate::simulation::drive::{Ending, Observer};
use crate::simulation::follow::{Seat, follow};
use crate::simulation::problem::Problem;
use crate::simulation::scout::scout;

/// What all cases have in common.
pub struct Simulator<'a> {
    /// The cases.
    pub cases: &'a [StudyCase],
    /// Where their directories are.
    pub directory: &'a StudyDirectory,
    /// The right to compute them there.
    pub lock: &'a TaskLock,
    /// Who is told how far they are.
    pub progress: Arc<StudyProgress>,
    /// Asked after every step.
    pub stop: Arc<AtomicBool>,
    /// Go on from checkpoints.
    pub resume: bool,
    /// The directories of the cases that are being computed.
    pub locks: Mutex<BTreeMap<usize, DirectoryLock>>,
}

impl Simulator<'_> {
    /// Makes the directory of a case anew, with its `case.toml`: from now on it is a case that has
    /// begun. One that is to go on from its checkpoint stays as it is.
    ///
    /// # Errors
    /// [`StudyError::Output`].
    pub fn begin(&self, case: usize) -> Result<OutputDirectory, StudyError> {
        let StudyCase { id, case: in_units, .. } = &self.cases[case];
        self.lock.check_there()?;
        let out = self.directory.make_case(id)?;
        let lock = DirectoryLock::take(out.root())?;
        lock.note().into_iter().for_each(|note| self.progress.message(id, &format!("note: {note}")));
        self.locks.lock().unwrap_or_else(PoisonError::into_inner).insert(case, lock);
        if self.done_meanwhile(case).is_some() {
            return Ok(out);
        }
        let checkpoint = self.checkpoint(case).unwrap_or_else(|error| {
            self.progress.message(id, &format!("note: {error}; computed from its beginning"));
            None
        });
        if checkpoint.is_none() {
            out.clear()?;
            out.write_case(&in_units.to_toml())?;
        }
        Ok(out)
    }

    /// Gives back the directory of a case.
    pub fn release(&self, case: usize) {
        self.locks.lock().unwrap_or_else(PoisonError::into_inner).remove(&case);
    }

    /// The summary of a case that is to go on, if another process has done it since the study was
    /// begun.
    pub fn done_meanwhile(&self, case: usize) -> Option<Summary> {
        let StudyCase { id, case, .. } = self.resume.then(|| &self.cases[case])?;
        let row = Row::read(case, &self.directory.case(id));
        row.summary.filter(|_| row.status == RowStatus::Done)
    }

    /// The checkpoint of a case that is to go on. One that is of another case or version, or
    /// damaged, is an error: the case is computed from its beginning.
    fn checkpoint(&self, case: usize) -> Result<Option<Checkpoint>, OutputError> {
        if !self.resume {
            return Ok(None);
        }
        let StudyCase { id, case, .. } = &self.cases[case];
        let out = self.directory.case(id);
        let path = out.checkpoint();
        let checkpoint = Checkpoint::read(&path)?.filter(|_| out.holds_result());
        checkpoint.as_ref().map_or(Ok(()), |checkpoint| checkpoint.check_case(&path, case))?;
        checkpoint.as_ref().map_or(Ok(()), |checkpoint| checkpoint.check_files(&out, case))?;
        Ok(checkpoint)
    }

    /// The mesh that a case asks for, or that of the checkpoint from which it will go on, with the
    /// model on it.
    ///
    /// # Errors
    /// [`StudyError::Simulation`].
    pub fn problem(&self, case: usize) -> Result<Problem, StudyError> {
        Ok(Problem::on(&self.cases[case].case, self.checkpoint(case)?.and_then(|checkpoint| checkpoint.zone()))?)
    }

    /// Follows the path of a case that has begun, from its checkpoint if there is one. `seat` has
    /// backends for its problem, the first of which computes on `computed_on`; `notes` are on how
    /// it was chosen.
    ///
    /// # Errors
    /// [`StudyError::Simulation`], [`StudyError::Output`]; a step that does not converge is none,
    /// but the summary's status.
    pub fn follow<'a>(
        &self,
        case: usize,
        mut problem: Problem,
        seat: &mut dyn FnMut(&Problem) -> Result<Seat<'a>, SimulationError>,
        computed_on: Description,
        notes: &[String],
    ) -> Result<Summary, StudyError> {
        let clock = Clock::start_for_thread();
        let StudyCase { id, case: in_units, .. } = &self.cases[case];
        let out = self.directory.case(id);
        let same_precision = |checkpoint: &Checkpoint| {
            let checked = checkpoint.check_precision(&out.checkpoint(), computed_on.precision);
            checked.inspect_err(|error| self.progress.message(id, &format!("note: {error}; computed from its beginning"))).is_ok()
        };
        let checkpoint = self.checkpoint(case)?.filter(same_precision);
        match &checkpoint {
            Some(checkpoint) => {
                checkpoint.snapshot().check(&problem.model.mesh)?;
                log::info!("case {id}: resumed after step {}", checkpoint.step());
            }
            // There may be one in another precision.
            None => {
                out.clear()?;
                if problem.zone != Problem::zone_of(in_units)? {
                    problem = Problem::new(in_units)?;
                }
            }
        }
        let begun = Instant::now();
        let scouts = checkpoint.is_none() && in_units.solver.error_estimate;
        let companion = if scouts { scout(in_units, &self.stop)? } else { None };
        let stopped = scouts && companion.is_none();
        if let Some(companion) = &companion {
            let zone = companion.zone(problem.zone, problem.spacing);
            if zone != problem.zone {
                problem = Problem::on(in_units, Some(zone))?;
            }
        }
        let scout_took = begun.elapsed().as_secs_f64();
        let setting = Setting { computed_on, elements: problem.model.mesh.elements.len(), unknowns: problem.free_unknowns() };
        let progress = Box::new(CaseProgress { study: self.progress.clone(), case, id: id.clone() });
        let mut results =
            ResultWriter::create(in_units, out.root(), setting, clock, progress, self.stop.clone(), checkpoint.as_ref())?;
        results.meshed(&problem);
        notes.iter().filter(|_| checkpoint.is_none()).for_each(|note| results.note(note));
        if let Some(companion) = companion {
            results.scouted(companion, scout_took);
        }
        if stopped {
            return Ok(results.finish(RunStatus::Interrupted, Some("interrupted after step 0"))?);
        }
        let followed = follow(problem, checkpoint.as_ref().map(Checkpoint::snapshot), seat, &mut results)?;
        results.computed_on(followed.computed_on);
        let (status, message) = match followed.ending {
            Ending::Done => (RunStatus::Done, None),
            Ending::NotConverged(reason) => (RunStatus::NotConverged, Some(format!("no convergence: {reason}"))),
            Ending::Outgrown(outgrowth) => (RunStatus::ContactOutgrewMesh, Some(format!("{outgrowth}; there is no larger mesh"))),
            Ending::Interrupted => (RunStatus::Interrupted, Some(format!("interrupted after step {}", results.steps()))),
        };
        Ok(results.finish(status, message.as_deref())?)
    }

    /// The summary of a case that broke off for `reason`, with the numbers of what was computed
    /// until then; also written to its directory, as far as that can be written.
    pub fn broke_off(&self, case: usize, reason: &str) -> Summary {
        let ours = self.locks.lock().unwrap_or_else(PoisonError::into_inner).contains_key(&case);
        let StudyCase { id, case, .. } = &self.cases[case];
        let out = self.directory.case(id);
        if !ours || !out.holds_result() || out.refuse_foreign().is_err() {
            // Somebody else computes it, its directory was removed, or a file of the user's has the
            // name of a result's: nothing is written there.
            let status = if ours { RunStatus::Failed } else { RunStatus::Interrupted };
            return Summary { status, messages: vec![reason.to_owned()], ..Summary::default() };
        }
        let history = read_history(&out.history()).unwrap_or_default();
        let summary = Summary {
            status: RunStatus::Failed,
            messages: vec![reason.to_owned()],
            ..Summary::from_history(&history, &SummaryInputs::of(case))
        };
        // If the disk is full, the study's table is where that is told.
        let _ = summary.write(&out.summary());
        summary
    }
}
