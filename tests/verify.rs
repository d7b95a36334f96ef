//! `asperity verify`: every check passes, the table and the JSON say so, and so does the exit code.

use std::fs;
use std::process::Output;

use asperity::internals::verify::FAMILIES;
use assert_cmd::Command;
use serde_json::Value;

fn verify(arguments: &[&str]) -> Output {
    Command::new(assert_cmd::cargo::cargo_bin!("asperity")).arg("verify").args(arguments).output().expect("the program runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("text is UTF-8")
}

#[test]
fn every_check_passes_on_the_cpu() {
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let out = scratch.path().join("verify.json");
    let output = verify(&["--device", "cpu", "--out", &out.to_string_lossy()]);
    let table = text(&output.stdout);
    println!("{table}");
    let progress = text(&output.stderr);
    for family in FAMILIES {
        assert!(progress.contains(&format!("{}: ", family.name)), "{} in {progress}", family.name);
    }
    let json: Value = serde_json::from_str(&fs::read_to_string(&out).expect("the report")).expect("JSON");
    let rows = json["checks"].as_array().expect("rows");
    let verdicts = |wanted: &str| rows.iter().filter(|row| row["verdict"] == wanted).count();
    let failed: Vec<String> =
        rows.iter().filter(|row| row["verdict"] == "fail").map(|row| format!("{} {}", row["check"], row["what"])).collect();
    assert!(failed.is_empty(), "{failed:?}");
    assert_eq!(output.status.code(), Some(0));

    // The table says the same as the report.
    let lines: Vec<&str> = table.lines().collect();
    assert!(lines[0].starts_with("check ") && lines[0].ends_with("  verdict"));
    assert_eq!(lines.iter().filter(|line| line.ends_with("  pass")).count(), verdicts("pass"));
    assert_eq!(lines.iter().filter(|line| line.ends_with("  FAIL")).count(), 0);
    let last = lines.last().expect("a last line");
    assert!(
        last.starts_with(&format!("{} passed, 0 failed, {} for information", verdicts("pass"), verdicts("information"))),
        "{last}"
    );
    for check in [
        "hertz",
        "first yield",
        "cattaneo-mindlin",
        "mindlin-deresiewicz",
        "nu = 0.3",
        "spence",
        "olsson-larsson, jackson-green",
        "unloading",
        "plastic press",
        "pressure",
        "plastic shear",
        "energy",
        "jaeger-ciavarella",
        "rigid sphere",
        "symmetry",
        "units",
    ] {
        assert!(rows.iter().any(|row| row["check"] == check), "{check}");
    }
    // Nothing is judged without a reason.
    for row in rows {
        assert!(row["because"].as_str().is_some_and(|because| !because.is_empty()), "{row}");
        assert!(
            row["tolerance"].is_null()
                || row["error"].as_f64().is_some_and(|error| error.abs() <= row["tolerance"].as_f64().unwrap_or(0.0)),
            "{row}"
        );
    }
}

#[test]
fn one_family_quietly_with_reasons() {
    let output = verify(&["--device", "cpu", "--only", "invariance", "-q"]);
    assert_eq!((output.status.code(), text(&output.stderr).as_str()), (Some(0), ""));
    let table = text(&output.stdout);
    assert!(table.contains("symmetry") && table.contains("units") && !table.contains("hertz"), "{table}");
    assert!(!table.contains("mirror image"));
    let output = verify(&["--device", "cpu", "--only", "invariance", "-v"]);
    assert!(text(&output.stdout).contains("the mesh is its own mirror image"), "{}", text(&output.stdout));
    let output = verify(&["--device", "cpu", "--only", "invariance", "-q", "--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).expect("nothing but JSON");
    assert_eq!(json["checks"].as_array().map(Vec::len), Some(table.lines().count() - 3), "{json}");
}

#[test]
fn usage_errors_end_with_2() {
    for arguments in [&["--only", "no-such-family"][..], &["--fine=yes"], &["case.toml"]] {
        let output = verify(arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(!output.stderr.is_empty());
    }
}
