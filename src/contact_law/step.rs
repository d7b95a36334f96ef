//! One step of the macro-element: the three equations of which it is the root.
//!
//! Unknown are the hardening y and the residual r = F_T/F_N, two components; F_N G = rho P and F_T
//! = r F_N are to be met. [`Step::evaluate`] tells by how much they are not, with slopes.

use super::sectors::{Sectors, Twist, slide_sectors};
use super::sliders::{Held, Limits, slide};
use super::state::ContactState;
use super::table::{FLOW, GAMMA, LN_FORCE, LN_STIFFNESS, MOBILISED, Row, SLIDERS, SOLVED, Table};
use super::turning_constants::{TWIST_LEVER, TurningConstants};

/// Unknowns and given ones, in the order of slopes: y, r (two), h, delta_T (two).
pub(super) const SLOPES: usize = 6;

/// What does not change within a step.
pub(super) struct Step<'a> {
    pub(super) table: &'a Table,
    pub(super) state: &'a ContactState,
    /// What it twists and rolls, if it does.
    pub(super) twist: Option<&'a Twist>,
    /// The row of its start.
    pub(super) row: Row,
    /// Elastic approach, were nothing to yield.
    pub(super) approach: f64,
    pub(super) d: [f64; 2],
    /// Hardening depth of its start.
    pub(super) depth: f64,
    /// Elastic approach D of first loading, radial slip and slip at the vertex at that depth.
    pub(super) reach: f64,
    pub(super) radial: f64,
    pub(super) sudden: f64,
    /// What releases have left of the yield force, and its slope by h.
    pub(super) rho: f64,
    pub(super) rho_slope: f64,
    /// The yield factor from which flow begins, and its slope by h; whether that of the elastic
    /// answer is beyond it.
    pub(super) rises: bool,
    pub(super) growing: f64,
    pub(super) growing_slope: f64,
    /// How far it was sheared, and its slopes by h and d.
    pub(super) worn: f64,
    pub(super) worn_by: [f64; 3],
    /// Of the sliders: their exponent, what each is lost at, and that where it was sheared a little
    /// less far.
    pub(super) exponent: f64,
    pub(super) lost: [f64; SLIDERS],
    pub(super) exponent_before: f64,
    pub(super) lost_before: [f64; SLIDERS],
}

/// By how much less far.
pub(super) const LESS: f64 = -1e-6;

/// Everything at a guess of y and r.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Guess {
    pub(super) f_n: f64,
    pub(super) f_t: [f64; 2],
    pub(super) factor: f64,
    pub(super) rho: f64,
    pub(super) width: f64,
    pub(super) hardens: f64,
    pub(super) approach: f64,
    pub(super) vertex: [f64; 2],
    /// The vertex of the twist.
    pub(super) twist_vertex: f64,
    pub(super) forces: super::sliders::Forces,
    pub(super) reach: f64,
    pub(super) slip: [f64; 2],
    pub(super) residual: [f64; 3],
    /// Guesses that are left to a bracket.
    pub(super) tries: u32,
    /// Slopes of the residuals, of F_N and of F_T.
    pub(super) by: [[f64; 3]; SLOPES],
    pub(super) n_by: [f64; SLOPES],
    pub(super) t_by: [[f64; 2]; SLOPES],
}

/// What slopes are made of.
pub(super) struct Terms {
    row: Row,
    pub(super) r: [f64; 2],
    rate: f64,
    /// r less the vertex, its length, and that rounded.
    x: [f64; 2],
    far: f64,
    round: f64,
    ratio: f64,
    /// By how much the vertex stays behind, and 1/(1 + q).
    q: f64,
    c: f64,
    factor_by: [f64; 3],
    width_by: [f64; 2],
    level: f64,
    flow: Flow,
    v: [f64; 2],
    eta_by: [f64; 2],
    rho_y: f64,
    rho_h: f64,
    held: Held,
    /// Of the twist: what is between its ratio and its vertex, the ratio after the flow, and 1 over
    /// the share that flow leaves.
    untwisted: f64,
    turned: f64,
    per_turn: f64,
    pub(super) sectors: Option<Box<Sectors>>,
}

