//! The contact law from the outside: fitted to studies that follow a known law, and applied through
//! the program.

#[path = "law/interpolated.rs"]
mod interpolated;
#[path = "law/presses.rs"]
mod presses;
#[path = "law/synthetic.rs"]
mod synthetic;
#[path = "law/unseen.rs"]
mod unseen;

use std::fs;
use std::path::Path;

use asperity::case::Case;
use asperity::law::formulas::fit::fit;
use asperity::law::formulas::predict::{NormalSource, predict};
use asperity::law::formulas::prior::Prior;
use asperity::law::{Law, LawError};
use assert_cmd::Command;

fn asperity(args: &[&str]) -> assert_cmd::assert::Assert {
    Command::cargo_bin("asperity").expect("the program").args(args).assert()
}

fn text(path: &Path) -> &str {
    path.to_str().expect("a path in UTF-8")
}

/// Greatest differences to the synthetic truth over materials, friction and indentations that the
/// study does not have, as shares of the peak of F_T and of F_N0.
fn unseen(law: &Law) -> [f64; 2] {
    let hardenings = ["law = \"ideal\"\nyield_stress = 800.0", "law = \"hollomon\"\ncoefficient = 1200.0\nexponent = 6.0"];
    let mut greatest = [0.0_f64; 2];
    for (hardening, friction, h) in [(0, 0.15, 0.005), (0, 0.4, 0.02), (1, 0.2, 0.015), (1, 0.35, 0.006)] {
        let case = Case::parse(&synthetic::case_text(hardenings[hardening], friction, h), "unseen.toml", &[]).expect("a case");
        let (inputs, curve, _) = synthetic::truth(&case, friction, 2.0 * h);
        let prediction = predict(law, &case, NormalSource::Formulas).expect("a prediction");
        assert!(prediction.out_of_range.is_empty(), "{:?}", prediction.out_of_range);
        let peak = curve.iter().fold(0.0_f64, |peak, point| peak.max(point[1]));
        for [d, f_t, f_n] in curve {
            let (ours_t, ours_n) = law.forces(&prediction.parameters, friction, d);
            greatest[0] = greatest[0].max((ours_t - f_t).abs() / peak);
            greatest[1] = greatest[1].max((ours_n - f_n).abs() / inputs.f_n);
        }
    }
    greatest
}

#[test]
fn a_known_law_is_found_again() {
    let folder = tempfile::tempdir().expect("a folder");
    synthetic::write_study(folder.path(), 0.0);
    let law = fit(folder.path(), &Prior::Wear2014).expect("a law");
    let [f_t, f_n] = unseen(&law);
    assert!(f_t < 0.01 && f_n < 0.01, "{f_t} {f_n}\n{}", law.formulas());
    let all = &law.errors.last().expect("a row for all").errors;
    assert_eq!(all.cases, 36);
    assert!(all.f_t_rms < 0.005 && all.f_n_rms < 0.005, "{all:?}");
    // What is not used is told.
    assert_eq!(law.provenance.left_out, [("c0036".to_owned(), "failed".to_owned())]);
}

#[test]
fn noise_of_a_mesh_does_not_lead_astray() {
    let folder = tempfile::tempdir().expect("a folder");
    synthetic::write_study(folder.path(), 0.02);
    let law = fit(folder.path(), &Prior::Wear2014).expect("a law");
    let [f_t, f_n] = unseen(&law);
    assert!(f_t < 0.04 && f_n < 0.04, "{f_t} {f_n}\n{}", law.formulas());
    // The elastic baseline knows nothing of the fall of F_N.
    let score = |name: &str| {
        law.candidates.iter().filter(|c| c.name.starts_with(name)).map(|c| c.errors.score()).fold(f64::INFINITY, f64::min)
    };
    assert!(score("Jaeger-Ciavarella") > 5.0 * law.candidates[0].errors.score());
    assert!(law.candidates[0].kept && law.candidates.iter().filter(|c| c.kept).count() == 1);
    // The same study, the same bytes, at any number of threads; and the file reads back.
    let path = folder.path().join("law.json");
    law.write(&path).expect("law.json");
    assert!(Law::read(&path).expect("it reads back") == law, "law.json does not read back to the bit");
    let first = fs::read(&path).expect("bytes");
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
    pool.install(|| fit(folder.path(), &Prior::Wear2014)).expect("a law").write(&path).expect("law.json");
    assert!(fs::read(&path).expect("bytes") == first, "another number of threads gives another law");
}

