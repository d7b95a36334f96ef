//! The laws one by one: stress, slope, work, the scalar return, and what the constructors refuse.

use super::*;
use crate::material::MaterialError;

const STRAINS: [f64; 8] = [1e-8, 1e-5, 1e-3, 4e-3, 0.03, 0.1, 0.5, 2.0];

#[test]
fn stresses_are_the_formulas() {
    let at = |law: &FlowStress<f64>, alpha: f64| law.flow_stress(alpha);
    let close = |x: f64, y: f64| assert!((x / y - 1.0).abs() < 1e-14, "{x} {y}");
    close(at(&FlowStress::ideal(2e-3).unwrap(), 0.7), 2e-3);
    close(at(&FlowStress::linear(2e-3, 0.05).unwrap(), 0.7), 0.037);
    close(at(&FlowStress::power(2e-3, 5e-3, 0.5).unwrap(), 0.25), 4.5e-3);
    close(at(&FlowStress::voce(2e-3, 5e-3, 20.0).unwrap(), 0.1), 5e-3 - 3e-3 * (-2.0_f64).exp());
    let table = FlowStress::table(&[[0.0, 2e-3], [0.1, 3e-3], [0.2, 3.5e-3]]).unwrap();
    for (alpha, stress) in [(0.0, 2e-3), (0.05, 2.5e-3), (0.1, 3e-3), (0.15, 3.25e-3), (0.2, 3.5e-3), (9.0, 3.5e-3)] {
        close(at(&table, alpha), stress);
    }
    assert_eq!(at(&FlowStress::Elastic, 0.3), f64::INFINITY);
}

#[test]
fn hollomon_starts_on_hookes_line_and_follows_the_total_strain() {
    for (coefficient, m) in [(0.02, 3.0), (5e-3, 10.0), (0.1, 1.5), (3e-3, 40.0)] {
        let law = FlowStress::<f64>::hollomon(coefficient, m, 1.0).unwrap();
        let yield_stress = law.flow_stress(0.0);
        let formula = coefficient.powf(m).powf(1.0 / (m - 1.0));
        assert!((yield_stress / formula - 1.0).abs() < 1e-12);
        for alpha in STRAINS {
            let stress = law.flow_stress(alpha);
            let expected = coefficient * (alpha + stress).powf(1.0 / m);
            assert!((stress / expected - 1.0).abs() < 1e-14, "{m} {alpha}: {stress} {expected}");
        }
    }
    // Stresses in other units: E = 200 GPa in MPa.
    let scaled = FlowStress::<f64>::hollomon(0.005, 5.0, 1.0).unwrap();
    let raw = FlowStress::<f64>::hollomon(1000.0, 5.0, 200e3).unwrap();
    assert!((raw.flow_stress(0.1) / (200e3 * scaled.flow_stress(0.1)) - 1.0).abs() < 1e-14);
}

#[test]
fn slope_and_work_are_derivative_and_integral() {
    for (name, law) in laws::<f64>().into_iter().skip(1) {
        for alpha in STRAINS {
            if name == "table" && [0.01, 0.05, 0.3].contains(&alpha) {
                continue;
            }
            let e = 1e-4 * alpha;
            let numeric = (law.flow_stress(alpha + e) - law.flow_stress(alpha - e)) / (2.0 * e);
            let slope = law.slope(alpha, law.flow_stress(alpha));
            let tolerance = 1e-6 * slope + 1e-15 / e;
            assert!((slope - numeric).abs() < tolerance, "{name} {alpha}: slope {slope:e} {numeric:e}");
            // alpha = end t^10 takes the infinite slope of a power law out; the kinks of the table
            // leave O(1/n^2).
            let n = 20_000;
            let integral: f64 = (0..n)
                .map(|i| {
                    let t = (f64::from(i) + 0.5) / f64::from(n);
                    law.flow_stress(alpha * t.powi(10)) * alpha * 10.0 * t.powi(9) / f64::from(n)
                })
                .sum();
            let work = law.plastic_work(alpha, law.flow_stress(alpha));
            assert!((work - integral).abs() < 1e-7 * integral, "{name} {alpha}: work {work:e} {integral:e}");
        }
        assert_eq!(law.plastic_work(0.0, law.flow_stress(0.0)), 0.0, "{name}");
    }
}

