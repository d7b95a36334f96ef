//! Paths on which the direction of delta_T turns, and paths on which a sphere twists or rolls, over
//! a plane or between two spheres.

use std::f64::consts::TAU;

use super::protocol::slip_displacement;
use super::{Path, meshed};
use crate::case::{Case, Friction, Hold, Motion, Segment, ShearTarget};
use crate::contact_law::ContactParameters;

/// Sides of a circle.
const SIDES: usize = 24;
/// Steps of a shear by the slip displacement along one of many short segments.
const STEPS: usize = 4;

/// Twist over the slip displacement, as a displacement at the contact's edge, and roll as one over
/// the contact radius.
const TWIST: f64 = 1.5;
const ROLL: f64 = 0.5;
/// Of an impact, over its depth: how far it has sheared, twisted and rolled at the deepest and at
/// the end.
const IMPACT: [[f64; 4]; 2] = [[0.6, 0.2, 0.4, 0.3], [0.8, 0.3, 0.6, 0.5]];

/// The paths of `fixtures/paths/vector` for the material, the friction and the greatest depth of
/// `case`. The direction turns along circles of half and nine tenths of the slip displacement of
/// the law, a figure of eight and a flip by 90 degrees; a sphere twists or rolls in a shear and
/// then a twist, a twist and then a shear, a roll forth and back at constant F_N, and an oblique
/// impact with spin. None where there is no friction.
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
    // Contact radius of a plastic contact; that of an elastic one is 0.7 of it.
    let a = (2.0 * case.effective_radius() * h).sqrt();
    let twist = || turned(Motion { twist: Some(TWIST * slip / a), ..Motion::default() }, Hold::Indentation);
    let roll = |about_y: f64| turned(Motion { roll: Some([0.0, about_y]), ..Motion::default() }, Hold::NormalForce);
    let rolled = vec![roll(ROLL * a / case.sphere.radius), roll(0.0)];
    let hit = |[x, y, twist, roll]: [f64; 4], depth: f64| {
        let to = Motion {
            indentation: Some(depth),
            shear: Some([x * h, y * h]),
            twist: Some(twist * h / a),
            roll: Some([0.0, roll * h / case.sphere.radius]),
        };
        Segment::Motion { to, hold: Hold::Indentation }
    };
    let sheared_first = out(radius).into_iter().chain([twist()]).collect();
    let twisted_first = std::iter::once(twist()).chain(out(radius)).collect();
    let paths: [(&str, Vec<Segment>); 7] = [
        ("circle, 50 % of slip", circle(0.5 * slip)),
        ("circle, 90 % of slip", circle(radius)),
        ("figure of eight", eight),
        ("flip by 90 degrees", flip.collect()),
        ("shear, then twist", sheared_first),
        ("twist, then shear", twisted_first),
        ("roll forth and back, F_N held", rolled),
    ];
    let press = Segment::Indentation { indentation: h };
    let of = |name: &'static str, steps: usize, path: Vec<Segment>| {
        let mut case = meshed(case, elements);
        case.solver.shear_steps = Some(steps);
        case.path = path;
        Path { name, case }
    };
    let impact = of("impact with spin", 2 * STEPS, vec![hit(IMPACT[0], h), hit(IMPACT[1], 0.0)]);
    let pressed = paths.into_iter().map(|(name, sheared)| {
        let steps = if sheared.len() > SIDES / 2 { STEPS } else { 2 * STEPS };
        of(name, steps, [vec![press], sheared].concat())
    });
    pressed.chain([impact]).collect()
}

fn turned(to: Motion, hold: Hold) -> Segment {
    Segment::Motion { to, hold }
}

fn along(delta_t: f64) -> Segment {
    Segment::Shear { shear: ShearTarget::Displacement(delta_t), hold: Hold::Indentation }
}

fn to(shear: [f64; 2]) -> Segment {
    turned(Motion { shear: Some(shear), ..Motion::default() }, Hold::Indentation)
}