#[test]
fn fit_and_predict_through_the_program() {
    let folder = tempfile::tempdir().expect("a folder");
    synthetic::write_study(folder.path(), 0.01);
    let short = asperity(&["law", "fit", text(folder.path())]).code(0);
    let short = String::from_utf8_lossy(&short.get_output().stdout).into_owned();
    assert!(
        short.lines().count() <= 24 && short.contains("F_N_slip/F_N0") && short.contains("predicted from h: F_T "),
        "{short}"
    );
    let fitted = asperity(&["law", "fit", "--verbose", text(folder.path())]).code(0);
    let printed = String::from_utf8_lossy(&fitted.get_output().stdout).into_owned();
    // Its histories have no limit of fine meshes, and both say so.
    let raw = "36 curves are those of their meshes";
    assert!(short.contains(raw) && printed.contains(raw), "{short}\n{printed}");
    for expected in ["36 cases of 8 materials", "Jaeger-Ciavarella", "the study alone", "F_N_slip/F_N0", "mu 0.2 to 0.4"] {
        assert!(printed.contains(expected), "{expected} is missing in\n{printed}");
    }
    let law = folder.path().join("law.json");
    let case = folder.path().join("case.toml");
    let ideal = "law = \"ideal\"\nyield_stress = 800.0";
    fs::write(&case, synthetic::case_text(ideal, 0.3, 0.01)).expect("case.toml");

    let within = asperity(&["law", "predict", text(&law), text(&case)]).code(0);
    assert!(within.get_output().stderr.is_empty(), "{}", String::from_utf8_lossy(&within.get_output().stderr));
    let csv = String::from_utf8_lossy(&within.get_output().stdout).into_owned();
    let rows: Vec<Vec<f64>> =
        csv.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
    assert!(csv.starts_with("segment,h,delta_T,F_N,F_T\n") && rows.len() > 100);
    assert_eq!(rows[0], [0.0; 5]);
    let last = rows.last().expect("rows");
    assert!((last[4] / (0.3 * last[3]) - 1.0).abs() < 1e-6, "full slip: {last:?}");
    let of = |segment: f64| rows.iter().filter(move |row| row[0] == segment).collect::<Vec<_>>();
    assert!(of(0.0).windows(2).all(|w| w[1][1] > w[0][1] && w[1][3] > w[0][3] && w[1][4] == 0.0));
    assert!(of(1.0).windows(2).all(|w| w[1][2] > w[0][2] && w[1][3] <= w[0][3] && w[1][1] == w[0][1]));

    // The rest of what a contact goes through.
    let path = "path=[{indentation=0.02},{shear=0.001,hold='normal-force'},{release=0.4},{indentation=0.022,shear=-0.001},{release=true}]";
    let whole = asperity(&["law", "predict", text(&law), text(&case), "--set", path]).code(0);
    let whole = String::from_utf8_lossy(&whole.get_output().stdout).into_owned();
    let rows: Vec<Vec<f64>> =
        whole.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect()).collect();
    let end = |segment: f64| rows.iter().rfind(|row| row[0] == segment).expect("a row").clone();
    assert!(rows.iter().filter(|row| row[0] == 1.0).all(|row| (row[3] / end(0.0)[3] - 1.0).abs() < 1e-9), "held");
    assert!((end(2.0)[3] / end(1.0)[3] - 0.4).abs() < 1e-9 && end(2.0)[2] == 0.001, "released: {:?}", end(2.0));
    assert_eq!((end(3.0)[1], end(3.0)[2]), (0.022, -0.001));
    assert!(end(3.0)[4] < 0.0 && end(4.0)[3] == 0.0, "{:?} {:?}", end(3.0), end(4.0));

    // In another direction.
    let aside = asperity(&["law", "predict", text(&law), text(&case), "--set", "path.1.shear=[6e-4, 8e-4]"]).code(0);
    let aside = String::from_utf8(aside.get_output().stdout.clone()).unwrap();
    let end: Vec<f64> = aside.lines().last().unwrap().split(',').map(|number| number.parse().unwrap()).collect();
    assert!(aside.starts_with("segment,h,delta_T,F_N,F_T,delta_T_y,F_T_y\n"), "{aside}");
    assert!((end[2], end[5]) == (6e-4, 8e-4) && (end[4] / end[6] - 0.75).abs() < 1e-3, "{end:?}");
    // The other way round, in the same units.
    let back = asperity(&["law", "predict", text(&law), text(&case), "--set", "path.1.shear=-1e-3"]).code(0);
    let back = String::from_utf8_lossy(&back.get_output().stdout).into_owned();
    let end = back.lines().last().expect("rows").to_owned();
    let cells: Vec<&str> = end.split(',').collect();
    assert!(cells[2] == "-0.001" && cells[4].starts_with('-'), "{end}");

    let outside = asperity(&["law", "predict", text(&law), text(&case), "--set", "contact.friction=0.9"]).code(0);
    let warning = String::from_utf8_lossy(&outside.get_output().stderr).into_owned();
    assert!(warning.contains("mu = 0.9") && warning.contains("outside"), "{warning}");

    // A material that hardens more than any of the study.
    let hard = synthetic::case_text("law = \"linear\"\nyield_stress = 200.0\nmodulus = 20000.0", 0.3, 0.01);
    fs::write(folder.path().join("hard.toml"), hard).expect("hard.toml");
    let hard = asperity(&["law", "predict", text(&law), text(&folder.path().join("hard.toml"))]).code(0);
    let warning = String::from_utf8_lossy(&hard.get_output().stderr).into_owned();
    assert!(warning.contains("hardening exponent"), "{warning}");

    what_no_law_predicts_is_refused(&law, &case);
}

