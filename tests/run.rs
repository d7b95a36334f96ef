//! `asperity run` on coarse meshes: what it writes, what it computes, and how it ends.

mod common;
#[path = "run/endings.rs"]
mod endings;
mod python;

use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::output::{OutputDirectory, RunStatus, StepRecord, Summary, TimeByPhase, read_contact, read_history};
use common::{Scratch, program, stderr, stdout};

/// Pressed and sheared, ideally plastic; everything below varies it by `--set`.
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
press_steps = 5
[[path]]
indentation = 0.02
"#;
const SHEAR: &str = "[[path]]\nshear = 0.002\n";
const FULL_SLIP: &str = "[[path]]\nshear = \"full-slip\"\n";

/// Whatever devices the machine has: what is tested here is the reference.
const CPU: [&str; 2] = ["--device", "cpu"];

/// The case with these segments after its press.
fn scratch(segments: &str) -> Scratch {
    Scratch::new(&format!("{CASE}{segments}"), &CPU)
}

/// Runs to the end and reads the results back.
fn done(scratch: &Scratch, name: &str, options: &[&str]) -> (Vec<StepRecord>, Summary) {
    let output = scratch.run(name, options);
    assert_eq!(output.status.code(), Some(0), "{options:?}: {}", stderr(&output));
    let (history, summary) = results(&scratch.path(name));
    assert_eq!(summary.status, RunStatus::Done);
    (history, summary)
}

fn results(dir: &Path) -> (Vec<StepRecord>, Summary) {
    let out = OutputDirectory::existing(dir);
    (read_history(&out.history()).expect("a history"), Summary::read(&out.summary()).expect("a summary"))
}

