//! A rigid sphere as the opponent: of great radius it is the plane; Hertz with R*; the hardness of
//! a flat; friction and energies while it is sheared.

use std::f64::consts::PI;

use super::runner::Runner;
use super::sphere::{History, RADIUS, YOUNGS_MODULUS, press, shear, sphere};
use super::{Check, VerifyError};
use crate::analytical::{ElasticSphere, hertz};
use crate::case::{Case, Hardening, Hold, Opponent, Segment};
use crate::output::{ContactPoint, ContactStatus, ripple};
use crate::simulation::record::StepRecord;

const NU: f64 = 0.3;
const MU: f64 = 0.3;
/// Contact radius at which Hertz is checked, the smallest that is meshed for: what the body beyond
/// the plate lacks goes with it.
const SMALL: f64 = 0.005 * RADIUS;
/// Yield stresses of flats, each with the depth it is pressed to: E/sigma_Y of 10,000 to 50,000.
/// They are fully plastic from a half of the depth on, E a/(sigma_Y R) = 340 to 1500, while a/R
/// stays below 0.051: a softer flat spreads more (a^2/(2 R h) = 1.47 at E a/(sigma_Y R) =
/// 4000), a stiffer one less, and large deformations lower the hardness by 3 % at a/R = 0.1 and
/// 8 % at 0.15 (Olsson & Larsson 2016).
const PLASTIC: [(f64, f64); 3] = [(20.0, 9e-4 * RADIUS), (10.0, 6e-4 * RADIUS), (4.0, 3e-4 * RADIUS)];

/// A case against a rigid sphere of this radius; its body is a flat or a sphere.
fn against(radius: f64, flat: bool, hardening: Hardening, friction: f64, elements: usize, path: Vec<Segment>) -> Case {
    let mut case = sphere(NU, hardening, friction, elements, path);
    case.sphere.flat = flat;
    case.opponent = Some(Opponent::Rigid { radius });
    case
}

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let mut checks = plane(runner)?;
    for flat in [true, false] {
        checks.extend(hertzian(runner, flat)?);
    }
    checks.extend(brinell(runner)?);
    checks.extend(sheared(runner)?);
    Ok(checks)
}

/// A sphere of great radius and the plane, which is computed another way.
fn plane(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let path = vec![press(0.02 * RADIUS), shear(0.002 * RADIUS, Hold::Indentation)];
    let mut plane = sphere(NU, Hardening::Ideal { yield_stress: 400.0 }, MU, 4, path);
    plane.solver.tolerance = 1e-8;
    (plane.solver.press_steps, plane.solver.shear_steps) = (Some(8), Some(5));
    let mut case = plane.clone();
    case.opponent = Some(Opponent::Rigid { radius: 1e9 * RADIUS });
    let (plane, case) = (runner.follow(&plane)?, runner.follow(&case)?);
    let pressed = |history: &History| history.end(0);
    let last = |history: &History| history.last();
    let check = |what: &str, ours: f64, reference: f64| {
        let because = "the solver's tolerance is 1e-8, and a/R over 1e9 nothing";
        Check::relative("rigid sphere", format!("radius 1e9 R: {what}"), ours, reference, 1e-6, because)
    };
    Ok(vec![
        check("F_N, pressed", pressed(&case).f_n, pressed(&plane).f_n),
        check("a, pressed", pressed(&case).a, pressed(&plane).a),
        check("F_N, sheared", last(&case).f_n, last(&plane).f_n),
        check("F_T, sheared", last(&case).f_t, last(&plane).f_t),
        check("a, sheared", last(&case).a, last(&plane).a),
    ])
}

/// An elastic body against a rigid sphere of radius R: Hertz with R* = R for the flat, R/2 for the
/// sphere.
fn hertzian(runner: &mut Runner<'_>, flat: bool) -> Result<Vec<Check>, VerifyError> {
    let mut case = against(RADIUS, flat, Hardening::Elastic, 0.0, runner.elements(8), Vec::new());
    let h = SMALL * SMALL / case.effective_radius();
    case.path = vec![press(h)];
    case.solver.press_steps = Some(4);
    case.solver.tolerance = 1e-5;
    let row = runner.follow(&case)?.last();
    let exact = ElasticSphere { radius: case.effective_radius(), youngs_modulus: YOUNGS_MODULUS, poissons_ratio: NU };
    let body = if flat { "flat" } else { "sphere" };
    let check = |what: &str, ours: f64, reference: f64, because: &'static str| {
        Check::relative("rigid sphere", format!("elastic {body}: {what} at a = 0.005 R"), ours, reference, 0.01, because)
    };
    Ok(vec![
        check(
            "F_N",
            row.f_n,
            hertz::force(&exact, h),
            "the body beyond its plate is missing, which makes F_N 0.55 or, of a flat, 0.65 a/R larger; the rest is the mesh",
        ),
        check("a", row.a, hertz::contact_radius(&exact, h), "a is found to less than a tenth of an element, of which it has 8"),
    ])
}

