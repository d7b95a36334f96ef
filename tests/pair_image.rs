//! An equal pair of which one body is simulated: on paths that an image serves it has the forces of
//! two bodies, of another image and of other directions, and all that a run leaves.
#![cfg(unix)]

mod common;
#[path = "common/followed.rs"]
mod followed;

use asperity::case::Case;
use asperity::internals::simulation::problem::Problem;
use asperity::output::StepRecord;
use common::{Scratch, difference, stderr};
use followed::rows;

const IDEAL: &str = "law = \"ideal\"\nyield_stress = 2.0";
const ELASTIC: &str = "law = \"elastic\"";
const IMAGE: &str = "equal = true";

/// The same sphere as one of two bodies.
fn meshed(law: &str) -> String {
    format!(
        "radius = 1.0\n[opponent.material]\nyoungs_modulus = 1000.0\npoissons_ratio = 0.3\n[opponent.material.hardening]\n{law}"
    )
}

/// A pair pressed and moved on half of the default mesh, in the units of E = 1000 and R = 1.
fn text(law: &str, opponent: &str, path: &[&str]) -> String {
    let segments: String = path.iter().map(|segment| format!("[[path]]\n{segment}\n")).collect();
    format!(
        "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 1000.0\npoissons_ratio = 0.3\n[material.hardening]\n{law}\n\
         [contact]\nfriction = 0.3\n[opponent]\n{opponent}\n[mesh]\nelements_per_contact_radius = 5\n\
         surface_elements_per_contact_radius = 10\n[solver]\nerror_estimate = false\n{segments}"
    )
}

fn end(rows: &[StepRecord]) -> &StepRecord {
    rows.last().expect("rows")
}

fn pressed(rows: &[StepRecord]) -> &StepRecord {
    rows.iter().rfind(|row| row.segment == 0).expect("a press")
}

/// What was put in is stored and dissipated, in both bodies, to half a per cent.
fn assert_energy(rows: &[StepRecord], what: &str) {
    let end = end(rows);
    let found = end.energy_elastic + end.work_plastic + end.work_friction;
    let most = rows.iter().fold(0.0, |most: f64, row| most.max(row.work_external));
    assert!((found - end.work_external).abs() < 0.005 * most, "{what}: {found} of {}", end.work_external);
}

/// Which bodies are meshed, and how much of each.
#[test]
fn the_path_decides_what_is_meshed() {
    let of = |path: &str| {
        let case = Case::parse(&text(ELASTIC, IMAGE, &["indentation = 0.01", path]), "case.toml", &[]).expect("a case");
        let mesh = Problem::new(&case).expect("a problem").model.mesh;
        (mesh.couple.is_some(), mesh.copies)
    };
    let paths = [
        ("shear = 0.001", (false, 2)),
        ("shear = \"full-slip\"\nshear_direction = 180.0", (false, 2)),
        ("shear = [0.001, 0.002]", (false, 1)),
        ("shear = \"full-slip\"\nshear_direction = 30.0", (false, 1)),
        ("twist = 0.1", (false, 1)),
        ("roll = [0.01, 0.0]\nshear = [0.001, 0.0]", (false, 1)),
        ("roll = 0.01", (true, 2)),
        ("twist = 0.1\nshear = [0.0, 0.001]", (true, 1)),
    ];
    paths.iter().for_each(|(path, expected)| assert_eq!(of(path), *expected, "{path}"));
}

/// F_N differs by 0.3 % after a twist on 5 elements and 10 at the surface, 0.1 % on 8 and 16, and
/// by 0.8 % after a shear across: the other body's nodes lie elsewhere. The two have no rolling
/// moment in a shear, by symmetry; of two meshed bodies, one of which has the slaves, the middle of
/// the pressure is beside the line of centres.
#[test]
fn an_image_has_the_forces_of_two_bodies() {
    let tight = ["solver.tolerance=1e-6"];
    for moved in ["shear = [0.002, 0.003]", "twist = 0.04", "twist = 0.03\nshear = [0.001, 0.0]"] {
        let path = ["indentation = 0.02", moved];
        let (image, two) = (rows(&text(IDEAL, IMAGE, &path), &tight), rows(&text(IDEAL, &meshed(IDEAL), &path), &tight));
        assert_energy(&image, moved);
        let (one, other) = (end(&image), end(&two));
        let is_there = |a: f64, b: f64| (a - b).abs() < 1e-12;
        assert!(
            is_there(one.twist, other.twist) && is_there(one.delta_t, other.delta_t) && is_there(one.delta_t_y, other.delta_t_y)
        );
        let (force, moment) = (other.f_n, other.f_n * other.a);
        let pairs = [
            (one.f_n / force, other.f_n / force),
            (one.f_t / force, other.f_t / force),
            (one.f_t_y / force, other.f_t_y / force),
            (one.m_twist / moment, other.m_twist / moment),
            (one.m_roll_x / moment, other.m_roll_x / moment),
            (one.m_roll_y / moment, other.m_roll_y / moment),
        ];
        let tolerances = [0.01, 0.005, 0.005, 0.0025, 0.015, 0.015];
        assert!(pairs.iter().zip(tolerances).all(|((a, b), tolerance)| (a - b).abs() < tolerance), "{moved}: {pairs:.4?}");
    }
}