fn names(dir: &Path) -> Vec<String> {
    let entries = fs::read_dir(dir).unwrap_or_else(|error| panic!("{}: {error}", dir.display()));
    let mut names: Vec<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Every number of a row with its column, in the order of the file.
fn numbers(row: &StepRecord) -> Vec<(String, f64)> {
    let serde_json::Value::Object(map) = serde_json::to_value(row).expect("a row") else { unreachable!("a struct is an object") };
    map.into_iter().filter_map(|(name, value)| Some((name, value.as_f64()?))).collect()
}

/// The summary without what may differ between two runs of one case: times.
fn timeless(summary: &Summary) -> Summary {
    Summary { wall_s: 0.0, cpu_s: None, time_by_phase: TimeByPhase::default(), ..summary.clone() }
}

/// Files of steps: the ends of the segments, and where the ratio of forces passes shares of mu.
fn tables_and_pictures_are_of_the_path(dir: &Path, history: &[StepRecord], press: usize) {
    let ends = [press, history.len()].map(|step| format!("step_{step:04}"));
    // The contact at the ends of the segments and, for the picture of stick and slip, at four
    // shares of mu on the way.
    let ratio = |row: &StepRecord| row.f_t / (0.3 * row.f_n);
    let passed =
        |i: usize| [0.3, 0.6, 0.8, 0.95].iter().any(|&share| ratio(&history[i - 1]) < share && ratio(&history[i]) >= share);
    let mut tables: Vec<usize> = (press..history.len()).filter(|&i| passed(i)).map(|i| history[i].step).collect();
    assert!((3..=4).contains(&tables.len()), "{tables:?}");
    tables.extend([press, history.len()]);
    tables.sort_unstable();
    tables.dedup();
    let tables: Vec<String> = tables.into_iter().map(|step| format!("step_{step:04}.csv")).collect();
    assert_eq!(names(&dir.join("contact")), tables);
    let slip = fs::read_to_string(dir.join("plots/slip.svg")).expect("a picture");
    assert_eq!(slip.matches(">δ</tspan>").count(), tables.len() - 1, "a panel for each table of the shear");
    assert_eq!(names(&dir.join("fields")), ["case.pvd".to_owned(), ends[0].clone() + ".vtu", ends[1].clone() + ".vtu"]);
    assert_eq!(
        names(&dir.join("plots")),
        ["contact.svg", "forces.svg", "indentation.svg", "pressure.svg", "ratio.svg", "slip.svg", "stick.svg"]
    );
}

/// The history ends where the path does, and the summary tells of it.
fn numbers_are_those_of_the_case(dir: &Path, history: &[StepRecord], summary: &Summary, press: usize) {
    // Pressed to where it was told, then sheared to full slip at constant indentation.
    assert_eq!(history[press - 1].h, 0.02);
    assert!(history[press - 1..].iter().all(|row| row.h == 0.02));
    let last = history[history.len() - 1];
    assert!((last.f_t / last.f_n - 0.3).abs() < 1e-3, "{last:?}");
    assert_eq!(last.stick_radius, 0.0);
    // On this mesh the forces are within some per cent of the converged ones, 148.8 and 30 to 31.6.
    assert!((summary.f_n0.expect("F_N0") / 148.8 - 1.0).abs() < 0.1, "{summary:?}");
    assert!((summary.f_t_max.expect("F_T_max") / 30.8 - 1.0).abs() < 0.05, "{summary:?}");
    assert!(summary.full_slip_reached && summary.delta_t_slip.is_some() && summary.k_t0.is_some());
    assert_eq!(summary.steps, history.len());
    assert_eq!(summary.newton_iterations, history.iter().map(|row| row.newton_iterations).sum::<usize>());
    assert!(summary.elements > 400 && summary.unknowns > 1000 && summary.krylov_iterations > 0);
    assert!(summary.wall_s > 0.0 && summary.device.starts_with("CPU"));
    // Every second is one of some phase; the elements take time and so do the files.
    let phases = summary.time_by_phase;
    assert!((phases.rows().iter().map(|(_, time)| time.seconds).sum::<f64>() / summary.wall_s - 1.0).abs() < 1e-9, "{phases:?}");
    assert!(phases.rows().iter().all(|(_, time)| time.seconds > 0.0) && phases.other.share < 0.5, "{phases:?}");
    assert_eq!((summary.precision.as_str(), summary.messages.len()), ("f64", 0));
    let json: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(dir.join("summary.json")).expect("text")).expect("JSON");
    assert_eq!(json["status"], "done");
    for key in ["F_N0", "a0", "h0", "F_N_slip", "F_T_max", "delta_T_slip", "k_T0", "elements", "unknowns", "newton_iterations"] {
        assert!(json[key].is_number(), "{key}: {}", json[key]);
    }
}

fn contact_and_fields_are_of_their_steps(dir: &Path, history: &[StepRecord], press: usize) {
    let (ends, last) = ([press, history.len()].map(|step| format!("step_{step:04}")), history[history.len() - 1]);
    // The contact table adds up to the forces of its step, over both halves.
    let points = read_contact(&dir.join("contact").join(ends[1].clone() + ".csv")).expect("a contact table");
    let sum = |of: fn(&asperity::output::ContactPoint) -> f64| points.iter().map(|point| of(point) * point.area).sum::<f64>();
    assert!((sum(|point| point.pressure) / last.f_n - 1.0).abs() < 1e-12);
    assert!((sum(|point| -point.traction_x) / last.f_t - 1.0).abs() < 1e-12);
    assert!((sum(|point| point.traction_y) / last.f_t).abs() < 1e-12);

    // The time of the fields is how far the sphere has been moved.
    let collection = fs::read_to_string(dir.join("fields/case.pvd")).expect("a collection");
    let times: Vec<f64> = collection
        .split("timestep=\"")
        .skip(1)
        .map(|rest| rest.split('"').next().expect("an end").parse().expect("a number"))
        .collect();
    assert!(times.len() == 2 && (times[0] - 0.02).abs() < 1e-12 && (times[1] - 0.02 - last.delta_t).abs() < 1e-12, "{times:?}");
}

