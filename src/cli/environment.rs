//! What comes from outside and is looked at before anything is done: environment variables, and
//! arguments too long to be echoed.

use super::CliError;
use crate::case::short;
use crate::compute::gpu::memory::MEMORY_VARIABLE;

/// Refuses environment variables that mean nothing.
///
/// # Errors
/// [`CliError::Variable`].
pub fn check() -> Result<(), CliError> {
    let Some(value) = std::env::var_os(MEMORY_VARIABLE) else { return Ok(()) };
    let value = value.to_string_lossy();
    if memory(&value) {
        return Ok(());
    }
    Err(CliError::Variable {
        name: MEMORY_VARIABLE,
        value: short(&value).into_owned(),
        what: "is not a whole number of MiB greater than 0, as in 4096",
    })
}

fn memory(value: &str) -> bool {
    value.trim().parse::<u64>().is_ok_and(|mib| mib > 0)
}

/// A message in which long arguments of this program are shortened; `None` if there are none.
pub fn shortened(message: &str) -> Option<String> {
    let mut text = message.to_owned();
    for argument in std::env::args_os().skip(1) {
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