/// Of two bodies one rolls on the other, which stays: their centres turn about each other by half
/// of the angle, and move apart. Turned back by that, with what the one's centre then has to move,
/// it is the image's roll, in which each turns by half of the angle.
#[test]
fn a_roll_about_x_is_that_of_two_bodies_seen_from_their_centres() {
    let (h, angle) = (0.02_f64, 0.02_f64);
    let image = rows(&text(IDEAL, IMAGE, &[&format!("indentation = {h:?}"), &format!("roll = [{angle:?}, 0.0]")]), &[]);
    assert_energy(&image, "roll");
    // The centre goes by R - h for each rad of a roll; between two bodies it is R - h/2.
    let beside = -0.5 * h * angle;
    let apart = (2.0 - h) * (1.0 - (0.5 * angle).cos());
    let moved = format!("roll = [{angle:?}, 0.0]\nshear = [0.0, {beside:?}]\nindentation = {:?}", h + apart);
    // Both meshes lie along x.
    let two = rows(&text(IDEAL, &meshed(IDEAL), &[&format!("indentation = {h:?}"), "shear = 1e-9", &moved]), &[]);
    let (one, other) = (end(&image), end(&two));
    let (sin, cos) = (0.5 * angle).sin_cos();
    let (f_n, across) = (other.f_n * cos + other.f_t_y * sin, other.f_t_y * cos - other.f_n * sin);
    assert!((one.roll_x - angle).abs() < 1e-12);
    let presses = [pressed(&image).f_n, pressed(&two).f_n];
    for (what, a, b) in [("F_N", one.f_n, f_n), ("F_T,y", one.f_t_y, across)] {
        assert!((a / presses[0] - b / presses[1]).abs() < 0.005, "{what} {a} {b} of {presses:?}");
    }
    // 1.6 % off, 0.8 on 8 elements and 16: the other body's nodes lie elsewhere.
    let moments = [one.m_roll_x / presses[0], other.m_roll_x / presses[1]];
    assert!((moments[0] / moments[1] - 1.0).abs() < 0.02, "{moments:?}");
}

/// On half of the mesh by the half turn, and on all of it by the inversion: within 2.5e-4 of the
/// F_N of the press.
#[test]
fn along_x_both_images_say_the_same() {
    for law in [ELASTIC, IDEAL] {
        let of = |shear: &str| rows(&text(law, IMAGE, &["indentation = 0.02", shear]), &["solver.tolerance=1e-6"]);
        let (half, whole) = (of("shear = 0.003"), of("shear = [0.003, 1e-14]"));
        assert_energy(&half, law);
        assert_energy(&whole, law);
        let press = pressed(&half).f_n;
        assert!((pressed(&whole).f_n / press - 1.0).abs() < 1e-5, "{} for {press}", pressed(&whole).f_n);
        let (one, other) = (end(&half), end(&whole));
        for (a, b) in [(one.f_n, other.f_n), (one.f_t, other.f_t), (one.f_t_y, other.f_t_y)] {
            assert!((a - b).abs() < 1e-3 * press, "{law}: {a} {b} of {press}");
        }
    }
}

/// The mesh lies along the first shear, so that nothing is across; after a first shear along x
/// there is the mesh's own anisotropy: 0.7 % of F_T, and nothing to speak of across.
#[test]
fn turned_axes_have_the_forces_of_the_x_axis() {
    turned_axes(&["indentation = 0.02"], 0.005, 1e-4);
    turned_axes(&["indentation = 0.02", "shear = 1e-9"], 0.01, 0.003);
}

