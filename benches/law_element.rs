//! Drives the contact update along paths, with any constants, for `benches/law/fit_element.py`:
//! `law_element INCREMENTS CONTACT... < paths and sets of constants`.
//!
//! A contact is a table, `LAW.json`, or `drawn:SEED:NUMBER`, one that
//! `asperity law check built-in --random` draws, by the built-in law. First the number of paths,
//! then each as `contact places` and its places `h d[0] d[1]`, over R. Then, until the end of the
//! input, sets of constants in the order of [`Constants::to_array`]: each answers F_N and both of
//! F_T at all places, over E R^2. Without arguments it does nothing.

use std::io::{BufRead as _, Write as _};
use std::path::Path;

use asperity::case::Case;
use asperity::contact_law::path::drive_in_the_plane;
use asperity::contact_law::{Centres, Constants, ContactParameters};
use asperity::law::LawFile;
use asperity::law::check::{Ranges, drawn};
use rayon::prelude::*;

/// What drawn contacts have in common, as in `asperity law check`.
const BASE: &str = "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\n[material.hardening]\n\
                    law = \"ideal\"\nyield_stress = 0.002\n[contact]\nfriction = 0.3\n[[path]]\nindentation = 0.02\n";

type Failed = Box<dyn std::error::Error>;

struct Run {
    contact: usize,
    places: Vec<[f64; 3]>,
}

/// The next numbers of the input.
fn numbers<const N: usize>(lines: &mut impl Iterator<Item = std::io::Result<String>>) -> Result<Option<[f64; N]>, Failed> {
    let Some(line) = lines.next() else { return Ok(None) };
    let found: Vec<f64> = line?.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    Ok(Some(found.try_into().map_err(|found: Vec<f64>| format!("{} numbers for {N}", found.len()))?))
}

/// A contact over its R and E, and what turns as it is sheared.
fn contact(name: &str, built_in: &LawFile, base: &Case) -> Result<(ContactParameters, Centres), Failed> {
    let Some((seed, number)) = name.strip_prefix("drawn:").and_then(|drawn| drawn.split_once(':')) else {
        let LawFile::Table(table) = LawFile::read(Path::new(name))? else { return Err(format!("{name} is no table").into()) };
        return Ok((table.unit_parameters()?, Centres::of(base)));
    };
    // With the R and the E of the case, which are 1.
    let case = drawn(base, &Ranges::default(), seed.parse()?, number.parse()?);
    Ok((built_in.contact_parameters(&case)?, Centres::of(&case)))
}

fn main() -> Result<(), Failed> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let Some((increments, names)) = arguments.split_first() else { return Ok(()) };
    let increments: usize = increments.parse()?;
    let (built_in, base) = (LawFile::built_in()?, Case::parse(BASE, "case", &[])?);
    let contacts = names.iter().map(|name| contact(name, &built_in, &base)).collect::<Result<Vec<_>, Failed>>()?;
    let mut lines = std::io::stdin().lock().lines();
    let Some([count]) = numbers(&mut lines)? else { return Ok(()) };
    let mut runs = Vec::new();
    for _ in 0..count as usize {
        let Some([contact, places]) = numbers(&mut lines)? else { return Err("no path".into()) };
        let places = (0..places as usize).map(|_| numbers(&mut lines)?.ok_or_else(|| "no place".into()));
        runs.push(Run { contact: contact as usize, places: places.collect::<Result<_, Failed>>()? });
    }
    while let Some(values) = numbers(&mut lines)? {
        let constants = Constants::from_array(values);
        let fitted: Vec<ContactParameters> = contacts.par_iter().map(|(contact, _)| contact.refitted(&constants)).collect();
        let lines = |run: &Run| {
            let (forces, _) = drive_in_the_plane(&fitted[run.contact], contacts[run.contact].1, &run.places, increments);
            forces.iter().map(|force| format!("{:e} {:e} {:e}\n", force[0], force[1], force[2])).collect::<String>()
        };
        let text: Vec<String> = runs.par_iter().map(lines).collect();
        std::io::stdout().lock().write_all(text.concat().as_bytes())?;
        std::io::stdout().flush()?;
    }
    Ok(())
}
