//! The iterates of Newton's method, where they stay on the device: what is asked of one case, and
//! the few numbers that come back.
//!
//! A backend that keeps iterates ([`super::About::keeps`]) has two for each case, the
//! current one and a trial, both as increments since the committed state, and a correction that
//! leads from the one to the other. Over a rigid body only, and in the press of an equal pair.

use super::linear::SideReport;
use super::{Energies, Evaluated, Fault};
use crate::contact::coulomb::Status;
use crate::mesh::Mesh;

/// Which of Newton's iterates a backend keeps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Keeps {
    /// None: the host has them.
    #[default]
    Nothing,
    /// Those of a step, and it commits the last one.
    Steps,
    /// The same in f32 where residuals are in f64 elsewhere: what a step ends with there is a first
    /// iterate for the host, who holds it to the residual in f64 and has it committed.
    Guesses,
}

/// Where the plate is, or is to be.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Plate {
    /// Depth h of the current iterate; of a first one its own.
    pub h: f64,
    /// delta_T at the end of the step.
    pub delta_t: f64,
    /// Normal force of the meshed half that is to be held.
    pub held: Option<f64>,
}

/// Where a step's first iterate comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum From {
    /// The committed displacement and so many times the last step; `lift` puts points that have
    /// passed the opponent's surface on it. The plate is placed.
    Extrapolation {
        /// Share of the last step.
        ratio: f64,
        /// Whether points are put on the surface.
        lift: bool,
    },
    /// The committed displacement: the plate has not moved yet.
    Start,
    /// The current iterate, which touches nothing, moved as one along x and z. Its internal forces
    /// stay as they are. The plate is placed.
    Shift([f64; 2]),
}

/// The first iterate of a step.
#[derive(Clone, Debug, PartialEq)]
pub struct Begin {
    /// Where it comes from.
    pub from: From,
    /// Under full stick: contact points that slide in this step. None keeps those there are.
    pub sliding: Option<Vec<bool>>,
}

/// A linear system at the current iterate, and the trial at the end of its correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correct {
    /// Relative residual to be reached (see [`super::linear::Side`]).
    pub tolerance: f64,
    /// Krylov iterations that it will probably take.
    pub expected: usize,
    /// Where a force is held: the same of the response to a unit indentation.
    pub unit_tolerance: f64,
    /// See `expected`.
    pub unit_expected: usize,
    /// It is the first of its step: the tolerance of the unit response is of the residual at its
    /// guess.
    pub first: bool,
    /// Plate force of the current iterate.
    pub plate_force: f64,
}

/// What is asked.
#[derive(Clone, Debug, PartialEq)]
pub enum Ask {
    /// A first iterate; valid, it is the current one.
    Begin(Begin),
    /// The linear system, and the whole correction as the trial.
    Correct(Correct),
    /// The trial at this step length along the correction, whose change of h is the second number.
    Try(f64, f64),
    /// Under full stick: points that came off within the step and come down again slide; the
    /// current iterate is assessed anew.
    Land,
    /// The current iterate becomes the committed state.
    Commit,
    /// All of the current iterate: for what the host does itself.
    Bring,
    /// The correction, from the host.
    Give(Vec<f64>),
    /// Committed displacement, and that of one step before.
    Displacements,
    /// The displacement of one step before, from which the next one is extrapolated.
    SetEarlier(Vec<f64>),
}

/// Asks something of the iterates of one case.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What was tried last is the current iterate from now on.
    pub kept: bool,
    /// The plate.
    pub plate: Plate,
    /// What is asked.
    pub ask: Ask,
}

