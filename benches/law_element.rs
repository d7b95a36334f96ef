//! Drives the contact update along paths, with any constants, for `benches/law/fit_element.py`:
//! `law_element INCREMENTS LAW.json... < paths and sets of constants`.
//!
//! First the number of paths, then each as `law places` and its places `h d[0] d[1]`, over R. Then,
//! until the end of the input, sets of constants in the order of
//! [`Constants::to_array`]: each answers F_N and both of F_T at all places, over E R^2. Without
//! arguments it does nothing.

use std::fmt::Write as _;
use std::io::{BufRead as _, Write as _};
use std::path::Path;

use asperity::contact_law::{Constants, ContactParameters, ContactState};
use asperity::law::LawFile;

type Failed = Box<dyn std::error::Error>;

struct Run {
    law: usize,
    places: Vec<[f64; 3]>,
}

/// The next numbers of the input.
fn numbers<const N: usize>(lines: &mut impl Iterator<Item = std::io::Result<String>>) -> Result<Option<[f64; N]>, Failed> {
    let Some(line) = lines.next() else { return Ok(None) };
    let found: Vec<f64> = line?.split_whitespace().map(str::parse).collect::<Result<_, _>>()?;
    Ok(Some(found.try_into().map_err(|found: Vec<f64>| format!("{} numbers for {N}", found.len()))?))
}

fn drive(parameters: &ContactParameters, places: &[[f64; 3]], increments: usize, text: &mut String) {
    let (mut state, mut at) = (ContactState::default(), [0.0; 3]);
    for to in places {
        let step = [1, 2].map(|i| (to[i] - at[i]) / increments as f64);
        let mut forces = [0.0; 3];
        for k in 1..=increments {
            let h = at[0] + (to[0] - at[0]) * k as f64 / increments as f64;
            let (next, out) = parameters.update(&state, h, step);
            (state, forces) = (next, [out.f_n, out.f_t[0], out.f_t[1]]);
        }
        at = *to;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{:e} {:e} {:e}", forces[0], forces[1], forces[2]);
    }
}

fn main() -> Result<(), Failed> {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with("--")).collect();
    let Some((increments, files)) = arguments.split_first() else { return Ok(()) };
    let increments: usize = increments.parse()?;
    let mut laws = Vec::new();
    for file in files {
        let LawFile::Table(table) = LawFile::read(Path::new(file))? else { return Err(format!("{file} is no table").into()) };
        laws.push(table.unit_parameters()?);
    }
    let mut lines = std::io::stdin().lock().lines();
    let Some([count]) = numbers(&mut lines)? else { return Ok(()) };
    let mut runs = Vec::new();
    for _ in 0..count as usize {
        let Some([law, places]) = numbers(&mut lines)? else { return Err("no path".into()) };
        let places = (0..places as usize).map(|_| numbers(&mut lines)?.ok_or_else(|| "no place".into()));
        runs.push(Run { law: law as usize, places: places.collect::<Result<_, Failed>>()? });
    }
    while let Some(values) = numbers(&mut lines)? {
        let constants = Constants::from_array(values);
        let parameters: Vec<ContactParameters> = laws.iter().map(|law| law.refitted(&constants)).collect();
        let mut text = String::new();
        runs.iter().for_each(|run| drive(&parameters[run.law], &run.places, increments, &mut text));
        std::io::stdout().lock().write_all(text.as_bytes())?;
        std::io::stdout().flush()?;
    }
    Ok(())
}
