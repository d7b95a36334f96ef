//! `asperity bench`: complete, paired, finite, and the same rows in the table and in the file.

mod device;

use asperity::internals::compute::gpu::Precision;
use asperity::material::HardeningLaw;
use serde_json::Value;
use std::collections::BTreeMap;
use std::process::{Command, Output};

const LAWS: [&str; HardeningLaw::ALL.len()] = HardeningLaw::WORDS;
const EVALUATIONS: [&str; 4] = ["internal force", "tangent", "contact", "commit"];
/// Parts of the linear solver, in single precision on a device alone.
const PARTS: [&str; 5] = ["matrix", "Galerkin", "smoother", "product", "V-cycle"];
const BATCHES: [u64; 3] = [1, 4, 8];

fn bench(options: &[&str], environment: &[(&str, &str)]) -> Output {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.args(["bench", "--quick"]).args(options);
    command.env_remove("ASPERITY_ADAPTER").env_remove("ASPERITY_GPU_MEMORY").envs(environment.iter().copied());
    command.output().unwrap()
}

/// The table and the numbers.
fn measured(options: &[&str], environment: &[(&str, &str)]) -> (String, String, Value) {
    let dir = tempfile::tempdir().unwrap();
    let file = dir.path().join("bench.json");
    let output = bench(&[options, &["--out", file.to_str().unwrap()]].concat(), environment);
    let [table, said] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert_eq!(output.status.code(), Some(0), "{said}");
    (table, said, serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap())
}

fn text<'a>(value: &'a Value, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_else(|| panic!("{key} in {value}"))
}

fn number(value: &Value, key: &str) -> f64 {
    value[key].as_f64().unwrap_or_else(|| panic!("{key} in {value}"))
}

/// Every evaluation, law, precision and batch size in each of `places`, and nothing else; every
/// measured number finite and positive.
fn complete(report: &Value, places: &[&str]) -> usize {
    let mut found: BTreeMap<(String, String, String, u64), Vec<String>> = BTreeMap::new();
    let mut skipped = 0;
    for row in report["rows"].as_array().unwrap() {
        let key = [text(row, "evaluation"), text(row, "law"), text(row, "precision")].map(str::to_owned);
        let [evaluation, law, precision] = key;
        found.entry((evaluation, law, precision, row["batch"].as_u64().unwrap())).or_default().push(text(row, "on").to_owned());
        let measured = &row["outcome"]["measured"];
        let is_part = PARTS.contains(&text(row, "evaluation"));
        // A copy into another order has no operations.
        let computes = text(row, "evaluation") != "matrix";
        for count in ["items", "bytes", "operations"] {
            let unknown = is_part && measured.is_null() && count != "items";
            assert!(number(row, count) > 0.0 || unknown || count == "operations" && !computes, "{row}");
        }
        if measured.is_null() {
            assert!(!text(&row["outcome"], "skipped").is_empty() && text(row, "on") == "device", "{row}");
            skipped += 1;
            continue;
        }
        for key in [
            "first_ms",
            "median_ms",
            "min_ms",
            "max_ms",
            "repetitions",
            "items_per_s",
            "bytes_per_s",
            "operations_per_s",
            "share_of_copy",
        ] {
            let x = number(measured, key);
            assert!(x.is_finite() && (x > 0.0 || key == "operations_per_s" && !computes), "{key}: {row}");
        }
        let [min, median, max] = ["min_ms", "median_ms", "max_ms"].map(|key| number(measured, key));
        assert!(min <= median && median <= max && number(measured, "repetitions") >= 1.0, "{row}");
        assert_eq!(measured["kernels_ms"].is_number(), text(row, "on") == "device", "{row}");
        let rate = number(row, "items") / (1e-3 * median);
        assert!((number(measured, "items_per_s") / rate - 1.0).abs() < 1e-9, "{row}");
    }
    let laws = LAWS.map(|law| ("return mapping", law));
    let evaluations = EVALUATIONS.map(|evaluation| (evaluation, "power"));
    for (evaluation, law) in laws.into_iter().chain(evaluations) {
        for precision in ["f64", "f32"] {
            for batch in BATCHES {
                let key = (evaluation.to_owned(), law.to_owned(), precision.to_owned(), batch);
                assert_eq!(found.remove(&key).unwrap_or_default(), places, "{key:?}");
            }
        }
    }
    for part in PARTS.into_iter().filter(|_| places.contains(&"device")) {
        for batch in BATCHES {
            let key = (part.to_owned(), "power".to_owned(), "f32".to_owned(), batch);
            assert_eq!(found.remove(&key).unwrap_or_default(), ["device"], "{key:?}");
        }
    }
    assert!(found.is_empty(), "{found:?}");
    skipped
}

