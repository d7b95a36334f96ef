//! The table of two unlike bodies from one table of each: the bodies in series.
//!
//! *Pressed* (Olsson & Larsson 2016; Storakers, Biwa & Larsson 1997): the pair meets as closely as
//! two bodies of radii R_1' and R_2' on the plane between them, 1/R_1' + 1/R_2' = 1/R*, that have
//! the same F_N and the same a; h = h_1 + h_2. So one table serves all radii, scaled by R*.
//!
//! *Sheared at constant h*: both carry the same F_T and F_N, delta_T is the sum, and F_N falls as
//! the body that flows creeps into the other, which unloads. At a ratio F_T/F_N a body that stands
//! on its limit curve has a share g of its F_N0; a stronger one is below its curve and elastic. By
//! itself a body at constant h creeps by what its own approach loses; in the pair by what those of
//! both lose. The plastic part of its delta_T is that of its own curve times the quotient: with a
//! stiff opponent the weak body has nearly all of the flow to do. Stiffnesses of unloading and of
//! reversal are in series.
//!
//! What hangs on the true radii is the constraint of a deep plastic contact: a slender body gives
//! way at less pressure. That is one number, of simulated pairs at other ratios of their radii.
//!
//! Exact for two equal bodies and in Hertz's limit.

use rayon::iter::{IntoParallelIterator, ParallelIterator};

use super::against::{Against, equivalent};
use super::body::{BodyInSeries, PressedBody};
use super::build::{LENGTH, NEARLY_SLIPPING, depths, hertzian, points};
use super::{FORMAT, Level, Tabulated, VERSION, check_levels};
use crate::analytical::ElasticSphere;
use crate::case::{Case, Friction, Opponent, Segment, Sphere};
use crate::contact_law::{Centres, POINTS, measured_slope};
use crate::law::LawError;
use crate::law::range::Interval;

/// A root is found when its bracket has become as narrow as by so many halvings,
const HALVINGS: i32 = 60;
/// or after so many steps, of which every fourth halves it at the latest.
const MOST_STEPS: usize = 4 * 60;
/// Steps of regula falsi in which the bracket has to become half as wide.
const STEPS: usize = 3;
/// Rounds in which the contact radius and the two curvatures settle.
const ROUNDS: usize = 20;
/// Steps of F_T/F_N along a shear.
const RATIOS: usize = 96;
/// Places of a limit curve.
const FINE: usize = 4 * POINTS;
/// A body creeps at most so many times as far as by itself. Half and twice of it:
/// `benches/constants`.
const MOST_CREEP: f64 = 6.0;
/// Share of the limit curve from which a body stands on it.
const ON_CURVE: f64 = 1.0 - 1e-6;
/// What the two are called.
const NAMES: [&str; 2] = ["sphere", "opponent"];
/// Share of the approach below which a creep is none.
const NO_CREEP: f64 = 1e-4;

/// Where a rising function becomes positive: by regula falsi with halved weights (the Illinois
/// algorithm, Dowell & Jarratt 1971), and by halving where three of its steps have not halved the
/// bracket. Roots are sought within roots: halving alone took 60 times 60 evaluations.
fn root(mut low: f64, mut high: f64, rising: impl Fn(f64) -> f64) -> f64 {
    let (mut below, mut above) = (rising(low), rising(high));
    let narrow = (high - low) * 0.5f64.powi(HALVINGS);
    let (mut width, mut left, mut side) = (high - low, STEPS, 0);
    for _ in 0..MOST_STEPS {
        let middle = 0.5 * (low + high);
        if high - low <= narrow || middle <= low || middle >= high {
            return middle;
        }
        let straight = high - above * (high - low) / (above - below);
        let bisects = left == 0 || !(below <= 0.0 && above > 0.0 && straight > low && straight < high);
        // A root at an end of the bracket is found from both of its sides.
        let nudge = (2.0 * f64::EPSILON * straight.abs()).max(narrow);
        let nudged = if low + nudge < high - nudge { straight.clamp(low + nudge, high - nudge) } else { middle };
        let at = if bisects { middle } else { nudged };
        let value = rising(at);
        if value > 0.0 {
            (high, above) = (at, value);
            below *= if side == 1 && !bisects { 0.5 } else { 1.0 };
            side = 1;
        } else {
            (low, below) = (at, value);
            above *= if side == -1 && !bisects { 0.5 } else { 1.0 };
            side = -1;
        }
        left = left.saturating_sub(1);
        if high - low <= 0.5 * width || bisects {
            (width, left) = (high - low, STEPS);
        }
    }
    0.5 * (low + high)
}

