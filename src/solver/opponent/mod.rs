//! What the body is pressed against.
//!
//! [`Opponent`] is the one list of all that depends on it, from the plan of the linear systems to
//! friction's work. `rigid` (a plane or a sphere), `pair` and `couple` are what there is; `joint`
//! is what the last two have in common. What is not said of an opponent is as over a plane.

pub mod couple;
pub mod dissipation;
pub mod joint;
pub mod pair;
pub mod rigid;

use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

use super::boundary::Boundary;
use super::outcome::Halt;
use super::systems::{OneBody, Systems};
use super::trial::Trial;
use crate::compute::ComputeError;
use crate::compute::handle::CaseHandle;
use crate::compute::linear::PairTie;
use crate::contact::coulomb::{Friction, Rows, Status};
use crate::linalg::{LinalgError, SolverKind};
use crate::mesh::Mesh;

/// A step that was taken, as friction's work needs it.
#[derive(Clone, Copy, Debug)]
pub struct StepTaken<'a> {
    /// The mesh.
    pub mesh: &'a Mesh,
    /// Friction between the bodies.
    pub friction: Friction<f64>,
    /// Displacements at its start and at its end (three a node; right at contact nodes).
    pub displacements: [&'a [f64]; 2],
    /// What contact exerted on contact nodes at its start (three a node).
    pub before: &'a [f64],
    /// What it exerts on each contact node at its end.
    pub after: &'a [[f64; 3]],
    /// What each contact node does at its end.
    pub statuses: &'a [Status],
}

/// An opponent, and how the body stands to it in the present step.
///
/// Displacements and forces are three a node. The unknowns of the linear systems are displacements
/// along the axes; at contact nodes what the opponent makes of them ([`Opponent::contract`]).
pub trait Opponent: Debug + Send + Sync {
    /// Plans the linear systems, of that kind if they are those of one body; `None` if the mesh has
    /// not the symmetry that they need.
    ///
    /// # Errors
    /// [`LinalgError::Hierarchy`] if the mesh's interpolations do not fit.
    fn systems(&self, mesh: &Arc<Mesh>, kind: SolverKind) -> Result<Option<Systems>, LinalgError> {
        Ok(Some(Systems::Planned(OneBody::new(mesh, kind))))
    }

    /// Makes the systems ready to be solved, once the tangent at `trial` is in them and it is known
    /// which unknowns are `fixed`.
    ///
    /// # Errors
    /// A matrix that cannot be solved with; systems that another opponent has planned.
    fn refresh(&self, systems: &mut Systems, trial: &Trial, boundary: &Boundary, fixed: &[bool]) -> Result<(), Halt> {
        let _ = (trial, boundary);
        systems.refresh(fixed)
    }

    /// What ties the bodies in the systems at `trial`, for a backend that solves those of an equal
    /// pair; none where the host has to.
    fn tied(&self, systems: &mut Systems, trial: &Trial, boundary: &Boundary) -> Option<PairTie> {
        let _ = (systems, trial, boundary);
        None
    }

    /// Whether backends solve its linear systems in steps that are not even in x.
    fn has_known_systems(&self) -> bool {
        self.is_rigid()
    }

    /// Whether it is rigid: the backend then states the conditions of contact, and a device may
    /// make whole steps.
    fn is_rigid(&self) -> bool {
        false
    }

    /// Whether backends know the conditions of contact of a step, which is even in x if it is
    /// `even`: a device may then make all of it. Other steps' are stated here alone.
    fn is_known(&self, even: bool) -> bool {
        let _ = even;
        self.is_rigid()
    }

    /// The contact nodes at which the contact is known: of two bodies the slave's.
    fn contacts(&self, mesh: &Mesh) -> Range<usize> {
        0..mesh.own_contacts()
    }

    /// Gap of a contact node of the undeformed body at `x`; over a rigid body of any node there.
    fn first_gap(&self, x: &[f64; 3]) -> f64 {
        x[2]
    }

