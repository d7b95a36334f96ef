//! The thick cylinder of MacNeal & Harder (1985, Finite Elem. Anal. Des. 1, 3-20, section 3.6):
//! nearly incompressible, plane strain.
//!
//! A wedge of ten degrees, five elements from the bore (radius 3) to the outside (radius 9), one
//! along the axis. Every node moves along its radius, so that the problem has six unknowns. The
//! same elements with the dilatation of each quadrature point in the place of the mean (which is
//! the displacement element) lock.

use super::*;
use crate::element::hex8::{PAIRS, pair, tangent};

const RADII: [f64; 6] = [3.0, 3.5, 4.2, 5.2, 6.75, 9.0];
const LAYERS: usize = RADII.len() - 1;
/// Half the angle of the wedge.
const HALF: f64 = 5.0 * std::f64::consts::PI / 180.0;

/// One quadrature point as an element of its own: its mean dilatation is that of the point. Eight
/// of them are the displacement element.
fn points_apart(g: &ElementGeometry<f64>) -> Vec<ElementGeometry<f64>> {
    (0..QUADRATURE_POINTS)
        .map(|q| {
            let mut alone = g.clone();
            alone.volume = crate::element::lanes::Lanes::from_fn(|i| if i == q { g.volume.0[q] } else { 0.0 });
            alone.total_volume = g.volume.0[q];
            alone
        })
        .collect()
}

struct Cylinder {
    material: Material<f64>,
    /// One geometry an element with mean dilatation, eight without.
    geometry: [Vec<ElementGeometry<f64>>; LAYERS],
    state: [Vec<ElementState<f64>>; LAYERS],
    /// Committed radial displacement of each ring of nodes.
    q: [f64; 6],
}

/// Ring (of two) and radial direction of the nodes of an element.
const RING: [usize; NODES] = [0, 1, 1, 0, 0, 1, 1, 0];
fn direction(a: usize) -> [f64; 3] {
    let angle = HALF * CORNERS[a][1];
    [angle.cos(), angle.sin(), 0.0]
}

impl Cylinder {
    fn new(material: Material<f64>, mean_dilatation: bool) -> Self {
        let geometry: [Vec<ElementGeometry<f64>>; LAYERS] = std::array::from_fn(|e| {
            let nodes = std::array::from_fn(|a| {
                let [c, s, _] = direction(a);
                let r = RADII[e + RING[a]];
                [r * c, r * s, 0.5 * (1.0 + CORNERS[a][2])]
            });
            let g = ElementGeometry::new(&nodes).unwrap();
            if mean_dilatation { vec![g] } else { points_apart(&g) }
        });
        let state = std::array::from_fn(|e| vec![ElementState::default(); geometry[e].len()]);
        Self { material, geometry, state, q: [0.0; 6] }
    }

    fn nodal(e: usize, q: &[f64; 6]) -> Nodal<f64> {
        std::array::from_fn(|a| direction(a).map(|d| q[e + RING[a]] * d))
    }

    /// Radial forces on the rings and their derivatives.
    fn evaluate(&self, q: &[f64; 6]) -> ([f64; 6], [[f64; 6]; 6]) {
        let (mut f, mut k) = ([0.0; 6], [[0.0; 6]; 6]);
        let increment: [f64; 6] = std::array::from_fn(|i| q[i] - self.q[i]);
        for e in 0..LAYERS {
            for (g, s) in self.geometry[e].iter().zip(&self.state[e]) {
                let (committed, step) = (Self::nodal(e, &self.q), Self::nodal(e, &increment));
                let nodal = force(g, &self.material, s, &committed, &step);
                let mut blocks = [[0.0; 9]; PAIRS];
                tangent(g, &self.material, &s.points, &committed, &step, &mut blocks).unwrap();
                for a in 0..NODES {
                    let d = direction(a);
                    f[e + RING[a]] += (0..3).map(|i| nodal[a][i] * d[i]).sum::<f64>();
                    for b in 0..NODES {
                        let t = direction(b);
                        for i in 0..3 {
                            for j in 0..3 {
                                let block = if a <= b { blocks[pair(a, b)][3 * i + j] } else { blocks[pair(b, a)][3 * j + i] };
                                k[e + RING[a]][e + RING[b]] += d[i] * block * t[j];
                            }
                        }
                    }
                }
            }
        }
        (f, k)
    }