/// The contact radius of the two: they have the same but for what [`RISING`] bends.
fn mean_radius(pressed: &[PressedBody; 2]) -> f64 {
    0.5 * (pressed[0].a + pressed[1].a)
}

/// The limit curve of a body at constant h, over its F_N0.
struct LimitCurve {
    /// x, F_T and F_N, from x = 0 on.
    points: Vec<[f64; 3]>,
    /// The greatest F_T/F_N up to there.
    ratios: Vec<f64>,
}

impl LimitCurve {
    fn new(level: &Level, friction: f64) -> Self {
        let at = |shape: &[f64], x: f64| {
            let j = ((POINTS as f64 * x.sqrt()) as usize).min(POINTS - 1);
            let place = |j: usize| (j as f64 / POINTS as f64).powi(2);
            let below = if j == 0 { 0.0 } else { shape[j - 1] };
            below + (shape[j] - below) * (x - place(j)) / (place(j + 1) - place(j))
        };
        let left = level.slip_share;
        let points: Vec<[f64; 3]> = (0..=FINE)
            .map(|i| (i as f64 / FINE as f64).powi(2))
            .map(|x| [x, friction * left * at(&level.tangential, x), 1.0 - (1.0 - left) * at(&level.normal, x)])
            .collect();
        let mut greatest = 0.0f64;
        let ratio = |point: &[f64; 3]| {
            greatest = greatest.max(point[1] / point[2]);
            greatest
        };
        let ratios = points.iter().map(ratio).collect();
        Self { points, ratios }
    }

    fn last_ratio(&self) -> f64 {
        self.ratios[FINE]
    }

    /// x and F_N where F_T/F_N first is `ratio`.
    fn at_ratio(&self, ratio: f64) -> [f64; 2] {
        let i = self.ratios.partition_point(|&known| known < ratio).clamp(1, FINE);
        let (before, after) = (self.ratios[i - 1], self.ratios[i]);
        let u = if after > before { ((ratio - before) / (after - before)).min(1.0) } else { 1.0 };
        [0, 2].map(|k| self.points[i - 1][k] + u * (self.points[i][k] - self.points[i - 1][k]))
    }

    /// x where F_T first is `force`; 1 where it never is.
    fn at_force(&self, force: f64) -> f64 {
        let Some(i) = self.points.iter().position(|point| point[1] >= force) else { return 1.0 };
        if i == 0 {
            return 0.0;
        }
        let (before, after) = (self.points[i - 1], self.points[i]);
        before[0] + (after[0] - before[0]) * (force - before[1]) / (after[1] - before[1])
    }
}

/// The two bodies at an indentation.
struct PressedPair<'a> {
    bodies: &'a [BodyInSeries; 2],
    pressed: [PressedBody; 2],
    friction: f64,
    h: f64,
    /// The two are one body twice: each has half of all.
    alike: bool,
}

impl<'a> PressedPair<'a> {
    /// Presses the bodies together by `h`, the radii being shared out of `radius`, R*.
    fn new(bodies: &'a [BodyInSeries; 2], radius: f64, friction: f64, h: f64) -> Self {
        let alike = bodies[0].like(&bodies[1]);
        if alike {
            let pressed = [0, 1].map(|i| bodies[i].pressed(2.0 * radius, 0.5 * h));
            return Self { bodies, pressed, friction, h, alike };
        }
        let at = |a: f64| {
            // Of the curvature 1/R* the first body has the share k.
            let k = root(1e-9, 1.0 - 1e-9, |k| bodies[0].pressure(a, radius / k) - bodies[1].pressure(a, radius / (1.0 - k)));
            let radii = [radius / k, radius / (1.0 - k)];
            let own = root(0.0, h, |own| bodies[0].force(radii[0], own) - bodies[1].force(radii[1], h - own));
            [bodies[0].pressed(radii[0], own), bodies[1].pressed(radii[1], h - own)]
        };
        let mut pressed = at((h * radius).sqrt());
        for _ in 0..ROUNDS {
            pressed = at(mean_radius(&pressed));
        }
        Self { bodies, pressed, friction, h, alike }
    }

