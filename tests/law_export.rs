//! The exported law, compiled by the compilers and run by the interpreter that users have, against
//! the vectors of the Rust update.
//!
//! A missing gcc, g++ or python3 skips its test, aloud; with `ASPERITY_REQUIRE_COMPILERS=1` that is
//! a failure.

#[path = "common/programs.rs"]
mod programs;

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Command, Output};

use asperity::analytical::ElasticSphere;
use asperity::case::Case;
use asperity::contact_law::{Frame, POINTS};
use asperity::law::export::{Language, engine_files, law_files, law_source};
use asperity::law::formulas::model::{FORMAT, Law, Provenance, VERSION, Validity};
use asperity::law::formulas::normal::NormalModel;
use asperity::law::formulas::shear::ShearConstants;
use asperity::law::range::Interval;
use asperity::law::table::{self, Level, Tabulated};
use asperity::law::variables::Body;
use asperity::law::{LawFile, Parameters};
use asperity::material::FlowStress;
use programs::has;

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

/// Whether `program` is there; if not, the test ends here.
fn text(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

/// The files for Python, of a made-up law and a case.
fn write_module(dir: &Path, law: &Law, hardening: &str) {
    for file in law_files(&LawFile::Formulas(Box::new(law.clone())), Language::Python, Some(&case(hardening))).unwrap() {
        fs::write(dir.join(file.name), file.content).unwrap();
    }
}

/// A case of a hardening law given as TOML.
fn case(hardening: &str) -> Case {
    let text = format!(
        "[sphere]\nradius = 0.5\n[material]\nyoungs_modulus = 70e3\npoissons_ratio = 0.3\n[material.hardening]\n{hardening}\n[contact]\n\
         friction = 0.25\n[[path]]\nindentation = 0.01\n"
    );
    Case::parse(&text, "case.toml", &[]).unwrap()
}

const IDEAL: &str = "law = \"ideal\"\nyield_stress = 140.0";
const HARDENINGS: [&str; 3] =
    [IDEAL, "law = \"elastic\"", "law = \"power\"\nyield_stress = 300.0\ncoefficient = 900.0\nexponent = 0.4"];

/// The files for engines, of a made-up law and a case.
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

fn compiled_headers_agree(compiler: &[&str], test: &str) {
    if !has(compiler[0], test) {
        return;
    }
    for (number, (law, hardening)) in laws().iter().flat_map(|law| HARDENINGS.map(|hardening| (law, hardening))).enumerate() {
        let dir = tempfile::tempdir().unwrap();
        write_engine_files(dir.path(), law, hardening);
        if let Some(kept) = std::env::var_os("ASPERITY_KEEP_EXPORTS") {
            let kept = Path::new(&kept).join(number.to_string());
            fs::create_dir_all(&kept).unwrap();
            write_engine_files(&kept, law, hardening);
            write_module(&kept, law, hardening);
        }
        // The constant, and the file that an engine reads.
        for arguments in [&["asperity_law_vectors.csv"][..], &["asperity_law_vectors.csv", "law.asperity"]] {
            let run = compile_and_run(dir.path(), CHECK, compiler, arguments);
            assert!(run.status.success(), "{} {hardening}: {}", law.provenance.study, text(&run));
            println!("{}", text(&run));
        }
    }
}

/// The headers as CUDA sees them: device code of the whole update, in double and in float, by
/// clang's front end, which needs no CUDA.
#[test]
fn the_headers_are_device_code() {
    let test = "the_headers_are_device_code";
    let names = ["clang++", "clang++-19", "clang++-16", "clang++-14"];
    let found = names.into_iter().find(|name| Command::new(name).arg("--version").output().is_ok_and(|o| o.status.success()));
    let Some(clang) = found else {
        #[allow(clippy::explicit_write)]
        writeln!(std::io::stderr(), "SKIPPED {test}: no clang++").expect("stderr");
        return;
    };
    let dir = tempfile::tempdir().unwrap();
    write_fitted_law(dir.path());
    let kernel = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/law/kernel.cu");
    for precision in [&[][..], &["-DASPERITY_SINGLE"]] {
        let cuda =
            ["-x", "cuda", "--cuda-device-only", "--cuda-gpu-arch=sm_70", "-nocudainc", "-nocudalib", "-std=c++17", "-O2", "-S"];
        let mut command = Command::new(clang);
        command.args(cuda).args(precision).args(["-Wall", "-Wextra", "-Werror", "-I.", "-o", "kernel.ptx"]).arg(&kernel);
        let built = command.current_dir(dir.path()).output().unwrap();
        assert!(built.status.success(), "{precision:?}\n{}", text(&built));
        let ptx = fs::read_to_string(dir.path().join("kernel.ptx")).unwrap();
        for entry in ["move_contacts", "collide_spheres"] {
            assert!(ptx.contains(&format!(".entry {entry}(")), "{entry}");
        }
    }
}

#[test]
fn the_header_agrees_as_c99() {
    compiled_headers_agree(&["gcc", "-std=c99", "-O2"], "the_header_agrees_as_c99");
}

#[test]
fn the_header_agrees_as_cpp17() {
    compiled_headers_agree(&["g++", "-std=c++17", "-O2"], "the_header_agrees_as_cpp17");
}

#[test]
fn single_precision_agrees_to_half_a_per_cent() {
    compiled_headers_agree(&["gcc", "-std=c99", "-O2", "-DASPERITY_SINGLE"], "single_precision_agrees_to_half_a_per_cent");
}

#[test]
fn sanitizers_find_nothing() {
    let sanitize = ["gcc", "-std=c99", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"];
    compiled_headers_agree(&sanitize, "sanitizers_find_nothing");
}

/// The law of the repository.
fn fitted_law() -> Law {
    match LawFile::read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law/law.json")).unwrap() {
        LawFile::Formulas(law) => *law,
        LawFile::Table(_) | LawFile::Interpolated(_) => panic!("no formulas"),
    }
}

/// The same for a case, with what engines need, in a directory.
fn write_fitted_law(dir: &Path) {
    for file in engine_files(&LawFile::Formulas(Box::new(fitted_law())), Some(&case(IDEAL))).unwrap() {
        fs::write(dir.join(file.name), file.content).unwrap();
    }
}

/// Compiles a program of the repository beside the fitted law and runs it.
fn program_succeeds(program: &str, compiler: &[&str], test: &str) {
    if !has(compiler[0], test) {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    write_fitted_law(dir.path());
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(program);
    let language = if compiler[0] == "g++" { "c++" } else { "c" };
    let mut command = Command::new(compiler[0]);
    command.args(&compiler[1..]).args(WARNINGS).args(["-I.", "-o", "program", "-x", language]).arg(source).arg("-lm");
    let built = command.current_dir(dir.path()).output().unwrap();
    assert!(built.status.success(), "{compiler:?}\n{}", text(&built));
    let run = Command::new(dir.path().join("program")).current_dir(dir.path()).output().unwrap();
    assert!(run.status.success(), "{compiler:?}\n{}", text(&run));
    println!("{}", text(&run));
}

/// Tangents, step size, energy, turned axes, steps of all sizes, and how many are left unsolved, on
/// tables of a soft and a strong contact.
#[test]
fn the_update_keeps_what_it_promises() {
    let test = "the_update_keeps_what_it_promises";
    if !has("gcc", test) {
        return;
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for name in ["ideal-200-mu-0.3", "ideal-3200-mu-0.1"] {
        let dir = tempfile::tempdir().unwrap();
        let law = LawFile::read(&root.join(format!("fixtures/paths/{name}.json"))).unwrap();
        for file in law_files(&law, Language::C, None).unwrap() {
            fs::write(dir.path().join(file.name), file.content).unwrap();
        }
        for program in ["element_check.c", "unsolved.c"] {
            fs::copy(root.join("tests/law").join(program), dir.path().join(program)).unwrap();
            let run = compile_and_run(dir.path(), program, &["gcc", "-std=c99", "-O2"], &["law.asperity"]);
            assert!(run.status.success(), "{name}\n{}", text(&run));
            println!("{name}\n{}", text(&run));
        }
    }
}

#[test]
fn three_dimensions_are_objective_and_balanced() {
    for compiler in [
        &["gcc", "-std=c99", "-O2"][..],
        &["g++", "-std=c++17", "-O2"],
        &["gcc", "-std=c99", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"],
    ] {
        program_succeeds("tests/law/contact3d.c", compiler, "three_dimensions_are_objective_and_balanced");
    }
}

/// Set-up, masses, damping, and what has no answer.
#[test]
fn an_engine_is_told_what_has_no_answer() {
    for compiler in [
        &["gcc", "-std=c99", "-O3"][..],
        &["g++", "-std=c++17", "-O2"],
        &["gcc", "-std=c99", "-O1", "-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all"],
    ] {
        program_succeeds("tests/law/engine_starts.c", compiler, "an_engine_is_told_what_has_no_answer");
    }
}

#[test]
fn the_example_of_an_engine_runs() {
    program_succeeds("examples/engine/two_spheres.c", &["gcc", "-std=c99", "-O2"], "the_example_of_an_engine_runs");
}

#[test]
fn a_damaged_table_is_refused() {
    if !has("gcc", "a_damaged_table_is_refused") {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    write_engine_files(dir.path(), &laws()[0], IDEAL);
    let file = dir.path().join("law.asperity");
    let whole = fs::read_to_string(&file).unwrap();
    for (content, says) in [
        (whole[..whole.len() / 2].to_owned(), "is damaged"),
        (whole.replacen("table 5", "table 4", 1), "no contact table of this version"),
        (whole.replacen("friction", "fiction", 1), "is damaged"),
        (String::new(), "no contact table"),
    ] {
        fs::write(&file, content).unwrap();
        let run = compile_and_run(dir.path(), CHECK, &["gcc", "-std=c99"], &["asperity_law_vectors.csv", "law.asperity"]);
        assert_eq!(run.status.code(), Some(2), "{}", text(&run));
        assert!(text(&run).contains(says), "{}", text(&run));
    }
}

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
        for file in law_files(&law, Language::C, None).unwrap() {
            fs::write(dir.path().join(file.name), file.content).unwrap();
        }
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
            "[sphere]\nradius = 1.0\n[material]\nyoungs_modulus = 1.0\npoissons_ratio = 0.25\n[material.hardening]\n{hardening}\n[contact]\n\
             friction = 0.4\n{opponent}\n[[path]]\nindentation = 0.01\n"
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
            for file in law_files(&law, language, None).unwrap() {
                fs::write(dir.path().join(file.name), file.content).unwrap();
            }
            let run = match compiler {
                Some(compiler) => compile_and_run(dir.path(), CHECK, &compiler, &["asperity_law_vectors.csv"]),
                None => Command::new("python3")
                    .args(["-W", "error", "asperity_law.py", "asperity_law_vectors.csv"])
                    .current_dir(dir.path())
                    .output()
                    .unwrap(),
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
            None => Command::new("python3")
                .args(["-W", "error", "asperity_law.py", "asperity_law_vectors.csv"])
                .current_dir(&files)
                .output()
                .unwrap(),
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

#[test]
fn two_translation_units_may_include_the_header() {
    if !has("gcc", "two_translation_units_may_include_the_header") {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    write_engine_files(dir.path(), &laws()[0], IDEAL);
    fs::write(
        dir.path().join("one.c"),
        "#include \"asperity_law.h\"\n#include \"asperity_law.h\"\nint main(void) { return 0; }\n",
    )
    .unwrap();
    fs::write(dir.path().join("two.c"), "#include \"asperity_law.h\"\nextern int two;\nint two = 2;\n").unwrap();
    let flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-o", "both", "one.c", "two.c", "-lm"];
    let built = Command::new("gcc").args(flags).current_dir(dir.path()).output().unwrap();
    assert!(built.status.success(), "{}", text(&built));
}

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
        let mut python = Command::new("python3");
        let run = python.args(["asperity_law.py", "asperity_law_vectors.csv"]).current_dir(dir.path()).output().unwrap();
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
        let run = python(&["asperity_law.py", "asperity_law_vectors.csv"], "gcc");
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
fn the_vectors_go_where_a_contact_can_go() {
    let law = LawFile::Formulas(Box::new(fitted_law()));
    let files = law_files(&law, Language::C, Some(&case(IDEAL))).unwrap();
    let text = &files.iter().find(|file| file.name == "asperity_law_vectors.csv").unwrap().content;
    let rows: Vec<Vec<f64>> = text.lines().skip(1).map(|line| line.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let at = |row: &[f64], name: &str| row[names.iter().position(|other| *other == name).unwrap()];
    let count = |test: &dyn Fn(&[f64]) -> bool| rows.iter().filter(|row| test(row)).count();
    assert!(rows.iter().all(|row| row.len() == names.len() && row.iter().all(|value| value.is_finite())));
    assert!(count(&|row| at(row, "f_n") == 0.0) > 10);
    assert!(count(&|row| at(row, "worn") > 1.0 && at(row, "f_n") > 0.0) > 100);
    assert!(count(&|row| at(row, "worn") > 0.0 && at(row, "worn") < 1.0) > 100);
    let force = |row: &[f64]| at(row, "f_t0").hypot(at(row, "f_t1"));
    let slips = |row: &[f64]| at(row, "f_n") > 0.0 && force(row) > 0.999 * at(row, "mu") * at(row, "f_n");
    assert!(count(&slips) > 100);
    assert!(count(&|row| at(row, "cosine") != 1.0) > 100);
    assert!(rows.iter().all(|row| force(row) <= at(row, "mu") * at(row, "f_n") * (1.0 + 1e-12)));
}

#[test]
fn the_update_follows_the_law_it_is_made_of() {
    let sphere = ElasticSphere { radius: 0.5, youngs_modulus: 70e3, poissons_ratio: 0.3 };
    for law in laws() {
        for hardening in [FlowStress::ideal(100.0).unwrap(), FlowStress::hollomon(400.0, 4.0, 70e3).unwrap(), FlowStress::Elastic]
        {
            let body = Body { sphere, hardening };
            let friction = 0.25;
            let pair = law.contact_parameters(&body, friction).unwrap();
            for h in [1e-5, 1e-3, 0.02].map(|h| h * sphere.radius) {
                let inputs = law.inputs(&body, friction, h);
                let expected: Parameters = law.contact(&inputs);
                let (mut state, _) = pair.update(&Default::default(), h, [0.0; 2]);
                for k in 1..=20 {
                    let delta = 1.1 * expected.delta_t_end * f64::from(k) / 20.0;
                    let increment = 1.1 * expected.delta_t_end / 20.0;
                    let (next, out) = pair.update(&state, h, [0.0, increment]);
                    state = next;
                    let (f_t, f_n) = law.forces(&expected, friction, delta);
                    // The sliders of an elastic contact are good for 1.2e-2, the flow of a plastic
                    // one for some more.
                    assert!((out.f_t[1] - f_t).abs() < 6e-2 * friction * f_n, "{h} {k}: {} {f_t}", out.f_t[1]);
                    assert!((out.f_n - f_n).abs() < 3e-2 * f_n, "{h} {k}: {} {f_n}", out.f_n);
                }
            }
        }
    }
}

/// Every step of a path, however it turns, takes at least the stored energy that it adds; so no
/// closed path returns work.
#[test]
fn no_path_extracts_work() {
    let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };
    let mut seed = 1u64;
    let mut random = |from: f64, to: f64| {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        from + (to - from) * ((seed >> 11) as f64 / (1u64 << 53) as f64)
    };
    let mut worst: f64 = 0.0;
    for law in laws() {
        for (stress, friction) in [(20.0, 0.5), (400.0, 0.3), (2500.0, 0.1)] {
            let pair = law.contact_parameters(&Body { sphere, hardening: FlowStress::ideal(stress).unwrap() }, friction).unwrap();
            for _ in 0..8 {
                let deepest = 10f64.powf(random(-4.0, -1.2));
                let virgin = pair.virgin(deepest);
                let mut state = Default::default();
                let (mut at, mut f, mut work, mut through) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
                for leg in 0..13 {
                    let mut to = at;
                    let kind = random(0.0, 1.0);
                    if leg == 0 || kind < 0.3 {
                        to[0] = deepest * random(0.3, 1.0);
                    } else if kind < 0.5 {
                        to[0] = at[0] - virgin.depth * random(-0.2, 0.6);
                    }
                    if leg > 0 && kind > 0.2 {
                        to[1] = virgin.point.delta_t_slip * random(-1.5, 1.5);
                        to[2] = virgin.point.delta_t_slip * random(-0.5, 0.5);
                    }
                    if leg == 12 {
                        to = [-1e-2 * deepest, 0.0, 0.0]; // back to where it started
                    }
                    let step: [f64; 3] = std::array::from_fn(|i| (to[i] - at[i]) / 500.0);
                    for _ in 0..500 {
                        at = std::array::from_fn(|i| at[i] + step[i]);
                        let (next, out) = pair.update(&state, at[0], [step[1], step[2]]);
                        let now = [out.f_n, out.f_t[0], out.f_t[1]];
                        let done: f64 = (0..3).map(|i| 0.5 * (f[i] + now[i]) * step[i]).sum();
                        let gain = pair.stored_energy(&next) - pair.stored_energy(&state) - done;
                        through += done.abs();
                        work += done;
                        // Between the knots of the table next to yield a step may gain a little of
                        // what others lost.
                        assert!(gain <= 1e-3 * through, "{stress} leg {leg}: {gain:e} of {through:e}");
                        (state, f) = (next, now);
                        let lost = work - pair.stored_energy(&state);
                        worst = worst.min(lost / through);
                        assert!(lost >= -1e-4 * through, "{stress} leg {leg}: {lost:e} of {through:e}");
                    }
                }
                // All that was stored is given back where the contact is lost; work in is what is
                // left.
                assert!(f == [0.0; 3] && work > 0.0, "{stress}: {f:?} {work:e} of {through:e}");
            }
        }
    }
    println!("least dissipation {worst:e} of the work exchanged");
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
    let case_file = "[sphere]\nradius = 0.5\n[material]\nyoungs_modulus = 70e3\npoissons_ratio = 0.3\n[material.hardening]\nlaw = \"ideal\"\n\
                     yield_stress = 140.0\n[contact]\nfriction = 0.25\n[[path]]\nindentation = 0.01\n";
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
    if (!same(out.f_t[0], far.f_t[0]) || !same(out.f_t[1], far.f_t[1]) || !same(hypot(out.f_t[0], out.f_t[1]), t->friction * out.f_n)) return 6;
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
        let run = Command::new("python3").args(["-c", program]).current_dir(dir.path()).output().unwrap();
        assert!(run.status.success(), "{}", text(&run));
    }
}
