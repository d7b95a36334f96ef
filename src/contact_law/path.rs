//! Follows the path of a case with the contact update.

use super::ContactParameters;
use super::centres::Centres;
use super::update::{ContactResponse, ContactState};
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
    let mut follower = Follower::new(parameters, centres);
    places
        .iter()
        .map(|&[h, delta_t]| {
            follower.towards(h, delta_t, increments, 1.0);
            follower.force
        })
        .collect()
}

/// Work that the update takes between two centres on its way through `places` and has not stored
/// at the end.
pub fn dissipated(parameters: &ContactParameters, centres: Centres, places: &[[f64; 2]], increments: usize) -> f64 {
    let mut follower = Follower::new(parameters, centres);
    for &[h, delta_t] in places {
        follower.towards(h, delta_t, increments, 1.0);
    }
    follower.work - parameters.stored_energy(&follower.state)
}

struct Follower<'a> {
    parameters: &'a ContactParameters,
    centres: Centres,
    state: ContactState,
    out: ContactResponse,
    /// The place along the fixed axes, F_N and F_T there.
    h: f64,
    delta_t: f64,
    force: [f64; 2],
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
            force: [0.0; 2],
            work: 0.0,
            direction: 1.0,
            number: 0,
            points: Vec::new(),
        }
    }

    fn tell(&mut self) {
        let [f_n, f_t] = self.force;
        let limit = self.parameters.friction * self.out.f_n;
        let slips = limit > 0.0 && self.out.f_t[0].abs() >= SLIPPING * limit;
        self.points.push(PathPoint { segment: self.number, h: self.h, delta_t: self.delta_t, f_n, f_t, slips });
    }

    /// The answer at a place, and its F_N and F_T along the fixed axes.
    fn ask(&self, h: f64, delta_t: f64) -> (ContactState, ContactResponse, [f64; 2]) {
        let place = [h, delta_t];
        let slid = self.centres.displacement([self.h, self.delta_t], place);
        let (state, out) = self.parameters.update(&self.state, self.centres.overlap(place), [slid, 0.0]);
        (state, out, self.centres.along_axes(place, [out.f_n, out.f_t[0]]))
    }

    fn step(&mut self, h: f64, delta_t: f64) {
        let before = self.force;
        (self.state, self.out, self.force) = self.ask(h, delta_t);
        self.work += 0.5 * ((before[0] + self.force[0]) * (h - self.h) + (before[1] + self.force[1]) * (delta_t - self.delta_t));
        (self.h, self.delta_t) = (h, delta_t);
    }

    /// Goes straight to a place, in steps that grow with the power `growth`.
    fn towards(&mut self, h: f64, delta_t: f64, steps: usize, growth: f64) {
        let (from, start) = (self.h, self.delta_t);
        for i in 1..=steps {
            let share = (i as f64 / steps as f64).powf(growth);
            let place = if i == steps { [h, delta_t] } else { [from + share * (h - from), start + share * (delta_t - start)] };
            self.step(place[0], place[1]);
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
            let (.., [f_n, _]) = self.ask(middle, delta_t);
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
