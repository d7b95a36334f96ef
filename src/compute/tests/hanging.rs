//! Elements with corners that hang: the patch test across them, and forces as the derivative of
//! energy.

use super::*;
use crate::contact::rigid::Rigid;
use crate::mesh::{SphereSpec, sphere_mesh};

/// Half a sphere with a skin of two levels.
fn with_skin() -> Arc<Mesh> {
    let spec =
        SphereSpec { contact_radius: 0.3, elements_per_contact_radius: 4, fine_zone: 1.3, skin_levels: 2, first_layer: 1.0 };
    Arc::new(sphere_mesh(&spec).unwrap())
}

fn of(mesh: &Arc<Mesh>, hardening: FlowStress<f64>) -> CaseModel {
    let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening };
    CaseModel {
        mesh: mesh.clone(),
        material,
        friction: Friction::Coulomb(0.3),
        opponent: None,
        image: None,
        surface: Rigid::default(),
    }
}

fn forces(backend: &mut dyn Compute, u: &[f64]) -> Vec<f64> {
    let mut force = vec![0.0; u.len()];
    assert_eq!(CaseHandle { backend, case: 0 }.internal_force(u, &mut force).unwrap(), Evaluated::Valid);
    force
}

/// Under a uniform deformation no node inside carries a force, however far it is turned.
#[test]
fn a_uniform_deformation_passes_through_corners_that_hang() {
    let mesh = with_skin();
    let hang = mesh.hanging.iter().filter(|hanging| !hanging.is_none()).count();
    assert!(10 * hang > mesh.elements.len(), "{hang} of {}", mesh.elements.len());
    let on_boundary = |x: &[f64; 3]| x[1] == 0.0 || x[2] == 1.0 || (x[0].hypot(x[1]).hypot(1.0 - x[2]) - 1.0).abs() < 1e-12;
    // A turn by 0.7 rad, after a stretch.
    let (c, s) = (0.7f64.cos(), 0.7f64.sin());
    let gradient = [[1.01 * c, -0.99 * s, 0.004], [1.01 * s, 0.99 * c, -0.002], [0.003, 0.001, 1.004]];
    let moved = |x: &[f64; 3]| [0, 1, 2].map(|i| (0..3).map(|j| gradient[i][j] * x[j]).sum::<f64>() - x[i]);
    let u: Vec<f64> = mesh.nodes.iter().flat_map(moved).collect();
    let mut cpu = Cpu::<f64>::new(vec![of(&mesh, FlowStress::Elastic)]).unwrap();
    let force = forces(&mut cpu, &u);
    let largest = |inside: bool| {
        let nodes = mesh.nodes.iter().enumerate().filter(|(_, x)| on_boundary(x) != inside);
        nodes.flat_map(|(n, _)| &force[3 * n..3 * n + 3]).fold(0f64, |m, f| m.max(f.abs()))
    };
    assert!(largest(true) < 1e-15 && largest(false) > 1e-4, "{:e} inside, {:e} outside", largest(true), largest(false));
}

/// Blocks against differences of the forces, at nodes from which corners hang; elastic, as a point
/// that begins to yield between the two has neither slope.
#[test]
fn the_tangent_is_the_derivative_across_corners_that_hang() {
    let mesh = with_skin();
    let mut cpu = Cpu::<f64>::new(vec![of(&mesh, FlowStress::Elastic)]).unwrap();
    commit(&mut cpu, 0, &displacement(&mesh, 5e-3));
    let u = displacement(&mesh, 2e-2);
    let pattern = Pattern::from_elements(mesh.nodes.len(), &mesh.elements);
    let mut blocks = vec![[0.0_f64; 9]; pattern.entries()];
    assert_eq!(CaseHandle { backend: &mut cpu, case: 0 }.tangent(&u, &mut blocks).unwrap(), Evaluated::Valid);
    let carriers = mesh
        .elements
        .iter()
        .zip(&mesh.hanging)
        .flat_map(|(nodes, hanging)| (0..8).filter(|&a| hanging.hangs(a)).map(|a| nodes[a] as usize).collect::<Vec<_>>());
    for node in carriers.step_by(97) {
        for j in 0..3 {
            let at = |step: f64| {
                let mut u = u.clone();
                u[3 * node + j] += step;
                u
            };
            let step = 1e-6;
            let (more, less) = (forces(&mut cpu, &at(step)), forces(&mut cpu, &at(-step)));
            for e in pattern.row(node) {
                let row = pattern.column[e] as usize;
                let block = blocks[pattern.position(row, node).unwrap()];
                for i in 0..3 {
                    let difference = (more[3 * row + i] - less[3 * row + i]) / (2.0 * step);
                    assert!((difference - block[3 * i + j]).abs() < 1e-8, "{node}, {row}: {difference} {}", block[3 * i + j]);
                }
            }
        }
    }
}