#[test]
fn device_and_cpu_stand_side_by_side() {
    let Some(context) = device::device("device_and_cpu_stand_side_by_side", Precision::F64) else { return };
    let (table, said, report) = measured(&["--device", "gpu", "--threads", "2"], &[]);
    assert_eq!(complete(&report, &["device", "one-core", "all-cores"]), 0, "{table}");
    let adapter = &report["adapter"];
    assert_eq!(text(adapter, "name"), context.adapter().name);
    for key in ["driver", "backend", "kind"] {
        assert!(!text(adapter, key).is_empty(), "{adapter}");
    }
    assert!(adapter["features"].as_array().unwrap().iter().any(|f| f == "f64") && number(adapter, "memory_budget_mib") > 0.0);
    assert_eq!((number(&report, "threads"), text(&report, "version")), (2.0, env!("CARGO_PKG_VERSION")));
    let date: Vec<usize> = text(&report, "date").split('-').map(|part| part.parse().unwrap()).collect();
    assert!(date.len() == 3 && date[0] >= 2026 && (1..=12).contains(&date[1]) && (1..=31).contains(&date[2]), "{date:?}");
    for rate in ["one_core", "all_cores", "device", "to_device", "from_device"] {
        assert!(number(&report["copy"], rate) > 0.0, "{rate}");
    }
    for precision in ["f64", "f32"] {
        for evaluation in ["return mapping", "all of an element"] {
            let of = |s: &&Value| text(s, "precision") == precision && text(s, "evaluation") == evaluation;
            assert!(report["setups"].as_array().unwrap().iter().filter(of).all(|s| number(s, "ms") > 0.0), "{precision}");
            assert!(report["setups"].as_array().unwrap().iter().any(|s| of(&s)), "{precision} {evaluation}");
        }
    }
    // the same in the table: a line each, and a software driver is called one
    assert_eq!(
        table.lines().filter(|line| line.starts_with('|')).count(),
        2 + ((7 + 4) * 2 + PARTS.len()) * BATCHES.len(),
        "{table}"
    );
    let software = adapter["software"].as_bool().unwrap();
    assert!(table.contains(&context.adapter().name) && table.contains("SOFTWARE DRIVER") == software, "{table}");
    assert!(said.contains("return mapping, linear, f64") && said.contains("batch of 8"), "{said}");
}

#[test]
fn what_does_not_fit_is_said_in_its_row() {
    if device::device("what_does_not_fit_is_said_in_its_row", Precision::F64).is_none() {
        return;
    }
    let (table, _, report) = measured(&["--device", "gpu", "--quiet"], &[("ASPERITY_GPU_MEMORY", "10")]);
    let skipped = complete(&report, &["device", "one-core", "all-cores"]);
    assert!(skipped > 0 && skipped < (2 * 11 + PARTS.len()) * BATCHES.len(), "{skipped}");
    let reasons: Vec<&str> = report["rows"].as_array().unwrap().iter().filter_map(|r| r["outcome"]["skipped"].as_str()).collect();
    assert!(reasons.iter().all(|reason| reason.contains("memory")), "{reasons:?}");
    assert!(table.contains("does not fit") && table.contains("Not measured:"), "{table}");
}

#[test]
#[cfg(target_os = "linux")]
fn without_a_driver_the_cpu_is_measured_and_that_is_said_loudly() {
    let nothing = [("VK_DRIVER_FILES", "/dev/null"), ("VK_ICD_FILENAMES", "/dev/null")];
    let (table, said, report) = measured(&[], &nothing);
    assert_eq!(complete(&report, &["one-core", "all-cores"]), 0);
    assert!(report["adapter"].is_null() && text(&report, "no_device").contains("NO GPU WAS MEASURED"));
    assert!(table.contains("NO GPU WAS MEASURED") && said.contains("NO GPU WAS MEASURED"), "{table}{said}");
    let output = bench(&["--device", "gpu"], &nothing);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.starts_with("error: --device gpu: no GPU found") && said.lines().count() == 1, "{said}");
}