    /// By how much body `i` gives way under F_N = `force` where its limit curve is at `cap` times
    /// its F_N0: less than before the shear where it is below the curve.
    fn gives_way(&self, i: usize, force: f64, cap: f64) -> f64 {
        let body = &self.pressed[i];
        if force < cap * body.force * (1.0 - 1e-12) {
            return body.h - body.recovered(force);
        }
        body.h.max(root(body.h, body.h + self.h, |h| cap * self.bodies[i].force(body.radius, h) - force))
    }

    /// The shear at constant h: delta_T, F_T and F_N from its start on.
    fn shear(&self) -> Vec<[f64; 3]> {
        let (mu, both) = (self.friction, &self.pressed);
        let limits = [0, 1].map(|i| LimitCurve::new(&both[i].level, mu));
        let end = limits[0].last_ratio().min(limits[1].last_ratio()).min(mu * (1.0 - 1e-9));
        let mut curve = vec![[0.0, 0.0, both[0].force]];
        let mut reached = [0.0f64; 2];
        for n in 1..=RATIOS {
            let ratio = end * (1.0 - (1.0 - n as f64 / RATIOS as f64).powf(1.5));
            let places = [0, 1].map(|i| limits[i].at_ratio(ratio));
            let gap = |force: f64| (0..2).map(|i| self.gives_way(i, force, places[i][1])).sum::<f64>() - self.h;
            // Two that are alike stand on their limit curves together: the gap jumps there.
            let force = if self.alike { places[0][1] * both[0].force } else { root(0.0, both[0].force, gap) };
            let flows = [0, 1].map(|i| force >= ON_CURVE * places[i][1] * both[i].force);
            let way: [f64; 2] = [0, 1].map(|i: usize| match (flows[i], flows[1 - i]) {
                // Where the other is elastic, this one takes what that gives back.
                (true, false) => self.h - self.gives_way(1 - i, force, places[1 - i][1]),
                _ => both[i].h,
            });
            for i in 0..2 {
                let deflection = if flows[i] {
                    self.flowing(i, way[i], force, ratio, places[i])
                } else {
                    let along = limits[i].at_force(ratio * force / both[i].force) * both[i].slip;
                    along.max(both[i].elastic(mu, force, ratio))
                };
                reached[i] = reached[i].max(deflection);
            }
            curve.push([reached[0] + reached[1], ratio * force, force]);
        }
        curve
    }

    /// delta_T of body `i` on its limit curve, at x and F_N over F_N0 of `place`, where it gives
    /// way by `way`.
    fn flowing(&self, i: usize, way: f64, force: f64, ratio: f64, place: [f64; 2]) -> f64 {
        let before = &self.pressed[i];
        let now = self.bodies[i].pressed(before.radius, way.max(before.h));
        let [x, left] = place;
        let whole = x * now.slip;
        let by_itself = now.recovered(left * now.force);
        if by_itself <= NO_CREEP * now.depth {
            return whole;
        }
        let creep = way - before.h + before.recovered(force);
        let elastic = now.elastic(self.friction, left * now.force, ratio).min(whole);
        elastic + (whole - elastic) * (creep / by_itself).clamp(0.0, MOST_CREEP)
    }

    /// c of the two in the press that `law tabulate` makes: both have the same r = F_T/F_N, and the
    /// way of each along F_T is its h times its slope. None where one that yields has no c.
    fn yield_coefficient(&self) -> Option<f64> {
        let of = |body: &PressedBody| Some([body.h, body.level.yield_coefficient?]);
        let both = [of(&self.pressed[0])?, of(&self.pressed[1])?];
        let slope = measured_slope(self.friction);
        if self.bodies.iter().all(|body| body.elastic) || !(slope > 0.0) {
            return None;
        }
        // The ratio at which the first of them flows without bounds.
        let most = both.iter().map(|[_, c]| c.sqrt().recip()).fold(f64::INFINITY, f64::min);
        let way = |r: f64| both.iter().map(|[h, c]| h * 2.0 * c * r / (1.0 - c * r * r)).sum::<f64>();
        let r = root(0.0, (1.0 - 1e-9) * most, |r| way(r) - slope * self.h);
        Some(slope / (r * (2.0 + slope * r)))
    }

