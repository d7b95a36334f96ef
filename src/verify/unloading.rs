//! Unloading from a plastic state, and elastic shear after it.
//!
//! Unloading starts with dF/dh = 2 E* a, as long as a is small against R. Shear that stays elastic follows from the unloading curve alone
//! (Jaeger 1998, Ciavarella 1998), exactly at beta = 0: nu = 0.49 here. Shear from the largest load goes on yielding; so the contact is first
//! unloaded, to the end for its curve, and loaded again to a part of its force.

use super::runner::{History, RADIUS, Runner, YOUNGS_MODULUS, press, shear, sphere};
use super::{Check, VerifyError};
use crate::analytical::mesarovic_johnson::Unloading;
use crate::analytical::olsson_larsson::{self, OlssonLarsson};
use crate::analytical::{ElasticSphere, hertz, jaeger_ciavarella};
use crate::case::{Case, Hardening};

/// Nearly incompressible: beta = 0.02.
const NU: f64 = 0.49;
/// A small yield stress, so that the contact is fully plastic (Lambda about 300) at a/R = 0.01.
const YIELD_STRESS: f64 = 10.0;
/// Indentation of the press.
const H: f64 = 5e-5 * RADIUS;
/// Coulomb's coefficient: small, so that shear stays elastic.
const MU: f64 = 0.1;
/// How far the contact is unloaded, over its elastic recovery: a little, for the slope; to where it is sheared; and nearly to the end.
const SLOPE_AT: f64 = 0.05;
const SHEARED_AT: f64 = 0.4;
const UNLOADED_TO: f64 = 0.95;
/// Where shear is compared, over the displacement at which everything slips.
const SHEAR: [f64; 3] = [0.25, 0.5, 0.75];

const SPHERE: ElasticSphere = ElasticSphere { radius: RADIUS, youngs_modulus: YOUNGS_MODULUS, poissons_ratio: NU };

/// The unloading as models expect it: where to take samples. What is compared uses the computed curve.
fn expected() -> Unloading {
    let model = OlssonLarsson { sphere: SPHERE, hardening: olsson_larsson::Hardening::Ideal { yield_stress: YIELD_STRESS } };
    Unloading { sphere: SPHERE, indentation: H, contact_radius: model.contact_radius(H), force: model.force(H) }
}

fn case(elements: usize) -> Case {
    let expected = expected();
    let at = |share: f64| H - share * expected.recovery();
    let slip = jaeger_ciavarella::slip_displacement(&SPHERE, MU, at(SHEARED_AT), expected.lost());
    let mut path = vec![press(H), press(at(SLOPE_AT)), press(at(SHEARED_AT)), press(at(UNLOADED_TO)), press(at(SHEARED_AT))];
    path.extend(SHEAR.map(|x| shear(x * slip)));
    let mut case = sphere(NU, Hardening::Ideal { yield_stress: YIELD_STRESS }, MU, elements, path);
    case.solver.shear_steps = Some(3);
    // The slope is a small difference of large forces.
    case.solver.tolerance = 1e-6;
    case
}

/// Runs the checks.
pub fn checks(runner: &mut Runner<'_>) -> Result<Vec<Check>, VerifyError> {
    let history = runner.follow(&case(runner.elements(8)))?;
    let (top, below) = (history.end(0), history.end(1));
    let mut checks = vec![Check::relative(
        "unloading",
        format!("dF_N/dh at a/R = {:.4}, fully plastic", top.a / RADIUS),
        (top.f_n - below.f_n) / (top.h - below.h),
        hertz::stiffness(&SPHERE, top.a),
        0.02,
        "the equator's share is 0.5 a/R = 0.5 %, a is known to 1 % (a tenth of an element), the secant costs 0.1 %",
    )];
    let curve = unloading_curve(&history);
    let start = history.end(4);
    let limit = MU * start.f_n;
    checks.push(
        Check::relative(
            "unloading",
            "F_N unloaded and loaded again, over F_N before",
            start.f_n,
            history.end(2).f_n,
            0.0,
            "unloading is elastic as far as the two agree",
        )
        .information(),
    );
    for (segment, x) in (5..).zip(SHEAR) {
        let row = history.end(segment);
        let reference = jaeger_ciavarella::force(&SPHERE, MU, start.h, |h| interpolate(&curve, h), row.delta_t);
        checks.push(
            Check::relative(
                "jaeger-ciavarella",
                format!("F_T/(mu F_N) at {x} of sliding, unloaded to {:.2} F_N0", start.f_n / top.f_n),
                row.f_t / limit,
                reference / limit,
                0.0,
                "as good as the shear stays elastic",
            )
            .by(1.0)
            .information(),
        );
    }
    Ok(checks)
}

/// (h, F_N) while unloading, h rising.
fn unloading_curve(history: &History) -> Vec<(f64, f64)> {
    let rows = history.rows.iter().filter(|row| (1..=3).contains(&row.segment));
    let mut curve: Vec<(f64, f64)> = std::iter::once(history.end(0)).chain(rows.copied()).map(|row| (row.h, row.f_n)).collect();
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
