//! Collects what a run tells, and breaks the device on the way.

use asperity::internals::compute::gpu::GpuContext;
use asperity::internals::simulation::drive::{Observer, StepView};
use asperity::internals::simulation::record::{RecordedPoint, StepRecord};
use std::error::Error;

/// Collects steps with their points, and notes; breaks the device after one of the steps.
#[derive(Default)]
pub struct Recorder<'a> {
    pub steps: Vec<(StepRecord, Vec<RecordedPoint>)>,
    pub notes: Vec<String>,
    pub destroy: Option<(usize, &'a GpuContext)>,
}

impl Observer for Recorder<'_> {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        self.steps.push((view.record.0, view.points.to_vec()));
        if let Some((_, context)) = self.destroy.filter(|(step, _)| *step == view.record.0.step) {
            context.destroy();
        }
        Ok(())
    }

    fn segment_end(&mut self, _: &mut StepView<'_>) -> Result<(), Box<dyn Error + Send + Sync>> {
        Ok(())
    }

    fn note(&mut self, text: &str) {
        self.notes.push(text.to_owned());
        println!("{text}");
    }
}
