//! Test vectors: random paths of random contacts.

use crate::analytical::ElasticSphere;
use crate::case::Material;
use crate::contact_law::ContactParameters;
use crate::contact_law::export::vectors::{COLUMNS, Contact, write_steps};
use crate::law::LawError;
use crate::law::formulas::model::Law;
use crate::law::table::Tabulated;
use crate::law::variables::Body;
use crate::material::{Hardening, HardeningLaw, MaterialError};
use crate::random::Seeded;

/// Seed of the vectors that are exported.
pub const SEED: u64 = 2014;
/// Paths of every hardening law.
const PATHS: usize = 2;

/// A hardening law and its numbers in the exports.
fn hardening(law: HardeningLaw, e: f64, random: &mut Seeded) -> Result<(Hardening<f64>, [f64; 3]), MaterialError> {
    let stress = e * (10f64).powf(random.between(-4.0, -1.8));
    Ok(match law {
        HardeningLaw::Ideal => (Hardening::ideal(stress)?, [stress, 0.0, 0.0]),
        HardeningLaw::Linear => {
            let modulus = e * random.between(0.0, 0.1);
            (Hardening::linear(stress, modulus)?, [stress, modulus, 0.0])
        }
        HardeningLaw::Power => {
            let (coefficient, exponent) = (stress * random.between(0.5, 5.0), random.between(0.1, 0.9));
            (Hardening::power(stress, coefficient, exponent)?, [stress, coefficient, exponent])
        }
        HardeningLaw::Hollomon => {
            let (coefficient, exponent) = (4.0 * stress, random.between(2.0, 10.0));
            (Hardening::hollomon(coefficient, exponent, e)?, [coefficient, exponent, 0.0])
        }
        HardeningLaw::Voce => {
            let (saturation, rate) = (stress * random.between(1.0, 3.0), random.between(1.0, 30.0));
            (Hardening::voce(stress, saturation, rate)?, [stress, saturation, rate])
        }
        HardeningLaw::Elastic | HardeningLaw::Table => (Hardening::Elastic, [0.0; 3]),
    })
}

/// The vectors as CSV: paths of every hardening law but the table, in random directions, with
/// press, shear to full slip and beyond, reversal, shear while h changes, partial unloading, loss
/// of contact, return, and turning axes.
pub fn vectors(law: &Law, seed: u64) -> String {
    let mut text = format!("{COLUMNS}\n");
    let mut random = Seeded::new(seed);
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
    let mut random = Seeded::new(seed);
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

/// Writes one path; `None` if there is no contact for its numbers.
fn write_path(law: &Law, path: usize, random: &mut Seeded, text: &mut String) -> Option<()> {
    let (e, nu) = ((10f64).powf(random.between(0.0, 12.0)), random.between(0.0, 0.5));
    let (radius, friction) = ((10f64).powf(random.between(-4.0, 1.0)), random.between(0.02, 1.0));
    // The ends of both ranges too.
    let (nu, friction) = match path % 10 {
        3 => (0.5, friction),
        5 => (0.0, friction),
        7 => (nu, 0.0),
        _ => (nu, friction),
    };
    // All but the table.
    let law_of_path = HardeningLaw::ALL[path % 6];
    let (hardening, numbers) = hardening(law_of_path, e, random).ok()?;
    let kind = law_of_path.code().into();
    let body = Body { sphere: ElasticSphere { radius, youngs_modulus: e, poissons_ratio: nu }, hardening };
    let pair = law.contact_parameters(&body, friction).ok()?;
    let deepest = radius * (10f64).powf(random.between(-4.0, -0.8));
    write_steps(path, &Contact { e, nu, kind, numbers, radius, pair }, deepest, random, text);
    Some(())
}
