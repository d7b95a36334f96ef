//! An equal pair, a rigid sphere, an unlike sphere that deforms and plates that turn, on a device:
//! the CPU's history step by step, and the same bits again, alone or in a study; against a rigid
//! sphere and in the press of an equal pair few bytes an iteration, as over a plane; in its shear
//! no matrix.

mod device;
#[path = "common/histories.rs"]
mod histories;

use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::internals::compute::gpu::Precision;
use asperity::output::{OutputDirectory, RunStatus, StepRecord, Summary, read_history};
use histories::{difference, history};

/// Two cases of one mesh, the first with friction that slips, tightly solved.
const STUDY: &str = r#"
[base.sphere]
radius = 1.0
[base.material]
youngs_modulus = 200e3
poissons_ratio = 0.3
[base.material.hardening]
law = "ideal"
yield_stress = 400.0
[base.mesh]
elements_per_contact_radius = 4
contact_radius = 0.16
[base.solver]
tolerance = 1e-9
press_steps = 4
shear_steps = 4
[base.output]
plots = false
[grid]
"contact.friction" = [0.1, 0.3]
"#;

const EQUAL: &str = "[base.opponent]\nequal = true\n[[base.path]]\nindentation = 0.02\n[[base.path]]\nshear = 0.004\n";
const PRESSED_EQUAL: &str = "[base.opponent]\nequal = true\n[[base.path]]\nindentation = 0.02\n";
const RIGID: &str =
    "[base.opponent]\nrigid = true\nradius = 0.8\n[[base.path]]\nindentation = 0.01\n[[base.path]]\nshear = 0.002\n";
const RELEASED: &str = "[[base.path]]\nrelease = 0.5\n";
/// Not along x: all of the sphere is meshed, and of an equal pair both.
const TURNED: &str =
    "[[base.path]]\nindentation = 0.01\n[[base.path]]\nshear = [0.001, 0.0015]\ntwist = 0.01\nroll = [0.0, 0.002]\n";
const TURNED_RIGID: &str = "[base.opponent]\nrigid = true\nradius = 2.0\n";
/// One of an equal pair and its image turned half round y, all of either.
const TWISTED: &str =
    "[base.opponent]\nequal = true\n[[base.path]]\nindentation = 0.01\n[[base.path]]\nshear = 0.002\ntwist = 0.01\n";
const TURNED_EQUAL: &str = "[base.opponent]\nequal = true\n";
/// One of an equal pair and its image by inversion.
const INVERTED: &str =
    "[base.opponent]\nequal = true\n[[base.path]]\nindentation = 0.01\n[[base.path]]\nshear = [0.001, 0.0015]\n";
const UNLIKE: &str = r#"
[base.opponent]
radius = 2.0
[base.opponent.material]
youngs_modulus = 600e3
poissons_ratio = 0.25
[base.opponent.material.hardening]
law = "voce"
yield_stress = 500.0
saturation_stress = 900.0
rate = 30.0
[[base.path]]
indentation = 0.02
[[base.path]]
shear = 0.004
"#;

/// What is told on a device, and on no CPU: what stays on the host.
const VECTORS: &str = "note: the sphere leaves the x axis or turns, so the vectors of Newton's method stay on the host";
const SYSTEMS: &str = "note: the sphere is pressed against a body that deforms, so the vectors and linear systems of \
                       Newton's method stay on the host";
const FROM_SHEAR: &str = "note: the sphere is pressed against its equal, so the vectors of Newton's method stay on the host \
                          from the first shear on";
const TURNED_PAIR: &str = "note: the sphere is pressed against its equal and turns, or its equator is free, so the vectors of \
                          Newton's method stay on the host, and as long as all is even in x the linear systems too";
const DIRECT: &str = "note: solver.linear is \"direct\", so the vectors and linear systems of Newton's method stay on the host";

fn program(verb: &str, file: &Path, out: &Path, options: &[&str]) {
    let mut command = Command::new(assert_cmd::cargo::cargo_bin!("asperity"));
    command.arg(verb).arg(file).arg("--out").arg(out).arg("--quiet").args(options);
    let output = command.output().expect("the program runs");
    assert_eq!(output.status.code(), Some(0), "{verb}: {}", String::from_utf8_lossy(&output.stderr));
}

/// The study with this end on the CPU and on a device; `told` is what the latter is told of.
fn check(test: &str, end: &str, told: &[&str]) {
    check_within(test, end, told, 3e-7);
}

