//! What an engine starts from, as the program writes it: it compiles, runs and warns; tables are
//! read whatever the locale is, and states that no contact has are refused by every language.
//!
//! A missing gcc, python3 or localedef skips its test, aloud; with `ASPERITY_REQUIRE_COMPILERS=1` a
//! missing compiler is a failure.

#[path = "common/programs.rs"]
mod programs;

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use asperity::case::Case;
use asperity::contact_law::ContactState;
use asperity::law::LawFile;
use asperity::law::export::{Language, law_files};
use programs::has;

const WARNINGS: [&str; 6] = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-pedantic", "-Werror"];

fn fixture(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// `asperity law export LAW` with more arguments, of which the first is the case.
fn export(law: &str, case: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_asperity")).args(["law", "export", law]).arg(case).args(arguments).output().unwrap()
}

/// Compiles a C program in a directory with these flags and runs it there.
fn compile_and_run(dir: &Path, program: &str, flags: &[&str], environment: &[(&str, &Path)]) -> Output {
    let built = Command::new("gcc")
        .args(["-std=c99", "-O2"])
        .args(flags)
        .args(WARNINGS)
        .args(["-o", "program", program, "-lm"])
        .current_dir(dir)
        .output()
        .unwrap();
    assert!(built.status.success(), "{}", text(&built));
    Command::new(dir.join("program")).envs(environment.iter().copied()).current_dir(dir).output().unwrap()
}

/// The numbers behind a word, one a line that has it.
fn numbers_after(output: &str, word: &str) -> Vec<f64> {
    let number = |line: &str| {
        let rest = line.split_once(word)?.1.trim_start();
        rest.split([' ', ',', ';']).next()?.parse().ok()
    };
    output.lines().filter_map(number).collect()
}

#[test]
fn a_program_in_c_collides_spheres_of_all_materials() {
    let test = "a_program_in_c_collides_spheres_of_all_materials";
    let voce = fixture("cases/voce.toml");
    let voce = voce.to_str().unwrap();
    for (with, contacts) in [(&[][..], 2), (&["--with", voce][..], 5)] {
        let dir = tempfile::tempdir().unwrap();
        let out = dir.path().to_str().unwrap();
        let written = export("built-in", &fixture("cases/equal.toml"), &[&["--for", "c", "--out", out], with].concat());
        assert!(written.status.success() && written.stderr.is_empty(), "{}", text(&written));
        assert!(text(&written).contains("cc -std=c99 -O2 main.c"), "{}", text(&written));
        if !has("gcc", test) {
            continue;
        }
        let run = compile_and_run(dir.path(), "main.c", &[], &[]);
        let told = text(&run);
        assert!(run.status.success(), "{told}");
        let restitution = numbers_after(&told, "restitution ");
        assert!(restitution.len() == contacts && restitution.iter().all(|e| (0.05..0.95).contains(e)), "{told}");
        println!("{told}");
    }
}

#[test]
fn an_input_for_lammps_names_all_its_tables() {
    let dir = tempfile::tempdir().unwrap();
    let soft = dir.path().join("soft one.toml");
    let voce = fs::read_to_string(fixture("cases/voce.toml")).unwrap();
    let voce = voce.replace("friction = 0.3", "friction = 0.12").replace("radius = 1.0", "radius = 0.5");
    fs::write(&soft, voce.replace("indentation = 0.02", "indentation = 0.01")).unwrap();
    let out = dir.path().join("out");
    let written = export(
        "built-in",
        &fixture("cases/equal.toml"),
        &["--for", "lammps", "--with", soft.to_str().unwrap(), "--out", out.to_str().unwrap()],
    );
    assert!(written.status.success() && written.stderr.is_empty(), "{}", text(&written));
    let input = fs::read_to_string(out.join("in.asperity")).unwrap();
    for line in [
        "pair_coeff 1 1 equal.asperity 200000.0 restitution ${restitution}",
        "pair_coeff 1 2 equal-soft_one.asperity 200000.0 restitution ${restitution}",
        "pair_coeff 2 2 soft_one.asperity 200000.0 restitution ${restitution}",
        "type 1 equal-wall.asperity 200000.0 restitution ${restitution}",
        "type 2 soft_one-wall.asperity 200000.0 restitution ${restitution}",
        "create_box 2 box",
        "variable R index 1.0",
    ] {
        assert!(input.contains(line), "{line}\n{input}");
    }
    assert!(!input.contains('@'), "{input}");
    let number = |file: &str, name: &str| numbers_after(&fs::read_to_string(out.join(file)).unwrap(), &format!("{name} "))[0];
    // Each surface as deep as in its case: 0.02 of an equal pair's 0.04, and 0.01.
    for (file, deepest, friction) in [
        ("equal.asperity", 0.04, 0.3),
        ("equal-wall.asperity", 0.02, 0.3),
        ("soft_one.asperity", 0.04, 0.12),
        ("soft_one-wall.asperity", 0.02, 0.12),
        ("equal-soft_one.asperity", 0.03, (0.3f64 * 0.12).sqrt()),
    ] {
        assert!((number(file, "friction") - friction).abs() < 1e-12, "{file}");
        assert!((number(file, "deepest") / deepest - 1.0).abs() < 1e-6, "{file}: {}", number(file, "deepest"));
    }
}

#[test]
fn what_the_law_was_not_made_for_is_said_and_written() {
    let dir = tempfile::tempdir().unwrap();
    let case = dir.path().join("rough.toml");
    let ideal = fs::read_to_string(fixture("cases/ideal.toml")).unwrap();
    fs::write(&case, ideal.replace("friction = 0.3", "friction = 1.4")).unwrap();
    let out = dir.path().join("out");
    let out = out.to_str().unwrap();
    for format in [["--for", "c"], ["--for", "lammps"], ["--format", "c"]] {
        let written = export("built-in", &case, &[&format[..], &["--out", out]].concat());
        let warned = String::from_utf8_lossy(&written.stderr).into_owned();
        let told = warned.contains("warning: ") && warned.contains("mu = 1.4000 is outside of");
        assert!(written.status.success() && told, "{format:?}: {warned}");
    }
    for (file, mark) in [
        ("rough.asperity", "# warning: "),
        ("rough-wall.asperity", "# warning: "),
        ("law.asperity", "# warning: "),
        ("asperity_law.h", " * Warning: "),
    ] {
        let content = fs::read_to_string(Path::new(out).join(file)).unwrap();
        assert!(content.contains(&format!("{mark}mu = 1.4000 is outside of")), "{file}");
    }
    // Within the range nothing is said.
    let quiet = export("built-in", &fixture("cases/ideal.toml"), &["--format", "c", "--out", out]);
    assert!(quiet.status.success() && quiet.stderr.is_empty(), "{}", text(&quiet));
    assert!(!fs::read_to_string(Path::new(out).join("law.asperity")).unwrap().contains("warning"));
}

#[test]
fn what_has_no_start_is_refused() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().to_str().unwrap();
    let ideal = fixture("cases/ideal.toml");
    let formulas = fixture("law/law.json");
    let formulas = formulas.to_str().unwrap();
    for (law, arguments, says) in [
        (formulas, &["--for", "c", "--out", out][..], "of one kind of contact alone"),
        ("built-in", &["--for", "c"], "--out"),
        ("built-in", &["--for", "c", "--format", "c", "--out", out], "cannot be used with"),
        ("built-in", &["--format", "c", "--with", "other.toml"], "--for"),
        ("built-in", &["--for", "c", "--out", out, "--with", "nowhere.toml"], "nowhere.toml"),
        ("built-in", &["--for", "c", "--out", out, "--set", "contact.friction=\"stick\""], "stick"),
        ("built-in", &["--out", out], "--format"),
    ] {
        let refused = export(law, &ideal, arguments);
        assert!(refused.status.code() == Some(2) && text(&refused).contains(says), "{arguments:?}: {}", text(&refused));
    }
}

