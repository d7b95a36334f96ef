//! Cohesion of one contact, beside the update. Its twin is `asperity_cohesion.h`.
//!
//! The law is driven at h, as without cohesion. Beside it stands the attraction of the surfaces:
//! w is the work of adhesion, energy over area, and the contact under it is that of Johnson,
//! Kendall & Roberts, *Proc. R. Soc. A* 324 (1971), over the elastic curve F(e) of an unloading.
//! Its radius a is that of the approach x = e + delta without attraction, with S = dF/de, A = pi
//! a^2 and S' delta^2/2 = w A'; its force is F(x) - S(x) delta, its energy that of the body less
//! w A. On an elastic sphere this is their curve; on a flattened one a is what plastic flow has
//! left: a^2 goes with eta (1 + c - c eta), eta = e/D, from a sphere (c = 0) to a uniform
//! pressure taken off (c = 1; Mesarovic & Johnson, *J. Mech. Phys. Solids* 48 (2000)), c such
//! that F(D) is the law's.
//!
//! - *Flow closes without attraction*: x goes no further than the approach D at which the contact
//!   yields. There the attraction is gone; F_N of a press is the law's, as in LAMMPS' MDR.
//! - *Shape*: D, the dent and a(e) are those of the hardening depth `flattened`. It follows that of
//!   the law only where that takes energy from the attraction.
//! - *Jumps*: the surfaces meet where e = 0 and part where x has no answer.
//! - *Range*: that attraction reaches no further than the contact, as it nearly does where surfaces
//!   are soft. Where a range z is given, the stress w/z holds surfaces that are less than z apart
//!   and does not deform them: Derjaguin, Muller & Toporov, *J. Colloid Interface Sci.* 53 (1975).
//! - *Friction*: what F(x) presses more than F(e) lets the contact bear mu times as much; a slider
//!   of the stiffness that the wider contact has more bears it.
//!
//! No closed path gains: the law alone returns no work; attraction has a potential, which meeting,
//! parting and flattening only lower; the slider gives back at most what it took.

use super::state::{ContactState, MOST};
use super::table::{COLUMNS, GAMMA, LN_FORCE, LN_RADIUS, LN_STIFFNESS, RECOVERED, ROWS, Table};
use std::f64::consts::PI;

/// Steps of Newton, many where the surfaces are about to part; and halvings.
const STEPS: usize = 100;
/// Of the approach.
const TOLERANCE: f64 = 1e-15;
/// Share of what is recovered of the shallowest indentation, down to which a contact is elastic:
/// some tables recover a little less than all.
const ELASTIC: f64 = 0.97;

/// The attraction between two materials.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cohesion {
    /// Work of adhesion w, energy over area: gamma_1 + gamma_2 - gamma_12, for two surfaces of one
    /// material twice its surface energy. 0: none.
    pub work: f64,
    /// Distance over which surfaces that do not touch attract each other; 0: none.
    pub range: f64,
    /// Greatest depth of first loading that leaves no dent.
    elastic: f64,
    /// E* and R of the undeformed contact.
    modulus: f64,
    radius: f64,
}

/// What a contact with cohesion remembers beside its [`ContactState`]; all zero before first
/// contact.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CohesionState {
    /// Hardening depth of its shape, less that of the table's first row; length.
    pub flattened: f64,
    /// 1 where the surfaces hold each other, else 0.
    pub joined: f64,
    /// Force of the slider along the two axes, and its stiffness.
    pub slider: [f64; 2],
    /// See there.
    pub stiffness: f64,
    /// Normal force of the attraction and its energy.
    pub f_n: f64,
    /// See there.
    pub energy: f64,
}

/// What cohesion adds to the answer of an increment.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Attraction {
    /// Normal force, compression positive: 0 or less.
    pub f_n: f64,
    /// Tangential force along the displacement.
    pub f_t: [f64; 2],
    /// Energy beside [`stored_energy`](super::ContactParameters::stored_energy): of an attraction
    /// that holds, negative.
    pub stored: f64,
    /// Work that this increment dissipated as the surfaces met, parted or were flattened,
    pub lost: f64,
    /// and by slip.
    pub slip: f64,
}

impl CohesionState {
    /// How many numbers it is.
    pub const NUMBERS: usize = 7;

    /// Whether it is one that an update may have left.
    pub fn is_sound(&self) -> bool {
        let all: &[f64] = bytemuck::cast_slice(std::slice::from_ref(self));
        all.iter().all(|value| value.is_finite() && value.abs() <= MOST)
            && self.flattened >= 0.0
            && self.stiffness >= 0.0
            && (self.joined == 0.0 || self.joined == 1.0)
    }
}

