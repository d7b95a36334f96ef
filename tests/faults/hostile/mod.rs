//! Hostile input: what is in the corpus and the fixtures, changed at random, through every parser.
//! No panic, none takes two seconds, all together no gigabyte.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use asperity::case::Case;
use asperity::law::Law;
use asperity::law::table::StudyTable;
use asperity::output::{Checkpoint, Summary, read_contact, read_history};
use asperity::study::Study;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rustix::process::{Pid, Signal, kill_process};

use super::common::{program, stderr};
use super::program::{CASE, scratch, whole};

const SEED: u64 = 15;
const PATIENCE: Duration = Duration::from_secs(2);
const MEMORY_KIB: usize = 1 << 20;
/// What a changed input may have; larger ones are read no otherwise, only slower.
const LARGEST: usize = 1 << 18;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Case,
    Study,
    Law,
    History,
    Contact,
    Summary,
    Table,
    Checkpoint,
}

/// Put in place of what stands there, or beside it.
const WORDS: [&str; 40] = [
    "nan",
    "-nan",
    "inf",
    "-inf",
    "0",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-308",
    "5e-324",
    "1e999",
    "9223372036854775807",
    "-9223372036854775808",
    "99999999999999999999",
    "0x7fffffffffffffff",
    "0b1",
    "1_000_000",
    "true",
    "\"stick\"",
    "\"full-slip\"",
    "[",
    "]",
    "{",
    "}",
    "[[",
    "]]",
    "[[path]]\n",
    "[grid]\n",
    "=",
    ",",
    ".",
    "\"",
    "\"\"\"",
    "'",
    "\\u0000",
    "\u{0}",
    "1979-05-27T07:32:00Z",
    "a.b.c.d",
    "null",
    "\r\n",
];

fn seeds(kind: Kind, dirs: &[&str], ends: &str) -> Vec<(Kind, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for dir in dirs {
        let mut paths: Vec<PathBuf> =
            fs::read_dir(root.join(dir)).expect("a corpus").map(|entry| entry.expect("an entry").path()).collect();
        paths.sort();
        for path in paths.iter().filter(|path| path.to_string_lossy().ends_with(ends)) {
            found.push((kind, fs::read(path).expect("a file")));
        }
    }
    found
}

/// The corpus: fixtures, files that are hostile as they stand, and what a run leaves.
fn corpus() -> Vec<(Kind, Vec<u8>)> {
    let mut all = seeds(Kind::Case, &["fixtures/cases", "fixtures/cases/bad", "tests/faults/corpus"], ".toml");
    // Without the study of 240 cases, which takes as long as the rest together.
    all.extend(seeds(Kind::Study, &["fixtures/studies", "fixtures/studies/bad", "tests/faults/corpus"], ".toml"));
    all.retain(|(kind, bytes)| *kind != Kind::Study || bytes.len() < 2000);
    all.push((Kind::Law, small_law()));
    let read = |path: PathBuf| fs::read(path).expect("a file of the run");
    all.push((Kind::History, read(whole().join("history.csv"))));
    all.push((Kind::Summary, read(whole().join("summary.json"))));
    let contact = fs::read_dir(whole().join("contact")).expect("tables").next().expect("a table").expect("an entry").path();
    all.push((Kind::Contact, read(contact)));
    let table = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law/study.csv")).expect("a table");
    all.push((Kind::Table, table.lines().take(6).collect::<Vec<_>>().join("\n").into_bytes()));
    all.push((Kind::Checkpoint, checkpoint()));
    all
}

/// The law of the fixtures without the cases it was fitted to, which are most of it.
fn small_law() -> Vec<u8> {
    let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law/law.json")).expect("a law");
    let mut law: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    for value in law.as_object_mut().expect("an object").values_mut() {
        if let Some(items) = value.as_array_mut() {
            items.truncate(2);
        }
    }
    serde_json::to_vec_pretty(&law).expect("JSON")
}

