//! The exported update of tables along simulated paths (fixtures/paths): in Rust, in C and in
//! Python.
//!
//! A missing gcc or python3 skips its part, aloud; with `ASPERITY_REQUIRE_COMPILERS=1` that is a
//! failure.

#[path = "common/contacts.rs"]
mod contacts;
#[path = "common/programs.rs"]
mod programs;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::case::Case;
use asperity::contact_law::path::{drive, drive_in_the_plane};
use asperity::contact_law::{Centres, ContactParameters, POINTS};
use asperity::law::LawFile;
use asperity::law::check::{AIMS, Ranges, drawn};
use asperity::law::export::{Language, law_files};
use contacts::{INCREMENTS, NAMES, folder, law};
use programs::has;

/// Paths of the 99 that are within both aims in F_T and F_N at the limit of fine meshes, at least.
const WITHIN: usize = 79;

/// Greatest root mean square error of F_T and of F_N of any path, and of F_T over all of them: what
/// they are, rounded up. They may only fall.
const GREATEST: [f64; 3] = [0.194, 0.071, 0.038];

/// One simulated path: places and forces.
type Rows = Vec<[f64; 4]>;

fn paths(name: &str) -> BTreeMap<String, Rows> {
    let mut reader = csv::Reader::from_path(folder().join(format!("{name}.csv"))).unwrap();
    let mut paths: BTreeMap<String, Rows> = BTreeMap::new();
    for record in reader.records() {
        let record = record.unwrap();
        let row = [2, 3, 4, 5].map(|i| record[i].parse::<f64>().unwrap());
        paths.entry(record[0].to_owned()).or_default().push(row);
    }
    paths
}

/// Errors of F_T and of F_N, root mean square and worst, over the path's greatest.
fn errors(rows: &Rows, law: &[[f64; 2]]) -> [[f64; 2]; 2] {
    let normal = rows.iter().map(|row| row[2]).fold(0.0, f64::max);
    [(3, 1), (2, 0)].map(|(force, component)| {
        let peak = rows.iter().map(|row| row[force].abs()).fold(0.01 * normal, f64::max);
        let of = |(row, law): (&[f64; 4], &[f64; 2])| (law[component] - row[force]).abs() / peak;
        let all: Vec<f64> = rows.iter().zip(law).map(of).collect();
        [(all.iter().map(|e| e * e).sum::<f64>() / all.len() as f64).sqrt(), all.iter().copied().fold(0.0, f64::max)]
    })
}

#[test]
fn the_update_follows_the_simulated_paths() {
    let (mut within, mut greatest, mut squares, mut report) = (0, [0.0f64; 2], Vec::new(), String::new());
    for name in NAMES {
        let (law, case) = law(name);
        let parameters = law.contact_parameters(&case).unwrap();
        let paths = paths(name);
        assert_eq!(paths.len(), 11, "{name}");
        for (path, rows) in paths {
            let places: Vec<[f64; 2]> = rows.iter().map(|row| [row[0], row[1]]).collect();
            let found = errors(&rows, &drive(&parameters, &places, INCREMENTS));
            let good = found.iter().all(|error| error[0] <= AIMS[0] && error[1] <= AIMS[1]);
            within += usize::from(good);
            squares.push(found[0][0] * found[0][0]);
            greatest = [0, 1].map(|i| greatest[i].max(found[i][0]));
            writeln!(report, "{name}, {path}: {found:.3?}{}", if good { "" } else { " *" }).unwrap();
        }
    }
    let all = (squares.iter().sum::<f64>() / squares.len() as f64).sqrt();
    println!("{report}{within} of {} within the aims; greatest {greatest:.4?}, F_T of all {all:.4}", squares.len());
    assert_eq!(squares.len(), 99);
    assert!(within >= WITHIN, "{report}{within}");
    assert!(greatest[0] <= GREATEST[0] && greatest[1] <= GREATEST[1] && all <= GREATEST[2], "{greatest:?} {all}");
}

