//! Random contacts on random paths of the kinds that particles take.

use super::protocol::slip_displacement;
use super::{Path, meshed};
use crate::case::{Case, Equator, Friction, Hardening, Hold, Material, Opponent, Segment, ShearTarget, Sphere};
use crate::law::{LawError, LawFile};
use crate::random::Seeded;

/// The kinds of path, in the order in which they come.
pub const KINDS: [&str; 6] = [
    "partial release, pressed on",
    "reversals of falling amplitude",
    "press and shear in stairs",
    "unloaded and reloaded while sheared",
    "oblique, then back",
    "grazing impact",
];

/// From where to where contacts are drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ranges {
    /// nu.
    pub poisson: [f64; 2],
    /// mu, evenly in its logarithm.
    pub friction: [f64; 2],
    /// E/sigma_Y, evenly in its logarithm.
    pub yield_ratio: [f64; 2],
    /// h of one body over R, or R* of unlike bodies, evenly in its logarithm.
    pub depth: [f64; 2],
    /// E of an unlike body over that of the sphere, and its radius over R, evenly in their
    /// logarithms.
    pub unlike: [f64; 2],
}

impl Default for Ranges {
    fn default() -> Self {
        Self {
            poisson: [0.0, 0.49],
            friction: [0.05, 1.0],
            yield_ratio: [12.0, 5000.0],
            depth: [0.001, 0.15],
            unlike: [1.0 / 3.0, 3.0],
        }
    }
}

impl std::fmt::Display for Ranges {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let range = |[low, high]: [f64; 2]| format!("{low} to {high}");
        write!(
            f,
            "nu {}, mu {}, E/sigma_Y {}, h/R {}; an unlike body has {:.2} to {} times E and R, or is flat",
            range(self.poisson),
            range(self.friction),
            range(self.yield_ratio),
            range(self.depth),
            self.unlike[0],
            self.unlike[1]
        )
    }
}

/// What a contact is with, in words.
pub fn opponent_of(case: &Case) -> &'static str {
    match &case.opponent {
        None => "plane",
        Some(Opponent::Equal) => "equal spheres",
        Some(_) => "unlike bodies",
    }
}

fn logarithmic(draw: &mut Seeded, [low, high]: [f64; 2]) -> f64 {
    draw.between(low.ln(), high.ln()).exp()
}

fn hardening(draw: &mut Seeded, modulus: f64, yield_stress: f64) -> Hardening {
    match draw.bits() % 6 {
        0 => Hardening::Ideal { yield_stress },
        1 => Hardening::Linear { yield_stress, modulus: modulus * logarithmic(draw, [1e-3, 0.1]) },
        2 => Hardening::Power {
            yield_stress,
            coefficient: yield_stress * logarithmic(draw, [0.5, 5.0]),
            exponent: draw.between(0.1, 0.7),
        },
        3 => {
            // sigma_Y lies where sigma_0 eps^(1/m) meets Hooke's line.
            let exponent = logarithmic(draw, [2.5, 10.0]);
            Hardening::Hollomon { coefficient: yield_stress * (modulus / yield_stress).powf(1.0 / exponent), exponent }
        }
        4 => Hardening::Voce {
            yield_stress,
            saturation_stress: yield_stress * draw.between(1.2, 4.0),
            rate: logarithmic(draw, [4.0, 100.0]),
        },
        _ => {
            let (mut strain, mut stress, mut slope) = (0.0, yield_stress, yield_stress * logarithmic(draw, [5.0, 60.0]));
            let mut points = vec![[strain, stress]];
            for step in [0.02, 0.08, 0.3, 0.6] {
                strain += step;
                stress += slope * step;
                points.push([strain, stress]);
                slope *= draw.between(0.1, 0.5);
            }
            Hardening::Table { points }
        }
    }
}

fn material(draw: &mut Seeded, modulus: f64, ranges: &Ranges) -> Material {
    let poissons_ratio = draw.between(ranges.poisson[0], ranges.poisson[1]);
    let yield_stress = modulus / logarithmic(draw, ranges.yield_ratio);
    Material { youngs_modulus: modulus, poissons_ratio, hardening: hardening(draw, modulus, yield_stress) }
}

