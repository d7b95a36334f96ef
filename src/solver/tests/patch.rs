//! A brick pressed on the plane without friction: the pressure is uniform to rounding.

use super::*;
use crate::mesh::brick;

/// A brick whose inner nodes, and those inside the bottom face, are off their grid.
fn irregular_brick() -> Mesh {
    let lengths = [1.2, 0.8, 0.9];
    let mut mesh = brick(4, 4, 3, lengths).unwrap();
    let mut seed = 5u64;
    let mut noise = || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    for x in &mut mesh.nodes {
        let inside = |i: usize| x[i] > 1e-9 && x[i] < lengths[i] - 1e-9;
        let (sides, height) = (inside(0) && inside(1), inside(2));
        for i in 0..3 {
            let shift = 0.04 * noise();
            if sides && (i < 2 && x[2] < lengths[2] - 1e-9 || height) {
                x[i] += shift;
            }
        }
    }
    let (area, size) = crate::mesh::connectivity::contact_measures(&mesh.nodes, &mesh.contact_faces, &mesh.contact_nodes);
    (mesh.contact_area, mesh.contact_size) = (area, size);
    mesh
}

/// The elastic constants with which a brick that is shortened to `stretch` wants to keep its width:
/// its lateral stress `(lambda^2 - 1)(kappa/2 - mu/3 lambda^(-2/3))` is zero (nu = 0 in the limit
/// of small strain).
fn cork(stretch: f64) -> Elasticity<f64> {
    Elasticity { bulk: 2.0 / 3.0 * 0.5 * stretch.powf(-2.0 / 3.0), shear: 0.5 }
}

#[test]
fn a_pressed_brick_has_a_uniform_pressure() {
    let stretch = 0.9_f64;
    let mesh = irregular_brick();
    let elasticity = cork(stretch);
    let material = Material { elasticity, hardening: FlowStress::Elastic };
    let mut rig = Rig::new(mesh, material, Friction::Coulomb(0.0), TIGHT);
    let report = rig.to(0.9 * (1.0 - stretch), 0.0);
    // -P_zz = -dW/dlambda of a uniaxial stretch.
    let pressure = 0.5 * elasticity.bulk * (1.0 / stretch - stretch)
        + 2.0 / 3.0 * elasticity.shear * stretch.powf(-5.0 / 3.0) * (1.0 - stretch * stretch);
    let trial = rig.newton.accepted();
    for ((&node, area), rows) in rig.mesh.contact_nodes.iter().zip(&rig.mesh.contact_area).zip(&trial.rows) {
        let n = 3 * node as usize;
        assert_ne!(rows.status, Status::Open);
        assert!(
            (trial.force[n + 2] / area / pressure - 1.0).abs() < 1e-11,
            "node {node}: {}",
            trial.force[n + 2] / area / pressure
        );
        assert!(trial.u[n + 2].abs() < 1e-15, "the gap is {:e}", trial.u[n + 2]);
    }
    for (u, x) in trial.u.chunks(3).zip(&rig.mesh.nodes) {
        let expected = [0.0, 0.0, (stretch - 1.0) * x[2]];
        assert!((0..3).all(|i| (u[i] - expected[i]).abs() < 1e-12), "{u:?} {expected:?}");
    }
    assert!((rig.forces().0 - pressure * 1.2 * 0.8).abs() < 1e-12);
    assert!(report.iterations.len() <= 8, "{} iterations", report.iterations.len());
}

#[test]
fn a_bonded_layer_is_squeezed_and_sheared_uniformly() {
    // One layer of elements between plate and plane, stuck: every node is prescribed in effect, and
    // F is the same everywhere.
    let (height, area) = (0.3, 1.2 * 0.8);
    let material = elastic(0.3);
    let e = material.elasticity;
    let mut rig = Rig::new(brick(5, 4, 1, [1.2, 0.8, height]).unwrap(), material, Friction::Stick, TIGHT);
    rig.to(0.02, 0.0);
    rig.to(0.02, 0.015);
    let (lambda, gamma) = (1.0 - 0.02 / height, 0.015 / height);
    let (f_n, f_t) = rig.forces();
    let shear = e.shear * lambda.powf(-2.0 / 3.0) * gamma;
    let normal = 0.5 * e.bulk * (1.0 / lambda - lambda)
        + e.shear * (lambda.powf(-5.0 / 3.0) * (2.0 + gamma * gamma + lambda * lambda) / 3.0 - lambda.powf(1.0 / 3.0));
    assert!((f_t / (shear * area) - 1.0).abs() < 1e-11, "{f_t} {}", shear * area);
    assert!((f_n / (normal * area) - 1.0).abs() < 1e-11, "{f_n} {}", normal * area);
    assert!(rig.statuses().iter().all(|s| *s == Status::Stick));
}

#[test]
fn a_body_that_lost_its_contact_is_in_equilibrium() {
    // Pressed until it flows, then lifted off: residual stresses remain, and no force by which to
    // scale what rounding leaves.
    let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::ideal(2e-3).unwrap() };
    let mut rig = Rig::new(
        irregular_brick(),
        material,
        Friction::Coulomb(0.2),
        Settings {
            tolerance: 3e-4,
            max_iterations: 25,
            loosest_linear: 0.1,
            held_linear: 0.01,
            first_linear: f64::INFINITY,
            monotone_from: 2,
        },
    );
    rig.to(0.004, 0.0);
    rig.to(0.008, 0.0);
    assert!(rig.energies.plastic > 0.0);
    for h in [0.004, -0.01, -0.02] {
        rig.to(h, 0.0);
    }
    assert!(rig.statuses().iter().all(|s| *s == Status::Open));
    assert_eq!(rig.forces(), (0.0, 0.0));
    // And back on.
    rig.to(0.009, 0.0);
    assert!(rig.forces().0 > 0.0);
}
