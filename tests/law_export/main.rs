//! The exported law, compiled by the compilers and run by the interpreter that users have, against
//! the vectors of the Rust update.
//!
//! A missing gcc, g++ or python3 skips its test, aloud; with `ASPERITY_REQUIRE_COMPILERS=1` that is
//! a failure.

mod headers;
mod languages;
#[path = "../common/programs.rs"]
mod programs;
mod tables;
mod update;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use asperity::case::Case;
use asperity::law::LawFile;
use asperity::law::export::{Language, engine_files, law_files};
use asperity::law::formulas::model::{FORMAT, Law, Provenance, VERSION, Validity};
use asperity::law::formulas::normal::NormalModel;
use asperity::law::formulas::shear::ShearConstants;
use asperity::law::range::Interval;
/// A made-up law.
fn made_up() -> Law {
    let interval = |from, to| Interval { from, to };
    Law {
        format: FORMAT.to_owned(),
        version: VERSION,
        constants: ShearConstants {
            fall: [1.13, 0.31, 0.47, 0.9, 1.9, 0.4],
            exponent: [1.7, 0.21, 0.83, 0.9, 0.7, 1.5],
            slip: [1.61, 0.23, 0.37, 1.11],
            curve: [0.61, 0.43, 0.77, 0.35],
        },
        normal: NormalModel::new([0.97, 0.31, 1.03, 0.12], [0.11, 0.86, 1.4, 0.5, 0.31, 0.83]),
        validity: Validity {
            lambda: interval(3.0, 800.0),
            friction: interval(0.1, 0.4),
            relative_radius: interval(0.02, 0.25),
            c_squared: interval(0.49, 0.9),
            poissons_ratio: interval(0.3, 0.3),
            hardening_exponent: interval(0.0, 0.2),
        },
        provenance: Provenance {
            program: "asperity".to_owned(),
            study: "made */ up \"\"\" \\".to_owned(),
            cases: 12,
            raw: 0,
            left_out: vec![],
            materials: 3,
            elements_per_contact_radius: (5, 6),
            folds: 3,
            seed: 1,
            prior: None,
        },
        errors: vec![],
        errors_predicted: vec![],
        candidates: vec![],
        normal_candidates: vec![],
        cases: vec![],
    }
}

/// Both that there are: a made-up law and that of the repository.
fn laws() -> [Law; 2] {
    [made_up(), fitted_law()]
}

/// What a program printed.
fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// Writes the files of a law for a language.
fn write_files(dir: &Path, law: &LawFile, language: Language, case: Option<&Case>) {
    for file in law_files(law, language, case).unwrap() {
        fs::write(dir.join(file.name), file.content).unwrap();
    }
}

/// The files for Python, of a law by formulas and a case.
fn write_module(dir: &Path, law: &Law, hardening: &str) {
    write_files(dir, &LawFile::Formulas(Box::new(law.clone())), Language::Python, Some(&case(hardening)));
}

/// Runs Python in `dir`, where warnings are errors.
fn python(dir: &Path, arguments: &[&str]) -> Output {
    Command::new("python3").args(["-W", "error"]).args(arguments).current_dir(dir).output().unwrap()
}

/// The module checks itself against the vectors.
const CHECK_MODULE: [&str; 2] = ["asperity_law.py", "asperity_law_vectors.csv"];

/// A case of a hardening law given as TOML.
fn case(hardening: &str) -> Case {
    let text = format!(
        "[sphere]\nradius = 0.5\n[material]\nyoungs_modulus = 70e3\npoissons_ratio = 0.3\n[material.hardening]\n\
         {hardening}\n[contact]\nfriction = 0.25\n[[path]]\nindentation = 0.01\n"
    );
    Case::parse(&text, "case.toml", &[]).unwrap()
}

const IDEAL: &str = "law = \"ideal\"\nyield_stress = 140.0";

const HARDENINGS: [&str; 3] =
    [IDEAL, "law = \"elastic\"", "law = \"power\"\nyield_stress = 300.0\ncoefficient = 900.0\nexponent = 0.4"];

/// The files for engines, of a law by formulas and a case.
fn write_engine_files(dir: &Path, law: &Law, hardening: &str) {
    for file in engine_files(&LawFile::Formulas(Box::new(law.clone())), Some(&case(hardening))).unwrap() {
        fs::write(dir.join(file.name), file.content).unwrap();
    }
}

/// The program that checks an export for engines.
const CHECK: &str = "asperity_contact_check.c";

/// Warnings that are errors in everything that is exported.
const WARNINGS: [&str; 6] = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-pedantic", "-Werror"];

/// Compiles and runs a checking program in `dir`.
fn compile_and_run(dir: &Path, program: &str, compiler: &[&str], arguments: &[&str]) -> Output {
    let language = if compiler[0] == "g++" { "c++" } else { "c" };
    let source = ["-o", "check", "-x", language, program, "-lm"];
    let mut command = Command::new(compiler[0]);
    let built = command.args(&compiler[1..]).args(WARNINGS).args(source).current_dir(dir).output().unwrap();
    assert!(built.status.success(), "{compiler:?}\n{}", text(&built));
    Command::new(dir.join("check")).args(arguments).current_dir(dir).output().unwrap()
}

/// The law of the repository.
fn fitted_law() -> Law {
    match LawFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law/law.json")).unwrap() {
        LawFile::Formulas(law) => *law,
        LawFile::Table(_) | LawFile::Interpolated(_) => panic!("no formulas"),
    }
}
