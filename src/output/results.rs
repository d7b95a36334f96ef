//! Watches a run and writes all that it leaves behind, as it goes.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use super::clock::Clock;
use super::path_share::PathShare;
use super::plots::Tables;
use super::{
    Collection, ContactPoint, ErrorEstimate, HistoryWriter, OutputDirectory, OutputError, OutsideSteps, PlotInputs, Position,
    Progress, Status, StepRecord, Summary, SummaryInputs, TimeByPhase, Units, write_contact, write_fields, write_plots,
};
use crate::case::{Case, Fields};
use crate::compute::Description;
use crate::simulation::drive::{Observer, StepView};
use crate::solver::phases::PhaseTimes;

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

type Failed = Box<dyn std::error::Error + Send + Sync>;

/// Writes `history.csv` row by row, fields and contact tables of the steps that are to be saved, and at the end plots and summary.
pub struct ResultWriter {
    out: OutputDirectory,
    units: Units,
    fields: Fields,
    /// Write the contact table at the end of each segment though no fields are written.
    contact_tables: bool,
    plots: Option<PlotInputs>,
    inputs: SummaryInputs,
    setting: Setting,
    clock: Clock,
    progress: Box<dyn Progress>,
    stop: Arc<AtomicBool>,
    share: PathShare,
    history: HistoryWriter,
    rows: Vec<StepRecord>,
    collection: Collection,
    saved: Option<usize>,
    /// Contact at the ends of segments, for the plots.
    tables: Tables,
    fallbacks: usize,
    times: PhaseTimes,
    outside: OutsideSteps,
    estimate: Option<ErrorEstimate>,
    messages: Vec<String>,
}

impl ResultWriter {
    /// Begins the results of a case (in the user's units) in a directory that is there; `stop` is asked after every step.
    pub fn create(
        case: &Case,
        dir: &Path,
        setting: Setting,
        clock: Clock,
        progress: Box<dyn Progress>,
        stop: Arc<AtomicBool>,
    ) -> Result<Self, OutputError> {
        let out = OutputDirectory::existing(dir);
        Ok(Self {
            units: Units::of(case),
            fields: case.output.fields,
            contact_tables: false,
            plots: case.output.plots.then(|| PlotInputs::of(case)),
            inputs: SummaryInputs::of(case),
            setting,
            clock,
            progress,
            stop,
            share: PathShare::new(&case.path),
            history: HistoryWriter::create(&out.history())?,
            rows: Vec::new(),
            collection: Collection::new(&out.collection()),
            saved: None,
            tables: Tables::default(),
            fallbacks: 0,
            times: PhaseTimes::default(),
            outside: OutsideSteps { setup: clock.wall_seconds(), ..OutsideSteps::default() },
            estimate: None,
            messages: Vec::new(),
            out,
        })
    }

    /// Writes the contact table at the end of each segment even where the case wants no fields: a few kilobytes.
    pub fn with_contact_tables(mut self) -> Self {
        self.contact_tables = true;
        self
    }

    /// Says anew where the run is computed: a device may have failed on the way.
    pub fn computed_on(&mut self, description: Description) {
        self.setting.computed_on = description;
    }

    /// Estimates the errors of the run on `elements` along the contact radius from the history of its companion, in the same units.
    pub fn compare(&mut self, elements: usize, companion: &[StepRecord], companion_elements: usize) {
        let run = Summary::from_history(&self.rows, &self.inputs);
        let other = Summary::from_history(companion, &self.inputs);
        self.estimate = Some(ErrorEstimate::new(&self.rows, &run, elements, &other, companion_elements));
    }

    /// Says how many seconds on the wall the error estimate took.
    pub fn estimate_took(&mut self, seconds: f64) {
        self.outside.error_estimate = seconds;
    }

    /// Steps written so far.
    pub fn steps(&self) -> usize {
        self.rows.len()
    }

