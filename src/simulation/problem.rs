//! From a case file to a scaled model: lengths by R, stresses by E.

use std::sync::Arc;

use super::SimulationError;
use super::path::Resolution;
use super::zone::Zone;
use crate::analytical::predicted_contact_radius;
use crate::case::{self, Case, Equator, Opponent, Scaled, Segment};
use crate::compute::CaseModel;
use crate::contact::coulomb::Friction;
use crate::contact::rigid::Rigid;
use crate::linalg::SolverKind;
use crate::material::{FlowStress, Material, MaterialError};
use crate::memory;
use crate::mesh::couple::{self, couple};
use crate::mesh::sphere::{SphereSpec, flat_mesh, opponent_mesh, sphere_mesh};
use crate::mesh::{Mesh, MeshError, whole};
use crate::solver::boundary::Boundary;
use crate::solver::newton::Newton;
use crate::solver::opponent;
use crate::solver::opponent::couple::TwoBodies;
use crate::solver::opponent::joint::Joint;
use crate::solver::opponent::pair::EqualPair;
use crate::solver::opponent::rigid::RigidBody;
use crate::solver::{FULLY_PLASTIC, Settings, SolverError, first_linear, held_linear, loosest_linear, monotone_from};

/// A case ready to be simulated.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The case.
    pub case: Scaled<Case>,
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
    /// A step of a press is guessed from all of the last one, not from a part of it, and points
    /// that come out below what they meet are left there, in three cases.
    ///
    /// - The contact becomes fully plastic: what flows has to be found flowing.
    /// - A body is nearly incompressible, `NEARLY_INCOMPRESSIBLE`: what a part leaves of the
    ///   plate's motion, and each point that is put back by itself, changes the volume of the
    ///   elements beside it. At nu = 0.49 and E/sigma_Y = 500 the residual was ten times the
    ///   normal force; the main job on 6 elements took 795 iterations and 31 cuts so, and takes
    ///   131 and none (468 and 12, 102 and none at 0.48; 133 and 103 at 0.45; at 0.4 they are
    ///   alike, and at 0.3 a part is better by a tenth).
    /// - One of two bodies is at least `UNLIKE_STIFFNESS` times as stiff as the other and Lambda at
    ///   least `UNLIKE_PLASTIC`: what a part leaves strains the sphere alone at first. A press of
    ///   `unlike.toml` takes 88, 120 and 153 iterations at 8, 12 and 16 elements, and took 95, 145
    ///   and 277 from a part, with points that had passed the other body moved back (on the plane
    ///   it takes 75, 91 and 107). Elastic bodies and bodies of one stiffness need the part: two
    ///   elastic spheres take 46 iterations at 10 elements with it, and 258 from all.
    pub pressed_in_full: bool,
    /// Of two bodies that both deform the stiffer one is the slave.
    slaves_are_exchanged: bool,
}

/// Steps of a press: so many and so many more for each element along the contact radius; the front
/// moves by a third of an element in the last ones. In the main job at 16 elements F_N(h) at the
/// end, half-way and at a quarter lacks 0.2, 0.5 and 2 % at these 26 steps (of which the steps 0.1,
/// 0.3 and 1 %). Half and twice of each: `benches/constants`.
const PRESS_STEPS: f64 = 14.0;
const PRESS_STEPS_PER_ELEMENT: f64 = 0.75;
/// Growing steps of a shear. With 15, 20, 24 and 30 `F_T_limit` is 0.62, 0.52, 0.47 and 0.42 % rms
/// off on eight contacts of `benches/limits/judge.py`, as the companion has half as many; 24 take
/// 4 % more time than 15. Half and twice of it: `benches/constants`.
const SHEAR_STEPS: usize = 24;
/// Two bodies have their linear systems solved further than one: by how much the loosest tolerance
/// is smaller, and how far the first of a step is solved (see [`first_linear`]). Else points that
/// flow in one of the bodies are thrown back, as the plate strains one of them alone at first.
/// Where a press starts from all of the last step, the first system alone: at E_2/E_1 = 3, R_2/R_1
/// = 2 and 12 elements it takes 120 iterations with 439 of Krylov so, 118 with 548 with both, and
/// 130 with 449 with none. Half and twice of either: `benches/constants`.
const COUPLE_LINEAR: f64 = 0.3;
const COUPLE_FIRST: f64 = 0.002;
/// Poisson's ratio; see [`Problem::pressed_in_full`]. Half and twice of this and of the numbers
/// below: `benches/constants`.
const NEARLY_INCOMPRESSIBLE: f64 = 0.42;
/// See [`Problem::pressed_in_full`].
const UNLIKE_STIFFNESS: f64 = 2.0;
const UNLIKE_PLASTIC: f64 = 30.0;

