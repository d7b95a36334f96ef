//! The tangent against central differences of the force.

use super::*;
use crate::element::hex8::{PAIRS, VOIGT, pair, tangent};
use crate::material::j2::{self, return_mapping};

type Full = [[f64; 24]; 24];

/// The whole tangent from its upper triangle of blocks.
fn full(
    g: &ElementGeometry<f64>,
    m: &Material<f64>,
    s: &ElementState<f64>,
    committed: &Nodal<f64>,
    increment: &Nodal<f64>,
) -> Full {
    let mut blocks = [[0.0; 9]; PAIRS];
    tangent(g, m, &s.points, committed, increment, &mut blocks).unwrap();
    let mut k = [[0.0; 24]; 24];
    for a in 0..NODES {
        for b in a..NODES {
            for i in 0..3 {
                for j in 0..3 {
                    k[3 * a + i][3 * b + j] = blocks[pair(a, b)][3 * i + j];
                    k[3 * b + j][3 * a + i] = blocks[pair(a, b)][3 * i + j];
                }
            }
        }
    }
    k
}

fn differences(
    g: &ElementGeometry<f64>,
    m: &Material<f64>,
    s: &ElementState<f64>,
    committed: &Nodal<f64>,
    increment: &Nodal<f64>,
) -> Full {
    let e = 1e-6;
    let mut k = [[0.0; 24]; 24];
    for b in 0..24 {
        let mut step = ZERO;
        step[b / 3][b % 3] = e;
        let up = force(g, m, s, committed, &plus(increment, &step, 1.0));
        let down = force(g, m, s, committed, &plus(increment, &step, -1.0));
        for a in 0..24 {
            k[a][b] = (up[a / 3][a % 3] - down[a / 3][a % 3]) / (2.0 * e);
        }
    }
    k
}

fn distance(a: &Full, b: &Full) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).fold(0.0, |m, (x, y)| m.max((x - y).abs()))
}

fn size(a: &Full) -> f64 {
    a.iter().flatten().fold(0.0, |m, x| m.max(x.abs()))
}

/// det and inverse of I + h.
fn inverse(h: &Matrix) -> Matrix {
    let f: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| h[i][j] + f64::from(u8::from(i == j))));
    let minor = |i: usize, j: usize| {
        let (r, c) = ([(i + 1) % 3, (i + 2) % 3], [(j + 1) % 3, (j + 2) % 3]);
        f[r[0]][c[0]] * f[r[1]][c[1]] - f[r[0]][c[1]] * f[r[1]][c[0]]
    };
    let det: f64 = (0..3).map(|j| f[0][j] * minor(0, j)).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| minor(j, i) / det))
}

fn gradient(g: &ElementGeometry<f64>, u: &Nodal<f64>, q: usize) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..NODES).map(|a| u[a][i] * g.gradient[a][j].0[q]).sum()))
}

/// What the symmetrised moduli leave out of the exact tangent: sum_q V grad N_a . C . grad N_b with
/// C = -mu_bar beta_4 (n (x) dev n^2 - dev n^2 (x) n) (Simo & Hughes 1998, box 9.2).
fn left_out(
    g: &ElementGeometry<f64>,
    m: &Material<f64>,
    s: &ElementState<f64>,
    committed: &Nodal<f64>,
    increment: &Nodal<f64>,
) -> (Full, usize) {
    let mut k = [[0.0; 24]; 24];
    let mut yielding = 0;
    for q in 0..QUADRATURE_POINTS {
        let (h_n, dh) = (gradient(g, committed, q), gradient(g, increment, q));
        let f_n = inverse(&h_n);
        let relative: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|l| dh[i][l] * f_n[l][j]).sum()));
        let r = return_mapping(m, &relative, &s.points[q]).unwrap();
        yielding += usize::from(r.yielding);
        let f_inverse = inverse(&std::array::from_fn(|i| std::array::from_fn(|j| h_n[i][j] + dh[i][j])));
        let grad: Nodal<f64> =
            std::array::from_fn(|a| std::array::from_fn(|j| (0..3).map(|l| g.gradient[a][l].0[q] * f_inverse[l][j]).sum()));
        let n: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| r.normal[VOIGT[i][j]]));
        let square: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|l| n[i][l] * n[l][j]).sum()));
        let mean = j2::norm_squared(&r.normal) / 3.0;
        let dev: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| square[i][j] - if i == j { mean } else { 0.0 }));
        let scale = -g.volume.0[q] * r.mu_bar * r.beta_4;
        let along = |t: &Matrix, b: usize| apply(t, &grad[b]);
        for a in 0..NODES {
            for b in 0..NODES {
                let (na, nb, ma, mb) = (along(&n, a), along(&n, b), along(&dev, a), along(&dev, b));
                for i in 0..3 {
                    for j in 0..3 {
                        k[3 * a + i][3 * b + j] += scale * (na[i] * mb[j] - ma[i] * nb[j]);
                    }
                }
            }
        }
    }
    (k, yielding)
}

