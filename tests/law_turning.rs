//! Twist and roll of the contact update: against simulated paths (fixtures/paths/vector), in Rust
//! and in C, its energy, and the torques of spheres.
//!
//! A missing gcc skips its part, aloud; with `ASPERITY_REQUIRE_COMPILERS=1` that is a failure.

#[path = "common/contacts.rs"]
mod contacts;
#[path = "common/programs.rs"]
mod programs;

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::process::Command;

use asperity::case::Case;
use asperity::contact_law::path::drive_turning;
use asperity::contact_law::{Centres, ContactParameters, ContactState, Turn, TurningState};
use asperity::law::LawFile;
use asperity::law::check::AIMS;
use asperity::law::export::{Language, law_files};
use contacts::{INCREMENTS, NAMES, folder, law};
use programs::has;

/// Of each kind of path: how many of nine contacts are within the aims in F_N, F_T and M_twist, at
/// least, and the greatest root mean square errors of F_N, F_T, M_twist and M_roll of any, by the
/// constants as they are fitted: to all of these paths and to others. M_twist is judged where a
/// sphere twists, M_roll where it rolls and nothing else.
const KNOWN: [(&str, usize, [f64; 4]); 4] = [
    ("impact with spin", 0, [0.02, 0.095, 0.175, 0.0]),
    ("roll forth and back, F_N held", 0, [0.055, 0.35, 0.0, 0.115]),
    ("shear, then twist", 6, [0.015, 0.09, 0.035, 0.0]),
    ("twist, then shear", 3, [0.105, 0.04, 0.095, 0.0]),
];

type Row = [f64; 12];

/// A contact with what its update reads.
fn contact(name: &str) -> (LawFile, ContactParameters, Case) {
    let (law, case) = law(name);
    let parameters = law.contact_parameters(&case).unwrap();
    (law, parameters, case)
}

/// The paths of a contact that twist or roll: places (h, delta_T along x and y, twist, roll about x
/// and y), forces and moments in that order.
fn paths(name: &str) -> BTreeMap<String, Vec<Row>> {
    let mut reader = csv::Reader::from_path(folder().join(format!("vector/{name}.csv"))).unwrap();
    let columns = reader.headers().unwrap().clone();
    let names = "h,delta_T,delta_T_y,twist,roll_x,roll_y,F_N,F_T,F_T_y,M_twist,M_roll_x,M_roll_y";
    let of: Vec<usize> = names.split(',').map(|name| columns.iter().position(|column| column == name).unwrap()).collect();
    let mut paths: BTreeMap<String, Vec<Row>> = BTreeMap::new();
    for record in reader.records() {
        let record = record.unwrap();
        paths.entry(record[0].to_owned()).or_default().push(std::array::from_fn(|i| record[of[i]].parse().unwrap()));
    }
    paths.retain(|_, rows| rows.iter().any(|row| row[3..6].iter().any(|angle| angle.abs() > 1e-12)));
    paths
}

/// Root mean square and greatest error of some columns, over their greatest size.
fn errors(rows: &[Row], law: &[[f64; 6]], columns: &[usize]) -> [f64; 2] {
    let size = |row: &Row| columns.iter().map(|&k| row[6 + k].powi(2)).sum::<f64>().sqrt();
    let peak = rows.iter().map(size).fold(0.0, f64::max);
    let off = |(row, law): (&Row, &[f64; 6])| columns.iter().map(|&k| (law[k] - row[6 + k]).powi(2)).sum::<f64>().sqrt() / peak;
    let all: Vec<f64> = rows.iter().zip(law).map(off).collect();
    [(all.iter().map(|e| e * e).sum::<f64>() / all.len() as f64).sqrt(), all.iter().copied().fold(0.0, f64::max)]
}

fn places(rows: &[Row]) -> Vec<[f64; 6]> {
    rows.iter().map(|row| std::array::from_fn(|i| row[i])).collect()
}

