//! A backend that computes wrongly from some step on: the way in which tests get one, in the
//! program and by themselves.

use super::handle::at;
use super::{About, Answer, Call, CaseModel, Compute, ComputeError, Energies, Evaluated, Fault, TangentBlocks};
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

impl<C: Compute> Wrong<C> {
    /// Makes an answer wrong.
    fn spoil(&mut self, case: usize, call: &Call, answer: &mut Answer) -> Result<(), ComputeError> {
        match answer {
            Answer::Force { force, outcome } => {
                if let Some(unknown) = self.wrong_force(case) {
                    force[unknown] = f64::NAN;
                }
                if self.is(Kind::Material) && at(&mut self.backend, case).state()?.displacement != call.displacement() {
                    *outcome = Evaluated::Invalid(REFUSAL);
                }
            }
            // In the middle of the matrix: the first rows may be prescribed ones, which nobody
            // reads.
            Answer::Tangent { blocks: TangentBlocks::Double(blocks), .. } if self.is(Kind::Tangent) => {
                let middle = blocks.len() / 2;
                blocks[middle] = [f64::NAN; 9];
            }
            Answer::Tangent { blocks: TangentBlocks::Single(blocks), .. } if self.is(Kind::Tangent) => {
                let middle = blocks.len() / 2;
                blocks[middle] = [f32::NAN; 9];
            }
            Answer::Contact(rows) if self.is(Kind::Contact) => rows[0].residual = [f64::NAN; 3],
            Answer::Commit { energies, .. } if self.is(Kind::Energy) => energies.elastic = f64::NAN,
            _ => {}
        }
        Ok(())
    }
}

impl<C: Compute> Compute for Wrong<C> {
    fn models(&self) -> &[CaseModel] {
        self.backend.models()
    }

    fn about(&self) -> About {
        About::plain(self.backend.about().description)
    }

    fn call(&mut self, calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        let commits = calls.iter().any(|(_, call)| call.commits());
        if commits && self.is(Kind::Commit) {
            let refused = Answer::Commit { energies: Energies::default(), outcome: Evaluated::Invalid(REFUSAL) };
            return Ok(vec![refused; calls.len()]);
        }
        let asked: Vec<(usize, Call)> = calls.iter().map(|(case, call)| (*case, call.again())).collect();
        let mut answers = self.backend.call(calls)?;
        for ((case, call), answer) in asked.iter().zip(&mut answers) {
            self.spoil(*case, call, answer)?;
        }
        self.commits = self.commits.saturating_sub(usize::from(commits));
        Ok(answers)
    }
}
