//! A device that is lost in mid-run: the way in which the tests of the whole program get one.

use std::sync::Arc;

use super::gpu::GpuContext;
use super::iterate::{Ask, IterateRequest, Keeps};
use super::linear::LinearRequest;
use super::traffic::Traffic;
use super::{
    CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, ForceRequest,
    TangentRequest,
};

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

impl LostAfter {
    fn lose_if_due(&self) {
        if self.commits == 0 {
            self.context.destroy();
        }
    }
}

impl Compute for LostAfter {
    fn description(&self) -> Description {
        self.backend.description()
    }

    fn models(&self) -> &[CaseModel] {
        self.backend.models()
    }

    fn traffic(&self) -> Option<Traffic> {
        self.backend.traffic()
    }

    fn begin_step(&mut self, case: usize, weight: f64) -> Result<(), ComputeError> {
        self.backend.begin_step(case, weight)
    }

    /// Here and in the tangent the device is lost, so that its last commit can still be read back.
    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        self.lose_if_due();
        self.backend.internal_force(requests)
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        self.lose_if_due();
        self.backend.tangent(requests)
    }

    fn linear(&mut self, requests: &mut [LinearRequest<'_>]) -> Result<(), ComputeError> {
        self.lose_if_due();
        self.backend.linear(requests)
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        self.backend.contact(requests)
    }

    fn keeps(&self) -> Keeps {
        self.backend.keeps()
    }

    fn has_stand_in(&self) -> bool {
        self.backend.has_stand_in()
    }

    /// A commit counts; before anything else the device is lost where it is due.
    fn iterate(&mut self, requests: &mut [IterateRequest]) -> Result<(), ComputeError> {
        self.lose_if_due();
        self.backend.iterate(requests)?;
        if requests.iter().any(|request| request.ask == Ask::Commit) {
            self.commits = self.commits.saturating_sub(1);
        }
        Ok(())
    }

    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError> {
        self.backend.commit(requests)?;
        self.commits = self.commits.saturating_sub(1);
        Ok(())
    }

    fn fields(&mut self, case: usize) -> Result<CaseFields, ComputeError> {
        self.backend.fields(case)
    }

    fn state(&mut self, case: usize) -> Result<CaseState, ComputeError> {
        self.backend.state(case)
    }

    fn restore(&mut self, case: usize, state: &CaseState) -> Result<(), ComputeError> {
        self.backend.restore(case, state)
    }

    fn replace(&mut self, case: usize, model: CaseModel) -> Result<bool, ComputeError> {
        self.backend.replace(case, model)
    }

    fn take_notes(&mut self) -> Vec<String> {
        self.backend.take_notes()
    }
}