/// The same with the histories within `most` of each other.
fn check_within(test: &str, end: &str, told: &[&str], most: f64) {
    let Some(context) = device::device(test, Precision::F64) else { return };
    let dir = tempfile::tempdir().expect("a scratch directory");
    let at = |name: &str| dir.path().join(name);
    fs::write(at("study.toml"), format!("{STUDY}{end}")).expect("the study");
    for device in ["cpu", "gpu"] {
        program("study", &at("study.toml"), &at(device), &["--device", device]);
    }
    for case in ["c0001", "c0002"] {
        let [theirs, ours] = ["cpu", "gpu"].map(|device| at(device).join("cases").join(case));
        let out = OutputDirectory::existing(&ours);
        let summary = Summary::read(&out.summary()).expect("a summary");
        assert!(summary.device.contains(&context.adapter().name), "{}", summary.device);
        assert_eq!((summary.status, summary.linear_fallbacks), (RunStatus::Done, 0));
        assert!(summary.messages == told && summary.device_traffic.is_some(), "{:?}", summary.messages);
        let on_cpu = Summary::read(&OutputDirectory::existing(&theirs).summary()).expect("a summary");
        assert!(on_cpu.messages.is_empty(), "{:?}", on_cpu.messages);
        let rows = [&ours, &theirs].map(|dir| read_history(&OutputDirectory::existing(dir).history()).expect("a history"));
        assert!(rows[0].iter().any(|row| row.slipping_points > 0 && row.f_t > 0.0), "nothing slips");
        let difference = difference(&rows[0], &rows[1]);
        eprintln!("{test}, case {case}: {difference:.1e}");
        assert!(difference <= most, "case {case}: {difference}");
        // The second case alone, twice.
        for again in ["alone", "again"].iter().filter(|_| case == "c0002") {
            program("run", &out.case(), &at(again), &["--device", "gpu"]);
            assert!(history(&at(again)) == history(&ours), "{again}: other bits than in the study");
        }
    }
}

#[test]
fn an_equal_pair_has_the_cpus_history() {
    check("an_equal_pair_has_the_cpus_history", EQUAL, &[FROM_SHEAR]);
}

/// The press stays on the device and the shear does not: what is between them are the displacements
/// of two steps.
#[test]
fn an_equal_pair_that_is_extended_by_a_shear_has_the_same_bits() {
    let Some(_) = device::device("an_equal_pair_that_is_extended_by_a_shear_has_the_same_bits", Precision::F64) else { return };
    let dir = tempfile::tempdir().expect("a scratch directory");
    let base = STUDY.split("[grid]").next().expect("a base");
    let [pressed, sheared] = [("pressed.toml", PRESSED_EQUAL), ("sheared.toml", EQUAL)].map(|(name, end)| {
        let file = dir.path().join(name);
        let text = format!("{base}[base.contact]\nfriction = 0.1\n{end}").replace("base.", "");
        fs::write(&file, text).expect("the case");
        file
    });
    let [at_once, later] = ["at_once", "later"].map(|name| dir.path().join(name));
    program("run", &sheared, &at_once, &["--device", "gpu"]);
    program("run", &pressed, &later, &["--device", "gpu"]);
    program("run", &sheared, &later, &["--device", "gpu", "--extend"]);
    assert!(history(&later) == history(&at_once), "other bits than at once");
}

#[test]
fn a_rigid_sphere_has_the_cpus_history() {
    check("a_rigid_sphere_has_the_cpus_history", &format!("{RIGID}hold = \"normal-force\"\n{RELEASED}"), &[]);
}

#[test]
fn a_plate_that_turns_has_the_cpus_history() {
    check("a_plate_that_turns_has_the_cpus_history", TURNED, &[VECTORS]);
}

#[test]
fn a_rigid_sphere_under_a_plate_that_turns_has_the_cpus_history() {
    check("a_rigid_sphere_under_a_plate_that_turns_has_the_cpus_history", &format!("{TURNED_RIGID}{TURNED}"), &[VECTORS]);
}

#[test]
fn an_equal_pair_that_turns_has_the_cpus_history() {
    check("an_equal_pair_that_turns_has_the_cpus_history", &format!("{TURNED_EQUAL}{TURNED}"), &[SYSTEMS]);
}

