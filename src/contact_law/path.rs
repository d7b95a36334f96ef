//! Follows the path of a case with the contact update.

use super::ContactParameters;
use super::centres::Centres;
use super::state::{ContactResponse, ContactState};
use crate::case::{Hold, Segment, ShearTarget};

/// A place on a path, in the units of the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathPoint {
    /// Segment, from 0.
    pub segment: usize,
    /// Indentation h.
    pub h: f64,
    /// Tangential displacement delta_T.
    pub delta_t: f64,
    /// Normal force F_N.
    pub f_n: f64,
    /// Tangential force F_T along delta_T.
    pub f_t: f64,
    /// Whether the contact slips as a whole: F_T has come to mu F_N in its own frame.
    pub slips: bool,
}

/// Steps of a press, of an unloading, of a shear up to the slip displacement.
const STEPS: usize = 100;
/// A shear to full slip is given up after so many slip displacements more.
const MOST_SLIPS: usize = 8;
/// F_T/F_N from this share of mu on is full slip.
const SLIPPING: f64 = 1.0 - 1e-6;
/// Halvings of the bracket in which h meets a force.
const HALVINGS: usize = 60;

/// The forces along `path`, from the state before first contact, where nothing turns. Each segment
/// begins with the place where the one before it ended.
pub fn follow(parameters: &ContactParameters, path: &[Segment]) -> Vec<PathPoint> {
    follow_centres(parameters, Centres::default(), path)
}

/// The same between two centres: path and forces are along the fixed axes, the update is driven in
/// the frame of the centres.
pub fn follow_centres(parameters: &ContactParameters, centres: Centres, path: &[Segment]) -> Vec<PathPoint> {
    let mut follower = Follower::new(parameters, centres);
    for (number, segment) in path.iter().enumerate() {
        follower.segment(number, segment);
    }
    follower.points
}

/// The forces at places that are given, from the state before first contact, with so many
/// increments between one and the next; nothing turns.
pub fn drive(parameters: &ContactParameters, places: &[[f64; 2]], increments: usize) -> Vec<[f64; 2]> {
    drive_centres(parameters, Centres::default(), places, increments)
}

/// The same between two centres: places and forces are along the fixed axes.
pub fn drive_centres(parameters: &ContactParameters, centres: Centres, places: &[[f64; 2]], increments: usize) -> Vec<[f64; 2]> {
    let places: Vec<[f64; 3]> = places.iter().map(|&[h, delta_t]| [h, delta_t, 0.0]).collect();
    let (forces, _) = drive_in_the_plane(parameters, centres, &places, increments);
    forces.iter().map(|&[f_n, f_t, _]| [f_n, f_t]).collect()
}

/// F_N and F_T along x and y at places (h, delta_T along x and y), between two centres, and the
/// work that the update takes on the way through them and has not stored at the end.
pub fn drive_in_the_plane(
    parameters: &ContactParameters,
    centres: Centres,
    places: &[[f64; 3]],
    increments: usize,
) -> (Vec<[f64; 3]>, f64) {
    let mut follower = Follower::new(parameters, centres);
    let mut at = |place: &[f64; 3]| {
        follower.straight_to(*place, increments, 1.0);
        follower.force
    };
    let forces = places.iter().map(&mut at).collect();
    (forces, follower.work - parameters.stored_energy(&follower.state))
}

struct Follower<'a> {
    parameters: &'a ContactParameters,
    centres: Centres,
    state: ContactState,
    out: ContactResponse,
    /// The place along the fixed axes, delta_T along y too, and F_N and F_T there.
    h: f64,
    delta_t: f64,
    across: f64,
    force: [f64; 3],
    /// Work so far, by the trapezoidal rule.
    work: f64,
    direction: f64,
    number: usize,
    points: Vec<PathPoint>,
}

impl<'a> Follower<'a> {
    fn new(parameters: &'a ContactParameters, centres: Centres) -> Self {
        Self {
            parameters,
            centres,
            state: ContactState::default(),
            out: ContactResponse::default(),
            h: 0.0,
            delta_t: 0.0,
            across: 0.0,
            force: [0.0; 3],
            work: 0.0,
            direction: 1.0,
            number: 0,
            points: Vec::new(),
        }
    }

    fn tell(&mut self) {
        let [f_n, f_t, _] = self.force;
        let limit = self.parameters.friction * self.out.f_n;
        let slips = limit > 0.0 && self.out.f_t[0].abs() >= SLIPPING * limit;
        self.points.push(PathPoint { segment: self.number, h: self.h, delta_t: self.delta_t, f_n, f_t, slips });
    }

    /// The answer at a place of the same delta_T along y, and its F_N and F_T along the fixed axes.
    fn ask(&self, h: f64, delta_t: f64) -> (ContactState, ContactResponse, [f64; 3]) {
        self.ask_at([h, delta_t, self.across])
    }

    fn ask_at(&self, place: [f64; 3]) -> (ContactState, ContactResponse, [f64; 3]) {
        let slid = self.centres.slid([self.h, self.delta_t, self.across], place);
        let (state, out) = self.parameters.update(&self.state, self.centres.overlap_at(place), slid);
        (state, out, self.centres.along_fixed_axes(place, [out.f_n, out.f_t[0], out.f_t[1]]))
    }

    fn step(&mut self, h: f64, delta_t: f64) {
        self.step_to([h, delta_t, self.across]);
    }

