//! The options that several subcommands share.

use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

use clap::{ArgAction, Args, ValueEnum};
use log::LevelFilter;

use super::CliError;
use crate::case::PictureFormat;
use crate::output::plots::axes::AxisUnits;

/// Where the kernels run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Device {
    /// A GPU if a short measurement finds it faster than the CPU; never a software adapter.
    #[default]
    Auto,
    /// The CPU.
    Cpu,
    /// A GPU, and an error if there is none.
    Gpu,
}

/// The floating-point precision of the kernels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PrecisionOption {
    /// f64 where the device has it.
    #[default]
    Auto,
    /// The same as mixed.
    F32,
    /// Double precision.
    F64,
    /// Steps in f32 on the device, checked by the CPU in f64: what auto does on a device without
    /// f64.
    Mixed,
}

/// The format of a picture's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// For browsers and drawing programs.
    Svg,
    /// For LaTeX and for print, with its font.
    Pdf,
    /// 300 pixels to the inch, or as many as --width says in px.
    Png,
}

impl From<Format> for PictureFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Svg => Self::Svg,
            Format::Pdf => Self::Pdf,
            Format::Png => Self::Png,
        }
    }
}

/// The units of axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum UnitsOption {
    /// Those of the case if its table `units` names them, else none.
    #[default]
    Auto,
    /// None: forces over E R^2, lengths over R, stresses over E.
    None,
    /// Those of the case.
    Case,
}

impl From<UnitsOption> for AxisUnits {
    fn from(units: UnitsOption) -> Self {
        match units {
            UnitsOption::Auto => Self::Auto,
            UnitsOption::None => Self::Normalised,
            UnitsOption::Case => Self::Case,
        }
    }
}

/// Where and how precisely to compute.
#[derive(Clone, Debug, Args)]
pub struct DeviceArgs {
    /// Where the kernels run. The default is ASPERITY_DEVICE if it is set, else auto.
    #[arg(long, value_enum, value_name = "DEVICE")]
    pub device: Option<Device>,
    /// Floating-point precision of the kernels.
    #[arg(long, value_enum, default_value_t, value_name = "PRECISION")]
    pub precision: PrecisionOption,
    /// Number of threads; by default all of the machine's.
    #[arg(long, value_name = "N", value_parser = threads)]
    pub threads: Option<NonZeroUsize>,
}

/// How much to say on stderr.
#[derive(Clone, Debug, Args)]
pub struct Verbosity {
    /// Print errors only, no progress.
    #[arg(short, long, conflicts_with = "verbose")]
    pub quiet: bool,
    /// Print more: at the end every result and the time of each phase; if given twice, every Newton
    /// iteration too.
    #[arg(short, long, action = ArgAction::Count)]
    pub verbose: u8,
}

/// Where the results of `file` go: into `out`, and without it into the directory of the file's name
/// less its extension, with `kind` behind it.
pub fn out_or_name(out: Option<&PathBuf>, file: &Path, kind: &str) -> PathBuf {
    let named = || {
        let mut name = file.file_stem().unwrap_or_default().to_owned();
        // A file without an extension stands there already.
        name.push(if file.extension().is_none() && kind.is_empty() { "-out" } else { kind });
        PathBuf::from(name)
    };
    out.cloned().unwrap_or_else(named)
}

/// Most threads that are taken for meant, unless the machine has more: beyond it, it is their
/// number that takes the time.
const MOST_THREADS: usize = 256;

fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let machine = std::thread::available_parallelism().map_or(1, NonZeroUsize::get);
    let most = MOST_THREADS.max(machine);
    let number = text.parse::<NonZeroUsize>().ok().filter(|number| number.get() <= most);
    number.ok_or_else(|| format!("a number of threads is from 1 to {most}; this machine runs {machine} at a time"))
}

impl DeviceArgs {
    /// Starts the pool of threads; to be called once, before anything uses it.
    pub fn start_threads(&self) -> Result<(), CliError> {
        // None is as many as the machine has.
        let pool = rayon::ThreadPoolBuilder::new().num_threads(self.threads.map_or(0, NonZeroUsize::get));
        let threads = self.threads.or_else(|| std::thread::available_parallelism().ok()).map_or(1, NonZeroUsize::get);
        pool.build_global().map_err(|error| CliError::Threads { threads, what: error.to_string() })
    }
}

impl Verbosity {
    /// Starts the log on stderr: warnings, with `-v` information, with `-vv` every iteration.
    pub fn start_log(&self) {
        let level = match (self.quiet, self.verbose) {
            (true, _) => LevelFilter::Error,
            (false, 0) => LevelFilter::Warn,
            (false, 1) => LevelFilter::Info,
            (false, _) => LevelFilter::Debug,
        };
        // Graphics drivers and their layers talk about themselves: only their errors are of
        // interest here.
        let mut log = env_logger::Builder::new();
        log.filter_level(LevelFilter::Error).filter_module("asperity", level).format_target(false).format_timestamp(None);
        // A log that is already there (in tests) stays.
        let _ = log.try_init();
    }
}
