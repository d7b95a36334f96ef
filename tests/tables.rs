//! History and study table, opened by the programs that users open them with.

mod python;

use std::fs;
use std::path::Path;
use std::process::Command;

/// About a second.
const CASE: &str = r#"
[sphere]
radius = 1.0
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[material.hardening]
law = "ideal"
yield_stress = 400.0
[contact]
friction = 0.3
[mesh]
elements_per_contact_radius = 4
[solver]
press_steps = 4
error_estimate = false
[output]
fields = "none"
plots = false
parquet = true
[[path]]
indentation = 0.01
"#;

fn asperity(args: &[&str]) {
    assert_cmd::Command::cargo_bin("asperity").expect("the program").args(args).assert().code(0);
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

#[test]
fn pyarrow_reads_the_history_and_pandas_keeps_the_numbers_of_cases_as_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let (case, run) = (folder.path().join("case.toml"), folder.path().join("run"));
    fs::write(&case, CASE).expect("the case");
    asperity(&["run", text(&case), "--out", text(&run), "--device", "cpu", "--quiet"]);
    let bytes = fs::read(run.join("history.parquet")).expect("history.parquet");
    assert!(bytes.starts_with(b"PAR1") && bytes.ends_with(b"PAR1"));

    // Two cases of the list with each of two zipped pairs, without Parquet.
    let (file, study) = (folder.path().join("study.toml"), folder.path().join("study"));
    let base = CASE.replace("parquet = true\n", "").replace("[[path]]", "[[base.path]]");
    let base: String = base
        .lines()
        .map(|line| {
            if line.starts_with('[') && !line.starts_with("[[") { format!("[base.{}\n", &line[1..]) } else { format!("{line}\n") }
        })
        .collect();
    let sweep = "[zip]\n\"contact.friction\" = [0.1, 0.3]\n\"material.hardening.yield_stress\" = [400.0, 800.0]\n\
                 [[list]]\n\"path.0.indentation\" = 0.005\n[[list]]\n\"material.poissons_ratio\" = 0.25\n";
    fs::write(&file, base + sweep).expect("the study");
    asperity(&["study", text(&file), "--out", text(&study), "--device", "cpu", "--quiet", "--shard", "1/2"]);
    asperity(&["study", text(&file), "--out", text(&study), "--device", "cpu", "--quiet", "--resume"]);
    let table = fs::read_to_string(study.join("study.csv")).expect("study.csv");
    let head = "case,directory,status,reason,contact.friction,material.hardening.yield_stress,path.0.indentation,material.poissons_ratio,E,";
    assert!(table.starts_with(head), "{table}");
    assert!(table.contains("\nc0001,cases/c0001,done,,0.1,400.0,0.005,,"), "{table}");
    assert!(table.contains("\nc0004,cases/c0004,done,,0.3,800.0,,0.25,"), "{table}");
    assert!(!study.join("cases/c0001/history.parquet").exists());
    // The same study by other names: what changes no result is no other case.
    let labelled = fs::read_to_string(&file).expect("the study") + "[base.units]\nlength = \"mm\"\n";
    fs::write(&file, labelled).expect("the study");
    asperity(&["study", text(&file), "--out", text(&study), "--device", "cpu", "--quiet", "--resume"]);
    assert_eq!(fs::read_to_string(study.join("study.csv")).expect("study.csv"), table);

    let name = "pyarrow_reads_the_history_and_pandas_keeps_the_numbers_of_cases_as_text";
    let Some(python) = python::python(name, &["pandas", "pyarrow"]) else { return };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/check_tables.py");
    let output = Command::new(python).arg(script).args([&run, &study]).output().expect("Python");
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && said.contains("all tables equal"), "{said}");
}
