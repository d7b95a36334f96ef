//! The patch test at finite strain: a homogeneous deformation of an irregular mesh is in
//! equilibrium and its stress uniform.

use super::*;
use crate::element::hex8::fields;
use crate::mesh::brick;

/// 3 x 3 x 3 elements with the inner nodes moved by up to 30 % of an element edge.
struct Patch {
    nodes: Vec<[f64; 3]>,
    elements: Vec<[u32; 8]>,
    inner: Vec<bool>,
    geometry: Vec<ElementGeometry<f64>>,
    state: Vec<ElementState<f64>>,
    u: Vec<[f64; 3]>,
}

impl Patch {
    fn new() -> Self {
        let mesh = brick(3, 3, 3, [1.0, 1.0, 1.0]).unwrap();
        let inner: Vec<bool> = mesh.nodes.iter().map(|x| x.iter().all(|&v| v > 1e-9 && v < 1.0 - 1e-9)).collect();
        let mut noise = Noise::new(11);
        let nodes: Vec<[f64; 3]> = mesh
            .nodes
            .iter()
            .zip(&inner)
            .map(|(x, &inner)| x.map(|v| v + if inner { 0.1 * noise.next() } else { 0.0 }))
            .collect();
        let geometry = mesh.elements.iter().map(|e| ElementGeometry::new(&e.map(|n| nodes[n as usize])).unwrap()).collect();
        assert_eq!(inner.iter().filter(|i| **i).count(), 8);
        let state = vec![ElementState::default(); mesh.elements.len()];
        Self { u: vec![[0.0; 3]; nodes.len()], inner, nodes, elements: mesh.elements, geometry, state }
    }

    fn of(&self, e: usize, x: &[[f64; 3]]) -> Nodal<f64> {
        self.elements[e].map(|n| x[n as usize])
    }

    /// Deforms from the committed displacement to u = h X, returns the nodal forces and commits.
    fn deform(&mut self, material: &Material<f64>, h: &Matrix) -> Vec<[f64; 3]> {
        let target: Vec<[f64; 3]> = self.nodes.iter().map(|x| apply(h, x)).collect();
        let mut forces = vec![[0.0; 3]; self.nodes.len()];
        for e in 0..self.elements.len() {
            let committed = self.of(e, &self.u);
            let increment = plus(&self.of(e, &target), &committed, -1.0);
            let f = force(&self.geometry[e], material, &self.state[e], &committed, &increment);
            for (&n, f) in self.elements[e].iter().zip(f) {
                for i in 0..3 {
                    forces[n as usize][i] += f[i];
                }
            }
            self.state[e] =
                update(&self.geometry[e], material, &self.state[e], &self.state[e].points, &committed, &increment).unwrap().0;
        }
        self.u = target;
        forces
    }

    /// The largest force on an inner node over the largest on any node, and the spread of the
    /// stress over its size.
    fn check(&mut self, material: &Material<f64>, h: &Matrix) -> (f64, f64, [f64; 6]) {
        let forces = self.deform(material, h);
        let size = |f: &[f64; 3]| f.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let all = forces.iter().map(size).fold(0.0, f64::max);
        let inner = forces.iter().zip(&self.inner).filter(|(_, i)| **i).map(|(f, _)| size(f)).fold(0.0, f64::max);
        let stress: Vec<[f64; 6]> = (0..self.elements.len())
            .flat_map(|e| fields(&self.geometry[e], material, &self.state[e].points, &self.of(e, &self.u)).unwrap().stress)
            .collect();
        let scale = stress[0].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let spread = stress.iter().flat_map(|s| (0..6).map(|c| (s[c] - stress[0][c]).abs())).fold(0.0, f64::max);
        (inner / all, spread / scale, stress[0])
    }
}

#[test]
fn an_elastic_patch_is_uniform_and_has_the_neo_hookean_stress() {
    // Stretches from 0.85 to 1.25 and shears of a quarter.
    let h = [[0.25, 0.2, -0.1], [0.05, -0.15, 0.15], [-0.1, 0.25, 0.1]];
    let material = elastic();
    let (inner, spread, stress) = Patch::new().check(&material, &h);
    assert!(inner < 1e-14 && spread < 1e-13, "inner force {inner:e}, stress spread {spread:e}");
    // sigma = U'(J) 1 + mu J^(-5/3) dev(F F^T), formed here from F itself.
    let f: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| h[i][j] + f64::from(u8::from(i == j))));
    let b: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| f[i][k] * f[j][k]).sum()));
    let j = f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) - f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0])
        + f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
    let mean = (b[0][0] + b[1][1] + b[2][2]) / 3.0;
    let e = &material.elasticity;
    for (c, (i, k)) in [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0)].into_iter().enumerate() {
        let one = f64::from(u8::from(i == k));
        let expected = 0.5 * e.bulk * (j - 1.0 / j) * one + e.shear * j.powf(-5.0 / 3.0) * (b[i][k] - mean * one);
        assert!((stress[c] - expected).abs() < 1e-14, "component {c}: {} {expected}", stress[c]);
    }
}

#[test]
fn a_plastic_patch_stays_uniform_through_loading_unloading_and_reversal() {
    let mut patch = Patch::new();
    let material = hardening();
    let direction = [[0.05, 0.04, -0.02], [0.0, -0.03, 0.03], [0.01, 0.02, 0.01]];
    // Elastic, plastic, plastic, back (elastic), far back (plastic again).
    for (factor, grows) in [(0.02, false), (0.5, true), (1.0, true), (0.98, false), (-1.0, true)] {
        let alpha = patch.state[0].points[0].alpha;
        let (inner, spread, _) = patch.check(&material, &direction.map(|r| r.map(|x| factor * x)));
        assert!(inner < 1e-12 && spread < 1e-11, "at {factor}: inner force {inner:e}, stress spread {spread:e}");
        assert_eq!(patch.state.iter().flat_map(|s| s.points).all(|p| p.alpha > alpha + 1e-6), grows, "at {factor}");
    }
}
