//! Newton converges quadratically where no contact status changes; the histories are held to
//! `fixtures/newton/quadratic.json`.
//!
//! A wrong tangent still finds the answer, only not quadratically: the history is what shows it.
//! `ASPERITY_BLESS=1` writes the fixture.

use crate::solver::pose::Pose;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::*;
use crate::mesh::brick;

/// Below this, rounding decides what the merit is.
const FLOOR: f64 = 1e-11;

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct History {
    name: String,
    /// Merit over the force scale after each iteration.
    merits: Vec<f64>,
    /// Order of convergence of the last three merits above the floor.
    order: f64,
}

fn history(name: &str, rig: &mut Rig, control: &Control) -> History {
    let before = rig.statuses();
    let report = rig.step(control);
    assert_eq!(rig.statuses(), before, "{name}: a status changed, so the step is not smooth");
    assert!(report.iterations.iter().all(|i| i.step_length == 1.0 && i.krylov == 0), "{name}: {report:?}");
    let mut merits: Vec<f64> = report.iterations.iter().skip(1).map(|i| i.merit).collect();
    merits.push(report.merit);
    History { name: name.into(), order: order(&merits), merits }
}

/// ln(m2/m1)/ln(m1/m0), the steepest of the triples whose first two members are above the floor.
fn order(merits: &[f64]) -> f64 {
    let of = |m: &[f64]| (m[2].max(1e-15) / m[1]).ln() / (m[1] / m[0]).ln();
    merits.windows(3).filter(|m| m[1] > FLOOR).map(of).fold(0.0, f64::max)
}

fn cube(material: Material<f64>, friction: Friction<f64>) -> Rig {
    Rig::new(brick(4, 3, 3, [1.0, 0.8, 0.6]).unwrap(), material, friction, TIGHT)
}

fn plastic() -> Material<f64> {
    Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::linear(2e-3, 0.05).unwrap() }
}

fn histories() -> Vec<History> {
    let to = |h, delta_t| Control { h, pose: Pose::along_x(delta_t), normal_force: None };
    let mut all = Vec::new();

    // Bonded: prescribed rows alone.
    let mut rig = cube(elastic(0.3), Friction::Stick);
    rig.to(0.02, 0.0);
    all.push(history("stick, press and shear", &mut rig, &to(0.05, 0.03)));

    // Every point slips along curves of its own: the friction rows are nonlinear.
    let mut rig = cube(elastic(0.3), Friction::Coulomb(0.1));
    rig.to(0.03, 0.0);
    rig.to(0.03, 0.02);
    assert!(rig.statuses().iter().all(|s| *s == Status::Slip), "{:?}", rig.statuses());
    all.push(history("slip, press and shear", &mut rig, &to(0.04, 0.04)));

    // The normal force is held: the bordered system.
    let mut rig = cube(elastic(0.3), Friction::Stick);
    rig.to(0.03, 0.0);
    let held = rig.forces().0;
    all.push(history(
        "stick, normal force held",
        &mut rig,
        &Control { h: 0.03, pose: Pose::along_x(0.04), normal_force: Some(held) },
    ));
    let mut rig = cube(elastic(0.3), Friction::Coulomb(0.1));
    rig.to(0.03, 0.0);
    rig.to(0.03, 0.02);
    let raised = 1.3 * rig.forces().0;
    all.push(history(
        "slip, normal force raised",
        &mut rig,
        &Control { h: 0.03, pose: Pose::along_x(0.04), normal_force: Some(raised) },
    ));

    // Plastic flow everywhere: the symmetrised moduli leave linear convergence at a small rate.
    let mut rig = cube(plastic(), Friction::Stick);
    rig.to(0.01, 0.0);
    all.push(history("plastic, symmetrised tangent", &mut rig, &to(0.011, 0.002)));
    all
}

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures/newton/quadratic.json")
}

#[test]
fn smooth_steps_converge_as_they_did() {
    let got = histories();
    if std::env::var_os("ASPERITY_BLESS").is_some() {
        std::fs::create_dir_all(path().parent().unwrap()).unwrap();
        std::fs::write(path(), serde_json::to_string_pretty(&got).unwrap() + "\n").unwrap();
    }
    let text = std::fs::read_to_string(path()).expect("ASPERITY_BLESS=1 writes fixtures/newton/quadratic.json");
    let expected: Vec<History> = serde_json::from_str(&text).unwrap();
    assert_eq!(got.len(), expected.len());
    for (got, expected) in got.iter().zip(&expected) {
        assert_eq!((&got.name, got.merits.len()), (&expected.name, expected.merits.len()), "{got:?}\n{expected:?}");
        for (g, e) in got.merits.iter().zip(&expected.merits).filter(|(_, e)| **e > FLOOR) {
            assert!((g / e).log10().abs() < 0.5, "{}: {g:e} where it was {e:e}", got.name);
        }
        assert!((got.order - expected.order).abs() < 0.3, "{}: order {} where it was {}", got.name, got.order, expected.order);
    }
}

#[test]
fn smooth_elastic_steps_converge_quadratically() {
    for history in histories() {
        if history.name.starts_with("plastic") {
            // Linear, but with a rate of a few per cent: no iteration more than a quadratic step to
            // the solver's usual 3e-4.
            let rates: Vec<f64> = history.merits.windows(2).filter(|m| m[1] > FLOOR).map(|m| m[1] / m[0]).collect();
            assert!(rates[1..].iter().all(|r| *r < 0.2), "{history:?}");
        } else {
            assert!(history.order > 1.7, "{history:?}");
            assert!(history.merits.len() <= 6, "{history:?}");
        }
    }
}