/// Plastic slip along r and along v, and slopes.
#[derive(Clone, Copy, Default)]
struct Flow {
    steady: f64,
    steady_y: f64,
    steady_r: f64,
    sudden: f64,
    sudden_y: f64,
    mobile: f64,
    mobile_r: f64,
    grown: f64,
}

impl Step<'_> {
    /// The elastic answer; none without contact.
    pub(super) fn elastic(&self, o: &mut Guess) -> Option<Terms> {
        self.evaluate(0.0, [0.0; 2], false, o)
    }

    /// The answer at the hardening `y` and the ratio `r`, where it `flows`; none without contact.
    /// The slopes stay those of before.
    pub(super) fn evaluate(&self, y: f64, r: [f64; 2], flows: bool, o: &mut Guess) -> Option<Terms> {
        let table = self.table;
        let row = if flows { table.read(self.depth + y, SOLVED) } else { self.row };
        let constants = &table.constants;
        let (force, stiff) = (row.value[LN_FORCE], row.value[LN_STIFFNESS]);
        let (gamma, gap) = (row.value[GAMMA], row.approach);
        let hardening = row.dent - self.row.dent;
        let rate = row.dent_slope;
        // The vertex follows r.
        let q = hardening * stiff / (force * constants.vertex_length * table.friction);
        let c = 1.0 / (1.0 + q);
        let x: [f64; 2] = std::array::from_fn(|i| (r[i] - self.state.vertex[i]) * c);
        let twisted = self.twisted();
        let untwisted = self.twist.map_or(0.0, |twist| (twisted - twist.vertex) * c);
        let ratio = (r[0] * r[0] + r[1] * r[1] + twisted * twisted).sqrt();
        let far = (x[0] * x[0] + x[1] * x[1] + untwisted * untwisted).sqrt();
        let eps = constants.vertex_round * table.friction;
        let round = (far * far + eps * eps).sqrt();
        let (factor, factor_by) = if flows { table.factor(&row, ratio, far) } else { (1.0, [0.0; 3]) };
        *o = Guess {
            hardens: hardening,
            factor,
            vertex: [r[0] - x[0], r[1] - x[1]],
            twist_vertex: twisted - untwisted,
            reach: self.state.reach,
            approach: self.approach - hardening,
            width: 1.0 + self.state.stiffened,
            tries: o.tries,
            by: o.by,
            ..Guess::default()
        };
        let e = o.approach;
        if !(e > 0.0) {
            return None;
        }
        let width_by = if flows { self.widen(&row, o, rate) } else { [0.0; 2] };
        let level = (e / gap).ln();
        o.f_n = force * (gamma * level + (gamma - 1.0) * o.width.ln()).exp();
        let flow = if flows { self.flow(&row, hardening, rate, ratio, factor) } else { Flow::default() };
        let v = x.map(|x| x / round);
        o.slip = std::array::from_fn(|i| flow.steady * r[i] + flow.sudden * v[i]);
        let along = [self.d[0] - o.slip[0], self.d[1] - o.slip[1], self.radial * hardening];
        let (eta, eta_by, eta_before) = self.left(&row, o, rate, flows);
        let before = Limits::new(eta_before, &self.lost_before);
        let limits = Limits::new(eta, &self.lost).worn(&before, LESS);
        let [turn, turned, per_turn] = self.twist.map_or([0.0; 3], |twist| twist.beside(flow.steady, flow.sudden * c / round));
        let (held, sectors) = self.slide((along, turn), stiff, table.friction * o.f_n, &limits);
        (o.forces, o.f_t) = (held.forces, held.f_t);
        let (rho_y, rho_h) = if flows { self.residuals(o, force, rate, r) } else { (0.0, 0.0) };
        Some(Terms {
            row,
            r,
            rate,
            x,
            far,
            round,
            ratio,
            q,
            c,
            factor_by,
            width_by,
            level,
            flow,
            v,
            eta_by,
            rho_y,
            rho_h,
            held,
            untwisted,
            turned,
            per_turn,
            sectors,
        })
    }

    /// What a release left of the annuli, eta, its slopes by y and h, and eta where the contact was
    /// sheared a little less far; they come back as the contact hardens.
    fn left(&self, row: &Row, o: &mut Guess, rate: f64, flows: bool) -> (f64, [f64; 2], f64) {
        let (e, gamma) = (o.approach, row.value[GAMMA]);
        let away = 1.0 - self.approach / self.state.reach;
        if !(away > 0.0) {
            o.reach = e;
            return (1.0, [0.0; 2], 1.0);
        }
        let length = self.table.constants.narrows * self.reach;
        let kept = if flows { (-o.hardens / length).exp() } else { 1.0 };
        let whole = 1.0 - away * kept;
        let log = whole.ln();
        o.reach = e / whole;
        let [eta, before] = [self.exponent, self.exponent_before].map(|exponent| (gamma * log / exponent).exp());
        let by_y = gamma * away * kept * rate / (length * whole) + row.slope[GAMMA] * log;
        let by = [by_y, gamma * kept / (self.state.reach * whole)].map(|by| eta / self.exponent * by);
        (eta, by, before)
    }

    /// The sliders, those of the sectors where it twists, after a displacement and a turn.
    fn slide(&self, (along, turn): ([f64; 3], f64), stiff: f64, most: f64, limits: &Limits) -> (Held, Option<Box<Sectors>>) {
        let radial_most = self.table.constants.radial_most;
        let Some(twist) = self.twist else { return (slide(&self.state.slider, along, stiff, most, limits, radial_most), None) };
        let [_, _, radial] = &self.state.slider;
        let (held, sectors) = slide_sectors(&twist.sectors, radial, (along, turn), stiff, most, limits, radial_most);
        (held, Some(sectors))
    }

    /// The part of a twist in yield.
    pub(super) fn twisted(&self) -> f64 {
        self.twist.map_or(0.0, |twist| twist.ratio)
    }

    /// What a roll leaves of the yield force.
    pub(super) fn kept(&self) -> f64 {
        self.twist.map_or(1.0, |twist| twist.kept)
    }

    /// Slopes of the residuals by y and r, for Newton's method: where the yield factor begins to
    /// grow, its first step has to know.
    pub(super) fn slopes_of_root(&self, t: &Terms, o: &mut Guess) {
        let begins = self.rises && o.factor > self.growing - 1e-9;
        (0..3).for_each(|j| self.slope(t, j, t.flow.grown > 0.0 || begins, o));
    }

    /// All slopes at the answer.
    pub(super) fn slopes(&self, t: &Terms, o: &mut Guess) {
        (0..SLOPES).for_each(|j| self.slope(t, j, t.flow.grown > 0.0, o));
    }

    /// g follows the yield factor, by the share that is wide, as the contact hardens (at once, F_N
    /// would jump where it yields); its slopes by the factor and by y.
    fn widen(&self, row: &Row, o: &mut Guess, rate: f64) -> [f64; 2] {
        let length = self.table.constants.narrows * self.reach;
        let kept = (-o.hardens / length).exp();
        let grown = o.factor - 1.0;
        let away = (self.state.stiffened - row.wide * grown) * kept;
        o.width = 1.0 + row.wide * grown + away;
        [row.wide * (1.0 - kept), row.wide_slope * grown * (1.0 - kept) - away * rate / length]
    }

    /// Plastic slip.
    fn flow(&self, row: &Row, hardening: f64, rate: f64, ratio: f64, factor: f64) -> Flow {
        let table = self.table;
        let (steady, steady_by) = table.shape(row, FLOW, ratio / table.friction);
        let (mobile, mobile_by) = table.shape(row, MOBILISED, ratio / table.friction);
        let per = 1.0 / (ratio + 1e-9);
        let (gap, gap_slope) = (row.approach, row.approach_slope);
        let grown = (factor - self.growing).max(0.0);
        let flows = self.twist.map_or(1.0, |twist| twist.flows);
        Flow {
            steady: hardening * steady * per * flows,
            steady_y: (rate * steady + hardening * steady_by[1] * row.share_slope) * per * flows,
            steady_r: hardening * (steady_by[0] / table.friction - steady * per) * per * flows,
            sudden: hardening * self.sudden + grown * gap * mobile,
            sudden_y: rate * self.sudden + grown * (gap_slope * mobile + gap * mobile_by[1] * row.share_slope),
            mobile,
            mobile_r: mobile_by[0] / table.friction,
            grown,
        }
    }

    /// The residuals; slopes of rho by y and by h.
    fn residuals(&self, o: &mut Guess, force: f64, rate: f64, r: [f64; 2]) -> (f64, f64) {
        let (mut rho, mut rho_y, mut rho_h) = (self.rho, 0.0, self.rho_slope);
        if rho < 1.0 - 1e-12 {
            // What releases took comes back with flow.
            let recovers = self.table.constants.recovers / self.reach;
            let log = rho.ln();
            let missing = -1.0 / log + recovers * o.hardens;
            let now = (-1.0 / missing).exp();
            rho_h *= now / (missing * missing * log * log * rho);
            rho = now;
            rho_y = rho / (missing * missing) * recovers * rate;
        }
        o.rho = rho;
        o.residual = [o.f_n * o.factor / force - rho * self.kept(), o.f_t[0] / o.f_n - r[0], o.f_t[1] / o.f_n - r[1]];
        (rho_y, rho_h)
    }

    /// Slopes by one of y, r, h, d.
    fn slope(&self, t: &Terms, j: usize, grows: bool, o: &mut Guess) {
        let friction = self.table.friction;
        let (row, held) = (&t.row, &t.held);
        let (force, stiff) = (row.value[LN_FORCE], row.value[LN_STIFFNESS]);
        let (gamma, gap, e) = (row.value[GAMMA], row.approach, o.approach);
        let one = |k: usize| if j == k { 1.0 } else { 0.0 };
        let (dy, dr, dh) = (one(0), [one(1), one(2)], one(3));
        let softer = row.slope[LN_STIFFNESS] - row.slope[LN_FORCE];
        let dq = dy * (t.rate * stiff / (force * self.table.constants.vertex_length * friction) + t.q * softer);
        let dx: [f64; 2] = std::array::from_fn(|i| t.c * (dr[i] - t.x[i] * dq));
        let dz = -t.c * t.untwisted * dq;
        let dround = (t.x[0] * dx[0] + t.x[1] * dx[1] + t.untwisted * dz) / t.round;
        let dfar = if t.far > 0.0 { dround * t.round / t.far } else { 0.0 };
        let dratio = if t.ratio > 0.0 { (t.r[0] * dr[0] + t.r[1] * dr[1]) / t.ratio } else { 0.0 };
        let dfactor = t.factor_by[0] * dratio + t.factor_by[1] * dfar + t.factor_by[2] * dy;
        let by_y =
            row.slope[LN_FORCE] + row.slope[GAMMA] * (t.level + o.width.ln()) - gamma * (t.rate / e + row.approach_slope / gap);
        let widens = (gamma - 1.0) / o.width * (t.width_by[0] * dfactor + t.width_by[1] * dy);
        let df = o.f_n * (by_y * dy + gamma / e * dh + widens);
        let flow = &t.flow;
        let mut dsudden = flow.sudden_y * dy;
        if grows {
            dsudden += gap * ((dfactor - self.growing_slope * dh) * flow.mobile + flow.grown * flow.mobile_r * dratio);
        }
        let dsteady = flow.steady_y * dy + flow.steady_r * dratio;
        let dmove: [f64; 2] = std::array::from_fn(|i| {
            let turns = flow.sudden * (dx[i] - t.v[i] * dround) / t.round;
            one(4 + i) - (dsteady * t.r[i] + flow.steady * dr[i] + dsudden * t.v[i] + turns)
        });
        let dradial = self.radial * t.rate * dy;
        let dturn = self.twist.map_or(0.0, |twist| {
            let dsudden = t.c / t.round * (dsudden - flow.sudden * (t.c * dq + dround / t.round));
            let by_flow = dsteady * t.turned + dsudden * (t.turned - twist.vertex);
            -TurningConstants::FITTED.twist_flow / TWIST_LEVER * t.per_turn * by_flow
        });
        o.n_by[j] = df;
        for i in 0..2 {
            let m = held.by_move;
            let across = if i == 0 { m[0] * dmove[0] + m[1] * dmove[1] } else { m[1] * dmove[0] + m[2] * dmove[1] };
            let stiffens = held.by_stiffness[i] * stiff * row.slope[LN_STIFFNESS] * dy;
            o.t_by[j][i] = across
                + held.by_radial[i] * dradial
                + stiffens
                + held.by_force[i] * df / o.f_n
                + held.by_eta[i] * (t.eta_by[0] * dy + t.eta_by[1] * dh)
                + if j > 2 { held.by_worn[i] * self.worn_by[j - 3] } else { 0.0 }
                + held.by_turn[i] * dturn;
            o.by[j][1 + i] = (o.t_by[j][i] - o.f_t[i] * df / o.f_n) / o.f_n - dr[i];
        }
        let share = o.f_n * o.factor / force;
        let by_factor = df / o.f_n + dfactor / o.factor - row.slope[LN_FORCE] * dy;
        o.by[j][0] = share * by_factor - self.kept() * (t.rho_y * dy + t.rho_h * dh);
    }
}

