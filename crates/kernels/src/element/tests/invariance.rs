//! What a superposed rigid motion must not change.

use super::*;

/// u of `x -> Q (X + v) + t`.
fn moved(nodes: &[[f64; 3]; NODES], v: &Nodal<f64>, q: &Matrix, t: [f64; 3]) -> Nodal<f64> {
    std::array::from_fn(|a| {
        let x: [f64; 3] = std::array::from_fn(|i| nodes[a][i] + v[a][i]);
        let y = apply(q, &x);
        std::array::from_fn(|i| y[i] + t[i] - nodes[a][i])
    })
}

#[test]
fn a_rigid_motion_has_no_force() {
    let (nodes, g) = (irregular(), geometry());
    for (angle, t) in [(1e-3, [0.0; 3]), (1.0, [3.0, -2.0, 5.0]), (3.0, [-10.0, 0.3, 0.1])] {
        let u = moved(&nodes, &ZERO, &rotation([1.0, -2.0, 0.5], angle), t);
        for material in [elastic(), hardening()] {
            let f = force(&g, &material, &ElementState::default(), &ZERO, &u);
            assert!(largest(&f) < 1e-14, "angle {angle}: {:e}", largest(&f));
        }
    }
    // A translation loses nothing at all: the gradients sum to zero in each direction up to their
    // rounding.
    let f = force(&g, &elastic(), &ElementState::default(), &ZERO, &[[0.1, -0.2, 0.3]; NODES]);
    assert!(largest(&f) < 1e-16, "{:e}", largest(&f));
}

#[test]
fn forces_turn_with_a_superposed_rotation() {
    let (nodes, g) = (irregular(), geometry());
    for material in [elastic(), hardening()] {
        let (state, committed) = if material.hardening == FlowStress::Elastic {
            let u = wild(2, 0.1);
            (update(&g, &material, &ElementState::default(), &ElementState::default().points, &ZERO, &u).unwrap().0, u)
        } else {
            loaded(&g, &material)
        };
        // From a committed state: on by a step, that step with a rotation by 2 rad on top of it.
        let total = plus(&committed, &wild(5, 0.02), 1.0);
        let q = rotation([0.3, 1.0, -0.7], 2.0);
        let turned = moved(&nodes, &total, &q, [1.0, 2.0, -1.0]);
        let f = force(&g, &material, &state, &committed, &plus(&total, &committed, -1.0));
        let turned_f = force(&g, &material, &state, &committed, &plus(&turned, &committed, -1.0));
        let expected = f.map(|f| apply(&q, &f));
        let difference = largest(&plus(&turned_f, &expected, -1.0));
        assert!(difference < 1e-13 * largest(&f).max(0.1), "{difference:e} of {:e}", largest(&f));
        // The states differ by the rotation alone.
        let a = update(&g, &material, &state, &state.points, &committed, &plus(&total, &committed, -1.0)).unwrap().0;
        let b = update(&g, &material, &state, &state.points, &committed, &plus(&turned, &committed, -1.0)).unwrap().0;
        for (p, r) in a.points.iter().zip(&b.points) {
            assert!((p.alpha - r.alpha).abs() < 1e-14);
        }
        assert!((a.plastic_work - b.plastic_work).abs() < 1e-16);
    }
}

#[test]
fn forces_and_moments_balance() {
    let (nodes, g) = (irregular(), geometry());
    let material = hardening();
    let (state, committed) = loaded(&g, &material);
    let increment = wild(6, 0.01);
    let f = force(&g, &material, &state, &committed, &increment);
    let mut sum = [0.0; 3];
    let mut moment = [0.0; 3];
    for a in 0..NODES {
        let x: [f64; 3] = std::array::from_fn(|i| nodes[a][i] + committed[a][i] + increment[a][i]);
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            sum[i] += f[a][i];
            moment[i] += x[j] * f[a][k] - x[k] * f[a][j];
        }
    }
    for i in 0..3 {
        assert!(sum[i].abs() < 1e-16 && moment[i].abs() < 1e-16, "{sum:?} {moment:?}");
    }
}
