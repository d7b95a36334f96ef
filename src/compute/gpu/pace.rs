//! How long lists of kernels take, so that a slow device gets them in pieces: drivers of consumer
//! cards reset a device that works at one submission for about two seconds.

use std::sync::Mutex;
use std::sync::PoisonError;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

/// The longest that a list may have taken for the next to be sent in one piece.
const LONGEST: Duration = Duration::from_millis(500);

/// What the last list took, and how many pieces came of that.
#[derive(Debug)]
pub(super) struct ListPace {
    longest: Duration,
    /// Of the last list that was waited for: its kernels, and what it took.
    last: Mutex<(u64, Duration)>,
    pieces: AtomicU64,
}

impl Default for ListPace {
    fn default() -> Self {
        Self::with(LONGEST)
    }
}

impl ListPace {
    /// Nothing is known yet; lists that take no longer than this are sent whole.
    pub fn with(longest: Duration) -> Self {
        Self { longest, last: Mutex::default(), pieces: AtomicU64::new(0) }
    }

    /// The same limit for another user of the device.
    pub fn of_part(&self) -> Self {
        Self::with(self.longest)
    }

    /// Kernels in a piece of the next list, each piece half as long as a list may be; none where it
    /// goes whole.
    pub fn most(&self) -> Option<u64> {
        let (kernels, took) = *self.last.lock().unwrap_or_else(PoisonError::into_inner);
        let share = 0.5 * self.longest.as_secs_f64() / took.as_secs_f64();
        (took > self.longest).then_some(((kernels as f64 * share) as u64).max(1))
    }

    /// A list with so many kernels took so long.
    pub fn took(&self, kernels: u64, time: Duration) {
        if kernels > 0 {
            *self.last.lock().unwrap_or_else(PoisonError::into_inner) = (kernels, time);
        }
    }

    /// A piece was sent ahead of the last one of its list.
    pub fn sent_ahead(&self) {
        self.pieces.fetch_add(1, Ordering::Relaxed);
    }

    /// Pieces that were sent ahead.
    pub fn ahead(&self) -> u64 {
        self.pieces.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_list_is_cut_where_the_last_one_took_too_long() {
        let pace = ListPace::default();
        assert_eq!(pace.most(), None);
        pace.took(100, Duration::from_millis(500));
        assert_eq!(pace.most(), None);
        pace.took(100, Duration::from_secs(1));
        assert_eq!(pace.most(), Some(25));
        // A list of copies says nothing.
        pace.took(0, Duration::ZERO);
        assert_eq!(pace.most(), Some(25));
        pace.took(3, Duration::from_secs(10));
        assert_eq!(pace.most(), Some(1));
        pace.took(100, Duration::from_millis(1));
        assert_eq!(pace.most(), None);
        assert_eq!(ListPace::with(Duration::ZERO).of_part().longest, Duration::ZERO);
    }
}