#[test]
fn the_elastic_tangent_is_the_derivative_of_the_force() {
    let (g, m) = (geometry(), elastic());
    for amplitude in [0.0, 1e-3, 0.2] {
        let u = wild(31, amplitude);
        let k = full(&g, &m, &ElementState::default(), &ZERO, &u);
        let error = distance(&k, &differences(&g, &m, &ElementState::default(), &ZERO, &u)) / size(&k);
        assert!(error < 2e-9, "amplitude {amplitude}: {error:e}");
    }
    // From a committed state the same tangent comes out: only the total deformation counts.
    let (u, part) = (wild(31, 0.1), wild(32, 0.08));
    let state = update(&g, &m, &ElementState::default(), &ElementState::default().points, &ZERO, &part).unwrap().0;
    let (whole, split) = (full(&g, &m, &ElementState::default(), &ZERO, &u), full(&g, &m, &state, &part, &plus(&u, &part, -1.0)));
    assert!(distance(&whole, &split) < 1e-14 * size(&whole) * 24.0);
}

#[test]
fn the_plastic_tangent_lacks_the_antisymmetric_moduli_and_nothing_else() {
    let g = geometry();
    for hardening in
        [FlowStress::ideal(2e-3).unwrap(), FlowStress::linear(2e-3, 0.05).unwrap(), FlowStress::voce(2e-3, 5e-3, 20.0).unwrap()]
    {
        let m = Material { elasticity: Elasticity::new(1.0, 0.3), hardening };
        let (state, committed) = loaded(&g, &m);
        let increment = plus(
            &homogeneous(&irregular(), &[[0.01, 0.0, 0.006], [0.0, -0.008, 0.0], [0.004, 0.002, -0.003]]),
            &wild(9, 1e-3),
            1.0,
        );
        let (extra, yielding) = left_out(&g, &m, &state, &committed, &increment);
        assert_eq!(yielding, QUADRATURE_POINTS, "{:?}", m.hardening);
        let k = full(&g, &m, &state, &committed, &increment);
        let exact: Full = std::array::from_fn(|a| std::array::from_fn(|b| k[a][b] + extra[a][b]));
        let numeric = differences(&g, &m, &state, &committed, &increment);
        let error = distance(&exact, &numeric) / size(&k);
        assert!(error < 1e-8, "{:?}: {error:e}", m.hardening);
        // beta_4 <= |s_trial|/mu_bar, which is of the size of the elastic strain and the increment:
        // a small part of the whole.
        let share = distance(&k, &numeric) / size(&k);
        assert!(share > 1e-5 && share < 2e-2, "{:?}: {share:e}", m.hardening);
    }
}

#[test]
fn an_elastic_step_after_plastic_flow_has_the_exact_tangent() {
    let (g, m) = (geometry(), hardening());
    let (state, committed) = loaded(&g, &m);
    // A tenth of a per mille back along the way it came, far inside the yield surface for the
    // differences.
    let increment = committed.map(|x| x.map(|v| -0.08 * v));
    let (extra, yielding) = left_out(&g, &m, &state, &committed, &increment);
    assert_eq!((yielding, size(&extra)), (0, 0.0));
    let k = full(&g, &m, &state, &committed, &increment);
    let error = distance(&k, &differences(&g, &m, &state, &committed, &increment)) / size(&k);
    assert!(error < 2e-9, "{error:e}");
}

#[test]
fn the_tangent_is_symmetric() {
    let (g, m) = (geometry(), hardening());
    let (state, committed) = loaded(&g, &m);
    let mut blocks = [[0.0; 9]; PAIRS];
    tangent(&g, &m, &state.points, &committed, &wild(33, 5e-3), &mut blocks).unwrap();
    let scale = blocks.iter().flatten().fold(0.0_f64, |m, x| m.max(x.abs()));
    // Off the diagonal only one triangle is formed; the blocks on it have both.
    for a in 0..NODES {
        let k = &blocks[pair(a, a)];
        for (i, j) in [(0, 1), (1, 2), (0, 2)] {
            assert!((k[3 * i + j] - k[3 * j + i]).abs() < 1e-15 * scale, "{a} {i} {j}: {k:?}");
        }
    }
    // The nodes in the opposite order (the element turned by 180 degrees about x) exchange the
    // triangles: the blocks that were not formed are the transposes.
    const TURN: [usize; 8] = [7, 6, 5, 4, 3, 2, 1, 0];
    let turned = ElementGeometry::<f64>::new(&TURN.map(|a| irregular()[a])).unwrap();
    let u = wild(33, 0.1);
    let k = full(&g, &elastic(), &ElementState::default(), &ZERO, &u);
    let t = full(&turned, &elastic(), &ElementState::default(), &ZERO, &TURN.map(|a| u[a]));
    for (a, &ta) in TURN.iter().enumerate() {
        for (b, &tb) in TURN.iter().enumerate() {
            for i in 0..3 {
                for j in 0..3 {
                    let difference = (t[3 * a + i][3 * b + j] - k[3 * ta + i][3 * tb + j]).abs();
                    assert!(difference < 1e-14 * scale.max(1.0), "{a} {b}: {difference:e}");
                }
            }
        }
    }
}
