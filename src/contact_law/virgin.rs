//! The virgin curves of one pair of materials: everything that the contact update asks of the law,
//! tabulated over the indentation.
//!
//! The table is cubic in ln h through [`KNOTS`] equidistant knots, so that an update costs no root
//! search. Its last digits differ from the formulas that filled it by some 1e-4; what counts is
//! that every language fills and reads it by the same operations.

use super::curve::NormalCurve;
use super::yielding::{is_elastic, virgin_yield_coefficient};

/// Number of knots over ln h.
pub const KNOTS: usize = 128;
/// Number of tabulated quantities.
pub const COLUMNS: usize = 8;
/// Points of a shape that is given by numbers, over x = (j/POINTS)^2, j = 1 and on.
pub const POINTS: usize = 24;
/// Levels of ln h on which they are given.
pub const LEVELS: usize = 16;
/// [`ContactParameters::form`] of shapes that are given by numbers.
pub const BY_NUMBERS: f64 = 2.0;
/// Number of sliders that stand for the contact's annuli.
pub const SLIDERS: usize = 16;

/// Exponent of the sliders' backbone of a contact that was never sheared. Of simulated oblique
/// rebounds; fades with the eighth power of 1 - x.
const UNSHEARED: f64 = 2.0;

/// Exponent of the sliders' backbone in a first reversal, less 1, over that of a table, which is
/// between it and those after.
const FIRST: f64 = 1.5;
/// The exponent of those after, which turn more sharply, in all materials alike. Of simulated
/// cycles.
const LATER: f64 = 1.15;
/// Share of F_N0 that is lost to shear from which that is so: an elastic contact keeps its
/// exponent.
const HARDLY: f64 = 0.02;

/// Pieces of a step of the table over which its work is summed.
pub const PIECES: usize = 4;

/// Share of the work of a step that is spared where a contact would store too much, for some of
/// what the cubics between the knots gain: 2e-4 of the work at the most.
pub const SPARE: f64 = 5e-5;
/// By how much a contact must store too much for it to be no rounding.
pub const ROUNDING: f64 = 1e-9;

/// Powers of h in a Hertz contact of the quantities whose logarithms are tabulated.
const ELASTIC_POWERS: [f64; COLUMNS] = [1.5, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5];

/// What the update needs to know of a pair of materials. Plain data, shared by all contacts of the
/// pair; any one consistent system of units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactParameters {
    /// Radius R, length; of a contact of two equal spheres R* = R/2.
    pub radius: f64,
    /// E* = E/(1 - nu^2), stress; half of it for two equal spheres.
    pub effective_modulus: f64,
    /// Coulomb's coefficient mu.
    pub friction: f64,
    /// Form of f_N: 0 is \[1 - (1 - x)^M\]^N, 1 is 1 - (1 - x^M)^N; 2: f_T and f_N are `shapes`.
    pub form: f64,
    /// ln h of the first knot.
    pub log_first: f64,
    /// Step of ln h from knot to knot.
    pub log_step: f64,
    /// The gentle exponent of f_N, N of form 0 and M of form 1: the same at every h.
    pub gentle: f64,
    /// Per knot: ln F_N0; ln a, the radius with which 2 E* a is the stiffness of an unloading;
    /// F_N_slip/F_N0; ln delta_T_end; n (with form 2 the coefficient c of the yield curve); the
    /// contact radius over a; the steep exponent of f_N (with form 2 the exponent of the sliders'
    /// backbone); ln k_T.
    pub table: [[f64; COLUMNS]; KNOTS],
    /// f_T and f_N of form 2 on levels from the first knot to the last, equidistant in ln h; zero
    /// otherwise.
    pub shapes: [Shapes; LEVELS],
}

/// f_T and f_N at x = (j/POINTS)^2, j = 1 and on.
pub type Shapes = [[f64; POINTS]; 2];

/// Why there are no contact parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// Coulomb's coefficient.
    #[error(
        "mu = {value}: a contact update needs a finite friction coefficient, 0 or more. full stick has no slip force to scale with"
    )]
    Friction {
        /// mu.
        value: f64,
    },
    /// Something is not a positive, finite number.
    #[error(
        "contact at h/R = {relative_indentation:e}: {what} = {value:e} is no positive number. Check the material and the law"
    )]
    Value {
        /// Indentation over R.
        relative_indentation: f64,
        /// What.
        what: &'static str,
        /// Its value.
        value: f64,
    },
}

