//! A body of two in series, by what its table says of it: pressed to an h, as one of any radius.

use super::tabulated::yielding_of;
use super::{Curves, Level, Tabulated, straight};
use crate::case::{Hardening, Material};
use crate::contact_law::unloading_exponent;
use crate::law::range::Interval;

/// Least power of a/R with which the mean pressure counts as rising where the two radii are shared
/// out. Of a fully plastic body it stands still or falls, and any radius would do: by this the
/// weaker body has the curvature, and equal ones half of it each. Half and twice of it:
/// `benches/constants`.
const RISING: f64 = 0.1;
/// Share of its mean pressure that a plastic contact loses for a/R, at the same R'. Of simulated
/// pairs at several ratios of the radii (fixtures/studies/ratios.toml, `benches/pairs/ratios.py`):
/// 0.45 to 0.67. Half and twice of it: `benches/constants`.
const CONSTRAINT: f64 = 0.6;
/// Share of its mean pressure that is left at the least, whatever the radii. Half and twice of it:
/// `benches/constants`.
const LEAST: f64 = 0.5;
/// Places of the mean pressure, even in ln h.
const PLACES: usize = 200;

/// One of the two bodies, by what its table says of the half that is its own.
pub(super) struct BodyInSeries {
    pub(super) curves: Curves,
    /// ln h and c of the levels that have one.
    pub(super) yielding: Vec<[f64; 2]>,
    /// Poisson's ratio, and whether the body never yields.
    pub(super) poissons_ratio: f64,
    pub(super) elastic: bool,
    pub(super) range: Interval,
    /// Its part of the table's h and delta_T: half of an equal pair's.
    pub(super) share: f64,
    /// E.
    pub(super) modulus: f64,
    /// E* of the table's contact.
    pub(super) effective_modulus: f64,
    /// 1/R, 0 of a flat, where the constraint is to hang on it.
    pub(super) curvature: Option<f64>,
    /// ln a and ln of the mean pressure, over R and in absolute units, both rising; and what it
    /// would lose to a constraint without R.
    pub(super) pressures: Vec<[f64; 3]>,
}

/// A body pressed on the plane between the two: R' and what it has there, as a force or a length.
#[derive(Clone)]
pub(super) struct PressedBody {
    pub(super) radius: f64,
    /// By how much it gives way.
    pub(super) h: f64,
    pub(super) force: f64,
    pub(super) a: f64,
    /// Stiffness of an unloading; exponent and elastic approach of it.
    pub(super) stiffness: f64,
    pub(super) gamma: f64,
    pub(super) depth: f64,
    pub(super) k_t: f64,
    pub(super) slip: f64,
    pub(super) level: Level,
}

impl BodyInSeries {
    pub(super) fn new(table: &Tabulated, material: &Material, share: f64, curvature: Option<f64>) -> Self {
        let (e, nu) = (material.youngs_modulus, material.poissons_ratio);
        let mut body = Self {
            curves: Curves::new(&table.levels),
            yielding: yielding_of(&table.levels),
            poissons_ratio: nu,
            elastic: matches!(material.hardening, Hardening::Elastic),
            range: table.range,
            share,
            modulus: e,
            effective_modulus: share * e / (1.0 - nu * nu),
            curvature,
            pressures: Vec::new(),
        };
        let (from, to) = (body.range.from.ln(), body.range.to.ln());
        let mut before = [f64::NEG_INFINITY; 3];
        for i in 0..PLACES {
            let place = (from + (to - from) * i as f64 / (PLACES as f64 - 1.0)).exp();
            let [f_n0, a0] = body.curves.normal(place);
            let ln_a = a0.ln().max(before[0]);
            let pressure = (e * f_n0).ln() - 2.0 * a0.ln();
            let rising = if i == 0 { pressure } else { pressure.max(before[1] + RISING * (ln_a - before[0])) };
            before = [ln_a, rising, body.slender(f_n0, a0)];
            body.pressures.push(before);
        }
        body
    }

    /// Whether the two have the same law, at the same constraint.
    pub(super) fn like(&self, other: &Self) -> bool {
        let numbers = |body: &Self| (body.share, body.modulus, body.effective_modulus, body.curvature);
        numbers(self) == numbers(other) && self.curves == other.curves
    }