    /// The level of the pair, in units of the sphere's R and E.
    fn level(&self, sphere: &ElasticSphere) -> Level {
        let both = &self.pressed;
        let series = |of: fn(&PressedBody) -> f64| 1.0 / (1.0 / of(&both[0]) + 1.0 / of(&both[1]));
        let (f_n0, a0, k_t) = (both[0].force, mean_radius(both), series(|body| body.k_t));
        let unloading_radius = series(|body| body.stiffness) / (2.0 * sphere.effective_modulus());
        if self.friction <= 0.0 {
            // There is nothing to shear.
            return Level { f_n0, a0, unloading_radius, k_t, ..hertzian(sphere, self.friction, self.h) };
        }
        // The bend of delta_T over F_T at the start of a reversal, (1 - 1/n)/k_T, adds up.
        let bend: f64 = both.iter().map(|body| (1.0 - 1.0 / body.level.backbone) / body.k_t).sum();
        let curve = self.shear();
        // As in a table that is simulated, x = 1 is beyond what the eye calls full slip.
        let slipping = NEARLY_SLIPPING * self.friction;
        let place = |i: usize| curve[i][1] / curve[i][2];
        let nearly = curve.partition_point(|point| point[1] < slipping * point[2]).clamp(1, RATIOS);
        let share = ((slipping - place(nearly - 1)) / (place(nearly) - place(nearly - 1))).clamp(0.0, 1.0);
        let end = LENGTH * (curve[nearly - 1][0] + share * (curve[nearly][0] - curve[nearly - 1][0]));
        let at = |x: f64, k: usize| {
            let delta = x * end;
            let i = curve.partition_point(|point| point[0] < delta).clamp(1, RATIOS);
            let (before, after) = (curve[i - 1], curve[i]);
            let step = after[0] - before[0];
            if step > 0.0 { before[k] + (after[k] - before[k]) * ((delta - before[0]) / step).min(1.0) } else { after[k] }
        };
        let f_n_slip = at(1.0, 2);
        let lost = f_n0 - f_n_slip;
        let normal = |x: f64| if lost > 1e-3 * f_n0 { ((f_n0 - at(x, 2)) / lost).clamp(0.0, 1.0) } else { x };
        let tangential = |x: f64| at(x, 1) / (self.friction * f_n_slip);
        Level {
            h: self.h,
            f_n0,
            a0,
            slip_share: (f_n_slip / f_n0).min(1.0),
            delta_t_end: end,
            unloading_radius,
            k_t,
            backbone: 1.0 / (1.0 - bend * k_t),
            yield_coefficient: self.yield_coefficient(),
            tangential: points().map(tangential).collect(),
            normal: points().map(normal).collect(),
        }
    }
}

impl Level {
    /// The same shear in units of what another series has when it is pressed.
    fn pressed_as(self, series: &PressedPair<'_>) -> Self {
        let (f_n0, a0) = (series.pressed[0].force, mean_radius(&series.pressed));
        let wider = a0 / self.a0;
        Self {
            f_n0,
            a0,
            delta_t_end: self.delta_t_end * f_n0 / self.f_n0 / wider,
            unloading_radius: self.unloading_radius * wider,
            k_t: self.k_t * wider,
            ..self
        }
    }
}

/// What the body of a table meets in it.
fn opponent_of(table: &Tabulated) -> Result<Option<Opponent>, LawError> {
    match table.body {
        Against::EqualSphere => Ok(Some(Opponent::Equal)),
        Against::Plane => Ok(None),
        _ => Err(LawError::NotCovered {
            problem: "a table of two unlike bodies says nothing of one of them",
            remedy: "Tabulate each body against its equal: [opponent] equal = true",
        }),
    }
}

/// The table of the pair of `case`, from one of the sphere and one of its opponent, each of that
/// body against its equal (or, less near, on a rigid plane), at the depths that a table of the
/// pair would simulate.
///
/// # Errors
/// [`LawError::NotCovered`] for a case without an opponent that deforms, or with full stick;
/// [`LawError::OtherMaterial`] where a table is not of its body or of another friction;
/// [`LawError::Shallow`] where one ends before the pair does.
pub fn compose(case: &Case, tables: [&Tabulated; 2]) -> Result<Tabulated, LawError> {
    compose_from(case, tables, tables)
}