/// c by how far gamma has come from 3/2 to 4/pi, y + y (1 - y) times this in y; to 1e-5
/// (`benches/law/fit_roundness.py`).
const ROUNDNESS: [f64; 3] = [-0.24433305, -0.04673567, -0.01232952];
/// Gauss' places and weights for the integral of sqrt(y) f(y) from 0 to 1.
const PLACES: [f64; 6] =
    [0.05311103539287674, 0.2011457477322403, 0.41261267387944145, 0.6425274355436583, 0.8419868222565716, 0.9686162851952115];
const SHARES: [f64; 6] = [
    0.024036267991510898,
    0.08360262854513247,
    0.14701057892612374,
    0.17846008077293196,
    0.15513017981975708,
    0.07842693261121042,
];

/// The elastic contact of one hardening depth, and how it is attracted.
#[derive(Clone, Copy, Debug, Default)]
struct Shape {
    dent: f64,
    /// Elastic approach D of first loading; stiffness, area and delta there.
    approach: f64,
    stiff: f64,
    area: f64,
    delta: f64,
    /// c.
    round: f64,
    /// k_T over the stiffness.
    along: f64,
    /// w and its range.
    work: f64,
    range: f64,
    /// x at the most.
    most: f64,
    /// R of the undeformed contact.
    radius: f64,
}

/// At an approach without attraction: F_N, its energy, its stiffness.
#[derive(Clone, Copy, Debug, Default)]
struct Bare {
    f_n: f64,
    energy: f64,
    stiff: f64,
}

/// An attracted contact: its energy and normal force beside those of the law, and by how much F_N
/// and the stiffness at x are more.
#[derive(Clone, Copy, Debug, Default)]
struct Held {
    energy: f64,
    f_n: f64,
    presses: f64,
    stiffer: f64,
}

impl Cohesion {
    /// The attraction `work` over the distance `range` (both 0 or more) between what a table is of,
    /// whose undeformed contact has this E* and R.
    pub(super) fn new(table: &Table, [modulus, radius]: [f64; 2], work: f64, range: f64) -> Self {
        let depth = |i: usize| table.first * (i as f64 / table.per_step).exp();
        let least = ELASTIC * table.rows[1][RECOVERED];
        let dented = (1..ROWS).find(|&i| table.rows[i][RECOVERED] < least);
        Self { work, range, elastic: dented.map_or(f64::INFINITY, |i| depth(i - 1)), modulus, radius }
    }

    /// Greatest gap, of what h is negative, over which the surfaces may hold each other.
    pub(super) fn greatest_gap(&self, table: &Table) -> f64 {
        if !(self.work > 0.0) {
            return 0.0;
        }
        if self.range > 0.0 {
            return self.range;
        }
        (0..ROWS).fold(0.0, |gap, i| {
            let shape = self.shape(table, table.first * ((i as f64 / table.per_step).exp() - 1.0));
            let h = shape.dent + shape.parts();
            if -h > gap { -h } else { gap }
        })
    }

    fn shape(&self, table: &Table, flattened: f64) -> Shape {
        let depth = table.first + flattened;
        let whole = depth <= self.elastic;
        let row = table.read(if whole { table.first } else { depth }, COLUMNS);
        let (gamma, mut a) = (row.value[GAMMA], row.value[LN_RADIUS].exp());
        let (mut dent, mut approach, mut stiff) = (row.dent, row.approach, gamma * row.value[LN_FORCE] / row.approach);
        if whole {
            (dent, approach, a) = (0.0, table.first, (self.radius * table.first).sqrt());
            stiff = 2.0 * self.modulus * a;
        }
        let delta = a * (4.0 * PI * self.work / stiff).sqrt();
        let along = row.value[LN_STIFFNESS] / stiff;
        let (work, range, area) = (self.work, self.range, PI * a * a);
        let radius = self.radius;
        let mut shape = Shape { dent, approach, stiff, area, delta, round: 0.0, along, work, range, most: approach, radius };
        if whole {
            // Attraction by itself makes no dent: up to where F has its least value there is none.
            let pull = if range > 0.0 { range } else { shape.turns(3.0) };
            shape.most = if self.elastic > pull { self.elastic } else { pull };
        } else {
            let y = ((1.5 - gamma) / (1.5 - 4.0 / PI)).clamp(0.0, 1.0);
            shape.round = y + y * (1.0 - y) * (ROUNDNESS[0] + y * (ROUNDNESS[1] + y * ROUNDNESS[2]));
        }
        shape
    }
}