/// Greatest error of F_T and of F_N along a first shear against the law's own curves, over mu
/// F_N_slip and F_N0, of the contacts of two seeds: what they are, rounded up.
const FIRST_SHEAR: [f64; 2] = [0.08, 0.06];

/// A first shear at constant h is that of the law: also of contacts that shear costs F_N though
/// they recover nearly all of their indentation.
#[test]
fn a_first_shear_is_that_of_the_law() {
    let (law, base) = (LawFile::built_in().unwrap(), path_of("", &[]));
    let mut report = String::new();
    let mut greatest = [0.0f64; 2];
    for (seed, number) in [1, 2].into_iter().flat_map(|seed| (0..18).map(move |number| (seed, number))) {
        let case = drawn(&base, &Ranges::default(), seed, number);
        let parameters = law.contact_parameters(&case).unwrap();
        let (h, mu) = (case.greatest_indentation(), parameters.first_loading().friction);
        let virgin = parameters.virgin(h);
        let point = &virgin.point;
        let press = (1..=20).map(|i| [h * f64::from(i) / 20.0, 0.0]);
        let shear = (1..=POINTS).map(|j| [h, point.delta_t_end * (j as f64 / POINTS as f64).powi(2)]);
        let forces = drive(&parameters, &press.chain(shear).collect::<Vec<_>>(), 16);
        let mut off = [0.0f64; 2];
        for (j, [f_n, f_t]) in forces[20..].iter().enumerate() {
            let given_t = mu * point.f_n_slip * virgin.shapes[0][j];
            let given_n = point.f_n0 - (point.f_n0 - point.f_n_slip) * virgin.shapes[1][j];
            let found = [(f_t - given_t).abs() / (mu * point.f_n_slip), (f_n - given_n).abs() / point.f_n0];
            assert!(found.iter().all(|error| error.is_finite()), "seed {seed}, number {number}: {f_n} {f_t}");
            off = [0, 1].map(|i| off[i].max(found[i]));
        }
        writeln!(report, "seed {seed}, number {number}: {off:.4?}").unwrap();
        greatest = [0, 1].map(|i| greatest[i].max(off[i]));
    }
    println!("{report}{greatest:.4?}");
    assert!(greatest[0] <= FIRST_SHEAR[0] && greatest[1] <= FIRST_SHEAR[1], "{report}{greatest:?}");
}

/// Paths in turning directions of the 36 that are within both aims, at least; the simulations, on
/// 6 elements with 12 at the surface, are 2 to 4 % off themselves (`errors.csv` beside them).
const WITHIN_TURNING: usize = 32;

/// Greatest root mean square error of F_T, as a vector, and of F_N of any of them.
const GREATEST_TURNING: [f64; 2] = [0.065, 0.036];

/// Of a contact, the paths on which nothing twists or rolls: places (h, delta_T along x and y), F_N
/// and F_T along x and y.
fn turning(name: &str) -> BTreeMap<String, Vec<[f64; 6]>> {
    let mut reader = csv::Reader::from_path(folder().join(format!("vector/{name}.csv"))).unwrap();
    let columns = reader.headers().unwrap().clone();
    let column = |name: &str| columns.iter().position(|column| column == name).unwrap();
    let angles = ["twist", "roll_x", "roll_y"].map(column);
    let numbers = ["h", "delta_T", "delta_T_y", "F_N", "F_T", "F_T_y"].map(column);
    let mut paths: BTreeMap<String, Vec<[f64; 6]>> = BTreeMap::new();
    let mut turned: Vec<String> = Vec::new();
    for record in reader.records() {
        let record = record.unwrap();
        let number = |i: usize| record[i].parse::<f64>().unwrap();
        if angles.iter().any(|&i| number(i).abs() > 1e-12) {
            turned.push(record[0].to_owned());
        }
        paths.entry(record[0].to_owned()).or_default().push(numbers.map(number));
    }
    paths.retain(|path, _| !turned.contains(path));
    paths
}

