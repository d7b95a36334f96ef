//! Twist and roll of one contact, beside the update. Its twin is `asperity_turning.h`.
//!
//! - *Twist*: each slider has forces around the normal beside those along the plane, in four
//!   sectors, within the one limit mu times its share of F_N. So a shear takes the moment of an
//!   earlier twist, and a twist the force of an earlier shear. M_twist over a lever counts for yield
//!   as F_T does, and flows with it.
//! - *Roll*: what rolls leaves its dent behind. The share `rolled` grows with the way over the
//!   contact's radius; it takes yield force, and is the limit of the rolling moment, whose rule is
//!   Armstrong and Frederick's: dM = k dtheta - (k/M_max) |dtheta| M, which loses energy on every
//!   way. Tractions are left behind, too, and a flattened sphere slips as it rolls.
//!
//! `twisted`, which enters yield, follows its moment over a little way, and `rolled` is of the
//! start of a step: a step that goes nowhere changes forces by less than 1e-4 F_N.

use super::sectors::{SECTORS, Sectors, Twist, alike, energy, twisting};
use super::state::{ContactResponse, ContactState, MOST};
use super::table::{COLUMNS, GAMMA, LN_RADIUS, LN_STIFFNESS, RECOVERED, SLIDERS, Table, WEIGHTS};
use super::turning_constants::{LEVERS_SQUARED, TWIST_FOLLOWS, TWIST_LEVER, TWIST_STIFF, TurningConstants};
use super::update::{elastic_force, moved_with, update};

const CONSTANTS: TurningConstants = TurningConstants::FITTED;

/// What a contact that twists or rolls remembers beside its [`ContactState`]; all zero before first
/// contact.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct TurningState {
    /// Forces of the sliders' sectors along the two axes, of a contact that has turned.
    pub sector: [[[f64; SLIDERS]; 2]; SECTORS],
    /// M_twist over its lever and F_N, as it counts for yield.
    pub twisted: f64,
    /// Its vertex of the yield surface.
    pub vertex: f64,
    /// Share of the contact that has left what was pressed behind, 0 to 1.
    pub rolled: f64,
    /// Moment of the roll about the two axes, force times length.
    pub moment: [f64; 2],
}

/// A turn of the sphere against what it is pressed on, rad. The normal points from that to the
/// sphere, and is right-handed with the two axes of the displacement.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turn {
    /// About the normal.
    pub twist: f64,
    /// About the two axes: a roll about the second carries the contact along the first. The
    /// displacement is what is left of the sphere's without it.
    pub roll: [f64; 2],
}

/// Moments of the tractions about the point of the contact, in the direction of the turn: what
/// turns the sphere; the plane gives it the opposite.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Moments {
    /// About the normal.
    pub m_twist: f64,
    /// About the two axes.
    pub m_roll: [f64; 2],
    /// Elastic energy of twist and roll, beside
    /// [`stored_energy`](super::ContactParameters::stored_energy).
    pub stored: f64,
    /// Work that this increment dissipated by turning, beside that of F_N and F_T.
    pub lost: f64,
}

impl TurningState {
    /// How many numbers it is.
    pub const NUMBERS: usize = 2 * SECTORS * SLIDERS + 5;

    /// Whether it is one that an update may have left.
    pub fn is_sound(&self) -> bool {
        let all = |values: &[f64]| values.iter().all(|value| value.is_finite() && value.abs() <= MOST);
        all(bytemuck::cast_slice(std::slice::from_ref(self))) && (0.0..=1.0).contains(&self.rolled)
    }
}

impl Turn {
    fn is_none(self) -> bool {
        self == Self::default()
    }
}

/// Of a contact at one time.
#[derive(Clone, Copy, Debug, Default)]
struct Rolling {
    /// The radius of all of it, and F_N.
    radius: f64,
    f_n: f64,
    /// Stiffness in a roll, and greatest moment.
    stiff: f64,
    most: f64,
    /// D, dent and k_T of its row.
    approach: f64,
    dent: f64,
    along: f64,
}

