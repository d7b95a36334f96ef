//! Follows the path of a case with the contact update.

use super::ContactParameters;
use super::centres::Centres;
use super::state::{ContactResponse, ContactState};
use super::turning::{Moments, Turn, TurningState};
use crate::case::{Hold, Motion, Segment, ShearTarget, unit};

/// A place on a path, in the units of the parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PathPoint {
    /// Segment, from 0.
    pub segment: usize,
    /// Indentation h.
    pub h: f64,
    /// Tangential displacement delta_T along x.
    pub delta_t: f64,
    /// The same along y.
    pub delta_t_y: f64,
    /// Normal force F_N.
    pub f_n: f64,
    /// Tangential force F_T along x.
    pub f_t: f64,
    /// The same along y.
    pub f_t_y: f64,
    /// How far it has turned about z (its twist), about x and about y (its roll), rad.
    pub turned: [f64; 3],
    /// The moments about these, in the direction of the turn.
    pub moments: [f64; 3],
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

/// F_N, F_T along x and y, and the moments about z, x and y at places (h, delta_T along x and y,
/// and how far the sphere has turned about z, x and y), and the work that the update takes on the
/// way through them and has not stored at the end.
pub fn drive_turning(
    parameters: &ContactParameters,
    centres: Centres,
    places: &[[f64; 6]],
    increments: usize,
) -> (Vec<[f64; 6]>, f64) {
    let mut follower = Follower::new(parameters, centres);
    let mut at = |place: &[f64; 6]| {
        let [h, x, y, twist, roll_x, roll_y] = *place;
        follower.turn_to([h, x, y], [twist, roll_x, roll_y], Hold::Indentation, increments, 1.0);
        let ([f_n, f_t, f_t_y], [m_z, m_x, m_y]) = (follower.force, follower.moments());
        [f_n, f_t, f_t_y, m_z, m_x, m_y]
    };
    let forces = places.iter().map(&mut at).collect();
    let stored = parameters.stored_energy(&follower.state) + follower.moment.stored;
    (forces, follower.work - stored)
}

/// What a contact remembers, answers and has for forces along the fixed axes.
type Answer = (ContactState, TurningState, ContactResponse, Moments, [f64; 3]);