/// The shear's linear systems are solved on the device: the CPU's iterations and its forces, and
/// what comes down in an iteration are forces and a solution, no matrix.
#[test]
fn the_shear_of_an_equal_pair_is_solved_on_the_device() {
    let test = "the_shear_of_an_equal_pair_is_solved_on_the_device";
    let Some(_) = device::device(test, Precision::F64) else { return };
    let dir = tempfile::tempdir().expect("a scratch directory");
    let at = |name: &str| dir.path().join(name);
    let base =
        STUDY.split("[grid]").next().expect("a base").replace("base.", "").replace("[output]", "[output]\nfields = \"none\"");
    let base = base.replace("tolerance = 1e-9", "tolerance = 1e-9\nerror_estimate = false");
    let of = |name: &str, end: &str, options: &[&str]| {
        fs::write(at("case.toml"), format!("{base}[contact]\nfriction = 0.3\n{end}").replace("base.", "")).expect("the case");
        program("run", &at("case.toml"), &at(name), options);
        let out = OutputDirectory::existing(at(name));
        (read_history(&out.history()).expect("a history"), Summary::read(&out.summary()).expect("a summary"))
    };
    let end = format!("{EQUAL}hold = \"normal-force\"\n[[base.path]]\nshear = -0.001\n");
    let [(theirs, _), (ours, all)] = ["cpu", "gpu"].map(|device| of(device, &end, &["--device", device]));
    let (mixed, _) = of("mixed", &end, &["--device", "gpu", "--precision", "mixed"]);
    let (_, pressed) = of("pressed", PRESSED_EQUAL, &["--device", "gpu"]);
    let [difference, in_single] = [&ours, &mixed].map(|rows| difference(rows, &theirs));
    let iterations = |rows: &[StepRecord]| -> Vec<usize> {
        rows.iter().filter(|row| row.segment > 0).map(|row| row.newton_iterations).collect()
    };
    eprintln!("{difference:.1e} and {in_single:.1e}, iterations {:?} and {:?}", iterations(&ours), iterations(&theirs));
    assert!(difference <= 2e-6 && in_single <= 2e-6, "{difference} {in_single}");
    assert_eq!(iterations(&ours), iterations(&theirs));
    assert_eq!((all.status, all.linear_fallbacks), (RunStatus::Done, 0));
    let account = |summary: &Summary| summary.device_traffic.expect("an account").steps;
    let count = (all.newton_iterations - pressed.newton_iterations) as u64;
    let [down, up] =
        [account(&all).bytes_down - account(&pressed).bytes_down, account(&all).bytes_up - account(&pressed).bytes_up];
    eprintln!("{count} iterations of {} unknowns: {} bytes down each, {} up", all.unknowns, down / count, up / count);
    // Forces in f64 and a solution in f32, of two sides where F_N is held.
    assert!(down / count <= 30 * all.unknowns as u64, "{}", down / count);
}

#[test]
fn an_equal_pair_that_twists_has_the_cpus_history() {
    check("an_equal_pair_that_twists_has_the_cpus_history", TWISTED, &[TURNED_PAIR]);
}

/// In the second step of this shear a point that has just ceased to flow has two answers: by the
/// two-step formula it flows, by the backward Euler step it does not (see `material::multistep`).
/// The CPU comes to the one and the device to the other, whatever the tolerance (3.0e-7 of F_N at
/// 1e-9 and at 1e-11; 1e-12 where the bodies are elastic).
#[test]
fn an_equal_pair_by_inversion_has_the_cpus_history() {
    check_within("an_equal_pair_by_inversion_has_the_cpus_history", INVERTED, &[SYSTEMS], 1e-6);
}

#[test]
fn an_unlike_pair_has_the_cpus_history() {
    check("an_unlike_pair_has_the_cpus_history", UNLIKE, &[SYSTEMS]);
}

/// Against a rigid sphere a path takes the CPU's iterations at the default tolerance, to a
/// twentieth of their sum, and has its forces, with friction and without: to 1e-5 of F_N, where a
/// step is solved to 1e-4; no vector comes down in them. Where a merit is all but at the tolerance,
/// rounding says whether a step takes one iteration more. Of steps in f32 the residual in f64 has
/// the say.
#[test]
fn a_rigid_sphere_stays_on_the_device() {
    stays_on_the_device("a_rigid_sphere_stays_on_the_device", RIGID, &[], Some(1e-5));
}

/// So stays an equal pair that is pressed and released, which meets in a plane where nothing slips.
/// The CPU measures its merits in the unknowns of the mortar: it ends a step at another iterate.
#[test]
fn the_press_of_an_equal_pair_stays_on_the_device() {
    stays_on_the_device("the_press_of_an_equal_pair_stays_on_the_device", PRESSED_EQUAL, &[FROM_SHEAR], None);
}

