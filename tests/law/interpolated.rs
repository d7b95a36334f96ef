//! A law by interpolation from a study that follows a known law, and through the program.

use std::fs;

use asperity::case::Case;
use asperity::law::LawFile;
use asperity::law::interpolated::{Interpolated, fit};

use super::{asperity, presses, synthetic, text};

#[test]
fn a_known_law_is_interpolated() {
    let folder = tempfile::tempdir().expect("a folder");
    synthetic::write_study(folder.path(), 0.0);
    let study = text(folder.path());
    let printed = asperity(&["law", "fit", study, "--interpolate"]).code(0).get_output().stdout.clone();
    let printed = String::from_utf8(printed).expect("text");
    assert!(printed.contains("36 cases of 8 materials on a rigid plane") && printed.contains("1 left out"), "{printed}");
    let law = Interpolated::read(&folder.path().join("law.json")).expect("a law");
    assert_eq!(law, fit(folder.path(), None).expect("a law"), "not the same twice");
    // Whole materials left out of eight: most of them lie outside of the others.
    let all = law.errors.last().expect("a row for all").errors;
    assert!(all.cases == 36 && all.f_t_rms < 0.08 && law.normal_errors.f_n0[0] < 0.05, "{all:?} {:?}", law.normal_errors);

    // From as few as 36 cases.
    for (hardening, friction, h) in [(2, 0.15, 0.005), (2, 0.4, 0.02), (5, 0.2, 0.015), (6, 0.35, 0.006)] {
        let case = synthetic::case_text(&synthetic::hardenings()[hardening], friction, h);
        let file = folder.path().join("case.toml");
        fs::write(&file, &case).expect("a file");
        let case = Case::parse(&case, "case.toml", &[]).expect("a case");
        let (inputs, curve, _) = synthetic::truth(&case, friction, 2.0 * h);
        let peak = curve.iter().fold(0.0_f64, |peak, point| peak.max(point[1]));
        let answer = asperity(&["law", "predict", text(&folder.path().join("law.json")), text(&file)]).code(0);
        let answer = String::from_utf8(answer.get_output().stdout.clone()).expect("text");
        let rows: Vec<Vec<f64>> =
            answer.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
        let shear: Vec<&Vec<f64>> = rows.iter().filter(|row| row[0] == 1.0).collect();
        assert!(shear.len() > 20);
        for [d, f_t, f_n] in curve {
            let i = shear.partition_point(|row| row[2] < d).clamp(1, shear.len() - 1);
            let (before, after) = (shear[i - 1], shear[i]);
            let u = ((d - before[2]) / (after[2] - before[2])).clamp(0.0, 1.0);
            let [ours_n, ours_t] = [3, 4].map(|column| before[column] + u * (after[column] - before[column]));
            assert!((ours_t - f_t).abs() < 0.06 * peak, "{hardening} {friction} {h} at {d}: {ours_t} and {f_t}");
            assert!((ours_n - f_n).abs() < 0.06 * inputs.f_n, "{hardening} {friction} {h} at {d}: {ours_n} and {f_n}");
        }
    }
}

#[test]
fn oblique_presses_tell_how_a_contact_yields() {
    let folder = tempfile::tempdir().expect("a folder");
    let [study, presses] = ["study", "presses"].map(|name| folder.path().join(name));
    synthetic::write_study(&study, 0.0);
    presses::write_presses(&presses);
    let law = study.join("law.json");
    asperity(&["law", "fit", text(&study), "--interpolate"]).code(0);
    let printed = asperity(&["law", "fit", text(&presses), "--interpolate", "--add-to", text(&law)]).code(0);
    let printed = String::from_utf8(printed.get_output().stdout.clone()).expect("text");
    assert!(printed.contains("c of 48 oblique presses of 8 materials, 0 left out"), "{printed}");
    let [without, with] = [law, presses.join("law.json")].map(|path| Interpolated::read(&path).expect("a law"));
    assert_eq!(Interpolated { yielding: None, ..with.clone() }, without);
    for (hardening, friction, h) in [(2, 0.15, 0.04), (5, 0.3, 0.03), (6, 0.4, 0.045)] {
        let case = synthetic::case_text(&synthetic::hardenings()[hardening], friction, h);
        let table = with.table(&Case::parse(&case, "case.toml", &[]).expect("a case")).expect("a table");
        for level in table.levels.iter().filter(|level| level.h > 0.005) {
            let (c, exact) = (level.yield_coefficient.expect("c"), presses::yield_coefficient(friction, level.h));
            assert!((c / exact - 1.0).abs() < 0.1, "{hardening} {friction} at {}: {c} and {exact}", level.h);
        }
    }
    // A study without presses says so, and a law is not written over.
    let refused = asperity(&["law", "fit", text(&study), "--interpolate", "--add-to", text(&presses.join("law.json"))]).code(2);
    let refused = String::from_utf8(refused.get_output().stderr.clone()).expect("text");
    assert!(refused.contains("has 0 of them, of 0 materials, and needs 32 of 8"), "{refused}");
    let refused = asperity(&["law", "fit", text(&presses), "--interpolate", "--add-to", text(&presses.join("law.json"))]).code(2);
    let refused = String::from_utf8(refused.get_output().stderr.clone()).expect("text");
    assert!(refused.contains("law.json"), "{refused}");
}

