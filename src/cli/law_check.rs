//! `asperity law check`: the law's contact update against simulated paths.

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::options::{DeviceArgs, Verbosity};
use super::{CliError, Exit, print};
use crate::case::{Case, Friction, Material};
use crate::law::check::{
    AIMS, CheckedPath, MOST_MESH_ERROR, Path, Ranges, check, materials, opponent_of, protocol, random_paths, table, turning_paths,
};
use crate::law::{LawError, LawFile};
use crate::output::write_own;

/// The arguments of `law check`.
#[derive(Clone, Debug, Args)]
pub struct LawCheckArgs {
    /// A law file that `law fit`, `law tabulate` or `law compose` wrote; or `built-in`.
    #[arg(value_name = "LAW.json")]
    pub law: PathBuf,
    /// Material, friction and depth to check [default: those of the table; for a law for many
    /// materials three of them, each with mu = 0.1, 0.3 and 0.6].
    #[arg(value_name = "CASE.toml")]
    pub case: Option<PathBuf>,
    /// Elements along the contact radius of the simulations; twice as many at the surface.
    #[arg(long, default_value_t = 5, value_name = "N", value_parser = clap::value_parser!(u32).range(4..=16))]
    pub elements: u32,
    /// Check this many random paths instead of the set, of six kinds in turn. They are paths of the
    /// contact that the case or the table describes; without either, the contacts are random too:
    /// on a plane, between equal spheres and between unlike bodies in turn.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub random: Option<u32>,
    /// Check paths on which the direction of shear changes, instead of the set: circles with radii
    /// of 0.5 and 0.9 of the displacement at full slip, a figure of eight and a corner of 90
    /// degrees. Four paths on which the sphere twists or rolls are simulated too, and their moments
    /// judged, but they are not counted. All of them mesh the whole lower hemisphere.
    #[arg(long, conflicts_with = "random")]
    pub turning: bool,
    /// Seed of the random paths.
    #[arg(long, default_value_t = 1, value_name = "S", requires = "random")]
    pub seed: u64,
    /// Replace a value of the case, as in contact.friction=0.1 or path.0.indentation=0.01. May be
    /// repeated.
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

/// Least share of the paths that are counted which has to be within the aims: with a table of the
/// contact's own, and with a law for many materials.
const GOALS: [f64; 2] = [0.9, 0.75];

/// Greatest share of the paths that may say nothing, as their own mesh's error is too large.
const MOST_LEFT_OUT: f64 = 0.1;

/// Simulates, compares and prints.
pub(super) fn check_law(args: &LawCheckArgs) -> Result<Exit, CliError> {
    args.verbosity.start_log();
    args.device.start_threads()?;
    let case = args.case.as_ref().map(|path| Case::load(path, &args.set)).transpose()?;
    let law = LawFile::read_or_built_in(&args.law)?;
    let base = Case::parse(CASE, "case", &[])?;
    let file = args.case.clone().unwrap_or_else(|| args.law.clone());
    let in_case = |source: LawError| CliError::LawCase { file: file.clone(), source: Box::new(source) };
    let elements = args.elements as usize;
    let mut all = Vec::new();
    let mut simulate = |paths: &[Path], title: &str, name: &str| -> Result<(), CliError> {
        let checked = check(&law, paths, &Arc::default()).map_err(in_case)?;
        print(&format!("{title}\n{}\n", table(&checked)))?;
        if let Some(dir) = &args.out {
            write_curves(dir, name, &checked)?;
        }
        all.extend(checked);
        Ok(())
    };
    if let Some(count) = args.random {
        let contact = match (case, &law) {
            (Some(case), _) => Some(case),
            (None, LawFile::Table(table)) => Some(table.deepest_case()?),
            (None, LawFile::Formulas(_) | LawFile::Interpolated(_)) => None,
        };
        let paths = random_paths(&law, contact.as_ref(), &base, (count as usize, args.seed), elements).map_err(in_case)?;
        let drawn = if contact.is_none() { format!("; {}", Ranges::default()) } else { String::new() };
        simulate(&paths, &format!("random paths: {count}, seed {}{drawn}", args.seed), &format!("seed {}", args.seed))?;
    } else {
        let cases = match (case, &law) {
            (Some(case), _) => vec![("the case", case)],
            (None, LawFile::Table(table)) => vec![("the table's material", table.deepest_case()?)],
            (None, LawFile::Formulas(_) | LawFile::Interpolated(_)) => materials(&base),
        };
        for (name, case) in &cases {
            let parameters = law.contact_parameters(case).map_err(in_case)?;
            if args.turning && case.contact.friction == Friction::Coefficient(0.0) {
                return Err(in_case(LawError::NotCovered {
                    problem: "the case has friction = 0, and without friction no direction matters",
                    remedy: "Give contact.friction a number above 0, or leave --turning out",
                }));
            }
            let paths = if args.turning { turning_paths } else { protocol }(case, &parameters, elements);
            let friction = match case.contact.friction {
                Friction::Coefficient(mu) => format!("mu {mu}"),
                Friction::Stick => "full stick".to_owned(),
            };
            let title = format!("{name}: {friction}, {}", in_words(&case.scaled().0.material));
            simulate(&paths, &title, &format!("{name} {friction}"))?;
        }
    }
    let goal = GOALS[usize::from(!matches!(law, LawFile::Table(_)))];
    let (text, met) = verdict(&all, elements, goal);
    print(&text)?;
    let failed = all.iter().filter(|one| one.failure.is_some()).count();
    if failed > 0 {
        // A closed stderr does not change the outcome.
        let _ = writeln!(
            std::io::stderr(),
            "error: {failed} of {} paths were not simulated to their end, as the table says",
            all.len()
        );
        return Ok(Exit::NotConverged);
    }
    Ok(if met { Exit::Done } else { Exit::GoalMissed })
}

/// A material in the words of a case file: `ideal, yield_stress 0.002, E 1, nu 0.3`.
fn in_words(material: &Material) -> String {
    // A hardening law is always TOML.
    let hardening = toml::to_string(&material.hardening).unwrap_or_default().replace('"', "").replace(" = ", " ");
    let numbers: Vec<&str> = hardening.lines().collect();
    format!("{}, E {}, nu {}", numbers.join(", ").replacen("law ", "", 1), material.youngs_modulus, material.poissons_ratio)
}

/// How many paths are within the aims, by kind and by opponent, and whether that is enough.
fn verdict(checked: &[CheckedPath], elements: usize, goal: f64) -> (String, bool) {
    let (turned, checked): (Vec<&CheckedPath>, Vec<&CheckedPath>) = checked.iter().partition(|one| one.turns());
    let counted: Vec<&CheckedPath> = checked.iter().copied().filter(|one| one.counts()).collect();
    let share = |of: &dyn Fn(&CheckedPath) -> bool| {
        let of: Vec<_> = counted.iter().filter(|one| of(one)).collect();
        (of.iter().filter(|one| one.within()).count(), of.len())
    };
    let mut text = String::new();
    let mut groups: Vec<&str> = Vec::new();
    for name in checked.iter().flat_map(|one| [one.name, opponent_of(&one.case)]) {
        if !groups.contains(&name) {
            groups.push(name);
        }
    }
    // Writing to a String cannot fail.
    for name in groups {
        let (within, of) = share(&|one: &CheckedPath| one.name == name || opponent_of(&one.case) == name);
        let _ = writeln!(text, "{name:<38} {within} of {of} within");
    }
    let (within, of) = share(&|_| true);
    let [rms, worst] = AIMS.map(|aim| 100.0 * aim);
    let _ = write!(
        text,
        "{within} of {of} paths within {rms} % rms and {worst} % at the worst of the greatest force, F_T and F_N (* is not)"
    );
    let left_out = checked.len() - of;
    if left_out > 0 {
        let limit = 100.0 * MOST_MESH_ERROR;
        let _ = write!(text, "; {left_out} not counted, as their own mesh error is above {limit} % or unknown");
    }
    if !turned.is_empty() {
        let _ = write!(text, "; {} that twist or roll not counted: forces and moments stand beside them", turned.len());
    }
    let enough = left_out as f64 <= MOST_LEFT_OUT * checked.len() as f64;
    let met = enough && within as f64 >= goal * of as f64;
    let verdict = if met { "met" } else { "missed" };
    let _ = writeln!(
        text,
        ".\nGoal: {:.0} % of them, and at most {:.0} % not counted: {verdict}. Simulated with {elements} elements along the contact \
         radius and {} at the surface, extrapolated to the limit of fine meshes",
        100.0 * goal,
        100.0 * MOST_LEFT_OUT,
        2 * elements
    );
    (text, met)
}

fn write_curves(dir: &std::path::Path, name: &str, checked: &[CheckedPath]) -> Result<(), CliError> {
    fs::create_dir_all(dir).map_err(|source| CliError::Out { dir: dir.to_owned(), what: "be created", source })?;
    let plain = |text: &str| {
        let words: Vec<String> = text.split(|c: char| !c.is_ascii_alphanumeric() && c != '.').map(str::to_lowercase).collect();
        words.iter().filter(|word| !word.is_empty()).cloned().collect::<Vec<_>>().join("-")
    };
    for (i, one) in checked.iter().enumerate() {
        // Random paths of one kind are several.
        let number =
            if checked.iter().filter(|other| other.name == one.name).count() > 1 { format!(" {}", i + 1) } else { String::new() };
        let name = format!("{}.csv", plain(&format!("{name} {}{number}", one.name)));
        write_own(&dir.join(name), |out| out.write_all(one.csv().as_bytes()))?;
    }
    Ok(())
}