/// Contact number `index` of a seed, R = 1 and E = 1, with a press to its depth: in turn on a
/// plane, with an equal sphere and with an unlike body; `base` has all that is not drawn.
pub fn drawn(base: &Case, ranges: &Ranges, seed: u64, index: usize) -> Case {
    let mut draw = of(seed, index);
    let material = material(&mut draw, 1.0, ranges);
    let friction = logarithmic(&mut draw, ranges.friction);
    let depth = logarithmic(&mut draw, ranges.depth);
    let opponent = match index % 3 {
        0 => None,
        1 => Some(Opponent::Equal),
        _ => {
            let modulus = logarithmic(&mut draw, ranges.unlike);
            let radius = (!draw.bits().is_multiple_of(3)).then(|| logarithmic(&mut draw, ranges.unlike));
            let other = self::material(&mut draw, modulus, ranges);
            Some(Opponent::Deforming { radius, material: other })
        }
    };
    let mut case = base.clone();
    case.sphere = Sphere { radius: 1.0, flat: false, equator: Equator::Clamped };
    case.material = material;
    case.contact.friction = Friction::Coefficient(friction);
    case.opponent = opponent;
    let indentation = match case.opponent {
        None => depth,
        Some(Opponent::Equal) => 2.0 * depth,
        Some(_) => 2.0 * depth * case.effective_radius(),
    };
    case.path = vec![Segment::Indentation { indentation }];
    case
}

fn of(seed: u64, index: usize) -> Seeded {
    // The generator's own numbers as seeds of the contacts, so that neighbours have nothing in
    // common.
    let mut seeds = Seeded::new(seed);
    let mut number = seeds.bits();
    for _ in 0..index {
        number = seeds.bits();
    }
    Seeded::new(number)
}

/// So many random paths: of the contact of `case`, with its depth, or of contacts that are
/// [`drawn`] where it is `None`; the kinds in turn, each with all three opponents before the next.
/// The displacements go with the one at which the law has 0.99 mu.
///
/// # Errors
/// The law says nothing of a contact.
pub fn random_paths(
    law: &LawFile,
    case: Option<&Case>,
    base: &Case,
    (count, seed): (usize, u64),
    elements: usize,
) -> Result<Vec<Path>, LawError> {
    (0..count)
        .map(|index| {
            let kind = kind_of(index, case.is_some());
            let case = case.map_or_else(|| drawn(base, &Ranges::default(), seed, index), Case::clone);
            let h = case.greatest_indentation();
            let slip = slip_displacement(&law.contact_parameters(&case)?, h);
            // Not the numbers of the contact.
            let mut draw = of(seed ^ 0x5bd1_e995, index);
            let mut case = meshed(&case, elements);
            case.path = within_reach(path(&mut draw, kind, h, slip), &case);
            Ok(Path { name: KINDS[kind], case })
        })
        .collect()
}

/// The kind of path number `index`, of one contact or of contacts that are drawn.
fn kind_of(index: usize, one_contact: bool) -> usize {
    if one_contact { index % KINDS.len() } else { index / 3 % KINDS.len() }
}

