//! A surface that is meshed finer than the inside: against uniform meshes as fine as either, with
//! every opponent; where the contact leaves it; interrupted and gone on with.
#![cfg(unix)]

mod common;

use asperity::case::Case;
use asperity::internals::simulation::drive::Ending;
use asperity::internals::simulation::follow::{follow, on_cpu};
use asperity::internals::simulation::problem::Problem;
use asperity::output::{Recorder, StepRecord, Summary, read_history};
use common::{Scratch, difference, stderr};

const IDEAL: &str = include_str!("../fixtures/cases/ideal.toml");
const MESH: &str = "mesh.elements_per_contact_radius";
const SURFACE: &str = "mesh.surface_elements_per_contact_radius";

/// The rows of a case with these settings, which is done.
fn rows(text: &str, settings: &[String]) -> Vec<StepRecord> {
    let case = Case::parse(text, "case.toml", settings).unwrap_or_else(|error| panic!("{error}"));
    let mut recorder = Recorder::new(&case, None);
    let followed = follow(Problem::new(&case).expect("a problem"), None, &mut |problem| on_cpu(problem), &mut recorder);
    assert_eq!(followed.expect("no failure of the program").ending, Ending::Done, "{settings:?}");
    // On 4 inside and 16 at the surface one point is let go in one step, at twice the way to slip.
    let relaxed: Vec<(f64, usize)> =
        recorder.rows.iter().filter(|row| row.relaxed > 0).map(|row| (row.delta_t, row.relaxed)).collect();
    let is_coarse = settings.contains(&format!("{SURFACE}=16")) && settings.contains(&format!("{MESH}=4"));
    let is_beyond = matches!(relaxed[..], [(delta_t, 1)] if is_coarse && delta_t > 0.005);
    assert!(relaxed.is_empty() || is_beyond, "{settings:?}: {relaxed:?}");
    recorder.rows
}

fn on(inside: usize, at_surface: usize) -> Vec<String> {
    vec![format!("{MESH}={inside}"), format!("{SURFACE}={at_surface}"), "solver.error_estimate=false".to_owned()]
}

/// F_N before the shear, and F_T at shares of a displacement before the first slip is over.
fn forces(rows: &[StepRecord], delta_t: f64) -> [f64; 4] {
    let pressed = rows.iter().rev().find(|row| row.segment == 0).expect("a press");
    let shear: Vec<&StepRecord> = std::iter::once(pressed).chain(rows.iter().filter(|row| row.segment == 1)).collect();
    let at = |d: f64| {
        let k = shear.partition_point(|row| row.delta_t < d).clamp(1, shear.len() - 1);
        let (a, b) = (shear[k - 1], shear[k]);
        a.f_t + (b.f_t - a.f_t) * (d - a.delta_t) / (b.delta_t - a.delta_t)
    };
    [pressed.f_n, at(0.3 * delta_t), at(0.6 * delta_t), at(delta_t)]
}

/// What the fine surface is for: F_T of a mesh that is coarse inside is that of one as fine as the
/// surface, and not that of one as coarse as the inside.
#[test]
fn f_t_is_that_of_the_surface_with_every_opponent() {
    let opponents: [(&str, &[&str]); 5] = [
        ("a plane", &[]),
        ("a rigid sphere", &["opponent={rigid=true, radius=2.0}"]),
        ("an equal sphere", &["opponent={equal=true}"]),
        (
            "a larger sphere",
            &["opponent={radius=1.5, material={youngs_modulus=300e3, poissons_ratio=0.3, hardening={law=\"elastic\"}}}"],
        ),
        ("a flat", &["opponent={flat=true, material={youngs_modulus=300e3, poissons_ratio=0.3, hardening={law=\"elastic\"}}}"]),
    ];
    for (name, more) in opponents {
        let of = |inside: usize, at_surface: usize| {
            let path = ["path.0.indentation=0.01".to_owned(), "path.1.shear=0.002".to_owned()];
            let settings = [on(inside, at_surface), path.to_vec(), more.iter().map(|s| (*s).to_owned()).collect()].concat();
            forces(&rows(IDEAL, &settings), 0.001)
        };
        let (coarse, skin, fine) = (of(4, 4), of(4, 8), of(8, 8));
        let off = |x: &[f64; 4]| -> f64 { (1..4).map(|k| (x[k] / fine[k] - 1.0).powi(2)).sum::<f64>().sqrt() };
        println!("{name}: {coarse:.4?} {skin:.4?} {fine:.4?}: {:.4} {:.4}", off(&coarse), off(&skin));
        assert!(off(&skin) < 0.5 * off(&coarse), "{name}: F_T {skin:?}, uniform {coarse:?} and {fine:?}");
        assert!((skin[0] / fine[0] - 1.0).abs() < 0.03, "{name}: F_N {} and {}", skin[0], fine[0]);
    }
}

