//! What a case asks of a shared backend: requests that own what they are about, so that they can go
//! to another thread and come back with the answer.

use std::sync::mpsc::Sender;

use crate::compute::iterate::IterateRequest;
use crate::compute::linear::{LinearRequest, Side, SideReport};
use crate::compute::{Blocks, CaseFields, CaseModel, CaseState, ComputeError, Energies, Outcome};
use crate::contact::coulomb::Rows;

/// What a case asks for, and the answer when it comes back.
pub(super) enum Ask {
    Force { displacement: Vec<f64>, force: Vec<f64>, outcome: Outcome },
    Contact { displacement: Vec<f64>, force: Vec<f64>, rows: Vec<Rows<f64>> },
    Tangent { displacement: Vec<f64>, blocks: OwnBlocks, outcome: Outcome },
    Linear(LinearAsk),
    Commit { displacement: Vec<f64>, energies: Energies, outcome: Outcome },
    Iterate(Box<IterateRequest>),
    Begin(f64),
    Fields(Option<CaseFields>),
    State(Option<CaseState>),
    Restore(CaseState),
    Replace(Box<CaseModel>),
    Replaced(bool),
}

/// [`Blocks`] that own their numbers.
pub(super) enum OwnBlocks {
    Double(Vec<[f64; 9]>),
    Single(Vec<[f32; 9]>),
}

impl Default for OwnBlocks {
    fn default() -> Self {
        Self::Single(Vec::new())
    }
}

impl OwnBlocks {
    /// Of the size and precision of `asked`; the memory is used again where it fits.
    pub fn like(self, asked: &Blocks<'_>) -> Self {
        match (self, asked) {
            (Self::Double(mut own), Blocks::Double(asked)) => {
                own.resize(asked.len(), [0.0; 9]);
                Self::Double(own)
            }
            (Self::Single(mut own), Blocks::Single(asked)) => {
                own.resize(asked.len(), [0.0; 9]);
                Self::Single(own)
            }
            (_, Blocks::Double(asked)) => Self::Double(vec![[0.0; 9]; asked.len()]),
            (_, Blocks::Single(asked)) => Self::Single(vec![[0.0; 9]; asked.len()]),
        }
    }

    pub fn request(&mut self) -> Blocks<'_> {
        match self {
            Self::Double(blocks) => Blocks::Double(blocks),
            Self::Single(blocks) => Blocks::Single(blocks),
        }
    }

    /// Copies to where they were asked for.
    pub fn copy_to(&self, asked: &mut Blocks<'_>) -> Result<(), ComputeError> {
        match (self, asked) {
            (Self::Double(own), Blocks::Double(asked)) => asked.copy_from_slice(own),
            (Self::Single(own), Blocks::Single(asked)) => asked.copy_from_slice(own),
            _ => return Err(ComputeError::Device("a tangent came back in another precision".to_owned())),
        }
        Ok(())
    }
}

/// A [`LinearRequest`] that owns what it is about.
pub(super) struct LinearAsk {
    pub displacement: Vec<f64>,
    pub rows: Vec<Rows<f64>>,
    pub fixed: Vec<bool>,
    pub sides: Vec<SideAsk>,
    pub outcome: Outcome,
}

/// A [`Side`] that owns its vectors.
pub(super) struct SideAsk {
    pub rhs: Vec<f64>,
    pub tolerance: f64,
    pub relative_to_guess: bool,
    pub expected: usize,
    pub x: Vec<f64>,
    pub report: SideReport,
}

impl LinearAsk {
    pub fn new(request: &LinearRequest<'_>) -> Self {
        let side = |side: &Side<'_>| SideAsk {
            rhs: side.rhs.to_vec(),
            tolerance: side.tolerance,
            relative_to_guess: side.relative_to_guess,
            expected: side.expected,
            x: side.x.to_vec(),
            report: side.report,
        };
        Self {
            displacement: request.displacement.to_vec(),
            rows: request.rows.to_vec(),
            fixed: request.fixed.to_vec(),
            sides: request.sides.iter().map(side).collect(),
            outcome: request.outcome,
        }
    }

    pub fn request(&mut self, case: usize) -> LinearRequest<'_> {
        let sides = self.sides.iter_mut().map(SideAsk::side).collect();
        let (displacement, rows, fixed) = (&self.displacement, &self.rows, &self.fixed);
        LinearRequest { case, displacement, rows, fixed, sides, outcome: self.outcome }
    }
}

impl SideAsk {
    fn side(&mut self) -> Side<'_> {
        let Self { rhs, tolerance, relative_to_guess, expected, x, report } = self;
        Side { rhs, tolerance: *tolerance, relative_to_guess: *relative_to_guess, expected: *expected, x, report: *report }
    }
}

pub(super) type Answer = Result<Ask, ComputeError>;

pub(super) struct Request {
    pub case: usize,
    pub ask: Ask,
    pub reply: Sender<Answer>,
}
