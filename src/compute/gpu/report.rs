//! What `asperity devices` says.

use super::adapters::{ADAPTER_VARIABLE, Adapter, Choice, DeviceRequest, choose};
use super::drivers::Drivers;
use super::error::GpuError;
use super::memory::MEMORY_VARIABLE;
use super::needs::{needs, unmet};
use crate::compute::select::DEVICE_VARIABLE;
use serde_json::{Value, json};
use std::fmt::Write;

/// What there is beside the adapters.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// The value of `ASPERITY_ADAPTER`.
    pub adapter: Option<String>,
    /// The value of `ASPERITY_DEVICE`.
    pub device: Option<String>,
    /// Whether `auto` takes the GPU that it finds, and why, if that was measured.
    pub measured: Option<(bool, String)>,
    /// Traces of drivers.
    pub drivers: Drivers,
}

impl Surroundings {
    /// What a request comes to.
    fn choose(&self, adapters: &[Adapter], request: DeviceRequest) -> Result<Choice, GpuError> {
        let choice = choose(adapters, request, self.adapter.as_deref()).map_err(|error| match error {
            GpuError::NoAdapter => self.drivers.nothing_found(),
            error => error,
        })?;
        Ok(match (request, &self.measured, choice) {
            (DeviceRequest::Auto, Some((takes, reason)), Choice { adapter: Some(found), named: false, .. }) => {
                Choice { adapter: takes.then_some(found), named: false, reason: reason.clone() }
            }
            (.., choice) => choice,
        })
    }
}

/// The adapters, their features and limits as far as they matter here, what the kernels need, and
/// what `--device auto` and `--device gpu` would take.
pub fn report(adapters: &[Adapter], around: &Surroundings) -> String {
    let mut text = String::new();
    // writing to a String cannot fail
    let _ = write_report(&mut text, adapters, around);
    text
}

/// One adapter for programs: sizes in bytes.
pub fn adapter_json(a: &Adapter) -> Value {
    json!({
        "name": a.name,
        "type": a.kind.to_string(),
        "backend": a.backend,
        "driver": a.driver,
        "double_precision": a.double_precision,
        "timestamps": a.timestamps,
        "max_binding": a.max_binding,
        "max_buffer": a.max_buffer,
        "max_storage_buffers": a.limits.storage_buffers,
        "max_uniform_buffers": a.limits.uniform_buffers,
        "max_uniform_buffer": a.limits.uniform_bytes,
        "max_workgroup": a.limits.threads,
        "max_workgroup_memory": a.limits.shared_bytes,
        "max_workgroups": a.max_workgroups,
        "unmet": unmet(&a.limits),
    })
}

/// What the kernels need, for programs.
pub fn needs_json() -> Value {
    needs().iter().map(|need| json!({ "what": need.what, "needed": need.needed, "kernel": need.kernel })).collect()
}

/// The same as [`report`] for programs.
pub fn report_json(adapters: &[Adapter], around: &Surroundings) -> Value {
    let chosen = |request| match around.choose(adapters, request) {
        Ok(choice) => {
            let device = choice.adapter.map_or("CPU", |i| adapters[i].name.as_str());
            json!({ "device": device, "reason": choice.reason })
        }
        Err(error) => json!({ "device": null, "reason": error.to_string() }),
    };
    json!({
        "adapters": adapters.iter().map(adapter_json).collect::<Vec<_>>(),
        "needs": needs_json(),
        "wanted": around.adapter,
        "device_variable": around.device,
        "hint": around.drivers.hint(adapters),
        "chosen": { "auto": chosen(DeviceRequest::Auto), "gpu": chosen(DeviceRequest::Gpu) },
    })
}

/// What of an adapter's limits the kernels take.
fn write_limits(text: &mut String, adapter: &Adapter) -> std::fmt::Result {
    writeln!(text, "   a kernel has      at most, and needs")?;
    for need in needs() {
        let short = if need.has(&adapter.limits) < need.needed { ": TOO FEW" } else { "" };
        writeln!(text, "   {:>15}   {:>7} {} ({}){short}", need.has(&adapter.limits), need.needed, need.what, need.kernel)?;
    }
    Ok(())
}

