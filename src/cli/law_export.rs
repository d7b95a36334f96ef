//! `asperity law export`: a law for a DEM code.

use std::fs;
use std::path::{Path, PathBuf};

use clap::builder::PossibleValue;
use clap::{Args, ValueEnum};

use super::input::InputFile;
use super::print::warn_out_of_range;
use super::{CliError, Exit, print};
use crate::law::export::{Engine, ExportedFile, Language, Start, beyond_the_law, law_files, law_source, start_files};
use crate::law::{LawError, LawFile};
use crate::output::{refuse_foreign, write_own};

/// The arguments of `law export`.
#[derive(Clone, Debug, Args)]
pub struct ExportArgs {
    /// A law file that `law fit`, `law tabulate` or `law compose` wrote; or `built-in`.
    #[arg(value_name = "LAW.json")]
    pub law: PathBuf,
    /// The material, the friction and the greatest depth; `-` for standard input. With --for, the
    /// opponent only says how deep the sphere's own surface is pressed: by half of the greatest
    /// indentation against a sphere that deforms, else by all of it. A table needs no case.
    #[arg(value_name = "CASE.toml")]
    pub case: Option<PathBuf>,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01. May be
    /// repeated.
    #[arg(long, value_name = "KEY=VALUE", requires = "case")]
    pub set: Vec<String>,
    /// Write all files that an engine needs: tables of two spheres and of a sphere on a rigid wall;
    /// for lammps also in.asperity, an input that pours, presses and shears; for c also the headers
    /// and main.c, which prints collisions. Needs an interpolated law, a case and --out.
    #[arg(long = "for", value_enum, value_name = "ENGINE", requires_all = ["case", "out"], conflicts_with = "format")]
    pub engine: Option<Engine>,
    /// With --for: the case of another material; may be repeated. Tables of all pairs are written;
    /// the friction between two materials is the geometric mean of their coefficients.
    #[arg(long, value_name = "OTHER.toml", requires = "engine")]
    pub with: Vec<PathBuf>,
    /// The language of one law by itself.
    #[arg(long, value_enum, value_name = "LANGUAGE", required_unless_present = "engine")]
    pub format: Option<Language>,
    /// Write the files to this directory, replacing files of the same names. With --format c:
    /// asperity_law.h (the table as a constant), law.asperity (the same, to be read at run time),
    /// asperity_contact.h (the update), asperity_contact3d.h (spheres and walls) and a program that
    /// checks them. With --format python: asperity_law.py. Both with test vectors [default:
    /// asperity_law.h or asperity_law.py alone, to stdout].
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

impl ValueEnum for Language {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::C, Self::Python]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Self::C => PossibleValue::new("c").help("Headers and a table, C99, C++17 and CUDA"),
            Self::Python => {
                PossibleValue::new("python").help("One module, Python 3.8 or later, which compiles the update with cc")
            }
        })
    }
}

impl ValueEnum for Engine {
    fn value_variants<'a>() -> &'a [Self] {
        &[Self::Lammps, Self::C]
    }

    fn to_possible_value(&self) -> Option<PossibleValue> {
        Some(match self {
            Self::Lammps => PossibleValue::new("lammps").help("Tables and an input for LAMMPS with the plug-in"),
            Self::C => PossibleValue::new("c").help("Headers, tables and a program in C99"),
        })
    }
}

/// Writes or prints the law.
pub(super) fn export_law(args: &ExportArgs) -> Result<Exit, CliError> {
    let law = LawFile::read_or_built_in(&args.law)?;
    match (args.engine, args.format) {
        (Some(engine), _) => export_start(args, &law, engine),
        (None, Some(language)) => export_one(args, &law, language),
        (None, None) => unreachable!("one of --for and --format is required"),
    }
}

