//! Each hardening law has its name and its flow stress in every language.

use std::fmt::Write;
use std::fs;
use std::process::Command;

use asperity::case::Hardening;
use asperity::law::LawFile;
use asperity::law::export::{Language, law_files};

use super::{compile_and_run, has, made_up, text};

const YOUNGS_MODULUS: f64 = 70e3;
const STRAINS: [f64; 6] = [0.0, 1e-9, 1e-4, 0.01, 0.3, 2.0];

fn hardenings() -> Vec<Hardening> {
    vec![
        Hardening::Elastic,
        Hardening::Ideal { yield_stress: 123.4 },
        Hardening::Linear { yield_stress: 123.4, modulus: 567.8 },
        Hardening::Power { yield_stress: 123.4, coefficient: 567.8, exponent: 0.31 },
        Hardening::Hollomon { coefficient: 567.8, exponent: 4.3 },
        Hardening::Hollomon { coefficient: 9000.0, exponent: 1.2 },
        Hardening::Voce { yield_stress: 123.4, saturation_stress: 456.7, rate: 8.9 },
        Hardening::Table { points: vec![[0.0, 123.4], [0.005, 200.0], [0.1, 234.5]] },
    ]
}

/// The numbers that a program printed, against the program's own.
fn agree(printed: &str, language: &str) {
    let mut theirs = printed.split_whitespace().map(|word| word.parse::<f64>().unwrap());
    for hardening in hardenings() {
        let law = hardening.law::<f64>(YOUNGS_MODULUS).unwrap();
        for strain in STRAINS {
            let (ours, theirs) = (law.flow_stress(strain), theirs.next().unwrap());
            let close = ours == theirs || (theirs / ours - 1.0).abs() <= 1e-12;
            assert!(close, "{language}, {hardening:?} at {strain}: {theirs} and {ours}");
        }
    }
    assert_eq!(theirs.next(), None);
}

fn list(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(", ")
}

fn in_c() -> String {
    let mut text = "#include \"asperity_law.h\"\n#include <stdio.h>\nint main(void) {\n".to_owned();
    for hardening in hardenings() {
        let mut numbers = hardening.numbers();
        numbers.resize(3, 0.0);
        let points = match &hardening {
            Hardening::Table { points } => points.as_flattened(),
            _ => &[0.0, 0.0],
        };
        let name = hardening.kind().word().to_uppercase();
        let (numbers, count) = (list(&numbers), points.len() / 2);
        let _ = writeln!(text, "{{ const double points[] = {{{}}};", list(points));
        let _ =
            writeln!(text, "asperity_material m = {{{YOUNGS_MODULUS:?}, 0.3, ASPERITY_{name}, {{{numbers}}}, points, {count}}};");
        for strain in STRAINS {
            let _ = writeln!(text, "printf(\"%.17g\\n\", asperity_flow_stress(&m, {strain:?}));");
        }
        text.push_str("}\n");
    }
    text + "return 0;\n}\n"
}

fn in_python() -> String {
    let mut text = "import asperity_law as a\n".to_owned();
    for hardening in hardenings() {
        let mut numbers = hardening.numbers();
        numbers.resize(3, 0.0);
        let points = match &hardening {
            Hardening::Table { points } => points.iter().map(|point| format!("({}),", list(point))).collect(),
            _ => String::new(),
        };
        let (name, numbers) = (hardening.kind().word().to_uppercase(), list(&numbers));
        let _ = writeln!(text, "m = a.Material({YOUNGS_MODULUS:?}, 0.3, a.{name}, ({numbers}), ({points}))");
        for strain in STRAINS {
            let _ = writeln!(text, "print(repr(a.flow_stress(m, {strain:?})))");
        }
    }
    text
}

#[test]
fn every_hardening_law_has_the_programs_flow_stress() {
    let test = "every_hardening_law_has_the_programs_flow_stress";
    let law = LawFile::Formulas(Box::new(made_up()));
    let dir = tempfile::tempdir().unwrap();
    for language in [Language::C, Language::Python] {
        for file in law_files(&law, language, None).unwrap() {
            fs::write(dir.path().join(file.name), file.content).unwrap();
        }
    }
    fs::write(dir.path().join("flow_stress.c"), in_c()).unwrap();
    fs::write(dir.path().join("flow_stress.py"), in_python()).unwrap();
    for compiler in [["gcc", "-std=c99"], ["g++", "-std=c++17"]] {
        if has(compiler[0], test) {
            let run = compile_and_run(dir.path(), "flow_stress.c", &compiler, &[]);
            assert!(run.status.success(), "{}", text(&run));
            agree(&text(&run), compiler[0]);
        }
    }
    if has("python3", test) {
        let run = Command::new("python3").args(["-W", "error", "flow_stress.py"]).current_dir(dir.path()).output().unwrap();
        assert!(run.status.success(), "{}", text(&run));
        agree(&text(&run), "python3");
    }
}
