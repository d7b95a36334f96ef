//! Tests of the room as a whole; helpers that its files share.

use crate::analytical::cattaneo_mindlin::CattaneoMindlin;
use crate::case;
use crate::law::data::{Sample, ShearPoint};
use crate::law::variables::Body;

/// A sample of an elastic sphere that follows Cattaneo and Mindlin exactly.
pub(in crate::law) fn elastic_sample(friction: f64) -> Sample {
    let material = case::Material { youngs_modulus: 200e3, poissons_ratio: 0.3, hardening: case::Hardening::Elastic };
    let body = Body::new(1.0, &material).unwrap();
    let h0 = 1e-4;
    let contact = CattaneoMindlin::at_indentation(body.sphere, friction, h0);
    let curve = (0..=20)
        .map(|i| contact.slip_displacement() * f64::from(i) / 20.0)
        .map(|delta_t| ShearPoint { delta_t, f_t: contact.force(delta_t), f_n: contact.normal_force })
        .collect();
    let variables = body.variables(h0, contact.contact_radius, contact.normal_force);
    Sample {
        id: "c0000".to_owned(),
        body,
        material: 0,
        friction,
        h0,
        a0: contact.contact_radius,
        f_n0: contact.normal_force,
        f_n_slip: contact.normal_force,
        k_t0: contact.initial_stiffness(),
        delta_t_slip: contact.slip_displacement(),
        variables,
        curve,
        elements_per_contact_radius: 16,
        is_raw: false,
    }
}

mod limits {
    use super::super::model::{Axisymmetric, Parameters, contact, forces};
    use super::super::shear::ShearConstants;
    use super::*;
    use crate::analytical::hertz;
    use crate::law::variables::{Body, yield_lambda};

    fn constants() -> ShearConstants {
        ShearConstants {
            fall: [1.2, 1.8, 0.4, 1.2, 2.0, 0.3],
            exponent: [30.0, 1.3, 2.0, 1.5, 0.7, 1.5],
            slip: [1.1, 0.3, 1.0, 1.0],
            curve: [0.4, 0.35, 0.5, 0.8],
        }
    }

    /// An ideally plastic contact, at a given Lambda, with plausible normal data that are Hertz's
    /// at first yield.
    fn at(lambda: f64, friction: f64) -> Axisymmetric {
        let stress = 400.0;
        let material = case::Material {
            youngs_modulus: 200e3,
            poissons_ratio: 0.3,
            hardening: case::Hardening::Ideal { yield_stress: stress },
        };
        let body = Body::new(3.0, &material).unwrap();
        let a = lambda * stress * 3.0 / body.sphere.effective_modulus();
        let plastic = (lambda / yield_lambda(0.3)).ln().max(0.0);
        let h = a * a / 3.0 / (1.0 + 0.2 * plastic);
        Axisymmetric {
            youngs_modulus: 200e3,
            poissons_ratio: 0.3,
            radius: 3.0,
            friction,
            sigma_rep: stress,
            h,
            a,
            f_n: hertz::force_from_radius(&body.sphere, a) / (1.0 + 0.5 * plastic * plastic),
        }
    }

    #[test]
    fn below_yield_it_is_cattaneo_and_mindlin_and_the_compliance_of_the_body() {
        for (lambda, friction) in [(0.1, 0.1), (2.5, 0.3), (2.532, 0.8)] {
            let inputs = at(lambda, friction);
            let p = contact(&constants(), &inputs);
            let exact = CattaneoMindlin::at_indentation(inputs.sphere(), friction, inputs.h);
            assert_eq!((p.n, p.f_n_slip, p.f_n0), (1.5, inputs.f_n, inputs.f_n));
            let compliance = 1.0 + constants().slip[0] * inputs.a / inputs.radius;
            assert!((p.delta_t_end / exact.slip_displacement() / compliance - 1.0).abs() < 1e-13);
            assert!((p.k_t0 / exact.initial_stiffness() * compliance - 1.0).abs() < 1e-13);
            for x in [-2.0, -0.5, 0.0, 0.3, 0.99, 1.0, 4.0] {
                let (f_t, f_n) = forces(&p, friction, x * p.delta_t_end);
                assert!((f_t - exact.force(x * exact.slip_displacement())).abs() < 1e-12 * inputs.f_n);
                assert_eq!(f_n, inputs.f_n);
            }
        }
        // In the limit of a half-space it is theirs exactly.
        let small = at(1e-13, 0.3);
        let exact = CattaneoMindlin::at_indentation(small.sphere(), 0.3, small.h);
        assert!((contact(&constants(), &small).delta_t_end / exact.slip_displacement() - 1.0).abs() < 1e-13);
        // And for a sphere that never yields.
        let elastic = Axisymmetric { sigma_rep: f64::INFINITY, ..at(50.0, 0.3) };
        assert_eq!(contact(&constants(), &elastic).n, 1.5);
    }

