//! A source compiled by naga as wgpu will, without a device, for messages with file and line.

use super::error::GpuError;
use super::source::{Assembled, Precision};
use naga::Module;
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

/// A parsed and validated source.
#[derive(Debug)]
pub struct ValidSource {
    /// naga's module.
    pub module: Module,
    /// The types of its expressions.
    pub info: ModuleInfo,
}

/// Parses and validates a source as wgpu will, without a device.
///
/// # Errors
/// [`GpuError::Shader`] with file and line.
pub fn validate(source: &Assembled) -> Result<ValidSource, GpuError> {
    let fail = |byte: Option<u32>, message: String| GpuError::Shader { place: source.place(byte.unwrap_or(0) as usize), message };
    let module = naga::front::wgsl::parse_str(&source.text)
        .map_err(|e| fail(e.location(&source.text).map(|l| l.offset), e.message().to_owned()))?;
    let capabilities = match source.precision {
        Precision::F32 => Capabilities::empty(),
        Precision::F64 => Capabilities::FLOAT64,
    };
    match Validator::new(ValidationFlags::all(), capabilities).validate(&module) {
        Ok(info) => Ok(ValidSource { module, info }),
        Err(e) => {
            // the innermost of naga's labels is the expression, the outermost the function
            let start = e.spans().filter_map(|(span, _)| span.to_range()).max_by_key(|r| r.start).map(|r| r.start as u32);
            let mut message = e.as_inner().to_string();
            let mut cause = std::error::Error::source(e.as_inner());
            while let Some(inner) = cause {
                message = format!("{message}: {inner}");
                cause = inner.source();
            }
            Err(fail(start, message))
        }
    }
}
