//! Draws cases: every law, stiffness, friction, depth and kind of path.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Ranges of what is drawn.
const YIELD_RATIO: [f64; 2] = [20.0, 20_000.0]; // E/sigma_Y, evenly in its logarithm
const POISSON: [f64; 2] = [0.0, 0.49];
const DEPTH: [f64; 2] = [1e-4, 0.1]; // h/R, evenly in its logarithm
const FRICTION: [f64; 2] = [0.0, 1.5];
/// Displacements of a shear of given length over sqrt(2 R h), evenly in the logarithm: from well
/// within stick to far into slip.
const SHEAR: [f64; 2] = [2e-4, 0.5];

/// Radius of a rigid sphere over that of the body, evenly in its logarithm.
const OPPONENT: [f64; 2] = [0.2, 5.0];

/// Young's modulus of another body that deforms over that of the body, evenly in its logarithm.
const STIFFNESS: [f64; 2] = [0.05, 20.0];

/// What the body is pressed against.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Against {
    Plane,
    /// Its equal; its spheres move as far as the one does.
    Equal,
    /// A rigid sphere, and every second body a flat; it moves as far in R*, or in the smaller
    /// radius.
    Rigid,
    /// Another body of another material that deforms: a sphere, or one of the two a flat.
    Unlike,
}

impl Against {
    /// The opponents in turn.
    pub fn of(index: usize) -> Self {
        [Self::Plane, Self::Equal, Self::Rigid, Self::Unlike][index % 4]
    }
}

/// What is drawn, and from where to where.
pub fn ranges() -> String {
    let range = |[low, high]: [f64; 2]| format!("{low} to {high}");
    format!(
        "E/sigma_Y {}, or elastic; nu {}; h/R or h/R* {}; mu {}, one in ten 0, two in ten full stick; shear over sqrt(2 R h) {}; \
         radius of the opponent {}, its E {} times the body's; seven hardening laws, twelve kinds of path",
        range(YIELD_RATIO),
        range(POISSON),
        range(DEPTH),
        range(FRICTION),
        range(SHEAR),
        range(OPPONENT),
        range(STIFFNESS),
    )
}

/// Elements along the contact radius.
#[derive(Clone, Copy, Debug)]
pub struct Elements {
    pub inside: usize,
    pub at_surface: usize,
}

/// Case number `index` of a seed, as a case file; the same as long as the ranges are.
pub fn case_text(seed: u64, index: usize, mesh: Elements, against: Against) -> String {
    let mut draw = Draw(ChaCha8Rng::seed_from_u64(seed));
    draw.0.set_stream(index as u64);
    let radius = draw.logarithmic([1e-3, 1e3]);
    let modulus = draw.logarithmic([1e-2, 1e6]);
    let nu = draw.even(POISSON);
    let yield_ratio = draw.logarithmic(YIELD_RATIO);
    let h = draw.logarithmic(DEPTH);
    let hardening = hardening(&mut draw, modulus, 1.0 / yield_ratio);
    let friction = match draw.one_of(10) {
        0 => "0.0".to_owned(),
        1 | 2 => "\"stick\"".to_owned(),
        _ => format!("{:?}", draw.even(FRICTION)),
    };
    let path = path(&mut draw, h, friction == "\"stick\"");
    let (body, opponent, travel) = match against {
        Against::Plane => ("", String::new(), radius),
        Against::Equal => ("", "[opponent]\nequal = true\n".to_owned(), 2.0 * radius),
        Against::Rigid => {
            // Drawn last, so that all else is as over the plane.
            let other = radius * draw.logarithmic(OPPONENT);
            let opponent = format!("[opponent]\nrigid = true\nradius = {other:?}\n");
            let effective = radius * other / (radius + other);
            if draw.chance(0.5) { ("flat = true\n", opponent, radius.min(other)) } else { ("", opponent, effective) }
        }
        Against::Unlike => {
            let other = radius * draw.logarithmic(OPPONENT);
            let (shape, body, travel) = match draw.one_of(4) {
                0 => ("flat = true".to_owned(), "", radius),
                1 => (format!("radius = {other:?}"), "flat = true\n", radius.min(other)),
                _ => (format!("radius = {other:?}"), "", radius * other / (radius + other)),
            };
            let (modulus, nu) = (modulus * draw.logarithmic(STIFFNESS), draw.even(POISSON));
            let yield_ratio = draw.logarithmic(YIELD_RATIO);
            let hardening = self::hardening(&mut draw, modulus, 1.0 / yield_ratio);
            let opponent = format!(
                "[opponent]\n{shape}\n[opponent.material]\nyoungs_modulus = {modulus:?}\npoissons_ratio = {nu:?}\n\
                 [opponent.material.hardening]\n{hardening}\n"
            );
            (body, opponent, travel)
        }
    };
    let segments: String = path
        .iter()
        .map(|segment| match segment {
            Segment::Press(h) => format!("[[path]]\nindentation = {:?}\n", h * travel),
            Segment::Shear(d, held) => format!("[[path]]\nshear = {:?}\n{}", d * travel, hold(*held)),
            Segment::FullSlip(held) => format!("[[path]]\nshear = \"full-slip\"\n{}", hold(*held)),
            Segment::Release => "[[path]]\nrelease = true\n".to_owned(),
            Segment::ReleaseTo(share) => format!("[[path]]\nrelease = {share:?}\n"),
            Segment::Oblique(h, d) => format!("[[path]]\nindentation = {:?}\nshear = {:?}\n", h * travel, d * travel),
        })
        .collect();
    format!(
        "[sphere]\nradius = {radius:?}\n{body}[material]\nyoungs_modulus = {modulus:?}\npoissons_ratio = {nu:?}\n[material.hardening]\n{hardening}\n\
         [contact]\nfriction = {friction}\n{opponent}[mesh]\nelements_per_contact_radius = {}\nsurface_elements_per_contact_radius = {}\n{segments}",
        mesh.inside, mesh.at_surface
    )
}

