//! Test vectors: random paths of random contacts and what the Rust update answers.

use std::f64::consts::TAU;
use std::fmt::Write;

use crate::analytical::ElasticSphere;
use crate::case::Material;
use crate::law::LawError;
use crate::law::contact::{ContactParameters, ContactState};
use crate::law::folds::splitmix;
use crate::law::model::Law;
use crate::law::tabulated::Tabulated;
use crate::law::variables::Body;
use crate::material::{Hardening, MaterialError};

/// Seed of the vectors that are exported.
pub const SEED: u64 = 2014;
/// Paths of every hardening law.
const PATHS: usize = 2;
/// Legs of a path.
const LEGS: usize = 10;
/// Steps of a leg.
const STEPS: usize = 15;

/// The columns: the path (a new number is a new contact), its material with the numbers of the
/// hardening law in the exports' order, R, mu, the indentation to go to, the tangential increment,
/// the axes' turn before it; then the answer, and last the state's x for information (near 1 it
/// hangs on the last digits of F_N, which hangs on x least there).
pub const COLUMNS: &str = "path,E,nu,hardening,stress,second,third,R,mu,h,d0,d1,cosine,sine,\
                           f_n,f_t0,f_t1,k00,k01,k10,k11,kn,kn0,kn1,a,energy,x";

/// The same numbers on every machine and for every version.
struct Random(u64);

