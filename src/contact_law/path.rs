//! Follows the path of a case with the contact update.

use super::update::{ContactResponse, ContactState};
use super::virgin::ContactParameters;
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
}

/// Steps of a press, of an unloading, of a shear up to the slip displacement.
const STEPS: usize = 100;
/// A shear to full slip is given up after so many slip displacements more.
const MOST_SLIPS: usize = 8;
/// F_T/F_N from this share of mu on is full slip.
const SLIPPING: f64 = 1.0 - 1e-6;
/// Halvings of the bracket in which h meets a force.
const HALVINGS: usize = 60;

/// The forces along `path`, from the state before first contact. Each segment begins with the place
/// where the one before it ended.
pub fn follow(parameters: &ContactParameters, path: &[Segment]) -> Vec<PathPoint> {
    let mut follower = Follower::new(parameters);
    for (number, segment) in path.iter().enumerate() {
        follower.segment(number, segment);
    }
    follower.points
}

/// The forces at places that are given, from the state before first contact, with so many
/// increments between one and the next.
pub fn drive(parameters: &ContactParameters, places: &[[f64; 2]], increments: usize) -> Vec<[f64; 2]> {
    let mut follower = Follower::new(parameters);
    places
        .iter()
        .map(|&[h, delta_t]| {
            follower.towards(h, delta_t, increments, 1.0);
            [follower.out.f_n, follower.out.f_t[0]]
        })
        .collect()
}

struct Follower<'a> {
    parameters: &'a ContactParameters,
    state: ContactState,
    out: ContactResponse,
    delta_t: f64,
    direction: f64,
    number: usize,
    points: Vec<PathPoint>,
}

impl<'a> Follower<'a> {
    fn new(parameters: &'a ContactParameters) -> Self {
        Self {
            parameters,
            state: ContactState::default(),
            out: ContactResponse::default(),
            delta_t: 0.0,
            direction: 1.0,
            number: 0,
            points: Vec::new(),
        }
    }

    fn tell(&mut self) {
        let point =
            PathPoint { segment: self.number, h: self.state.h, delta_t: self.delta_t, f_n: self.out.f_n, f_t: self.out.f_t[0] };
        self.points.push(point);
    }

    fn step(&mut self, h: f64, delta_t: f64) {
        (self.state, self.out) = self.parameters.update(&self.state, h, [delta_t - self.delta_t, 0.0]);
        self.delta_t = delta_t;
    }

    /// Goes straight to a place, in steps that grow with the power `growth`.
    fn towards(&mut self, h: f64, delta_t: f64, steps: usize, growth: f64) {
        let (from, start) = (self.state.h, self.delta_t);
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
            let (_, out) = self.parameters.update(&self.state, middle, [delta_t - self.delta_t, 0.0]);
            if out.f_n < wanted { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Withdraws until F_N has fallen to a share of what it is; with 0 until contact is lost.
    fn release(&mut self, share: f64) {
        if !(self.out.f_n > 0.0) {
            return;
        }
        let from = self.state.h;
        // A little beyond where contact is lost, so that rounding leaves no force.
        let end = from - (1.0 + 1e-12) * self.state.approach;
        let end = if share > 0.0 { self.meet(share * self.out.f_n, self.delta_t, end, from) } else { end };
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
                self.step(self.state.h, d);
                self.tell();
            }
            return;
        }
        let (start, f_n, direction) = (self.delta_t, self.out.f_n, self.direction);
        for i in 1..=(MOST_SLIPS + 1) * STEPS {
            let distance =
                if i <= STEPS { length.min(slip) * (i as f64 / STEPS as f64).powi(2) } else { slip * i as f64 / STEPS as f64 };
            let last = distance >= length * (1.0 - 1e-12) || i == (MOST_SLIPS + 1) * STEPS && length.is_finite();
            let delta_t = match target {
                ShearTarget::Displacement(d) if last => d,
                _ => start + direction * distance,
            };
            let h = if held { self.holding(f_n, delta_t) } else { self.state.h };
            let before = self.out.f_n;
            self.step(h, delta_t);
            self.tell();
            let slips = self.out.f_t[0].abs() >= SLIPPING * self.parameters.friction * self.out.f_n;
            let settled = i >= STEPS && slips && (before - self.out.f_n).abs() <= 1e-9 * before;
            if last || length.is_infinite() && settled {
                return;
            }
        }
    }

    /// The indentation that keeps F_N.
    fn holding(&self, wanted: f64, delta_t: f64) -> f64 {
        if !(wanted > 0.0) {
            return self.state.h;
        }
        let falls = |h: f64| self.parameters.update(&self.state, h, [delta_t - self.delta_t, 0.0]).1.f_n < wanted;
        let h = self.state.h;
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
