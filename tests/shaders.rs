//! Every shader in both precisions, without a device: it compiles, does not contain what compiles
//! and is wrong, and is what the kernel list says of it.

#[path = "shaders/lint.rs"]
mod lint;

use asperity::internals::compute::gpu::kernel::Kernel;
use asperity::internals::compute::gpu::kernels::KERNELS;
use asperity::internals::compute::gpu::reflect::{Binding, KernelInterface};
use asperity::internals::compute::gpu::shader_sources::{MATH, TENSOR};
use asperity::internals::compute::gpu::source::{Assembled, Precision, ShaderSource};
use asperity::internals::compute::gpu::validate::{ValidSource, validate};
use asperity::material::HardeningLaw;
use lint::Rule;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

fn each_kernel(mut check: impl FnMut(&Kernel, Precision, &Assembled)) {
    assert!(!KERNELS.is_empty());
    for kernel in KERNELS {
        for precision in Precision::ALL {
            check(kernel, precision, &kernel.assemble(precision));
        }
    }
}

#[test]
fn every_kernel_compiles_and_is_clean() {
    each_kernel(|kernel, precision, source| {
        let findings = lint::lint(source).unwrap_or_else(|e| panic!("{} in {precision}: {e}", kernel.name));
        let lines: Vec<String> = findings.iter().map(|f| format!("{}: {}", f.place, f.rule)).collect();
        assert!(lines.is_empty(), "{} in {precision}:\n{}", kernel.name, lines.join("\n"));
    });
}

#[test]
fn every_shader_file_is_in_some_kernel() {
    fn files(folder: &Path, found: &mut Vec<PathBuf>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() { files(&path, found) } else { found.push(path) }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    files(&root.join("shaders"), &mut found);
    assert!(found.len() > 3);
    let listed: Vec<&str> = KERNELS.iter().flat_map(|k| k.sources).map(|s| s.path).collect();
    for path in found {
        let path = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
        assert!(path.starts_with("shaders/prelude_") || listed.contains(&path.as_str()), "{path} is in no kernel");
    }
}

/// The codes by which a material's parameters name its hardening law.
#[test]
fn hardening_laws_have_the_codes_of_the_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("shaders/material/hardening.wgsl");
    let text = std::fs::read_to_string(path).unwrap();
    for law in HardeningLaw::ALL {
        let line = format!("const {}: u32 = {}u;", law.word().to_uppercase(), law.code());
        assert!(text.lines().any(|found| found == line), "hardening.wgsl lacks `{line}`");
    }
}

#[test]
fn every_kernel_has_one_entry_point_of_its_name_and_takes_the_same_in_both_precisions() {
    each_kernel(|kernel, precision, source| {
        let ValidSource { module, .. } = validate(source).unwrap();
        assert_eq!(module.entry_points.len(), 1, "{}", kernel.name);
        let (entry, interface) = (&module.entry_points[0], KernelInterface::of(source).unwrap());
        assert_eq!((entry.name.as_str(), entry.workgroup_size), (kernel.name, [interface.workgroup, 1, 1]));
        // Arguments are bound to group 0 alone, and to what a shader may call a binding.
        for (_, variable) in module.global_variables.iter().filter(|(_, variable)| variable.binding.is_some()) {
            assert!(variable.binding.is_some_and(|place| place.group == 0), "{:?} of {}", variable.name, kernel.name);
            let is_array = matches!(variable.space, naga::AddressSpace::Uniform | naga::AddressSpace::Storage { .. });
            assert!(is_array, "{:?} of {} in {precision}", variable.name, kernel.name);
        }
        let (listed, of_kernel) = (&interface.variables, kernel.interface().unwrap());
        assert!(listed.len() > 1, "{}", kernel.name);
        assert_eq!((listed, interface.workgroup), (&of_kernel.variables, of_kernel.workgroup), "{} in {precision}", kernel.name);
    });
}

/// What WebGPU promises of every adapter: eight storage buffers and twelve uniform ones in a
/// kernel, 256 threads and 16 KiB in a workgroup. Of a uniform buffer Vulkan promises 16 KiB.
#[test]
fn no_kernel_takes_more_than_every_adapter_has() {
    let mut beyond = Vec::new();
    for kernel in KERNELS {
        let interface = kernel.interface().unwrap();
        let names = |uniform: bool| {
            let found = interface.variables.iter().filter(|variable| (variable.kind == Binding::Uniform) == uniform);
            found.map(|variable| variable.name.as_str()).collect::<Vec<_>>()
        };
        let (arrays, blocks) = (names(false), names(true));
        if arrays.len() > 8 || blocks.len() > 12 {
            beyond.push(format!("{} binds {} storage buffers: {}", kernel.name, arrays.len(), arrays.join(", ")));
        }
        let sizes = (interface.workgroup, interface.shared_bytes, interface.uniform_bytes);
        if sizes.0 > 256 || sizes.1 > 16 << 10 || sizes.2 > 16 << 10 {
            beyond.push(format!("{}: threads, shared bytes and bytes of a block {sizes:?}", kernel.name));
        }
    }
    assert!(beyond.is_empty(), "{}", beyond.join("\n"));
}

/// Local arrays are what makes drivers compile for minutes and kernels crawl.
#[test]
fn private_arrays_stay_small() {
    each_kernel(|kernel, precision, source| {
        let largest = lint::private_bytes(&validate(source).unwrap());
        let limit = if precision == Precision::F64 { 1024 } else { 512 };
        assert!(largest[0].1 <= limit, "{} in {precision}: {} has {} bytes", kernel.name, largest[0].0, largest[0].1);
    });
}

