//! From a case file to a scaled model: lengths by R, stresses by E.

use std::sync::Arc;

use super::SimulationError;
use super::path::Resolution;
use super::zone::Zone;
use crate::analytical::predicted_contact_radius;
use crate::case::{self, Case, Opponent, Segment};
use crate::compute::CaseModel;
use crate::contact::coulomb::Friction;
use crate::linalg::{LinearSolver, SolverKind};
use crate::material::hardening::Hardening;
use crate::mesh::pattern::Pattern;
use crate::mesh::sphere::{SphereSpec, sphere_mesh};
use crate::solver::newton::Newton;
use crate::solver::pair::{PairSolver, mirror_nodes};
use crate::solver::system::Boundary;
use crate::solver::{FULLY_PLASTIC, Settings, SolverError, first_linear, loosest_linear};

/// A case ready to be simulated.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The case, scaled.
    pub case: Case,
    /// Mesh, material and friction, scaled.
    pub model: CaseModel,
    /// Step numbers.
    pub resolution: Resolution,
    /// Newton settings.
    pub settings: Settings,
    /// Bisections of one step before the run is given up.
    pub max_cutbacks: usize,
    /// Typical distance of contact points.
    pub spacing: f64,
    /// The part of the surface that is finely meshed.
    pub zone: Zone,
    /// Share of the last step by which a press step is extrapolated.
    pub press_extrapolation: f64,
    /// The body is pressed against its own image (see [`crate::contact::pair`]), not against a plane.
    pub equal_pair: bool,
    /// Bodies that deform, see [`Case::bodies`]: displacements of the path and the record are those of one.
    pub bodies: f64,
}

/// Steps of a press: so many and so many more for each element along the contact radius; the front moves by a third of an element in the last ones. In the
/// main job at 16 elements F_N(h) at the end, half-way and at a quarter lacks 0.2, 0.5 and 2 % at these 26 steps (of which the steps 0.1, 0.3 and 1 %).
const PRESS_STEPS: f64 = 14.0;
const PRESS_STEPS_PER_ELEMENT: f64 = 0.75;
const SHEAR_STEPS: usize = 15;
/// Largest indentation of the path, scaled.
fn largest_indentation(case: &Case) -> f64 {
    case.path.iter().fold(0.0, |h, s| match s {
        Segment::Indentation { indentation } | Segment::Oblique { indentation, .. } => h.max(*indentation),
        _ => h,
    })
}

/// Steps of a first press: as many as the case says, or else as go with its elements along the contact radius.
pub fn press_steps(case: &Case) -> usize {
    let elements = case.mesh.elements_per_contact_radius as f64;
    case.solver.press_steps.unwrap_or_else(|| (PRESS_STEPS + PRESS_STEPS_PER_ELEMENT * elements).ceil() as usize)
}

/// Growing steps of a shear: as many as the case says, or else the default.
pub fn shear_steps(case: &Case) -> usize {
    case.solver.shear_steps.unwrap_or(SHEAR_STEPS)
}

/// The fine zone that a scaled case asks for: its own contact radius, or else the predicted one.
fn asked_zone(case: &Case, law: &Hardening<f64>) -> Zone {
    let flow_stress = |alpha| if matches!(law, Hardening::Elastic) { f64::INFINITY } else { law.flow_stress(alpha) };
    let predicted = || predicted_contact_radius(1.0, case.material.poissons_ratio, flow_stress, largest_indentation(case));
    Zone::new(case.mesh.contact_radius.unwrap_or_else(predicted), case.mesh.fine_zone)
}

/// Johnson's parameter of a contact of radius `a`, Lambda = E a/((1 - nu^2) sigma_rep R), with sigma_rep at the plastic strain 0.2 a/R (Tabor 1951); zero where
/// there is no yield.
fn johnson_parameter(law: &Hardening<f64>, nu: f64, a: f64) -> f64 {
    match law {
        Hardening::Elastic => 0.0,
        law => a / ((1.0 - nu * nu) * law.flow_stress(0.2 * a)),
    }
}