/// Root mean square and greatest of errors, over the greatest of the sizes beside them.
fn over_the_greatest(errors_and_sizes: &[[f64; 2]]) -> [f64; 2] {
    let peak = errors_and_sizes.iter().map(|one| one[1]).fold(0.0, f64::max);
    let squares: f64 = errors_and_sizes.iter().map(|one| (one[0] / peak).powi(2)).sum();
    let worst = errors_and_sizes.iter().map(|one| one[0] / peak).fold(0.0, f64::max);
    [(squares / errors_and_sizes.len() as f64).sqrt(), worst]
}

/// Errors of F_T, as a vector, and of F_N along the rows of a path: root mean square and greatest.
fn errors_in_the_plane(parameters: &ContactParameters, case: &Case, rows: &[[f64; 6]]) -> [[f64; 2]; 2] {
    let places: Vec<[f64; 3]> = rows.iter().map(|row| [row[0], row[1], row[2]]).collect();
    let (forces, _) = drive_in_the_plane(parameters, Centres::of(case), &places, INCREMENTS);
    let beside = rows.iter().zip(&forces);
    let along: Vec<[f64; 2]> =
        beside.clone().map(|(row, law)| [(law[1] - row[4]).hypot(law[2] - row[5]), row[4].hypot(row[5])]).collect();
    let normal: Vec<[f64; 2]> = beside.map(|(row, law)| [(law[0] - row[3]).abs(), row[3]]).collect();
    [over_the_greatest(&along), over_the_greatest(&normal)]
}

#[test]
fn the_update_follows_paths_in_turning_directions() {
    let (mut count, mut within, mut greatest, mut report) = (0, 0, [0.0f64; 2], String::new());
    for name in NAMES {
        let (law, case) = law(name);
        let parameters = law.contact_parameters(&case).unwrap();
        for (path, rows) in turning(name) {
            let found = errors_in_the_plane(&parameters, &case, &rows);
            let good = found.iter().all(|error| error[0] <= AIMS[0] && error[1] <= AIMS[1]);
            (count, within) = (count + 1, within + usize::from(good));
            greatest = [0, 1].map(|i| greatest[i].max(found[i][0]));
            writeln!(report, "{name}, {path}: {found:.3?}{}", if good { "" } else { " *" }).unwrap();
        }
    }
    println!("{report}{within} of {count} within the aims; greatest {greatest:.4?}");
    assert_eq!(count, 36, "{report}");
    assert!(within >= WITHIN_TURNING, "{report}{within}");
    assert!(greatest[0] <= GREATEST_TURNING[0] && greatest[1] <= GREATEST_TURNING[1], "{report}{greatest:?}");
}

/// A program that reads places, one path after the other, each headed by their number, and prints
/// F_N and F_T at them.
const IN_C: &str = r#"
#include "asperity_law.h"
#include <stdlib.h>
int main(int argc, char **argv) {
    static asperity_table table;
    int count, k;
    if (argc != 2 || asperity_read_table(argv[1], &table) != 0) {
        return 2;
    }
    while (scanf("%d", &count) == 1) {
        asperity_state state;
        asperity_response out;
        double h0 = 0.0, d0 = 0.0, h, d;
        memset(&state, 0, sizeof state);
        for (; count > 0; count--) {
            if (scanf("%lf %lf", &h, &d) != 2) {
                return 2;
            }
            for (k = 1; k <= 64; k++) {
                double increment[2] = {(d - d0) / 64, 0.0};
                asperity_update(&table, 1.0, 1.0, &state, h0 + (h - h0) * k / 64, increment, &state, &out, NULL);
            }
            printf("%.17g %.17g\n", out.f_n, out.f_t[0]);
            h0 = h;
            d0 = d;
        }
    }
    return 0;
}
"#;

