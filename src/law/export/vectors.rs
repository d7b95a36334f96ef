//! Test vectors: random paths of random contacts.

use crate::case::{Hardening, Material};
use crate::contact_law::ContactParameters;
use crate::contact_law::export::vectors::{COLUMNS, Contact, write_steps};
use crate::random::Seeded;

/// Seed of the vectors that are exported.
pub const SEED: u64 = 2014;
/// Paths.
const PATHS: usize = 12;

/// The vectors of one material and one friction: paths with spheres of any radius and units, to and
/// beyond `deepest` over R. `unit` and `material` are those of a sphere with R = 1 and E = 1.
pub fn unit_vectors(unit: &ContactParameters, material: &Material, deepest: f64, seed: u64) -> String {
    let mut text = format!("{COLUMNS}\n");
    let mut random = Seeded::new(seed);
    let (kind, numbers, stresses) = hardening_numbers(&material.hardening);
    for path in 0..PATHS {
        let e = (10f64).powf(random.between(0.0, 12.0));
        let radius = (10f64).powf(random.between(-4.0, 1.0));
        let pair = unit.clone().scaled(radius, e);
        let numbers = std::array::from_fn(|i| if stresses[i] { numbers[i] * e } else { numbers[i] });
        let contact = Contact { e, nu: material.poissons_ratio, kind: kind.into(), numbers, radius, pair };
        let deepest = 1.2 * deepest * (10f64).powf(random.between(-2.0, 0.0));
        write_steps(path, &contact, deepest * radius, &mut random, &mut text);
    }
    text
}

/// The code of a hardening law, its numbers in the exports, and which of them are stresses.
fn hardening_numbers(hardening: &Hardening) -> (u8, [f64; 3], [bool; 3]) {
    let (law, numbers) = (hardening.kind(), hardening.numbers());
    let parameters = law.parameters();
    (
        law.code(),
        std::array::from_fn(|i| numbers.get(i).copied().unwrap_or(0.0)),
        std::array::from_fn(|i| parameters.get(i).is_some_and(|parameter| parameter.is_stress)),
    )
}
