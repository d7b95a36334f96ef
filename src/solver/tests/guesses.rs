//! Steps that a device has made in f32 are held to the residual in f64.

use super::*;
use crate::compute::iterate::{Ask, Corrected, Keeps, Reading, Reply, Vectors};
use crate::compute::{About, Answer, Call, ComputeError, Fault};
use crate::contact::rigid::Rigid;
use crate::mesh::{SphereSpec, sphere_mesh};
use crate::solver::pose::Pose;

const SETTINGS: Settings = Settings {
    tolerance: 1e-6,
    max_iterations: 30,
    loosest_linear: 0.1,
    held_linear: 0.01,
    first_linear: f64::INFINITY,
    monotone_from: 2,
};
const CONTROL: Control = Control { h: 4e-3, pose: Pose::along_x(0.0), normal_force: None };

/// What a device makes of a step.
#[derive(Clone)]
enum Device {
    /// It ends with this displacement; these contact points have come off on the way.
    Ends(Vec<f64>, Vec<bool>),
    /// Its tangent is invalid.
    ComesToNothing,
    /// What it reads is not a number.
    ReadsNaN,
    /// It is lost, and the state is not.
    Lost,
}

/// Such a device, and the CPU for everything else.
struct Guesser {
    cpu: Cpu<f64, f32>,
    device: Device,
}

impl Compute for Guesser {
    fn models(&self) -> &[CaseModel] {
        self.cpu.models()
    }

    fn about(&self) -> About {
        About { keeps: Keeps::Guesses, ..self.cpu.about() }
    }

    fn call(&mut self, mut calls: Vec<(usize, Call)>) -> Result<Vec<Answer>, ComputeError> {
        match calls.pop() {
            Some((_, Call::Iterate(request))) => Ok(vec![Answer::Iterate(self.iterate(request.ask)?)]),
            call => self.cpu.call(call.into_iter().collect()),
        }
    }
}

impl Guesser {
    fn iterate(&self, ask: Ask) -> Result<Reply, ComputeError> {
        let reading = |merit: f64| Reply::Reading(Reading { merit, ..Reading::default() });
        Ok(match (&self.device, ask) {
            (Device::Lost, _) => return Err(ComputeError::Moved),
            (Device::Ends(..), Ask::Begin(_)) => reading(0.0),
            (Device::Ends(displacement, came_off), Ask::Bring) => Reply::Vectors(Box::new(Vectors {
                displacement: displacement.clone(),
                force: vec![0.0; displacement.len()],
                sliding: vec![false; came_off.len()],
                came_off: came_off.clone(),
            })),
            (Device::ReadsNaN, Ask::Begin(_)) => reading(f64::NAN),
            (Device::ReadsNaN, Ask::Bring) => {
                let (nodes, points) = (self.models()[0].mesh.nodes.len(), self.models()[0].mesh.contact_nodes.len());
                let forces = vec![f64::NAN; 3 * nodes];
                let marks = vec![false; points];
                Reply::Vectors(Box::new(Vectors {
                    displacement: vec![0.0; 3 * nodes],
                    force: forces,
                    sliding: marks.clone(),
                    came_off: marks,
                }))
            }
            (Device::ComesToNothing, Ask::Begin(_)) => reading(1.0),
            (Device::ComesToNothing, Ask::Correct(_)) => {
                let tangent = Evaluated::Invalid(Fault::Inverted { element: 3, point: 1 });
                Reply::Corrected(Corrected { tangent, ..Corrected::default() })
            }
            (_, other) => panic!("{other:?}"),
        })
    }
}

fn model(friction: Friction<f64>) -> CaseModel {
    let spec =
        SphereSpec { contact_radius: 0.08, elements_per_contact_radius: 3, fine_zone: 1.3, skin_levels: 0, first_layer: 1.0 };
    let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::ideal(2e-3).unwrap() };
    CaseModel {
        mesh: Arc::new(sphere_mesh(&spec).unwrap()),
        material,
        friction,
        opponent: None,
        image: None,
        surface: Rigid::default(),
    }
}

