//! The moduli against central differences of the stress.

use super::*;
use crate::material::{Response, deviatoric_tangent};

const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)];

fn full(a: &[f64; 6]) -> Matrix {
    [[a[0], a[3], a[5]], [a[3], a[1], a[4]], [a[5], a[4], a[2]]]
}

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

/// What symmetrising leaves out of the exact moduli: -mu_bar beta_4 (n (x) dev n^2 - dev n^2 (x) n).
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
