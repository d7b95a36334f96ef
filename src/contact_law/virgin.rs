//! First loading of one pair of materials: everything that the table of the update is made of,
//! tabulated over the indentation, cubic in ln h through [`KNOTS`] equidistant knots.

/// Number of knots over ln h.
const KNOTS: usize = 128;
/// Number of tabulated quantities.
const COLUMNS: usize = 8;
/// Points of a shape, over x = (j/POINTS)^2, j = 1 and on.
pub const POINTS: usize = 24;
/// Levels of ln h on which the shapes are given.
const LEVELS: usize = 16;

/// Pieces of a step of the table over which its work is summed.
const PIECES: usize = 4;

/// Share of the work of a step that is spared where a contact would store too much, for some of
/// what the cubics between the knots gain: 2e-4 of the work at the most.
const SPARE: f64 = 5e-5;
/// Halvings of the stiffness that stores so much.
const HALVINGS: usize = 40;
/// By how much a contact must store too much for it to be no rounding.
const ROUNDING: f64 = 1e-9;

/// F_N_slip/F_N0 from which a contact counts as elastic.
const ELASTIC: f64 = 1.0 - 1e-6;

/// Least contact radius over that of the unloading.
const LEAST_RADII: f64 = 1e-6;

/// Columns of the table.
const LN_FORCE: usize = 0;
const LN_UNLOADING_RADIUS: usize = 1;
const SLIP_SHARE: usize = 2;
const LN_END: usize = 3;
const COEFFICIENT: usize = 4;
const RADII: usize = 5;
const BACKBONE: usize = 6;
const LN_STIFFNESS: usize = 7;

/// Powers of h in a Hertz contact of the quantities whose logarithms are tabulated.
const ELASTIC_POWERS: [f64; COLUMNS] = [1.5, 0.5, 0.0, 1.0, 0.0, 0.0, 0.0, 0.5];

/// First loading over h, and the shear at constant h. Any one consistent system of units.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstLoading {
    /// Radius R, length; of a contact of two equal spheres R* = R/2.
    pub radius: f64,
    /// E* = E/(1 - nu^2), stress; half of it for two equal spheres.
    pub effective_modulus: f64,
    /// Coulomb's coefficient mu.
    pub friction: f64,
    /// Whether the stiffness of an unloading was measured.
    measured: bool,
    /// ln h of the first knot.
    pub log_first: f64,
    /// Step of ln h from knot to knot.
    pub log_step: f64,
    table: [[f64; COLUMNS]; KNOTS],
    /// f_T and f_N on levels from the first knot to the last, equidistant in ln h.
    shapes: [Shapes; LEVELS],
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

/// What a law gives of a contact at one indentation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Given {
    /// The contact; its c is not read.
    pub point: VirginPoint,
    /// Radius with which 2 E* a is the stiffness of an unloading, length; of a law that knows none
    /// it is that of the contact, or as much greater as keeps a press from storing too much.
    pub unloading_radius: Option<f64>,
    /// Exponent of the backbone of a reversal, as [`Virgin::backbone`].
    pub backbone: f64,
    /// Coefficient c of an oblique press; of none, that of the shear at constant h.
    pub coefficient: Option<f64>,
    /// f_T and f_N.
    pub shapes: Shapes,
}

/// The contact at one indentation of first loading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VirginPoint {
    /// Contact radius a, length.
    pub a: f64,
    /// Normal force F_N0 before any shear, force.
    pub f_n0: f64,
    /// Normal force where the curves of the shear end, force.
    pub f_n_slip: f64,
    /// Displacement there, length.
    pub delta_t_end: f64,
    /// Tangential stiffness without slip and plastic flow, force over length: that of a reversal.
    pub k_t: f64,
    /// c of an oblique press, d(delta_T)/dh = 2 c r/(1 - c r^2) with r = F_T/F_N.
    pub c: f64,
}

/// [`VirginPoint`] and what the table of the update needs beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Virgin {
    /// The law.
    pub point: VirginPoint,
    /// dF_N0/dh, force over length.
    pub slope: f64,
    /// Exponent gamma of the elastic unloading, F_N = F_N0 eta^gamma: 3/2 for Hertz, 4/pi for a
    /// uniform pressure.
    pub gamma: f64,
    /// Elastic approach D = gamma F_N0/(2 E* a): h less D is the residual indentation, length.
    pub depth: f64,
    /// Exponent of the backbone of a reversal: 3/2 in Cattaneo and Mindlin's contact, near 1 where
    /// it turns sharply.
    pub backbone: f64,
    /// f_T and f_N.
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