/// The same.
const IN_PYTHON: &str = r"
import sys
import asperity_law as law
pair = law.setup(1.0, 1.0)
words = iter(sys.stdin.read().split())
for count in words:
    state, h0, d0 = law.State(), 0.0, 0.0
    for _ in range(int(count)):
        h, d = float(next(words)), float(next(words))
        for k in range(1, 65):
            state, out = law.update(pair, state, h0 + (h - h0) * k / 64, ((d - d0) / 64, 0.0))
        print(repr(out.f_n), repr(out.f_t[0]))
        h0, d0 = h, d
";

/// What a program answers to `input`.
fn answers(command: &mut Command, input: &Path) -> Vec<[f64; 2]> {
    let run = command.stdin(fs::File::open(input).unwrap()).output().unwrap();
    assert!(run.status.success(), "{command:?}: {}", String::from_utf8_lossy(&run.stderr));
    let text = String::from_utf8(run.stdout).unwrap();
    let line = |line: &str| {
        let mut numbers = line.split(' ').map(|word| word.parse::<f64>().unwrap());
        [numbers.next().unwrap(), numbers.next().unwrap()]
    };
    text.lines().map(line).collect()
}

#[test]
fn every_language_takes_the_same_way() {
    let test = "every_language_takes_the_same_way";
    let gcc = has("gcc", test);
    let python = gcc && has("python3", test);
    for name in [NAMES[1], NAMES[3], NAMES[8]] {
        let (law, case) = law(name);
        let parameters = law.contact_parameters(&case).unwrap();
        let dir = tempfile::tempdir().unwrap();
        for language in [Language::C, Language::Python] {
            for file in law_files(&law, language, None).unwrap() {
                fs::write(dir.path().join(file.name), file.content).unwrap();
            }
        }
        let (mut input, mut ours) = (String::new(), Vec::new());
        for rows in paths(name).into_values() {
            let places: Vec<[f64; 2]> = rows.iter().map(|row| [row[0], row[1]]).collect();
            writeln!(input, "{}", places.len()).unwrap();
            for [h, d] in &places {
                writeln!(input, "{h:?} {d:?}").unwrap();
            }
            ours.extend(drive(&parameters, &places, INCREMENTS));
        }
        let places = dir.path().join("places");
        fs::write(&places, input).unwrap();
        let mut theirs = Vec::new();
        if gcc {
            fs::write(dir.path().join("drive.c"), IN_C).unwrap();
            let built = Command::new("gcc")
                .args(["-std=c99", "-O2", "-Wall", "-Werror", "drive.c", "-o", "drive", "-lm"])
                .current_dir(dir.path())
                .output()
                .unwrap();
            assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
            theirs.push(answers(Command::new(dir.path().join("drive")).arg(dir.path().join("law.asperity")), &places));
        }
        if python {
            fs::write(dir.path().join("drive.py"), IN_PYTHON).unwrap();
            theirs.push(answers(Command::new("python3").arg(dir.path().join("drive.py")), &places));
        }
        let scale = ours.iter().map(|force| force[0]).fold(0.0, f64::max);
        for theirs in theirs {
            assert_eq!(theirs.len(), ours.len());
            for (ours, theirs) in ours.iter().zip(&theirs) {
                assert!((0..2).all(|i| (ours[i] - theirs[i]).abs() < 1e-9 * scale), "{name}: {ours:?} {theirs:?}");
            }
        }
    }
}

/// A case over a plane or an equal sphere, with these segments after its press.
fn path_of(opponent: &str, segments: &[&str]) -> Case {
    let segments: String = segments.iter().map(|segment| format!("[[path]]\n{segment}\n")).collect();
    let text = format!(
        "[sphere]\nradius = 2.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\n\
         law = \"ideal\"\nyield_stress = 400.0\n[contact]\nfriction = 0.3\n{opponent}[[path]]\nindentation = 0.04\n{segments}"
    );
    Case::parse(&text, "case.toml", &[]).expect("a case")
}

