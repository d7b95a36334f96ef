//! Elastic-plastic normal contact without hardening: Jackson & Green, *J. Tribology* 127 (2005)
//! 343-354.
//!
//! In omega* = h/h_c (see [`yielding`]). Fitted for 1.9 < omega* < 1000 and a/R <= 0.41; Hertz
//! below 1.9, where the force jumps by half a per cent and the area is continuous.

use super::{ElasticSphere, yielding};
use std::f64::consts::PI;

/// omega* up to which the contact is Hertz's.
pub const ELASTIC_LIMIT: f64 = 1.9;

/// The model for one sphere and one yield stress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JacksonGreen {
    /// The sphere.
    pub sphere: ElasticSphere,
    /// Yield stress sigma_Y.
    pub yield_stress: f64,
}

impl JacksonGreen {
    /// C = 1.295 exp(0.736 nu), the fit that belongs to the model.
    pub fn constant(&self) -> f64 {
        yielding::jackson_green_constant(self.sphere.poissons_ratio)
    }

    /// omega* = h/h_c.
    pub fn interference(&self, h: f64) -> f64 {
        h / yielding::critical_indentation(&self.sphere, self.yield_stress, self.constant())
    }

    /// Contact area: A/A_c = omega* (omega*/1.9)^B with B = 0.14 exp(23 sigma_Y/E*); omega* below
    /// 1.9.
    pub fn area(&self, h: f64) -> f64 {
        let omega = self.interference(h.max(0.0));
        let b = 0.14 * (23.0 * self.yield_stress / self.sphere.effective_modulus()).exp();
        let growth = if omega > ELASTIC_LIMIT { (omega / ELASTIC_LIMIT).powf(b) } else { 1.0 };
        omega * growth * yielding::critical_area(&self.sphere, self.yield_stress, self.constant())
    }

    /// Contact radius sqrt(A/pi).
    pub fn contact_radius(&self, h: f64) -> f64 {
        (self.area(h) / PI).sqrt()
    }

    /// Limiting mean pressure over yield stress, H_G/sigma_Y = 2.84 [1 - exp(-0.82 (a/R)^-0.7)].
    pub fn hardness_ratio(&self, a: f64) -> f64 {
        2.84 * (1.0 - (-0.82 * (a / self.sphere.radius).powf(-0.7)).exp())
    }

    /// Normal force: F/F_c = exp(-omega*^(5/12)/4) omega*^1.5 + (4 H_G/(C sigma_Y)) (1 -
    /// exp(-omega*^(5/9)/25)) omega*; omega*^1.5 below 1.9.
    pub fn force(&self, h: f64) -> f64 {
        let omega = self.interference(h.max(0.0));
        let elastic = omega.powf(1.5);
        let ratio = if omega <= ELASTIC_LIMIT {
            elastic
        } else {
            let plastic = 4.0 * self.hardness_ratio(self.contact_radius(h)) / self.constant();
            (-0.25 * omega.powf(5.0 / 12.0)).exp() * elastic + plastic * (1.0 - (-omega.powf(5.0 / 9.0) / 25.0).exp()) * omega
        };
        ratio * yielding::critical_force(&self.sphere, self.yield_stress, self.constant())
    }
}

#[cfg(test)]
mod tests {
    use super::super::kogut_etsion::KogutEtsion;
    use super::super::olsson_larsson::{OlssonLarsson, OlssonLarssonHardening};
    use super::super::{bisect, hertz, johnson};
    use super::*;

    const STEEL: ElasticSphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };

    fn h_c(model: &JacksonGreen) -> f64 {
        1.0 / model.interference(1.0)
    }

    #[test]
    fn hertz_below_and_continuous_at_the_limit() {
        let model = JacksonGreen { sphere: STEEL, yield_stress: 400.0 };
        let limit = ELASTIC_LIMIT * h_c(&model);
        assert!((model.force(limit) / hertz::force(&STEEL, limit) - 1.0).abs() < 1e-12);
        let (below, above) = (limit * (1.0 - 1e-9), limit * (1.0 + 1e-9));
        assert!((model.area(above) / model.area(below) - 1.0).abs() < 1e-7);
        let jump = model.force(above) / model.force(below) - 1.0;
        assert!(jump.abs() < 6e-3, "{jump}");
    }

    #[test]
    fn large_deformation_hardness_in_its_bands() {
        let model = JacksonGreen { sphere: STEEL, yield_stress: 400.0 };
        for (radius, low, high) in [(0.1, 2.71, 2.89), (0.2, 2.60, 2.66), (0.3, 2.37, 2.46), (0.4, 2.15, 2.24)] {
            let hardness = model.hardness_ratio(radius);
            assert!(hardness > low - 0.06 && hardness < high + 0.06, "a/R = {radius}: {hardness}");
        }
    }

    #[test]
    fn the_three_models_agree_in_their_band() {
        // At equal Lambda and a small a/R, so that no large-deformation effect enters; differences
        // from Olsson & Larsson.
        let yield_stress = 40.0;
        let green = JacksonGreen { sphere: STEEL, yield_stress };
        let etsion = KogutEtsion { sphere: STEEL, yield_stress };
        let larsson = OlssonLarsson { sphere: STEEL, hardening: OlssonLarssonHardening::Ideal { yield_stress } };
        let difference = |a: f64, radius: &dyn Fn(f64) -> f64, force: &dyn Fn(f64) -> f64| {
            let h = bisect(0.3 * a * a, 2.0 * a * a, |h| radius(h) - a);
            let hardness = johnson::normalized_hardness(force(h), yield_stress, a) / larsson.normalized_hardness(a) - 1.0;
            (hardness.abs(), (0.5 * a * a / h / larsson.c_squared(a) - 1.0).abs())
        };
        let greatest = |x: (f64, f64), y: (f64, f64)| (x.0.max(y.0), x.1.max(y.1));
        let (mut with_green, mut with_etsion, mut etsion_at_yield) = ((0.0, 0.0), (0.0, 0.0), (0.0, 0.0));
        for i in 0..=400 {
            let lambda = 0.5 * 260f64.powf(i as f64 / 400.0);
            let a = lambda * yield_stress / STEEL.effective_modulus();
            with_green = greatest(with_green, difference(a, &|h| green.contact_radius(h), &|h| green.force(h)));
            let now = difference(a, &|h| etsion.contact_radius(h), &|h| etsion.force(h));
            match lambda {
                ..5.5 => etsion_at_yield = greatest(etsion_at_yield, now),
                5.5..35.0 => with_etsion = greatest(with_etsion, now), // omega* < 110
                _ => {}
            }
        }
        println!(
            "Hbar, c^2: Jackson-Green {with_green:.3?}, Kogut-Etsion {with_etsion:.3?}, around first yield {etsion_at_yield:.3?}"
        );
        assert!(with_green.0 < 0.065 && with_green.1 < 0.085, "{with_green:?}");
        assert!(with_etsion.0 < 0.065 && with_etsion.1 < 0.08, "{with_etsion:?}");
        // Kogut & Etsion's pieces do not meet: there they are off by more than the band.
        assert!(etsion_at_yield.0 > 0.06 && etsion_at_yield.0 < 0.16 && etsion_at_yield.1 < 0.1, "{etsion_at_yield:?}");
    }
}