/// Steps of a first press: as many as the case says, or else as go with its elements along the
/// contact radius, inside and at the surface alike.
pub fn press_steps(case: &Case) -> usize {
    let elements = (case.mesh.elements_per_contact_radius as f64 * case.mesh.surface_elements() as f64).sqrt();
    case.solver.press_steps.unwrap_or_else(|| (PRESS_STEPS + PRESS_STEPS_PER_ELEMENT * elements).ceil() as usize)
}

/// Growing steps of a shear: as many as the case says, or else the default.
pub fn shear_steps(case: &Case) -> usize {
    case.solver.shear_steps.unwrap_or(SHEAR_STEPS)
}

/// The fine zone that a scaled case asks for: its own contact radius, or else the predicted one.
fn asked_zone(scaled: &Scaled<Case>, laws: &[&FlowStress<f64>]) -> Zone {
    let case = &scaled.0;
    let flow_stress = |alpha: f64| {
        laws.iter()
            .filter(|law| !matches!(law, FlowStress::Elastic))
            .map(|law| law.flow_stress(alpha))
            .fold(f64::INFINITY, f64::min)
    };
    // Of two bodies the closed forms know R*, E* and the weaker yield stress alone.
    let (r, modulus) = (case.body_radius(), 1.0 / case.compliance()[0]);
    let predicted =
        || r * predicted_contact_radius(modulus, case.material.poissons_ratio, flow_stress, case.greatest_indentation() / r);
    Zone::new(case.mesh.contact_radius.unwrap_or_else(predicted), case.mesh.fine_zone).within(smaller_radius(scaled))
}

/// Radius of the smaller of the spheres that are meshed, of a scaled case.
fn smaller_radius(Scaled(case): &Scaled<Case>) -> f64 {
    match case.opponent {
        Some(Opponent::Deforming { radius: Some(radius), .. }) => radius.min(1.0),
        _ => 1.0,
    }
}

/// The mesh that a scaled case has with a fine zone: of one body or, with another one against it,
/// of both.
fn mesh_of(Scaled(case): &Scaled<Case>, zone: &Zone) -> Result<Mesh, MeshError> {
    let spec = |radius: f64| SphereSpec {
        contact_radius: zone.contact_radius / radius,
        elements_per_contact_radius: case.mesh.elements_per_contact_radius,
        fine_zone: zone.fine_zone,
        skin_levels: case.mesh.skin_levels(),
        first_layer: case.mesh.first_layer(),
    };
    let own = if case.sphere.flat { flat_mesh(&spec(1.0))? } else { sphere_mesh(&spec(1.0))? };
    // Of what is even in y, half tells all.
    let meshed = |half: Mesh| if case.is_even() { half } else { whole(&half) };
    let own = meshed(own);
    Ok(match case.opponent {
        Some(Opponent::Deforming { radius: Some(radius), .. }) => {
            couple(own, couple::scaled(meshed(opponent_mesh(&spec(radius))?), radius))
        }
        Some(Opponent::Deforming { radius: None, .. }) => couple(own, meshed(flat_mesh(&spec(1.0))?)),
        None | Some(Opponent::Equal | Opponent::Rigid { .. }) => own,
    })
}

/// Constants of the opponent of a scaled case, if it deforms.
fn opponent_material(Scaled(case): &Scaled<Case>) -> Result<Option<Material<f64>>, MaterialError> {
    match &case.opponent {
        Some(Opponent::Deforming { material, .. }) => material.constants_as_given().map(Some),
        _ => Ok(None),
    }
}

/// The surface of a scaled case's opponent, if that does not deform.
fn rigid_surface(case: &Case) -> Rigid {
    match case.opponent {
        Some(Opponent::Rigid { radius }) => Rigid { curvature: 1.0 / radius },
        _ => Rigid::default(),
    }
}

