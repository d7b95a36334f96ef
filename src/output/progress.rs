//! How far the run is: a bar on a terminal, plain lines elsewhere, nothing with `-q`. All of it on stderr.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

/// Where a run stands after an accepted step.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Position {
    /// Steps accepted so far.
    pub step: usize,
    /// Segment of the path, from 0 as in `history.csv` and in the key `path.0`.
    pub segment: usize,
    /// Segments of the path.
    pub segments: usize,
    /// Share of the whole path that is behind, 0 to 1.
    pub fraction: f64,
    /// What there is to say of the step, such as `h 0.0100  F_N 72.6  5 iterations`.
    pub detail: String,
}

impl Position {
    /// The segment and the number of the last one.
    pub(super) fn place(&self) -> String {
        format!("segment {} (last {})", self.segment, self.segments.saturating_sub(1))
    }
}

/// Told about every accepted step.
pub trait Progress: Send {
    /// A step was accepted.
    fn step(&mut self, position: &Position);
    /// A note or a warning for the user, a line of its own.
    fn message(&mut self, text: &str);
    /// The run is over; `text` is the last line.
    fn finish(&mut self, text: &str);
}

/// What suits the place: nothing if `quiet`, a bar if stderr is a terminal, plain lines otherwise.
pub fn progress(quiet: bool) -> Box<dyn Progress> {
    if quiet {
        Box::new(SilentProgress)
    } else if io::stderr().is_terminal() {
        Box::new(BarProgress::new())
    } else {
        Box::new(PlainProgress::new(io::stderr(), Duration::from_secs(2)))
    }
}

/// Says nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct SilentProgress;

impl Progress for SilentProgress {
    fn step(&mut self, _position: &Position) {}
    fn message(&mut self, _text: &str) {}
    fn finish(&mut self, _text: &str) {}
}

/// A bar that is redrawn in place, with the time that is left.
#[derive(Debug)]
pub struct BarProgress {
    bar: ProgressBar,
}

/// The bar counts in these parts of the path.
const BAR_PARTS: u64 = 1000;

impl BarProgress {
    /// A bar at zero on stderr.
    pub fn new() -> Self {
        Self::on(ProgressDrawTarget::stderr())
    }

    fn on(target: ProgressDrawTarget) -> Self {
        let bar = ProgressBar::with_draw_target(Some(BAR_PARTS), target);
        // The template is fixed; should it ever be refused, the default style serves.
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {elapsed} + {eta}  {msg}") {
            bar.set_style(style);
        }
        Self { bar }
    }
}

impl Default for BarProgress {
    fn default() -> Self {
        Self::new()
    }
}

impl Progress for BarProgress {
    fn step(&mut self, position: &Position) {
        self.bar.set_message(format!("{}  {}", position.place(), position.detail));
        self.bar.set_position((position.fraction.clamp(0.0, 1.0) * BAR_PARTS as f64) as u64);
    }

    fn message(&mut self, text: &str) {
        self.bar.suspend(|| {
            // A closed stderr is no reason to stop computing.
            let _ = writeln!(io::stderr(), "{text}");
        });
    }

    fn finish(&mut self, text: &str) {
        self.bar.finish_and_clear();
        self.message(text);
    }
}

/// A line now and then, for log files.
#[derive(Debug)]
pub struct PlainProgress<W: Write> {
    out: W,
    interval: Duration,
    last: Option<Instant>,
}

impl<W: Write> PlainProgress<W> {
    /// Lines to `out`, steps at most once in `interval`, but always the last one of the path.
    pub fn new(out: W, interval: Duration) -> Self {
        Self { out, interval, last: None }
    }

    fn line(&mut self, text: &str) {
        // As above: computing goes on without a reader.
        let _ = writeln!(self.out, "{text}").and_then(|()| self.out.flush());
    }
}

impl<W: Write + Send> Progress for PlainProgress<W> {
    fn step(&mut self, position: &Position) {
        let due = self.last.is_none_or(|last| last.elapsed() >= self.interval);
        if due || position.fraction >= 1.0 {
            self.last = Some(Instant::now());
            let percent = 100.0 * position.fraction.clamp(0.0, 1.0);
            self.line(&format!("{percent:5.1} %  step {}  {}  {}", position.step, position.place(), position.detail));
        }
    }

    fn message(&mut self, text: &str) {
        self.line(text);
    }

    fn finish(&mut self, text: &str) {
        self.line(text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(step: usize, fraction: f64) -> Position {
        Position { step, segment: 1, segments: 2, fraction, detail: "F_N 72.6".into() }
    }

    #[test]
    fn plain_lines() {
        let mut text = Vec::new();
        let mut plain = PlainProgress::new(&mut text, Duration::ZERO);
        plain.step(&position(3, 0.25));
        plain.message("note");
        plain.finish("done");
        assert_eq!(String::from_utf8(text).unwrap(), " 25.0 %  step 3  segment 1 (last 1)  F_N 72.6\nnote\ndone\n");
    }

    #[test]
    fn lines_are_rationed_but_the_last_step_is_told() {
        let mut text = Vec::new();
        let mut plain = PlainProgress::new(&mut text, Duration::from_secs(3600));
        (1..=10).for_each(|step| plain.step(&position(step, step as f64 / 10.0)));
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().count(), 2);
        assert!(text.lines().last().unwrap().starts_with("100.0 %"));
    }

    #[test]
    fn a_closed_reader_does_not_stop_the_run() {
        struct Closed;
        impl Write for Closed {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::Error::from(io::ErrorKind::BrokenPipe))
            }
            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let mut plain = PlainProgress::new(Closed, Duration::ZERO);
        plain.step(&position(1, 0.1));
        plain.finish("done");
    }

    #[test]
    fn the_bar_follows_the_fraction() {
        let mut bar = BarProgress::on(ProgressDrawTarget::hidden());
        bar.step(&position(1, 0.5));
        assert_eq!(bar.bar.position(), BAR_PARTS / 2);
        bar.step(&position(2, 1.5));
        assert_eq!(bar.bar.position(), BAR_PARTS);
        assert_eq!(bar.bar.message(), "segment 1 (last 1)  F_N 72.6");
        bar.bar.finish_and_clear();
        assert!(bar.bar.is_finished());
    }
}
