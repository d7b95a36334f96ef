//! C and Python alike: what a wrong constant does, what is no number, what the command writes.

use std::fs;
use std::process::Command;

use asperity::law::LawFile;
use asperity::law::export::{Language, law_files, law_source};

use super::programs::has;
use super::{CHECK, CHECK_MODULE, IDEAL, case, compile_and_run, laws, python, text, write_engine_files, write_module};

#[test]
fn a_wrong_constant_is_found() {
    let law = &laws()[1];
    let mut wrong = law.clone();
    wrong.constants.slip[1] *= 1.0 + 1e-7;
    let dir = tempfile::tempdir().unwrap();
    if has("gcc", "a_wrong_constant_is_found") {
        write_engine_files(dir.path(), law, IDEAL);
        let wrong = LawFile::Formulas(Box::new(wrong.clone()));
        fs::write(dir.path().join("asperity_law.h"), law_source(&wrong, Language::C, Some(&case(IDEAL))).unwrap()).unwrap();
        let run = compile_and_run(dir.path(), CHECK, &["gcc", "-std=c99"], &["asperity_law_vectors.csv"]);
        assert_eq!(run.status.code(), Some(1), "{}", text(&run));
    }
    if has("python3", "a_wrong_constant_is_found") {
        write_module(dir.path(), law, IDEAL);
        let wrong = LawFile::Formulas(Box::new(wrong));
        fs::write(dir.path().join("asperity_law.py"), law_source(&wrong, Language::Python, Some(&case(IDEAL))).unwrap()).unwrap();
        let run = python(dir.path(), &CHECK_MODULE);
        assert_eq!(run.status.code(), Some(1), "{}", text(&run));
    }
}

#[test]
fn the_module_agrees_and_says_what_it_lacks() {
    let test = "the_module_agrees_and_says_what_it_lacks";
    if !has("python3", test) || !has("gcc", test) {
        return;
    }
    for law in laws() {
        let dir = tempfile::tempdir().unwrap();
        write_module(dir.path(), &law, IDEAL);
        let python = |arguments: &[&str], compiler: &str| {
            Command::new("python3")
                .args(["-W", "error"])
                .args(arguments)
                .env("CC", compiler)
                .current_dir(dir.path())
                .output()
                .unwrap()
        };
        let run = python(&CHECK_MODULE, "gcc");
        assert!(run.status.success(), "{}: {}", law.provenance.study, text(&run));
        let missing = python(&["-c", "import asperity_law"], "no-such-compiler");
        assert!(text(&missing).contains("needs a C compiler: there is no no-such-compiler"), "{}", text(&missing));
        let failing = python(&["-c", "import asperity_law"], "gcc -no-such-flag");
        assert!(text(&failing).contains("asperity_law: gcc failed"), "{}", text(&failing));
        let beyond = "import asperity_law as a\np = a.setup(70e3, 2.0)\ns = a.State()\nfor h in (0.01, 0.9):\n    \
                      s, _ = a.update(p, s, h, (0.0, 0.0))\n    print(a.out_of_range(s))\n\
                      try:\n    a.setup(0.0, 1.0)\nexcept ValueError as error:\n    print(error)";
        let run = python(&["-c", beyond], "gcc");
        assert!(text(&run).ends_with("True\ngive E > 0 and R > 0\n"), "{}", text(&run));
    }
}

