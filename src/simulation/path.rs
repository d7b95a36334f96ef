//! The increments of a path: where each step of a segment should end.

use serde::{Deserialize, Serialize};

/// Where a step should end.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Indentation, or the first guess of it when the normal force is held.
    pub h: f64,
    /// Tangential displacement along x.
    pub delta_t: f64,
    /// Along y.
    pub across: f64,
    /// How far the sphere has rolled about x and y and been twisted about z, in rad.
    pub angles: [f64; 3],
    /// Normal force is held at what it was when the segment began.
    pub hold_force: bool,
    /// Extrapolating the last two steps is a good first guess.
    pub extrapolate: bool,
}

/// What the increments of a segment are made from: the state at its start.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SegmentStart {
    /// Indentation.
    pub h: f64,
    /// Largest indentation so far.
    pub h_max: f64,
    /// Tangential displacement along x.
    pub delta_t: f64,
    /// Along y.
    pub across: f64,
    /// See [`Target::angles`].
    pub angles: [f64; 3],
    /// Normal force, whole sphere.
    pub f_n: f64,
    /// Contact radius.
    pub a: f64,
    /// Longest elastic recovery of any state so far (see [`SegmentStart::recovery`]).
    pub longest_recovery: f64,
    /// Coefficient of friction; infinite for full stick.
    pub friction: f64,
    /// Poisson's ratio.
    pub nu: f64,
    /// How much more than the sphere alone both bodies give way (see
    /// [`crate::case::Case::compliance`]).
    pub compliance: [f64; 2],
    /// The last shear went the other way.
    pub reversed: bool,
}

/// How finely a path is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Steps of a press from first touch to its end.
    pub press_steps: usize,
    /// Steps of the first, growing part of a shear.
    pub shear_steps: usize,
    /// By how much all other steps, which no number of the case says, are longer than usual.
    pub coarseness: f64,
}

/// Increments of a shear grow as i^1.3: its resolution is needed at the start, where sticking
/// points begin to slip. Half and twice of it: `benches/constants`.
pub const SHEAR_GROWTH: f64 = 1.3;
/// The growing increments end at this many elastic slip displacements (full slip was seen at 3.3 of
/// them in fully plastic contacts). Half and twice of it: `benches/constants`.
const SHEAR_RANGE: f64 = 4.5;
/// Friction beyond which the yield stress in shear, not friction, limits the traction: k/p =
/// 0.577/2.8, with a margin. Half and twice of it: `benches/constants`.
const FRICTION_LIMIT: f64 = 0.3;
/// First steps of a press, which grow; they are worth half as many of the others. Half and
/// twice of it: `benches/constants`.
const GROWING_STEPS: usize = 4;
/// Steps of an unloading over its estimated elastic recovery. Half and twice of it:
/// `benches/constants`.
pub const RELEASE_STEPS: f64 = 12.0;
/// No increment of a shear is longer than this share of the contact radius; where everything slips
/// those of a shear of given length go on growing up to it. What comes into contact or leaves it
/// while it slips makes an error of the first order in this share: at friction 0.95 and h/R = 0.07,
/// where sticking contacts allow increments five times as long, F_T is 7 % off with those. Half and
/// twice of it: `benches/constants`.
const LARGEST_SHEAR_STEP: f64 = 0.05;
/// No step turns the sphere by more than this angle, in rad: what slips is moved along a chord in
/// it, and friction would point beside the way by half of the angle. Half and twice of it:
/// `benches/constants`.
const LARGEST_TURN: f64 = 0.1;
/// Most steps after the first part of a shear of given length: where nothing touches, say, the slip
/// displacement says nothing. Half and twice of it: `benches/constants`.
const MOST_LATER_STEPS: f64 = 120.0;

impl Target {
    /// Part of the way from `start` to this one.
    pub fn part(&self, start: &Self, share: f64) -> Self {
        let between = |from: f64, to: f64| from + share * (to - from);
        Self {
            h: between(start.h, self.h),
            delta_t: between(start.delta_t, self.delta_t),
            across: between(start.across, self.across),
            angles: std::array::from_fn(|i| between(start.angles[i], self.angles[i])),
            ..*self
        }
    }

