//! Watches a run and writes all that it leaves behind, as it goes.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::checkpoint::{Checkpoint, no_estimate};
use super::clock::Clock;
use super::finite::{check_saved, check_summary};
use super::ledger::Ledger;
use super::path_share::PathShare;
use super::tables::is_panel;
use super::units::coefficient;
use super::{
    Collection, ContactPoint, ErrorEstimate, HistoryWriter, Limits, OutputDirectory, OutputError, Position, Progress, RunStatus,
    StepRecord, Summary, SummaryInputs, TimeByPhase, Units, detail, last_line, write_contact, write_fields, write_parquet,
};
use crate::case::{Case, Fields, PictureFormat};
use crate::compute::{ComputeError, Description};
use crate::simulation::checkpoint::Snapshot;
use crate::simulation::drive::{Observer, StepView};
use crate::simulation::error::ObserverError;
use crate::simulation::problem::Problem;
use crate::simulation::scout::Scout;

/// What the summary has to know beside the history.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Device that runs the kernels, and their precision.
    pub computed_on: Description,
    /// Elements of the mesh.
    pub elements: usize,
    /// Displacements that are not prescribed.
    pub unknowns: usize,
}

/// Time between checkpoints: what a killed run loses at most, but for the step under way.
const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(5);
/// Writing them takes no more than one part in so many of the run, however large they are.
const CHECKPOINT_SHARE: u32 = 20;

/// What is drawn at the end, and how.
#[cfg(feature = "plots")]
struct Pictures {
    inputs: super::PlotInputs,
    view: super::plots::View,
    format: PictureFormat,
}

#[cfg(feature = "plots")]
impl Pictures {
    fn of(case: &Case) -> Self {
        Self { inputs: super::PlotInputs::of(case), view: super::plots::View::of(case), format: case.output.plot_format }
    }
}

/// What a run says that is to draw pictures and cannot: they are asked for by default, so that it
/// is no error.
const NO_PICTURES: &str = "no pictures are drawn: this program was built without the feature \"plots\". What they are drawn from is kept, \
                           and `asperity plot` draws them; output.plots = false asks for none";

/// Refuses what this program was built without before anything is computed.
fn check_formats(case: &Case, out: &OutputDirectory) -> Result<(), OutputError> {
    if case.output.parquet && !cfg!(feature = "parquet") {
        let problem = "this program was built without the feature \"parquet\"; leave out output.parquet".to_owned();
        return Err(OutputError::Format { path: out.parquet(), problem });
    }
    match case.output.plot_format {
        PictureFormat::Pdf | PictureFormat::Png if case.output.plots && !cfg!(feature = "print") => {
            let problem = "this program was built without the feature \"print\"; set output.plot_format = \"svg\"".to_owned();
            Err(OutputError::Format { path: out.plot("forces", case.output.plot_format), problem })
        }
        _ => Ok(()),
    }
}

/// Writes `history.csv` row by row, fields and contact tables of the steps that are to be saved,
/// and at the end plots and summary.
pub struct ResultWriter {
    out: OutputDirectory,
    units: Units,
    fields: Fields,
    /// Keep what the pictures show, and draw them at the end where this build can.
    plots: bool,
    #[cfg(feature = "plots")]
    pictures: Pictures,
    friction: Option<f64>,
    /// Write `history.parquet` at the end.
    parquet: bool,
    inputs: SummaryInputs,
    setting: Setting,
    clock: Clock,
    progress: Box<dyn Progress>,
    stop: Arc<AtomicBool>,
    share: PathShare,
    as_given: Case,
    history: HistoryWriter,
    collection: Collection,
    ledger: Ledger,
    /// Size of the elements in the contact, scaled.
    spacing: f64,
    /// What the companion tells, if there was one that got to its end.
    limits: Option<Limits>,
    /// The resolved case, for checkpoints.
    case: String,
    /// Where the run began, as `setting` may not say any more.
    began_on: Description,
    checkpoint_interval: Duration,
    /// [`CHECKPOINT_SHARE`], or 0 for no bound.
    checkpoint_share: u32,
    next_checkpoint: Instant,
    /// The last checkpoint could not be written, and that has been told.
    checkpoint_failed: bool,
    /// The checkpoint of the path's end stays when the run is done; and it has been written.
    keeps_checkpoint: bool,
    end_is_kept: bool,
    /// A result was no number: to compute it again would be in vain.
    failed: bool,
}

