//! One case of a batch, as its Newton iteration sees it.

use super::iterate::{Answer, Ask, IterateRequest, Keeps, Plate};
use super::linear::LinearRequest;
use super::{
    Blocks, CaseModel, CommitRequest, Compute, ComputeError, ContactRequest, Energies, ForceRequest, Outcome, TangentRequest,
};
use crate::contact::coulomb::Rows;

/// What the solver of one case may ask for.
pub trait Evaluate {
    /// The case.
    fn model(&self) -> &CaseModel;
    /// Internal forces at a trial displacement.
    fn internal_force(&mut self, displacement: &[f64], force: &mut [f64]) -> Result<Outcome, ComputeError>;
    /// Tangent blocks at a trial displacement.
    fn tangent(&mut self, displacement: &[f64], blocks: Blocks<'_>) -> Result<Outcome, ComputeError>;
    /// Contact conditions at a trial displacement with its internal forces.
    fn contact(&mut self, displacement: &[f64], force: &[f64], rows: &mut [Rows<f64>]) -> Result<(), ComputeError>;
    /// Linear systems with the tangent, where the backend solves them; the case is this one,
    /// whatever the request says.
    fn linear(&mut self, request: &mut LinearRequest<'_>) -> Result<(), ComputeError>;
    /// Which iterates stay where they are computed (see [`Compute::keeps`]).
    fn keeps(&self) -> Keeps;
    /// Asks something of the iterates there. `kept` says that what was tried last is the current
    /// one from now on.
    fn iterate(&mut self, kept: bool, plate: Plate, ask: Ask) -> Result<Answer, ComputeError>;
    /// Makes a trial displacement the committed state.
    fn commit(&mut self, displacement: &[f64]) -> Result<(Energies, Outcome), ComputeError>;
}

/// A case of a backend that this thread has for itself.
pub struct CaseHandle<'a> {
    /// The backend.
    pub backend: &'a mut dyn Compute,
    /// The case's index in the batch.
    pub case: usize,
}

impl Evaluate for CaseHandle<'_> {
    fn model(&self) -> &CaseModel {
        &self.backend.models()[self.case]
    }

    fn internal_force(&mut self, displacement: &[f64], force: &mut [f64]) -> Result<Outcome, ComputeError> {
        let mut request = [ForceRequest { case: self.case, displacement, force, outcome: Outcome::Valid }];
        self.backend.internal_force(&mut request)?;
        Ok(request[0].outcome)
    }

    fn tangent(&mut self, displacement: &[f64], blocks: Blocks<'_>) -> Result<Outcome, ComputeError> {
        let mut request = [TangentRequest { case: self.case, displacement, blocks, outcome: Outcome::Valid }];
        self.backend.tangent(&mut request)?;
        Ok(request[0].outcome)
    }

    fn contact(&mut self, displacement: &[f64], force: &[f64], rows: &mut [Rows<f64>]) -> Result<(), ComputeError> {
        self.backend.contact(&mut [ContactRequest { case: self.case, displacement, force, rows }])
    }

    fn linear(&mut self, request: &mut LinearRequest<'_>) -> Result<(), ComputeError> {
        request.case = self.case;
        self.backend.linear(std::slice::from_mut(request))
    }

    fn keeps(&self) -> Keeps {
        self.backend.keeps()
    }

    fn iterate(&mut self, kept: bool, plate: Plate, ask: Ask) -> Result<Answer, ComputeError> {
        let mut request = [IterateRequest { case: self.case, kept, plate, ask, answer: Answer::Nothing }];
        self.backend.iterate(&mut request)?;
        let [IterateRequest { answer, .. }] = request;
        Ok(answer)
    }

    fn commit(&mut self, displacement: &[f64]) -> Result<(Energies, Outcome), ComputeError> {
        let mut request =
            [CommitRequest { case: self.case, displacement, energies: Energies::default(), outcome: Outcome::Valid }];
        self.backend.commit(&mut request)?;
        Ok((request[0].energies, request[0].outcome))
    }
}
