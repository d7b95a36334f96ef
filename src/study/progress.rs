//! How far the study is: a bar on a terminal, plain lines elsewhere, nothing with `-q`. All of it
//! on stderr.

use std::collections::BTreeSet;
use std::io::{self, IsTerminal, Write};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use indicatif::{ProgressBar, ProgressStyle};

use super::row::{Row, RowStatus};
use crate::output::{BAR_PARTS, Position, Progress, in_words};

/// Told by all workers about their cases.
pub struct StudyProgress {
    display: Display,
    state: Mutex<ProgressState>,
}

enum Display {
    Silent,
    Bar(ProgressBar),
    Plain(Mutex<Box<dyn Write + Send>>),
}

struct ProgressState {
    begun: Instant,
    /// Cases that are to be computed, with their expected costs and the share of each that is
    /// behind.
    cost: Vec<f64>,
    behind: Vec<f64>,
    total: usize,
    done: usize,
    running: usize,
    failed: usize,
    told: BTreeSet<String>,
}

impl StudyProgress {
    /// What suits the place: nothing if `quiet`, a bar if stderr is a terminal, plain lines
    /// otherwise.
    pub fn new(quiet: bool) -> Self {
        Self::on(if quiet {
            Display::Silent
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::new(BAR_PARTS);
            // The template is fixed; should it ever be refused, the default style serves.
            if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {elapsed}  {msg}") {
                bar.set_style(style);
            }
            Display::Bar(bar)
        } else {
            Display::Plain(Mutex::new(Box::new(io::stderr())))
        })
    }

    fn on(display: Display) -> Self {
        let state = ProgressState {
            begun: Instant::now(),
            cost: Vec::new(),
            behind: Vec::new(),
            total: 0,
            done: 0,
            running: 0,
            failed: 0,
            told: BTreeSet::new(),
        };
        Self { display, state: Mutex::new(state) }
    }

    fn state(&self) -> MutexGuard<'_, ProgressState> {
        // A worker that panicked left counts behind, and counts are never half-made.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The work begins: expected costs of all cases, in any unit, and which of them there are to
    /// compute; the others have `done` and `failed` among them.
    pub fn begin(&self, headline: &str, costs: &[f64], to_compute: &[usize], done: usize, failed: usize) {
        let mut state = self.state();
        state.begun = Instant::now();
        state.cost = vec![0.0; costs.len()];
        to_compute.iter().for_each(|&case| state.cost[case] = costs[case]);
        state.behind = vec![0.0; costs.len()];
        (state.total, state.done, state.failed) = (done + failed + to_compute.len(), done, failed);
        drop(state);
        self.line(headline);
    }

    /// A case begins.
    pub fn started(&self) {
        self.state().running += 1;
        self.redraw();
    }

    /// This share of a case's path is behind.
    pub fn advanced(&self, case: usize, fraction: f64) {
        self.state().behind[case] = fraction.clamp(0.0, 1.0);
        self.redraw();
    }

    /// A case that had begun has ended.
    pub fn finished(&self, case: usize, id: &str, row: &Row) {
        let mut state = self.state();
        state.behind[case] = 1.0;
        state.running = state.running.saturating_sub(1);
        match row.status {
            RowStatus::Done => state.done += 1,
            RowStatus::Pending => {}
            _ => state.failed += 1,
        }
        let (ended, total) = (state.done + state.failed, state.total);
        let counts = state.counts();
        drop(state);
        let reason = if row.reason.is_empty() { String::new() } else { format!(": {}", row.reason) };
        match &self.display {
            Display::Bar(_) if row.status == RowStatus::Done => self.redraw(),
            Display::Bar(_) => self.line(&format!("{id} {}{reason}", row.status)),
            _ => self.line(&format!("{ended}/{total}  {id} {}{reason}  ({counts})", row.status)),
        }
    }

    /// Something that the user should know; the same text is said once, for the case in which it
    /// came up first.
    pub fn message(&self, id: &str, text: &str) {
        if self.state().told.insert(text.to_owned()) {
            self.line(&format!("{id}: {text}"));
        }
    }

    /// The last line.
    pub fn end(&self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    fn redraw(&self) {
        if let Display::Bar(bar) = &self.display {
            let state = self.state();
            bar.set_message(format!("of {} cases: {}", state.total, state.counts()));
            bar.set_position((state.share() * BAR_PARTS as f64) as u64);
        }
    }

    fn line(&self, text: &str) {
        // A closed stderr is no reason to stop computing.
        match &self.display {
            Display::Silent => {}
            Display::Bar(bar) => bar.suspend(|| {
                let _ = writeln!(io::stderr(), "{text}");
            }),
            Display::Plain(out) => {
                let mut out = out.lock().unwrap_or_else(PoisonError::into_inner);
                let _ = writeln!(out, "{text}").and_then(|()| out.flush());
            }
        }
    }
}