fn write_report(text: &mut String, adapters: &[Adapter], around: &Surroundings) -> std::fmt::Result {
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    if adapters.is_empty() {
        let found = match around.drivers.nothing_found() {
            GpuError::BrokenDriver { drivers, .. } => {
                format!("a Vulkan driver is installed ({drivers}), and it opens no device")
            }
            _ => "no Vulkan, Metal or DX12 driver was found".to_owned(),
        };
        writeln!(text, "No GPU adapter: {found}. Everything runs on the CPU.")?;
        writeln!(
            text,
            "A GPU needs its vendor's Vulkan driver; in a container also its Vulkan driver file (VK_DRIVER_FILES) and device nodes."
        )?;
    }
    for (i, a) in adapters.iter().enumerate() {
        writeln!(text, "{i}: {}", a.name)?;
        writeln!(text, "   type              {}", a.kind)?;
        writeln!(text, "   interface         {}, {}", a.backend, a.driver)?;
        let precision = if a.double_precision { "yes" } else { "no: f32 only, the residual stays on the CPU" };
        writeln!(text, "   double precision  {precision}")?;
        writeln!(text, "   timestamps        {}", if a.timestamps { "yes" } else { "no" })?;
        writeln!(text, "   longest array     {:.0} MiB in a kernel, {:.0} MiB in all", mib(a.max_binding), mib(a.max_buffer))?;
        writeln!(text, "   workgroups        {} a direction", a.max_workgroups)?;
        write_limits(text, a)?;
    }
    if let Some(hint) = around.drivers.hint(adapters) {
        writeln!(text, "{hint}")?;
    }
    writeln!(text)?;
    for (name, request) in [("auto", DeviceRequest::Auto), ("gpu", DeviceRequest::Gpu)] {
        match around.choose(adapters, request) {
            Ok(choice) => {
                let device = choice.adapter.map_or("the CPU", |i| adapters[i].name.as_str());
                writeln!(text, "--device {name:4}  {device} ({})", choice.reason)?;
            }
            Err(e) => writeln!(text, "--device {name:4}  {e}")?,
        }
    }
    writeln!(text, "--device cpu   the CPU")?;
    let set = |value: &Option<String>| value.as_ref().map_or_else(|| "not set".to_owned(), |name| format!("set to {name}"));
    writeln!(
        text,
        "\n{DEVICE_VARIABLE} stands for --device where that is not given ({}); {ADAPTER_VARIABLE} selects an adapter by a part of \
         its name ({}); {MEMORY_VARIABLE} is the memory to use, MiB.",
        set(&around.device),
        set(&around.adapter)
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::gpu::AdapterKind;
    use crate::compute::gpu::needs::ENOUGH;

    fn adapter(name: &str, kind: AdapterKind) -> Adapter {
        Adapter {
            name: name.into(),
            kind,
            backend: "vulkan".into(),
            driver: "Mesa 22".into(),
            double_precision: true,
            timestamps: true,
            max_binding: 128 << 20,
            max_buffer: 2 << 30,
            limits: ENOUGH,
            max_workgroups: 65535,
        }
    }

    #[test]
    fn says_what_was_measured_and_what_is_too_small() {
        let integrated = adapter("Iris Xe", AdapterKind::Integrated);
        for (takes, device) in [(true, "Iris Xe"), (false, "the CPU")] {
            let measured = Some((takes, "as measured".to_owned()));
            let around = Surroundings { measured, device: Some("auto".into()), ..Surroundings::default() };
            let text = report(std::slice::from_ref(&integrated), &around);
            assert!(text.contains(&format!("--device auto  {device} (as measured)")), "{text}");
            assert!(text.contains("--device gpu   Iris Xe (") && text.contains("not given (set to auto)"), "{text}");
        }
        let mut small = integrated;
        small.limits.storage_buffers = 4;
        let text = report(std::slice::from_ref(&small), &Surroundings::default());
        assert!(text.contains("): TOO FEW\n") && text.contains("--device gpu   Iris Xe: needs "), "{text}");
        let json = report_json(&[small], &Surroundings::default());
        assert!(json["adapters"][0]["unmet"].as_str().is_some_and(|unmet| unmet.ends_with("the adapter has 4")), "{json}");
    }

    #[test]
    fn a_broken_driver_and_a_hidden_card_are_told_of() {
        let drivers = Drivers { manifests: vec!["nvidia_icd.json".into()], nvidia: true, capabilities: Some("compute".into()) };
        let around = Surroundings { drivers, ..Surroundings::default() };
        let text = report(&[], &around);
        for part in
            ["is installed (nvidia_icd.json), and it opens no device", "NVIDIA_DRIVER_CAPABILITIES has to contain graphics"]
        {
            assert!(text.contains(part), "{part}: {text}");
        }
        let text = report(&[adapter("llvmpipe", AdapterKind::Software)], &around);
        assert!(text.contains("it is compute"), "{text}");
    }

    #[test]
    fn says_what_is_there_and_what_is_chosen() {
        let software = adapter("llvmpipe", AdapterKind::Software);
        let text = report(&[software], &Surroundings::default());
        for line in [
            "0: llvmpipe",
            "type              software (CPU)",
            "double precision  yes",
            "longest array     128 MiB in a kernel, 2048 MiB in all",
            "8         8 storage buffers in one kernel (",
            "--device auto  the CPU (only a software adapter is present",
            "--device gpu   llvmpipe (no real GPU is of use",
        ] {
            assert!(text.contains(line), "{line}: {text}");
        }
    }

    #[test]
    fn says_that_there_is_nothing() {
        let a100 = Surroundings { adapter: Some("A100".into()), ..Surroundings::default() };
        let json = report_json(&[], &a100);
        assert_eq!(json["adapters"], json!([]));
        assert_eq!(json["chosen"]["gpu"]["device"], Value::Null);
        assert!(json["chosen"]["gpu"]["reason"].as_str().is_some_and(|reason| reason.contains("A100")), "{json}");
        let text = report(&[], &Surroundings::default());
        for line in
            ["No GPU adapter", "--device auto  the CPU (no adapter is present)", "--device gpu   no GPU found", "--device cpu"]
        {
            assert!(text.contains(line), "{line}: {text}");
        }
        let text = report(&[], &a100);
        assert!(text.contains("ASPERITY_ADAPTER=A100: no adapter has this in its name. Present: none"), "{text}");
    }
}