fn what_no_law_predicts_is_refused(law: &Path, case: &Path) {
    for (set, told) in [
        ("contact.friction=\"stick\"", "stick"),
        // A simulated press gives F_N0 and a0 for one shear.
        ("path.1.hold=\"normal-force\"", "normal force"),
        ("path=[{indentation = 0.02}]", "no shear"),
        ("path=[{indentation = 0.02}, {shear = 0.001}, {shear = -0.001}]", "goes on after"),
        ("path=[{indentation = 0.02}, {indentation = 0.01}, {shear = 0.001}]", "more than once"),
    ] {
        let mut args = vec!["law", "predict", text(law), text(case), "--set", set];
        if told == "stick" {
            args.extend(["--set", "path.1.shear=0.01"]);
        } else {
            args.push("--press");
        }
        let refused = asperity(&args).code(2);
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.contains(told) && said.lines().count() == 1, "{set}: {said}");
    }
}

#[test]
fn the_press_gives_the_normal_data() {
    let folder = tempfile::tempdir().expect("a folder");
    synthetic::write_study(folder.path(), 0.0);
    let law = fit(folder.path(), &Prior::Wear2014).expect("a law");
    let text = synthetic::case_text("law = \"ideal\"\nyield_stress = 400.0", 0.3, 0.02);
    let case = Case::parse(&text, "case.toml", &["mesh.elements_per_contact_radius=6".to_owned()]).expect("a case");
    let inputs = predict(&law, &case, NormalSource::Press).expect("a prediction").inputs;
    // Axisymmetric computations of this case with R = 1: F_N = 148.8 and a = 0.2087.
    assert!((inputs.f_n / (4.0 * 148.8) - 1.0).abs() < 0.02 && (inputs.a / (2.0 * 0.2087) - 1.0).abs() < 0.05, "{inputs:?}");
}

