//! Hostile input: what is in the corpus and the fixtures, changed at random, through everything
//! that reads it, and what was taken through what uses it. No panic, none takes two seconds, all
//! together no 256 MiB.
//!
//! `ASPERITY_FUZZ=100000 cargo test --test faults hostile -- --nocapture` makes so many inputs of
//! each kind and tells how many were taken. An input with a fault is kept in `target/tmp/hostile`.

mod corpus;
mod engine;
mod mutate;
mod runner;
mod uses;

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use asperity::case::{Case, estimated_memory};
use asperity::internals::cli::point::read_path;
use asperity::law::LawFile;
use asperity::law::study_table::StudyTable;
use asperity::material::point::along;
use asperity::output::plots::Sheet;
use asperity::output::{Checkpoint, Summary, read_contact, read_history};
use asperity::session::{Canceller, Earlier, Options};
use asperity::study::{Study, StudyDirectory, report};
use asperity::{Simulation, case::PictureFormat};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::Value;

use self::runner::fuzz;
use super::common::{program, stderr};
use super::program::{CASE, scratch};

const SEED: u64 = 15;
const PATIENCE: Duration = Duration::from_secs(2);

fn any<'a, T>(rng: &mut ChaCha8Rng, all: &'a [T]) -> &'a T {
    &all[rng.random_range(0..all.len())]
}

/// A changed TOML file: its bytes, or its tree where it is one.
fn changed_toml(rng: &mut ChaCha8Rng, from: &[Vec<u8>], others: &[Vec<u8>]) -> Vec<u8> {
    let (seed, other) = (any(rng, from), any(rng, others));
    let tree = std::str::from_utf8(seed).ok().and_then(|text| toml::from_str::<Value>(text).ok());
    match tree {
        Some(mut tree) if rng.random_range(0..2) == 0 => {
            mutate::tree(rng, &mut tree);
            // TOML has no null.
            toml::to_string(&tree).map_or_else(|_| mutate::bytes(rng, seed, other), String::into_bytes)
        }
        _ => mutate::bytes(rng, seed, other),
    }
}

/// A changed JSON file, more often of its tree than of its bytes.
fn changed_json(rng: &mut ChaCha8Rng, seeds: &[Value]) -> Vec<u8> {
    let seed = any(rng, seeds);
    if rng.random_range(0..4) == 0 {
        return mutate::bytes(rng, &serde_json::to_vec_pretty(seed).expect("JSON"), b"");
    }
    let mut tree = seed.clone();
    mutate::tree(rng, &mut tree);
    serde_json::to_vec(&tree).expect("JSON")
}

/// A changed table, more often of its cells than of its bytes.
fn changed_table(rng: &mut ChaCha8Rng, seed: &[u8]) -> Vec<u8> {
    if rng.random_range(0..3) == 0 { mutate::bytes(rng, seed, b"") } else { mutate::table(rng, seed) }
}

#[test]
fn changed_cases() {
    let all = corpus::toml_files(&["fixtures/cases", "fixtures/cases/bad", "tests/faults/corpus"]);
    let is_right = |bytes: &&Vec<u8>| Case::parse(&String::from_utf8_lossy(bytes), "case.toml", &[]).is_ok();
    let right: Vec<Vec<u8>> = all.iter().filter(is_right).cloned().collect();
    assert!(right.len() >= 10, "{}", right.len());
    let law = LawFile::Interpolated(Box::new(
        serde_json::from_value(corpus::interpolated("fixtures/law/interpolated/plane.json")).expect("a law"),
    ));
    let next = move |rng: &mut ChaCha8Rng| {
        // What is right as it stands comes more often: what is wrong already ends early.
        let from = if rng.random_range(0..3) > 0 { &right } else { &all };
        changed_toml(rng, from, &all)
    };
    fuzz("case", 0.05, next, move |bytes, _| {
        Case::parse(&String::from_utf8_lossy(bytes), "case.toml", &[]).is_ok_and(|case| {
            let again = Case::parse(&case.to_toml(), "again.toml", &[]).expect("a resolved case is a case");
            assert_eq!(again, case);
            let _ = (case.material.constants::<f64>(), case.scaled(), estimated_memory(&case));
            uses::law(&law, &[case], false);
            true
        })
    });
}

#[test]
fn changed_studies() {
    // Without the study of 240 cases, which takes as long as the rest together.
    let mut all = corpus::toml_files(&["fixtures/studies", "fixtures/studies/bad", "tests/faults/corpus"]);
    all.retain(|bytes| bytes.len() < 2000);
    let next = move |rng: &mut ChaCha8Rng| changed_toml(rng, &all, &all);
    // Two in a hundred are taken, a little more or less as the studies grow.
    fuzz("study", 0.015, next, |bytes, _| {
        Study::parse(&String::from_utf8_lossy(bytes), "study.toml").is_ok_and(|study| {
            let _ = (study.size(), study.cases.iter().map(|case| case.case.to_toml().len()).sum::<usize>());
            true
        })
    });
}

