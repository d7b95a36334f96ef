//! The command line: one file a subcommand; parses, prints, exits.

pub mod backend;
pub mod bench;
pub mod check;
pub mod cluster;
pub mod compare;
pub mod devices;
pub mod environment;
pub mod error;
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
pub mod prove;
pub mod run;
pub mod schema;
pub mod shell;
pub mod signals;
mod snippet;
pub mod study;
pub mod verify;

pub use error::CliError;

use std::io::Write;
use std::process::ExitCode;

use clap::{CommandFactory, Parser, Subcommand};
use serde::Serialize;

/// Simulates elastic-plastic spheres pressed onto a rigid plane and sheared along it.
#[derive(Debug, Parser)]
#[command(name = "asperity", version, propagate_version = true, after_help = EXIT_CODES)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

const EXIT_CODES: &str = "Exit codes: 0 done; 1 a law that is checked misses its goal; 2 bad input or usage; \
                          3 did not converge or ran out of memory or room (what was computed is kept), or a check failed; \
                          75 interrupted (--resume goes on).";

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
    fn run(&self) -> Result<Outcome, CliError> {
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
            Command::Completions(args) => shell::completions(args),
            Command::Man(args) => shell::man(args),
        }
    }
}

/// How a subcommand that had good input ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// All was done: exit code 0.
    Done,
    /// A step did not converge or the contact outgrew the mesh, what was computed is kept: exit
    /// code 3.
    NotConverged,
    /// A check of a verification failed: exit code 3.
    ChecksFailed,
    /// A law is further from simulations than its goal allows: exit code 1.
    GoalMissed,
    /// Cases of a study failed, all rows are kept: exit code 3.
    CasesFailed,
    /// Interrupted, what was computed is kept: exit code 75 (EX_TEMPFAIL of sysexits.h).
    Interrupted,
}

impl From<Outcome> for ExitCode {
    fn from(outcome: Outcome) -> Self {
        ExitCode::from(match outcome {
            Outcome::Done => 0,
            Outcome::GoalMissed => 1,
            Outcome::NotConverged | Outcome::ChecksFailed | Outcome::CasesFailed => error::NOT_CONVERGED,
            Outcome::Interrupted => 75,
        })
    }
}

/// The program: reads the arguments, runs the subcommand, reports an error on stderr and ends with
/// its exit code.
pub fn main() -> ExitCode {
    signals::begin();
    let checked = crate::processor::check().map_err(CliError::from).and_then(|()| environment::check());
    let outcome = checked.and_then(|()| match Cli::try_parse() {
        Ok(cli) => cli.command.run().map(ExitCode::from),
        Err(usage) => {
            // Help and version come this way too, with exit code 0.
            let _ = match environment::shortened(&usage.to_string()) {
                None => usage.print(),
                Some(text) => write!(std::io::stderr(), "{text}"),
            };
            Ok(ExitCode::from(u8::try_from(usage.exit_code()).unwrap_or(error::BAD_INPUT)))
        }
    });
    outcome.unwrap_or_else(|error| {
        report(&error);
        ExitCode::from(error.exit_code())
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

/// Writes indented JSON to stdout; what is not a number is null.
pub fn print_json(value: &impl Serialize) -> Result<(), CliError> {
    // Plain numbers, words and lists: nothing that could fail.
    print(&(serde_json::to_string_pretty(value).unwrap_or_default() + "\n"))
}

/// Writes to stdout; a reader that has gone away (`asperity check ... | head`) is not an error.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(source) if source.kind() != std::io::ErrorKind::BrokenPipe => Err(CliError::Stdout { source }),
        _ => Ok(()),
    }
}
