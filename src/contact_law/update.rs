//! One increment of one contact. The C header has the functions of `table`, `sliders`, `step` and
//! this file, in that order, and does the same operations.

use super::sectors::{Sectors, Twist};
use super::sliders::energy;
use super::state::{ContactResponse, ContactState, MOST};
use super::step::{Guess, LESS, Step, Terms};
use super::table::{
    COLUMNS, FIRST_N, GAMMA, LN_FORCE, LN_RADIUS, LN_STIFFNESS, RADIAL_SLIP, Row, SLIDERS, SOFTENING, SUDDEN, Table, UNSHEARED_N,
    exponent, lost,
};
use super::turning_constants::TurningConstants;

/// Steps of Newton.
const STEPS: usize = 20;
/// Steps of a bracket where Newton does not find the way.
const BRACKETS: usize = 100;
/// Parts of a step, at the most, where neither does; `tests/law/unsolved.c` counts what is left.
const PARTS: u32 = 256;
/// Steps for the ratio at a hardening, greatest one over mu; on the way to it, and of its bracket,
/// before halves and of halves.
const RATIOS: usize = 50;
const SHORT: f64 = 1.0 / 15.0;
const WAYS: usize = 400;
const SLOWLY: usize = 600;
const HALVES: usize = 20;
/// Guesses of a bracket, at the most, and of all brackets of a step: where these do not do, parts
/// are found sooner. `tests/law/unsolved.c` counts what is left.
const GUESSES: u32 = 1 << 12;
const ALL_GUESSES: u32 = 1 << 16;
/// Hardening of a step over the depth and the elastic approach, at the most.
const MOST_HARDENING: f64 = 3.0;
/// Of F_N over the yield force and of F_T/F_N.
const TOLERANCE: f64 = 1e-12;
/// What is good enough where rounding leaves no better.
const ENOUGH: f64 = 1e-7;
/// Share of mu below which the vertex hardly tells whether slip is against it.
const HARDLY: f64 = 0.02;
/// An overlap below this is none: the powers of a smaller one are no numbers any more.
const LEAST: f64 = 1e-30;

/// A root between two places, by the secant; of a side that stays the excess is halved (the
/// Illinois method). The excess is above 0 at `low`, below 0 at `high`.
#[derive(Default)]
struct Between {
    low: f64,
    high: f64,
    at_low: f64,
    at_high: f64,
    side: i32,
}

impl Between {
    fn secant(&self) -> f64 {
        self.high - self.at_high * (self.high - self.low) / (self.at_high - self.at_low)
    }

    fn narrow(&mut self, place: f64, excess: f64) {
        if excess > 0.0 {
            (self.low, self.at_low) = (place, excess);
            self.at_high *= if self.side == 1 { 0.5 } else { 1.0 };
            self.side = 1;
        } else {
            (self.high, self.at_high) = (place, excess);
            self.at_low *= if self.side == -1 { 0.5 } else { 1.0 };
            self.side = -1;
        }
    }
}

/// F_N at an elastic approach of a contact that is wider than its F_N by `stiffened`.
pub(super) fn elastic_force(row: &Row, e: f64, stiffened: f64) -> f64 {
    let gamma = row.value[GAMMA];
    row.value[LN_FORCE] * (gamma * (e / row.approach).ln() + (gamma - 1.0) * stiffened.ln_1p()).exp()
}

/// Moves a contact: see [`ContactParameters::update`](super::ContactParameters::update).
pub(super) fn update(table: &Table, state: &ContactState, h: f64, increment: [f64; 2]) -> (ContactState, ContactResponse) {
    if !(h.abs() <= MOST && increment[0].is_finite() && increment[1].is_finite() && state.is_sound()) {
        let nan = f64::NAN;
        let out = ContactResponse {
            f_n: nan,
            f_t: [nan; 2],
            df_t_ddelta: [[nan; 2]; 2],
            df_n_dh: nan,
            df_n_ddelta: [nan; 2],
            a: nan,
            df_t_dh: [nan; 2],
        };
        return (*state, out);
    }
    let h = if h.abs() < LEAST { 0.0 } else { h };
    let size = increment[0].abs().max(increment[1].abs());
    moved(table, state, h, if size > MOST { increment.map(|d| d / size * MOST) } else { increment })
}