impl Shape {
    /// a^2 over that at D, and its slope by eta.
    fn wide(&self, eta: f64) -> (f64, f64) {
        (eta * (1.0 + self.round * (1.0 - eta)), 1.0 + self.round * (1.0 - 2.0 * eta))
    }

    /// delta at x, and its slope.
    fn delta_at(&self, x: f64) -> (f64, f64) {
        let (wide, slope) = self.wide(x / self.approach);
        let delta = self.delta * wide.sqrt().sqrt();
        (delta, 0.25 * delta * slope / (wide * self.approach))
    }

    fn bare(&self, e: f64) -> Bare {
        if !(e > 0.0) {
            return Bare::default();
        }
        let eta = e / self.approach;
        let (mut f_n, mut energy) = (0.0, 0.0);
        for (y, share) in PLACES.into_iter().zip(SHARES) {
            let part = share * (1.0 + self.round * (1.0 - eta * y)).sqrt();
            f_n += part;
            energy += (1.0 - y) * part;
        }
        let root = eta.sqrt();
        let force = self.stiff * e * root;
        Bare { f_n: force * f_n, energy: force * e * energy, stiff: self.stiff * self.wide(eta).0.sqrt() }
    }

    /// x at which delta changes as fast as x, over `times`, of a sphere.
    fn turns(&self, times: f64) -> f64 {
        self.approach * ((0.25 * times * self.delta / self.approach).ln() / 0.75).exp()
    }

    /// The elastic approach at which the surfaces part: the least of x - delta.
    fn parts(&self) -> f64 {
        let (mut low, mut high) = (0.0, self.most);
        if self.round == 0.0 {
            high = high.min(self.turns(1.0));
        } else if self.delta_at(high).1 < 1.0 {
            for _ in 0..STEPS {
                let middle = 0.5 * (low + high);
                if self.delta_at(middle).1 < 1.0 {
                    high = middle;
                } else {
                    low = middle;
                }
            }
        }
        high - self.delta_at(high).0
    }

    /// x at the elastic approach e < `most`: the greater root of x - delta = e, from above. None
    /// where the surfaces part.
    fn joined(&self, e: f64) -> Option<f64> {
        let mut x = self.most;
        if x < f64::INFINITY && e >= x - self.delta_at(x).0 {
            return Some(x);
        }
        if self.round == 0.0 {
            let touching = self.turns(4.0);
            let above = if e > 0.0 { 3.0 * e.max(touching) } else { touching };
            x = x.min(above);
        }
        for _ in 0..STEPS {
            let (delta, slope) = self.delta_at(x);
            let step = (x - delta - e) / (1.0 - slope);
            if !(slope < 1.0 && step < x) {
                return None;
            }
            if !(step > TOLERANCE * x) {
                return Some(x);
            }
            x -= step;
        }
        Some(x)
    }

    /// Area over which undeformed surfaces are less than `z` apart, and its integral from 0 on: by
    /// their curvature, and beyond what is flattened by that of the sphere.
    fn near(&self, z: f64) -> (f64, f64) {
        let eta = 2.0 * z / self.approach;
        if self.round == 0.0 {
            return (self.area * eta, 0.5 * self.area * eta * z);
        }
        let to = if eta < 1.0 { eta } else { 1.0 };
        let sum = 0.5 * self.approach * to * to * (0.5 * (1.0 + self.round) - self.round * to / 3.0);
        let beyond = 0.5 * self.approach * (eta - to);
        let around = PI * self.radius * beyond;
        (self.area * self.wide(to).0 + 2.0 * around, self.area * (sum + beyond) + around * beyond)
    }

    /// What a range adds at the elastic approach e: as much in contact as at its beginning, but
    /// less and less over the last of the way to where the contact yields.
    fn attracted(&self, e: f64) -> Held {
        let stress = self.work / self.range;
        let gap = if e < 0.0 { -e } else { 0.0 };
        let (area, sum) = self.near(self.range - gap);
        let mut held = Held { f_n: -stress * area, energy: -stress * sum, ..Held::default() };
        if e > 0.0 {
            let last = if self.range < self.most { self.range } else { self.most };
            let left = if e < self.most { self.most - e } else { 0.0 };
            let share = if left < last { left / last } else { 1.0 };
            let way = if left < last { self.most - 0.5 * (last + left * share) } else { e };
            held.energy += held.f_n * way;
            held.f_n *= share;
        }
        held
    }

