//! Sliders that are driven by hand along one axis.

use super::super::state::ContactState;
use super::super::table::{SLIDERS, WEIGHTS, lost};

/// What the sliders are while they move.
pub(super) struct Slides {
    pub(super) stiff: f64,
    /// mu F_N.
    pub(super) most: f64,
    pub(super) exponent: f64,
    pub(super) radial_most: f64,
}

/// Their forces.
#[derive(Clone, Copy, Default)]
pub(super) struct Driven {
    force: [f64; SLIDERS],
    radial: [f64; SLIDERS],
}

impl Driven {
    /// Those of a contact.
    pub(super) fn of(state: &ContactState) -> Self {
        Self { force: state.slider[0], radial: state.slider[2] }
    }

    /// Moved by d and, radially, by `radial`; and their sum.
    fn moved_with(&self, slides: &Slides, lost: &[f64; SLIDERS], d: f64, radial: f64) -> (Self, f64) {
        let sum: f64 = WEIGHTS.iter().zip(lost).map(|(weight, lost)| weight * (1.0 - lost)).sum();
        let (mut to, mut all) = (Self::default(), 0.0);
        for i in 0..SLIDERS {
            let most = slides.most * WEIGHTS[i] * (1.0 - lost[i]) / sum;
            let mut f = self.force[i] + slides.stiff * WEIGHTS[i] * d;
            let mut g = (self.radial[i] + slides.stiff * WEIGHTS[i] * radial).min(slides.radial_most * most);
            let size = (f * f + g * g).sqrt();
            if size > most {
                f *= most / size;
                g *= most / size;
            }
            (to.force[i], to.radial[i]) = (f, g);
            all += f;
        }
        (to, all)
    }

    /// Moves them by the displacement, up to `most`, that brings them to a force; that
    /// displacement.
    pub(super) fn drive_to(&mut self, slides: &Slides, radial: f64, force: f64, most: f64) -> f64 {
        let lost = lost(slides.exponent);
        let lacks = |d: f64| self.moved_with(slides, &lost, d, radial).1 - force;
        let d = if most > 0.0 && lacks(most) > 0.0 { root(lacks, 0.0, most) } else { most };
        *self = self.moved_with(slides, &lost, d, radial).0;
        d
    }
}

/// Evaluations of a root, at the most.
const MOST: usize = 60;

/// Where an increasing function is zero between two places; the nearer of these, if it is not. By
/// chords that lose half of an end that stays (Illinois).
pub(super) fn root(f: impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let (mut at_low, mut at_high) = (f(low), f(high));
    if !(at_low < 0.0) {
        return low;
    }
    if !(at_high > 0.0) {
        return high;
    }
    let tolerance = 1e-14 * (high - low).abs();
    let mut side = 0;
    for _ in 0..MOST {
        let x = high - at_high * (high - low) / (at_high - at_low);
        let here = f(x);
        if here > 0.0 {
            (high, at_high) = (x, here);
            at_low *= if side == 1 { 0.5 } else { 1.0 };
            side = 1;
        } else {
            (low, at_low) = (x, here);
            at_high *= if side == -1 { 0.5 } else { 1.0 };
            side = -1;
        }
        if here == 0.0 || high - low < tolerance {
            return x;
        }
    }
    0.5 * (low + high)
}
