//! Two equal spheres: the press of one over a frictionless plane, the same forwards and back,
//! energies that balance.

mod paths;

use asperity::case::Case;
use asperity::output::{ContactPoint, ContactStatus, StepRecord};
use paths::Steps;
use rayon::prelude::*;

/// Follows the path of a case file of `fixtures/cases` with these settings.
fn follow(text: &str, settings: &[&str]) -> Steps {
    let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    let case = Case::parse(text, "case.toml", &settings).expect("a case");
    paths::follow(&case)
}

const PLANE: &str = include_str!("../fixtures/cases/ideal.toml");
const PAIR: &str = include_str!("../fixtures/cases/equal.toml");
const COARSE: &str = "mesh.elements_per_contact_radius=4";

#[test]
fn the_press_is_that_of_one_sphere_over_a_frictionless_plane_whatever_the_friction() {
    let exact = "solver.tolerance=1e-8";
    let plane = follow(PLANE, &[COARSE, exact, "contact.friction=0.0", "path=[{indentation=0.02}]"]);
    for friction in ["0.0", "0.5", "\"stick\""] {
        let friction = format!("contact.friction={friction}");
        let pair = follow(PAIR, &[COARSE, exact, &friction, "path=[{indentation=0.04}]"]);
        assert_eq!(pair.len(), plane.len());
        let total = plane.last().map_or(0.0, |(row, _)| row.work_plastic);
        for ((pair, _), (plane, _)) in pair.iter().zip(&plane).skip(1) {
            assert!((pair.h / plane.h - 2.0).abs() < 1e-12);
            assert!((pair.f_n / plane.f_n - 1.0).abs() < 1e-6, "{friction}, h = {}: {} and {}", pair.h, pair.f_n, plane.f_n);
            assert!((pair.a / plane.a - 1.0).abs() < 1e-6, "{friction}, h = {}: {} and {}", pair.h, pair.a, plane.a);
            // Two bodies, each with the energies of one.
            assert!((pair.work_plastic - 2.0 * plane.work_plastic).abs() < 1e-5 * total);
            assert!(pair.f_t.abs() < 1e-6 * pair.f_n && pair.work_friction.abs() < 1e-9);
        }
    }
}

#[test]
fn forwards_and_back_are_the_same() {
    // Slaves and masters change places: what carries the force is then the other half of the
    // surface.
    let both: Vec<Steps> = ["0.012", "-0.012"]
        .into_par_iter()
        .map(|shear| follow(PAIR, &[COARSE, "solver.tolerance=1e-5", &format!("path=[{{indentation=0.04}},{{shear={shear}}}]")]))
        .collect();
    assert_eq!(both[0].len(), both[1].len());
    for ((forwards, _), (back, _)) in both[0].iter().zip(&both[1]) {
        assert!((forwards.f_n - back.f_n).abs() <= 2e-3 * forwards.f_n, "{} and {}", forwards.f_n, back.f_n);
        assert!((forwards.f_t + back.f_t).abs() <= 2e-3 * forwards.f_n, "{} and {}", forwards.f_t, back.f_t);
    }
}

/// The plane between them tilts, and the normal force on it has a share along x.
#[test]
fn without_friction_nothing_is_dissipated_however_far_they_pass() {
    let (mesh, path) = ("mesh.contact_radius=0.1", "path=[{indentation=0.008},{shear=0.08}]");
    let steps = follow(PAIR, &[COARSE, mesh, "contact.friction=0.0", "material.hardening={law=\"elastic\"}", path]);
    let stored = steps.iter().fold(0.0, |most: f64, (row, _)| most.max(row.energy_elastic));
    let (last, _) = steps.last().expect("steps");
    eprintln!("F_T/F_N {}, friction {:e} of {stored:e}", last.f_t / last.f_n, last.work_friction);
    assert!(last.f_t < -0.02 * last.f_n, "{} and {}", last.f_t, last.f_n);
    assert!(last.work_friction.abs() < 0.03 * stored, "{:e} of {stored:e}", last.work_friction);
    let left = last.work_external - last.energy_elastic - last.work_friction;
    assert!(left.abs() < 0.03 * stored, "{left:e} of {stored:e}");
}

#[test]
fn the_contact_carries_the_force_and_the_energies_balance() {
    let paths = [
        (PAIR, vec![COARSE]),
        (PAIR, vec![COARSE, "material.hardening={law=\"linear\",yield_stress=300.0,modulus=5000.0}", "contact.friction=0.6"]),
        (PAIR, vec![COARSE, "path=[{indentation=0.02},{shear=0.001},{shear=-0.001},{release=true}]"]),
        (PAIR, vec![COARSE, "path=[{indentation=0.02},{shear=0.004,hold=\"normal-force\"}]"]),
    ];
    paths.into_par_iter().for_each(|(text, settings)| {
        let steps = follow(text, &settings);
        for (row, points) in &steps {
            let at = format!("{settings:?}, step {}", row.step);
            let sum = |f: &dyn Fn(&ContactPoint) -> f64| points.iter().map(f).sum::<f64>();
            let [f_n, f_t] = [sum(&|p| p.pressure * p.area), -sum(&|p| p.traction_x * p.area)];
            let scale = row.f_n.max(1e-3);
            assert!((f_n - row.f_n).abs() < 1e-9 * scale && (f_t - row.f_t).abs() < 1e-9 * scale, "{at}: {f_n}, {f_t}, {row:?}");
            // Nothing is pulled, and nothing has passed the other body.
            assert!(points.iter().all(|p| p.status == ContactStatus::Open || p.gap.abs() < 1e-4), "{at}");
        }
        // The trapezoidal rule of the work is worth 2 % at so few steps.
        let last = steps.last().map(|(row, _)| *row).unwrap_or_default();
        let energy = last.energy_elastic + last.work_plastic + last.work_friction;
        assert!(
            (last.work_external - energy).abs() <= 0.03 * last.work_external,
            "{settings:?}: {} and {energy}",
            last.work_external
        );
        let held: Vec<&StepRecord> = steps.iter().map(|(row, _)| row).filter(|row| row.segment == 1).collect();
        if settings.iter().any(|s| s.contains("normal-force")) {
            let force = steps.iter().rfind(|(row, _)| row.segment == 0).map_or(0.0, |(row, _)| row.f_n);
            assert!(held.iter().all(|row| (row.f_n / force - 1.0).abs() < 1e-4), "{force}");
        }
    });
}

#[test]
fn friction_shears_a_pair_otherwise_than_a_plane() {
    // The plane's press lacks 3 % of the force and 4 % of the radius at mu = 0.3, as an
    // axisymmetric code says too (153.6 and 148.2, and 0.2164 and 0.2098 R, for a fine mesh).
    let mesh = "mesh.elements_per_contact_radius=8";
    let last = |text: &str, path: &str| follow(text, &[mesh, path]).last().map(|(row, _)| *row).unwrap_or_default();
    let (pair, plane) = (last(PAIR, "path=[{indentation=0.04}]"), last(PLANE, "path=[{indentation=0.02}]"));
    assert!((pair.f_n / 153.6 - 1.0).abs() < 0.015 && (plane.f_n / 148.2 - 1.0).abs() < 0.015, "{} {}", pair.f_n, plane.f_n);
    assert!((pair.a / plane.a - 1.035).abs() < 0.01, "{} {}", pair.a, plane.a);
}