    /// What moves from `start` to here: along x and y, and the angles.
    pub fn way_from(&self, start: &Self) -> ([f64; 2], [f64; 3]) {
        let turned = std::array::from_fn(|i| self.angles[i] - start.angles[i]);
        ([self.delta_t - start.delta_t, self.across - start.across], turned)
    }
}

/// Length of a way along and about the surface, over R, for a contact of radius `a`: what turns
/// counts as far as it moves a point at the contact's edge, and what rolls as far as it moves the
/// contact.
pub fn way_length(([x, y], [about_x, about_y, twist]): ([f64; 2], [f64; 3]), a: f64) -> f64 {
    let along = if y == 0.0 { x.abs() } else { x.hypot(y) };
    along + a * twist.abs() + about_x.hypot(about_y)
}

impl Resolution {
    /// Step of h of an unloading.
    pub fn release_step(&self, start: &SegmentStart) -> f64 {
        start.recovery() / RELEASE_STEPS * self.coarseness
    }
}

impl SegmentStart {
    /// Where the segment starts, as a target.
    pub fn place(&self) -> Target {
        let Self { h, delta_t, across, angles, .. } = *self;
        Target { h, delta_t, across, angles, hold_force: false, extrapolate: true }
    }

    /// Elastic modulus E/(1 - nu^2), scaled; with another body that of both, E*.
    fn plane_modulus(&self) -> f64 {
        1.0 / ((1.0 - self.nu * self.nu) * self.compliance[0])
    }

    /// Cattaneo's slip displacement, 3 mu F_N (2 - nu)/(16 G a), as the scale of a shear.
    pub fn slip_displacement(&self) -> f64 {
        let g = 0.5 / (1.0 + self.nu);
        let mu = self.friction.min(FRICTION_LIMIT);
        let scale = 3.0 * mu * self.f_n * (2.0 - self.nu) * self.compliance[1] / (16.0 * g * self.a.max(1e-12));
        // Without friction nothing happens in a shear, but the steps still need a length.
        let floor = 0.01 * self.a.max(1e-6);
        let scale = if scale > 1e-3 * floor { scale } else { floor };
        if self.reversed { 2.0 * scale } else { scale }
    }

    /// Fall of F_N with h at the start of an unloading, 2 E* a.
    pub fn unloading_stiffness(&self, a: f64) -> f64 {
        2.0 * self.plane_modulus() * a
    }

    /// Elastic recovery of an unloading, F_N/(2 E* a) times 3/2 (Hertz: h = 3F/(4E*a)).
    pub fn recovery(&self) -> f64 {
        0.75 * self.f_n / (self.plane_modulus() * self.a.max(1e-12))
    }
}

/// Ends of the `n` steps of a press by `h`: first steps that grow evenly (equal steps of the
/// contact radius after first touch), and, as soon as they are as long, equal steps.
///
/// The error of a step goes with its length over h, and what was wrong in a small contact is
/// forgotten in a larger one: with equal steps of the radius throughout it is twice as large at the
/// end, for the same number of steps.
fn press(n: usize, h: f64) -> Vec<f64> {
    let n = n.max(1);
    let growing = GROWING_STEPS.min(n / 2);
    let step = h / (n as f64 - 0.5 * growing as f64);
    let end = |i: usize| if i <= growing { 0.5 * (i * i) as f64 / growing as f64 } else { i as f64 - 0.5 * growing as f64 };
    (1..=n).map(|i| step * end(i)).collect()
}

