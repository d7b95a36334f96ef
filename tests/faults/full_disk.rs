//! A disk that is full at any place: what is told is true, and with room again the run goes on to
//! the same bits.

use std::fs;
use std::process::Command;

use asperity::output::{RunStatus, Summary};

use super::common::{difference, files, stderr};
use super::program::{scratch, skipped, whole};

/// A file system in memory, of a size; unmounted when dropped.
struct Small(std::path::PathBuf);

impl Small {
    fn mount(at: std::path::PathBuf, kib: usize) -> Option<Self> {
        std::fs::create_dir_all(&at).expect("a directory");
        let mounted = Command::new("mount").args(["-t", "tmpfs", "-o", &format!("size={kib}k"), "tmpfs"]).arg(&at).output();
        mounted.is_ok_and(|output| output.status.success()).then_some(Self(at))
    }

    fn widen(&self) {
        let widened = Command::new("mount").args(["-o", "remount,size=64m"]).arg(&self.0).output().expect("mount runs");
        assert!(widened.status.success(), "{}", stderr(&widened));
    }
}

impl Drop for Small {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg(&self.0).output();
    }
}

#[test]
fn a_disk_that_is_full_at_any_place_is_told_and_the_run_goes_on_with_room() {
    let scratch = scratch();
    let total = files(whole()).values().map(|bytes| bytes.len().div_ceil(4096) * 4).sum::<usize>();
    let (mut full, mut while_drawing) = (0, 0);
    let sizes = if super::all() { 40 } else { 10 };
    for part in 0..sizes {
        // Closer together towards the end, where the pictures are drawn.
        let left = sizes - part - 1;
        let room = total - total * left * left / (sizes * sizes);
        let Some(disk) = Small::mount(scratch.path(format!("disk{part}")), 8 + room) else {
            return skipped("full_disk", "no right to mount a tmpfs");
        };
        let out = disk.0.join("out");
        let output = scratch.run(&out, &["-q"]);
        let (code, message) = (output.status.code(), stderr(&output));
        if code != Some(0) {
            full += 1;
            assert!(message.lines().filter(|line| line.starts_with("error: ")).count() == 1, "{message}");
            assert!(code == Some(3) || code == Some(2), "{code:?} {message}");
            let summary = Summary::read(&out.join("summary.json")).ok();
            assert!(summary.is_none_or(|summary| summary.status != RunStatus::Done), "done, but {message}");
            while_drawing += usize::from(message.contains("plots/"));
        }
        disk.widen();
        let output = scratch.run(&out, &["-q", "--resume"]);
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let kept = out.join("checkpoint.bin");
        if code == Some(0) && !kept.exists() {
            // There was room for all but the last checkpoint, which is for a longer path alone.
            let mut told = Summary::read(&out.join("summary.json")).expect("a summary");
            let note = told.messages.pop().expect("a note");
            assert!(note.contains("--extend is not possible"), "{note}");
            told.write(&out.join("summary.json")).expect("written");
            fs::copy(whole().join("checkpoint.bin"), kept).expect("copied");
        }
        if code != Some(0) {
            let told = Summary::read(&out.join("summary.json")).expect("a summary");
            // A disk that was too full for a checkpoint is no difference in what was computed.
            assert_eq!(told.status, RunStatus::Done);
        }
        assert_eq!(difference(&out, whole()), None, "after {code:?} {message}");
    }
    println!("{full} of {sizes} disks were full, {while_drawing} of them while the plots were drawn");
    assert!(full > 2 && while_drawing > 0, "{full} {while_drawing}");
}
