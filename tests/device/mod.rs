//! A device for tests: every test states what it needs and is skipped aloud where that is missing.

use asperity::internals::compute::gpu::{DeviceRequest, GpuContext, GpuError, Precision};
use std::io::Write;

/// The device, or none after a line on stderr that no test runner swallows.
///
/// With `ASPERITY_REQUIRE_GPU=1` a missing device is a failure: a machine that is meant to have one
/// must not pass by skipping.
pub fn device(test: &str, precision: Precision) -> Option<GpuContext> {
    let opened = GpuContext::open(DeviceRequest::Gpu);
    let missing = match opened {
        Ok(Some(context)) => match context.supports(precision) {
            Ok(()) => return Some(context),
            Err(e) => e.to_string(),
        },
        Ok(None) => "no Vulkan adapter".to_owned(),
        Err(GpuError::NoAdapter) => "no Vulkan adapter".to_owned(),
        Err(e) => e.to_string(),
    };
    let required = std::env::var("ASPERITY_REQUIRE_GPU").is_ok_and(|v| v == "1");
    assert!(!required, "ASPERITY_REQUIRE_GPU=1, and {test} has no device: {missing}");
    // The print macros are captured for passing tests; the handle is not.
    #[allow(clippy::explicit_write)]
    writeln!(std::io::stderr(), "SKIPPED: {missing} ({test}, {precision})").unwrap();
    None
}
