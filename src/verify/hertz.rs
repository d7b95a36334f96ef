//! Elastic pressing against Hertz, and the load at first yield against the exact Mises stress on
//! the axis.
//!
//! The plate's displacement is prescribed at the equator: what the body between adds is taken off
//! (`equator`).

use super::runner::Runner;
use super::sphere::{RADIUS, YOUNGS_MODULUS, press, sphere};
use super::{Check, VerifyError};
use crate::analytical::yielding::{critical_indentation, first_yield};
use crate::analytical::{ElasticSphere, hertz};
use crate::case::{Case, Hardening};
use crate::simulation::record::StepRecord;

/// Poisson's ratio of the checks of this file.
const NU: f64 = 0.3;
/// Indentation at which Hertz is checked: a/R = 0.01.
const H: f64 = 1e-4 * RADIUS;
/// Indentation of first yield in the checks, a little further on.
const H_YIELD: f64 = 1.2e-4 * RADIUS;
/// Indentations around first yield, over `H_YIELD`.
const AROUND_YIELD: [f64; 6] = [0.94, 0.98, 1.02, 1.06, 1.10, 1.14];

/// A frictionless sphere meshed for a contact of radius `a`.
fn case(hardening: Hardening, runner: &Runner<'_>, a: f64, indentations: &[f64]) -> Case {
    let mut case = sphere(NU, hardening, 0.0, runner.elements(8), indentations.iter().map(|h| press(*h)).collect());
    case.mesh.contact_radius = Some(a);
    // Elastic contact without friction has no memory, so that long steps cost nothing but
    // iterations.
    case.solver.press_steps = Some(4);
    case.solver.tolerance = 1e-5;
    case
}

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let ball = ElasticSphere { radius: RADIUS, youngs_modulus: YOUNGS_MODULUS, poissons_ratio: NU };
    let onset = first_yield(NU);
    // The yield stress that puts first yield at H_YIELD.
    let yield_stress = (H_YIELD / critical_indentation(&ball, 1.0, onset.pressure_ratio)).sqrt();
    let mut indentations = vec![H];
    indentations.extend(AROUND_YIELD.map(|share| share * H_YIELD));
    let history =
        runner.follow(&case(Hardening::Ideal { yield_stress }, runner, hertz::contact_radius(&ball, H_YIELD), &indentations))?;
    let body = runner.equator(NU)?;

    let at_h = history.end(0);
    let yielding = yield_force(&history.rows).unwrap_or(f64::NAN);
    let pressure = hertz::maximum_pressure(&ball, hertz::contact_radius(&ball, hertz::indentation(&ball, yielding)));
    let mut checks = vec![
        Check::relative(
            "hertz",
            "F_N at h = 1e-4 R, the body's share taken off",
            at_h.f_n,
            hertz::force(&ball, body.contact_indentation(at_h.h, at_h.f_n)),
            0.01,
            "Hertz errs by (a/R)^2 = 1e-4; the rest is the mesh, in which nodes enter the contact one by one",
        ),
        Check::relative(
            "hertz",
            "F_N at h = 1e-4 R, as computed",
            at_h.f_n,
            hertz::force(&ball, H),
            0.0,
            "the same with the body's share",
        )
        .without_verdict(),
        Check::relative(
            "hertz",
            "a at h = 1e-4 R",
            at_h.a,
            hertz::contact_radius(&ball, hertz::indentation(&ball, at_h.f_n)),
            0.01,
            "Hertz's radius for the computed force, so without the body's share; a is found to less than a tenth of \
             an element, of which a has 8",
        ),
        Check::relative(
            "first yield",
            "p_0/sigma_Y where alpha begins",
            pressure / yield_stress,
            onset.pressure_ratio,
            0.02,
            "0.3 % by F_N^(1/3), the rest because Mises' stress is seen at quadrature points, a sixteenth of a apart, and not at its peak",
        ),
    ];
    checks.extend(body.rows(NU));
    Ok(checks)
}

/// The normal force at which alpha leaves zero: extrapolated from the first two plastic steps,
/// within the step in which it happens.
fn yield_force(rows: &[StepRecord]) -> Option<f64> {
    let first = rows.iter().position(|row| row.max_alpha > 0.0)?;
    let (before, now, next) = (rows.get(first.checked_sub(1)?)?, rows.get(first)?, rows.get(first + 1)?);
    let slope = (next.max_alpha - now.max_alpha) / (next.f_n - now.f_n);
    Some((now.f_n - now.max_alpha / slope).clamp(before.f_n, now.f_n))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(f_n: f64, max_alpha: f64) -> StepRecord {
        StepRecord { f_n, max_alpha, ..StepRecord::default() }
    }

    #[test]
    fn yield_lies_where_alpha_extrapolates_to_zero() {
        let rows = [row(0.0, 0.0), row(1.0, 0.0), row(2.0, 0.5), row(3.0, 1.5)];
        assert_eq!(yield_force(&rows), Some(1.5));
        // Never outside the step in which alpha left zero.
        assert_eq!(yield_force(&[row(0.0, 0.0), row(1.0, 0.0), row(2.0, 5.0), row(3.0, 6.0)]), Some(1.0));
        assert_eq!(yield_force(&rows[..2]), None);
        assert_eq!(yield_force(&rows[2..]), None);
    }
}