/// Formulas are of a plane; what they send two spheres to takes them.
#[test]
fn formulas_send_two_spheres_to_the_built_in_law() {
    let folder = tempfile::tempdir().expect("a folder");
    let case = folder.path().join("case.toml");
    let pair = synthetic::case_text("law = \"ideal\"\nyield_stress = 400.0", 0.3, 0.01) + "[opponent]\nequal = true\n";
    fs::write(&case, pair).expect("case.toml");
    let formulas = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law/law.json");
    for press in [&[][..], &["--press"]] {
        let refused = asperity(&[&["law", "predict", text(&formulas), text(&case)], press].concat()).code(2);
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.contains("[opponent]") && said.contains("a law of formulas is of a sphere on a rigid plane"), "{said}");
        assert!(said.contains("`built-in`") && said.contains("`asperity law tabulate`"), "{said}");
    }
    let predicted = asperity(&["law", "predict", "built-in", text(&case)]).code(0);
    assert!(String::from_utf8_lossy(&predicted.get_output().stdout).lines().count() > 100);
}

/// Random paths are those of their seed, and the exit code tells whether the goal is met.
#[test]
fn random_paths_are_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/paths/ideal-3200-mu-0.1.json");
    let checked = |seed: &str, to: &str| {
        let out = folder.path().join(to);
        let args = ["law", "check", text(&table), "--random", "2", "--seed", seed, "--elements", "4", "--out", text(&out), "-q"];
        let run = asperity(&args);
        let output = run.get_output();
        let said = String::from_utf8_lossy(&output.stdout).into_owned();
        let met = said.contains("not counted: met.");
        assert_eq!(output.status.code(), Some(i32::from(!met)), "{said}");
        assert!(met || said.contains("not counted: missed."), "{said}");
        assert!(
            said.contains(&format!("random paths: 2, seed {seed}")) && said.contains("reversals of falling amplitude"),
            "{said}"
        );
        assert_eq!(fs::read_dir(&out).expect("curves").count(), 2);
        said
    };
    let said = checked("5", "one");
    assert_eq!(said, checked("5", "two"));
    assert_ne!(said, checked("6", "three"));
    asperity(&["law", "check", text(&table), "--seed", "1"]).code(2);
}