#[test]
fn a_contact_that_leaves_the_fine_surface_starts_over_on_a_larger_one() {
    for opponent in [&[] as &[&str], &["opponent={equal=true}"]] {
        let more: Vec<String> = opponent.iter().map(|s| (*s).to_owned()).collect();
        let on = [on(4, 16), more].concat();
        let small = ["mesh.contact_radius=0.1", "mesh.fine_zone=1.1", "path.1.shear=0.02"].map(str::to_owned);
        let (case, wide) = (Case::parse(IDEAL, "", &small).expect("a case"), [on.clone(), vec![small[2].clone()]].concat());
        let (narrow, wide) = (rows(IDEAL, &[on, small.to_vec()].concat()), rows(IDEAL, &wide));
        let zone = 1.1 * case.mesh.contact_radius.expect("given");
        let (last, expected) = (narrow.last().expect("rows"), wide.last().expect("rows"));
        assert!(last.reach > 1.2 * zone, "{opponent:?}: {} against {zone}", last.reach);
        assert!((last.f_t / expected.f_t - 1.0).abs() < 0.02, "{opponent:?}: {} and {}", last.f_t, expected.f_t);
    }
}

#[test]
fn a_run_with_a_fine_surface_goes_on_to_the_same_bits() {
    let text = format!("{IDEAL}\n[mesh]\nelements_per_contact_radius = 4\nsurface_elements_per_contact_radius = 8\n");
    let scratch = Scratch::new(&text, &["--device", "cpu"]);
    let whole = scratch.run("whole", &[]);
    assert_eq!(whole.status.code(), Some(0), "{}", stderr(&whole));
    assert!(stderr(&whole).contains("4 elements along the contact radius and 8 at the surface"), "{}", stderr(&whole));
    let mut child =
        common::program().args(scratch.args("out", &[])).stderr(std::process::Stdio::null()).spawn().expect("it runs");
    let out = scratch.path("out");
    while read_history(&out.join("history.csv")).map_or(0, |rows| rows.len()) < 8 {
        assert_eq!(child.try_wait().expect("a child"), None, "it ends before it is stopped");
        std::thread::sleep(std::time::Duration::from_millis(2));
    }
    rustix::process::kill_process(rustix::process::Pid::from_child(&child), rustix::process::Signal::TERM)
        .expect("a signal is sent");
    assert_eq!(child.wait().expect("it ends").code(), Some(75));
    let resumed = scratch.run("out", &["--resume"]);
    assert_eq!(resumed.status.code(), Some(0), "{}", stderr(&resumed));
    assert_eq!(difference(&out, &scratch.path("whole")), None);
    let summary = Summary::read(&out.join("summary.json")).expect("a summary");
    assert!(summary.f_t_max_limit.is_some(), "it has a companion");
    // Points that hang are drawn, with the numbers of all fields: see `output::space` for where.
    let vtu = std::fs::read_dir(out.join("fields")).expect("fields").map(|entry| entry.expect("an entry").path());
    let vtu = vtu.into_iter().find(|path| path.extension().is_some_and(|end| end == "vtu")).expect("a step");
    let text = std::fs::read_to_string(vtu).expect("a text");
    let points: usize =
        text.split("NumberOfPoints=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("told").parse().expect("a number");
    assert!(points > summary.unknowns / 3 + 10, "{points} points of {} unknowns", summary.unknowns);
}

#[test]
fn elements_set_by_themselves_are_those_at_the_surface_too() {
    let text = format!("{IDEAL}\n[mesh]\nelements_per_contact_radius = 6\nsurface_elements_per_contact_radius = 24\n");
    let mesh = |text: &str, settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|s| (*s).to_owned()).collect();
        let mesh = Case::parse(text, "", &settings).unwrap_or_else(|error| panic!("{error}")).mesh;
        (mesh.elements_per_contact_radius, mesh.surface_elements())
    };
    assert_eq!(mesh(&text, &[]), (6, 24));
    assert_eq!(mesh(&text, &["mesh.elements_per_contact_radius=8"]), (8, 8));
    assert_eq!(mesh(&text, &["mesh.elements_per_contact_radius=8", "mesh.surface_elements_per_contact_radius=16"]), (8, 16));
    assert_eq!(mesh(&text, &["mesh.surface_elements_per_contact_radius=12", "mesh.elements_per_contact_radius=12"]), (12, 12));
    assert_eq!((mesh(IDEAL, &[]), mesh(IDEAL, &["mesh.elements_per_contact_radius=16"])), ((10, 20), (16, 16)));
    assert_eq!(mesh(IDEAL, &["mesh.surface_elements_per_contact_radius=40"]), (10, 40));
    assert_eq!(mesh(IDEAL, &["mesh.surface_elements_per_contact_radius=10"]), (10, 10));
    let alone = format!("{IDEAL}\n[mesh]\nelements_per_contact_radius = 16\n");
    assert_eq!(mesh(&alone, &[]), (16, 16));
    // What is written out is read as it was.
    for (setting, expected) in
        [("surface_elements_per_contact_radius=40", (10, 40)), ("elements_per_contact_radius=16", (16, 16))]
    {
        let written = Case::parse(IDEAL, "", &[format!("mesh.{setting}")]).expect("a case").to_toml();
        assert_eq!(mesh(&written, &[]), expected);
    }
    let written = Case::parse(IDEAL, "", &[]).expect("a case").to_toml();
    assert_eq!(mesh(&written, &[]), (10, 20));
    assert_eq!(mesh(&written, &["mesh.elements_per_contact_radius=4"]), (4, 4));
    let error =
        Case::parse(&text, "case.toml", &["mesh.surface_elements_per_contact_radius=16".to_owned()]).unwrap_err().to_string();
    assert!(error.contains("6, 12, 24, 48"), "{error}");
}
