//! What the program was called with.

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::OnceLock;

use crate::case::short;
use crate::compute::select::{DEVICE_VARIABLE, DeviceChoice};

/// What the program was called with, where it runs within another one.
static CALLED_WITH: OnceLock<Vec<OsString>> = OnceLock::new();

/// What the program was called with, its name first.
pub fn arguments() -> Vec<OsString> {
    CALLED_WITH.get().cloned().unwrap_or_else(|| std::env::args_os().collect())
}

/// The program's file, as a script can call it.
///
/// # Errors
/// What the system says where it does not tell.
pub fn program() -> std::io::Result<PathBuf> {
    match CALLED_WITH.get().and_then(|arguments| arguments.first()) {
        Some(name) => std::path::absolute(name),
        None => std::env::current_exe(),
    }
}

/// Sets what the program was called with within another one; to be called once.
pub fn set_arguments(arguments: Vec<OsString>) {
    let _ = CALLED_WITH.set(arguments);
}

/// Where it stands that a GPU is to be used, as it would be typed.
pub fn gpu_asked_by() -> String {
    let is_option = |argument: OsString| argument.to_string_lossy().starts_with("--device");
    let by_variable = DeviceChoice::of_environment() == Ok(DeviceChoice::Gpu) && !arguments().into_iter().any(is_option);
    if by_variable { format!("{DEVICE_VARIABLE}=gpu") } else { "--device gpu".to_owned() }
}

/// A message in which long arguments of this program are shortened; `None` if there are none.
pub fn shortened(message: &str) -> Option<String> {
    let mut text = message.to_owned();
    for argument in arguments().into_iter().skip(1) {
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
