//! A run that is stopped and goes on is the run that never stopped, bit for bit.

use super::SimulationError;
use super::checkpoint::Snapshot;
use super::drive::{Drive, Ending, Observer, StepView};
use super::error::ObserverError;
use super::problem::Problem;
use super::record::StepRecord;
use crate::case::{Case, Hold, Opponent, Segment, ShearTarget};
use crate::compute::cpu::Cpu;
use crate::compute::handle::at;
use crate::compute::wrong::{Kind, REFUSAL, Wrong};
use crate::compute::{CaseState, ComputeError};
use crate::real::Real;

/// Every kind of segment, there and back.
fn problem(friction: &str, solver: &str) -> Problem {
    // Full stick never slips fully.
    let end = if friction == "\"stick\"" { "0.001" } else { "\"full-slip\"" };
    let text = format!(
        "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\nlaw = \"linear\"\nyield_stress = 400.0\n\
         modulus = 2000.0\n[contact]\nfriction = {friction}\n[mesh]\nelements_per_contact_radius = 4\nfine_zone = 1.5\n[solver]\npress_steps = 4\n\
         shear_steps = 4\n{solver}\n[[path]]\nindentation = 0.015\n[[path]]\nshear = 0.001\nhold = \"normal-force\"\n[[path]]\nshear = -0.0003\n[[path]]\n\
         indentation = 0.014\n[[path]]\nshear = {end}\n[[path]]\nindentation = 0.016\n[[path]]\nindentation = 0.017\nshear = 0.0\n[[path]]\nrelease = 0.6\n[[path]]\nindentation = 0.0165\nshear = -0.0005\n[[path]]\nrelease = true\n"
    );
    let mut problem = Problem::new(&Case::parse(&text, "case.toml", &[]).unwrap()).unwrap();
    // A case file may not ask for more of what does not touch.
    let shear = Segment::Shear { shear: ShearTarget::Displacement(0.002), hold: Hold::Indentation };
    problem.case.0.path.extend([Segment::Release { share: 0.0 }, shear]);
    problem
}

/// What a run shows. It stops after so many attempts, and takes a snapshot then.
#[derive(Clone, Debug, Default, PartialEq)]
struct Seen {
    rows: Vec<StepRecord>,
    ends: Vec<usize>,
    notes: Vec<String>,
    attempts: std::cell::Cell<usize>,
    stop_after: Option<usize>,
    snapshot: Option<Snapshot>,
}

impl Observer for Seen {
    fn step(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.rows.push(view.record.0);
        Ok(())
    }
    fn segment_end(&mut self, view: &mut StepView<'_>) -> Result<(), ObserverError> {
        self.ends.push(view.record.0.step);
        Ok(())
    }
    fn note(&mut self, text: &str) {
        self.notes.push(text.to_owned());
    }
    fn stop_requested(&self) -> bool {
        self.attempts.set(self.attempts.get() + 1);
        self.stop_after.is_some_and(|most| self.attempts.get() > most)
    }
    fn checkpoint(&mut self, last: bool, take: &mut dyn FnMut() -> Result<Snapshot, ComputeError>) {
        if last {
            self.snapshot = Some(take().unwrap());
        }
    }
}

/// Follows the path from a snapshot on, or from the beginning, with everything made anew; returns
/// the last committed state too.
fn follow<R: Real>(problem: &Problem, from: Option<Snapshot>, seen: &mut Seen) -> (Ending, CaseState) {
    let mut backend = Cpu::<R>::new(vec![problem.model.clone()]).unwrap();
    let mut drive = Drive::new(problem, &mut backend, 0, problem.newton().unwrap());
    if let Some(snapshot) = from {
        drive.resume(snapshot).unwrap();
    }
    let ending = drive.run(seen).unwrap();
    (ending, at(&mut backend, 0).state().unwrap())
}

/// The run in one go, and stopped after every attempt at a step: both show the same.
fn stop_and_go<R: Real>(problem: &Problem) -> Seen {
    let mut whole = Seen::default();
    let (ending, state) = follow::<R>(problem, None, &mut whole);
    let mut pieces = Seen { stop_after: Some(1), ..Seen::default() };
    let mut from = None;
    let last = loop {
        pieces.attempts.set(0);
        let ends = pieces.ends.len();
        let (ending, state) = follow::<R>(problem, from.take(), &mut pieces);
        if ending != Ending::Interrupted {
            break (ending, state);
        }
        // That of the interruption is none.
        assert!(pieces.ends.len() > ends);
        pieces.ends.pop();
        let bytes = postcard::to_stdvec(&pieces.snapshot.take().unwrap()).unwrap();
        from = Some(postcard::from_bytes(&bytes).unwrap());
    };
    assert_eq!(last, (ending, state));
    assert_eq!(pieces.rows, whole.rows);
    assert_eq!((&pieces.ends, &pieces.notes), (&whole.ends, &whole.notes));
    whole
}

