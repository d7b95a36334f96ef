//! Systems as the device takes them, and its answers as they are asked for.

use super::super::layout::{FRAME, POINT_ROWS};
use super::solver::{Right, SideSolutions};
use crate::compute::linear::{Side, SideReport, Solution, SolveRequest};
use crate::contact::coulomb::{Rows, Status};
use crate::contact::frame::AXES;

/// The systems of a dispatch, slot by slot.
#[derive(Debug, Default)]
pub struct Packed {
    /// Contact rows `[slot][slides, force rows, displacement rows, frame][point]`; of pairs -1 in
    /// the place of what slides, for slaves that touch.
    pub rows: Vec<f32>,
    /// Fixed components `[slot][node]`, a bit each.
    pub fixed: Vec<u32>,
    /// Right-hand sides; nothing for slots that have fewer than others.
    pub sides: Vec<Right>,
    /// What the numbers of each side of each slot were multiplied by: a power of two, so that no
    /// digit is lost and squares stay within the range of f32.
    factors: Vec<Vec<f64>>,
}

impl Packed {
    /// Packs systems in the order of their slots.
    pub fn new(systems: &[&SolveRequest]) -> Self {
        let mut out = Self { rows: Vec::new(), fixed: Vec::new(), sides: Vec::new(), factors: Vec::new() };
        for system in systems {
            out.pack_rows(system);
            let bits = |f: &[bool; 3]| u32::from(f[0]) | u32::from(f[1]) << 1 | u32::from(f[2]) << 2;
            out.fixed.extend(system.fixed.as_chunks::<3>().0.iter().map(bits));
        }
        let sides = systems.iter().map(|system| system.sides.len()).max().unwrap_or(0);
        for side in 0..sides {
            let (mut right, mut factors) = (Right::default(), Vec::new());
            let has_guess = systems.iter().any(|s| s.sides.get(side).is_some_and(|s| s.guess.iter().any(|x| *x != 0.0)));
            for system in systems {
                factors.push(pack_side(system, system.sides.get(side), has_guess, &mut right));
            }
            out.sides.push(right);
            out.factors.push(factors);
        }
        out
    }

    fn pack_rows(&mut self, system: &SolveRequest) {
        let (first, points) = (self.rows.len(), system.rows.len());
        self.rows.resize(first + POINT_ROWS * points, 0.0);
        // What stands in the place of a slave's force is no row of the matrix: see `tie_met.wgsl`.
        let is_tied = system.tie.is_some();
        let counts = |rows: &Rows<f64>| rows.status == Status::Slip || is_tied && rows.status != Status::Open;
        let mark = if is_tied { -1.0 } else { 1.0 };
        for (k, rows) in system.rows.iter().enumerate().filter(|(_, rows)| counts(rows)) {
            let numbers =
                std::iter::once(&mark).chain(rows.force_rows.as_flattened()).chain(rows.displacement_rows.as_flattened());
            for (c, &number) in numbers.enumerate() {
                self.rows[first + c * points + k] = number as f32;
            }
        }
        for k in 0..points {
            let frame = system.frames.get(k).unwrap_or(&AXES);
            for (c, &number) in frame.as_flattened().iter().enumerate() {
                self.rows[first + (POINT_ROWS - FRAME + c) * points + k] = number as f32;
            }
        }
    }

    /// What the device answered for a slot: fixed unknowns keep the values that were given.
    pub fn unpack(&self, slot: usize, answers: &[SideSolutions], system: &SolveRequest) -> Vec<Solution> {
        let sides = system.sides.iter().zip(answers).zip(&self.factors);
        let solution = |((side, (solutions, reports)), factors): ((&Side, &SideSolutions), &Vec<f64>)| {
            let (back, n) = (1.0 / factors[slot], side.rhs.len());
            let solution = &solutions[slot * n..][..n];
            let value = |i: usize| {
                if system.fixed[i] { side.rhs[i] } else { f64::from(solution[i % 3 * (n / 3) + i / 3]) * back }
            };
            let report = reports[slot];
            let report = SideReport {
                rhs_norm: report.rhs_norm * back,
                start_norm: report.start_norm * back,
                residual: report.residual * back,
                along: report.along * back,
                ..report
            };
            Solution { x: (0..n).map(value).collect(), report }
        };
        sides.map(solution).collect()
    }
}

/// Appends a side of a slot; returns the factor of its numbers.
fn pack_side(system: &SolveRequest, side: Option<&Side>, has_guess: bool, right: &mut Right) -> f64 {
    let n = system.fixed.len();
    let largest = side.map_or(0.0, |side| side.rhs.iter().fold(0.0_f64, |m, b| m.max(b.abs())));
    let factor = if largest > 0.0 && largest.is_finite() { (-largest.log2().floor()).exp2() } else { 1.0 };
    let number = |value: Option<f64>| value.map_or(0.0, |value| (value * factor) as f32);
    let rhs = |i: usize| side.map(|side| side.rhs[i]);
    for c in 0..3 {
        for i in (c..n).step_by(3) {
            right.rhs.push(number(rhs(i)));
        }
    }
    if has_guess {
        let guess = right.guess.get_or_insert_default();
        for c in 0..3 {
            guess.extend(
                (c..n).step_by(3).map(|i| if system.fixed[i] { number(rhs(i)) } else { number(side.map(|s| s.guess[i])) }),
            );
        }
    }
    right.expected = right.expected.max(side.map_or(0, |side| side.expected));
    right.tolerance.push(side.map_or(0.0, |side| side.tolerance as f32));
    right.relative_to_guess.push(side.is_some_and(|side| side.relative_to_guess));
    factor
}
