//! `asperity point` from outside.

use std::fs;
use std::path::PathBuf;

use assert_cmd::Command;
use tempfile::TempDir;

const MATERIAL: &str = "[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\nlaw = \"linear\"\nyield_stress = 400.0\nmodulus = 2000.0\n";

struct Run {
    code: i32,
    rows: Vec<Vec<f64>>,
    header: String,
    stderr: String,
}

fn folder() -> (TempDir, PathBuf) {
    let folder = TempDir::new().unwrap();
    let material = folder.path().join("material.toml");
    fs::write(&material, MATERIAL).unwrap();
    (folder, material)
}

fn point(material: &PathBuf, args: &[&str]) -> Run {
    let output = Command::cargo_bin("asperity").unwrap().arg("point").arg(material).args(args).output().unwrap();
    let stdout = String::from_utf8(output.stdout).unwrap();
    let mut lines = stdout.lines();
    let header = lines.next().unwrap_or_default().to_owned();
    let rows = lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    Run { code: output.status.code().unwrap(), rows, header, stderr: String::from_utf8(output.stderr).unwrap() }
}

#[test]
fn uniaxial_stress_is_in_the_units_of_the_file() {
    let (_folder, material) = folder();
    let run = point(&material, &["--mode", "uniaxial", "--strain", "0.05", "--steps", "200"]);
    assert_eq!(run.code, 0, "{}", run.stderr);
    assert!(run.header.starts_with("step,F11,F12,") && run.header.ends_with("von_mises,alpha,plastic_work,elastic_energy"));
    assert_eq!(run.rows.len(), 201);
    let columns = run.header.split(',').count();
    assert!(run.rows.iter().all(|row| row.len() == columns));
    let last = run.rows.last().unwrap();
    let (f11, f22, stress, lateral, alpha) = (last[1], last[5], last[10], last[11], last[17]);
    assert!((f11.ln() - 0.05).abs() < 1e-14 && lateral.abs() < 1e-9);
    // Kirchhoff stress on the flow curve.
    let kirchhoff = stress * f11 * f22 * f22;
    assert!((kirchhoff - (400.0 + 2000.0 * alpha)).abs() < 1e-9, "{kirchhoff}");
    // The plastic part of the logarithmic strain, but for a share of the order of the elastic
    // strain.
    assert!((alpha / (0.05 - kirchhoff / 200e3) - 1.0).abs() < 0.004, "{alpha}");
    // Plastic work: the area under the flow curve.
    assert!((last[18] - (400.0 + 1000.0 * alpha) * alpha).abs() < 1e-9);
    assert!((last[19] / (0.5 * kirchhoff * kirchhoff / 200e3) - 1.0).abs() < 5e-3, "{}", last[19]);
}

#[test]
fn compression_shear_and_settings_reach_the_point() {
    let (_folder, material) = folder();
    let run = point(&material, &["--strain", "-0.05", "--steps", "10", "--set", "material.hardening.yield_stress=300"]);
    assert_eq!((run.code, run.rows.len()), (0, 11), "{}", run.stderr);
    let last = run.rows.last().unwrap();
    let kirchhoff = last[10] * last[1] * last[5] * last[9];
    assert!((kirchhoff + 300.0 + 2000.0 * last[17]).abs() < 1e-9, "{kirchhoff}");
    let run = point(&material, &["--mode", "shear", "--strain", "0.3"]);
    assert_eq!((run.code, run.rows.len()), (0, 101), "{}", run.stderr);
    let last = run.rows.last().unwrap();
    assert!(last[2] == 0.3 && (last[16] - (400.0 + 2000.0 * last[17])).abs() < 1e-9);
}

#[test]
fn a_given_path_is_followed_and_a_bad_row_keeps_what_was_computed() {
    let (folder, material) = folder();
    let file = folder.path().join("path.csv");
    let path = file.to_str().unwrap();
    fs::write(&file, "F11,F12,F13,F21,F22,F23,F31,F32,F33\n# a comment\n1,0.01,0,0,1,0,0,0,1\n1, 0.02, 0, 0, 1, 0, 0, 0, 1\n")
        .unwrap();
    let run = point(&material, &["--path", path]);
    assert_eq!((run.code, run.rows.len()), (0, 3), "{}", run.stderr);
    assert_eq!(run.rows[2][2], 0.02);
    // The same by --mode shear.
    let shear = point(&material, &["--mode", "shear", "--strain", "0.02", "--steps", "2"]);
    assert_eq!(shear.rows, run.rows);

    fs::write(&file, "1,0.01,0,0,1,0,0,0,1\n-1,0,0,0,1,0,0,0,1\n").unwrap();
    let run = point(&material, &["--mode", "path", "--path", path]);
    assert_eq!((run.code, run.rows.len()), (3, 2));
    assert!(run.stderr.contains("step 2") && run.stderr.contains("det F = -1"), "{}", run.stderr);
}

