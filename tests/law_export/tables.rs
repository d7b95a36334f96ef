//! Tables of every hardening law and of two bodies, in every language.

use std::fs;
use std::path::Path;
use std::process::Command;

use asperity::contact_law::{Frame, POINTS};
use asperity::law::LawFile;
use asperity::law::export::{Language, law_source};
use asperity::law::range::Interval;
use asperity::law::table::{self, Level, Tabulated};

use super::programs::has;
use super::{CHECK, CHECK_MODULE, IDEAL, case, compile_and_run, python, text, write_files};

/// The table of two unlike spheres is scaled by R*, whichever of the two comes first; that of a
/// flat which deforms is a wall's.
#[test]
fn a_pair_is_scaled_by_the_effective_radius() {
    if !has("gcc", "a_pair_is_scaled_by_the_effective_radius") {
        return;
    }
    let program = r#"
#include "asperity_law.h"
#include "asperity_contact3d.h"
#include <stdlib.h>
int main(int count, char **arguments) {
    asperity_law3d law;
    asperity_body one, two;
    asperity_contact c, d;
    asperity_forces f, g;
    double scale = atof(arguments[1]), ratio = atof(arguments[2]), h = 0.004 * scale, increment[2] = {0.0, 0.0};
    asperity_state s;
    asperity_response r;
    (void)count;
    (void)asperity_pair_law(&law, &asperity_law, 3.0, 1.0);
    memset(&one, 0, sizeof one);
    memset(&c, 0, sizeof c);
    memset(&s, 0, sizeof s);
    one.radius = scale;
    one.mass = 1.0;
    two = one;
    two.radius = ratio * scale;
    d = c;
    one.position[2] = one.radius + two.radius - h;
    asperity_update(&asperity_law, scale, 3.0, &s, h, increment, &s, &r, NULL);
    asperity_spheres(&law, &one, &two, 1.0, &c, &c, &f);
    asperity_spheres(&law, &two, &one, 1.0, &d, &d, &g);
    printf("%d %.17g %.17g %.17g", asperity_law.plane, r.f_n, f.f_n, g.f_n);
    return 0;
}

"#;
    for (opponent, plane) in [("radius = 3.0", "0"), ("flat = true", "1")] {
        let law = table_against(
            "law = \"ideal\"\nyield_stress = 0.002",
            &format!(
                "[opponent]\n{opponent}\n[opponent.material]\nyoungs_modulus = 2.0\npoissons_ratio = 0.4\n\
                 [opponent.material.hardening]\nlaw = \"ideal\"\nyield_stress = 0.005"
            ),
        );
        let dir = tempfile::tempdir().unwrap();
        write_files(dir.path(), &law, Language::C, None);
        fs::write(dir.path().join("pair.c"), program).unwrap();
        for scale in ["1.0", "0.0025"] {
            let run = compile_and_run(dir.path(), "pair.c", &["gcc", "-std=c99"], &[scale, "3.0"]);
            let told = text(&run);
            let numbers: Vec<&str> = told.split_whitespace().collect();
            assert_eq!(numbers[0], plane, "{told}");
            let [bare, spheres, exchanged] = [1, 2, 3].map(|i| numbers[i].parse::<f64>().unwrap());
            assert!(bare > 0.0, "{told}");
            for force in [spheres, exchanged] {
                // A wall's table is refused between spheres: the force is no number.
                let good = if plane == "1" { force.is_nan() } else { (force - bare).abs() <= 1e-12 * bare };
                assert!(good, "{opponent} {scale}: {told}");
            }
        }
    }
}

/// A made-up table of a hardening law given as TOML.
fn table(hardening: &str) -> LawFile {
    table_against(hardening, "")
}

/// The same against an opponent, as TOML.
fn table_against(hardening: &str, opponent: &str) -> LawFile {
    let level = |i: i32| {
        let h = 1e-4 * 1.6f64.powi(i);
        let plasticity = f64::from(i) / 11.0;
        let (a0, f_n0) = ((h * (1.0 + plasticity)).sqrt(), 1.4 * h.powf(1.5) * (1.0 - 0.6 * plasticity));
        let shape = |power: f64| (1..=POINTS).map(move |j| 1.0 - (1.0 - (j as f64 / POINTS as f64).powi(2)).powf(power));
        let peak = |x: f64| 0.05 * plasticity * x * (1.0 - x);
        Level {
            yield_coefficient: None,
            h,
            f_n0,
            a0,
            slip_share: 1.0 - 0.3 * plasticity,
            delta_t_end: 0.9 * f_n0 / (1.6 * a0) * (1.0 + plasticity),
            unloading_radius: 1.1 * a0,
            k_t: 1.7 * a0,
            backbone: 1.3,
            tangential: shape(2.0 + plasticity).map(|f| f + peak(f)).collect(),
            normal: shape(3.0).collect(),
        }
    };
    let levels: Vec<Level> = (0..12).map(level).collect();
    LawFile::Table(Box::new(Tabulated {
        format: table::FORMAT.to_owned(),
        version: table::VERSION,
        body: if opponent.is_empty() {
            table::Against::Plane
        } else if opponent.contains("flat = true") {
            table::Against::Flat
        } else {
            table::Against::OtherSphere
        },
        frame: (!opponent.is_empty() && !opponent.contains("flat = true")).then_some(Frame::LineOfCentres),
        program: "a test".to_owned(),
        case: format!(
            "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 1.0\npoissons_ratio = 0.25\n[material.hardening]\n\
             {hardening}\n[contact]\nfriction = 0.4\n{opponent}\n[[path]]\nindentation = 0.01\n"
        ),
        range: Interval { from: levels[0].h, to: levels[11].h },
        elements_per_contact_radius: 8,
        levels,
        errors: Vec::new(),
    }))
}

