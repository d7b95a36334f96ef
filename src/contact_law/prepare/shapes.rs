//! The shapes of one level from the shear at constant h.

use super::super::state::ContactState;
use super::super::table::{
    COLUMNS, FIRST_N, FLOW, GAMMA, LN_FORCE, LN_STIFFNESS, LOST, MOBILISED, PLACES, Row, SOLVED, SUDDEN, Table, UNSHEARED_N,
    VERTEX, exponent, place,
};
use super::super::virgin::Virgin;
use super::drive::{Driven, Slides, root};
use super::losses::{costs, power, steady_loss};

/// Points along a shear.
const WAY: usize = 144;
/// Least rise of the yield factor over r/mu, at constant r and F_N there is no place on the curve:
/// of a contact that shear costs F_N, and of an elastic one.
const LEAST_RISE: [f64; 2] = [0.02, 1e-6];
/// r/mu from which a shear has come to its end.
const END: f64 = 0.9985;
/// Greatest rise of the yield factor over that of F_N0/F_N: a contact that recovers nearly all of
/// its indentation would have to harden without bounds to lose F_N.
const MOST_RISE: f64 = 4.0;
/// Dents over the elastic approach that are no flow.
const NO_FLOW: f64 = 1e-12;

/// What a shear at constant h passes, over r/mu.
#[derive(Default)]
struct Way {
    /// r/mu.
    x: Vec<f64>,
    /// The yield factor.
    factor: Vec<f64>,
    /// Distance from the vertex.
    far: Vec<f64>,
    dent: Vec<f64>,
    /// Length of the rounded direction v.
    along: Vec<f64>,
    /// What of delta_T the sliders leave, and what no elastic contact would have.
    left: Vec<f64>,
    inelastic: Vec<f64>,
}

impl Way {
    fn push(&mut self, [x, factor, far, dent, along, left, inelastic]: [f64; 7]) {
        self.x.push(x);
        self.factor.push(factor);
        self.far.push(far);
        self.dent.push(dent);
        self.along.push(along);
        self.left.push(left);
        self.inelastic.push(inelastic);
    }

    fn last(&self) -> usize {
        self.x.len() - 1
    }
}

/// The lesser of two, rounded.
fn lesser(a: f64, b: f64) -> f64 {
    if !(a > 0.0) || !(b > 0.0) {
        return 0.0;
    }
    let q = if a < b { a / b } else { b / a };
    a.min(b) / (1.0 + q * q * q * q).powf(0.25)
}

/// Straight between the points of a curve with increasing x, flat beyond.
fn between(x: &[f64], y: &[f64], at: f64) -> f64 {
    let last = x.len() - 1;
    let mut i = 0;
    while i < last - 1 && x[i + 1] < at {
        i += 1;
    }
    let mut u = (at - x[i]) / (x[i + 1] - x[i]);
    if i == last - 1 && u > 1.0 {
        u = 1.0;
    }
    y[i] + u * (y[i + 1] - y[i])
}

/// The depth whose yield force and dent leave F_N at the indentation h; that of the greatest yield
/// factor, if that comes first.
fn hardened(table: &Table, h: f64, f_n: f64, most: f64, from: f64) -> f64 {
    root(
        |depth| {
            // The lesser of what F_N and what the yield factor lack.
            let row = table.read(depth, SOLVED);
            (f_n - left_at(&row, h, f_n)).max(row.value[LN_FORCE] - most * f_n) / f_n
        },
        from,
        from + h,
    )
}

/// F_N at the indentation h of a contact hardened to the depth of `row`, where the shear leaves
/// `f_n`.
fn left_at(row: &Row, h: f64, f_n: f64) -> f64 {
    let (gamma, force) = (row.value[GAMMA], row.value[LN_FORCE]);
    let e = (h - row.dent).max(0.0);
    let width = 1.0 + row.wide * (force / f_n - 1.0);
    force * ((gamma - 1.0) * width.ln() + gamma * (e / row.approach).ln()).exp()
}

