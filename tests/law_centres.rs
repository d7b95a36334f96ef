//! The frame of the centres: two simulated spheres that slide have F_T = mu F_N in it, and what
//! `law predict` says along fixed axes is what an engine's two spheres answer.

mod paths;
#[path = "common/programs.rs"]
mod programs;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::case::Case;
use asperity::contact_law::Centres;
use asperity::contact_law::path::drive_centres;
use asperity::law::LawFile;
use asperity::law::export::{Language, law_files};
use programs::has;
use rayon::prelude::*;

/// A sphere of this hardening against this opponent, pressed and sheared at mu = 0.05.
fn case(hardening: &str, opponent: &str, h: f64, shear: f64) -> Case {
    let text = format!(
        "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\nhardening = {hardening}\n\
         [contact]\nfriction = 0.05\n[mesh]\nelements_per_contact_radius = 5\nfine_zone = 1.6\n{opponent}\n\
         [[path]]\nindentation = {h:?}\n[[path]]\nshear = {shear:?}\n"
    );
    Case::parse(&text, "case.toml", &[]).expect("a case")
}

const EQUAL: &str = "[opponent]\nequal = true";
const RIGID: &str = "[opponent]\nrigid = true\nradius = 1.5";
const LARGER: &str = "[opponent]\nradius = 2.0\n[opponent.material]\nyoungs_modulus = 600e3\npoissons_ratio = 0.3\n\
                      hardening = { law = \"elastic\" }";

#[test]
fn spheres_that_slide_have_mu_in_the_frame_of_their_centres() {
    let ideal = "{ law = \"ideal\", yield_stress = 400.0 }";
    // Along the axes F_T/F_N falls by 0.4 to 0.8 mu 0.01 R/2 R, however far it is from mu.
    let all = [
        ("{ law = \"elastic\" }", EQUAL, 0.04, 0.01, 0.92),
        ("{ law = \"elastic\" }", RIGID, 0.02, 0.01, 0.93),
        ("{ law = \"elastic\" }", LARGER, 0.02, 0.01, 0.94),
        // The dent of a plastic contact turns less than the line of centres.
        (ideal, EQUAL, 0.04, 0.001, 0.996),
    ];
    all.into_par_iter().with_max_len(1).for_each(|(hardening, opponent, h, shear, most)| {
        let case = case(hardening, opponent, h, shear);
        let centres = Centres::of(&case);
        let steps = paths::follow(&case);
        let (row, _) = steps.last().expect("a step");
        let ratio = |[f_n, f_t]: [f64; 2]| f_t / (0.05 * f_n);
        let (fixed, turned) = (ratio([row.f_n, row.f_t]), ratio(centres.turned([row.h, row.delta_t], [row.f_n, row.f_t])));
        assert!((turned - 1.0).abs() < 0.01, "{opponent}: {turned}");
        assert!(fixed < most, "{opponent}: {fixed} along the axes");
    });
}

/// A program that moves two spheres of radius 1 without spin through places (h, delta_T) and prints
/// the force along the axes.
const ENGINE: &str = r#"
#include "asperity_law.h"
#include "asperity_contact3d.h"
int main(int argc, char **argv) {
    static asperity_table table;
    asperity_law3d law;
    asperity_body i, j;
    asperity_contact contact;
    asperity_forces out;
    double h, d, before[2] = {0.0, 0.0};
    if (argc != 2 || asperity_read_table(argv[1], &table) != 0) {
        return 2;
    }
    memset(&law, 0, sizeof law);
    memset(&i, 0, sizeof i);
    memset(&j, 0, sizeof j);
    memset(&contact, 0, sizeof contact);
    law.table = &table;
    law.modulus = 1.0;
    i.radius = j.radius = i.mass = j.mass = 1.0;
    while (scanf("%lf %lf", &h, &d) == 2) {
        i.position[0] = d;
        i.position[2] = 2.0 - h;
        i.velocity[0] = d - before[1];
        i.velocity[2] = before[0] - h;
        asperity_spheres(&law, &i, &j, 1.0, &contact, &contact, &out);
        printf("%.17g %.17g\n", out.force_i[2], -out.force_i[0]);
        before[0] = h;
        before[1] = d;
    }
    return 0;
}
"#;

#[test]
fn predict_is_along_the_axes_what_an_engine_has_between_two_spheres() {
    if !has("gcc", "predict_is_along_the_axes_what_an_engine_has_between_two_spheres") {
        return;
    }
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law/pairs/copper.json");
    let law = LawFile::read(&fixture).expect("a table");
    let LawFile::Table(table) = &law else { panic!("no table") };
    let case = table.deepest_case().expect("a case");
    let parameters = law.contact_parameters(&case).expect("parameters");
    // Pressed, sheared far beyond slip, pressed on, back beyond where it began, let off.
    let corners = [[0.04, 0.0], [0.04, 0.08], [0.05, 0.08], [0.05, -0.1], [0.049, -0.1], [0.045, -0.05]];
    let (mut places, mut at) = (Vec::new(), [0.0; 2]);
    for corner in corners {
        for k in 1..=800 {
            let share = f64::from(k) / 800.0;
            places.push([0, 1].map(|i| at[i] + share * (corner[i] - at[i])));
        }
        at = corner;
    }
    let ours = drive_centres(&parameters, Centres::of(&case), &places, 1);
    let dir = tempfile::tempdir().expect("a folder");
    for file in law_files(&law, Language::C, None).expect("files") {
        fs::write(dir.path().join(file.name), file.content).expect("written");
    }
    fs::write(dir.path().join("engine.c"), ENGINE).expect("written");
    let gcc = Command::new("gcc")
        .args(["-std=c99", "-O2", "-Wall", "-Werror", "engine.c", "-o", "engine", "-lm"])
        .current_dir(dir.path())
        .output()
        .expect("gcc runs");
    assert!(gcc.status.success(), "{}", String::from_utf8_lossy(&gcc.stderr));
    let mut input = String::new();
    for [h, d] in &places {
        writeln!(input, "{h:?} {d:?}").expect("text");
    }
    fs::write(dir.path().join("places"), input).expect("written");
    let run = Command::new(dir.path().join("engine"))
        .arg(dir.path().join("law.asperity"))
        .stdin(fs::File::open(dir.path().join("places")).expect("opened"))
        .output()
        .expect("it runs");
    assert!(run.status.success());
    let text = String::from_utf8(run.stdout).expect("text");
    let theirs: Vec<Vec<f64>> =
        text.lines().map(|line| line.split(' ').map(|word| word.parse().expect("a number")).collect()).collect();
    assert_eq!(theirs.len(), ours.len());
    let most = ours.iter().map(|force| force[0]).fold(0.0, f64::max);
    let mut turned: f64 = 0.0;
    for ((ours, theirs), place) in ours.iter().zip(&theirs).zip(&places) {
        // Of the two an engine takes the tangent at the end of its step.
        assert!((0..2).all(|i| (ours[i] - theirs[i]).abs() < 1e-3 * most), "{place:?}: {ours:?} {theirs:?}");
        turned = turned.max((Centres::of(&case).turned(*place, *ours)[1] - ours[1]).abs());
    }
    assert!(turned > 0.02 * most, "nothing turned: {turned}");
}