/// That of a run that was interrupted.
fn checkpoint() -> Vec<u8> {
    let scratch = scratch();
    let out = scratch.path("out");
    let args = scratch.args(&out, &["-q", "--set", "solver.press_steps=60"]);
    let mut child = program().args(args).stderr(std::process::Stdio::null()).spawn().expect("it runs");
    while !out.join("checkpoint.bin").exists() {
        std::thread::sleep(Duration::from_millis(1));
    }
    kill_process(Pid::from_child(&child), Signal::TERM).expect("a signal is sent");
    child.wait().expect("it ends");
    fs::read(out.join("checkpoint.bin")).expect("a checkpoint")
}

fn mutated(rng: &mut ChaCha8Rng, seed: &[u8], other: &[u8]) -> Vec<u8> {
    let mut bytes = seed.to_vec();
    for _ in 0..rng.random_range(1..=4) {
        let length = bytes.len();
        let at = rng.random_range(0..=length);
        let end = (at + rng.random_range(0..=16)).min(length);
        match rng.random_range(0..9) {
            0 if at < length => bytes[at] ^= 1 << rng.random_range(0..8),
            1 if at < length => bytes[at] = rng.random(),
            2 => drop(bytes.splice(at..end, [])),
            3 => drop(bytes.splice(at..at, WORDS[rng.random_range(0..WORDS.len())].bytes())),
            4 => {
                // In place of a number or a word.
                let word = |byte: &u8| byte.is_ascii_alphanumeric() || b".+-_\"".contains(byte);
                let end = at + bytes[at..].iter().take_while(|byte| word(byte)).count();
                drop(bytes.splice(at..end, WORDS[rng.random_range(0..WORDS.len())].bytes()));
            }
            5 => bytes.truncate(at),
            6 => {
                let from = rng.random_range(0..=other.len());
                let to = (from + rng.random_range(0..=200)).min(other.len());
                drop(bytes.splice(at..at, other[from..to].iter().copied()));
            }
            7 => {
                let end = (at + rng.random_range(0..=64)).min(length);
                let times = 1 << rng.random_range(0..=10);
                let piece = bytes[at..end].repeat(times);
                drop(bytes.splice(at..at, piece));
            }
            _ => {
                let line = bytes[..at].iter().rposition(|byte| *byte == b'\n').map_or(0, |line| line + 1);
                let piece: Vec<u8> = bytes[line..].iter().copied().take_while(|byte| *byte != b'\n').collect();
                drop(bytes.splice(line..line, piece.into_iter().chain([b'\n'])));
            }
        }
        bytes.truncate(LARGEST);
    }
    bytes
}

/// Through its parser; true if it was taken.
fn parse(kind: Kind, bytes: &[u8], path: &Path) -> bool {
    let text = || String::from_utf8_lossy(bytes).into_owned();
    match kind {
        Kind::Case => Case::parse(&text(), "case.toml", &[]).is_ok_and(|case| {
            let again = Case::parse(&case.to_toml(), "again.toml", &[]).expect("a resolved case is a case");
            assert_eq!(again, case);
            let _ = case.material.constants::<f64>();
            true
        }),
        Kind::Study => Study::parse(&text(), "study.toml").is_ok(),
        _ => {
            fs::write(path, bytes).expect("a file");
            match kind {
                Kind::Law => Law::read(path).is_ok(),
                Kind::History => read_history(path).is_ok(),
                Kind::Contact => read_contact(path).is_ok(),
                Kind::Summary => Summary::read(path).is_ok(),
                Kind::Table => StudyTable::read(path).is_ok(),
                _ => matches!(Checkpoint::read(path), Ok(Some(_))),
            }
        }
    }
}

/// With the sum that belongs to it, so that what is behind the sum sees it.
fn summed(mut bytes: Vec<u8>) -> Vec<u8> {
    let stored = bytes.len().saturating_sub(4);
    let sum = crc32fast::hash(&bytes[..stored]);
    bytes.truncate(stored);
    bytes.extend(sum.to_le_bytes());
    bytes
}

