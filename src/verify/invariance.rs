//! What must not change the result: the sign of the shear, and the units.

use super::runner::Runner;
use super::sphere::{History, RADIUS, press, shear, sphere};
use super::{Check, VerifyError};
use crate::case::{Case, Hardening, Hold, Segment, ShearTarget};
use crate::simulation::record::StepRecord;

/// Contact merit at which the steps of these cases are accepted.
const TOLERANCE: f64 = 1e-8;
/// How far results may differ: differences of the order of the tolerance, which the path adds up.
const ALLOWED: f64 = 1e-6;

/// An elastic-plastic press and shear, coarse, solved far beyond the usual tolerance.
fn case(d: f64) -> Case {
    let path: Vec<Segment> = vec![press(0.01 * RADIUS), shear(d, Hold::Indentation)];
    let mut case = sphere(0.3, Hardening::Linear { yield_stress: 400.0, modulus: 2000.0 }, 0.3, 4, path);
    case.solver.tolerance = TOLERANCE;
    case.solver.shear_steps = Some(4);
    case
}

/// The same sphere with lengths `length` times and stresses `stress` times as large in number.
fn in_other_units(case: &Case, length: f64, stress: f64) -> Case {
    let mut other = case.clone();
    other.sphere.radius *= length;
    other.material.youngs_modulus *= stress;
    other.material.hardening = case.material.hardening.scaled(1.0 / stress);
    for segment in &mut other.path {
        match segment {
            Segment::Indentation { indentation } => *indentation *= length,
            Segment::Shear { shear: ShearTarget::Displacement(d), .. } => *d *= length,
            _ => {}
        }
    }
    other
}

/// Largest difference of two histories in `value`, over the largest value.
fn difference(a: &History, b: &History, value: impl Fn(&StepRecord) -> f64, factor: f64) -> f64 {
    if a.rows.len() != b.rows.len() {
        return f64::NAN;
    }
    let largest = a.rows.iter().map(|row| value(row).abs()).fold(0.0, f64::max);
    a.rows.iter().zip(&b.rows).map(|(a, b)| (value(a) - value(b) / factor).abs()).fold(0.0, f64::max) / largest
}

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let forward = runner.follow(&case(1e-3 * RADIUS))?;
    let backward = runner.follow(&case(-1e-3 * RADIUS))?;
    let (length, stress) = (25.4e-3, 6894.757);
    let converted = runner.follow(&in_other_units(&case(1e-3 * RADIUS), length, stress))?;
    let force = stress * length * length;
    let zero = |check, what: &str, ours: f64, because| Check::relative(check, what, ours, 0.0, ALLOWED, because).by(1.0);
    let mirror = "the mesh is its own mirror image; a hundred times the tolerance to which these cases are solved";
    let units = "everything is scaled by R and E first; a hundred times the tolerance to which these cases are solved";
    Ok(vec![
        zero("symmetry", "F_N(d) - F_N(-d), largest", difference(&forward, &backward, |row| row.f_n, 1.0), mirror),
        zero("symmetry", "F_T(d) + F_T(-d), largest", difference(&forward, &backward, |row| row.f_t, -1.0), mirror),
        zero("units", "F_N in other units, largest difference", difference(&forward, &converted, |row| row.f_n, force), units),
        zero("units", "F_T in other units, largest difference", difference(&forward, &converted, |row| row.f_t, force), units),
        zero("units", "a in other units, largest difference", difference(&forward, &converted, |row| row.a, length), units),
    ])
}
