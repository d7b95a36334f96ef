//! The segments of a path in a history: what each does, and in which colour it is drawn.

use super::super::StepRecord;
use super::canvas::Colour;
use super::chart::{Axis, ColourBar};
use super::style::GROUPS;

/// One segment: its steps, with the last one before it first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SegmentSteps<'h> {
    /// Number of the segment, from 0.
    pub number: usize,
    /// Its steps; of the first segment, the undeformed state is not among them.
    pub steps: &'h [StepRecord],
}

/// The segments of a history in their order. One that has no step yet is left out.
pub fn segments(history: &[StepRecord]) -> Vec<SegmentSteps<'_>> {
    let mut all = Vec::new();
    let mut begin = 0;
    for end in 1..=history.len() {
        if end == history.len() || history[end].segment != history[end - 1].segment {
            let steps = &history[begin.max(1) - 1..end];
            all.push(SegmentSteps { number: history[end - 1].segment, steps });
            begin = end;
        }
    }
    all
}

impl SegmentSteps<'_> {
    /// What it does, as in `1: shear`.
    pub fn label(&self) -> String {
        format!("{}: {}", self.number, self.what())
    }

    fn what(&self) -> &'static str {
        let (Some(first), Some(last)) = (self.steps.first(), self.steps.last()) else { return "" };
        // The first segment begins in the undeformed state.
        let from = if self.number == 0 && self.steps.len() == 1 { &StepRecord::default() } else { first };
        let (h, delta_t) = (last.h - from.h, last.delta_t - from.delta_t);
        let held_force = (last.f_n - from.f_n).abs() < 1e-3 * from.f_n.abs();
        if last.angles() != from.angles() {
            return "turn";
        }
        // Not to the last bit: a mesh that does not lie along x turns what moves.
        let across = last.delta_t_y - from.delta_t_y;
        if across.abs() > 1e-9 * delta_t.abs() {
            return "shear";
        }
        match (delta_t, h) {
            (0.0, h) if h < 0.0 => "unload",
            (0.0, _) => "press",
            (delta_t, h) if h.abs() > 0.02 * delta_t.abs() && !held_force => "oblique",
            (delta_t, _) if delta_t < 0.0 => "shear back",
            _ => "shear",
        }
    }
}

/// Most segments that are told apart by name; more have the colours of a bar.
const NAMED: usize = GROUPS.len();

/// Colours of segments: a group's each, or along viridis where they are many.
#[derive(Clone, Debug, PartialEq)]
pub struct SegmentColours {
    first: usize,
    /// What the colours stand for, where they have no entries in the legend.
    pub bar: Option<ColourBar>,
}

impl SegmentColours {
    /// For these segments.
    pub fn of(segments: &[SegmentSteps<'_>]) -> Self {
        let number = |segment: Option<&SegmentSteps<'_>>| segment.map_or(0, |segment| segment.number);
        let (first, last) = (number(segments.first()), number(segments.last()));
        let bar = (segments.len() > NAMED).then(|| ColourBar { axis: Axis::linear("segment", first as f64, last as f64) });
        Self { first, bar }
    }

    /// Of one of them.
    pub fn colour(&self, segment: &SegmentSteps<'_>) -> Colour {
        match &self.bar {
            Some(bar) => bar.colour(segment.number as f64),
            // A history that was changed by hand may go back to an earlier segment.
            None => GROUPS[segment.number.abs_diff(self.first) % GROUPS.len()],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(segment: usize, h: f64, delta_t: f64, f_n: f64) -> StepRecord {
        StepRecord { segment, h, delta_t, f_n, ..StepRecord::default() }
    }

    #[test]
    fn segments_begin_where_the_last_one_ended_and_say_what_they_do() {
        let history = [
            row(0, 0.01, 0.0, 50.0),
            row(0, 0.02, 0.0, 100.0),
            row(1, 0.02, 0.003, 80.0),
            row(2, 0.02, -0.003, 80.0),
            row(3, 0.021, 0.003, 80.01),
            row(4, 0.03, 0.01, 90.0),
            row(5, 0.0, 0.01, 0.0),
        ];
        let all = segments(&history);
        let labels: Vec<String> = all.iter().map(SegmentSteps::label).collect();
        assert_eq!(labels, ["0: press", "1: shear", "2: shear back", "3: shear", "4: oblique", "5: unload"]);
        assert_eq!(all[1].steps, &history[1..3]);
        assert_eq!(segments(&history[..1])[0].label(), "0: press");
        assert!(segments(&[]).is_empty());
        assert!(SegmentColours::of(&all).bar.is_none());
        let many: Vec<StepRecord> = (0..9).map(|i| row(i, 0.02, 0.001 * i as f64, 80.0)).collect();
        assert!(SegmentColours::of(&segments(&many)).bar.is_some());
    }
}