#[test]
fn a_run_that_stops_after_every_attempt_is_the_run_that_never_stops() {
    // So few iterations that steps are bisected, some of them twice.
    let seen = stop_and_go::<f64>(&problem("0.3", "max_iterations = 4"));
    assert_eq!(seen.ends.len(), 12);
    let cutbacks: usize = seen.rows.iter().map(|row| row.cutbacks).sum();
    assert!(cutbacks > 3, "{cutbacks}");
    assert!(seen.notes.iter().any(|note| note.starts_with("release: nothing touches")), "{:?}", seen.notes);
    assert!(seen.notes.iter().any(|note| note.starts_with("shear: nothing touches")), "{:?}", seen.notes);
}

#[test]
fn so_it_is_in_single_precision_with_full_stick_and_with_the_direct_solver() {
    for (friction, solver, single) in [("\"stick\"", "", true), ("0.1", "linear = \"direct\"", false)] {
        let mut problem = problem(friction, solver);
        problem.case.0.path.truncate(3);
        if single {
            stop_and_go::<f32>(&problem)
        } else {
            stop_and_go::<f64>(&problem)
        };
    }
}

#[test]
fn so_it_is_between_equal_spheres() {
    let mut problem = problem("0.3", "");
    problem.case.0.path.truncate(3);
    problem.case.0.opponent = Some(Opponent::Equal);
    stop_and_go::<f64>(&problem);
}

#[test]
fn so_it_is_against_a_rigid_sphere() {
    let mut problem = problem("0.3", "");
    problem.case.0.path.truncate(3);
    problem.case.0.opponent = Some(Opponent::Rigid { radius: 1.0 });
    stop_and_go::<f64>(&problem);
}

#[test]
fn so_it_is_where_the_plate_turns() {
    let mut problem = problem("0.3", "");
    let text = "[[path]]\nindentation = 0.01\n[[path]]\nshear = [0.001, 0.001]\ntwist = 0.01\n[[path]]\nroll = [0.003, -0.004]\n\
                hold = \"normal-force\"\n[[path]]\nindentation = 0.011\ntwist = 0.0\n[[path]]\nshear = \"full-slip\"\n\
                shear_direction = 130.0\n[[path]]\nrelease = true\n";
    let head = problem.case.0.to_toml().split("[[path]]").next().unwrap_or_default().to_owned();
    problem = Problem::new(&Case::parse(&(head + text), "case.toml", &[]).unwrap()).unwrap();
    stop_and_go::<f64>(&problem);
}

#[test]
fn so_it_is_between_two_bodies() {
    let text = include_str!("../../fixtures/cases/unlike.toml");
    let sets = [
        "mesh.elements_per_contact_radius=4",
        "solver.press_steps=5",
        "solver.shear_steps=4",
        "solver.max_iterations=8",
        "path=[{indentation=0.01},{shear=0.001},{release=true}]",
    ];
    let case = Case::parse(text, "case.toml", &sets.map(str::to_owned)).unwrap();
    let seen = stop_and_go::<f64>(&Problem::new(&case).unwrap());
    assert_eq!(seen.ends.len(), 3);
}

#[test]
fn on_a_larger_zone_the_opponent_is_the_same() {
    let text = include_str!("../../fixtures/cases/ideal.toml");
    for opponent in ["opponent.equal=true", "opponent={rigid=true,radius=2.0}", "opponent.radius=2.0"] {
        let sets = ["mesh.elements_per_contact_radius=4".to_owned(), opponent.to_owned()];
        let case = Case::parse(text, "case.toml", &sets).unwrap();
        let mut problem = Problem::new(&case).unwrap();
        problem.exchange_slaves();
        let zone = problem.zone.grown(1.2 * problem.zone.radius(), 0.0, 1.0).unwrap();
        let grown = problem.on_zone(zone).unwrap();
        assert_eq!((grown.bodies(), &grown.case, grown.zone), (case.bodies(), &problem.case, zone));
        assert_eq!((grown.couple(), &grown.model.opponent), (problem.couple(), &problem.model.opponent));
        assert_eq!(grown.pressed_in_full, problem.pressed_in_full);
        let opponent = grown.case.0.opponent.as_ref();
        let slave = grown.couple().map(|bodies| bodies.slave);
        assert!(matches!(
            (opponent, slave),
            (Some(Opponent::Equal | Opponent::Rigid { .. }), None) | (Some(Opponent::Deforming { .. }), Some(1))
        ));
    }
}

