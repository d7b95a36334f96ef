//! SIGINT (Ctrl-C) and SIGTERM (a batch system's time limit): the run ends after its present step; a second signal ends it at once.

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;

use super::CliError;

/// A flag that the first SIGINT or SIGTERM sets. SIGHUP is left alone, so that `nohup` means what it says.
pub fn stop_flag() -> Result<Arc<AtomicBool>, CliError> {
    let stop = Arc::new(AtomicBool::new(false));
    for signal in [SIGINT, SIGTERM] {
        // In this order: the signal that sets the flag finds it unset.
        flag::register_conditional_shutdown(signal, 128 + signal, Arc::clone(&stop))
            .and_then(|_| flag::register(signal, Arc::clone(&stop)))
            .map_err(|source| CliError::Signals { source })?;
    }
    Ok(stop)
}
