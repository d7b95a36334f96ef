//! Elastic-plastic pressing against the published models: Olsson & Larsson, Jackson & Green.

use super::runner::{RADIUS, Runner, YOUNGS_MODULUS, press, sphere};
use super::{Check, VerifyError};
use crate::analytical::jackson_green::JacksonGreen;
use crate::analytical::olsson_larsson::{self, OlssonLarsson};
use crate::analytical::{ElasticSphere, johnson};
use crate::case::Hardening;
use crate::simulation::record::StepRecord;

/// Poisson's ratio.
const NU: f64 = 0.3;
/// Yield stresses and indentations, over R; a contact has at least 0.7 of the elements that it has at the end of its press.
const PRESSES: [(f64, [f64; 2]); 3] = [(2000.0, [0.01, 0.02]), (400.0, [0.01, 0.02]), (40.0, [1.5e-4, 3e-4])];

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let (mut larsson, mut green) = (Vec::new(), Vec::new());
    for (yield_stress, indentations) in PRESSES {
        let path = indentations.map(|h| press(h * RADIUS)).to_vec();
        let history = runner.follow(&sphere(NU, Hardening::Ideal { yield_stress }, 0.0, runner.elements(8), path))?;
        for segment in 0..indentations.len() {
            larsson.extend(olsson_larsson(yield_stress, &history.end(segment)));
            green.extend(jackson_green(yield_stress, &history.end(segment)));
        }
    }
    larsson.append(&mut green);
    Ok(larsson)
}

fn ball() -> ElasticSphere {
    ElasticSphere { radius: RADIUS, youngs_modulus: YOUNGS_MODULUS, poissons_ratio: NU }
}

/// Hbar and c^2 at the computed contact radius, as the model has them.
fn olsson_larsson(yield_stress: f64, row: &StepRecord) -> [Check; 2] {
    const BAND: &str = "the published models differ by 6 % in Hbar and 8 % in c^2 for Lambda < 130: that is what each is worth";
    let model = OlssonLarsson { sphere: ball(), hardening: olsson_larsson::Hardening::Ideal { yield_stress } };
    let lambda = model.lambda(row.a);
    let hardness = johnson::normalized_hardness(row.f_n, yield_stress, row.a);
    let c_squared = row.a * row.a / (2.0 * RADIUS * row.h);
    let at = format!("at Lambda = {lambda:.1}, a/R = {:.3}", row.a / RADIUS);
    let check = |what: &str, ours, reference, band| {
        Check::relative("olsson-larsson", format!("{what} {at}"), ours, reference, band, BAND)
    };
    [
        check("Hbar", hardness, model.normalized_hardness(row.a), 0.06),
        check("c^2", c_squared, model.c_squared(row.a), 0.08),
    ]
}

/// F_N and a at the indentation, as the model has them.
fn jackson_green(yield_stress: f64, row: &StepRecord) -> [Check; 2] {
    let model = JacksonGreen { sphere: ball(), yield_stress };
    let at = format!("at h/h_c = {:.1}, a/R = {:.3}", model.interference(row.h), row.a / RADIUS);
    let check = |what: &str, ours, reference, band, because| {
        Check::relative("jackson-green", format!("{what} {at}"), ours, reference, band, because)
    };
    let [of_force, of_radius] = [
        "F_N goes with Hbar c^2, of which the published models are worth 6 and 8 %",
        "a goes with the root of c^2, of which the published models are worth 8 %",
    ];
    [
        check("F_N", row.f_n, model.force(row.h), 0.14, of_force),
        check("a", row.a, model.contact_radius(row.h), 0.04, of_radius),
    ]
}
