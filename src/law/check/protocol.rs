//! The paths that the update is held against: what contacts in a packing go through, alone and at
//! once.

use super::{Path, meshed};
use crate::case::{Case, Friction, Hardening, Hold, Segment, ShearTarget};
use crate::contact_law::ContactParameters;
use crate::contact_law::path::follow;
use crate::output::SLIP_DISPLACEMENT_RATIO;

/// F_T/F_N over mu at which a shear counts as full.
const FULL: f64 = SLIP_DISPLACEMENT_RATIO;

/// The protocol for the material, the friction and the greatest depth of `case`; the shears are
/// measured in the displacement at which the law has 0.99 mu.
pub fn protocol(case: &Case, parameters: &ContactParameters, elements: usize) -> Vec<Path> {
    let h = case.greatest_indentation();
    let slip = slip_displacement(parameters, h);
    let press = |share: f64| Segment::Indentation { indentation: share * h };
    let shear = |share: f64| Segment::Shear { shear: ShearTarget::Displacement(share * slip), hold: Hold::Indentation };
    let held = Segment::Shear { shear: ShearTarget::Displacement(slip), hold: Hold::NormalForce };
    let oblique = |degrees: f64| Segment::Oblique { indentation: h, shear: h * degrees.to_radians().tan() };
    let back = Segment::Oblique { indentation: 0.0, shear: 0.0 };
    let mut paths = vec![("press, release, press", vec![press(1.0), Segment::Release { share: 0.4 }, press(1.0), press(1.1)])];
    if case.contact.friction != Friction::Coefficient(0.0) {
        let cycles = |share: f64| vec![press(1.0), shear(share), shear(-share), shear(share), shear(-share), shear(share)];
        paths.extend([
            ("two cycles, 30 % of slip", cycles(0.3)),
            ("two cycles, 60 % of slip", cycles(0.6)),
            ("two cycles, 90 % of slip", cycles(0.9)),
            ("two cycles, full slip", cycles(1.0)),
            ("sheared, then pressed on", vec![press(0.8), shear(0.5), press(1.0)]),
            ("sheared under held F_N", vec![press(1.0), held]),
            ("released while sheared", vec![press(1.0), shear(0.6), Segment::Release { share: 0.3 }, shear(0.0)]),
        ]);
    }
    paths.extend([
        ("oblique, 15 degrees, and out", vec![oblique(15.0), back]),
        ("oblique, 45 degrees, and out", vec![oblique(45.0), back]),
        ("oblique, 75 degrees, and out", vec![oblique(75.0), back]),
    ]);
    paths
        .into_iter()
        .map(|(name, path)| {
            let mut case = meshed(case, elements);
            case.path = path;
            Path { name, case }
        })
        .collect()
}

/// delta_T from a virgin contact at `h` at which F_T/F_N is 0.99 mu.
pub(super) fn slip_displacement(parameters: &ContactParameters, h: f64) -> f64 {
    let full = Segment::Shear { shear: ShearTarget::FullSlip, hold: Hold::Indentation };
    let points = follow(parameters, &[Segment::Indentation { indentation: h }, full]);
    let slips = points.iter().find(|p| p.segment == 1 && p.f_t >= FULL * parameters.friction * p.f_n && p.delta_t > 0.0);
    slips.map_or(parameters.virgin(h).point.delta_t_end, |point| point.delta_t)
}

/// The materials of a check without a case, each with three frictions: just yielding, deep plastic,
/// and hardening strongly.
pub fn materials(case: &Case) -> Vec<(&'static str, Case)> {
    let modulus = case.material.youngs_modulus;
    let laws = [
        ("just yielding", Hardening::Ideal { yield_stress: 0.016 * modulus }),
        ("deep plastic", Hardening::Ideal { yield_stress: 0.001 * modulus }),
        ("strong hardening", Hardening::Power { yield_stress: 0.0015 * modulus, coefficient: 0.005 * modulus, exponent: 0.4 }),
    ];
    let mut all = Vec::new();
    for (name, hardening) in laws {
        for friction in [0.1, 0.3, 0.6] {
            let mut case = case.clone();
            case.material.hardening = hardening.clone();
            case.contact.friction = Friction::Coefficient(friction);
            all.push((name, case));
        }
    }
    all
}