    /// Expands the bore to `u` and returns the pressure in it (on its current surface).
    fn expand(&mut self, u: f64) -> f64 {
        let mut q = self.q;
        let ratio = if self.q[0] > 0.0 { u / self.q[0] } else { 1.0 };
        q.iter_mut().for_each(|x| *x *= ratio);
        q[0] = u;
        let mut f = [0.0; 6];
        for iteration in 0..30 {
            let (residual, mut k) = self.evaluate(&q);
            f = residual;
            let size = residual[1..].iter().fold(0.0_f64, |m, x| m.max(x.abs()));
            if iteration > 0 && size <= 1e-11 * f[0].abs() {
                break;
            }
            assert!(iteration < 29, "no convergence: {residual:?}");
            // The free rings, by elimination (the matrix is symmetric and positive, no pivots
            // needed).
            let mut r = residual;
            for i in 1..6 {
                for row in i + 1..6 {
                    let m = k[row][i] / k[i][i];
                    for c in i..6 {
                        k[row][c] -= m * k[i][c];
                    }
                    r[row] -= m * r[i];
                }
            }
            for i in (1..6).rev() {
                let known: f64 = (i + 1..6).map(|c| k[i][c] * r[c]).sum();
                r[i] = (r[i] - known) / k[i][i];
                q[i] -= r[i];
            }
        }
        let increment: [f64; 6] = std::array::from_fn(|i| q[i] - self.q[i]);
        for e in 0..LAYERS {
            let (committed, step) = (Self::nodal(e, &self.q), Self::nodal(e, &increment));
            for (g, s) in self.geometry[e].iter().zip(self.state[e].iter_mut()) {
                *s = update(g, &self.material, s, &s.points, &committed, &step).unwrap().0;
            }
        }
        self.q = q;
        // The face is the chord of the bore; its normal leans from the nodes' radii by half the
        // angle.
        f[0] / (2.0 * (RADII[0] + u) * HALF.sin() * HALF.cos())
    }
}

/// Lame: pressure over the expansion of the bore in plane strain.
fn lame(nu: f64) -> f64 {
    let (a2, b2) = (RADII[0] * RADII[0], RADII[5] * RADII[5]);
    (b2 - a2) / ((1.0 + nu) * RADII[0] * (b2 + (1.0 - 2.0 * nu) * a2))
}

#[test]
fn a_nearly_incompressible_elastic_cylinder_does_not_lock() {
    for (nu, locked) in [(0.3, 1.0), (0.49, 1.1), (0.4999, 5.0)] {
        let material = Material { elasticity: Elasticity::new(1.0, nu), hardening: FlowStress::Elastic };
        let u = 1e-6;
        let exact = lame(nu) * u;
        let mean = Cylinder::new(material.clone(), true).expand(u) / exact;
        let displacement = Cylinder::new(material, false).expand(u) / exact;
        println!("nu {nu}: stiffness over the exact one {mean:.4} with mean dilatation, {displacement:.4} without");
        // Six rings of nodes in a field that falls as 1/r: a few per cent, at any Poisson's ratio.
        assert!((mean - 1.0).abs() < 0.03, "nu {nu}: {mean}");
        assert!(displacement >= locked, "nu {nu}: {displacement}");
    }
}

#[test]
fn a_fully_plastic_cylinder_reaches_its_limit_pressure() {
    // Hill (1950): p = 2/sqrt(3) sigma_Y ln(b/a) once the whole wall flows, with the present radii.
    let yield_stress = 1e-3;
    let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::ideal(yield_stress).unwrap() };
    let pressure = |mean_dilatation: bool| {
        let mut cylinder = Cylinder::new(material.clone(), mean_dilatation);
        let mut ratio = [0.0; 2];
        for i in 1..=60 {
            let p = cylinder.expand(0.002 * f64::from(i));
            let limit = 2.0 / 3.0_f64.sqrt() * yield_stress * ((RADII[5] + cylinder.q[5]) / (RADII[0] + cylinder.q[0])).ln();
            if i % 30 == 0 {
                ratio[i as usize / 30 - 1] = p / limit;
            }
        }
        assert!(cylinder.state.iter().flatten().flat_map(|s| s.points).filter(|p| p.alpha > 0.0).count() >= LAYERS * 8);
        ratio
    };
    let (mean, displacement) = (pressure(true), pressure(false));
    println!("pressure over the limit at u = 0.06 and 0.12: {mean:?} with mean dilatation, {displacement:?} without");
    assert!(mean.iter().all(|r| (r - 1.0).abs() < 0.02), "{mean:?}");
    assert!((mean[1] - mean[0]).abs() < 2e-3, "no limit load: {mean:?}");
    assert!(displacement[1] > 1.05 && displacement[1] > displacement[0], "{displacement:?}");
}
