//! One case to the end of its path, on a mesh that is large enough for it.

use super::SimulationError;
use super::checkpoint::Snapshot;
use super::drive::{Drive, Ending, Observer, Paused};
use super::problem::Problem;
use super::zone::{BLIND_MARGIN, Zone};
use crate::compute::cpu::Cpu;
use crate::compute::handle::at;
use crate::compute::select::Selected;
use crate::compute::{CaseFields, Compute, ComputeError, Description};

/// A backend and the number of the case on it, which is in its virgin state.
pub type Seat<'a> = (Box<dyn Compute + 'a>, usize);

/// How a run went.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// How it ended.
    pub ending: Ending,
    /// Where its last part was computed.
    pub computed_on: Description,
}

/// Follows the path of `problem`, or what `snapshot` leaves of it, on the backend that `seat` has
/// for the problem. Where the contact leaves the finely meshed zone the run starts over on a larger
/// one, of which the observer is told; [`Ending::Outgrown`] is left for the largest zone there is.
///
/// # Errors
/// [`SimulationError`] where no smaller step helps.
pub fn follow<'a>(
    problem: Problem,
    snapshot: Option<Snapshot>,
    seat: &mut dyn FnMut(&Problem) -> Result<Seat<'a>, SimulationError>,
    observer: &mut dyn Observer,
) -> Result<Followed, SimulationError> {
    let mut follower = Follower::new(problem, snapshot, seat)?;
    let ending = follower.go_on(seat, observer)?;
    Ok(Followed { ending, computed_on: follower.description() })
}

/// A run that may be left after any step, and taken up again: what [`follow`] does, in parts.
pub struct Follower<'a> {
    problem: Problem,
    seat: Seat<'a>,
    /// `None` only while the drive is under way, and after it failed.
    paused: Option<Paused>,
}

impl<'a> Follower<'a> {
    /// At the start of the path, or where `snapshot` was taken.
    ///
    /// # Errors
    /// [`SimulationError`] if there is no backend, or the snapshot is of another mesh.
    pub fn new(
        problem: Problem,
        snapshot: Option<Snapshot>,
        seat: &mut dyn FnMut(&Problem) -> Result<Seat<'a>, SimulationError>,
    ) -> Result<Self, SimulationError> {
        let mut seat = seat(&problem)?;
        let paused = set_out(&problem, &mut seat, snapshot)?;
        Ok(Self { problem, seat, paused: Some(paused) })
    }

    /// Follows the path to its end, or until the observer asks to stop. After
    /// [`Ending::Interrupted`] it may be called again.
    ///
    /// # Errors
    /// As [`follow`]; there is then nothing to go on from.
    pub fn go_on(
        &mut self,
        seat: &mut dyn FnMut(&Problem) -> Result<Seat<'a>, SimulationError>,
        observer: &mut dyn Observer,
    ) -> Result<Ending, SimulationError> {
        let note = self.paused.as_ref().and_then(|paused| paused.first_note(self.seat.0.as_ref()));
        note.iter().for_each(|note| observer.note(note));
        loop {
            let paused = match self.paused.take() {
                Some(paused) => paused,
                None => set_out(&self.problem, &mut self.seat, None)?,
            };
            let mut drive = paused.go_on(&self.problem, self.seat.0.as_mut(), self.seat.1);
            let ending = drive.run(observer)?;
            if ending == Ending::Done && observer.keeps_end() {
                drive.checkpoint(true, observer);
            }
            self.paused = Some(drive.pause()?);
            let grown = match &ending {
                Ending::Outgrown(outgrowth) => {
                    let zone = self.problem.grown_zone(outgrowth.reach, outgrowth.contact_radius, BLIND_MARGIN);
                    zone.map(|zone| (zone, *outgrowth))
                }
                _ => None,
            };
            let Some((zone, outgrowth)) = grown else { return Ok(ending) };
            self.problem = self.problem.on_zone(zone)?;
            let problem = &self.problem;
            observer.starts_over(problem, problem.free_unknowns()).map_err(SimulationError::Observer)?;
            observer.note(&format!(
                "{outgrowth}; started over with a finely meshed zone of {:.4} R and elements of {:.5} R in it",
                zone.radius(),
                problem.spacing
            ));
            self.paused = None;
            self.seat = seat(problem)?;
        }
    }

    /// The problem, on the mesh of the present part of the run.
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// The last accepted step; `None` after a failure.
    pub fn last(&self) -> Option<&Paused> {
        self.paused.as_ref()
    }

    /// Stresses and strains of the last accepted step, scaled.
    ///
    /// # Errors
    /// [`ComputeError`] of the device.
    pub fn fields(&mut self) -> Result<CaseFields, ComputeError> {
        at(self.seat.0.as_mut(), self.seat.1).fields()
    }

    /// Where the present part of the run is computed.
    pub fn description(&self) -> Description {
        self.seat.0.about().description
    }
}

/// A drive that has done nothing yet, or is put back to where `snapshot` was taken.
fn set_out(problem: &Problem, seat: &mut Seat<'_>, snapshot: Option<Snapshot>) -> Result<Paused, SimulationError> {
    let mut drive = Drive::new(problem, seat.0.as_mut(), seat.1, problem.newton()?);
    if let Some(snapshot) = snapshot {
        drive.resume(snapshot)?;
    }
    Ok(drive.pause()?)
}

/// Gives out `first`, which was made for a problem on `zone`, and afterwards, or for another zone,
/// what `open` makes.
pub fn seats<'a>(
    first: Seat<'a>,
    zone: Zone,
    mut open: impl FnMut(&Problem) -> Result<Selected, ComputeError>,
) -> impl FnMut(&Problem) -> Result<Seat<'a>, SimulationError> {
    let mut first = Some(first);
    move |problem| match first.take().filter(|_| problem.zone == zone) {
        Some(seat) => Ok(seat),
        None => Ok((open(problem)?.backend, 0)),
    }
}

/// A seat on the CPU in f64, for a problem alone.
///
/// # Errors
/// [`SimulationError::Compute`].
pub fn on_cpu<'a>(problem: &Problem) -> Result<Seat<'a>, SimulationError> {
    Ok((Box::new(Cpu::<f64, f32>::with_tangents(vec![problem.model.clone()])?), 0))
}