/// Follows the shear with the sliders as the press has left them.
fn way(table: &Table, virgin: &Virgin, h: f64, mut driven: Driven) -> Way {
    let constants = &table.constants;
    let mu = table.friction;
    let eps = constants.vertex_round * mu;
    let (mut vertex, mut depth, mut moved, mut slipped) = (0.0, h, 0.0, 0.0);
    let least_rise = LEAST_RISE[1] + costs(virgin) * (LEAST_RISE[0] - LEAST_RISE[1]);
    let mut way = Way::default();
    way.push([0.0, 1.0, 0.0, h - table.approach(h), 0.0, 0.0, 0.0]);
    for k in 1..=WAY {
        let at = (k as f64 / WAY as f64).powi(2);
        let [f_n, f_t] = virgin.sheared(mu, at);
        let r = (f_t / f_n).min(0.999 * mu);
        let last = way.last();
        if r <= (way.x[last] + 1e-9) * mu {
            if way.x[last] > 0.99 {
                break;
            }
            continue;
        }
        let most = 1.0 + MOST_RISE * (virgin.point.f_n0 / f_n - 1.0);
        depth = hardened(table, h, f_n, most, depth);
        let row = table.read(depth, COLUMNS);
        let (dent, force, stiff) = (row.dent, row.value[LN_FORCE], row.value[LN_STIFFNESS]);
        let q = (dent - way.dent[last]).max(0.0) * stiff / (force * constants.vertex_length * mu);
        // What hardens to its bounds keeps more of F_N than the shear has, and F_T with it: their
        // ratio stays that of the shear.
        let f_n = f_n.max(left_at(&row, h, f_n));
        let d = at * virgin.point.delta_t_end;
        let slides = Slides {
            stiff,
            most: mu * f_n,
            exponent: exponent(row.value[FIRST_N], row.value[UNSHEARED_N], table.later, way.x[last]),
            radial_most: constants.radial_most,
        };
        slipped += driven.drive_to(&slides, 0.0, r * f_n, d - moved);
        moved = d;
        let behind = (r - vertex) / (1.0 + q);
        vertex = r - behind;
        let x = r / mu;
        let far = behind.max(way.far[last] + 1e-6 * mu);
        let factor = (force / f_n).max(way.factor[last] + least_rise * (x - way.x[last]));
        let along = far / (far * far + eps * eps).sqrt();
        way.push([x, factor, far, dent.max(way.dent[last]), along, d - slipped, d - r * f_n / stiff]);
        if x > END {
            break;
        }
    }
    if way.last() == 0 {
        way.push([1.0, 1.0 + least_rise, mu, way.dent[0], 1.0, 0.0, 0.0]);
    }
    way
}

/// Fills the shapes of one level, at the depth of a contact that was `pressed`; c of plastic
/// displacements and the ratio at which it was measured.
pub(super) fn fill(virgin: &Virgin, table: &mut Table, level: usize, [c, measured]: [f64; 2], pressed: &ContactState) {
    let h = pressed.h;
    let constants = table.constants;
    let mu = table.friction;
    let recovered = virgin.slope * virgin.depth / (virgin.gamma * virgin.point.f_n0);
    let (approach, sudden) = (table.approach(h), table.column(SUDDEN, h));
    let way = way(table, virgin, h, Driven::of(pressed));
    let last = way.last();
    let end = way.x[last];
    let shape = &mut table.shapes[level];
    for j in 0..=PLACES {
        let here = place(j) * end;
        let r = place(j) * mu;
        let low = 0.5 * (place(j) + place(j.saturating_sub(1))) * end;
        let high = 0.5 * (place(j) + place((j + 1).min(PLACES))) * end;
        let over = |y: &[f64]| between(&way.x, y, high) - between(&way.x, y, low);
        let (hardens, grows) = (over(&way.dent), over(&way.factor));
        let direction = between(&way.x, &way.along, here);
        let factor = |j: usize| between(&way.x, &way.factor, place(j) * end);
        let mut lost = lesser(steady_loss(&constants, c, r), constants.loss_most * (factor(j) - 1.0));
        if j > 0 {
            // No more than the shear loses from place to place: A and B are its yield factor.
            lost = lost.min(shape[LOST][j - 1] + factor(j) - factor(j - 1));
        }
        // c rises with r where more is elastic, and falls where less is; and a steady press flows
        // no more than this shear.
        let bend = 1.0 + constants.bend * (recovered - constants.bend_from) * ((r / measured).min(2.0) - 1.0);
        let mut flow = 2.0 * c * bend.max(0.2) * r / (1.0 - lost).max(0.02);
        if hardens > NO_FLOW * approach {
            flow = lesser(flow, over(&way.inelastic) / hardens);
        }
        let way_left = over(&way.left) - hardens * (sudden * direction + flow);
        shape[LOST][j] = lost;
        shape[FLOW][j] = flow;
        // What hardly loses F_N flows less than it was given to, not without bounds.
        let grows = grows.max(LEAST_RISE[0] * (high - low));
        shape[MOBILISED][j] = if way_left > 0.0 && direction > 0.0 { way_left / grows / approach / direction } else { 0.0 };
    }
    shape[MOBILISED][0] = shape[MOBILISED][1];
    shape[MOBILISED][PLACES] = shape[MOBILISED][PLACES - 1];
    shape[FLOW][PLACES] = shape[FLOW][PLACES].max(shape[FLOW][PLACES - 1]);
    table.reach[level] = way.far[last];
    table.beyond[level] = constants.beyond * power(1.0 - approach / h, constants.beyond_fades);
    fill_vertex(&mut table.shapes[level], &way);
}

/// B, what the shear loses beyond A, over the distance from the vertex.
fn fill_vertex(shape: &mut [[f64; PLACES + 1]], way: &Way) {
    let last = way.last();
    shape[VERTEX][0] = 0.0;
    for j in 1..=PLACES {
        let distance = place(j) * way.far[last];
        let at = between(&way.far, &way.x, distance) / way.x[last];
        let mut k = 0;
        while k < PLACES - 1 && place(k + 1) < at {
            k += 1;
        }
        let u = ((at - place(k)) / (place(k + 1) - place(k))).min(1.0);
        let lost = shape[LOST][k] + u * (shape[LOST][k + 1] - shape[LOST][k]);
        let far = between(&way.far, &way.factor, distance) - 1.0 - lost;
        shape[VERTEX][j] = far.max(shape[VERTEX][j - 1]);
    }
}