impl Rolling {
    /// Where a contact is that was `rolled` so far; `e` is the elastic approach to take where it
    /// has not yet touched.
    fn of(table: &Table, state: &ContactState, e: f64, rolled: f64) -> Self {
        let row = table.read(table.first + state.hardened, COLUMNS);
        let (gamma, wide) = (row.value[GAMMA], 1.0 + state.stiffened);
        let whole = row.value[LN_RADIUS].exp();
        let mut place = Self { approach: row.approach, dent: row.dent, along: row.value[LN_STIFFNESS], ..Self::default() };
        let reach = if state.reach > 0.0 { state.reach } else { e };
        if reach > 0.0 {
            place.radius = whole * ((gamma - 1.0) * (wide * reach / row.approach).ln()).exp();
        }
        if state.approach > 0.0 {
            let e = state.approach;
            place.f_n = elastic_force(&row, e, state.stiffened);
            let a = whole * ((gamma - 1.0) * (wide * e / row.approach).ln()).exp();
            let recovered = row.value[RECOVERED];
            if recovered < 1.0 {
                let fades = (CONSTANTS.roll_fades * (1.0 - recovered).ln()).exp();
                place.most = CONSTANTS.roll_moment * rolled * fades * place.f_n * a;
                let softens = (CONSTANTS.roll_softens * recovered.ln()).exp();
                place.stiff = CONSTANTS.roll_stiff * softens * (2.0 / 3.0) * gamma * place.f_n / e * a * a;
            }
        }
        place
    }

    /// Share of the yield force that a roll has left.
    fn left_by_roll(&self, rolled: f64) -> f64 {
        let plastic = self.dent / (self.dent + self.approach);
        if plastic > 0.0 { 1.0 - CONSTANTS.roll_loss * rolled * (CONSTANTS.roll_loss_fades * plastic.ln()).exp() } else { 1.0 }
    }

    /// Elastic energy of twist and roll.
    fn energy(&self, sectors: &Sectors, moment: [f64; 2]) -> f64 {
        let square = moment[0] * moment[0] + moment[1] * moment[1];
        energy(sectors, self.along) + if self.stiff > 0.0 { 0.5 * square / self.stiff } else { 0.0 }
    }

    /// The part of a twist in yield as a step goes on: it follows its moment over the way and what
    /// F_N changes by.
    fn follow_twist(&self, friction: f64, sectors: &Sectors, before: f64, way: f64, change: f64) -> f64 {
        if !(self.f_n > 0.0 && self.radius > 0.0) {
            return before;
        }
        let to = CONSTANTS.twist_yield * twisting(sectors) / (TWIST_LEVER * self.f_n);
        to - (to - before) * (-(self.along * way / friction + change) / (TWIST_FOLLOWS * self.f_n)).exp()
    }

    /// The rolling moment along a roll, and its work.
    fn roll_moment(&self, roll: [f64; 2], moment: &mut [f64; 2]) -> f64 {
        let angle = (roll[0] * roll[0] + roll[1] * roll[1]).sqrt();
        if !(angle > 0.0) {
            return 0.0;
        }
        if !(self.most > 0.0 && self.stiff > 0.0) {
            *moment = [0.0; 2];
            return 0.0;
        }
        let (kept, mut work) = ((-self.stiff * angle / self.most).exp(), 0.0);
        for i in 0..2 {
            let to = self.most * roll[i] / angle;
            work += to * roll[i] + (moment[i] - to) * (self.most / self.stiff) * (1.0 - kept) * roll[i] / angle;
            moment[i] = to + (moment[i] - to) * kept;
        }
        work
    }

    /// What the part of a twist in yield were if all stuck, and by how much slip takes from it.
    fn try_twist(&self, friction: f64, along: f64, ratio: f64) -> Twist {
        let mut twist =
            Twist { along, ratio, vertex: 0.0, trial: ratio, gives: 0.0, kept: 1.0, flows: 1.0, sectors: Sectors::default() };
        if self.f_n > 0.0 {
            let slope = CONSTANTS.twist_yield / (TWIST_LEVER * self.f_n) * TWIST_STIFF * self.along * LEVERS_SQUARED;
            let most = 1.1 * CONSTANTS.twist_yield * friction;
            twist.gives = slope * CONSTANTS.twist_flow / TWIST_LEVER;
            twist.trial = (ratio + slope * along).clamp(-most, most);
        }
        twist
    }
}

/// What a roll does before the step: tractions stay behind. Answers how far it has rolled, what it
/// leaves of the flow, and the energy of the tractions.
fn leave_behind(
    before: &Rolling,
    (far, pressed): (f64, f64),
    rolled: f64,
    state: &mut ContactState,
    sectors: &mut Sectors,
) -> [f64; 3] {
    let flows = if pressed > 0.0 { pressed / (pressed + far / CONSTANTS.roll_flow) } else { 0.0 };
    let recovered = before.approach / (before.approach + before.dent);
    let kept = (-far / CONSTANTS.roll_traction * (-CONSTANTS.roll_leaves * recovered.ln()).exp()).exp();
    let mut lost = 0.0;
    for i in 0..SLIDERS {
        for j in 0..2 {
            let held = state.slider[j][i];
            state.slider[j][i] = held * kept;
            lost += 0.5 * held * held * (1.0 - kept * kept) / (WEIGHTS[i] * before.along);
        }
    }
    sectors.iter_mut().flatten().flatten().for_each(|force| *force *= kept);
    [1.0 - (1.0 - rolled) * (-far / CONSTANTS.roll_way).exp(), flows, lost]
}

