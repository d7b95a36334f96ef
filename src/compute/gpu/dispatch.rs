//! What a batch evaluates, for which of its cases, and how it went.

use crate::compute::{Evaluated, Fault};
use crate::contact::coulomb::Status;
use crate::element::hex8::Invalid;
use crate::material::Refusal;

/// What a batch evaluates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Evaluation {
    /// Internal forces.
    InternalForce,
    /// Tangents.
    Tangent,
    /// Contact rows.
    Contact,
    /// States at the end of a step and their energies, what a commit computes.
    Update,
}

/// Some of a call's requests, served by one dispatch.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Dispatch {
    pub(super) group: usize,
    /// Indices of the requests, in the order of their slots.
    pub requests: Vec<usize>,
    /// Their cases, counted from the first of the group.
    pub(super) cases: Vec<usize>,
}

/// What a code in `first_invalid` stands for (see shaders/element/point.wgsl).
fn fault(code: u32) -> Fault {
    let (element, point, is_not_finite) = (code as usize / 32, code as usize / 2 % 8, code % 2 == 1);
    Fault::of(
        element,
        match (code / 16 % 2, is_not_finite) {
            (0, false) => Invalid::Inverted(point),
            (0, true) => Invalid::NotFinite(point),
            (_, false) => Invalid::Material(point, Refusal::Inverted),
            (_, true) => Invalid::Material(point, Refusal::NotFinite),
        },
    )
}

/// How each slot went, from the first invalid point of each.
pub(super) fn outcomes(first: &[u32]) -> Vec<Evaluated> {
    let outcome = |&code: &u32| match code {
        u32::MAX => Evaluated::Valid,
        code => Evaluated::Invalid(fault(code)),
    };
    first.iter().map(outcome).collect()
}

/// The status of a contact point that `coulomb.wgsl` has this number for.
pub(super) fn status_of(number: u32) -> Status {
    match number {
        0 => Status::Open,
        1 => Status::Stick,
        _ => Status::Slip,
    }
}