/// Elastic energy of a contact: see
/// [`ContactParameters::stored_energy`](super::ContactParameters::stored_energy).
pub(super) fn stored_energy(table: &Table, state: &ContactState) -> f64 {
    if !state.is_sound() {
        return f64::NAN;
    }
    let e = state.approach;
    if !(e > 0.0) {
        return 0.0;
    }
    let row = table.read(table.first + state.hardened, COLUMNS);
    let f_n = elastic_force(&row, e, state.stiffened);
    f_n * e / (row.value[GAMMA] + 1.0) + energy(&state.slider, row.value[LN_STIFFNESS])
}

/// The contact moved to h and by d.
pub(super) fn moved(table: &Table, state: &ContactState, h: f64, d: [f64; 2]) -> (ContactState, ContactResponse) {
    let (state, response, _) = moved_with(table, state, None, h, d);
    (state, response)
}

/// The same with a twist, or none: its sectors' forces and its vertex after the step, where there
/// is contact.
///
/// A step that is so long that its answer is not found is taken in parts: flow that fades at full
/// slip may leave it several, and a slower one comes to the right one. The tangent is that of the
/// last part.
pub(super) fn moved_with(table: &Table, state: &ContactState, twist: Option<&Twist>, h: f64, d: [f64; 2]) -> Moved {
    let (mut parts, mut left) = (1, ALL_GUESSES);
    loop {
        if let Some(moved) = moved_in(parts, table, state, twist, (h, d), &mut left) {
            return moved;
        }
        parts *= 2;
    }
}

/// State, answer, and of a twist the sectors' forces and the vertex.
type Moved = (ContactState, ContactResponse, Option<(Sectors, f64)>);

/// A step in so many parts; none where the answer of one was not found. Of [`PARTS`] what is
/// nearest will do. `left`: guesses of brackets.
fn moved_in(
    parts: u32,
    table: &Table,
    state: &ContactState,
    twist: Option<&Twist>,
    (h, d): (f64, [f64; 2]),
    left: &mut u32,
) -> Option<Moved> {
    let share = 1.0 / f64::from(parts);
    let mut from = *state;
    let mut turn = twist.map(|twist| {
        let trial = twist.ratio + (twist.trial - twist.ratio) * share;
        Twist { along: twist.along * share, trial, ..twist.clone() }
    });
    for k in 1.. {
        let to = if k < parts { state.h + (h - state.h) * (f64::from(k) * share) } else { h };
        let (next, response, sectors) =
            moved_once(table, &from, turn.as_ref(), (to, d.map(|d| d * share)), parts == PARTS, left)?;
        if let Some(turn) = &mut turn {
            (turn.sectors, turn.vertex) = sectors.unwrap_or((Sectors::default(), turn.vertex));
        }
        if k == parts {
            return Some((next, response, turn.map(|turn| (turn.sectors, turn.vertex))));
        }
        from = next;
    }
    None
}

/// A step as it is; none where its answer is not found, unless it is the `last` way.
fn moved_once(
    table: &Table,
    state: &ContactState,
    twist: Option<&Twist>,
    (h, d): (f64, [f64; 2]),
    last: bool,
    left: &mut u32,
) -> Option<Moved> {
    let (mut step, released) = begin(table, state, twist, h, d);
    let mut o = Guess::default();
    let elastic = step.elastic(&mut o);
    let force = step.row.value[LN_FORCE];
    let mut trial = [0.0; 2];
    if elastic.is_some() {
        trial = o.f_t.map(|f_t| f_t / o.f_n);
        o.factor = step.factor_at(trial);
    }
    let load = o.f_n / force;
    if elastic.is_none() || load * o.factor <= step.rho * step.kept() * (1.0 + 1e-11) {
        if let Some(terms) = &elastic {
            step.slopes(terms, &mut o);
        }
        let tangent = std::array::from_fn(|j| o.slopes(j, [0.0; 3]));
        let sectors = elastic.and_then(|terms| Some((*terms.sectors?, twist?.vertex)));
        return Some((step.keep(&o, h, 0.0, state.softened, released), step.answer(&o, 0.0, tangent), sectors));
    }
    let trial_load = load * o.factor;
    let (r, factor) = step.begin_flow(&o, trial);
    let guess = step.first_guess(load * factor);
    let way = step.hinted(trial, r, trial_load);
    let hinted = way.begin.and_then(|(y, r)| step.newton(y, r, &mut o));
    let found = hinted.or_else(|| step.newton(guess, r, &mut o));
    let (y, terms) = found.unwrap_or_else(|| {
        o.tries = GUESSES.min(*left);
        *left -= o.tries;
        let answer = step.bracket(guess, r, &mut o);
        *left += o.tries;
        answer
    });
    let [a, b, c] = o.residual;
    if !(last || a * a + b * b + c * c <= ENOUGH * ENOUGH) {
        return None;
    }
    if let Some(terms) = &terms {
        step.slopes(terms, &mut o);
    }
    let tangent = std::array::from_fn(|j| o.slopes(j, o.solve(o.by[3 + j]).unwrap_or_default()));
    let [softened, released] = step.left_released(&o, y);
    let mut next = step.keep(&o, h, y, softened, released);
    if let Some(terms) = &terms {
        next.hint = way.left(next.hint, y, terms.r, r);
    }
    let sectors = terms.and_then(|terms| Some((*terms.sectors?, o.twist_vertex)));
    Some((next, step.answer(&o, y, tangent), sectors))
}

