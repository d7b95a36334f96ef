//! What slots are told, and what comes back of them.

use super::arrays::{NUMBERS, READINGS};
use crate::compute::linear::SideReport;
use crate::compute::{Energies, Evaluated};

/// What is done to a slot, as `told.wgsl` has it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SlotMark {
    /// The current iterate of the case, 0 or 1.
    pub current: u32,
    /// The one that is made.
    pub trial: u32,
    /// [`flags`].
    pub flags: u32,
    /// [`source`](mod@source).
    pub source: u32,
    /// `STEP` and so on.
    pub numbers: [f64; NUMBERS],
}

/// Flags of a slot.
pub mod flags {
    /// The plate is put where it belongs.
    pub const PLACES_PLATE: u32 = 1;
    /// The merit has the missing normal force in it.
    pub const HOLDS_FORCE: u32 = 2;
    /// Points below the plane are put on it.
    pub const LIFTS: u32 = 8;
    /// The first system of its step.
    pub const IS_FIRST: u32 = 16;
    /// The last trial was kept, under full stick.
    pub const LANDS: u32 = 32;
}

/// What a trial is made of.
pub mod source {
    /// The current iterate and a part of the correction.
    pub const ALONG_CORRECTION: u32 = 0;
    /// The last step.
    pub const EXTRAPOLATED: u32 = 1;
    /// The committed displacement.
    pub const AT_START: u32 = 2;
    /// The current iterate moved as one.
    pub const SHIFTED: u32 = 3;
}

/// Places of a slot's numbers.
pub mod number {
    /// Step length.
    pub const STEP: usize = 0;
    /// h of the current iterate.
    pub const DEPTH: usize = 1;
    /// delta_T.
    pub const SHEAR: usize = 2;
    /// Change of h along the correction; where a force is held, `depth.wgsl` finds it.
    pub const DEPTH_CHANGE: usize = 3;
    /// Force that is held.
    pub const HELD_FORCE: usize = 4;
    /// Share of the last step; of a shift its x.
    pub const RATIO: usize = 5;
    /// Of a shift its z.
    pub const SHIFT_Z: usize = 6;
    /// What is missing of the plate's force at the current iterate.
    pub const MISSING: usize = 7;
    /// What solutions of the slot's scaled systems are multiplied by.
    pub const BACK: usize = 8;
}

/// What a slot's trial came to, as `read.wgsl` orders it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Readout {
    /// How the evaluation went.
    pub outcome: Evaluated,
    /// Merit, force scale, plate force, tangential residual, normal force, slope, slope at the
    /// current iterate, square of what is released, change of h, largest right-hand side.
    pub numbers: [f64; READINGS],
    /// Status changed, come down again, closed, slipping.
    pub counts: [u32; 4],
}

/// What a commit leaves in a slot.
#[derive(Clone, Debug)]
pub struct CommitReport {
    /// How it went.
    pub outcome: Evaluated,
    /// Energies of the body.
    pub energies: Energies,
    /// `[AT_POINT][point]`.
    pub at_points: Vec<f64>,
    /// `[point]`.
    pub status: Vec<u32>,
}

/// Corrections and the trials at their ends, slot by slot.
#[derive(Clone, Debug)]
pub struct Corrections {
    /// How the tangents went.
    pub tangents: Vec<Evaluated>,
    /// How the solutions went.
    pub reports: Vec<SideReport>,
    /// The same of the responses to a unit indentation; none where no force is held.
    pub units: Vec<SideReport>,
    /// The trials.
    pub readouts: Vec<Readout>,
}

/// An iterate of a case.
#[derive(Clone, Debug)]
pub struct Brought<R> {
    /// Since the start of the step, `[3 node + i]`.
    pub increments: Vec<R>,
    /// Internal forces, `[3 node + i]`.
    pub forces: Vec<R>,
    /// Contact points that slide without friction, or have come off: bits.
    pub let_go: Vec<u32>,
}
