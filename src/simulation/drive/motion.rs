//! Segments in which the plate moves across the x axis or turns, and what their steps start from.

use super::{Drive, Ending, Observer};
use crate::case::{Hold, Motion, Segment, unit};
use crate::simulation::SimulationError;
use crate::simulation::checkpoint::Increment;
use crate::simulation::path::{SegmentStart, Target, straight_targets};
use crate::solver::pose::Pose;

impl Drive<'_> {
    /// Moves the plate in several of its degrees of freedom, in proportion.
    pub(super) fn motion(
        &mut self,
        start: &SegmentStart,
        to: &Motion,
        hold: Hold,
        observer: &mut dyn Observer,
    ) -> Result<Ending, SimulationError> {
        let held = hold == Hold::NormalForce && to.indentation.is_none();
        let end = Target { hold_force: held, ..end_of(to, start) };
        if self.place.is_at_segment_start() && to.indentation.is_none() {
            if start.f_n <= 0.0 {
                observer.note("nothing touches, so the sphere moves freely");
            }
            if !to.turns() {
                self.place.stiffness = self.tangential_stiffness(hold, [self.state.way[0], self.state.way[1]])?;
            }
        }
        self.set_held_force(start, held);
        let ending = self.reach(&straight_targets(start, &end, &self.resolution()), observer);
        self.held_force = None;
        ending
    }

    /// The direction of a segment along x and y and about z, where it is none along x alone; of
    /// length 1, the turn by what it moves at the contact's edge. `None` of other segments, and of
    /// one that only presses or rolls.
    pub(super) fn way_of(&self, segment: &Segment, start: &SegmentStart) -> Option<[f64; 3]> {
        match segment {
            Segment::Slip { direction, .. } => {
                let [x, y] = unit(*direction);
                Some([x, y, 0.0])
            }
            Segment::Motion { to, .. } => {
                let ([x, y], [.., twist]) = end_of(to, start).way_from(&start.place());
                let way = [x, y, start.a * twist];
                let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
                Some(if length > 0.0 { way.map(|part| part / length) } else { [0.0; 3] })
            }
            _ => None,
        }
    }

    /// By how much the way along and about the surface to a target is longer than the last step's;
    /// `None` if that did not move so.
    pub(super) fn way_ratio(&self, target: &Target, last: &Increment) -> Option<f64> {
        let r = &self.state.record;
        let ([x, y], turned) = target.way_from(&self.start().place());
        if y == 0.0 && last.along[1] == 0.0 && turned == [0.0; 3] && last.turned == [0.0; 3] {
            return (last.along[0] != 0.0).then(|| x / last.along[0]);
        }
        let edge = r.a.max(self.problem.spacing);
        let parts = |[x, y]: [f64; 2], [about_x, about_y, twist]: [f64; 3]| [x, y, about_x, about_y, edge * twist];
        let (now, before) = (parts([x, y], turned), parts(last.along, last.turned));
        let product = |a: &[f64; 5], b: &[f64; 5]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let square = product(&before, &before);
        (square > 0.0).then(|| product(&now, &before) / square)
    }

    /// The indentation at which a step is expected to end: where the force is held it is an
    /// unknown, and goes on as the displacements do.
    pub(super) fn expected_h(&self, target: &Target, ratio: Option<f64>) -> f64 {
        let r = &self.state.record;
        match self.state.last_increment.filter(|_| target.hold_force && ratio.is_some()) {
            // In this order, so that a shear along x keeps its bits.
            Some(last) if last.along[0] != 0.0 && last.along[1] == 0.0 && last.turned == [0.0; 3] => {
                r.h + last.h * (target.delta_t - r.delta_t) / last.along[0]
            }
            Some(last) => self.way_ratio(target, &last).map_or(target.h, |ratio| r.h + last.h * ratio),
            None => target.h,
        }
    }

    /// The displacements of a body that turns with the plate to `pose` at `h`, and goes on
    /// deforming as in the last step, `ratio` times as much. A straight way there would strain what
    /// turns; the first step of a segment, the shortest, has no other.
    pub(super) fn turned_guess(&self, ratio: f64, h: f64, pose: &Pose) -> Vec<f64> {
        let state = &self.state;
        let onwards = state.pose.motion_to(state.record.h, pose, h);
        let last = state.pose_before.motion_to(state.h_before, &state.pose, state.record.h);
        let at = |u: &[f64], n: usize| -> [f64; 3] { std::array::from_fn(|k| self.mesh.nodes[n / 3][k] + u[n + k]) };
        let mut guess = Vec::with_capacity(state.u.len());
        for n in (0..state.u.len()).step_by(3) {
            let (now, before) = (at(&state.u, n), at(&state.u_before, n));
            let moved = onwards.moved(now);
            let rigid = last.moved(before);
            let deformed = onwards.turned(std::array::from_fn(|k| ratio * (now[k] - rigid[k])));
            guess.extend((0..3).map(|k| moved[k] + deformed[k] - self.mesh.nodes[n / 3][k]));
        }
        guess
    }
}

/// Where a motion from `start` ends.
fn end_of(to: &Motion, start: &SegmentStart) -> Target {
    let [about_x, about_y] = to.roll.unwrap_or([start.angles[0], start.angles[1]]);
    let [delta_t, across] = to.shear.unwrap_or([start.delta_t, start.across]);
    let twist = to.twist.unwrap_or(start.angles[2]);
    Target { h: to.indentation.unwrap_or(start.h), delta_t, across, angles: [about_x, about_y, twist], ..start.place() }
}
