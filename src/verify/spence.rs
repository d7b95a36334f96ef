//! An elastic sphere pressed with friction: the part of the contact that sticks, and what friction
//! adds to the force, against a solution of Spence's problem.

use super::runner::Runner;
use super::sphere::{RADIUS, press, sphere};
use super::{Check, VerifyError};
use crate::case::Hardening;
use crate::simulation::record::StepRecord;

/// Poisson's ratio, mu, c/a and F_N over the frictionless one at the same h, of an elastic
/// half-space (Spence 1968, 1975), solved by `benches/pairs/spence.py` to the last digit.
const SPENCE: [(f64, f64, f64, f64); 3] = [(0.0, 0.3, 0.503, 1.0318), (0.0, 0.5, 0.813, 1.0439), (0.3, 0.2, 0.698, 1.0118)];
/// Depth of the press, a = 0.02 R.
const DEPTH: f64 = 4e-4 * RADIUS;
/// Steps of the press. Half as many lower c/a by 0.02: what lands in a step has slipped since its
/// start. Without friction, F_N needs none of them.
const STEPS: usize = 24;

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let elements = runner.elements(10);
    let mut pressed = |nu: f64, mu: f64| {
        let mut case = sphere(nu, Hardening::Elastic, mu, elements, vec![press(DEPTH)]);
        case.solver.tolerance = 1e-5;
        case.solver.press_steps = Some(if mu > 0.0 { STEPS } else { 4 });
        let history = runner.follow(&case)?;
        // c/a is a constant of the press; it is averaged over its second half, in which `a` grows
        // by two elements and a half.
        let rows: Vec<&StepRecord> = history.segment(0).filter(|row| row.h >= 0.5 * DEPTH).collect();
        let ratio = rows.iter().map(|row| row.stick_radius / row.a_gap).sum::<f64>() / rows.len() as f64;
        Ok::<_, VerifyError>((ratio, history.last().f_n))
    };
    let mut checks = Vec::new();
    let mut frictionless = Vec::new();
    for (nu, mu, stick, force) in SPENCE {
        if frictionless.last().is_none_or(|&(of, _)| of != nu) {
            frictionless.push((nu, pressed(nu, 0.0)?.1));
        }
        let without = frictionless.last().map_or(f64::NAN, |&(_, f_n)| f_n);
        let (ratio, f_n) = pressed(nu, mu)?;
        let because = "less than a third of an element, of which the contact radius has 10; a is that of the gap";
        checks.push(Check::relative("spence", format!("nu = {nu}, mu = {mu}: c/a"), ratio, stick, 0.03, because).by(1.0));
        let because = "a tenth of what friction adds at most, 4.4 %, on so coarse a mesh";
        checks.push(Check::relative(
            "spence",
            format!("nu = {nu}, mu = {mu}: F_N over that at mu = 0"),
            f_n / without,
            force,
            0.0045,
            because,
        ));
    }
    Ok(checks)
}