    /// Draws the plots and writes the summary of a run that ended as `status` for the reason `message`. The summary is written even if a plot
    /// fails, whose error is then returned.
    pub fn finish(mut self, status: Status, message: Option<&str>) -> Result<Summary, OutputError> {
        self.progress.finish(&format!("{status}: {} steps", self.rows.len()));
        self.messages.extend(message.map(str::to_owned));
        let begun = Instant::now();
        let plots = match &self.plots {
            Some(inputs) => write_plots(&self.out, &self.rows, &self.tables, inputs).map(drop),
            None => Ok(()),
        };
        if let Err(error) = &plots {
            self.messages.push(error.to_string());
        }
        self.outside.output += begun.elapsed().as_secs_f64();
        let wall_s = self.clock.wall_seconds();
        let estimate = self.estimate.unwrap_or_default();
        let summary = Summary {
            f_n0_error: estimate.f_n0,
            a0_error: estimate.a0,
            f_t_max_error: estimate.f_t_max,
            error_companion_elements: self.estimate.map(|e| e.companion_elements),
            status,
            elements: self.setting.elements,
            unknowns: self.setting.unknowns,
            device: self.setting.computed_on.device,
            precision: self.setting.computed_on.precision.to_owned(),
            linear_fallbacks: self.fallbacks,
            wall_s,
            cpu_s: self.clock.cpu_seconds(),
            time_by_phase: TimeByPhase::new(&self.times, &self.outside, wall_s),
            messages: self.messages,
            ..Summary::from_history(&self.rows, &self.inputs)
        };
        summary.write(&self.out.summary())?;
        plots.map(|()| summary)
    }

    fn contact(&self, view: &StepView<'_>) -> Vec<ContactPoint> {
        view.points.iter().map(|point| ContactPoint::in_units(point, &self.units)).collect()
    }

    /// Writes fields and contact table of a step, once.
    fn save(&mut self, view: &mut StepView<'_>, contact: &[ContactPoint]) -> Result<(), Failed> {
        let step = view.record.step;
        if self.saved == Some(step) {
            return Ok(());
        }
        let fields = view.fields()?;
        let path = self.out.fields(step);
        write_contact(&self.out.contact(step), contact)?;
        write_fields(&path, view.mesh, view.displacement, &fields, contact, &self.units)?;
        self.collection.push(step as f64, &path)?;
        self.saved = Some(step);
        Ok(())
    }

    fn detail(&self, row: &StepRecord) -> String {
        let mut text = format!("h {:.4e}  F_N {:.4e}", row.h, row.f_n);
        if row.delta_t != 0.0 {
            text += &format!("  delta_T {:.4e}  F_T {:.4e}", row.delta_t, row.f_t);
        }
        text + &format!("  {} iterations", row.newton_iterations)
    }
}

impl Observer for ResultWriter {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Failed> {
        if view.record.step == 0 {
            // The undeformed state is no step that was computed.
            return Ok(());
        }
        let begun = Instant::now();
        let row = view.record.in_units(&self.units);
        self.history.append(&row)?;
        self.rows.push(row);
        self.fallbacks += view.report.fallbacks;
        self.times += view.report.times;
        if self.fields == Fields::All {
            let contact = self.contact(view);
            self.save(view, &contact)?;
        }
        let position = Position {
            step: row.step,
            segment: row.segment,
            segments: self.share.segments(),
            fraction: self.share.after(&row),
            detail: self.detail(&row),
        };
        self.progress.step(&position);
        self.outside.output += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), Failed> {
        self.times += view.unfinished;
        if view.record.step == 0 {
            return Ok(());
        }
        let begun = Instant::now();
        let contact = self.contact(view);
        if self.fields != Fields::None {
            self.save(view, &contact)?;
        } else if self.contact_tables {
            write_contact(&self.out.contact(view.record.step), &contact)?;
        }
        if self.plots.is_some() {
            self.tables.add(&self.rows, contact);
        }
        self.outside.output += begun.elapsed().as_secs_f64();
        Ok(())
    }

    fn note(&mut self, text: &str) {
        self.messages.push(format!("note: {text}"));
        self.progress.message(&format!("note: {text}"));
    }

    fn stop_requested(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }
}
