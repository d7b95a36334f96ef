//! One file a theme; what they share is here.

mod energy;
mod invalid;
mod invariance;
mod locking;
mod patch;
mod precision;
mod tangent;

use super::hex8::{CORNERS, ElementGeometry, ElementState, NODES, Nodal, QUADRATURE_POINTS, internal_force, update};
use crate::material::hardening::FlowStress;
use crate::material::multistep::Flow;
use crate::material::{Elasticity, Material};
use crate::real::Real;

/// 3 x 3, rows first.
pub type Matrix = [[f64; 3]; 3];

pub const ZERO: Nodal<f64> = [[0.0; 3]; NODES];

/// A well-formed but irregular element: a unit cube (the sizes differ) with every corner moved by
/// up to a tenth.
pub fn irregular() -> [[f64; 3]; NODES] {
    let mut noise = Noise::new(7);
    CORNERS.map(|c| std::array::from_fn(|i| 0.5 * [1.0, 1.2, 0.9][i] * c[i] + 0.1 * noise.next()))
}

pub fn geometry() -> ElementGeometry<f64> {
    ElementGeometry::new(&irregular()).unwrap()
}

pub fn elastic() -> Material<f64> {
    Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::Elastic }
}

pub fn hardening() -> Material<f64> {
    Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::linear(2e-3, 0.05).unwrap() }
}

/// The displacement (F - I) X of given points.
pub fn homogeneous(nodes: &[[f64; 3]; NODES], h: &Matrix) -> Nodal<f64> {
    nodes.map(|x| apply(h, &x))
}

pub fn apply(m: &Matrix, x: &[f64; 3]) -> [f64; 3] {
    std::array::from_fn(|i| (0..3).map(|j| m[i][j] * x[j]).sum())
}

/// Rotation by `angle` about `axis` (Rodrigues).
pub fn rotation(axis: [f64; 3], angle: f64) -> Matrix {
    let length = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
    let [x, y, z] = axis.map(|a| a / length);
    let (s, c) = angle.sin_cos();
    let d = 1.0 - c;
    [
        [c + x * x * d, x * y * d - z * s, x * z * d + y * s],
        [y * x * d + z * s, c + y * y * d, y * z * d - x * s],
        [z * x * d - y * s, z * y * d + x * s, c + z * z * d],
    ]
}

/// Smooth nodal displacements without any symmetry, of the size of `amplitude`.
pub fn wild(seed: u64, amplitude: f64) -> Nodal<f64> {
    let mut noise = Noise::new(seed);
    ZERO.map(|x| x.map(|_| amplitude * noise.next()))
}

pub fn plus(a: &Nodal<f64>, b: &Nodal<f64>, scale: f64) -> Nodal<f64> {
    std::array::from_fn(|n| std::array::from_fn(|i| a[n][i] + scale * b[n][i]))
}

/// The largest component.
pub fn largest(f: &Nodal<f64>) -> f64 {
    f.iter().flatten().fold(0.0, |m, x| m.max(x.abs()))
}

pub fn force(
    g: &ElementGeometry<f64>,
    m: &Material<f64>,
    s: &ElementState<f64>,
    committed: &Nodal<f64>,
    increment: &Nodal<f64>,
) -> Nodal<f64> {
    internal_force(g, m, &s.points, committed, increment).unwrap()
}

/// A plastic history: two steps of loading, committed. Returns the state and its displacement.
pub fn loaded(g: &ElementGeometry<f64>, m: &Material<f64>) -> (ElementState<f64>, Nodal<f64>) {
    let first =
        plus(&homogeneous(&irregular(), &[[0.004, 0.003, 0.0], [0.0, -0.006, 0.002], [0.001, 0.0, 0.003]]), &wild(3, 5e-4), 1.0);
    let state = update(g, m, &ElementState::default(), &ElementState::default().points, &ZERO, &first).unwrap().0;
    let second = plus(
        &homogeneous(&irregular(), &[[0.006, -0.002, 0.001], [0.004, -0.005, 0.0], [0.0, 0.003, 0.001]]),
        &wild(4, 5e-4),
        1.0,
    );
    let state = update(g, m, &state, &state.points, &first, &second).unwrap().0;
    assert!(state.points.iter().all(|p| p.alpha > 1e-3), "the history is not plastic at every point");
    (state, plus(&first, &second, 1.0))
}

/// Numbers in (-1, 1) from a 64-bit linear congruential generator (Knuth): the same ones always.
pub struct Noise(u64);

impl Noise {
    pub fn new(seed: u64) -> Self {
        let mut noise = Self(seed);
        noise.next();
        noise
    }

    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Rounds a state to another precision.
pub fn cast_state<R: Real>(s: &ElementState<f64>) -> ElementState<R> {
    ElementState {
        points: std::array::from_fn::<_, QUADRATURE_POINTS, _>(|q| crate::material::PointState {
            be: s.points[q].be.map(R::of),
            alpha: R::of(s.points[q].alpha),
        }),
        flow: s.flow.map(|f| Flow { strain: f.strain.map(R::of), alpha: R::of(f.alpha) }),
        plastic_work: R::of(s.plastic_work),
    }
}
