//! A path to be checked.

use crate::case::{Case, Fields};

/// A path to be checked.
#[derive(Clone, Debug)]
pub struct Path {
    /// What it is.
    pub name: &'static str,
    /// The case to simulate.
    pub case: Case,
}

/// A case on the mesh of a check: so many elements along the contact radius inside and twice as
/// many at the surface, with a companion, and no pictures.
pub fn meshed(case: &Case, elements: usize) -> Case {
    let mut case = case.clone();
    case.mesh = case.mesh.refined(elements);
    case.mesh.contact_radius = None;
    case.solver.error_estimate = true;
    case.output.fields = Fields::None;
    case.output.plots = false;
    case
}