/// Along a path in another direction a law says what it says along x, turned; of the plane and of
/// two spheres, F_N held and not, to full slip and back, and after a release.
#[test]
fn a_law_follows_a_path_in_any_direction() {
    let law = LawFile::built_in().expect("the built-in law");
    let (cos, sin) = (28.0 / 53.0, 45.0 / 53.0);
    let degrees = f64::atan2(sin, cos).to_degrees();
    let held = "\nhold = \"normal-force\"";
    for opponent in ["", "[opponent]\nequal = true\n"] {
        let to = |d: f64, hold: &str| [format!("shear = {d:?}{hold}"), format!("shear = [{:?}, {:?}]{hold}", d * cos, d * sin)];
        let both = [
            to(0.002, ""),
            to(-0.001, held),
            ["release = 0.5".to_owned(), "release = 0.5".to_owned()],
            [
                "indentation = 0.05\nshear = 0.002".to_owned(),
                format!("indentation = 0.05\nshear = [{:?}, {:?}]", 0.002 * cos, 0.002 * sin),
            ],
            ["shear = \"full-slip\"".to_owned(), format!("shear = \"full-slip\"\nshear_direction = {degrees:?}")],
            ["release = true".to_owned(), "release = true".to_owned()],
        ];
        let follow = |k: usize| {
            let segments: Vec<&str> = both.iter().map(|pair| pair[k].as_str()).collect();
            law.follow(&path_of(opponent, &segments)).expect("a prediction").0
        };
        let (along, turned) = (follow(0), follow(1));
        let greatest = along.iter().fold(0.0, |most: f64, point| most.max(point.f_n));
        let slides = along.iter().fold(0.0, |most: f64, point| most.max(point.f_t));
        assert!(slides > 0.2 * greatest && along.last().is_some_and(|point| point.f_n.abs() < 1e-9 * greatest));
        assert_eq!(along.len(), turned.len(), "{opponent}");
        for (a, b) in along.iter().zip(&turned) {
            let way = [b.delta_t * cos + b.delta_t_y * sin, b.delta_t_y * cos - b.delta_t * sin];
            let force = [b.f_t * cos + b.f_t_y * sin, b.f_t_y * cos - b.f_t * sin];
            assert!((way[0] - a.delta_t).abs() < 1e-12 && way[1].abs() < 1e-12, "{a:?} {b:?}");
            let off = [b.f_n - a.f_n, force[0] - a.f_t, force[1]].map(|x| x.abs() / greatest);
            assert!(off.iter().all(|off| *off < 1e-4), "{opponent}: {off:?} {a:?} {b:?}");
            assert_eq!((a.segment, a.f_t_y), (b.segment, 0.0));
        }
    }
}

/// A path that turns a corner: F_T follows the displacement, and where all slips it is mu F_N along
/// the way. A sphere that twists has a moment about the normal, one that rolls about its axis.
#[test]
fn a_law_turns_corners_twists_and_rolls() {
    let law = LawFile::built_in().expect("the built-in law");
    let case = path_of("", &["shear = [0.01, 0.0]", "shear = \"full-slip\"\nshear_direction = 90.0"]);
    let (points, _) = law.follow(&case).expect("a prediction");
    let end = points.last().expect("points");
    assert!(end.slips && end.delta_t == 0.01 && end.delta_t_y > 0.0);
    assert!((end.f_t_y / (0.3 * end.f_n) - 1.0).abs() < 0.01 && end.f_t.abs() < 0.1 * end.f_t_y, "{end:?}");
    for (segment, about) in [("twist = 0.1", 0), ("roll = 0.1", 2), ("shear = [0.01, 0.0]\nroll = [0.1, 0.0]", 1)] {
        let (points, _) = law.follow(&path_of("", &[segment])).expect(segment);
        let end = points.last().expect("points");
        assert!(end.turned[about] == 0.1 && end.moments[about] > 0.02 * end.f_n, "{segment}: {end:?}");
        assert!((0..3).all(|k| end.moments[k] <= end.moments[about]), "{segment}: {end:?}");
    }
}