/// delta_T over h of the oblique press by which c is measured: at c = 2 its F_T comes to half of mu
/// F_N.
pub fn measured_slope(mu: f64) -> f64 {
    2.0 * mu / (1.0 + 0.5 * mu * mu)
}

impl FirstLoading {
    /// Tabulates `law`, which answers for an indentation, over the indentations `range` (both >
    /// 0), from first yield (below it, it must go with Hertz's powers of h) to the greatest that
    /// will be met.
    ///
    /// # Errors
    /// [`ContactError::Value`] where a quantity is not positive and finite.
    pub fn tabulate(
        radius: f64,
        effective_modulus: f64,
        friction: f64,
        range: [f64; 2],
        law: impl Fn(f64) -> Given,
    ) -> Result<Self, ContactError> {
        let log_first = range[0].ln();
        let log_step = (range[1].ln() - log_first) / (KNOTS as f64 - 1.0);
        let mut table = [[0.0; COLUMNS]; KNOTS];
        for (i, row) in table.iter_mut().enumerate() {
            let h = (log_first + log_step * i as f64).exp();
            let Given { point: p, unloading_radius, backbone, coefficient, .. } = law(h);
            let positive = [
                ("a", p.a),
                ("F_N0", p.f_n0),
                ("F_N_slip", p.f_n_slip),
                ("delta_T_end", p.delta_t_end),
                ("k_T", p.k_t),
                ("unloading_radius", unloading_radius.unwrap_or(p.a)),
                ("backbone", backbone),
            ];
            for (what, value) in positive {
                if !(value > 0.0 && value.is_finite()) {
                    return Err(ContactError::Value { relative_indentation: h / radius, what, value });
                }
            }
            let share = (p.f_n_slip / p.f_n0).min(1.0);
            let c = coefficient.unwrap_or(f64::NAN);
            let (ln_force, ln_end, ln_stiffness) = (p.f_n0.ln(), p.delta_t_end.ln(), p.k_t.ln());
            let unloading = unloading_radius.unwrap_or(p.a);
            *row = [ln_force, unloading.ln(), share, ln_end, c, p.a / unloading, backbone, ln_stiffness];
        }
        let mut shapes = [[[0.0; POINTS]; 2]; LEVELS];
        for (i, shape) in shapes.iter_mut().enumerate() {
            let position = i as f64 * (KNOTS as f64 - 1.0) / (LEVELS as f64 - 1.0);
            *shape = law((log_first + position * log_step).exp()).shapes;
        }
        let measured = law(range[1]).unloading_radius.is_some();
        let mut found = Self { radius, effective_modulus, friction, measured, log_first, log_step, table, shapes };
        found.conserve();
        for (i, h) in found.knots().collect::<Vec<_>>().into_iter().enumerate() {
            if found.table[i][COEFFICIENT].is_nan() {
                found.table[i][COEFFICIENT] = shear_coefficient(&found.virgin(h), friction);
            }
        }
        Ok(found)
    }