    /// What the table says at h over R; below its first level the contact is Hertz's.
    pub(super) fn level(&self, h: f64) -> Level {
        let first = self.range.from;
        let mut level = self.curves.at(h.max(first));
        level.yield_coefficient = self.yield_coefficient(h);
        if h < first {
            let ratio = h / first;
            level.h = h;
            level.f_n0 *= ratio.powf(1.5);
            level.delta_t_end *= ratio;
            for length in [&mut level.a0, &mut level.unloading_radius, &mut level.k_t] {
                *length *= ratio.sqrt();
            }
        }
        level
    }

    /// c of an oblique press, d(delta_T)/dh = 2 c r for a small r; of a body that never yields by
    /// Mindlin and Deresiewicz (J. Appl. Mech. 20, 1953), whose F_T/F_N is k_T/k_N times
    /// delta_T/h.
    pub(super) fn yield_coefficient(&self, h: f64) -> Option<f64> {
        let nu = self.poissons_ratio;
        if self.elastic { Some((2.0 - nu) / (4.0 * (1.0 - nu))) } else { straight(&self.yielding, h.ln()) }
    }

    /// What F_N0 of the table loses where the body is more curved than R' by 1/R', as a share: of
    /// a/R' the part that is plastic, by how far F_N0 is below Hertz's at the same a.
    pub(super) fn slender(&self, f_n0: f64, a0: f64) -> f64 {
        let hertz = 4.0 * self.effective_modulus * a0 * a0 * a0 / (3.0 * self.share * self.modulus);
        CONSTRAINT * a0 * (1.0 - f_n0 / hertz).max(0.0)
    }

    /// Share of the table's F_N0 that a body of this R' has for its true radius.
    pub(super) fn constraint(&self, radius: f64, slender: f64) -> f64 {
        self.curvature.map_or(1.0, |own| (1.0 + slender * (1.0 - radius * own)).max(LEAST))
    }

    /// F_N0 of a body of this R' that gives way by `h`.
    pub(super) fn force(&self, radius: f64, h: f64) -> f64 {
        let place = h / (self.share * radius);
        let first = self.range.from;
        let [f_n0, a0] = self.curves.normal(place.max(first));
        let scale = if place < first { (place / first).powf(1.5) } else { self.constraint(radius, self.slender(f_n0, a0)) };
        scale * f_n0 * self.modulus * radius * radius
    }

    pub(super) fn pressed(&self, radius: f64, h: f64) -> PressedBody {
        let level = self.level(h / (self.share * radius));
        let force = self.force(radius, h);
        let unloading = level.unloading_radius * radius;
        let stiffness = 2.0 * self.effective_modulus * unloading / self.share;
        let gamma = unloading_exponent(self.share * radius, self.effective_modulus, unloading, force);
        PressedBody {
            radius,
            h,
            force,
            a: level.a0 * radius,
            stiffness,
            gamma,
            depth: gamma * force / stiffness,
            k_t: level.k_t * self.modulus * radius / self.share,
            slip: level.delta_t_end * radius * self.share,
            level,
        }
    }

    /// Logarithm of the mean pressure of a body of this R' at the contact radius a, rising with
    /// a/R'.
    pub(super) fn pressure(&self, a: f64, radius: f64) -> f64 {
        let ln_a = (a / radius).ln();
        let constrained = |slender: f64| self.constraint(radius, slender).ln();
        let [first, last] = [self.pressures[0], self.pressures[PLACES - 1]];
        if ln_a <= first[0] {
            return first[1] + (ln_a - first[0]);
        }
        if ln_a >= last[0] {
            return last[1] + RISING * (ln_a - last[0]) + constrained(last[2]);
        }
        let i = self.pressures.partition_point(|place| place[0] <= ln_a);
        let ([x0, y0, s0], [x1, y1, s1]) = (self.pressures[i - 1], self.pressures[i]);
        let u = (ln_a - x0) / (x1 - x0);
        y0 + u * (y1 - y0) + constrained(s0 + u * (s1 - s0))
    }
}

impl PressedBody {
    /// By how much its elastic approach is less at the normal force `force` than at F_N0.
    pub(super) fn recovered(&self, force: f64) -> f64 {
        self.depth * (1.0 - (force / self.force).powf(1.0 / self.gamma))
    }

    /// Its deflection at F_T = `ratio` F_N without plastic flow, as on a reversal's curve.
    pub(super) fn elastic(&self, friction: f64, force: f64, ratio: f64) -> f64 {
        let n = self.level.backbone;
        n * friction * force / self.k_t * (1.0 - (1.0 - (ratio / friction).min(1.0)).powf(1.0 / n))
    }
}
