//! The environment variables of this program, which are looked at before anything is done.

use super::CliError;
use crate::case::short;
use crate::compute::gpu::memory::MEMORY_VARIABLE;
use crate::compute::select::{DEVICE_VARIABLE, DeviceChoice};

/// Refuses environment variables that mean nothing.
///
/// # Errors
/// [`CliError::Variable`].
pub fn check() -> Result<(), CliError> {
    let refused = |name: &'static str, value: &str, what: &'static str| {
        Err(CliError::Variable { name, value: short(value).into_owned(), what })
    };
    if let Err(value) = DeviceChoice::of_environment() {
        return refused(DEVICE_VARIABLE, &value, "is no device. Allowed: auto, cpu, gpu");
    }
    let Some(value) = std::env::var_os(MEMORY_VARIABLE) else { return Ok(()) };
    let value = value.to_string_lossy();
    if memory(&value) {
        return Ok(());
    }
    refused(MEMORY_VARIABLE, &value, "is not a whole number of MiB greater than 0, as in 4096")
}

fn memory(value: &str) -> bool {
    value.trim().parse::<u64>().is_ok_and(|mib| mib > 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_is_a_whole_number_of_mebibytes() {
        assert!(memory("4096") && memory(" 1 "));
        for wrong in ["abc", "", "0", "-1", "1.5", "1e3", "99999999999999999999999"] {
            assert!(!memory(wrong), "{wrong}");
        }
    }
}
