//! What must not change: objectivity, det b_e_bar = 1, the yield surface, and the refusal of
//! impossible deformations.

use super::*;
use crate::material::{PointError, elastic_energy_deviatoric, return_mapping};

fn minus_identity(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| a[i][k] - IDENTITY[i][k]))
}

fn plus_identity(a: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| a[i][k] + IDENTITY[i][k]))
}

fn rotated(q: &Matrix, a: &[f64; 6]) -> [f64; 6] {
    symmetric(&multiply(&multiply(q, &full(a)), &transpose(q)))
}

const STEP: Matrix = [[0.02, 0.05, -0.01], [0.01, -0.03, 0.02], [0.015, -0.02, 0.025]];

#[test]
fn superposed_rotations_turn_stress_and_state() {
    let first = rotation([1.0, 2.0, -1.0], 0.7);
    let second = rotation([0.3, -1.0, 0.5], 2.1);
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let plain = respond(&material, &STEP, &PointState::default());
        // Q1 before: F_1* = Q1 F_1.
        let turned = respond(&material, &minus_identity(&multiply(&first, &plus_identity(&STEP))), &PointState::default());
        assert!(distance(&turned.stress, &rotated(&first, &plain.stress)) < 1e-14, "{name}");
        assert!(distance(&turned.state.be, &rotated(&first, &plain.state.be)) < 1e-14, "{name}");
        // The next relative deformation, seen by the rotating observer: f* = Q2 f Q1^T.
        let next = respond(&material, &STEP, &plain.state);
        let f = multiply(&multiply(&second, &plus_identity(&STEP)), &transpose(&first));
        let next_turned = respond(&material, &minus_identity(&f), &turned.state);
        assert!(distance(&next_turned.stress, &rotated(&second, &next.stress)) < 1e-14, "{name}");
        assert!((next_turned.state.alpha - next.state.alpha).abs() < 1e-14, "{name}");
        let energy = |r: &crate::material::Response<f64>| elastic_energy_deviatoric(&material.elasticity, &r.state.be);
        assert!((energy(&next_turned) - energy(&next)).abs() < 1e-14, "{name}");
    }
}

#[test]
fn a_pure_rotation_of_a_loaded_point_leaves_alpha() {
    let material = material(FlowStress::linear(2e-3, 0.05).unwrap());
    let loaded = respond(&material, &STEP, &PointState::default());
    let q = rotation([1.0, 1.0, 0.2], 1.3);
    let turned = respond(&material, &minus_identity(&q), &loaded.state);
    assert!(!turned.yielding);
    assert_eq!(turned.state.alpha, loaded.state.alpha);
    assert!(distance(&turned.stress, &rotated(&q, &loaded.stress)) < 1e-15);
}

#[test]
fn ten_thousand_plastic_steps_keep_the_determinant_of_b_e() {
    // A rotating shear, 1e-3 a step: plastic throughout, with every component at work.
    let axis = [0.4, -0.3, 1.0];
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let mut state = PointState::default();
        let (mut plastic, mut worst) = (0, 0.0_f64);
        for step in 0..10_000 {
            let q = rotation(axis, 0.01 * f64::from(step));
            let shear = [[2e-4, 1e-3, 0.0], [0.0, -1e-4, 5e-4], [0.0, 0.0, -1e-4]];
            let d = multiply(&multiply(&q, &shear), &transpose(&q));
            let response = respond(&material, &d, &state);
            plastic += u32::from(response.yielding);
            state = response.state;
            worst = worst.max(determinant_excess(&state.be).abs());
        }
        if name == "elastic" {
            // No return renews the trace here: roundings add up, in proportion to b_e_bar, which is
            // large by now.
            let size = state.be.iter().fold(1.0_f64, |w, x| w.max(x.abs()));
            assert!(worst < 1e-15 * 10_000.0 * size.powi(3), "{worst:e} at {size}");
        } else {
            assert!(plastic > 9_000, "{name}: {plastic}");
            assert!(worst < 3e-16, "{name}: {worst:e}");
        }
    }
}

#[test]
fn yielding_ends_on_the_yield_surface() {
    for (name, hardening) in laws::<f64>().into_iter().skip(1) {
        let material = material(hardening);
        let (mut state, mut work) = (PointState::default(), 0.0);
        for step in 0..20 {
            let response = respond(&material, &STEP, &state);
            assert!(response.yielding, "{name} {step}");
            let flow = material.hardening.flow_stress(response.state.alpha);
            let off = von_mises(&response.stress) / flow - 1.0;
            assert!(off.abs() < 1e-14, "{name} {step}: {off:e}");
            // Plastic work: between the two flow stresses times the increment, and the sum of
            // increments is the law's own.
            let increment = response.state.alpha - state.alpha;
            let least = material.hardening.flow_stress(state.alpha) * increment;
            let slack = 1e-15 * material.hardening.plastic_work(response.state.alpha, flow);
            assert!(response.plastic_work >= least - slack && response.plastic_work <= flow * increment + slack, "{name} {step}");
            work += response.plastic_work;
            let total = material.hardening.plastic_work(response.state.alpha, flow);
            assert!((work / total - 1.0).abs() < 1e-14, "{name} {step}: {work:e} {total:e}");
            // The same deformation again, from the accepted state: nothing happens.
            let again = respond(&material, &[[0.0; 3]; 3], &response.state);
            assert!(!again.yielding && again.state.alpha == response.state.alpha, "{name} {step}");
            assert!(distance(&again.stress, &response.stress) < 1e-16, "{name} {step}");
            state = response.state;
        }
    }
}

#[test]
fn stress_follows_from_the_state() {
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let response = respond(&material, &STEP, &PointState::default());
        let (deviator, _) = crate::material::j2::deviator(&response.state.be);
        assert!(distance(&deviator.map(|x| material.elasticity.shear * x), &response.stress) < 1e-16, "{name}");
    }
}

#[test]
fn impossible_deformations_are_errors() {
    let material = material(FlowStress::ideal(2e-3).unwrap());
    let virgin = PointState::default();
    let flat = [[-1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
    assert_eq!(return_mapping(&material, &flat, &virgin), Err(PointError::Inverted { jacobian: 0.0 }));
    let mirrored = [[-3.0, 0.0, 0.0], [0.0; 3], [0.0; 3]];
    assert_eq!(return_mapping(&material, &mirrored, &virgin), Err(PointError::Inverted { jacobian: -2.0 }));
    for i in 0..3 {
        for k in 0..3 {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e200] {
                let mut d = [[0.01; 3]; 3];
                d[i][k] = bad;
                assert!(return_mapping(&material, &d, &virgin).is_err(), "{bad} at {i}{k}");
                let narrow = d.map(|row| row.map(|x| x as f32));
                let single = super::material(FlowStress::<f32>::ideal(2e-3).unwrap());
                assert!(return_mapping(&single, &narrow, &PointState::default()).is_err(), "f32 {bad} at {i}{k}");
            }
        }
    }
    for a in 0..6 {
        let mut state = virgin;
        state.be[a] = f64::NAN;
        assert_eq!(return_mapping(&material, &STEP, &state), Err(PointError::NotFinite), "{a}");
    }
    // A NaN in alpha must not end as a stress.
    for (name, hardening) in laws::<f64>().into_iter().skip(1) {
        let state = PointState { be: [0.0; 6], alpha: f64::NAN };
        let answer = return_mapping(&super::material(hardening), &STEP, &state);
        assert_eq!(answer, Err(PointError::NotFinite), "{name}");
    }
}