/// Law files of a kind: read, and then followed along cases, exported and drawn.
fn changed_laws(kind: &'static str, least: f64, seeds: Vec<Value>, opponents: &[&str]) {
    let cases: Vec<Case> = opponents.iter().map(|opponent| corpus::case(opponent)).collect();
    let next = move |rng: &mut ChaCha8Rng| changed_json(rng, &seeds);
    fuzz(kind, least, next, move |bytes, path| {
        LawFile::read(path).map(|law| uses::law(&law, &cases, bytes.len() % 8 == 0)).is_ok()
    });
}

const EQUAL: &str = "[opponent]\nequal = true\n";
const LIKE_ITSELF: &str = "[opponent]\nradius = 1.0\n";

#[test]
fn changed_laws_of_formulas() {
    changed_laws("law", 0.1, vec![corpus::formulas()], &[""]);
}

#[test]
fn changed_tables() {
    changed_laws("table", 0.04, corpus::tables(), &[LIKE_ITSELF]);
}

#[test]
fn changed_laws_by_interpolation() {
    let seeds = ["plane", "pair"].map(|name| corpus::interpolated(&format!("fixtures/law/interpolated/{name}.json")));
    changed_laws("interpolated", 0.1, seeds.to_vec(), &["", EQUAL]);
}

#[test]
fn changed_histories() {
    let seed = corpus::of_run("history.csv");
    let case = Case::parse(CASE, "case.toml", &[]).expect("a case");
    let laws = [corpus::formulas(), corpus::tables().swap_remove(0)].map(|law| {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hostile-law.json");
        fs::write(&path, law.to_string()).expect("a law");
        LawFile::read(&path).expect("a law")
    });
    fuzz(
        "history",
        0.1,
        move |rng| changed_table(rng, &seed),
        move |_, path| read_history(path).map(|rows| uses::history(&rows, &case, &laws)).is_ok(),
    );
}

#[test]
fn changed_contact_tables() {
    let seed = corpus::contact();
    let history = read_history(&super::program::whole().join("history.csv")).expect("a history");
    let case = Case::parse(CASE, "case.toml", &[]).expect("a case");
    fuzz(
        "contact",
        0.1,
        move |rng| changed_table(rng, &seed),
        move |_, path| read_contact(path).map(|points| uses::contact(points, &history, &case)).is_ok(),
    );
}

#[test]
fn changed_summaries() {
    let seed = [corpus::json(&String::from_utf8(corpus::of_run("summary.json")).expect("text"))];
    let folder = tempfile::tempdir().expect("a scratch directory");
    fuzz(
        "summary",
        0.1,
        move |rng| changed_json(rng, &seed),
        move |_, path| {
            Summary::read(path).is_ok_and(|summary| {
                let again = folder.path().join("again.json");
                summary.write(&again).expect("it is written");
                assert_eq!(Summary::read(&again).expect("a summary"), summary);
                true
            })
        },
    );
}

#[test]
fn changed_tables_of_studies() {
    let folder = tempfile::tempdir().expect("a scratch directory");
    let seed = corpus::study(folder.path());
    fuzz(
        "study-table",
        0.1,
        move |rng| changed_table(rng, &seed),
        move |bytes, path| {
            StudyTable::read(path).is_ok_and(|table| {
                for row in &table.rows {
                    let _ = table.header.iter().filter_map(|column| table.number(row, column)).sum::<f64>();
                }
                fs::write(folder.path().join("study.csv"), bytes).expect("a file");
                drop(report::write_report(&StudyDirectory::new(folder.path()), None, Sheet::default(), PictureFormat::Svg));
                true
            })
        },
    );
}

#[test]
fn changed_paths_of_a_point() {
    let mut seed = "F11,F12,F13,F21,F22,F23,F31,F32,F33\n".to_owned();
    for i in 0..20 {
        let x = 1e-3 * f64::from(i);
        seed.push_str(&format!("{:?},{x:?},0,0,{:?},0,0,0,1.0\n", 1.0 + x, 1.0 - 0.4 * x));
    }
    let material = Case::parse(CASE, "case.toml", &[]).expect("a case").material.constants::<f64>().expect("a material");
    fuzz(
        "path",
        0.1,
        move |rng| changed_table(rng, seed.as_bytes()),
        move |_, path| {
            read_path(path).is_ok_and(|gradients| {
                let _ = along(&material, gradients).take(200).filter(Result::is_ok).count();
                true
            })
        },
    );
}