impl ResultWriter {
    /// Begins the results of a case (in the user's units) in a directory that is there, or goes on
    /// with those of an unfinished run of the same case, whose files beyond the checkpoint are
    /// removed; `stop` is asked after every step.
    ///
    /// # Errors
    /// [`OutputError::Write`], [`OutputError::Read`].
    pub fn create(
        case: &Case,
        dir: &Path,
        setting: Setting,
        clock: Clock,
        progress: Box<dyn Progress>,
        stop: Arc<AtomicBool>,
        resumed: Option<&Checkpoint>,
    ) -> Result<Self, OutputError> {
        let out = OutputDirectory::existing(dir);
        check_formats(case, &out)?;
        let mut ledger = Ledger { cpu_before: Some(0.0), ..Ledger::default() };
        let mut share = PathShare::new(&case.path);
        let (history, collection) = match resumed {
            None => (HistoryWriter::create(&out.history())?, Collection::new(&out.collection())),
            Some(checkpoint) => {
                ledger = checkpoint.ledger.clone();
                ledger.traffic.reopened();
                for row in &ledger.rows {
                    share.after(row);
                }
                out.cut_back(&ledger.saved, &ledger.panels)?;
                let saved = ledger.saved.iter().filter(|_| case.output.fields.has_vtu());
                let collection =
                    Collection::resume(&out.collection(), saved.map(|&step| (ledger.path_length(step), out.fields(step))))?;
                (HistoryWriter::resume(&out.history(), &ledger.rows)?, collection)
            }
        };
        ledger.outside.setup += clock.wall_seconds();
        let moved = resumed.and_then(|checkpoint| checkpoint.change_of_device(&setting.computed_on.device));
        let mut results = Self {
            units: Units::of(case),
            fields: case.output.fields,
            plots: case.output.plots,
            #[cfg(feature = "plots")]
            pictures: Pictures::of(case),
            friction: coefficient(case.contact.friction),
            parquet: case.output.parquet,
            inputs: SummaryInputs::of(case),
            began_on: setting.computed_on.clone(),
            setting,
            clock,
            progress,
            stop,
            share,
            history,
            collection,
            ledger,
            spacing: 0.0,
            limits: None,
            as_given: case.clone(),
            case: case.to_toml(),
            checkpoint_interval: CHECKPOINT_INTERVAL,
            checkpoint_share: CHECKPOINT_SHARE,
            next_checkpoint: Instant::now() + CHECKPOINT_INTERVAL,
            checkpoint_failed: false,
            keeps_checkpoint: false,
            end_is_kept: false,
            failed: false,
            out,
        };
        moved.iter().for_each(|text| results.note(text));
        // A resumed run has noted it before.
        if results.plots && cfg!(not(feature = "plots")) && resumed.is_none() {
            results.note(NO_PICTURES);
        }
        Ok(results)
    }

    /// Checkpoints every so often instead of every five seconds, whatever share of the run writing
    /// them takes; zero is after every step. Results do not depend on it.
    pub fn with_checkpoints_every(mut self, interval: Duration) -> Self {
        (self.checkpoint_interval, self.checkpoint_share, self.next_checkpoint) = (interval, 0, Instant::now() + interval);
        self
    }

    /// Keeps the last checkpoint when the run is done, or not.
    pub fn keeping_checkpoint(mut self, keeps: bool) -> Self {
        self.keeps_checkpoint = keeps;
        self
    }

    /// Keeps a note for the summary that the user has been told already.
    pub fn remember(&mut self, note: &str) {
        self.ledger.messages.push(format!("note: {note}"));
    }

