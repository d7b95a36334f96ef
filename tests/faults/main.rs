//! What may happen to a run beside mechanics: it is killed at any system call that changes a file,
//! the disk fills, its directory is removed, linked or written by another run, and what it is given
//! is hostile.
//!
//! A share of the kills and 2,000 hostile inputs of each kind run by default; ASPERITY_FAULTS=all
//! runs every kill and 100,000 inputs, ASPERITY_FUZZ as many inputs as it says.
#![cfg(target_os = "linux")]

#[path = "../common/mod.rs"]
mod common;
mod directory;
mod full_disk;
mod hostile;
mod kills;
mod profile;
mod program;
#[path = "../common/programs.rs"]
mod programs;
mod signals;

/// Whether all is to be run and not a share.
fn all() -> bool {
    [("ASPERITY_FAULTS", "all"), ("ASPERITY_LONG", "1")]
        .iter()
        .any(|(name, all)| std::env::var_os(name).is_some_and(|v| v == *all))
}
