//! Runs changed inputs through what reads and uses them, and holds that to its limits.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::{Duration, Instant};

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rustix::time::{ClockId, clock_gettime};

const SEED: u64 = 15;
/// Processor time that an input may take.
const PATIENCE: Duration = Duration::from_secs(2);
/// Time after which one that has not ended never will, however busy the machine is.
const HANGS: Duration = Duration::from_secs(60);
/// What the process may have grown to, all together.
const MEMORY_KIB: usize = 256 << 10;
/// So many are told before a run is given up.
const TOLD: usize = 5;

/// Inputs of each kind: `ASPERITY_FUZZ` says another number.
fn count() -> usize {
    let asked = std::env::var("ASPERITY_FUZZ").ok().map(|count| count.parse().expect("ASPERITY_FUZZ is a number of inputs"));
    asked.unwrap_or(if super::super::all() { 100_000 } else { 2000 })
}

fn processor_time() -> Duration {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    Duration::new(now.tv_sec.try_into().expect("a time"), now.tv_nsec.try_into().expect("a time"))
}

/// Set in the process that has one kind of input to itself.
const ALONE: &str = "ASPERITY_FUZZ_ALONE";

/// Runs this very test in a process of its own, whose memory is that of one kind of input, and
/// whose death is seen.
fn alone() {
    let name = std::thread::current().name().expect("a test has a name").to_owned();
    let program = std::env::current_exe().expect("this program");
    let output = Command::new(program).args(["--exact", &name, "--nocapture"]).env(ALONE, "1").output().expect("it runs");
    let [out, errors] = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    println!("{}", out.lines().filter(|line| line.contains(" inputs in ")).collect::<Vec<_>>().join("\n"));
    assert!(output.status.success(), "{name}: {}\n{out}{errors}", output.status);
    assert!(out.contains("1 passed"), "{name}: no such test\n{out}");
}

fn greatest_memory_kib() -> usize {
    let status = fs::read_to_string("/proc/self/status").expect("the state of this process");
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).expect("its greatest size");
    line.trim().trim_end_matches(" kB").trim().parse().expect("a number")
}

/// Makes inputs with `next` and hands each to `take`, as bytes and as a file; `take` says whether
/// it was taken. No panic, none takes two seconds, all together take no 256 MiB; some are taken, at
/// least the share `least` of them, or the changes are too great to find anything.
pub fn fuzz(
    kind: &'static str,
    least: f64,
    mut next: impl FnMut(&mut ChaCha8Rng) -> Vec<u8> + Send + 'static,
    take: impl Fn(&[u8], &Path) -> bool + Send + 'static,
) {
    if std::env::var_os(ALONE).is_none() {
        return alone();
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("hostile");
    fs::create_dir_all(&folder).expect("a folder");
    // Left there when the process itself dies.
    let path = folder.join(format!("{kind}.{}", std::process::id()));
    let (count, begun) = (count(), Instant::now());
    let (tell, told) = channel();
    let file = path.clone();
    let worker = std::thread::spawn(move || {
        let mut rng = ChaCha8Rng::seed_from_u64(SEED);
        for number in 0..count {
            let bytes = next(&mut rng);
            fs::write(&file, &bytes).expect("a file");
            let start = processor_time();
            let result = catch_unwind(AssertUnwindSafe(|| take(&bytes, &file))).map_err(|panic| {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic").to_owned()
            });
            if tell.send((number, bytes, result, processor_time() - start)).is_err() {
                return;
            }
        }
    });
    let keep = |number: usize, bytes: &[u8]| -> PathBuf {
        let kept = folder.join(format!("{kind}-{number}"));
        fs::write(&kept, bytes).expect("the input");
        kept
    };
    let (mut taken, mut ran, mut slowest, mut faults) = (0, 0, Duration::ZERO, Vec::new());
    loop {
        match told.recv_timeout(HANGS) {
            Ok((number, bytes, result, took)) => {
                ran += 1;
                slowest = slowest.max(took);
                taken += usize::from(result == Ok(true));
                let fault = match result {
                    Err(panic) => Some(panic),
                    Ok(_) if took > PATIENCE => Some(format!("{took:?} of processor time")),
                    Ok(_) => None,
                };
                faults.extend(fault.map(|fault| format!("{fault}: {}", keep(number, &bytes).display())));
                if faults.len() >= TOLD {
                    break;
                }
            }
            Err(RecvTimeoutError::Timeout) => {
                faults.push(format!("no end within {HANGS:?}: {}", path.display()));
                break;
            }
            Err(RecvTimeoutError::Disconnected) => break,
        }
    }
    drop(told);
    if faults.is_empty() {
        worker.join().expect("the inputs are made");
        fs::remove_file(&path).expect("the last input");
    }
    let memory = greatest_memory_kib();
    println!(
        "{kind}: {ran} inputs in {:.1} s, {taken} taken; slowest {slowest:?}, greatest memory {memory} KiB",
        begun.elapsed().as_secs_f64()
    );
    assert!(faults.is_empty(), "{kind}, of {ran} inputs of seed {SEED}: {faults:#?}");
    assert!(memory < MEMORY_KIB, "{kind}: {memory} KiB");
    assert!(taken as f64 >= least * ran as f64 && taken < ran, "{kind}: {taken} of {ran} inputs were taken");
}
