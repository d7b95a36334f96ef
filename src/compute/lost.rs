//! A device that is lost in mid-run: the way in which the tests of the whole program get one.

use std::sync::Arc;

use super::gpu::GpuContext;
use super::{About, Answer, Call, CaseModel, Compute, ComputeError};

/// The environment variable of the hook, which only builds with debug assertions look at, those of
/// the tests: a number N of calls that commit (of one case: N accepted steps), after which the
/// device is given up as a driver reset would. Not set, or no number: nothing is hooked in.
pub const LOSE_VARIABLE: &str = "ASPERITY_TEST_LOSE_DEVICE_AFTER";

/// A backend whose device is destroyed behind its back after so many commits.
struct LostAfter {
    backend: Box<dyn Compute>,
    context: Arc<GpuContext>,
    commits: usize,
}

/// The backend as it is, or with [`LOSE_VARIABLE`] one whose device will be lost.
pub fn hooked(backend: Box<dyn Compute>, context: Arc<GpuContext>) -> Box<dyn Compute> {
    if !cfg!(debug_assertions) {
        return backend;
    }
    match std::env::var(LOSE_VARIABLE).ok().and_then(|text| text.parse().ok()) {
        None => backend,
        Some(commits) => {
            log::warn!("{LOSE_VARIABLE}: the device will be lost after {commits} accepted steps");
            Box::new(LostAfter { backend, context, commits })
        }
    }
}

impl Compute for LostAfter {
    fn models(&self) -> &[CaseModel] {
        self.backend.models()
    }

    fn about(&self) -> About {
        self.backend.about()
    }

    /// Where it is due the device is lost before an evaluation, so that its last commit can still
    /// be read back, and before anything that is asked of iterates.
    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        let evaluates =
            |call: &Call| matches!(call, Call::Force { .. } | Call::Tangent { .. } | Call::Solve(_) | Call::Iterate(_));
        if self.commits == 0 && calls.iter().any(|(_, call)| evaluates(call)) {
            self.context.destroy();
        }
        let commits = calls.iter().any(|(_, call)| call.commits());
        let answers = self.backend.call(calls)?;
        self.commits = self.commits.saturating_sub(usize::from(commits));
        Ok(answers)
    }

    fn take_notes(&mut self) -> Vec<String> {
        self.backend.take_notes()
    }
}
