//! Paths on which the direction of delta_T turns, over a plane or between two spheres.

use std::f64::consts::TAU;

use super::protocol::slip_displacement;
use super::{Path, meshed};
use crate::case::{Case, Friction, Hold, Motion, Segment, ShearTarget};
use crate::contact_law::ContactParameters;

/// Sides of a circle.
const SIDES: usize = 24;
/// Steps of a shear by the slip displacement along one of many short segments.
const STEPS: usize = 4;

/// Circles of half and nine tenths of the slip displacement of the law, a figure of eight and a
/// flip by 90 degrees, for the material, the friction and the greatest depth of `case`: the paths
/// of `fixtures/paths/vector` on which nothing twists or rolls. None
/// where there is no friction.
pub fn turning_paths(case: &Case, parameters: &ContactParameters, elements: usize) -> Vec<Path> {
    if case.contact.friction == Friction::Coefficient(0.0) {
        return Vec::new();
    }
    let h = case.greatest_indentation();
    let slip = slip_displacement(parameters, h);
    let radius = 0.9 * slip;
    let out = |r: f64| [0.25, 0.5, 0.75, 1.0].map(|share| along(share * r));
    let corner = |i: usize| (TAU * i as f64 / SIDES as f64).sin_cos();
    let circle = |r: f64| {
        let sides = (1..=SIDES).map(|i| to([r * corner(i).1, r * corner(i).0]));
        out(r).into_iter().chain(sides).collect::<Vec<_>>()
    };
    // Gerono's: through the middle twice, back to the start.
    let eight = (1..=SIDES).map(|i| to([radius * corner(i).0, 0.5 * radius * corner(2 * i).0])).collect();
    let flip = out(radius).into_iter().chain([1.0 / 3.0, 2.0 / 3.0, 1.0].map(|share| to([radius, share * radius])));
    let paths: [(&str, Vec<Segment>); 4] = [
        ("circle, 50 % of slip", circle(0.5 * slip)),
        ("circle, 90 % of slip", circle(radius)),
        ("figure of eight", eight),
        ("flip by 90 degrees", flip.collect()),
    ];
    let press = Segment::Indentation { indentation: h };
    paths
        .into_iter()
        .map(|(name, sheared)| {
            let mut case = meshed(case, elements);
            case.solver.shear_steps = Some(if sheared.len() > SIDES / 2 { STEPS } else { 2 * STEPS });
            case.path = [vec![press], sheared].concat();
            Path { name, case }
        })
        .collect()
}

fn along(delta_t: f64) -> Segment {
    Segment::Shear { shear: ShearTarget::Displacement(delta_t), hold: Hold::Indentation }
}

fn to(shear: [f64; 2]) -> Segment {
    let to = Motion { indentation: None, shear: Some(shear), roll: None, twist: None };
    Segment::Motion { to, hold: Hold::Indentation }
}