impl ProgressState {
    /// Share of the work that is behind, 0 to 1.
    fn share(&self) -> f64 {
        let all: f64 = self.cost.iter().sum();
        let behind: f64 = self.cost.iter().zip(&self.behind).map(|(cost, share)| cost * share).sum();
        if all > 0.0 { behind / all } else { 1.0 }
    }

    fn counts(&self) -> String {
        let Self { done, running, failed, .. } = self;
        let share = self.share();
        let left = if share >= 0.01 && done + failed < self.total {
            format!(", about {} left", in_words(self.begun.elapsed().as_secs_f64() * (1.0 - share) / share))
        } else {
            String::new()
        };
        format!("{done} done, {running} running, {failed} failed{left}")
    }
}

/// What one case's run tells.
pub struct CaseProgress {
    /// All of the study's.
    pub study: Arc<StudyProgress>,
    /// Index of the case.
    pub case: usize,
    /// Its number as text.
    pub id: String,
}

impl Progress for CaseProgress {
    fn step(&mut self, position: &Position) {
        self.study.advanced(self.case, position.fraction);
    }

    fn message(&mut self, text: &str) {
        self.study.message(&self.id, text);
    }

    fn finish(&mut self, _text: &str) {}
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{RunStatus, Summary};

    /// A writer that others can look into.
    #[derive(Clone, Default)]
    struct Shared(Arc<Mutex<Vec<u8>>>);

    impl Write for Shared {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            self.0.lock().unwrap().write(bytes)
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    fn row(status: RunStatus, message: &str) -> Row {
        Row::of(Summary { status, messages: vec![message.to_owned()], ..Summary::default() })
    }

    #[test]
    fn plain_lines_count_cases_and_name_the_reason() {
        let text = Shared::default();
        let progress = StudyProgress::on(Display::Plain(Mutex::new(Box::new(text.clone()))));
        progress.begin("5 cases", &[1.0, 2.0, 4.0, 1.0, 1.0], &[0, 1, 2], 1, 1);
        progress.started();
        progress.started();
        progress.message("c0001", "note: once");
        progress.message("c0002", "note: once");
        progress.finished(0, "c0001", &row(RunStatus::Done, "note: once"));
        progress.finished(1, "c0002", &row(RunStatus::NotConverged, "no convergence:\n step 3"));
        progress.end();
        let text = String::from_utf8(text.0.lock().unwrap().clone()).unwrap();
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines[..2], ["5 cases", "c0001: note: once"]);
        assert!(lines[2].starts_with("3/5  c0001 done  (2 done, 1 running, 1 failed, about "), "{text}");
        assert!(lines[3].starts_with("4/5  c0002 not-converged: no convergence: step 3  (2 done, 0 running, 2 failed"), "{text}");
        assert_eq!(lines.len(), 4);
    }

    #[test]
    fn work_is_weighed_by_cost() {
        let progress = StudyProgress::on(Display::Silent);
        assert_eq!(progress.state().share(), 1.0);
        progress.begin("", &[1.0, 9.0, 100.0], &[0, 1], 1, 0);
        progress.advanced(1, 0.5);
        assert!((progress.state().share() - 0.45).abs() < 1e-12);
        progress.finished(0, "c0001", &row(RunStatus::Done, ""));
        assert!((progress.state().share() - 0.55).abs() < 1e-12);
    }
}