fn greatest_memory_kib() -> usize {
    let status = fs::read_to_string("/proc/self/status").expect("the state of this process");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("its greatest size");
    line.trim().trim_end_matches(" kB").trim().parse().expect("a number")
}

#[test]
fn changed_inputs_are_refused_or_taken_but_never_a_panic_a_hang_or_all_memory() {
    let corpus = corpus();
    let of = |kind: Kind| corpus.iter().filter(|(k, _)| *k == kind).map(|(_, bytes)| bytes.as_slice()).collect::<Vec<_>>();
    let kinds = [Kind::Case, Kind::Study, Kind::Law, Kind::History, Kind::Contact, Kind::Summary, Kind::Table, Kind::Checkpoint];
    let seeds = kinds.map(of);
    let is_right = |bytes: &&&[u8]| Case::parse(&String::from_utf8_lossy(bytes), "case.toml", &[]).is_ok();
    let right: Vec<&[u8]> = seeds[0].iter().filter(is_right).copied().collect();
    assert!(right.len() >= 10, "{}", right.len());
    let scratch = tempfile::tempdir().expect("a scratch directory");
    let path = scratch.path().join("input");
    let total = if super::all() { 1_000_000 } else { 20_000 };
    let mut rng = ChaCha8Rng::seed_from_u64(SEED);
    let (mut taken, mut slowest) = ([0usize; 8], Duration::ZERO);
    let mut counts = [0usize; 8];
    let keep = |bytes: &[u8]| {
        let kept = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hostile-input");
        fs::write(&kept, bytes).expect("the input");
        kept
    };
    for number in 0..total {
        // Mostly cases, as that is what people write; few of what is large.
        let kind = match rng.random_range(0..1000) {
            0..830 => 0,
            830..860 => 1,
            860..870 => 2,
            870..900 => 3,
            900..920 => 4,
            920..960 => 5,
            960..998 => 6,
            _ => 7,
        };
        // What is right as it stands comes more often: what is wrong already ends early.
        let from = if kind == 0 && rng.random_range(0..3) > 0 { &right } else { &seeds[kind] };
        let seed = from[rng.random_range(0..from.len())];
        let (_, other) = &corpus[rng.random_range(0..corpus.len() - 1)];
        // Checkpoints are larger than the rest and come whole.
        let mut bytes = if kind == 7 { seed.to_vec() } else { mutated(&mut rng, seed, other) };
        if kind == 7 {
            let line = bytes.iter().position(|byte| *byte == b'\n').expect("a first line");
            for _ in 0..rng.random_range(1..=4) {
                let at = rng.random_range(line + 1..bytes.len());
                bytes[at] = rng.random();
            }
            if rng.random_range(0..2) == 0 {
                bytes.truncate(rng.random_range(line + 5..bytes.len()));
            }
            bytes = summed(bytes);
        }
        let begun = Instant::now();
        let parsed = catch_unwind(AssertUnwindSafe(|| parse(kinds[kind], &bytes, &path)));
        let took = begun.elapsed();
        let name = || format!("{:?}, input {number} of seed {SEED}, kept in {}", kinds[kind], keep(&bytes).display());
        taken[kind] += usize::from(parsed.unwrap_or_else(|_| panic!("a panic: {}", name())));
        counts[kind] += 1;
        assert!(took < PATIENCE, "{took:?}: {}", name());
        slowest = slowest.max(took);
        if number % 256 == 0 {
            assert!(greatest_memory_kib() < MEMORY_KIB, "{} KiB: {}", greatest_memory_kib(), name());
        }
    }
    println!(
        "{total} inputs: {kinds:?} {counts:?}, taken {taken:?}; slowest {slowest:?}, greatest memory {} KiB",
        greatest_memory_kib()
    );
    assert!(taken.iter().zip(&counts).all(|(taken, count)| taken < count), "{taken:?} of {counts:?}");
    assert!(taken[0] > counts[0] / 50, "the changes are too great: {taken:?} of {counts:?}");
}

#[test]
fn every_damaged_checkpoint_is_refused() {
    let good = checkpoint();
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
