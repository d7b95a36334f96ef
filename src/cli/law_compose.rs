//! `asperity law compose`: the table of two bodies from one table of each.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use clap::Args;

use super::{CliError, Outcome, print};
use crate::case::Case;
use crate::law::tabulated::{Tabulated, compose};

/// The arguments of `law compose`.
#[derive(Clone, Debug, Args)]
pub struct ComposeArgs {
    /// The case of the pair: both materials, its friction, and its indentation, which is the
    /// deepest of the table. The rest of its path is not used.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// The table of the sphere's material, of two equal spheres (or of a sphere on a plane, which
    /// is less near).
    #[arg(value_name = "SPHERE.json")]
    pub sphere: PathBuf,
    /// That of the opponent's material [default: the sphere's].
    #[arg(value_name = "OPPONENT.json")]
    pub opponent: Option<PathBuf>,
    /// Directory for the law.json.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1. May be repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Replace a law.json that is there.
    #[arg(long)]
    pub force: bool,
}

/// Makes the table and prints it.
pub(super) fn compose_tables(args: &ComposeArgs) -> Result<Outcome, CliError> {
    let case = Case::load(&args.case, &args.set)?;
    let sphere = Tabulated::read(&args.sphere)?;
    let opponent = args.opponent.as_deref().map(Tabulated::read).transpose()?;
    let file = args.out.join("law.json");
    if file.exists() && !args.force {
        return Err(CliError::FileThere { file });
    }
    let table = compose(&case, [&sphere, opponent.as_ref().unwrap_or(&sphere)])
        .map_err(|source| CliError::LawCase { file: args.case.clone(), source: Box::new(source) })?;
    fs::create_dir_all(&args.out).map_err(|source| CliError::Out { dir: args.out.clone(), what: "be created", source })?;
    table.write(&file)?;
    let mut text = format!(
        "{} levels, against {}; lengths over R, forces over E R^2 of the sphere\n\n{:>10} {:>11} {:>9} {:>11} {:>14}\n",
        table.levels.len(),
        table.body,
        "h",
        "F_N0",
        "a0",
        "F_N_slip",
        "delta_T_slip"
    );
    for level in &table.levels {
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{:>10.3e} {:>11.4e} {:>9.5} {:>11.4e} {:>14.4e}",
            level.h,
            level.f_n0,
            level.a0,
            level.slip_share * level.f_n0,
            level.delta_t_slip
        );
    }
    print(&format!("{text}\nlaw in {}\n", file.display()))?;
    Ok(Outcome::Done)
}