/// Share of the last step by which a press step is extrapolated, for a contact whose Johnson parameter grows to
/// `lambda`: a part, so that points that are about to touch come down but are not pushed through the plane (0.45 to
/// 0.75 need the same iterations, a third fewer than none); all of it where the contact is fully plastic, so that what
/// flows is found flowing. Without friction, at E/sigma_Y = 15,000 and h = 0.085 R, a press took 2,200 iterations and
/// 37 cuts at 0.6, and takes 170 and one.
fn press_extrapolation(lambda: f64) -> f64 {
    if lambda >= FULLY_PLASTIC { 1.0 } else { 0.6 }
}

impl Problem {
    /// Scales a case (in the user's units) and makes the mesh that it asks for.
    ///
    /// # Errors
    /// [`SimulationError::Hardening`], [`SimulationError::Mesh`].
    pub fn new(case: &Case) -> Result<Self, SimulationError> {
        Self::on(case, None)
    }

    /// The same on a mesh with this fine zone, in place of the one that the case asks for.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn on(case: &Case, zone: Option<Zone>) -> Result<Self, SimulationError> {
        let (equal_pair, bodies) = (case.opponent == Some(Opponent::Equal), case.bodies());
        let case = case.scaled();
        let nu = case.material.poissons_ratio;
        let material = case.material.constants::<f64>()?;
        let zone = zone.unwrap_or_else(|| asked_zone(&case, &material.hardening));
        let elements = case.mesh.elements_per_contact_radius;
        let lambda = johnson_parameter(&material.hardening, nu, zone.contact_radius);
        let mesh = sphere_mesh(&SphereSpec {
            contact_radius: zone.contact_radius,
            elements_per_contact_radius: elements,
            fine_zone: zone.fine_zone,
        })?;
        Ok(Self {
            resolution: Resolution { press_steps: press_steps(&case), shear_steps: shear_steps(&case) },
            settings: Settings {
                tolerance: case.solver.tolerance,
                max_iterations: case.solver.max_iterations,
                loosest_linear: loosest_linear(nu),
                first_linear: first_linear(lambda),
            },
            max_cutbacks: case.solver.max_cutbacks,
            spacing: zone.contact_radius / elements as f64,
            zone,
            press_extrapolation: press_extrapolation(lambda),
            equal_pair,
            bodies,
            model: CaseModel {
                mesh: Arc::new(mesh),
                material,
                friction: match case.contact.friction {
                    case::Friction::Coefficient(mu) => Friction::Coulomb(mu),
                    case::Friction::Stick => Friction::Stick,
                },
            },
            case,
        })
    }

    /// The fine zone that a case (in the user's units) asks for.
    ///
    /// # Errors
    /// [`SimulationError::Hardening`].
    pub fn zone_of(case: &Case) -> Result<Zone, SimulationError> {
        let case = case.scaled();
        Ok(asked_zone(&case, &case.material.constants::<f64>()?.hardening))
    }

    /// Number of displacements that are not prescribed.
    pub fn free_unknowns(&self) -> usize {
        Boundary::new(&self.model.mesh).prescribed.iter().filter(|p| !**p).count()
    }

    /// The Newton iteration for this problem.
    pub fn newton(&self) -> Result<Newton, SimulationError> {
        let mesh = &self.model.mesh;
        let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
        if self.equal_pair {
            let mirror = mirror_nodes(mesh).ok_or(SimulationError::NotMirrored)?;
            let solver = PairSolver::new(mesh, &pattern, mirror).map_err(SolverError::from)?;
            return Ok(Newton::new(mesh, solver, self.settings));
        }
        let kind = match self.case.solver.linear {
            case::Linear::Multigrid => SolverKind::Multigrid,
            case::Linear::Direct => SolverKind::Direct,
        };
        let linear = LinearSolver::new(kind, &pattern, &mesh.hierarchy).map_err(SolverError::from)?;
        Ok(Newton::new(mesh, linear, self.settings))
    }
}
