//! SIGINT (Ctrl-C), SIGTERM and SIGUSR1 (a batch system's time limit, or its warning of it) and
//! SIGHUP (a terminal that was closed): the run ends after its present step; a second signal ends
//! it at once.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::CliError;

/// Signals so close to each other are one: batch systems send theirs to a script, which hands it
/// on, and to the program as well.
const ONE_SIGNAL: Duration = Duration::from_millis(250);

/// A flag that the first signal sets. SIGHUP is left alone where it is ignored, so that `nohup`
/// means what it says.
///
/// # Errors
/// [`CliError::Signals`].
#[cfg(unix)]
pub fn stop_flag() -> Result<Arc<AtomicBool>, CliError> {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGUSR1};
    let failed = |source| CliError::Signals { source };
    let wanted = [SIGINT, SIGTERM, SIGUSR1].into_iter().chain((!is_ignored(SIGHUP)).then_some(SIGHUP));
    let mut signals = signal_hook::iterator::Signals::new(wanted).map_err(failed)?;
    let stop = Arc::new(AtomicBool::new(false));
    let flag = Arc::clone(&stop);
    let listen = move || {
        let mut first: Option<Instant> = None;
        for signal in signals.forever() {
            if first.is_some_and(|first| first.elapsed() >= ONE_SIGNAL) {
                std::process::exit(128 + signal);
            }
            first.get_or_insert_with(Instant::now);
            flag.store(true, Ordering::Relaxed);
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(listen).map_err(failed)?;
    Ok(stop)
}

/// Whether a signal is ignored, as far as the system tells: where the program is started, by what
/// started it (`nohup`).
#[cfg(unix)]
pub fn is_ignored(signal: i32) -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:")).map(str::trim);
    mask.and_then(|mask| u64::from_str_radix(mask, 16).ok()).is_some_and(|mask| mask >> (signal - 1) & 1 == 1)
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