/// Where the direction turns, F_T along y is compared too.
#[test]
fn paths_in_turning_directions_are_checked() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/paths/ideal-3200-mu-0.1.json");
    let out = folder.path().join("curves");
    let args = ["law", "check", text(&table), "--turning", "--elements", "4", "--out", text(&out), "-q"];
    let said = String::from_utf8_lossy(&asperity(&args).code(0).get_output().stdout).into_owned();
    assert!(said.contains("figure of eight") && said.contains("flip by 90 degrees"), "{said}");
    assert!(said.contains("4 of 4 paths within") && !said.contains("unknown"), "{said}");
    // A twist takes a good part of what friction can bear.
    assert!(said.contains("4 that twist or roll not counted"), "{said}");
    let twisted = said.lines().find(|line| line.starts_with("shear, then twist")).expect("a twist");
    let judged = twisted.split_once("M_twist ").and_then(|(_, rest)| rest.split(',').next()).expect("a moment");
    let number =
        |text: Option<&str>| text.and_then(|text| text.trim().parse::<f64>().ok()).unwrap_or_else(|| panic!("{twisted}"));
    let (rms, most) = (number(judged.split(' ').next()), number(judged.split(" of ").nth(1)));
    assert!((0.3..0.7).contains(&most) && rms > 0.0 && rms < 5.0, "{twisted}");
    assert_eq!(fs::read_dir(&out).expect("curves").count(), 8);
    let curve = fs::read_to_string(out.join("the-table-s-material-mu-0.1-shear-then-twist.csv")).expect("a curve");
    assert!(curve.lines().next().is_some_and(|head| {
        head.ends_with(",twist,roll_x,roll_y,M_twist,M_roll_x,M_roll_y,law_M_twist,law_M_roll_x,law_M_roll_y")
    }));
    let circle = out.join("the-table-s-material-mu-0.1-circle-90-of-slip.csv");
    let mut reader = csv::Reader::from_path(&circle).expect("a circle");
    let columns = reader.headers().expect("columns").clone();
    let column = |name: &str| columns.iter().position(|column| column == name).expect("a column");
    let (simulated, law) = (column("F_T_y"), column("law_F_T_y"));
    let (mut largest, mut apart) = (0.0f64, 0.0f64);
    for row in reader.records() {
        let row = row.expect("a row");
        let [simulated, law] = [simulated, law].map(|i| row[i].parse::<f64>().expect("a number"));
        largest = largest.max(simulated.abs());
        apart = apart.max((simulated - law).abs());
    }
    assert!(largest > 0.0 && apart > 0.0 && apart < 0.12 * largest, "{apart} of {largest}");
    asperity(&["law", "check", text(&table), "--turning", "--random", "2"]).code(2);
    let smooth =
        asperity(&["law", "check", "built-in", "fixtures/cases/ideal.toml", "--set", "contact.friction=0.0", "--turning"])
            .code(2);
    assert!(String::from_utf8_lossy(&smooth.get_output().stderr).contains("without friction no direction matters"));
}

#[test]
fn what_is_no_study_and_no_law_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let refuse = |args: &[&str], told: &str| {
        let refused = asperity(args).code(2);
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.starts_with("error: ") && said.contains(told) && said.lines().count() == 1, "{told}: {said}");
    };
    refuse(&["law", "fit", text(&folder.path().join("nowhere"))], "is not a study");
    fs::write(folder.path().join("study.csv"), "case,status\nc0000,done\n").expect("study.csv");
    refuse(&["law", "fit", text(folder.path())], "no column directory");
    fs::write(folder.path().join("study.csv"), "case,directory,status\nc0000,cases/c0000,failed\n").expect("study.csv");
    refuse(&["law", "fit", text(folder.path())], "0 usable cases of 0 materials");
    assert!(matches!(fit(folder.path(), &Prior::Wear2014), Err(LawError::TooFewCases { needed_cases: 8, .. })));
    fs::write(folder.path().join("study.csv"), "case,directory,status\nc0000,cases/c0000,done\n").expect("study.csv");
    refuse(&["law", "fit", text(folder.path())], "case.toml");

    let case = folder.path().join("case.toml");
    fs::write(&case, synthetic::case_text("law = \"ideal\"\nyield_stress = 400.0", 0.3, 0.02)).expect("case.toml");
    let law = folder.path().join("law.json");
    refuse(&["law", "predict", text(&law), text(&case)], "cannot be read");
    for (content, told) in [
        ("{", "is not a law"),
        ("{\"format\": \"other\", \"version\": 1}", "its format is \"other\""),
        ("{\"format\": \"asperity-law\", \"version\": 7}", "version 7"),
        ("{\"format\": \"asperity-law\", \"version\": 2}", "constants is missing"),
    ] {
        fs::write(&law, content).expect("law.json");
        refuse(&["law", "predict", text(&law), text(&case)], told);
    }
}