/// Moves a contact that twists and rolls: see
/// [`ContactParameters::update_turning`](super::ContactParameters::update_turning).
pub(super) fn update_turning(
    table: &Table,
    effective_radius: f64,
    (state, turning): (&ContactState, &TurningState),
    h: f64,
    d: [f64; 2],
    turn: Turn,
) -> (ContactState, TurningState, ContactResponse, Moments) {
    let is_known = turning.is_sound() && turn.twist.is_finite() && turn.roll.iter().all(|angle| angle.is_finite());
    if (*turning == TurningState::default() && turn.is_none()) || !is_known || !state.is_sound() {
        let h = if is_known { h } else { f64::NAN };
        let (next, response) = update(table, state, h, d);
        let nan = if response.f_n.is_nan() { f64::NAN } else { 0.0 };
        return (next, *turning, response, Moments { m_twist: nan, m_roll: [nan; 2], stored: nan, lost: nan });
    }
    if !(h.abs() <= MOST && d.iter().all(|d| d.abs() <= MOST)) {
        return update_turning(table, effective_radius, (state, turning), f64::NAN, d, Turn { twist: f64::NAN, ..turn });
    }
    advance(table, effective_radius, (state, turning), h, d, turn)
}

/// The same of what is known to be numbers.
fn advance(
    table: &Table,
    effective_radius: f64,
    (state, turning): (&ContactState, &TurningState),
    h: f64,
    mut d: [f64; 2],
    turn: Turn,
) -> (ContactState, TurningState, ContactResponse, Moments) {
    let friction = table.friction.max(1e-9);
    let (mut rolled, mut moment, roll) = (turning.rolled, turning.moment, turn.roll);
    let e = state.approach + (h - state.h);
    let before = Rolling::of(table, state, e, rolled);
    let has_turned = *turning != TurningState::default();
    let mut sectors = if has_turned { turning.sector } else { alike(&state.slider) };
    let mut lost = before.energy(&sectors, moment) + 0.5 * before.radius * twisting(&sectors) * turn.twist;
    let along = before.radius * turn.twist;
    let slip = CONSTANTS.roll_slip * (before.approach + before.dent);
    let angle = (roll[0] * roll[0] + roll[1] * roll[1]).sqrt();
    let way = (d[0] * d[0] + d[1] * d[1] + along * along + slip * slip * angle * angle).sqrt();
    let (mut from, mut flows) = (*state, 1.0);
    if angle > 0.0 && before.radius > 0.0 {
        let pressed = (h - state.h) / (before.approach + before.dent);
        let far = angle * effective_radius / before.radius;
        let [now, leaves, left] = leave_behind(&before, (far, pressed), rolled, &mut from, &mut sectors);
        (rolled, flows, lost) = (now, leaves, lost + left);
        d = [d[0] + slip * roll[1], d[1] - slip * roll[0]];
    }
    let change = if e > 0.0 && state.approach > 0.0 { before.f_n * (e / state.approach - 1.0).abs() } else { 0.0 };
    let ratio = before.follow_twist(friction, &sectors, turning.twisted, way, change);
    let kept = before.left_by_roll(rolled);
    let twist = Twist { vertex: turning.vertex, kept, flows, sectors, ..before.try_twist(friction, along, ratio) };
    let (next, response, held) = moved_with(table, &from, Some(&twist), h, d);
    let (sector, vertex) = held.unwrap_or((Sectors::default(), turning.vertex));
    let after = Rolling::of(table, &next, 0.0, rolled);
    if after.dent > before.dent {
        rolled *= (-CONSTANTS.roll_press * (after.dent - before.dent) / (after.dent + after.approach)).exp();
    }
    let shrinks = if before.stiff > 0.0 && after.stiff < before.stiff {
        after.stiff / before.stiff
    } else if after.stiff > 0.0 {
        1.0
    } else {
        0.0
    };
    moment = moment.map(|moment| moment * shrinks);
    lost += after.roll_moment(roll, &mut moment);
    let m_twist = after.radius * twisting(&sector);
    let stored = after.energy(&sector, moment);
    let twisted = if response.f_n > 0.0 { ratio } else { 0.0 };
    let m_roll = [moment[0] - slip * response.f_t[1], moment[1] + slip * response.f_t[0]];
    let moments = Moments { m_twist, m_roll, stored, lost: lost + 0.5 * m_twist * turn.twist - stored };
    (next, TurningState { sector, twisted, vertex, rolled, moment }, response, moments)
}
