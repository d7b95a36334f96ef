//! What `asperity devices` says.

use super::adapters::{ADAPTER_VARIABLE, Adapter, DeviceRequest, choose};
use super::memory::MEMORY_VARIABLE;
use serde_json::{Value, json};
use std::fmt::Write;

/// The adapters, their features and limits as far as they matter here, and what `--device auto` and
/// `--device gpu` would take.
///
/// `wanted` is the value of `ASPERITY_ADAPTER`.
pub fn report(adapters: &[Adapter], wanted: Option<&str>) -> String {
    let mut text = String::new();
    // writing to a String cannot fail
    let _ = write_report(&mut text, adapters, wanted);
    text
}

/// The same for programs: sizes in bytes.
pub fn report_json(adapters: &[Adapter], wanted: Option<&str>) -> Value {
    let adapter = |a: &Adapter| {
        json!({
            "name": a.name,
            "type": a.kind.to_string(),
            "backend": a.backend,
            "driver": a.driver,
            "double_precision": a.double_precision,
            "timestamps": a.timestamps,
            "max_binding": a.max_binding,
            "max_buffer": a.max_buffer,
            "max_storage_buffers": a.max_storage_buffers,
            "max_workgroup": a.max_workgroup,
            "max_workgroups": a.max_workgroups,
        })
    };
    let chosen = |request| match choose(adapters, request, wanted) {
        Ok(choice) => {
            let device = choice.adapter.map_or("CPU", |i| adapters[i].name.as_str());
            json!({ "device": device, "reason": choice.reason })
        }
        Err(error) => json!({ "device": null, "reason": error.to_string() }),
    };
    json!({
        "adapters": adapters.iter().map(adapter).collect::<Vec<_>>(),
        "wanted": wanted,
        "chosen": { "auto": chosen(DeviceRequest::Auto), "gpu": chosen(DeviceRequest::Gpu) },
    })
}

fn write_report(text: &mut String, adapters: &[Adapter], wanted: Option<&str>) -> std::fmt::Result {
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    if adapters.is_empty() {
        writeln!(text, "No GPU adapter: no Vulkan, Metal or DX12 driver was found. Everything runs on the CPU.")?;
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
        writeln!(text, "   arrays a kernel   {}", a.max_storage_buffers)?;
        writeln!(text, "   workgroup         {} threads, {} groups a direction", a.max_workgroup, a.max_workgroups)?;
    }
    writeln!(text)?;
    for (name, request) in [("auto", DeviceRequest::Auto), ("gpu", DeviceRequest::Gpu)] {
        match choose(adapters, request, wanted) {
            Ok(choice) => {
                let device = choice.adapter.map_or("the CPU", |i| adapters[i].name.as_str());
                writeln!(text, "--device {name:4}  {device} ({})", choice.reason)?;
            }
            Err(e) => writeln!(text, "--device {name:4}  {e}")?,
        }
    }
    writeln!(text, "--device cpu   the CPU")?;
    let set = wanted.map_or_else(|| "not set".to_owned(), |name| format!("set to {name}"));
    writeln!(
        text,
        "\n{ADAPTER_VARIABLE} selects an adapter by a part of its name ({set}); {MEMORY_VARIABLE} is the memory to use, MiB."
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compute::gpu::AdapterKind;

    #[test]
    fn says_what_is_there_and_what_is_chosen() {
        let software = Adapter {
            name: "llvmpipe".into(),
            kind: AdapterKind::Software,
            backend: "vulkan".into(),
            driver: "Mesa 22".into(),
            double_precision: true,
            timestamps: true,
            max_binding: 128 << 20,
            max_buffer: 2 << 30,
            max_storage_buffers: 32,
            max_workgroup: 1024,
            max_workgroups: 65535,
        };
        let text = report(&[software], None);
        for line in [
            "0: llvmpipe",
            "type              software (CPU)",
            "double precision  yes",
            "longest array     128 MiB in a kernel, 2048 MiB in all",
            "--device auto  the CPU (only a software adapter is present",
            "--device gpu   llvmpipe (no real GPU is present",
        ] {
            assert!(text.contains(line), "{line}: {text}");
        }
    }

    #[test]
    fn says_that_there_is_nothing() {
        let json = report_json(&[], Some("A100"));
        assert_eq!(json["adapters"], json!([]));
        assert_eq!(json["chosen"]["gpu"]["device"], Value::Null);
        assert!(json["chosen"]["gpu"]["reason"].as_str().is_some_and(|reason| reason.contains("A100")), "{json}");
        let text = report(&[], None);
        for line in
            ["No GPU adapter", "--device auto  the CPU (no adapter is present)", "--device gpu   no GPU found", "--device cpu"]
        {
            assert!(text.contains(line), "{line}: {text}");
        }
        let text = report(&[], Some("A100"));
        assert!(text.contains("ASPERITY_ADAPTER=A100: no adapter has this in its name. Present: none"), "{text}");
    }
}