/// Writes what an engine starts from.
fn export_start(args: &ExportArgs, law: &LawFile, engine: Engine) -> Result<Exit, CliError> {
    let mut cases = Vec::new();
    for file in args.case.iter().chain(&args.with) {
        let input = InputFile::read(file)?;
        let name = file.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        let settings: &[String] = if cases.is_empty() { &args.set } else { &[] };
        cases.push((name, input.case(settings)?));
    }
    let Start { files, out_of_range } = start_files(law, engine, &cases).map_err(|source| in_case(args, source))?;
    for (table, beyond) in &out_of_range {
        warn_out_of_range(Path::new(table), beyond);
    }
    // clap requires it.
    let dir = args.out.clone().unwrap_or_default();
    write_files(&dir, files)?;
    let dir = dir.display();
    print(&match engine {
        Engine::Lammps => format!(
            "To run it: cd {dir} && lmp -in in.asperity -var plugin PATH/asperityplugin.so\n\
             The plug-in is built by: bash integrations/lammps/run.sh --build\n"
        ),
        Engine::C => format!("To run it: cd {dir} && cc -std=c99 -O2 main.c -o main -lm && ./main\n"),
    })?;
    Ok(Exit::Done)
}

/// An error about the first case, if there is one.
fn in_case(args: &ExportArgs, source: LawError) -> CliError {
    match &args.case {
        Some(file) => CliError::LawCase { file: file.clone(), source: Box::new(source) },
        None => source.into(),
    }
}

/// Writes files of this program into a directory, and says what each is for.
fn write_files(dir: &Path, files: Vec<ExportedFile>) -> Result<(), CliError> {
    let failed = |source| CliError::Out { dir: dir.to_owned(), what: "be created", source };
    fs::create_dir_all(dir).map_err(failed)?;
    files.iter().try_for_each(|file| refuse_foreign(&dir.join(&file.name)))?;
    for file in files {
        let path = dir.join(&file.name);
        write_own(&path, |out| out.write_all(file.content.as_bytes()))?;
        print(&format!("{}: {}\n", path.display(), purpose(&file.name)))?;
    }
    Ok(())
}

/// Writes or prints a law by itself.
fn export_one(args: &ExportArgs, law: &LawFile, language: Language) -> Result<Exit, CliError> {
    let input = args.case.as_deref().map(InputFile::read).transpose()?;
    let case = input.as_ref().map(|input| input.case(&args.set)).transpose()?;
    // What messages call the case: that of standard input has no path.
    let in_case = |source: LawError| match &input {
        Some(input) => CliError::LawCase { file: input.name.clone().into(), source: Box::new(source) },
        None => source.into(),
    };
    if let (Some(case), Some(input)) = (&case, &input) {
        warn_out_of_range(Path::new(&input.name), &beyond_the_law(law, case).map_err(in_case)?);
    }
    let Some(dir) = &args.out else {
        print(&law_source(law, language, case.as_ref()).map_err(in_case)?)?;
        return Ok(Exit::Done);
    };
    write_files(dir, law_files(law, language, case.as_ref()).map_err(in_case)?)?;
    let dir = dir.display();
    let (using, checking) = match language {
        Language::C => (
            format!(
                "#include \"asperity_contact3d.h\" and \"asperity_law.h\", and compile with: cc -std=c99 -I {dir} YOURS.c -lm \
                 (or c++ -std=c++17)"
            ),
            "cc -std=c99 -O2 asperity_contact_check.c -lm -o check && ./check asperity_law_vectors.csv",
        ),
        Language::Python => {
            (format!("import asperity_law, with {dir} on PYTHONPATH"), "python3 asperity_law.py asperity_law_vectors.csv")
        }
    };
    print(&format!("To use it: {using}\nTo check it here: cd {dir} && {checking}\n"))?;
    Ok(Exit::Done)
}

/// What a file of an export is for.
fn purpose(file: &str) -> &'static str {
    match file {
        "asperity_contact.h" => "the update of one contact",
        "asperity_turning.h" => "twist and roll of one contact",
        "asperity_cohesion.h" => "cohesion of one contact",
        "asperity_frame.h" => "memory and frame of one contact in three dimensions",
        "asperity_contact3d.h" => "two spheres, or a sphere and a wall, in three dimensions",
        "asperity_law.h" | "asperity_law.py" => "the law",
        "law.asperity" => "the law, to be read when an engine starts",
        "in.asperity" => "the input",
        "main.c" => "a program that prints collisions",
        wall if wall.ends_with("-wall.asperity") => "the table of a sphere on a wall",
        pair if pair.ends_with(".asperity") => "the table of two spheres",
        csv if csv.ends_with(".csv") => "paths with the forces that the law gives along them",
        _ => "compares the law with these",
    }
}
