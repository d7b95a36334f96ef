//! What the law is compared with: Jaeger and Ciavarella's solution, which takes the shear for
//! elastic and F_N for constant.
//!
//! F_T = mu \[F_u(h0) - F_u(h0 - d/(mu kappa))\] for the elastic unloading curve F_u from h0. Two
//! curves bracket it: that of a Hertz pressure with the contact's own a0 and F_N0, which is
//! Cattaneo and Mindlin's law, and that of a uniform pressure, the fully plastic limit.

use crate::analytical::mesarovic_johnson::Unloading;
use crate::analytical::{ElasticSphere, hertz, jaeger_ciavarella};
use crate::law::data::Sample;
use crate::law::report::{Candidate, Errors, case_errors};

/// Both baselines with their errors; they have no constants to fit.
pub fn candidates(samples: &[Sample]) -> Vec<Candidate> {
    let row = |name: &str, f_t: &dyn Fn(&Sample, f64) -> f64| Candidate {
        name: name.to_owned(),
        constants: 0,
        errors: Errors::over(&samples.iter().map(|s| case_errors(s, |d| (f_t(s, d), s.f_n0))).collect::<Vec<_>>()),
        kept: false,
    };
    vec![row("Jaeger-Ciavarella, Hertz pressure", &hertzian), row("Jaeger-Ciavarella, uniform pressure", &uniform)]
}

/// F_T with the unloading curve of a Hertz contact of the radius a0 under F_N0: a sphere of the
/// radius 4 E* a0^3/(3 F_N0).
fn hertzian(sample: &Sample, d: f64) -> f64 {
    let sphere = sample.body.sphere;
    let radius = 4.0 * sphere.effective_modulus() * sample.a0.powi(3) / (3.0 * sample.f_n0);
    let flattened = ElasticSphere { radius, ..sphere };
    let recovery = sample.a0 * sample.a0 / radius;
    jaeger_ciavarella::force(&flattened, sample.friction, recovery, |h| hertz::force(&flattened, h), d)
}

/// F_T with Mesarovic and Johnson's unloading curve of a uniform pressure.
fn uniform(sample: &Sample, d: f64) -> f64 {
    let sphere = sample.body.sphere;
    let unloading = Unloading { sphere, indentation: sample.h0, contact_radius: sample.a0, force: sample.f_n0 };
    // As `jaeger_ciavarella::force` with F_u(h), whose closed form in d avoids inverting the curve.
    let slip = jaeger_ciavarella::slip_displacement(&sphere, sample.friction, sample.h0, unloading.lost());
    sample.friction * sample.f_n0 * jaeger_ciavarella::uniform_pressure_ratio(d / slip)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analytical::cattaneo_mindlin;
    use crate::law::formulas::tests::elastic_sample;

    #[test]
    fn a_hertz_pressure_is_cattaneo_and_mindlins() {
        let sample = elastic_sample(0.3);
        let sphere = sample.body.sphere;
        let slip = 1.5 * 0.3 * sample.f_n0 / cattaneo_mindlin::initial_stiffness(&sphere, sample.a0);
        for x in [0.1, 0.5, 0.9, 1.5] {
            let expected = 0.3 * sample.f_n0 * (1.0 - (1.0 - f64::min(x, 1.0)).powf(1.5));
            assert!((hertzian(&sample, x * slip) / expected - 1.0).abs() < 1e-9, "{x}");
        }
        assert!((uniform(&sample, 10.0 * slip) / (0.3 * sample.f_n0) - 1.0).abs() < 1e-12);
        let table = candidates(&[sample]);
        assert!(table[0].errors.f_t_max < 1e-9 && table[1].errors.f_t_max > 0.02, "{table:?}");
    }
}