/// F_N and F_T over it that a state holds; none without contact.
fn held(row: &Row, state: &ContactState) -> Option<(f64, [f64; 2])> {
    if !(state.approach > 0.0) {
        return None;
    }
    let f_n = elastic_force(row, state.approach, state.stiffened);
    let sum = |along: &[f64; SLIDERS]| along.iter().sum::<f64>() / f_n;
    Some((f_n, [sum(&state.slider[0]), sum(&state.slider[1])]))
}

/// A step before it flows, and the greatest share of F_N released after it.
fn begin<'a>(table: &'a Table, state: &'a ContactState, twist: Option<&'a Twist>, h: f64, d: [f64; 2]) -> (Step<'a>, f64) {
    let depth = table.first + state.hardened;
    let row = table.read(depth, COLUMNS);
    let e = state.approach + (h - state.h);
    let whole = (1.0 - state.softened) * row.value[SOFTENING];
    let (mut released, mut rho_slope) = (state.released, 0.0);
    if e < state.reach && state.reach > 0.0 {
        let gamma = row.value[GAMMA];
        let share = if e > 0.0 { (gamma * (e / state.reach).ln()).exp() } else { 0.0 };
        if 1.0 - share > released {
            released = 1.0 - share;
            rho_slope = if e > 0.0 { whole * 2.0 * released * gamma * share / e } else { 0.0 };
        }
    }
    let (worn, worn_by) = worn(table, &row, (state, twist), e, d);
    let exponent_at = |worn: f64| exponent(row.value[FIRST_N], row.value[UNSHEARED_N], table.later, worn);
    let (exponent, exponent_before) = (exponent_at(worn), exponent_at(worn + LESS));
    let step = Step {
        table,
        state,
        twist,
        row,
        approach: e,
        d,
        depth,
        reach: row.approach,
        radial: row.value[RADIAL_SLIP],
        sudden: row.value[SUDDEN],
        rho: 1.0 - state.softened - whole * released * released,
        rho_slope,
        rises: false,
        growing: 0.0,
        growing_slope: 0.0,
        worn,
        worn_by,
        exponent,
        lost: lost(exponent),
        exponent_before,
        lost_before: lost(exponent_before),
    };
    (step, released)
}