#[test]
fn a_row_of_names_says_which_column_is_which() {
    let (folder, material) = folder();
    let file = folder.path().join("path.csv");
    let followed = |text: &str| {
        fs::write(&file, text).unwrap();
        let run = point(&material, &["--path", file.to_str().unwrap()]);
        assert_eq!(run.code, 0, "{}", run.stderr);
        run.rows
    };
    let in_order = followed("1.01,0.02,0,0,1,0,0,0,0.99\n");
    assert_eq!(followed("F33,F11,F12,F13,F21,F22,F23,F31,F32\n0.99,1.01,0.02,0,0,1,0,0,0\n"), in_order);
    assert_eq!(followed("F11,F12,F13,F21,F22,F23,F31,F32,F33\n1.01,0.02,0,0,1,0,0,0,0.99\n"), in_order);
}

/// A path is read whole, up to a limit: a device without an end takes neither all memory nor for
/// ever.
#[cfg(target_os = "linux")]
#[test]
fn a_path_without_an_end_is_refused() {
    let (_folder, material) = folder();
    let begun = std::time::Instant::now();
    let run = point(&material, &["--path", "/dev/zero"]);
    assert_eq!((run.code, run.rows.len()), (2, 0), "{}", run.stderr);
    assert!(run.stderr.contains("/dev/zero") && run.stderr.contains("more than 256 MiB"), "{}", run.stderr);
    assert!(begun.elapsed() < std::time::Duration::from_secs(20), "{:?}", begun.elapsed());
}

#[test]
fn bad_input_names_the_place_and_the_remedy() {
    let (folder, material) = folder();
    let file = folder.path().join("path.csv");
    let path = file.to_str().unwrap();
    let refused = |args: &[&str], words: &[&str]| {
        let run = point(&material, args);
        assert_eq!((run.code, run.rows.len()), (2, 0), "{args:?}: {}", run.stderr);
        assert!(words.iter().all(|word| run.stderr.contains(word)), "{args:?}: {}", run.stderr);
    };
    fs::write(&file, "1,0,0,0,1,0,0,0,1\n1,0,0,0,1,0,0,1\n").unwrap();
    refused(&["--path", path], &["path.csv", "line 2", "8 columns", "F11"]);
    fs::write(&file, "1,0,0,0,1,0,0,0,1\n1,0,0,0,x,0,0,0,1\n").unwrap();
    refused(&["--path", path], &["path.csv", "line 2", "column 5", "\"x\""]);
    fs::write(&file, "\n").unwrap();
    refused(&["--path", path], &["no rows"]);
    let row = "1,0,0,0,1,0,0,0,1\n";
    fs::write(&file, format!("F11,F12,F13,F21,F22,F23,F31,F32,G33\n{row}")).unwrap();
    refused(&["--path", path], &["path.csv", "line 1", "column 9 is called \"G33\"", "in any order"]);
    fs::write(&file, format!("F11,F12,F13,F21,F22,F23,F31,F11,F33\n{row}")).unwrap();
    refused(&["--path", path], &["path.csv", "line 1", "two columns are called F11"]);
    refused(&["--path", "nowhere.csv"], &["nowhere.csv", "cannot be read"]);
    refused(&["--mode", "path"], &["--path"]);
    refused(&["--mode", "shear", "--path", path], &["--path", "shear"]);
    refused(&["--path", path, "--steps", "3"], &["--steps"]);
    refused(&["--strain", "nan"], &["--strain"]);
    refused(&["--steps", "0"], &["--steps"]);
    refused(&["--set", "material.hardening.law=plastic"], &["law", "linear"]);
    refused(&["--set", "material.hardening.modulus=-1"], &["modulus"]);
    let output = Command::cargo_bin("asperity").unwrap().args(["point", "nowhere.toml"]).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8(output.stderr).unwrap().contains("nowhere.toml"));
}
