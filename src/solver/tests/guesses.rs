//! Steps that a device has made in f32 are held to the residual in f64.

use super::*;
use crate::compute::iterate::{Answer, Ask, Corrected, Keeps, Plate, Reading, Vectors};
use crate::compute::linear::LinearRequest;
use crate::compute::{Blocks, ComputeError};
use crate::contact::coulomb::Rows;
use crate::mesh::{SphereSpec, sphere_mesh};

const SETTINGS: Settings =
    Settings { tolerance: 1e-6, max_iterations: 30, loosest_linear: 0.1, first_linear: f64::INFINITY, monotone_from: 2 };
const CONTROL: Control = Control { h: 4e-3, delta_t: 0.0, normal_force: None };

/// A device that says that this displacement is the step's end, or that its tangent is invalid.
struct Guesser<'a> {
    cpu: CaseHandle<'a>,
    end: Option<Vec<f64>>,
}

impl Evaluate for Guesser<'_> {
    fn model(&self) -> &CaseModel {
        self.cpu.model()
    }

    fn internal_force(&mut self, displacement: &[f64], force: &mut [f64]) -> Result<Outcome, ComputeError> {
        self.cpu.internal_force(displacement, force)
    }

    fn tangent(&mut self, displacement: &[f64], blocks: Blocks<'_>) -> Result<Outcome, ComputeError> {
        self.cpu.tangent(displacement, blocks)
    }

    fn contact(&mut self, displacement: &[f64], force: &[f64], rows: &mut [Rows<f64>]) -> Result<(), ComputeError> {
        self.cpu.contact(displacement, force, rows)
    }

    fn trial(&mut self, displacement: &[f64], force: &mut [f64], rows: &mut [Rows<f64>]) -> Result<Outcome, ComputeError> {
        self.cpu.trial(displacement, force, rows)
    }

    fn linear(&mut self, request: &mut LinearRequest<'_>) -> Result<(), ComputeError> {
        self.cpu.linear(request)
    }

    fn keeps(&self) -> Keeps {
        Keeps::Guesses
    }

    fn iterate(&mut self, _kept: bool, _plate: Plate, ask: Ask) -> Result<Answer, ComputeError> {
        let merit = if self.end.is_some() { 0.0 } else { 1.0 };
        Ok(match ask {
            Ask::Begin(_) => Answer::Reading(Reading { merit, ..Reading::default() }),
            Ask::Correct(_) => {
                let tangent = Outcome::Inverted { element: 3, point: 1 };
                Answer::Corrected(Corrected { tangent, ..Corrected::default() })
            }
            Ask::Bring => Answer::Vectors(Box::new(Vectors {
                displacement: self.end.clone().unwrap(),
                force: vec![0.0; 3 * self.cpu.model().mesh.nodes.len()],
                sliding: vec![false; self.cpu.model().mesh.contact_nodes.len()],
            })),
            other => panic!("{other:?}"),
        })
    }

    fn commit(&mut self, displacement: &[f64]) -> Result<(Energies, Outcome), ComputeError> {
        self.cpu.commit(displacement)
    }
}

fn model() -> CaseModel {
    let spec = SphereSpec { contact_radius: 0.08, elements_per_contact_radius: 3, fine_zone: 1.3 };
    let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening: Hardening::ideal(2e-3).unwrap() };
    CaseModel { mesh: Arc::new(sphere_mesh(&spec).unwrap()), material, friction: Friction::Coulomb(0.3), opponent: None }
}

fn newton(mesh: &Mesh) -> Newton {
    let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    Newton::new(mesh, LinearSolver::<f32>::new(SolverKind::Multigrid, &pattern, &mesh.hierarchy).unwrap(), SETTINGS)
}

/// The step on the CPU alone, or after a device that ends it at `end` or nowhere.
fn solved(device: Option<Option<Vec<f64>>>) -> (StepReport, Vec<f64>) {
    let model = model();
    let zero = vec![0.0; 3 * model.mesh.nodes.len()];
    let start = SetOut { displacement: &zero, h: 0.0, delta_t: 0.0, guess: None, extrapolation: None };
    let mut newton = newton(&model.mesh);
    let mut cpu = Cpu::<f64, f32>::with_tangents(vec![model]).unwrap();
    let mut cpu = CaseHandle { backend: &mut cpu, case: 0 };
    let outcome = match device {
        None => newton.solve(&mut cpu, &start, &CONTROL),
        Some(end) => newton.solve(&mut Guesser { cpu, end }, &start, &CONTROL),
    };
    let StepOutcome::Converged(report) = outcome.unwrap() else { panic!("no convergence") };
    (report, newton.accepted().u.clone())
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |m, (a, b)| m.max((a - b).abs()))
}

#[test]
fn what_the_device_ends_with_is_taken_where_the_residual_bears_it_out() {
    let (alone, u) = solved(None);
    assert!(alone.confirming.is_none() && alone.iterations.len() > 2);
    let (report, same) = solved(Some(Some(u.clone())));
    assert_eq!((report.confirming, report.iterations.len(), report.given_up), (Some(0), 0, 0));
    assert_eq!(same, u);
}

#[test]
fn what_the_device_ends_with_is_gone_on_from_where_it_is_no_equilibrium() {
    let (alone, u) = solved(None);
    let off: Vec<f64> = u.iter().enumerate().map(|(i, u)| u + 1e-5 * (i as f64).sin()).collect();
    let (report, found) = solved(Some(Some(off.clone())));
    let more = report.confirming.unwrap();
    assert!(more > 0 && more <= alone.iterations.len() && report.iterations.len() == more, "{report:?}");
    assert_eq!(report.given_up, 0);
    assert!(largest_difference(&found, &u) < 1e-3 * largest_difference(&off, &u), "{:e}", largest_difference(&found, &u));
}

#[test]
fn a_step_that_comes_to_nothing_in_f32_is_made_in_f64() {
    let (alone, u) = solved(None);
    let (report, found) = solved(Some(None));
    assert_eq!((report.given_up, report.confirming), (1, Some(alone.iterations.len())));
    assert_eq!(found, u);
}