/// With the sum that belongs to it, so that what is behind the sum sees it.
fn summed(mut bytes: Vec<u8>) -> Vec<u8> {
    let sum = crc32fast::hash(&bytes);
    bytes.extend(sum.to_le_bytes());
    bytes
}

/// The bytes of a changed checkpoint.
fn changed_checkpoint(rng: &mut ChaCha8Rng, good: &[u8], tree: &Value, place: &Path) -> Vec<u8> {
    if rng.random_range(0..2) == 0 {
        let mut tree = tree.clone();
        mutate::tree(rng, &mut tree);
        if let Ok(changed) = serde_json::from_value::<Checkpoint>(tree) {
            changed.write(place).expect("it is written");
            return fs::read(place).expect("a checkpoint");
        }
    }
    let mut bytes = good[..good.len() - 4].to_vec();
    let line = bytes.iter().position(|byte| *byte == b'\n').expect("a first line");
    for _ in 0..rng.random_range(1..=4) {
        let at = rng.random_range(line + 1..bytes.len());
        bytes[at] = rng.random();
    }
    if rng.random_range(0..4) == 0 {
        bytes.truncate(rng.random_range(line + 1..bytes.len()));
    }
    summed(bytes)
}

/// A resumed run: its state is put back; `steps` says whether a step is made from it, which takes
/// longer.
fn resume(case: &Case, out: &Path, steps: bool) {
    let canceller = Canceller::default();
    if !steps {
        canceller.cancel();
    }
    let options = Options {
        out: Some(out.to_owned()),
        earlier: Earlier::Resume,
        threads: std::num::NonZeroUsize::new(1),
        canceller,
        ..Options::default()
    };
    // What it refuses is refused with an error.
    if let Ok(mut run) = Simulation::with(case, options) {
        drop(run.step());
    }
}

/// Some of those that are taken are resumed: that takes as long as a thousand of the others.
#[test]
fn changed_checkpoints() {
    const RESUMED: usize = 20;
    let (scratch, whole) = corpus::interrupted();
    let good = fs::read(whole.join("checkpoint.bin")).expect("a checkpoint");
    let read = Checkpoint::read(&whole.join("checkpoint.bin")).expect("it can be read").expect("it is there");
    let tree = serde_json::to_value(&read).expect("JSON");
    let case = Case::load(&whole.join("case.toml"), &[]).expect("a case");
    let (place, out): (PathBuf, PathBuf) = (scratch.path("changed.bin"), scratch.path("resumed"));
    let number = std::sync::atomic::AtomicUsize::new(0);
    let next = move |rng: &mut ChaCha8Rng| changed_checkpoint(rng, &good, &tree, &place);
    fuzz("checkpoint", 0.1, next, move |bytes, path| {
        let _owned = &scratch;
        if !matches!(Checkpoint::read(path), Ok(Some(_))) {
            return false;
        }
        let number = number.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
        if number.is_multiple_of(RESUMED) {
            fs::remove_dir_all(&out).or_else(|_| fs::create_dir(&out)).expect("a folder");
            copy(&whole, &out);
            fs::write(out.join("checkpoint.bin"), bytes).expect("a checkpoint");
            resume(&case, &out, number.is_multiple_of(2 * RESUMED));
        }
        true
    });
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).expect("a folder");
    for entry in fs::read_dir(from).expect("a folder") {
        let entry = entry.expect("an entry").path();
        let place = to.join(entry.file_name().expect("a name"));
        if entry.is_dir() { copy(&entry, &place) } else { fs::copy(&entry, &place).map(drop).expect("a copy") }
    }
}

#[test]
fn every_damaged_checkpoint_is_refused() {
    let (_run, out) = corpus::interrupted();
    let good = fs::read(out.join("checkpoint.bin")).expect("a checkpoint");
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let path = scratch.path().join("checkpoint.bin");
    fs::write(&path, &good).expect("a file");
    assert!(matches!(Checkpoint::read(&path), Ok(Some(_))));
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    for number in 0..300 {
        let mut bytes = good.clone();
        match number % 3 {
            0 => bytes.truncate(rng.random_range(0..good.len())),
            1 => bytes[rng.random_range(0..good.len())] ^= 1 << rng.random_range(0..8),
            _ => bytes.extend((0..rng.random_range(1..100)).map(|_| rng.random::<u8>())),
        }
        fs::write(&path, &bytes).expect("a file");
        let message = Checkpoint::read(&path).expect_err("damaged").to_string();
        assert!(message.contains("checkpoint.bin") && message.contains("--force"), "{message}");
    }
}

