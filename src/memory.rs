//! How much memory there is for this process, and what it is taken for.
//!
//! The least counts of what the machine has, what the control groups of the process and their
//! parents allow (a container, a job of a cluster), and the limit of its address space (`ulimit
//! -v`). Only refusals depend on it: no result does.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Bytes in a GiB.
pub const GIB: f64 = 1024.0 * 1024.0 * 1024.0;
/// What is taken where the system does not tell, in GiB.
pub const ASSUMED_GIB: f64 = 8.0;
/// What is left out: this share for the system and what else runs, and so many bytes for the
/// program itself.
const MARGIN: (f64, f64) = (0.1, 64.0 * 1024.0 * 1024.0);

/// How much memory this process may take.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// In GiB, less a margin.
    pub gib: f64,
    /// What says so.
    pub from: Origin,
}

/// What limits the memory of the process.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Origin {
    /// What the machine has.
    Machine,
    /// A control group: the file that holds its limit.
    ControlGroup(PathBuf),
    /// The limit of the address space.
    AddressSpace,
    /// Nothing that could be read.
    Assumed,
}

impl Room {
    /// What each case side by side takes of it beside its own memory, in GiB: of an address space,
    /// two threads with their stacks and what the system's allocator sets aside for each, unused.
    pub fn of_each_worker(&self) -> f64 {
        if self.from == Origin::AddressSpace { 2.0 * (64.0 + 2.0) / 1024.0 } else { 0.0 }
    }
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Machine => f.write_str("what the machine has"),
            Self::ControlGroup(file) => write!(f, "what its container or job has, {}", file.display()),
            Self::AddressSpace => f.write_str("the limit of its address space, ulimit -v"),
            Self::Assumed => f.write_str("assumed, as this system does not tell"),
        }
    }
}

impl fmt::Display for Room {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:.2} GiB that there are for this process ({}, less a margin)", self.gib, self.from)
    }
}

/// The memory that there is for this process.
pub fn room() -> Room {
    least(&of_system)
}

/// Bytes that this process may take now: what the machine has free, and of each of its control
/// groups what is left. `None` where the system does not tell.
pub fn left() -> Option<u64> {
    left_of(&of_system)
}

fn of_system(path: &Path) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

/// [`room`], by what `read` says of files of the system.
fn least(read: &dyn Fn(&Path) -> Option<String>) -> Room {
    let machine = read(Path::new("/proc/meminfo")).and_then(|text| total(&text)).map(|bytes| (bytes, Origin::Machine));
    let groups = groups(read).into_iter().map(|(file, bytes)| (bytes, Origin::ControlGroup(file)));
    let address_space = address_space_left(read).map(|bytes| (bytes, Origin::AddressSpace));
    let known = machine.into_iter().chain(groups).chain(address_space);
    match known.min_by_key(|(bytes, _)| *bytes) {
        Some((bytes, from)) => Room { gib: ((1.0 - MARGIN.0) * bytes as f64 - MARGIN.1).max(0.0) / GIB, from },
        None => Room { gib: ASSUMED_GIB, from: Origin::Assumed },
    }
}

/// [`left`], by what `read` says of files of the system.
fn left_of(read: &dyn Fn(&Path) -> Option<String>) -> Option<u64> {
    let machine = read(Path::new("/proc/meminfo")).and_then(|text| kibibytes(&text, "MemAvailable:"));
    let groups = groups(read).into_iter().filter_map(|(file, limit)| {
        let beside = |name: &str| read(&file.with_file_name(name));
        let used = beside("memory.current").or_else(|| beside("memory.usage_in_bytes")).and_then(|text| bytes(&text))?;
        // Copies of files count as used, and are given up for whoever needs the room.
        let stat = beside("memory.stat").unwrap_or_default();
        let of = |name: &str| stat.lines().find_map(|line| bytes(line.strip_prefix(name)?)).unwrap_or(0);
        Some(limit.saturating_sub(used.saturating_sub(of("inactive_file ").saturating_add(of("active_file ")))))
    });
    machine.into_iter().chain(groups).chain(address_space_left(read)).min()
}

/// The control groups of the process that have a limit: the file that holds it, and its bytes.
fn groups(read: &dyn Fn(&Path) -> Option<String>) -> Vec<(PathBuf, u64)> {
    let files = read(Path::new("/proc/self/cgroup")).map_or(Vec::new(), |text| limit_files(&text));
    files.into_iter().filter_map(|file| bytes(&read(&file)?).map(|bytes| (file, bytes))).collect()
}

/// What the limit of the address space leaves to the process, in bytes.
fn address_space_left(read: &dyn Fn(&Path) -> Option<String>) -> Option<u64> {
    let limit = read(Path::new("/proc/self/limits")).and_then(|text| address_space(&text))?;
    // Of that the program has a part already.
    let taken = read(Path::new("/proc/self/status")).and_then(|text| kibibytes(&text, "VmSize:")).unwrap_or(0);
    Some(limit.saturating_sub(taken))
}

/// MemTotal of `/proc/meminfo`, in bytes.
fn total(meminfo: &str) -> Option<u64> {
    kibibytes(meminfo, "MemTotal:")
}