/// The CPU's iterations, to a twentieth, and forces within a share of F_N, or without one its
/// forces alone.
fn stays_on_the_device(test: &str, end: &str, told: &[&str], as_on_the_cpu: Option<f64>) {
    let Some(_) = device::device(test, Precision::F64) else { return };
    let dir = tempfile::tempdir().expect("a scratch directory");
    let at = |name: &str| dir.path().join(name);
    let base = STUDY.split("[grid]").next().expect("a base").replace("tolerance = 1e-9\n", "error_estimate = false\n");
    let grid = "[grid]\n\"contact.friction\" = [0.0, 0.3]\n";
    fs::write(at("study.toml"), format!("{base}fields = \"none\"\n{grid}{end}{RELEASED}")).expect("the study");
    for (name, options) in [
        ("cpu", &["--device", "cpu"][..]),
        ("gpu", &["--device", "gpu"]),
        ("mixed", &["--device", "gpu", "--precision", "mixed"]),
    ] {
        program("study", &at("study.toml"), &at(name), options);
    }
    for case in ["c0001", "c0002"] {
        let [theirs, ours, mixed] = ["cpu", "gpu", "mixed"].map(|device| {
            let out = OutputDirectory::existing(at(device).join("cases").join(case));
            let summary = Summary::read(&out.summary()).expect("a summary");
            assert_eq!((summary.status, summary.linear_fallbacks), (RunStatus::Done, 0), "{device}");
            assert_eq!(summary.messages, if device == "cpu" { &[] } else { told }, "{device}");
            (read_history(&out.history()).expect("a history"), summary)
        });
        for (device, (rows, _), most) in [("f64", &ours, as_on_the_cpu.unwrap_or(5e-4)), ("f32", &mixed, 5e-4)] {
            let difference = difference(rows, &theirs.0);
            eprintln!("case {case} in {device}: {difference:.1e}");
            assert!(difference <= most, "case {case} in {device}: {difference}");
        }
        let iterations = |rows: &[StepRecord]| rows.iter().map(|row| row.newton_iterations).sum::<usize>();
        let [mine, cpus] = [iterations(&ours.0), iterations(&theirs.0)];
        eprintln!("case {case}: {mine} iterations, {cpus} on the CPU, {} steps", ours.0.len());
        assert!(as_on_the_cpu.is_none() || 20 * mine.abs_diff(cpus) <= cpus, "{mine} and {cpus} iterations");
        let contact = |rows: &[StepRecord]| rows.iter().map(|row| (row.contact_points, row.slipping_points)).collect::<Vec<_>>();
        assert_eq!(contact(&ours.0), contact(&theirs.0));
        assert!(ours.1.confirming_iterations.is_none() && mixed.1.confirming_iterations.is_some());
    }
    // The account of a case by itself, with what each step records of its contact points.
    let case = OutputDirectory::existing(at("gpu").join("cases/c0002")).case();
    program("run", &case, &at("alone"), &["--device", "gpu"]);
    let alone = Summary::read(&OutputDirectory::existing(at("alone")).summary()).expect("a summary");
    let each = alone.device_traffic.expect("an account").steps.bytes_down / alone.newton_iterations as u64;
    eprintln!("{} iterations: {each} bytes down each", alone.newton_iterations);
    assert!(each <= 2000, "{each}");
}

/// Against a rigid body along x nothing is told, unless systems are to be solved directly.
#[test]
fn what_stays_on_the_host_is_told() {
    let Some(_) = device::device("what_stays_on_the_host_is_told", Precision::F64) else { return };
    let dir = tempfile::tempdir().expect("a scratch directory");
    let file = dir.path().join("case.toml");
    let base = STUDY.split("[grid]").next().expect("a base").replace("base.", "");
    fs::write(&file, format!("{base}[contact]\nfriction = 0.3\n[[path]]\nindentation = 0.002\n")).expect("the case");
    for (options, told) in [
        (&["--device", "gpu"][..], &[][..]),
        (&["--device", "gpu", "--set", "solver.linear=direct"], &[DIRECT]),
        (&["--device", "gpu", "--precision", "mixed", "--set", "opponent={equal=true}"], &[FROM_SHEAR]),
        (&["--device", "cpu", "--set", "solver.linear=direct"], &[]),
    ] {
        let out = dir.path().join("out");
        program("run", &file, &out, &[options, &["--force"]].concat());
        let summary = Summary::read(&OutputDirectory::existing(&out).summary()).expect("a summary");
        assert_eq!(summary.messages, told, "{options:?}");
    }
}