/// What took minutes, or all memory.
#[test]
fn great_inputs_take_time_in_proportion_or_are_refused() {
    let head = CASE.split("[[path]]").next().expect("a head");
    let numbers = |count: usize, text: &dyn Fn(usize) -> String| (0..count).map(text).collect::<Vec<_>>().join(", ");
    let path: String = (0..16_000).map(|i| format!("[[path]]\nindentation = {:?}\n", 0.01 + 1e-4 * f64::from(i % 2))).collect();
    let points = numbers(100_000, &|i| format!("[{:?}, {:?}]", 1e-4 * i as f64, 400.0 + 1e-3 * i as f64));
    let table = head.replace("\"ideal\"\nyield_stress = 400.0", &format!("\"table\"\npoints = [{points}]"));
    let press = "[[path]]\nindentation = 0.01\n";
    let base = format!("{head}{press}").replace("[[", "<<").replace('[', "[base.").replace("<<", "[[base.");
    let grid =
        format!("{base}[grid]\n\"contact.friction\" = [{}]\n", numbers(10_000, &|i| format!("{:?}", 0.1 + 1e-5 * i as f64)));
    let huge = format!(
        "{}[grid]\n\"contact.friction\" = [{}]\n",
        base.replace("[[base.path]]\nindentation = 0.01\n", &path.replace("[[", "[[base.")),
        numbers(3000, &|i| format!("{:?}", 0.1 + 1e-5 * i as f64))
    );
    let timed = |name: &str, parse: &dyn Fn() -> Result<(), String>| {
        let begun = Instant::now();
        let parsed = parse();
        assert!(begun.elapsed() < PATIENCE, "{name}: {:?}", begun.elapsed());
        parsed
    };
    let case = |text: &str| Case::parse(text, "case.toml", &[]).map(drop).map_err(|error| error.to_string());
    let study = |text: &str| Study::parse(text, "study.toml").map(drop).map_err(|error| error.to_string());
    assert_eq!(timed("16000 segments", &|| case(&format!("{head}{path}"))), Ok(()));
    assert_eq!(timed("100000 points", &|| case(&format!("{table}{press}"))), Ok(()));
    assert_eq!(timed("10000 values", &|| study(&grid)), Ok(()));
    let refused = timed("48 million values", &|| study(&huge)).expect_err("too many");
    assert!(refused.contains("combinations of about") && refused.contains("fewer combinations"), "{refused}");
    for (name, text) in [
        ("brackets", format!("a = {}", "[".repeat(100_000))),
        ("tables", format!("a = {}", "{b=".repeat(100_000))),
        ("dots", format!("{}b = 1", "a.".repeat(100_000))),
        ("spaced dots", format!("x = {{ {}b = 1 }}", "a . ".repeat(100_000))),
    ] {
        let message = timed(name, &|| case(&text)).expect_err(name);
        assert!(message.starts_with("case.toml:1: not valid TOML: ") && message.len() < 1000, "{name}: {message}");
    }
    let set = timed("--set", &|| {
        Case::parse(CASE, "case.toml", &[format!("{}b=1", "a.".repeat(50_000))]).map(drop).map_err(|error| error.to_string())
    });
    assert!(set.expect_err("too deep").contains("more than 64 parts"));
    let error = Case::load(Path::new("/dev/zero"), &[]).expect_err("no end").to_string();
    assert!(error.contains("more than 16 MiB"), "{error}");
}

/// A message names a value; it does not repeat a book.
#[test]
fn long_values_are_shortened_in_messages() {
    let long = "x".repeat(5000);
    for set in [format!("contact.friction={long}"), format!("{long}=1"), format!("contact.friction=[\"{long}\"")] {
        let message = Case::parse(CASE, "case.toml", &[set]).expect_err("refused").to_string();
        assert!(message.contains("characters ...]") && message.len() < 1200, "{message}");
    }
    let scratch = scratch();
    for option in [format!("--device={long}"), format!("--threads={long}")] {
        let output = scratch.run("out", &[&option]);
        assert_eq!(output.status.code(), Some(2));
        assert!(stderr(&output).len() < 1500, "{}", stderr(&output));
    }
    let output = program().arg("devices").env("ASPERITY_GPU_MEMORY", "abc").output().expect("it runs");
    assert_eq!(output.status.code(), Some(2));
    let message = stderr(&output);
    assert!(message.contains("ASPERITY_GPU_MEMORY=abc: is not a whole number of MiB"), "{message}");
    let mut args = scratch.args("out", &[]);
    args.iter_mut().filter(|arg| *arg == "1").for_each(|arg| *arg = "100000".into());
    let output = program().args(args).output().expect("it runs");
    let message = stderr(&output);
    assert!(output.status.code() == Some(2) && message.contains("a number of threads is from 1 to"), "{message}");
    assert!(!scratch.path("out").exists());
}