fn hold(force: bool) -> &'static str {
    if force { "hold = \"normal-force\"\n" } else { "" }
}

/// A segment, lengths over R.
enum Segment {
    Press(f64),
    Shear(f64, bool),
    FullSlip(bool),
    Release,
    ReleaseTo(f64),
    Oblique(f64, f64),
}

struct Draw(ChaCha8Rng);

impl Draw {
    fn even(&mut self, [low, high]: [f64; 2]) -> f64 {
        low + (high - low) * self.0.random::<f64>()
    }
    fn logarithmic(&mut self, [low, high]: [f64; 2]) -> f64 {
        (self.even([low.ln(), high.ln()])).exp()
    }
    fn one_of(&mut self, n: usize) -> usize {
        self.0.random_range(0..n)
    }
    fn chance(&mut self, share: f64) -> bool {
        self.0.random::<f64>() < share
    }
}

/// Hardening as TOML for a yield strain sigma_Y/E.
fn hardening(draw: &mut Draw, modulus: f64, yield_strain: f64) -> String {
    let y = yield_strain * modulus;
    match draw.one_of(7) {
        0 => "law = \"elastic\"".to_owned(),
        1 => format!("law = \"ideal\"\nyield_stress = {y:?}"),
        2 => format!("law = \"linear\"\nyield_stress = {y:?}\nmodulus = {:?}", modulus * draw.logarithmic([1e-4, 0.1])),
        3 => format!(
            "law = \"power\"\nyield_stress = {y:?}\ncoefficient = {:?}\nexponent = {:?}",
            y * draw.logarithmic([0.3, 10.0]),
            draw.even([0.1, 1.0])
        ),
        4 => {
            // sigma = sigma_0 eps^(1/m) meets Hooke's line at E (sigma_0/E)^(m/(m-1)).
            let m = draw.even([2.0, 12.0]);
            format!("law = \"hollomon\"\ncoefficient = {:?}\nexponent = {m:?}", modulus * yield_strain.powf((m - 1.0) / m))
        }
        5 => format!(
            "law = \"voce\"\nyield_stress = {y:?}\nsaturation_stress = {:?}\nrate = {:?}",
            y * draw.even([1.1, 3.0]),
            draw.logarithmic([2.0, 100.0])
        ),
        _ => {
            let steps: Vec<f64> = (0..3).map(|_| draw.even([0.02, 0.5])).collect();
            format!(
                "law = \"table\"\npoints = [[0.0, {y:?}], [0.02, {:?}], [0.1, {:?}], [0.5, {:?}]]",
                y * (1.0 + steps[0]),
                y * (1.0 + steps[0] + steps[1]),
                y * (1.0 + steps[0] + steps[1] + steps[2])
            )
        }
    }
}

fn path(draw: &mut Draw, h: f64, stick: bool) -> Vec<Segment> {
    use Segment::{FullSlip, Oblique, Press, Release, ReleaseTo, Shear};
    let scale = (2.0 * h).sqrt();
    let d = (scale * draw.logarithmic(SHEAR)).min(0.45);
    let held = draw.chance(0.25);
    // What never slips fully is sheared by a length.
    let far = |d: f64, held: bool| if stick { Shear(d, held) } else { FullSlip(held) };
    match draw.one_of(12) {
        0 => vec![Press(h), far(d, false)],
        1 => vec![Press(h), Shear(d, held)],
        2 => vec![Press(h), Shear(d, held), Shear(-d, held)],
        3 => vec![Press(h), Shear(d, false), Shear(-d, false), Shear(d, false), Shear(-d, false)],
        4 => vec![Press(h), Release],
        5 => vec![Press(h), Shear(d, held), Release],
        6 => vec![Press(h), far(d, true)],
        7 => vec![Press(h), ReleaseTo(draw.even([0.1, 0.9])), Shear(d, held), Press(h)],
        8 => vec![Press(h), Shear(d, false), ReleaseTo(draw.even([0.1, 0.9])), Shear(-d, false)],
        // Obliquely in, up to 75 degrees off the normal, and out another way.
        9 => {
            let [along, back] = [draw.even([-3.7, 3.7]), draw.even([-3.7, 3.7])].map(|slope| (slope * h).clamp(-0.45, 0.45));
            vec![Oblique(h, along), Oblique(0.0, back)]
        }
        10 => {
            let end = draw.even([0.8, 1.5]) * h;
            vec![Press(h), Oblique(end, d), Oblique(0.95 * end, -d)]
        }
        _ => vec![Press(0.6 * h), Shear(d, held), Press(h), Shear(draw.even([-1.0, 1.0]) * d, false)],
    }
}
