//! The iterates of a step: who holds displacements, forces and matrices, and what Newton's method
//! decides by.
//!
//! [`Iterate`] is all that [`super::newton`] knows of them: numbers, no vectors. `host` holds them
//! itself and asks the backend for forces and tangents, whatever the opponent; `resident` leaves
//! them on a device that keeps iterates. `linearise` is the linear system of `host`.

mod equator;
pub mod host;
mod linearise;
pub mod resident;
pub mod stiffness;

use super::outcome::Halt;
use super::phases::PhaseTimes;
use super::pose::Pose;
use super::{Control, Worst};
use crate::compute::Fault;
use crate::compute::handle::CaseHandle;
use crate::compute::iterate::Reading;

/// Where a step starts from.
#[derive(Clone, Copy, Debug)]
pub struct SetOut<'a> {
    /// The committed displacement, three a node. A device that keeps iterates has its own.
    pub displacement: &'a [f64],
    /// Indentation there.
    pub h: f64,
    /// Where the plate stands there otherwise.
    pub pose: Pose,
    /// The first iterate on the host, three a node, if there is a better one than the start.
    pub guess: Option<&'a [f64]>,
    /// The same where a device keeps iterates.
    pub extrapolation: Option<Extrapolation>,
    /// Under full stick: the contact points that have come off on the way to the guess; none for an
    /// empty list.
    pub came_off: &'a [bool],
}

/// A first iterate: the committed displacement and so many times the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extrapolation {
    /// Share of the last step.
    pub ratio: f64,
    /// Whether points that have passed the opponent's surface are put on it.
    pub lift: bool,
}

/// What is asked of a linear system.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// What drives the step.
    pub control: &'a Control,
    /// Relative residual to be reached.
    pub eta: f64,
    /// It is the first of its step.
    pub first: bool,
}

/// A correction that was found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Correction {
    /// Krylov iterations.
    pub krylov: usize,
    /// It was solved directly, because the iteration stalled.
    pub fallback: bool,
    /// Change of h along it, where the normal force is held.
    pub delta_h: f64,
    /// Work of the current iterate's free residual forces on it.
    pub slope: f64,
}

/// The iterates of one step: a current one, trials along a correction, and the best of these.
pub trait Iterate {
    /// Sets the first iterate: the guess if it can be evaluated, the start otherwise.
    ///
    /// # Errors
    /// What no smaller step cures; the device that holds the iterate is gone.
    fn begin(
        &mut self,
        case: &mut CaseHandle<'_>,
        start: &SetOut<'_>,
        control: &Control,
        times: &mut PhaseTimes,
    ) -> Result<Reading, Halt>;

    /// Indentation of the current iterate.
    fn h(&self) -> f64;

    /// The plate of the current iterate is where it belongs: it moves with the first linear system,
    /// if not with the guess.
    fn plate_is_placed(&self, control: &Control) -> bool;

    /// Solves the linear system at the current iterate.
    ///
    /// # Errors
    /// A system that cannot be solved; what no smaller step cures.
    fn correct(&mut self, case: &mut CaseHandle<'_>, asked: Asked<'_>, times: &mut PhaseTimes) -> Result<Correction, Halt>;

    /// Evaluates the trial at a step length along the correction.
    ///
    /// # Errors
    /// What no smaller step cures.
    fn try_length(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        length: f64,
        times: &mut PhaseTimes,
    ) -> Result<Reading, Halt>;

    /// What was tried last is the best so far.
    fn favour(&mut self);

    /// Makes the trial at a step length the current iterate. It costs an evaluation if it is not
    /// the one that was favoured last.
    ///
    /// # Errors
    /// What no smaller step cures.
    fn keep(&mut self, case: &mut CaseHandle<'_>, control: &Control, length: f64, times: &mut PhaseTimes) -> Result<(), Halt>;

    /// Under full stick, after an iterate was kept: a point that came off within the step and comes
    /// down again has let go of its tangential force, and carries none up to the step's end: held
    /// to where it stuck before, or open, there may be no equilibrium for it. `expected` such
    /// points were read. Returns how many there are, and the current iterate assessed with them.
    ///
    /// # Errors
    /// What no smaller step cures.
    fn land(
        &mut self,
        case: &mut CaseHandle<'_>,
        control: &Control,
        expected: usize,
        times: &mut PhaseTimes,
    ) -> Result<Option<(usize, Reading)>, Halt>;

    /// Where the residual of what was tried last is not finite, if that takes a closer look; the
    /// step cannot go on after it.
    ///
    /// # Errors
    /// What no smaller step cures.
    fn locate(&mut self, case: &mut CaseHandle<'_>, control: &Control) -> Result<Option<Fault>, Halt> {
        let _ = (case, control);
        Ok(None)
    }

    /// The unknown of the current iterate with the largest residual, over the force `scale`.
    ///
    /// # Errors
    /// What no smaller step cures.
    fn worst(&mut self, case: &mut CaseHandle<'_>, control: &Control, scale: f64) -> Result<Worst, Halt>;
}