/// The axisymmetric state and the law at one indentation of first loading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VirginPoint {
    /// Contact radius a, length.
    pub a: f64,
    /// Normal force F_N0 before any shear, force.
    pub f_n0: f64,
    /// Normal force at full slip, force.
    pub f_n_slip: f64,
    /// Displacement at which the curves end, delta_T_end, length.
    pub delta_t_slip: f64,
    /// Tangential stiffness without slip and plastic flow, force over length: that of a reversal.
    pub k_t: f64,
    /// Exponent n of f_T; with form 2 the coefficient c of the yield curve, of which f_T knows
    /// nothing.
    pub n: f64,
    /// Exponent M of f_N.
    pub m_exponent: f64,
    /// Exponent N of f_N.
    pub n_exponent: f64,
}

/// [`VirginPoint`] as the update uses it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Virgin {
    /// The law.
    pub point: VirginPoint,
    /// dF_N0/dh, force over length.
    pub slope: f64,
    /// Exponent gamma of the elastic unloading, F_N = F_N0 eta^gamma: 3/2 for Hertz, 4/pi for a
    /// uniform pressure.
    pub gamma: f64,
    /// Elastic approach D = gamma F_N0/(2 E* a), length: h less D is the residual indentation.
    pub depth: f64,
    /// Exponent of the sliders' backbone in a first reversal after full slip: of formulas the
    /// smaller of gamma and n.
    pub first: f64,
    /// The same of this contact.
    pub backbone: f64,
    /// Shares of the sliders in k_T; their sum is 1.
    pub weight: [f64; SLIDERS],
    /// Approach over D at which each slider's annulus loses contact.
    pub lost: [f64; SLIDERS],
    /// f_T and f_N of form 2.
    pub shapes: Shapes,
}

/// gamma from how far the hardness has fallen below Hertz's at the same contact radius: 3/2 while
/// it has not (Hertz), 4/pi at the end (a uniform pressure taken off, Mesarovic & Johnson 2000,
/// whose unloading curve it keeps to 2 % of the force).
pub fn unloading_exponent(radius: f64, effective_modulus: f64, a: f64, f_n0: f64) -> f64 {
    let hertz = 4.0 * effective_modulus * a * a * a / (3.0 * radius);
    let share = if f_n0 < hertz { f_n0 / hertz } else { 1.0 };
    PLASTIC_GAMMA + (1.5 - PLASTIC_GAMMA) * share
}

/// 4/pi: with it unloading from a uniform pressure starts with 2 E* a and recovers 2 p a/E*.
const PLASTIC_GAMMA: f64 = 1.2732395447351628;

impl ContactParameters {
    /// Tabulates `law`, which answers for an indentation, over the indentations `range` (both >
    /// 0), from first yield (below it, it must go with Hertz's powers of h) to the greatest that
    /// will be met. The gentle exponent of f_N must not hang on h. Without a `curve` f_T and f_N
    /// are to be given [by numbers](Self::with_shapes): then a is the radius whose 2 E* a is the
    /// stiffness of an unloading, and M the exponent of the sliders' backbone.
    ///
    /// # Errors
    /// [`ContactError::Value`] where a quantity is not positive and finite.
    pub fn tabulate(
        radius: f64,
        effective_modulus: f64,
        friction: f64,
        curve: Option<NormalCurve>,
        range: [f64; 2],
        law: impl Fn(f64) -> VirginPoint,
    ) -> Result<Self, ContactError> {
        let form = match curve {
            Some(NormalCurve::PowerOfComplement) => 0.0,
            Some(NormalCurve::ComplementOfPower) => 1.0,
            None => BY_NUMBERS,
        };
        let log_first = range[0].ln();
        let log_step = (range[1].ln() - log_first) / (KNOTS as f64 - 1.0);
        let mut table = [[0.0; COLUMNS]; KNOTS];
        let mut gentle = 1.0;
        for i in 0..KNOTS {
            let h = (log_first + log_step * i as f64).exp();
            let p = law(h);
            let positive = [
                ("a", p.a),
                ("F_N0", p.f_n0),
                ("F_N_slip", p.f_n_slip),
                ("delta_T_end", p.delta_t_slip),
                ("k_T", p.k_t),
                ("n", p.n),
                ("M", p.m_exponent),
                ("N", p.n_exponent),
            ];
            for (what, value) in positive {
                if !(value > 0.0 && value.is_finite()) {
                    return Err(ContactError::Value { relative_indentation: h / radius, what, value });
                }
            }
            let ratio = p.f_n_slip / p.f_n0;
            let steep = match curve {
                Some(NormalCurve::ComplementOfPower) => {
                    gentle = p.m_exponent;
                    p.n_exponent
                }
                Some(NormalCurve::PowerOfComplement) | None => {
                    gentle = p.n_exponent;
                    p.m_exponent
                }
            };
            table[i] =
                [p.f_n0.ln(), p.a.ln(), if ratio < 1.0 { ratio } else { 1.0 }, p.delta_t_slip.ln(), p.n, 1.0, steep, p.k_t.ln()];
        }
        let shapes = [[[0.0; POINTS]; 2]; LEVELS];
        let mut parameters = Self { radius, effective_modulus, friction, form, gentle, log_first, log_step, table, shapes };
        parameters.conserve();
        Ok(parameters)
    }