    /// Tells the user something that is not for the summary.
    pub fn tell(&mut self, text: &str) {
        self.progress.message(text);
    }

    /// Says anew where the run is computed: a device may have failed on the way.
    pub fn computed_on(&mut self, description: Description) {
        self.setting.computed_on = description;
    }

    /// Takes what the coarse run before this one has found in so many seconds on the wall, which
    /// have gone by already.
    pub fn scouted(&mut self, scout: Scout, seconds: f64) {
        self.ledger.outside.error_estimate = seconds;
        self.ledger.outside.setup -= seconds;
        no_estimate(&scout).iter().for_each(|text| self.note(text));
        self.ledger.scout = Some(scout);
        self.compare();
    }

    /// Says on what mesh the run is.
    pub fn meshed(&mut self, problem: &Problem) {
        self.spacing = problem.spacing;
        self.ledger.zone = Some(problem.zone);
        self.compare();
    }

    /// Makes the limits anew: mesh or companion are others.
    fn compare(&mut self) {
        self.limits = self.ledger.scout.as_ref().and_then(|scout| Limits::new(&self.as_given, scout, self.spacing));
    }

    /// The row of a step, with what is known of its limits, which the view gets too.
    fn row(&self, view: &mut StepView<'_>) -> StepRecord {
        if let Some(limits) = &self.limits {
            limits.of(&self.ledger.rows, &view.record.in_units(&self.units)).put_into(&mut view.record, &self.units);
        }
        view.record.in_units(&self.units)
    }

    /// Estimates the errors of the run from what the scout has found, if it got to its end.
    fn estimate(&self) -> Option<ErrorEstimate> {
        Some(ErrorEstimate::new(&self.ledger.rows, &self.inputs.oblique, self.limits.as_ref()?))
    }

    /// Steps written so far.
    pub fn steps(&self) -> usize {
        self.ledger.rows.len()
    }

    #[cfg(feature = "plots")]
    fn draw(&self) -> Result<(), OutputError> {
        if self.plots {
            let Pictures { inputs, view, format } = &self.pictures;
            super::write_plots(&self.out, &self.ledger.rows, &self.ledger.tables, inputs, view, *format)?;
        }
        Ok(())
    }

    /// Contact tables and history are there for `asperity plot`, which draws the same pictures.
    #[cfg(not(feature = "plots"))]
    fn draw(&self) -> Result<(), OutputError> {
        Ok(())
    }