    /// Indentations of the knots.
    pub fn knots(&self) -> impl Iterator<Item = f64> + '_ {
        (0..KNOTS).map(|i| (self.log_first + self.log_step * i as f64).exp())
    }

    /// Indentations of the first knot and of the last.
    pub(super) fn range(&self) -> [f64; 2] {
        [self.log_first.exp(), (self.log_first + self.log_step * (KNOTS as f64 - 1.0)).exp()]
    }

    /// All that it is, as numbers.
    pub(super) fn to_numbers(&self) -> Vec<f64> {
        let measured = if self.measured { 1.0 } else { 0.0 };
        let alone = [self.radius, self.effective_modulus, self.friction, measured, self.log_first, self.log_step];
        let shapes = self.shapes.as_flattened().as_flattened();
        alone.iter().chain(self.table.as_flattened()).chain(shapes).copied().collect()
    }

    pub(super) fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let (&[radius, effective_modulus, friction, measured, log_first, log_step], rest) = numbers.split_first_chunk()?;
        let (mut table, mut shapes) = ([[0.0; COLUMNS]; KNOTS], [[[0.0; POINTS]; 2]; LEVELS]);
        let (of_table, of_shapes) = rest.split_at_checked(KNOTS * COLUMNS)?;
        if of_shapes.len() != LEVELS * 2 * POINTS || numbers.iter().any(|number| !number.is_finite()) {
            return None;
        }
        table.as_flattened_mut().copy_from_slice(of_table);
        shapes.as_flattened_mut().as_flattened_mut().copy_from_slice(of_shapes);
        let measured = measured != 0.0;
        Some(Self { radius, effective_modulus, friction, measured, log_first, log_step, table, shapes })
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
            row[LN_FORCE] += force;
            row[LN_UNLOADING_RADIUS] += length;
            row[LN_END] += length;
            row[LN_STIFFNESS] += stiffness;
        }
        scaled
    }

    /// f_T and f_N at a place between the levels; straight between them.
    fn shapes_at(&self, position: f64) -> Shapes {
        let mut shapes = self.shapes[0];
        if position <= 0.0 {
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
            if !self.measured {
                // What the body adds stays as the contact yields.
                self.stiffen(i, 1.0 / self.table[i - 1][RADII]);
            }
            let most = before + self.work_between(i);
            let stored = self.stored_at(i);
            if stored > (1.0 + ROUNDING) * most {
                self.stiffen_to(i, (1.0 - SPARE) * most, stored);
            }
            self.keep_below(i, (self.log_first + self.log_step * i as f64).exp());
            before = self.stored_at(i);
        }
    }

    /// Work of a press from the knot before to this one, F_N0 being a power of h on each of
    /// [`PIECES`] pieces of the way.
    fn work_between(&self, i: usize) -> f64 {
        let mut work = 0.0;
        let mut log_f = self.table[i - 1][LN_FORCE];
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
        self.table[i][LN_UNLOADING_RADIUS] += factor.ln();
        self.table[i][RADII] /= factor;
    }

    /// Makes the unloading of a knot so much stiffer that it stores `most`. No more: gamma falls
    /// with it, and what one knot stores too little, all after it would have to.
    fn stiffen_to(&mut self, i: usize, most: f64, stored: f64) {
        let (mut least, mut greatest) = (0.0, (stored / most).ln());
        for _ in 0..HALVINGS {
            let middle: f64 = 0.5 * (least + greatest);
            self.stiffen(i, middle.exp());
            if self.stored_at(i) > most {
                least = middle
            } else {
                greatest = middle
            }
            self.stiffen(i, (-middle).exp());
        }
        self.stiffen(i, greatest.exp());
    }

    /// Lets no more than the indentation `h` be recovered at a knot.
    fn keep_below(&mut self, i: usize, h: f64) {
        let (f_n0, a) = (self.table[i][LN_FORCE].exp(), self.table[i][LN_UNLOADING_RADIUS].exp());
        let gamma = self.exponent_of(a, self.table[i][RADII], f_n0);
        let depth = gamma * f_n0 / (2.0 * self.effective_modulus * a);
        if depth > h {
            self.stiffen(i, depth / h);
        }
    }

    /// gamma of a contact whose radius is so many `radii` of its unloading: by that, or by the
    /// latter where it was measured.
    fn exponent_of(&self, a: f64, radii: f64, f_n0: f64) -> f64 {
        let a = if self.measured { a } else { radii * a };
        unloading_exponent(self.radius, self.effective_modulus, a, f_n0)
    }

    /// Elastic energy of the virgin contact at a knot.
    fn stored_at(&self, i: usize) -> f64 {
        let (f_n0, a) = (self.table[i][LN_FORCE].exp(), self.table[i][LN_UNLOADING_RADIUS].exp());
        let gamma = self.exponent_of(a, self.table[i][RADII], f_n0);
        gamma / (gamma + 1.0) * f_n0 * f_n0 / (2.0 * self.effective_modulus * a)
    }

    /// Slope of a column at a knot, per step. The steeper secant for the force and the flatter one
    /// for the radius: so neither kink at yield makes a virgin contact store more energy than was
    /// put in. The mean for the others.
    fn knot_slope(&self, column: usize, i: usize) -> f64 {
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
            LN_FORCE => {
                if above > below {
                    above
                } else {
                    below
                }
            }
            LN_UNLOADING_RADIUS => {
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
        let position = (h.ln() - self.log_first) / self.log_step;
        let [log_f, log_f_slope] = self.column(LN_FORCE, position);
        let value = |column: usize| self.column(column, position)[0];
        let f_n0 = log_f.exp();
        let unloading = value(LN_UNLOADING_RADIUS).exp();
        // A cubic may undershoot where the law has a step.
        let radii = value(RADII).max(LEAST_RADII);
        let gamma = self.exponent_of(unloading, radii, f_n0);
        let (delta_t_end, backbone) = (value(LN_END).exp(), value(BACKBONE));
        // The elastic sliders must not be slower to slip than the curve of the shear.
        let k_t = value(LN_STIFFNESS).exp().max(backbone * self.friction * f_n0 / delta_t_end);
        let point = VirginPoint {
            a: radii * unloading,
            f_n0,
            f_n_slip: value(SLIP_SHARE).min(1.0) * f_n0,
            delta_t_end,
            k_t,
            c: value(COEFFICIENT).max(0.0),
        };
        Virgin {
            point,
            slope: f_n0 * log_f_slope / (self.log_step * h),
            gamma,
            depth: gamma * f_n0 / (2.0 * self.effective_modulus * unloading),
            backbone,
            shapes: self.shapes_at(position),
        }
    }
}