#[test]
fn leaves_every_file_of_the_contract() {
    let scratch = scratch(FULL_SLIP);
    let output = scratch.run("out", &[]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let dir = scratch.path("out");
    let all = ["case.toml", "checkpoint.bin", "contact", "fields", "history.csv", "plots", "run.log", "summary.json"];
    assert_eq!(names(&dir), all);

    let text = fs::read_to_string(dir.join("history.csv")).expect("a history");
    assert!(text.starts_with("step,segment,h,delta_T,F_N,F_T,a,stick_radius,newton_iterations,cutbacks,"), "{text}");
    let (history, summary) = results(&dir);
    let steps: Vec<usize> = history.iter().map(|row| row.step).collect();
    assert_eq!(steps, (1..=history.len()).collect::<Vec<_>>());
    let press = history.iter().filter(|row| row.segment == 0).count();
    tables_and_pictures_are_of_the_path(&dir, &history, press);
    numbers_are_those_of_the_case(&dir, &history, &summary, press);
    contact_and_fields_are_of_their_steps(&dir, &history, press);

    // A person is told in three lines what came out, how well, and where it is.
    let told = stdout(&output);
    assert_eq!(told.lines().count(), 3, "{told}");
    for word in
        ["F_N0 ", "a0 ", "F_N_slip ", "F_T_max ", "\nerrors: ", "\ndone in ", &format!("; results in {}\n", dir.display())]
    {
        assert!(told.contains(word), "{word}: {told}");
    }
    // Not a terminal: plain lines.
    assert!(stderr(&output).contains(" %  segment 0, step 1  h ") && !stderr(&output).contains('\u{1b}'), "{}", stderr(&output));

    // The resolved case runs to the same result.
    let again = program()
        .arg("run")
        .args([&dir.join("case.toml"), Path::new("--out"), &scratch.path("again")])
        .args(CPU)
        .arg("-q")
        .output()
        .expect("the program runs");
    assert_eq!((again.status.code(), again.stdout.len(), again.stderr.len()), (Some(0), 0, 0), "{}", stderr(&again));
    assert_eq!(fs::read(scratch.path("again").join("history.csv")).expect("a history"), text.as_bytes());

    // Whoever wants to know more is told every result and what took the time.
    let more = program()
        .arg("run")
        .args([&dir.join("case.toml"), Path::new("--out"), &scratch.path("more")])
        .args(CPU)
        .arg("-v")
        .output()
        .expect("the program runs");
    let told = stdout(&more);
    for word in ["F_N0 ", "delta_T_slip ", "Newton iterations", " s on CPU", "\ntime by phase ", "\nelement tangents "] {
        assert!(told.contains(word), "{word}: {told}");
    }
}

#[test]
fn fields_are_written_as_asked_and_an_earlier_result_is_replaced() {
    let scratch = scratch("");
    let set = ["--set", "solver.press_steps=3", "--set", "output.fields=\"all\""];
    done(&scratch, "out", &set);
    let dir = scratch.path("out");
    assert_eq!(names(&dir.join("fields")), ["case.pvd", "step_0001.vtu", "step_0002.vtu", "step_0003.vtu"]);
    assert_eq!(names(&dir.join("contact")).len(), 3);
    fs::write(dir.join("notes.txt"), "mine").expect("a file");
    let fewer = ["--set", "solver.press_steps=2", "--set", "output.fields=\"none\"", "--set", "output.plots=false"];
    // Not without a word.
    let output = scratch.run("out", &fewer);
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    for part in
        ["a run that is done, of another case (output.fields is \"all\" there and \"none\" here), 3 steps, written ", "--force"]
    {
        assert!(message.contains(part), "{message}");
    }
    assert_eq!(names(&dir.join("contact")).len(), 3);
    done(&scratch, "out", &[&fewer[..], &["--force"]].concat());
    assert_eq!(
        names(&dir),
        ["case.toml", "checkpoint.bin", "contact", "fields", "history.csv", "notes.txt", "plots", "run.log", "summary.json"]
    );
    for folder in ["fields", "contact", "plots"] {
        assert!(names(&dir.join(folder)).is_empty(), "{folder}: {:?}", names(&dir.join(folder)));
    }
}

#[test]
fn fields_open_in_python_and_agree_with_the_history() {
    let Some(python) = python::python("fields_open_in_python_and_agree_with_the_history", &["meshio", "numpy"]) else { return };
    let scratch = scratch(SHEAR);
    let (history, _) = done(&scratch, "out", &[]);
    let out = OutputDirectory::existing(scratch.path("out"));
    // The steps of the picture of stick and slip have a contact table alone.
    let saved: Vec<usize> =
        out.contact_steps().expect("contact tables").into_iter().filter(|&step| out.fields(step).exists()).collect();
    assert_eq!(saved.len(), 2);
    for step in saved {
        let force = history[step - 1].f_n.to_string();
        let output = Command::new(&python)
            .arg(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/scripts/check_fields.py"))
            .args([out.fields(step), out.contact(step), force.into(), out.collection()])
            .output()
            .expect("Python runs");
        assert!(output.status.success() && stdout(&output).contains("as written"), "{}{}", stdout(&output), stderr(&output));
    }
}

#[test]
fn two_runs_are_equal_to_the_bit_on_any_number_of_threads() {
    let scratch = scratch(SHEAR);
    let (_, first) = done(&scratch, "a", &["--threads", "1"]);
    let (_, second) = done(&scratch, "b", &["--threads", "2"]);
    let bytes =
        |name: &str, file: &str| fs::read(scratch.path(name).join(file)).unwrap_or_else(|error| panic!("{file}: {error}"));
    for file in ["history.csv", "case.toml", "contact/step_0005.csv", "fields/step_0005.vtu", "plots/forces.svg"] {
        assert!(bytes("a", file) == bytes("b", file), "{file} differs");
    }
    assert_eq!((first.device.as_str(), second.device.as_str()), ("CPU (1 thread)", "CPU (2 threads)"));
    assert_eq!(timeless(&first), timeless(&Summary { device: first.device.clone(), ..second }));
}

#[test]
fn other_units_give_the_same_normalised_curve() {
    let scratch = scratch(SHEAR);
    let (radius, modulus) = (2.5e-3, 200e9);
    let (reference, first) = done(&scratch, "mpa", &[]);
    let (other, second) = done(
        &scratch,
        "pa",
        &[
            "--set",
            "sphere.radius=2.5e-3",
            "--set",
            "material.youngs_modulus=200e9",
            "--set",
            "material.hardening.yield_stress=400e6",
            "--set",
            "path.0.indentation=5e-5",
            "--set",
            "path.1.shear=5e-6",
        ],
    );
    assert_eq!(reference.len(), other.len());
    let force = modulus * radius * radius / 200e3;
    for (a, b) in reference.iter().zip(&other) {
        for ((name, a), (_, b)) in numbers(a).into_iter().zip(numbers(b)) {
            let unit = match name.as_str() {
                "h" | "delta_T" | "a" | "stick_radius" | "a_gap" | "reach" | "h_contact" | "delta_T_contact" => radius,
                "F_N" | "F_T" | "F_T_limit" | "F_N_limit" | "F_T_error" | "F_N_error" => force,
                "k_T" => force / radius,
                "work_external" | "energy_elastic" | "work_plastic" | "work_friction" | "M_roll_y" => force * radius,
                _ => 1.0,
            };
            // What is left of F_T and its moment while pressing is rounding of F_N.
            let size = match name.as_str() {
                "delta_T_contact" => 1e-5,
                "M_roll_y" => 1.0,
                _ if name.starts_with("F_T") => 1.0,
                _ => a.abs(),
            };
            // How close to zero an accepted residual came is no result.
            let counted = matches!(name.as_str(), "merit" | "krylov_iterations");
            assert!(counted || (b / unit - a).abs() <= 1e-6 * size, "{name}: {a} and {} in other units", b / unit);
        }
    }
    let (a, b) = (first.normalized, second.normalized);
    for (a, b) in [(a.f_n0, b.f_n0), (a.a0, b.a0), (a.h0, b.h0), (a.f_t_max, b.f_t_max), (a.k_t0, b.k_t0)] {
        let (a, b) = (a.expect("a number"), b.expect("a number"));
        assert!((b / a - 1.0).abs() < 1e-6, "{a} and {b}");
    }
}

#[test]
fn a_shear_to_the_left_mirrors_one_to_the_right() {
    let scratch = scratch(SHEAR);
    // At the default tolerance the two differ by as much as it allows, some 1e-5.
    let (right, first) = done(&scratch, "right", &["--set", "solver.tolerance=1e-8"]);
    let (left, second) = done(&scratch, "left", &["--set", "solver.tolerance=1e-8", "--set", "path.1.shear=-0.002"]);
    assert_eq!(right.len(), left.len());
    let largest = |name: &str| right.iter().flat_map(numbers).filter(|n| n.0 == name).map(|n| n.1.abs()).fold(0.0, f64::max);
    for (a, b) in right.iter().zip(&left) {
        for ((name, a), (_, b)) in numbers(a).into_iter().zip(numbers(b)) {
            let mirrored =
                if matches!(name.as_str(), "delta_T" | "delta_T_contact" | "F_T" | "F_T_limit" | "M_roll_y") { -b } else { b };
            let counted = matches!(name.as_str(), "merit" | "krylov_iterations" | "newton_iterations");
            assert!(counted || (mirrored - a).abs() <= 1e-6 * largest(&name), "{name}: {a} to the right, {b} to the left");
        }
    }
    // The summary's numbers are sizes.
    for (a, b) in [(first.f_t_max, second.f_t_max), (first.k_t0, second.k_t0), (first.f_n0, second.f_n0)] {
        assert!((a.expect("a number") / b.expect("a number") - 1.0).abs() < 1e-5, "{a:?} and {b:?}");
    }
}

#[test]
fn without_friction_there_is_no_tangential_force() {
    let scratch = scratch(SHEAR);
    let (history, summary) = done(&scratch, "out", &["--set", "contact.friction=0.0", "--set", "solver.tolerance=1e-9"]);
    let pressed = summary.f_n0.expect("F_N0");
    // Zero but for the residual at which a step is accepted.
    let work = history[history.len() - 1].work_external;
    for row in &history {
        assert!(row.f_t.abs() <= 1e-8 * pressed && row.work_friction.abs() <= 1e-8 * work, "{row:?}");
    }
    // Nothing resists: the sphere slides as it is.
    let last = history[history.len() - 1];
    assert!((last.f_n / pressed - 1.0).abs() < 0.02, "{last:?}");
    assert_eq!(last.slipping_points, last.contact_points);
}

#[test]
fn full_stick_has_no_full_slip() {
    let scratch = scratch(SHEAR);
    let (history, summary) = done(&scratch, "out", &["--set", "contact.friction=\"stick\""]);
    let last = history[history.len() - 1];
    // More than the coefficient of the other cases: only the yield stress in shear limits it. What
    // the points do is in contact_points.rs.
    assert!(last.f_t / last.f_n > 0.4 && last.slipping_points == 0, "{last:?}");
    assert!(!summary.full_slip_reached && summary.f_n_slip.is_none() && summary.delta_t_slip.is_none());
}

#[test]
fn a_held_normal_force_is_held() {
    let scratch = scratch("[[path]]\nshear = 0.0015\nhold = \"normal-force\"\n");
    let (history, summary) = done(&scratch, "out", &["--set", "mesh.fine_zone=1.8", "--set", "solver.tolerance=1e-6"]);
    let held = summary.f_n0.expect("F_N0");
    let shear: Vec<&StepRecord> = history.iter().filter(|row| row.segment == 1).collect();
    assert!(shear.len() > 5);
    for row in &shear {
        assert!((row.f_n / held - 1.0).abs() < 1e-5, "{row:?} instead of F_N = {held}");
    }
    // The sheared contact yields, so the sphere sinks in.
    assert!(shear[shear.len() - 1].h > 0.0201, "{:?}", shear[shear.len() - 1]);
}

#[test]
fn a_release_ends_without_force_and_leaves_an_indentation() {
    let scratch = scratch("[[path]]\nrelease = true\n");
    let (history, summary) = done(&scratch, "out", &[]);
    let last = history[history.len() - 1];
    assert_eq!((last.f_n, last.f_t, last.contact_points, last.a), (0.0, 0.0, 0, 0.0));
    assert!(last.h > 0.017 && last.h < 0.0199, "{last:?}");
    let forces: Vec<f64> = history.iter().filter(|row| row.segment == 1).map(|row| row.f_n).collect();
    assert!(forces.windows(2).all(|pair| pair[1] < pair[0]), "{forces:?}");
    assert_eq!(summary.h0, Some(0.02));
    // The map shows the last contact there was.
    assert!(names(&scratch.path("out").join("plots")).contains(&"contact.svg".to_owned()));
}

#[test]
fn f32_is_what_mixed_is_and_says_so() {
    let scratch = scratch(SHEAR);
    let (mixed, _) = done(&scratch, "mixed", &["--precision", "mixed"]);
    let (single, summary) = done(&scratch, "f32", &["--precision", "f32"]);
    assert_eq!((summary.precision.as_str(), &single), ("f64", &mixed));
    assert!(matches!(&summary.messages[..], [message] if message.contains("f32 means mixed")), "{:?}", summary.messages);
}

#[test]
fn asked_to_say_more_it_tells_what_each_step_took() {
    let scratch = scratch("");
    let output = scratch.run("out", &["-v"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (history, _) = results(&scratch.path("out"));
    let told = stderr(&output);
    // The steps of the coarse run come before.
    let told = told.split_once("the run:").expect("the run is announced").1;
    for row in &history {
        let (step, newton, krylov) = (row.step, row.newton_iterations, row.krylov_iterations);
        let line =
            told.lines().find(|line| line.contains(&format!(" step {step}: "))).unwrap_or_else(|| panic!("step {step}: {told}"));
        assert!(line.contains(&format!(" {newton} iterations, {krylov} Krylov, ")), "{line}");
        assert!(line.contains(&format!("merit {:.1e}, ", row.merit)) && line.contains(" s (tangent "), "{line}");
    }
}

#[test]
fn a_contact_that_leaves_the_fine_mesh_is_computed_on_a_larger_one() {
    let scratch = scratch("");
    let narrow = "mesh.contact_radius=0.12";
    let scouted = scratch.run("scouted", &["--set", narrow]);
    let blind = scratch.run("blind", &["--set", narrow, "--set", "solver.error_estimate=false"]);
    // Blind, a contact may leave the larger mesh as well.
    for (name, output, remeshed, note) in [
        ("scouted", &scouted, 0..=0, "note: the contact leaves the zone of 0.1560 R"),
        ("blind", &blind, 1..=2, "note: the contact reaches "),
    ] {
        assert_eq!(output.status.code(), Some(0), "{}", stderr(output));
        assert!(stderr(output).contains(note), "{}", stderr(output));
        let (history, summary) = results(&scratch.path(name));
        assert!(remeshed.contains(&summary.remeshed), "{summary:?}");
        assert_eq!((summary.status, summary.messages.len()), (RunStatus::Done, summary.remeshed.max(1)), "{summary:?}");
        assert_eq!(history[0].step, 1);
        assert_eq!(history.len(), summary.steps);
        assert!((summary.a0.expect("a radius") / 0.2087 - 1.0).abs() < 0.1, "{summary:?}");
        // Nothing of the first start is left.
        assert_eq!(names(&scratch.path(name).join("contact")), [format!("step_{:04}.csv", history.len())]);
    }
}
