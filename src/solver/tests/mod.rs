//! Whole steps on small bodies, by the direct linear solver to tight tolerances. One file a theme;
//! what they share is here.

mod block;
mod failure;
mod guesses;
mod patch;
mod quadratic;

use super::pose::Pose;
use std::sync::Arc;

use super::iterate::SetOut;
use super::newton::Newton;
use super::{Control, Settings, StepFailure, StepOutcome, StepReport};
use crate::compute::cpu::Cpu;
use crate::compute::handle::at;
use crate::compute::{CaseModel, Compute, Energies, Evaluated, Fault};
use crate::contact::coulomb::{Friction, Status};
use crate::contact::rigid::Rigid;
use crate::linalg::{LinearSolver, Pattern, SolverKind};
use crate::material::hardening::FlowStress;
use crate::material::{Elasticity, Material};
use crate::mesh::Mesh;

pub fn elastic(nu: f64) -> Material<f64> {
    Material { elasticity: Elasticity::new(1.0, nu), hardening: FlowStress::Elastic }
}

/// A body, its committed state and the iteration that moves it on.
pub struct Rig {
    pub backend: Cpu<f64>,
    pub newton: Newton,
    pub mesh: Arc<Mesh>,
    pub u: Vec<f64>,
    pub h: f64,
    pub energies: Energies,
}

pub const TIGHT: Settings = Settings {
    tolerance: 1e-12,
    max_iterations: 30,
    loosest_linear: 0.1,
    held_linear: 0.01,
    first_linear: f64::INFINITY,
    monotone_from: 2,
};

impl Rig {
    pub fn new(mesh: Mesh, material: Material<f64>, friction: Friction<f64>, settings: Settings) -> Self {
        let mesh = Arc::new(mesh);
        let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
        let linear = LinearSolver::<f64>::new(SolverKind::Direct, &pattern, &mesh.hierarchy).unwrap();
        let newton = Newton::new(&mesh, linear, settings);
        let backend = Cpu::new(vec![CaseModel {
            mesh: mesh.clone(),
            material,
            friction,
            opponent: None,
            image: None,
            surface: Rigid::default(),
        }])
        .unwrap();
        Self { backend, newton, u: vec![0.0; 3 * mesh.nodes.len()], mesh, h: 0.0, energies: Energies::default() }
    }

    /// Solves a step without committing it.
    pub fn attempt(&mut self, control: &Control) -> Result<StepReport, StepFailure> {
        match self.attempt_from(None, control) {
            StepOutcome::Converged(report) => Ok(report),
            StepOutcome::Failed(failure) => Err(failure),
        }
    }

    /// The same from a guess.
    pub fn attempt_from(&mut self, guess: Option<&[f64]>, control: &Control) -> StepOutcome {
        let mut handle = at(&mut self.backend, 0);
        let plate = self.mesh.plate_nodes.first().map_or(0, |&n| 3 * n as usize);
        let start = SetOut {
            displacement: &self.u,
            h: self.h,
            pose: Pose::along_x(self.u[plate]),
            guess,
            extrapolation: None,
            came_off: &[],
        };
        self.newton.solve(&mut handle, &start, control).unwrap()
    }

    /// Solves a step and commits it.
    pub fn step(&mut self, control: &Control) -> StepReport {
        let report = self.attempt(control).unwrap_or_else(|failure| panic!("{control:?}: {failure}"));
        self.commit();
        report
    }

    pub fn commit(&mut self) {
        let accepted = self.newton.accepted();
        let (energies, outcome) = at(&mut self.backend, 0).commit(&accepted.u).unwrap();
        assert_eq!(outcome, Evaluated::Valid);
        self.u.clone_from(&accepted.u);
        self.h = accepted.h;
        self.energies = energies;
    }

    /// Press to h, shear to delta_t, h held.
    pub fn to(&mut self, h: f64, delta_t: f64) -> StepReport {
        self.step(&Control { h, pose: Pose::along_x(delta_t), normal_force: None })
    }

    /// Normal and tangential force of the plane on the body, F_T positive against the motion of the
    /// plate along +x.
    pub fn forces(&self) -> (f64, f64) {
        let f = self.newton.contact_state(&self.mesh).0.iter().fold([0.0; 3], |s, f| [s[0] + f[0], s[1] + f[1], s[2] + f[2]]);
        (f[2], -f[0])
    }

    pub fn statuses(&self) -> Vec<Status> {
        self.newton.accepted().rows.iter().map(|r| r.status).collect()
    }

    pub fn state_bits(&mut self) -> Vec<u64> {
        let state = at(&mut self.backend, 0).state().unwrap();
        let points = state.points.iter().flatten().flat_map(|p| p.be.into_iter().chain([p.alpha]));
        state.displacement.iter().copied().chain(points).chain(state.plastic_work.iter().copied()).map(f64::to_bits).collect()
    }
}