impl Virgin {
    /// Whether shear costs no normal force: Cattaneo and Mindlin's contact.
    pub fn is_elastic(&self) -> bool {
        self.point.f_n_slip >= ELASTIC * self.point.f_n0
    }

    /// F_N and F_T at x of the shear at constant h.
    pub(super) fn sheared(&self, friction: f64, x: f64) -> [f64; 2] {
        let point = &self.point;
        let lost = (point.f_n0 - point.f_n_slip) * given(&self.shapes[1], x);
        [point.f_n0 - lost, friction * point.f_n_slip * given(&self.shapes[0], x)]
    }
}

/// x at point `j` of a shape.
fn point_x(j: usize) -> f64 {
    let share = j as f64 / POINTS as f64;
    share * share
}

/// A shape at 0 <= x <= 1, straight from point to point.
fn given(shape: &[f64; POINTS], x: f64) -> f64 {
    if x >= 1.0 {
        return shape[POINTS - 1];
    }
    let j = ((POINTS as f64 * x.sqrt()) as usize).min(POINTS - 1);
    let below = if j == 0 { 0.0 } else { shape[j - 1] };
    below + (shape[j] - below) / (point_x(j + 1) - point_x(j)) * (x - point_x(j))
}

/// The least x at which a shape has the value `f`, or that of its peak.
fn given_inverse(shape: &[f64; POINTS], f: f64) -> f64 {
    let (mut peak, mut place) = (0.0, 0.0);
    for (j, &here) in shape.iter().enumerate() {
        if here >= f {
            let below = if j == 0 { 0.0 } else { shape[j - 1] };
            return point_x(j) + (f - below) / (here - below) * (point_x(j + 1) - point_x(j));
        }
        if here > peak {
            (peak, place) = (here, point_x(j + 1));
        }
    }
    place
}

/// c of F_N0/F_N = 1 + b r + c r^2, r = F_T/F_N, which the shear at constant h follows; by its
/// points at 40 % and all of the slip force. The linear part belongs to a sudden shear alone. Not
/// less than half of what it is without that part.
fn shear_coefficient(virgin: &Virgin, friction: f64) -> f64 {
    if !(friction > 0.0) {
        return 0.0;
    }
    let point = &virgin.point;
    let at_slip = (point.f_n0 - point.f_n_slip) / (point.f_n_slip * friction);
    let [f_n, _] = virgin.sheared(friction, given_inverse(&virgin.shapes[0], 0.4));
    let r = 0.4 * friction * point.f_n_slip / f_n;
    let before = (point.f_n0 - f_n) / (f_n * r);
    ((at_slip - before) / (friction - r)).max(0.5 * at_slip / friction).max(0.0)
}