#[test]
fn a_table_agrees_in_every_language() {
    for hardening in [
        "law = \"elastic\"",
        "law = \"hollomon\"\ncoefficient = 0.02\nexponent = 5.0",
        "law = \"voce\"\nyield_stress = 0.002\nsaturation_stress = 0.004\nrate = 10.0",
        "law = \"table\"\npoints = [[0.0, 0.002], [0.1, 0.003]]",
    ] {
        let law = table(hardening);
        for (compiler, language) in
            [(Some(["gcc", "-std=c99"]), Language::C), (Some(["g++", "-std=c++17"]), Language::C), (None, Language::Python)]
        {
            if !has(compiler.map_or("python3", |compiler| compiler[0]), "a_table_agrees_in_every_language") {
                continue;
            }
            let dir = tempfile::tempdir().unwrap();
            write_files(dir.path(), &law, language, None);
            let run = match compiler {
                Some(compiler) => compile_and_run(dir.path(), CHECK, &compiler, &["asperity_law_vectors.csv"]),
                None => python(dir.path(), &CHECK_MODULE),
            };
            assert!(run.status.success(), "{hardening}: {}", text(&run));
        }
    }
}

/// Copper on steel, made of the tables of the two by the program: exported as any table is, and
/// followed by every language.
#[test]
fn a_table_of_two_bodies_in_series_agrees_in_every_language() {
    let test = "a_table_of_two_bodies_in_series_agrees_in_every_language";
    let dir = tempfile::tempdir().unwrap();
    let tables = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/law/pairs");
    let [copper, steel] = ["copper.json", "steel.json"].map(|name| Path::new(tables).join(name));
    let pair = "opponent = { radius = 4.0, material = { youngs_modulus = 210e3, poissons_ratio = 0.28, hardening = { \
                law = \"linear\", yield_stress = 300.0, modulus = 4000.0 } } }\n\
                material = { youngs_modulus = 120e3, poissons_ratio = 0.34, hardening = { law = \"voce\", yield_stress = 60.0, \
                saturation_stress = 300.0, rate = 10.0 } }\npath = [{ indentation = 0.03 }]\n\
                [sphere]\nradius = 1.3333333333333333\n[contact]\nfriction = 0.3\n";
    fs::write(dir.path().join("pair.toml"), pair).unwrap();
    let asperity = |arguments: &[&std::ffi::OsStr]| {
        Command::new(env!("CARGO_BIN_EXE_asperity")).arg("law").args(arguments).current_dir(dir.path()).output().unwrap()
    };
    let [compose, case, out, folder, force] = ["compose", "pair.toml", "--out", "made", "--force"].map(std::ffi::OsStr::new);
    let run = asperity(&[compose, case, copper.as_ref(), steel.as_ref(), out, folder]);
    assert!(run.status.success() && text(&run).contains("against another sphere"), "{}", text(&run));
    let law = dir.path().join("made/law.json");
    let made = fs::read(&law).unwrap();
    // A table that is there may have cost minutes.
    let again = asperity(&[compose, case, copper.as_ref(), steel.as_ref(), out, folder]);
    assert!(again.status.code() == Some(2) && text(&again).contains("is there already"), "{}", text(&again));
    let wrong = asperity(&[compose, case, steel.as_ref(), copper.as_ref(), out, folder, force]);
    assert!(wrong.status.code() == Some(2) && text(&wrong).contains("of the sphere, nu = 0.34"), "{}", text(&wrong));
    assert_eq!(fs::read(&law).unwrap(), made);
    let predicted = asperity(&["predict".as_ref(), law.as_ref(), case]);
    assert!(predicted.status.success() && text(&predicted).lines().count() > 50, "{}", text(&predicted));
    for (compiler, format) in [(Some("gcc"), "c"), (None, "python")] {
        if !has(compiler.unwrap_or("python3"), test) {
            continue;
        }
        let run = asperity(&["export".as_ref(), law.as_ref(), "--format".as_ref(), format.as_ref(), out, format.as_ref()]);
        assert!(run.status.success(), "{}", text(&run));
        let files = dir.path().join(format);
        let run = match compiler {
            Some(compiler) => compile_and_run(&files, CHECK, &[compiler, "-std=c99"], &["asperity_law_vectors.csv"]),
            None => python(&files, &CHECK_MODULE),
        };
        assert!(run.status.success(), "{}", text(&run));
    }
}

#[test]
fn a_table_refuses_another_material_in_every_language() {
    let law = table("law = \"ideal\"\nyield_stress = 0.002");
    // The table's nu and mu are 0.25 and 0.4.
    for language in [Language::C, Language::Python] {
        let other = law_source(&law, language, Some(&case(IDEAL))).unwrap_err().to_string();
        assert!(other.contains("nu = 0.3, and the table is of nu = 0.25"), "{other}");
    }
}