/// Targets of an indentation segment from `start` to indentation `h`.
pub fn indentation_targets(start: &SegmentStart, h: f64, resolution: &Resolution) -> Vec<Target> {
    let target = |h, extrapolate| Target { h, extrapolate, ..start.place() };
    let mut targets = Vec::new();
    let mut from = start.h;
    if h > from && from < start.h_max {
        // Loading again, up to where it was. What the press is released to may carry no force at
        // all, so the steps are those of the release from the deepest state; before contact is
        // near, one step does.
        let to = h.min(start.h_max);
        let recovery = start.longest_recovery;
        let near = (start.h_max - 1.5 * recovery).clamp(from, to);
        if near > from {
            targets.push(target(near, false));
        }
        let n = (RELEASE_STEPS / resolution.coarseness * (to - near) / recovery.max(f64::MIN_POSITIVE)).ceil().max(1.0) as usize;
        if to > near {
            targets.extend((1..=n).map(|i| target(near + (to - near) * i as f64 / n as f64, false)));
        }
        if let Some(last) = targets.last_mut() {
            last.h = to;
        }
        from = to;
    } else if h < from {
        let to = h;
        let recovery = start.recovery();
        let length = from - to;
        // Beyond 1.5 recoveries nothing touches any more: one step does for the rest.
        let elastic = if recovery > 0.0 { length.min(1.5 * recovery) } else { 0.0 };
        let n = if recovery > 0.0 {
            (RELEASE_STEPS / resolution.coarseness * elastic / recovery).ceil().max(1.0) as usize
        } else {
            0
        };
        targets.extend((1..=n).map(|i| target(from - elastic * i as f64 / n as f64, false)));
        if length > elastic {
            targets.push(target(to, false));
        } else if let Some(last) = targets.last_mut() {
            last.h = to;
        }
        from = to;
    }
    if h > from {
        // A press that goes on has its share of the steps, and small ones first again: sheared
        // before, it takes up the force that the shear has cost it.
        let rest = h - from;
        let n = match resolution.press_steps {
            _ if rest < 1e-9 * h => 1,
            n if from > 0.0 => (n as f64 * rest / h).ceil() as usize + GROWING_STEPS / 2,
            n => n,
        };
        targets.extend(press(n, rest).into_iter().map(|rise| target(from + rise, true)));
        if let Some(last) = targets.last_mut() {
            last.h = h;
        }
    }
    targets
}

/// Targets of a segment from `start` to `end` in a straight line: at every place no longer than the
/// steps of the press and of the shear alone would be there.
pub fn straight_targets(start: &SegmentStart, end: &Target, resolution: &Resolution) -> Vec<Target> {
    let rise = end.h - start.h;
    let length = way_length(end.way_from(&start.place()), start.a);
    let sheared = sheared_ends(start, end.h, length, end.hold_force, resolution);
    let ends = if end.hold_force || rise == 0.0 {
        vec![1.0]
    } else {
        // Where the segment stands at the end of each step, as shares of it.
        let pressed: Vec<Target> = indentation_targets(start, end.h, resolution);
        let mut ends: Vec<f64> = pressed.iter().map(|t| (t.h - start.h) / rise).collect();
        if let Some(last) = ends.last_mut() {
            *last = 1.0;
        }
        ends
    };
    // Beyond 1.5 recoveries nothing touches any more, and no step is too long; unless another part
    // of the surface comes down.
    let rolls = end.angles[..2] != start.angles[..2];
    let free = if rise < 0.0 && !rolls { (1.5 * start.recovery() / -rise).min(1.0) } else { 1.0 };
    let around = |ends: &mut dyn Iterator<Item = f64>, at: f64| {
        let mut from = 0.0;
        for end in ends {
            if end > at + 1e-9 {
                return end - from;
            }
            from = end;
        }
        1.0
    };
    let (_, turned) = end.way_from(&start.place());
    let turn = turned.iter().map(|angle| angle * angle).sum::<f64>().sqrt();
    let longest = if turn > 0.0 { LARGEST_TURN / turn } else { 1.0 };
    let (mut at, mut targets) = (0.0, Vec::new());
    while at < 1.0 {
        let press = around(&mut ends.iter().copied(), at);
        let shear = if at < free - 1e-9 { around(&mut sheared.iter().copied(), at) } else { 1.0 };
        let step = press.min(shear).min(longest);
        // A rest of less than a third of a step goes with it.
        at = if at + 1.33 * step >= 1.0 { 1.0 } else { at + step };
        targets.push(end.part(&start.place(), at));
    }
    if let Some(last) = targets.last_mut() {
        *last = *end;
    }
    targets
}

