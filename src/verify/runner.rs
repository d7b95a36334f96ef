//! Follows one case of the checks and keeps what the checks ask for.

use serde::Serialize;

use super::VerifyError;
use super::equator::Compliances;
use super::sphere::History;
use crate::case::Case;
use crate::compute::{CaseModel, Compute, ComputeError, Description};
use crate::output::Recorder;
use crate::simulation::drive::{Drive, Ending};
use crate::simulation::problem::Problem;

/// Elements along the contact radius at the fine level.
const FINE: usize = 16;

/// Makes the backend on which a case is computed.
pub type BackendFactory<'a> = dyn FnMut(Vec<CaseModel>) -> Result<Box<dyn Compute>, ComputeError> + 'a;

/// How finely the cases are meshed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Fineness {
    /// Meshes with which all checks take about a minute.
    #[default]
    Quick,
    /// `FINE` elements, or the check's own where these are more.
    Fine,
}

/// Runs cases, one after the other; each uses all threads.
pub struct Runner<'a> {
    backend: &'a mut BackendFactory<'a>,
    /// How finely the cases are meshed.
    pub level: Fineness,
    equator: Vec<(f64, Compliances)>,
    computed_on: Option<Description>,
}

impl<'a> Runner<'a> {
    /// A runner whose cases are computed by what `backend` makes.
    pub fn new(backend: &'a mut BackendFactory<'a>, level: Fineness) -> Self {
        Self { backend, level, equator: Vec::new(), computed_on: None }
    }

    /// Where the last case was computed.
    pub fn computed_on(&self) -> Option<&Description> {
        self.computed_on.as_ref()
    }

    /// Elements along the contact radius: `quick`, or at the fine level at least [`FINE`].
    pub fn elements(&self, quick: usize) -> usize {
        match self.level {
            Fineness::Quick => quick,
            Fineness::Fine => quick.max(FINE),
        }
    }

    /// The body's compliances at one Poisson's ratio, measured when they are first asked for.
    ///
    /// # Errors
    /// As those of [`Runner::follow`].
    pub fn equator(&mut self, nu: f64) -> Result<Compliances, VerifyError> {
        if let Some((_, known)) = self.equator.iter().find(|(at, _)| *at == nu) {
            return Ok(*known);
        }
        let elements = self.elements(8);
        let measured = Compliances::measure(nu, elements, |case| self.follow(case))?;
        self.equator.push((nu, measured));
        Ok(measured)
    }

    /// Follows the whole path of a case.
    ///
    /// # Errors
    /// The case cannot be set up or the device fails, or the path cannot be followed to its end.
    pub fn follow(&mut self, case: &Case) -> Result<History, VerifyError> {
        let problem = Problem::new(case)?;
        let mut backend = (self.backend)(vec![problem.model.clone()])?;
        let newton = problem.newton()?;
        let mut recorder = Recorder::new(case, None);
        let ending = Drive::new(&problem, backend.as_mut(), 0, newton).run(&mut recorder);
        // Not where it began, if the device failed on the way.
        self.computed_on = Some(backend.about().description);
        match ending? {
            Ending::Done => Ok(History { rows: recorder.rows, contact: recorder.contact }),
            Ending::NotConverged(reason) => Err(VerifyError::Stopped(reason)),
            Ending::Outgrown(outgrowth) => Err(VerifyError::Stopped(outgrowth.to_string())),
            Ending::Interrupted => Err(VerifyError::Stopped("interrupted".to_owned())),
        }
    }
}