    fn step_to(&mut self, place: [f64; 3]) {
        let before = self.force;
        (self.state, self.out, self.force) = self.ask_at(place);
        let [h, delta_t, across] = place;
        self.work += 0.5 * ((before[0] + self.force[0]) * (h - self.h) + (before[1] + self.force[1]) * (delta_t - self.delta_t));
        self.work += 0.5 * (before[2] + self.force[2]) * (across - self.across);
        (self.h, self.delta_t, self.across) = (h, delta_t, across);
    }

    /// Goes straight to a place, in steps that grow with the power `growth`.
    fn towards(&mut self, h: f64, delta_t: f64, steps: usize, growth: f64) {
        self.straight_to([h, delta_t, self.across], steps, growth);
    }

    fn straight_to(&mut self, end: [f64; 3], steps: usize, growth: f64) {
        let start = [self.h, self.delta_t, self.across];
        for i in 1..=steps {
            let share = (i as f64 / steps as f64).powf(growth);
            let place = if i == steps { end } else { [0, 1, 2].map(|k| start[k] + share * (end[k] - start[k])) };
            self.step_to(place);
            self.tell();
        }
    }

    fn segment(&mut self, number: usize, segment: &Segment) {
        self.number = number;
        self.tell();
        let at = self.delta_t;
        match *segment {
            Segment::Indentation { indentation } => self.towards(indentation, at, STEPS, 1.5),
            Segment::Oblique { indentation, shear } => {
                self.turn(shear);
                self.towards(indentation, shear, 2 * STEPS, 1.5);
            }
            Segment::Release { share } => self.release(share),
            Segment::Shear { shear, hold } => self.shear(shear, hold == Hold::NormalForce),
            // Refused by `law::LawFile::follow`.
            Segment::Motion { .. } | Segment::Slip { .. } => {}
        }
    }

    fn turn(&mut self, to: f64) {
        self.direction = (to - self.delta_t).signum();
    }

    /// The indentation between `low` and `high` at which the next increment ends with the normal
    /// force `wanted`; F_N rises with h.
    fn meet(&self, wanted: f64, delta_t: f64, mut low: f64, mut high: f64) -> f64 {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let (.., [f_n, ..]) = self.ask(middle, delta_t);
            if f_n < wanted { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Withdraws until F_N has fallen to a share of what it is; with 0 until contact is lost.
    fn release(&mut self, share: f64) {
        if !(self.out.f_n > 0.0) {
            return;
        }
        let from = self.h;
        // A little beyond where contact is lost, so that rounding leaves no force.
        let end = self.centres.indentation(self.state.h - (1.0 + 1e-12) * self.state.approach, self.delta_t);
        let end = if share > 0.0 { self.meet(share * self.force[0], self.delta_t, end, from) } else { end };
        self.towards(end, self.delta_t, STEPS, 1.0);
    }

    fn shear(&mut self, target: ShearTarget, held: bool) {
        let slip = if self.state.h_max > 0.0 { self.parameters.virgin(self.state.h_max).point.delta_t_slip } else { 0.0 };
        let length = match target {
            ShearTarget::Displacement(d) => {
                self.turn(d);
                (d - self.delta_t).abs()
            }
            ShearTarget::FullSlip => f64::INFINITY,
        };
        if !(slip > 0.0) {
            // Nothing touches: it moves freely.
            if let ShearTarget::Displacement(d) = target {
                self.step(self.h, d);
                self.tell();
            }
            return;
        }
        let (start, f_n, direction) = (self.delta_t, self.force[0], self.direction);
        for i in 1..=(MOST_SLIPS + 1) * STEPS {
            let distance =
                if i <= STEPS { length.min(slip) * (i as f64 / STEPS as f64).powi(2) } else { slip * i as f64 / STEPS as f64 };
            let last = distance >= length * (1.0 - 1e-12) || i == (MOST_SLIPS + 1) * STEPS && length.is_finite();
            let delta_t = match target {
                ShearTarget::Displacement(d) if last => d,
                _ => start + direction * distance,
            };
            let h = if held { self.holding(f_n, delta_t) } else { self.h };
            let before = self.out.f_n;
            self.step(h, delta_t);
            self.tell();
            let slips = self.out.f_t[0].abs() >= SLIPPING * self.parameters.friction * self.out.f_n;
            // As two spheres pass each other F_N falls on with the overlap.
            let stands = self.centres.frame().is_some() || (before - self.out.f_n).abs() <= 1e-9 * before;
            let settled = i >= STEPS && slips && stands;
            if last || length.is_infinite() && settled {
                return;
            }
        }
    }

    /// The indentation that keeps F_N.
    fn holding(&self, wanted: f64, delta_t: f64) -> f64 {
        if !(wanted > 0.0) {
            return self.h;
        }
        let falls = |h: f64| self.ask(h, delta_t).2[0] < wanted;
        let h = self.h;
        let mut reach = 1e-3 * self.parameters.virgin(self.state.h_max).depth;
        if falls(h) {
            for _ in 0..HALVINGS {
                if !falls(h + reach) {
                    return self.meet(wanted, delta_t, h, h + reach);
                }
                reach *= 2.0;
            }
            return h;
        }
        for _ in 0..HALVINGS {
            if falls(h - reach) {
                return self.meet(wanted, delta_t, h - reach, h);
            }
            reach *= 2.0;
        }
        h
    }
}
