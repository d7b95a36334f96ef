//! `run.log`: what a run said and when, kept beside its results, with `-q` as well.

use super::{OutputDirectory, Position, Progress};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::time::Instant;

/// Passes everything on and keeps it in a file, a line each after the seconds since its start.
pub struct LoggedProgress {
    inner: Box<dyn Progress>,
    file: Option<File>,
    begun: Instant,
}

impl LoggedProgress {
    /// Goes on with the log of a directory; `head` is the first line of this part. A run is worth
    /// more than its log: where that cannot be written, there is none. A link is not followed.
    pub fn new(inner: Box<dyn Progress>, out: &OutputDirectory, head: &str) -> Self {
        let path = out.log();
        let opened = (!path.is_symlink()).then(|| OpenOptions::new().append(true).create(true).open(&path));
        let file = opened.and_then(Result::ok);
        let mut log = Self { inner, file, begun: Instant::now() };
        log.line(head);
        log
    }

    fn line(&mut self, text: &str) {
        let seconds = self.begun.elapsed().as_secs_f64();
        let written = self.file.as_mut().map(|file| file.write_all(format!("{seconds:9.2} s  {text}\n").as_bytes()));
        if let Some(Err(_)) = written {
            self.file = None;
        }
    }
}

impl Progress for LoggedProgress {
    fn step(&mut self, position: &Position) {
        self.line(&format!("{}  {}", position.place(), position.detail));
        self.inner.step(position);
    }

    fn message(&mut self, text: &str) {
        self.line(text);
        self.inner.message(text);
    }

    fn finish(&mut self, text: &str) {
        self.line(text);
        self.inner.finish(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::SilentProgress;

    fn logged(out: &OutputDirectory, head: &str) {
        let mut log = LoggedProgress::new(Box::new(SilentProgress), out, head);
        log.message("a note");
        log.step(&Position { step: 3, segment: 1, segments: 2, fraction: 0.5, detail: "F_N 72.6".into() });
        log.finish("done: 3 steps");
    }

    #[test]
    fn a_log_goes_on_where_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutputDirectory::create(folder.path()).unwrap();
        logged(&out, "first");
        logged(&out, "second");
        let text = std::fs::read_to_string(out.log()).unwrap();
        let said: Vec<&str> = text.lines().map(|line| line.split_once(" s  ").unwrap().1).collect();
        let step = "segment 1, step 3  F_N 72.6";
        assert_eq!(said, ["first", "a note", step, "done: 3 steps", "second", "a note", step, "done: 3 steps"]);
    }

    #[cfg(unix)]
    #[test]
    fn what_a_link_leads_to_is_not_written_to() {
        let folder = tempfile::tempdir().unwrap();
        let out = OutputDirectory::create(folder.path().join("out")).unwrap();
        let foreign = folder.path().join("foreign");
        std::fs::write(&foreign, "mine").unwrap();
        std::os::unix::fs::symlink(&foreign, out.log()).unwrap();
        logged(&out, "first");
        assert_eq!(std::fs::read_to_string(foreign).unwrap(), "mine");
    }
}
