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

/// The columns of a table that hold words or nothing, whole numbers alone, and all others.
fn kinds(table: &Path) -> [Vec<String>; 2] {
    let mut reader = csv::Reader::from_path(table).expect("a table");
    let names: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    let rows: Vec<csv::StringRecord> = reader.records().map(|row| row.expect("a row")).collect();
    assert!(!rows.is_empty(), "{}", table.display());
    let [mut whole, mut decimal] = [Vec::new(), Vec::new()];
    for (column, name) in names.into_iter().enumerate() {
        let cells = || rows.iter().map(|row| &row[column]).filter(|cell| !cell.is_empty());
        if cells().count() == 0 || cells().any(|cell| cell.parse::<f64>().is_err()) {
            continue;
        }
        match cells().filter(|cell| cell.parse::<i64>().is_ok()).count() {
            0 => decimal.push(name),
            all if all == cells().count() => whole.push(name),
            _ => panic!("{}: {name} has whole numbers and others", table.display()),
        }
    }
    [whole, decimal]
}

/// A study in Pa and m whose file has whole numbers: their squares are beyond 64 bits.
#[test]
fn numbers_that_are_no_counts_have_a_point_in_every_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let (file, study) = (folder.path().join("study.toml"), folder.path().join("study"));
    let base = CASE
        .replace("parquet = true\n", "")
        .replace("200e3", "200e9")
        .replace("yield_stress = 400.0", "yield_stress = 400000000");
    let base = base.replace("fields = \"none\"\n", "").replace("radius = 1.0", "radius = 1").replace("[[path]]", "[[base.path]]");
    let base = base.replace("\n[", "\n[base.").replace("[base.[base.", "[[base.");
    let grid = "[grid]\n\"material.youngs_modulus\" = [200000000000, 70000000000]\n\"contact.friction\" = [1, \"stick\"]\n\
                \"mesh.elements_per_contact_radius\" = [4]\n";
    let shear = "[[base.path]]\nshear = 0.0001\n";
    fs::write(&file, base + shear + grid).expect("the study");
    asperity(&["study", text(&file), "--out", text(&study), "--device", "cpu", "--quiet"]);
    let table = fs::read_to_string(study.join("study.csv")).expect("study.csv");
    assert!(
        table.contains("\nc0001,cases/c0001,done,,200000000000.0,1.0,4,200000000000.0,0.3,400000000.0,1.0,1.0,0.01,"),
        "{table}"
    );
    assert!(table.contains("\nc0004,cases/c0004,done,,70000000000.0,stick,4,70000000000.0,"), "{table}");
    let [whole, decimal] = kinds(&study.join("study.csv"));
    assert_eq!(
        whole,
        [
            "mesh.elements_per_contact_radius",
            "elements_per_contact_radius",
            "surface_elements_per_contact_radius",
            "newton_iterations",
            "cutbacks"
        ]
    );
    for name in ["material.youngs_modulus", "E", "sigma_Y", "mu", "R", "h0", "F_N0", "sigma_rep", "cpu_s"] {
        assert!(decimal.iter().any(|column| column == name), "{name} in {decimal:?}");
    }
    let run = study.join("cases/c0001");
    let [whole, _] = kinds(&run.join("history.csv"));
    let counts = [
        "step",
        "segment",
        "newton_iterations",
        "cutbacks",
        "krylov_iterations",
        "contact_points",
        "slipping_points",
        "relaxed",
        "landed_again",
    ];
    assert!(whole.iter().all(|name| counts.contains(&name.as_str())), "{whole:?}");
    let contact = fs::read_dir(run.join("contact")).expect("contact tables").map(|entry| entry.expect("an entry").path());
    let contact: Vec<_> = contact.collect();
    assert_eq!(contact.len(), 2);
    contact.iter().for_each(|table| assert_eq!(kinds(table)[0], ["point"]));

    // What the program prints as a table.
    let case = folder.path().join("case.toml");
    fs::write(&case, CASE.replace("200e3", "200000000000").replace("400.0", "400000000")).expect("the case");
    for arguments in [vec!["point", text(&case)], vec!["law", "predict", "built-in", text(&case)]] {
        let output = assert_cmd::Command::cargo_bin("asperity").expect("the program").args(&arguments).output().expect("a table");
        let printed = folder.path().join("printed.csv");
        fs::write(&printed, output.stdout).expect("a file");
        let [whole, _] = kinds(&printed);
        assert!(whole.iter().all(|name| ["step", "segment"].contains(&name.as_str())), "{arguments:?}: {whole:?}");
    }

    // What was written is read again: nothing is left to do, and the table stays.
    asperity(&["study", text(&file), "--out", text(&study), "--device", "cpu", "--quiet", "--resume"]);
    assert_eq!(fs::read_to_string(study.join("study.csv")).expect("study.csv"), table);
    // A table of before, with whole numbers, is of this study too.
    fs::write(study.join("study.csv"), table.replace(".0,", ",")).expect("study.csv");
    asperity(&["study", text(&file), "--out", text(&study), "--device", "cpu", "--quiet", "--resume"]);
    assert_eq!(fs::read_to_string(study.join("study.csv")).expect("study.csv"), table);

    pandas_squares_them(&[&study.join("study.csv"), &run.join("history.csv"), &contact[0]]);
}

/// Where there is pandas: it reads them as decimals.
fn pandas_squares_them(tables: &[&Path]) {
    let name = "numbers_that_are_no_counts_have_a_point_in_every_table";
    let Some(python) = python::python(name, &["pandas"]) else { return };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/check_numbers.py");
    let output = Command::new(python).arg(script).args(tables).output().expect("Python");
    let said = format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success() && said.contains("no square overflows"), "{said}");
}

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
    // The base says "none".
    assert!(study.join("cases/c0001/history.csv").exists() && !study.join("cases/c0001/contact").exists());
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
