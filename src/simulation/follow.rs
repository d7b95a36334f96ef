//! One case to the end of its path, on a mesh that is large enough for it.

use super::SimulationError;
use super::checkpoint::Snapshot;
use super::drive::{Drive, Ending, Observer};
use super::problem::Problem;
use super::zone::{BLIND_MARGIN, Zone};
use crate::compute::cpu::Cpu;
use crate::compute::select::Selected;
use crate::compute::{Compute, ComputeError, Description};

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

/// Follows the path of `problem`, or what `snapshot` leaves of it, on the backend that `seat` has for the problem. Where the contact leaves the finely
/// meshed zone the run starts over on a larger one, of which the observer is told; [`Ending::Outgrown`] is left for the largest zone there is.
///
/// # Errors
/// [`SimulationError`] where no smaller step helps.
pub fn follow<'a>(
    mut problem: Problem,
    mut snapshot: Option<Snapshot>,
    seat: &mut dyn FnMut(&Problem) -> Result<Seat<'a>, SimulationError>,
    observer: &mut dyn Observer,
) -> Result<Followed, SimulationError> {
    loop {
        let (mut backend, case) = seat(&problem)?;
        let mut drive = Drive::new(&problem, backend.as_mut(), case, problem.newton()?);
        if let Some(snapshot) = snapshot.take() {
            drive.resume(snapshot)?;
        }
        let ending = drive.run(observer)?;
        if ending == Ending::Done && problem.case.output.plots {
            // Whatever becomes of the pictures, the path has not to be followed again.
            drive.checkpoint(true, observer);
        }
        let grown = match &ending {
            Ending::Outgrown(outgrowth) => {
                problem.zone.grown(outgrowth.reach, outgrowth.contact_radius, BLIND_MARGIN).map(|zone| (zone, *outgrowth))
            }
            _ => None,
        };
        let Some((zone, outgrowth)) = grown else {
            return Ok(Followed { ending, computed_on: backend.description() });
        };
        problem = Problem::on(&problem.case, Some(zone))?;
        observer.starts_over(&problem, problem.free_unknowns()).map_err(SimulationError::Observer)?;
        observer.note(&format!(
            "{outgrowth}; started over with a finely meshed zone of {:.4} R and elements of {:.5} R in it",
            zone.radius(),
            problem.spacing
        ));
    }
}

/// Gives out `first`, which was made for a problem on `zone`, and afterwards, or for another zone, what `open` makes.
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
    Ok((Box::new(Cpu::<f64>::new(vec![problem.model.clone()])?), 0))
}
