//! Single precision against double, and the forms that keep digits near the identity.

use super::*;
use crate::material::j2::{determinant_minus_one, isochoric_factor_minus_one, isochoric_mean};
use crate::material::{deviatoric_tangent, elastic_energy_deviatoric, return_mapping};

/// Worst relative error of f32 (stress, moduli, alpha) after two steps of size `strain`; the inputs
/// are rounded for both.
fn single_precision_error(hardening: (FlowStress<f32>, FlowStress<f64>), strain: f64) -> (f64, f64, f64) {
    let shape = [[0.7, 0.9, -0.3], [0.2, -0.6, 0.5], [0.4, -0.5, 0.3]];
    let d32: [[f32; 3]; 3] = shape.map(|row: [f64; 3]| row.map(|x| (strain * x) as f32));
    let d64: Matrix = d32.map(|row| row.map(f64::from));
    let (single, double) = (material(hardening.0), material(hardening.1));
    let (mut state32, mut state64) = (PointState::default(), PointState::default());
    let (mut stress, mut moduli, mut alpha) = (0.0_f64, 0.0_f64, 0.0_f64);
    for _ in 0..2 {
        let a = return_mapping(&single, &d32, &state32).unwrap();
        let b = return_mapping(&double, &d64, &state64).unwrap();
        let size = b.stress.iter().fold(0.0_f64, |w, x| w.max(x.abs()));
        stress = stress.max(distance(&a.stress.map(f64::from), &b.stress) / size);
        let (c32, c64) = (deviatoric_tangent(&a), deviatoric_tangent(&b));
        for (row32, row64) in c32.iter().zip(&c64) {
            for (x, y) in row32.iter().zip(row64) {
                moduli = moduli.max((f64::from(*x) - y).abs());
            }
        }
        if b.state.alpha > 0.0 {
            alpha = alpha.max((f64::from(a.state.alpha) / b.state.alpha - 1.0).abs());
        }
        (state32, state64) = (a.state, b.state);
    }
    (stress, moduli, alpha)
}

#[test]
fn f32_keeps_six_digits_from_1e_6_to_1e_1() {
    for ((name, single), (_, double)) in laws::<f32>().into_iter().zip(laws::<f64>()) {
        for exponent in -24..=-4 {
            let strain = 10.0_f64.powf(0.25 * f64::from(exponent));
            let (stress, moduli, alpha) = single_precision_error((single.clone(), double.clone()), strain);
            assert!(stress < 1e-6, "{name} at {strain:e}: stress {stress:e}");
            // The moduli have a rounding of their own where the return is steepest.
            assert!(moduli < 4e-6, "{name} at {strain:e}: moduli {moduli:e}");
            // Right at first yield alpha is a difference of two stresses.
            assert!(alpha < 5e-6 || strain < 5e-3 && alpha < 1e-3, "{name} at {strain:e}: alpha {alpha:e}");
        }
    }
}

#[test]
fn isochoric_factor_is_the_power() {
    for exponent in -60..=60 {
        // From 1 + 1e-15 to 1e6 and down to 1e-6.
        for sign in [1.0, -1.0] {
            let j = sign * 10.0_f64.powf(f64::from(exponent) / 4.0);
            if j <= -1.0 + 1e-6 || j > 1e6 {
                continue;
            }
            let expected = (-2.0 / 3.0 * j.ln_1p()).exp_m1();
            let got = isochoric_factor_minus_one(j);
            assert!((got / expected - 1.0).abs() < 2e-15, "{j}: {got} {expected}");
            let single = f64::from(isochoric_factor_minus_one(j as f32));
            let expected = (-2.0 / 3.0 * f64::from(j as f32).ln_1p()).exp_m1();
            assert!((single / expected - 1.0).abs() < 1e-6 || j < -0.99, "f32 {j}: {single} {expected}");
        }
    }
    assert_eq!(isochoric_factor_minus_one(0.0), 0.0);
    assert!((isochoric_factor_minus_one(-1.0 + 1e-6) / 9999.0 - 1.0).abs() < 1e-9);
    assert!((isochoric_factor_minus_one(1e9) + 1.0 - 1e-6).abs() < 1e-15);
}

#[test]
fn determinant_less_one_keeps_small_changes() {
    // An isochoric shear: exactly 0.
    assert_eq!(determinant_minus_one(&[[0.0, 1e-3, 0.0], [0.0; 3], [0.0; 3]]), 0.0);
    let d = [[1e-9, 2e-9, 0.0], [-1e-9, 3e-9, 0.0], [0.0, 0.0, -1e-9]];
    assert!((determinant_minus_one(&d) / (3e-9 + 1e-18) - 1.0).abs() < 1e-9);
    // Against the determinant itself.
    let d = [[0.3, -0.2, 0.5], [0.1, 0.4, -0.3], [-0.6, 0.2, -0.1]];
    let [[a, b, c], [e, f, g], [h, i, j]] = [[1.3, -0.2, 0.5], [0.1, 1.4, -0.3], [-0.6, 0.2, 0.9]];
    let full: f64 = a * (f * j - g * i) - b * (e * j - g * h) + c * (e * i - f * h);
    assert!((determinant_minus_one(&d) - (full - 1.0)).abs() < 1e-15);
}

#[test]
fn the_trace_follows_from_the_deviator() {
    // b = diag(a, a^-1/2, a^-1/2) turned: tr b - 3 in closed form, second order in a - 1.
    let q = rotation([1.0, -0.4, 0.7], 0.9);
    for stretch in [1e-7, 1e-4, 1e-2, 0.3, 3.0, -0.5] {
        let a: f64 = 1.0 + stretch;
        let (axial, lateral) = (stretch, (-0.5 * stretch.ln_1p()).exp_m1());
        let diagonal = [[axial, 0.0, 0.0], [0.0, lateral, 0.0], [0.0, 0.0, lateral]];
        let be = symmetric(&multiply(&multiply(&q, &diagonal), &transpose(&q)));
        let (deviator, mean) = crate::material::j2::deviator(&be);
        // (a - 1) + 2 (a^-1/2 - 1) = (x - 1)^2 (x + 2)/x with x = a^1/2.
        let root = a.sqrt();
        let less_one = stretch / (1.0 + root);
        let expected = less_one * less_one * (root + 2.0) / root / 3.0;
        for guess in [mean, expected * 1.5, 0.5] {
            let u = isochoric_mean(&deviator, guess.max(expected));
            assert!((u / expected - 1.0).abs() < 2e-8, "{stretch}: {u:e} {expected:e}");
        }
        // Energy mu/2 (tr - 3), with full relative digits where summing the diagonal has none.
        let elasticity = Elasticity::<f64>::new(1.0, 0.3);
        let energy = elastic_energy_deviatoric(&elasticity, &be);
        assert!((energy / (1.5 * elasticity.shear * expected) - 1.0).abs() < 2e-8, "{stretch}");
        let single = elastic_energy_deviatoric(&Elasticity::<f32>::new(1.0, 0.3), &be.map(|x| x as f32));
        assert!((f64::from(single) / energy - 1.0).abs() < 2e-6, "f32 {stretch}: {single:e} {energy:e}");
    }
}