    /// The same with f_T and f_N given by numbers for every level, the first at the first knot;
    /// with the contact radius that `contact_radius` has for an indentation, and with the
    /// coefficient c of the yield curve that `yielding` has, or that of the virgin curve where it
    /// has none.
    #[must_use]
    pub fn with_shapes(
        self,
        shapes: [Shapes; LEVELS],
        contact_radius: impl Fn(f64) -> f64,
        yielding: impl Fn(f64) -> Option<f64>,
    ) -> Self {
        let mut given = Self { form: BY_NUMBERS, shapes, ..self };
        let place = |i: usize| (self.log_first + self.log_step * i as f64).exp();
        for (i, row) in given.table.iter_mut().enumerate() {
            row[5] = contact_radius(place(i)) / row[1].exp();
        }
        let coefficients: [f64; KNOTS] = std::array::from_fn(|i| {
            let h = place(i);
            yielding(h).unwrap_or_else(|| virgin_yield_coefficient(&given, &given.virgin(h)))
        });
        for (row, c) in given.table.iter_mut().zip(coefficients) {
            row[4] = c;
        }
        given
    }

    /// What belongs to R = 1 and E = 1 for a sphere of this radius and this Young's modulus.
    #[must_use]
    pub fn scaled(self, radius: f64, youngs_modulus: f64) -> Self {
        let length = radius.ln();
        let force = (youngs_modulus * radius * radius).ln();
        let stiffness = (youngs_modulus * radius).ln();
        let mut scaled = Self {
            radius: self.radius * radius,
            effective_modulus: self.effective_modulus * youngs_modulus,
            log_first: self.log_first + length,
            ..self
        };
        for row in &mut scaled.table {
            row[0] += force;
            row[1] += length;
            row[3] += length;
            row[7] += stiffness;
        }
        scaled
    }

    /// f_T and f_N at a place between the levels; straight between them.
    fn shapes_at(&self, position: f64) -> Shapes {
        let mut shapes = self.shapes[0];
        if self.form != BY_NUMBERS || position <= 0.0 {
            return shapes;
        }
        let level = position * (LEVELS as f64 - 1.0) / (KNOTS as f64 - 1.0);
        let last = (LEVELS - 1) as f64;
        let level = if level < last { level } else { last };
        let i = if (level as usize) < LEVELS - 2 { level as usize } else { LEVELS - 2 };
        let u = level - i as f64;
        for kind in 0..2 {
            for j in 0..POINTS {
                let (low, high) = (self.shapes[i][kind][j], self.shapes[i + 1][kind][j]);
                shapes[kind][j] = low + u * (high - low);
            }
        }
        shapes
    }

    /// Stiffens the unloading where the law's F_N0 and a would let a press store more energy than
    /// was put in (an elastic contact of a finite a/R is stiffer than Hertz's of its radius, and a
    /// fit may be off next to first yield): the stored energy of a knot is at most that of the one
    /// before and the work between; and a dent never rises above where the sphere began. The
    /// contact radius stays the law's.
    fn conserve(&mut self) {
        self.keep_below(0, self.log_first.exp());
        let mut before = self.stored_at(0);
        for i in 1..KNOTS {
            if self.form != BY_NUMBERS {
                // What the body adds stays as the contact yields; a table has measured it.
                self.stiffen(i, 1.0 / self.table[i - 1][5]);
            }
            let most = before + self.work_between(i);
            let stored = self.stored_at(i);
            if stored > (1.0 + ROUNDING) * most {
                self.stiffen(i, stored / ((1.0 - SPARE) * most));
            }
            self.keep_below(i, (self.log_first + self.log_step * i as f64).exp());
            before = self.stored_at(i);
        }
    }

    /// Work of a press from the knot before to this one, F_N0 being a power of h on each of
    /// [`PIECES`] pieces of the way.
    fn work_between(&self, i: usize) -> f64 {
        let mut work = 0.0;
        let mut log_f = self.table[i - 1][0];
        for k in 1..=PIECES {
            let u = k as f64 / PIECES as f64;
            let next = self.column(0, (i - 1) as f64 + u)[0];
            let [h0, h1] = [u - 1.0 / PIECES as f64, u].map(|u| (self.log_first + self.log_step * ((i - 1) as f64 + u)).exp());
            let power = (next - log_f) / (self.log_step / PIECES as f64);
            work += (next.exp() * h1 - log_f.exp() * h0) / (power + 1.0);
            log_f = next;
        }
        work
    }