/// Ends of the steps of a way of this length along the surface, as shares of it; it ends at `h`.
fn sheared_ends(start: &SegmentStart, h: f64, length: f64, held: bool, resolution: &Resolution) -> Vec<f64> {
    if start.a > 0.0 {
        let steps = ShearSteps::new(start, length, held, resolution);
        (1..).map(|i| steps.distance(i) / length).take_while(|&share| share < 1.0 - 1e-9).chain([1.0]).collect()
    } else {
        // What begins to touch has no slip displacement yet; where all of it slips, steps of a
        // share of its radius do.
        let longest = LARGEST_SHEAR_STEP * resolution.coarseness * h.max(0.0).sqrt();
        let count = (length / longest.max(1e-12)).ceil().clamp(1.0, MOST_LATER_STEPS / resolution.coarseness);
        (1..=count as usize).map(|i| i as f64 / count).collect()
    }
}

/// Tangential displacements of a shear segment, as distances from its start: increments that grow;
/// to `"full-slip"`, which is waited for, equal ones in the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearSteps {
    range: f64,
    total: f64,
    /// Increments of the first, growing part.
    count: usize,
    /// Greatest increment of that part.
    longest: f64,
    /// Bounds of the increments after it.
    least: f64,
    largest: f64,
}

impl ShearSteps {
    /// Steps for a segment of given length (infinite for `"full-slip"`) which holds the normal
    /// force or not.
    pub fn new(start: &SegmentStart, length: f64, held: bool, resolution: &Resolution) -> Self {
        let count = resolution.shear_steps.max(1);
        let range = (SHEAR_RANGE * start.slip_displacement()).min(length);
        let total: f64 = (1..=count).map(|i| (i as f64).powf(SHEAR_GROWTH)).sum();
        let longest = (LARGEST_SHEAR_STEP * start.a).max(range / MOST_LATER_STEPS) * resolution.coarseness;
        let last = (range * (count as f64).powf(SHEAR_GROWTH) / total).min(longest);
        let (least, largest) = if length.is_finite() {
            let least = last.max((length - range) / MOST_LATER_STEPS * resolution.coarseness);
            (least, least.max(longest))
        } else if held {
            // The contact grows until it bears the friction: that is far away where the normal
            // force does not fall.
            (last, last.max(longest))
        } else {
            (last, last)
        };
        Self { range, total, count, longest, least, largest }
    }

    /// Distance from the start of the segment at the end of step `i >= 1`.
    pub fn distance(&self, i: usize) -> f64 {
        let growing = |i: usize| self.range * (i as f64).powf(SHEAR_GROWTH) / self.total;
        let increment =
            |i| if i <= self.count { growing(i).min(self.longest) } else { growing(i).clamp(self.least, self.largest) };
        (1..=i).map(increment).sum()
    }