    /// What holds at the elastic approach e; none where the surfaces part.
    fn held(&self, e: f64) -> Option<Held> {
        if self.range > 0.0 {
            return (e > -self.range).then(|| self.attracted(e));
        }
        if e >= self.most {
            return Some(Held { energy: -self.work * self.area * self.wide(self.most / self.approach).0, ..Held::default() });
        }
        let x = self.joined(e)?;
        let (whole, bare, delta) = (self.bare(x), self.bare(e), x - e);
        let body = whole.energy - whole.f_n * delta + 0.5 * whole.stiff * delta * delta;
        Some(Held {
            energy: body - self.work * self.area * self.wide(x / self.approach).0 - bare.energy,
            f_n: whole.f_n - whole.stiff * delta - bare.f_n,
            presses: whole.f_n - bare.f_n,
            stiffer: whole.stiff - bare.stiff,
        })
    }
}

/// Work of a step, by the mean of its forces, that the energy after it has not.
fn lost(before: &CohesionState, after: &Held, dh: f64) -> f64 {
    0.5 * (before.f_n + after.f_n) * dh - (after.energy - before.energy)
}

/// The shape that a contact has at the indentation h, after one that `dh` led there, and what holds
/// there: that of before, or that of the law's hardening where it has less energy, by more than the
/// work of the step. Surfaces meet where the law's hardened shape touches.
fn join(cohesion: &Cohesion, table: &Table, state: &mut CohesionState, contact: &ContactState, dh: f64) -> (Shape, Held) {
    let now = |flattened: f64| {
        let shape = cohesion.shape(table, flattened);
        (shape, contact.h - shape.dent)
    };
    let (flat, e) = now(contact.hardened);
    let (shape, held) = if contact.hardened > state.flattened {
        let (shape, e) = now(state.flattened);
        (shape, shape.held(e))
    } else {
        (flat, flat.held(e))
    };
    let meets = state.joined != 1.0 && e >= -cohesion.range;
    let held = held.filter(|held| state.joined == 1.0 || meets && held.energy <= 0.0);
    if contact.hardened > state.flattened && (held.is_some() || meets) {
        let loses = |less: &Held| less.energy <= held.map_or(0.0, |held| held.energy) && lost(state, less, dh) >= 0.0;
        if let Some(less) = flat.held(e).filter(loses) {
            (state.flattened, state.joined) = (contact.hardened, 1.0);
            return (flat, less);
        }
    }
    state.joined = if held.is_some() { 1.0 } else { 0.0 };
    (shape, held.unwrap_or_default())
}

/// What cohesion adds to an increment: see
/// [`ContactParameters::cohere`](super::ContactParameters::cohere).
pub(super) fn cohere(
    table: &Table,
    cohesion: &Cohesion,
    (before, after): (&ContactState, &ContactState),
    state: &CohesionState,
    d: [f64; 2],
) -> (CohesionState, Attraction) {
    if !(cohesion.work > 0.0) {
        return (*state, Attraction::default());
    }
    let known = state.is_sound() && before.is_sound() && after.is_sound() && d.iter().all(|d| d.abs() <= MOST);
    if !known {
        let nan = f64::NAN;
        return (*state, Attraction { f_n: nan, f_t: [nan; 2], stored: nan, lost: nan, slip: nan });
    }
    let mut next = *state;
    // What never touched comes from where attraction begins.
    let begins = if state.joined == 0.0 && before.h_max == 0.0 && before.h == 0.0 { cohesion.range } else { 0.0 };
    let dh = after.h - before.h + begins;
    let (shape, held) = join(cohesion, table, &mut next, after, dh);
    (next.f_n, next.energy) = (held.f_n, held.energy);
    let lost = lost(state, &held, dh);
    // A stiffness that falls takes force with it, one that grows none: neither adds energy.
    next.stiffness = shape.along * if held.stiffer > 0.0 { held.stiffer } else { 0.0 };
    let share = if next.stiffness < state.stiffness { next.stiffness / state.stiffness } else { 1.0 };
    let [x, y] = [0, 1].map(|i| share * state.slider[i] + next.stiffness * d[i]);
    let (force, limit) = ((x * x + y * y).sqrt(), table.friction * held.presses);
    let kept = if force > limit { if limit > 0.0 { limit / force } else { 0.0 } } else { 1.0 };
    next.slider = [kept * x, kept * y];
    let energy = |state: &CohesionState| {
        let [x, y] = state.slider;
        if state.stiffness > 0.0 { 0.5 * (x * x + y * y) / state.stiffness } else { 0.0 }
    };
    let done: f64 = (0..2).map(|i| 0.5 * (state.slider[i] + next.slider[i]) * d[i]).sum();
    let slip = done - (energy(&next) - energy(state));
    (next, Attraction { f_n: held.f_n, f_t: next.slider, stored: held.energy + energy(&next), lost, slip })
}