/// A rigid sphere pressed into ideally plastic flats, without friction.
fn brinell(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    const BECAUSE: &str = "Mesarovic & Fleck 1999, two digits of a finite-element result; mesh and steps are worth 2 %";
    let elements = runner.elements(8);
    let mut checks = Vec::new();
    for (yield_stress, depth) in PLASTIC {
        let hardening = Hardening::Ideal { yield_stress };
        let history = runner.follow(&against(RADIUS, true, hardening, 0.0, elements, vec![press(depth)]))?;
        // Means over the second half of the press, in which both are constant but for the ripple.
        let rows: Vec<&StepRecord> = history.segment(0).filter(|row| row.h >= 0.5 * depth * (1.0 - 1e-9)).collect();
        let mean = |of: &dyn Fn(&StepRecord) -> f64| rows.iter().map(|row| of(row)).sum::<f64>() / rows.len() as f64;
        let pressure = mean(&|row| row.f_n / (PI * row.a * row.a * yield_stress));
        let area = mean(&|row| row.a * row.a / (2.0 * RADIUS * row.h));
        let flat = format!("ideal flat, E = {} sigma_Y", YOUNGS_MODULUS / yield_stress);
        checks.push(Check::relative("rigid sphere", format!("{flat}: p_m/sigma_Y"), pressure, 3.0, 0.04, BECAUSE));
        checks.push(Check::relative("rigid sphere", format!("{flat}: a^2/(2 R h)"), area, 1.4, 0.04, BECAUSE));
        checks.push(Check::information(
            "rigid sphere",
            format!("{flat}: ripple of F_N"),
            // Without the state before first touch.
            ripple(&history.segment(0).filter(|row| row.f_n > 0.0).copied().collect::<Vec<_>>()).unwrap_or(f64::NAN),
            "root mean square of ln F_N about a parabola in ln h",
        ));
    }
    Ok(checks)
}

/// A rigid sphere sheared along a flat, and the main job's sphere along a plane, for what they
/// cost.
fn sheared(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let path = || vec![press(0.02 * RADIUS), shear(0.01 * RADIUS, Hold::Indentation)];
    let hardening = || Hardening::Ideal { yield_stress: 400.0 };
    let ball = runner.follow(&against(RADIUS, true, hardening(), MU, 6, path()))?;
    let plane = runner.follow(&sphere(NU, hardening(), MU, 6, path()))?;
    let iterations = |history: &History| history.rows.iter().map(|row| row.newton_iterations).sum::<usize>() as f64;
    let balance = |row: StepRecord| 1.0 - (row.energy_elastic + row.work_plastic + row.work_friction) / row.work_external;
    let energy = |what: &str, row: StepRecord| {
        let because = "trapezoidal rule over the steps, as over a plane";
        Check::relative("rigid sphere", what, balance(row), 0.0, 0.03, because).by(1.0)
    };
    Ok(vec![
        Check::range(
            "rigid sphere",
            "sheared along a flat: |q|/(mu p) at any point",
            worst_friction(&ball.contact, RADIUS),
            [0.9, 1.0],
            1e-6,
            "Coulomb's bound holds at every point exactly, in the frame of the sphere's surface there",
        ),
        energy("sheared along a flat: missing work, pressed", ball.end(0)),
        energy("sheared along a flat: missing work, sheared", ball.last()),
        Check::range(
            "rigid sphere",
            "sheared along a flat: Newton iterations over those of the plane",
            iterations(&ball) / iterations(&plane),
            [0.0, 1.3],
            0.0,
            "the same path of a sphere on the plane, on as many elements along the contact radius",
        ),
    ])
}

/// Largest |q|/(mu p) of the points in contact with a rigid sphere of this radius.
pub fn worst_friction(points: &[ContactPoint], radius: f64) -> f64 {
    let closed = points.iter().filter(|point| point.status != ContactStatus::Open && point.pressure > 0.0);
    closed
        .map(|point| {
            let distance = radius + point.gap;
            let (x, y) = (point.current_x / distance, point.current_y / distance);
            let normal = [x, y, (1.0 - x * x - y * y).max(0.0).sqrt()];
            let traction = [point.traction_x, point.traction_y, point.pressure];
            let p: f64 = normal.iter().zip(traction).map(|(n, t)| n * t).sum();
            let q: f64 = normal.iter().zip(traction).map(|(n, t)| (t - p * n).powi(2)).sum::<f64>().sqrt();
            q / (MU * p)
        })
        .fold(0.0, f64::max)
}