/// How far it was sheared and its slip reversed, as a step goes on from there, with slopes by h and
/// d. It follows r over a little way of d or F_N, and a press takes it back: a step that goes
/// nowhere leaves it, and with it the sliders.
fn worn(table: &Table, row: &Row, (state, twist): (&ContactState, Option<&Twist>), e: f64, d: [f64; 2]) -> (f64, [f64; 3]) {
    let (mut worn, mut by) = (state.worn, [0.0; 3]);
    let Some((f_n, r)) = held(row, state) else { return (worn, by) };
    let (mu, constants, gamma) = (table.friction, &table.constants, row.value[GAMMA]);
    let r = r.map(|r| r / mu);
    let turning = TurningConstants::FITTED;
    let twisted = twist.map_or(0.0, |twist| twist.ratio / (mu * turning.twist_yield));
    let size = (r[0] * r[0] + r[1] * r[1] + twisted * twisted).sqrt().min(1.0);
    let mut to = worn.max(size).max((twisted.abs() * turning.twist_worn).min(turning.twist_most));
    let vertex = state.vertex;
    let back = -(r[0] * vertex[0] + r[1] * vertex[1]);
    if back > 0.0 {
        // Slip against the vertex of a contact that was sheared.
        let length = (vertex[0] * vertex[0] + vertex[1] * vertex[1]).sqrt();
        let (sheared, back) = (to.min(1.0), (back / length).min(1.0));
        let fourth = sheared * sheared * sheared * sheared;
        to = to.max(sheared + (2.0 - sheared) * fourth * back * back * length / (length + HARDLY * mu));
    }
    if to > worn {
        let trial = if e > 0.0 { elastic_force(row, e, state.stiffened) } else { 0.0 };
        let k = 1.0 / (constants.follows * mu * f_n);
        let (kd, kn) = (row.value[LN_STIFFNESS] * k, if trial < f_n { -k * mu } else { k * mu });
        let turn = twist.map_or(0.0, |twist| twist.along);
        let way = (d[0] * d[0] + d[1] * d[1] + turn * turn).sqrt();
        let slope = (to - worn) * (-kd * way - kn * (trial - f_n)).exp();
        worn = to - slope;
        let along = |d: f64| if way > 0.0 { slope * kd * d / way } else { 0.0 };
        by = [if e > 0.0 { slope * kn * gamma * trial / e } else { 0.0 }, along(d[0]), along(d[1])];
    }
    if worn > size && e > state.reach {
        let per = constants.forgets / row.approach * row.dent_slope / (row.dent_slope + row.approach_slope + 1e-12);
        let pressed = ((state.reach - e) * per).exp();
        worn = size + (worn - size) * pressed;
        by = [by[0] * pressed - (worn - size) * per, by[1] * pressed, by[2] * pressed];
    }
    (worn, by)
}