/// The same of two tables of each body: one that it is pressed by, and one for the shear, whose
/// force and size are scaled to those of the press.
///
/// # Errors
/// Those of [`compose`].
pub fn compose_from(case: &Case, tables: [&Tabulated; 2], for_shear: [&Tabulated; 2]) -> Result<Tabulated, LawError> {
    let scaled = case.scaled().0;
    let (Some(Opponent::Deforming { material: other, radius: other_radius }), Friction::Coefficient(friction)) =
        (&scaled.opponent, scaled.contact.friction)
    else {
        return Err(LawError::NotCovered {
            problem: "two bodies in series need an opponent that deforms, and a friction coefficient",
            remedy: "Give the case an [opponent] with a radius or flat = true, and contact.friction a number",
        });
    };
    let materials = [&scaled.material, other];
    let of_sphere = if scaled.sphere.flat { 0.0 } else { 1.0 };
    let curvatures = [of_sphere, other_radius.map_or(0.0, f64::recip)];
    let body = |i: usize, tables: [&Tabulated; 2], curvature: Option<f64>| {
        let (table, material, name) = (tables[i], materials[i], NAMES[i]);
        let opponent = opponent_of(table)?;
        let alone = Case {
            sphere: Sphere { flat: false, ..scaled.sphere.clone() },
            material: material.clone(),
            opponent,
            ..scaled.clone()
        };
        table.covers(&alone).map_err(|error| match error {
            LawError::OtherMaterial { what } => LawError::OtherMaterial { what: format!("of the {name}, {what}") },
            error => error,
        })?;
        // Of h in the table this much is one body's.
        Ok::<BodyInSeries, LawError>(BodyInSeries::new(table, material, 1.0 / alone.bodies(), curvature))
    };
    let bodies = [body(0, tables, Some(curvatures[0]))?, body(1, tables, Some(curvatures[1]))?];
    let sheared = [body(0, for_shear, None)?, body(1, for_shear, None)?];
    let radius = scaled.effective_radius();
    let sphere = equivalent(&scaled);
    let level = |h: f64| {
        let series = PressedPair::new(&bodies, radius, friction, h);
        for (i, body) in bodies.iter().enumerate() {
            let place = series.pressed[i].h / (body.share * series.pressed[i].radius);
            if place > body.range.to * (1.0 + 1e-6) {
                return Err(LawError::Shallow { body: NAMES[i], has: body.range.to, needs: place });
            }
        }
        Ok(PressedPair::new(&sheared, radius, friction, h).level(&sphere).pressed_as(&series))
    };
    // All of them, so that the error does not depend on which is the first to be done.
    let levels: Vec<Result<Level, LawError>> = depths(case)?.into_par_iter().map(level).collect();
    let levels = levels.into_iter().collect::<Result<Vec<Level>, LawError>>()?;
    check_levels(&levels).map_err(|problem| LawError::NoTable { problem })?;
    let range = Interval { from: levels[0].h, to: levels[levels.len() - 1].h };
    let elements = tables.map(|table| table.elements_per_contact_radius);
    Ok(Tabulated {
        format: FORMAT.to_owned(),
        version: VERSION,
        body: Against::of(&scaled),
        frame: Centres::of(&scaled).frame(),
        program: format!("asperity {}, in series from the tables of its two bodies", env!("CARGO_PKG_VERSION")),
        case: super::cases::case_of(&scaled, elements[0].min(elements[1])).to_toml(),
        range,
        elements_per_contact_radius: elements[0].min(elements[1]),
        levels,
        errors: Vec::new(),
    })
}

/// The two bodies of a pair as [`compose`] wants their tables: each by itself with the friction of
/// the pair, on a rigid plane or against an equal sphere, pressed as deep as the pair may need,
/// with `spare` to multiply it; R = 1, E that of the sphere. `None` of a case whose opponent does
/// not deform.
pub fn bodies_alone(case: &Case, opponent: Against, spare: f64) -> Option<[Case; 2]> {
    let scaled = case.scaled().0;
    let Some(Opponent::Deforming { material: other, .. }) = scaled.opponent.clone() else { return None };
    let deepest = scaled.greatest_indentation();
    let radius = scaled.effective_radius();
    let opponent = (opponent == Against::EqualSphere).then_some(Opponent::Equal);
    let mut base = Case { sphere: Sphere { flat: false, ..scaled.sphere.clone() }, opponent, ..scaled };
    // One body may give way by all of h, and its R' is R* at the least; a table of an equal pair
    // counts what both of its spheres give way.
    base.path = vec![Segment::Indentation { indentation: spare * base.bodies() * deepest / radius }];
    Some([base.clone(), Case { material: other, ..base }])
}

#[cfg(test)]
mod tests;
