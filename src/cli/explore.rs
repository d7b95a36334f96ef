//! `asperity explore`: a law to look at, in the browser.

use std::io::Write as _;
use std::num::NonZeroUsize;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use clap::Args;

use super::backend::{device_choice, precision_choice};
use super::input::InputFile;
use super::options::DeviceArgs;
use super::signals::stop_flag;
use super::{CliError, Exit, print};
use crate::case::Case;
use crate::explore::{Beginning, End, Explorer, FIRST_CASE, Resources, Server, StudyCases, read_run, token};
use crate::law::LawFile;
use crate::law::file::BUILT_IN;

/// Look at a law in the browser, simulate what is shown, export it.
///
/// Plots forces over displacements for any material, friction and depth, with the law's errors and
/// closed forms. The page is served to this machine only. The program ends with Ctrl-C, or after an
/// hour without a request.
#[derive(Clone, Debug, Args)]
pub struct ExploreArgs {
    /// The case that the page begins with, or the directory of a run, whose results are drawn over
    /// the law [default: an ideally plastic sphere].
    #[arg(value_name = "CASE")]
    pub case: Option<PathBuf>,
    /// The law: `built-in`, or a law.json that `law fit`, `law tabulate` or `law compose` wrote.
    #[arg(long, value_name = "LAW.json", default_value = BUILT_IN)]
    pub law: PathBuf,
    /// The directory of a study, whose cases are drawn over the law as points.
    #[arg(long, value_name = "DIR")]
    pub study: Option<PathBuf>,
    /// The port; 0 means any free port.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub port: u16,
    /// Print the address and start no browser.
    #[arg(long)]
    pub no_browser: bool,
    /// Where simulations that the page starts compute; by default on all cores but one.
    #[command(flatten)]
    pub device: DeviceArgs,
    /// Seconds without a request after which it ends, for tests.
    #[arg(long, value_name = "SECONDS", hide = true, default_value_t = 3600)]
    pub idle: u64,
}

/// Serves the page until it is told to end.
pub fn explore(args: &ExploreArgs) -> Result<Exit, CliError> {
    let stop = stop_flag()?;
    let law = LawFile::read_or_built_in(&args.law)?;
    let earlier = args.case.as_deref().filter(|case| case.is_dir()).map(read_run).transpose()?;
    let base = match (&args.case, &earlier) {
        (_, Some(run)) => run.case.clone(),
        (Some(file), None) => InputFile::read(file)?.case(&[])?,
        (None, None) => Case::parse(FIRST_CASE, "first.toml", &[])?,
    };
    let study = args.study.as_deref().map(StudyCases::read).transpose()?.unwrap_or_default();
    let cores = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let threads = args.device.threads.or_else(|| NonZeroUsize::new(cores - 1)).unwrap_or(NonZeroUsize::MIN);
    let place = Resources { device: device_choice(&args.device), precision: precision_choice(&args.device), threads };
    let beginning = Beginning { law, base, study, earlier, place, tell };
    let explorer = Arc::new(Explorer::new(beginning));
    let failed = |source| CliError::Serve { port: args.port, source };
    let server = Server::bind(args.port, token()).map_err(failed)?;
    let address = server.address();
    print(&format!("{address}\n"))?;
    tell("who has this address can use the page; Ctrl-C ends it");
    if !args.no_browser {
        open(&address);
    }
    let end = server.run(&explorer, &stop, Duration::from_secs(args.idle)).map_err(failed)?;
    if explorer.end() {
        tell("the simulation that was running is cancelled");
    }
    match end {
        End::Stopped => tell("ended"),
        End::Idle => tell("ended, as nobody asked for anything for so long"),
    }
    Ok(Exit::Done)
}

/// Says something on stderr; a closed one changes nothing.
fn tell(text: &str) {
    let _ = writeln!(std::io::stderr(), "{text}");
}

/// Opens the address with what the system has for that. Where there is nothing, the printed address
/// is what the user has.
fn open(address: &str) {
    let program = if cfg!(target_os = "macos") {
        "open"
    } else if cfg!(windows) {
        "explorer"
    } else {
        "xdg-open"
    };
    let quiet = || std::process::Stdio::null();
    let started = std::process::Command::new(program).arg(address).stdin(quiet()).stdout(quiet()).stderr(quiet()).spawn();
    match started {
        // Taken from the system's table when it ends, whatever that says.
        Ok(mut child) => drop(std::thread::spawn(move || child.wait())),
        Err(_) => tell("no browser could be started; open the address yourself"),
    }
}