fn kibibytes(meminfo: &str, name: &str) -> Option<u64> {
    let line = meminfo.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()?.checked_mul(1024)
}

/// The soft limit of the address space of `/proc/self/limits`, in bytes, if there is one.
fn address_space(limits: &str) -> Option<u64> {
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    line.split_whitespace().next()?.parse().ok()
}

/// The bytes of `memory.max` or `memory.limit_in_bytes`; `None` for "max".
fn bytes(limit: &str) -> Option<u64> {
    limit.trim().parse().ok()
}

/// The files in which the limits of the groups of `/proc/self/cgroup` and of their parents may
/// stand: those of version 2, and those of the memory controller of version 1.
fn limit_files(cgroup: &str) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for line in cgroup.lines() {
        let mut parts = line.splitn(3, ':');
        let (Some(_), Some(controllers), Some(path)) = (parts.next(), parts.next(), parts.next()) else { continue };
        let (roots, name): (&[&str], _) = if controllers.is_empty() {
            (&["/sys/fs/cgroup", "/sys/fs/cgroup/unified"], "memory.max")
        } else if controllers.split(',').any(|controller| controller == "memory") {
            (&["/sys/fs/cgroup/memory"], "memory.limit_in_bytes")
        } else {
            continue;
        };
        // A group outside of those that the process sees begins with "..".
        let group: PathBuf =
            Path::new(path).components().filter(|part| matches!(part, std::path::Component::Normal(_))).collect();
        for root in roots {
            files.extend(group.ancestors().map(|group| Path::new(root).join(group).join(name)));
        }
    }
    files
}

/// Elements of the largest mesh so far, and most cases side by side: what memory was taken for, if
/// there is no more of it.
static LARGEST: [AtomicUsize; 2] = [AtomicUsize::new(0), AtomicUsize::new(0)];

/// Keeps in mind that there is a mesh of so many elements.
pub fn meshed(elements: usize) {
    LARGEST[0].fetch_max(elements, Ordering::Relaxed);
}

/// Keeps in mind that so many cases are computed side by side.
pub fn side_by_side(cases: usize) {
    LARGEST[1].fetch_max(cases, Ordering::Relaxed);
}