#[test]
fn bad_input_is_one_message() {
    let dir = tempfile::tempdir().unwrap();
    std::fs::write(dir.path().join("in-the-way"), "").unwrap();
    let export = dir.path().join("in-the-way/bench.json");
    let bad: [([&str; 2], &str); 2] = [
        (["--elements", "1"], "--elements: elements_per_contact_radius = 1"),
        (["--out", export.to_str().unwrap()], "in-the-way"),
    ];
    for (options, part) in bad {
        let output = bench(&[&options[..], &["--device", "cpu", "--quiet"]].concat(), &[]);
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.starts_with("error: ") && said.contains(part) && said.lines().count() == 1, "{said}");
    }
}

/// Whole simulations: the CPU's rows, and the device's with what passed to it.
#[test]
fn whole_jobs_are_a_table_and_the_same_numbers() {
    let device = device::device("whole_jobs_are_a_table_and_the_same_numbers", Precision::F64).is_some();
    let place = if device { "gpu" } else { "cpu" };
    let (table, _, report) = measured(&["--whole-job", "--device", place, "--elements", "4", "--threads", "2"], &[]);
    let rows = report["jobs"].as_array().unwrap();
    assert_eq!(rows.len(), if device { 4 } else { 2 });
    assert_eq!(table.lines().take_while(|line| line.starts_with('|')).count(), rows.len() + 2);
    for (row, jobs) in rows.iter().zip([1, 2, 1, 2]) {
        assert!(row["batch"] == jobs && number(row, "wall_s") > 0.0 && number(row, "newton_iterations") > 30.0, "{row}");
        assert!(table.contains(&format!(" {} | ", row["unknowns"])) && table.contains(text(row, "device")), "{table}");
        assert_eq!(row["traffic"].is_null(), text(row, "device").starts_with("CPU"), "{row}");
    }
    if device {
        // One job is the same wherever it runs.
        let newton = [&rows[0], &rows[2]].map(|row| number(row, "newton_iterations"));
        assert!((newton[0] - newton[1]).abs() <= 0.05 * newton[0], "{newton:?}");
    }
    let profiles = report["kernels"].as_array().unwrap();
    assert_eq!(profiles.len(), if device { 2 } else { 0 });
    for (profile, jobs) in profiles.iter().zip([1, 2]) {
        assert!(profile["batch"] == jobs && number(profile, "copy_bytes_per_s") > 0.0, "{profile}");
        let kernels = profile["kernels"].as_array().unwrap();
        assert!(kernels.len() > 30 && kernels.iter().all(|kernel| number(kernel, "dispatches") > 0.0), "{profile}");
        if profile["kernels_s"].is_null() {
            assert!(table.contains("NO TIMES BY KERNEL"), "{table}");
            continue;
        }
        let seconds: Vec<f64> = kernels.iter().map(|kernel| number(kernel, "seconds")).collect();
        assert!(seconds.is_sorted_by(|a, b| a >= b) && seconds.iter().all(|s| *s > 0.0), "{seconds:?}");
        let (all, span, wall) = (number(profile, "kernels_s"), number(profile, "span_s"), number(profile, "wall_s"));
        assert!((all - seconds.iter().sum::<f64>()).abs() <= 1e-9 * all && all <= span && span <= wall, "{all} {span} {wall}");
        for kernel in kernels {
            let known = !kernel["bytes"].is_null();
            assert!(known != kernel["share_of_copy"].is_null() && known != kernel["bytes_per_s"].is_null(), "{kernel}");
            let names = [text(kernel, "kernel"), text(kernel, "precision")];
            let has = |line: &str| line.split(['|', ' ']).filter(|word| !word.is_empty()).take(2).eq(names);
            assert!(table.lines().any(has), "{names:?}\n{table}");
        }
    }
}
