//! The results of a run without a directory.

use super::Canceller;
use crate::case::Case;
use crate::compute::traffic::Account;
use crate::output::{
    Clock, ErrorEstimate, Limits, OutsideSteps, PathShare, Position, Progress, RunStatus, Setting, StepRecord, Summary,
    SummaryInputs, TimeByPhase, Units, detail, last_line,
};
use crate::simulation::drive::{Observer, StepView};
use crate::simulation::error::ObserverError;
use crate::simulation::problem::Problem;
use crate::simulation::scout::Scout;
use crate::solver::phases::PhaseTimes;

/// What the summary has to know beside the history.
pub struct Memory {
    units: Units,
    inputs: SummaryInputs,
    setting: Setting,
    canceller: Canceller,
    clock: Clock,
    progress: Box<dyn Progress>,
    share: PathShare,
    case: Case,
    spacing: f64,
    /// The rows so far, in the user's units.
    rows: Vec<StepRecord>,
    /// What the companion tells, if there was one that got to its end.
    limits: Option<Limits>,
    remeshed: usize,
    fallbacks: usize,
    confirming: Option<usize>,
    traffic: Account,
    times: PhaseTimes,
    outside: OutsideSteps,
    messages: Vec<String>,
}

impl Memory {
    /// Of a run of `case` on the mesh of `problem`.
    pub fn new(
        case: &Case,
        problem: &Problem,
        setting: Setting,
        clock: Clock,
        progress: Box<dyn Progress>,
        canceller: Canceller,
    ) -> Self {
        Self {
            progress,
            share: PathShare::new(&case.path),
            case: case.clone(),
            units: Units::of(case),
            inputs: SummaryInputs::of(case),
            setting,
            canceller,
            clock,
            spacing: problem.spacing,
            rows: Vec::new(),
            limits: None,
            remeshed: 0,
            fallbacks: 0,
            confirming: None,
            traffic: Account::default(),
            times: PhaseTimes::default(),
            outside: OutsideSteps { setup: clock.wall_seconds(), ..OutsideSteps::default() },
            messages: Vec::new(),
        }
    }

    /// Takes what the coarse run has found in so many seconds on the wall, which have gone by
    /// already.
    pub fn scouted(&mut self, scout: Scout, seconds: f64) {
        self.outside.error_estimate = seconds;
        self.outside.setup -= seconds;
        self.limits = Limits::new(&self.case, &scout, self.spacing);
    }

    /// Keeps a note for the summary that the user has been told already.
    pub fn remember(&mut self, note: &str) {
        self.messages.push(format!("note: {note}"));
    }

    /// The summary of the run, as it would be written.
    pub fn finish(mut self, rows: &[StepRecord], status: RunStatus, message: Option<&str>) -> Summary {
        self.progress.finish(&last_line(status, rows.len()));
        let wall_s = self.clock.wall_seconds();
        let limits = self.limits.filter(|_| status == RunStatus::Done);
        let estimate = limits.map(|limits| ErrorEstimate::new(rows, &self.inputs.oblique, &limits));
        Summary {
            status,
            remeshed: self.remeshed,
            elements: self.setting.elements,
            unknowns: self.setting.unknowns,
            device: self.setting.computed_on.device,
            precision: self.setting.computed_on.precision.to_owned(),
            linear_fallbacks: self.fallbacks,
            confirming_iterations: self.confirming,
            device_traffic: self.traffic.sum(),
            wall_s,
            cpu_s: self.clock.cpu_seconds(),
            time_by_phase: TimeByPhase::new(&self.times, &self.outside, wall_s),
            messages: self.messages.into_iter().chain(message.map(str::to_owned)).collect(),
            ..Summary::from_history(rows, &self.inputs).with_errors(estimate)
        }
    }
}

impl Observer for Memory {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        if view.record.0.step == 0 {
            // The undeformed state is no step that was computed.
            return Ok(());
        }
        self.fallbacks += view.report.fallbacks;
        if let Some(more) = view.report.confirming {
            *self.confirming.get_or_insert(0) += more;
        }
        self.times += view.report.times;
        self.traffic.step(view.report.traffic, view.traffic());
        if let Some(limits) = &self.limits {
            limits.of(&self.rows, &view.record.in_units(&self.units)).put_into(&mut view.record, &self.units);
        }
        let row = view.record.in_units(&self.units);
        self.rows.push(row);
        self.progress.step(&Position {
            step: row.step,
            segment: row.segment,
            segments: self.share.segments(),
            fraction: self.share.after(&row),
            detail: detail(&row),
        });
        Ok(())
    }

    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.times += view.unfinished;
        self.traffic.read(view.traffic());
        Ok(())
    }

    fn note(&mut self, text: &str) {
        self.progress.message(&format!("note: {text}"));
        self.messages.push(format!("note: {text}"));
    }

    fn starts_over(&mut self, problem: &Problem, unknowns: usize) -> Result<(), ObserverError> {
        self.setting.elements = problem.model.mesh.elements.len();
        self.setting.unknowns = unknowns;
        self.spacing = problem.spacing;
        self.rows.clear();
        if let Some(limits) = &mut self.limits {
            limits.meshed(problem.spacing);
        }
        self.share = PathShare::new(&self.case.path);
        (self.fallbacks, self.confirming) = (0, None);
        self.traffic.starts_over();
        self.remeshed += 1;
        Ok(())
    }

    fn stop_requested(&self) -> bool {
        self.canceller.is_cancelled()
    }
}
