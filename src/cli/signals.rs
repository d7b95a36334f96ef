//! What signals do. SIGINT (Ctrl-C), SIGTERM, SIGHUP (a terminal that was closed) and the warnings
//! of batch systems (SIGUSR1, SIGUSR2, SIGXCPU): the run ends after its present step. SIGXFSZ (a
//! file at the limit of its size): nothing, so that the write fails and is told as an error.

use std::sync::Arc;
#[cfg(unix)]
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

#[cfg(unix)]
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1, SIGUSR2, SIGXCPU, SIGXFSZ};

use super::CliError;

/// Signals so close to each other are one: batch systems send theirs to a script, which hands it
/// on, and to the program as well.
const ONE_SIGNAL: Duration = Duration::from_millis(250);

/// Signals that end a run after its present step; a second one ends it at once.
#[cfg(unix)]
const ENDING: [i32; 3] = [SIGINT, SIGTERM, SIGHUP];
/// Signals by which batch systems warn that time is nearly over. They end a run after its present
/// step too, but never at once: some systems repeat them, and SIGXCPU comes every second.
#[cfg(unix)]
const WARNING: [i32; 3] = [SIGUSR1, SIGUSR2, SIGXCPU];

/// To be called before anything else: notes which signals are ignored, and lets a write that would
/// make a file larger than `ulimit -f` allows fail (EFBIG) rather than end the program.
pub fn begin() {
    #[cfg(unix)]
    {
        ignored_at_start();
        // A handler that does nothing else. Where there can be none, such a write ends the program,
        // which loses no more than a kill does.
        let _ = signal_hook::flag::register(SIGXFSZ, Arc::default());
    }
}

/// A flag that the first signal sets. A signal that was ignored when the program was started stays
/// so, so that `nohup`, `trap '' INT` and the background of a script mean what they say.
///
/// # Errors
/// [`CliError::Signals`].
#[cfg(unix)]
pub fn stop_flag() -> Result<Arc<AtomicBool>, CliError> {
    let failed = |source| CliError::Signals { source };
    let wanted = ENDING.into_iter().chain(WARNING).filter(|signal| !is_ignored(*signal));
    let mut signals = signal_hook::iterator::Signals::new(wanted).map_err(failed)?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let listen = move || {
        let mut first: Option<Instant> = None;
        for signal in signals.forever() {
            let again = first.is_some_and(|first| first.elapsed() >= ONE_SIGNAL);
            if again && !WARNING.contains(&signal) {
                std::process::exit(128 + signal);
            }
            first.get_or_insert_with(Instant::now);
            flag.store(true, Ordering::Relaxed);
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen).map_err(failed)?;
    Ok(stop)
}

/// Whether a signal was ignored at [`begin`], or at the first question, as far as the system tells:
/// where the program was started so (`nohup`).
#[cfg(unix)]
pub fn is_ignored(signal: i32) -> bool {
    ignored_at_start() >> (signal - 1) & 1 == 1
}

/// A bit for each ignored signal, the lowest for signal 1; none on systems without `/proc`.
#[cfg(unix)]
fn ignored_at_start() -> u64 {
    static MASK: OnceLock<u64> = OnceLock::new();
    *MASK.get_or_init(|| {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).map(str::trim);
        mask.and_then(|mask| u64::from_str_radix(mask, 16).ok()).unwrap_or(0)
    })
}

/// A flag that the first Ctrl-C sets; the second ends the program.
///
/// # Errors
/// [`CliError::Signals`].
#[cfg(not(unix))]
pub fn stop_flag() -> Result<Arc<AtomicBool>, CliError> {
    use signal_hook::consts::{SIGINT, SIGTERM};
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the signal that sets the flag finds it unset.
        signal_hook::flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&stop))
            .and_then(|_| signal_hook::flag::register(signal, Arc::clone(&stop)))
            .map_err(|source| CliError::Signals { source })?;
    }
    let _ = (ONE_SIGNAL, Ordering::Relaxed, Instant::now);
    Ok(stop)
}