    /// What a contact node does that is at `x` at the end of a step of which backends know the
    /// conditions of contact (see [`Opponent::is_known`]), where they say `status`; and its gap.
    fn settled(&self, x: &[f64; 3], status: Status, friction: Friction<f64>) -> (Status, f64) {
        let _ = friction;
        (status, self.first_gap(x))
    }

    /// The point of its surface on the normal through the sphere's centre: over a plane the foot of
    /// the perpendicular, on a sphere the point on the line of centres.
    fn contact_point(&self, centre: &[f64; 3]) -> [f64; 3] {
        [centre[0], centre[1], 0.0]
    }

    /// Sets out for a step from the displacement `start`, which is expected to lead to `expected`;
    /// both and the step are even in x if it is `symmetric`.
    fn set_out(&mut self, mesh: &Mesh, start: &[f64], expected: &[f64], symmetric: bool) {
        let _ = (mesh, start, expected, symmetric);
    }

    /// Moves points of a guess that have passed the opponent back to it.
    fn separate(&self, mesh: &Mesh, guess: &mut [f64]);

    /// Leaves the even part of displacements or forces, if all of the step is even in x. Rounding
    /// is not, nor the points that it makes flow on one side alone.
    fn leave_even(&self, x: &mut [f64]) {
        let _ = x;
    }

    /// The same of a correction: `delta` in displacements, `correction` in unknowns.
    fn leave_even_correction(&self, delta: &mut [f64], correction: &mut [f64]) {
        let _ = (delta, correction);
    }

    /// States the conditions of contact at a trial whose displacement and force are known: rows,
    /// residual, force scale.
    ///
    /// # Errors
    /// What the backend says.
    fn meet(&self, trial: &mut Trial, case: &mut CaseHandle<'_>, boundary: &Boundary) -> Result<(), ComputeError>;

    /// Whether the conditions of contact stand in the matrix; others' are imposed on its products.
    fn is_in_matrix(&self) -> bool {
        true
    }

    /// Turns corrections from the unknowns of the linear systems to displacements.
    fn expand(&self, trial: &Trial, mesh: &Mesh, x: &mut [f64]) {
        let _ = (trial, mesh, x);
    }

    /// Turns displacements into the unknowns of the linear systems.
    fn contract(&self, trial: &Trial, mesh: &Mesh, x: &mut [f64]) {
        let _ = (trial, mesh, x);
    }

    /// What contact exerts on each contact node, along the axes, as its conditions have it: normal
    /// to the surface the internal force; along it xi_t projected onto the friction cone (see
    /// [`crate::contact::coulomb`]), which is the internal force less the row's residual. In
    /// equilibrium that is nothing; what the tolerance leaves of it is a force that is missing in
    /// the body, not friction beyond Coulomb's bound. The symmetry plane's force is not the
    /// contact's.
    fn forces(&self, trial: &Trial, mesh: &Mesh) -> Vec<[f64; 3]>;

    /// What each contact node does; a master has the status of the slave that carries most of its
    /// load.
    fn statuses(&self, trial: &Trial) -> Vec<Status> {
        trial.rows.iter().map(|rows| rows.status).collect()
    }

    /// Gap at each contact node.
    fn gaps(&self, trial: &Trial, mesh: &Mesh) -> Vec<f64>;

    /// See [`super::newton::Newton::needed_forces`].
    fn needed_forces(&self, trial: &Trial, mesh: &Mesh) -> Vec<([f64; 3], Status)>;

    /// Work that friction dissipates in a step to the accepted `trial`, on the meshed half. Of a
    /// step that stays on a device the trial is unknown.
    fn friction_work(&self, trial: &Trial, step: &StepTaken<'_>) -> f64;
}

/// What a body needs at a point in its frame, where friction along y is left out that is none of
/// the contact's; and what the point does.
fn needed(rows: &Rows<f64>, [x, y, n]: [f64; 3], has_friction_along_y: bool) -> ([f64; 3], Status) {
    ([x, if has_friction_along_y { y } else { 0.0 }, n], rows.status)
}