fn newton(mesh: &Mesh) -> Newton {
    let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    Newton::new(mesh, LinearSolver::<f32>::new(SolverKind::Multigrid, &pattern, &mesh.hierarchy).unwrap(), SETTINGS)
}

/// A step that was made.
struct Made {
    report: StepReport,
    u: Vec<f64>,
    given_up: usize,
    statuses: Vec<Status>,
    sliding: Vec<bool>,
}

/// The step on the CPU alone, or after a device.
fn solved(friction: Friction<f64>, device: Option<Device>) -> Made {
    let model = model(friction);
    let zero = vec![0.0; 3 * model.mesh.nodes.len()];
    let start = SetOut { displacement: &zero, h: 0.0, pose: Pose::along_x(0.0), guess: None, extrapolation: None, came_off: &[] };
    let mut newton = newton(&model.mesh);
    let mut cpu = Cpu::<f64, f32>::with_tangents(vec![model]).unwrap();
    let outcome = match device {
        None => newton.solve(&mut at(&mut cpu, 0), &start, &CONTROL),
        Some(device) => newton.solve(&mut at(&mut Guesser { cpu, device }, 0), &start, &CONTROL),
    };
    let StepOutcome::Converged(report) = outcome.unwrap() else { panic!("no convergence") };
    let given_up = newton.take_given_up();
    let (u, statuses) = (newton.accepted().u.clone(), newton.accepted().rows.iter().map(|row| row.status).collect());
    Made { report, u, given_up, statuses, sliding: newton.sliding().to_vec() }
}

fn coulomb(device: Option<Device>) -> Made {
    solved(Friction::Coulomb(0.3), device)
}

fn ends(u: &[f64], alone: &Made) -> Option<Device> {
    Some(Device::Ends(u.to_vec(), vec![false; alone.statuses.len()]))
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

#[test]
fn what_the_device_ends_with_is_taken_where_the_residual_bears_it_out() {
    let alone = coulomb(None);
    assert!(alone.report.confirming.is_none() && alone.report.iterations.len() > 2);
    let made = coulomb(ends(&alone.u, &alone));
    assert_eq!((made.report.confirming, made.report.iterations.len(), made.given_up), (Some(0), 0, 0));
    assert_eq!(made.u, alone.u);
}

#[test]
fn what_the_device_ends_with_is_gone_on_from_where_it_is_no_equilibrium() {
    let alone = coulomb(None);
    let off: Vec<f64> = alone.u.iter().enumerate().map(|(i, u)| u + 1e-5 * (i as f64).sin()).collect();
    let made = coulomb(ends(&off, &alone));
    let (more, report) = (made.report.confirming.unwrap(), &made.report);
    assert!(more > 0 && more <= alone.report.iterations.len() && report.iterations.len() == more, "{report:?}");
    assert_eq!((made.given_up, report.effort()), (0, more));
    let left = largest_difference(&made.u, &alone.u);
    assert!(left < 1e-3 * largest_difference(&off, &alone.u), "{left:e}");
}

#[test]
fn a_step_that_comes_to_nothing_in_f32_or_loses_its_device_is_made_in_f64() {
    let alone = coulomb(None);
    for (device, given_up) in [(Device::ComesToNothing, 1), (Device::ReadsNaN, 1), (Device::Lost, 0)] {
        let made = coulomb(Some(device));
        assert_eq!((made.given_up, made.report.confirming), (given_up, Some(alone.report.iterations.len())));
        assert_eq!(made.u, alone.u);
    }
}

/// As on the CPU, where a point that came off has let go of its tangential force.
#[test]
fn under_full_stick_a_point_that_came_off_in_f32_and_is_down_in_f64_slides() {
    let alone = solved(Friction::Stick, None);
    let down = alone.statuses.iter().position(|status| *status == Status::Stick).unwrap();
    let mut came_off = vec![false; alone.statuses.len()];
    came_off[down] = true;
    let made = solved(Friction::Stick, Some(Device::Ends(alone.u.clone(), came_off.clone())));
    assert_eq!((made.report.landed_again, made.sliding), (1, came_off));
}
