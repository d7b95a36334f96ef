//! How far it is: a bar with the time to go on a terminal, a line for each part elsewhere, nothing
//! with `-q`. All of it on stderr.

use std::io::{self, IsTerminal, Write};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::output::{BAR_PARTS, in_words};

/// Told which part begins.
pub struct ProveProgress {
    display: ProofDisplay,
    begun: Instant,
    /// Expected work of all parts, in any unit.
    total: f64,
    /// Of those that have ended, and of the one that has begun.
    behind: f64,
    current: f64,
}

enum ProofDisplay {
    Silent,
    Bar(ProgressBar),
    Plain,
}

impl ProveProgress {
    /// What suits the place, for `total` work.
    pub fn new(quiet: bool, total: f64) -> Self {
        let display = if quiet {
            ProofDisplay::Silent
        } else if io::stderr().is_terminal() {
            let bar = ProgressBar::new(BAR_PARTS);
            // The template is fixed; should it ever be refused, the default style serves.
            if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {elapsed}  {msg}") {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(500));
            ProofDisplay::Bar(bar)
        } else {
            ProofDisplay::Plain
        };
        Self { display, begun: Instant::now(), total, behind: 0.0, current: 0.0 }
    }

    /// A part of so much work begins, and the one before it has ended.
    pub fn begins(&mut self, what: &str, work: f64) {
        self.behind += self.current;
        self.current = work;
        let (elapsed, share) = (self.begun.elapsed().as_secs_f64(), self.share());
        let left = left(elapsed, share).map_or_else(String::new, |left| format!(", about {left} left"));
        match &self.display {
            ProofDisplay::Silent => {}
            ProofDisplay::Bar(bar) => {
                bar.set_position((share * BAR_PARTS as f64) as u64);
                bar.set_message(format!("{what}{left}"));
            }
            // A closed stderr is no reason to stop.
            ProofDisplay::Plain => drop(writeln!(io::stderr(), "{:3.0} %  {what}{left}", 100.0 * share)),
        }
    }

    /// All has ended.
    pub fn ends(&mut self) {
        if let ProofDisplay::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }

    fn share(&self) -> f64 {
        (self.behind / self.total.max(self.behind + self.current)).clamp(0.0, 1.0)
    }
}

/// The time to go in words, once enough is behind to tell.
fn left(elapsed: f64, share: f64) -> Option<String> {
    (elapsed >= 1.0 && (0.02..1.0).contains(&share)).then(|| in_words(elapsed * (1.0 - share) / share))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_to_go_follows_from_what_is_behind() {
        assert_eq!(left(10.0, 0.25).as_deref(), Some("30 s"));
        assert_eq!(left(60.0, 0.25).as_deref(), Some("3 min"));
        assert_eq!(left(0.5, 0.25), None);
        assert_eq!(left(30.0, 0.01), None);
        let mut progress = ProveProgress::new(true, 10.0);
        progress.begins("first", 2.0);
        assert_eq!(progress.share(), 0.0);
        progress.begins("second", 3.0);
        assert_eq!(progress.share(), 0.2);
        // More than was expected is no share above one.
        progress.begins("third", 20.0);
        assert_eq!(progress.share(), 0.2);
        progress.ends();
    }
}