/// The table of two equal spheres, with the headers, in a directory.
fn write_table(dir: &Path) {
    let case = Case::load(&fixture("cases/equal.toml"), &[]).unwrap();
    for file in law_files(&LawFile::built_in().unwrap(), Language::C, Some(&case)).unwrap() {
        fs::write(dir.join(file.name), file.content).unwrap();
    }
}

/// Prints the code of reading law.asperity, and whether it is the constant of the header.
const READ: &str = r#"
#include "asperity_law.h"
#include <locale.h>
int main(int argc, char **argv) {
    static asperity_table table;
    int code, same;
    if (argc > 1 && !setlocale(LC_ALL, argv[1])) {
        printf("no locale\n");
        return 1;
    }
    code = asperity_read_table("law.asperity", &table);
    same = asperity_fingerprint(&table) == asperity_fingerprint(&asperity_law);
    printf("code %d same %d point %s\n", code, same, localeconv()->decimal_point);
    return 0;
}
"#;

#[test]
fn a_table_is_read_in_every_locale() {
    let test = "a_table_is_read_in_every_locale";
    if !has("gcc", test) {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    write_table(dir.path());
    fs::write(dir.path().join("read.c"), READ).unwrap();
    let run = compile_and_run(dir.path(), "read.c", &[], &[]);
    assert_eq!(text(&run), "code 0 same 1 point .\n");
    // ps_AF has a decimal point of two bytes.
    for (source, point) in [("de_DE", ","), ("ps_AF", "\u{66b}")] {
        let locales = dir.path().join("locales");
        fs::create_dir_all(&locales).unwrap();
        let name = format!("{source}.UTF-8");
        let made = Command::new("localedef").args(["-c", "-i", source, "-f", "UTF-8"]).arg(locales.join(&name)).output();
        if !locales.join(&name).exists() {
            let why = made.map_or_else(|error| error.to_string(), |made| text(&made));
            #[allow(clippy::explicit_write)]
            writeln!(std::io::stderr(), "SKIPPED {test}, {source}: localedef made no locale: {why}").expect("stderr");
            continue;
        }
        let program = dir.path().join("program");
        let run = Command::new(program).arg(&name).env("LOCPATH", &locales).current_dir(dir.path()).output().unwrap();
        assert_eq!(text(&run), format!("code 0 same 1 point {point}\n"), "{source}");
    }
}

/// Numbers that no law has, where they are read: in double, in float, and with a compiler that was
/// told that every number is finite.
#[test]
fn numbers_that_no_law_has_are_refused() {
    if !has("gcc", "numbers_that_no_law_has_are_refused") {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    write_table(dir.path());
    fs::write(dir.path().join("read.c"), READ).unwrap();
    let file = dir.path().join("law.asperity");
    let whole = fs::read_to_string(&file).unwrap();
    let with = |name: &str, value: &str| {
        let (start, rest) = whole.split_once(&format!("\n{name} ")).unwrap();
        format!("{start}\n{name} {value}\n{}", rest.split_once('\n').unwrap().1)
    };
    let knot = |value: &str| {
        let (start, rest) = whole.split_once("rows\n").unwrap();
        format!("{start}rows\n{value} {}", rest.split_once(' ').unwrap().1)
    };
    let damaged = [
        with("per_step", "0"),
        with("per_level", "1e-60"),
        with("first", "-1"),
        with("first", "1e-60"),
        with("friction", "-1"),
        with("friction", "nan"),
        with("later", "0.9"),
        with("level_start", "-1"),
        with("deepest", "inf"),
        with("share", "0x"),
        knot("nan"),
        knot("1e39"),
        knot("0,5"),
        knot("1.5.5"),
        knot(&"1".repeat(60)),
    ];
    for flags in [&[][..], &["-DASPERITY_SINGLE"], &["-Ofast"]] {
        fs::write(&file, &whole).unwrap();
        let run = compile_and_run(dir.path(), "read.c", flags, &[]);
        assert!(text(&run).starts_with("code 0 same 1"), "{flags:?}: {}", text(&run));
        for table in &damaged {
            fs::write(&file, table).unwrap();
            let run = Command::new(dir.path().join("program")).current_dir(dir.path()).output().unwrap();
            assert!(text(&run).starts_with("code 3 "), "{flags:?}: {}", text(&run));
        }
    }
}

/// The C twin is held to this by `tests/law/engine_starts.c`.
#[test]
fn a_state_that_no_contact_has_is_refused() {
    let case = Case::load(&fixture("cases/ideal.toml"), &[]).unwrap();
    let law = LawFile::read(&fixture("law/law.json")).unwrap();
    let parameters = law.contact_parameters(&case).unwrap();
    let (good, _) = parameters.update(&ContactState::default(), 0.01, [1e-4, 0.0]);
    assert!(good.is_sound());
    let spoil: [fn(&mut ContactState, f64); 11] = [
        |s, v| s.h = v,
        |s, v| s.h_max = v,
        |s, v| s.approach = v,
        |s, v| s.hardened = v,
        |s, v| s.reach = v,
        |s, v| s.softened = v,
        |s, v| s.released = v,
        |s, v| s.worn = v,
        |s, v| s.stiffened = v,
        |s, v| s.vertex[1] = v,
        |s, v| s.slider[2][6] = v,
    ];
    let mut states: Vec<ContactState> = Vec::new();
    for change in spoil {
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut state = good;
            change(&mut state, value);
            states.push(state);
        }
    }
    for (change, value) in
        [(1, -1e-3), (3, -1e-3), (4, -1e-3), (5, -0.1), (5, 1.1), (6, -0.1), (6, 1.1), (7, -0.1), (7, 2.1), (8, -1.1)]
    {
        let mut state = good;
        spoil[change](&mut state, value);
        states.push(state);
    }
    for state in &states {
        let (next, out) = parameters.update(state, 0.012, [0.0; 2]);
        assert!(!state.is_sound() && out.f_n.is_nan() && out.f_t[0].is_nan() && out.a.is_nan(), "{state:?}");
        assert!(parameters.stored_energy(state).is_nan() && format!("{next:?}") == format!("{state:?}"));
    }
    let mut shallow = good;
    shallow.h_max = 1e-200;
    let _ = parameters.update(&shallow, 1.7e308, [0.0; 2]);
    let test = "a_state_that_no_contact_has_is_refused";
    if !has("gcc", test) || !has("python3", test) {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    for file in law_files(&law, Language::Python, Some(&case)).unwrap() {
        fs::write(dir.path().join(file.name), file.content).unwrap();
    }
    let program = "import math, asperity_law as a\n\
        p = a.setup(200e3, 1.0)\n\
        s, out = a.update(p, a.State(), 0.01, (1e-4, 0.0))\n\
        assert out.f_n > 0.0\n\
        for name in ('h', 'h_max', 'approach', 'hardened', 'reach', 'softened', 'released', 'worn', 'stiffened'):\n\
        \x20   for value in (math.nan, math.inf, -math.inf) + (() if name in ('h', 'approach') else (-2.0,)):\n\
        \x20       t = s.copy()\n\
        \x20       setattr(t, name, value)\n\
        \x20       n, out = a.update(p, t, 0.012, (0.0, 0.0))\n\
        \x20       assert math.isnan(out.f_n) and n.to_bytes() == t.to_bytes(), name\n\
        \x20       assert math.isnan(a.stored_energy(p, t)), name\n";
    let run = Command::new("python3").args(["-c", program]).current_dir(dir.path()).output().unwrap();
    assert!(run.status.success(), "{}", text(&run));
}
