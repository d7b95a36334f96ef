//! The command line: one file a subcommand; parses, prints, exits.

pub mod backend;
pub mod bench;
mod called;
pub mod check;
pub mod cluster;
pub mod compare;
pub mod contact;
pub mod devices;
pub mod environment;
pub mod error;
mod exit;
pub mod explain;
#[cfg(feature = "explore")]
pub mod explore;
pub mod init;
pub mod input;
pub mod law;
mod law_check;
mod law_compose;
mod law_export;
mod law_tabulate;
pub mod options;
pub mod plot;
pub mod point;
mod print;
pub mod prove;
pub mod run;
pub mod schema;
pub mod shell;
pub mod signals;
mod snippet;
pub mod study;
pub mod verify;

pub use error::CliError;
pub use exit::Exit;
pub use print::{print, print_json};

use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, FromArgMatches, Parser, Subcommand};

/// Simulates elastic-plastic spheres pressed onto a rigid plane and sheared along it.
#[derive(Debug, Parser)]
#[command(name = "asperity", version, propagate_version = true, after_help = EXIT_CODES)]
#[command(help_template = "{about}\n\n{usage-heading} {usage}\n\n{before-help}Options:\n{options}{after-help}")]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 a law that is checked misses its goal; 2 bad input or usage; \
                          3 did not converge or ran out of memory or room (what was computed is kept), or a check failed; \
                          75 interrupted (--resume goes on).";

/// The subcommands by what they are for, as `--help` lists them.
const GROUPS: [(&str, &[&str]); 4] = [
    ("Simulate", &["init", "check", "run", "study", "plot", "compare", "explain"]),
    ("Laws", &["law", "explore"]),
    ("This program and this machine", &["verify", "devices", "prove", "bench", "point"]),
    ("Editors and shells", &["schema", "completions", "man", "help"]),
];

/// The command line, its help with the subcommands in [`GROUPS`].
fn command_line() -> clap::Command {
    let command = Cli::command();
    let mut list = String::new();
    for (group, names) in GROUPS {
        list.push_str(&format!("\n{group}:\n"));
        for name in names {
            let about = command.find_subcommand(name).and_then(clap::Command::get_about).map(ToString::to_string);
            match about {
                Some(about) => list.push_str(&format!("  {name:<12} {about}\n")),
                None if *name == "help" => list.push_str("  help         The options of a subcommand: `asperity help run`\n"),
                // One that was left out of the build.
                None => {}
            }
        }
    }
    command.before_help(list.trim_start().trim_end().to_owned())
}

#[derive(Debug, Subcommand)]
enum Command {
    Init(init::InitArgs),
    Explain(explain::ExplainArgs),
    Check(check::CheckArgs),
    Run(run::RunArgs),
    Study(study::StudyArgs),
    Plot(plot::PlotArgs),
    Compare(compare::CompareArgs),
    Law(law::LawArgs),
    #[cfg(feature = "explore")]
    Explore(explore::ExploreArgs),
    Verify(verify::VerifyArgs),
    Devices(devices::DevicesArgs),
    Bench(bench::BenchArgs),
    Prove(prove::ProveArgs),
    Point(point::PointArgs),
    Schema(schema::SchemaArgs),
    Completions(shell::CompletionsArgs),
    Man(shell::ManArgs),
}

impl Command {
    fn run(&self) -> Result<Exit, CliError> {
        match self {
            Command::Run(args) => run::run(args),
            Command::Check(args) => check::check(args),
            Command::Verify(args) => verify::verify(args),
            Command::Devices(args) => devices::devices(args),
            Command::Bench(args) => bench::bench(args),
            Command::Prove(args) => prove::prove(args),
            Command::Point(args) => point::point(args),
            Command::Study(args) => study::study(args),
            Command::Law(args) => law::law(args),
            #[cfg(feature = "explore")]
            Command::Explore(args) => explore::explore(args),
            Command::Plot(args) => plot::plot(args),
            Command::Init(args) => init::init(args),
            Command::Explain(args) => explain::explain(args),
            Command::Compare(args) => compare::compare(args),
            Command::Schema(args) => schema::schema(args),
            Command::Completions(args) => shell::completions(args, command()),
            Command::Man(args) => shell::man(args, command()),
        }
    }
}

impl Cli {
    /// The arguments that the program was called with.
    fn from_command_line() -> Result<Self, clap::Error> {
        Self::from_arg_matches(&command_line().try_get_matches_from(called::arguments())?)
    }
}

/// The program: reads the arguments, runs the subcommand, reports an error on stderr and ends with
/// its exit code.
pub fn main() -> ExitCode {
    exit_code().into()
}

/// The program within another one, called with these arguments, the first of which is the file that
/// scripts call. Gives the exit code; to be called once.
pub fn main_within(arguments: Vec<OsString>) -> u8 {
    called::set_arguments(arguments);
    exit_code()
}

fn exit_code() -> u8 {
    signals::begin();
    let checked = crate::processor::check().map_err(CliError::from).and_then(|()| environment::check());
    let outcome = checked.and_then(|()| match Cli::from_command_line() {
        Ok(cli) => cli.command.run().map(Exit::exit_code),
        Err(usage) => {
            // Help and version come this way too, with exit code 0.
            let _ = match called::shortened(&usage.to_string()) {
                None => usage.print(),
                Some(text) => write!(std::io::stderr(), "{text}"),
            };
            Ok(u8::try_from(usage.exit_code()).unwrap_or(error::BAD_INPUT))
        }
    });
    outcome.unwrap_or_else(|error| {
        report(&error);
        error.exit_code()
    })
}

/// Writes an error to stderr, in clap's colours where that is a terminal. A closed stderr changes
/// nothing.
fn report(error: &CliError) {
    let mut stderr = anstream::stderr().lock();
    let _ = match error {
        CliError::Mistakes { errors, text } => writeln!(stderr, "{}", snippet::coloured(errors, text)),
        error => {
            let red = clap::builder::Styles::styled().get_error().to_owned();
            writeln!(stderr, "{red}error:{red:#} {error}")
        }
    };
}

/// The definition of the command line, for completions, man pages and the command reference.
pub fn command() -> clap::Command {
    Cli::command()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_subcommand_stands_in_one_group_on_a_line_of_its_own() {
        let listed: Vec<&str> = GROUPS.iter().flat_map(|(_, names)| *names).copied().filter(|name| *name != "help").collect();
        let command = Cli::command();
        let mut known: Vec<&str> = command.get_subcommands().map(clap::Command::get_name).collect();
        let mut sorted = listed.clone();
        sorted.retain(|name| cfg!(feature = "explore") || *name != "explore");
        sorted.sort_unstable();
        known.sort_unstable();
        assert_eq!(sorted, known);
        let help = command_line().render_help().to_string();
        for name in known {
            let lines: Vec<&str> = help.lines().filter(|line| line.starts_with(&format!("  {name} "))).collect();
            assert!(lines.len() == 1 && lines[0].len() <= 80, "{name}: {help}");
        }
        assert!(help.contains("Laws:") && help.contains("--version") && help.contains("Exit codes"), "{help}");
    }
}