    #[test]
    fn the_elastic_limit_is_reached_without_a_jump() {
        let yielding = yield_lambda(0.3);
        let (below, above) =
            (contact(&constants(), &at(yielding, 0.3)), contact(&constants(), &at(yielding * (1.0 + 1e-9), 0.3)));
        let pairs = |p: &Parameters| [p.f_n_slip / p.f_n0, p.delta_t_end / p.f_n0, p.k_t0, p.n, p.m_exponent, p.n_exponent];
        for (below, above) in pairs(&below).into_iter().zip(pairs(&above)) {
            assert!((above / below - 1.0).abs() < 1e-5, "{below} and {above}");
        }
    }

    #[test]
    fn smooth_monotone_and_bounded_beyond() {
        let mut last: Option<Parameters> = None;
        for i in 0..400 {
            let lambda = 1.0 * (f64::from(i) * 0.02).exp();
            let inputs = at(lambda, 0.5);
            let p = contact(&constants(), &inputs);
            let share = p.f_n_slip / p.f_n0;
            assert!(share > 0.0 && share <= 1.0 && p.n >= 1.5 && p.n <= 10.0 && p.delta_t_end > 0.0, "{p:?}");
            assert!(p.m_exponent >= 1.0 && p.n_exponent >= 1.0);
            assert!((p.k_t0 - p.n * 0.5 * p.f_n_slip / p.delta_t_end).abs() < 1e-12 * p.k_t0);
            if let Some(last) = last {
                // Both turn where the contact is large: these contacts grow with Lambda.
                assert!(lambda > 100.0 || share <= last.f_n_slip / last.f_n0 + 1e-12, "at {lambda}");
                assert!(lambda > 100.0 || p.n >= last.n - 1e-12, "at {lambda}");
            }
            last = Some(p);
        }
    }

    #[test]
    fn symmetry_and_a_monotone_approach_to_full_slip() {
        let inputs = at(60.0, 0.4);
        let p = contact(&constants(), &inputs);
        let mut last = (0.0, inputs.f_n);
        for i in 0..=300 {
            let d = p.delta_t_end * f64::from(i) / 250.0;
            let (f_t, f_n) = forces(&p, 0.4, d);
            let (back_t, back_n) = forces(&p, 0.4, -d);
            assert_eq!((back_t, back_n), (0.0 - f_t, f_n));
            assert!(f_t >= last.0 && f_n <= last.1 && f_t <= 0.4 * f_n * (1.0 + 1e-12), "x = {}", d / p.delta_t_end);
            last = (f_t, f_n);
        }
        assert!((last.0 / (0.4 * p.f_n_slip) - 1.0).abs() < 1e-14 && last.1 == p.f_n_slip);
    }

    #[test]
    fn units_do_not_matter() {
        let inputs = at(40.0, 0.3);
        let (length, stress) = (1e-3, 1e6);
        let other = Axisymmetric {
            youngs_modulus: inputs.youngs_modulus * stress,
            radius: inputs.radius * length,
            sigma_rep: inputs.sigma_rep * stress,
            h: inputs.h * length,
            a: inputs.a * length,
            f_n: inputs.f_n * stress * length * length,
            ..inputs
        };
        let (p, q) = (contact(&constants(), &inputs), contact(&constants(), &other));
        assert!((q.delta_t_end / length / p.delta_t_end - 1.0).abs() < 1e-12 && (q.n / p.n - 1.0).abs() < 1e-12);
    }

    #[test]
    fn nothing_is_pressed_nothing_breaks() {
        for inputs in [
            Axisymmetric { f_n: 0.0, ..at(30.0, 0.3) },
            Axisymmetric { h: 0.0, a: 0.0, f_n: 0.0, ..at(30.0, 0.3) },
            Axisymmetric { friction: 0.0, ..at(30.0, 0.3) },
        ] {
            let p = contact(&constants(), &inputs);
            let (f_t, f_n) = forces(&p, inputs.friction, 1e-3);
            assert!(f_t.is_finite() && f_n.is_finite() && p.k_t0.is_finite() && f_t == 0.0, "{p:?}");
        }
    }
}