fn rules(precision: Precision, text: &'static str) -> Vec<(String, Rule)> {
    let prelude = KERNELS[0].assemble(precision);
    let prelude: &'static str = prelude.text[..prelude.shared_start()].to_owned().leak();
    let parts = [ShaderSource { path: "prelude", text: prelude }, MATH, TENSOR, ShaderSource { path: "snippet", text }];
    let findings = lint::lint(&Assembled::new(precision, &parts)).unwrap_or_else(|e| panic!("{text}: {e}"));
    findings.into_iter().map(|f| (f.place, f.rule)).collect()
}

/// Each of these is valid WGSL in the precision given, and wrong.
#[test]
fn the_lint_rejects_what_it_must() {
    use Precision::{F32, F64};
    use Rule::*;
    let mut rejected = vec![
        (F32, "fn f(x: real) -> bool {\n return x != x;\n}".to_owned(), SelfComparison, 2),
        (F64, "fn f(x: real) -> bool {\n return x != x;\n}".to_owned(), SelfComparison, 2),
        (F32, "fn f(x: real) -> bool {\n return x == x;\n}".to_owned(), SelfComparison, 2),
        (F32, "fn f(x: real) -> bool {\n var y = x;\n y *= 2.0;\n return y != y;\n}".to_owned(), SelfComparison, 4),
        (F64, "fn f(x: vec3<real>) -> bool {\n return x.y != x.y;\n}".to_owned(), SelfComparison, 2),
        (F32, "fn f(c: bool) -> real {\n return select(0.0, 1.0, c);\n}".to_owned(), LiteralSelect, 2),
        (F32, "fn f(x: real) -> real {\n return x * 2.0f;\n}".to_owned(), NamedPrecision, 2),
        (F32, "fn f(x: real) -> real {\n let y: f32 = 1.0;\n return x * y;\n}".to_owned(), NamedPrecision, 2),
        (F64, "fn f(x: real) -> real {\n return x * 2.0lf;\n}".to_owned(), NamedPrecision, 2),
        (F64, "fn f(x: f64) -> real {\n return x;\n}".to_owned(), NamedPrecision, 1),
        (F32, "fn f(x: vec3f) -> real {\n return x.x;\n}".to_owned(), NamedPrecision, 1),
        (F64, "fn f(x: real) -> real {\n let y = 2.0;\n return x;\n}".to_owned(), SinglePrecision, 2),
        (F64, "fn f(x: real) -> real {\n var y = 2.0;\n y += 1.0;\n return x;\n}".to_owned(), SinglePrecision, 2),
        (F64, "fn f(c: bool) -> real {\n return real(select(0.0, 1.0, c));\n}".to_owned(), LiteralSelect, 2),
        (F64, "fn f(x: real) -> real {\n return pow(x, x);\n}".to_owned(), DoublePrecisionFunction, 2),
        (F64, "fn f(x: vec3<real>) -> vec3<real> {\n return exp(x);\n}".to_owned(), DoublePrecisionFunction, 2),
    ];
    let transcendental = "cos cosh sin sinh tan tanh acos asin atan asinh acosh atanh exp exp2 log log2 radians degrees";
    for name in transcendental.split(' ') {
        rejected.push((F64, format!("fn f(x: real) -> real {{\n return {name}(x);\n}}"), DoublePrecisionFunction, 2));
    }
    for (precision, text, rule, line) in rejected {
        let found = rules(precision, text.clone().leak());
        assert!(found.contains(&(format!("snippet:{line}"), rule)), "{text} in {precision}: {found:?}");
    }
}

/// frexp needs 64-bit integers in naga's eyes, which no kernel asks for: refused before the lint
/// sees it.
#[test]
fn frexp_is_refused_in_f64() {
    let prelude = KERNELS[0].assemble(Precision::F64);
    let prelude: &'static str = prelude.text[..prelude.shared_start()].to_owned().leak();
    let snippet = ShaderSource { path: "snippet", text: "fn f(x: real) -> real {\n return frexp(x).fract;\n}" };
    assert!(lint::lint(&Assembled::new(Precision::F64, &[ShaderSource { path: "prelude", text: prelude }, snippet])).is_err());
}

#[test]
fn the_lint_accepts_what_it_may() {
    let text = "// an f32 in a comment\nfn f(x: real, c: bool) -> real {\n var y: real = 2.0;\n if c { y = 0.5; }\n \
                let k = select(1u, 2u, c);\n return select(x, y, c) + exp_(x) * real(k) + sqrt(x) + 0.5;\n}";
    for precision in Precision::ALL {
        assert_eq!(rules(precision, text), []);
    }
}

#[test]
fn the_spirv_is_valid() {
    let version = Command::new("spirv-val").arg("--version").output();
    if !version.is_ok_and(|v| v.status.success()) {
        writeln!(std::io::stderr(), "SKIPPED: spirv-val is not installed (apt-get install spirv-tools)").unwrap();
        assert!(std::env::var_os("ASPERITY_REQUIRE_GPU").is_none(), "ASPERITY_REQUIRE_GPU is set and spirv-val is missing");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    each_kernel(|kernel, precision, source| {
        let ValidSource { module, info } = validate(source).unwrap();
        let options = naga::back::spv::Options { lang_version: (1, 3), ..Default::default() };
        let words = naga::back::spv::write_vec(&module, &info, &options, None).unwrap();
        let path = folder.path().join(format!("{}_{precision}.spv", kernel.name));
        std::fs::write(&path, words.iter().flat_map(|w| w.to_le_bytes()).collect::<Vec<u8>>()).unwrap();
        let checked = Command::new("spirv-val").args(["--target-env", "vulkan1.1"]).arg(&path).output().unwrap();
        let message = String::from_utf8_lossy(&checked.stderr).into_owned();
        assert!(checked.status.success(), "{} in {precision}: {message}", kernel.name);
    });
}
