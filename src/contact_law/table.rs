//! What the update reads: columns over the hardening depth, and shapes over F_T/F_N.

use super::constants::Constants;

/// Rows, even in ln h.
pub const ROWS: usize = 192;
/// Levels of the shapes, even in ln h.
pub const LEVELS: usize = 24;
/// Places of a shape after its start, at 1 - (1 - j/PLACES)^2: denser at full slip.
pub const PLACES: usize = 24;
/// Sliders, each an annulus of the contact.
pub const SLIDERS: usize = 7;

/// Columns: those that a step solves with first, then those of its start.
pub(crate) const LN_FORCE: usize = 0;
pub(crate) const LN_STIFFNESS: usize = 1;
pub(crate) const RECOVERED: usize = 2;
pub(crate) const GAMMA: usize = 3;
pub(super) const SOLVED: usize = 4;
pub(crate) const FIRST_N: usize = 4;
pub(crate) const UNSHEARED_N: usize = 5;
pub(crate) const RADIAL_SLIP: usize = 6;
pub(crate) const SUDDEN: usize = 7;
pub(crate) const SOFTENING: usize = 8;
pub(crate) const LN_RADIUS: usize = 9;
/// Number of columns.
pub const COLUMNS: usize = 10;

/// Shapes over r/mu: the steady loss A, the steady flow, the flow with a growing yield factor; and
/// B over the distance from the vertex.
pub(crate) const LOST: usize = 0;
pub(crate) const FLOW: usize = 1;
pub(crate) const MOBILISED: usize = 2;
pub(crate) const VERTEX: usize = 3;
/// Number of shapes.
pub const SHAPES: usize = 4;

/// The table of one contact, any one consistent system of units.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Universal constants.
    pub(crate) constants: Constants,
    /// mu.
    pub(crate) friction: f64,
    /// n of the sliders after their slip was reversed.
    pub(crate) later: f64,
    /// Hardening depth of the first row, below first yield.
    pub(crate) first: f64,
    /// Rows of an e-fold of the depth.
    pub(crate) per_step: f64,
    /// ln of the depth of the first level over that of the first row; levels of an e-fold.
    pub(crate) level_start: f64,
    pub(crate) per_level: f64,
    pub(crate) rows: [[f64; COLUMNS]; ROWS],
    pub(crate) shapes: [[[f64; PLACES + 1]; SHAPES]; LEVELS],
    /// Of the vertex: its distance at full slip, and its slope beyond that over the mean one
    /// before.
    pub(crate) reach: [f64; LEVELS],
    pub(crate) beyond: [f64; LEVELS],
}

/// A row at a hardening depth, and its slopes: forces and stiffnesses themselves, with the slopes
/// of their logarithms.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Row {
    pub(super) value: [f64; COLUMNS],
    pub(super) slope: [f64; COLUMNS],
    /// Elastic approach D of first loading and the dent, and their slopes.
    pub(super) approach: f64,
    pub(super) approach_slope: f64,
    pub(super) dent: f64,
    pub(super) dent_slope: f64,
    /// Share of a growing yield factor that makes the contact stiffer, and its slope.
    pub(super) wide: f64,
    pub(super) wide_slope: f64,
    level: usize,
    /// Place between the levels, and its slope.
    share: f64,
    pub(super) share_slope: f64,
}

/// Plastic share of the indentation over this, up to 1, is the share of a growing yield factor that
/// makes a contact stiffer: one that recovers all of it has no dent that could grow instead.
const WIDE: f64 = 2.0;

/// That share, of what is plastic.
fn wide(plastic: f64) -> f64 {
    (WIDE * plastic).min(1.0)
}

/// Place j of the shapes.
pub(super) fn place(j: usize) -> f64 {
    let rest = 1.0 - j as f64 / PLACES as f64;
    1.0 - rest * rest
}

impl Table {
    /// The first `count` columns at a depth.
    pub(super) fn read(&self, depth: f64, count: usize) -> Row {
        let log_h = (depth / self.first).ln();
        let (x, level) = (log_h * self.per_step, (log_h - self.level_start) * self.per_level);
        let mut row = Row { value: [0.0; COLUMNS], ..Row::default() };
        let i = if x > 0.0 { (x as usize).min(ROWS - 2) } else { 0 };
        let u = if x > 0.0 { x - i as f64 } else { 0.0 };
        for c in 0..count {
            let low = self.rows[i][c];
            let rise = self.rows[i + 1][c] - low;
            // Beyond the last row only forces, stiffnesses and radii go on.
            let v = if (RECOVERED..LN_RADIUS).contains(&c) && u > 1.0 { 1.0 } else { u };
            row.value[c] = low + v * rise;
            row.slope[c] = if v < u { 0.0 } else { rise * self.per_step / depth };
        }
        row.value[LN_FORCE] = row.value[LN_FORCE].exp();
        row.value[LN_STIFFNESS] = row.value[LN_STIFFNESS].exp();
        row.approach = row.value[RECOVERED] * depth;
        row.approach_slope = row.value[RECOVERED] + row.slope[RECOVERED] * depth;
        row.dent = depth - row.approach;
        row.dent_slope = 1.0 - row.approach_slope;
        let plastic = 1.0 - row.value[RECOVERED];
        (row.wide, row.wide_slope) = (wide(plastic), if WIDE * plastic < 1.0 { -WIDE * row.slope[RECOVERED] } else { 0.0 });
        row.level = if level > 0.0 { (level as usize).min(LEVELS - 2) } else { 0 };
        let u = level - row.level as f64;
        row.share = if u > 0.0 { u.min(1.0) } else { 0.0 };
        row.share_slope = if (0.0..1.0).contains(&u) { self.per_level / depth } else { 0.0 };
        row
    }