    /// Makes the unloading of a knot stiffer by a factor.
    fn stiffen(&mut self, i: usize, factor: f64) {
        self.table[i][1] += factor.ln();
        self.table[i][5] /= factor;
    }

    /// Lets no more than the indentation `h` be recovered at a knot.
    fn keep_below(&mut self, i: usize, h: f64) {
        let (f_n0, a) = (self.table[i][0].exp(), self.table[i][1].exp());
        let gamma = self.exponent_of(a, self.table[i][5], f_n0);
        let depth = gamma * f_n0 / (2.0 * self.effective_modulus * a);
        if depth > h {
            self.stiffen(i, depth / h);
        }
    }

    /// gamma by the contact radius, which is `radii` times that of the stiffness; of shapes by
    /// numbers by the latter, which the measured unloadings of a table were read with.
    fn exponent_of(&self, a: f64, radii: f64, f_n0: f64) -> f64 {
        let a = if self.form == BY_NUMBERS { a } else { radii * a };
        unloading_exponent(self.radius, self.effective_modulus, a, f_n0)
    }

    /// Elastic energy of the virgin contact at a knot.
    fn stored_at(&self, i: usize) -> f64 {
        let (f_n0, a) = (self.table[i][0].exp(), self.table[i][1].exp());
        let gamma = self.exponent_of(a, self.table[i][5], f_n0);
        gamma / (gamma + 1.0) * f_n0 * f_n0 / (2.0 * self.effective_modulus * a)
    }

    /// Slope of a column at a knot, per step. The steeper secant for the force and the flatter one
    /// for the radius: so neither kink at yield makes a virgin contact store more energy than was
    /// put in. The mean for the others.
    pub(super) fn knot_slope(&self, column: usize, i: usize) -> f64 {
        let value = |i: usize| self.table[i][column];
        if i == 0 {
            return value(1) - value(0);
        }
        let below = value(i) - value(i - 1);
        if i == KNOTS - 1 {
            return below;
        }
        let above = value(i + 1) - value(i);
        match column {
            0 => {
                if above > below {
                    above
                } else {
                    below
                }
            }
            1 => {
                if above < below {
                    above
                } else {
                    below
                }
            }
            _ => 0.5 * (above + below),
        }
    }

    /// The table's column `column` and its slope in steps, cubic between the knots. Below the
    /// first it goes with Hertz's powers of h; beyond the last logarithms go on straight and the
    /// others stay.
    fn column(&self, column: usize, position: f64) -> [f64; 2] {
        let value = |i: usize| self.table[i][column];
        let last = (KNOTS - 1) as f64;
        if position < 0.0 {
            let slope = ELASTIC_POWERS[column] * self.log_step;
            return [value(0) + slope * position, slope];
        }
        if position >= last {
            let end = KNOTS - 1;
            let slope = if ELASTIC_POWERS[column] > 0.0 { self.knot_slope(column, end) } else { 0.0 };
            return [value(end) + slope * (position - last), slope];
        }
        let i = position as usize;
        let u = position - i as f64;
        let (y0, y1, s0, s1) = (value(i), value(i + 1), self.knot_slope(column, i), self.knot_slope(column, i + 1));
        let rise = y1 - y0;
        let quadratic = 3.0 * rise - 2.0 * s0 - s1;
        let cubic = s0 + s1 - 2.0 * rise;
        [y0 + u * (s0 + u * (quadratic + u * cubic)), s0 + u * (2.0 * quadratic + 3.0 * u * cubic)]
    }

    /// First loading at the indentation `h` > 0.
    pub fn virgin(&self, h: f64) -> Virgin {
        self.virgin_sheared(h, 1.0, 0.0)
    }

