//! A backend that computes wrongly from some step on: the way in which tests get one, in the
//! program and by themselves.

use super::iterate::Keeps;
use super::{
    Blocks, CaseFields, CaseModel, CaseState, CommitRequest, Compute, ComputeError, ContactRequest, Description, Fault,
    ForceRequest, Outcome, TangentRequest,
};
use crate::material::Refusal;

/// The environment variable of the hook, which only builds with debug assertions look at, those of
/// the tests: `KIND:N`, a [`Kind`] and a number of calls that commit, after which the CPU computes
/// wrongly. Not set, or anything else: nothing is hooked in.
pub const WRONG_VARIABLE: &str = "ASPERITY_TEST_WRONG_AFTER";

/// What is wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A NaN among the internal forces at a node inside the body.
    Force,
    /// A NaN in the normal force at the first contact node.
    NormalForce,
    /// A NaN in the tangential force there, which under full stick is in no residual.
    TangentialForce,
    /// NaN in the conditions of the first contact node.
    Contact,
    /// A NaN in the tangent.
    Tangent,
    /// The material refuses every displacement but the committed one.
    Material,
    /// It refuses every commit.
    Commit,
    /// The elastic energy is a NaN.
    Energy,
}

impl Kind {
    /// All of them, with the words that the variable has for them.
    pub const ALL: [(&'static str, Self); 8] = [
        ("force", Self::Force),
        ("normal-force", Self::NormalForce),
        ("tangential-force", Self::TangentialForce),
        ("contact", Self::Contact),
        ("tangent", Self::Tangent),
        ("material", Self::Material),
        ("commit", Self::Commit),
        ("energy", Self::Energy),
    ];
}

/// The refusal of [`Kind::Material`] and [`Kind::Commit`].
pub const REFUSAL: Fault = Fault::Refused { element: 7, point: 3, why: Refusal::NotFinite };

/// A backend whose answers for its first case are wrong after so many commits.
pub struct Wrong<C> {
    backend: C,
    kind: Kind,
    commits: usize,
}

/// The backend as it is, or one that [`WRONG_VARIABLE`] asks for.
pub fn hooked<C: Compute + 'static>(backend: C) -> Box<dyn Compute> {
    let variable = if cfg!(debug_assertions) { std::env::var(WRONG_VARIABLE).ok() } else { None };
    let asked = || {
        let (word, commits) = variable.as_deref()?.split_once(':')?;
        let (_, kind) = Kind::ALL.into_iter().find(|(name, _)| *name == word)?;
        Some((kind, commits.parse().ok()?))
    };
    match asked() {
        None => Box::new(backend),
        Some((kind, commits)) => Box::new(Wrong::new(backend, kind, commits)),
    }
}

impl<C: Compute> Wrong<C> {
    /// Right up to so many commits.
    pub fn new(backend: C, kind: Kind, commits: usize) -> Self {
        Self { backend, kind, commits }
    }

    fn is(&self, kind: Kind) -> bool {
        self.commits == 0 && self.kind == kind
    }

    /// The unknown whose force is wrong.
    fn wrong_force(&self, case: usize) -> Option<usize> {
        let mesh = &self.models()[case].mesh;
        let first = 3 * *mesh.contact_nodes.first()? as usize;
        let is_inside = |n: &u32| !mesh.contact_nodes.contains(n) && !mesh.plate_nodes.contains(n);
        match self.kind {
            _ if self.commits > 0 => None,
            Kind::Force => (0..mesh.nodes.len() as u32).find(is_inside).map(|n| 3 * n as usize + 2),
            Kind::NormalForce => Some(first + 2),
            Kind::TangentialForce => Some(first),
            _ => None,
        }
    }
}

impl<C: Compute> Compute for Wrong<C> {
    fn description(&self) -> Description {
        self.backend.description()
    }

    fn models(&self) -> &[CaseModel] {
        self.backend.models()
    }

    fn begin_step(&mut self, case: usize, weight: f64) -> Result<(), ComputeError> {
        self.backend.begin_step(case, weight)
    }

    fn internal_force(&mut self, requests: &mut [ForceRequest<'_>]) -> Result<(), ComputeError> {
        self.backend.internal_force(requests)?;
        for request in requests {
            if let Some(unknown) = self.wrong_force(request.case) {
                request.force[unknown] = f64::NAN;
            }
            if self.is(Kind::Material) && self.backend.state(request.case)?.displacement != request.displacement {
                request.outcome = Outcome::Invalid(REFUSAL);
            }
        }
        Ok(())
    }

    fn tangent(&mut self, requests: &mut [TangentRequest<'_>]) -> Result<(), ComputeError> {
        self.backend.tangent(requests)?;
        for request in requests.iter_mut().filter(|_| self.is(Kind::Tangent)) {
            // In the middle of the matrix: the first rows may be prescribed ones, which nobody
            // reads.
            match &mut request.blocks {
                Blocks::Double(blocks) => {
                    let middle = blocks.len() / 2;
                    blocks[middle] = [f64::NAN; 9];
                }
                Blocks::Single(blocks) => {
                    let middle = blocks.len() / 2;
                    blocks[middle] = [f32::NAN; 9];
                }
            }
        }
        Ok(())
    }

    fn contact(&mut self, requests: &mut [ContactRequest<'_>]) -> Result<(), ComputeError> {
        self.backend.contact(requests)?;
        for request in requests.iter_mut().filter(|_| self.is(Kind::Contact)) {
            request.rows[0].residual = [f64::NAN; 3];
        }
        Ok(())
    }

    fn keeps(&self) -> Keeps {
        Keeps::Nothing
    }

    fn commit(&mut self, requests: &mut [CommitRequest<'_>]) -> Result<(), ComputeError> {
        if self.is(Kind::Commit) {
            requests.iter_mut().for_each(|request| request.outcome = Outcome::Invalid(REFUSAL));
            return Ok(());
        }
        self.backend.commit(requests)?;
        if self.is(Kind::Energy) {
            requests.iter_mut().for_each(|request| request.energies.elastic = f64::NAN);
        }
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
}
