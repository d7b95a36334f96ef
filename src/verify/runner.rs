//! Follows one case of the checks and keeps what the checks ask for.

use serde::Serialize;

use super::VerifyError;
use super::equator::Equator;
use crate::case::{
    Case, Contact, Fields, Friction, Hardening, Hold, Material, Mesh, Output, Segment, ShearTarget, Solver, Sphere, UnitLabels,
};
use crate::compute::{CaseModel, Compute, ComputeError, Description};
use crate::output::{ContactPoint, Recorder};
use crate::simulation::drive::{Drive, Ending};
use crate::simulation::problem::Problem;
use crate::simulation::record::StepRecord;

/// Makes the backend on which a case is computed.
pub type BackendFactory<'a> = dyn FnMut(Vec<CaseModel>) -> Result<Box<dyn Compute>, ComputeError> + 'a;

/// How finely the cases are meshed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Level {
    /// Meshes with which all checks take about a minute.
    #[default]
    Quick,
    /// The mesh that a case has by default, or the check's own where that is finer.
    Fine,
}

/// Radius and Young's modulus of the checks' sphere: lengths in radii, stresses in MPa.
pub const RADIUS: f64 = 1.0;
/// See [`RADIUS`].
pub const YOUNGS_MODULUS: f64 = 200e3;

/// Runs cases, one after the other; each uses all threads.
pub struct Runner<'a> {
    backend: &'a mut BackendFactory<'a>,
    /// How finely the cases are meshed.
    pub level: Level,
    equator: Vec<(f64, Equator)>,
    computed_on: Option<Description>,
}

impl<'a> Runner<'a> {
    /// A runner whose cases are computed by what `backend` makes.
    pub fn new(backend: &'a mut BackendFactory<'a>, level: Level) -> Self {
        Self { backend, level, equator: Vec::new(), computed_on: None }
    }

    /// Where the last case was computed.
    pub fn computed_on(&self) -> Option<&Description> {
        self.computed_on.as_ref()
    }

    /// Elements along the contact radius: `quick`, or at the fine level at least as many as a case
    /// has by default.
    pub fn elements(&self, quick: usize) -> usize {
        match self.level {
            Level::Quick => quick,
            Level::Fine => quick.max(Mesh::default().elements_per_contact_radius),
        }
    }

    /// The body's compliances at one Poisson's ratio, measured when they are first asked for.
    ///
    /// # Errors
    /// As those of [`Runner::follow`].
    pub fn equator(&mut self, nu: f64) -> Result<Equator, VerifyError> {
        if let Some((_, known)) = self.equator.iter().find(|(at, _)| *at == nu) {
            return Ok(*known);
        }
        let measured = Equator::measure(self, nu)?;
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
        self.computed_on = Some(backend.description());
        match ending? {
            Ending::Done => Ok(History { rows: recorder.rows, contact: recorder.contact }),
            Ending::NotConverged(reason) => Err(VerifyError::Stopped(reason)),
            Ending::Outgrown(outgrowth) => Err(VerifyError::Stopped(outgrowth.to_string())),
            Ending::Interrupted => Err(VerifyError::Stopped("interrupted".to_owned())),
        }
    }
}

/// The accepted steps of a case, in the case's units; forces and energies of the whole sphere.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// All rows, the undeformed state first.
    pub rows: Vec<StepRecord>,
    /// The whole contact at the end of the path.
    pub contact: Vec<ContactPoint>,
}

impl History {
    /// The rows of one segment of the path, in order.
    pub fn segment(&self, segment: usize) -> impl Iterator<Item = &StepRecord> {
        self.rows.iter().filter(move |row| row.segment == segment && row.step > 0)
    }

    /// The last row of a segment; all zero if it has none.
    pub fn end(&self, segment: usize) -> StepRecord {
        self.segment(segment).last().copied().unwrap_or_default()
    }

    /// The last row.
    pub fn last(&self) -> StepRecord {
        self.rows.last().copied().unwrap_or_default()
    }
}

/// A case on the checks' sphere, with default numerics; nothing is written.
pub fn sphere(poissons_ratio: f64, hardening: Hardening, friction: f64, elements: usize, path: Vec<Segment>) -> Case {
    Case {
        opponent: None,
        sphere: Sphere { radius: RADIUS, flat: false },
        material: Material { youngs_modulus: YOUNGS_MODULUS, poissons_ratio, hardening },
        contact: Contact { friction: Friction::Coefficient(friction) },
        mesh: Mesh { elements_per_contact_radius: elements, ..Mesh::default() },
        solver: Solver::default(),
        output: Output { fields: Fields::None, plots: false, ..Output::default() },
        units: UnitLabels::default(),
        path,
    }
}

/// A segment that presses, or unloads, to `h`.
pub fn press(h: f64) -> Segment {
    Segment::Indentation { indentation: h }
}

/// A segment that shears to `d`.
pub fn shear(d: f64, hold: Hold) -> Segment {
    Segment::Shear { shear: ShearTarget::Displacement(d), hold }
}

/// A segment that shears to full slip at constant h.
pub fn full_slip() -> Segment {
    Segment::Shear { shear: ShearTarget::FullSlip, hold: Hold::Indentation }
}