/// What is known of a trial: all that decides how the iteration goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Reading {
    /// How its evaluation went; nothing else means anything if it is not valid.
    pub outcome: Evaluated,
    /// Norm of the residual: free forces, contact residuals, missing displacements and the missing
    /// normal force, all as forces.
    pub merit: f64,
    /// Sum of the normal forces |f_n| over the points in contact.
    pub force_scale: f64,
    /// Normal force that the plate feels, minus its f_z.
    pub plate_force: f64,
    /// Norm of the tangential residuals of the points in contact.
    pub tangential: f64,
    /// Normal force that the opponent exerts on the meshed half. Only known where it is held.
    pub normal_force: f64,
    /// Work of the free residual on the correction.
    pub slope: f64,
    /// Square of the tangential forces that points let go of that stick in the current iterate and
    /// are open in the trial.
    pub released: f64,
    /// Contact points whose status differs from the current iterate's.
    pub changed: usize,
    /// Under full stick: points that would be let slide (see [`Ask::Land`]).
    pub landed: usize,
}

impl Reading {
    /// Of a trial that could not be evaluated.
    pub fn of_nothing(outcome: Evaluated) -> Self {
        Self { outcome, merit: f64::INFINITY, ..Self::default() }
    }

    /// Whether there is something to decide by: a valid trial whose numbers are all finite.
    /// Newton's method compares them, and a NaN passes any comparison that is written the wrong way
    /// round.
    ///
    /// # Errors
    /// The fault.
    pub fn check(&self) -> Result<(), Fault> {
        let Self { outcome, merit, force_scale, plate_force, tangential, normal_force, released, .. } = *self;
        outcome.check()?;
        let numbers = [merit, force_scale, plate_force, tangential, normal_force, released];
        if numbers.iter().all(|x| x.is_finite()) { Ok(()) } else { Err(Fault::Residual { at: None }) }
    }
}

/// How a linear system and its trial went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Corrected {
    /// How the tangent went.
    pub tangent: Evaluated,
    /// How the solution went. Where it did not converge, the rest means nothing.
    pub report: SideReport,
    /// Where a force is held: the same of the response to a unit indentation.
    pub unit: Option<SideReport>,
    /// Change of h along the correction.
    pub delta_h: f64,
    /// Work of the current iterate's free residual on the correction.
    pub slope: f64,
    /// The trial.
    pub trial: Reading,
}

/// A contact point of a committed state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SettledPoint {
    /// Displacement.
    pub displacement: [f64; 3],
    /// What the opponent exerts: along its surface what Coulomb's bound allows, normal to it the
    /// internal force.
    pub force: [f64; 3],
    /// What it does.
    pub status: Status,
}

/// What a commit leaves.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// How it went; an invalid state is not committed.
    pub outcome: Evaluated,
    /// Energies of the new state.
    pub energies: Energies,
    /// Its contact points.
    pub points: Vec<SettledPoint>,
}

/// An iterate as the host would have it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Vectors {
    /// Displacement, three a node.
    pub displacement: Vec<f64>,
    /// Internal force, three a node.
    pub force: Vec<f64>,
    /// Whether each contact point slides without friction in this step.
    pub sliding: Vec<bool>,
    /// Under full stick: whether each contact point has come off in this step.
    pub came_off: Vec<bool>,
}

/// What comes back.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// There is nothing to say.
    Nothing,
    /// Of [`Ask::Begin`], [`Ask::Try`] and [`Ask::Land`].
    Reading(Reading),
    /// Of [`Ask::Correct`].
    Corrected(Corrected),
    /// Of [`Ask::Commit`].
    Settled(Settled),
    /// Of [`Ask::Bring`].
    Vectors(Box<Vectors>),
    /// Of [`Ask::Displacements`].
    Displacements([Vec<f64>; 2]),
}

/// Per unknown: prescribed by the plate or by symmetry, whatever the contact does.
pub fn prescribed(mesh: &Mesh) -> Vec<bool> {
    let mut prescribed = vec![false; 3 * mesh.nodes.len()];
    for &n in &mesh.symmetry_nodes {
        prescribed[3 * n as usize + 1] = true;
    }
    for &n in &mesh.plate_nodes {
        prescribed[3 * n as usize..3 * n as usize + 3].fill(true);
    }
    prescribed
}

/// A typical stiffness, by which a missing prescribed displacement enters the merit.
pub fn missing_weight(mesh: &Mesh) -> f64 {
    0.1 * mesh.contact_size.iter().sum::<f64>() / mesh.contact_size.len().max(1) as f64
}
