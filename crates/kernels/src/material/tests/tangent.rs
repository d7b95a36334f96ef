//! The moduli against central differences of the stress.

use super::*;
use crate::material::{Response, deviatoric_tangent, elastic_energy_volumetric, pressure};

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

/// (I + e l) (I + d) - I.
fn perturbed(d: &Matrix, l: &Matrix, e: f64) -> Matrix {
    let product = multiply(l, d);
    std::array::from_fn(|i| std::array::from_fn(|k| d[i][k] + e * (l[i][k] + product[i][k])))
}

/// ds/de - l s - s l^T by central differences.
fn lie_derivative(material: &Material<f64>, d: &Matrix, state: &PointState<f64>, l: &Matrix) -> Matrix {
    let e = 1e-6;
    let plus = full(&respond(material, &perturbed(d, l, e), state).stress);
    let minus = full(&respond(material, &perturbed(d, l, -e), state).stress);
    let s = full(&respond(material, d, state).stress);
    let ls = multiply(l, &s);
    std::array::from_fn(|i| std::array::from_fn(|k| (plus[i][k] - minus[i][k]) / (2.0 * e) - ls[i][k] - ls[k][i]))
}

/// What symmetrising leaves out of the exact moduli: -mu_bar beta_4 (n (x) dev n^2 - dev n^2 (x)
/// n).
fn antisymmetric(response: &Response<f64>) -> [[f64; 6]; 6] {
    let n = full(&response.normal);
    let square = multiply(&n, &n);
    let mean = (square[0][0] + square[1][1] + square[2][2]) / 3.0;
    let m: [f64; 6] = std::array::from_fn(|a| square[PAIRS[a].0][PAIRS[a].1] - if a < 3 { mean } else { 0.0 });
    let scale = response.mu_bar * response.beta_4;
    std::array::from_fn(|a| std::array::from_fn(|b| -scale * (response.normal[a] * m[b] - m[a] * response.normal[b])))
}

/// Largest |c d - L_v s| over the six unit rates, and over rigid spin.
fn error(material: &Material<f64>, d: &Matrix, state: &PointState<f64>, exact: bool) -> f64 {
    let response = respond(material, d, state);
    let mut c = deviatoric_tangent(&response);
    for (a, row) in c.iter().enumerate() {
        for (b, entry) in row.iter().enumerate() {
            assert_eq!(entry.to_bits(), c[b][a].to_bits(), "not symmetric at {a}, {b}");
        }
    }
    if exact {
        let extra = antisymmetric(&response);
        for a in 0..6 {
            for b in 0..6 {
                c[a][b] += extra[a][b];
            }
        }
    }
    let mut worst = 0.0_f64;
    for b in 0..6 {
        let (k, l) = PAIRS[b];
        let mut rate = [[0.0; 3]; 3];
        // One component d_kl = d_lk = 1.
        rate[k][l] = 1.0;
        rate[l][k] = 1.0;
        let factor = if b < 3 { 1.0 } else { 2.0 };
        let numeric = lie_derivative(material, d, state, &rate);
        for a in 0..6 {
            worst = worst.max((factor * c[a][b] - numeric[PAIRS[a].0][PAIRS[a].1]).abs());
        }
    }
    for (k, l) in [(0, 1), (1, 2), (2, 0)] {
        let mut spin = [[0.0; 3]; 3];
        spin[k][l] = 1.0;
        spin[l][k] = -1.0;
        let numeric = lie_derivative(material, d, state, &spin);
        worst = numeric.iter().flatten().fold(worst, |w, x| w.max(x.abs()));
    }
    worst
}

#[test]
fn exact_moduli_are_the_derivative() {
    let d = [[0.02, 0.05, -0.01], [0.01, -0.03, 0.02], [0.015, -0.02, 0.025]];
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let first = respond(&material, &d, &PointState::default());
        for state in [PointState::default(), first.state] {
            let e = error(&material, &d, &state, true);
            assert!(e < 2e-8, "{name}: {e:e}");
        }
    }
}