    /// The same with [the sliders](Virgin::sharpen) of a contact that was sheared.
    pub(super) fn virgin_sheared(&self, h: f64, sheared: f64, reversed: f64) -> Virgin {
        let position = (h.ln() - self.log_first) / self.log_step;
        let [log_f, log_f_slope] = self.column(0, position);
        let f_n0 = log_f.exp();
        let a = self.column(1, position)[0].exp();
        let radii = self.column(5, position)[0];
        let gamma = self.exponent_of(a, radii, f_n0);
        let f_n_slip = self.column(2, position)[0] * f_n0;
        let delta_t_slip = self.column(3, position)[0].exp();
        let n = self.column(4, position)[0];
        let contact_radius = radii * a;
        let steep = self.column(6, position)[0];
        let (m_exponent, n_exponent) = if self.form == 0.0 { (steep, self.gentle) } else { (self.gentle, steep) };
        let mut backbone = if gamma < n { gamma } else { n };
        // The elastic sliders must be able to follow the virgin curve: neither softer at its start,
        // as a table's are, nor slower to slip.
        let mut k_t = self.column(7, position)[0].exp();
        if self.form == BY_NUMBERS {
            backbone = steep;
        } else {
            let start = n * self.friction * f_n_slip / delta_t_slip;
            if k_t < start {
                k_t = start;
            }
        }
        let end = backbone * self.friction * f_n0 / delta_t_slip;
        if k_t < end {
            k_t = end;
        }
        let point = VirginPoint { a: contact_radius, f_n0, f_n_slip, delta_t_slip, k_t, n, m_exponent, n_exponent };
        if self.form == BY_NUMBERS && !is_elastic(&point) {
            backbone = 1.0 + FIRST * (backbone - 1.0);
        }
        let mut virgin = Virgin {
            point,
            slope: f_n0 * log_f_slope / (self.log_step * h),
            gamma,
            depth: gamma * f_n0 / (2.0 * self.effective_modulus * a),
            first: backbone,
            backbone,
            weight: [0.0; SLIDERS],
            lost: [0.0; SLIDERS],
            shapes: self.shapes_at(position),
        };
        virgin.sharpen(sheared, reversed);
        virgin
    }
}

impl Virgin {
    /// Gives it the sliders of a contact that has yielded to shear at the place `sheared` of the
    /// virgin curves, and whose slip was reversed so far. Where it was hardly sheared, the
    /// tractions are lost sooner as it is released.
    pub(super) fn sharpen(&mut self, sheared: f64, reversed: f64) {
        self.backbone = self.first;
        if !is_elastic(&self.point) {
            let lost = (1.0 - self.point.f_n_slip / self.point.f_n0) / HARDLY;
            let again = reversed * (if lost < 1.0 { lost } else { 1.0 });
            if self.backbone > LATER {
                self.backbone += (LATER - self.backbone) * again;
            }
            if self.backbone < UNSHEARED {
                let rest = if sheared < 1.0 { 1.0 - sheared } else { 0.0 };
                let rest = rest * rest;
                let rest = rest * rest;
                self.backbone += (UNSHEARED - self.backbone) * (rest * rest);
            }
        }
        (self.weight, self.lost) = sliders(self.backbone);
    }
}

/// Power of the sliders' place at which the stiffness inside it grows: with it the broken line of
/// sixteen is within 2e-3 of a backbone with an exponent from 1.1 to 1.6 (3e-3 from 1.05 on).
const SPACING: f64 = 0.65;

/// (k/16)^0.65: shares of k_T of the annuli inside the end of cell k.
const INSIDE: [f64; SLIDERS + 1] = [
    0.0,
    0.16493848884661177,
    0.25881623096034434,
    0.3368610723585669,
    0.40612619817811774,
    0.46951828924049643,
    0.5285916811459566,
    0.5842997994985654,
    0.6372803136596311,
    0.6879860659818012,
    0.7367531668195612,
    0.7838397013217092,
    0.8294492546152544,
    0.8737459792985665,
    0.9168646621816685,
    0.9589176881122033,
    1.0,
];

/// Shares and points of loss of the sliders whose backbone is 1 - (1 - x)^backbone.
///
/// Each stands for a cell of the annuli at its centre of gravity, so that the broken line lies on
/// the curve at the cells' ends, above it between them and at 1 at full slip. The shares are the
/// same for every backbone: so a contact that grows keeps the forces of all its sliders by one
/// factor. The places of the cells differ.
pub(super) fn sliders(backbone: f64) -> ([f64; SLIDERS], [f64; SLIDERS]) {
    let (mut weight, mut lost) = ([0.0; SLIDERS], [0.0; SLIDERS]);
    let power = SPACING / (backbone - 1.0);
    let mut below_moment = 0.0;
    for i in 0..SLIDERS {
        let end = if i == SLIDERS - 1 { 1.0 } else { ((i + 1) as f64 / SLIDERS as f64).powf(power) };
        let above_moment = INSIDE[i + 1] * end;
        weight[i] = INSIDE[i + 1] - INSIDE[i];
        lost[i] = (backbone - 1.0) / backbone * (above_moment - below_moment) / weight[i];
        below_moment = above_moment;
    }
    (weight, lost)
}
