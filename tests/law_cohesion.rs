//! Cohesion of the contact update: the C header takes the way of the Rust update, and the forces
//! that two spheres and a sphere and a wall have in three dimensions.
//!
//! A missing gcc skips its part, aloud; with `ASPERITY_REQUIRE_COMPILERS=1` that is a failure.

#[path = "common/contacts.rs"]
mod contacts;
#[path = "common/programs.rs"]
mod programs;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::contact_law::{CohesionState, ContactState};
use asperity::law::LawFile;
use asperity::law::export::{Language, law_files};
use contacts::{INCREMENTS, NAMES, law};
use programs::has;

/// Legs of a walk.
const LEGS: usize = 8;

/// Numbers from -1 to 1, the same each time.
fn drawn(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// R, E, w and the range, then the steps of a contact: h and two increments.
const IN_C: &str = r#"
#include "asperity_cohesion.h"
int main(int argc, char **argv) {
    static asperity_table table;
    double radius, modulus, w, range, at[3];
    int count;
    if (argc != 2 || asperity_read_table(argv[1], &table) != 0) {
        return 2;
    }
    while (scanf("%d %lf %lf %lf %lf", &count, &radius, &modulus, &w, &range) == 5) {
        asperity_cohesive cohesion;
        asperity_state state, next;
        asperity_cohesion memory;
        asperity_response out;
        asperity_attraction pull;
        asperity_real r = (asperity_real)radius, e = (asperity_real)modulus;
        if (asperity_make_cohesion(&cohesion, &table, (asperity_real)-1.0, 0) != 1 ||
            asperity_make_cohesion(&cohesion, &table, (asperity_real)w, (asperity_real)range) != 0) {
            return 2;
        }
        memset(&state, 0, sizeof state);
        memset(&memory, 0, sizeof memory);
        printf("%.17g 0 0 0 0 0\n", (double)asperity_greatest_gap(&cohesion, &table, r, e));
        for (; count > 0; count--) {
            asperity_real d[2];
            if (scanf("%lf %lf %lf", &at[0], &at[1], &at[2]) != 3) {
                return 2;
            }
            d[0] = (asperity_real)at[1];
            d[1] = (asperity_real)at[2];
            asperity_update(&table, r, e, &state, (asperity_real)at[0], d, &next, &out, NULL);
            asperity_cohere(&cohesion, &table, r, e, &state, &next, &memory, d, &memory, &pull);
            state = next;
            printf("%.17g %.17g %.17g %.17g %.17g %.17g\n", (double)pull.f_n, (double)pull.f_t[0], (double)pull.f_t[1],
                   (double)pull.stored, (double)pull.lost, (double)pull.slip);
        }
    }
    return 0;
}
"#;

/// Builds a program with the exported headers of a law; what it answers to `input`.
fn in_c(law: &LawFile, source: &str, compiler: &[&str], input: &str) -> Vec<Vec<f64>> {
    let dir = tempfile::tempdir().unwrap();
    for file in law_files(law, Language::C, None).unwrap() {
        fs::write(dir.path().join(file.name), file.content).unwrap();
    }
    build_and_run(dir.path(), source, compiler, input)
}

fn build_and_run(dir: &Path, source: &str, compiler: &[&str], input: &str) -> Vec<Vec<f64>> {
    fs::write(dir.join("drive.c"), source).unwrap();
    let language = if compiler[0] == "g++" { "c++" } else { "c" };
    let warnings = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-pedantic", "-Werror"];
    let mut command = Command::new(compiler[0]);
    let built = command.args(&compiler[1..]).args(warnings).args(["-x", language, "drive.c", "-o", "drive", "-lm"]);
    let built = built.current_dir(dir).output().unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    fs::write(dir.join("input"), input).unwrap();
    let mut run = Command::new(dir.join("drive"));
    let run = run.arg(dir.join("law.asperity")).stdin(fs::File::open(dir.join("input")).unwrap()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let text = String::from_utf8(run.stdout).unwrap();
    text.lines().map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect()
}

/// The walks of one contact: those of each w and range begin with R, E, w, the range.
fn walks(name: &str) -> (LawFile, String, Vec<[f64; 6]>) {
    let (law, case) = law(name);
    let parameters = law.contact_parameters(&case).unwrap();
    let (radius, modulus) = (case.sphere.radius, case.material.youngs_modulus);
    let (mut input, mut ours, mut seed) = (String::new(), Vec::new(), 3);
    for (w, range) in [(1e-8, 0.0), (1e-6, 0.0), (1e-4, 0.0), (1e-2, 0.0), (1e-6, 1e-3), (1e-4, 1e-2), (0.0, 0.0)] {
        let (w, range) = (w * modulus * radius, range * radius);
        let cohesion = parameters.cohesion(w, range);
        let gap = parameters.greatest_gap(&cohesion);
        ours.push([gap, 0.0, 0.0, 0.0, 0.0, 0.0]);
        writeln!(input, "{} {radius:?} {modulus:?} {w:?} {range:?}", LEGS * INCREMENTS).unwrap();
        let (mut state, mut memory) = (ContactState::default(), CohesionState::default());
        for leg in 0..LEGS {
            let v = parameters.virgin(state.h_max.max(1e-5 * radius));
            let to = match leg {
                0 | 4 => 0.02 * radius * (1.2 + drawn(&mut seed)) / 2.2,
                3 | 7 => -1.2 * gap.max(1e-6 * radius),
                _ => state.h + (v.depth + gap) * (drawn(&mut seed) - 0.3),
            };
            let d = [0, 1].map(|_| v.point.delta_t_end * drawn(&mut seed) / INCREMENTS as f64);
            let from = state.h;
            for k in 1..=INCREMENTS {
                let h = from + (to - from) * k as f64 / INCREMENTS as f64;
                let (next, _) = parameters.update(&state, h, d);
                let (after, pull) = parameters.cohere(&cohesion, (&state, &next), &memory, d);
                (state, memory) = (next, after);
                writeln!(input, "{h:?} {:?} {:?}", d[0], d[1]).unwrap();
                ours.push([pull.f_n, pull.f_t[0], pull.f_t[1], pull.stored, pull.lost, pull.slip]);
            }
        }
    }
    (law, input, ours)
}

#[test]
fn c_takes_the_same_way() {
    if !has("gcc", "c_takes_the_same_way") || !has("g++", "c_takes_the_same_way") {
        return;
    }
    for name in [NAMES[1], NAMES[3], NAMES[8]] {
        let (law, input, ours) = walks(name);
        let exact: &[&[&str]] = &[&["gcc", "-std=c99", "-O2"], &["g++", "-std=c++17", "-O2"]];
        for (compiler, aim) in exact.iter().map(|compiler| (*compiler, 1e-9)).chain([(&["gcc", "-DASPERITY_SINGLE"][..], 5e-3)]) {
            let theirs = in_c(&law, IN_C, compiler, &input);
            assert_eq!(theirs.len(), ours.len());
            let mut worst = 0.0_f64;
            for (ours, theirs) in ours.chunks(LEGS * INCREMENTS + 1).zip(theirs.chunks(LEGS * INCREMENTS + 1)) {
                assert!(
                    (theirs[0][0] - ours[0][0]).abs() <= aim * ours[0][0],
                    "{name} {compiler:?}: gap {:?} {:?}",
                    theirs[0],
                    ours[0]
                );
                // Forces by the greatest force of a walk, energies by the greatest energy.
                let size = |columns: std::ops::Range<usize>| {
                    let all = ours[1..].iter().flat_map(|row| row[columns.clone()].iter().map(|x| x.abs()));
                    all.fold(f64::MIN_POSITIVE, f64::max)
                };
                let sizes = [size(0..3), size(0..3), size(0..3), size(3..6), size(3..6), size(3..6)];
                for (k, (ours, theirs)) in ours[1..].iter().zip(&theirs[1..]).enumerate() {
                    for i in 0..6 {
                        let off = (ours[i] - theirs[i]).abs() / sizes[i];
                        assert!(off <= aim, "{name} {compiler:?}, step {k}: {ours:?} {theirs:?}");
                        worst = if off > worst { off } else { worst };
                    }
                }
            }
            println!("{name} {compiler:?}: {worst:.1e}");
        }
    }
}

/// A sphere on a wall, then on another sphere, pulled off after a light touch: the greatest pull
/// over pi w R*, what is stored at the end, what the energy balance lacks, whether it still holds.
const PULLED: &str = r#"
#include "asperity_contact3d.h"
int main(int argc, char **argv) {
    static asperity_table table;
    asperity_law3d law;
    asperity_body i = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 2.0, 1.0}, j = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, 1.0, 1.0};
    asperity_wall wall = {{0, 0, 0}, {0, 0, 1}, {0, 0, 0}, {0, 0, 0}};
    asperity_contact c;
    asperity_cohesion memory;
    asperity_forces out;
    const double w = 1e-9, effective = 2.0 / 3.0;
    double least = 0.0, stored = 0.0, work = 0.0, before = 0.0, lost = 0.0, gap;
    int k, pair;
    if (argc != 2 || asperity_read_table(argv[1], &table) != 0) {
        return 2;
    }
    for (pair = 0; pair < 2; pair++) {
        if (pair) {
            asperity_stand_in(&table);
        }
        if ((pair ? asperity_pair_law(&law, &table, 1.0, 1.0) : asperity_wall_law(&law, &table, 1.0, 1.0)) != 0 ||
            asperity_law_cohesion(&law, -w, 0.0) != 1 || asperity_law_cohesion(&law, w, 0.0) != 0) {
            return 2;
        }
        gap = asperity_holding_gap(&law, i.radius, pair ? j.radius : 0.0);
        memset(&c, 0, sizeof c);
        memset(&memory, 0, sizeof memory);
        least = work = before = lost = 0.0;
        for (k = 0; k <= 4000; k++) {
            double h = gap * (k < 1000 ? k * 2e-3 - 1.0 : 1.0 - (k - 1000) * 1e-3);
            i.position[2] = (pair ? i.radius + j.radius : i.radius) - h;
            if (pair) {
                asperity_spheres_cohesive(&law, &i, &j, 0.0, &c, &c, NULL, NULL, &memory, &memory, &out);
            } else {
                asperity_sphere_wall_cohesive(&law, &i, &wall, 0.0, &c, &c, NULL, NULL, &memory, &memory, &out);
            }
            work += k ? 0.5 * (before + out.f_n) * gap * (k <= 1000 ? 2e-3 : -1e-3) : 0.0;
            lost += out.parted;
            before = out.f_n;
            least = out.f_n < least ? out.f_n : least;
            if ((out.flags & ASPERITY_HOLDS) != 0 && asperity_may_forget_cohesive(&c, &memory)) {
                return 3;
            }
        }
        stored = out.stored;
        least /= 3.141592653589793 * w * (pair ? effective : i.radius);
        printf("%.17g %.17g %.17g %.17g\n", least, stored, (work - lost) / work, memory.joined);
    }
    return 0;
}
"#;

#[test]
fn spheres_and_walls_are_pulled_off_at_one_and_a_half_pi_w_r() {
    if !has("gcc", "spheres_and_walls_are_pulled_off_at_one_and_a_half_pi_w_r") {
        return;
    }
    let found = in_c(&law(NAMES[1]).0, PULLED, &["gcc", "-std=c99"], "");
    for row in &found {
        println!("{row:?}");
        assert!((row[0] / -1.5 - 1.0).abs() < 0.01, "{row:?}");
        assert!(row[1] == 0.0 && row[2].abs() < 0.01 && row[3] == 0.0, "{row:?}");
    }
    assert_eq!(found.len(), 2);
}