impl Guess {
    /// How y and r move so that the three equations, off by `right`, are met; none where they have
    /// no answer.
    pub(super) fn solve(&self, right: [f64; 3]) -> Option<[f64; 3]> {
        let [a, b, c] = [self.by[0], self.by[1], self.by[2]];
        let across = |u: [f64; 3], v: [f64; 3]| [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let dot = |u: [f64; 3], v: [f64; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let bc = across(b, c);
        let whole = -dot(a, bc);
        (whole.abs() > 0.0).then(|| [dot(right, bc) / whole, dot(a, across(right, c)) / whole, dot(a, across(b, right)) / whole])
    }

    /// How r moves so that its two equations are met where y moves by `dy`; and dy.
    pub(super) fn solve_at(&self, dy: f64) -> Option<[f64; 3]> {
        let [a, b, c] = [self.by[0], self.by[1], self.by[2]];
        let right = [1, 2].map(|i| -self.residual[i] - a[i] * dy);
        let whole = b[1] * c[2] - c[1] * b[2];
        (whole.abs() > 0.0)
            .then(|| [dy, (right[0] * c[2] - c[1] * right[1]) / whole, (b[1] * right[1] - right[0] * b[2]) / whole])
    }

    /// Slopes of F_N and F_T by h or d, number `j` of these, where y and r move by `x` with it.
    pub(super) fn slopes(&self, j: usize, x: [f64; 3]) -> [f64; 3] {
        let through = |given: f64, by: [f64; 3]| given + by[0] * x[0] + by[1] * x[1] + by[2] * x[2];
        let t = |i: usize| through(self.t_by[3 + j][i], [self.t_by[0][i], self.t_by[1][i], self.t_by[2][i]]);
        [through(self.n_by[3 + j], [self.n_by[0], self.n_by[1], self.n_by[2]]), t(0), t(1)]
    }
}