struct Follower<'a> {
    parameters: &'a ContactParameters,
    centres: Centres,
    state: ContactState,
    out: ContactResponse,
    /// The same of twist and roll, how far it has turned about z, x and y, and to where the next
    /// increment turns it.
    turning: TurningState,
    moment: Moments,
    turned: [f64; 3],
    turns_to: [f64; 3],
    /// The place along the fixed axes, delta_T along y too, and F_N and F_T there.
    h: f64,
    delta_t: f64,
    across: f64,
    force: [f64; 3],
    /// Work so far, by the trapezoidal rule.
    work: f64,
    /// Direction of the last shear, along x and y.
    way: [f64; 2],
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
            turning: TurningState::default(),
            moment: Moments::default(),
            turned: [0.0; 3],
            turns_to: [0.0; 3],
            h: 0.0,
            delta_t: 0.0,
            across: 0.0,
            force: [0.0; 3],
            work: 0.0,
            way: [1.0, 0.0],
            number: 0,
            points: Vec::new(),
        }
    }

    fn tell(&mut self) {
        let [f_n, f_t, f_t_y] = self.force;
        let Self { number: segment, h, delta_t, across: delta_t_y, .. } = *self;
        let (turned, moments, slips) = (self.turned, self.moments(), self.slips());
        self.points.push(PathPoint { segment, h, delta_t, delta_t_y, f_n, f_t, f_t_y, turned, moments, slips });
    }

    /// The moments about z, x and y.
    fn moments(&self) -> [f64; 3] {
        let [x, y] = self.moment.m_roll;
        [self.moment.m_twist, x, y]
    }

    /// Whether F_T has come to mu F_N.
    fn slips(&self) -> bool {
        let limit = self.parameters.friction * self.out.f_n;
        let [x, y] = self.out.f_t;
        let f_t = if y == 0.0 { x.abs() } else { x.hypot(y) };
        limit > 0.0 && f_t >= SLIPPING * limit
    }

    /// The answer at a place, and its F_N and F_T along the fixed axes.
    fn ask_at(&self, place: [f64; 3]) -> Answer {
        let slid = self.centres.slid([self.h, self.delta_t, self.across], place);
        let [twist, x, y] = [0, 1, 2].map(|k| self.turns_to[k] - self.turned[k]);
        let (before, turn) = ((&self.state, &self.turning), Turn { twist, roll: [x, y] });
        let (state, turning, out, moment) = self.parameters.update_turning(before, self.centres.overlap_at(place), slid, turn);
        (state, turning, out, moment, self.centres.along_fixed_axes(place, [out.f_n, out.f_t[0], out.f_t[1]]))
    }

    fn step_to(&mut self, place: [f64; 3]) {
        let (before, moments) = (self.force, self.moments());
        (self.state, self.turning, self.out, self.moment, self.force) = self.ask_at(place);
        let after = self.moments();
        for k in 0..3 {
            self.work += 0.5 * (moments[k] + after[k]) * (self.turns_to[k] - self.turned[k]);
        }
        self.turned = self.turns_to;
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

    /// Goes to a place and turns about z, x and y on the way, in proportion.
    fn turn_to(&mut self, end: [f64; 3], turned: [f64; 3], hold: Hold, steps: usize, growth: f64) {
        let (start, from, f_n) = ([self.h, self.delta_t, self.across], self.turned, self.force[0]);
        for i in 1..=steps {
            let share = (i as f64 / steps as f64).powf(growth);
            let between = |from: [f64; 3], to: [f64; 3]| {
                if i == steps { to } else { [0, 1, 2].map(|k| from[k] + share * (to[k] - from[k])) }
            };
            self.turns_to = between(from, turned);
            let [mut h, x, y] = between(start, end);
            if hold == Hold::NormalForce {
                h = self.holding(f_n, [x, y]);
            }
            self.step_to([h, x, y]);
            self.tell();
        }
    }

    /// A segment that twists or rolls.
    fn turning_segment(&mut self, to: &Motion, hold: Hold) {
        let [x, y] = to.shear.unwrap_or([self.delta_t, self.across]);
        let [about_x, about_y] = to.roll.unwrap_or([self.turned[1], self.turned[2]]);
        let turned = [to.twist.unwrap_or(self.turned[0]), about_x, about_y];
        if to.shear.is_some() {
            self.turn([x, y]);
        }
        self.turn_to([to.indentation.unwrap_or(self.h), x, y], turned, hold, 2 * STEPS, 1.5);
    }

    fn segment(&mut self, number: usize, segment: &Segment) {
        self.number = number;
        self.tell();
        let at = self.delta_t;
        match *segment {
            Segment::Indentation { indentation } => self.towards(indentation, at, STEPS, 1.5),
            Segment::Oblique { indentation, shear } => {
                self.turn([shear, self.across]);
                self.towards(indentation, shear, 2 * STEPS, 1.5);
            }
            Segment::Release { share } => self.release(share),
            Segment::Shear { shear: ShearTarget::Displacement(d), hold } => self.shear_to([d, self.across], hold),
            Segment::Shear { shear: ShearTarget::FullSlip, hold } => {
                // On along x, forward if it has not been sheared so.
                self.way = [if self.way[0] < 0.0 { -1.0 } else { 1.0 }, 0.0];
                self.shear(None, hold);
            }
            Segment::Slip { direction, hold } => {
                self.way = unit(direction);
                self.shear(None, hold);
            }
            Segment::Motion { ref to, hold } if to.turns() => self.turning_segment(to, hold),
            Segment::Motion { to: Motion { indentation: None, shear: Some(end), .. }, hold } => self.shear_to(end, hold),
            Segment::Motion { to: Motion { indentation: Some(h), shear: Some(end), .. }, .. } => {
                self.turn(end);
                self.straight_to([h, end[0], end[1]], 2 * STEPS, 1.5);
            }
            Segment::Motion { to: Motion { indentation, .. }, .. } => {
                if let Some(h) = indentation {
                    self.towards(h, at, STEPS, 1.5);
                }
            }
        }
    }

    /// Sets out for a delta_T along x and y; how far it is.
    fn turn(&mut self, to: [f64; 2]) -> f64 {
        let [x, y] = [to[0] - self.delta_t, to[1] - self.across];
        if y == 0.0 {
            self.way = [x.signum(), 0.0];
            return x.abs();
        }
        let length = x.hypot(y);
        self.way = [x / length, y / length];
        length
    }

    /// The indentation between `low` and `high` at which the next increment, to `delta_t` along x
    /// and y, ends with the normal force `wanted`; F_N rises with h.
    fn meet(&self, wanted: f64, [x, y]: [f64; 2], mut low: f64, mut high: f64) -> f64 {
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            let (.., [f_n, ..]) = self.ask_at([middle, x, y]);
            if f_n < wanted { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    }

    /// Withdraws until F_N has fallen to a share of what it is; with 0 until contact is lost.
    fn release(&mut self, share: f64) {
        if !(self.out.f_n > 0.0) {
            return;
        }
        let (from, at) = (self.h, [self.delta_t, self.across]);
        let aside = if at[1] == 0.0 { at[0] } else { at[0].hypot(at[1]) };
        // A little beyond where contact is lost, so that rounding leaves no force.
        let end = self.centres.indentation(self.state.h - (1.0 + 1e-12) * self.state.approach, aside);
        let end = if share > 0.0 { self.meet(share * self.force[0], at, end, from) } else { end };
        self.towards(end, self.delta_t, STEPS, 1.0);
    }

    fn shear_to(&mut self, end: [f64; 2], hold: Hold) {
        let length = self.turn(end);
        self.shear(Some((end, length)), hold);
    }

    /// Shears on along `way` to an end at this length, or to full slip.
    fn shear(&mut self, end: Option<([f64; 2], f64)>, hold: Hold) {
        let slip = if self.state.h_max > 0.0 { self.parameters.virgin(self.state.h_max).point.delta_t_end } else { 0.0 };
        if !(slip > 0.0) {
            // Nothing touches: it moves freely.
            if let Some(([x, y], _)) = end {
                self.step_to([self.h, x, y]);
                self.tell();
            }
            return;
        }
        let (start, f_n, way) = ([self.delta_t, self.across], self.force[0], self.way);
        let length = end.map_or(f64::INFINITY, |(_, length)| length);
        for i in 1..=(MOST_SLIPS + 1) * STEPS {
            let distance =
                if i <= STEPS { length.min(slip) * (i as f64 / STEPS as f64).powi(2) } else { slip * i as f64 / STEPS as f64 };
            let last = distance >= length * (1.0 - 1e-12) || i == (MOST_SLIPS + 1) * STEPS && length.is_finite();
            let [x, y] = match end {
                Some((end, _)) if last => end,
                _ => [start[0] + way[0] * distance, start[1] + way[1] * distance],
            };
            let h = if hold == Hold::NormalForce { self.holding(f_n, [x, y]) } else { self.h };
            let before = self.out.f_n;
            self.step_to([h, x, y]);
            self.tell();
            // As two spheres pass each other F_N falls on with the overlap.
            let stands = self.centres.frame().is_some() || (before - self.out.f_n).abs() <= 1e-9 * before;
            let settled = i >= STEPS && self.slips() && stands;
            if last || length.is_infinite() && settled {
                return;
            }
        }
    }

    /// The indentation that keeps F_N.
    fn holding(&self, wanted: f64, delta_t: [f64; 2]) -> f64 {
        if !(wanted > 0.0) {
            return self.h;
        }
        let falls = |h: f64| self.ask_at([h, delta_t[0], delta_t[1]]).4[0] < wanted;
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