/// The overlap of two spheres falls as they pass each other, and the update takes that for an
/// unloading: no reason to lose more than Hertz's contact does, but for the law's own error, 0.06 %
/// of F_N rms and 0.4 % at the worst over the elastic pairs that it is made from.
#[test]
fn two_spheres_that_do_not_yield_keep_their_force() {
    let law = LawFile::Interpolated(Box::new(Interpolated::built_in().expect("a law")));
    for (hardening, friction, h) in [
        ("law = \"elastic\"", 0.1, 0.0188),
        ("law = \"elastic\"", 0.3, 0.05),
        ("law = \"hollomon\", coefficient = 2.877e4, exponent = 2.84", 0.1, 0.005),
    ] {
        let text = format!(
            "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\nhardening = {{ {hardening} }}\n\
             [opponent]\nequal = true\n[contact]\nfriction = {friction}\n[[path]]\nindentation = {h}\n\
             [[path]]\nshear = \"full-slip\"\n"
        );
        let (points, _) = law.follow(&Case::parse(&text, "case.toml", &[]).expect("a case")).expect("a path");
        let pressed = points.iter().rfind(|point| point.segment == 0).expect("a press").f_n;
        assert!(points.iter().filter(|point| point.segment == 1).count() > 5);
        for point in points.iter().filter(|point| point.segment == 1) {
            let lost = 1.0 - point.f_n / pressed;
            let passed = 1.5 * point.delta_t.powi(2) / (4.0 * h);
            assert!(lost < 1.1 * passed + 5e-3, "{hardening}, mu = {friction}: {lost} and {passed} at {}", point.delta_t);
        }
    }
}

#[test]
fn it_is_used_with_a_case_and_refused_without() {
    let folder = tempfile::tempdir().expect("a folder");
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let law = root.join("fixtures/law/interpolated/plane.json");
    let case = root.join("fixtures/cases/voce.toml");
    let out = folder.path().join("table");
    // A table of its own, which is what is exported.
    asperity(&["law", "compose", text(&case), text(&law), "--out", text(&out)]).code(0);
    let table = out.join("law.json");
    assert!(matches!(LawFile::read(&table).expect("a law"), LawFile::Table(_)));
    let source = |law: &str| asperity(&["law", "export", law, text(&case), "--format", "c"]).code(0).get_output().stdout.clone();
    assert_eq!(source(text(&law)), source(text(&table)));
    asperity(&["law", "export", text(&law), text(&case), "--format", "python", "--out", text(&folder.path().join("module"))])
        .code(0);
    for (args, words) in [
        (vec!["law", "export", text(&law), "--format", "c"], "Give the case too"),
        (
            vec!["law", "predict", text(&law), text(&root.join("fixtures/cases/brinell.toml"))],
            "the law's study is of spheres on a rigid plane",
        ),
        (vec!["law", "predict", text(&law), text(&case), "--press"], "--press"),
        (
            vec!["law", "compose", text(&case), text(&law), text(&table), "--out", text(&folder.path().join("other"))],
            "leave OPPONENT.json out",
        ),
    ] {
        let refused = asperity(&args).code(2).get_output().stderr.clone();
        let refused = String::from_utf8(refused).expect("text");
        assert!(refused.contains(words), "{args:?}: {refused}");
    }
    // Two unlike bodies, from the materials alone.
    let unlike = root.join("fixtures/cases/unlike.toml");
    let out = folder.path().join("pair");
    asperity(&["law", "compose", text(&unlike), "built-in", "--out", text(&out)]).code(0);
    asperity(&["law", "predict", text(&out.join("law.json")), text(&unlike)]).code(0);
}