/// What a number of a law file may be is known before anything is computed from it.
#[test]
fn a_law_file_with_a_number_that_no_law_has_is_refused_by_its_key() {
    let folder = tempfile::tempdir().expect("a scratch directory");
    let (law, case) = (folder.path().join("law.json"), folder.path().join("case.toml"));
    fs::write(&case, synthetic::case_text("law = \"ideal\"\nyield_stress = 400.0", 0.3, 0.02)).expect("case.toml");
    let read = |name: &str| -> serde_json::Value {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law").join(name)).expect("a law");
        serde_json::from_str(&text).expect("JSON")
    };
    let [table, plane, formulas] = ["pairs/steel.json", "interpolated/plane.json", "law.json"].map(read);
    let refused = |changed: &serde_json::Value| {
        fs::write(&law, changed.to_string()).expect("law.json");
        let output = asperity(&["law", "predict", text(&law), text(&case)]).code(2).get_output().clone();
        let message = String::from_utf8(output.stderr).expect("text");
        assert!(message.contains("law.json: ") && message.contains("Restore the file, or make it anew"), "{message}");
        assert!(!message.contains("panicked") && !message.contains("expected"), "{message}");
        message
    };
    for (good, place, value, told) in [
        (&table, "/range/to", 1e-6.into(), "range.from is 2.1599911290901404e-5, and has to be 1e-6, which is range.to, or less"),
        (&table, "/range/from", 0.0.into(), "range.from is 0.0"),
        (&table, "/range/to", 0.5.into(), "range has to lie within its levels"),
        (&table, "/levels/2/normal/3", 1e308.into(), "levels[2].normal[3] is 1e308, and has to be a number from -0.1 to 1.1"),
        (&table, "/levels/2/h", 1e-6.into(), "levels[2].h is 1e-6, and has to be more than that of the level before"),
        (&table, "/levels/4/F_N0", (-1.0).into(), "levels[4].F_N0 is -1.0"),
        (&table, "/levels/1/tangential", serde_json::json!([1.0, 2.0]), "levels[1].tangential has 2 numbers, and has to have 24"),
        (&table, "/elements_per_contact_radius", 1000.into(), "elements_per_contact_radius"),
        (&plane, "/samples/0/0", 1e308.into(), "samples[0][0] is 1e308, and has to be a number from -1000.0 to 1000.0"),
        (&plane, "/inputs/1/range/to", (-1e3).into(), "inputs[1].range.from is 0.0"),
        (&plane, "/processes/3/lengths/2", 0.0.into(), "processes[3].lengths[2] is 0.0"),
        (&plane, "/ratio/mean/5", 1e20.into(), "ratio.mean[5] is 1e20"),
        (&plane, "/inputs/1/name", "nu".into(), "inputs[1].name is \"nu\", and has to be \"hardening to 0\""),
        (&formulas, "/constants/fall/2", 1e308.into(), "constants.fall[2] is 1e308"),
        (&formulas, "/validity/poissons_ratio/from", (-1.5).into(), "validity.poissons_ratio.from is -1.5"),
        (&formulas, "/validity/lambda/to", (-1.0).into(), "validity.lambda.to is -1.0"),
        (&formulas, "/normal/force", serde_json::json!([1.0]), "normal.force"),
        (&formulas, "/normal/radius/1", 0.0.into(), "normal.radius[1] is 0.0"),
        (&formulas, "/constants/slip/1", "x".into(), "constants.slip[1] is \"x\", and has to be a number"),
    ] {
        let mut changed = good.clone();
        *changed.pointer_mut(place).expect(place) = value;
        let message = refused(&changed);
        assert!(message.contains(told), "{told}: {message}");
    }
    for (word, told) in [
        ("lambda", "earlier versions had: forms.variable is \"lambda\", and this version has \"area\""),
        ("x", "forms is no key of this file"),
    ] {
        let mut named = formulas.clone();
        named["forms"] = serde_json::json!({ "variable": word });
        let message = refused(&named);
        assert!(message.contains(told), "{told}: {message}");
    }
    for (content, told) in [
        (serde_json::json!([1]), "line 1: is not a law file: [0] is 1, and has to be a text"),
        (serde_json::json!({}), "line 1: is not a law file: format is missing"),
        (serde_json::json!({ "format": "asperity-law-table", "version": 1, "body": "cube" }), "body is \"cube\", and has to be"),
    ] {
        let message = refused(&content);
        assert!(message.contains(told), "{told}: {message}");
    }
}