/// A path of a kind to the depth `h`, with shears that go with the displacement `slip`.
fn path(draw: &mut Seeded, kind: usize, h: f64, slip: f64) -> Vec<Segment> {
    let press = |indentation: f64| Segment::Indentation { indentation };
    let shear = |delta: f64| Segment::Shear { shear: ShearTarget::Displacement(delta), hold: Hold::Indentation };
    let both = |indentation: f64, shear: f64| Segment::Oblique { indentation, shear };
    match kind {
        0 => {
            let first = slip * draw.between(0.3, 1.0);
            let share = draw.between(0.15, 0.7);
            let on = slip * draw.between(0.5, 1.2);
            vec![press(0.8 * h), shear(first), Segment::Release { share }, press(h), shear(first + on)]
        }
        1 => {
            let (first, ratio) = (slip * draw.between(0.6, 1.2), -draw.between(0.55, 0.75));
            let mut legs = vec![press(h)];
            legs.extend((0..5).map(|i| shear(first * ratio.powi(i))));
            legs
        }
        2 => {
            let heights = [draw.between(0.25, 0.45), draw.between(0.5, 0.75), 1.0];
            let mut delta = 0.0;
            let stair = |height: f64| {
                delta += slip * height.sqrt() * draw.between(0.3, 0.9);
                [press(height * h), shear(delta)]
            };
            heights.into_iter().flat_map(stair).collect()
        }
        3 => {
            let far = slip * draw.between(0.5, 1.2);
            let share = draw.between(0.12, 0.5);
            let back = -far * draw.between(0.15, 0.3);
            let first = h / 1.1;
            vec![press(first), shear(far), Segment::Release { share }, shear(back), press(first), both(h, far)]
        }
        4 => {
            let first = 0.9 * h * draw.between(10.0, 60.0).to_radians().tan();
            let back = first * draw.between(-1.5, 0.8);
            let last = first * draw.between(1.0, 2.0);
            vec![both(0.9 * h, first), both(h, back), shear(last)]
        }
        _ => {
            let first = h * draw.between(50.0, 77.0).to_radians().tan();
            let further = first * draw.between(0.35, 0.5);
            vec![both(h, first), both(0.9 * h, first + further), both(0.0, first + 2.0 * further)]
        }
    }
}

/// Displacement over the smaller radius up to which paths go: half of it is the most of a case.
const REACH: f64 = 0.45;

/// The path with its displacements in proportion, none beyond what is simulated: deep and grazing
/// ones would be.
fn within_reach(mut path: Vec<Segment>, case: &Case) -> Vec<Segment> {
    let most = REACH * case.opponent_radius().unwrap_or(f64::INFINITY).min(case.sphere.radius);
    let mut displacements: Vec<&mut f64> = path
        .iter_mut()
        .filter_map(|segment| match segment {
            Segment::Oblique { shear, .. } | Segment::Shear { shear: ShearTarget::Displacement(shear), .. } => Some(shear),
            _ => None,
        })
        .collect();
    let furthest = displacements.iter().map(|delta| delta.abs()).fold(0.0, f64::max);
    if furthest > most {
        displacements.iter_mut().for_each(|delta| **delta *= most / furthest);
    }
    path
}

#[cfg(test)]
mod tests {
    use super::*;

    fn base() -> Case {
        Case::parse(include_str!("../../../fixtures/cases/ideal.toml"), "ideal.toml", &[]).unwrap()
    }

    #[test]
    fn contacts_are_those_of_the_seed_and_within_the_ranges() {
        let ranges = Ranges::default();
        for index in 0..60 {
            let case = drawn(&base(), &ranges, 7, index);
            assert_eq!(case, drawn(&base(), &ranges, 7, index));
            assert_ne!(case, drawn(&base(), &ranges, 8, index));
            let Friction::Coefficient(mu) = case.contact.friction else { panic!("stick") };
            assert!((0.05..1.0).contains(&mu) && case.material.poissons_ratio < 0.49);
            assert!(case.material.constants::<f64>().is_ok(), "{:?}", case.material);
        }
    }

    #[test]
    fn every_kind_meets_every_opponent_in_cases_that_can_be_read() {
        let mut met = Vec::new();
        for index in 0..90 {
            let mut case = drawn(&base(), &Ranges::default(), 3, index);
            let kind = kind_of(index, false);
            let h = case.greatest_indentation();
            case.path = within_reach(path(&mut of(3, index), kind, h, 0.1 * h), &case);
            met.push((KINDS[kind], opponent_of(&case)));
            if let Err(error) = Case::parse(&case.to_toml(), "path", &[]) {
                panic!("{index}: {error}");
            }
        }
        met.sort_unstable();
        met.dedup();
        assert_eq!(met.len(), 3 * KINDS.len());
        // Of one contact each path is of another kind.
        assert_eq!((0..6).map(|index| kind_of(index, true)).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5]);
    }
}