#[test]
fn a_run_that_ends_early_ends_so_again() {
    let mut narrow = problem("0.3", "");
    narrow.case.0.path.truncate(1);
    narrow.case.0.path.push(Segment::Indentation { indentation: 0.08 });
    let mut seen = Seen::default();
    assert!(matches!(follow::<f64>(&narrow, None, &mut seen).0, Ending::Outgrown(_)), "{seen:?}");
    stop_and_go::<f64>(&narrow);
    let stubborn = problem("0.3", "max_iterations = 2\nmax_cutbacks = 1");
    let mut seen = Seen::default();
    assert!(matches!(follow::<f64>(&stubborn, None, &mut seen).0, Ending::NotConverged(_)), "{seen:?}");
    stop_and_go::<f64>(&stubborn);
}

#[test]
fn a_snapshot_of_another_mesh_is_refused() {
    let coarse = problem("0.3", "");
    let mut seen = Seen { stop_after: Some(1), ..Seen::default() };
    follow::<f64>(&coarse, None, &mut seen);
    let mut other = coarse.case.0.clone();
    other.mesh.elements_per_contact_radius = 5;
    let other = Problem::new(&other).unwrap();
    let mut backend = Cpu::<f64>::new(vec![other.model.clone()]).unwrap();
    let refused = Drive::new(&other, &mut backend, 0, other.newton().unwrap()).resume(seen.snapshot.unwrap()).unwrap_err();
    assert!(matches!(refused, SimulationError::Snapshot { .. }), "{refused}");
    assert!(refused.to_string().contains("displacements where the mesh has"), "{refused}");
}

/// Follows the path on a backend that computes wrongly after so many steps.
fn wrongly(kind: Kind, steps: usize, friction: &str) -> (Result<Ending, SimulationError>, Seen) {
    let problem = problem(friction, "max_cutbacks = 2");
    let cpu = Cpu::<f64, f32>::with_tangents(vec![problem.model.clone()]).unwrap();
    let mut backend = Wrong::new(cpu, kind, steps);
    let mut seen = Seen::default();
    (Drive::new(&problem, &mut backend, 0, problem.newton().unwrap()).run(&mut seen), seen)
}

#[test]
fn what_is_not_a_number_ends_the_run_and_is_called_what_it_is() {
    let refused = REFUSAL.to_string();
    let not_finite = "the residual is not finite at node ";
    for friction in ["0.3", "0.0", "\"stick\""] {
        // Where nothing touches yet, in the press, and in the shear at a held force.
        for steps in [0, 3, 6] {
            for (kind, what, remedy) in [
                (Kind::Force, not_finite, "--device cpu"),
                (Kind::NormalForce, not_finite, "--device cpu"),
                (Kind::TangentialForce, not_finite, "--device cpu"),
                (Kind::Contact, not_finite, "--device cpu"),
                (Kind::Tangent, "the matrix has a number that is not finite in the row of node ", "A finer mesh"),
                (Kind::Material, &refused, "--device cpu"),
                (Kind::Commit, &refused, "--device cpu"),
            ] {
                // Under full stick, the host states the conditions of points that come down in a
                // step.
                let is_seen = kind != Kind::Contact || steps > 0 || friction != "\"stick\"";
                let (ending, seen) = wrongly(kind, steps, friction);
                let context = format!("{kind:?} after {steps} steps at friction {friction}: {ending:?}");
                let Ok(Ending::NotConverged(reason)) = ending else { panic!("{context}") };
                assert!(if is_seen { seen.rows.len() == 1 + steps } else { seen.rows.len() > 1 }, "{context}");
                assert!(reason.contains(what) && reason.contains(remedy) && !reason.contains("inverts"), "{context}");
                assert!(reason.contains("the step was bisected 2 times"), "{context}");
            }
        }
    }
}

#[test]
fn a_result_that_is_not_a_number_is_none() {
    let (ending, seen) = wrongly(Kind::Energy, 3, "0.3");
    let error = ending.expect_err("there is no energy").to_string();
    assert!(error.starts_with("energy_elastic of step 4 is NaN"), "{error}");
    // The wrong call is the fourth commit's.
    assert_eq!(seen.rows.len(), 4);
}
