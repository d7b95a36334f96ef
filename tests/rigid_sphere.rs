//! A rigid sphere as the opponent, of a sphere and of a flat: forces, friction at every point,
//! energies, held forces, stick, release; and resumed runs.

mod paths;

use asperity::case::Case;
use asperity::output::{ContactPoint, ContactStatus};
use paths::Steps;
use rayon::prelude::*;

const BRINELL: &str = include_str!("../fixtures/cases/brinell.toml");

fn case(settings: &[&str]) -> Case {
    let mesh = ["mesh.elements_per_contact_radius=4", "solver.press_steps=10"];
    let settings: Vec<String> = mesh.iter().chain(settings).map(|&setting| setting.to_owned()).collect();
    Case::parse(BRINELL, "brinell.toml", &settings).expect("a case")
}

fn follow(settings: &[&str]) -> Steps {
    let case = case(settings);
    paths::follow(&case)
}

/// Pressure and traction of a point in contact across and along the surface of a sphere with this
/// radius.
fn in_its_frame(point: &ContactPoint, radius: f64) -> [f64; 2] {
    let distance = radius + point.gap;
    let (x, y) = (point.current_x / distance, point.current_y / distance);
    let normal = [x, y, (1.0 - x * x - y * y).sqrt()];
    let traction = [point.traction_x, point.traction_y, point.pressure];
    let p: f64 = normal.iter().zip(traction).map(|(n, t)| n * t).sum();
    [p, normal.iter().zip(traction).map(|(n, t)| (t - p * n).powi(2)).sum::<f64>().sqrt()]
}

#[test]
fn coulomb_holds_at_every_point_and_the_energies_balance() {
    let paths: [(&[&str], f64); 6] = [
        (&["path.1.shear=0.008"], 1.0),
        (&["opponent.radius=0.4", "path=[{indentation=0.01},{shear=0.004},{shear=-0.002},{release=true}]"], 0.4),
        (&["path=[{indentation=0.01},{shear=0.003,hold=\"normal-force\"}]"], 1.0),
        (&["contact.friction=\"stick\"", "path=[{indentation=0.01},{shear=0.001},{release=0.5}]"], 1.0),
        (&["sphere.flat=false", "path=[{indentation=0.02},{shear=0.004},{release=true}]"], 1.0),
        (&["path=[{indentation=0.01},{indentation=0.015,shear=0.002},{indentation=0.005,shear=0.0}]"], 1.0),
    ];
    paths.into_par_iter().for_each(|(settings, radius)| {
        let steps = follow(settings);
        let mu = if settings.iter().any(|s| s.contains("stick")) { f64::INFINITY } else { 0.3 };
        for (row, points) in &steps {
            let at = format!("{settings:?}, step {}", row.step);
            let sum = |f: &dyn Fn(&ContactPoint) -> f64| points.iter().map(f).sum::<f64>();
            let [f_n, f_t] = [sum(&|p| p.pressure * p.area), -sum(&|p| p.traction_x * p.area)];
            let scale = row.f_n.max(1e-3);
            assert!((f_n - row.f_n).abs() < 1e-9 * scale && (f_t - row.f_t).abs() < 1e-9 * scale, "{at}: {f_n}, {f_t}, {row:?}");
            let mean = row.f_n / (std::f64::consts::PI * row.a * row.a).max(1e-12);
            for point in points.iter().filter(|p| p.status != ContactStatus::Open) {
                let [p, q] = in_its_frame(point, radius);
                assert!(point.gap.abs() < 1e-4, "{at}: {point:?}");
                let bound = if mu.is_finite() { mu * p } else { f64::INFINITY };
                assert!(p > -1e-9 * mean && q <= bound + 1e-9 * mean, "{at}: {p} {q} {point:?}");
            }
            assert!(points.iter().all(|p| p.gap > -1e-4), "{at}: nothing has passed the sphere");
        }
        let last = steps.last().map(|(row, _)| *row).unwrap_or_default();
        let most = steps.iter().map(|(row, _)| row.work_external).fold(0.0, f64::max);
        let energy = last.energy_elastic + last.work_plastic + last.work_friction;
        // The trapezoidal rule of the work is worth 2 % at so few steps.
        assert!((last.work_external - energy).abs() <= 0.03 * most, "{settings:?}: {} and {energy}", last.work_external);
        if settings.iter().any(|s| s.contains("normal-force")) {
            let force = steps.iter().rfind(|(row, _)| row.segment == 0).map_or(0.0, |(row, _)| row.f_n);
            assert!(
                steps.iter().filter(|(row, _)| row.segment == 1).all(|(row, _)| (row.f_n / force - 1.0).abs() < 1e-4),
                "{force}"
            );
        }
        if settings.iter().any(|s| s.contains("release=true")) {
            assert_eq!((last.contact_points, last.f_n), (0, 0.0), "{settings:?}");
        }
    });
}

#[test]
fn forwards_and_back_are_the_same() {
    let both: Vec<Steps> = ["0.004", "-0.004"]
        .into_par_iter()
        .map(|shear| follow(&["solver.tolerance=1e-6", &format!("path=[{{indentation=0.01}},{{shear={shear}}}]")]))
        .collect();
    assert_eq!(both[0].len(), both[1].len());
    for ((forwards, _), (back, _)) in both[0].iter().zip(&both[1]) {
        assert!((forwards.f_n - back.f_n).abs() <= 1e-4 * forwards.f_n, "{} and {}", forwards.f_n, back.f_n);
        assert!((forwards.f_t + back.f_t).abs() <= 1e-4 * forwards.f_n, "{} and {}", forwards.f_t, back.f_t);
    }
}