impl Random {
    /// A number in \[from, to).
    fn between(&mut self, from: f64, to: f64) -> f64 {
        let z = splitmix(&mut self.0);
        from + (to - from) * ((z >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// A hardening law by the number it has in the exports, and its numbers there.
fn hardening(kind: usize, e: f64, random: &mut Random) -> Result<(Hardening<f64>, [f64; 3]), MaterialError> {
    let stress = e * (10f64).powf(random.between(-4.0, -1.8));
    Ok(match kind {
        1 => (Hardening::ideal(stress)?, [stress, 0.0, 0.0]),
        2 => {
            let modulus = e * random.between(0.0, 0.1);
            (Hardening::linear(stress, modulus)?, [stress, modulus, 0.0])
        }
        3 => {
            let (coefficient, exponent) = (stress * random.between(0.5, 5.0), random.between(0.1, 0.9));
            (Hardening::power(stress, coefficient, exponent)?, [stress, coefficient, exponent])
        }
        4 => {
            let (coefficient, exponent) = (4.0 * stress, random.between(2.0, 10.0));
            (Hardening::hollomon(coefficient, exponent, e)?, [coefficient, exponent, 0.0])
        }
        5 => {
            let (saturation, rate) = (stress * random.between(1.0, 3.0), random.between(1.0, 30.0));
            (Hardening::voce(stress, saturation, rate)?, [stress, saturation, rate])
        }
        _ => (Hardening::Elastic, [0.0; 3]),
    })
}

/// The vectors as CSV: paths of every hardening law but the table, in random directions, with
/// press, shear to full slip and beyond, reversal, shear while h changes, partial unloading, loss
/// of contact, return, and turning axes.
pub fn vectors(law: &Law, seed: u64) -> String {
    let mut text = format!("{COLUMNS}\n");
    let mut random = Random(seed);
    for path in 0..6 * PATHS {
        // What no law is made for (a number that is not positive) is left out, not invented.
        let _ = write_path(law, path, &mut random, &mut text);
    }
    text
}

/// The vectors of a table: paths of its material and its friction with spheres of any radius and
/// units.
///
/// # Errors
/// A table without numbers.
pub fn table_vectors(table: &Tabulated, seed: u64) -> Result<String, LawError> {
    Ok(unit_vectors(&table.unit_parameters()?, &table.material()?, table.range.to, seed))
}

/// The vectors of one material and one friction: paths with spheres of any radius and units, to and
/// beyond `deepest` over R. `unit` and `material` are those of a sphere with R = 1 and E = 1.
pub fn unit_vectors(unit: &ContactParameters, material: &Material, deepest: f64, seed: u64) -> String {
    let mut text = format!("{COLUMNS}\n");
    let mut random = Random(seed);
    let (kind, numbers, stresses) = super::hardening_numbers(&material.hardening);
    for path in 0..6 * PATHS {
        let e = (10f64).powf(random.between(0.0, 12.0));
        let radius = (10f64).powf(random.between(-4.0, 1.0));
        let pair = unit.scaled(radius, e);
        let numbers = std::array::from_fn(|i| if stresses[i] { numbers[i] * e } else { numbers[i] });
        let contact = Contact { e, nu: material.poissons_ratio, kind: kind.into(), numbers, radius, pair };
        let deepest = 1.2 * deepest * (10f64).powf(random.between(-2.0, 0.0));
        write_steps(path, &contact, deepest * radius, &mut random, &mut text);
    }
    text
}

/// What a path is of.
struct Contact {
    e: f64,
    nu: f64,
    kind: usize,
    numbers: [f64; 3],
    radius: f64,
    pair: ContactParameters,
}

/// Writes one path; `None` if there is no contact for its numbers.
fn write_path(law: &Law, path: usize, random: &mut Random, text: &mut String) -> Option<()> {
    let (e, nu) = ((10f64).powf(random.between(0.0, 12.0)), random.between(0.0, 0.5));
    let (radius, friction) = ((10f64).powf(random.between(-4.0, 1.0)), random.between(0.02, 1.0));
    // The ends of both ranges too.
    let (nu, friction) = match path % 10 {
        3 => (0.5, friction),
        5 => (0.0, friction),
        7 => (nu, 0.0),
        _ => (nu, friction),
    };
    let kind = path % 6;
    let (hardening, numbers) = hardening(kind, e, random).ok()?;
    let body = Body { sphere: ElasticSphere { radius, youngs_modulus: e, poissons_ratio: nu }, hardening };
    let pair = ContactParameters::new(law, &body, friction).ok()?;
    let deepest = radius * (10f64).powf(random.between(-4.0, -0.8));
    write_steps(path, &Contact { e, nu, kind, numbers, radius, pair }, deepest, random, text);
    Some(())
}

/// Writes the steps of one path that goes to about `deepest`.
fn write_steps(path: usize, contact: &Contact, deepest: f64, random: &mut Random, text: &mut String) {
    let &Contact { e, nu, kind, numbers, radius, ref pair } = contact;
    let friction = pair.friction;
    let slip = pair.virgin(deepest).point.delta_t_slip;
    let depth = pair.virgin(deepest).depth;
    let mut state = ContactState::default();
    let (mut h, mut d) = (-0.01 * deepest, [0.0; 2]);
    for leg in 0..LEGS {
        let from = (h, d);
        let mut to = from;
        let choice = random.between(0.0, 1.0);
        if leg == 0 {
            to.0 = 0.7 * deepest;
        } else if choice < 0.35 {
            to.0 = state.h_max - depth * random.between(-0.3, 1.2);
        } else if choice < 0.5 {
            to.0 = state.h_max * random.between(1.0, 1.3);
        }
        if leg > 0 && choice > 0.2 {
            let (angle, size) = (random.between(0.0, TAU), slip * random.between(0.05, 2.0));
            to.1 = [size * angle.cos(), size * angle.sin()];
        }
        let turn = if choice > 0.8 { random.between(-0.1, 0.1) } else { 0.0 };
        for k in 1..=STEPS {
            let share = k as f64 / STEPS as f64;
            h = from.0 + (to.0 - from.0) * share;
            let target: [f64; 2] = std::array::from_fn(|i| from.1[i] + (to.1[i] - from.1[i]) * share);
            let increment = [target[0] - d[0], target[1] - d[1]];
            d = target;
            let (cosine, sine) = (turn.cos(), turn.sin());
            state.rotate(cosine, sine);
            let (next, out) = pair.update(&state, h, increment);
            state = next;
            let [s0, s1, s2] = numbers;
            let [[k00, k01], [k10, k11]] = out.df_t_ddelta;
            // Writing to a String cannot fail.
            let _ = write!(text, "{path},{e:?},{nu:?},{kind},{s0:?},{s1:?},{s2:?},{radius:?},{friction:?}");
            for value in [
                h,
                increment[0],
                increment[1],
                cosine,
                sine,
                out.f_n,
                out.f_t[0],
                out.f_t[1],
                k00,
                k01,
                k10,
                k11,
                out.df_n_dh,
                out.df_n_ddelta[0],
                out.df_n_ddelta[1],
                out.a,
                pair.stored_energy(&state),
                state.x,
            ] {
                let _ = write!(text, ",{value:?}");
            }
            text.push('\n');
        }
    }
}
