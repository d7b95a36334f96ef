//! What comes from outside and is looked at before anything is done: environment variables, and
//! arguments too long to be echoed.

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

/// Where it stands that a GPU is to be used, as it would be typed.
pub fn gpu_asked_by() -> String {
    let is_option = |argument: std::ffi::OsString| argument.to_string_lossy().starts_with("--device");
    let by_variable = DeviceChoice::of_environment() == Ok(DeviceChoice::Gpu) && !super::arguments().into_iter().any(is_option);
    if by_variable { format!("{DEVICE_VARIABLE}=gpu") } else { "--device gpu".to_owned() }
}

fn memory(value: &str) -> bool {
    value.trim().parse::<u64>().is_ok_and(|mib| mib > 0)
}

/// A message in which long arguments of this program are shortened; `None` if there are none.
pub fn shortened(message: &str) -> Option<String> {
    let mut text = message.to_owned();
    for argument in super::arguments().into_iter().skip(1) {
        let argument = argument.to_string_lossy().into_owned();
        let value = argument.split_once('=').map_or(argument.as_str(), |(_, value)| value);
        for long in [argument.as_str(), value] {
            if short(long) != long {
                text = text.replace(long, &short(long));
            }
        }
    }
    (text != message).then_some(text)
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
