//! Elastic shear after a plastic preload: Jaeger (1998), Ciavarella (1998).
//!
//! Shear that stays elastic follows from the unloading curve alone, exactly at beta = 0: nu = 0.49
//! here. Shear from the largest load goes on yielding; so the contact is unloaded, nearly to the
//! end for the curve, and loaded again to a part of its force, where it is sheared. Strong
//! hardening keeps all that elastic: the curve is not Hertz's, for the surface has taken the
//! plane's shape.

use super::equator::Compliances;
use super::runner::Runner;
use super::sphere::{History, RADIUS, YOUNGS_MODULUS, press, shear, sphere};
use super::{Check, VerifyError};
use crate::analytical::mesarovic_johnson::Unloading;
use crate::analytical::olsson_larsson::{self, OlssonLarsson};
use crate::analytical::{ElasticSphere, jaeger_ciavarella};
use crate::case::{Case, Hardening, Hold};

const NU: f64 = 0.49;
/// Small, so that the contact is well in the plastic range at a/R = 0.02.
const YIELD_STRESS: f64 = 40.0;
/// Linear hardening.
const MODULUS: f64 = 20e3;
/// Indentation of the press.
const H: f64 = 3e-4 * RADIUS;
/// Coulomb's coefficient: small, so that shear stays elastic.
const MU: f64 = 0.1;
/// How far the contact is unloaded, over its elastic recovery: for the curve, and where it is
/// sheared.
const UNLOADED_TO: f64 = 0.9;
const SHEARED_AT: f64 = 0.3;
/// Where shear is compared, over the displacement at which everything slips.
const SHEAR: [f64; 3] = [0.25, 0.5, 0.75];

const SPHERE: ElasticSphere = ElasticSphere { radius: RADIUS, youngs_modulus: YOUNGS_MODULUS, poissons_ratio: NU };

/// The unloading as a model expects it: where to take samples. What is compared uses the computed
/// curve.
fn expected() -> Unloading {
    let hardening = olsson_larsson::OlssonLarssonHardening::ThreeParameter {
        yield_stress: YIELD_STRESS,
        coefficient: MODULUS / YIELD_STRESS,
        exponent: 1.0,
    };
    let model = OlssonLarsson { sphere: SPHERE, hardening };
    Unloading { sphere: SPHERE, indentation: H, contact_radius: model.contact_radius(H), force: model.force(H) }
}

fn case(elements: usize) -> Case {
    let expected = expected();
    let at = |share: f64| H - share * expected.recovery();
    let slip = jaeger_ciavarella::slip_displacement(&SPHERE, MU, at(SHEARED_AT), expected.lost());
    let mut path = vec![press(H), press(at(UNLOADED_TO)), press(at(SHEARED_AT))];
    path.extend(SHEAR.map(|x| shear(x * slip, Hold::Indentation)));
    let mut case = sphere(NU, Hardening::Linear { yield_stress: YIELD_STRESS, modulus: MODULUS }, MU, elements, path);
    case.solver.shear_steps = Some(2);
    // The preload may be any: its accuracy does not matter.
    case.solver.press_steps = Some(8);
    // The unloading curve enters by differences of it.
    case.solver.tolerance = 3e-5;
    case
}

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let body = runner.equator(NU)?;
    let history = runner.follow(&case(runner.elements(8)))?;
    let (top, start) = (history.end(0), history.end(2));
    let curve = unloading_curve(&history, &body);
    let start_h = body.contact_indentation(start.h, start.f_n);
    let mut checks = vec![
        Check::relative(
            "jaeger-ciavarella",
            "F_N unloaded and loaded again, on the unloading curve",
            start.f_n / top.f_n,
            interpolate(&curve, start_h) / top.f_n,
            0.0,
            "unloading is elastic as far as the two agree",
        )
        .without_verdict(),
    ];
    let limit = MU * start.f_n;
    for (segment, x) in (3..).zip(SHEAR) {
        let row = history.end(segment);
        let d = body.contact_shear(row.delta_t, row.f_t);
        let reference = jaeger_ciavarella::force(&SPHERE, MU, start_h, |h| interpolate(&curve, h), d);
        checks.push(
            Check::relative(
                "jaeger-ciavarella",
                format!("F_T/(mu F_N) at {x} of sliding, unloaded to {:.2} F_N0", start.f_n / top.f_n),
                row.f_t / limit,
                reference / limit,
                0.03,
                "as Cattaneo-Mindlin's 2 %, and 1 % for a curve of twelve points and for shear that is not quite elastic",
            )
            .by(1.0),
        );
    }
    Ok(checks)
}

/// (h, F_N) while unloading, h of the contact itself and rising.
fn unloading_curve(history: &History, body: &Compliances) -> Vec<(f64, f64)> {
    let rows = std::iter::once(history.end(0)).chain(history.segment(1).copied());
    let mut curve: Vec<(f64, f64)> = rows.map(|row| (body.contact_indentation(row.h, row.f_n), row.f_n)).collect();
    curve.reverse();
    curve
}

/// Linear between the points of a rising curve, and on beyond its ends, but never below zero.
fn interpolate(curve: &[(f64, f64)], x: f64) -> f64 {
    let after = curve.partition_point(|point| point.0 < x).clamp(1, curve.len().max(2) - 1);
    match (curve.get(after - 1), curve.get(after)) {
        (Some(&(x0, y0)), Some(&(x1, y1))) => (y0 + (y1 - y0) * (x - x0) / (x1 - x0)).max(0.0),
        _ => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpolates_and_continues() {
        let curve = [(1.0, 0.5), (2.0, 1.5), (4.0, 2.5)];
        for (x, y) in [(1.0, 0.5), (1.5, 1.0), (2.0, 1.5), (3.0, 2.0), (4.0, 2.5), (5.0, 3.0), (0.75, 0.25), (0.0, 0.0)] {
            assert_eq!(interpolate(&curve, x), y, "{x}");
        }
        assert!(interpolate(&curve[..1], 1.0).is_nan());
    }
}
