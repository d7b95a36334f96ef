//! How far the run is: a bar on a terminal, plain lines elsewhere, nothing with `-q`. All of it on
//! stderr.

use super::report::rounded;
use super::{RunStatus, StepRecord};
#[cfg(feature = "bars")]
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
    /// What there is to say of the step, such as `h 0.01000  F_N 72.60`.
    pub detail: String,
}

/// Where a step stands and what it has: h, F_N, F_T of a shear and M_twist of a twist, in few
/// digits.
pub fn detail(row: &StepRecord) -> String {
    let number = |value: f64| rounded(value, 4);
    let mut text = format!("h {}  F_N {}", number(row.h), number(row.f_n));
    if row.delta_t != 0.0 || row.delta_t_y != 0.0 {
        text += &format!("  F_T {}", number(row.f_t.hypot(row.f_t_y).copysign(if row.f_t_y == 0.0 { row.f_t } else { 1.0 })));
    }
    if row.twist != 0.0 {
        text += &format!("  M_twist {}", number(row.m_twist));
    }
    text
}

impl Position {
    /// The segment and the step.
    pub(super) fn place(&self) -> String {
        format!("segment {}, step {}", self.segment, self.step)
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

/// A time to come, in words that promise no more than they can hold: `15 s`, `4 min`, `3.5 h`.
pub fn in_words(seconds: f64) -> String {
    match seconds {
        seconds if seconds < 60.0 => format!("{seconds:.0} s"),
        seconds if seconds < 90.0 * 60.0 => format!("{:.0} min", seconds / 60.0),
        seconds => format!("{:.1} h", seconds / 3600.0),
    }
}

/// The last line of a run: of one that is done, that all of its path is behind.
pub fn last_line(status: RunStatus, steps: usize) -> String {
    let share = if status == RunStatus::Done { "100.0 %  " } else { "" };
    format!("{share}{status}: {steps} steps")
}

/// Tells from the steps so far how long the rest of the path will take.
#[derive(Debug, Default)]
struct Remaining {
    /// When the first step was shown, and the share of the path that was behind then: not 0 in a
    /// run that was resumed.
    first: Option<(Instant, f64)>,
}

impl Remaining {
    /// `, 4 min left`; nothing as long as too little is behind to tell.
    fn after(&mut self, fraction: f64) -> String {
        let (begun, at) = *self.first.get_or_insert((Instant::now(), fraction));
        let (elapsed, gone) = (begun.elapsed().as_secs_f64(), fraction - at);
        let known = elapsed >= 1.0 && gone >= 0.02 && fraction < 1.0;
        if known { format!(", {} left", in_words(elapsed * (1.0 - fraction) / gone)) } else { String::new() }
    }
}

/// What suits the place: nothing if `quiet`, a bar if stderr is a terminal, plain lines otherwise.
pub fn progress(quiet: bool) -> Box<dyn Progress> {
    if quiet {
        Box::new(SilentProgress)
    } else if io::stderr().is_terminal() {
        on_a_terminal()
    } else {
        Box::new(PlainProgress::new(io::stderr(), Duration::from_secs(2)))
    }
}

#[cfg(feature = "bars")]
fn on_a_terminal() -> Box<dyn Progress> {
    Box::new(BarProgress::new())
}

#[cfg(not(feature = "bars"))]
fn on_a_terminal() -> Box<dyn Progress> {
    Box::new(PlainProgress::new(io::stderr(), Duration::from_secs(2)))
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
#[cfg(feature = "bars")]
pub struct BarProgress {
    bar: ProgressBar,
    remaining: Remaining,
}

/// A bar counts in these parts of the path, or of a study.
#[cfg(feature = "bars")]
pub const BAR_PARTS: u64 = 1000;

#[cfg(feature = "bars")]
impl BarProgress {
    /// A bar at zero on stderr.
    pub fn new() -> Self {
        Self::on(ProgressDrawTarget::stderr())
    }

    fn on(target: ProgressDrawTarget) -> Self {
        let bar = ProgressBar::with_draw_target(Some(BAR_PARTS), target);
        // The template is fixed; should it ever be refused, the default style serves.
        if let Ok(style) = ProgressStyle::with_template("{bar:20} {percent:>3} %  {msg}") {
            bar.set_style(style);
        }
        Self { bar, remaining: Remaining::default() }
    }
}

#[cfg(feature = "bars")]
impl Default for BarProgress {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(feature = "bars")]
impl Progress for BarProgress {
    fn step(&mut self, position: &Position) {
        let left = self.remaining.after(position.fraction);
        self.bar.set_message(format!("{}{left}", position.detail));
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
    remaining: Remaining,
}

impl<W: Write> PlainProgress<W> {
    /// Lines to `out`, steps at most once in `interval`, but always the last one of the path.
    pub fn new(out: W, interval: Duration) -> Self {
        Self { out, interval, last: None, remaining: Remaining::default() }
    }

    fn line(&mut self, text: &str) {
        // As above: computing goes on without a reader.
        let _ = writeln!(self.out, "{text}").and_then(|()| self.out.flush());
    }
}

impl<W: Write + Send> Progress for PlainProgress<W> {
    fn step(&mut self, position: &Position) {
        let left = self.remaining.after(position.fraction);
        let due = self.last.is_none_or(|last| last.elapsed() >= self.interval);
        if due || position.fraction >= 1.0 {
            self.last = Some(Instant::now());
            let percent = 100.0 * position.fraction.clamp(0.0, 1.0);
            self.line(&format!("{percent:5.1} %  {}  {}{left}", position.place(), position.detail));
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
        assert_eq!(String::from_utf8(text).unwrap(), " 25.0 %  segment 1, step 3  F_N 72.6\nnote\ndone\n");
    }

    #[test]
    fn a_step_is_told_in_a_line_of_80_columns() {
        let row = StepRecord { h: 0.0123456, f_n: 123.456, delta_t: 0.1, f_t: -1.2345e-5, ..StepRecord::default() };
        assert_eq!(detail(&row), "h 0.01235  F_N 123.5  F_T -1.234e-5");
        let most = StepRecord { h: 1.23456e-7, f_n: 12345.6, ..row };
        let position = Position { step: 123, segment: 3, segments: 4, fraction: 0.5, detail: detail(&most) };
        let line = format!(" 50.0 %  {}  {}, 59 min left", position.place(), position.detail);
        assert!(line.len() <= 80 && detail(&row) != detail(&most), "{line}");
        assert_eq!(detail(&StepRecord { f_t: 0.0, delta_t: 0.0, ..row }), "h 0.01235  F_N 123.5");
        let turned = StepRecord { f_t: 3.0, f_t_y: -4.0, delta_t_y: 0.1, ..row };
        assert!(detail(&turned).ends_with("F_T 5.000"));
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
    fn what_is_left_is_told_in_words_once_it_can_be() {
        assert_eq!([12.4, 89.0, 5400.0, 20_000.0].map(in_words), ["12 s", "1 min", "1.5 h", "5.6 h"]);
        let mut remaining = Remaining { first: Some((Instant::now() - Duration::from_secs(100), 0.5)) };
        // A quarter of the path took 100 s, and a quarter is to come.
        assert_eq!(remaining.after(0.75), ", 2 min left");
        assert_eq!(remaining.after(0.51), "", "too little to tell");
        assert_eq!(remaining.after(1.0), "");
        assert_eq!(Remaining::default().after(0.5), "", "the first step of a run that was resumed");
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

    #[cfg(feature = "bars")]
    #[test]
    fn the_bar_follows_the_fraction() {
        let mut bar = BarProgress::on(ProgressDrawTarget::hidden());
        bar.step(&position(1, 0.5));
        assert_eq!(bar.bar.position(), BAR_PARTS / 2);
        bar.step(&position(2, 1.5));
        assert_eq!(bar.bar.position(), BAR_PARTS);
        assert_eq!(bar.bar.message(), "F_N 72.6");
        bar.bar.finish_and_clear();
        assert!(bar.bar.is_finished());
    }
}