    /// Draws the plots and writes the summary of a run that ended as `status` for the reason
    /// `message`. The summary is written even if a plot fails, whose error is then returned. Of a
    /// run that has ended for good the checkpoint is removed, unless it is done and the checkpoint
    /// is to be kept.
    pub fn finish(mut self, status: RunStatus, message: Option<&str>) -> Result<Summary, OutputError> {
        self.history.check_there()?;
        self.progress.finish(&last_line(status, self.ledger.rows.len()));
        self.ledger.messages.extend(message.map(str::to_owned));
        let begun = Instant::now();
        let plots = self.draw().and_then(|()| match self.parquet {
            true => write_parquet(&self.out.parquet(), &self.ledger.rows),
            false => Ok(()),
        });
        let mut status = if self.failed { RunStatus::Failed } else { status };
        if let Err(error) = &plots {
            self.ledger.messages.push(error.to_string());
            // Not done: who goes on from the checkpoint comes here again, and draws them.
            status = RunStatus::Interrupted;
        }
        self.ledger.outside.output += begun.elapsed().as_secs_f64();
        let (wall_s, cpu_s) = self.spent();
        // Of a run that did not get to its end there is nothing to compare.
        let estimate = self.estimate().filter(|_| status == RunStatus::Done);
        let mut summary = Summary {
            remeshed: self.ledger.remeshed,
            status,
            elements: self.setting.elements,
            unknowns: self.setting.unknowns,
            device: self.setting.computed_on.device,
            precision: self.setting.computed_on.precision.to_owned(),
            linear_fallbacks: self.ledger.fallbacks,
            confirming_iterations: self.ledger.confirming,
            device_traffic: self.ledger.traffic.sum(),
            wall_s,
            cpu_s,
            time_by_phase: TimeByPhase::new(&self.ledger.times, &self.ledger.outside, wall_s),
            messages: self.ledger.messages,
            ..Summary::from_history(&self.ledger.rows, &self.inputs).with_errors(estimate)
        };
        if status == RunStatus::Done && self.keeps_checkpoint && !self.end_is_kept {
            summary.messages.push("note: the last checkpoint could not be written: --extend is not possible".to_owned());
        }
        let finite = check_summary(&self.out.summary(), &summary);
        if let Err(error) = &finite {
            summary.status = RunStatus::Failed;
            summary.messages.push(error.to_string());
        }
        summary.write(&self.out.summary())?;
        finite?;
        let stays = match status {
            // Of a result that was no number another device may make one, from the state before.
            RunStatus::Interrupted | RunStatus::Failed => true,
            RunStatus::Done => self.keeps_checkpoint && self.end_is_kept,
            RunStatus::NotConverged | RunStatus::ContactOutgrewMesh => false,
        };
        if status == RunStatus::Done {
            let _ = std::fs::remove_file(self.out.end_checkpoint());
        }
        if !stays {
            // The summary says that the run has ended, so that one which cannot be removed does no
            // harm.
            let _ = std::fs::remove_file(self.out.checkpoint());
        }
        plots.map(|()| summary)
    }

    /// Seconds on the wall and of the processor, those of earlier parts of the run included.
    fn spent(&self) -> (f64, Option<f64>) {
        let Ledger { wall_before, cpu_before, .. } = self.ledger;
        (wall_before + self.clock.wall_seconds(), cpu_before.zip(self.clock.cpu_seconds()).map(|(before, now)| before + now))
    }

    fn write_checkpoint(&mut self, run: Snapshot) -> Result<(), OutputError> {
        let (wall_before, cpu_before) = self.spent();
        let ledger = Ledger { wall_before, cpu_before, ..self.ledger.clone() };
        Checkpoint::new(&self.case, &self.began_on, ledger, run).write(&self.out.checkpoint())
    }

    /// The whole contact of a step, both halves.
    fn contact(&self, view: &StepView<'_>) -> Vec<ContactPoint> {
        ContactPoint::whole_of(view.points, &self.units)
    }

    /// Writes fields and contact table of a step, once.
    fn save(&mut self, view: &mut StepView<'_>, contact: &[ContactPoint]) -> Result<(), ObserverError> {
        let step = view.record.0.step;
        if self.ledger.saved.last() == Some(&step) {
            return Ok(());
        }
        let fields = view.fields()?;
        let path = self.out.fields(step);
        if let Err(error) = check_saved(&path, step, &fields, contact) {
            self.failed = true;
            return Err(error.into());
        }
        write_contact(&self.out.contact(step), contact)?;
        let other = view.opponent_points.iter().map(|point| ContactPoint::in_units(point, &self.units));
        let all: Vec<ContactPoint> = contact.iter().cloned().chain(other).collect();
        write_fields(&path, view.mesh, view.displacement()?, &fields, &all, &self.units)?;
        self.collection.push(self.ledger.path_length(step), &path)?;
        self.ledger.saved.push(step);
        Ok(())
    }

    /// Keeps the contact of a step of the shear for the plots, with its table, from which they can
    /// be drawn again.
    fn save_panel(&mut self, view: &StepView<'_>) -> Result<(), ObserverError> {
        if !self.plots || !is_panel(&self.ledger.rows, self.friction) {
            return Ok(());
        }
        let (step, contact) = (view.record.0.step, self.contact(view));
        if matches!(self.fields, Fields::Segments | Fields::Contact) {
            write_contact(&self.out.contact(step), &contact)?;
            self.ledger.panels.push(step);
        }
        self.ledger.tables.add(&self.ledger.rows, contact);
        Ok(())
    }
}

