//! Eight points side by side have the bits that each has alone.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;
use crate::lanes::Lanes;
use crate::material::{PointError, Response, deviatoric_tangent, return_mapping, return_mapping_of_eight};

/// Every number of an answer and its tangent, by their bits.
fn bits(response: &Response<f64>) -> Vec<u64> {
    let r = response;
    let one = [r.state.alpha, r.mu_bar, r.norm, r.beta_1, r.beta_3, r.beta_4, r.delta_gamma, r.plastic_work];
    let tangent = deviatoric_tangent(response);
    let all = one.iter().chain(&r.stress).chain(&r.state.be).chain(&r.normal).chain(tangent.as_flattened());
    all.map(|x| x.to_bits()).chain([u64::from(r.yielding)]).collect()
}

fn side_by_side(d: &[Matrix; 8]) -> [[Lanes<f64>; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|k| Lanes::from_fn(|q| d[q][i][k])))
}

#[test]
fn eight_side_by_side_have_the_bits_of_each_alone() {
    let mut random = ChaCha8Rng::seed_from_u64(8);
    // elastic, yielding, refused points, and groups that are both elastic and yielding
    let mut counts = [0; 4];
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let mut states = [PointState::default(); 8];
        for group in 0..1500 {
            let around = random.random_range(-6.0..-0.2);
            let d: [Matrix; 8] = std::array::from_fn(|_| {
                let size = 10.0_f64.powf(around + random.random_range(-0.5..0.5));
                std::array::from_fn(|_| std::array::from_fn(|_| size * random.random_range(-1.0..1.0)))
            });
            let alone: Vec<_> = (0..8).map(|q| return_mapping(&material, &d[q], &states[q])).collect();
            let together = return_mapping_of_eight(&material, &side_by_side(&d), &PointState::of_eight(&states));
            let first_refused = alone.iter().position(Result::is_err);
            match together {
                Err((q, error)) => {
                    assert_eq!((Some(q), Some(&error)), (first_refused, alone[q].as_ref().err()), "{name} {group}");
                    counts[2] += 1;
                }
                Ok(together) => {
                    assert_eq!(first_refused, None, "{name} {group}");
                    let tangents = deviatoric_tangent(&together);
                    let alone: Vec<_> = alone.into_iter().map(Result::unwrap).collect();
                    for (q, alone) in alone.iter().enumerate() {
                        assert_eq!(bits(&together.point(q)), bits(alone), "{name} group {group} point {q}");
                        let tangent = tangents.map(|row| row.map(|c| c.0[q].to_bits()));
                        assert_eq!(tangent, deviatoric_tangent(alone).map(|row| row.map(f64::to_bits)), "{name} {group} {q}");
                        counts[usize::from(alone.yielding)] += 1;
                    }
                    counts[3] += usize::from(alone.iter().any(|r| r.yielding) && alone.iter().any(|r| !r.yielding));
                    states = std::array::from_fn(|q| alone[q].state);
                }
            }
        }
    }
    assert!(counts.iter().all(|&n| n > 200), "{counts:?}");
}

#[test]
fn a_point_that_is_refused_is_named() {
    let material = material(FlowStress::linear(2e-3, 0.05).unwrap());
    for (bad, error) in [(f64::NAN, PointError::NotFinite), (-2.0, PointError::Inverted { jacobian: -1.0 })] {
        for q in 0..8 {
            let mut d = [[[1e-2, 0.0, 0.0], [0.0; 3], [0.0; 3]]; 8];
            d[q][0][0] = bad;
            let answer =
                return_mapping_of_eight(&material, &side_by_side(&d), &PointState::of_eight(&[PointState::default(); 8]));
            assert_eq!(answer, Err((q, error)), "{bad} at {q}");
        }
    }
    // A hardening variable that is no number matters where something flows, and there alone.
    let material = super::material(FlowStress::ideal(2e-3).unwrap());
    let mut states = [PointState::default(); 8];
    states[5].alpha = f64::NAN;
    let mut d = [[[1e-2, 0.0, 0.0], [0.0; 3], [0.0; 3]]; 8];
    d[5][0][0] = 1e-4;
    assert!(return_mapping_of_eight(&material, &side_by_side(&d), &PointState::of_eight(&states)).is_ok());
    d[5][0][0] = 1e-2;
    let answer = return_mapping_of_eight(&material, &side_by_side(&d), &PointState::of_eight(&states));
    assert_eq!(answer, Err((5, PointError::NotFinite)));
}
