//! One case of a batch, as those see it who follow its path.

use std::sync::Arc;

use super::call::{Answer, Call, OfBlocks, not_asked};
use super::iterate::{Ask, Keeps, Plate, Reply, Request};
use super::linear::{SolveRequest, Solved};
use super::{CaseFields, CaseModel, CaseState, Compute, ComputeError, Energies, Evaluated};
use crate::contact::coulomb::Rows;
use crate::mesh::Mesh;

/// A case of a backend that this thread has for itself. All errors are the backend's.
pub struct CaseHandle<'a> {
    /// The backend.
    pub backend: &'a mut dyn Compute,
    /// The case's index in the batch.
    pub case: usize,
}

/// The case at this place of a backend.
pub fn at(backend: &mut dyn Compute, case: usize) -> CaseHandle<'_> {
    CaseHandle { backend, case }
}

impl CaseHandle<'_> {
    /// The case.
    pub fn model(&self) -> &CaseModel {
        &self.backend.models()[self.case]
    }

    /// Which iterates stay where they are computed.
    pub fn keeps(&self) -> Keeps {
        self.backend.about().keeps
    }

    fn call(&mut self, call: Call) -> Result<Answer, ComputeError> {
        self.backend.call(vec![(self.case, call)])?.pop().ok_or_else(not_asked)
    }

    /// See [`Call::BeginStep`].
    pub fn begin_step(&mut self, weight: f64) -> Result<(), ComputeError> {
        self.call(Call::BeginStep(weight)).map(drop)
    }

    /// Internal forces at a trial displacement.
    pub fn internal_force(&mut self, displacement: &[f64], force: &mut Vec<f64>) -> Result<Evaluated, ComputeError> {
        let answer = self.call(Call::Force { displacement: displacement.into() })?;
        let Answer::Force { force: found, outcome } = answer else { return Err(not_asked()) };
        *force = found;
        Ok(outcome)
    }

    /// Tangent blocks at a trial displacement. After an error there are none.
    pub fn tangent<T: OfBlocks>(&mut self, displacement: &[f64], blocks: &mut Vec<[T; 9]>) -> Result<Evaluated, ComputeError> {
        let memory = T::wrap(std::mem::take(blocks));
        let answer = self.call(Call::Tangent { displacement: displacement.into(), blocks: memory })?;
        let Answer::Tangent { blocks: found, outcome } = answer else { return Err(not_asked()) };
        *blocks = T::unwrap(found).ok_or_else(not_asked)?;
        Ok(outcome)
    }

    /// Contact conditions at a trial displacement with its internal forces.
    pub fn contact(&mut self, displacement: &[f64], force: &[f64], rows: &mut Vec<Rows<f64>>) -> Result<(), ComputeError> {
        let mesh = &self.model().mesh;
        let call = Call::Contact { displacement: at_contact(mesh, displacement), force: at_contact(mesh, force) };
        let Answer::Contact(found) = self.call(call)? else { return Err(not_asked()) };
        *rows = found;
        Ok(())
    }

    /// Linear systems with the tangent, where the backend solves them.
    pub fn solve(&mut self, system: SolveRequest) -> Result<Solved, ComputeError> {
        match self.call(Call::Solve(system.into()))? {
            Answer::Solved(solved) => Ok(solved),
            _ => Err(not_asked()),
        }
    }

    /// Asks something of the iterates where the backend keeps them. `kept` says that what was tried
    /// last is the current one from now on.
    pub fn iterate(&mut self, kept: bool, plate: Plate, ask: Ask) -> Result<Reply, ComputeError> {
        match self.call(Call::Iterate(Request { kept, plate, ask }))? {
            Answer::Iterate(reply) => Ok(reply),
            _ => Err(not_asked()),
        }
    }

    /// Makes a trial displacement the committed state.
    pub fn commit(&mut self, displacement: &[f64]) -> Result<(Energies, Evaluated), ComputeError> {
        match self.call(Call::Commit { displacement: displacement.into() })? {
            Answer::Commit { energies, outcome } => Ok((energies, outcome)),
            _ => Err(not_asked()),
        }
    }

    /// Stresses and strains of the committed state.
    pub fn fields(&mut self) -> Result<CaseFields, ComputeError> {
        match self.call(Call::Fields)? {
            Answer::Fields(fields) => Ok(fields),
            _ => Err(not_asked()),
        }
    }

    /// A copy of the committed state.
    pub fn state(&mut self) -> Result<CaseState, ComputeError> {
        match self.call(Call::State)? {
            Answer::State(state) => Ok(state),
            _ => Err(not_asked()),
        }
    }

    /// Replaces the committed state.
    pub fn restore(&mut self, state: impl Into<Arc<CaseState>>) -> Result<(), ComputeError> {
        self.call(Call::Restore(state.into())).map(drop)
    }
}

/// What there is at the contact nodes of a vector of three numbers a node.
pub fn at_contact(mesh: &Mesh, vector: &[f64]) -> Vec<f64> {
    mesh.contact_nodes.iter().flat_map(|&node| &vector[3 * node as usize..][..3]).copied().collect()
}