impl Observer for ResultWriter {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        if view.record.0.step == 0 {
            // The undeformed state is no step that was computed.
            return Ok(());
        }
        let begun = Instant::now();
        let row = self.row(view);
        if let Err(error) = self.history.append(&row) {
            self.failed = matches!(error, OutputError::NotFinite { .. });
            return Err(error.into());
        }
        self.ledger.rows.push(row);
        self.ledger.fallbacks += view.report.fallbacks;
        if let Some(more) = view.report.confirming {
            *self.ledger.confirming.get_or_insert(0) += more;
        }
        self.ledger.times += view.report.times;
        self.ledger.traffic.step(view.report.traffic, view.traffic());
        if self.fields == Fields::All {
            let contact = self.contact(view);
            self.save(view, &contact)?;
        }
        self.save_panel(view)?;
        self.ledger.traffic.read(view.traffic());
        let position = Position {
            step: row.step,
            segment: row.segment,
            segments: self.share.segments(),
            fraction: self.share.after(&row),
            detail: detail(&row),
        };
        self.progress.step(&position);
        self.ledger.outside.output += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.ledger.times += view.unfinished;
        if view.record.0.step == 0 {
            return Ok(());
        }
        let begun = Instant::now();
        let contact = self.contact(view);
        match self.fields {
            Fields::None => {}
            // A few kilobytes.
            Fields::Contact => {
                write_contact(&self.out.contact(view.record.0.step), &contact)?;
                self.ledger.saved.push(view.record.0.step);
            }
            Fields::Segments | Fields::All => self.save(view, &contact)?,
        }
        if self.plots {
            self.ledger.tables.add(&self.ledger.rows, contact);
        }
        self.ledger.traffic.read(view.traffic());
        self.ledger.outside.output += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn starts_over(&mut self, problem: &Problem, unknowns: usize) -> Result<(), ObserverError> {
        self.out.cut_back(&[], &[])?;
        self.history = HistoryWriter::create(&self.out.history())?;
        self.collection = Collection::new(&self.out.collection());
        self.share = PathShare::new(&self.as_given.path);
        self.setting.elements = problem.model.mesh.elements.len();
        self.setting.unknowns = unknowns;
        let ledger = &mut self.ledger;
        (ledger.rows, ledger.saved, ledger.panels, ledger.tables) = Default::default();
        (ledger.fallbacks, ledger.confirming) = (0, None);
        ledger.traffic.starts_over();
        ledger.remeshed += 1;
        self.meshed(problem);
        Ok(())
    }

    fn note(&mut self, text: &str) {
        self.ledger.messages.push(format!("note: {text}"));
        self.progress.message(&format!("note: {text}"));
    }

    fn stop_requested(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Whatever becomes of the pictures, the path has not to be followed again.
    fn keeps_end(&self) -> bool {
        self.plots || self.keeps_checkpoint
    }

    /// A checkpoint that cannot be written is no reason to stop computing, and the one before is
    /// still there.
    fn checkpoint(&mut self, last: bool, take: &mut dyn FnMut() -> Result<Snapshot, ComputeError>) {
        let begun = Instant::now();
        // Of a directory that was removed the next row tells, or the end.
        if !last && begun < self.next_checkpoint || self.history.check_there().is_err() {
            return;
        }
        let taken = take().map_err(|error| error.to_string());
        let written = taken.and_then(|run| self.write_checkpoint(run).map_err(|error| error.to_string()));
        if let Err(error) = &written
            && !self.checkpoint_failed
        {
            self.progress.message(&format!("warning: no checkpoint, the run goes on without: {error}"));
        }
        self.checkpoint_failed = written.is_err();
        self.end_is_kept = last && written.is_ok();
        let took = begun.elapsed();
        self.next_checkpoint = begun + self.checkpoint_interval.max(self.checkpoint_share * took);
        self.ledger.outside.output += took.as_secs_f64();
    }
}