#[test]
fn the_scalar_return_leaves_no_residual() {
    for (name, law) in laws::<f64>().into_iter().skip(1) {
        for alpha in [0.0, 1e-30, 1e-12, 1e-6, 1e-3, 0.01, 0.05, 0.29999, 1.0] {
            for excess in [1e-15, 1e-10, 1e-6, 1e-4, 1e-3, 0.1, 1.0, 50.0] {
                let flow = law.flow_stress(alpha);
                let (trial, stiffness) = (flow + excess, 1.2);
                let step = law.plastic_strain_increment(alpha, flow, trial, stiffness);
                let context = format!("{name} alpha {alpha:e} excess {excess:e}: {step:?}");
                assert!(step.increment >= 0.0 && step.increment.is_finite() && !step.slope.is_nan(), "{context}");
                let residual = trial - step.flow_stress - stiffness * step.increment;
                assert!(residual.abs() < 4e-16 * trial + 4e-16 * stiffness * alpha, "{context}: {residual:e}");
                let end = alpha + step.increment;
                // What one rounding of alpha is worth in stress.
                let rounding = 4e-16 * (flow + trial) + 4e-16 * end * step.slope.min(1e300);
                let off = law.flow_stress(end) - step.flow_stress;
                assert!(off.abs() < 2.0 * rounding, "{context}: {off:e}");
            }
        }
    }
}

#[test]
fn a_table_return_stops_at_and_crosses_kinks() {
    let law = FlowStress::<f64>::table(&[[0.0, 2.0], [0.1, 3.0], [0.2, 3.5], [0.3, 3.5]]).unwrap();
    // To the middle of the second segment from the first: 3.25 = trial - 10 (0.15 - 0.05).
    let step = law.plastic_strain_increment(0.05, 2.5, 4.25, 10.0);
    assert!((step.increment - 0.1).abs() < 1e-15 && (step.flow_stress - 3.25).abs() < 1e-15);
    assert!((step.slope - 5.0).abs() < 1e-14);
    // Exactly onto a kink, and beyond the last point.
    let step = law.plastic_strain_increment(0.0, 2.0, 4.0, 10.0);
    assert!((step.increment - 0.1).abs() < 1e-15 && (step.flow_stress - 3.0).abs() < 1e-15);
    let step = law.plastic_strain_increment(0.0, 2.0, 13.5, 10.0);
    assert!((step.increment - 1.0).abs() < 1e-14 && step.flow_stress == 3.5 && step.slope == 0.0);
}

#[test]
fn constructors_refuse_what_is_no_law() {
    let parameter = |law: Result<FlowStress<f64>, MaterialError>, name: &str| match law {
        Err(MaterialError::Parameter { parameter, .. }) => assert_eq!(parameter, name),
        other => panic!("{other:?}"),
    };
    parameter(FlowStress::ideal(0.0), "yield_stress");
    parameter(FlowStress::ideal(f64::NAN), "yield_stress");
    parameter(FlowStress::linear(1.0, -0.1), "modulus");
    parameter(FlowStress::power(1.0, -1.0, 0.5), "coefficient");
    parameter(FlowStress::power(1.0, 1.0, 0.0), "exponent");
    parameter(FlowStress::power(1.0, 1.0, 1.1), "exponent");
    parameter(FlowStress::power(1.0, 1.0, f64::NAN), "exponent");
    parameter(FlowStress::hollomon(1.0, 1.0, 1.0), "exponent");
    parameter(FlowStress::hollomon(-1.0, 3.0, 1.0), "coefficient");
    parameter(FlowStress::voce(2.0, 1.0, 1.0), "saturation_stress");
    parameter(FlowStress::voce(2.0, 3.0, 0.0), "rate");
    let point = |points: &[[f64; 2]], at: usize| match FlowStress::<f64>::table(points) {
        Err(MaterialError::Table { index, .. }) => assert_eq!(index, at),
        other => panic!("{other:?}"),
    };
    point(&[], 0);
    point(&[[0.1, 1.0]], 0);
    point(&[[0.0, 1.0], [0.0, 2.0]], 1);
    point(&[[0.0, 1.0], [0.1, 0.9]], 1);
    point(&[[0.0, 1.0], [0.1, f64::INFINITY]], 1);
    point(&[[0.0, -1.0]], 0);
    // The message names law, key, value and remedy.
    let message = FlowStress::<f64>::linear(1.0, -0.1).unwrap_err().to_string();
    assert!(message.contains("linear") && message.contains("modulus = -0.1") && message.contains("0 or more"), "{message}");
}
