//! The internal force is the derivative of the energy.

use super::*;
use crate::element::hex8::fields;
use crate::material::j2;

fn energy(g: &ElementGeometry<f64>, m: &Material<f64>, u: &Nodal<f64>) -> f64 {
    let (state, energy) = update(g, m, &ElementState::default(), &ElementState::default().points, &ZERO, u).unwrap();
    let shown = fields(g, m, &state.points, u).unwrap().elastic_energy;
    assert!((energy - shown).abs() <= 1e-12 * shown, "{energy:e} {shown:e}");
    energy
}

#[test]
fn the_elastic_force_is_the_derivative_of_the_energy() {
    let g = geometry();
    let m = elastic();
    for amplitude in [1e-3, 0.05, 0.2] {
        let u = wild(21, amplitude);
        let f = force(&g, &m, &ElementState::default(), &ZERO, &u);
        let e = 1e-5 * amplitude.sqrt();
        for a in 0..NODES {
            for i in 0..3 {
                let mut step = ZERO;
                step[a][i] = e;
                let slope = (energy(&g, &m, &plus(&u, &step, 1.0)) - energy(&g, &m, &plus(&u, &step, -1.0))) / (2.0 * e);
                assert!((slope - f[a][i]).abs() < 1e-8 * largest(&f), "amplitude {amplitude}, {a} {i}: {slope:e} {:e}", f[a][i]);
            }
        }
    }
}

/// (work - elastic energy - plastic work)/work of a straight path in n steps by the trapezoidal
/// rule, and what it would be if plastic work were that of the flow stress over alpha.
///
/// Simo & Hughes's flow rule, L_v b_e = -2/3 gamma tr(b_e) n, dissipates `|s| gamma (tr b_e/3) n :
/// n b_e^-1`, which is `sigma d alpha (1 - dev b_e : n^2 + ...)` and not `sigma d alpha` alone.
/// With |tr n^3| <= 1/sqrt(6) the difference is at most |dev b_e|/sqrt(6) of the plastic work, in
/// first order of the elastic strain.
fn imbalance(yield_stress: f64, n: usize) -> (f64, f64) {
    let g = geometry();
    let m = Material {
        elasticity: Elasticity::new(1.0, 0.3),
        hardening: FlowStress::linear(yield_stress, 25.0 * yield_stress).unwrap(),
    };
    let end = plus(&homogeneous(&irregular(), &[[0.02, 0.03, 0.0], [0.0, -0.02, 0.01], [0.01, 0.0, 0.005]]), &wild(3, 5e-3), 1.0);
    let (mut state, mut committed, mut f, mut work) = (ElementState::default(), ZERO, ZERO, 0.0);
    for i in 1..=n {
        let target = end.map(|x| x.map(|x| x * i as f64 / n as f64));
        let increment = plus(&target, &committed, -1.0);
        let next = force(&g, &m, &state, &committed, &increment);
        for a in 0..NODES {
            for i in 0..3 {
                work += 0.5 * (f[a][i] + next[a][i]) * increment[a][i];
            }
        }
        state = update(&g, &m, &state, &state.points, &committed, &increment).unwrap().0;
        (committed, f) = (target, next);
    }
    let elastic = fields(&g, &m, &state.points, &committed).unwrap().elastic_energy;
    assert!(state.plastic_work > elastic, "the path is hardly plastic");
    let strain = state.points.iter().map(|p| j2::norm_squared(&j2::deviator(&p.be).0).sqrt()).fold(0.0, f64::max);
    ((work - elastic - state.plastic_work) / work, strain / 6.0_f64.sqrt())
}

#[test]
fn the_work_of_a_plastic_path_is_stored_or_dissipated() {
    // Nothing is left in the limit of fine steps, however large the elastic strain.
    for yield_stress in [2e-4, 2e-3] {
        let [coarse, middle, fine] = [80, 320, 1280].map(|n| imbalance(yield_stress, n));
        println!("{yield_stress}: {coarse:?} {middle:?} {fine:?}");
        assert!(middle.0.abs() < 0.25 * coarse.0.abs() && fine.0.abs() < 0.01 * coarse.0.abs(), "{coarse:?} {middle:?} {fine:?}");
        assert!(fine.0.abs() < 0.02 * fine.1, "{fine:?}");
    }
}