#[test]
fn the_law_follows_twist_and_roll() {
    let mut found: BTreeMap<String, (usize, [f64; 4])> = BTreeMap::new();
    for name in NAMES {
        let (_, parameters, case) = contact(name);
        for (path, rows) in paths(name) {
            let (law, _) = drive_turning(&parameters, Centres::of(&case), &places(&rows), INCREMENTS);
            let of = |columns: &[usize], is_judged: bool| if is_judged { errors(&rows, &law, columns) } else { [0.0; 2] };
            let rolls_alone = path.starts_with("roll");
            let all = [of(&[0], true), of(&[1, 2], true), of(&[3], !rolls_alone), of(&[4, 5], rolls_alone)];
            let within = all[..3].iter().all(|error| error[0] <= AIMS[0] && error[1] <= AIMS[1]);
            println!("{name}, {path}: {all:.3?}{}", if within { "" } else { " *" });
            let kind = found.entry(path).or_default();
            kind.0 += usize::from(within);
            (0..4).for_each(|k| kind.1[k] = kind.1[k].max(all[k][0]));
        }
    }
    assert_eq!(found.len(), KNOWN.len());
    for ((path, (within, greatest)), (known, least, most)) in found.iter().zip(KNOWN) {
        println!("{path}: {within} of 9 within, {greatest:.3?}");
        assert!(path == known && *within >= least && (0..4).all(|k| greatest[k] <= most[k]), "{path}: {within} {greatest:.4?}");
    }
}

/// A contact that never turned has the forces of the update to the last bit, and stays so.
#[test]
fn without_a_turn_nothing_changes() {
    let (_, parameters, _) = contact(NAMES[1]);
    let (mut one, mut other, turning) = (ContactState::default(), ContactState::default(), TurningState::default());
    for i in 0..400 {
        let t = f64::from(i) / 60.0;
        let (h, d) = (0.01 * t.sin().abs() + 0.002 * t, [2e-5 * (3.0 * t).cos(), 1e-5 * t.sin()]);
        let (plain, forces) = parameters.update(&one, h, d);
        let (next, still, same, moments) = parameters.update_turning((&other, &turning), h, d, Turn::default());
        assert_eq!((plain.to_numbers().map(f64::to_bits), forces), (next.to_numbers().map(f64::to_bits), same));
        assert!(still == turning && moments.m_twist == 0.0 && moments.m_roll == [0.0; 2]);
        (one, other) = (plain, next);
    }
}

/// A step that goes nowhere changes forces and moments by no more than what the sliders' exponent
/// does, which goes with the depth at the start of a step.
#[test]
fn a_step_that_goes_nowhere_changes_little() {
    let mut most = 0.0f64;
    let (_, parameters, _) = contact(NAMES[4]);
    let (mut state, mut turning) = (ContactState::default(), TurningState::default());
    for i in 1..=200 {
        let turn = Turn { twist: 2e-4, roll: [1e-4, -2e-4] };
        let h = 1e-4 * f64::from(i.min(150));
        let (next, turned, forces, moments) = parameters.update_turning((&state, &turning), h, [2e-5, 1e-5], turn);
        let (_, _, again, same) = parameters.update_turning((&next, &turned), h, [0.0; 2], Turn::default());
        let off =
            [again.f_n - forces.f_n, again.f_t[0] - forces.f_t[0], again.f_t[1] - forces.f_t[1], same.m_twist - moments.m_twist];
        let off = off.map(|off| off.abs() / forces.f_n);
        most = if i > 10 { off.into_iter().fold(most, f64::max) } else { most };
        (state, turning) = (next, turned);
    }
    println!("{most:e}");
    assert!(most < 2e-4, "{most:e}");
}

