//! `asperity law check`: the law's contact update against simulated paths.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::PathBuf;

use clap::Args;

use super::options::{DeviceArgs, Verbosity};
use super::{CliError, Outcome, print};
use crate::case::Case;
use crate::law::check::{AIMS, Checked, Errors, check, materials, table};
use crate::law::{LawError, LawFile};
use crate::output::write_own;

/// The arguments of `law check`.
#[derive(Clone, Debug, Args)]
pub struct CheckArgs {
    /// A law file that `law fit`, `law tabulate` or `law compose` wrote; or `built-in`.
    #[arg(value_name = "LAW.json")]
    pub law: PathBuf,
    /// Material, friction and depth to check [default: those of the table; for formulas, three
    /// materials with mu = 0.1, 0.3 and 0.6 each].
    #[arg(value_name = "CASE.toml")]
    pub case: Option<PathBuf>,
    /// Elements along the contact radius of the simulations.
    #[arg(long, default_value_t = 6, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=32))]
    pub elements: u32,
    /// Replace a value of the case, as in contact.friction=0.1. May be repeated.
    #[arg(long, value_name = "KEY=VALUE", requires = "case")]
    pub set: Vec<String>,
    /// Write the simulated steps and the forces of the law to this directory, a CSV file for each
    /// path. Existing files of these names are replaced.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads; the simulations are done on the CPU.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// How much to say.
    #[command(flatten)]
    pub verbosity: Verbosity,
}

/// The case for which formulas are checked where none is given; its material is replaced.
const CASE: &str = "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 1.0\npoissons_ratio = 0.3\n[material.hardening]\nlaw = \"elastic\"\n\
                    [contact]\nfriction = 0.3\n[[path]]\nindentation = 0.02\n";

/// Simulates, compares and prints.
pub(super) fn check_law(args: &CheckArgs) -> Result<Outcome, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    let case = args.case.as_ref().map(|path| Case::load(path, &args.set)).transpose()?;
    let law = LawFile::read_or_built_in(&args.law)?;
    let cases = match (case, &law) {
        (Some(case), _) => vec![("the case", case)],
        (None, LawFile::Table(table)) => vec![("the table's material", table.deepest_case()?)],
        (None, LawFile::Formulas(_) | LawFile::Interpolated(_)) => materials(&Case::parse(CASE, "case", &[])?),
    };
    let file = args.case.clone().unwrap_or_else(|| args.law.clone());
    let in_case = |source: LawError| CliError::LawCase { file: file.clone(), source: Box::new(source) };
    let (mut within, mut failed, mut count) = (0, 0, 0);
    for (name, case) in &cases {
        let checked = check(&law, case, args.elements as usize).map_err(in_case)?;
        let friction = case.contact.friction;
        print(&format!("{name}, {friction:?}, {:?}\n{}\n", case.scaled().0.material.hardening, table(&checked)))?;
        count += checked.len();
        within += checked.iter().filter(|one| one.errors().iter().all(Errors::within)).count();
        failed += checked.iter().filter(|one| one.failure.is_some()).count();
        if let Some(dir) = &args.out {
            write_curves(dir, name, &format!("{friction:?}"), &checked)?;
        }
    }
    let mut text = String::new();
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{within} of {count} paths within {} % rms and {} % at the worst of the greatest force, F_T and F_N (* is not); {} elements along the contact radius",
        100.0 * AIMS[0],
        100.0 * AIMS[1],
        args.elements
    );
    print(&text)?;
    if failed > 0 {
        // A closed stderr does not change the outcome.
        let _ =
            writeln!(std::io::stderr(), "error: {failed} of {count} paths were not simulated to their end, as the table says");
        return Ok(Outcome::NotConverged);
    }
    Ok(Outcome::Done)
}

fn write_curves(dir: &std::path::Path, material: &str, friction: &str, checked: &[Checked]) -> Result<(), CliError> {
    fs::create_dir_all(dir).map_err(|source| CliError::Out { dir: dir.to_owned(), what: "be created", source })?;
    let plain = |text: &str| {
        let words: Vec<String> = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '.').map(str::to_lowercase).collect();
        words.iter().filter(|word| !word.is_empty()).cloned().collect::<Vec<_>>().join("-")
    };
    for one in checked {
        let name = format!("{}.csv", plain(&format!("{material} {friction} {}", one.name)));
        write_own(&dir.join(name), |out| out.write_all(one.csv().as_bytes()))?;
    }
    Ok(())
}
