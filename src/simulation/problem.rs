//! From a case file to a scaled model: lengths by R, stresses by E.

use std::sync::Arc;

use super::SimulationError;
use super::path::Resolution;
use super::zone::Zone;
use crate::analytical::predicted_contact_radius;
use crate::case::{self, Case, Opponent, Segment};
use crate::compute::CaseModel;
use crate::contact::coulomb::Friction;
use crate::contact::rigid::Rigid;
use crate::linalg::{LinearSolver, SolverKind};
use crate::material::hardening::Hardening;
use crate::mesh::pattern::Pattern;
use crate::mesh::sphere::{SphereSpec, flat_mesh, sphere_mesh};
use crate::solver::newton::Newton;
use crate::solver::pair::{PairSolver, mirror_nodes};
use crate::solver::system::Boundary;
use crate::solver::{FULLY_PLASTIC, Settings, SolverError, first_linear, loosest_linear, monotone_from};

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
    /// The contact becomes fully plastic: what flows has to be found flowing.
    pub fully_plastic: bool,
    /// The body is pressed against its own image (see [`crate::contact::pair`]), not against a
    /// plane.
    pub equal_pair: bool,
    /// What the body is pressed against, if it is no plane nor its image.
    pub rigid: Option<Rigid>,
    /// Bodies that deform, see [`Case::bodies`]: displacements of the path and the record are those
    /// of one.
    pub bodies: f64,
}

/// Steps of a press: so many and so many more for each element along the contact radius; the front
/// moves by a third of an element in the last ones. In the main job at 16 elements F_N(h) at the
/// end, half-way and at a quarter lacks 0.2, 0.5 and 2 % at these 26 steps (of which the steps 0.1,
/// 0.3 and 1 %).
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

/// Steps of a first press: as many as the case says, or else as go with its elements along the
/// contact radius.
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
    // Of two spheres the closed forms know R* alone.
    let r = case.effective_radius();
    let predicted =
        || r * predicted_contact_radius(1.0, case.material.poissons_ratio, flow_stress, largest_indentation(case) / r);
    Zone::new(case.mesh.contact_radius.unwrap_or_else(predicted), case.mesh.fine_zone)
}

/// Johnson's parameter of a contact of radius `a`, Lambda = E a/((1 - nu^2) sigma_rep R), with
/// sigma_rep at the plastic strain 0.2 a/R (Tabor 1951); zero where there is no yield.
fn johnson_parameter(law: &Hardening<f64>, nu: f64, a: f64) -> f64 {
    match law {
        Hardening::Elastic => 0.0,
        law => a / ((1.0 - nu * nu) * law.flow_stress(0.2 * a)),
    }
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
        let rigid = match case.opponent {
            Some(Opponent::Rigid { radius }) => Some(Rigid { curvature: 1.0 / radius }),
            None | Some(Opponent::Equal) => None,
        };
        let nu = case.material.poissons_ratio;
        let material = case.material.constants::<f64>()?;
        let zone = zone.unwrap_or_else(|| asked_zone(&case, &material.hardening));
        let elements = case.mesh.elements_per_contact_radius;
        let spec =
            SphereSpec { contact_radius: zone.contact_radius, elements_per_contact_radius: elements, fine_zone: zone.fine_zone };
        let mesh = if case.sphere.flat { flat_mesh(&spec)? } else { sphere_mesh(&spec)? };
        // Of two spheres it knows R* alone.
        let lambda = johnson_parameter(&material.hardening, nu, zone.contact_radius / case.effective_radius());
        Ok(Self {
            resolution: Resolution { press_steps: press_steps(&case), shear_steps: shear_steps(&case), coarseness: 1.0 },
            settings: Settings {
                tolerance: case.solver.tolerance,
                max_iterations: case.solver.max_iterations,
                loosest_linear: loosest_linear(nu),
                first_linear: first_linear(lambda),
                monotone_from: monotone_from(lambda),
            },
            max_cutbacks: case.solver.max_cutbacks,
            spacing: zone.contact_radius / elements as f64,
            zone,
            fully_plastic: lambda >= FULLY_PLASTIC,
            equal_pair,
            rigid,
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

    /// The same problem on a mesh with another fine zone.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn on_zone(&self, zone: Zone) -> Result<Self, SimulationError> {
        // The scaled case is that of one body: it does not say that there are two, nor that it is a
        // scout's.
        let Self { equal_pair, bodies, resolution, .. } = *self;
        Ok(Self { equal_pair, bodies, resolution, ..Self::on(&self.case, Some(zone))? })
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
        let newton = Newton::new(mesh, linear, self.settings);
        Ok(match self.rigid {
            Some(rigid) => newton.against(rigid),
            None => newton,
        })
    }
}
