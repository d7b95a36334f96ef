//! Where the results of a run go: into a directory, or into memory alone.

use super::memory::Memory;
use crate::output::ResultWriter;
use crate::simulation::drive::Observer;
use crate::simulation::scout::Scout;

/// Where results go.
pub enum Sink {
    /// Into a directory.
    Files(Box<ResultWriter>),
    /// Nowhere: what the summary needs is kept.
    Memory(Box<Memory>),
}

impl Sink {
    /// What watches the steps.
    pub fn observer(&mut self) -> &mut dyn Observer {
        match self {
            Self::Files(results) => results.as_mut(),
            Self::Memory(memory) => memory.as_mut(),
        }
    }

    /// Keeps a note for the summary that the user has been told already.
    pub fn remember(&mut self, note: &str) {
        match self {
            Self::Files(results) => results.remember(note),
            Self::Memory(memory) => memory.remember(note),
        }
    }
    /// Takes what the coarse run has found in so many seconds on the wall.
    pub fn scouted(&mut self, scout: Scout, seconds: f64) {
        match self {
            Self::Files(results) => results.scouted(scout, seconds),
            Self::Memory(memory) => memory.scouted(scout, seconds),
        }
    }
}
