//! The headers, by the compilers that engines have, and the programs that check them.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::Command;

use asperity::law::LawFile;
use asperity::law::export::Language;

use super::programs::has;
use super::{
    CHECK, HARDENINGS, IDEAL, WARNINGS, compile_and_run, fitted_law, laws, text, write_engine_files, write_files, write_module,
};

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
    write_engine_files(dir.path(), &fitted_law(), IDEAL);
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

/// Compiles a program of the repository beside the fitted law and runs it.
fn program_succeeds(program: &str, compiler: &[&str], test: &str) {
    if !has(compiler[0], test) {
        return;
    }
    let dir = tempfile::tempdir().unwrap();
    write_engine_files(dir.path(), &fitted_law(), IDEAL);
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
        write_files(dir.path(), &law, Language::C, None);
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