#[test]
fn the_command_writes_what_the_library_makes() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("law.json");
    let law = &laws()[0];
    law.write(&path).unwrap();
    let asperity = |arguments: &[&str]| {
        let path = path.to_str().unwrap();
        Command::new(env!("CARGO_BIN_EXE_asperity"))
            .args(["law", "export", path])
            .args(arguments)
            .current_dir(dir.path())
            .output()
            .unwrap()
    };
    let case_file = "[sphere]\nradius = 0.5\n[material]\nyoungs_modulus = 70e3\npoissons_ratio = 0.3\n\
                     [material.hardening]\nlaw = \"ideal\"\nyield_stress = 140.0\n[contact]\nfriction = 0.25\n[[path]]\nindentation = 0.01\n";
    fs::write(dir.path().join("case.toml"), case_file).unwrap();
    let either = LawFile::Formulas(Box::new(law.clone()));
    for (arguments, language) in
        [(&["case.toml", "--format", "c"][..], Language::C), (&["case.toml", "--format", "python"], Language::Python)]
    {
        let case = Some(case(IDEAL));
        let printed = asperity(arguments);
        let said = String::from_utf8_lossy(&printed.stderr).into_owned();
        // The made-up law is not made for the depth of the case, and says so.
        let good = said.starts_with("warning: case.toml lies outside");
        assert!(printed.status.success() && good, "{said}");
        let source = String::from_utf8(printed.stdout).unwrap();
        assert_eq!(source, law_source(&either, language, case.as_ref()).unwrap());
        let written = asperity(&[arguments, &["--out", "for/dem"]].concat());
        assert!(written.status.success(), "{}", text(&written));
        for file in law_files(&either, language, case.as_ref()).unwrap() {
            assert_eq!(fs::read_to_string(dir.path().join("for/dem").join(file.name)).unwrap(), file.content);
        }
    }
    let all = asperity(&["--format", "python"]);
    assert!(all.status.code() == Some(2) && text(&all).contains("Name a case after it"), "{}", text(&all));
    for wrong in [&["--format", "fortran"][..], &[]] {
        assert_eq!(asperity(wrong).status.code(), Some(2));
    }
    fs::write(&path, "{}").unwrap();
    let refused = asperity(&["--format", "c"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(refused.stdout.is_empty() && text(&refused).contains("law.json"), "{}", text(&refused));
}

/// Beside the vectors, which are all finite: what is no number gives none and leaves the contact as
/// it was, also where the compiler was told that every number is one; an increment beyond all
/// bounds is full slip.
const HOSTILE_C: &str = r#"
#include "asperity_law.h"
#include <stdio.h>
#include <stdlib.h>
static int same(double a, double b) { return fabs(a - b) <= 1e-6 * fabs(b); }
int main(int argc, char **argv) {
    const asperity_table *t = &asperity_law;
    asperity_state state, next;
    asperity_response good, out, far;
    asperity_tangent tangent;
    double still[2] = {0.0, 0.0}, slip[2] = {3.0, 4.0}, huge[2], bad = strtod(argc > 1 ? argv[1] : "nan", NULL);
    int i;
    memset(&state, 0, sizeof state);
    for (i = 1; i <= 20; i++) asperity_update(t, 1.0, 70e3, &state, 0.001 * i, still, &state, &good, NULL);
    asperity_update(t, 1.0, 70e3, &state, bad, still, &next, &out, &tangent);
    if (asperity_is_finite(out.f_n) || asperity_is_finite(tangent.a) || memcmp(&state, &next, sizeof state) != 0) return 3;
    slip[0] = bad;
    asperity_update(t, 1.0, 70e3, &state, 0.02, slip, &next, &out, NULL);
    if (asperity_is_finite(out.f_t[0]) || memcmp(&state, &next, sizeof state) != 0) return 4;
    asperity_update(t, 1.0, 70e3, &next, 0.02, still, &next, &out, NULL);
    if (!same(out.f_n, good.f_n)) return 5;
    slip[0] = 3.0;
    asperity_update(t, 1.0, 70e3, &state, 0.02, slip, &next, &far, NULL);
    huge[0] = 0.6e200;
    huge[1] = 0.8e200;
    asperity_update(t, 1.0, 70e3, &state, 0.02, huge, &next, &out, NULL);
    if (!same(out.f_t[0], far.f_t[0]) || !same(out.f_t[1], far.f_t[1])) return 6;
    if (!same(hypot(out.f_t[0], out.f_t[1]), t->friction * out.f_n)) return 6;
    printf("%g %g\n", good.f_n, out.f_t[1]);
    return 0;
}
"#;

#[test]
fn no_number_in_gives_no_number_out() {
    let dir = tempfile::tempdir().unwrap();
    if has("gcc", "no_number_in_gives_no_number_out") {
        write_engine_files(dir.path(), &laws()[0], IDEAL);
        fs::write(dir.path().join("hostile.c"), HOSTILE_C).unwrap();
        for flags in [&["-O0"][..], &["-O3"], &["-O3", "-ffast-math"]] {
            let all = [&["-std=c99", "-Wall", "-Wextra", "-Werror", "-o", "hostile", "hostile.c", "-lm"][..], flags].concat();
            let built = Command::new("gcc").args(all).current_dir(dir.path()).output().unwrap();
            assert!(built.status.success(), "{}", text(&built));
            for value in ["nan", "inf", "-inf"] {
                let run = Command::new(dir.path().join("hostile")).arg(value).output().unwrap();
                assert!(run.status.success(), "{flags:?} {value}: {:?} {}", run.status, text(&run));
            }
        }
    }
    if has("python3", "no_number_in_gives_no_number_out") {
        write_module(dir.path(), &laws()[0], IDEAL);
        let program = "import math, asperity_law as a\n\
            p = a.setup(70e3, 1.0)\n\
            s = a.State()\n\
            for i in range(1, 21): s, good = a.update(p, s, 0.001 * i, (0.0, 0.0))\n\
            for h, d in ((math.nan, (0.0, 0.0)), (math.inf, (0.0, 0.0)), (0.02, (math.nan, 0.0)), (0.02, (0.0, -math.inf))):\n\
            \x20   n, out = a.update(p, s, h, d)\n\
            \x20   assert math.isnan(out.f_n) and math.isnan(out.f_t[0]) and n.to_bytes() == s.to_bytes()\n\
            far, out = a.update(p, s, 0.02, (3.0, 4.0))[1], a.update(p, s, 0.02, (0.6e200, 0.8e200))[1]\n\
            assert abs(out.f_t[1] / far.f_t[1] - 1) < 1e-8 and abs(math.hypot(*out.f_t) / (0.25 * out.f_n) - 1) < 1e-6\n";
        let run = python(dir.path(), &["-c", program]);
        assert!(run.status.success(), "{}", text(&run));
    }
}