impl Step<'_> {
    /// The yield factor at its start, at a ratio.
    fn factor_at(&self, r: [f64; 2]) -> f64 {
        let [x, y] = [r[0] - self.state.vertex[0], r[1] - self.state.vertex[1]];
        let m = self.twisted();
        let z = self.twist.map_or(0.0, |twist| m - twist.vertex);
        let ratio = (r[0] * r[0] + r[1] * r[1] + m * m).sqrt();
        self.table.factor(&self.row, ratio, (x * x + y * y + z * z).sqrt()).0
    }

    /// Sets the yield factor from which flow begins: that of the start of the step, or that at
    /// which the elastic answer `o` reaches the yield force. The ratio of the start, which is a
    /// better guess than that of the `trial`, and its yield factor.
    fn begin_flow(&mut self, o: &Guess, trial: [f64; 2]) -> ([f64; 2], f64) {
        let state = self.state;
        let (mut r, mut factor) = (trial, o.factor);
        self.growing = 1.0;
        if let Some((_, start)) = held(&self.row, state) {
            (r, factor) = (start, self.factor_at(start));
            self.growing = factor;
        }
        self.rises = o.factor > self.growing;
        let rho = (1.0 - state.softened) * (1.0 - self.row.value[SOFTENING] * state.released * state.released);
        let before = self.kept() * rho * self.row.value[LN_FORCE] / o.f_n;
        // Where h stays they are the same, and rounding is not to choose the slope.
        if before > self.growing * (1.0 + 1e-10) {
            self.growing = before;
            self.growing_slope = -before * self.row.value[GAMMA] / self.approach;
        }
        (r, factor)
    }

    /// The hardening that brings F_N to the yield force, where the dent and D go on straight and r
    /// stays; `load` is F_N G over the yield force.
    pub(super) fn first_guess(&self, load: f64) -> f64 {
        let left = (-(load / (self.rho * self.kept())).ln() / self.row.value[GAMMA]).exp();
        let rate = self.row.dent_slope + left * self.approach / self.reach * self.row.approach_slope;
        let y = self.approach * (1.0 - left) / rate;
        if y > 0.0 { y.min(self.most()) } else { 0.0 }
    }

    /// The hardening by Newton's steps from a guess.
    fn newton(&self, guess: f64, start: [f64; 2], o: &mut Guess) -> Option<(f64, Option<Terms>)> {
        let most = self.most();
        let bound = 0.5 * self.table.friction + 0.01;
        let (mut y, mut r, mut back, mut known) = (guess, start, 0, false);
        let (mut from, mut by) = ([0.0; 3], [0.0; 3]);
        // Squares.
        let mut least = f64::INFINITY;
        for tries in 1.. {
            let terms = self.evaluate(y, r, true, o);
            let [a, b, c] = o.residual;
            let norm = if terms.is_some() { a * a + b * b + c * c } else { f64::INFINITY };
            if norm < TOLERANCE * TOLERANCE {
                return Some((y, terms));
            }
            if tries == 1 && terms.is_none() {
                y = 0.0;
                continue;
            }
            if tries > 1 && !(norm <= 1.1 * least) && back < 6 {
                back += 1;
                by = by.map(|by| 0.4 * by);
            } else {
                let terms = terms?;
                let enough = |terms| (norm < ENOUGH * ENOUGH).then_some((y, Some(terms)));
                if tries >= STEPS {
                    return enough(terms);
                }
                // Near to it the slopes of before are good enough: what they leave is norm^2/least.
                if !(known && norm * norm < 1e-26 * least) {
                    self.slopes_of_root(&terms, o);
                    known = true;
                }
                let Some(x) = o.solve(o.residual) else { return enough(terms) };
                (back, least, from) = (0, norm, [y, r[0], r[1]]);
                by = x;
                if y + x[0] < 0.0 {
                    by = o.solve_at(-0.7 * y).unwrap_or([-0.7 * y, x[1], x[2]]);
                } else if y + x[0] > most {
                    by = o.solve_at(0.7 * (most - y)).unwrap_or([0.7 * (most - y), x[1], x[2]]);
                }
                let size = (by[1] * by[1] + by[2] * by[2]).sqrt();
                let share = if size > bound { bound / size } else { 1.0 };
                by = [by[0], share * by[1], share * by[2]];
            }
            y = from[0] + by[0];
            r = [from[1] + by[1], from[2] + by[2]];
        }
        None
    }

    /// No contact hardens more in a step.
    fn most(&self) -> f64 {
        MOST_HARDENING * (self.approach + self.depth)
    }

    /// The hardening, where Newton does not find the way: r is solved for at each, and what F_N G
    /// has over the yield force falls from above zero at 0 to below it.
    fn bracket(&self, guess: f64, start: [f64; 2], o: &mut Guess) -> (f64, Option<Terms>) {
        let most = self.most();
        let excess = |y: f64, o: &mut Guess| {
            let terms = self.at_ratio(y, start, o);
            (if terms.is_some() { o.residual[0] } else { -1.0 }, terms)
        };
        let (at_low, mut terms) = excess(0.0, o);
        if !(at_low > 0.0) {
            return (0.0, terms);
        }
        let mut b = Between { at_low, high: guess.max(1e-3 * most), ..Between::default() };
        (b.at_high, terms) = excess(b.high, o);
        while b.at_high > 0.0 && b.high < most && o.tries > 0 {
            (b.low, b.at_low) = (b.high, b.at_high);
            b.high = (4.0 * b.high).min(most);
            (b.at_high, terms) = excess(b.high, o);
        }
        let mut y = b.high;
        for _ in 0..BRACKETS {
            if !(b.at_low > 0.0 && b.at_high < 0.0) || b.high - b.low <= 1e-15 * self.depth || o.tries == 0 {
                break;
            }
            y = b.secant();
            let here;
            (here, terms) = excess(y, o);
            if here.abs() < TOLERANCE {
                break;
            }
            b.narrow(y, here);
        }
        (y, terms)
    }

    /// The answer at a hardening, for the ratio that belongs to it, looked for from that of the
    /// `start`: by Newton's steps where they bring it much nearer, else along what it lacks.
    fn at_ratio(&self, y: f64, start: [f64; 2], o: &mut Guess) -> Option<Terms> {
        let (mut r, short) = (start, self.table.friction * SHORT);
        for tries in 0..RATIOS {
            let terms = self.counted(y, r, o)?;
            let [_, mut a, mut b] = o.residual;
            let size = (a * a + b * b).sqrt();
            if size < TOLERANCE {
                return Some(terms);
            }
            if o.tries == 0 {
                break;
            }
            if tries > 0 {
                self.slopes_of_root(&terms, o);
                let [_, x0, x1] = o.solve_at(0.0).unwrap_or_default();
                let to = [r[0] + x0, r[1] + x1];
                if x0 * x0 + x1 * x1 < short * short && self.counted(y, to, o).is_some() {
                    let [_, c, d] = o.residual;
                    if c * c + d * d < 0.04 * size * size {
                        r = to;
                        continue;
                    }
                }
            }
            (a, b) = (a / size, b / size);
            let way = self.way(y, r, [a, b], size, o);
            r = [r[0] + way * a, r[1] + way * b];
        }
        // Slowly from the start, where that comes to no end: there is an answer, as no ratio is
        // beyond mu.
        r = start;
        for _ in 0..SLOWLY {
            let terms = self.counted(y, r, o)?;
            let [_, a, b] = o.residual;
            if !(a * a + b * b > 1e-20) || o.tries == 0 {
                return Some(terms);
            }
            r = [r[0] + 0.05 * a, r[1] + 0.05 * b];
        }
        self.counted(y, r, o)
    }

    /// The answer at a guess of a bracket.
    fn counted(&self, y: f64, r: [f64; 2], o: &mut Guess) -> Option<Terms> {
        o.tries = o.tries.saturating_sub(1);
        self.evaluate(y, r, true, o)
    }

    /// What the ratio lacks, along `e`, at a way `s` from `r`.
    fn along(&self, y: f64, r: [f64; 2], e: [f64; 2], s: f64, o: &mut Guess) -> f64 {
        let touches = self.counted(y, [r[0] + s * e[0], r[1] + s * e[1]], o).is_some();
        if touches { o.residual[1] * e[0] + o.residual[2] * e[1] } else { -1.0 }
    }

    /// The way from `r` along `e` to the first ratio that lacks nothing; of `r` it lacks `size`.
    /// Flow that fades at full slip may leave several, and a slower step would come to the first.
    fn way(&self, y: f64, r: [f64; 2], e: [f64; 2], size: f64, o: &mut Guess) -> f64 {
        let greatest = self.table.friction * SHORT;
        let mut b = Between { at_low: size, at_high: size, ..Between::default() };
        for _ in 0..WAYS {
            if !(b.at_high > 0.0) {
                break;
            }
            (b.low, b.at_low) = (b.high, b.at_high);
            b.high += (0.2 * b.at_high).min(greatest).max(0.05 * greatest);
            b.at_high = self.along(y, r, e, b.high, o);
        }
        let mut s = b.high;
        for k in 0..2 * HALVES {
            if !(b.high - b.low > 1e-14) {
                break;
            }
            s = if k < HALVES { b.secant() } else { 0.5 * (b.low + b.high) };
            let here = self.along(y, r, e, s, o);
            if here.abs() < 0.1 * TOLERANCE || here.abs() < 1e-3 * size {
                break;
            }
            b.narrow(s, here);
        }
        s
    }

    /// What releases took of the yield force before the one that a step has left over, and the
    /// share of F_N that is still released: so a next step that goes nowhere finds the same.
    fn left_released(&self, o: &Guess, y: f64) -> [f64; 2] {
        // The last guess may be without contact: a shear may harden until nothing of h is elastic.
        if !(o.approach > 0.0) {
            return [self.state.softened, 1.0];
        }
        if !(o.reach > o.approach) {
            return [1.0 - o.rho, 0.0];
        }
        let row = self.table.read(self.depth + y, COLUMNS);
        let released = 1.0 - (row.value[GAMMA] * (o.approach / o.reach).ln()).exp();
        [(1.0 - o.rho / (1.0 - row.value[SOFTENING] * released * released)).max(0.0), released]
    }

    /// The memory after the step.
    fn keep(&self, o: &Guess, h: f64, y: f64, softened: f64, released: f64) -> ContactState {
        let state = self.state;
        let touches = o.f_n > 0.0;
        ContactState {
            h,
            h_max: state.h_max.max(h),
            approach: o.approach,
            hardened: state.hardened + y,
            reach: o.reach,
            softened,
            released,
            worn: self.worn,
            stiffened: if touches && y > 0.0 { (o.width - 1.0).max(0.0) } else { state.stiffened },
            vertex: if touches && y > 0.0 { o.vertex } else { state.vertex },
            slider: o.forces,
            hint: [state.hint[0], state.hint[1], -state.hint[2].abs()],
        }
    }

    fn answer(&self, o: &Guess, y: f64, [h, d0, d1]: [[f64; 3]; 3]) -> ContactResponse {
        if !(o.f_n > 0.0) {
            return ContactResponse::default();
        }
        let row = self.table.read(self.depth + y, COLUMNS);
        let a = row.value[LN_RADIUS].exp() * (o.width * o.approach / row.approach).powf(row.value[GAMMA] - 1.0);
        ContactResponse {
            f_n: o.f_n,
            f_t: o.f_t,
            df_t_ddelta: [[d0[1], d1[1]], [d0[2], d1[2]]],
            df_n_dh: h[0],
            df_n_ddelta: [d0[0], d1[0]],
            a,
            df_t_dh: [h[1], h[2]],
        }
    }
}