#[test]
fn symmetrised_moduli_differ_by_the_antisymmetric_part_alone() {
    let d = [[0.02, 0.05, -0.01], [0.01, -0.03, 0.02], [0.015, -0.02, 0.025]];
    let material = material(FlowStress::ideal(2e-3).unwrap());
    let response = respond(&material, &d, &PointState::default());
    let difference = error(&material, &d, &PointState::default(), false);
    let antisymmetric = antisymmetric(&response);
    let entries = antisymmetric.iter().flat_map(|row| row.iter().enumerate());
    // Engineering shears double a column.
    let expected = entries.clone().fold(0.0_f64, |w, (b, x)| w.max(if b < 3 { x.abs() } else { 2.0 * x.abs() }));
    assert!((difference - expected).abs() < 2e-8, "{difference:e} {expected:e}");
    // |n| = 1 and |dev n^2| <= 1/sqrt(6): no entry is above mu_bar beta_4/sqrt(6), where beta_4 =
    // O(strain increment).
    let largest = entries.fold(0.0_f64, |w, (_, x)| w.max(x.abs()));
    assert!(
        largest > 1e-4 * response.mu_bar && largest <= response.mu_bar * response.beta_4.abs() / 6.0_f64.sqrt(),
        "{largest:e}"
    );
    // In uniaxial stretch dev n^2 is parallel to n, and the two moduli are one.
    let uniaxial = [[0.05, 0.0, 0.0], [0.0, -0.02, 0.0], [0.0, 0.0, -0.02]];
    assert!(error(&material, &uniaxial, &PointState::default(), false) < 2e-8);
}

#[test]
fn the_virgin_point_has_hookes_moduli() {
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let response = respond(&material, &[[0.0; 3]; 3], &PointState::default());
        assert!(!response.yielding && response.stress == [0.0; 6], "{name}");
        let c = deviatoric_tangent(&response);
        let mu = material.elasticity.shear;
        for (a, row) in c.iter().enumerate() {
            for (b, entry) in row.iter().enumerate() {
                let expected = match (a, b) {
                    _ if a < 3 && b < 3 => 2.0 * mu * (f64::from(u8::from(a == b)) - 1.0 / 3.0),
                    _ if a == b => mu,
                    _ => 0.0,
                };
                assert!((entry - expected).abs() < 1e-15, "{name} {a} {b}");
            }
        }
        let (first, second) = pressure(&material.elasticity, 0.0);
        assert_eq!(first, 0.0);
        assert!((second - material.elasticity.bulk).abs() < 1e-15);
    }
    // kappa and mu themselves, nu = 0.3.
    let elasticity = Elasticity::<f64>::new(200e3, 0.3);
    assert!((elasticity.bulk - 200e3 / 1.2).abs() < 1e-9 && (elasticity.shear - 200e3 / 2.6).abs() < 1e-9);
}

#[test]
fn volumetric_stress_is_the_derivative_of_its_energy() {
    let elasticity = Elasticity::<f64>::new(1.0, 0.3);
    let energy = |j: f64| elastic_energy_volumetric(&elasticity, j);
    for j in [-0.7, -0.21, -0.19, -0.05, 1e-3, 0.1, 0.199, 0.25, 1.5] {
        let e = 1e-6;
        let (first, second) = pressure(&elasticity, j);
        assert!(((energy(j + e) - energy(j - e)) / (2.0 * e) - first).abs() < 1e-9, "U' at {j}");
        let (above, below) = (pressure(&elasticity, j + e).0, pressure(&elasticity, j - e).0);
        assert!(((above - below) / (2.0 * e) - second).abs() < 1e-8, "U'' at {j}");
        let direct = 0.5 * elasticity.bulk * (0.5 * ((1.0 + j) * (1.0 + j) - 1.0) - (1.0 + j).ln());
        assert!((energy(j) - direct).abs() < 1e-14 * (1.0 + direct), "U at {j}");
    }
    // Small volume changes keep their digits: U = kappa/2 j^2 (1 - j/3 + ...).
    for j in [1e-5, -1e-9, 1e-14] {
        let leading = 0.5 * elasticity.bulk * j * j * (1.0 - j / 3.0);
        assert!((energy(j) / leading - 1.0).abs() < 1e-9, "{j}");
        assert!((pressure(&elasticity, j).0 / (elasticity.bulk * j * (1.0 - 0.5 * j)) - 1.0).abs() < 1e-9, "{j}");
    }
}
