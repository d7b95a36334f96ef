use super::*;
use crate::material::j2::Response;
use crate::material::multistep::{Flow, anticipate, complete, dissipated, weight};

/// Isochoric stretch whose axes turn: strain far beyond yield on a curved path, no two increments
/// of which have one direction.
fn path(t: f64) -> Matrix {
    let turn = rotation([0.0, 0.0, 1.0], 0.9 * t);
    let stretch = 0.06 * t;
    let diagonal = [[stretch.exp(), 0.0, 0.0], [0.0, (-stretch).exp(), 0.0], [0.0, 0.0, 1.0]];
    let mut f = multiply(&multiply(&turn, &diagonal), &transpose(&turn));
    f[1][2] += 0.05 * t * t;
    f
}

fn inverse(m: &Matrix) -> Matrix {
    let c = |i: usize, k: usize| {
        let (a, b, c, d) = ((i + 1) % 3, (i + 2) % 3, (k + 1) % 3, (k + 2) % 3);
        m[a][c] * m[b][d] - m[a][d] * m[b][c]
    };
    let det: f64 = (0..3).map(|k| m[0][k] * c(0, k)).sum();
    std::array::from_fn(|i| std::array::from_fn(|k| c(k, i) / det))
}

/// Stress and alpha at the end of the path in `steps` steps, whose lengths follow the ratio
/// `growth`.
fn integrate(material: &Material<f64>, steps: usize, growth: f64, second_order: bool) -> ([f64; 6], f64) {
    let total: f64 = (0..steps).map(|i| growth.powf(i as f64 / steps as f64)).sum();
    let (mut state, mut flow, mut stress) = (PointState::default(), Flow::default(), [0.0; 6]);
    let (mut t, mut last) = (0.0, 0.0);
    for i in 0..steps {
        let dt = growth.powf(i as f64 / steps as f64) / total;
        let f = multiply(&path(t + dt), &inverse(&path(t)));
        let d: Matrix = std::array::from_fn(|i| std::array::from_fn(|k| f[i][k] - IDENTITY[i][k]));
        let w = if second_order && i > 0 { weight(dt / last) } else { 0.0 };
        let start = anticipate(&state, &flow, w);
        let response = respond(material, &d, &start);
        let (response, flowed) = complete(material, &d, &state, &start, response).unwrap();
        (state, flow, stress) = (response.state, flowed, response.stress);
        (t, last) = (t + dt, dt);
    }
    (stress, state.alpha)
}

#[test]
fn second_order_on_a_curved_path() {
    for (name, hardening) in [("ideal", FlowStress::ideal(2e-3).unwrap()), ("power", FlowStress::power(2e-3, 5e-3, 0.5).unwrap())]
    {
        let material = material(hardening);
        for growth in [1.0, 4.0] {
            let (exact, exact_alpha) = integrate(&material, 20_000, growth, true);
            let error = |n, second| {
                let (stress, alpha) = integrate(&material, n, growth, second);
                (distance(&stress, &exact), (alpha - exact_alpha).abs())
            };
            for second in [false, true] {
                let ((s1, a1), (s2, a2)) = (error(80, second), error(160, second));
                println!("{name}, growth {growth}, second order {second}: stress {s1:.1e} {s2:.1e}, alpha {a1:.1e} {a2:.1e}");
                let expected = if second { 3.5..4.6 } else { 1.8..2.2 };
                assert!(expected.contains(&(s1 / s2)), "{name}: stress {s1:e} {s2:e}");
            }
            let (first, second) = (error(160, false), error(160, true));
            assert!(second.0 < 0.1 * first.0 && second.1 < 0.5 * first.1, "{name}: {second:?} against {first:?}");
        }
    }
}

#[test]
fn nothing_anticipated_is_backward_euler() {
    let material = material(FlowStress::linear(2e-3, 0.05).unwrap());
    let d: Matrix = [[0.01, 0.004, 0.0], [0.0, -0.006, 0.0], [0.002, 0.0, -0.003]];
    let committed = respond(&material, &d, &PointState::default()).state;
    assert_eq!(anticipate(&committed, &Flow { strain: [1.0; 6], alpha: 0.1 }, 0.0), committed);
    assert_eq!(anticipate(&committed, &Flow { strain: [0.0; 6], alpha: 0.0 }, 0.3), committed);
    let plain = respond(&material, &d, &committed);
    let (response, flow) = complete(&material, &d, &committed, &committed, plain).unwrap();
    let dissipation = plain.plastic_work * dissipated(&plain.state.be);
    assert_eq!(response, Response { plastic_work: dissipation, ..plain });
    assert!((flow.alpha - (plain.state.alpha - committed.alpha)).abs() < 1e-18);
    // What the deviator lost is the plastic strain: |flow| = sqrt 6 delta alpha for small elastic
    // strains, b_e being twice the strain.
    let length = crate::material::j2::norm_squared(&flow.strain).sqrt();
    assert!((length / (6.0_f64.sqrt() * flow.alpha) - 1.0).abs() < 0.02, "{length} {}", flow.alpha);
}

#[test]
fn a_point_that_unloads_has_not_flowed() {
    let material = material(FlowStress::power(2e-3, 5e-3, 0.5).unwrap());
    let d: Matrix = [[0.0, 0.02, 0.0], [0.0; 3], [0.0; 3]];
    let first = respond(&material, &d, &PointState::default());
    let (first, flow) = complete(&material, &d, &PointState::default(), &PointState::default(), first).unwrap();
    assert!(flow.alpha > 0.0);
    let start = anticipate(&first.state, &flow, weight(1.0));
    assert!(start.alpha > first.state.alpha);
    // From the state that has anticipated flow this is an elastic step; from the committed one it
    // is an elastic unloading.
    let back: Matrix = [[0.0, 0.0048, 0.0], [0.0; 3], [0.0; 3]].map(|r: [f64; 3]| r.map(|x| x));
    let found = respond(&material, &back, &start);
    assert!(!found.yielding);
    let (response, flow) = complete(&material, &back, &first.state, &start, found).unwrap();
    let exact = respond(&material, &back, &first.state);
    let dissipation = exact.plastic_work * dissipated(&exact.state.be);
    assert_eq!(response, Response { plastic_work: dissipation, ..exact });
    assert!((flow.alpha - (exact.state.alpha - first.state.alpha)).abs() < 1e-18);
}

#[test]
fn the_work_of_anticipated_flow_is_counted() {
    let material = material(FlowStress::linear(2e-3, 0.05).unwrap());
    let d: Matrix = [[0.0, 0.01, 0.0], [0.0; 3], [0.0; 3]];
    let (mut state, mut flow, mut work) = (PointState::default(), Flow::default(), 0.0);
    for i in 0..5 {
        let start = anticipate(&state, &flow, if i > 0 { weight(1.0) } else { 0.0 });
        let (response, flowed) = complete(&material, &d, &state, &start, respond(&material, &d, &start)).unwrap();
        (state, flow) = (response.state, flowed);
        // Of the flow stress over alpha, from that of the flow rule.
        work += response.plastic_work / dissipated(&state.be);
        assert!(determinant_excess(&state.be).abs() < 1e-14);
    }
    let exact = state.alpha * (2e-3 + 0.5 * 0.05 * state.alpha);
    assert!((work / exact - 1.0).abs() < 1e-12, "{work} {exact}");
}