    /// A shear to full slip is given up beyond this distance.
    pub fn bound(&self, a: f64) -> f64 {
        (3.0 * self.range).max(0.25 * a)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn start(a: f64, friction: f64) -> SegmentStart {
        SegmentStart {
            h: 0.02,
            h_max: 0.02,
            delta_t: 0.0,
            across: 0.0,
            angles: [0.0; 3],
            f_n: 7e-4 * (a / 0.2).powi(2),
            a,
            longest_recovery: 0.002,
            friction,
            nu: 0.3,
            compliance: [1.0; 2],
            reversed: false,
        }
    }

    /// Ends of the steps of a shear.
    fn ends(start: &SegmentStart, length: f64) -> Vec<f64> {
        let steps = ShearSteps::new(start, length, false, &Resolution { press_steps: 20, shear_steps: 15, coarseness: 1.0 });
        (1..).map(|i| steps.distance(i)).take_while(|d| *d < length).collect()
    }

    #[test]
    fn a_press_starts_with_small_steps_and_ends_with_equal_ones() {
        let resolution = |press_steps| Resolution { press_steps, shear_steps: 15, coarseness: 1.0 };
        for n in [1, 2, 3, 5, 9, 24] {
            let first = SegmentStart { h: 0.0, h_max: 0.0, ..start(0.0, 0.3) };
            let ends: Vec<f64> = indentation_targets(&first, 0.02, &resolution(n)).iter().map(|t| t.h).collect();
            assert_eq!((ends.len(), ends[n - 1]), (n, 0.02));
            let steps: Vec<f64> = std::iter::once(ends[0]).chain(ends.windows(2).map(|w| w[1] - w[0])).collect();
            assert!(
                steps.iter().all(|step| *step > 0.0) && steps.windows(2).all(|w| w[0] < w[1] * (1.0 + 1e-9)),
                "{n}: {steps:?}"
            );
            if n >= 9 {
                assert!(steps[0] < 0.2 * steps[n - 1] && (steps[4] / steps[n - 1] - 1.0).abs() < 1e-9, "{n}: {steps:?}");
            }
        }
        // Half of the way is left: half of the steps, and small ones first again.
        let half = SegmentStart { h: 0.01, h_max: 0.01, ..start(0.14, 0.3) };
        let targets = indentation_targets(&half, 0.02, &resolution(24));
        assert!(targets.len() == 14 && targets[0].h < 0.0102 && targets[13].h == 0.02, "{targets:?}");
    }

    #[test]
    fn a_press_after_a_full_release_is_cut_as_the_release_was() {
        let resolution = |coarseness| Resolution { press_steps: 20, shear_steps: 15, coarseness };
        // The release ended where nothing touches, or went on into the air.
        for (h, far) in [(0.0178, 0), (0.01, 1)] {
            let released = SegmentStart { h, f_n: 0.0, a: 0.0, ..start(0.2, 0.3) };
            let targets = indentation_targets(&released, 0.02, &resolution(1.0));
            let ends: Vec<f64> = std::iter::once(h).chain(targets.iter().map(|t| t.h)).collect();
            assert_eq!(ends.last(), Some(&0.02));
            assert!(ends[1 + far..].windows(2).all(|w| w[1] > w[0] && w[1] - w[0] < 0.002 / 11.9), "{ends:?}");
            // A force of next to nothing cuts it no otherwise.
            let touching = SegmentStart { f_n: 1e-12, a: 1e-3, ..released };
            assert_eq!(indentation_targets(&touching, 0.02, &resolution(1.0)), targets);
            assert!(indentation_targets(&released, 0.02, &resolution(2.0)).len() < targets.len());
        }
    }

    #[test]
    fn an_oblique_segment_is_cut_as_finely_as_a_press_and_a_shear() {
        let resolution = Resolution { press_steps: 20, shear_steps: 15, coarseness: 1.0 };
        let first = SegmentStart { h: 0.0, h_max: 0.0, f_n: 0.0, ..start(0.0, 0.3) };
        let later = start(0.2, 0.3);
        for (from, h, d) in [
            (first, 0.02, 0.005),
            (first, 0.02, 0.08),
            (later, 0.025, 0.001),
            (later, 0.0201, 0.03),
            (later, 0.0, 0.02),
            (later, 0.0199, -0.01),
            (SegmentStart { h: 0.019, delta_t: 0.001, ..later }, 0.03, -0.002),
        ] {
            let targets = straight_targets(&from, &Target { h, delta_t: d, ..from.place() }, &resolution);
            let last = targets[targets.len() - 1];
            assert_eq!((last.h, last.delta_t), (h, d));
            assert!(targets.len() <= 160, "{h} {d}: {} steps", targets.len());
            let press = indentation_targets(&from, h, &resolution);
            let longest = |ends: &[f64], whole: f64| {
                std::iter::once(ends[0] - from.h)
                    .chain(ends.windows(2).map(|w| w[1] - w[0]))
                    .fold(0.0, |most: f64, d| most.max((d / whole).abs()))
            };
            let ours: Vec<f64> = targets.iter().map(|t| t.h).collect();
            let theirs: Vec<f64> = press.iter().map(|t| t.h).collect();
            assert!(longest(&ours, h - from.h) <= 1.34 * longest(&theirs, h - from.h) + 1e-9, "{h} {d}: {ours:?}");
            for pair in targets.windows(2) {
                let slope = (pair[1].delta_t - pair[0].delta_t) * (h - from.h) - (pair[1].h - pair[0].h) * (d - from.delta_t);
                assert!(slope.abs() < 1e-12, "not in proportion");
                assert!((pair[1].h - pair[0].h) * (h - from.h) > 0.0);
            }
        }
        // The shear alone bounds the first steps of one that hardly presses.
        let targets = straight_targets(&later, &Target { h: 0.0201, delta_t: 0.03, ..later.place() }, &resolution);
        let steps = ShearSteps::new(&later, 0.03, false, &resolution);
        assert!(targets[0].delta_t <= steps.distance(1) * 1.0001, "{:?}", targets[0]);
    }

    #[test]
    fn no_step_turns_by_far() {
        let resolution = Resolution { press_steps: 20, shear_steps: 15, coarseness: 1.0 };
        let touching = start(0.2, 0.3);
        let first = SegmentStart { h: 0.0, h_max: 0.0, f_n: 0.0, ..start(0.0, 0.3) };
        for (from, h) in [(touching, touching.h), (first, 0.02)] {
            for angles in [[0.0, 0.0, 3.0], [0.1, -0.4, 0.0], [0.0, 0.0, -0.02]] {
                let targets = straight_targets(&from, &Target { h, angles, ..from.place() }, &resolution);
                let mut before = from.place();
                for target in &targets {
                    let (_, turned) = target.way_from(&before);
                    let turn = turned.iter().map(|angle| angle * angle).sum::<f64>().sqrt();
                    assert!(turn <= 1.34 * LARGEST_TURN, "{angles:?}: {turn}");
                    before = *target;
                }
                assert_eq!(before.angles, angles);
            }
        }
    }

    #[test]
    fn a_shear_of_any_length_has_a_bounded_number_of_steps() {
        for (a, friction, length) in
            [(0.2, 0.3, 0.03), (0.2, 0.3, 0.4), (0.2, 1e-6, 0.4), (0.2, 0.0, 0.01), (0.0, 0.3, 0.01), (0.005, 0.5, 0.3)]
        {
            let ends = ends(&start(a, friction), length);
            assert!(ends.len() <= 15 + 120, "a = {a}, mu = {friction}, {length}: {} steps", ends.len());
            assert!(ends.windows(2).all(|w| w[0] < w[1]));
        }
        // Where everything slips the steps go on growing.
        let ends = ends(&start(0.2, 0.3), 0.03);
        assert!((20..45).contains(&ends.len()), "{}", ends.len());
        let last: Vec<f64> = ends.windows(2).map(|w| w[1] - w[0]).collect();
        assert!(last.windows(2).all(|w| w[1] > w[0]) && last.iter().all(|d| *d <= 0.05 * 0.2 * 1.0001));
        // A deep elastic contact, whose slip displacement is a large share of its radius.
        let elastic = SegmentStart { f_n: 4.0 / 3.0 * 0.25_f64.powi(3), reversed: true, ..start(0.25, 0.95) };
        let ends = self::ends(&elastic, 0.6);
        assert!(ends.windows(2).all(|w| w[1] - w[0] <= 0.05 * 0.25 * 1.0001) && ends.len() < 80, "{ends:?}");
    }

    #[test]
    fn waiting_for_full_slip_goes_on_in_equal_steps() {
        let steps = ShearSteps::new(
            &start(0.2, 0.3),
            f64::INFINITY,
            false,
            &Resolution { press_steps: 20, shear_steps: 15, coarseness: 1.0 },
        );
        let increment = |i: usize| steps.distance(i + 1) - steps.distance(i);
        assert!((increment(20) / increment(40) - 1.0).abs() < 1e-9 && increment(2) < increment(10));
    }
}
