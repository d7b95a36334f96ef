//! A seeded random sweep over laws, states and steps of every size.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::material::j2::norm_squared;
use crate::material::{PointError, deviatoric_tangent, return_mapping};

#[test]
fn random_histories_keep_every_invariant() {
    let mut random = ChaCha8Rng::seed_from_u64(20_261_121);
    let mut counts = [0_usize; 3];
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let mu = material.elasticity.shear;
        for history in 0..400 {
            let mut state = PointState::default();
            for step in 0..25 {
                let size = 10.0_f64.powf(random.random_range(-7.0..0.0));
                let d: Matrix = std::array::from_fn(|_| std::array::from_fn(|_| size * random.random_range(-1.0..1.0)));
                let jacobian = 1.0 + crate::material::j2::determinant_minus_one(&d);
                let context = format!("{name} history {history} step {step} size {size:e}");
                let response = match return_mapping(&material, &d, &state) {
                    Ok(response) => response,
                    Err(error) => {
                        assert_eq!(error, PointError::Inverted { jacobian }, "{context}");
                        assert!(jacobian <= 0.0, "{context}");
                        counts[0] += 1;
                        continue;
                    }
                };
                let flow = material.hardening.flow_stress(response.state.alpha);
                let stress = von_mises(&response.stress);
                assert!(stress <= flow * (1.0 + 1e-13), "{context}: {stress} {flow}");
                if response.yielding {
                    counts[1] += 1;
                    assert!((stress / flow - 1.0).abs() < 1e-13, "{context}: {stress} {flow}");
                    assert!(determinant_excess(&response.state.be).abs() < 1e-14, "{context}");
                    assert!(response.state.alpha >= state.alpha && response.plastic_work >= 0.0, "{context}");
                    // Radial: the stress keeps the direction of the trial.
                    let scale = norm_squared(&response.stress).sqrt();
                    assert!(distance(&response.stress, &response.normal.map(|n| scale * n)) < 1e-14 * scale, "{context}");
                    // |s_trial| - |s| = 2 mu_bar delta_gamma.
                    let gap = response.norm - scale - 2.0 * response.mu_bar * response.delta_gamma;
                    assert!(gap.abs() < 1e-14 * (response.norm + response.mu_bar * state.alpha), "{context}: {gap:e}");
                } else {
                    counts[2] += 1;
                    assert_eq!(response.state.alpha, state.alpha, "{context}");
                }
                let trace: f64 = response.stress[..3].iter().sum();
                assert!(trace.abs() < 1e-14 * (mu + stress), "{context}");
                for row in deviatoric_tangent(&response) {
                    assert!(row.iter().all(|x| x.is_finite()), "{context}");
                }
                if name != "elastic" || stress < 5.0 {
                    state = response.state;
                }
            }
        }
    }
    // All three ways through the code were taken, often.
    assert!(counts.iter().all(|&n| n > 200), "{counts:?}");
}