fn turned_axes(first: &[&str], most: f64, most_across: f64) {
    let of = |direction: f64| {
        let shear = format!("shear = 0.003\nshear_direction = {direction:?}");
        rows(&text(IDEAL, IMAGE, &[first, &[&shear]].concat()), &[])
    };
    let along = of(0.0);
    let press = pressed(&along).f_n;
    let peak = along.iter().fold(0.0, |most: f64, row| most.max(row.f_t));
    for direction in [45.0_f64, 90.0] {
        let turned = of(direction);
        assert_energy(&turned, "turned");
        let (sin, cos) = direction.to_radians().sin_cos();
        let (one, other) = (end(&along), end(&turned));
        let (f_t, across) = (other.f_t * cos + other.f_t_y * sin, other.f_t_y * cos - other.f_t * sin);
        assert!((one.f_n - other.f_n).abs() < most * press, "{direction}: F_N {} for {}", other.f_n, one.f_n);
        assert!((one.f_t - f_t).abs() < most * peak, "{direction}: F_T {f_t} for {}", one.f_t);
        assert!(across.abs() < most_across * peak, "{direction}: {across} across");
    }
}

/// A held force, ways back and releases, and full stick, with both images.
#[test]
fn images_take_every_kind_of_segment() {
    let held = |moved: &str| format!("{moved}\nhold = \"normal-force\"");
    let shears = [held("shear = [0.001, 0.0015]"), "shear = [0.0, 0.0]".to_owned(), "release = 0.5".to_owned()];
    let turns = [held("twist = 0.02"), "twist = 0.0".to_owned(), "release = 0.5".to_owned()];
    for moved in [shears, turns] {
        let path: Vec<&str> = ["indentation = 0.01"].into_iter().chain(moved.iter().map(String::as_str)).collect();
        let rows = rows(&text(IDEAL, IMAGE, &path), &[]);
        let press = pressed(&rows).f_n;
        for row in rows.iter().filter(|row| row.segment == 1) {
            assert!((row.f_n - press).abs() < 1e-4 * press, "{} of {press} in step {}", row.f_n, row.step);
        }
        let before = rows.iter().rfind(|row| row.segment == 2).expect("a way back").f_n;
        assert!((end(&rows).f_n - 0.5 * before).abs() < 0.01 * before, "{} of {before}", end(&rows).f_n);
        assert_energy(&rows, &moved[0]);
    }
    // Stuck, an elastic contact is as stiff in all directions.
    let stuck = |moved: &str| rows(&text(ELASTIC, IMAGE, &["indentation = 0.01", moved]), &["contact.friction=\"stick\""]);
    let (one, other) = (stuck("shear = 0.0005"), stuck("shear = 0.0005\nshear_direction = 60.0"));
    let (sin, cos) = 60.0_f64.to_radians().sin_cos();
    let (one, other) = (end(&one), end(&other));
    assert!((other.f_t * cos + other.f_t_y * sin - one.f_t).abs() < 0.01 * one.f_t, "{other:?} for {one:?}");
    assert!((other.f_t_y * cos - other.f_t * sin).abs() < 0.01 * one.f_t, "{other:?}");
}

/// A run that was stopped goes on to the bits of one that was not, with tables and fields.
#[test]
fn a_stopped_run_goes_on_to_the_same_bits() {
    for (name, moved) in [("inversion", "shear = [0.001, 0.002]"), ("half-turn", "twist = 0.03")] {
        let scratch = Scratch::new(&text(IDEAL, IMAGE, &["indentation = 0.01", moved]), &["--device", "cpu"]);
        let run = |out: &str, options: &[&str]| {
            let output = scratch.run(out, &[&["-q"], options].concat());
            assert!(output.status.success(), "{}", stderr(&output));
        };
        run("whole", &[]);
        // Stopped where it has left the press, it has the rest before it.
        let mut child = common::program().args(scratch.args("parts", &["-q"])).spawn().expect("it runs");
        let history = scratch.path("parts").join("history.csv");
        let moves = || asperity::output::read_history(&history).is_ok_and(|rows| rows.iter().any(|row| row.segment == 1));
        while !moves() {
            let ended = child.try_wait().expect("a child");
            assert!(ended.is_none(), "{name}: it ended before it was stopped: {ended:?}");
            std::thread::sleep(std::time::Duration::from_millis(2));
        }
        let process = rustix::process::Pid::from_child(&child);
        rustix::process::kill_process(process, rustix::process::Signal::TERM).expect("a signal is sent");
        assert_eq!(child.wait().expect("it ends").code(), Some(75), "{name}");
        run("parts", &["--resume"]);
        assert_eq!(difference(&scratch.path("parts"), &scratch.path("whole")), None, "{name}");
        for kind in ["contact", "fields"] {
            let files = std::fs::read_dir(scratch.path("whole").join(kind)).expect("a folder").count();
            assert!(files >= 2, "{name}: {files} in {kind}");
        }
    }
}