/// Numbers from -1 to 1, the same each time.
fn drawn(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// What a path has put in is never less than what is stored, and what is neither stored nor told as
/// lost is little.
#[test]
fn no_path_that_turns_gives_more_than_was_put_in() {
    for name in [NAMES[1], NAMES[5], NAMES[6]] {
        let (_, parameters, _) = contact(name);
        for seed in 0..4 {
            let (mut seed, steps) = (seed + 7, 300);
            let (mut state, mut turning) = (ContactState::default(), TurningState::default());
            let (mut at, mut work, mut moved, mut least) = ([0.0; 6], 0.0, 0.0, 0.0f64);
            let mut before = [0.0; 6];
            for leg in 0..16 {
                let h = if leg == 15 { -1e-3 } else { 0.006 + 0.014 * drawn(&mut seed).abs() };
                let reach = [0.005, 0.005, 0.06, 0.05, 0.05].map(|reach| if leg > 12 { 0.0 } else { reach * drawn(&mut seed) });
                let end = [h, reach[0], reach[1], reach[2], reach[3], reach[4]];
                let step: [f64; 6] = std::array::from_fn(|k| (end[k] - at[k]) / f64::from(steps));
                for i in 1..=steps {
                    let turn = Turn { twist: step[3], roll: [step[4], step[5]] };
                    let h = at[0] + step[0] * f64::from(i);
                    let (next, turned, f, m) = parameters.update_turning((&state, &turning), h, [step[1], step[2]], turn);
                    let after = [f.f_n, f.f_t[0], f.f_t[1], m.m_twist, m.m_roll[0], m.m_roll[1]];
                    let done: f64 = (0..6).map(|k| 0.5 * (before[k] + after[k]) * step[k]).sum();
                    (work, moved) = (work + done, moved + done.abs());
                    least = least.min(work - parameters.stored_energy(&next) - m.stored);
                    (state, turning, before) = (next, turned, after);
                }
                at = end;
            }
            assert!(work.is_finite() && work > 0.0 && least >= -1e-6 * moved, "{name}: {work} {least} {moved}");
        }
    }
}

/// Forces and moments at places, one path after the other, each headed by their number.
const IN_C: &str = r#"
#include "asperity_turning.h"
#include "asperity_contact3d.h"
int main(int argc, char **argv) {
    static asperity_table table;
    int count, i, k;
    if (argc != 2 || asperity_read_table(argv[1], &table) != 0) {
        return 2;
    }
    while (scanf("%d", &count) == 1) {
        asperity_state state;
        asperity_turning turning;
        asperity_response out;
        asperity_moments moments;
        double at[6] = {0.0}, to[6], step[6];
        memset(&state, 0, sizeof state);
        memset(&turning, 0, sizeof turning);
        for (; count > 0; count--) {
            for (i = 0; i < 6; i++) {
                if (scanf("%lf", &to[i]) != 1) {
                    return 2;
                }
                step[i] = (to[i] - at[i]) / 64;
            }
            for (k = 1; k <= 64; k++) {
                double turn[3] = {step[4], step[5], step[3]};
                asperity_update_turning(&table, 1.0, 1.0, &state, &turning, at[0] + step[0] * k, step + 1, turn,
                                        &state, &turning, &out, &moments, NULL);
            }
            printf("%.17g %.17g %.17g %.17g %.17g %.17g\n", out.f_n, out.f_t[0], out.f_t[1],
                   moments.m_twist, moments.m_roll[0], moments.m_roll[1]);
            memcpy(at, to, sizeof at);
        }
    }
    return 0;
}
"#;

/// A sphere that a weight presses on a wall, and that spins about the normal: what it had over what
/// its contact has lost and stores at the end, its spin over that at the start, and the same
/// without twist and roll, which has to spin on.
const SPINNING: &str = r#"
#include "asperity_contact3d.h"
static double run(const asperity_law3d *law, int turns, double *left) {
    asperity_body ball = {{0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.02}, 1.0, 1.0};
    asperity_wall wall = {{0.0, 0.0, 0.0}, {0.0, 0.0, 1.0}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    asperity_contact contact;
    asperity_turning turning;
    asperity_forces out;
    const double dt = 0.02, weight = 2e-4, inertia = 0.4;
    double start = 0.5 * inertia * 0.02 * 0.02, work = 0.0, end = 0.0;
    int i, k;
    memset(&contact, 0, sizeof contact);
    memset(&turning, 0, sizeof turning);
    for (i = 0; i < 60000; i++) {
        asperity_sphere_wall_turning(law, &ball, &wall, dt, &contact, &contact, turns ? &turning : NULL,
                                     turns ? &turning : NULL, &out);
        if (!(out.force_i[2] == out.force_i[2]) || out.force_i[0] != -out.force_j[0]) {
            return -1.0;
        }
        for (k = 0; k < 3; k++) {
            double force = out.force_i[k] - (k == 2 ? weight : 0.0) - 0.01 * ball.velocity[k];
            work -= 0.01 * ball.velocity[k] * ball.velocity[k] * dt + (k == 2 ? weight * ball.velocity[k] * dt : 0.0);
            ball.velocity[k] += force * dt;
            ball.position[k] += ball.velocity[k] * dt;
            ball.spin[k] += out.torque_i[k] / inertia * dt;
        }
    }
    for (k = 0; k < 3; k++) {
        end += 0.5 * inertia * ball.spin[k] * ball.spin[k] + 0.5 * ball.velocity[k] * ball.velocity[k];
    }
    *left = ball.spin[2] / 0.02;
    return (start + work - end) / (contact.plastic + contact.slip + out.stored);
}
int main(int argc, char **argv) {
    static asperity_table table;
    asperity_law3d law;
    double left, still, share;
    if (argc != 2 || asperity_read_table(argv[1], &table) != 0 || asperity_wall_law(&law, &table, 1.0, 1.0) != 0) {
        return 2;
    }
    share = run(&law, 1, &left);
    run(&law, 0, &still);
    printf("%.17g %.17g %.17g\n", share, left, still);
    return 0;
}
"#;

/// Builds a program with the exported headers of a law; what it answers to `input`.
fn in_c(law: &LawFile, source: &str, input: &str) -> String {
    let dir = tempfile::tempdir().unwrap();
    for file in law_files(law, Language::C, None).unwrap() {
        fs::write(dir.path().join(file.name), file.content).unwrap();
    }
    fs::write(dir.path().join("drive.c"), source).unwrap();
    let flags = ["-std=c99", "-O2", "-Wall", "-Wextra", "-Werror", "drive.c", "-o", "drive", "-lm"];
    let built = Command::new("gcc").args(flags).current_dir(dir.path()).output().unwrap();
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    fs::write(dir.path().join("input"), input).unwrap();
    let run = Command::new(dir.path().join("drive"))
        .arg(dir.path().join("law.asperity"))
        .stdin(fs::File::open(dir.path().join("input")).unwrap())
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    String::from_utf8(run.stdout).unwrap()
}

fn numbers(line: &str) -> Vec<f64> {
    line.split(' ').map(|word| word.parse().unwrap()).collect()
}

#[test]
fn c_takes_the_same_way() {
    if !has("gcc", "c_takes_the_same_way") {
        return;
    }
    for name in NAMES {
        let (law, parameters, case) = contact(name);
        let (mut input, mut ours) = (String::new(), Vec::new());
        for rows in paths(name).into_values() {
            writeln!(input, "{}", rows.len()).unwrap();
            for place in places(&rows) {
                writeln!(input, "{}", place.map(|x| format!("{x:?}")).join(" ")).unwrap();
            }
            ours.extend(drive_turning(&parameters, Centres::of(&case), &places(&rows), INCREMENTS).0);
        }
        let theirs = in_c(&law, IN_C, &input);
        assert_eq!(theirs.lines().count(), ours.len());
        let scale = ours.iter().map(|forces| forces[0]).fold(0.0, f64::max);
        for (ours, theirs) in ours.iter().zip(theirs.lines().map(numbers)) {
            assert!((0..6).all(|k| (ours[k] - theirs[k]).abs() < 1e-9 * scale), "{name}: {ours:?} {theirs:?}");
        }
    }
}

#[test]
fn a_spinning_sphere_stops_and_its_energy_is_accounted_for() {
    if !has("gcc", "a_spinning_sphere_stops_and_its_energy_is_accounted_for") {
        return;
    }
    for (name, left) in [(NAMES[1], 2e-3), (NAMES[4], 0.65)] {
        let found = numbers(in_c(&law(name).0, SPINNING, "").trim());
        println!("{name}: {found:?}");
        assert!((found[0] - 1.0).abs() < 1e-4, "{name}: energy {found:?}");
        assert!(found[1].abs() < left && found[2] == 1.0, "{name}: spin {found:?}");
    }
}