    /// Elastic approach D of first loading at a depth.
    pub(super) fn approach(&self, depth: f64) -> f64 {
        self.column(RECOVERED, depth) * depth
    }

    /// A column as it stands in the rows, straight between and beyond them.
    pub(super) fn column(&self, column: usize, depth: f64) -> f64 {
        let x = (depth / self.first).ln() * self.per_step;
        let i = if x > 0.0 { (x as usize).min(ROWS - 2) } else { 0 };
        let u = if x > 0.0 { x - i as f64 } else { 0.0 };
        self.rows[i][column] + u * (self.rows[i + 1][column] - self.rows[i][column])
    }

    /// A shape at x: value, and slopes by x and by the share between levels.
    pub(super) fn shape(&self, row: &Row, shape: usize, x: f64) -> (f64, [f64; 2]) {
        let (low, high) = (&self.shapes[row.level][shape], &self.shapes[row.level + 1][shape]);
        if x >= 1.0 {
            // The vertex goes on straight, by a share of its mean slope; the others stay.
            let (a, b) = (low[PLACES], high[PLACES]);
            if shape != VERTEX {
                return (a + row.share * (b - a), [0.0, b - a]);
            }
            let on = a * self.beyond[row.level];
            let rise = b * self.beyond[row.level + 1] - on;
            let slope = on + row.share * rise;
            return (a + row.share * (b - a) + slope * (x - 1.0), [slope, b - a + rise * (x - 1.0)]);
        }
        let j = ((PLACES as f64 * (1.0 - (1.0 - x).sqrt())) as usize).min(PLACES - 1);
        let from = place(j);
        let width = place(j + 1) - from;
        let (rise, rise_b) = (low[j + 1] - low[j], high[j + 1] - high[j]);
        let u = (x - from) / width;
        let (a, b) = (low[j] + u * rise, high[j] + u * rise_b);
        (a + row.share * (b - a), [(rise + row.share * (rise_b - rise)) / width, b - a])
    }

    /// The yield factor G at a ratio F_T/F_N and a distance from the vertex; its slopes by these
    /// two and by the depth.
    pub(super) fn factor(&self, row: &Row, ratio: f64, distance: f64) -> (f64, [f64; 3]) {
        let low = self.reach[row.level];
        let rise = self.reach[row.level + 1] - low;
        let reach = low + row.share * rise;
        let x = distance / reach;
        let (lost, a) = self.shape(row, LOST, ratio / self.friction);
        let (vertex, b) = self.shape(row, VERTEX, x);
        let by_depth = (a[1] + b[1] - b[0] * x * rise / reach) * row.share_slope;
        (1.0 + lost + vertex, [a[0] / self.friction, b[0] / reach, by_depth])
    }
}

/// Shares of the sliders in k_T: (i/7)^0.65 inside the end of cell i.
pub(crate) const WEIGHTS: [f64; SLIDERS] = [
    0.28228007246945605,
    0.16067234912498195,
    0.1335715962968834,
    0.11854658577836137,
    0.10849433246541654,
    0.10110285024062748,
    0.09533221362427317,
];

/// Approach, over that of the whole contact, at which each slider's annulus is lost, for the
/// backbone 1 - (1 - x)^n (Jaeger 1998). Cells end at (i/7)^(0.65/(n - 1)).
pub(super) fn lost(n: f64) -> [f64; SLIDERS] {
    let p = 0.65 / (n - 1.0);
    let [two, three, five, seven] = [2.0_f64, 3.0, 5.0, 7.0].map(|x| (x.ln() * p).exp());
    let seventh = 1.0 / seven;
    let end = [seventh, two * seventh, three * seventh, two * two * seventh, five * seventh, two * three * seventh, 1.0];
    let (mut inside, mut before) = (0.0, 0.0);
    std::array::from_fn(|i| {
        inside += WEIGHTS[i];
        let above = inside * end[i];
        let lost = (n - 1.0) / n * (above - before) / WEIGHTS[i];
        before = above;
        lost
    })
}

/// Exponent of the backbone: of a contact that was not sheared, of its first reversal, of those
/// after; by how far it was sheared (to 1) and its slip reversed (to 2).
pub(super) fn exponent(first: f64, unsheared: f64, later: f64, worn: f64) -> f64 {
    if worn <= 1.0 {
        let rest = 1.0 - worn;
        first + unsheared * rest * rest.sqrt()
    } else if first > later {
        first + (worn - 1.0) * (later - first)
    } else {
        first
    }
}