/// Writes what to do about an allocation of so many bytes that failed. Takes no memory itself.
///
/// # Errors
/// Those of `out`.
pub fn explain_failure(out: &mut dyn fmt::Write, bytes: usize) -> fmt::Result {
    let [elements, cases] = LARGEST.each_ref().map(|number| number.load(Ordering::Relaxed));
    // Of 1 MiB in tenths: numbers of floating point would do, but need more of the library.
    let tenths = bytes / (1024 * 1024 / 10);
    write!(out, "error: out of memory: {}.{} MiB more were asked for and cannot be had", tenths / 10, tenths % 10)?;
    match (elements, cases) {
        (0, _) => out.write_str(". What is read or made here is too large for the memory that there is. Take less of it")?,
        (_, 0 | 1) => write!(out, ". A mesh of {elements} elements is too large for the memory that there is")?,
        _ => write!(
            out,
            ". {cases} cases side by side, meshes of up to {elements} elements, are too large for the memory that there is"
        )?,
    }
    if elements > 0 {
        out.write_str(
            ". Take fewer elements (mesh.elements_per_contact_radius, mesh.surface_elements_per_contact_radius, mesh.fine_zone)",
        )?;
    }
    if cases > 1 {
        out.write_str(", fewer cases side by side (--threads)")?;
    }
    out.write_str(", or allow more memory (the machine, the job's or the container's limit, ulimit -v)")?;
    if elements > 0 {
        out.write_str("; what was computed is kept, and --resume goes on")?;
    }
    out.write_str("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    const MEMINFO: &str = "MemTotal:       16316412 kB\nMemFree:         9133000 kB\nMemAvailable:   13113804 kB\n";
    const LIMITS: &str = "Limit                     Soft Limit           Hard Limit           Units     \n\
        Max stack size            8388608              unlimited            bytes     \n\
        Max address space         unlimited            unlimited            bytes     \n";

    #[test]
    fn the_machine_tells_its_memory() {
        assert_eq!(total(MEMINFO), Some(16_316_412 * 1024));
        for wrong in [
            "",
            "MemTotal: many kB\n",
            "MemTotal: 12\n",
            "MemTotal: 99999999999999999999 kB\n",
            "MemTotal: 18446744073709551615 kB",
        ] {
            assert_eq!(total(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_limit_of_the_address_space_is_the_soft_one() {
        assert_eq!(address_space(LIMITS), None);
        let limited = LIMITS.replace("space         unlimited ", "space         409600000 ");
        assert_eq!(address_space(&limited), Some(409_600_000));
        assert_eq!(address_space(""), None);
    }

    #[test]
    fn a_group_without_a_limit_has_max() {
        assert_eq!([bytes("max\n"), bytes("536870912\n"), bytes("")], [None, Some(1 << 29), None]);
    }

    #[test]
    fn the_limits_of_all_parents_count() {
        let files = |cgroup: &str| -> Vec<String> { limit_files(cgroup).iter().map(|file| file.display().to_string()).collect() };
        let second = files("0::/slurm/job_7\n");
        assert_eq!(
            second[..3],
            ["/sys/fs/cgroup/slurm/job_7/memory.max", "/sys/fs/cgroup/slurm/memory.max", "/sys/fs/cgroup/memory.max"]
        );
        assert!(second.contains(&"/sys/fs/cgroup/unified/slurm/memory.max".to_owned()));
        let first = files("12:cpu,cpuacct:/a\n7:memory:/docker/4711\n1:name=systemd:/a\n");
        let of = |group: &str| format!("/sys/fs/cgroup/memory/{group}memory.limit_in_bytes");
        assert_eq!(first, [of("docker/4711/"), of("docker/"), of("")]);
        // A process outside of the groups that it sees, a name with a colon, and what is no list.
        assert_eq!(files("0::/../../other\n")[0], "/sys/fs/cgroup/other/memory.max");
        assert_eq!(files("0::/a:b\n")[0], "/sys/fs/cgroup/a:b/memory.max");
        assert!(files("nonsense\n\n1:memory\n").is_empty());
    }

    fn of(files: &[(&str, &str)]) -> Room {
        least(&|path| files.iter().find(|(name, _)| Path::new(name) == path).map(|(_, text)| (*text).to_owned()))
    }

    #[test]
    fn the_least_of_them_is_what_there_is() {
        let gib = |bytes: f64| (0.9 * bytes - MARGIN.1) / GIB;
        let machine = ("/proc/meminfo", MEMINFO);
        assert_eq!(of(&[machine]), Room { gib: gib(16_316_412.0 * 1024.0), from: Origin::Machine });
        let group = ("/proc/self/cgroup", "0::/job/step\n");
        let parent = ("/sys/fs/cgroup/job/memory.max", "2147483648\n");
        let job = of(&[machine, group, parent, ("/sys/fs/cgroup/job/step/memory.max", "max\n")]);
        assert_eq!(job, Room { gib: gib(2.0 * GIB), from: Origin::ControlGroup(parent.0.into()) });
        assert_eq!(
            job.to_string(),
            "1.74 GiB that there are for this process (what its container or job has, /sys/fs/cgroup/job/memory.max, less a margin)"
        );
        let limited = LIMITS.replace("space         unlimited ", "space         409600000 ");
        let limits = limited;
        let limited = of(&[machine, group, parent, ("/proc/self/limits", &limits)]);
        assert_eq!(limited, Room { gib: gib(409_600_000.0), from: Origin::AddressSpace });
        assert!(limited.of_each_worker() > 0.1 && job.of_each_worker() == 0.0);
        let status = ("/proc/self/status", "VmPeak:\t  300000 kB\nVmSize:\t  200000 kB\n");
        assert_eq!(of(&[machine, ("/proc/self/limits", &limits), status]).gib, gib(409_600_000.0 - 204_800_000.0));
        // The first version says "no limit" with a number above all others.
        let none = [
            machine,
            ("/proc/self/cgroup", "7:memory:/\n"),
            ("/sys/fs/cgroup/memory/memory.limit_in_bytes", "9223372036854771712"),
        ];
        assert_eq!(of(&none).from, Origin::Machine);
        // No machine at all is left with less than nothing.
        assert_eq!(of(&[("/proc/meminfo", "MemTotal: 10 kB")]).gib, 0.0);
    }

    #[test]
    fn what_is_left_is_that_of_the_machine_or_of_the_narrowest_group() {
        let left = |files: &[(&str, &str)]| {
            left_of(&|path| files.iter().find(|(name, _)| Path::new(name) == path).map(|(_, text)| (*text).to_owned()))
        };
        let machine = ("/proc/meminfo", MEMINFO);
        assert_eq!(left(&[machine]), Some(13_113_804 * 1024));
        let group = [
            machine,
            ("/proc/self/cgroup", "0::/job/step\n"),
            ("/sys/fs/cgroup/job/memory.max", "2000000\n"),
            ("/sys/fs/cgroup/job/memory.current", "1500000\n"),
            ("/sys/fs/cgroup/job/memory.stat", "anon 1100000\ninactive_file 300000\nactive_file 100000\n"),
        ];
        assert_eq!(left(&group), Some(900_000));
        let first = [
            ("/proc/self/cgroup", "7:memory:/a\n"),
            ("/sys/fs/cgroup/memory/a/memory.limit_in_bytes", "5000"),
            ("/sys/fs/cgroup/memory/a/memory.usage_in_bytes", "4000"),
        ];
        assert_eq!(left(&first), Some(1000));
        assert_eq!(left(&[]), None);
    }

    #[test]
    fn where_nothing_is_told_it_is_as_it_was() {
        assert_eq!(of(&[]), Room { gib: 8.0, from: Origin::Assumed });
        assert_eq!(of(&[("/proc/meminfo", "?"), ("/proc/self/cgroup", "?")]).from, Origin::Assumed);
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn this_machine_tells() {
        let room = room();
        assert!(room.gib > 0.1 && room.from != Origin::Assumed, "{room:?}");
    }
}