/// The two bodies of a scaled case whose opponent deforms.
fn two_bodies(Scaled(case): &Scaled<Case>, slaves_are_exchanged: bool) -> Option<TwoBodies> {
    match &case.opponent {
        Some(Opponent::Deforming { material, radius }) => {
            Some(TwoBodies::new(material.youngs_modulus, *radius, slaves_are_exchanged))
        }
        _ => None,
    }
}

/// Johnson's parameter of a contact of radius `a`, Lambda = E a/((1 - nu^2) sigma_rep R), with
/// sigma_rep at the plastic strain 0.2 a/R (Tabor 1951); zero where there is no yield. With another
/// body E* is that of both, and the weaker one yields.
fn johnson_parameter(laws: &[&FlowStress<f64>], compliance: f64, nu: f64, a: f64) -> f64 {
    let of = |law: &&FlowStress<f64>| match law {
        FlowStress::Elastic => 0.0,
        law => a / (compliance * (1.0 - nu * nu) * law.flow_stress(0.2 * a)),
    };
    laws.iter().map(of).fold(0.0, f64::max)
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
        Self::of(case.scaled(), zone)
    }

    fn of(scaled: Scaled<Case>, zone: Option<Zone>) -> Result<Self, SimulationError> {
        let case = &scaled.0;
        let nu = case.material.poissons_ratio;
        let material = case.material.constants::<f64>()?;
        let opponent = opponent_material(&scaled)?;
        let laws: Vec<&FlowStress<f64>> = std::iter::once(&material).chain(&opponent).map(|m| &m.hardening).collect();
        let zone = zone.map_or_else(|| asked_zone(&scaled, &laws), |zone| zone.within(smaller_radius(&scaled)));
        let elements = case.mesh.surface_elements();
        let mesh = mesh_of(&scaled, &zone)?;
        memory::meshed(mesh.elements.len());
        // Of two spheres it knows R* alone.
        let lambda = johnson_parameter(&laws, case.compliance()[0], nu, zone.contact_radius / case.body_radius());
        let couple = two_bodies(&scaled, false);
        let is_unlike = couple.is_some_and(|couple| couple.series.contrast() >= UNLIKE_STIFFNESS);
        let largest_nu = match &case.opponent {
            Some(Opponent::Deforming { material, .. }) => nu.max(material.poissons_ratio),
            _ => nu,
        };
        let pressed_in_full =
            lambda >= FULLY_PLASTIC || largest_nu >= NEARLY_INCOMPRESSIBLE || is_unlike && lambda >= UNLIKE_PLASTIC;
        let further = if couple.is_some() && !pressed_in_full { COUPLE_LINEAR } else { 1.0 };
        Ok(Self {
            resolution: Resolution { press_steps: press_steps(case), shear_steps: shear_steps(case), coarseness: 1.0 },
            settings: Settings {
                tolerance: case.solver.tolerance,
                max_iterations: case.solver.max_iterations,
                loosest_linear: loosest_linear(largest_nu) * further,
                held_linear: held_linear(lambda),
                first_linear: if couple.is_some() { COUPLE_FIRST } else { first_linear(lambda) },
                monotone_from: monotone_from(lambda),
            },
            max_cutbacks: case.solver.max_cutbacks,
            spacing: zone.contact_radius / elements as f64,
            zone,
            pressed_in_full,
            slaves_are_exchanged: false,
            model: CaseModel {
                mesh: Arc::new(mesh),
                material,
                friction: match case.contact.friction {
                    case::Friction::Coefficient(mu) => Friction::Coulomb(mu),
                    case::Friction::Stick => Friction::Stick,
                },
                opponent,
                image: case.image(),
                surface: rigid_surface(case),
            },
            case: scaled,
        })
    }

    /// The same problem on a mesh with another fine zone.
    ///
    /// # Errors
    /// As [`Problem::new`].
    pub fn on_zone(&self, zone: Zone) -> Result<Self, SimulationError> {
        // The case does not say that it is a scout's, nor that slaves are exchanged.
        let mut grown = Self { resolution: self.resolution, ..Self::of(self.case.clone(), Some(zone))? };
        if self.slaves_are_exchanged {
            grown.exchange_slaves();
        }
        Ok(grown)
    }

    /// The fine zone for a contact that has left this one (see [`Zone::grown`]); `None` if
    /// none that all bodies can have is larger.
    pub fn grown_zone(&self, reach: f64, contact_radius: f64, margin: f64) -> Option<Zone> {
        let smaller = smaller_radius(&self.case);
        let zone = self.zone.grown(reach, contact_radius, margin)?.within(smaller);
        (zone.radius_within(smaller) > self.zone.radius_within(smaller) * (1.0 + 1e-9)).then_some(zone)
    }

    /// Makes the stiffer of two bodies the slave: a check on the interface, which costs iterations.
    pub fn exchange_slaves(&mut self) {
        self.slaves_are_exchanged = !self.slaves_are_exchanged;
        // The full guess needs the softer body as the slave.
        self.pressed_in_full &= self.couple().is_none();
    }

    /// Two bodies that both deform, and which of them is the slave.
    pub fn couple(&self) -> Option<TwoBodies> {
        two_bodies(&self.case, self.slaves_are_exchanged)
    }

    /// Bodies that deform (see [`Case::bodies`]): displacements of the path and the record are
    /// those of one.
    pub fn bodies(&self) -> f64 {
        self.case.0.bodies()
    }

    /// The scaled path in the mesh's axes.
    pub fn path(&self) -> Vec<Segment> {
        let case = &self.case.0;
        let orientation = case.orientation();
        case.path.iter().map(|&segment| orientation.segment_to_mesh(segment)).collect()
    }

    /// The fine zone that a case (in the user's units) asks for.
    ///
    /// # Errors
    /// [`SimulationError::Hardening`].
    pub fn zone_of(case: &Case) -> Result<Zone, SimulationError> {
        let case = case.scaled();
        let (own, opponent) = (case.0.material.constants::<f64>()?, opponent_material(&case)?);
        let laws: Vec<&FlowStress<f64>> = std::iter::once(&own).chain(&opponent).map(|m| &m.hardening).collect();
        Ok(asked_zone(&case, &laws))
    }

    /// Number of displacements that are not prescribed.
    pub fn free_unknowns(&self) -> usize {
        Boundary::new(&self.model.mesh).prescribed.iter().filter(|p| !**p).count()
    }

    /// What the body is pressed against, before any step.
    fn opponent(&self) -> Box<dyn opponent::Opponent> {
        let mesh = &self.model.mesh;
        match &self.case.0.opponent {
            None | Some(Opponent::Rigid { .. }) => Box::new(RigidBody { surface: self.model.surface }),
            Some(Opponent::Equal) => {
                let image = self.case.0.image().unwrap_or_default();
                Box::new(Joint::new(mesh, EqualPair { image }))
            }
            Some(Opponent::Deforming { material, radius }) => {
                Box::new(Joint::new(mesh, TwoBodies::new(material.youngs_modulus, *radius, self.slaves_are_exchanged)))
            }
        }
    }

    /// The Newton iteration for this problem.
    ///
    /// # Errors
    /// [`SimulationError::NotMirrored`], [`SimulationError::Solver`].
    pub fn newton(&self) -> Result<Newton, SimulationError> {
        let kind = match self.case.0.solver.linear {
            case::Linear::Multigrid => SolverKind::Multigrid,
            case::Linear::Direct => SolverKind::Direct,
        };
        let (mesh, opponent) = (&self.model.mesh, self.opponent());
        if !self.case.0.sphere.equator.is_clamped() && matches!(self.case.0.opponent, Some(Opponent::Deforming { .. })) {
            return Err(SimulationError::TwoPlates);
        }
        let systems = opponent.systems(mesh, kind).map_err(SolverError::from)?.ok_or(SimulationError::NotMirrored)?;
        let at_home = match (self.case.0.moves_along_x(), self.case.0.sphere.equator) {
            (false, _) => Some("the sphere leaves the x axis or turns, so the vectors of Newton's method stay on the host"),
            (true, Equator::Free) => Some("the equator is free, so the vectors of Newton's method stay on the host"),
            (true, Equator::Clamped) => None,
        };
        Ok(Newton::new(mesh, systems, self.settings).against(opponent).at_home(at_home))
    }
}
