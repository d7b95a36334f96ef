//! `asperity law compose`: the table of two bodies from one table of each, or of any contact from a
//! law by interpolation.

use std::fmt::Write as _;
use std::fs;
use std::path::PathBuf;

use clap::Args;

use super::print::warn_out_of_range;
use super::{CliError, Exit, print};
use crate::case::Case;
use crate::law::interpolated::Interpolated;
use crate::law::table::{Tabulated, compose};
use crate::law::{LawError, LawFile};
use crate::output::refuse_input;

/// The arguments of `law compose`.
#[derive(Clone, Debug, Args)]
pub struct ComposeArgs {
    /// The case: its materials, friction, opponent, and indentation, which is the greatest depth of
    /// the table. The rest of its path is not used.
    #[arg(value_name = "CASE.toml")]
    pub case: PathBuf,
    /// The table of the sphere's material, made with two equal spheres; one made on a plane is less
    /// accurate. Or an interpolated law, such as `built-in`, that covers both materials.
    #[arg(value_name = "LAW.json")]
    pub sphere: PathBuf,
    /// The table of the opponent's material [default: the sphere's].
    #[arg(value_name = "OPPONENT.json")]
    pub opponent: Option<PathBuf>,
    /// Directory for the law.json.
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01. May be
    /// repeated.
    #[arg(long, value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Replace an existing law.json.
    #[arg(long)]
    pub force: bool,
}

/// What a table is composed from.
enum GivenTable {
    Tables(Box<[Tabulated; 2]>),
    Interpolated(Box<Interpolated>),
}

impl GivenTable {
    fn read(args: &ComposeArgs) -> Result<Self, CliError> {
        match (LawFile::read_or_built_in(&args.sphere)?, &args.opponent) {
            (LawFile::Interpolated(law), None) => Ok(Self::Interpolated(law)),
            (LawFile::Table(sphere), opponent) => {
                let opponent = opponent.as_deref().map(Tabulated::read).transpose()?.unwrap_or_else(|| (*sphere).clone());
                Ok(Self::Tables(Box::new([*sphere, opponent])))
            }
            (LawFile::Interpolated(_), Some(_)) => Err(CliError::from(LawError::NotCovered {
                problem: "a law by interpolation knows both bodies of a pair",
                remedy: "leave OPPONENT.json out",
            })),
            (LawFile::Formulas(_), _) => Err(CliError::from(LawError::NotCovered {
                problem: "a law of formulas has no table of a body",
                remedy: "Give a table that `asperity law tabulate` made, a law by interpolation, or built-in",
            })),
        }
    }

    fn table(&self, case: &Case) -> Result<Tabulated, LawError> {
        match self {
            Self::Tables(tables) => compose(case, [&tables[0], &tables[1]]),
            Self::Interpolated(law) => law.compose(case),
        }
    }
}

/// Makes the table and prints it.
pub(super) fn compose_tables(args: &ComposeArgs) -> Result<Exit, CliError> {
    let case = Case::load(&args.case, &args.set)?;
    let law = GivenTable::read(args)?;
    let file = args.out.join("law.json");
    if file.exists() && !args.force {
        return Err(CliError::FileThere { file });
    }
    let opponent = args.opponent.as_deref().unwrap_or(&args.sphere);
    refuse_input(&file, &[&args.case, &args.sphere, opponent])?;
    let table = law.table(&case).map_err(|source| CliError::LawCase { file: args.case.clone(), source: Box::new(source) })?;
    if let GivenTable::Interpolated(law) = &law {
        let deepest = table.range.to * case.sphere.radius;
        warn_out_of_range(&args.case, &law.out_of_range(&case, deepest)?);
    }
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
        "delta_T_end"
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
            level.delta_t_end
        );
    }
    print(&format!("{text}\nlaw in {}\n", file.display()))?;
    Ok(Exit::Done)
}
